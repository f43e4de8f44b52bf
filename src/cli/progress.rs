//! Progress for people at a terminal: a bar a stage, and one for all of them.

use std::sync::{MutexGuard, PoisonError};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use super::*;

/// Takes a lock also after a thread that held it has failed.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One bar a stage, with the time it is expected to take still, and below them
/// one of all stages together.
#[derive(Default)]
pub(super) struct Bars {
    all: MultiProgress,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    running: HashMap<u64, Running>,
    overall: Overall,
    overall_bar: Option<ProgressBar>,
}

struct Running {
    bar: ProgressBar,
    name: String,
    expected: f64,
    /// Simulated time in s from which this run went on with a stage.
    from: f64,
    /// When a stage began; none where pieces are counted.
    began: Option<Instant>,
}

/// Simulated time as the bar counts it.
fn ticks(seconds: f64) -> u64 {
    (seconds.max(0.0) * 1000.0) as u64
}

/// Simulated seconds per second, for people.
pub(super) fn speed(simulated: f64, began: Instant) -> String {
    times_real_time(simulated / began.elapsed().as_secs_f64().max(1e-3))
}

/// A ratio of times to two digits, or to hundredths if it is not small.
fn times_real_time(ratio: f64) -> String {
    let is_small = ratio > 0.0 && ratio < 0.1;
    let digits = if is_small { 1 - ratio.log10().floor() as i32 } else { 2 };
    format!("{ratio:.*} × real time", digits.clamp(2, 9) as usize)
}

fn bar(expected: f64) -> ProgressBar {
    // Words take what is left of a line, and are cut off there: a line that wraps is drawn anew
    // below itself.
    let style =
        ProgressStyle::with_template("{wide_msg} [{bar:10}] {percent:>3} % {elapsed} (ETA {eta})")
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .progress_chars("=> ");
    // What is not in a `MultiProgress` yet must not draw itself.
    let bar = ProgressBar::hidden();
    bar.set_length(ticks(expected));
    bar.set_style(style);
    bar
}

impl Bars {
    fn begin(&self, id: u64, name: &str, expected: f64, began: Option<Instant>) {
        let mut state = lock(&self.state);
        let State { running, overall, overall_bar } = &mut *state;
        if began.is_some() {
            overall.begin_stage(id, expected);
        }
        if overall.total() > 0.0 && overall_bar.is_none() {
            let of_all = self.all.add(bar(overall.total()));
            *overall_bar = Some(of_all);
        }
        let bar = bar(expected);
        let bar = match overall_bar {
            Some(below) => self.all.insert_before(below, bar),
            None => self.all.add(bar),
        };
        let name = plain(name).into_owned();
        bar.set_message(name.clone());
        running.insert(id, Running { bar, name, expected, from: 0.0, began });
        state.show_overall();
    }
}

impl State {
    fn show_overall(&self) {
        if let Some(bar) = &self.overall_bar {
            bar.set_length(ticks(self.overall.total()));
            bar.set_position(ticks(self.overall.done()));
            bar.set_message(format!("all stages: {}", self.overall));
        }
    }

    /// Takes away the bar of a stage that runs no more.
    fn clear(&mut self, id: u64) {
        self.show_overall();
        if let Some(Running { bar, .. }) = self.running.remove(&id) {
            bar.finish_and_clear();
        }
    }
}

impl Progress for Bars {
    fn begin_work(&self, expected: f64) {
        lock(&self.state).overall = Overall::of(expected);
    }

    fn already_done(&self, expected: f64) {
        let mut state = lock(&self.state);
        state.overall.leave_out(expected);
        state.show_overall();
    }

    fn end_work(&self) {
        let mut state = lock(&self.state);
        state.overall = Overall::default();
        if let Some(bar) = state.overall_bar.take() {
            bar.finish_and_clear();
        }
    }

    fn begin_pieces(&self, id: u64, name: &str, pieces: usize) {
        self.begin(id, name, pieces as f64, None);
    }

    fn begin_stage(&self, id: u64, name: &str, expected: f64) {
        self.begin(id, name, expected, Some(Instant::now()));
    }

    fn resume_stage(&self, id: u64, simulated: f64) {
        let mut state = lock(&self.state);
        state.overall.resume_stage(id, simulated);
        state.show_overall();
        if let Some(stage) = state.running.get_mut(&id) {
            stage.from = simulated;
            stage.bar.set_position(ticks(simulated));
            // It took no time.
            stage.bar.reset_eta();
        }
    }

    fn update(&self, id: u64, simulated: f64, note: &str) {
        let mut state = lock(&self.state);
        state.overall.update(id, simulated);
        state.show_overall();
        let Some(Running { bar, name, expected, from, began }) = state.running.get(&id) else {
            return;
        };
        let position = ticks(simulated);
        // Stages that end when the grains have settled may take longer than expected.
        if bar.length().is_some_and(|length| length < position) {
            bar.set_length(position);
        }
        bar.set_position(position);
        let mut line = match began {
            Some(began) => {
                let whole = expected.max(simulated);
                let mut line = format!("{name}: {simulated:.2} of {whole:.1} s");
                if simulated > *from {
                    line += &format!(", {}", speed(simulated - from, *began));
                }
                line
            }
            None => format!("{name}: {simulated:.0} of {expected:.0}"),
        };
        if !note.is_empty() {
            line += &format!(", {note}");
        }
        bar.set_message(plain(&line).into_owned());
    }

