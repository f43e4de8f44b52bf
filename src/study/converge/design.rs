//! The design of a convergence study: which settings are refined, and how far.

use super::*;

/// A convergence study as its file describes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConvergenceDesign {
    /// What the study is for.
    #[serde(default)]
    pub description: String,
    /// The specimen.
    pub full: SpecimenDesign,
    /// A smaller one, for `--quick`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quick: Option<SpecimenDesign>,
    /// How far a result may be from the converged one.
    pub limits: ConvergenceLimits,
    /// Name of the ladder whose finest rung stands for the converged result of
    /// the whole study; every setting is compared with it, too.
    #[schemars(length(min = 1))]
    pub reference: String,
    /// The ladders.
    #[schemars(length(min = 1, max = 100))]
    pub ladders: Vec<LadderDesign>,
}

/// Largest deviations that pass, in percent of the converged value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConvergenceLimits {
    /// Of the height of the mean surface after pouring.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 100.0))]
    pub height_percent: f64,
    /// Of the settlements of plate and mean surface.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 100.0))]
    pub settlement_percent: f64,
}

/// Settings that are refined step by step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LadderDesign {
    /// Short name; begins the names of runs.
    #[schemars(length(min = 1, max = 40))]
    pub name: String,
    /// What is refined, for tables and figures.
    #[schemars(length(min = 1, max = 100))]
    pub title: String,
    /// Changes that all rungs have, each `path=value`.
    #[serde(default)]
    pub changes: Vec<String>,
    /// Most configurations, where the ladder is costly.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1000))]
    pub configurations: Option<u32>,
    /// From the coarsest to the finest, which is the ladder's converged one.
    #[schemars(length(min = 2, max = 100))]
    pub rungs: Vec<RungDesign>,
}

/// One rung of a ladder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RungDesign {
    /// Short name; ends the names of runs.
    #[schemars(length(min = 1, max = 40))]
    pub name: String,
    /// The setting in words.
    #[schemars(length(min = 1, max = 100))]
    pub title: String,
    /// Changes, each `path=value`; none for the scenario as it is.
    #[serde(default)]
    pub changes: Vec<String>,
    /// Whether it is also run with `--quick`.
    #[serde(default = "yes")]
    pub quick: bool,
}

/// A design that was read and checked.
#[derive(Debug)]
pub(super) struct Designed {
    pub quick: bool,
    pub limits: ConvergenceLimits,
    /// Title of the ladder whose finest rung is the converged result.
    pub reference: String,
    /// The ladders, each with its rungs from the coarsest to the finest.
    pub ladders: Vec<Ladder>,
    pub varied: Varied,
    pub configurations: u32,
}

/// A ladder with the names of its variations.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ladder {
    pub title: String,
    /// Name of the variation and title of each rung.
    pub rungs: Vec<(String, String)>,
}

impl Designed {
    /// Reads a design; tells all its faults, or else all of the scenarios it makes.
    pub(super) fn of_file(file: &Path, quick: bool) -> Result<Self, ScenarioErrors> {
        let design: ConvergenceDesign = load_document(file)?;
        let mut faults = Faults::of(file);
        let chosen = faults.chosen(&design.full, design.quick.as_ref(), quick);
        let mut names = Vec::new();
        let (mut ladders, mut variations) = (Vec::new(), Vec::<Variation>::new());
        for (l, ladder) in design.ladders.iter().enumerate() {
            let at = format!("ladders[{l}]");
            faults.name(&format!("{at}.name"), &ladder.name, &mut names);
            let before = &design.ladders[..l];
            if before.iter().any(|other| other.title == ladder.title) {
                let found = format!("\"{}\"", ladder.title);
                faults.add(&format!("{at}.title"), &found, "", "the title is given twice");
            }
            let common = faults.changes(&format!("{at}.changes"), &ladder.changes);
            let mut known = Vec::new();
            let mut rungs = Vec::new();
            for (r, rung) in ladder.rungs.iter().enumerate() {
                let at = format!("{at}.rungs[{r}]");
                faults.name(&format!("{at}.name"), &rung.name, &mut known);
                let own = faults.changes(&format!("{at}.changes"), &rung.changes);
                if quick && !rung.quick {
                    continue;
                }
                let name = format!("{}-{}", ladder.name, rung.name);
                // Names that are given twice have their faults.
                let is_new = before.iter().all(|other| other.name != ladder.name)
                    && ladder.rungs[..r].iter().all(|other| other.name != rung.name);
                if is_new && variations.iter().any(|known| known.name == name) {
                    let found = format!("\"{}\"", rung.name);
                    let allowed =
                        format!("another name: runs of another ladder are called `{name}`");
                    faults.add(&format!("{at}.name"), &found, &allowed, "two runs have one name");
                }
                rungs.push((name.clone(), rung.title.clone()));
                variations.push(Variation {
                    name,
                    group: ladder.title.clone(),
                    changes: [common.as_slice(), &own].concat(),
                    configurations: ladder.configurations,
                });
            }
            if rungs.len() == 1 {
                let path = format!("{at}.rungs");
                faults.add(&path, "1", "none or at least 2", "too few rungs are left with --quick");
            }
            if !rungs.is_empty() {
                ladders.push(Ladder { title: ladder.title.clone(), rungs });
            }
        }
        let reference = design.ladders.iter().find(|l| l.name == design.reference);
        let reference = reference.map(|l| l.title.clone());
        if !reference.as_ref().is_some_and(|title| ladders.iter().any(|l| l.title == *title)) {
            let found = format!("\"{}\"", design.reference);
            faults.add("reference", &found, "the name of a ladder that is run", "it is none");
        }
        let Some(chosen) = chosen else { return Err(faults.into_error()) };
        let varied = faults.load(&chosen, variations)?;
        let Chosen { configurations, .. } = chosen;
        let reference = reference.unwrap_or_default();
        Ok(Self { quick, limits: design.limits, reference, ladders, varied, configurations })
    }
}
