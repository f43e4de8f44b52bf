//! A server for one page, on the loopback address alone.
//!
//! It reads a request's head and nothing more, answers from memory and closes
//! the connection: no file is opened for anybody. `httparse` reads the heads;
//! lengths, times and the number of connections are bounded here.

use std::{
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
use super::request::{Answer, LONGEST_HEAD, answer};

/// How long a request's head may take to arrive.
const HEAD_TIME: Duration = Duration::from_secs(5);

/// How long a reader may take nothing of an answer.
const WRITE_TIME: Duration = Duration::from_secs(30);

/// Connections at one time; a browser opens about six.
const MOST_CONNECTIONS: usize = 32;

/// What is read of a request's body before its connection is closed, so that
/// the sender sees the answer and not a broken connection.
const LONGEST_REST: usize = 64 * 1024;

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
    ended: Arc<AtomicBool>,
    listening: Option<thread::JoinHandle<()>>,
}

impl Server {
    /// Serves a page on a port of the loopback address, on a free one if the
    /// port is 0.
    ///
    /// # Errors
    /// When the port is taken or not allowed.
    pub fn start(site: Site, port: u16) -> Result<Self, ServerError> {
        let refused = |reason| ServerError { port, reason };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let ended = Arc::new(AtomicBool::new(false));
        let end = ended.clone();
        let site = Arc::new(site);
        let listening = thread::Builder::new()
            .name("viewer".to_owned())
            .spawn(move || listen(&listener, &site, address.port(), &end))
            .map_err(refused)?;
        Ok(Self { address, ended, listening: Some(listening) })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What to type into a browser.
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
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

fn listen(listener: &TcpListener, site: &Arc<Site>, port: u16, end: &AtomicBool) {
    let busy = Arc::new(AtomicUsize::new(0));
    while !end.load(Ordering::SeqCst) {
        let stream = match listener.accept() {
            Ok((stream, _)) => stream,
            Err(error) => {
                tracing::debug!("a connection failed: {error}");
                // Out of handles, for instance: others must close theirs first.
                thread::sleep(Duration::from_millis(50));
                continue;
            }
        };
        if busy.fetch_add(1, Ordering::SeqCst) >= MOST_CONNECTIONS {
            busy.fetch_sub(1, Ordering::SeqCst);
            // Nothing is read: whoever sends much is cut off.
            let refusal = Answer::refusal(503, "Service Unavailable").bytes();
            let _ = stream.set_nonblocking(true).and_then(|()| (&stream).write_all(&refusal));
            continue;
        }
        let (site, counted) = (site.clone(), Busy(busy.clone()));
        let spawned = thread::Builder::new().name("viewer-answer".to_owned()).spawn(move || {
            let _counted = counted;
            if let Err(error) = serve(&stream, &site, port) {
                tracing::debug!("a connection ended early: {error}");
            }
        });
        if let Err(error) = spawned {
            tracing::debug!("no thread for a connection: {error}");
        }
    }
}

/// One of the connections that are open, until it is dropped.
struct Busy(Arc<AtomicUsize>);

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

fn serve(stream: &TcpStream, site: &Site, port: u16) -> io::Result<()> {
    stream.set_write_timeout(Some(WRITE_TIME))?;
    let answer = read_and_answer(stream, site, port)?;
    let mut stream = stream;
    stream.write_all(&answer.bytes())?;
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(Duration::from_millis(200)))?;
    let mut rest = [0; 4096];
    let mut left = LONGEST_REST;
    while left > 0 {
        match stream.read(&mut rest) {
            Ok(0) | Err(_) => break,
            Ok(read) => left = left.saturating_sub(read),
        }
    }
    Ok(())
}

/// Reads until there is an answer: a whole head, or enough to refuse.
fn read_and_answer<'a>(
    mut stream: &TcpStream,
    site: &'a Site,
    port: u16,
) -> io::Result<Answer<'a>> {
    let latest = Instant::now() + HEAD_TIME;
    let mut received = Vec::new();
    let mut part = [0; 2048];
    loop {
        let left = latest.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(Answer::refusal(408, "Request Timeout"));
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut part) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(read) => received.extend_from_slice(&part[..read]),
            Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => continue,
            Err(e) if e.kind() == ErrorKind::Interrupted => continue,
            Err(e) => return Err(e),
        }
        received.truncate(LONGEST_HEAD);
        if let Some(answer) = answer(site, port, &received) {
            return Ok(answer);
        }
    }
}
