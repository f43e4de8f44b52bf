//! What `scripts/test-sanitizers.sh` names is there, and its runs have every kind of stage.

use std::collections::BTreeSet;

use pluvia::grains::load_scenario;
use pluvia::scenario::schema;
use serde_json::Value;

use super::{
    architecture::files,
    program::{page, root},
};

const SCRIPT: &str = "scripts/test-sanitizers.sh";

/// Law: the runs that AddressSanitizer looks at, and those of valgrind, have every kind of stage.
#[test]
fn runs_under_sanitizers_have_every_kind_of_stage() {
    let (script, schema) = (page(SCRIPT), schema());
    let variants = schema["$defs"]["StageSpec"]["oneOf"].as_array().expect("stages");
    let name =
        |of: &Value| of["properties"]["stage"]["const"].as_str().expect("its name").to_owned();
    let expected: BTreeSet<String> = variants.iter().map(name).collect();
    let lists: Vec<&str> = script
        .lines()
        .filter_map(|line| line.trim().strip_prefix("for scenario in ")?.strip_suffix("; do"))
        .collect();
    assert_eq!(lists.len(), 2, "law: the script has the two lists of scenarios, got {lists:?}");
    for list in lists {
        let stages = |scenario: &str| {
            let path = root().join(format!("tests/sanitizers/{scenario}.json"));
            let loaded = load_scenario(&path, &[]).unwrap_or_else(|e| panic!("{scenario}: {e:?}"));
            let names = loaded.scenario.stages.iter().map(|stage| stage.name().to_owned());
            names.collect::<Vec<String>>()
        };
        let got: BTreeSet<String> = list.split(' ').flat_map(stages).collect();
        assert_eq!(got, expected, "law: every kind of stage is in `{list}`");
    }
}

/// Law: each name by which the script picks unit tests begins that of one, or is a folder with some.
#[test]
fn sanitizers_pick_unit_tests_that_are_there() {
    let sources = files(&["src/world"], &["rs"]);
    let is_there = |name: &str| {
        let path = format!("src/{}", name.replace("::", "/"));
        let (module, start) = path.rsplit_once('/').expect("a path");
        let (modules, test) =
            ([format!("{module}.rs"), format!("{module}/mod.rs")], format!("#[test]\nfn {start}"));
        let folder = format!("{path}/");
        sources.iter().any(|(file, text)| {
            (modules.contains(file) && text.contains(&test))
                || (file.starts_with(&folder) && text.contains("#[test]"))
        })
    };
    for gone in ["world::bullet::native_tests::gone", "world::gone"] {
        assert!(!is_there(gone), "the check finds no test where there is none");
    }
    let script = page(SCRIPT);
    let names: Vec<&str> =
        script.split_whitespace().filter(|word| word.starts_with("world::")).collect();
    assert!(names.len() >= 5, "law: the script picks unit tests by their names, got {names:?}");
    for name in names {
        assert!(is_there(name), "law: {name} is a unit test, or a module of some");
    }
}
