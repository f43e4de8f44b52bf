//! What is answered to a request, as a function of its bytes.

use std::io;

use httparse::{EMPTY_HEADER, Request, Status};
use rand::{TryRng, rngs::SysRng};

use super::page::{Resource, SITE_POLICY, Site};
use crate::input::hexadecimal;

/// Longest head of a request in bytes; a browser's have about 1000.
pub(super) const LONGEST_HEAD: usize = 16 * 1024;

/// Most header fields of a request; a browser sends about 20.
const MOST_FIELDS: usize = 100;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Answer<'a> {
    /// Status code and its words.
    pub status: (u16, &'static str),
    /// What is sent; of a refusal, its words.
    pub resource: Option<&'a Resource>,
    /// Whether the content itself is left out.
    pub head_only: bool,
}

impl Answer<'_> {
    /// No, and why.
    pub const fn refusal(code: u16, words: &'static str) -> Self {
        Self { status: (code, words), resource: None, head_only: false }
    }

    /// Head and content as they go over the wire. Every answer ends its connection.
    pub fn bytes(&self) -> Vec<u8> {
        let (code, words) = self.status;
        let refusal = format!("{code} {words}\n");
        let (kind, content) = match self.resource {
            Some(resource) => (resource.kind, resource.content.as_slice()),
            None => ("text/plain; charset=utf-8", refusal.as_bytes()),
        };
        let allow = if code == 405 { "Allow: GET, HEAD\r\n" } else { "" };
        let head = format!(
            "HTTP/1.1 {code} {words}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n{allow}\
             Content-Security-Policy: {SITE_POLICY}\r\nX-Content-Type-Options: nosniff\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\nReferrer-Policy: no-referrer\r\n\
             Cache-Control: no-store\r\nConnection: close\r\n\r\n",
            length = content.len(),
        );
        let mut bytes = head.into_bytes();
        if !self.head_only {
            bytes.extend_from_slice(content);
        }
        bytes
    }
}

/// What the address holds beside host and port, so that not every user of the machine
/// can read the run: 128 bits that nobody can guess.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Token(String);

impl Token {
    /// A new one, of random numbers of the system, which may give none.
    pub fn new() -> io::Result<Self> {
        let mut bytes = [0_u8; 16];
        SysRng.try_fill_bytes(&mut bytes).map_err(io::Error::other)?;
        Ok(Self(hexadecimal(&bytes)))
    }

    /// How paths begin that may be asked for; a slash follows.
    pub fn path(&self) -> String {
        format!("/{}", self.0)
    }

    /// What follows it in a path; none where it does not stand there. How long that takes
    /// does not tell how much of it was right.
    fn after<'p>(&self, path: &'p str) -> Option<&'p str> {
        let (given, rest) = path.strip_prefix('/')?.split_at_checked(self.0.len())?;
        let differing = given.bytes().zip(self.0.bytes()).fold(0, |all, (a, b)| all | (a ^ b));
        (differing == 0).then_some(rest)
    }
}

/// What is served, and to whom.
#[derive(Debug)]
pub(super) struct Door {
    /// The files.
    pub site: Site,
    /// The port that a request must name.
    pub port: u16,
    /// What its path must begin with.
    pub token: Token,
}

