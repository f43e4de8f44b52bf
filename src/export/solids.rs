//! Grains in their places as one mesh, for programs that print, slice or
//! measure solids: STL and PLY, world coordinates in metres, z up.

use std::io;

use crate::geometry::ConvexPolyhedron;
use crate::grains::{write_ply_of, write_stl_of};
use crate::specimen::Specimen;

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
