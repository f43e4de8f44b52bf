//! Decides step by step whether the threads of a world share a step or one of them does it alone.
//!
//! Threads can take longer together than one alone, as two do while few grains are poured
//! (docs/cost.md, "Cost of a step"). So where a world may leave them, both are tried every
//! [`PERIOD`] steps, and the faster one goes on: which it is changes no bit.

use std::time::Duration;

/// In steps: of each period the first are the trial, in blocks of one kind.
const BLOCK: u32 = 5;
const TRIAL: u32 = 4 * BLOCK;
const PERIOD: u32 = 400;

/// See the module.
pub(super) struct Sharing {
    may_leave: bool,
    /// Of the period.
    step: u32,
    /// After the trial.
    alone: bool,
    /// In the trial, shared and alone.
    spent: [Duration; 2],
}

impl Sharing {
    /// `may_leave`:
    /// [`NativeSettings::may_leave_threads`](crate::scenario::NativeSettings::may_leave_threads).
    pub(super) fn new(may_leave: bool) -> Self {
        // A new world has much to do that it does once.
        let step = PERIOD - 24;
        Self { may_leave, step, alone: false, spent: Default::default() }
    }

    /// Whether one thread does the next step.
    pub(super) fn alone(&self) -> bool {
        // Shared, alone, alone, shared: what grows or shrinks meanwhile counts alike.
        let in_trial = matches!(self.step / BLOCK, 1 | 2);
        self.may_leave && if self.step < TRIAL { in_trial } else { self.alone }
    }

    /// To be called after each step, with how long it took.
    pub(super) fn took(&mut self, time: Duration) {
        // The first of a block finds everything in another cache.
        if self.step < TRIAL && !self.step.is_multiple_of(BLOCK) {
            self.spent[usize::from(self.alone())] += time;
        }
        self.step += 1;
        if self.step == TRIAL {
            let [shared, alone] = std::mem::take(&mut self.spent);
            self.alone = alone < shared;
        }
        self.step %= PERIOD;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which of as many steps a single thread does, where a shared one takes so long, in s, and
    /// one of a single thread so long.
    fn steps_alone(may_leave: bool, shared_s: &[f64], alone_s: &[f64]) -> Vec<bool> {
        let mut sharing = Sharing::new(may_leave);
        let step = |(shared, alone): (&f64, &f64)| {
            let is_alone = sharing.alone();
            sharing.took(Duration::from_secs_f64(if is_alone { *alone } else { *shared }));
            is_alone
        };
        shared_s.iter().zip(alone_s).map(step).collect()
    }

    #[test]
    fn threads_are_left_where_they_do_not_help_and_were_not_typed() {
        let (slow, fast) = (vec![2.0; 1000], vec![1.0; 1000]);
        // Both are tried for 20 of the first 44 steps and of every 400; the faster one does the
        // others.
        let tried = |i: usize| (24..44).contains(&i) || (424..444).contains(&i) || i >= 824;
        let share = |alone: &[bool], at: &dyn Fn(usize) -> bool| {
            let picked: Vec<bool> = (0..1000).filter(|i| at(*i)).map(|i| alone[i]).collect();
            picked.iter().filter(|alone| **alone).count() as f64 / picked.len() as f64
        };
        let later = |i: usize| (44..824).contains(&i) && !tried(i);
        for (may_leave, shared, alone, expected) in [
            (true, &slow, &fast, 1.0),
            (true, &fast, &slow, 0.0),
            (false, &slow, &fast, 0.0),
            (false, &fast, &slow, 0.0),
        ] {
            let got = steps_alone(may_leave, shared, alone);
            let trial = if may_leave { 0.5 } else { 0.0 };
            let case =
                format!("may leave {may_leave}, shared {} s, alone {} s", shared[0], alone[0]);
            let first = share(&got, &|i| i < 24);
            assert_eq!(first, 0.0, "law: {case}: the first 24 steps are shared, got {first} alone");
            let trials = share(&got, &|i| (24..44).contains(&i) || (424..444).contains(&i));
            assert_eq!(trials, trial, "law: {case}: share alone in trials {trial}, got {trials}");
            let rest = share(&got, &later);
            assert_eq!(rest, expected, "law: {case}: share alone otherwise {expected}, got {rest}");
        }
        // What changes is found out: threads help from the 500th step on.
        let shared: Vec<f64> = (0..1300).map(|i| if i < 500 { 2.0 } else { 0.5 }).collect();
        let got = steps_alone(true, &shared, &vec![1.0; 1300]);
        assert!(got[600] && !got[900], "law: the next trial finds that threads help by now");
    }
}
