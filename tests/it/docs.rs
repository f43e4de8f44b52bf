//! What the documents say of commands, fields, defaults, links and versions is
//! so.

mod commands;
mod markdown;

use std::{collections::BTreeSet, fs};

use pluvia::export::Carrier;
use pluvia::grains::load_scenario;
use pluvia::scenario::{EngineSettings, NativeSettings, RapierSettings, Scenario, StockSettings};
use serde_json::Value;

use super::program::{self, done, page as read, root};
use markdown::{anchors, blocks, links, make_targets};

/// Paths of the Markdown files at the root and in the folders of the documentation.
fn documents() -> Vec<String> {
    let mut found = Vec::new();
    for folder in ["", "docs/", "docs/concepts/", "docs/results/"] {
        for entry in fs::read_dir(root().join(folder)).expect("the crate's folders can be listed") {
            let name = entry.expect("a folder entry can be read").file_name();
            let name = name.to_string_lossy();
            if name.ends_with(".md") {
                found.push(format!("{folder}{name}"));
            }
        }
    }
    found.sort();
    assert!(found.len() >= 4, "expected README, ARCHITECTURE, CHANGELOG and docs/, got {found:?}");
    found
}

#[test]
fn make_targets_exist() {
    let makefile = read("Makefile");
    let missing = |text: &str| -> Vec<String> {
        make_targets(text)
            .into_iter()
            .filter(|target| !makefile.lines().any(|l| l.starts_with(&format!("{target}:"))))
            .collect()
    };
    for document in documents() {
        let missing = missing(&read(&document));
        assert!(missing.is_empty(), "{document} names targets the Makefile lacks: {missing:?}");
    }
    assert_eq!(
        missing("`make test bogus OUT=x ARGS=\"--quick other\"`"),
        ["bogus"],
        "the check finds faults"
    );
}

#[test]
fn links_resolve() {
    fn broken(document: &str, text: &str) -> Vec<String> {
        let folder = root().join(document).parent().expect("a file has a folder").to_owned();
        links(text)
            .into_iter()
            .filter(|target| !target.contains("://") && !target.starts_with("mailto:"))
            .filter(|target| {
                let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
                let path = if path.is_empty() { root().join(document) } else { folder.join(path) };
                let anchor_found = || {
                    fs::read_to_string(&path)
                        .is_ok_and(|t| anchors(&t).contains(&anchor.to_owned()))
                };
                !path.exists() || !anchor.is_empty() && !anchor_found()
            })
            .collect()
    }
    for document in documents() {
        let broken = broken(&document, &read(&document));
        assert!(broken.is_empty(), "{document} has links to nowhere: {broken:?}");
    }
    let text = "[a](README.md#first-run) [b](nowhere.md) [c](README.md#nowhere) [d](https://x.y/z)";
    let found = broken("README.md", text);
    assert_eq!(found, ["nowhere.md", "README.md#nowhere"], "the check finds faults");
}

#[test]
fn changelog_and_citation_have_the_crate_version() {
    let version = env!("CARGO_PKG_VERSION");
    let changelog = read("CHANGELOG.md");
    let latest = changelog.lines().find_map(|l| l.strip_prefix("## [")).unwrap_or_default();
    assert!(
        latest.starts_with(&format!("{version}]")),
        "the first entry of CHANGELOG.md is `{latest}`, expected [{version}]"
    );
    let citation = read("CITATION.cff");
    let cited = citation.lines().find_map(|l| l.strip_prefix("version: "));
    assert_eq!(cited, Some(version), "version in CITATION.cff (left), of the crate (right)");
}

/// Pages with a scenario that readers copy, and the language of its block: the short one, the
/// complete one.
const SHOWN: [(&str, &str); 2] = [("README.md", "json"), ("docs/scenario-files.md", "jsonc")];

/// The one block of a page in a language.
fn shown(page: &str, language: &str) -> String {
    let mut found = blocks(&read(page), language);
    assert_eq!(found.len(), 1, "{page} has one block of {language}");
    found.remove(0)
}

/// Law: what a reader copies can be run: with its comments.
#[test]
fn the_shown_scenarios_load_as_they_stand() {
    let folder = tempfile::tempdir().expect("a folder");
    for (page, language) in SHOWN {
        let path = folder.path().join(format!("{language}.json"));
        fs::write(&path, shown(page, language)).expect("it is written");
        if let Err(faults) = load_scenario(&path, &[]) {
            panic!("the {language} of {page} is refused: {faults}");
        }
    }
}

