//! A command within another program, as the Python package runs it: the same words, checks, files
//! and messages as of the program `pluvia`, without its signals and standard streams.

use std::ffi::OsString;
use std::sync::Once;

use super::Command;
use super::*;

/// The stack of the thread that a command runs on, in bytes: that of a program's first.
const STACK: usize = 8 << 20;

/// Exit code of wrong usage, as of [`CliError::Usage`].
const USAGE: u8 = 2;

/// What a command says while it goes on.
#[derive(Debug, Clone, PartialEq)]
pub enum News {
    /// Something a reader should know at once.
    Message(String),
    /// How far it is.
    Progress {
        /// The stage or work that has just gone on.
        stage: String,
        /// What is done of all stages of the command, in simulated s, or in pieces.
        done: f64,
        /// What is expected in all, in the same unit.
        total: f64,
        /// What matters most just now; may be empty.
        note: String,
    },
}

/// How a command ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ended {
    /// The program's exit code (`pluvia --help` lists them).
    pub code: u8,
    /// What it printed: results as JSON, where the command has any.
    pub printed: String,
    /// Why it did not do what it was asked; none where it did.
    pub error: Option<String>,
}

/// Runs the command of the words that stand behind `pluvia` on a command line.
///
/// `cancel` takes the place of Ctrl-C: set to true, the command stops at a point from which the
/// same words resume, and the code is 130. `hear` is called from the command's threads. Commands
/// may run side by side.
///
/// Commands that have no end or print no results are refused: a viewer that serves
/// (`view` without `--save`), `completions`, and sweeps that have others run the program
/// (`--slurm`, `--snakemake`).
pub fn embedded(
    words: &[OsString],
    cancel: &Arc<AtomicBool>,
    hear: impl Fn(News) + Send + Sync + 'static,
) -> Ended {
    static NOTED: Once = Once::new();
    NOTED.call_once(note_panics);
    let listener: Arc<dyn Progress> = Arc::new(Listener { hear, state: Mutex::default() });
    // A thread of its own has the stack of a program, and nothing of other commands.
    let (words, cancel) = (words.to_vec(), cancel.clone());
    let work = move || on_this_thread(&words, &cancel, listener);
    let started = thread::Builder::new().name("pluvia".to_owned()).stack_size(STACK).spawn(work);
    match started.map(thread::JoinHandle::join) {
        Ok(Ok(ended)) => ended,
        Ok(Err(_)) => failed(&CliError::Fault("the command's thread panicked".to_owned())),
        Err(error) => failed(&CliError::Threads(error.to_string())),
    }
}

fn on_this_thread(
    words: &[OsString],
    cancel: &Arc<AtomicBool>,
    listener: Arc<dyn Progress>,
) -> Ended {
    let wrong = |error| Ended { code: USAGE, printed: String::new(), error: Some(error) };
    if let Some(what) = renamed::refused(words).or_else(|| not_here(words)) {
        return wrong(what);
    }
    let program = OsString::from("pluvia");
    let cli = match Cli::try_parse_from([program].iter().chain(words)) {
        Ok(cli) => cli,
        // Help and version are asked for.
        Err(said) if said.exit_code() == 0 => {
            return Ended { code: 0, printed: said.to_string(), error: None };
        }
        Err(error) => {
            let error = error.to_string();
            return wrong(error.strip_prefix("error: ").unwrap_or(&error).trim_end().to_owned());
        }
    };
    if let Some(what) = endless(&cli.command) {
        return wrong(what.to_owned());
    }
    let kept = Arc::new(Mutex::new(String::new()));
    listen(Some(listener.clone()));
    let done = carried_out(&cli, || Context::within(cancel.clone(), listener, kept.clone()));
    listen(None);
    let printed = std::mem::take(&mut *lock(&kept));
    match done {
        Ok(status) => Ended { code: status as u8, printed, error: None },
        Err(error) => Ended { printed, ..failed(&error) },
    }
}

fn failed(error: &CliError) -> Ended {
    let what = plain_lines(&error.to_string()).into_owned();
    Ended { code: error.exit_code(), printed: String::new(), error: Some(what) }
}

/// Why options that have others run the program are refused.
fn not_here(words: &[OsString]) -> Option<String> {
    let option = ["--slurm", "--snakemake"].into_iter().find(|o| words.iter().any(|w| w == o))?;
    Some(format!("{option} hands the runs to the program `pluvia`: use that on the command line"))
}

/// Why a command is refused that has no end or prints no result.
fn endless(command: &Command) -> Option<&'static str> {
    match command {
        Command::View(args) if args.save.is_none() => {
            Some("`pluvia view` serves a page until Ctrl-C: give --save FILE.html")
        }
        Command::Completions(_) => Some("`pluvia completions` is for shells"),
        _ => None,
    }
}

