//! Progress for people: bars on a terminal, lines elsewhere.

use std::{
    collections::HashMap,
    io::Write,
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::protocol::Progress;

/// At most one line about a stage in this time, beside those at its begin and end.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One bar a stage, with the time it is expected to take still.
#[derive(Default)]
pub(super) struct Bars {
    all: MultiProgress,
    running: Mutex<HashMap<u64, ProgressBar>>,
}

/// Simulated time as the bar counts it.
fn ticks(seconds: f64) -> u64 {
    (seconds.max(0.0) * 1000.0) as u64
}

impl Progress for Bars {
    fn begin_stage(&self, id: u64, name: &str, expected: f64) {
        let style = ProgressStyle::with_template(
            "{prefix} [{bar:24}] {percent:>3} % {elapsed} (ETA {eta}) {wide_msg}",
        )
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ");
        let bar = self.all.add(ProgressBar::new(ticks(expected)));
        bar.set_style(style);
        bar.set_prefix(name.to_owned());
        lock(&self.running).insert(id, bar);
    }

    fn update(&self, id: u64, simulated: f64, note: &str) {
        if let Some(bar) = lock(&self.running).get(&id) {
            let position = ticks(simulated);
            // Stages that end when the grains have settled may take longer than expected.
            if bar.length().is_some_and(|length| length < position) {
                bar.set_length(position);
            }
            bar.set_position(position);
            bar.set_message(note.to_owned());
        }
    }

    fn end_stage(&self, id: u64) {
        if let Some(bar) = lock(&self.running).remove(&id) {
            bar.finish_and_clear();
        }
    }

    fn message(&self, text: &str) {
        // The only failure is a terminal that is gone.
        let _ = self.all.println(text);
    }
}

/// Plain lines: one at the begin and the end of a stage, few between.
pub(super) struct Lines<W> {
    state: Mutex<LinesState<W>>,
    interval: Duration,
}

struct LinesState<W> {
    out: W,
    running: HashMap<u64, Running>,
}

struct Running {
    name: String,
    expected: f64,
    began: Instant,
    last_line: Instant,
}

impl<W: Write + Send> Lines<W> {
    /// Writes to `out`.
    pub(super) fn new(out: W) -> Self {
        Self::every(LINE_INTERVAL, out)
    }

    fn every(interval: Duration, out: W) -> Self {
        Self { state: Mutex::new(LinesState { out, running: HashMap::new() }), interval }
    }
}

impl<W: Write> LinesState<W> {
    fn line(&mut self, text: &str) {
        // A reader that is gone must not stop the simulation.
        let _ = writeln!(self.out, "{text}");
    }
}

impl<W: Write + Send> Progress for Lines<W> {
    // Each piece says a line of its own.
    fn begin_pieces(&self, _: u64, name: &str, pieces: usize) {
        lock(&self.state).line(&format!("{name}: {pieces} to do"));
    }

    fn begin_stage(&self, id: u64, name: &str, expected: f64) {
        let mut state = lock(&self.state);
        state.line(&format!("{name}: begins, about {expected:.1} s to simulate"));
        let now = Instant::now();
        let name = name.to_owned();
        state.running.insert(id, Running { name, expected, began: now, last_line: now });
    }

    fn update(&self, id: u64, simulated: f64, note: &str) {
        let mut state = lock(&self.state);
        let Some(stage) = state.running.get_mut(&id) else { return };
        if stage.last_line.elapsed() < self.interval {
            return;
        }
        stage.last_line = Instant::now();
        let mut line = format!(
            "{}: {simulated:.2} of about {:.1} s",
            stage.name,
            stage.expected.max(simulated)
        );
        if simulated > 0.0 && simulated < stage.expected {
            let left = stage.began.elapsed().as_secs_f64() * (stage.expected / simulated - 1.0);
            line += &format!(", ETA {}", super::table::duration(left));
        }
        if !note.is_empty() {
            line += &format!(", {note}");
        }
        state.line(&line);
    }

    fn end_stage(&self, id: u64) {
        let mut state = lock(&self.state);
        if let Some(stage) = state.running.remove(&id) {
            let took = super::table::duration(stage.began.elapsed().as_secs_f64());
            state.line(&format!("{}: ended after {took}", stage.name));
        }
    }

    fn message(&self, text: &str) {
        lock(&self.state).line(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(interval: Duration) -> Vec<String> {
        let progress = Lines::every(interval, Vec::new());
        progress.begin_stage(1, "pour", 4.0);
        for step in 1..=3 {
            progress.update(1, f64::from(step), "surface 100 mm");
        }
        progress.update(2, 1.0, "a stage that never began");
        progress.message("hello");
        progress.end_stage(1);
        progress.update(1, 4.0, "after its end");
        progress.end_stage(1);
        let out = lock(&progress.state).out.clone();
        String::from_utf8(out).expect("text").lines().map(str::to_owned).collect()
    }

    #[test]
    fn lines_are_few() {
        let got = lines(Duration::from_secs(3600));
        assert_eq!(got.len(), 3, "begin, message, end: {got:?}");
        assert!(got[0].contains("pour: begins"), "{got:?}");
        assert_eq!(got[1], "hello");
        assert!(got[2].contains("pour: ended"), "{got:?}");
    }

    #[test]
    fn lines_tell_how_far_it_is() {
        let got = lines(Duration::ZERO);
        assert_eq!(got.len(), 6, "begin, three updates, message, end: {got:?}");
        assert!(got[1].contains("1.00 of about 4.0 s, ETA"), "{got:?}");
        assert!(got[1].ends_with("surface 100 mm"), "{got:?}");
    }

    #[test]
    fn bars_outlive_wrong_expectations() {
        let bars = Bars::default();
        bars.begin_stage(7, "pour", 1.0);
        bars.update(7, 2.5, "");
        let bar = lock(&bars.running).get(&7).cloned().expect("a bar");
        assert_eq!((bar.position(), bar.length()), (2500, Some(2500)), "the bar grows");
        bars.end_stage(7);
        assert!(lock(&bars.running).is_empty(), "the bar is gone");
        bars.update(7, 3.0, "");
    }
}
