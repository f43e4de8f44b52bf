//! Grains as triangle and polygon meshes, each at its place in its block, in m.

use std::io::{self, Write};

use super::GrainSet;

/// Wavefront OBJ: one object a grain, polygon faces.
///
/// # Errors
/// The writer's.
pub fn write_obj(set: &GrainSet, mut out: impl Write) -> io::Result<()> {
    let mut first = 1;
    for (index, grain) in set.grains.iter().enumerate() {
        writeln!(out, "o grain_{index}")?;
        for v in grain.cell.vertices() {
            writeln!(out, "v {} {} {}", v.x, v.y, v.z)?;
        }
        for face in grain.cell.faces() {
            write!(out, "f")?;
            for corner in face {
                write!(out, " {}", *corner as usize + first)?;
            }
            writeln!(out)?;
        }
        first += grain.cell.vertices().len();
    }
    Ok(())
}

/// Text STL: one solid a grain, faces cut into triangles.
///
/// # Errors
/// The writer's.
pub fn write_stl(set: &GrainSet, mut out: impl Write) -> io::Result<()> {
    for (index, grain) in set.grains.iter().enumerate() {
        writeln!(out, "solid grain_{index}")?;
        for [a, b, c] in grain.cell.triangles() {
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
            writeln!(out, "facet normal {} {} {}\nouter loop", normal.x, normal.y, normal.z)?;
            for v in [a, b, c] {
                writeln!(out, "vertex {} {} {}", v.x, v.y, v.z)?;
            }
            writeln!(out, "endloop\nendfacet")?;
        }
        writeln!(out, "endsolid grain_{index}")?;
    }
    Ok(())
}

/// Text PLY: all grains in one mesh, polygon faces with the number of their grain.
///
/// # Errors
/// The writer's.
pub fn write_ply(set: &GrainSet, mut out: impl Write) -> io::Result<()> {
    let vertices: usize = set.grains.iter().map(|g| g.cell.vertices().len()).sum();
    let faces: usize = set.grains.iter().map(|g| g.cell.faces().len()).sum();
    writeln!(
        out,
        "ply\nformat ascii 1.0\ncomment lengths in m\nelement vertex {vertices}\n\
         property double x\nproperty double y\nproperty double z\nelement face {faces}\n\
         property list uchar int vertex_indices\nproperty int grain\nend_header"
    )?;
    for v in set.grains.iter().flat_map(|g| g.cell.vertices()) {
        writeln!(out, "{} {} {}", v.x, v.y, v.z)?;
    }
    let mut first = 0;
    for (index, grain) in set.grains.iter().enumerate() {
        for face in grain.cell.faces() {
            write!(out, "{}", face.len())?;
            for corner in face {
                write!(out, " {}", *corner as usize + first)?;
            }
            writeln!(out, " {index}")?;
        }
        first += grain.cell.vertices().len();
    }
    Ok(())
}
