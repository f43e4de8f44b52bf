//! Rounds a polyhedron within itself: its largest inner sphere, and what it leaves for a ball's
//! centre.

use nalgebra::{Matrix4, Vector4};

use super::{
    ConvexPolyhedron, Point, Rounded, Vector,
    convex::{cut, mean},
    convex_hull,
};

/// Corners of an eroded polyhedron that are nearer to each other than this, as a fraction of its
/// size, are one.
const SAME_CORNER: f64 = 1e-6;

impl Rounded {
    /// Radius of the corners over that of the largest sphere inside: roundness after Wadell (1932),
    /// exact, as every corner has the same curvature.
    pub fn roundness(&self) -> f64 {
        self.radius / (self.radius + inner_radius(&self.core))
    }
}

/// Radius in m of the largest sphere inside a body: a sphere's own, of a rounded polyhedron the
/// core's and the ball's together.
pub fn inner_radius(body: &ConvexPolyhedron) -> f64 {
    if let Some(sphere) = body.sphere() {
        return sphere.radius;
    }
    if let Some(rounded) = body.rounded() {
        return rounded.radius + inner_radius(&rounded.core);
    }
    // Largest R with n·x + R ≤ d for every face: a linear programme with four unknowns, whose
    // optimum lies on four planes. The dual simplex method: from a tetrahedron around all,
    // the plane that is violated most takes the place of one of the four.
    let centre = mean(body.vertices());
    let size = body.vertices().iter().map(|v| (v.coords - centre).norm()).fold(0.0, f64::max);
    let mut planes: Vec<(Vector, f64)> =
        [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]]
            .map(|n| (Vector::from(n).normalize(), 2.0))
            .to_vec();
    planes.extend(
        (0..body.faces().len())
            .filter_map(|f| body.plane(f))
            .map(|(n, d)| (n, (d - n.dot(&centre)) / size)),
    );
    let touching = |four: [usize; 4]| -> Option<Vector4<f64>> {
        let rows = Matrix4::from_fn(|i, j| if j < 3 { planes[four[i]].0[j] } else { 1.0 });
        rows.lu().solve(&Vector4::from_fn(|i, _| planes[four[i]].1))
    };
    let beyond = |x: &Vector4<f64>, f: usize| planes[f].0.dot(&x.xyz()) + x.w - planes[f].1;
    let mut four = [0, 1, 2, 3];
    let mut best = touching(four).map_or(0.0, |x| x.w);
    for _ in 0..4 * planes.len() {
        let Some(x) = touching(four) else { break };
        best = x.w;
        let worst = (0..planes.len()).max_by(|&f, &g| beyond(&x, f).total_cmp(&beyond(&x, g)));
        let Some(worst) = worst.filter(|&f| beyond(&x, f) > 1e-13) else { break };
        let exchanges = (0..4).filter_map(|out| {
            let mut next = four;
            let gone = std::mem::replace(&mut next[out], worst);
            let x = touching(next)?;
            (x.iter().all(|c| c.is_finite()) && beyond(&x, gone) <= 1e-12).then_some((x.w, next))
        });
        let Some((_, next)) = exchanges.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        four = next;
    }
    best * size
}

/// What a polyhedron leaves for the centre of a ball of radius `by` (m) that stays inside: its
/// planes moved inwards. `None` where that is no polyhedron.
pub fn eroded(body: &ConvexPolyhedron, by: f64) -> Option<ConvexPolyhedron> {
    let at = |v: u32| body.vertices()[v as usize].coords;
    let mut faces: Vec<Vec<Vector>> =
        body.faces().iter().map(|f| f.iter().map(|&v| at(v)).collect()).collect();
    for (normal, offset) in (0..body.faces().len()).filter_map(|f| body.plane(f)) {
        faces = cut(faces, |p| normal.dot(p) - (offset - by), |_| {});
    }
    let points = faces.into_iter().flatten();
    let size = body.vertices().iter().map(|v| (v - body.vertices()[0]).norm()).fold(0.0, f64::max);
    let mut corners: Vec<Point> = Vec::new();
    for point in points {
        if corners.iter().all(|c| (c.coords - point).norm() > SAME_CORNER * size) {
            corners.push(point.into());
        }
    }
    convex_hull(&corners)
}

/// A polyhedron whose corners and edges have a radius of `roundness` times that of its largest
/// inner sphere, within the polyhedron and on all of its faces that are left. `None` where what is
/// left for the ball's centre is no polyhedron.
pub fn rounded_within(body: &ConvexPolyhedron, roundness: f64) -> Option<Rounded> {
    let radius = roundness * inner_radius(body);
    Some(Rounded { core: eroded(body, radius)?, radius })
}
