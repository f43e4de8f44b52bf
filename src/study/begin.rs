//! The specimen of another run that a run begins with: read from that run's store, and checked as
//! a stored stage is before it is used.

use super::stage_end::end_of;
use super::*;
use crate::record::run_file;
use crate::scenario::BeginSpec;

/// The file that holds a run's grains.
pub(super) const GRAINS_FILE: &str = "grains.json";

/// A specimen that a run begins with.
#[derive(Debug, PartialEq)]
pub struct Begun {
    /// Folder of that run.
    pub run: PathBuf,
    /// Key of the stage at whose end it was.
    pub key: String,
    /// What that stage says of itself.
    pub record: StageRecord,
    /// Its state.
    pub state: SpecimenState,
}

impl Begun {
    /// Reads what a scenario begins with; `grains_sha256` is the hash of its grains. Refused is a
    /// stored specimen that is not as it was written, of other grains, or none of this laboratory.
    pub(super) fn read(
        spec: &BeginSpec,
        grains: &Arc<GrainSet>,
        grains_sha256: &str,
        setup: &Setup,
    ) -> Result<Arc<Self>, StudyError> {
        let run = spec.folder();
        let root = run_file(&run, "stages");
        let key = spec.key.clone().unwrap_or_default();
        let noted = spec.specimen_sha256.as_deref().unwrap_or_default();
        let (record, state, file) = StageStore::stage_in(&root, &key, noted)?;
        let unfit = |why: String| FileError::unfit(&file, why);
        let identity = record.identity.as_ref().filter(|identity| identity.key == key);
        let identity = identity.ok_or_else(|| unfit("it does not say which stage it is".into()))?;
        if identity.grains_sha256 != grains_sha256 {
            return Err(unfit("it is a specimen of other grains".to_owned()).into());
        }
        state.check(grains.grains.len()).map_err(unfit)?;
        if state.pieces.len() != setup.pieces.len() {
            let (there, asked) = (counted(state.pieces.len(), "piece"), setup.pieces.len());
            return Err(unfit(format!("it has {there}, the scenario {asked}")).into());
        }
        let specimen = Specimen { grains: grains.clone(), state };
        // It has come to its end under the gravity of its own run, which may be another.
        let gravity = identity.determined_by["gravity_m_per_s2"].as_f64();
        let gravity =
            gravity.ok_or_else(|| unfit("it does not say under which gravity it was".into()))?;
        let scale = Scale { gravity, ..setup.scale };
        let made_in = Setup { gravity, scale, ..setup.clone() };
        plausible(&made_in, &specimen, 0.0, 0.0).map_err(unfit)?;
        let recorded = record.end.ok_or_else(|| unfit("it does not say how it ended".into()))?;
        end_of(gravity, &specimen).is(&recorded).map_err(unfit)?;
        // Wherever the store is looked over.
        let run = std::path::absolute(&run).unwrap_or(run);
        Ok(Arc::new(Self { run, key, record, state: specimen.state }))
    }

    /// Refuses a seed or a configuration of a scenario that is not the specimen's and draws nothing:
    /// the run would be called another realisation than it is.
    pub(super) fn refuse_other_name(&self, scenario: &Scenario) -> Result<(), StudyError> {
        if scenario.has_realisations() {
            return Ok(());
        }
        let made = self.record.identity.as_ref().map(|identity| &identity.determined_by);
        let of_scenario =
            [("seed", scenario.seed), ("configuration", u64::from(scenario.configuration))];
        let others = of_scenario.into_iter().filter_map(|(field, typed)| {
            let own = made?[field].as_u64()?;
            (own != typed).then(|| {
                format!(
                    "{field}: it is not that of the specimen (found {typed}; allowed: {own}, or the \
                     field left out)"
                )
            })
        });
        let others: Vec<String> = others.collect();
        if others.is_empty() {
            return Ok(());
        }
        refused(format!(
            "`{}` begins with one specimen and draws nothing at random itself, so it keeps that \
             specimen's seed and configuration: {}",
            scenario.name,
            others.join("; ")
        ))
    }
}

/// The grains of the run that a scenario begins with. `own` is the file of grains that the scenario
/// names, if any: refused where it holds others.
pub(super) fn grains_of(spec: &BeginSpec, own: Option<&Path>) -> Result<GrainSet, StudyError> {
    let file = run_file(&spec.folder(), GRAINS_FILE);
    let set = read_grains(&file)?;
    match own.filter(|own| *own != file) {
        Some(own) if read_grains(own)? != set => refused(format!(
            "grains.file: {} holds other grains than the run in {}: a specimen that is begun with \
             has its grains; leave the field out",
            own.display(),
            spec.folder().display()
        )),
        _ => Ok(set),
    }
}

/// The grains in a file.
pub(super) fn read_grains(file: &Path) -> Result<GrainSet, FileError> {
    grains::from_json(&read_json(file)?).map_err(|e| FileError::unfit(file, e))
}

#[cfg(test)]
#[path = "begun_tests.rs"]
mod tests;
