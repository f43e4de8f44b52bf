//! Conditions that end a stage: what is watched, and when it holds.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Setup;
use crate::geometry::Vector;
use crate::scenario::{OpeningSpec, UntilSpec};
use crate::specimen::Opening;
use crate::units::{from_g, from_mm, to_g, to_mm};

/// What ends a stage.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ending {
    /// What is watched.
    pub subject: Subject,
    /// What has to hold of it.
    pub condition: Condition,
    /// Length of the window in s over which means are taken.
    pub window: f64,
}

/// What is watched.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Subject {
    /// Force of the grains on pieces, by number, along a unit vector.
    Force(Vec<usize>, Vector),
    /// Displacement of pieces since the stage began, along a unit vector or in every direction.
    Way(Vec<usize>, Option<Vector>),
    /// Flow through an opening.
    Flow(Opening),
}

/// What has to hold, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Condition {
    /// It is as large as this.
    Reaches(f64),
    /// It is smaller than this, and was not before.
    FallsBelow(f64),
    /// It changed by no more than this share of itself from one window to the next.
    Steady(f64),
}

/// What was seen of a condition so far.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// Impulse in N s or mass in kg of each time between two looks, the last two windows of them.
    pub amounts: Vec<f64>,
    /// Whether the flow was as large as what it is to fall below.
    pub was_above: bool,
    /// What was found last: force in N, way in m, flow in kg/s, or a relative change.
    pub last: Option<f64>,
    /// When the condition held, in s since the stage began.
    pub reached_s: Option<f64>,
}

/// What came of the condition that was to end a stage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UntilFound {
    /// Whether it held, so that it ended the stage; otherwise a limit of time did, or everything
    /// had settled.
    pub reached: bool,
    /// When it held, in s since the stage began; null where it did not.
    pub at_s: Option<f64>,
    /// Force found then, or last, in N.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_n: Option<f64>,
    /// Displacement, likewise, in mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moved_mm: Option<f64>,
    /// Flow, likewise, in g/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_g_per_s: Option<f64>,
    /// Change from window to window, likewise, in percent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change_percent: Option<f64>,
}

/// An opening as a scenario has it.
pub fn opening(spec: &OpeningSpec) -> Opening {
    Opening {
        middle: Vector::from(spec.at_mm.map(from_mm)),
        radius: from_mm(spec.diameter_mm) / 2.0,
        direction: Vector::from(spec.direction).normalize(),
    }
}

impl Ending {
    /// By what a scenario says; none where that makes no condition, which its checks refuse.
    pub(super) fn of(until: &UntilSpec, setup: &Setup) -> Option<Self> {
        let direction = until.direction.map(|to| Vector::from(to).normalize());
        let pieces = || {
            let name = until.piece.as_ref()?;
            let group = setup.measures.groups.iter().find(|group| group.name == *name);
            let names = group.map_or(std::slice::from_ref(name), |group| &group.pieces);
            let number = |name: &String| setup.pieces.iter().position(|p| p.name == *name);
            names.iter().map(number).collect::<Option<Vec<usize>>>()
        };
        let force = || Some(Subject::Force(pieces()?, direction?));
        let flow = || {
            let name = until.opening.as_ref()?;
            let spec = setup.measures.openings.iter().find(|o| o.name == *name)?;
            Some(Subject::Flow(opening(spec)))
        };
        let (subject, condition) = match *until {
            UntilSpec { force_n: Some(n), .. } => (force()?, Condition::Reaches(n)),
            UntilSpec { steady_force_percent: Some(p), .. } => {
                (force()?, Condition::Steady(p / 100.0))
            }
            UntilSpec { moved_mm: Some(mm), .. } => {
                (Subject::Way(pieces()?, direction), Condition::Reaches(from_mm(mm)))
            }
            UntilSpec { flow_below_g_per_s: Some(rate), .. } => {
                (flow()?, Condition::FallsBelow(from_g(rate)))
            }
            UntilSpec { steady_flow_percent: Some(p), .. } => {
                (flow()?, Condition::Steady(p / 100.0))
            }
            _ => return None,
        };
        Some(Self { subject, condition, window: until.window() })
    }

    /// What is reported of it.
    pub(super) fn found(&self, judged: &Judged) -> UntilFound {
        let none = UntilFound {
            reached: judged.reached_s.is_some(),
            at_s: judged.reached_s,
            force_n: None,
            moved_mm: None,
            flow_g_per_s: None,
            change_percent: None,
        };
        let last = judged.last;
        match (&self.subject, self.condition) {
            (_, Condition::Steady(_)) => {
                UntilFound { change_percent: last.map(|share| 100.0 * share), ..none }
            }
            (Subject::Force(..), _) => UntilFound { force_n: last, ..none },
            (Subject::Way(..), _) => UntilFound { moved_mm: last.map(to_mm), ..none },
            (Subject::Flow(_), _) => UntilFound { flow_g_per_s: last.map(to_g), ..none },
        }
    }
}

impl UntilFound {
    /// What was found, with its unit, for a reader.
    pub fn line(&self) -> String {
        let found = match *self {
            Self { force_n: Some(n), .. } => format!("a force of {n:.3} N"),
            Self { moved_mm: Some(mm), .. } => format!("{mm:.3} mm moved"),
            Self { flow_g_per_s: Some(rate), .. } => format!("a flow of {rate:.2} g/s"),
            Self { change_percent: Some(p), .. } => format!("a change of {p:.2} %"),
            _ => "nothing to tell".to_owned(),
        };
        match self.at_s {
            Some(at) => format!("`until` held after {at:.3} s: {found}"),
            None => format!("`until` was not reached: {found} at the end"),
        }
    }
}

impl Judged {
    /// Whether nothing was seen.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Takes what was found at a look: a way in m, or the impulse in N s or mass in kg since the
    /// look before, `every` seconds ago. Whether the condition holds.
    pub(super) fn look(&mut self, ending: &Ending, found: f64, every: f64) -> bool {
        let now = match ending.subject {
            Subject::Way(..) => Some(found),
            Subject::Force(..) | Subject::Flow(_) => {
                let window = ((ending.window / every).round() as usize).max(1);
                self.amounts.push(found);
                let surplus = self.amounts.len().saturating_sub(2 * window);
                self.amounts.drain(..surplus);
                let mean = |end: usize| {
                    let amounts = self.amounts.get(end.checked_sub(window)?..end)?;
                    Some(amounts.iter().sum::<f64>() / (window as f64 * every))
                };
                let count = self.amounts.len();
                let last = mean(count);
                match ending.condition {
                    Condition::Steady(_) => {
                        let before = count.checked_sub(window).and_then(mean);
                        let change = last.zip(before).map(|(b, a)| ((b - a) / b).abs());
                        // Of nothing there is no change to tell.
                        change.filter(|change| change.is_finite())
                    }
                    Condition::Reaches(_) | Condition::FallsBelow(_) => last,
                }
            }
        };
        self.last = now;
        let Some(now) = now else { return false };
        match ending.condition {
            Condition::Reaches(wanted) => now >= wanted,
            Condition::Steady(share) => now <= share,
            Condition::FallsBelow(limit) => {
                let is_above = now >= limit;
                self.was_above = self.was_above || is_above;
                self.was_above && !is_above
            }
        }
    }

    /// Whether a stage can go on from it.
    pub(super) fn check(&self) -> Result<(), String> {
        let numbers = self.amounts.iter().chain(&self.last).chain(&self.reached_s);
        match numbers.into_iter().all(|x| x.is_finite()) {
            true => Ok(()),
            false => Err("`judged` holds what is no number".to_owned()),
        }
    }
}
