//! Progress of work that is carried out in parts, one after the other, told as that of one work.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::*;

/// Passes on what parts of a work tell. What there is to do in all follows from the first part and
/// the numbers of runs; the work has ended when this is dropped.
pub(super) struct InParts {
    told: Arc<dyn Progress>,
    /// Runs of all parts, and of the part that is carried out.
    runs: usize,
    of_part: AtomicUsize,
    begun: AtomicBool,
}

impl InParts {
    /// Of a work of this number of runs.
    pub fn new(told: Arc<dyn Progress>, runs: usize) -> Self {
        Self { told, runs, of_part: AtomicUsize::new(1), begun: AtomicBool::new(false) }
    }

    /// The next part has this number of runs.
    pub fn next(&self, runs: usize) {
        self.of_part.store(runs.max(1), Ordering::Relaxed);
    }
}

impl Drop for InParts {
    fn drop(&mut self) {
        if *self.begun.get_mut() {
            self.told.end_work();
        }
    }
}

impl Progress for InParts {
    fn begin_work(&self, expected: f64) {
        if !self.begun.swap(true, Ordering::Relaxed) {
            let of_part = self.of_part.load(Ordering::Relaxed);
            self.told.begin_work(expected * self.runs as f64 / of_part as f64);
        }
    }

    fn already_done(&self, expected: f64) {
        self.told.already_done(expected);
    }

    // Only that of a part.
    fn end_work(&self) {}

    fn begin_stage(&self, id: u64, name: &str, expected: f64) {
        self.told.begin_stage(id, name, expected);
    }

    fn begin_pieces(&self, id: u64, name: &str, pieces: usize) {
        self.told.begin_pieces(id, name, pieces);
    }

    fn update(&self, id: u64, simulated: f64, note: &str) {
        self.told.update(id, simulated, note);
    }

    fn end_stage(&self, id: u64) {
        self.told.end_stage(id);
    }

    fn leave_stage(&self, id: u64) {
        self.told.leave_stage(id);
    }

    fn message(&self, text: &str) {
        self.told.message(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keeps what is reported to it.
    #[derive(Default)]
    struct Heard(Mutex<Vec<String>>);

    impl Heard {
        fn keep(&self, what: String) {
            self.0.lock().expect("nobody panics").push(what);
        }
    }

    impl Progress for Heard {
        fn begin_work(&self, expected: f64) {
            self.keep(format!("begin {expected}"));
        }

        fn already_done(&self, expected: f64) {
            self.keep(format!("done {expected}"));
        }

        fn end_work(&self) {
            self.keep("end".to_owned());
        }

        fn begin_stage(&self, id: u64, name: &str, expected: f64) {
            self.keep(format!("{name} {id} {expected}"));
        }

        fn update(&self, _: u64, _: f64, _: &str) {}

        fn end_stage(&self, id: u64) {
            self.keep(format!("ended {id}"));
        }

        fn message(&self, text: &str) {
            self.keep(text.to_owned());
        }
    }

    /// Law: what there is to do in all is that of all parts, from the first one on.
    #[test]
    fn parts_are_told_as_one_work() {
        let heard = Arc::new(Heard::default());
        let parts = InParts::new(heard.clone(), 6);
        for part in 0..3 {
            parts.next(2);
            parts.begin_work(10.0);
            parts.already_done(1.0);
            parts.begin_stage(part, "pour", 9.0);
            parts.end_stage(part);
            parts.end_work();
        }
        drop(parts);
        let got = heard.0.lock().expect("nobody panics").clone();
        let of =
            |part: u64| ["done 1".to_owned(), format!("pour {part} 9"), format!("ended {part}")];
        let expected =
            [vec!["begin 30".to_owned()], of(0).to_vec(), of(1).to_vec(), of(2).to_vec()];
        assert_eq!(got, [expected.concat(), vec!["end".to_owned()]].concat(), "law: one work");
        let unused = Arc::new(Heard::default());
        drop(InParts::new(unused.clone(), 6));
        assert!(unused.0.lock().expect("nobody panics").is_empty(), "law: nothing began");
    }
}
