//! Names of files, scenarios and factors that hold what would act: tags of HTML, escape sequences of
//! terminals, characters that turn the direction of what follows. They are shown, and nothing more.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Output,
};

use serde_json::{Value, json};

use super::{
    crafted::seal,
    export::small_run,
    interruption::{copy, finished, stored, write_scenario},
    program::{self, json as read, said, text, words, write},
    reproduce, small,
    viewer::browser::Browser,
};

/// A tag that says so when it acts.
const TAG: &str = "<img src=x onerror=document.documentElement.dataset.acted=1>";

/// Colours, a title for the terminal, and a turn of the direction.
const TURN: &str = "\u{1b}[31mred\u{1b}]0;title\u{7}\u{202e}drow";

/// What is seen of it.
const TURN_SHOWN: &str = "\\u001b[31mred\\u001b]0;title\\u0007\\u202edrow";

fn hostile() -> String {
    format!("{TAG}{TURN}")
}

/// The program, with colours as on a terminal.
fn pluvia(args: &[&str]) -> Output {
    let mut command = program::pluvia();
    command.args(args).env_remove("NO_COLOR").env("CLICOLOR_FORCE", "1");
    command.output().expect("it starts")
}

/// What the program prints and says, without our own colours: those that a style begins and ends.
fn without_colours(output: &Output) -> String {
    let all = [output.stdout.as_slice(), output.stderr.as_slice()].concat();
    let mut all = String::from_utf8(all).expect("UTF-8");
    for style in ["\u{1b}[1m\u{1b}[31m", "\u{1b}[31m", "\u{1b}[32m", "\u{1b}[33m", "\u{1b}[2m"] {
        // A colour of ours has an end; the one of the name is followed by `red`.
        all = all.replace(&format!("{style}red"), "FORGED").replace(style, "");
    }
    all.replace("\u{1b}[0m", "")
}

fn assert_plain(output: &Output, what: &str) {
    let said = without_colours(output);
    let acts = |c: char| c.is_control() && c != '\n' || ('\u{202a}'..='\u{202e}').contains(&c);
    assert!(!said.contains(acts), "law: {what}: nothing acts on the terminal, got {said:?}");
    assert!(!said.contains("FORGED"), "law: {what}: nothing but ours is coloured, got {said:?}");
    assert!(said.contains(TURN_SHOWN), "law: {what}: the name is seen, got {said:?}");
}

#[test]
fn a_terminal_is_told_names_and_nothing_more() {
    let folder = tempfile::tempdir().expect("a folder");
    let home = home(folder.path());
    // Errors name paths.
    let missing = home.join("none.json");
    let output = pluvia(&["run", text(&missing), "--out", text(&home.join("out"))]);
    assert_eq!(output.status.code(), Some(4));
    assert_plain(&output, "an error");
    let output = pluvia(&["export", text(&home), "--format", "csv", "--out", text(folder.path())]);
    assert_plain(&output, "a run that is none");
    // Results name paths; messages on the way name damaged files.
    let scenario = write_scenario(&home);
    let out = home.join("out");
    fs::write(copied(&out).join("series.csv"), "").expect("damaged");
    let output = pluvia(&["run", text(&scenario), "--out", text(&out), "--no-figures"]);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("damaged and done again"), "law: it is reported, got {said}");
    assert_plain(&output, "a run");
    let coloured = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(coloured.contains("\u{1b}[3"), "law: our own colours stay, got {coloured:?}");
    // JSON says the same to a program, and nothing acts.
    let output = pluvia(&["store", "check", text(&out), "--json"]);
    assert_plain(&output, "JSON");
    let report: Value = serde_json::from_slice(&output.stdout).expect("law: it is JSON still");
    assert_eq!(report["store"], text(&out.join("stages")), "law: a program reads the name itself");
}

/// Copies what the small run left, and gives the folder of one of its stages.
fn copied(out: &Path) -> PathBuf {
    copy(finished(), out);
    stored(out).remove(0)
}