/// Tells of stages as [`News`].
struct Listener<F> {
    hear: F,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    overall: Overall,
    /// What was expected in all of the work that has ended last; 0 where there was none.
    ended: f64,
    /// Name of each stage that runs, and what is expected of it.
    running: HashMap<u64, (String, f64)>,
}

impl State {
    /// How far all is when a stage has reached `at`.
    fn news(&self, id: u64, at: f64, note: &str) -> Option<News> {
        let (stage, expected) = self.running.get(&id)?;
        let (done, total) = match self.overall.total() {
            // What follows the work, as figures do, adds nothing to it.
            total if total <= 0.0 && self.ended > 0.0 => (self.ended, self.ended),
            // Nobody has said what there is to do in all.
            total if total <= 0.0 => (at.min(*expected), *expected),
            total => (self.overall.done(), total),
        };
        Some(News::Progress { stage: stage.clone(), done, total, note: note.to_owned() })
    }
}

impl<F: Fn(News) + Send + Sync> Listener<F> {
    /// Changes the state and tells what there is to tell.
    fn with(&self, change: impl FnOnce(&mut State) -> Option<News>) {
        let news = change(&mut lock(&self.state));
        news.into_iter().for_each(&self.hear);
    }
}

impl<F: Fn(News) + Send + Sync> Progress for Listener<F> {
    fn begin_work(&self, expected: f64) {
        let mut state = lock(&self.state);
        (state.overall, state.ended) = (Overall::of(expected), 0.0);
    }

    fn already_done(&self, expected: f64) {
        lock(&self.state).overall.leave_out(expected);
    }

    fn end_work(&self) {
        let mut state = lock(&self.state);
        state.ended = state.overall.total();
        state.overall = Overall::default();
    }

    fn begin_stage(&self, id: u64, name: &str, expected: f64) {
        self.with(|state| {
            state.overall.begin_stage(id, expected);
            state.running.insert(id, (name.to_owned(), expected));
            state.news(id, 0.0, "")
        });
    }

    fn resume_stage(&self, id: u64, simulated: f64) {
        lock(&self.state).overall.resume_stage(id, simulated);
    }

    fn begin_pieces(&self, id: u64, name: &str, pieces: usize) {
        self.with(|state| {
            state.running.insert(id, (name.to_owned(), pieces as f64));
            state.news(id, 0.0, "")
        });
    }

    fn update(&self, id: u64, simulated: f64, note: &str) {
        self.with(|state| {
            state.overall.update(id, simulated);
            state.news(id, simulated, note)
        });
    }

    fn end_stage(&self, id: u64) {
        self.with(|state| {
            state.overall.end_stage(id);
            let news = state.news(id, f64::INFINITY, "");
            state.running.remove(&id);
            news
        });
    }

    fn leave_stage(&self, id: u64) {
        let mut state = lock(&self.state);
        state.overall.leave_stage(id);
        state.running.remove(&id);
    }

    fn message(&self, text: &str) {
        (self.hear)(News::Message(plain_lines(text).into_owned()));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    fn run(words: &[&str], cancelled: bool) -> (Ended, Vec<News>) {
        let words: Vec<OsString> = words.iter().map(OsString::from).collect();
        let (tell, told) = mpsc::channel();
        let cancel = Arc::new(AtomicBool::new(cancelled));
        let ended = embedded(&words, &cancel, move |news| drop(tell.send(news)));
        (ended, told.try_iter().collect())
    }

    fn small() -> serde_json::Value {
        serde_json::json!({
            "name": "small",
            "grains": { "total_mass_g": 15, "density_kg_per_m3": 2673.9, "sieve_table":
                [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }] },
            "stages": [{ "stage": "fill_funnel", "time_limit_s": 0.5 }],
            "rest_test_s": 0
        })
    }

