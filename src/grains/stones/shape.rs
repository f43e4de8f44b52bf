//! From a closed surface to a convex polyhedron.

use std::collections::HashMap;

use super::{
    hull::{Hull, hull},
    rounded,
    surface::{Surface, extent, fault, volume},
};
use crate::{
    geometry::{ConvexPolyhedron, Point, Vector},
    scenario::{Fault, MeshGrains},
};

/// Stones whose volume is at least this share of their hull's are taken as
/// their hulls without being asked: the roughness of a scan leaves them there.
pub(super) const NEARLY_CONVEX: f64 = 0.99;

/// Triangles whose corners lie within this of one plane, as a fraction of the
/// stone's radius, make one face. Half of what a polyhedron allows its faces,
/// and above the rounding of single precision a few dozen stones away from
/// the origin.
const FLATNESS: f64 = 5e-6;

/// A surface as a convex polyhedron.
#[derive(Debug, Clone)]
pub(super) struct Convex {
    /// The polyhedron, where the surface was.
    pub shape: ConvexPolyhedron,
    /// Volume of the surface over that of its convex hull; 1 where it was convex.
    pub convexity: f64,
    /// Whether the shape is the hull (or a simpler one), not the surface itself.
    pub hull: bool,
    /// How far in m the mesh sticks out of the shape, where vertices were left out.
    pub left_out: f64,
}

/// The convex polyhedron of a surface: the surface itself where it is convex
/// and has few enough vertices, else its hull where that is near enough or
/// asked for.
pub(super) fn convex(surface: &Surface, spec: &MeshGrains) -> Result<Convex, Fault> {
    let most = spec.largest_vertex_count as usize;
    if surface.vertices.len() <= 8 * most
        && let Some(shape) = polyhedron(&surface.vertices, &surface.faces)
        && shape.vertices().len() <= most
    {
        return Ok(Convex { shape, convexity: 1.0, hull: false, left_out: 0.0 });
    }
    let unmade = || {
        fault(
            "no convex hull can be made of its vertices".into(),
            format!("{} vertices", surface.vertices.len()),
            "a stone as thick as a hundredth of its length".into(),
        )
    };
    let whole = hull(&surface.vertices, usize::MAX).ok_or_else(unmade)?;
    let convexity = (surface.volume / volume(&whole.vertices, &whole.triangles)).min(1.0);
    if !(spec.hull || convexity >= NEARLY_CONVEX) {
        return Err(fault(
            format!(
                "the stone is not convex: its hull has {} % more volume",
                rounded(100.0 * (1.0 / convexity - 1.0))
            ),
            format!("a volume of {} % of the hull's", rounded(100.0 * convexity)),
            format!(
                "at least {} %; or `\"hull\": true`, which takes the hulls of all stones",
                100.0 * NEARLY_CONVEX
            ),
        ));
    }
    if whole.left_out > FLATNESS * extent(&surface.vertices) {
        return Err(unmade());
    }
    // Joining triangles may leave vertices amid a face, so count after it.
    if whole.vertices.len() <= 8 * most
        && let Some(shape) = polyhedron(&whole.vertices, &whole.triangles)
        && shape.vertices().len() <= most
    {
        return Ok(Convex { shape, convexity, hull: true, left_out: 0.0 });
    }
    let Hull { vertices, triangles, left_out } = hull(&whole.vertices, most).ok_or_else(unmade)?;
    let shape = polyhedron(&vertices, &triangles).ok_or_else(unmade)?;
    Ok(Convex { shape, convexity, hull: true, left_out })
}

/// A polyhedron of closed faces, triangles that lie in one plane joined;
/// `None` where it is not convex. Faces with more corners are left as they
/// are: whoever made them joined what belongs together.
fn polyhedron(vertices: &[Point], faces: &[Vec<u32>]) -> Option<ConvexPolyhedron> {
    if faces.iter().all(|face| face.len() == 3)
        && let Some(joined) = joined(vertices, faces)
        && let Ok(shape) = compact(vertices, joined)
    {
        return Some(shape);
    }
    ConvexPolyhedron::new(vertices.to_vec(), faces.to_vec()).ok()
}

fn compact(
    vertices: &[Point],
    mut faces: Vec<Vec<u32>>,
) -> Result<ConvexPolyhedron, crate::geometry::PolyhedronError> {
    let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    for corner in faces.iter_mut().flatten() {
        *corner = used.partition_point(|v| v < corner) as u32;
    }
    ConvexPolyhedron::new(used.iter().map(|&v| vertices[v as usize]).collect(), faces)
}

/// Joins triangles into plane faces, beginning with the largest; vertices amid
/// a face or an edge go. `None` where a face would have a hole.
fn joined(vertices: &[Point], triangles: &[Vec<u32>]) -> Option<Vec<Vec<u32>>> {
    let centre = vertices.iter().map(|v| v.coords).sum::<Vector>() / vertices.len().max(1) as f64;
    let radius = vertices.iter().map(|v| (v.coords - centre).norm()).fold(0.0, f64::max);
    let at = |v: u32| vertices[v as usize].coords;
    let area = |t: &[u32]| (at(t[1]) - at(t[0])).cross(&(at(t[2]) - at(t[0])));
    let mut owner: HashMap<(u32, u32), usize> = HashMap::new();
    for (index, t) in triangles.iter().enumerate() {
        for (i, &a) in t.iter().enumerate() {
            owner.insert((a, t[(i + 1) % 3]), index);
        }
    }
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
            let t = &triangles[triangle];
            for (i, &a) in t.iter().enumerate() {
                let b = t[(i + 1) % 3];
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
