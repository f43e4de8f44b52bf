//! The search for a value at which a scattering result is as wanted.
//!
//! First the whole range is looked at, at a few values. Where the means pass the wanted result, a
//! root search on the means (`root`) closes in until the mean is as close as a single run scatters;
//! nearer it would follow chance. Then a line is fitted to values on either side, far enough apart
//! that the slope stands out of the scatter and close enough that the line is straight, and runs
//! are added until the interval is as narrow as asked.

use super::*;

#[derive(Debug, Clone)]
pub(super) struct Answer {
    pub ending: Ending,
    /// The last line.
    pub fit: Option<InversePrediction>,
    /// The values it was fitted to.
    pub fitted: Vec<f64>,
    /// The tolerance that intervals are compared with.
    pub tolerance: Option<f64>,
    /// Standard deviation of a single run.
    pub scatter: Option<f64>,
    pub notes: Vec<String>,
    pub kept: Kept,
}

/// Most steps of the root search: those that close the range in to the width below.
const MOST_STEPS: u32 = 10;

/// Width of the range at which the root search ends, as a share of the question's.
const NARROW: f64 = 1e-3;

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
        let Some(bracket) = self.crossing_within(self.question.between) else {
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
        self.evaluate(&values, q.realisations)
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

    /// Of several between two values, the one whose ends are farthest from the wanted result:
    /// chance makes crossings of small means.
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
            self.evaluate(&beside, self.question.realisations)?;
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

    /// The root search on the means.
    fn close_in(&mut self, (low, high): (f64, f64)) -> Going<()> {
        let width = NARROW * self.question.width();
        match root::narrow((low, high), width, MOST_STEPS, |value| self.off_or_close(value)) {
            Ok(_) | Err(None) => Ok(()),
            Err(Some(halt)) => Err(halt),
        }
    }

    /// Mean result less the wanted one of a value, which is run; 0 where it is closer than
    /// a single run scatters, for its sign is chance there. A value without a result ends the
    /// search without a fault: what is known then is enough to go on.
    fn off_or_close(&mut self, value: f64) -> Result<f64, Option<Halt>> {
        let value = self.question.rounded(value);
        self.evaluate(&[value], self.question.realisations).map_err(Some)?;
        let usable = self.kept.usable();
        let off = self.off(value).filter(|_| usable.contains(&value)).ok_or(None)?;
        let close = self.scatter(&usable).max(self.question.tolerance.unwrap_or(0.0));
        Ok(if off.abs() <= close { 0.0 } else { off })
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
            // No value near its solution says whether the line holds there.
            Some(fit) if self.beyond_window(&fit).is_some() => {
                let line: Vec<String> = self.window.iter().map(f64::to_string).collect();
                self.window = Vec::new();
                self.notes.push(format!(
                    "the line through the values {} has the wanted result at {}, beyond all of \
                     them: it is no solution; the runs were used up before a line could be fitted \
                     there",
                    line.join(", "),
                    compact(fit.x)
                ));
                Ending::RunsUsedUp
            }
            Some(fit) if in_result(&fit).is_some_and(|s| s <= self.tolerance()) => self.found(),
            Some(_) => Ending::RunsUsedUp,
            // A line through values that were not found fit for one says
            // nothing: where the result is passed is all that is known.
            None => {
                self.window = Vec::new();
                let crossing = self.crossing_within(self.question.between);
                let place = match (crossing, self.touching()) {
                    (Some((low, high)), _) => {
                        format!("the wanted result is passed between {low} and {high}")
                    }
                    (None, Some(value)) => format!("the mean at {value} may be the wanted result"),
                    (None, None) => return Ending::OutOfReach,
                };
                self.notes.push(format!(
                    "{place}; the runs were used up before a line could be fitted there"
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
