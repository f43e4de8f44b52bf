//! The page in a headless browser: that it plays, tells the truth about a
//! grain, and says what it cannot show.

use std::{collections::HashSet, fs, path::Path};

use pluvia::export::{FramesRead, read_playback, read_run};
use pluvia::grains::grain_name;
use pluvia::specimen::{Other, Party};
use serde_json::json;

use super::super::{
    export::small_run,
    interruption::{copy, stored},
    near::near,
    program, small,
};
use super::browser::Browser;
use super::serve;

/// A part of the picture without words, for a window of 1200 by 800.
const MIDDLE: [f64; 4] = [330.0, 100.0, 500.0, 560.0];

/// The columns of `grains.csv` that the page shows, and the last digit shown.
const COLUMNS: [(&str, f64); 7] = [
    ("volume_mm3", 0.1),
    ("mass_g", 0.001),
    ("equivalent_diameter_mm", 0.01),
    ("x_mm", 0.01),
    ("y_mm", 0.01),
    ("z_mm", 0.01),
    ("speed_mm_per_s", 0.1),
];

/// A grain that is seen where no panel is, and the pixel at which to click it.
fn clickable(browser: &mut Browser) -> (usize, f64, f64) {
    let found = browser.evaluate(
        "(() => { for (let n = 0; n < pluvia.grains; n++) { const [x, y] = pluvia.screenOf(n); \
         if (pluvia.pickAt(x, y) === n && document.elementFromPoint(x, y)?.id === 'view') \
         return [n, x, y]; } })()",
    );
    let part = |n: usize| found[n].as_f64().expect("some grain is seen");
    (part(0) as usize, part(1), part(2))
}

/// Which two bodies press on each other at the end of a run, grains at least on one side.
fn pairs_at_end(run: &Path) -> usize {
    let contacts = read_run(run, None).expect("the run").specimen.state.contacts;
    let plain = |party: Party| match party {
        Party::Grain(n) => (0, n),
        Party::Other(Other::TopPlate) => (1, 0),
        Party::Other(Other::Cylinder(n)) => (2, n),
        Party::Other(Other::Funnel(n)) => (3, n),
        Party::Other(Other::Base(n)) => (4, n),
        Party::Other(Other::Piece(piece, part)) => (5 + piece, part),
    };
    let pairs: HashSet<_> = contacts
        .iter()
        .map(|c| c.between.map(plain))
        .filter(|between| between.iter().any(|party| party.0 == 0))
        .map(|[a, b]| if a < b { (a, b) } else { (b, a) })
        .collect();
    pairs.len()
}

#[test]
fn a_run_plays_in_a_browser() {
    let Some(mut browser) = Browser::start("a_run_plays_in_a_browser") else { return };
    let server = serve(small_run());
    browser.look(1200, 800, "light");
    browser.open(&server.url());
    assert_eq!(browser.evaluate("pluvia.error"), json!(null), "law: the page has no trouble");
    let playback = read_playback(small_run(), FramesRead::All, None).expect("the run");
    let frames: usize = playback.stages.iter().map(|stage| stage.frames.len()).sum();
    assert_eq!(browser.number("pluvia.frames"), frames as f64, "law: every frame is there");
    assert_eq!(browser.evaluate("pluvia.kept"), json!(true), "law: this run kept its frames");
    assert!(browser.evaluate("document.getElementById('frames-note').hidden") == json!(true));
    let at_end = browser.evaluate("pluvia.time === pluvia.end");
    assert_eq!(at_end, json!(true), "law: it opens on the finished specimen");
    browser.keep_picture("begin-1200.png");
    let offered = browser.evaluate(OFFERED);
    assert_eq!((&offered[0], &offered[3]), (&json!(true), &json!("Cylinder")), "law: {offered}");

    fits_the_grains_and_their_time(&mut browser);
    plays(&mut browser);
    tells_of_a_grain(&mut browser);
    colours_change(&mut browser);
    forces_are_shown_at_ends_alone(&mut browser);
    cuts(&mut browser);
    fits_a_small_window(&mut browser);
    browser.assert_content("the page writes no error to the console");
}

/// Which bodies of the apparatus can be shown and hidden, and what the first is called.
const OFFERED: &str = "[...['cylinder', 'funnel', 'plate'].map(id => !document.getElementById(id).hidden), \
                       document.querySelector('label[for=cylinder]').textContent]";