/// Law: names in a store that somebody made up stay in their line.
#[test]
fn a_store_is_checked_and_its_names_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let stage = copied(&out);
    let mut record = read(&stage.join("stage.json"));
    let name = format!("{TURN}\nforged line");
    record["identity"]["stage"] = json!(name);
    record["stage"] = json!(name);
    seal(&mut record, "record_sha256");
    write(&stage, "stage.json", &record);
    fs::rename(&stage, stage.with_file_name(format!("{TURN}\nforged folder"))).expect("renamed");
    let output = pluvia(&["store", "check", text(&out)]);
    assert_eq!(output.status.code(), Some(1), "law: it is damaged");
    assert_plain(&output, "a check");
    let printed = without_colours(&output);
    assert!(!printed.lines().any(|l| l.starts_with("forged")), "law: no lines of names: {printed}");
    assert!(printed.contains("\\u000aforged folder"), "law: they are seen, got {printed}");
}

/// A page in a browser: no script of a name has run, its tags are text, nothing turns the direction,
/// and every name is by itself.
fn assert_shown(browser: &mut Browser, url: &str, page: &str, seen: &[&str]) {
    browser.send("Page.navigate", json!({ "url": url }));
    browser.wait_for("document.readyState === 'complete' && document.querySelector('h1')");
    browser.settle();
    let acted = browser.evaluate("document.documentElement.dataset.acted ?? null");
    assert_eq!(acted, json!(null), "law: {page}: no script of a name runs");
    let made = browser.number("document.querySelectorAll('img[src=\"x\"]').length");
    assert_eq!(made, 0.0, "law: {page}: no tag of a name is one");
    let all = browser.evaluate("document.body.textContent + document.title");
    let all = all.as_str().expect("text");
    let turns = |c: char| ('\u{202a}'..='\u{202e}').contains(&c) || c == '\u{1b}';
    assert!(!all.contains(turns), "law: {page}: nothing turns the direction of what follows");
    for words in seen {
        assert!(all.contains(words), "law: {page}: `{words}` is read as it is, got {all}");
    }
    // Cells go from left to right, whatever they hold, and names are isolated.
    let disordered = browser.evaluate(
        "[...document.querySelectorAll('tr')].filter(row => { \
           const at = [...row.cells].map(cell => cell.getBoundingClientRect().left); \
           return at.some((x, n) => n > 0 && x < at[n - 1]) && getComputedStyle(row).display === 'table-row'; \
         }).length",
    );
    assert_eq!(disordered, json!(0), "law: {page}: what stands beside a name keeps its place");
    let loose = browser.evaluate(
        "[...document.querySelectorAll('bdi')].filter(e => \
           !getComputedStyle(e).unicodeBidi.startsWith('isolate')).length",
    );
    assert_eq!(loose, json!(0), "law: {page}: a name is by itself");
    browser.complaints.retain(|said| !said.contains("favicon"));
    browser.assert_content(page);
}

/// A folder of a name that acts, with what somebody made there.
fn home(folder: &Path) -> PathBuf {
    let home = folder.join(hostile());
    fs::create_dir(&home).expect("a folder of any name");
    home
}

/// The address of a file for a browser.
fn address(path: &Path) -> String {
    let mut url = String::from("file://");
    for byte in text(path).bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'.' | b'-' | b'_' => {
                url.push(byte as char);
            }
            other => url += &format!("%{other:02X}"),
        }
    }
    url
}

/// A scenario all of whose texts act, as far as they are allowed to.
fn scenario(folder: &Path) -> PathBuf {
    let mut scenario = small::layer(30.0);
    scenario["name"] = json!(TAG);
    scenario["description"] = json!(hostile());
    scenario["notes"] = json!([hostile()]);
    write(folder, "small.json", &scenario)
}

