//! Conditions that end a stage: what is watched, and when it holds.

use super::*;
use crate::plain::four_digits;
use crate::scenario::{ConditionSpec, OpeningSpec, UntilSpec};
use crate::specimen::Opening;
use crate::units::{from_deg, to_g, to_mm};

/// What ends a stage: conditions, of which one or all have to hold.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Endings {
    pub rule: Rule,
    pub each: Vec<Ending>,
}

/// How many of several conditions have to hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rule {
    Single,
    Any,
    /// All, at the same look.
    All,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ending {
    /// What it is called: the field and the piece, group or opening.
    pub name: String,
    pub subject: Subject,
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
    Displacement(Vec<usize>, Option<Vector>),
    /// Angle by which pieces have turned since the stage began, in the mean.
    Turn(Vec<usize>),
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

/// What was seen of a condition so far. Of several conditions `each` has what was seen of every
/// one, and `reached_s` says when they ended the stage.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// Impulse in N s or mass in kg of each time between two looks, the last two windows of them.
    pub amounts: Vec<f64>,
    /// Whether the flow was as large as what it is to fall below.
    pub was_above: bool,
    /// What was found last: force in N, displacement in m, angle in rad, flow in kg/s, or a
    /// relative change.
    pub last: Option<f64>,
    /// When the condition held, in s since the stage began; of one of several, whether it held at
    /// the last look, and when that was.
    pub reached_s: Option<f64>,
    /// What was seen of each of several conditions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub each: Vec<Judged>,
}

/// What came of the condition, or the conditions, that were to end a stage.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UntilFound {
    /// Whether it held, so that it ended the stage; otherwise a limit of time did, or everything
    /// had settled.
    pub reached: bool,
    /// When it held, in s since the stage began; null where it did not.
    pub at_s: Option<f64>,
    /// What was found then, or last, of one condition.
    #[serde(flatten)]
    pub found: Found,
    /// Of several conditions, each of them: whether it held at the last look, and what was found
    /// last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conditions: Vec<ConditionFound>,
    /// Of several conditions, whether all had to hold at the same time, and not any one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub all_of: bool,
}

/// What was found of a condition: the one number that it is about.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Found {
    /// Force in N.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_n: Option<f64>,
    /// Displacement in mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moved_mm: Option<f64>,
    /// Angle turned in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turned_deg: Option<f64>,
    /// Flow in g/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_g_per_s: Option<f64>,
    /// Change from window to window in percent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change_percent: Option<f64>,
}

/// What came of one of several conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConditionFound {
    /// Which: the field and the piece, group or opening.
    pub condition: String,
    /// Whether it held at the last look.
    pub reached: bool,
    /// When that was, in s since the stage began; null where it did not hold.
    pub at_s: Option<f64>,
    /// What was found last.
    #[serde(flatten)]
    pub found: Found,
}

/// An opening as a scenario has it.
pub fn opening(spec: &OpeningSpec) -> Opening {
    Opening {
        middle: Vector::from(spec.at_mm.map(from_mm)),
        radius: from_mm(spec.diameter_mm) / 2.0,
        direction: Vector::from(spec.direction).normalize(),
    }
}

impl Endings {
    /// By what a scenario says; none where that makes no condition, which its checks refuse.
    pub(super) fn of(until: &UntilSpec, setup: &Setup) -> Option<Self> {
        let rule = match until {
            UntilSpec::One(_) => Rule::Single,
            UntilSpec::Any(_) => Rule::Any,
            UntilSpec::All(_) => Rule::All,
        };
        let each: Option<Vec<Ending>> =
            until.conditions().iter().map(|one| Ending::of(one, setup)).collect();
        each.filter(|each| !each.is_empty()).map(|each| Self { rule, each })
    }

    pub(super) fn found(&self, judged: &Judged) -> UntilFound {
        let at_s = judged.reached_s;
        let whole = UntilFound { reached: at_s.is_some(), at_s, ..UntilFound::default() };
        if self.rule == Rule::Single {
            return UntilFound { found: self.each[0].found(judged.last), ..whole };
        }
        let of = |(k, ending): (usize, &Ending)| {
            let judged = judged.each.get(k);
            let at_s = judged.and_then(|judged| judged.reached_s);
            ConditionFound {
                condition: ending.name.clone(),
                reached: at_s.is_some(),
                at_s,
                found: ending.found(judged.and_then(|judged| judged.last)),
            }
        };
        UntilFound {
            conditions: self.each.iter().enumerate().map(of).collect(),
            all_of: self.rule == Rule::All,
            ..whole
        }
    }
}

