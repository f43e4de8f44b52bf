//! Grains and apparatus in their places as meshes, in metres, z up: Wavefront OBJ, one object a body
//! with polygonal faces; STL and PLY of the grains, for programs that print, slice or measure solids.

use std::io;

use super::*;
use crate::grains::{obj_of, write_ply_of, write_stl_of};
use crate::plain::counted;

/// The grains that take part, `grain_00000` and so on by their numbers.
pub fn grains_obj(specimen: &Specimen) -> String {
    let shapes = in_place(specimen);
    let title = format!("{}, lengths in metres, z up", counted(shapes.len(), "grain"));
    obj_of(&title, shapes.iter().map(|(n, shape)| (grain_name(*n), shape)))
}

/// The apparatus around them: the pieces of cylinder, funnel and lid that stand, and the top plate.
///
/// # Errors
/// When the apparatus cannot be built.
pub fn apparatus_obj(setup: &Setup, specimen: &Specimen) -> Result<String, ApparatusError> {
    let standing = standing(setup, &specimen.grains, &specimen.state)?.into_iter();
    let walls = standing.map(|s| (s.name, s.piece.shape.transformed(&s.piece.pose)));
    let plate = specimen.state.top_plate.iter();
    let plate = plate.map(|p| ("top_plate".to_owned(), setup.plate.shape.transformed(&p.pose)));
    let shapes: Vec<(String, ConvexPolyhedron)> = walls.chain(plate).collect();
    let title = "apparatus, lengths in metres, z up";
    Ok(obj_of(title, shapes.iter().map(|(name, shape)| (name, shape))))
}

/// The grains that take part, where they are, with their numbers.
fn in_place(specimen: &Specimen) -> Vec<(usize, ConvexPolyhedron)> {
    let state = &specimen.state;
    let shape = |n: usize| &specimen.grains.grains[n].shape;
    specimen.present().map(|n| (n, shape(n).transformed(&state.bodies[n].body.pose))).collect()
}

/// A binary STL file of their triangles (single precision).
///
/// # Errors
/// When there are more triangles than STL can hold.
pub fn grains_stl(specimen: &Specimen) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_stl_of(in_place(specimen).iter().map(|(_, shape)| shape), &mut bytes)?;
    Ok(bytes)
}

/// A PLY file (text): polygonal faces, each with the number of its grain.
///
/// # Errors
/// None in memory.
pub fn grains_ply(specimen: &Specimen) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_ply_of(in_place(specimen).iter().map(|(n, shape)| (*n, shape)), &mut bytes)?;
    Ok(bytes)
}
