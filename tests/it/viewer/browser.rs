//! A headless Chromium, told what to do through its DevTools protocol.
//!
//! The protocol goes over two pipes (`--remote-debugging-pipe`): messages in
//! JSON, each ended by a zero byte. So no port is opened, and neither a driver
//! nor a library is needed beside the browser itself.

use std::{
    env, fs,
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, Command, Stdio},
    sync::mpsc::{Receiver, channel},
    thread,
    time::{Duration, Instant},
};

use base64::{Engine, engine::general_purpose::STANDARD};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::super::program::skipped;

/// How long a browser that draws without a graphics card may take for anything.
const PATIENCE: Duration = Duration::from_secs(120);

/// Set to `required` where a missing browser must fail the tests.
const SWITCH: &str = "PLUVIA_BROWSER_TESTS";

/// A browser with one page.
pub struct Browser {
    child: Child,
    input: ChildStdin,
    messages: Receiver<Value>,
    last: u64,
    session: Option<String>,
    /// Errors that the page wrote to the console or did not catch.
    pub complaints: Vec<String>,
    _profile: TempDir,
}

/// A Chromium or Chrome on the search path.
fn installed() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    let folders: Vec<PathBuf> = env::split_paths(&env::var_os("PATH")?).collect();
    names.iter().flat_map(|name| folders.iter().map(move |f| f.join(name))).find(|p| p.is_file())
}

impl Browser {
    /// Starts a browser; none where none is installed, which is said aloud.
    pub fn start(test: &str) -> Option<Self> {
        let Some(program) = installed() else {
            assert_ne!(
                env::var(SWITCH).as_deref(),
                Ok("required"),
                "{SWITCH}=required, but no Chromium is installed"
            );
            skipped(test, "no Chromium here; try: apt-get install chromium");
            return None;
        };
        let profile = tempfile::tempdir().expect("a folder for the profile");
        let mut command = Command::new("sh");
        // The browser reads from handle 3 and writes to handle 4.
        command.args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 </dev/null >/dev/null"]).arg(program);
        command.args([
            "--headless",
            "--no-sandbox",
            "--use-gl=angle",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--no-first-run",
            "--disable-dev-shm-usage",
            "--disable-background-networking",
            "--remote-debugging-pipe",
        ]);
        command.arg(format!("--user-data-dir={}", profile.path().display())).arg("about:blank");
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().expect("the shell starts");
        let input = child.stdin.take().expect("a pipe");
        let output = BufReader::new(child.stdout.take().expect("a pipe"));
        let (sender, messages) = channel();
        thread::spawn(move || {
            for message in output.split(0).map_while(Result::ok) {
                let parsed = serde_json::from_slice(&message).unwrap_or(Value::Null);
                if sender.send(parsed).is_err() {
                    break;
                }
            }
        });
        let complaints = Vec::new();
        let mut browser =
            Self { child, input, messages, last: 0, session: None, complaints, _profile: profile };
        browser.attach();
        Some(browser)
    }

    fn attach(&mut self) {
        let made = self.send("Target.createTarget", json!({ "url": "about:blank" }));
        let asked = json!({ "targetId": made["targetId"], "flatten": true });
        let session = self.send("Target.attachToTarget", asked);
        self.session = session["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log"] {
            self.send(&format!("{domain}.enable"), json!({}));
        }
    }

    /// Sends a command and waits for its result.
    pub fn send(&mut self, method: &str, params: Value) -> Value {
        self.last += 1;
        let mut message = json!({ "id": self.last, "method": method, "params": params });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        self.input.write_all(&bytes).expect("the browser listens");
        self.input.flush().expect("the browser listens");
        loop {
            let answer = self
                .messages
                .recv_timeout(PATIENCE)
                .unwrap_or_else(|e| panic!("no answer to {method} from the browser: {e}"));
            if answer["id"] == self.last {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            self.hear(&answer);
        }
    }

    fn hear(&mut self, event: &Value) {
        let params = &event["params"];
        let bad = match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => true,
            Some("Runtime.consoleAPICalled") => {
                ["error", "assert"].iter().any(|t| params["type"] == *t)
            }
            Some("Log.entryAdded") => params["entry"]["level"] == "error",
            _ => false,
        };
        if bad {
            self.complaints.push(params.to_string());
        }
    }

    /// Gives the page a size in pixels and a light or dark surrounding.
    pub fn look(&mut self, width: u32, height: u32, scheme: &str) {
        let narrow = width < 600;
        self.send(
            "Emulation.setDeviceMetricsOverride",
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": narrow }),
        );
        let feature = json!({ "name": "prefers-color-scheme", "value": scheme });
        self.send("Emulation.setEmulatedMedia", json!({ "features": [feature] }));
    }