impl Door {
    /// The answer to what has arrived of a request; none when more must be read.
    ///
    /// A request must name this machine as its host: a page of another site that
    /// had its own name resolved to the loopback address (DNS rebinding) names itself.
    /// And it must know the token, which other users of this machine do not.
    pub fn answer(&self, received: &[u8]) -> Option<Answer<'_>> {
        let mut fields = [EMPTY_HEADER; MOST_FIELDS];
        let mut request = Request::new(&mut fields);
        match request.parse(received) {
            Ok(Status::Complete(_)) => {}
            Ok(Status::Partial) if received.len() < LONGEST_HEAD => return None,
            Ok(Status::Partial) | Err(httparse::Error::TooManyHeaders) => {
                return Some(Answer::refusal(431, "Request Header Fields Too Large"));
            }
            Err(httparse::Error::Version) => {
                return Some(Answer::refusal(505, "HTTP Version Not Supported"));
            }
            Err(_) => return Some(Answer::refusal(400, "Bad Request")),
        }
        let mut hosts = request.headers.iter().filter(|f| f.name.eq_ignore_ascii_case("host"));
        let Some(host) = hosts.next().filter(|_| hosts.next().is_none()) else {
            return Some(Answer::refusal(400, "Bad Request"));
        };
        if !is_this_machine(host.value, self.port) {
            return Some(Answer::refusal(403, "Forbidden"));
        }
        let head_only = match request.method {
            Some("GET") => false,
            Some("HEAD") => true,
            _ => return Some(Answer::refusal(405, "Method Not Allowed")),
        };
        let target = request.path.unwrap_or_default();
        let path = target.split_once('?').map_or(target, |(path, _)| path);
        let Some(path) = self.token.after(path) else {
            return Some(Answer::refusal(403, "Forbidden"));
        };
        let resource = self.site.get(path);
        let status = if resource.is_some() { (200, "OK") } else { (404, "Not Found") };
        Some(Answer { status, resource, head_only })
    }
}

/// The viewer's answers without a connection, for whoever tries very many requests; it has a
/// token of its own.
#[derive(Debug)]
pub struct Responder {
    door: Door,
}

impl Responder {
    /// One that serves a site as from a port.
    ///
    /// # Errors
    /// When the system gives no random numbers.
    pub fn new(site: Site, port: u16) -> io::Result<Self> {
        Ok(Self { door: Door { site, port, token: Token::new()? } })
    }

    /// How paths begin that are served; a slash follows.
    pub fn path(&self) -> String {
        self.door.token.path()
    }

    /// Head and content of the answer to what has arrived of a request; none when more must arrive.
    pub fn answer(&self, received: &[u8]) -> Option<Vec<u8>> {
        self.door.answer(received).map(|answer| answer.bytes())
    }
}

fn is_this_machine(host: &[u8], port: u16) -> bool {
    ["127.0.0.1", "localhost"].iter().any(|name| {
        let with_port = format!("{name}:{port}");
        host.eq_ignore_ascii_case(with_port.as_bytes())
            || port == 80 && host.eq_ignore_ascii_case(name.as_bytes())
    })
}

#[cfg(test)]
mod tests {
    use super::super::data::RunData;
    use super::*;

    const PORT: u16 = 4321;

    fn door() -> Door {
        let bytes = b"PLUVIEW1".to_vec();
        let scenario = "s".to_owned();
        let run = RunData { scenario, grains: 0, stages: 0, frames: 0, kept: true, bytes };
        Door { site: Site::new(run), port: PORT, token: Token("0123".to_owned()) }
    }

    fn code(request: &[u8]) -> Option<u16> {
        door().answer(request).map(|answer| answer.status.0)
    }

    fn ask(path: &str) -> Vec<u8> {
        format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{PORT}\r\n\r\n").into_bytes()
    }

    fn get(path: &str) -> Vec<u8> {
        ask(&format!("/0123{path}"))
    }

    #[test]
    fn without_the_token_nothing_is_served() {
        for path in [
            "/",
            "/run.bin",
            "/viewer.js",
            "/0122/",
            "/01234/run.bin",
            "/012/run.bin",
            "0123/",
            "//0123/",
            "/0123\u{301}/",
            "/run.bin?0123",
            "/012",
            "",
            "*",
            "/é123/",
            "http://127.0.0.1:4321/0123/",
        ] {
            let got = code(&ask(path));
            // What is no path at all is no request; one letter more than the token leads nowhere.
            let longer = ["/01234", "/0123\u{301}"].iter().any(|begin| path.starts_with(begin));
            let expected: &[u16] = if longer { &[404] } else { &[403, 400] };
            assert!(got.is_some_and(|c| expected.contains(&c)), "law: `{path}` gets {got:?}");
        }
        assert_eq!(code(&ask("/0123/run.bin")), Some(200), "law: with it, it is");
        let [a, b] = [(); 2].map(|()| Token::new().expect("random numbers"));
        assert!(a != b && a.0.len() == 32, "law: 128 bits, another each time: {a:?}, {b:?}");
    }

