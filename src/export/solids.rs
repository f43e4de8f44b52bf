//! Grains and apparatus in their places as meshes, in metres, z up: Wavefront OBJ, one object a body
//! with polygonal faces; STL and PLY of the grains, for programs that print, slice or measure solids.

use std::fmt::Write;
use std::io;

use super::*;
use crate::grains::{write_ply_of, write_stl_of};

/// A file in the making.
struct Objects {
    text: String,
    // OBJ numbers vertices from 1, through the whole file.
    first: usize,
}

impl Objects {
    fn new(title: &str) -> Self {
        Self { text: format!("# {title}, lengths in metres, z up\n"), first: 1 }
    }

    fn add(&mut self, name: &str, shape: &ConvexPolyhedron, pose: &Pose) {
        // Writing into a string cannot fail.
        let _ = writeln!(self.text, "o {name}");
        for vertex in shape.vertices() {
            let v = pose * vertex;
            let _ = writeln!(self.text, "v {} {} {}", v.x, v.y, v.z);
        }
        for face in shape.faces() {
            self.text.push('f');
            for corner in face {
                let _ = write!(self.text, " {}", self.first + *corner as usize);
            }
            self.text.push('\n');
        }
        self.first += shape.vertices().len();
    }
}

/// The grains that take part, `grain_00000` and so on by their numbers.
pub fn grains_obj(specimen: &Specimen) -> String {
    let mut objects = Objects::new(&format!("{} grains", specimen.present().count()));
    for n in specimen.present() {
        let pose = &specimen.state.bodies[n].body.pose;
        objects.add(&grain_name(n), &specimen.grains.grains[n].shape, pose);
    }
    objects.text
}

/// The apparatus around them: the pieces of cylinder, funnel and lid that stand, and the top plate.
///
/// # Errors
/// When the apparatus cannot be built.
pub fn apparatus_obj(setup: &Setup, specimen: &Specimen) -> Result<String, ApparatusError> {
    let mut objects = Objects::new("apparatus");
    for s in standing(setup, &specimen.grains, &specimen.state)? {
        objects.add(&s.name, &s.piece.shape, &s.piece.pose);
    }
    if let Some(plate) = &specimen.state.top_plate {
        objects.add("top_plate", &setup.plate.shape, &plate.pose);
    }
    Ok(objects.text)
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
