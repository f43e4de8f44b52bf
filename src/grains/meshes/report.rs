//! What became of each mesh, for the table `stones.csv` and for warnings.

use super::*;
use crate::grains::table_csv;
use crate::plain::decimals_at_least;
use crate::units::to_mm3;

/// One grain: its mesh as read, the shape made of it, and how it was used.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshRecord {
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

/// Scales that need no explanation: a grain stands for one ten times finer or
/// coarser; a factor of 1000 is more likely a wrong unit.
const USUAL_SCALES: (f64, f64) = (0.05, 20.0);

impl MeshRecord {
    /// Notes a grain of this shape: how many times as large it is.
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

    /// What a reader of results should know of grains: hulls in place of
    /// meshes, simplified hulls, and scales that point to a wrong unit.
    pub fn notes(records: &[Self]) -> Vec<String> {
        let mut notes = Vec::new();
        let largest = |of: fn(&Self) -> f64| {
            records
                .iter()
                .map(of)
                .fold(0.0, |most: f64, x| if x.abs() > most.abs() { x } else { most })
        };
        let hulls = records.iter().filter(|s| s.hull).count();
        if hulls > 0 {
            notes.push(format!(
                "replaced by convex hulls: {hulls} of {}, with at most {} % more volume",
                counted(records.len(), "mesh"),
                rounded(largest(Self::hull_adds_percent))
            ));
        }
        let simplified = records.iter().filter(|s| s.left_out > 0.0).count();
        if simplified > 0 {
            notes.push(format!(
                "simplified hulls: {simplified}; the mesh sticks out by at most {} mm, and the volume \
                 differs from the mesh's by at most {} %",
                rounded(to_mm(largest(|s| s.left_out))),
                rounded(largest(|s| match s.left_out > 0.0 {
                    true => s.volume_change_percent(),
                    false => 0.0,
                }))
            ));
        }
        let used = || records.iter().filter(|s| s.grains > 0);
        let least = used().map(|s| s.scales.0).fold(f64::INFINITY, f64::min);
        let most = used().map(|s| s.scales.1).fold(0.0, f64::max);
        if least < USUAL_SCALES.0 || most > USUAL_SCALES.1 {
            notes.push(format!(
                "grains were scaled by {} to {} to their sieves: is `mesh_unit` right?",
                rounded(least),
                rounded(most)
            ));
        }
        notes
    }
}

/// `stones.csv`: one row per grain.
///
/// # Errors
/// As [`table_csv`].
pub fn meshes_csv(records: &[MeshRecord]) -> Result<Vec<u8>, csv::Error> {
    let row = |record: &MeshRecord| {
        vec![
            ("file", record.file.clone()),
            ("object", record.object.clone()),
            ("mesh_vertices", record.mesh_vertices.to_string()),
            ("mesh_faces", record.mesh_faces.to_string()),
            ("mesh_volume_mm3", decimals_at_least(to_mm3(record.mesh_volume), 6)),
            ("convexity", format!("{:.6}", record.convexity)),
            ("hull", record.hull.to_string()),
            ("vertices", record.vertices.to_string()),
            ("faces", record.faces.to_string()),
            ("volume_mm3", decimals_at_least(to_mm3(record.volume), 6)),
            // No minus before what rounds to zero.
            (
                "volume_change_percent",
                format!("{:.4}", (record.volume_change_percent() * 1e4).round() / 1e4 + 0.0),
            ),
            ("left_out_mm", format!("{:.6}", to_mm(record.left_out))),
            ("sieve_size_mm", decimals_at_least(to_mm(record.sieve_size), 4)),
            ("grains", record.grains.to_string()),
            ("smallest_scale", format!("{:.6}", record.scales.0)),
            ("largest_scale", format!("{:.6}", record.scales.1)),
        ]
    };
    table_csv(records.iter().map(row))
}
