//! What became of each mesh, for the table `stones.csv` and for warnings.

use std::io::Write;

use super::rounded;
use crate::{grains::GrainsError, units::to_mm};

/// One stone: its mesh as read, the shape made of it, and how it was used.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StoneRecord {
    /// The file.
    pub file: String,
    /// The object in the file.
    pub object: String,
    /// Vertices of the mesh, no two at one place.
    pub mesh_vertices: usize,
    /// Faces of the mesh.
    pub mesh_faces: usize,
    /// Volume of the mesh in m³.
    pub mesh_volume: f64,
    /// Volume of the mesh over that of its convex hull.
    pub convexity: f64,
    /// Whether the shape is the hull, or simpler, and not the mesh itself.
    pub hull: bool,
    /// Vertices of the shape.
    pub vertices: usize,
    /// Faces of the shape.
    pub faces: usize,
    /// Volume of the shape in m³.
    pub volume: f64,
    /// How far in m the mesh sticks out of a simplified hull; 0 where none was simplified.
    pub left_out: f64,
    /// Sieve size of the shape in m, before any scaling.
    pub sieve_size: f64,
    /// Number of grains with this shape.
    pub grains: usize,
    /// Smallest and largest number of times its own size at which it was taken.
    pub scales: (f64, f64),
}

/// Scales that need no explanation: a stone stands for one ten times finer or
/// coarser; a factor of 1000 is more likely a wrong unit.
const USUAL_SCALES: (f64, f64) = (0.05, 20.0);

impl StoneRecord {
    /// Notes a grain of this shape, so many times the stone's size.
    pub(super) fn take(&mut self, scale: f64) {
        let (least, most) = self.scales;
        self.scales = match self.grains {
            0 => (scale, scale),
            _ => (least.min(scale), most.max(scale)),
        };
        self.grains += 1;
    }

    /// Volume of the shape less that of the mesh, in percent of the mesh's.
    pub fn volume_change_percent(&self) -> f64 {
        100.0 * (self.volume / self.mesh_volume - 1.0)
    }

    /// Volume that the convex hull adds to the mesh, in percent of the mesh's.
    pub fn hull_adds_percent(&self) -> f64 {
        100.0 * (1.0 / self.convexity - 1.0)
    }

    /// What a reader of results should know of stones: hulls in place of
    /// meshes, simplified hulls, and scales that point to a wrong unit.
    pub fn notes(stones: &[Self]) -> Vec<String> {
        let mut notes = Vec::new();
        let largest = |of: fn(&Self) -> f64| {
            stones
                .iter()
                .map(of)
                .fold(0.0, |most: f64, x| if x.abs() > most.abs() { x } else { most })
        };
        let hulls = stones.iter().filter(|s| s.hull).count();
        if hulls > 0 {
            notes.push(format!(
                "{hulls} of {} stones are the convex hulls of their meshes, which add at most {} % to \
                 the volume",
                stones.len(),
                rounded(largest(Self::hull_adds_percent))
            ));
        }
        let simplified = stones.iter().filter(|s| s.left_out > 0.0).count();
        if simplified > 0 {
            notes.push(format!(
                "{simplified} hulls were simplified: the mesh sticks out by at most {} mm, and the \
                 volume differs from the mesh's by at most {} %",
                rounded(to_mm(largest(|s| s.left_out))),
                rounded(largest(Self::volume_change_percent))
            ));
        }
        let used = || stones.iter().filter(|s| s.grains > 0);
        let least = used().map(|s| s.scales.0).fold(f64::INFINITY, f64::min);
        let most = used().map(|s| s.scales.1).fold(0.0, f64::max);
        if least < USUAL_SCALES.0 || most > USUAL_SCALES.1 {
            notes.push(format!(
                "stones were scaled by {} to {} to their sieves: is `mesh_unit` right?",
                rounded(least),
                rounded(most)
            ));
        }
        notes
    }
}

/// Writes `stones.csv`: a row a stone.
///
/// # Errors
/// When writing fails.
pub fn stones_csv(stones: &[StoneRecord], into: impl Write) -> Result<(), GrainsError> {
    let mut csv = csv::Writer::from_writer(into);
    csv.write_record([
        "file",
        "object",
        "mesh_vertices",
        "mesh_faces",
        "mesh_volume_mm3",
        "convexity",
        "hull",
        "vertices",
        "faces",
        "volume_mm3",
        "volume_change_percent",
        "left_out_mm",
        "sieve_size_mm",
        "grains",
        "smallest_scale",
        "largest_scale",
    ])?;
    for stone in stones {
        csv.write_record([
            stone.file.clone(),
            stone.object.clone(),
            stone.mesh_vertices.to_string(),
            stone.mesh_faces.to_string(),
            format!("{:.6}", stone.mesh_volume * 1e9),
            format!("{:.6}", stone.convexity),
            stone.hull.to_string(),
            stone.vertices.to_string(),
            stone.faces.to_string(),
            format!("{:.6}", stone.volume * 1e9),
            // No minus before what rounds to zero.
            format!("{:.4}", (stone.volume_change_percent() * 1e4).round() / 1e4 + 0.0),
            format!("{:.6}", to_mm(stone.left_out)),
            format!("{:.4}", to_mm(stone.sieve_size)),
            stone.grains.to_string(),
            format!("{:.6}", stone.scales.0),
            format!("{:.6}", stone.scales.1),
        ])?;
    }
    csv.flush()?;
    Ok(())
}
