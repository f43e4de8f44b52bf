//! Face loops of convex polyhedra, and what a plane leaves of them.

use std::collections::HashMap;

use super::{Point, Vector};

/// The vertices that faces use, in the order of their numbers, and the faces by their new numbers.
pub(crate) fn used<V: Copy>(
    faces: &[impl AsRef<[u32]>],
    vertices: &[V],
) -> (Vec<V>, Vec<Vec<u32>>) {
    let mut used: Vec<u32> = faces.iter().flat_map(AsRef::as_ref).copied().collect();
    used.sort_unstable();
    used.dedup();
    let number = |v: &u32| used.partition_point(|u| u < v) as u32;
    let faces = faces.iter().map(|face| face.as_ref().iter().map(number).collect()).collect();
    (used.iter().map(|&v| vertices[v as usize]).collect(), faces)
}

/// The face loop of some corners, where a corner that follows itself counts once; `None` of fewer
/// than three, which have no area.
pub(crate) fn loop_of(corners: impl Iterator<Item = u32>) -> Option<Vec<u32>> {
    let mut face: Vec<u32> = corners.collect();
    face.dedup();
    while face.len() > 1 && face.first() == face.last() {
        face.pop();
    }
    (face.len() >= 3).then_some(face)
}

/// Each corner of a loop with the one that follows it, the last with the first.
pub(crate) fn edges_of<T: Copy>(corners: &[T]) -> impl Iterator<Item = (T, T)> {
    (0..corners.len()).map(move |i| (corners[i], corners[(i + 1) % corners.len()]))
}

/// The number of the face to the left of each directed edge, seen from outside.
pub(super) fn left_of_edges(faces: &[Vec<u32>]) -> HashMap<(u32, u32), usize> {
    let mut left = HashMap::new();
    for (number, face) in faces.iter().enumerate() {
        left.extend(edges_of(face).map(|edge| (edge, number)));
    }
    left
}

/// Mean of points in m.
pub(super) fn mean(points: &[Point]) -> Vector {
    points.iter().map(|p| p.coords).sum::<Vector>() / points.len().max(1) as f64
}

/// Volume that face loops enclose, in the cube of the vertices' unit, by the divergence theorem
/// about the mean of the vertices; negative where faces are turned inwards.
pub(crate) fn enclosed_volume(vertices: &[Point], faces: &[Vec<u32>]) -> f64 {
    let centre = mean(vertices);
    volume_of_loops(faces, |v| vertices[v as usize].coords - centre)
}

/// The same of corners that are wherever `at` says; about its origin.
pub(crate) fn volume_of_loops<C: Copy>(faces: &[Vec<C>], at: impl Fn(C) -> Vector) -> f64 {
    faces
        .iter()
        .flat_map(|f| (1..f.len() - 1).map(move |i| [f[0], f[i], f[i + 1]]))
        .map(|[a, b, c]| at(a).dot(&at(b).cross(&at(c))) / 6.0)
        .sum()
}

/// What of a closed convex surface lies where a height over a plane is not above 0, closed again;
/// `onto` puts a point that is off the plane by a rounding onto it.
pub(crate) fn cut(
    faces: Vec<Vec<Vector>>,
    height: impl Fn(&Vector) -> f64,
    onto: impl Fn(&mut Vector),
) -> Vec<Vec<Vector>> {
    let mut kept = Vec::new();
    // Where faces leave and enter again: the rim of the cut, the other way round.
    let mut rim: Vec<(Vector, Vector)> = Vec::new();
    for face in faces {
        let mut inside = Vec::new();
        let (mut leaves, mut enters) = (None, None);
        for (p, q) in edges_of(&face) {
            let (a, b) = (height(&p), height(&q));
            if a <= 0.0 {
                inside.push(p);
            }
            if (a <= 0.0) != (b <= 0.0) {
                let mut at = p + (q - p) * (a / (a - b));
                onto(&mut at);
                inside.push(at);
                if a <= 0.0 { leaves = Some(at) } else { enters = Some(at) }
            }
        }
        rim.extend(enters.zip(leaves));
        if inside.len() >= 3 {
            kept.push(inside);
        }
    }
    if let Some(&(middle, _)) = rim.first() {
        // Triangles of a convex cap; where it has been cut before, inner edges cancel.
        kept.extend(rim.into_iter().map(|(enters, leaves)| vec![middle, enters, leaves]));
    }
    kept
}
