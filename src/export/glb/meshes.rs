//! Shapes as glTF meshes: flat faces, each with vertices of its own, so that edges stay sharp.

use std::collections::HashMap;

use super::*;
use crate::export::parts::corners;
use crate::geometry::{ConvexPolyhedron, Point, Vector};

/// The meshes of a file.
#[derive(Debug, Default)]
pub struct Meshes {
    /// `meshes`.
    pub list: Vec<Value>,
    known: HashMap<Shape, usize>,
}

/// What makes two grains' meshes the same: corners bit by bit, faces, material.
type Shape = (Vec<[u64; 3]>, Vec<Vec<u32>>, usize);

impl Meshes {
    /// The mesh of a grain's shape, in its own frame; one of all grains of that shape and material.
    pub fn of_shape(
        &mut self,
        shape: &ConvexPolyhedron,
        material: usize,
        buffers: &mut Buffers,
    ) -> usize {
        let bits = |v: &Point| [v.x, v.y, v.z].map(f64::to_bits);
        let vertices = shape.vertices().iter().map(bits).collect();
        let key: Shape = (vertices, shape.faces().to_vec(), material);
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        let identity = Pose::identity();
        let faces: Vec<Vec<Point>> =
            shape.faces().iter().map(|f| corners(shape, f, &identity).collect()).collect();
        let name = format!("shape_{:05}", self.list.len());
        let mesh = self.of_faces(&name, &faces, material, buffers);
        self.known.insert(key, mesh);
        mesh
    }

    /// A mesh of flat faces.
    pub fn of_faces(
        &mut self,
        name: &str,
        faces: &[Vec<Point>],
        material: usize,
        buffers: &mut Buffers,
    ) -> usize {
        let single = |v: &Vector| [v.x as f32, v.y as f32, v.z as f32];
        let (mut positions, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for face in faces {
            // A face without area shows nothing and has no normal.
            let Some(normal) = normal(face) else { continue };
            let first = positions.len() as u32;
            positions.extend(face.iter().map(|p| single(&p.coords)));
            normals.extend(face.iter().map(|_| single(&normal)));
            for n in 2..face.len() as u32 {
                triangles.extend([first, first + n - 1, first + n]);
            }
        }
        let position = buffers.floats(Use::Positions, &positions);
        let normal = buffers.floats(Use::Normals, &normals);
        let indices = buffers.indices(&triangles);
        self.list.push(json!({
            "name": name,
            "primitives": [{
                "attributes": { "POSITION": position, "NORMAL": normal },
                "indices": indices,
                "material": material,
            }],
        }));
        self.list.len() - 1
    }
}

/// Unit normal of a flat polygon (Newell's sum), outwards where its corners run counter-clockwise.
fn normal(face: &[Point]) -> Option<Vector> {
    let next = face.iter().cycle().skip(1);
    let sum: Vector = face.iter().zip(next).map(|(a, b)| a.coords.cross(&b.coords)).sum();
    sum.try_normalize(f64::MIN_POSITIVE)
}