    #[test]
    fn the_four_files_are_there_and_nothing_else() {
        for path in ["/", "/viewer.js", "/viewer.css", "/run.bin", "/?from=here"] {
            assert_eq!(code(&get(path)), Some(200), "law: {path} is served");
        }
        for path in [
            "/manifest.json",
            "/../Cargo.toml",
            "/%2e%2e/Cargo.toml",
            "/..%2fCargo.toml",
            "//etc/passwd",
            "/run.bin/",
            "/./run.bin",
            "/RUN.BIN",
            "/run.bin%00",
        ] {
            assert_eq!(code(&get(path)), Some(404), "law: {path} is not served");
        }
    }

    #[test]
    fn only_this_machine_may_be_named() {
        for (host, expected) in [
            ("127.0.0.1:4321", 200),
            ("localhost:4321", 200),
            ("LocalHost:4321", 200),
            ("127.0.0.1", 403),
            ("127.0.0.1:4322", 403),
            ("evil.example", 403),
            ("evil.example:4321", 403),
            ("127.0.0.1.evil.example:4321", 403),
            ("localhost:4321@evil.example", 403),
            ("", 403),
        ] {
            let request = format!("GET /0123/ HTTP/1.1\r\nHost: {host}\r\n\r\n");
            assert_eq!(code(request.as_bytes()), Some(expected), "law: Host `{host}`");
        }
        for fields in ["", "Host: 127.0.0.1:4321\r\nHost: evil.example\r\n"] {
            let request = format!("GET / HTTP/1.1\r\n{fields}\r\n");
            assert_eq!(code(request.as_bytes()), Some(400), "law: one Host, got `{fields}`");
        }
    }

    #[test]
    fn what_is_no_request_is_refused() {
        let host = format!("Host: 127.0.0.1:{PORT}\r\n");
        let many = format!("GET / HTTP/1.1\r\n{host}{}\r\n", "A: b\r\n".repeat(MOST_FIELDS));
        let long = [b"GET /".to_vec(), vec![b'a'; LONGEST_HEAD]].concat();
        for (request, expected) in [
            (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03".to_vec(), Some(400)),
            (b"GET / HTTP/1.1\r\nHost 127.0.0.1\r\n\r\n".to_vec(), Some(400)),
            (b"GET / HTTP/9.9\r\n\r\n".to_vec(), Some(505)),
            (b"\0\0\0\0".to_vec(), Some(400)),
            (many.into_bytes(), Some(431)),
            (long, Some(431)),
            (b"GET / HTT".to_vec(), None),
            (b"".to_vec(), None),
        ] {
            let shown = String::from_utf8_lossy(&request[..request.len().min(40)]).into_owned();
            assert_eq!(code(&request), expected, "law: answer to {shown:?}");
        }
    }

    #[test]
    fn head_has_the_length_alone_and_other_methods_are_refused() {
        let ask = |method: &str| {
            let request =
                format!("{method} /0123/run.bin HTTP/1.1\r\nHost: localhost:{PORT}\r\n\r\n");
            let bytes = door().answer(request.as_bytes()).expect("an answer").bytes();
            String::from_utf8(bytes).expect("text")
        };
        let (got, head) = (ask("GET"), ask("HEAD"));
        assert!(got.contains("Content-Length: 8\r\n") && got.ends_with("\r\n\r\nPLUVIEW1"));
        assert_eq!(format!("{head}PLUVIEW1"), got, "law: the same without the content");
        for method in ["POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "get"] {
            let refused = ask(method);
            assert!(refused.starts_with("HTTP/1.1 405 "), "law: {method} is refused: {refused}");
            assert!(refused.contains("Allow: GET, HEAD\r\n"), "law: what is allowed is said");
        }
    }
}