    fn end_stage(&self, id: u64) {
        let mut state = lock(&self.state);
        state.overall.end_stage(id);
        state.clear(id);
    }

    fn leave_stage(&self, id: u64) {
        let mut state = lock(&self.state);
        state.overall.leave_stage(id);
        state.clear(id);
    }

    fn message(&self, text: &str) {
        // The only failure is a terminal that is gone.
        let _ = self.all.println(plain_lines(text));
    }
}

#[cfg(test)]
mod tests {
    use indicatif::{InMemoryTerm, ProgressDrawTarget};

    use super::*;
    use crate::plain::assert_holds;

    /// Law: a run that takes hours has a speed above nothing.
    #[test]
    fn slow_runs_have_a_speed() {
        for (ratio, expected) in [
            (0.0, "0.00"),
            (0.000_04, "0.000040"),
            (0.000_41, "0.00041"),
            (0.003, "0.0030"),
            (0.099, "0.099"),
            (0.1, "0.10"),
            (2.5, "2.50"),
        ] {
            assert_eq!(times_real_time(ratio), format!("{expected} × real time"), "of {ratio}");
        }
    }

    #[test]
    fn bars_outlive_wrong_expectations() {
        let bars = Bars::default();
        bars.begin_stage(7, "pour", 1.0);
        bars.update(7, 2.5, "");
        let bar = lock(&bars.state).running[&7].bar.clone();
        assert_eq!((bar.position(), bar.length()), (2500, Some(2500)), "the bar grows");
        bars.end_stage(7);
        assert!(lock(&bars.state).running.is_empty(), "the bar is gone");
        bars.update(7, 3.0, "");
    }

    /// Law: the ETA of a stage that goes on follows from this run: what an earlier one had simulated
    /// took no time of it.
    #[test]
    fn the_bar_of_a_stage_that_goes_on_has_an_eta_of_this_run() {
        let bars = Bars::default();
        bars.begin_stage(7, "vibrate", 20.0);
        bars.resume_stage(7, 19.0);
        let pause = Duration::from_millis(50);
        thread::sleep(pause);
        bars.update(7, 19.1, "");
        let bar = lock(&bars.state).running[&7].bar.clone();
        assert_eq!(bar.position(), 19_100, "law: of the whole stage");
        // 0.1 s took that long or longer, and 0.9 s are left.
        let (got, least) = (bar.eta(), 8 * pause);
        assert!(got >= least, "law: nine times {pause:?}, expected {least:?} or more, got {got:?}");
    }

    /// What a terminal of 120 columns shows.
    fn shown(told: impl Fn(&Bars)) -> String {
        shown_in(120, told)
    }

    fn shown_in(columns: u16, told: impl Fn(&Bars)) -> String {
        let terminal = InMemoryTerm::new(10, columns);
        let target = ProgressDrawTarget::term_like_with_hz(Box::new(terminal.clone()), 255);
        let bars = Bars { all: MultiProgress::with_draw_target(target), ..Bars::default() };
        told(&bars);
        terminal.contents()
    }

    #[test]
    fn a_terminal_shows_the_stage_and_all_stages() {
        let text = shown(|bars| {
            bars.begin_work(16.0);
            bars.already_done(6.0);
            bars.begin_stage(1, "vibrate", 5.0);
            bars.update(1, 2.5, "settlement 3.1 mm");
        });
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2, "a stage, and all of them: {text}");
        let stage = ["vibrate: 2.50 of 5.0 s", "× real time", "settlement 3.1 mm", "]  50 %"];
        assert_holds(lines[0], &stage);
        assert_holds(lines[1], &["all stages: 2.5 of about 10.0 s done", "]  25 %", "ETA"]);
    }

    /// Law: the longest stage of a run has one line of a terminal of 40 columns or more, with how far
    /// it is, and of a usual one of 80 also its time.
    #[test]
    fn a_narrow_terminal_holds_a_stage_in_a_line() {
        for columns in [40, 60, 80, 120] {
            let text = shown_in(columns, |bars| {
                bars.begin_work(16.0);
                bars.begin_stage(1, "realisation 1, place the top plate", 5.0);
                bars.update(1, 2.5, "settlement 3.1 mm");
            });
            let lines: Vec<&str> = text.lines().collect();
            assert_eq!(lines.len(), 2, "law: a line each in {columns} columns, got\n{text}");
            for (line, words) in lines.iter().zip(["real", "all "]) {
                assert!(line.starts_with(words), "law: what it is of, {columns} columns: {line}");
                assert!(line.ends_with(')'), "law: nothing is cut off behind, {columns}: {line}");
            }
            assert!(lines[0].contains("50 %"), "law: how far it is, got {}", lines[0]);
            let has_time = lines[0].contains("2.50");
            assert!(has_time || columns < 80, "law: and its time, got {}", lines[0]);
        }
    }

    #[test]
    fn a_terminal_is_left_clean() {
        let text = shown(|bars| {
            bars.begin_work(5.0);
            bars.begin_stage(1, "pour", 5.0);
            bars.update(1, 1.0, "");
            bars.end_stage(1);
            bars.end_work();
        });
        assert_eq!(text, "", "law: no bar is left behind");
    }

    #[test]
    fn pieces_are_counted() {
        let text = shown(|bars| {
            bars.begin_pieces(1, "experiments", 31);
            bars.update(1, 4.0, "rebound");
        });
        assert!(text.contains("4 of 31, rebound"), "{text}");
        assert!(!text.contains("all stages"), "law: pieces are no stages, {text}");
    }
}