/// Law: only what there is can be shown and hidden: of a laboratory its pieces, no funnel and no plate.
#[test]
fn a_laboratory_offers_its_pieces() {
    let Some(mut browser) = Browser::start("a_laboratory_offers_its_pieces") else { return };
    let folder = program::Folder::new();
    let scenario = json!({
        "name": "boxed",
        "grains": small::fine(5.0),
        "pieces": [{ "name": "box", "shape": { "box": { "inner_mm": [60, 60, 60] } } }],
        "stages": [{ "stage": "deposit", "at_mm": [0, 0, 60], "area_mm": [50, 50], "rate_g_per_s": 150 }],
        "rest_test_s": 0
    });
    let (file, out) = (folder.scenario("boxed.json", &scenario), folder.out("boxed"));
    program::done(&["run", &file, "--out", &out, "--jobs", "1", "--no-figures"]);
    let server = serve(Path::new(&out));
    browser.look(1200, 800, "light");
    browser.open(&server.url());
    assert_eq!(browser.evaluate("pluvia.error"), json!(null), "law: the page has no trouble");
    assert_eq!(browser.evaluate(OFFERED), json!([true, false, false, "Pieces"]));
    browser.choose("colour", "displacement");
    legend_says(&mut browser, "added since the stage began");
    browser.choose("colour", "height");
    let legend = browser.evaluate("document.getElementById('legend').textContent");
    let above = legend.as_str().is_some_and(|text| text.contains("above z = 0"));
    assert!(above, "law: a laboratory has no cylinder whose floor is 0, got {legend}");
    browser.choose("colour", "displacement");
    browser.keep_picture("laboratory-1200.png");
    browser.assert_content("the page writes no error to the console");
}

/// Law: grains of which a quantity is unknown are grey, and the legend says why.
fn legend_says(browser: &mut Browser, why: &str) {
    let legend = browser.evaluate("document.getElementById('legend').textContent");
    let text = legend.as_str().unwrap_or_default();
    assert!(text.contains(why), "law: the legend says `{why}`, got {legend}");
    let colour = browser.evaluate("pluvia.colourOf(0)");
    assert_eq!(colour, json!([0.62, 0.62, 0.62]), "law: grey");
    let scales = browser.number("document.querySelectorAll('#legend .scale').length");
    assert_eq!(scales, 0.0, "law: no scale where no grain has a number");
}

/// Law: the page's lengths grow with the grains, from sand to ballast, and the stages fill their bar
/// however short the run is.
fn fits_the_grains_and_their_time(browser: &mut Browser) {
    let mut sizes = program::column(&small_run().join("grains.csv"), "equivalent_diameter_mm");
    sizes.sort_by(f64::total_cmp);
    let expected = sizes[sizes.len() / 2] / 10.0;
    near("size of the grains over 10 mm", browser.number("pluvia.scale"), expected, 1e-5);
    let shares = browser.number(
        "[...document.querySelectorAll('#stages button')] \
         .reduce((sum, button) => sum + Number(button.style.flexGrow), 0)",
    );
    near("stages share the bar, in percent", shares, 100.0, 1.0);
}

fn plays(browser: &mut Browser) {
    browser.evaluate("pluvia.seek(pluvia.start)");
    let still = [browser.picture(Some(MIDDLE)), browser.picture(Some(MIDDLE))];
    assert!(still[0] == still[1], "law: a picture that does not play stays as it is");
    let seen = browser.colours(&still[0]);
    assert!(seen > 200.0, "law: shaded grains have many colours, expected over 200, got {seen}");

    browser.click_on("play");
    browser.wait_for("pluvia.time > pluvia.start + 0.1");
    browser.click_on("play");
    assert_eq!(browser.evaluate("pluvia.playing"), json!(false), "law: the button pauses, too");
    let moved = browser.picture(Some(MIDDLE));
    assert!(moved != still[0], "law: time went on, so pixels changed");

    browser.choose("rate", "4");
    browser.click_on("view");
    browser.evaluate("pluvia.pick(null)");
    browser.key(" ");
    browser.wait_for("!pluvia.playing && pluvia.time === pluvia.end");
    assert_eq!(browser.evaluate("pluvia.atStageEnd"), json!(true), "law: it plays to the end");
}

