//! `pluvia view`: the server as others on the machine may meet it, and the page
//! in a real browser.

pub mod browser;
mod hostile;
#[cfg(target_os = "linux")]
mod opened;
mod page;

use std::{
    fs,
    io::{BufRead, BufReader, ErrorKind, Read, Write},
    net::{Ipv4Addr, Shutdown, SocketAddr, TcpStream, UdpSocket},
    path::Path,
    process::Stdio,
    time::Duration,
};

use pluvia::viewer::{Server, Site, read_run_data};

use super::{
    export::small_run,
    program::{ended, pluvia, refused, said, send, text},
};

/// The page of the small run on a free port.
fn serve(run: &Path) -> Server {
    let data = read_run_data(run).expect("the run can be read");
    Server::start(Site::new(data), 0).expect("a free port")
}

/// Sends bytes and reads what comes back until the connection ends.
fn exchange(address: SocketAddr, request: &[u8]) -> Vec<u8> {
    let mut stream = TcpStream::connect(address).expect("the server listens");
    stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a timeout");
    // A refused request may be cut off while it is sent.
    let _ = stream.write_all(request);
    let _ = stream.shutdown(Shutdown::Write);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    answer
}

/// How the paths begin that the server answers: a slash and its token.
fn secret(server: &Server) -> String {
    let url = server.url();
    let path = url.trim_end_matches('/').rsplit('/').next().expect("a token");
    format!("/{path}")
}

fn get(server: &Server, path: &str) -> Vec<u8> {
    let (host, secret) = (server.address(), secret(server));
    exchange(host, format!("GET {secret}{path} HTTP/1.1\r\nHost: {host}\r\n\r\n").as_bytes())
}

fn status(answer: &[u8]) -> String {
    String::from_utf8_lossy(answer).lines().next().unwrap_or_default().to_owned()
}

/// Whether a status has one of these codes.
fn is_one_of(status: &str, codes: &[u16]) -> bool {
    codes.iter().any(|code| status.starts_with(&format!("HTTP/1.1 {code} ")))
}

fn assert_status(answer: &[u8], expected: u16, law: &str) {
    let got = status(answer);
    assert!(is_one_of(&got, &[expected]), "law: {law}, expected {expected}, got `{got}`");
}

#[test]
fn the_page_and_the_run_are_served_and_nothing_else() {
    let server = serve(small_run());
    assert_status(&get(&server, "/"), 200, "the page is there");
    let whole = get(&server, "/run.bin");
    let body = whole.windows(4).position(|w| w == b"\r\n\r\n").expect("a head") + 4;
    let expected = read_run_data(small_run()).expect("the run").bytes;
    assert!(whole[body..] == expected, "law: the run comes over the wire byte by byte");
    for path in ["/grains.csv", "/../manifest.json", "/%2e%2e/%2e%2e/etc/passwd", "//", "/\\..\\a"]
    {
        assert_status(&get(&server, path), 404, path);
    }
    // Read as a whole first, or a pair of dots would be lost on the way.
    let raw = format!(
        "GET {}/run.bin/../../x HTTP/1.1\r\nHost: {}\r\n\r\n",
        secret(&server),
        server.address()
    );
    assert_status(&exchange(server.address(), raw.as_bytes()), 404, "dots lead nowhere");
}

#[test]
fn only_the_loopback_address_listens() {
    let server = serve(small_run());
    assert!(server.address().ip().is_loopback(), "law: {} is loopback", server.address());
    // The address by which others would reach this machine; no packet is sent.
    let outward = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))
        .and_then(|socket| socket.connect("192.0.2.1:9").and_then(|()| socket.local_addr()));
    let Ok(outward) = outward.map(|address| address.ip()) else { return };
    if !outward.is_loopback() {
        let there = SocketAddr::new(outward, server.address().port());
        let got = TcpStream::connect_timeout(&there, Duration::from_secs(2));
        assert!(got.is_err(), "law: nobody else reaches the page, but {there} answers");
    }
}

