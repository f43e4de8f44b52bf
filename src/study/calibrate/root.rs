//! The root of a function between two values of opposite sign, by the ITP method (interpolate,
//! truncate, project): Oliveira and Takahashi, "An Enhancement of the Bisection Method Average
//! Performance Preserving Minmax Optimality", ACM Transactions on Mathematical Software 47 (2020).
//!
//! It follows the chord where that does well, and never needs more than one step more than
//! halving the range would: every step here is a handful of simulations.

/// Factor of the truncation, in widths of the range; its exponent is 2. As the authors suggest.
const TRUNCATION: f64 = 0.2;

/// Steps that it may need beyond those of halving.
const SLACK: i32 = 1;

/// Narrows a range in which a function changes its sign until it is as narrow as `width`, in
/// `most_steps` at most; ends early where the function is 0. The function is asked at both ends, too.
/// Gives the range that is left: both ends the same at a root, the range itself where the sign
/// does not change in it.
pub(super) fn narrow<E>(
    (low, high): (f64, f64),
    width: f64,
    most_steps: u32,
    mut function: impl FnMut(f64) -> Result<f64, E>,
) -> Result<(f64, f64), E> {
    let (mut a, mut b) = (low, high);
    let (mut at_a, mut at_b) = (function(a)?, function(b)?);
    for (end, value) in [(a, at_a), (b, at_b)] {
        if value == 0.0 {
            return Ok((end, end));
        }
    }
    if !(at_a * at_b < 0.0 && b > a && width > 0.0) {
        return Ok((low, high));
    }
    // A hair less, so that rounding costs no step.
    let aim = 0.999 * width;
    let halvings = ((b - a) / aim).log2().ceil().max(0.0) as i32;
    let truncation = TRUNCATION / (b - a);
    for step in 0..most_steps {
        if b - a <= width {
            break;
        }
        let middle = f64::midpoint(a, b);
        let chord = (at_b * a - at_a * b) / (at_b - at_a);
        // The chord's root, moved towards the middle so that the other end moves, too.
        let towards = (middle - chord).signum();
        let moved = truncation * (b - a).powi(2);
        let truncated =
            if moved <= (middle - chord).abs() { chord + towards * moved } else { middle };
        // As far from the middle as the steps that are left make up for.
        let left = halvings + SLACK - step as i32;
        let reach = (aim / 2.0 * 2f64.powi(left) - (b - a) / 2.0).max(0.0);
        let at =
            if (truncated - middle).abs() <= reach { truncated } else { middle - towards * reach };
        let value = function(at)?;
        if value == 0.0 {
            return Ok((at, at));
        }
        if (value < 0.0) == (at_a < 0.0) {
            (a, at_a) = (at, value);
        } else {
            (b, at_b) = (at, value);
        }
    }
    Ok((a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    type Case = (&'static str, fn(f64) -> f64, (f64, f64), f64);

    const CASES: [Case; 7] = [
        ("x² - 2", |x| x * x - 2.0, (0.0, 2.0), std::f64::consts::SQRT_2),
        ("2 - x²", |x| 2.0 - x * x, (0.0, 2.0), std::f64::consts::SQRT_2),
        ("cos x - x", |x| x.cos() - x, (0.0, 1.0), 0.739_085_133_215_160_6),
        ("x⁹ - 0.1, flat at one end", |x| x.powi(9) - 0.1, (0.0, 2.0), 0.774_263_682_681_127),
        ("a step", |x| if x < 0.3 { -1.0 } else { 5.0 }, (0.0, 1.0), 0.3),
        ("a line", |x| 3.0 * x - 1.0, (-1.0, 1.0), 1.0 / 3.0),
        ("an exponential", |x| (8.0 * x).exp() - 1000.0, (0.0, 2.0), 0.863_469_409_872_767_3),
    ];

    /// Law: the range that is left holds the root, is as narrow as asked, and takes no more than
    /// one step more than halving.
    #[test]
    fn roots_are_closed_in_on_in_no_more_steps_than_halving_and_one() {
        for (name, function, range, root) in CASES {
            let mut asked = 0;
            let found = narrow(range, 1e-6, 100, |x| {
                asked += 1;
                Ok::<_, ()>(function(x))
            });
            let (low, high) = found.expect("nothing fails");
            assert!(
                low - 1e-9 <= root && root <= high + 1e-9 && high - low <= 1e-6,
                "law: {name}: {root} is closed in to 1e-6, got {low} to {high}"
            );
            let halvings = ((range.1 - range.0) / 1e-6_f64).log2().ceil() as i32;
            // Both ends are asked, too.
            assert!(asked <= halvings + 3, "law: {name}: {asked} values, halving takes {halvings}");
        }
        let mut asked = 0;
        let smooth = narrow((0.0, 2.0), 1e-6, 100, |x| {
            asked += 1;
            Ok::<_, ()>(x * x - 2.0)
        });
        assert!(smooth.is_ok() && asked <= 14, "law: a smooth one takes few values, got {asked}");
    }

    #[test]
    fn it_ends_where_it_must() {
        let parabola = |x: f64| Ok::<_, ()>(x * x - 2.0);
        assert_eq!(narrow((2.0, 3.0), 1e-6, 100, parabola), Ok((2.0, 3.0)), "law: no sign changes");
        let at_end = |x: f64| Ok::<_, ()>(x - 1.0);
        assert_eq!(narrow((1.0, 3.0), 1e-6, 100, at_end), Ok((1.0, 1.0)), "law: a root at an end");
        let (low, high) = narrow((0.0, 2.0), 1e-6, 2, parabola).expect("nothing fails");
        assert!(high - low < 2.0 && high - low > 1e-6, "law: two steps are two steps");
        let mut left = 3;
        let stopped = narrow((0.0, 2.0), 1e-6, 100, |x| {
            left -= 1;
            if left < 0 { Err("no more") } else { Ok(x * x - 2.0) }
        });
        assert_eq!(stopped, Err("no more"), "law: what fails is handed on");
    }
}
