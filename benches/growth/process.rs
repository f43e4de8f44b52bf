//! Processes that measure, each one world: alone, or several at once that begin together and keep
//! their cores busy until all have measured.

use std::{
    io::{self, BufRead, BufReader, Read, Write},
    path::Path,
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use super::measured::{Measured, State};

/// First argument of a process that measures.
pub const MEASURE: &str = "measure";

/// Last argument of one that measures at once with others.
pub const BESIDE: &str = "beside";

/// It has done the steps before, and waits.
const READY: &str = "ready";

/// The answer when all are ready.
const BEGIN: &str = "begin";

/// It has measured, and stays busy until its input ends.
const DONE: &str = "done";

/// Has a process of its own measure.
pub fn alone(specimen: &Path, state: State, threads: u32) -> Result<Measured, String> {
    let mut command = command(specimen, state, threads)?;
    let output = command.output().map_err(|e| format!("{:?}: {e}", command.get_program()))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|e| e.to_string())
}

/// Has several processes measure at once, each a world of its own; the steps are those of all.
pub fn at_once(
    worlds: usize,
    specimen: &Path,
    state: State,
    threads: u32,
) -> Result<Measured, String> {
    let beside = |_: usize| -> Result<Command, String> {
        let mut command = command(specimen, state, threads)?;
        command.arg(BESIDE);
        Ok(command)
    };
    let commands = (0..worlds).map(beside).collect::<Result<Vec<_>, _>>()?;
    let mut all: Option<Measured> = None;
    for text in together(commands)? {
        let measured: Measured = serde_json::from_str(&text).map_err(|e| e.to_string())?;
        match &mut all {
            None => all = Some(measured),
            Some(all) => all.steps.extend(measured.steps),
        }
    }
    all.ok_or_else(|| "no world".to_owned())
}

fn command(specimen: &Path, state: State, threads: u32) -> Result<Command, String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut command = if state == State::ShakenOneCore {
        let mut command = Command::new("taskset");
        command.args(["-c", "0"]).arg(program);
        command
    } else {
        Command::new(program)
    };
    command.args([MEASURE.as_ref(), specimen.as_os_str()]);
    command.args([state.to_string(), threads.to_string()]);
    Ok(command)
}

/// Lets processes that speak as [`Beside`] does measure together; what each says at its end.
pub fn together(commands: Vec<Command>) -> Result<Vec<String>, String> {
    let mut processes = commands.into_iter().map(Process::start).collect::<Result<Vec<_>, _>>()?;
    processes.iter_mut().try_for_each(|process| process.hear(READY))?;
    processes.iter_mut().try_for_each(|process| process.say(BEGIN))?;
    processes.iter_mut().try_for_each(|process| process.hear(DONE))?;
    // What they say at the end is long: none says it while another one measures.
    processes.iter_mut().for_each(|process| process.input = None);
    processes.iter_mut().map(Process::result).collect()
}

/// A process that measures at once with others. It is ended when this is dropped.
struct Process {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Process {
    fn start(mut command: Command) -> Result<Self, String> {
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|e| format!("{:?}: {e}", command.get_program()))?;
        let input = child.stdin.take();
        let output = BufReader::new(child.stdout.take().expect("it is piped"));
        Ok(Self { child, input, output })
    }

    /// Waits for a word.
    fn hear(&mut self, word: &str) -> Result<(), String> {
        let mut line = String::new();
        match self.output.read_line(&mut line) {
            Ok(_) if line.trim_end() == word => Ok(()),
            Ok(_) => Err(self.why(format!("expected `{word}`, got `{}`", line.trim_end()))),
            Err(e) => Err(self.why(e.to_string())),
        }
    }

    fn say(&mut self, word: &str) -> Result<(), String> {
        let said = self.input.as_mut().map_or(Ok(()), |input| writeln!(input, "{word}"));
        said.map_err(|e| self.why(e.to_string()))
    }

    /// The rest of what it says.
    fn result(&mut self) -> Result<String, String> {
        let mut text = String::new();
        self.output.read_to_string(&mut text).map_err(|e| e.to_string())?;
        let status = self.child.wait().map_err(|e| e.to_string())?;
        if status.success() { Ok(text) } else { Err(self.why(status.to_string())) }
    }

    /// What it says of its failure; if nothing, the fault.
    fn why(&mut self, fault: String) -> String {
        let _ = self.child.kill();
        let mut said = String::new();
        if let Some(mut errors) = self.child.stderr.take() {
            let _ = errors.read_to_string(&mut said);
        }
        if said.trim().is_empty() { fault } else { said }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // None is busy while something else is measured.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A process's own side of it.
pub struct Beside<W> {
    output: W,
    over: Arc<AtomicBool>,
}

impl<W: Write> Beside<W> {
    /// Says that it is ready, and waits until all are.
    pub fn begin(mut input: impl BufRead + Send + 'static, mut output: W) -> io::Result<Self> {
        writeln!(output, "{READY}")?;
        output.flush()?;
        let mut line = String::new();
        input.read_line(&mut line)?;
        if line.trim_end() != BEGIN {
            let fault = format!("expected `{BEGIN}`, got `{}`", line.trim_end());
            return Err(io::Error::other(fault));
        }
        let over = Arc::new(AtomicBool::new(false));
        let ended = Arc::clone(&over);
        thread::spawn(move || {
            let _ = io::copy(&mut input, &mut io::sink());
            ended.store(true, Ordering::Relaxed);
        });
        Ok(Self { output, over })
    }

    /// Says that it has measured, and works on until all have.
    pub fn stay_busy(mut self, mut work: impl FnMut()) -> io::Result<()> {
        writeln!(self.output, "{DONE}")?;
        self.output.flush()?;
        while !self.over.load(Ordering::Relaxed) {
            work();
        }
        Ok(())
    }
}