#[test]
fn gravel_and_pile_of_the_tutorial_are_scenarios_of_the_same_grains() {
    let scenarios = blocks(&read("docs/tutorial.md"), "json");
    let folder = tempfile::tempdir().expect("a folder");
    let loaded = ["my-gravel.json", "my-pile.json"].iter().zip(&scenarios).map(|(name, text)| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("it is written");
        load_scenario(&path, &[])
            .unwrap_or_else(|faults| panic!("{name} of docs/tutorial.md is refused: {faults}"))
    });
    let grains: Vec<_> =
        loaded.map(|l| serde_json::to_value(&l.scenario.grains).expect("JSON")).collect();
    assert_eq!(grains.len(), 2, "the tutorial has a gravel and a pile");
    assert_eq!(grains[0], grains[1], "law: friction is calibrated on the user's own grains");
}

#[test]
fn the_complete_scenario_shows_every_field_and_default() {
    let [_, (page, language)] = SHOWN;
    let block = shown(page, language);
    let lines: String = block.lines().map(|l| l.split(" //").next().unwrap_or_default()).collect();
    let complete: Value = serde_json::from_str(&lines).expect("it is JSON without its comments");
    let scenario: Scenario = serde_json::from_value(complete.clone()).expect("it is a scenario");
    let fields = |value: &Value| -> BTreeSet<String> { paths("", value).collect() };
    let known = fields(&serde_json::to_value(&scenario).expect("a scenario has a JSON form"));
    let shown = fields(&complete);
    let missing: Vec<_> = known.difference(&shown).collect();
    assert!(missing.is_empty(), "docs/scenario-files.md does not show {missing:?}");

    let mut required = complete;
    required
        .as_object_mut()
        .expect("it is an object")
        // The interval is shown with what it is where it is left out.
        .retain(|key, _| ["name", "grains", "stages", "sample_interval_s"].contains(&key.as_str()));
    let bare: Scenario = serde_json::from_value(required).expect("nothing else is required");
    let (shown, default) = (format!("{scenario:#?}"), format!("{bare:#?}"));
    for (shown, default) in shown.lines().zip(default.lines()) {
        assert_eq!(shown, default, "docs/scenario-files.md (left), default in the code (right)");
    }
}

/// Every field of a JSON value as a dotted path; elements of arrays are reported
/// apart by their number.
fn paths<'a>(prefix: &str, value: &'a Value) -> Box<dyn Iterator<Item = String> + 'a> {
    let prefix = prefix.to_owned();
    match value {
        Value::Object(map) => Box::new(map.iter().flat_map(move |(key, value)| {
            let path = format!("{prefix}.{key}");
            std::iter::once(path.clone()).chain(paths(&path, value))
        })),
        Value::Array(items) => Box::new(
            items.iter().enumerate().flat_map(move |(i, v)| paths(&format!("{prefix}[{i}]"), v)),
        ),
        _ => Box::new(std::iter::empty()),
    }
}

/// A page is what the program prints; `by` writes it anew.
fn assert_kept(path: &str, printed: &str, by: &str) {
    let kept = read(path);
    let differs = printed.lines().zip(kept.lines()).find(|(new, old)| new != old);
    assert!(
        printed == kept,
        "law: {path} is what the program prints; {by} writes it anew. First difference (printed, \
         kept): {differs:?}"
    );
}

#[test]
fn every_field_of_a_scenario_is_on_its_page() {
    let printed = done(&["schema", "--page"]);
    assert_kept("docs/scenario.md", &printed, "`cargo run -- schema --page > docs/scenario.md`");
}

/// `PLUVIA_WRITE=1` writes the table anew.
#[test]
fn every_quantity_of_the_scale_is_on_its_page() {
    let page = read("docs/scale.md");
    let (before, rest) = page.split_once("<!-- SCALE: from src/scale.rs -->\n").expect("a mark");
    let (kept, after) = rest.split_once("<!-- END -->").expect("its end");
    let table = pluvia::scale::table();
    if std::env::var_os("PLUVIA_WRITE").is_some() {
        let page = format!("{before}<!-- SCALE: from src/scale.rs -->\n{table}<!-- END -->{after}");
        fs::write(root().join("docs/scale.md"), page).expect("written");
        return;
    }
    assert_eq!(kept, table, "law: docs/scale.md holds the table of src/scale.rs");
}

