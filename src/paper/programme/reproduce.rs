//! The paper's whole programme: every configuration poured from every falling
//! height, and the specimens poured from 5 cm shaken in both modes.

use std::collections::BTreeMap;

use super::departures::departures;
use super::pictures::of_programme;
use super::*;
use crate::grains::{GrainSet, ParticleSizeDistribution};
use crate::motion::TableMotion;
use crate::paper;
use crate::plain::in_shell;
use crate::record::read_json;
use crate::report;
use crate::specimen::Specimen;
use crate::study::{PlannedRun, carry_out, described, folder_of, preset, refused};
use crate::units::{to_cm3, to_g, to_mm};
use crate::world::EffectiveSettings;

/// What to reproduce.
pub struct ReproduceOptions {
    /// A few hundred grains instead of 1456, and shorter vibration.
    pub quick: bool,
    /// Number of configurations (paper, section 3: three).
    pub configurations: u32,
    /// How often the plate is laid on each specimen: 1 is the programme's own placement alone; more
    /// are drawn in addition to it, and shaken continuously.
    pub placements: u32,
    /// What is changed in every scenario of the programme, the engine for one.
    pub changes: Vec<Override>,
    /// An interpretation of the paper; `changes` have the last word.
    pub interpretation: Option<Interpretation>,
}

/// What came out.
#[derive(Debug, Clone, PartialEq)]
pub struct ReproduceOutcome {
    /// The paper's statements, judged.
    pub claims: Vec<Claim>,
    /// The results that decide whether it is reproduced.
    pub scorecard: Scorecard,
    /// The report.
    pub report: PathBuf,
    /// All runs.
    pub runs: Vec<RunRecord>,
}

/// Plans the programme, which leaves `claims.json`, `scorecard.json`, `uncertainty.json`,
/// `report.html`, `figures/`, `grains.json`, `sieve.csv` and `runs/<name>/`.
///
/// # Errors
/// [`StudyError`] where the changes do not fit, or something cannot be built.
pub fn reproduce(options: ReproduceOptions) -> Result<Study<ReproduceOutcome>, StudyError> {
    let interpretation = options.interpretation.as_ref();
    let scenarios = Scenarios::load(options.quick, interpretation, &options.changes)?;
    let grains = Arc::new(make_grains(&scenarios.pluviation)?);
    let runs = programme(&scenarios, &grains, options.configurations, options.placements);
    let plan = Plan::new(&runs)?;
    let question = json!({ (MEANWHILE): {
        "quick": options.quick,
        "configurations": options.configurations,
        "placements": options.placements,
        "interpretation": interpretation.map(|i| i.name),
        "changes": options.changes.iter().map(Override::text).collect::<Vec<&str>>(),
    } });
    Ok(Study {
        command: "reproduce",
        question,
        scenarios: runs.iter().map(|run| run.scenario.clone()).collect(),
        conclude: Box::new(move |run| {
            let (records, effective) =
                carry_out(&plan, &runs, run, |of| folder_of(&run.out, &of.name))?;
            finish(&options, run, &scenarios, &grains, records, &effective)
        }),
    })
}

/// The scenarios of the programme.
pub(super) struct Scenarios {
    pub pluviation: Scenario,
    pub continuous: Scenario,
    pub intermittent: Scenario,
    /// The pile of slow pluviation; none under an interpretation, which is about what
    /// the paper simulated, and it simulated no pile.
    pub repose: Option<Scenario>,
    /// What the programme is called: the engine, or the interpretation.
    pub label: String,
    /// What its runs and files are called beside those of the default.
    pub suffix: String,
    /// What changes make otherwise than the paper gives it.
    pub departures: Vec<Departure>,
    quick: bool,
    changes: Vec<Override>,
}

