//! What a run left, for other programs: the exchange format that other engines
//! read, tables, and meshes of everything in its place.

mod apparatus;
mod exchange;
mod obj;
mod playback;
mod run_folder;
mod tables;

pub use apparatus::{Carrier, StandingPiece, standing};
pub use exchange::{
    ApparatusPiece, Damping, ExchangeContact, ExchangeGrain, FORMAT, MadeBy, PairValue, Place,
    PlateBody, Scene, SceneError, Table, TableLaw, VERSION,
};
pub use obj::{apparatus_obj, grains_obj};
pub use playback::{Playback, PlayedStage, read_playback};
pub use run_folder::{ExportError, Exported, read_run};
pub use tables::{contacts_csv, grains_csv, pairs_csv};