    /// Law: the same words leave the same files as those of the program, resume after `cancel`,
    /// and tell how far they are.
    #[test]
    fn a_run_is_stopped_and_resumed() {
        let folder = tempfile::tempdir().expect("a folder");
        let (file, out) = (folder.path().join("small.json"), folder.path().join("out"));
        std::fs::write(&file, small().to_string()).expect("a scenario");
        let file = file.to_str().expect("UTF-8");
        let words = ["run", file, "--out", out.to_str().expect("UTF-8")];
        let (ended, _) = run(&words, true);
        assert_eq!(ended.code, 130, "law: cancelled, {ended:?}");
        assert!(!out.join("summary.json").exists(), "law: it is not finished");
        let (ended, told) = run(&words, false);
        assert_eq!((ended.code, &ended.error), (0, &None), "law: the same words resume");
        let printed: serde_json::Value = serde_json::from_str(&ended.printed).expect("JSON");
        let kept = std::fs::read(out.join("summary.json")).expect("a summary");
        let kept: serde_json::Value = serde_json::from_slice(&kept).expect("JSON");
        assert_eq!(printed, kept, "law: what is printed is the summary");
        let reported = told.iter().filter_map(|news| match news {
            News::Progress { stage, done, total, .. } => Some((stage.as_str(), *done, *total)),
            News::Message(_) => None,
        });
        let reported: Vec<(&str, f64, f64)> = reported.collect();
        let is_named = |name: &str| reported.iter().any(|(stage, ..)| stage.contains(name));
        assert!(is_named("fill the funnel"), "law: the stage is named, got {reported:?}");
        assert!(is_named("figures"), "law: and so is what takes time after it, got {reported:?}");
        let (_, done, total) = reported.last().expect("law: progress is reported");
        assert!(*done > 0.0 && (done - total).abs() < 1e-9, "law: all is done: {done} of {total}");
        let never_less = reported.windows(2).all(|pair| pair[0].1 <= pair[1].1);
        assert!(never_less, "law: what is done stays done, got {reported:?}");
    }

    /// Law: a command that leaves all its files or none stops before it writes them.
    #[test]
    fn what_is_stopped_before_it_writes_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
        let (file, out, to) = (path("small.json"), path("out"), path("to"));
        let (png, svg, html) = (path("to/a.png"), path("to/a.svg"), path("to/a.html"));
        std::fs::write(&file, small().to_string()).expect("a scenario");
        let (ended, _) = run(&["run", &file, "--no-figures", "--out", &out], false);
        assert_eq!(ended.code, 0, "{ended:?}");
        let commands: [&[&str]; 9] = [
            &["grains", &file, "--out", &to],
            &["export", &out, "--format", "csv", "--out", &to],
            &["export", &out, "--format", "vtk", "--out", &to],
            &["export", &out, "--format", "glb", "--animate", "--out", &to],
            &["picture", &out, "--width", "128", "--out", &png],
            &["picture", &out, "--width", "128", "--grains", "--out", &png],
            &["picture", &out, "--width", "128", "--animate", &png],
            &["plot", &out, "--x", "time_s", "--y", "kinetic_energy_j", "--out", &svg],
            &["view", &out, "--save", &html],
        ];
        for words in commands {
            let (ended, _) = run(words, true);
            let got = (ended.code, ended.error.as_deref());
            assert_eq!(got, (130, Some("stopped; nothing is written")), "law: of {words:?}");
            assert!(!Path::new(&to).exists(), "law: {words:?} leaves nothing, not even a folder");
        }
    }

    /// Law: code and words of an error are the program's.
    #[test]
    fn errors_are_values() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("bad.json");
        let mut bad = small();
        bad["engine"] = serde_json::json!({ "rate_hz": -1 });
        bad["gravitation"] = 1.into();
        std::fs::write(&file, bad.to_string()).expect("a scenario");
        let file = file.to_str().expect("UTF-8");
        let out = folder.path().join("out");
        let out = out.to_str().expect("UTF-8");
        let (ended, _) = run(&["run", file, "--out", out], false);
        let said = ended.error.unwrap_or_default();
        assert_eq!(ended.code, 2, "{said}");
        assert!(
            said.contains("rate_hz") && said.contains("gravitation"),
            "law: all faults: {said}"
        );
        let cases: [(&[&str], u8, &str); 6] = [
            (&["run", "/nowhere/a.json", "--out", out], 4, "/nowhere/a.json"),
            (&["run", file], 2, "--out"),
            (&["view", out], 2, "--save"),
            (&["completions", "bash"], 2, "shells"),
            (&["sweep", file, "--over", "seed=1,2", "--slurm", "--out", out], 2, "--slurm"),
            (&["readings"], 2, "interpretations"),
        ];
        for (words, code, what) in cases {
            let (ended, _) = run(words, false);
            let said = ended.error.unwrap_or_default();
            assert_eq!(ended.code, code, "{words:?}: {said}");
            assert!(said.contains(what), "law: {words:?} says `{what}`, got `{said}`");
        }
    }

    /// Law: results are handed back, not printed, and commands may run side by side.
    #[test]
    fn results_are_handed_back() {
        let asked = || {
            let (ended, told) = run(&["info"], false);
            assert_eq!((ended.code, told), (0, Vec::new()));
            let info: serde_json::Value = serde_json::from_str(&ended.printed).expect("JSON");
            assert!(info.is_object(), "law: JSON, got {info}");
        };
        std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(asked)).collect();
            threads.into_iter().for_each(|t| t.join().expect("law: as one alone"));
        });
        let (ended, _) = run(&["--version"], false);
        assert_eq!(ended.printed.trim(), concat!("pluvia ", env!("CARGO_PKG_VERSION")));
    }
}
