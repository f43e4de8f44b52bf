//! Voronoi cells of a cube as closed convex polyhedra.

use meshless_voronoi::{Dimensionality, VoronoiIntegrator};

use super::GrainsError;
use crate::geometry::{ConvexPolyhedron, Point, PolyhedronError, Vector};

/// Distances in m below which two corners of a cell are taken as one, tried
/// in this order until the cell passes every check. Voronoi cells have corners
/// as close as 1e-8 m, whose faces rounding can leave without area.
const MERGE: [f64; 6] = [0.0, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7];

/// Cuts the cube [0, side]³ into the Voronoi cells of points within it; cells
/// in the order of the points, in the same coordinates, in m.
///
/// # Errors
/// [`GrainsError::Points`] when a point is not inside the cube or stands
/// twice; [`GrainsError::Cell`] when a cell is no sound polyhedron.
pub fn cells(side: f64, points: &[Vector]) -> Result<Vec<ConvexPolyhedron>, GrainsError> {
    check(side, points)?;
    if points.len() == 1 {
        let cube = ConvexPolyhedron::frustum(square(side, 0.0), square(side, side));
        return Ok(vec![cube.map_err(|reason| GrainsError::Cell { cell: 0, reason })?]);
    }
    // In units of the cube: the tessellation's own tolerances are made for that.
    let generators: Vec<_> = points.iter().map(|p| (p / side).into_glam()).collect();
    let voronoi = VoronoiIntegrator::build(
        &generators,
        None,
        [0.0; 3].into(),
        [1.0; 3].into(),
        Dimensionality::ThreeD,
        false,
    )
    .with_faces();
    voronoi
        .cells_iter()
        .enumerate()
        .map(|(cell, c)| {
            let point = |v: &[f64; 3]| Point::from(Vector::from(*v) * side);
            let corners: Vec<Point> = c.vertices.iter().map(|v| point(&v.loc.to_array())).collect();
            let faces: Vec<&[usize]> = (0..c.face_count()).map(|f| c.face_vertices(f)).collect();
            polyhedron(&corners, &faces, &point(&c.loc.to_array()))
                .map_err(|reason| GrainsError::Cell { cell, reason })
        })
        .collect()
}

fn square(side: f64, z: f64) -> Vec<Point> {
    [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| Point::new(x, y, z)).to_vec()
}

fn check(side: f64, points: &[Vector]) -> Result<(), GrainsError> {
    let inside = |p: &Vector| p.iter().all(|&c| c > 0.0 && c < side);
    if let Some(index) = points.iter().position(|p| !inside(p)) {
        return Err(GrainsError::Points { index, reason: "it does not lie inside the cube" });
    }
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        points[a]
            .iter()
            .zip(points[b].iter())
            .fold(std::cmp::Ordering::Equal, |o, (x, y)| o.then(x.total_cmp(y)))
    });
    match order.windows(2).find(|w| points[w[0]] == points[w[1]]) {
        Some(w) => Err(GrainsError::Points { index: w[1], reason: "it stands twice" }),
        None => Ok(()),
    }
}

/// The polyhedron of a cell's corners and faces around an inner point.
fn polyhedron(
    corners: &[Point],
    faces: &[&[usize]],
    inner: &Point,
) -> Result<ConvexPolyhedron, PolyhedronError> {
    let mut last = None;
    for tolerance in MERGE {
        match merged(corners, faces, inner, tolerance) {
            Ok(polyhedron) => return Ok(polyhedron),
            Err(error) => last = Some(error),
        }
    }
    Err(last.unwrap_or(PolyhedronError::TooSmall { vertices: 0, faces: 0 }))
}

/// The polyhedron after corners closer than the tolerance have become one.
fn merged(
    corners: &[Point],
    faces: &[&[usize]],
    inner: &Point,
    tolerance: f64,
) -> Result<ConvexPolyhedron, PolyhedronError> {
    let mut kept: Vec<Point> = Vec::new();
    let mut name = vec![0_u32; corners.len()];
    for (i, corner) in corners.iter().enumerate() {
        let same = kept.iter().position(|k| tolerance > 0.0 && (k - corner).norm() <= tolerance);
        name[i] = same.unwrap_or_else(|| {
            kept.push(*corner);
            kept.len() - 1
        }) as u32;
    }
    let mut loops = Vec::with_capacity(faces.len());
    for face in faces {
        let mut corners: Vec<u32> = face.iter().map(|&c| name[c]).collect();
        corners.dedup();
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        if corners.len() >= 3 {
            if !outward(&kept, &corners, inner) {
                corners.reverse();
            }
            loops.push(corners);
        }
    }
    ConvexPolyhedron::new(kept, loops)
}

/// Whether a face's corners run counter-clockwise seen from outside.
fn outward(points: &[Point], face: &[u32], inner: &Point) -> bool {
    let origin = points[face[0] as usize];
    let mut normal = Vector::zeros();
    for i in 1..face.len() - 1 {
        normal +=
            (points[face[i] as usize] - origin).cross(&(points[face[i + 1] as usize] - origin));
    }
    normal.dot(&(origin - inner)) > 0.0
}

/// To the vector type of the tessellation's library.
trait IntoGlam {
    fn into_glam<T: From<[f64; 3]>>(self) -> T;
}

impl IntoGlam for Vector {
    fn into_glam<T: From<[f64; 3]>>(self) -> T {
        T::from([self.x, self.y, self.z])
    }
}
