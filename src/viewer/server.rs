//! A server for one page, on the loopback address alone.
//!
//! It reads a request's head and nothing more, answers from memory and closes
//! the connection: no file is opened for anybody. `httparse` reads the heads;
//! lengths, times and the number of connections are bounded here.
//!
//! Whoever does not name the token of the address gets a few words and no thread,
//! and one who is slow to ask waits in a queue that the next ones shorten: other
//! users of the machine can connect as often as they like, and keep nobody from being served.

use std::{
    collections::VecDeque,
    io::{self, ErrorKind, Read, Write},
    net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use super::page::Site;
use super::request::{Answer, Door, LONGEST_HEAD, Token};

/// How long a request's head may take to arrive.
const HEAD_TIME: Duration = Duration::from_secs(5);

/// How long a reader may take nothing of an answer.
const WRITE_TIME: Duration = Duration::from_secs(30);

/// Answers with content at one time; a browser asks for about six.
const MOST_ANSWERS: usize = 32;

/// Connections whose requests are not there yet. A browser's arrives within
/// milliseconds; of more than these the oldest are closed.
const MOST_WAITING: usize = 256;

/// Connections that are taken before those that wait are looked at.
const MOST_AT_ONCE: usize = 64;

/// Time between two looks at connections that wait.
const LOOK: Duration = Duration::from_millis(2);

/// What is read of a request's body before its connection is closed, so that
/// the sender sees the answer and not a broken connection, and how long that may take.
const LONGEST_REST: usize = 64 * 1024;
const REST_TIME: Duration = Duration::from_millis(200);

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
#[error("cannot listen on 127.0.0.1 port {port}: {reason}")]
pub struct ServerError {
    /// The port asked for; 0 stands for any free one.
    pub port: u16,
    /// What the system said.
    pub reason: io::Error,
}

/// A running server; it ends when it is dropped.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    token: Token,
    ended: Arc<AtomicBool>,
    asked: Arc<AtomicBool>,
    listening: Option<thread::JoinHandle<()>>,
}

impl Server {
    /// Serves a page on a port of the loopback address, on a free one if the port is 0.
    ///
    /// # Errors
    /// When the port is taken or not allowed, or the system gives no random numbers.
    pub fn start(site: Site, port: u16) -> Result<Self, ServerError> {
        let refused = |reason| ServerError { port, reason };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let token = Token::new().map_err(refused)?;
        let ended = Arc::new(AtomicBool::new(false));
        let end = ended.clone();
        let listener = Listener {
            listener,
            door: Arc::new(Door { site, port: address.port(), token: token.clone() }),
            busy: Arc::default(),
            waiting: VecDeque::new(),
            asked: Arc::default(),
        };
        let asked = listener.asked.clone();
        let listening = thread::Builder::new()
            .name("viewer".to_owned())
            .spawn(move || listener.listen(&end))
            .map_err(refused)?;
        Ok(Self { address, token, ended, asked, listening: Some(listening) })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Whether somebody who knows the address has asked for the page.
    pub fn was_asked(&self) -> bool {
        self.asked.load(Ordering::SeqCst)
    }

    /// What to type into a browser. Whoever knows it, on this machine, can read the run.
    pub fn url(&self) -> String {
        format!("http://{}{}/", self.address, self.token.path())
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::SeqCst);
        // The listener waits for a connection; this is one.
        let woken = TcpStream::connect_timeout(&self.address, Duration::from_secs(1)).is_ok();
        if let Some(listening) = self.listening.take().filter(|_| woken) {
            let _ = listening.join();
        }
    }
}

/// The listening thread, and what it keeps.
struct Listener {
    listener: TcpListener,
    door: Arc<Door>,
    /// Answers that are being sent.
    busy: Arc<AtomicUsize>,
    /// The oldest first.
    waiting: VecDeque<Waiting>,
    /// Whether anything was handed out.
    asked: Arc<AtomicBool>,
}

/// A connection whose request is not there yet.
struct Waiting {
    stream: TcpStream,
    since: Instant,
    received: Vec<u8>,
}

