//! What the page is given of a run, as one block of bytes.
//!
//! Little endian: the eight bytes of [`MAGIC`], the length of a JSON text as a 32-bit integer, the
//! text (padded with blanks to a multiple of four bytes from the block's beginning), and sections
//! of numbers. The text says where each section begins (`offset`, in bytes from the end of the
//! text) and how many numbers of 32 bits it has (`count`):
//!
//! - `constants`: five floats per grain: fraction, sieve size mm, mass g, volume
//!   mm³, equivalent diameter mm
//! - `shapes.vertex_counts`, `shapes.face_counts`: per shape: grains, then
//!   `apparatus`
//! - `shapes.vertices_m`: three floats per vertex: grain in its principal frame;
//!   cylinder with the table centred; funnel and lid above the funnel's opening;
//!   plate about its centroid
//! - `shapes.face_sizes`, `shapes.corners`: corners per face; vertex numbers
//!   within the shape, counter-clockwise from outside
//! - `stages[].frames`: `count` is in frames, laid out as `frames.bin`
//!   (`src/record/frames.rs`)
//! - `stages[].velocities_m_per_s`: three floats per grain, at the end, in the
//!   laboratory
//! - `stages[].coordination`: neighbours per grain, at the end
//! - `stages[].links`: eight each: two integers (grain; grain, -1 wall or floor,
//!   -2 top plate, -3 funnel), three floats (mean contact point, m), three floats
//!   (force on the first, N)

use std::{io, path::Path};

use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Value, json};

use super::links::links;
use super::shapes::Shape;
use crate::apparatus::{ApparatusError, Funnel, Piece};
use crate::export::{
    ExportError, Exported, FramesRead, Playback, PlayedStage, read_playback, read_run,
};
use crate::grains::sieve_size;
use crate::measure::neighbours;
use crate::picture::palette;
use crate::plain::plain;
use crate::protocol::{Setup, base_pieces};
use crate::specimen::{SavedContact, Specimen};
use crate::units::{to_mm, to_typed_mm};

/// The first bytes of every such block.
pub const MAGIC: &[u8; 8] = b"PLUVIEW1";

/// What `format` says in the text.
pub const FORMAT: &str = "pluvia-view";

/// Raised whenever a page made for the format before would misread the block.
pub const VERSION: u32 = 1;

/// A run as the page is given it.
#[derive(Debug, Clone, PartialEq)]
pub struct RunData {
    /// Name of the scenario.
    pub scenario: String,
    /// Number of grains.
    pub grains: usize,
    /// Number of stages.
    pub stages: usize,
    /// Number of frames of all stages.
    pub frames: usize,
    /// Whether every stage kept frames.
    pub kept: bool,
    /// The block.
    pub bytes: Vec<u8>,
}

/// Where numbers begin, and how many there are.
#[derive(Debug, Clone, Copy, Serialize)]
struct Section {
    offset: usize,
    count: usize,
}

/// Numbers of a grain that do not change: the section `constants`.
const CONSTANTS: usize = 5;

/// Reads a run folder as `pluvia run` and `reproduce` write it.
///
/// # Errors
/// [`ExportError`], naming the file.
pub fn read_run_data(folder: &Path) -> Result<RunData, ExportError> {
    let playback = read_playback(folder, FramesRead::All, None)?;
    let ends = (0..playback.stages.len())
        .map(|n| read_run(folder, Some(&n.to_string())))
        .collect::<Result<Vec<Exported>, _>>()?;
    let ends: Vec<Specimen> = ends.into_iter().map(|end| end.specimen).collect();
    encode(&playback, &ends).map_err(|reason| ExportError::apparatus(folder, reason))
}

