//! A thin rectangular block that slides and spins, by Coulomb's law at its four corners.
//!
//! Each corner i bears a quarter of the weight and is resisted by −μ m g/4 · vᵢ/|vᵢ| with vᵢ = v +
//! ω × rᵢ. Sliding and spinning are coupled: friction has one direction at each corner, and what is
//! used against the spin is lacking against the sliding, so that a block that spins slides further
//! (Goyal, Ruina and Papadopoulos 1991, "Planar sliding with dry friction", Wear 143; for the disc
//! Farkas et al. 2003, Phys. Rev. Lett. 90, 248302). Both end at the same time. There is no closed
//! solution but for one of them alone; the equations are integrated by Runge-Kutta with steps that
//! shrink with the motion that is left.

use super::*;

/// A block and how it begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slide {
    /// Half the sides in m.
    pub half: Vector2<f64>,
    pub friction: f64,
    /// Velocity along x in m/s.
    pub speed: f64,
    /// Angular velocity in rad/s.
    pub spin: f64,
    /// Half the block's height in m if the loads shift to the corners in front
    /// as far as friction below the centroid demands; 0 for equal loads.
    pub half_height: f64,
}

/// How it ends.
#[derive(Debug, Clone)]
pub(super) struct End {
    /// Displacement in m.
    pub displacement: Vector2<f64>,
    /// Angle turned in rad.
    pub angle: f64,
    /// Time in s.
    pub time: f64,
    /// Distance in m over time in s.
    pub curve: Vec<(f64, f64)>,
}

/// x, y, angle, and their rates.
type State = SVector<f64, 6>;

impl Slide {
    /// Half the diagonal in m, at which the corners are.
    fn radius(&self) -> f64 {
        self.half.norm()
    }

    /// Square of the radius of gyration in m²: (a² + b²)/3 for a rectangle.
    fn gyration_squared(&self) -> f64 {
        self.half.norm_squared() / 3.0
    }

    /// Share of the weight at a corner with friction `pull` (acceleration, m/s²).
    fn share(&self, corner: Vector2<f64>, axes: [Vector2<f64>; 2], pull: Vector2<f64>) -> f64 {
        // Σ Nᵢ rᵢ = −(h/2) F with Nᵢ linear over the base; Σ of rᵢ² along an axis is 4 a².
        let along =
            |axis: Vector2<f64>, half: f64| corner.dot(&axis) * pull.dot(&axis) / half / half;
        let shift = along(axes[0], self.half.x) + along(axes[1], self.half.y);
        0.25 * (1.0 - self.half_height / GRAVITY * shift)
    }

    fn rate(&self, s: &State) -> State {
        let (sin, cos) = s[2].sin_cos();
        let axes = [Vector2::new(cos, sin), Vector2::new(-sin, cos)];
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
            .map(|(i, j)| axes[0] * (i * self.half.x) + axes[1] * (j * self.half.y));
        let against = corners.map(|r| {
            let slip = Vector2::new(s[3] - s[5] * r.y, s[4] + s[5] * r.x);
            -slip / slip.norm().max(1e-12)
        });
        let mut shares = [0.25; 4];
        // Loads depend on friction and friction on loads: by a percent, so that few rounds do.
        let rounds = if self.half_height > 0.0 { 4 } else { 1 };
        let (mut pull, mut turn) = (Vector2::zeros(), 0.0);
        for _ in 0..rounds {
            (pull, turn) = (Vector2::zeros(), 0.0);
            for ((r, d), share) in corners.iter().zip(&against).zip(shares) {
                let force = self.friction * GRAVITY * share * d;
                pull += force;
                turn += r.perp(&force);
            }
            shares = corners.map(|r| self.share(r, axes, pull));
        }
        State::from([s[3], s[4], s[5], pull.x, pull.y, turn / self.gyration_squared()])
    }

