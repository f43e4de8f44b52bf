//! Pieces from mesh files: what a scenario names as a file is put into it as convex parts, so that
//! the parts determine a stage, and a run folder holds what was there.

use super::*;

parts! {
/// A piece whose solid convex parts are those of a mesh.
pub struct MeshPieceSpec {
    /// Path of an OBJ, STL or PLY file, relative to the scenario file that names it. Each closed
    /// surface in it is a part, and has to be convex. Once loaded, the parts stand in `parts`.
    pub file: Option<String>, skip "Option::is_none", schemars(length(min = 1));
    /// Millimetres per unit of length of the file, as 1000 for metres; left out, 1.
    pub scale_to_mm: Option<f64>, skip "Option::is_none", above 0.0 to 1e6;
    /// The parts, in place of a file.
    pub parts: Option<Vec<MeshPart>>, skip "Option::is_none", length 1 to 1000;
}

/// A convex part of a piece.
pub struct MeshPart {
    /// Corners in mm.
    pub vertices_mm: Vec<[f64; 3]>, length 4 to 1000;
    /// Faces as loops of numbers of corners from 0, counter-clockwise seen from outside.
    pub faces: Vec<Vec<u32>>, length 4 to 2000;
}
}

/// Reads the convex parts of a mesh file, lengths multiplied by a number.
pub type PartsOf = fn(&Path, f64) -> Result<Vec<MeshPart>, Vec<Fault>>;

/// Most parts of a piece.
pub const MOST_PARTS: usize = 1000;

impl MeshPieceSpec {
    /// The parts, once they are loaded.
    pub fn parts(&self) -> &[MeshPart] {
        self.parts.as_deref().unwrap_or(&[])
    }

    /// Area in mm² of the shadow of a mesh of one part along a unit vector: half of what its
    /// faces have together (Cauchy); of several parts, the sum of theirs.
    pub(super) fn shows_mm2(&self, along: [f64; 3]) -> f64 {
        let along = Vector::from(along);
        self.parts().iter().map(|part| Self::shadow_mm2(part, &along)).sum()
    }

    fn shadow_mm2(part: &MeshPart, along: &Vector) -> f64 {
        let corner = |n: &u32| part.vertices_mm.get(*n as usize).copied().unwrap_or_default();
        let corner = |n: &u32| Vector::from(corner(n));
        let face = |face: &Vec<u32>| {
            let first = face.first().map(corner)?;
            let fan = face.windows(2).map(|edge| {
                (corner(&edge[0]) - first).cross(&(corner(&edge[1]) - first)).dot(along) / 2.0
            });
            Some(fan.sum::<f64>().abs())
        };
        part.faces.iter().filter_map(face).sum::<f64>() / 2.0
    }

    /// Lowest and highest coordinates of its corners in mm; none without any.
    pub(super) fn extent_mm(&self) -> Option<[[f64; 3]; 2]> {
        let corners = self.parts().iter().flat_map(|part| &part.vertices_mm);
        corners
            .map(|corner| Vector::from(*corner))
            .map(|corner| [corner, corner])
            .reduce(|[low, high], [corner, _]| [low.inf(&corner), high.sup(&corner)])
            .map(|ends| ends.map(Into::into))
    }

    /// Largest distance of a corner from the origin in mm.
    pub(super) fn reach_mm(&self) -> f64 {
        let corners = self.parts().iter().flat_map(|part| &part.vertices_mm);
        corners.map(|[x, y, z]| x.hypot(*y).hypot(*z)).fold(0.0, f64::max)
    }
}

/// Reads the mesh files that the pieces of a document name, each relative to the file that names
/// it, into parts beside which nothing is left of the name; the faults of those that cannot be
/// used.
pub(super) fn read(document: &mut Document, parts_of: PartsOf) -> Vec<Fault> {
    let mut faults = Vec::new();
    let count = document.value["pieces"].as_array().map_or(0, Vec::len);
    for i in 0..count {
        let path = format!("pieces[{i}].shape.mesh.file");
        let mesh = &document.value["pieces"][i]["shape"]["mesh"];
        let Some(name) = mesh["file"].as_str().filter(|name| !name.is_empty()) else { continue };
        let scale = mesh.get("scale_to_mm").map_or(Some(1.0), Value::as_f64);
        // Both together, and what is no scale, are refused by the checks.
        let scale = scale.filter(|scale| *scale > 0.0 && mesh.get("parts").is_none());
        let Some(scale) = scale else { continue };
        let file = document.folder(&path).join(name);
        match parts_of(&file, scale) {
            Ok(parts) => {
                if let Some(mesh) = document.value["pieces"][i]["shape"]["mesh"].as_object_mut() {
                    mesh.shift_remove("file");
                    mesh.shift_remove("scale_to_mm");
                    mesh.insert("parts".to_owned(), json!(parts));
                }
            }
            Err(found) => faults.extend(found.into_iter().map(|fault| {
                let of = match fault.path.is_empty() {
                    true => file.display().to_string(),
                    false => format!("{}, {}", file.display(), fault.path),
                };
                let message = format!("{of}: {}", fault.message);
                document.with_origin(Fault { message, ..fault }.at(&path))
            })),
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_of_one_part_shows_its_shadow_and_reaches_to_its_farthest_corner() {
        // A tetrahedron at three edges of a cube of 30 × 40 × 50 mm.
        let part = MeshPart {
            vertices_mm: vec![[0.0; 3], [30.0, 0.0, 0.0], [0.0, 40.0, 0.0], [0.0, 0.0, 50.0]],
            faces: vec![vec![0, 2, 1], vec![0, 1, 3], vec![0, 3, 2], vec![1, 2, 3]],
        };
        let mesh = MeshPieceSpec { file: None, scale_to_mm: None, parts: Some(vec![part.clone()]) };
        for (along, expected) in
            [([0.0, 0.0, 1.0], 600.0), ([0.0, -1.0, 0.0], 750.0), ([1.0, 0.0, 0.0], 1000.0)]
        {
            let got = mesh.shows_mm2(along);
            assert!(
                (got - expected).abs() < 1e-9,
                "law: {expected} mm² along {along:?}, got {got}"
            );
        }
        assert_eq!(mesh.reach_mm(), 50.0);
        let two = MeshPieceSpec { parts: Some(vec![part.clone(), part]), ..mesh };
        let got = two.shows_mm2([0.0, 0.0, 1.0]);
        assert!((got - 1200.0).abs() < 1e-9, "law: the sum of both parts, got {got} mm²");
    }
}
