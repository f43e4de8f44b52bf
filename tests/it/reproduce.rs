//! `pluvia reproduce` as a user meets it, on a few grains: the files it leaves,
//! and its report in a real browser, on a phone and on paper.

use std::{fs, path::Path, sync::OnceLock};

use base64::{Engine, engine::general_purpose::STANDARD};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::{
    program::{done, json as read, text, words},
    viewer::browser::Browser,
};

/// The whole programme on some fifteen grains.
pub(super) const PROGRAMME: &str = "reproduce --quick --configurations 1 \
                                    --set grains.total_mass_g=30 --set rest_test_s=0.2";

/// The whole programme with some twenty grains, once for all tests.
pub(super) fn programme() -> &'static Path {
    static MADE: OnceLock<TempDir> = OnceLock::new();
    let folder = MADE.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let more = ["--quiet", "--out", text(folder.path()), "--placements", "2"];
        done(&[&words(PROGRAMME)[..], &more].concat());
        folder
    });
    folder.path()
}

#[test]
fn every_file_of_the_contract_is_there() {
    let folder = programme();
    let claims = read(&folder.join("claims.json"));
    let claims = claims.as_array().expect("a list");
    assert!(claims.len() >= 25, "law: every statement that runs can show, got {}", claims.len());
    for claim in claims {
        for field in ["id", "source", "paper", "ours", "unit", "kind", "verdict"] {
            assert!(claim.get(field).is_some(), "law: a claim has `{field}`, got {claim}");
        }
        if claim["full_size"] == true && claim["paper"].is_object() {
            let verdict = claim["verdict"].as_str().unwrap_or_default();
            let expected = ["not_comparable", "not_run"];
            assert!(expected.contains(&verdict), "law: nothing of the quick study's size: {claim}");
            assert!(claim["reason"].is_string(), "law: in words: {claim}");
        }
    }
    let card = read(&folder.join("scorecard.json"));
    let rows = card["rows"].as_array().expect("a list").len();
    assert!((6..=8).contains(&rows), "law: six to eight rows, got {rows}");
    let tally = card["tally"].as_object().expect("counts");
    let counted: u64 = tally.values().filter_map(Value::as_u64).sum();
    assert_eq!(counted, rows as u64, "law: a row is counted once, got {tally:?}");
    let results = claims.iter().filter(|c| c["kind"] == "result");
    for verdict in ["within", "outside", "not_run", "not_comparable"] {
        let counted = results.clone().filter(|c| c["verdict"] == verdict).count();
        assert_eq!(card["results"][verdict], counted, "law: results alone are counted");
    }
    let runs = fs::read_dir(folder.join("runs")).expect("runs").flatten();
    let mut count = 0;
    for run in runs {
        count += 1;
        for file in ["manifest.json", "summary.json", "series.csv", "grains.csv"] {
            assert!(run.path().join(file).exists(), "{file} is missing in {:?}", run.path());
        }
    }
    assert_eq!(
        count, 9,
        "law: four pours, two vibrations, a pile, and two placements of the plate"
    );
    let uncertainty = read(&folder.join("uncertainty.json"));
    let plate = &uncertainty["placements"][0];
    let of = |field: &str| plate["specimens"][0][field].as_array().expect("a list").clone();
    let (values, left_out) = (of("values"), of("left_out"));
    assert_eq!(values.len() + left_out.len(), 2, "law: one value a placement, got {plate}");
    assert_ne!(values.first(), values.get(1), "law: placements differ");
    let report = fs::read_to_string(folder.join("report.html")).expect("report.html");
    assert!(
        report.contains("Scatter of specimens and of placements"),
        "law: the report shows them"
    );
}

/// The report's address for a browser.
fn address() -> String {
    format!("file://{}", programme().join("report.html").display())
}

#[test]
fn the_report_needs_no_network_and_fits_a_phone() {
    let text = fs::read_to_string(programme().join("report.html")).expect("report.html");
    for outside in ["src=\"http", "href=\"//", "src=\"//", "@import", "url(http"] {
        assert!(!text.contains(outside), "law: nothing is fetched, but there is `{outside}`");
    }
    let Some(mut browser) = Browser::start("the report") else { return };
    for scheme in ["light", "dark"] {
        for width in [390, 1440] {
            browser.look(width, 900, scheme);
            browser.send("Page.navigate", json!({ "url": address() }));
            browser.wait_for("document.readyState === 'complete' && document.querySelector('h1')");
            let wide = browser.number("document.documentElement.scrollWidth");
            assert!(
                wide <= f64::from(width),
                "law: the page is no wider than its window, expected {width} px, got {wide}"
            );
            let broken = "[...document.images].filter(i => i.complete && !i.naturalWidth).length";
            assert_eq!(browser.number(broken), 0.0, "law: every picture is there");
            browser.keep_picture(&format!("report-{scheme}-{width}.png"));
        }
    }
    browser.assert_content("the report has no faults");
}

/// How many pages a PDF says it has: the root of the tree of pages has the
/// largest count (ISO 32000-1, section 7.7.3).
fn pages(pdf: &[u8]) -> usize {
    let text = String::from_utf8_lossy(pdf);
    let counts = text.match_indices("/Count ").map(|(at, word)| {
        let digits = text[at + word.len()..].chars().take_while(char::is_ascii_digit);
        digits.collect::<String>().parse().unwrap_or(0)
    });
    counts.max().unwrap_or(0)
}

#[test]
fn the_report_can_be_printed() {
    let Some(mut browser) = Browser::start("the printed report") else { return };
    browser.send("Page.navigate", json!({ "url": address() }));
    browser.wait_for("document.readyState === 'complete' && document.querySelector('h1')");
    let asked = json!({ "paperWidth": 8.27, "paperHeight": 11.69, "printBackground": true });
    let printed = browser.send("Page.printToPDF", asked);
    let pdf = STANDARD.decode(printed["data"].as_str().unwrap_or_default()).expect("base64");
    assert!(pdf.starts_with(b"%PDF-"), "law: it is a PDF, got {} bytes", pdf.len());
    let count = pages(&pdf);
    assert!((5..=60).contains(&count), "law: a report of 5 to 60 pages, got {count}");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("viewer");
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join("report.pdf"), pdf).expect("it is written");
}

#[test]
fn pages_are_counted() {
    let tree = b"<</Type /Pages /Count 8 /Kids []>> <</Type /Pages /Count 12>>";
    assert_eq!(pages(tree), 12, "law: the root has the most");
    assert_eq!(pages(b"no pages"), 0, "law: nothing is no PDF");
}