    /// Integrates until nothing moves.
    pub(super) fn end(&self) -> End {
        // Longest step in s and share of the time left; the rest that is not integrated.
        const STEP: f64 = 2e-5;
        const SHARE: f64 = 0.02;
        const REST: f64 = 1e-7;
        let motion = |s: &State| s[3].hypot(s[4]) + s[5].abs() * self.radius();
        let mut s = State::from([0.0, 0.0, 0.0, self.speed, 0.0, self.spin]);
        let start = motion(&s);
        let (mut time, mut curve) = (0.0, vec![(0.0, 0.0)]);
        while motion(&s) > REST * start {
            let step = STEP.min(SHARE * motion(&s) / (self.friction * GRAVITY));
            s = runge_kutta(&s, step, |s| self.rate(s));
            time += step;
            if time - curve[curve.len() - 1].0 > 1e-3 {
                curve.push((time, s[0].hypot(s[1])));
            }
        }
        let displacement = Vector2::new(s[0], s[1]);
        curve.push((time, displacement.norm()));
        End { displacement, angle: s[2], time, curve }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slide(speed: f64, spin: f64) -> Slide {
        let half = Vector2::new(0.01, 0.01);
        Slide { half, friction: 0.5, speed, spin, half_height: 0.0 }
    }

    fn near(law: &str, got: f64, expected: f64, share: f64) {
        crate::geometry::testing::near(law, got, expected, share * expected.abs());
    }

    #[test]
    fn without_spin_it_is_the_sliding_block() {
        let end = slide(0.5, 0.0).end();
        let deceleration = 0.5 * GRAVITY;
        near("v²/2μg", end.displacement.x, 0.25 / (2.0 * deceleration), 1e-6);
        near("v/μg", end.time, 0.5 / deceleration, 1e-6);
        assert_eq!((end.displacement.y, end.angle), (0.0, 0.0), "law: straight on");
    }

    #[test]
    fn without_sliding_the_spin_decays_steadily() {
        let slide = slide(0.0, -80.0);
        let end = slide.end();
        // All of the friction acts at half a diagonal R: α = μ g R/k².
        let deceleration = 0.5 * GRAVITY * slide.radius() / slide.gyration_squared();
        near("ω²/2α", -end.angle, 6400.0 / (2.0 * deceleration), 1e-6);
        near("ω/α", end.time, 80.0 / deceleration, 1e-6);
        assert!(end.displacement.norm() < 1e-12, "law: on the spot");
    }

    #[test]
    fn a_spinning_block_slides_further_and_ends_both_at_once() {
        let still = slide(0.5, 0.0).end();
        let mut before = still.displacement.norm();
        for spin in [25.0, 50.0, 100.0, 200.0] {
            let end = slide(0.5, spin).end();
            let distance = end.displacement.norm();
            assert!(distance > before, "law: {spin} rad/s slides further than {before} m");
            // Neither motion alone could last as long with all of the friction.
            assert!(end.time > still.time, "law: friction is shared");
            before = distance;
        }
    }

    /// The work of friction is what the motion had: a check that does not
    /// use the integration's own path.
    #[test]
    fn energy_is_lost_at_no_more_than_the_friction_allows() {
        let slide = slide(0.5, 100.0);
        let end = slide.end();
        let energy = 0.5 * (0.25 + slide.gyration_squared() * 1e4);
        // |Σ μ g/4 |vᵢ|| ≤ μ g (|v| + |ω| R), so that E ≤ μ g (path + R angle).
        let most = 0.5 * GRAVITY * (end.displacement.norm() + slide.radius() * end.angle);
        assert!(energy <= most, "law: energy {energy} is at most {most}");
    }

    #[test]
    fn loads_that_shift_hardly_change_the_distance() {
        for spin in [25.0, 50.0, 100.0, 200.0] {
            let equal = slide(0.5, spin);
            let shifted = Slide { half_height: 0.00025, ..equal };
            let (a, b) = (equal.end().displacement.norm(), shifted.end().displacement.norm());
            near("by some ten-thousandths", b, a, 3e-4);
            assert!(a != b, "law: the loads do shift");
        }
    }

    #[test]
    fn one_size_is_another_in_other_units() {
        // Lengths times 10 and speeds times √10: distances times 10, times times √10.
        let small = slide(0.5, 100.0);
        let root = 10.0_f64.sqrt();
        let large = Slide {
            half: small.half * 10.0,
            speed: small.speed * root,
            spin: small.spin / root,
            ..small
        };
        let (small, large) = (small.end(), large.end());
        near("distance", large.displacement.norm(), 10.0 * small.displacement.norm(), 1e-3);
        near("time", large.time, root * small.time, 1e-3);
        near("angle", large.angle, small.angle, 1e-3);
    }
}