fn tells_of_a_grain(browser: &mut Browser) {
    browser.evaluate("pluvia.seek(pluvia.end)");
    browser.choose("plate", "hidden");
    browser.settle();
    let (grain, x, y) = clickable(browser);
    browser.click(x, y);
    browser.wait_for(&format!("pluvia.picked === {grain}"));
    let title = browser.evaluate("document.getElementById('picked-name').textContent");
    assert_eq!(title, json!(grain_name(grain)), "law: the grain clicked is named as in files");
    for (column, digit) in COLUMNS {
        let shown = browser.evaluate(&format!(
            "document.querySelector('#picked-data [data-field={column}]').dataset.value"
        ));
        let got: f64 = shown.as_str().and_then(|s| s.parse().ok()).unwrap_or(f64::NAN);
        let expected = program::column(&small_run().join("grains.csv"), column)[grain];
        // Half the last digit shown, and the rounding of 32-bit numbers.
        let tolerance = 0.5 * digit + 1e-6 * expected.abs() + 1e-9;
        let law = format!("{column} of grain {grain} is that of grains.csv");
        near(&law, got, expected, tolerance);
    }
    browser.keep_picture("picked-1200.png");
    browser.key("Escape");
    browser.wait_for("pluvia.picked === null");
}

fn colours_change(browser: &mut Browser) {
    browser.choose("colour", "fraction");
    let mut before = browser.picture(Some(MIDDLE));
    for (mode, unit) in [
        ("displacement", "mm"),
        ("speed", "mm/s"),
        ("height", "mm"),
        ("coordination", "coordination number"),
        ("fraction", "mm"),
    ] {
        browser.choose("colour", mode);
        assert_eq!(browser.evaluate("pluvia.colour"), json!(mode));
        let now = browser.picture(Some(MIDDLE));
        assert!(now != before, "law: other colours by {mode}");
        let legend = browser.evaluate("document.getElementById('legend').textContent");
        assert!(
            legend.as_str().is_some_and(|text| text.contains(unit)),
            "law: the legend of {mode} names `{unit}`, got {legend}"
        );
        browser.keep_picture(&format!("by-{mode}-1200.png"));
        before = now;
    }
    // The colours of two grains stand in the order of what they show.
    browser.choose("colour", "height");
    let ordered = browser.evaluate(
        "(() => { const grains = [...Array(pluvia.grains).keys()].sort((a, b) => \
         pluvia.positionOf(a)[2] - pluvia.positionOf(b)[2]); \
         const green = n => pluvia.colourOf(n)[1]; \
         return green(grains[0]) < green(grains[grains.length - 1]); })()",
    );
    assert_eq!(ordered, json!(true), "law: viridis grows greener with height");
    browser.choose("colour", "fraction");
}

fn forces_are_shown_at_ends_alone(browser: &mut Browser) {
    assert_eq!(browser.number("pluvia.links"), 0.0, "law: no forces before they are asked for");
    let before = browser.picture(Some(MIDDLE));
    browser.click_on("forces");
    browser.choose("weakest", "0");
    let expected = pairs_at_end(small_run()) as f64;
    assert!(expected > 0.0, "the check has forces to look for");
    let got = browser.number("pluvia.links");
    assert_eq!(got, expected, "law: one line (left) for every two bodies that press (right)");
    assert!(browser.picture(Some(MIDDLE)) != before, "law: they are drawn");
    browser.keep_picture("forces-1200.png");
    browser.evaluate("pluvia.seek(pluvia.end - 0.05)");
    assert_eq!(browser.number("pluvia.links"), 0.0, "law: between frames no force is known");
    let note = browser.evaluate("document.getElementById('ends-note').hidden");
    assert_eq!(note, json!(false), "law: it is said why");
    browser.click_on("to-end");
    assert_eq!(browser.number("pluvia.links"), expected, "law: the button leads to the end");
    browser.click_on("forces");
}

fn cuts(browser: &mut Browser) {
    let whole = browser.picture(Some(MIDDLE));
    // At this end the plane lies outside the cylinder, and all is on its near side.
    browser.choose("cut-axis", "x");
    browser.choose("cut", "0");
    assert_eq!(
        browser.evaluate("(() => { for (let n = 0; n < pluvia.grains; n++) if (pluvia.pickAt(...pluvia.screenOf(n)) !== null) return n; return null; })()"),
        json!(null),
        "law: what is cut away cannot be clicked"
    );
    assert!(browser.picture(Some(MIDDLE)) != whole, "law: the cut takes something away");
    browser.choose("cut-axis", "");
    assert!(browser.picture(Some(MIDDLE)) == whole, "law: without it all is as it was");
}

