//! The last part of a search: values near the solution through which a line is
//! fitted, and as many runs of them as it takes.

use super::*;

/// Least half width of a window, in parts of the range.
const LEAST_REACH: f64 = 5e-4;
/// Most windows that are tried for the line.
const MOST_WINDOWS: usize = 8;
/// Most times that a window is sought anew because the solution has left it.
const MOST_MOVES: usize = 3;
/// p-value below which a bend is taken for real.
const LEVEL: f64 = 0.01;
/// How far from the place wanted a value may be that is there already, in
/// parts of the window's half width.
const NEAR: f64 = 0.35;

impl Search<'_> {
    /// Half the width of the window for the line, and whether it may be wider.
    ///
    /// So wide that the line's slope is known to a third, by Fieller's g = t²s²/(n·Sxx·b²) = 0.1
    /// for three values and n configurations; but where the means bend by c·x², not so wide that
    /// the line misses the middle by more than a tenth of the tolerance: 2/3·c·w² for three values.
    /// The slope must stand out of a single run's scatter all the same.
    fn reach(&self, centre: f64) -> (f64, bool) {
        let q = self.question;
        let scatter = self.scatter(&self.kept.usable());
        let n = f64::from(q.realisations);
        let t = t_quantile(0.975, n - 1.0).unwrap_or(12.7);
        let deviations = (t / (0.2 * n).sqrt()).clamp(2.0, 8.0);
        let slope = self.chord_slope(centre, scatter * (2.0 / n).sqrt());
        let of = |deviations: f64| {
            slope.map_or(f64::INFINITY, |slope| deviations * scatter / slope.abs())
        };
        let bend = self.bend(centre).abs();
        let straight = (0.15 * q.tolerance.unwrap_or(scatter) / bend).sqrt();
        let (least, most) = (LEAST_REACH * q.width(), q.width());
        let bounded = straight < of(deviations);
        let reach = if bounded { straight.max(of(1.0)) } else { of(deviations) };
        (if reach.is_nan() { most } else { reach.clamp(least, most) }, !bounded)
    }

    /// How the means bend around a value: by the fewest values there that show
    /// it beyond scatter, or else by all.
    fn bend(&self, centre: f64) -> f64 {
        let mut values = self.kept.usable();
        values.sort_by(|a, b| (a - centre).abs().total_cmp(&(b - centre).abs()));
        let mut last = 0.0;
        for count in 3..=values.len() {
            let mut nearest = values[..count].to_vec();
            nearest.sort_by(f64::total_cmp);
            let Some((bend, p)) = self.kept.bend(&nearest) else { continue };
            last = bend;
            let around = nearest[0] < centre && centre < nearest[count - 1];
            if around && p < LEVEL {
                break;
            }
        }
        last
    }

    /// Slope of the narrowest chord around a value that stands out of the
    /// scatter of differences; none where none does.
    fn chord_slope(&self, centre: f64, error: f64) -> Option<f64> {
        let values = self.kept.usable();
        let mut best: Option<(f64, f64)> = None;
        for low in values.iter().filter(|v| **v <= centre) {
            for high in values.iter().filter(|v| **v >= centre && *v > low) {
                let (Some(a), Some(b)) = (self.off(*low), self.off(*high)) else { continue };
                let width = high - low;
                if (b - a).abs() > 3.0 * error && best.is_none_or(|(w, _)| width < w) {
                    best = Some((width, (b - a) / width));
                }
            }
        }
        best.map(|(_, slope)| slope)
    }

    /// Makes sure of values at the middle and at both sides of a window.
    fn set_window(&mut self, centre: f64, reach: f64) -> Going<()> {
        let q = self.question;
        let (low, high) = q.between;
        let places = [centre - reach, centre, centre + reach].map(|v| v.clamp(low, high));
        let known = self.kept.usable();
        let missing: Vec<f64> = places
            .iter()
            .filter(|place| !known.iter().any(|v| (v - **place).abs() <= NEAR * reach))
            .map(|place| q.rounded(*place))
            .collect();
        self.evaluate(&missing, q.realisations)?;
        let slack = (1.0 + NEAR) * reach;
        self.window = self.kept.usable();
        self.window.retain(|v| (v - centre).abs() <= slack);
        Ok(())
    }

    /// Finds a window in which a line fits, and runs until it is well known. Where more runs move
    /// the solution out of the window, a window is sought where the solution is.
    pub(super) fn local(&mut self, centre: f64) -> Going<Ending> {
        let (mut centre, mut moves) = (centre, MOST_MOVES);
        loop {
            self.find_window(centre)?;
            match self.sharpen(moves > 0)? {
                ControlFlow::Break(ending) => return Ok(ending),
                ControlFlow::Continue(solution) => (centre, moves) = (solution, moves - 1),
            }
        }
    }

    /// How far the usable values beside a value are: the nearest below it, or it, and the nearest
    /// above, the farther of them.
    fn to_neighbours(&self, centre: f64) -> f64 {
        let usable = self.kept.usable();
        let below = usable.iter().rfind(|v| **v <= centre);
        let above = usable.iter().find(|v| **v > centre);
        below.into_iter().chain(above).map(|v| (v - centre).abs()).fold(0.0, f64::max)
    }

    /// Finds a window in which a line fits.
    fn find_window(&mut self, centre: f64) -> Going<()> {
        self.settled = false;
        let q = self.question;
        let (low, high) = q.between;
        let mut centre = centre.clamp(low, high);
        let (mut reach, mut may_widen) = self.reach(centre);
        for _ in 0..MOST_WINDOWS {
            self.set_window(centre, reach)?;
            let whole = centre - reach <= low && centre + reach >= high;
            let fit = self.kept.fit(&self.window, q.wanted);
            let Some(fit) = fit.filter(|f| f.interval.is_some()) else {
                // One value tells nothing of a slope, however the response bends.
                let is_short = self.window.len() < 2;
                if whole || !(may_widen || is_short) {
                    break;
                }
                let least = if is_short { self.to_neighbours(centre) } else { 0.0 };
                reach = (2.0 * reach).max(least).min(q.width());
                continue;
            };
            let next = fit.x.clamp(low, high);
            let moved = (next - centre).abs() > 0.5 * reach;
            // What was learnt since may ask for a narrower window.
            let (again, widen) = self.reach(next);
            let narrower = again < 0.7 * reach;
            if !moved && !narrower {
                break;
            }
            centre = next;
            if narrower {
                (reach, may_widen) = (again, widen);
            }
        }
        self.settled = true;
        Ok(())
    }

    /// Where in the range a line through the window's values has the wanted result, if that is
    /// beyond all of them: there it was not compared with anything. Of a solution outside the range
    /// nothing is known but that it lies beyond the last value that can be used.
    pub(super) fn beyond_window(&self, fit: &InversePrediction) -> Option<f64> {
        let (low, high) = self.question.between;
        let mut solution = self.question.rounded(fit.x);
        if !(low..=high).contains(&fit.x) {
            let usable = self.kept.usable();
            solution = solution.clamp(*usable.first()?, *usable.last()?);
        }
        let (first, last) = (self.window.first()?, self.window.last()?);
        (solution < *first || solution > *last).then_some(solution)
    }

    /// How well the result is to be known.
    pub(super) fn tolerance(&self) -> f64 {
        let means: Vec<f64> =
            self.kept.usable().iter().filter_map(|v| self.kept.mean(*v)).collect();
        let span = means.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - means.iter().copied().fold(f64::INFINITY, f64::min);
        let scatter = self.scatter(&self.window);
        // Without scatter, a thousandth of what the range moves.
        self.question.tolerance.unwrap_or(scatter.max(1e-3 * span.max(0.0)))
    }

    /// Configurations with which a mean is known as well as asked, if what scatters belongs to
    /// configurations and not to single runs, which is the worst. It looks at no more than the
    /// scatter, so that a line that came out narrow by chance does not end the search.
    fn configurations_needed(&self) -> u32 {
        let scatter = self.scatter(&self.kept.usable());
        let least = self.question.realisations;
        let enough = |n: u32| {
            let t = t_quantile(0.975, f64::from(n) - 1.0).unwrap_or(f64::INFINITY);
            t * scatter / f64::from(n).sqrt() <= self.tolerance()
        };
        (least..4 * least).find(|n| enough(*n)).unwrap_or(4 * least)
    }

    /// Adds configurations to the window's values until the interval is narrow enough; or, where the
    /// window may move, until the solution lies beyond its values, and gives it.
    fn sharpen(&mut self, may_move: bool) -> Going<ControlFlow<Ending, f64>> {
        let mut doubled = 0;
        let needed = self.configurations_needed();
        loop {
            let fit = self.kept.fit(&self.window, self.question.wanted);
            let size = fit.and_then(|f| in_result(&f));
            let tolerance = self.tolerance();
            let now = self.window.iter().map(|v| self.kept.tried(*v)).max().unwrap_or(0);
            let known = fit.filter(|_| size.is_some());
            let beyond = known.and_then(|f| self.beyond_window(&f));
            if let Some(solution) = beyond.filter(|_| may_move) {
                return Ok(ControlFlow::Continue(solution));
            }
            let narrow = size.is_some_and(|s| s <= tolerance) && beyond.is_none();
            if now >= needed && narrow {
                return Ok(ControlFlow::Break(self.found()));
            }
            // Fewer than two values: more runs there tell nothing of a slope.
            let hopeless = size.is_none() && doubled >= 2 || self.window.len() < 2;
            doubled += u32::from(size.is_none());
            if hopeless {
                return Ok(ControlFlow::Break(Ending::Flat));
            }
            let more = size.map_or(2.0, |s| (s / tolerance).powi(2)).clamp(1.0, 4.0);
            let more = (f64::from(now) * more).ceil() as u32;
            let affordable = (self.left() / self.window.len()) as u32;
            let next = more.max(needed).max(now + 1).min(now + affordable);
            if next == now {
                return Err(Halt::RunsUsedUp);
            }
            let window = self.window.clone();
            self.evaluate(&window, next)?;
        }
    }

    /// Found, unless it lies outside of what was asked.
    pub(super) fn found(&self) -> Ending {
        let (low, high) = self.question.between;
        let fit = self.kept.fit(&self.window, self.question.wanted);
        match fit {
            Some(fit) if fit.x >= low && fit.x <= high => Ending::Found,
            _ => Ending::OutOfReach,
        }
    }
}

/// Half of a line's interval for the unknown, its larger side, in units of the result.
pub(super) fn in_result(fit: &InversePrediction) -> Option<f64> {
    let (low, high) = fit.interval?;
    Some((fit.x - low).max(high - fit.x) * fit.slope.abs())
}