impl Ending {
    /// By what a scenario says; none where that makes no condition.
    fn of(until: &ConditionSpec, setup: &Setup) -> Option<Self> {
        let direction = until.direction.map(|to| Vector::from(to).normalize());
        let pieces = || {
            let name = until.piece.as_ref()?;
            let group = setup.measures.groups.iter().find(|group| group.name == *name);
            let names = group.map_or(std::slice::from_ref(name), |group| &group.pieces);
            setup.numbers(names)
        };
        let force = || Some(Subject::Force(pieces()?, direction?));
        let flow = || {
            let name = until.opening.as_ref()?;
            let spec = setup.measures.openings.iter().find(|o| o.name == *name)?;
            Some(Subject::Flow(opening(spec)))
        };
        let (subject, condition) = match *until {
            ConditionSpec { force_n: Some(n), .. } => (force()?, Condition::Reaches(n)),
            ConditionSpec { steady_force_percent: Some(p), .. } => {
                (force()?, Condition::Steady(p / 100.0))
            }
            ConditionSpec { moved_mm: Some(mm), .. } => {
                (Subject::Displacement(pieces()?, direction), Condition::Reaches(from_mm(mm)))
            }
            ConditionSpec { turned_deg: Some(deg), .. } => {
                (Subject::Turn(pieces()?), Condition::Reaches(from_deg(deg)))
            }
            ConditionSpec { flow_below_g_per_s: Some(rate), .. } => {
                (flow()?, Condition::FallsBelow(from_g(rate)))
            }
            ConditionSpec { steady_flow_percent: Some(p), .. } => {
                (flow()?, Condition::Steady(p / 100.0))
            }
            _ => return None,
        };
        let of = until.piece.as_ref().or(until.opening.as_ref())?;
        let name = format!("`{}` of `{of}`", until.given().first()?.0);
        Some(Self { name, subject, condition, window: until.window() })
    }

    /// What is reported of it, by what was found last.
    fn found(&self, last: Option<f64>) -> Found {
        let mut found = Found::default();
        let (number, value) = match (&self.subject, self.condition) {
            (_, Condition::Steady(_)) => (&mut found.change_percent, last.map(|x| 100.0 * x)),
            (Subject::Force(..), _) => (&mut found.force_n, last),
            (Subject::Turn(_), _) => (&mut found.turned_deg, last.map(f64::to_degrees)),
            (Subject::Displacement(..), _) => (&mut found.moved_mm, last.map(to_mm)),
            (Subject::Flow(_), _) => (&mut found.flow_g_per_s, last.map(to_g)),
        };
        *number = value;
        found
    }
}

impl UntilFound {
    /// What was found, with its unit, for a reader. Of several conditions those that held come
    /// first.
    pub fn line(&self) -> String {
        let Self { conditions, all_of, .. } = self;
        let named = |of: &ConditionFound| format!("{} with {}", of.condition, of.found.value());
        let list = |reached: bool| {
            let of = conditions.iter().filter(|of| of.reached == reached).map(named);
            of.collect::<Vec<_>>().join(", ")
        };
        let (held, not) = (list(true), list(false));
        match (self.at_s, conditions.is_empty()) {
            (Some(at), true) => format!("`until` held after {at:.3} s: {}", self.found.value()),
            (None, true) => format!("`until` was not reached: {} at the end", self.found.value()),
            (Some(at), false) if not.is_empty() => format!("`until` held after {at:.3} s: {held}"),
            (Some(at), false) => format!("`until` held after {at:.3} s: {held}; not {not}"),
            (None, false) => {
                let wanted = if *all_of { "all at the same time" } else { "any" };
                let all = conditions.iter().map(named).collect::<Vec<_>>().join(", ");
                format!("`until` was not reached, which is {wanted} of: {all} at the end")
            }
        }
    }
}

impl Found {
    /// With its unit.
    fn value(&self) -> String {
        match *self {
            Self { force_n: Some(n), .. } => format!("a force of {} N", four_digits(n)),
            Self { moved_mm: Some(mm), .. } => format!("{} mm moved", four_digits(mm)),
            Self { turned_deg: Some(deg), .. } => format!("{deg:.2}° turned"),
            Self { flow_g_per_s: Some(g), .. } => format!("a flow of {} g/s", four_digits(g)),
            Self { change_percent: Some(p), .. } => format!("a change of {p:.2} %"),
            _ => "nothing to tell".to_owned(),
        }
    }
}

impl Judged {
    /// Whether nothing was seen.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Takes what was found at a look, at a time in s since the stage began, of each condition.
    /// Whether they end the stage, which is then noted.
    pub(super) fn look_at_all(
        &mut self,
        endings: &Endings,
        found: &[f64],
        time: f64,
        every: f64,
    ) -> bool {
        let ends = match endings.rule {
            Rule::Single => self.look(&endings.each[0], found[0], every),
            Rule::Any | Rule::All => {
                self.each.resize(endings.each.len(), Self::default());
                let mut held = 0;
                for ((one, ending), found) in self.each.iter_mut().zip(&endings.each).zip(found) {
                    let holds = one.look(ending, *found, every);
                    one.reached_s = holds.then_some(time);
                    held += usize::from(holds);
                }
                held == endings.each.len() || held > 0 && endings.rule == Rule::Any
            }
        };
        if ends {
            self.reached_s = Some(time);
        }
        ends
    }

    /// Takes what was found at a look: a displacement in m, an angle in rad, or the impulse in N s
    /// or mass in kg since the look before, `every` seconds ago. Whether the condition holds.
    pub(super) fn look(&mut self, ending: &Ending, found: f64, every: f64) -> bool {
        let now = match ending.subject {
            Subject::Displacement(..) | Subject::Turn(_) => Some(found),
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
        let mut numbers = self.amounts.iter().chain(&self.last).chain(&self.reached_s);
        if !numbers.all(|x| x.is_finite()) {
            return Err("`judged` holds what is no number".to_owned());
        }
        self.each.iter().try_for_each(Self::check)
    }
}
