//! How `pluvia view` opens a browser: by a page that nobody else can read, so that its address is in
//! no list of processes.

use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use super::super::{
    export::small_run,
    program::{self, pluvia, send},
};
use super::{assert_status, exchange};

/// A launcher of browsers that notes what it is started with, and takes a copy of the page.
fn launcher(folder: &Path) {
    let script = "#!/bin/sh\n\
                  printf '%s\\n' \"$@\" > \"$NOTES/arguments\"\n\
                  stat -c %a \"$1\" > \"$NOTES/mode\"\n\
                  stat -c %a \"$(dirname \"$1\")\" >> \"$NOTES/mode\"\n\
                  cp \"$1\" \"$NOTES/page.html\"\n\
                  : > \"$NOTES/done\"\n";
    program::script(&folder.join("xdg-open"), script);
}

/// A command that serves; it is ended also where a test fails.
struct Served(Child);

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts the command with that launcher; gives it, its address and the page that was opened.
fn opened(notes: &Path) -> (Served, String, String) {
    launcher(notes);
    let mut command = pluvia();
    let path = format!("{}:/usr/bin:/bin", notes.display());
    command.arg("view").arg(small_run()).env("PATH", path).env("NOTES", notes);
    let mut child = Served(command.stdout(Stdio::piped()).spawn().expect("it starts"));
    let mut lines = BufReader::new(child.0.stdout.take().expect("a pipe")).lines();
    let url = loop {
        let line = lines.next().expect("an address is printed").expect("text");
        if line.starts_with("http://") {
            break line.split(' ').next().unwrap_or_default().to_owned();
        }
    };
    wait_for("the page is opened", || notes.join("done").exists());
    let page = fs::read_to_string(notes.join("arguments")).expect("arguments").trim().to_owned();
    (child, url, page)
}

fn wait_for(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        // Enough on a slow machine, and half the time after which a page goes by itself.
        assert!(begun.elapsed() < Duration::from_secs(60), "law: {what}, got nothing");
        sleep(Duration::from_millis(20));
    }
}

fn end(mut child: Served) {
    send(&child.0, "TERM");
    wait_for("it ends", || child.0.try_wait().expect("its state").is_some());
    let ended = child.0.wait().expect("its state");
    assert_eq!(ended.code(), Some(0), "law: it ends when it is asked to");
}

#[test]
fn the_address_is_in_no_command_line_and_the_page_goes_when_it_was_followed() {
    let notes = tempfile::tempdir().expect("a folder");
    let (child, url, page) = opened(notes.path());
    let address = url.strip_prefix("http://").expect("an address");
    let (host, path) = address.split_once('/').expect("a host and a path");
    let token = path.trim_end_matches('/');
    assert_eq!(token.len(), 32, "law: the address has a token of 128 bits, got {url}");
    assert!(!page.contains(token) && page.lines().count() == 1, "law: no token, got {page}");
    let mode = fs::read_to_string(notes.path().join("mode")).expect("modes");
    assert_eq!(mode, "600\n700\n", "law: page and folder are for their owner alone");
    let content = fs::read_to_string(notes.path().join("page.html")).expect("a page");
    assert!(content.contains(&format!("url={url}\"")), "law: the page leads there: {content}");
    assert!(Path::new(&page).exists(), "law: it is there until it is followed");
    let request = format!("GET /{path} HTTP/1.1\r\nHost: {host}\r\n\r\n");
    let answer = exchange(host.parse().expect("an address"), request.as_bytes());
    assert_status(&answer, 200, "the page that it leads to is served");
    wait_for("the page goes when it was followed", || !Path::new(&page).exists());
    let folder = Path::new(&page).parent().expect("a folder");
    assert!(!folder.exists(), "law: and its folder");
    end(child);
}

#[test]
fn a_page_that_nobody_followed_goes_with_the_command() {
    let notes = tempfile::tempdir().expect("a folder");
    let (child, _, page) = opened(notes.path());
    assert!(Path::new(&page).exists(), "law: it is there");
    end(child);
    assert!(!Path::new(&page).exists(), "law: nothing stays");
}

/// Law: a real browser follows the page.
#[test]
fn a_browser_comes_by_the_page_to_the_run() {
    let notes = tempfile::tempdir().expect("a folder");
    let Some(mut browser) = super::browser::Browser::start("the page that opens the run") else {
        return;
    };
    let (child, url, page) = opened(notes.path());
    browser.open(&format!("file://{page}"));
    let at = browser.evaluate("location.href");
    assert_eq!(at, url.as_str(), "law: it ends at the run");
    let grains = browser.number("pluvia.grains");
    assert!(grains > 0.0, "law: the run is shown, got {grains} grains");
    browser.assert_content("the run comes without errors");
    end(child);
}
