//! Rounded polyhedra: a convex core swept by a ball, with exact volume, surface and moments.

use std::collections::HashMap;

use nalgebra::{Matrix3, Matrix4, Vector4};

use super::{
    ConvexPolyhedron, MassProperties, Point, Vector,
    convex::{cut, left_of_edges, mean},
    edges_of, hull, joined_polyhedron,
    mass::Moments,
};

/// Corners of an eroded polyhedron that are nearer to each other than this, as a fraction of its
/// size, are one.
const SAME_CORNER: f64 = 1e-6;

/// A convex polyhedron, the core, swept by a ball: all points that are at most a radius away from
/// the core.
///
/// Its flat faces are those of the core moved outwards by the radius; along the edges lie parts of
/// cylinders, about the corners parts of spheres.
#[derive(Debug, Clone, PartialEq)]
pub struct Rounded {
    /// What the ball's centre goes through.
    pub core: ConvexPolyhedron,
    /// Radius of the ball in m.
    pub radius: f64,
}

fn both(a: &Vector, b: &Vector) -> Matrix3<f64> {
    a * b.transpose() + b * a.transpose()
}

/// Angle in rad between two directions.
pub(super) fn angle(a: &Vector, b: &Vector) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// An edge of the core: its ends and the outward normals of its faces, such that from `left` to
/// `right` is a right-handed turn about the way from `to` to `from`.
struct CoreEdge {
    from: Vector,
    to: Vector,
    left: Vector,
    right: Vector,
}

impl CoreEdge {
    /// Angle between the normals, in rad.
    fn angle(&self) -> f64 {
        angle(&self.left, &self.right)
    }

    fn length(&self) -> f64 {
        (self.to - self.from).norm()
    }
}

/// The outward unit normals of all faces.
pub(super) fn normals(core: &ConvexPolyhedron) -> Vec<Vector> {
    (0..core.faces().len())
        .map(|face| core.plane(face).map_or_else(Vector::zeros, |(normal, _)| normal))
        .collect()
}

/// The faces about each vertex, counter-clockwise seen from outside.
pub(super) fn faces_about(core: &ConvexPolyhedron) -> Vec<Vec<usize>> {
    let left = left_of_edges(core.faces());
    // Where a face came from.
    let mut before: HashMap<(u32, usize), u32> = HashMap::new();
    let mut first: Vec<Option<usize>> = vec![None; core.vertices().len()];
    for (face, corners) in core.faces().iter().enumerate() {
        for (a, b) in edges_of(corners) {
            before.insert((b, face), a);
            first[b as usize].get_or_insert(face);
        }
    }
    first
        .iter()
        .enumerate()
        .map(|(v, &first)| {
            let mut around = Vec::new();
            let mut next = first;
            while let Some(face) = next {
                around.push(face);
                let back = before.get(&(v as u32, face));
                next = back
                    .and_then(|&back| left.get(&(v as u32, back)).copied())
                    .filter(|face| Some(*face) != first && around.len() <= core.faces().len());
            }
            around
        })
        .collect()
}