fn done(args: &[&str]) {
    let output = pluvia(args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", said(&output));
}

#[test]
fn a_sweep_over_names_shows_them_as_they_are() {
    let Some(mut browser) = Browser::start("names in the page of a sweep") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let home = home(folder.path());
    let (scenario, out) = (scenario(&home), home.join("out"));
    // Specimens of different grains are values, which the page names.
    let specimens = ["30", "25"].map(|mass| home.join(format!("\u{5d0}\u{5d1}\u{5d2} {mass}")));
    for (specimen, mass) in specimens.iter().zip(["30", "25"]) {
        let set = format!("grains.total_mass_g={mass}");
        let made = ["--set", &set, "--out", text(specimen), "--quiet", "--no-figures"];
        done(&[&["run", text(&scenario)][..], &made].concat());
    }
    let rest = json!({
        "name": TAG, "begin": { "specimen": text(&specimens[0]) },
        "stages": [{ "stage": "rest", "duration_s": 0.05 }], "rest_test_s": 0.05
    });
    let rest = write(&home, "rest.json", &rest);
    let over = format!("begin.specimen={},{}", text(&specimens[0]), text(&specimens[1]));
    done(&["sweep", text(&rest), "--over", &over, "--out", text(&out), "--quiet"]);
    let page = address(&out.join("report.html"));
    assert_shown(&mut browser, &page, "a sweep", &[TAG, TURN_SHOWN, "\u{5d0}\u{5d1}\u{5d2} 25"]);
    let markdown = fs::read_to_string(out.join("sweep.md")).expect("sweep.md");
    assert!(!markdown.contains("<img"), "law: Markdown has no tag of a name");
    assert!(!markdown.contains(['\u{1b}', '\u{202e}']), "law: nor what acts on a terminal");
}

#[test]
#[ignore = "slow: make test-all"]
fn a_calibration_shows_names_as_they_are() {
    let Some(mut browser) = Browser::start("names in the page of a calibration") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let home = home(folder.path());
    let (scenario, out) = (scenario(&home), home.join("out"));
    let asked = words(
        "--target standing_height_mm.mean_surface=9 --unknown grains.total_mass_g \
         --between 20..90 --realisations 2 --tolerance 3 --quiet --out",
    );
    done(&[&["calibrate", text(&scenario)][..], &asked, &[text(&out)]].concat());
    let page = address(&out.join("report.html"));
    // The page says nothing of the scenario; its folder has the name.
    assert_shown(&mut browser, &page, "a calibration", &["Calibration"]);
}

#[test]
#[ignore = "slow: make test-all"]
fn a_comparison_and_the_report_show_names_as_they_are() {
    let Some(mut browser) = Browser::start("names in reports") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let home = home(folder.path());
    let (scenario, out) = (scenario(&home), home.join("compared"));
    let output = pluvia(&["compare", text(&scenario), "--out", text(&out), "--quiet"]);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    let page = address(&out.join("report.html"));
    assert_shown(&mut browser, &page, "a comparison", &[TAG, "side by side"]);
    // The same programme in a folder of another name: its stages are there.
    let out = home.join("report");
    copy(reproduce::programme(), &out);
    // What another engine is said to have made of it.
    let mut column = read(&out.join("beside/claims.json"));
    column["label"] = json!(hostile());
    seal(&mut column, "content_sha256");
    write(&out.join("beside"), "claims-other.json", &column);
    let asked = words(reproduce::PROGRAMME);
    done(&[&asked[..], &["--quiet", "--out", text(&out)]].concat());
    let page = address(&out.join("report.html"));
    assert_shown(&mut browser, &page, "the report", &[TAG, TURN_SHOWN]);
}

#[test]
#[ignore = "slow: make test-all"]
fn the_viewer_shows_names_as_they_are() {
    let Some(mut browser) = Browser::start("names in the viewer") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let run = home(folder.path()).join("run");
    copy(small_run(), &run);
    let mut manifest = read(&run.join("manifest.json"));
    manifest["scenario"]["name"] = json!(TAG);
    manifest["scenario"]["description"] = json!(hostile());
    manifest["stages"][0]["stage"] = json!(hostile());
    write(&run, "manifest.json", &manifest);
    let saved = folder.path().join("saved.html");
    done(&["view", text(&run), "--save", text(&saved)]);
    browser.open(&address(&saved));
    assert_eq!(browser.evaluate("pluvia.error"), json!(null), "law: the run is shown");
    assert_shown(&mut browser, &address(&saved), "the viewer", &[TAG, "202edrow"]);
    browser.wait_for("window.pluvia && pluvia.ready");
    browser.evaluate("pluvia.seek(0)");
    browser.settle();
    // The name of a stage stands right of the time, and stays there.
    let apart = browser.number(
        "document.getElementById('stage-name').getBoundingClientRect().left - \
         document.getElementById('time').getBoundingClientRect().right",
    );
    assert!(apart >= 0.0, "law: the time keeps its place, got {apart} px");
}
