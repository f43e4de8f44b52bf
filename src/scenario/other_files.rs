//! Files of Pluvia's that are no scenarios, by what stands in them: a person who gives one learns
//! which it is, in place of a fault for each of its fields.

use super::*;

/// Fields that such a file has and no scenario, what it is, and where a scenario is found.
const KNOWN: [(&[&str], &str, &str); 8] = [
    (
        &["engine_settings_read_back", "scenario"],
        "the manifest of a run",
        "a scenario; that of this run stands in its field `scenario`",
    ),
    (&["meets_standard", "scenario"], "the summary of a run", SCENARIO),
    (&["bodies", "table_x"], "the specimen of a run", BEGUN),
    (
        &["blocks"],
        "a file of grains",
        r#"a scenario, which may name it: "grains": { "file": ... }"#,
    ),
    (&["scenario_sha256", "runs"], "the plan of a sweep", SCENARIO),
    (&["full", "ladders"], "a design of `pluvia converge`", SCENARIO),
    (&["full", "parameters"], "a design of `pluvia sensitivity`", SCENARIO),
    (&["command", "question"], "a note of what a folder holds", SCENARIO),
];

const SCENARIO: &str = "a scenario, an object with `name`, `grains` and `stages`";
const BEGUN: &str = r#"a scenario, which may begin with it: "begin": { "specimen": ... }"#;

/// Says which file of Pluvia's the content of one is; `None` of others.
pub(super) fn fault(content: &Map<String, Value>) -> Option<Fault> {
    let has_all = |fields: &&[&str]| fields.iter().all(|field| content.contains_key(*field));
    let (_, what, allowed) = KNOWN.iter().find(|(fields, ..)| has_all(fields))?;
    Some(Fault::new(format!("this is {what}, not a scenario"), "", *allowed))
}
