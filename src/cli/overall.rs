//! How far all the stages of a command are together.

use std::fmt;

use super::*;

/// Simulated time of all stages: what is expected, and what is done.
///
/// A stage counts as long as it is expected to take, however long it took: one
/// that ends when the grains have settled may end early or late.
#[derive(Debug)]
pub(super) struct Overall {
    total: f64,
    finished: f64,
    running: HashMap<u64, Stage>,
    began: Instant,
}

/// A stage that runs, in s of simulated time.
#[derive(Debug)]
struct Stage {
    /// What is expected of it in this run.
    expected: f64,
    /// Where this run went on with it.
    from: f64,
    /// What it has reached.
    at: f64,
}

impl Default for Overall {
    fn default() -> Self {
        Self::of(0.0)
    }
}

impl Overall {
    /// Nothing done yet of so much simulated time in s.
    pub(super) fn of(total: f64) -> Self {
        Self { total, finished: 0.0, running: HashMap::new(), began: Instant::now() }
    }

    /// So much was done before, and is no work any more.
    pub(super) fn leave_out(&mut self, expected: f64) {
        self.total = (self.total - expected).max(0.0);
    }

    pub(super) fn begin_stage(&mut self, id: u64, expected: f64) {
        self.running.insert(id, Stage { expected, from: 0.0, at: 0.0 });
    }

    /// A stage goes on from a simulated time that was reached before: that is no work any more.
    pub(super) fn resume_stage(&mut self, id: u64, simulated: f64) {
        let Some(stage) = self.running.get_mut(&id) else { return };
        let before = simulated.min(stage.expected);
        (stage.from, stage.at) = (simulated, simulated);
        stage.expected -= before;
        self.leave_out(before);
    }

    /// A stage has reached a simulated time in s.
    pub(super) fn update(&mut self, id: u64, simulated: f64) {
        if let Some(stage) = self.running.get_mut(&id) {
            stage.at = simulated;
        }
    }

    pub(super) fn end_stage(&mut self, id: u64) {
        if let Some(stage) = self.running.remove(&id) {
            self.finished += stage.expected;
        }
    }

    /// A stage is given up: what it has simulated is done, and the rest is no work any more.
    pub(super) fn leave_stage(&mut self, id: u64) {
        if let Some(stage) = self.running.remove(&id) {
            let done = (stage.at - stage.from).min(stage.expected);
            self.finished += done;
            self.leave_out(stage.expected - done);
        }
    }

    /// What is expected in all, in s; 0 where nobody has said.
    pub(super) fn total(&self) -> f64 {
        self.total
    }

    /// What is done of it, in s.
    pub(super) fn done(&self) -> f64 {
        let running =
            self.running.values().map(|stage| (stage.at - stage.from).min(stage.expected));
        (self.finished + running.sum::<f64>()).min(self.total)
    }

    /// Wall time in s that the rest takes if it goes on as before; none where
    /// nothing is done or nothing is left.
    pub(super) fn left(&self) -> Option<f64> {
        let done = self.done();
        let left = self.total - done;
        // Rounding must not leave a rest.
        let some = 1e-9 * self.total;
        (done > some && left > some).then(|| self.began.elapsed().as_secs_f64() * left / done)
    }
}

impl fmt::Display for Overall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} of about {:.1} s done", self.done(), self.total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_count_as_long_as_expected() {
        let mut all = Overall::of(20.0);
        assert_eq!((all.done(), all.left()), (0.0, None), "nothing to judge the rest by");
        all.begin_stage(1, 6.0);
        all.update(1, 2.0);
        assert_eq!(all.done(), 2.0);
        all.update(1, 9.0);
        assert_eq!(all.done(), 6.0, "law: one that takes longer counts no more");
        all.end_stage(1);
        all.end_stage(1);
        assert_eq!(all.done(), 6.0, "law: ended once");
        assert!(all.left().is_some_and(|left| left >= 0.0));
        all.leave_out(10.0);
        assert_eq!((all.done(), all.total()), (6.0, 10.0), "law: what is no work is not done");
        all.begin_stage(2, 4.0);
        all.end_stage(2);
        assert_eq!((all.done(), all.left()), (10.0, None), "law: nothing is left");
    }

    /// Law: a stage that is given up is done as far as it has come, and leaves nothing to do.
    #[test]
    fn what_a_stage_given_up_has_not_simulated_is_no_work() {
        let mut all = Overall::of(30.0);
        all.begin_stage(1, 20.0);
        all.update(1, 2.0);
        all.leave_stage(1);
        assert_eq!((all.done(), all.total()), (2.0, 12.0), "law: 18 s are not simulated");
        all.begin_stage(2, 10.0);
        all.update(2, 15.0);
        all.leave_stage(2);
        all.leave_stage(2);
        assert_eq!((all.done(), all.total()), (12.0, 12.0), "law: longer than expected is no more");
    }

    /// Law: what a stage had reached in an earlier run is no work of this one.
    #[test]
    fn what_was_simulated_before_a_stage_goes_on_is_no_work() {
        let mut all = Overall::of(30.0);
        all.begin_stage(1, 20.0);
        all.resume_stage(1, 19.0);
        assert_eq!((all.done(), all.total()), (0.0, 11.0), "law: 1 s of it and 10 s are left");
        all.update(1, 19.5);
        assert_eq!(all.done(), 0.5, "law: since it went on");
        all.update(1, 21.0);
        all.end_stage(1);
        assert_eq!((all.done(), all.total()), (1.0, 11.0), "law: as long as was expected");
        all.begin_stage(2, 10.0);
        all.resume_stage(2, 12.0);
        all.update(2, 12.5);
        assert_eq!((all.done(), all.total()), (1.0, 1.0), "law: longer than expected is no more");
        all.resume_stage(3, 1.0);
        assert_eq!(all.total(), 1.0, "law: who has not begun does not go on");
    }
}
