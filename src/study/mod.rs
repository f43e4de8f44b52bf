//! Runs scenarios stage by stage, with a store of finished stages, and the studies of many runs:
//! sweeps and their targets, calibration, convergence, sensitivity, index densities and comparison.

mod accuracy;
mod begin;
mod believed;
mod calibrate;
mod checks;
mod compare;
mod compared;
mod converge;
mod declaration;
mod density;
mod described;
mod design;
mod engine_key;
mod execute;
mod fallen;
mod inside;
mod laboratory;
mod lids;
mod motions;
mod plan;
mod presets;
mod realisations;
mod recorder;
mod run;
mod sensitivity;
mod slurm;
mod stage_end;
mod stage_key;
mod standing;
mod summarise;
mod sweep;
mod targets;
#[cfg(test)]
mod tests;
mod tilt;
mod told;
mod variations;

pub use crate::report::{CompareRecord, CompareRun};
pub use accuracy::standard;
pub use calibrate::{CalibrationOptions, CalibrationTarget, GRAIN_FRICTION, calibrate};
pub use compare::compare;
pub use compared::{HEIGHT_BAND, VOID_RATIO_BAND};
pub use converge::{
    ConvergenceDesign, ConvergenceLimits, LadderDesign, RungDesign, StudyOptions, converge,
};
pub use declaration::{AT_LEAST, MEANWHILE, Study, WORDS};
pub use density::{DensityOptions, IndexDensities, IndexState, OfStates, density};
pub use design::SpecimenDesign;
pub use execute::{RunOptions, available_cores};
pub use presets::preset;
pub use recorder::container;
pub use run::{ReadyRun, grain_files, make_grains};
pub use sensitivity::{Parameter, ParameterDesign, SensitivityDesign, sensitivity};
pub use slurm::{SlurmJob, SlurmRequest, submit as submit_to_slurm, this_program};
pub use stage_key::FORMAT as STAGE_FORMAT;
pub use summarise::peak_memory_mib;
pub use sweep::{
    Design, Factor, PLAN_FILE, PlannedPoint, Point, SCENARIO_FILE, SNAKEFILE, SampledRange,
    SweepOptions, SweepPlan, SweepStage, SweepStatus, SweepStudy, SweepTasks, write_snakefile,
};
pub use targets::{TargetRuns, meet_targets};
pub use told::tell_warnings;
pub use variations::{Variation, Varied, carry_out_variations, write_variations};

// What studies are made of, too.
use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    ops::{ControlFlow, Range},
    path::{Path, PathBuf},
    str::FromStr,
    sync::{Arc, Mutex, PoisonError},
};

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::apparatus::ApparatusError;
use crate::geometry::Vector;
use crate::grains::{self, GrainSet, GrainsError, ParticleSizeDistribution, load_scenario};
use crate::in_order::{each_once, grouped};
use crate::measure::{
    self, Container, Estimate, HeightMap, LoadedContact, MeasureError, change_for_one_unit,
    contacts_of_grains_in, fabric, fates, grain_energy, height_cell_over, inference::MeanTest,
    overlap_statistics, paired_difference, pairs_within, stress_in, void_ratio, void_ratio_in,
};
use crate::motion::MotionFacts;
use crate::plain::{counted, in_number};
use crate::protocol::{Midway, Progress, Setup, Work, WorldMaker, plausible};
use crate::record::{
    AskedStage, Beside, Checkpoints, EnergyRow, FabricSummary, FileError, FrameWriter,
    LaboratoryRow, Overlap, ProfileRow, RunKind, RunRecord, RunRow, SeriesRow, SolverResidual,
    StageChecks, StageIdentity, StageRecord, StageStore, StoredStage, StressSummary, Summary,
    VariationRow, Withheld, create_folder, hash_json, keep_beside, read_json, to_csv, write_file,
    write_json,
};
use crate::report::{self, ReportError, Sensitivity, Standard};
use crate::scale::{self, Scale};
use crate::scenario::{
    Backend, EngineSettings, Fault, GrainsSpec, Override, Scenario, ScenarioErrors, StageSpec,
    load_document, warnings,
};
use crate::specimen::{Fate, Specimen, SpecimenState};
use crate::units::{from_mm, to_cm3, to_g, to_mm};
use crate::world::EffectiveSettings;
use {
    believed::held,
    declaration::in_question,
    design::{Chosen, Faults, range, yes},
    execute::Shop,
    plan::{Node, RunNodes},
    presets::with_design,
    realisations::{CONFIGURATIONS, refuse_repeats, refuse_shared},
    sensitivity::End,
    told::of_grains,
    variations::conclude_so_far,
};
pub(crate) use {
    described::described,
    plan::{Plan, PlannedRun},
    run::{carry_out, carry_out_each, folder_of, write_shared_grains},
};

/// Why a study did not finish.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The scenario asks for something that cannot be made.
    #[error("{0}")]
    Scenario(String),
    /// A built-in scenario has faults after what was changed in it.
    #[error(transparent)]
    Faults(#[from] ScenarioErrors),
    /// A stage does not fit where it stands.
    #[error("{stage}: {what}")]
    Stage {
        /// Which stage.
        stage: String,
        /// What is wrong.
        what: String,
    },
    /// The simulation became unphysical, or the engine failed.
    #[error("{stage}: {what}; the last good state is kept in {}", kept.display())]
    Simulation {
        /// Which stage.
        stage: String,
        /// What happened, where and when.
        what: String,
        /// File with the last good state.
        kept: PathBuf,
    },
    /// The program itself failed in a stage: a panic.
    #[error("{stage}: a fault of the program ended this stage, please report it: {what}")]
    Fault {
        /// Which stage.
        stage: String,
        /// What the panic said, and where.
        what: String,
    },
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The report could not be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A result could not be measured.
    #[error("a result could not be measured: {0}")]
    Measure(String),
    /// Asked to stop; what is finished is stored, and the same command resumes from there.
    #[error("stopped; run the same command again to resume")]
    Cancelled,
}

/// Refuses what a study is asked for, and says why.
pub(crate) fn refused<T>(why: String) -> Result<T, StudyError> {
    Err(StudyError::Scenario(why))
}

impl StudyError {
    /// An error with what is not lost by it, where it is about a file.
    fn keeping(self, store: &StageStore) -> Self {
        match self {
            Self::File(error) => Self::File(store.keeping(error)),
            other => other,
        }
    }

    /// What cannot be built, of a run.
    fn apparatus(run: &str, error: &ApparatusError) -> Self {
        Self::Scenario(format!("{run}: {error}"))
    }

    pub(crate) fn grains(error: GrainsError) -> Self {
        Self::Scenario(error.to_string())
    }

    fn measure(error: MeasureError) -> Self {
        Self::Measure(error.to_string())
    }
}
