//! Runs a headless Chromium through its DevTools protocol, for the tests of pages. Each test has one browser page.

use serde_json::{Value, json};
use std::cell::{Cell, RefCell};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket, stream::MaybeTlsStream};

/// How long anything may take, on a busy machine too.
const PATIENCE: Duration = Duration::from_secs(120);

/// The browser's program, if there is one.
pub fn program() -> Option<PathBuf> {
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    names.iter().flat_map(|n| folders.iter().map(move |f| f.join(n))).find(|p| p.is_file())
}

/// A browser with one page.
pub struct Browser {
    child: Child,
    socket: RefCell<WebSocket<MaybeTlsStream<std::net::TcpStream>>>,
    session: String,
    next: Cell<u64>,
    events: RefCell<Vec<Value>>,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// Starts it with an empty page; `None`, said aloud, where there is no Chromium.
    pub fn start() -> Option<Self> {
        let Some(program) = program() else {
            eprintln!("SKIPPED pages in a browser: no chromium on the PATH (apt-get install chromium)");
            return None;
        };
        let profile = tempfile::tempdir().expect("a folder for the profile");
        let mut child = Command::new(program)
            .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run"])
            .args(["--disable-extensions", "--disable-background-networking", "--remote-debugging-port=0"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stderr(Stdio::piped())
            .spawn()
            .expect("chromium starts");
        let stderr = BufReader::new(child.stderr.take().expect("its messages"));
        let mut lines = stderr.lines().map_while(Result::ok);
        let address = lines
            .find_map(|line| Some(line.split_once("DevTools listening on ")?.1.to_string()))
            .expect("chromium tells where it listens");
        // what it says later is read and dropped, or it would stop when the pipe is full
        std::thread::spawn(move || lines.for_each(drop));
        let (socket, _) = tungstenite::connect(address).expect("chromium answers");
        let mut browser = Self {
            child,
            socket: RefCell::new(socket),
            session: String::new(),
            next: Cell::new(0),
            events: RefCell::default(),
            _profile: profile,
        };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let attached =
            browser.call("Target.attachToTarget", json!({"targetId": target["targetId"], "flatten": true}));
        browser.session = attached["sessionId"].as_str().expect("a session").to_string();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        Some(browser)
    }

    /// Carries out a command and returns its result; events on the way are kept.
    pub fn call(&self, method: &str, parameters: Value) -> Value {
        let id = self.next.get() + 1;
        self.next.set(id);
        let mut command = json!({"id": id, "method": method, "params": parameters});
        if !self.session.is_empty() {
            command["sessionId"] = json!(self.session);
        }
        let mut socket = self.socket.borrow_mut();
        socket.send(Message::text(command.to_string())).expect("chromium listens");
        loop {
            let Message::Text(text) = socket.read().expect("chromium answers") else { continue };
            let message: Value = serde_json::from_str(&text).expect("JSON");
            if message["id"].as_u64() == Some(id) {
                assert!(message.get("error").is_none(), "{method}: {message}");
                return message["result"].clone();
            }
            self.events.borrow_mut().push(message);
        }
    }

    /// Opens a file and waits until its program has run.
    pub fn open(&self, page: &Path) {
        self.events.borrow_mut().clear();
        self.call("Page.navigate", json!({"url": format!("file://{}", page.display())}));
        self.until("document.documentElement?.dataset.ready === 'yes'");
    }

    /// The value of an expression in the page.
    pub fn value(&self, expression: &str) -> Value {
        let result = self.call(
            "Runtime.evaluate",
            json!({"expression": expression, "returnByValue": true, "awaitPromise": true}),
        );
        assert!(result.get("exceptionDetails").is_none(), "{expression}: {result}");
        result["result"]["value"].clone()
    }

    /// The text of an element.
    pub fn text(&self, selector: &str) -> String {
        let value = self.value(&format!("document.querySelector({}).textContent", json!(selector)));
        value.as_str().unwrap_or_default().to_string()
    }

    /// A count in the page.
    pub fn count(&self, expression: &str) -> usize {
        self.value(expression).as_u64().unwrap_or_default() as usize
    }

    /// Waits until an expression is true.
    pub fn until(&self, expression: &str) {
        self.keep_trying(expression, || self.value(expression) == json!(true));
    }

    /// Repeats an attempt until it succeeds: a page on a busy machine may not be laid out yet.
    pub fn keep_trying(&self, what: &str, attempt: impl Fn() -> bool) {
        let started = Instant::now();
        while !attempt() {
            assert!(started.elapsed() < PATIENCE, "never came true: {what}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Clicks an element.
    pub fn click(&self, selector: &str) {
        self.value(&format!("document.querySelector({}).click()", json!(selector)));
    }

    /// The rectangle of an element in the window: left, top, width, height. It is brought into view.
    pub fn place(&self, selector: &str) -> [f64; 4] {
        let found = self.value(&format!(
            "(() => {{ const n = document.querySelector({}); n.scrollIntoView({{block: 'center', behavior: 'instant'}}); \
             const b = n.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; }})()",
            json!(selector)
        ));
        [0, 1, 2, 3].map(|i| found[i].as_f64().expect("a number"))
    }

    /// A mouse event: `mouseMoved`, `mousePressed`, `mouseReleased`.
    pub fn mouse(&self, kind: &str, x: f64, y: f64) {
        let button = if kind == "mouseMoved" { "none" } else { "left" };
        let event = json!({"type": kind, "x": x, "y": y, "button": button, "clickCount": 1});
        self.call("Input.dispatchMouseEvent", event);
    }

    /// Drags with the left button held.
    pub fn drag(&self, from: (f64, f64), to: (f64, f64)) {
        self.mouse("mouseMoved", from.0, from.1);
        self.mouse("mousePressed", from.0, from.1);
        for step in 1..=4 {
            let part = f64::from(step) / 4.0;
            let (x, y) = (from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1));
            let event = json!({"type": "mouseMoved", "x": x, "y": y, "button": "left", "buttons": 1});
            self.call("Input.dispatchMouseEvent", event);
        }
        self.mouse("mouseReleased", to.0, to.1);
    }

    /// Presses a key.
    pub fn key(&self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({"type": kind, "key": key, "code": key}));
        }
    }

    /// Width and height of the window.
    pub fn size(&self, width: u32, height: u32) {
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", metrics);
    }

    /// `screen` or `print`, `light` or `dark`.
    pub fn media(&self, medium: &str, scheme: &str) {
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        self.call("Emulation.setEmulatedMedia", json!({"media": medium, "features": features}));
    }

    /// What the page complained of and asked the network for, since it was opened.
    pub fn complaints(&self) -> Vec<String> {
        self.value("1");
        let events = self.events.borrow();
        let kind = |e: &Value| e["method"].as_str().unwrap_or_default().to_string();
        let asked = |e: &&Value| {
            let of = &e["params"];
            kind(e) == "Network.requestWillBeSent" && of["type"] != "Document"
        };
        let wrong = |e: &&Value| {
            kind(e) == "Runtime.exceptionThrown"
                || (kind(e) == "Log.entryAdded" && e["params"]["entry"]["level"] == "error")
                || (kind(e) == "Runtime.consoleAPICalled" && e["params"]["type"] == "error")
        };
        events.iter().filter(|e| asked(e) || wrong(e)).map(Value::to_string).collect()
    }

    /// A picture of a part of the page, as PNG.
    pub fn picture(&self, clip: Value) -> Vec<u8> {
        let shot = self.call(
            "Page.captureScreenshot",
            json!({"format": "png", "clip": clip, "captureBeyondViewport": true}),
        );
        decoded(&shot["data"])
    }

    /// The page printed on A4, as PDF.
    pub fn printed(&self) -> Vec<u8> {
        let a4 = json!({"paperWidth": 8.27, "paperHeight": 11.69, "preferCSSPageSize": true, "printBackground": false});
        decoded(&self.call("Page.printToPDF", a4)["data"])
    }
}

fn decoded(data: &Value) -> Vec<u8> {
    data_encoding::BASE64.decode(data.as_str().expect("data").as_bytes()).expect("base64")
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