impl Scenarios {
    /// The built-in scenarios under an interpretation, where there is one, and changes.
    pub(super) fn load(
        quick: bool,
        interpretation: Option<&Interpretation>,
        changes: &[Override],
    ) -> Result<Self, StudyError> {
        let poured = if quick { "quick/pluviation.json" } else { "paper/pluviation.json" };
        let with = |name, changes: &[Override]| {
            let mut all = interpretation.map_or(Ok(Vec::new()), |r| r.changes_of(name))?;
            all.extend_from_slice(changes);
            preset(name, &all)
        };
        let preset = |name| with(name, changes);
        let shaken = ["paper/vibration-continuous.json", "paper/vibration-intermittent.json"];
        let [pluviation, continuous, intermittent] = if quick {
            let continuous = preset("quick/vibration.json")?;
            let intermittent = intermittent_of(&continuous);
            [preset(poured)?, continuous, intermittent]
        } else {
            [preset(poured)?, preset(shaken[0])?, preset(shaken[1])?]
        };
        let own = [with(shaken[0], &[])?, with(shaken[1], &[])?];
        let pairs = [(&own[0], &continuous), (&own[1], &intermittent)];
        // The quick study's specimen is another one anyhow.
        let departures = if quick { Vec::new() } else { departures(&pairs) };
        own_values(&pluviation, changes)?;
        let repose = match interpretation {
            None if quick => Some(preset("quick/repose.json")?),
            None => Some(preset("paper/repose.json")?),
            Some(_) => None,
        };
        // What follows a changed specimen or gravity by itself is no change of the engine.
        let is_of_engine = |of: &&Override| of.path().split('.').next() == Some("engine");
        let of_others: Vec<_> = changes.iter().filter(|of| !is_of_engine(of)).cloned().collect();
        let (own, engine) = (with(poured, &of_others)?.engine, &pluviation.engine);
        let (label, suffix) = beside::names(interpretation.map(|of| of.name), &own, engine);
        let changes = changes.to_vec();
        Ok(Self {
            pluviation,
            continuous,
            intermittent,
            repose,
            label,
            suffix,
            departures,
            quick,
            changes,
        })
    }

    /// A hash of the programme without its engine and its interpretation: programmes
    /// that have the same may stand side by side.
    pub(super) fn programme_hash(&self, configurations: u32) -> Result<String, StudyError> {
        let plain = Self::load(self.quick, None, &self.changes)?;
        Ok(beside::programme_hash(&plain.all(), configurations))
    }

    /// A hash of the programme without its interpretation, and with its engine as it is without:
    /// interpretations that have the same may stand side by side.
    pub(super) fn programme_of_interpretations_hash(
        &self,
        configurations: u32,
    ) -> Result<String, StudyError> {
        let plain = Self::load(self.quick, None, &self.changes)?;
        let programme = beside::programme_hash(&plain.all(), configurations);
        Ok(beside::programme_and_engine_hash(&programme, plain.engine()))
    }

    /// All of them.
    pub(super) fn all(&self) -> Vec<&Scenario> {
        let three = [&self.pluviation, &self.continuous, &self.intermittent];
        three.into_iter().chain(&self.repose).collect()
    }

    fn engine(&self) -> &EngineSettings {
        &self.pluviation.engine
    }
}

/// Refuses changes of what the programme gives its runs itself, and which would change nothing.
fn own_values(pluviation: &Scenario, changes: &[Override]) -> Result<(), StudyError> {
    let stages = pluviation.stages.iter().enumerate();
    let pours = stages.filter(|(_, stage)| matches!(stage, StageSpec::Pour { .. }));
    let heights = pours.map(|(n, _)| format!("stages.{n}.falling_height_mm="));
    for path in heights.chain(["configuration=".to_owned()]) {
        let is_it =
            |change: &&Override| path.parse::<Override>().is_ok_and(|at| at.is_where(change));
        if let Some(change) = changes.iter().find(is_it) {
            return refused(format!(
                "--set {} would change nothing: the programme counts configurations from 1 and \
                 pours from the paper's heights (--configurations and --seed give other specimens)",
                change.text()
            ));
        }
    }
    Ok(())
}

/// The same vibration cut into the paper's four periods of whole cycles, with
/// rests as long in proportion as those of the paper's scenario (a fifth of a period).
fn intermittent_of(continuous: &Scenario) -> Scenario {
    let mut scenario = continuous.clone();
    scenario.name = format!("{}-intermittent", scenario.name);
    for stage in &mut scenario.stages {
        // A recorded motion has one period, which cannot be cut.
        if let StageSpec::Vibrate(stage) = stage
            && let (Some(frequency), Some(whole)) = (stage.frequency_hz, stage.duration_s)
        {
            let cycles = (whole / 4.0 * frequency).round().max(1.0);
            let duration = cycles / frequency;
            stage.duration_s = Some(duration);
            stage.periods = 4;
            stage.rest_s = duration / 5.0;
        }
    }
    scenario
}

