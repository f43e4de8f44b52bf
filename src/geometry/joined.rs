//! Convex polyhedra out of points and faces, triangles of one plane joined.

use std::collections::HashMap;

use super::{
    ConvexPolyhedron, Point,
    convex::{left_of_edges, mean},
    edges_of, used,
};

/// Triangles whose corners lie within this of one plane, as a fraction of the grain's radius, make
/// one face. Half of what a polyhedron allows its faces, and above the rounding of single precision
/// a few dozen grains away from the origin.
pub(crate) const FLATNESS: f64 = 5e-6;

/// A polyhedron of closed faces, triangles that lie in one plane joined;
/// `None` where it is not convex. Faces with more corners are left as they
/// are: whoever made them joined what belongs together.
pub(crate) fn joined_polyhedron(
    vertices: &[Point],
    faces: &[Vec<u32>],
) -> Option<ConvexPolyhedron> {
    if faces.iter().all(|face| face.len() == 3)
        && let Some(joined) = joined(vertices, faces)
        && let (vertices, joined) = used(&joined, vertices)
        && let Ok(shape) = ConvexPolyhedron::new(vertices, joined)
    {
        return Some(shape);
    }
    ConvexPolyhedron::new(vertices.to_vec(), faces.to_vec()).ok()
}

/// Joins triangles into plane faces, beginning with the largest; vertices amid
/// a face or an edge go. `None` where a face would have a hole.
fn joined(vertices: &[Point], triangles: &[Vec<u32>]) -> Option<Vec<Vec<u32>>> {
    let centre = mean(vertices);
    let radius = vertices.iter().map(|v| (v.coords - centre).norm()).fold(0.0, f64::max);
    let at = |v: u32| vertices[v as usize].coords;
    let area = |t: &[u32]| (at(t[1]) - at(t[0])).cross(&(at(t[2]) - at(t[0])));
    let owner = left_of_edges(triangles);
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|&a, &b| {
        area(&triangles[b]).norm().total_cmp(&area(&triangles[a]).norm()).then(a.cmp(&b))
    });
    let mut taken = vec![false; triangles.len()];
    let mut region_of = vec![usize::MAX; triangles.len()];
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for seed in order {
        if taken[seed] {
            continue;
        }
        taken[seed] = true;
        let normal = area(&triangles[seed]).try_normalize(0.0)?;
        let offset = normal.dot(&at(triangles[seed][0]));
        let mut next: HashMap<u32, u32> = HashMap::new();
        region_of[seed] = seed;
        let mut region = vec![seed];
        let mut visited = 0;
        while let Some(&triangle) = region.get(visited) {
            visited += 1;
            for (a, b) in edges_of(&triangles[triangle]) {
                let &beyond = owner.get(&(b, a))?;
                let in_plane = |v: &u32| (normal.dot(&at(*v)) - offset).abs() <= FLATNESS * radius;
                let belongs = !taken[beyond]
                    && triangles[beyond].iter().all(in_plane)
                    && area(&triangles[beyond]).dot(&normal) >= 0.0;
                if belongs {
                    taken[beyond] = true;
                    region_of[beyond] = seed;
                    region.push(beyond);
                } else if region_of[beyond] != seed && next.insert(a, b).is_some() {
                    return None;
                }
            }
        }
        faces.push(outline(&next)?);
    }
    Some(without_needless_vertices(faces))
}

/// The loop of a face's edges, beginning at its lowest vertex; `None` where they make several.
fn outline(next: &HashMap<u32, u32>) -> Option<Vec<u32>> {
    let start = *next.keys().min()?;
    let mut face = vec![start];
    let mut at = *next.get(&start)?;
    while at != start {
        if face.len() > next.len() {
            return None;
        }
        face.push(at);
        at = *next.get(&at)?;
    }
    (face.len() == next.len()).then_some(face)
}

/// A vertex where only two faces meet lies on their common edge.
fn without_needless_vertices(mut faces: Vec<Vec<u32>>) -> Vec<Vec<u32>> {
    let mut meeting: HashMap<u32, usize> = HashMap::new();
    for &corner in faces.iter().flatten() {
        *meeting.entry(corner).or_default() += 1;
    }
    for face in &mut faces {
        face.retain(|corner| meeting[corner] > 2);
    }
    faces
}
