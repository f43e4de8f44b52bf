//! What long work reports to whoever shows its progress.

/// Told of stages as they go on, from any thread.
pub trait Progress: Send + Sync {
    /// Work begins whose stages are expected to take so much simulated time in s together.
    fn begin_work(&self, _expected: f64) {}
    /// A stage of that work, expected to take so much simulated time in s, was found done.
    fn already_done(&self, _expected: f64) {}
    /// Stages of that work, expected to take so much simulated time in s together, are not run: one
    /// before them failed. They are as little left to do as what was found done.
    fn left_out(&self, expected: f64) {
        self.already_done(expected);
    }
    /// That work has ended.
    fn end_work(&self) {}
    /// A stage begins; `expected` is the simulated time in s it is expected to take.
    fn begin_stage(&self, _id: u64, _name: &str, _expected: f64) {}
    /// Work begins that is counted in pieces, not in simulated time; it is
    /// updated and ended like a stage.
    fn begin_pieces(&self, id: u64, name: &str, pieces: usize) {
        self.begin_stage(id, name, pieces as f64);
    }
    /// A stage that has begun goes on from a simulated time in s, reached in an earlier run: what lies
    /// before that is no work any more.
    fn resume_stage(&self, _id: u64, _simulated: f64) {}
    /// A stage has reached a simulated time in s; the note says what matters most just now.
    fn update(&self, _id: u64, _simulated: f64, _note: &str) {}
    /// A stage has ended, and its result is kept.
    fn end_stage(&self, _id: u64) {}
    /// A stage is given up: it failed, or was asked to stop.
    fn leave_stage(&self, id: u64) {
        self.end_stage(id);
    }
    /// Something a reader should know at once.
    fn message(&self, text: &str);
}

/// Work that is reported; it ends when this is dropped.
pub struct Work<'a>(&'a dyn Progress);

impl<'a> Work<'a> {
    /// Begins work whose stages are expected to take so much simulated time in s together.
    pub fn begin(progress: &'a dyn Progress, expected: f64) -> Self {
        progress.begin_work(expected);
        Self(progress)
    }
}

impl Drop for Work<'_> {
    fn drop(&mut self) {
        self.0.end_work();
    }
}

/// Tells nobody.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn message(&self, _: &str) {}
}
