//! Pictures of specimens and apparatus, by ray casting: no display, no graphics
//! card, the same pixels on any number of threads.
//!
//! A moment of a run becomes a `Scene` of convex solids; a camera on an orbit around it casts rays;
//! grains are coloured by what is asked for; a key and notes stand beside the picture.

mod animation;
mod camera;
mod colour;
pub(crate) mod figures;
mod image;
mod light;
mod loose;
mod moment;
mod paint;
mod render;
mod scene;
mod scenery;
mod sheet;
mod shot;
mod solid;

pub use animation::{Animated, Animation, animate};
pub use camera::View;
pub use figures::of_run;
pub use image::{Background, Image};
pub use loose::{VIEW as LOOSE_VIEW, loose_grains};
pub use moment::{At, at};
pub use paint::{ColourBy, palette};
pub use scenery::Walls;
pub use shot::{SIDES, Shot, picture};

// What its parts are made of, too.
use crate::apparatus::ApparatusError;
use crate::export::{ExportError, Playback};
use crate::geometry::{ConvexPolyhedron, Point, Pose, Vector};
use crate::grains::GrainSet;
use crate::plain::three_decimals as number;
use crate::record::{FileError, Frame};
use crate::scenario::MeantStage;
use crate::units::to_mm;
use {
    camera::*, colour::*, light::*, moment::*, paint::*, scene::*, scenery::*, sheet::*, shot::*,
    solid::*,
};

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The run could not be read.
    #[error(transparent)]
    Run(#[from] ExportError),
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// No one stage of the run is meant.
    #[error("{0}")]
    Stage(String),
    /// Nothing was kept of that time.
    #[error("no frame is stored at {} s; {allowed}", shown(asked_s))]
    NoTime {
        /// What was asked for, in s since the run began.
        asked_s: f64,
        /// Which times there are.
        allowed: String,
    },
    /// Colours by a quantity that needs frames which were not kept.
    #[error(
        "colours by {0} need frames of the stage before this moment, and there are none; \
         fraction, coordination and plain need none"
    )]
    NeedsFrames(&'static str),
    /// Colours that tell of motion or contacts, of grains that lie apart.
    #[error("grains alone have no {0}: colour them by fraction or plain")]
    NeedsRun(&'static str),
    /// An animation of one frame.
    #[error("nothing moves: an animation needs two frames at least (frames.bin of the stage)")]
    NothingMoves,
    /// Numbers out of range, a line each.
    #[error("{0}")]
    Range(String),
    /// An animation that would become too large.
    #[error(
        "the animation would take about {expected_mb:.0} MB in {frames} frames, allowed are \
         {allowed_mb} MB: take fewer frames (--every), a smaller --width or a larger --limit-mb"
    )]
    TooLarge {
        /// Expected size in MB.
        expected_mb: f64,
        /// Number of frames.
        frames: usize,
        /// Allowed size in MB.
        allowed_mb: f64,
    },
    /// Asked to stop.
    #[error("stopped; nothing is written")]
    Cancelled,
    /// The apparatus cannot be built.
    #[error(transparent)]
    Apparatus(ApparatusError),
    /// Text or file could not be made.
    #[error("the picture cannot be drawn: {0}")]
    Drawing(String),
}

impl From<png::EncodingError> for PictureError {
    fn from(error: png::EncodingError) -> Self {
        Self::Drawing(error.to_string())
    }
}

impl PictureError {
    /// Whether another request would do, so that it is a matter of usage.
    pub fn is_usage(&self) -> bool {
        match self {
            Self::Run(ExportError::File(error)) | Self::File(error) => error.refused,
            Self::Drawing(_) => false,
            _ => true,
        }
    }
}