fn fits_a_small_window(browser: &mut Browser) {
    for scheme in ["light", "dark"] {
        browser.look(390, 844, scheme);
        browser.evaluate("pluvia.seek(pluvia.end)");
        browser.settle();
        assert_eq!(browser.evaluate("document.documentElement.dataset.theme"), json!(scheme));
        let wide = browser.number("document.documentElement.scrollWidth");
        assert!(wide <= 390.0, "law: nothing stands out sideways, got {wide} px");
        let outside = browser.evaluate(
            "[...document.querySelectorAll('#bar *, #head *, #toggle')].filter(e => { \
             const b = e.getBoundingClientRect(); \
             return b.width > 0 && (b.left < 0 || b.right > 390.5 || b.bottom > 844.5); \
             }).map(e => e.id || e.tagName)",
        );
        assert_eq!(outside, json!([]), "law: every control is inside the window");
        browser.keep_picture(&format!("end-390-{scheme}.png"));
    }
    browser.click_on("toggle");
    browser.wait_for("document.getElementById('controls').getBoundingClientRect().height > 100");
    browser.click_on("toggle");
    // A telephone that lies on its side: not narrow, and low.
    browser.look(780, 390, "light");
    browser.settle();
    browser.key("r");
    browser.settle();
    let below = browser.evaluate(
        "pluvia.covered.top * innerHeight >= \
         document.getElementById('head').getBoundingClientRect().bottom - 0.5",
    );
    assert_eq!(below, json!(true), "law: the facts do not stand before what is shown");
    browser.keep_picture("end-780.png");
    browser.look(1200, 800, "light");
}

#[test]
fn what_cannot_be_shown_is_said() {
    let Some(mut browser) = Browser::start("what_cannot_be_shown_is_said") else { return };
    browser.look(1200, 800, "dark");

    // A run without frames.
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    copy_without_frames(small_run(), &run);
    let server = serve(&run);
    browser.open(&server.url());
    assert_eq!(browser.evaluate("[pluvia.kept, pluvia.frames]"), json!([false, 4]));
    browser.evaluate("pluvia.seek(pluvia.start)");
    browser.choose("colour", "displacement");
    legend_says(&mut browser, "unknown: no frames were kept");
    let note = browser.evaluate("document.getElementById('frames-note').innerText");
    assert!(
        note.as_str().is_some_and(|text| text.contains("kept no frames")),
        "law: it is said that only ends are shown, got {note}"
    );
    browser.click_on("play");
    browser.wait_for("!pluvia.playing && pluvia.time === pluvia.end");
    browser.keep_picture("no-frames-1200.png");

    // One file, from the disk.
    let file = folder.path().join("saved.html");
    let data = pluvia::viewer::read_run_data(small_run()).expect("the run");
    fs::write(&file, pluvia::viewer::self_contained(&data)).expect("a file");
    browser.open(&format!("file://{}", file.display()));
    assert_eq!(browser.evaluate("[pluvia.error, pluvia.grains]"), json!([null, data.grains]));
    let picture = browser.picture(Some(MIDDLE));
    let seen = browser.colours(&picture);
    assert!(seen > 200.0, "law: it draws from the disk, expected over 200 colours, got {seen}");
    browser.assert_content("nothing of this is an error");

    // No WebGL.
    let without = "HTMLCanvasElement.prototype.getContext = () => null";
    browser.send("Page.addScriptToEvaluateOnNewDocument", json!({ "source": without }));
    browser.open(&server.url());
    let said = browser.evaluate("document.getElementById('trouble').innerText");
    assert!(
        said.as_str().is_some_and(|text| text.contains("WebGL 2")),
        "law: a browser without WebGL is told so, got {said}"
    );
    browser.assert_content("what is missing is no error, it is said");
}

pub(super) fn copy_without_frames(from: &Path, to: &Path) {
    copy(from, to);
    for stage in stored(to) {
        let _ = fs::remove_file(stage.join("frames.bin"));
    }
}
