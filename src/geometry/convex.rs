//! Convex polyhedra out of points and triangles, and what a plane leaves of them.

use std::collections::HashMap;

use super::{ConvexPolyhedron, Point, Vector};

/// Triangles whose corners lie within this of one plane, as a fraction of the
/// grain's radius, make one face. Half of what a polyhedron allows its faces,
/// and above the rounding of single precision a few dozen grains away from
/// the origin.
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
    let at = |v: u32| vertices[v as usize].coords - centre;
    faces
        .iter()
        .flat_map(|f| (1..f.len() - 1).map(move |i| [f[0], f[i], f[i + 1]]))
        .map(|[a, b, c]| at(a).dot(&at(b).cross(&at(c))) / 6.0)
        .sum()
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

/// The loop of a face's edges, beginning at its lowest vertex; `None` where
/// they make several.
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