    /// Opens a page and waits until it is ready, or says that it cannot be.
    pub fn open(&mut self, url: &str) {
        self.send("Page.navigate", json!({ "url": url }));
        self.wait_for("window.pluvia && (pluvia.ready || pluvia.error !== null)");
    }

    /// The value of an expression in the page.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let asked = json!({
            "expression": expression, "returnByValue": true, "awaitPromise": true,
        });
        let result = self.send("Runtime.evaluate", asked);
        let fault = &result["exceptionDetails"];
        assert!(fault.is_null(), "`{expression}` fails in the page: {fault}");
        result["result"]["value"].clone()
    }

    /// A number of the page.
    pub fn number(&mut self, expression: &str) -> f64 {
        let got = self.evaluate(expression);
        got.as_f64().unwrap_or_else(|| panic!("`{expression}` is {got}, expected a number"))
    }

    /// Waits until an expression holds.
    pub fn wait_for(&mut self, expression: &str) {
        let latest = Instant::now() + PATIENCE;
        while self.evaluate(&format!("Boolean({expression})")) != json!(true) {
            assert!(Instant::now() < latest, "`{expression}` did not come true in {PATIENCE:?}");
            thread::sleep(Duration::from_millis(50));
        }
    }

    /// Waits until the picture shows all that was asked for.
    pub fn settle(&mut self) {
        let frame = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))";
        self.evaluate(&format!("{frame}.then(() => {frame}).then(() => true)"));
    }

    /// Presses and lets go of the left button.
    pub fn click(&mut self, x: f64, y: f64) {
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1 });
            self.send("Input.dispatchMouseEvent", event);
        }
    }

    /// Clicks the middle of an element.
    pub fn click_on(&mut self, id: &str) {
        let middle = format!(
            "(() => {{ const e = document.getElementById('{id}'); e.scrollIntoView({{ block: 'nearest' }}); \
             const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()"
        );
        let at = self.evaluate(&middle);
        let part = |n: usize| at[n].as_f64().unwrap_or_else(|| panic!("#{id} has no place: {at}"));
        self.click(part(0), part(1));
    }

    /// Chooses an entry of a list, as a person does.
    pub fn choose(&mut self, id: &str, value: &str) {
        self.evaluate(&format!(
            "(() => {{ const e = document.getElementById('{id}'); e.value = '{value}'; \
             for (const kind of ['input', 'change']) e.dispatchEvent(new Event(kind, {{ bubbles: true }})); }})()"
        ));
    }

    /// Presses a key.
    pub fn key(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.send("Input.dispatchKeyEvent", json!({ "type": kind, "key": key }));
        }
    }

    /// A picture of the page as PNG; of a part of it (x, y, width, height) where that is given.
    pub fn picture(&mut self, part: Option<[f64; 4]>) -> Vec<u8> {
        self.settle();
        let mut asked = json!({ "format": "png" });
        if let Some([x, y, width, height]) = part {
            asked["clip"] = json!({ "x": x, "y": y, "width": width, "height": height, "scale": 1 });
        }
        let result = self.send("Page.captureScreenshot", asked);
        STANDARD.decode(result["data"].as_str().unwrap_or_default()).expect("base64")
    }

    /// A picture of the page in `target/tmp`, for people to look at.
    pub fn keep_picture(&mut self, name: &str) {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("viewer");
        fs::create_dir_all(&folder).expect("a folder");
        let picture = self.picture(None);
        fs::write(folder.join(name), picture).expect("a picture");
    }

    /// How many colours a picture has.
    pub fn colours(&mut self, picture: &[u8]) -> f64 {
        let data = STANDARD.encode(picture);
        self.number(&format!(
            "(async () => {{ const text = atob('{data}'); \
             const bytes = Uint8Array.from(text, c => c.charCodeAt(0)); \
             const image = await createImageBitmap(new Blob([bytes], {{ type: 'image/png' }})); \
             const canvas = new OffscreenCanvas(image.width, image.height), pen = canvas.getContext('2d'); \
             pen.drawImage(image, 0, 0); \
             const pixels = new Uint32Array(pen.getImageData(0, 0, image.width, image.height).data.buffer); \
             return new Set(pixels).size; }})()"
        ))
    }

    /// Fails when the page complained of anything.
    pub fn assert_content(&self, law: &str) {
        assert!(self.complaints.is_empty(), "law: {law}, got errors: {:#?}", self.complaints);
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let asked = json!({ "id": 0, "method": "Browser.close" }).to_string() + "\0";
        let asked = self.input.write_all(asked.as_bytes()).and_then(|()| self.input.flush());
        let latest = Instant::now() + Duration::from_secs(if asked.is_ok() { 10 } else { 0 });
        while matches!(self.child.try_wait(), Ok(None)) && Instant::now() < latest {
            thread::sleep(Duration::from_millis(50));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
