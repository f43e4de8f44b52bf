//! The page: its files, carried in the program, and the two ways to hand them
//! out, as a small site or as one file with the data inside.

use std::collections::HashMap;

use base64::{Engine, engine::general_purpose::STANDARD};

use super::data::RunData;
use crate::plain::plain;

const PAGE: &str = include_str!("../../assets/viewer/index.html");
const STYLE: &str = include_str!("../../assets/viewer/viewer.css");

/// The program of the page: modules in an order in which each uses only those before it. They are
/// joined into one script, without their lines of `import` and without the word `export`, so that
/// the page also works as a single file: a browser lets no page from the disk load modules.
const MODULES: [&str; 13] = [
    include_str!("../../assets/viewer/vectors.js"),
    include_str!("../../assets/viewer/data.js"),
    include_str!("../../assets/viewer/playback.js"),
    include_str!("../../assets/viewer/colours.js"),
    include_str!("../../assets/viewer/measures.js"),
    include_str!("../../assets/viewer/picking.js"),
    include_str!("../../assets/viewer/camera.js"),
    include_str!("../../assets/viewer/shaders.js"),
    include_str!("../../assets/viewer/meshes.js"),
    include_str!("../../assets/viewer/renderer.js"),
    include_str!("../../assets/viewer/timeline.js"),
    include_str!("../../assets/viewer/panels.js"),
    include_str!("../../assets/viewer/main.js"),
];

/// What the page may load (the value of `Content-Security-Policy`): nothing but what the site
/// itself serves; no frame, form or plug-in.
pub(super) const SITE_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; \
                           connect-src 'self'; img-src data:; base-uri 'none'; \
                           form-action 'none'; frame-ancestors 'none'";

/// Nothing from anywhere: all is in the file.
const FILE_POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; \
                           style-src 'unsafe-inline'; img-src data:; base-uri 'none'; \
                           form-action 'none'";

/// Where the files of the page are named in it.
const STYLE_LINK: &str = "<link rel=\"stylesheet\" href=\"viewer.css\">";
const SCRIPT_LINK: &str = "<script type=\"module\" src=\"viewer.js\"></script>";

/// A file that the server hands out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Resource {
    /// Its media type.
    pub kind: &'static str,
    /// Its content.
    pub content: Vec<u8>,
}

/// All that the server hands out: the page, its style and script, the run.
#[derive(Debug, Clone, PartialEq)]
pub struct Site {
    resources: HashMap<&'static str, Resource>,
}

impl Site {
    /// The page of a run.
    pub fn new(run: RunData) -> Self {
        let text = |kind, content: String| Resource { kind, content: content.into_bytes() };
        let resources = HashMap::from([
            ("/", text("text/html; charset=utf-8", titled(&run.scenario))),
            ("/viewer.css", text("text/css; charset=utf-8", STYLE.to_owned())),
            ("/viewer.js", text("text/javascript; charset=utf-8", script())),
            ("/run.bin", Resource { kind: "application/octet-stream", content: run.bytes }),
        ]);
        Self { resources }
    }

    /// The file at a path; none at any other than the four there are.
    pub(super) fn get(&self, path: &str) -> Option<&Resource> {
        self.resources.get(path)
    }
}

/// The page of a run as one file that needs no server and no network.
pub fn self_contained(run: &RunData) -> String {
    let policy = format!(
        "<meta http-equiv=\"Content-Security-Policy\" content=\"{FILE_POLICY}\">\n<style>\n{STYLE}</style>"
    );
    let data = STANDARD.encode(&run.bytes);
    let program = format!(
        "<script id=\"run\" type=\"application/octet-stream\">{data}</script>\n\
         <script type=\"module\">\n{}</script>",
        script()
    );
    titled(&run.scenario).replace(STYLE_LINK, &policy).replace(SCRIPT_LINK, &program)
}

fn titled(scenario: &str) -> String {
    PAGE.replace(
        "<title>Pluvia</title>",
        &format!("<title>{} - Pluvia</title>", escaped(&plain(scenario))),
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The modules as one.
fn script() -> String {
    let mut joined = String::from("\"use strict\";\n");
    for line in MODULES.iter().flat_map(|module| module.lines()) {
        if !line.starts_with("import ") {
            joined += line.strip_prefix("export ").unwrap_or(line);
            joined.push('\n');
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run() -> RunData {
        RunData {
            scenario: "a <b> & c".to_owned(),
            grains: 0,
            stages: 0,
            frames: 0,
            kept: true,
            bytes: b"PLUVIEW1 and more".to_vec(),
        }
    }

    #[test]
    fn nothing_in_the_page_points_elsewhere() {
        let whole = self_contained(&run());
        for (word, why) in [
            ("src=", "loads a file"),
            ("href=\"v", "loads a file"),
            ("href=\"/", "loads a file"),
            ("http://", "names another site"),
            ("https://", "names another site"),
            ("@import", "loads a style"),
        ] {
            assert!(!whole.contains(word), "law: the page stands alone; `{word}` {why}");
        }
        assert_eq!(
            whole.matches("</script").count(),
            2,
            "law: no text of the script ends it early; expected the ends of data and script"
        );
        let got = whole
            .split_once("octet-stream\">")
            .and_then(|(_, rest)| rest.split_once("</script"))
            .map(|(data, _)| STANDARD.decode(data));
        assert_eq!(got, Some(Ok(run().bytes)), "law: the data come back byte by byte");
    }

    #[test]
    fn the_name_of_a_scenario_is_text() {
        let page = titled(&run().scenario);
        assert!(page.contains("<title>a &lt;b&gt; &amp; c - Pluvia</title>"), "{page}");
    }

    #[test]
    fn modules_use_only_those_before_them() {
        let mut before: Vec<String> = Vec::new();
        for (n, module) in MODULES.iter().enumerate() {
            for line in module.lines().filter(|line| line.starts_with("import ")) {
                let file = line.rsplit('"').nth(1).unwrap_or_default();
                let names = line.split(['{', '}']).nth(1).unwrap_or_default();
                assert!(file.starts_with("./") && line.ends_with(';'), "module {n}: {line}");
                for name in names.split(',').map(str::trim) {
                    assert!(
                        before.iter().any(|known| known == name),
                        "module {n} imports `{name}`, which no module before it exports"
                    );
                }
            }
            let exports = module.lines().filter_map(|line| line.strip_prefix("export "));
            let names = exports.filter_map(|line| {
                let mut words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
                words.find(|w| !["async", "function", "const", "class"].contains(w))
            });
            before.extend(names.map(str::to_owned));
        }
        assert!(before.len() > 20, "the check finds exports, got {before:?}");
        let script = script();
        assert!(!script.lines().any(|l| l.starts_with("import ") || l.starts_with("export ")));
    }
}
