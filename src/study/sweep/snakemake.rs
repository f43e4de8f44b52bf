//! A sweep as a Snakefile: one rule a level of stages, each stage with the file
//! it leaves and the stage it goes on from, and one rule that collects.
//!
//! Mölder et al., *Sustainable data analysis with Snakemake*, F1000Research 10:33 (2021).

use std::{fmt::Write as _, path::Path};

use super::{super::StudyError, SweepTasks};
use crate::record::{StageStore, write_file};

/// Name of the file in the output folder.
pub const SNAKEFILE: &str = "Snakefile";

const HEAD: &str = r##"# Written by `pluvia sweep --snakemake`. From any folder:
#     snakemake --cores 2 --snakefile THIS/FOLDER/Snakefile
# The folder can be moved. Another program: --config pluvia=/path/to/pluvia
#
# Stages lie under the hash of all that determines them: whether one is there
# counts, its age does not. Therefore `ancient`, and `update`, which leaves alone
# what is there: asked for a stage that is stored, the program does nothing.

workdir: workflow.basedir

"##;

const RULES_BEGIN: &str = r#"
def stored(stage):
    return f"stages/{stage}/stage.json"

def goes_on_from(wildcards):
    return stored(FROM[wildcards.stage])

def named(wildcards):
    return NAME[wildcards.stage]

"#;

const COLLECT: &str = r#"ALL = [stored(stage) for level in LEVELS for stage in level]
TABLES = ["sweep.csv", "sweep.json", "sweep.md", "report.html"]

rule collect:
    input: ALL
    output: TABLES
    message: "collect the results"
    shell: "{PLUVIA:q} sweep --collect --out . --quiet"

# Stages are asked for by themselves: one that is lost is missed though the tables are there.
rule all:
    default_target: True
    input: ALL, TABLES
"#;

/// Writes the Snakefile of a planned sweep into its folder.
///
/// # Errors
/// [`StudyError::File`].
pub fn write(tasks: &SweepTasks, program: &Path) -> Result<(), StudyError> {
    let path = tasks.folder().join(SNAKEFILE);
    Ok(write_file(&path, text(tasks, program).as_bytes())?)
}

fn text(tasks: &SweepTasks, program: &Path) -> String {
    // Writing to a string does not fail.
    let mut text = HEAD.to_owned();
    let _ =
        writeln!(text, "PLUVIA = config.get(\"pluvia\", {})", literal(&program.to_string_lossy()));
    let levels: Vec<_> = (0..tasks.levels().len()).map(|level| tasks.stages(level)).collect();
    text += "\n# The stages of each level; those of a level need only such of the levels before.\n";
    text += "LEVELS = [\n";
    for level in &levels {
        text += "    [\n";
        for stage in level {
            let _ = writeln!(text, "        {},", literal(&folder_name(stage.key)));
        }
        text += "    ],\n";
    }
    text += "]\n\n# What each stage goes on from.\nFROM = {\n";
    for stage in levels.iter().flatten() {
        if let Some(parent) = stage.parent {
            let (stage, parent) = (folder_name(stage.key), folder_name(parent));
            let _ = writeln!(text, "    {}: {},", literal(&stage), literal(&parent));
        }
    }
    text += "}\n\n# What each stage is.\nNAME = {\n";
    for stage in levels.iter().flatten() {
        let _ =
            writeln!(text, "    {}: {},", literal(&folder_name(stage.key)), literal(stage.label));
    }
    text += "}\n";
    text += RULES_BEGIN;
    for level in 0..levels.len() {
        let input = if level == 0 { "ancient(\"plan.json\")" } else { "ancient(goes_on_from)" };
        let cores = tasks.cores(level);
        let _ = write!(
            text,
            "rule level_{level}:\n    input: {input}\n    output: update(\"stages/{{stage}}/stage.json\")\n    \
             wildcard_constraints: stage=\"|\".join(LEVELS[{level}])\n    \
             params: name=named\n    message: \"{{params.name}}\"\n    threads: {cores}\n    \
             shell: \"{{PLUVIA:q}} stage . --key {{wildcards.stage}} --quiet\"\n\n"
        );
    }
    text + COLLECT
}

/// Name of a stage's folder in the store.
fn folder_name(key: &str) -> String {
    StageStore::folder_in(Path::new(""), key).to_string_lossy().into_owned()
}

/// A text as Python has it: JSON's quotes and escapes mean the same there.
fn literal(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_quoted_as_in_python() {
        assert_eq!(literal("/a b/it's \"x\"\\"), r#""/a b/it's \"x\"\\""#);
    }
}
