//! Progress for people who read a file or a pipe: plain lines.

use std::io::Write;

use super::*;

/// At most one line about a stage in this time, beside those at its begin and end.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// Plain lines: one at the begin and the end of a stage, few between.
pub(super) struct Lines<W> {
    state: Mutex<LinesState<W>>,
    interval: Duration,
}

struct LinesState<W> {
    out: W,
    running: HashMap<u64, Running>,
    overall: Overall,
}

struct Running {
    name: String,
    expected: f64,
    /// Simulated time in s from which this run went on with it.
    from: f64,
    began: Instant,
    last_line: Instant,
}

impl<W: Write + Send> Lines<W> {
    pub(super) fn new(out: W) -> Self {
        Self::every(LINE_INTERVAL, out)
    }

    fn every(interval: Duration, out: W) -> Self {
        let (running, overall) = (HashMap::new(), Overall::default());
        Self { state: Mutex::new(LinesState { out, running, overall }), interval }
    }
}

impl<W: Write> LinesState<W> {
    fn line(&mut self, text: &str) {
        // A reader that is gone must not stop the simulation.
        let _ = writeln!(self.out, "{}", plain_lines(text));
    }

    /// Takes a stage out; gives its name and how long it took, `None` where it does not run.
    fn remove(&mut self, id: u64) -> Option<(String, String)> {
        let stage = self.running.remove(&id)?;
        Some((stage.name, table::duration(stage.began.elapsed().as_secs_f64())))
    }
}

impl<W: Write + Send> Progress for Lines<W> {
    fn begin_work(&self, expected: f64) {
        lock(&self.state).overall = Overall::of(expected);
    }

    fn already_done(&self, expected: f64) {
        lock(&self.state).overall.leave_out(expected);
    }

    fn end_work(&self) {
        lock(&self.state).overall = Overall::default();
    }

    // Each piece says a line of its own.
    fn begin_pieces(&self, _: u64, name: &str, pieces: usize) {
        lock(&self.state).line(&format!("{name}: {pieces} to do"));
    }

    fn begin_stage(&self, id: u64, name: &str, expected: f64) {
        let mut state = lock(&self.state);
        state.line(&format!("{name}: begins, about {expected:.1} s to simulate"));
        state.overall.begin_stage(id, expected);
        let now = Instant::now();
        let name = name.to_owned();
        let stage = Running { name, expected, from: 0.0, began: now, last_line: now };
        state.running.insert(id, stage);
    }

    fn resume_stage(&self, id: u64, simulated: f64) {
        let mut state = lock(&self.state);
        state.overall.resume_stage(id, simulated);
        if let Some(stage) = state.running.get_mut(&id) {
            stage.from = simulated;
        }
    }

    fn update(&self, id: u64, simulated: f64, note: &str) {
        let mut state = lock(&self.state);
        state.overall.update(id, simulated);
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
        let done = simulated - stage.from;
        if done > 0.0 && simulated < stage.expected {
            let left = stage.began.elapsed().as_secs_f64() * (stage.expected - simulated) / done;
            line += &format!(", ETA {}", table::duration(left));
        }
        line += &format!(", {}", speed(done, stage.began));
        if !note.is_empty() {
            line += &format!(", {note}");
        }
        state.line(&line);
    }

    fn end_stage(&self, id: u64) {
        let mut state = lock(&self.state);
        let Some((name, took)) = state.remove(id) else { return };
        state.overall.end_stage(id);
        let mut line = format!("{name}: ended after {took}");
        if state.overall.total() > 0.0 {
            line += &format!("; in all {}", state.overall);
            if let Some(left) = state.overall.left() {
                line += &format!(", ETA {}", table::duration(left));
            }
        }
        state.line(&line);
    }

    fn leave_stage(&self, id: u64) {
        let mut state = lock(&self.state);
        if let Some((name, took)) = state.remove(id) {
            state.overall.leave_stage(id);
            state.line(&format!("{name}: not finished, left after {took}"));
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
    fn a_stage_that_is_given_up_is_not_said_to_have_ended() {
        let progress = Lines::every(Duration::ZERO, Vec::new());
        progress.begin_stage(1, "pour", 4.0);
        progress.leave_stage(1);
        progress.end_stage(1);
        let text = String::from_utf8(lock(&progress.state).out.clone()).expect("text");
        assert!(text.contains("pour: not finished") && !text.contains("ended"), "law: got {text}");
    }

    #[test]
    fn lines_tell_how_far_it_is() {
        let got = lines(Duration::ZERO);
        assert_eq!(got.len(), 6, "begin, three updates, message, end: {got:?}");
        assert!(got[1].contains("1.00 of about 4.0 s, ETA"), "{got:?}");
        assert!(got[1].ends_with("surface 100 mm"), "{got:?}");
    }

    /// Law: speed and ETA of a stage that goes on are those of this run: what an earlier one had
    /// simulated took no time of it.
    #[test]
    fn a_stage_that_goes_on_is_as_fast_as_it_is_now() {
        let progress = Lines::every(Duration::ZERO, Vec::new());
        progress.begin_work(30.0);
        progress.begin_stage(1, "vibrate", 20.0);
        progress.resume_stage(1, 19.0);
        let pause = Duration::from_millis(50);
        thread::sleep(pause);
        progress.update(1, 19.5, "");
        progress.end_stage(1);
        let text = String::from_utf8(lock(&progress.state).out.clone()).expect("text");
        let line = text.lines().find(|l| l.contains("19.50 of about 20.0 s")).expect("a line");
        let told = line.strip_suffix(" × real time").and_then(|l| l.rsplit(", ").next());
        let got: f64 = told.and_then(|number| number.parse().ok()).expect("a speed");
        let most = 0.5 / pause.as_secs_f64();
        assert!(got <= most + 0.005, "law: 0.5 s in {pause:?} or more, at most {most}, got {got}");
        assert!(text.contains("; in all 1.0 of about 11.0 s done, ETA"), "law: got {text}");
    }

    /// Law: what a failed stage has not simulated, and stages that need it, are not left to do.
    #[test]
    fn the_rest_of_a_failed_run_is_no_work() {
        let progress = Lines::every(Duration::ZERO, Vec::new());
        progress.begin_work(30.0);
        progress.begin_stage(1, "pour", 5.0);
        progress.update(1, 1.0, "");
        progress.leave_stage(1);
        progress.left_out(10.0);
        progress.begin_stage(2, "pour", 15.0);
        progress.end_stage(2);
        let text = String::from_utf8(lock(&progress.state).out.clone()).expect("text");
        let last = text.lines().last().unwrap_or_default();
        let expected = "; in all 16.0 of about 16.0 s done";
        assert!(last.ends_with(expected), "law: expected `{expected}`, got `{last}`");
    }

    #[test]
    fn lines_tell_how_far_all_is() {
        let progress = Lines::every(Duration::ZERO, Vec::new());
        progress.begin_work(16.0);
        progress.already_done(6.0);
        progress.begin_stage(1, "pour", 5.0);
        progress.end_stage(1);
        progress.begin_stage(2, "vibrate", 5.0);
        progress.end_stage(2);
        progress.end_work();
        let out = lock(&progress.state).out.clone();
        let text = String::from_utf8(out).expect("text");
        let ends: Vec<&str> = text.lines().filter(|l| l.contains("ended")).collect();
        assert!(ends[0].contains("; in all 5.0 of about 10.0 s done, ETA"), "{text}");
        assert!(ends[1].ends_with("; in all 10.0 of about 10.0 s done"), "{text}");
        assert!(!text.contains('\x1b'), "law: plain lines, got {text:?}");
    }
}
