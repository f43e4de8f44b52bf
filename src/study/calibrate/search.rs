//! The search for a value at which a scattering result is as wanted.
//!
//! First the whole range is looked at, at a few values. Where the means pass
//! the wanted result, Brent's method on the means closes in until the mean is
//! as close as a single run scatters; nearer it would follow chance. Then a
//! line is fitted to values on either side, far enough apart that the slope
//! stands out of the scatter and close enough that the line is straight, and
//! runs are added until the interval is as narrow as asked.

use std::{cell::RefCell, ops::Range};

use argmin::{
    core::{CostFunction, Error as Stopped, Executor},
    solver::brent::BrentRoot,
};

use super::{super::StudyError, kept::Kept};
use crate::measure::{InversePrediction, inference::t_quantile};
use crate::report::{CalibrationEnding as Ending, CalibrationRun};

/// What is asked.
#[derive(Debug, Clone)]
pub(super) struct Question {
    /// The result that is wanted.
    pub wanted: f64,
    /// Between which values of the unknown.
    pub between: (f64, f64),
    /// Runs at least a value.
    pub replicates: u32,
    /// How well the result is to be known: half of the interval, in the
    /// result's unit. `None` for the scatter of a single run.
    pub tolerance: Option<f64>,
    /// Most runs altogether.
    pub most_runs: usize,
    /// Whether the unknown takes whole numbers only.
    pub whole: bool,
    /// A value to try in any case.
    pub also: Option<f64>,
}

impl Question {
    fn width(&self) -> f64 {
        self.between.1 - self.between.0
    }

    /// A value with no more digits than the range can use: one part in ten
    /// thousand of it, or whole; the ends are as given.
    pub(super) fn rounded(&self, value: f64) -> f64 {
        let (low, high) = self.between;
        let power = if self.whole { 0 } else { self.width().log10().floor() as i32 - 4 };
        let rounded = if power < 0 {
            let decimals = power.unsigned_abs() as usize;
            format!("{value:.decimals$}").parse().unwrap_or(value)
        } else {
            let step = 10f64.powi(power);
            (value / step).round() * step
        };
        if rounded <= low {
            low
        } else if rounded >= high {
            high
        } else {
            rounded
        }
    }
}

/// Carries out values in a range of configurations, counted from 0.
pub(super) type Experiment<'a> =
    &'a mut dyn FnMut(&[f64], Range<u32>) -> Result<Vec<CalibrationRun>, StudyError>;

/// What was found.
#[derive(Debug, Clone)]
pub(super) struct Answer {
    pub ending: Ending,
    /// The last line.
    pub fit: Option<InversePrediction>,
    /// The values it was fitted to.
    pub fitted: Vec<f64>,
    /// The tolerance held against.
    pub tolerance: Option<f64>,
    /// Standard deviation of a single run.
    pub scatter: Option<f64>,
    pub notes: Vec<String>,
    pub kept: Kept,
}

/// Why a search goes no further.
enum Halt {
    RunsUsedUp,
    Error(StudyError),
}

type Going<T> = Result<T, Halt>;

struct Search<'a> {
    question: &'a Question,
    experiment: Experiment<'a>,
    kept: Kept,
    /// Values of the line.
    window: Vec<f64>,
    /// Whether the window was found fit for a line.
    settled: bool,
    notes: Vec<String>,
}

/// Most steps of Brent's method; each halves the range at least every other time.
const MOST_STEPS: u64 = 10;
/// Least half width of a window, in parts of the range.
const LEAST_REACH: f64 = 5e-4;
/// Most windows that are tried for the line.
const MOST_WINDOWS: usize = 8;
/// p-value below which a bend is taken for real.
const LEVEL: f64 = 0.05;
/// How far from the place wanted a value may be that is there already, in
/// parts of the window's half width.
const NEAR: f64 = 0.35;

/// Searches.
///
/// # Errors
/// Those of the experiment.
pub(super) fn search(question: &Question, experiment: Experiment) -> Result<Answer, StudyError> {
    let mut search = Search {
        question,
        experiment,
        kept: Kept::default(),
        window: Vec::new(),
        settled: false,
        notes: Vec::new(),
    };
    let ending = match search.carry_out() {
        Ok(ending) => ending,
        Err(Halt::RunsUsedUp) => search.end_early(),
        Err(Halt::Error(error)) => return Err(error),
    };
    Ok(search.answer(ending))
}