#[test]
fn it_ends_when_it_is_dropped() {
    let asked_after_the_end = || {
        let server = serve(small_run());
        let address = server.address();
        drop(server);
        TcpStream::connect_timeout(&address, Duration::from_secs(2)).map(|_| ())
    };
    // Another program may be given the same port at once, but hardly every time.
    let got = [(); 3].map(|()| asked_after_the_end());
    let refused = |e: &std::io::Error| e.kind() == ErrorKind::ConnectionRefused;
    let refused = got.iter().any(|got| got.as_ref().is_err_and(refused));
    assert!(refused, "law: nobody listens any more, got {got:?}");
}

#[test]
fn the_command_serves_until_ctrl_c() {
    let mut command = pluvia();
    command.arg("view").arg(small_run()).args(["--no-browser"]).stdout(Stdio::piped());
    let mut child = command.spawn().expect("it starts");
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let address = loop {
        let line = lines.next().expect("an address is printed").expect("text");
        if let Some(rest) = line.strip_prefix("http://") {
            break rest.split(' ').next().unwrap_or_default().to_owned();
        }
    };
    let (address, path) = address.split_once('/').expect("a host and a path");
    let address: SocketAddr = address.parse().expect("an address and a port");
    let ask = |path: &str| {
        let request = format!("GET /{path} HTTP/1.1\r\nHost: {address}\r\n\r\n");
        exchange(address, request.as_bytes())
    };
    assert_status(&ask(path), 200, "the page is there");
    for path in ["", "run.bin", "viewer.js"] {
        assert_status(&ask(path), 403, "without the token of the address nothing is read");
    }
    // A port that is taken is reported as such.
    let port = address.port().to_string();
    let second =
        pluvia().arg("view").arg(small_run()).args(["--no-browser", "--port", &port]).output();
    let second = second.expect("it starts");
    let said = said(&second);
    assert!(second.status.code() == Some(2) && said.contains(&port), "law: port taken: {said}");

    send(&child, "INT");
    let status = ended(child, Duration::from_secs(10), "Ctrl-C").status;
    assert_eq!(status.code(), Some(0), "law: Ctrl-C is the way to end it");
}

/// Law: a file that is there is kept, and replaced by force alone; its folder is made.
#[test]
fn a_file_is_saved_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("pages/of/run.html");
    let save = |more: &[&str]| {
        pluvia().arg("view").arg(small_run()).arg("--save").arg(&file).args(more).output()
    };
    let first = save(&[]).expect("it starts");
    assert_eq!(first.status.code(), Some(0), "{}", said(&first));
    let content = fs::read(&file).expect("the file");
    fs::write(&file, "another").expect("written");
    let second = save(&[]).expect("it starts");
    let told = said(&second);
    assert_eq!(second.status.code(), Some(2), "law: nothing is written over: {told}");
    assert!(told.contains("exists already") && told.contains("--force"), "{told}");
    assert!(fs::read(&file).expect("the file") == b"another", "law: it is as it was");
    let third = save(&["--force"]).expect("it starts");
    assert_eq!(third.status.code(), Some(0), "{}", said(&third));
    assert!(fs::read(&file).expect("the file") == content, "law: the page is there again");
    // A page is no other file of a run, by force either.
    let other = folder.path().join("summary.json");
    fs::write(&other, "numbers").expect("written");
    let words = ["view", text(small_run()), "--force", "--save", text(&other)];
    refused(&words, 2, &["--save", "summary.json", ".html"]);
    assert!(fs::read(&other).expect("the file") == b"numbers", "law: it is as it was");
}

#[test]
fn a_folder_that_is_no_run_is_told_as_such() {
    let folder = tempfile::tempdir().expect("a folder");
    refused(&["view", text(folder.path())], 2, &["manifest.json"]);
}