/// A scenario in which the plate is laid as a placement of a number has it.
fn placed(scenario: &Scenario, number: u32) -> Scenario {
    let mut scenario = scenario.clone();
    for stage in &mut scenario.stages {
        if let StageSpec::PlaceTopPlate(stage) = stage {
            stage.placement = number;
        }
    }
    scenario
}

/// Every run of the programme.
pub(super) fn programme(
    scenarios: &Scenarios,
    grains: &Arc<GrainSet>,
    configurations: u32,
    placements: u32,
) -> Vec<PlannedRun> {
    let mut runs = Vec::new();
    for configuration in 1..=configurations {
        let mut add = |name: String, kind, scenario: &Scenario, falling_height| {
            let mut scenario = scenario.clone();
            scenario.configuration = configuration;
            for stage in &mut scenario.stages {
                if let StageSpec::Pour { falling_height_mm, .. } = stage {
                    *falling_height_mm = falling_height;
                }
            }
            let name = name + &scenarios.suffix;
            runs.push(PlannedRun { name, kind, scenario, grains: grains.clone(), prepared: None });
        };
        for height in FALLING_HEIGHTS_MM {
            let name = format!("pluviation-c{configuration}-fh{height:03}");
            add(name, RunKind::Pluviation, &scenarios.pluviation, height);
        }
        for (mode, kind, scenario) in [
            ("continuous", RunKind::VibrationContinuous, &scenarios.continuous),
            ("intermittent", RunKind::VibrationIntermittent, &scenarios.intermittent),
        ] {
            let name = format!("vibration-{mode}-c{configuration}");
            add(name, kind, scenario, VIBRATED_FALLING_HEIGHT_MM);
        }
        // The placements of a design are all drawn: the programme's own, on the axis, is none of them.
        for number in (1..=placements).filter(|_| placements > 1) {
            let name = format!("vibration-continuous-c{configuration}-placement{number:02}");
            let scenario = placed(&scenarios.continuous, number);
            add(name, RunKind::VibrationPlacement, &scenario, VIBRATED_FALLING_HEIGHT_MM);
        }
        if let Some(scenario) = &scenarios.repose {
            // Nothing is poured: the falling height is that of no stage.
            add(format!("repose-c{configuration}"), RunKind::Repose, scenario, 0.0);
        }
    }
    runs
}

/// Compares the runs with the paper and writes claims and report.
fn finish(
    options: &ReproduceOptions,
    run: &RunOptions,
    scenarios: &Scenarios,
    grains: &Arc<GrainSet>,
    records: Vec<RunRecord>,
    effective: &EffectiveSettings,
) -> Result<ReproduceOutcome, StudyError> {
    let study = study_view(options.configurations, scenarios, grains, &records)?;
    let claims = paper::claims(&study);
    let scorecard = paper::scorecard(&study, &claims);
    write_json(&run.out.join("claims.json"), &claims)?;
    write_json(&run.out.join("scorecard.json"), &scorecard)?;
    write_json(&run.out.join("uncertainty.json"), &paper::uncertainty(&study))?;
    let column = Column {
        label: scenarios.label.clone(),
        programme: scenarios.programme_hash(options.configurations)?,
        claims: claims.clone(),
        stock_bullet: scenarios.engine().is_stock(),
        settlement: MeanSettlement::of(&study),
    };
    let progress = run.progress.as_ref();
    let beside = beside::keep_and_read(&run.out, &scenarios.suffix, &column, progress)?;
    // The shaken scenario has every choice of the poured one, and more.
    let mut choices = paper::choices(&scenarios.intermittent);
    choices.extend(scenarios.repose.iter().flat_map(paper::pile_choices));
    let (pictures, warnings) = pictures(run, scenarios);
    paper::write_report(
        &run.out,
        &ReportInput {
            study,
            claims: &claims,
            scorecard: &scorecard,
            beside: &beside,
            choices: &choices,
            changes: &changes(options),
            standard: standard(&Scale::PAPER),
            provenance: &provenance(options, scenarios),
            effective,
            piles: &pile_pictures(&run.out, grains, &records)?,
            pictures: &pictures,
            warnings: &warnings,
        },
    )?;
    Ok(ReproduceOutcome { claims, scorecard, report: run.out.join("report.html"), runs: records })
}