impl Rounded {
    /// Volume in m³ by Steiner's formula: V + S r + M r² + 4/3 π r³, with the integral of mean
    /// curvature M = ½ Σ edge length times turn of the normal.
    pub fn volume(&self) -> f64 {
        let r = self.radius;
        let bends: f64 = self.edges().iter().map(|e| e.length() * e.angle()).sum();
        self.core.signed_volume()
            + self.core.surface() * r
            + bends / 2.0 * r * r
            + 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)
    }

    /// Surface in m²: S + 2 M r + 4 π r².
    pub fn surface(&self) -> f64 {
        let r = self.radius;
        let bends: f64 = self.edges().iter().map(|e| e.length() * e.angle()).sum();
        self.core.surface() + bends * r + 4.0 * std::f64::consts::PI * r * r
    }

    /// Radius of the corners over that of the largest sphere inside: roundness after Wadell (1932),
    /// exact, as every corner has the same curvature.
    pub fn roundness(&self) -> f64 {
        self.radius / (self.radius + inner_radius(&self.core))
    }

    fn edges(&self) -> Vec<CoreEdge> {
        let core = &self.core;
        let normals = normals(core);
        let left = left_of_edges(core.faces());
        let at = |v: u32| core.vertices()[v as usize].coords;
        let edges = core.edges().into_iter().filter_map(|(a, b)| {
            let (l, r) = (left.get(&(a, b))?, left.get(&(b, a))?);
            Some(CoreEdge { from: at(a), to: at(b), left: normals[*l], right: normals[*r] })
        });
        edges.collect()
    }

    /// Exact mass properties: those of the core, of a prism on each face, of a sector of a
    /// cylinder on each edge and of a sector of a sphere on each corner.
    pub(super) fn mass_properties(&self) -> MassProperties {
        let core = MassProperties::of(&self.core);
        let about = core.centroid;
        let mut all = Moments::default();
        let covariance = Matrix3::identity() * (core.inertia_per_density.trace() / 2.0)
            - core.inertia_per_density;
        all.add(core.volume, Vector::zeros(), covariance);
        self.add_prisms(&about, &mut all);
        self.add_cylinders(&about, &mut all);
        self.add_corners(&about, &mut all);
        all.about(about)
    }

    fn add_prisms(&self, about: &Point, all: &mut Moments) {
        let r = self.radius;
        let normals = normals(&self.core);
        for (corners, n) in self.core.faces().iter().zip(&normals) {
            for i in 1..corners.len() - 1 {
                let [a, b, c] = [corners[0], corners[i], corners[i + 1]]
                    .map(|v| self.core.vertices()[v as usize] - about);
                let area = (b - a).cross(&(c - a)).dot(n) / 2.0;
                let s = a + b + c;
                let mean = s / 3.0;
                let square =
                    (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose())
                        / 12.0;
                all.add(
                    area * r,
                    (mean * r + n * (r * r / 2.0)) * area,
                    (square * r
                        + both(&mean, n) * (r * r / 2.0)
                        + n * n.transpose() * (r.powi(3) / 3.0))
                        * area,
                );
            }
        }
    }

    fn add_cylinders(&self, about: &Point, all: &mut Moments) {
        let r = self.radius;
        for edge in self.edges() {
            let (angle, length) = (edge.angle(), edge.length());
            let Some(along) = (edge.to - edge.from).try_normalize(0.0) else { continue };
            let Some(middle) = (edge.left + edge.right).try_normalize(0.0) else { continue };
            let across = along.cross(&middle);
            let p = (edge.from + edge.to) / 2.0 - about.coords;
            let area = angle * r * r / 2.0;
            let first = middle * (r.powi(3) / 3.0 * 2.0 * (angle / 2.0).sin());
            let second = (middle * middle.transpose() * ((angle + angle.sin()) / 2.0)
                + across * across.transpose() * ((angle - angle.sin()) / 2.0))
                * (r.powi(4) / 4.0);
            all.add(
                area * length,
                (p * area + first) * length,
                (p * p.transpose() * area + both(&p, &first) + second) * length
                    + along * along.transpose() * (area * length.powi(3) / 12.0),
            );
        }
    }

    /// Directions from a corner fill a spherical polygon between the normals of its faces, Ω in
    /// solid angle, by van Oosterom and Strackee (1983).
    ///
    /// Over it ∫n dΩ = ½ Σ θ w, for its arcs of length θ with the unit vectors w that they turn
    /// about, as the surface of a solid sector closes. And ∫(n nᵀ − I/3) dΩ = −⅙ ∮(ν nᵀ + n νᵀ) dl
    /// with the outward conormal ν = −w: spherical harmonics of degree 2 are eigenfunctions of the
    /// Laplacian with the value −6. On an arc from a to b ∫n dl = (a + b) tan(θ/2).
    fn add_corners(&self, about: &Point, all: &mut Moments) {
        let r = self.radius;
        let normals = normals(&self.core);
        for (v, faces) in faces_about(&self.core).iter().enumerate() {
            let p = self.core.vertices()[v] - about;
            let mut solid = 0.0;
            let mut mean = Vector::zeros();
            let mut square = Matrix3::zeros();
            for (a, b) in edges_of(faces) {
                let [a, b] = [a, b].map(|face| normals[face]);
                let turn = a.cross(&b);
                let angle = turn.norm().atan2(a.dot(&b));
                mean += turn.try_normalize(0.0).unwrap_or_else(Vector::zeros) * (angle / 2.0);
                square += both(&turn, &((a + b) / (1.0 + a.dot(&b)))) / 6.0;
                let c = normals[faces[0]];
                let over = 1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a);
                solid += 2.0 * c.dot(&turn).atan2(over);
            }
            square += Matrix3::identity() * (solid / 3.0);
            let volume = solid * r.powi(3) / 3.0;
            let first = mean * (r.powi(4) / 4.0);
            all.add(
                volume,
                p * volume + first,
                p * p.transpose() * volume + both(&p, &first) + square * (r.powi(5) / 5.0),
            );
        }
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
    let hull = hull(&corners, usize::MAX)?;
    joined_polyhedron(&hull.vertices, &hull.triangles)
}

/// A polyhedron whose corners and edges have a radius of `roundness` times that of its largest
/// inner sphere, within the polyhedron and on all of its faces that are left. `None` where what is
/// left for the ball's centre is no polyhedron.
pub fn rounded_within(body: &ConvexPolyhedron, roundness: f64) -> Option<Rounded> {
    let radius = roundness * inner_radius(body);
    Some(Rounded { core: eroded(body, radius)?, radius })
}

#[cfg(test)]
#[path = "rounded_tests.rs"]
mod tests;
