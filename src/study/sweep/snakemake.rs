//! A sweep as a Snakefile: one rule a level of stages, each stage with the file
//! it leaves and the stage it goes on from, and one rule that collects.
//!
//! Mölder et al., *Sustainable data analysis with Snakemake*, F1000Research 10:33 (2021).

use super::*;

/// Name of the file in the output folder.
pub const SNAKEFILE: &str = "Snakefile";

const TEMPLATE: &str = include_str!("Snakefile.template");

/// Writes the Snakefile of a planned sweep into its folder.
///
/// # Errors
/// [`StudyError::File`].
pub fn write(tasks: &SweepTasks, program: &Path) -> Result<(), StudyError> {
    let path = tasks.folder().join(SNAKEFILE);
    Ok(write_file(&path, text(tasks, program).as_bytes())?)
}

fn text(tasks: &SweepTasks, program: &Path) -> String {
    let levels: Vec<_> = (0..tasks.levels().len()).map(|level| tasks.stages(level)).collect();
    let stages = || levels.iter().flatten();
    let line = |stage: &SweepStage, of: &str| {
        format!("    {}: {},\n", literal(&folder_name(stage.key)), literal(of))
    };
    let level = |stages: &Vec<SweepStage>| {
        let keys = stages.iter().map(|stage| literal(&folder_name(stage.key)));
        let lines: String = keys.map(|key| format!("        {key},\n")).collect();
        format!("    [\n{lines}    ],\n")
    };
    let parent = |stage: &SweepStage| Some(line(stage, &folder_name(stage.parent?)));
    let rule = |level: usize| {
        let input = if level == 0 { "ancient(\"plan.json\")" } else { "ancient(goes_on_from)" };
        let cores = tasks.cores(level);
        format!(
            "rule level_{level}:\n    input: {input}\n    output: update(\"stages/{{stage}}/stage.json\")\n    \
             wildcard_constraints: stage=\"|\".join(LEVELS[{level}])\n    \
             params: name=named\n    message: \"{{params.name}}\"\n    threads: {cores}\n    \
             shell: \"{{PLUVIA:q}} stage . --key {{wildcards.stage}} --quiet\"\n\n"
        )
    };
    TEMPLATE
        .replace("@rules@", &(0..levels.len()).map(rule).collect::<String>())
        .replace("@levels@", &levels.iter().map(level).collect::<String>())
        .replace("@parents@", &stages().filter_map(parent).collect::<String>())
        .replace("@names@", &stages().map(|stage| line(stage, stage.label)).collect::<String>())
        .replace("@program@", &literal(&program.to_string_lossy()))
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
