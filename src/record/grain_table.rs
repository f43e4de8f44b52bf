//! `grains.csv`: each grain, what it is and where it lies.

use super::*;
use crate::grains::grain_name;
use crate::measure::Place;
use crate::specimen::Specimen;
use crate::units::{to_g, to_mm3};

/// One row of `grains.csv`.
#[derive(Debug, Serialize)]
struct GrainRow {
    grain: String,
    passing_mm: f64,
    retained_mm: f64,
    volume_mm3: f64,
    mass_g: f64,
    equivalent_diameter_mm: f64,
    vertices: usize,
    faces: usize,
    fate: Fate,
    x_mm: f64,
    y_mm: f64,
    z_mm: f64,
    rotation_x: f64,
    rotation_y: f64,
    rotation_z: f64,
    rotation_w: f64,
    speed_mm_per_s: f64,
    turned_deg: Option<f64>,
    sieve_size_mm: f64,
    sieve_size_at_end_mm: Option<f64>,
    longest_mm: f64,
    intermediate_mm: f64,
    shortest_mm: f64,
    elongation: f64,
    flatness: f64,
    sphericity: f64,
    roundness: f64,
}

/// One row a grain: what it is, where it is (centroid, m to mm, orientation of its principal axes
/// as a unit quaternion) and how fast; the smallest square opening it passes, as generated and with
/// the shape that the engine held at the end; and its shape. `places`, by which the summary counts
/// and which give the fate, `sieved`, `shapes`, `sieved_at_end_mm` and `turned`, the angles in rad
/// by which grains turned in the last stage, are in the order of the grains; what is not known of a
/// grain is empty.
///
/// # Errors
/// As [`to_csv`].
pub fn grains_csv(
    specimen: &Specimen,
    places: &[Place],
    sieved: &[Sieved],
    shapes: &[GrainShape],
    sieved_at_end_mm: &[Option<f64>],
    turned: &[Option<f64>],
) -> Result<Vec<u8>, csv::Error> {
    let set = &specimen.grains;
    let known = sieved.iter().zip(shapes);
    to_csv(set.grains.iter().zip(&specimen.state.bodies).zip(known).enumerate().map(
        |(index, ((grain, state), (sieved, shape)))| {
            let block = &set.blocks[grain.fraction];
            let at = state.body.pose.translation.vector;
            let q = state.body.pose.rotation.coords;
            GrainRow {
                grain: grain_name(index),
                passing_mm: to_mm(block.passing),
                retained_mm: to_mm(block.retained),
                volume_mm3: to_mm3(grain.volume),
                mass_g: to_g(grain.mass),
                equivalent_diameter_mm: to_mm(grain.equivalent_diameter),
                vertices: shape.vertices,
                faces: shape.faces,
                fate: places.get(index).map_or(state.fate, |place| place.fate(state.fate)),
                x_mm: to_mm(at.x),
                y_mm: to_mm(at.y),
                z_mm: to_mm(at.z),
                rotation_x: q.x,
                rotation_y: q.y,
                rotation_z: q.z,
                rotation_w: q.w,
                speed_mm_per_s: to_mm(state.body.linear_velocity.norm()),
                turned_deg: turned.get(index).copied().flatten().map(f64::to_degrees),
                sieve_size_mm: to_mm(sieved.size),
                sieve_size_at_end_mm: sieved_at_end_mm.get(index).copied().flatten(),
                longest_mm: to_mm(shape.longest),
                intermediate_mm: to_mm(shape.intermediate),
                shortest_mm: to_mm(shape.shortest),
                elongation: shape.ratio(ShapeRatio::Elongation),
                flatness: shape.ratio(ShapeRatio::Flatness),
                sphericity: shape.ratio(ShapeRatio::Sphericity),
                roundness: shape.roundness,
            }
        },
    ))
}
