//! How many cores a command may use, and the threads on which it uses them.

use std::env;
use std::sync::mpsc;

use super::*;

#[derive(Debug, Clone, Copy, Default, Args)]
pub(super) struct Jobs {
    /// Number of cores: that many stages run in parallel; when fewer are left, each uses several
    /// threads. Limited to the available cores; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = whole(1_u16, 1024), allow_negative_numbers = true)]
    jobs: Option<u16>,
}

impl Jobs {
    /// The cores asked for, or as many as there are, with a warning.
    pub(super) fn cores(self) -> usize {
        cores_for(self.jobs)
    }
}

/// The same of the value of an option `--jobs`.
pub(super) fn cores_for(jobs: Option<u16>) -> usize {
    let there = available_cores();
    let asked = jobs.map_or(there, usize::from);
    if asked > there {
        say(&format!("warning: --jobs {asked} exceeds the {there} available cores; using {there}"));
    }
    asked.min(there)
}

/// Whether the threads of [`start_pool`] are there.
static STARTED: Mutex<bool> = Mutex::new(false);

/// Starts the threads that share work within commands, unless they are there: as many as there
/// are cores, or fewer where the system gives no more.
///
/// # Errors
/// When the system gives none.
pub(super) fn start_pool() -> Result<(), CliError> {
    let mut started = lock(&STARTED);
    if *started {
        return Ok(());
    }
    let asked = env::var("RAYON_NUM_THREADS").ok().and_then(|n| n.parse().ok());
    let wanted = asked.filter(|n| *n > 0).unwrap_or_else(available_cores);
    // The pool is started once or never: what it can have is found out before.
    let given = can_be_started(wanted)?;
    let built = rayon::ThreadPoolBuilder::new().num_threads(given).build_global();
    built.map_err(|e| CliError::Threads(e.to_string()))?;
    *started = true;
    Ok(())
}

/// How many threads of those wanted can be there at the same time.
fn can_be_started(wanted: usize) -> Result<usize, CliError> {
    let mut waiting = Vec::new();
    for n in 0..wanted {
        let (go, gone) = mpsc::channel::<()>();
        let begin = thread::Builder::new().spawn(move || gone.recv().is_ok());
        match begin {
            Ok(thread) => waiting.push((go, thread)),
            Err(error) if n == 0 => return Err(CliError::Threads(error.to_string())),
            Err(_) => break,
        }
    }
    let given = waiting.len();
    for (go, thread) in waiting {
        drop(go);
        drop(thread.join());
    }
    Ok(given)
}