/// A run and the specimen at the end of each of its stages.
fn encode(run: &Playback, ends: &[Specimen]) -> Result<RunData, ApparatusError> {
    let mut body = Body::default();
    let (set, setup) = (&run.grains, &run.setup);
    let funnel = Funnel::new(&setup.funnel, 0.0, 0.0)?;

    let sizes: Vec<f64> = set.grains.par_iter().map(|g| sieve_size(&g.shape)).collect();
    let constants = set.grains.iter().zip(&sizes).flat_map(|(g, sieve)| -> [f64; CONSTANTS] {
        let fraction = g.fraction as f64;
        // The units of grains.csv.
        [fraction, to_mm(*sieve), g.mass * 1e3, g.volume * 1e9, to_mm(g.equivalent_diameter)]
    });
    let constants = body.floats(constants);

    let mut shapes: Vec<Shape> = set.grains.iter().map(|g| Shape::of(&g.shape)).collect();
    shapes.push(Shape::of_pieces(&setup.cylinder.pieces));
    shapes.push(Shape::of_pieces(&funnel.pieces));
    shapes.push(Shape::of_pieces(std::slice::from_ref(&funnel.lid)));
    shapes.push(Shape::of(&setup.plate.shape));
    let mut apparatus = ["cylinder", "funnel", "lid", "top_plate"].map(str::to_owned).to_vec();
    let base = ends.iter().find_map(|end| end.state.base.as_ref());
    if base.is_some() {
        let pieces = base_pieces(set, base)?.into_iter().map(|(piece, _)| piece);
        shapes.push(Shape::of_pieces(&pieces.collect::<Vec<Piece>>()));
        apparatus.push("base".to_owned());
    }
    for (n, piece) in setup.pieces.iter().enumerate() {
        shapes.push(Shape::of_pieces(&piece.parts));
        apparatus.push(format!("piece_{n}"));
    }
    let shapes = body.shapes(&shapes);

    let stages: Vec<Value> =
        run.stages.iter().zip(ends).map(|(stage, end)| body.stage(stage, end)).collect();

    let (colours, plate_colour) = palette(set);
    let fractions = set.blocks.iter().enumerate().map(|(n, block)| {
        let grains = set.grains.iter().filter(|g| g.fraction == n).count();
        let (passing, retained) = (to_typed_mm(block.passing), to_typed_mm(block.retained));
        let colour = &colours[n];
        json!({ "passing_mm": passing, "retained_mm": retained, "grains": grains, "colour": colour })
    });
    let pieces = || setup.pieces.iter();
    let header = json!({
        "format": FORMAT,
        "version": VERSION,
        "program": format!("pluvia {}", env!("CARGO_PKG_VERSION")),
        "scenario": plain(&run.scenario),
        "grains": set.grains.len(),
        "frame_bytes": frame_bytes(run),
        "fractions": fractions.collect::<Vec<_>>(),
        "plate_colour": plate_colour,
        "cylinder": cylinder(setup),
        "funnel": { "top_radius_m": funnel.top_radius, "height_m": funnel.top_height },
        // Of the floor under a pile; null where there is none.
        "base": base.map(|base| json!({ "radius_m": base.radius })),
        // Names of the shapes after those of the grains; `base` is among them where there is a
        // pile.
        "apparatus": apparatus,
        // Names of the pieces of a laboratory; their shapes are the last of `apparatus`.
        "pieces": pieces().map(|p| plain(&p.name)).collect::<Vec<_>>(),
        // Of each the radius about the origin of its frame that holds it.
        "piece_radii_m": pieces().map(|p| p.radius).collect::<Vec<_>>(),
        "constants": constants,
        "shapes": shapes,
        "stages": stages,
    });
    Ok(RunData {
        scenario: run.scenario.clone(),
        grains: set.grains.len(),
        stages: run.stages.len(),
        frames: run.stages.iter().map(|s| s.frames.len()).sum(),
        kept: run.stages.iter().all(|s| s.kept),
        bytes: block(&header.to_string(), &body.bytes),
    })
}