/// The side view of the first pile, from the files of its run.
fn pile_pictures(
    out: &Path,
    grains: &Arc<GrainSet>,
    records: &[RunRecord],
) -> Result<Vec<Figure>, StudyError> {
    let pile = |r: &RunRecord| Some((r.name.clone(), r.summary.angle_of_repose.clone()?));
    let Some((name, angle)) = records.iter().find_map(pile) else { return Ok(Vec::new()) };
    let state = read_json(&folder_of(out, &name).join("specimen.json"))?;
    let specimen = Specimen { grains: grains.clone(), state };
    Ok(vec![report::pile_picture(&specimen, &angle)?])
}

/// The paper's pictures from the first configuration, and why there are none where
/// they cannot be made: a report is worth having without them.
fn pictures(run: &RunOptions, scenarios: &Scenarios) -> (Vec<Picture>, Vec<String>) {
    let name = format!("vibration-continuous-c1{}", scenarios.suffix);
    run.progress.message("making the pictures");
    match of_programme(&folder_of(&run.out, &name)) {
        Ok(pictures) => (pictures, Vec::new()),
        Err(error) => (Vec::new(), vec![format!("There are no pictures of {name}: {error}")]),
    }
}

/// How the programme differs from the default one: an interpretation, and changes as they were
/// typed.
fn changes(options: &ReproduceOptions) -> Vec<String> {
    let interpretation = options.interpretation.as_ref();
    let interpretation = interpretation.map(|i| format!("interpretation {}: {}", i.name, i.title));
    let typed = options.changes.iter().map(|change| change.text().to_owned());
    interpretation.into_iter().chain(typed).collect()
}

