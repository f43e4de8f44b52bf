//! One paper: what it states, with section and figure, its programme run by us, how each statement
//! is compared with the runs, and the report that says so. No module below uses it; its scenarios
//! stand in `study/presets.rs`, its friction and angle of repose in `report/calibration.rs`.
//!
//! The paper is Izadi & Bezuijen (2014), "Simulation of granular soil behaviour using the Bullet
//! physics library". Only its text was available to us: for what stood in its figures alone (sieve
//! curve, laboratory bands of Figures 7 and 10, size of the funnel) we substitute no values.

pub mod bands;
#[cfg(test)]
pub(crate) mod canned;
mod claim;
mod claims;
pub mod constants;
mod fluctuation;
mod mean_settlement;
mod programme;
mod report;
mod scorecard;
pub mod uncertainty;
mod view;

pub use bands::{PaperValue, Stated};
pub use claim::{Claim, ClaimKind, NotValid, Verdict};
pub use claims::claims;
pub use mean_settlement::MeanSettlement;
pub use programme::{
    Interpretation, InterpretationsOptions, InterpretationsOutcome, ReproduceOptions,
    ReproduceOutcome, interpretations, reproduce,
};
pub use report::{
    Choice, Column, InterpretationCell, InterpretationColumn, InterpretationFailure,
    InterpretationRow, ReportInput, choices, pile_choices, write as write_report,
    write_interpretations,
};
pub use scorecard::{ResultCounts, RowCounts, ScoreRow, Scorecard, scorecard};
pub use uncertainty::{Uncertainty, uncertainty};
pub use view::{Departs, Departure, StudyView};

use std::{
    path::{Path, PathBuf},
    sync::{Arc, LazyLock},
};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::measure::{Interval, inference::MeanTest, statistics::mean};
use crate::plain::{counted, in_number, without_zeros};
use crate::record::{NO_VALID_RUN, RunKind, RunRecord, Settlement, left_out_in_words, write_json};
use crate::report::{
    Figure, Look, Picture, Plot, ReportError, Standard,
    page::{Block, Page},
    quality::never_mixed,
    settlement::settlement_curve,
    style,
    table::{Cell, Table, dash, from_to, row, table},
    text::{compact, listed, number, thousandths},
};
use crate::scale::Scale;
use crate::scenario::{Backend, EngineSettings, GrainsSpec, Override, Scenario, StageSpec};
use crate::study::{MEANWHILE, Plan, RunOptions, Study, StudyError, make_grains, standard};

// What several files share.
use {
    claim::{Draft, unit_of},
    constants::{CONTINUOUS_S, FALLING_HEIGHTS_MM, MM_IN_CM, VIBRATED_FALLING_HEIGHT_MM},
    uncertainty::{CONFIDENCE, PlacementScatter, trend},
    view::{angle_of_repose, height_mm, plate, share_percent, surface},
};
