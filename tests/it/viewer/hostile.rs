//! The server of `pluvia view` against requests that mean harm or are broken:
//! nothing but the page and the run comes back, and it goes on serving.

use std::{
    fs,
    io::{Read, Write},
    net::{Shutdown, TcpStream},
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use pluvia::viewer::Server;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::super::export::small_run;
use super::{assert_status, exchange, get, is_one_of, secret, serve, status};

/// A request for a target after the token, written as it is.
fn request(server: &Server, target: &[u8]) -> Vec<u8> {
    let (address, secret) = (server.address(), secret(server));
    let end = format!(" HTTP/1.1\r\nHost: {address}\r\n\r\n");
    [b"GET ", secret.as_bytes(), target, end.as_bytes()].concat()
}

/// Asserts that the page still comes; refusals for want of room pass.
fn assert_serves(server: &Server, after: &str) {
    let latest = Instant::now() + Duration::from_secs(20);
    loop {
        let got = status(&get(server, "/"));
        if is_one_of(&got, &[200]) {
            return;
        }
        assert!(Instant::now() < latest, "law: the page comes after {after}, got `{got}`");
        thread::sleep(Duration::from_millis(50));
    }
}

/// The content of an answer, whose head says how long it is.
fn content(answer: &[u8]) -> &[u8] {
    let head = answer.windows(4).position(|w| w == b"\r\n\r\n").map_or(answer.len(), |at| at + 4);
    let text = String::from_utf8_lossy(&answer[..head]).into_owned();
    let length = text.lines().find_map(|l| l.strip_prefix("Content-Length: "));
    let length: usize = length.and_then(|n| n.parse().ok()).expect("a length");
    let content = &answer[head..];
    assert_eq!(content.len(), length, "law: the length told is that of what comes");
    content
}

/// Every way of writing dots and slashes, before files that are there.
#[test]
fn no_spelling_leads_out_of_the_four_files() {
    let server = serve(small_run());
    let dots =
        ["..", "%2e%2e", "%2E.", ".%2e", "%252e%252e", "..%00", "%c0%ae%c0%ae", "....", "．．"];
    let slashes = ["/", "%2f", "%2F", "%5c", "\\", "//", "%252f", "%c0%af", "/./"];
    let files = ["manifest.json", "stages", "etc/passwd", "proc/self/environ"];
    let mut tried = 0;
    for dot in dots {
        for slash in slashes {
            for (deep, file) in [1, 2, 8, 12].into_iter().zip(files) {
                let up = format!("{dot}{slash}").repeat(deep);
                for begin in ["/", "", "/run.bin/", "/viewer.js?"] {
                    let target = format!("{begin}{up}{file}");
                    let answer = exchange(server.address(), &request(&server, target.as_bytes()));
                    tried += 1;
                    // What stands behind a question mark is no path.
                    if begin.ends_with('?') {
                        assert_status(&answer, 200, &target);
                        continue;
                    }
                    let got = status(&answer);
                    let is_refused = is_one_of(&got, &[404, 403, 400]);
                    assert!(is_refused, "law: `{target}` leads nowhere, got `{got}`");
                    let said = content(&answer);
                    assert!(said.len() < 50, "law: a refusal is a few words, got {}", said.len());
                }
            }
        }
    }
    assert!(tried > 1000, "the check tries many spellings, got {tried}");
}

#[test]
fn what_lies_in_the_folder_is_not_served() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    super::page::copy_without_frames(small_run(), &run);
    let server = serve(&run);
    fs::write(run.join("secret.txt"), "secret").expect("a file");
    std::os::unix::fs::symlink("/etc/passwd", run.join("link")).expect("a link");
    let names: Vec<_> = fs::read_dir(&run).expect("a folder").flatten().collect();
    assert!(names.len() > 5, "the check has files to ask for, got {}", names.len());
    for entry in names {
        let name = entry.file_name().into_string().expect("UTF-8");
        assert_status(&get(&server, &format!("/{name}")), 404, &name);
    }
    // Nor is the run read again: it may be gone.
    let before = get(&server, "/run.bin");
    fs::remove_dir_all(&run).expect("removed");
    assert!(get(&server, "/run.bin") == before, "law: what was read is served, from memory");
}

