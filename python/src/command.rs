//! A command of the program, run while Python's other threads go on.

use std::{
    ffi::OsString,
    process,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU32, Ordering},
        mpsc::{self, Receiver, RecvTimeoutError},
    },
    thread,
    time::{Duration, Instant},
};

use pluvia::cli::{Ended, News, embedded};
use pyo3::{exceptions::PyRuntimeError, prelude::*};

/// Time between two looks whether the user asked to stop, and between two words on progress.
const LOOK: Duration = Duration::from_millis(50);

/// The process in which threads of the library were started.
static STARTED_IN: AtomicU32 = AtomicU32::new(0);

/// How far a command is: stage, done, total, note.
type Far = (String, f64, f64, String);

/// Runs the command of the words that stand behind `pluvia` on a command line, and gives its exit
/// code, what it printed, and why it did not do what it was asked, if so.
///
/// `message(text)` and `progress(stage, done, total, note)` are called on the calling thread, which
/// holds no GIL meanwhile. A signal that raises (Ctrl-C), or a callback that does, stops the command at a
/// resumable point, and is raised then; callbacks are not called any more. A signal that raises
/// after that is raised at once; the command then stops by itself.
#[pyfunction]
pub fn command(
    py: Python<'_>,
    words: Vec<OsString>,
    message: Py<PyAny>,
    progress: Py<PyAny>,
) -> PyResult<(u8, String, Option<String>)> {
    let own = process::id();
    let first = STARTED_IN.compare_exchange(0, own, Ordering::SeqCst, Ordering::SeqCst);
    if first.is_err_and(|started_in| started_in != own) {
        return Err(PyRuntimeError::new_err(
            "pluvia was used before this process was forked, and its threads stayed behind; start \
             processes with multiprocessing.get_context(\"spawn\")",
        ));
    }
    let cancel = Arc::new(AtomicBool::new(false));
    let (tell, mut told) = mpsc::channel();
    let (end, mut ended) = mpsc::channel();
    let asked = cancel.clone();
    thread::Builder::new().name("pluvia-python".to_owned()).spawn(move || {
        let done = embedded(&words, &asked, move |news| drop(tell.send(news)));
        // Nobody waits after a second Ctrl-C.
        drop(end.send(done));
    })?;
    let mut raised: Option<PyErr> = None;
    loop {
        // One at a time may listen.
        let (told, ended) = (&mut told, &mut ended);
        let (done, messages, far) = py.detach(move || listen(told, ended));
        // A callback that raises each time would end the waiting while the command is still at work.
        let heard = match raised {
            None => hear(py, &message, &progress, messages, far),
            Some(_) => Ok(()),
        };
        if let Err(error) = heard.and_then(|()| py.check_signals()) {
            if raised.is_some() {
                return Err(error);
            }
            cancel.store(true, Ordering::SeqCst);
            raised = Some(error);
        }
        match (done, raised.take()) {
            (Some(_), Some(error)) => return Err(error),
            (Some(Ended { code, printed, error }), None) => return Ok((code, printed, error)),
            (None, earlier) => raised = earlier,
        }
    }
}

/// Waits a moment for the command's end; what was said meanwhile, and how far it is.
fn listen(
    told: &Receiver<News>,
    ended: &Receiver<Ended>,
) -> (Option<Ended>, Vec<String>, Option<Far>) {
    let (mut messages, mut far) = (Vec::new(), None);
    let until = Instant::now() + LOOK;
    let done = match ended.recv_timeout(until - Instant::now()) {
        Ok(done) => Some(done),
        Err(RecvTimeoutError::Timeout) => None,
        Err(RecvTimeoutError::Disconnected) => {
            let error = Some("the command's thread ended without a result".to_owned());
            Some(Ended { code: 3, printed: String::new(), error })
        }
    };
    for news in told.try_iter() {
        match news {
            News::Message(text) => messages.push(text),
            News::Progress { stage, done, total, note } => far = Some((stage, done, total, note)),
        }
    }
    (done, messages, far)
}

/// Calls the callbacks.
fn hear(
    py: Python<'_>,
    message: &Py<PyAny>,
    progress: &Py<PyAny>,
    messages: Vec<String>,
    far: Option<Far>,
) -> PyResult<()> {
    for text in messages {
        message.call1(py, (text,))?;
    }
    if let Some(far) = far {
        progress.call1(py, far)?;
    }
    Ok(())
}