impl Search<'_> {
    fn carry_out(&mut self) -> Going<Ending> {
        self.first_look()?;
        if self.kept.usable().len() < 2 {
            return Ok(Ending::Failed);
        }
        if self.crossings().is_empty() {
            self.look_beside_the_nearest()?;
        }
        let Some(bracket) = self.crossing() else {
            return match self.touching() {
                Some(value) => self.local(value),
                None => Ok(Ending::OutOfReach),
            };
        };
        self.close_in(bracket)?;
        let near = self.crossing_within(bracket);
        let centre = near.map_or(bracket.0, |pair| self.between_by_chord(pair));
        self.local(centre)
    }

    /// Carries out what is missing of values up to a number of configurations.
    fn evaluate(&mut self, values: &[f64], configurations: u32) -> Going<()> {
        let mut missing: Vec<(u32, Vec<f64>)> = Vec::new();
        for &value in values {
            let from = self.kept.tried(value);
            if from >= configurations {
                continue;
            }
            match missing.iter_mut().find(|(known, _)| *known == from) {
                Some((_, together)) if !together.contains(&value) => together.push(value),
                Some(_) => {}
                None => missing.push((from, vec![value])),
            }
        }
        let runs: usize =
            missing.iter().map(|(from, v)| (configurations - from) as usize * v.len()).sum();
        if runs > self.left() {
            return Err(Halt::RunsUsedUp);
        }
        for (from, values) in missing {
            let runs = (self.experiment)(&values, from..configurations).map_err(Halt::Error)?;
            self.kept.runs.extend(runs);
        }
        Ok(())
    }

    fn left(&self) -> usize {
        self.question.most_runs.saturating_sub(self.kept.runs.len())
    }

    /// Both ends, thirds between, and the value to try in any case.
    fn first_look(&mut self) -> Going<()> {
        let q = self.question;
        let (low, high) = q.between;
        let also = q.also.map(|v| q.rounded(v)).filter(|v| *v > low && *v < high);
        let apart = |v: &f64| also.is_none_or(|a| (a - v).abs() > 0.1 * q.width());
        let thirds = [low + q.width() / 3.0, high - q.width() / 3.0].map(|v| q.rounded(v));
        let mut values: Vec<f64> =
            thirds.into_iter().filter(apart).chain([low, high]).chain(also).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        self.evaluate(&values, q.replicates)
    }

    /// Mean result less the wanted one.
    fn off(&self, value: f64) -> Option<f64> {
        self.kept.mean(value).map(|mean| mean - self.question.wanted)
    }

    /// Neighbouring usable values between which the means pass the wanted result.
    fn crossings(&self) -> Vec<(f64, f64)> {
        let off: Vec<(f64, f64)> =
            self.kept.usable().into_iter().filter_map(|v| Some((v, self.off(v)?))).collect();
        off.windows(2)
            .filter(|w| w[0].1 * w[1].1 < 0.0 || (w[0].1 == 0.0) != (w[1].1 == 0.0))
            .map(|w| (w[0].0, w[1].0))
            .collect()
    }

    /// Of several, the one whose ends are farthest from the wanted result:
    /// chance makes crossings of small means.
    fn crossing(&self) -> Option<(f64, f64)> {
        self.crossing_within(self.question.between)
    }

    /// The same, of those between two values.
    fn crossing_within(&self, (low, high): (f64, f64)) -> Option<(f64, f64)> {
        let size = |v: f64| self.off(v).map_or(0.0, f64::abs);
        let inside = |pair: &(f64, f64)| low <= pair.0 && pair.1 <= high;
        self.crossings().into_iter().filter(inside).max_by(|a, b| {
            let least = |pair: &(f64, f64)| size(pair.0).max(size(pair.1));
            least(a).total_cmp(&least(b))
        })
    }

    /// Where the straight line between two means has the wanted result.
    fn between_by_chord(&self, (low, high): (f64, f64)) -> f64 {
        match (self.off(low), self.off(high)) {
            (Some(a), Some(b)) if a != b => low + (high - low) * a / (a - b),
            _ => f64::midpoint(low, high),
        }
    }

    fn nearest(&self) -> Option<f64> {
        let size = |v: &f64| self.off(*v).map_or(f64::INFINITY, f64::abs);
        self.kept.usable().into_iter().min_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// No crossing was seen: where the nearest result lies inside the range, a
    /// crest may hide on either side of it.
    fn look_beside_the_nearest(&mut self) -> Going<()> {
        for _ in 0..2 {
            let (Some(nearest), values) = (self.nearest(), self.kept.usable()) else { break };
            let Some(at) = values.iter().position(|v| *v == nearest) else { break };
            if at == 0 || at + 1 == values.len() {
                break;
            }
            let beside = [values[at - 1], values[at + 1]]
                .map(|v| self.question.rounded(f64::midpoint(v, nearest)));
            self.evaluate(&beside, self.question.replicates)?;
            if !self.crossings().is_empty() {
                break;
            }
        }
        Ok(())
    }

    /// A value whose mean cannot be told from the wanted result.
    fn touching(&self) -> Option<f64> {
        let nearest = self.nearest()?;
        let table = self.kept.table(&[]);
        let row = table.iter().find(|row| row.value == nearest)?;
        (self.off(nearest)?.abs() <= row.half_width_95?).then_some(nearest)
    }

    /// Scatter of a single run, over all usable values.
    fn scatter(&self, values: &[f64]) -> f64 {
        self.kept.scatter(values).map_or(0.0, |s| s.deviation)
    }

    /// Brent's method on the means.
    fn close_in(&mut self, (low, high): (f64, f64)) -> Going<()> {
        let q = self.question;
        let solver = BrentRoot::new(low, high, 1e-3 * q.width());
        let held = RefCell::new((&mut *self, None));
        let run = Executor::new(Means { search: &held }, solver)
            .configure(|state| state.max_iters(MOST_STEPS))
            .run();
        // A step without a result ends it; what is known then is enough to go on.
        drop(run);
        match held.into_inner().1 {
            Some(halt) => Err(halt),
            None => Ok(()),
        }
    }

    /// Half the width of the window for the line, and whether it may be wider.
    ///
    /// So wide that the line's slope is known to a third, by Fieller's
    /// g = t²s²/(n·Sxx·b²) = 0.1 for three values and n configurations; but
    /// where the means bend by c·x², not so wide that the line misses the middle
    /// by more than a tenth of the tolerance: 2/3·c·w² for three values. The
    /// slope must stand out of a single run's scatter all the same.
    fn reach(&self, centre: f64) -> (f64, bool) {
        let q = self.question;
        let scatter = self.scatter(&self.kept.usable());
        let n = f64::from(q.replicates);
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
    /// scatter of differences, or else of the widest.
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
        self.evaluate(&missing, q.replicates)?;
        let slack = (1.0 + NEAR) * reach;
        self.window = self.kept.usable();
        self.window.retain(|v| (v - centre).abs() <= slack);
        Ok(())
    }

    /// Finds a window in which a line fits, and runs until it is well known.
    fn local(&mut self, centre: f64) -> Going<Ending> {
        let q = self.question;
        let (low, high) = q.between;
        let mut centre = centre.clamp(low, high);
        let (mut reach, mut may_widen) = self.reach(centre);
        for _ in 0..MOST_WINDOWS {
            self.set_window(centre, reach)?;
            let whole = centre - reach <= low && centre + reach >= high;
            let fit = self.kept.fit(&self.window, q.wanted);
            let Some(fit) = fit.filter(|f| f.interval.is_some()) else {
                if whole || !may_widen {
                    break;
                }
                reach = (2.0 * reach).min(q.width());
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
        self.sharpen()
    }

    /// How well the result is to be known.
    fn tolerance(&self) -> f64 {
        let means: Vec<f64> =
            self.kept.usable().iter().filter_map(|v| self.kept.mean(*v)).collect();
        let span = means.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - means.iter().copied().fold(f64::INFINITY, f64::min);
        let scatter = self.scatter(&self.window);
        // Without scatter, a thousandth of what the range moves.
        self.question.tolerance.unwrap_or(scatter.max(1e-3 * span.max(0.0)))
    }

    /// Configurations with which a mean is known as well as asked, if what
    /// scatters belongs to configurations and not to single runs, which is the
    /// worst. It looks at no more than the scatter, so that a line that came out
    /// narrow by chance does not end the search.
    fn configurations_needed(&self) -> u32 {
        let scatter = self.scatter(&self.kept.usable());
        let least = self.question.replicates;
        let enough = |n: u32| {
            let t = t_quantile(0.975, f64::from(n) - 1.0).unwrap_or(f64::INFINITY);
            t * scatter / f64::from(n).sqrt() <= self.tolerance()
        };
        (least..4 * least).find(|n| enough(*n)).unwrap_or(4 * least)
    }

    /// Adds configurations to the window's values until the interval is
    /// narrow enough.
    fn sharpen(&mut self) -> Going<Ending> {
        let mut doubled = 0;
        let needed = self.configurations_needed();
        loop {
            let fit = self.kept.fit(&self.window, self.question.wanted);
            let size = fit.and_then(|f| in_result(&f));
            let tolerance = self.tolerance();
            let now = self.window.iter().map(|v| self.kept.tried(*v)).max().unwrap_or(0);
            if now >= needed && size.is_some_and(|s| s <= tolerance) {
                return Ok(self.found());
            }
            // Fewer than two values: more runs there tell nothing of a slope.
            let hopeless = size.is_none() && doubled >= 2 || self.window.len() < 2;
            doubled += u32::from(size.is_none());
            if hopeless {
                return Ok(Ending::Flat);
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
    fn found(&self) -> Ending {
        let (low, high) = self.question.between;
        let fit = self.kept.fit(&self.window, self.question.wanted);
        match fit {
            Some(fit) if fit.x >= low && fit.x <= high => Ending::Found,
            _ => Ending::OutOfReach,
        }
    }

    /// What the runs so far amount to, where no more are allowed.
    fn end_early(&mut self) -> Ending {
        if self.kept.usable().len() < 2 {
            return Ending::Failed;
        }
        let fit = self.kept.fit(&self.window, self.question.wanted);
        match fit.filter(|_| self.settled) {
            Some(fit) if fit.interval.is_none() && self.kept.differences().is_empty() => {
                Ending::Flat
            }
            Some(fit) if in_result(&fit).is_some_and(|s| s <= self.tolerance()) => self.found(),
            Some(_) => Ending::RunsUsedUp,
            // A line through values that were not found fit for one says
            // nothing: where the result is passed is all that is known.
            None => {
                self.window = Vec::new();
                let Some((low, high)) = self.crossing() else { return Ending::OutOfReach };
                self.notes.push(format!(
                    "the wanted result is passed between {low} and {high}; the runs were used up \
                     before a line could be fitted there"
                ));
                Ending::RunsUsedUp
            }
        }
    }

    fn answer(mut self, ending: Ending) -> Answer {
        let crossings = self.crossings();
        // Means that chance made pass do not count.
        let beyond = |v: f64| {
            let rows = self.kept.table(&[]);
            let half = rows.iter().find(|r| r.value == v).and_then(|r| r.half_width_95);
            self.off(v).zip(half).is_some_and(|(off, half)| off.abs() > half)
        };
        let sure: Vec<&(f64, f64)> =
            crossings.iter().filter(|(a, b)| beyond(*a) && beyond(*b)).collect();
        if sure.len() > 1 {
            let places: Vec<String> = sure.iter().map(|(a, b)| format!("{a} and {b}")).collect();
            self.notes.push(format!(
                "the wanted result is passed more than once, between {}: there are several solutions",
                places.join(", between ")
            ));
        }
        let fit = match ending {
            Ending::Failed => None,
            _ => self.kept.fit(&self.window, self.question.wanted),
        };
        let scatter = self.kept.scatter(&self.kept.usable()).map(|s| s.deviation);
        Answer {
            tolerance: fit.is_some().then(|| self.tolerance()),
            fit,
            ending,
            fitted: self.window,
            scatter,
            notes: self.notes,
            kept: self.kept,
        }
    }
}

/// Half of a line's interval for the unknown, its larger side, in units of the result.
pub(super) fn in_result(fit: &InversePrediction) -> Option<f64> {
    let (low, high) = fit.interval?;
    Some((fit.x - low).max(high - fit.x) * fit.slope.abs())
}

/// The means as a function whose root is sought.
struct Means<'a, 'b, 'c> {
    search: &'a RefCell<(&'b mut Search<'c>, Option<Halt>)>,
}

impl CostFunction for Means<'_, '_, '_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, value: &f64) -> Result<f64, Stopped> {
        let mut held = self.search.borrow_mut();
        let (search, halted) = &mut *held;
        let value = search.question.rounded(*value);
        if let Err(halt) = search.evaluate(&[value], search.question.replicates) {
            *halted = Some(halt);
            return Err(Stopped::msg("stopped"));
        }
        let usable = search.kept.usable();
        let off = search.off(value).filter(|_| usable.contains(&value));
        let off = off.ok_or_else(|| Stopped::msg("too few runs of the value have results"))?;
        // Closer than a single run scatters the sign is chance.
        let close = search.scatter(&usable).max(search.question.tolerance.unwrap_or(0.0));
        Ok(if off.abs() <= close { 0.0 } else { off })
    }
}