#[test]
fn broken_requests_are_refused_in_words() {
    let server = serve(small_run());
    let address = server.address();
    let host = format!("Host: {address}\r\n");
    let line = |line: &str| format!("{line}\r\n{host}\r\n").into_bytes();
    let fields = |fields: &str| {
        format!("GET {}/ HTTP/1.1\r\n{host}{fields}\r\n", secret(&server)).into_bytes()
    };
    let long = "a".repeat(20_000);
    let cases: Vec<(&str, Vec<u8>, &[u16])> = vec![
        ("a long target", line(&format!("GET /{long} HTTP/1.1")), &[431]),
        ("a long method", line(&format!("{long} / HTTP/1.1")), &[431]),
        ("a long field's name", fields(&format!("{long}: b\r\n")), &[431]),
        ("a long field", fields(&format!("A: {long}\r\n")), &[431]),
        ("two hundred fields", fields(&"A: b\r\n".repeat(200)), &[431]),
        ("no version", line("GET /"), &[400]),
        ("version 2", line("GET / HTTP/2.0"), &[400, 505]),
        ("HTTP/2's preface", b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n".to_vec(), &[400, 505]),
        ("no target", line("GET  HTTP/1.1"), &[400]),
        ("a NUL in the target", line("GET /\0 HTTP/1.1"), &[400]),
        ("a control character", line("GET /\x07 HTTP/1.1"), &[400]),
        ("no UTF-8", request(&server, b"/\xff\xfe"), &[400, 404]),
        ("a NUL in a field", fields("A: \0\r\n"), &[400]),
        ("a field without colon", fields("A\r\n"), &[400]),
        ("a field without name", fields(": b\r\n"), &[400]),
        ("a folded field", fields("A: b\r\n c\r\n"), &[400]),
        ("a space before the colon", fields("A : b\r\n"), &[400]),
        ("two hosts", fields("Host: evil.example\r\n"), &[400]),
        ("a bare carriage return", fields("A: b\rC: d\r\n"), &[400]),
        ("a length that is none", fields("Content-Length: -1\r\n"), &[200]),
        ("chunks that never come", fields("Transfer-Encoding: chunked\r\n"), &[200]),
        ("a change of protocol", fields("Connection: Upgrade\r\nUpgrade: h2c\r\n"), &[200]),
        ("a range", fields("Range: bytes=0-18446744073709551615\r\n"), &[200]),
        ("an expectation", fields("Expect: 100-continue\r\n"), &[200]),
        ("a tunnel", line("CONNECT example.org:443 HTTP/1.1"), &[405]),
        ("another site", line("GET http://example.org/ HTTP/1.1"), &[403]),
        ("no token", line("GET /run.bin HTTP/1.1"), &[403]),
    ];
    for (what, request, expected) in cases {
        let answer = exchange(address, &request);
        // What is refused while it is being sent may break the connection.
        if answer.is_empty() && request.len() > 16_000 {
            continue;
        }
        let got = status(&answer);
        let fits = is_one_of(&got, expected);
        assert!(fits, "law: {what} is answered by one of {expected:?}, got `{got}`");
        content(&answer);
    }
    // Two requests at once: one answer, and the end.
    let twice = [request(&server, b"/viewer.css"), request(&server, b"/run.bin")].concat();
    let answer = exchange(address, &twice);
    assert_status(&answer, 200, "the first of two is answered");
    content(&answer);
    assert_serves(&server, "broken requests");
}

/// Requests changed at a few places, at random: each is answered or cut off.
#[test]
fn random_requests_do_no_harm() {
    let server = serve(small_run());
    let address = server.address();
    let whole = format!(
        "GET {}/viewer.css HTTP/1.1\r\nHost: {address}\r\nAccept: */*\r\nContent-Length: 3\r\n\r\nabc",
        secret(&server)
    );
    let mut rng = Pcg64::seed_from_u64(9);
    let (mut answered, mut taken) = (0, 0);
    for _ in 0..300 {
        let mut request = whole.clone().into_bytes();
        for _ in 0..rng.random_range(1..5) {
            spoil(&mut request, &mut rng);
        }
        let answer = exchange(address, &request);
        if !answer.is_empty() {
            let got = status(&answer);
            assert!(got.starts_with("HTTP/1.1 "), "law: an answer is HTTP, got `{got}`");
            answered += 1;
            taken += usize::from(got.contains(" 200 "));
        }
    }
    assert!(answered > 150 && taken < answered, "{answered} answered, {taken} of them with 200");
    assert_serves(&server, "random requests");
}

fn spoil(request: &mut Vec<u8>, rng: &mut impl Rng) {
    let at = rng.random_range(0..request.len().max(1)).min(request.len());
    let end = (at + rng.random_range(1..20)).min(request.len());
    match rng.random_range(0..5) {
        0 if at < request.len() => request[at] = rng.random(),
        1 => drop(request.drain(at..end)),
        2 => {
            let piece = request[at..end].to_vec();
            request.splice(at..at, piece);
        }
        3 => {
            let pieces: [&[u8]; 6] = [b"\r\n", b"\0", b":", b"%2e%2e/", b"\xff", b" "];
            let piece = pieces[rng.random_range(0..pieces.len())].iter().copied();
            request.splice(at..at, piece);
        }
        _ => request.truncate(at),
    }
}

/// Whoever says half of it and waits is told so after some seconds; whoever
/// says it slowly is answered.
#[test]
fn half_and_slow_requests_end() {
    let server = serve(small_run());
    let address = server.address();
    let mut half = TcpStream::connect(address).expect("the server listens");
    half.write_all(b"GET / HTTP/1.1\r\nHost: ").expect("sent");

    let mut slow = TcpStream::connect(address).expect("the server listens");
    for (n, byte) in request(&server, b"/viewer.css").into_iter().enumerate() {
        slow.write_all(&[byte]).expect("sent");
        // All must arrive within 5 s, and on a busy machine the shortest pause may be long.
        if n % 8 == 0 {
            thread::sleep(Duration::from_millis(2));
        }
    }
    let mut answer = Vec::new();
    slow.read_to_end(&mut answer).expect("an answer");
    assert_status(&answer, 200, "byte by byte, but in time");

    let begun = Instant::now();
    half.set_read_timeout(Some(Duration::from_secs(30))).expect("a timeout");
    let mut answer = Vec::new();
    half.read_to_end(&mut answer).expect("an answer");
    assert_status(&answer, 408, "half a request is not waited for");
    assert!(begun.elapsed() < Duration::from_secs(25), "law: soon, took {:?}", begun.elapsed());

    // One who reads nothing of the answer and leaves.
    for _ in 0..50 {
        let mut gone = TcpStream::connect(address).expect("the server listens");
        let _ = gone.write_all(&request(&server, b"/run.bin"));
        let _ = gone.shutdown(Shutdown::Both);
    }
    assert_serves(&server, "readers that left");
}

#[test]
fn hundreds_of_connections_take_no_threads() {
    let server = serve(small_run());
    let address = server.address();
    // Those of servers and those that they begin: how many threads other tests have depends on the
    // machine. One without a name of its own has that of who began it.
    let threads = || {
        let tasks = fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
        let names = tasks.filter_map(|task| fs::read_to_string(task.path().join("comm")).ok());
        names.filter(|name| ["viewer", "viewer-answer"].contains(&name.trim_end())).count()
    };
    let before = threads();
    let mut held = Vec::new();
    for _ in 0..400 {
        let Ok(mut stream) = TcpStream::connect(address) else { continue };
        let _ = stream.write_all(b"GET / HTTP/1.1\r\nHo");
        held.push(stream);
    }
    assert!(held.len() > 300, "the check opens many, got {}", held.len());
    // Servers of other tests have some, too; 400 of them would be ours.
    let most = threads().saturating_sub(before);
    assert!(most < 150, "law: who has not asked yet gets no thread, got {most} more threads");
    assert_status(&get(&server, "/"), 200, "whoever asks is served while hundreds say half");
    let mut closed = 0;
    let oldest = held.len() - 260;
    for stream in &mut held[..oldest] {
        stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a timeout");
        let mut answer = [0; 64];
        closed += usize::from(matches!(stream.read(&mut answer), Ok(0) | Err(_)));
    }
    assert!(closed > 10, "law: of those who wait the oldest are closed, got {closed}");
}

/// Law: clients that come back as soon as they are cut off, with half a request each
/// or with a whole one that knows no token, keep nobody from being served.
#[test]
fn reconnecting_clients_keep_nobody_from_being_served() {
    let server = serve(small_run());
    let address = server.address();
    let over = AtomicBool::new(false);
    let refused = format!("GET /run.bin HTTP/1.1\r\nHost: {address}\r\n\r\n");
    thread::scope(|scope| {
        for n in 0..60 {
            let whole = if n % 2 == 0 { &refused.as_bytes()[..20] } else { refused.as_bytes() };
            let over = &over;
            scope.spawn(move || {
                while !over.load(Ordering::Relaxed) {
                    let Ok(mut stream) = TcpStream::connect(address) else { continue };
                    let _ = stream.set_read_timeout(Some(Duration::from_millis(500)));
                    let _ = stream.write_all(whole);
                    let _ = stream.read(&mut [0; 64]);
                }
            });
        }
        let served = (0..20).filter(|_| status(&get(&server, "/run.bin")).contains(" 200 "));
        let served = served.count();
        over.store(true, Ordering::Relaxed);
        assert_eq!(served, 20, "law: who knows the token is served, every time");
    });
}