/// The cylinder, or what holds all pieces of a laboratory about the axis: what a camera must see.
fn cylinder(setup: &Setup) -> Value {
    if setup.pieces.is_empty() {
        let cylinder = &setup.cylinder;
        return json!({ "radius_m": cylinder.radius, "height_m": cylinder.height });
    }
    let pieces = || setup.pieces.iter().map(|p| (p.at.translation.vector, p.radius));
    let wide = pieces().map(|(at, radius)| at.xy().norm() + radius).fold(0.0, f64::max);
    let high = pieces().map(|(at, radius)| at.z + radius).fold(0.0, f64::max);
    json!({ "radius_m": wide / 1.5, "height_m": high })
}

/// Length of a frame, which all of a run share.
fn frame_bytes(run: &Playback) -> usize {
    let mut bytes = Vec::new();
    if let Some(frame) = run.stages.iter().find_map(|s| s.frames.first()) {
        written(frame.write(&mut bytes));
    }
    bytes.len()
}

fn block(header: &str, body: &[u8]) -> Vec<u8> {
    let mut text = header.as_bytes().to_vec();
    // What stands before it has a multiple of four bytes, too.
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = (text.len() as u32).to_le_bytes();
    [&MAGIC[..], &length[..], &text[..], body].concat()
}

/// Writing to memory does not fail.
fn written(result: io::Result<()>) {
    debug_assert!(result.is_ok(), "memory refuses nothing: {result:?}");
}

/// The sections; every number has four bytes, so that all are aligned.
#[derive(Default)]
struct Body {
    bytes: Vec<u8>,
}

impl Body {
    fn words(&mut self, words: impl Iterator<Item = [u8; 4]>) -> Section {
        let offset = self.bytes.len();
        words.for_each(|word| self.bytes.extend(word));
        Section { offset, count: (self.bytes.len() - offset) / 4 }
    }

    fn floats(&mut self, values: impl Iterator<Item = f64>) -> Section {
        self.words(values.map(|x| (x as f32).to_le_bytes()))
    }

    fn integers(&mut self, values: impl Iterator<Item = u32>) -> Section {
        self.words(values.map(u32::to_le_bytes))
    }

    fn shapes(&mut self, shapes: &[Shape]) -> Value {
        let faces = || shapes.iter().flat_map(|s| &s.faces);
        let vertices = shapes.iter().flat_map(|s| &s.vertices);
        json!({
            "vertex_counts": self.integers(shapes.iter().map(|s| s.vertices.len() as u32)),
            "face_counts": self.integers(shapes.iter().map(|s| s.faces.len() as u32)),
            "vertices_m": self.floats(vertices.flat_map(|v| [v.x, v.y, v.z])),
            "face_sizes": self.integers(faces().map(|f| f.len() as u32)),
            "corners": self.integers(faces().flatten().copied()),
        })
    }

    fn stage(&mut self, stage: &PlayedStage, end: &Specimen) -> Value {
        let offset = self.bytes.len();
        for frame in &stage.frames {
            written(frame.write(&mut self.bytes));
        }
        let frames = Section { offset, count: stage.frames.len() };
        let velocities = end.state.bodies.iter().flat_map(|g| {
            let v = g.body.linear_velocity;
            [v.x, v.y, v.z]
        });
        json!({
            "name": plain(&stage.name),
            "kept": stage.kept,
            // Whether a pile's base stood.
            "base": end.state.base.is_some(),
            "frames": frames,
            "velocities_m_per_s": self.floats(velocities),
            "coordination": self.integers(neighbours(end).into_iter()),
            "links": self.links(&end.state.contacts),
        })
    }

    /// Eight words a link: two parties, a point, the force on the first.
    fn links(&mut self, contacts: &[SavedContact]) -> Section {
        let words = links(contacts).into_iter().flat_map(|link| {
            let numbers = link.point.into_iter().chain(link.force);
            link.between
                .map(i32::to_le_bytes)
                .into_iter()
                .chain(numbers.map(|x| (x as f32).to_le_bytes()))
        });
        self.words(words)
    }
}

#[cfg(test)]
#[path = "data_tests.rs"]
mod tests;