#[test]
fn engine_settings_are_explained_with_their_defaults() {
    let table = read("docs/parameters.md");
    let settings = [
        ("", serde_json::to_value(EngineSettings::default())),
        ("stock.", serde_json::to_value(StockSettings::default())),
        ("native.", serde_json::to_value(NativeSettings::default())),
        ("rapier.", serde_json::to_value(RapierSettings::default())),
    ];
    for (prefix, defaults) in settings {
        let defaults = defaults.expect("settings have JSON");
        // Settings of their own have rows of their own.
        let own = defaults.as_object().expect("settings are an object").iter();
        for (field, default) in own.filter(|(_, value)| !value.is_object()) {
            let row = format!("| `{prefix}{field}` | `{default}` | ");
            assert!(table.contains(&row), "docs/parameters.md has no row that begins {row}");
        }
    }
}

#[test]
fn a_pile_is_explained_with_its_defaults() {
    let page = read("docs/parameters.md");
    let typed = r#"{"stage": "slow_pluviation", "base_diameter_mm": 240}"#;
    let stage: pluvia::scenario::StageSpec = serde_json::from_str(typed).expect("a stage");
    let stage = serde_json::to_value(&stage).expect("a stage has JSON");
    for field in ["feed_rate_grains_per_s", "drop_height_mm", "spout_diameter_mm", "time_limit_s"] {
        let default = stage[field].as_f64().unwrap_or_else(|| panic!("no default of {field}"));
        let row = format!("| `{field}` | `{default}` | ");
        assert!(page.contains(&row), "docs/parameters.md has no row that begins {row}");
    }
}

#[test]
fn options_of_pictures_are_explained_with_their_defaults() {
    let help = done(&["picture", "--help"]);
    let page = read("docs/pictures.md");
    for option in ["--cylinder", "--azimuth", "--elevation", "--width", "--background"] {
        let of_option = help.split(&format!("\n      {option} ")).nth(1).unwrap_or_default();
        let default = of_option.split("[default: ").nth(1).unwrap_or_default();
        let default = default.split([';', ']']).next().unwrap_or_default();
        let row = page.lines().find(|l| l.starts_with(&format!("| `{option}`")));
        let cell = row.and_then(|r| r.split('|').nth(2)).unwrap_or_default().replace('`', "");
        let first = cell.trim().split(',').next().unwrap_or_default();
        assert_eq!(first, default, "default of {option} in docs/pictures.md (left), in its help");
    }
}

#[test]
fn fields_of_results_are_explained() {
    let page = read("docs/files.md");
    let source = read("src/record/summary.rs") + &read("src/record/series.rs");
    let mut count = 0;
    let mut renamed = None;
    for line in source.lines().map(str::trim) {
        if let Some(rest) = line.strip_prefix("#[serde(rename = \"") {
            renamed = rest.split('"').next();
        }
        let Some((field, _)) = line.strip_prefix("pub ").and_then(|l| l.split_once(": ")) else {
            continue;
        };
        if field.starts_with("fn ") {
            continue;
        }
        let name = renamed.take().unwrap_or(field);
        assert!(page.contains(&format!("`{name}`")), "docs/files.md does not explain `{name}`");
        count += 1;
    }
    assert!(count > 40, "expected the fields of summary.json and series.csv, found {count}");
}

/// Law: every column of the tables of grains and of sieves is explained.
#[test]
fn columns_of_grains_and_sieves_are_explained() {
    let page = read("docs/files.md");
    let of_grains = read("src/record/grain_table.rs");
    let (_, names) = of_grains.split_once("const COLUMNS: &str = \"").expect("their columns");
    let (names, _) = names.split_once("\";").expect("the end of the columns");
    let names = names.split([',', '\\', '\n', ' ']).filter(|name| !name.is_empty());
    let of_sieves = read("src/grains/sieve_table.rs");
    let cells = of_sieves.lines().filter_map(|line| line.trim().strip_prefix("(\""));
    let columns: Vec<&str> = names.chain(cells.filter_map(|cell| cell.split('"').next())).collect();
    for column in &columns {
        assert!(page.contains(&format!("`{column}`")), "docs/files.md does not explain `{column}`");
    }
    assert!(columns.len() > 35, "expected the columns of both tables, found {columns:?}");
}

