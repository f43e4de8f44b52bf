//! `grains.csv`: each grain, what it is and where it lies.

use super::*;
use crate::grains::{Block, grain_name};
use crate::specimen::Specimen;
use crate::units::{to_g, to_mm3, to_typed_mm};

/// Columns of [`grains_csv`], in the order of its cells.
const COLUMNS: &str = "grain,passing_mm,retained_mm,volume_mm3,mass_g,equivalent_diameter_mm,\
                       vertices,faces,fate,x_mm,y_mm,z_mm,\
                       rotation_x,rotation_y,rotation_z,rotation_w,\
                       speed_mm_per_s,turned_deg,sieve_size_mm,sieve_size_at_end_mm,\
                       longest_mm,intermediate_mm,shortest_mm,\
                       elongation,flatness,sphericity,roundness";

/// One row a grain: what it is, where it is (centroid, m to mm, orientation of its principal axes
/// as a unit quaternion) and how fast; the smallest square opening it passes, as generated and with
/// the shape that the engine held at the end; and its shape. `fates`, by which the summary counts,
/// `sieved`, `shapes`, `sieved_at_end_mm` and `turned`, the angles in rad by which grains turned in
/// the last stage, are in the order of the grains; what is not known of a grain is empty.
///
/// # Errors
/// As [`csv_of`].
pub fn grains_csv(
    specimen: &Specimen,
    fates: &[Fate],
    sieved: &[Sieved],
    shapes: &[GrainShape],
    sieved_at_end_mm: &[Option<f64>],
    turned: &[Option<f64>],
) -> Result<Vec<u8>, csv::Error> {
    let set = &specimen.grains;
    let known = sieved.iter().zip(shapes);
    let typed = |block: &Block| [to_typed_mm(block.passing), to_typed_mm(block.retained)];
    let sieves: Vec<_> = set.blocks.iter().map(typed).collect();
    let rows = set.grains.iter().zip(&specimen.state.bodies).zip(known).enumerate();
    let rows = rows.map(|(index, ((grain, state), (sieved, shape)))| {
        let at = state.body.pose.translation.vector;
        let q = state.body.pose.rotation.coords;
        (
            grain_name(index),
            sieves[grain.fraction],
            [to_mm3(grain.volume), to_g(grain.mass), to_mm(grain.equivalent_diameter)],
            [shape.vertices, shape.faces],
            fates.get(index).copied().unwrap_or(state.fate),
            [to_mm(at.x), to_mm(at.y), to_mm(at.z)],
            [q.x, q.y, q.z, q.w],
            to_mm(state.body.linear_velocity.norm()),
            turned.get(index).copied().flatten().map(f64::to_degrees),
            to_mm(sieved.size),
            sieved_at_end_mm.get(index).copied().flatten(),
            [to_mm(shape.longest), to_mm(shape.intermediate), to_mm(shape.shortest)],
            [ShapeRatio::Elongation, ShapeRatio::Flatness, ShapeRatio::Sphericity]
                .map(|ratio| shape.ratio(ratio)),
            shape.roundness,
        )
    });
    csv_of(COLUMNS, rows)
}