/// Where the results come from, in words.
fn provenance(options: &ReproduceOptions, scenarios: &Scenarios) -> BTreeMap<String, String> {
    let engine = crate::world::info(scenarios.engine().backend);
    let target = format!("{} {}", std::env::consts::ARCH, std::env::consts::OS);
    let mut settings = beside::label(&EngineSettings::default(), scenarios.engine());
    let mut mode = if options.quick { " --quick" } else { "" }.to_owned();
    if let Some(interpretation) = &options.interpretation {
        let Interpretation { name, title, .. } = interpretation;
        mode += &format!(" --interpretation {name}");
        settings = format!("interpretation {name}: {title}; {settings}");
    }
    if options.placements > 1 {
        mode += &format!(" --placements {}", options.placements);
    }
    mode += &format!(" --configurations {}", options.configurations);
    for change in &options.changes {
        mode += &format!(" --set {}", in_shell(change.text()));
    }
    [
        ("Pluvia", env!("CARGO_PKG_VERSION").to_owned()),
        ("Engine", format!("{} {}, {} precision", engine.name, engine.version, engine.precision)),
        ("Settings", settings),
        ("Machine", target),
        ("Command", format!("pluvia reproduce{mode}")),
        ("Seed", scenarios.pluviation.seed.to_string()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// The study as claims and report see it.
pub(super) fn study_view<'a>(
    configurations: u32,
    scenarios: &Scenarios,
    grains: &Arc<GrainSet>,
    runs: &'a [RunRecord],
) -> Result<StudyView<'a>, StudyError> {
    let GrainsSpec::Sieved(sieved) = &scenarios.pluviation.grains else {
        return refused("the paper's grains come from a sieve table".into());
    };
    let distribution = ParticleSizeDistribution::new(sieved).map_err(StudyError::grains)?;
    let known = described(grains);
    let still = || TableMotion { periods: 0, ..TableMotion::sine(0.0, 0.0, 0.0) };
    Ok(StudyView {
        runs,
        left_out: &[],
        configurations,
        sieve: distribution.passing_curve(),
        sieved_grains: known.sieved.points().iter().map(|p| (to_mm(p.0), p.1)).collect(),
        grain_count: grains.grains.len(),
        total_mass_g: to_g(grains.total_mass()),
        solids_volume_cm3: to_cm3(grains.total_volume()),
        gradation: distribution.gradation().into(),
        generated: Some(known.sieved.gradation().into()),
        shapes: known.shapes.clone(),
        intermittent: scenarios.intermittent.motion().unwrap_or_else(still),
        pile_friction: scenarios
            .repose
            .as_ref()
            .map_or(f64::NAN, |s| s.contact.grain_grain_friction),
        quick: scenarios.quick,
        departures: scenarios.departures.clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: a change that the programme would overwrite is refused.
    #[test]
    fn what_the_programme_sets_itself_is_no_change() {
        let converged = Interpretation::named("converged").expect("an interpretation");
        for (typed, refused) in [
            ("configuration=5", true),
            ("stages.1.falling_height_mm=20", true),
            ("stages[1].falling_height_mm=20", true),
            ("seed=5", false),
        ] {
            let change: Override = typed.parse().expect("a change");
            let loaded = Scenarios::load(true, Some(&converged), &[change]);
            let got = loaded.err().map(|e| e.to_string());
            let said = format!("--set {typed} would change nothing");
            let is_refused = got.as_ref().is_some_and(|got| got.contains(&said));
            assert_eq!(is_refused, refused, "law: of {typed} (got left): {got:?}");
        }
    }

    /// Law: an interpretation with another engine has names of its own, so that it stands beside
    /// itself in `reproduce`; in `interpretations`, where every column has the same changes, it
    /// is another programme.
    #[test]
    fn a_changed_engine_is_no_other_interpretation() {
        let load = |name: &str, typed: &[&str]| {
            let interpretation = Interpretation::named(name).expect("an interpretation");
            let changes: Vec<Override> =
                typed.iter().map(|text| text.parse().expect("a change")).collect();
            Scenarios::load(true, Some(&interpretation), &changes).expect("scenarios")
        };
        let lighter = load("full_stroke", &["gravity_m_per_s2=9.8"]);
        assert_eq!(
            lighter.suffix, "-interpretation-full-stroke",
            "law: what follows gravity is not"
        );
        let stock = ["engine.contact_solver=stock"];
        let (plain, changed) = (load("full_stroke", &[]), load("full_stroke", &stock));
        assert_eq!(plain.label, "interpretation full_stroke");
        assert_eq!(plain.suffix, "-interpretation-full-stroke", "law: the name alone");
        assert!(changed.label.contains("full_stroke, contact_solver stock"), "{}", changed.label);
        assert_ne!(plain.suffix, changed.suffix, "law: runs of both have their names");
        let reproduced = |of: &Scenarios| of.programme_hash(1).expect("a hash");
        assert_eq!(reproduced(&plain), reproduced(&changed), "law: beside each other");
        let compared = |of: &Scenarios| of.programme_of_interpretations_hash(1).expect("a hash");
        assert_ne!(compared(&plain), compared(&changed), "law: other changes in all columns");
        let other = load("per_body", &[]);
        assert_eq!(compared(&plain), compared(&other), "law: interpretations stand side by side");
        let own = load("bullet_stock", &[]);
        assert_eq!(compared(&plain), compared(&own), "law: whatever engine they have themselves");
    }

    /// Law: the command that is shown gives the same programme again, with every change.
    #[test]
    fn the_command_has_every_change() {
        let typed = ["grains.total_mass_g=60", "engine.backend=\"bullet\""];
        let changed_by = |typed: &[&str]| ReproduceOptions {
            quick: true,
            configurations: 2,
            placements: 1,
            changes: typed.iter().map(|text| text.parse().expect("a change")).collect(),
            interpretation: None,
        };
        let command = |options: &ReproduceOptions| {
            let scenarios = Scenarios::load(true, None, &options.changes).expect("scenarios");
            provenance(options, &scenarios)["Command"].clone()
        };
        let (plain, changed) = (changed_by(&[]), changed_by(&typed));
        let expected = "pluvia reproduce --quick --configurations 2";
        assert_eq!(command(&plain), expected, "law: nothing is changed");
        let expected =
            format!("{expected} --set grains.total_mass_g=60 --set 'engine.backend=\"bullet\"'");
        assert_eq!(command(&changed), expected, "law: as a shell reads it");
        assert!(changes(&plain).is_empty(), "law: the default programme");
        assert_eq!(changes(&changed), typed, "law: as they were typed");
    }
}