/// Law: whatever may carry a piece of the apparatus is on the page of the exchange format.
#[test]
fn what_carries_a_piece_is_explained() {
    let page = read("docs/exchange.md");
    let line = page.split("\n- ").find(|line| line.starts_with("`apparatus`")).expect("its line");
    for carrier in [Carrier::Fixed, Carrier::Table, Carrier::Kinematic] {
        let name = serde_json::to_value(carrier).expect("JSON");
        let name = name.as_str().expect("a word");
        assert!(line.contains(&format!("`{name}`")), "law: `{name}` is explained, got {line}");
    }
}

/// Law: the README is one page: at most 9 KB.
#[test]
fn the_readme_is_one_page() {
    let bytes = read("README.md").len();
    assert!(bytes <= 9216, "law: README.md has at most 9216 bytes, got {bytes}");
}

/// Law: every page is in the site's contents, and the contents name no page that is not there.
#[test]
fn every_page_is_in_the_contents_of_the_site() {
    let contents = read("mkdocs.yml");
    let (_, nav) = contents.split_once("\nnav:\n").expect("mkdocs.yml has a nav");
    let named: BTreeSet<String> = nav
        .lines()
        .filter_map(|l| l.split(' ').next_back().filter(|word| word.ends_with(".md")))
        .map(str::to_owned)
        .collect();
    // README, tour and history are added by scripts/site.py.
    let added = ["about.md", "architecture.md", "changelog.md"];
    let mut there = BTreeSet::from(added.map(str::to_owned));
    there.extend(documents().iter().filter_map(|d| d.strip_prefix("docs/")).map(str::to_owned));
    assert_eq!(named, there, "law: pages in mkdocs.yml (left) and in docs/ (right)");
}

/// Help of the program or of one of its commands, 100 columns wide.
fn help(arguments: &[&str]) -> String {
    let mut command = program::pluvia();
    command.args(arguments).arg("--help").envs([("COLUMNS", "100"), ("NO_COLOR", "1")]);
    String::from_utf8(command.output().expect("the program starts").stdout).expect("UTF-8")
}

/// The page of commands, from the program's own help.
fn commands_page() -> String {
    let all = help(&[]);
    let mut page = "# Commands\n\nThe program's own help. `PLUVIA_WRITE=1 cargo test --test it \
                    docs` writes this page. [Files of a run](files.md) says what each command \
                    leaves, [exit codes](faq.md#exit-codes) how it ends.\n"
        .to_owned();
    let mut section = |title: &str, text: &str| {
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        let text = lines.join("\n");
        page.push_str(&format!("\n## {title}\n\n```text\n{}\n```\n", text.trim_end()));
    };
    section("pluvia", &all);
    let (_, list) = all.split_once("\nCommands:\n").expect("the help lists commands");
    for line in list.lines().take_while(|line| line.starts_with("  ")) {
        // Lines that go on are indented further.
        if let Some(name) = line[2..].split(' ').next().filter(|n| !n.is_empty() && *n != "help") {
            section(&format!("pluvia {name}"), &help(&[name]));
        }
    }
    page
}

/// Law: every field that a `summary.json` may have stands in the pages.
#[test]
fn every_field_of_summaries_is_explained() {
    let schema = schemars::schema_for!(pluvia::record::Summary).to_value();
    let parts = schema["$defs"].as_object().expect("parts").values().chain([&schema]);
    let fields: BTreeSet<&String> =
        parts.filter_map(|part| part["properties"].as_object()).flat_map(|of| of.keys()).collect();
    assert!(fields.len() > 100, "law: fields are found, got {}", fields.len());
    let pages: String = documents()
        .iter()
        .filter(|page| page.starts_with("docs/"))
        .map(|page| read(page))
        .collect();
    let is_in_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words: BTreeSet<&str> = pages.split(|c: char| !is_in_name(c)).collect();
    let missing: Vec<_> = fields.iter().filter(|field| !words.contains(field.as_str())).collect();
    assert!(missing.is_empty(), "law: no page explains {missing:?}");
}

/// `PLUVIA_WRITE=1` writes the page anew.
#[test]
fn every_command_is_on_its_page() {
    let page = commands_page();
    assert!(page.matches("\n## pluvia ").count() >= 15, "law: all commands are found");
    if std::env::var_os("PLUVIA_WRITE").is_some() {
        fs::write(root().join("docs/commands.md"), page).expect("written");
        return;
    }
    assert_kept("docs/commands.md", &page, "PLUVIA_WRITE=1");
}