impl Listener {
    fn listen(mut self, end: &AtomicBool) {
        while !end.load(Ordering::SeqCst) {
            // With nobody to look at, the next connection is waited for.
            let idle = self.waiting.is_empty();
            if let Err(error) = self.listener.set_nonblocking(!idle) {
                tracing::debug!("the listener fails: {error}");
            }
            let more = if idle { 1 } else { MOST_AT_ONCE };
            for _ in 0..more {
                match self.listener.accept() {
                    Ok((stream, _)) => self.take(stream),
                    Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                    Err(error) => {
                        // Out of handles, for instance: the oldest closes its own.
                        tracing::debug!("a connection failed: {error}");
                        self.waiting.pop_front();
                        thread::sleep(LOOK);
                        break;
                    }
                }
            }
            for mut waiting in std::mem::take(&mut self.waiting) {
                match waiting.look(&self.door) {
                    Look::Wait => self.waiting.push_back(waiting),
                    Look::Answer => self.answer(waiting),
                    Look::Close => {}
                }
            }
            if !self.waiting.is_empty() {
                thread::sleep(LOOK);
            }
        }
    }

    fn take(&mut self, stream: TcpStream) {
        if stream.set_nonblocking(true).is_err() {
            return;
        }
        if self.waiting.len() >= MOST_WAITING {
            self.waiting.pop_front();
        }
        self.waiting.push_back(Waiting { stream, since: Instant::now(), received: Vec::new() });
    }

    /// Sends an answer: content by a thread of its own, a refusal at once.
    fn answer(&self, waiting: Waiting) {
        let Waiting { stream, received, .. } = waiting;
        let has_content = self.door.answer(&received).is_some_and(|a| a.resource.is_some());
        if !has_content {
            let refusal = self.door.answer(&received);
            refuse(&stream, &refusal.unwrap_or(Answer::refusal(408, "Request Timeout")));
            return;
        }
        self.asked.store(true, Ordering::SeqCst);
        if self.busy.fetch_add(1, Ordering::SeqCst) >= MOST_ANSWERS {
            self.busy.fetch_sub(1, Ordering::SeqCst);
            refuse(&stream, &Answer::refusal(503, "Service Unavailable"));
            return;
        }
        let (door, counted) = (self.door.clone(), Busy(self.busy.clone()));
        let spawned = thread::Builder::new().name("viewer-answer".to_owned()).spawn(move || {
            let _counted = counted;
            if let Some(answer) = door.answer(&received)
                && let Err(error) = send(&stream, &answer)
            {
                tracing::debug!("a connection ended early: {error}");
            }
        });
        if let Err(error) = spawned {
            tracing::debug!("no thread for a connection: {error}");
        }
    }
}

/// What becomes of a connection.
enum Look {
    Wait,
    Answer,
    Close,
}

impl Waiting {
    /// Reads what has arrived.
    fn look(&mut self, door: &Door) -> Look {
        let mut part = [0; 2048];
        loop {
            match self.stream.read(&mut part) {
                Ok(0) => return Look::Close,
                Ok(read) => self.received.extend_from_slice(&part[..read]),
                Err(e) if e.kind() == ErrorKind::WouldBlock => break,
                Err(e) if e.kind() == ErrorKind::Interrupted => continue,
                Err(_) => return Look::Close,
            }
            self.received.truncate(LONGEST_HEAD);
            if door.answer(&self.received).is_some() {
                return Look::Answer;
            }
        }
        if self.since.elapsed() > HEAD_TIME { Look::Answer } else { Look::Wait }
    }
}

/// One of the answers that are being sent, until it is dropped.
struct Busy(Arc<AtomicUsize>);

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Sends a few words without waiting: they fit into what the system keeps for a connection.
fn refuse(stream: &TcpStream, refusal: &Answer) {
    let mut stream = stream;
    let _ = stream.write_all(&refusal.bytes());
    let _ = stream.shutdown(Shutdown::Write);
    // What has arrived and is not read would break the connection before the words are read.
    let mut rest = [0; 4096];
    let mut left = LONGEST_REST;
    while left > 0 {
        match stream.read(&mut rest) {
            Ok(0) | Err(_) => break,
            Ok(read) => left = left.saturating_sub(read),
        }
    }
}

/// Sends content, as fast as it is taken.
fn send(stream: &TcpStream, answer: &Answer) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_write_timeout(Some(WRITE_TIME))?;
    let mut stream = stream;
    stream.write_all(&answer.bytes())?;
    stream.shutdown(Shutdown::Write)?;
    let latest = Instant::now() + REST_TIME;
    let mut rest = [0; 4096];
    let mut read = 0;
    while read < LONGEST_REST {
        let left = latest.saturating_duration_since(Instant::now());
        if left.is_zero() {
            break;
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut rest) {
            Ok(0) | Err(_) => break,
            Ok(more) => read += more,
        }
    }
    Ok(())
}
