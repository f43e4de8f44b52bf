//! Moments of volumes, and what a ball that sweeps a polyhedron adds to them.

use nalgebra::Matrix3;

use super::{
    Point, Rounded, Vector, edges_of,
    polyhedron::{faces_about, normals},
};

/// Moments of a body about a point: ∫dV, ∫x dV, ∫x xᵀ dV.
#[derive(Default)]
pub(super) struct Moments {
    pub(super) volume: f64,
    pub(super) first: Vector,
    pub(super) second: Matrix3<f64>,
}

impl Moments {
    pub(super) fn add(&mut self, volume: f64, first: Vector, second: Matrix3<f64>) {
        self.volume += volume;
        self.first += first;
        self.second += second;
    }
}

/// Adds what the ball of a rounded polyhedron adds to the core: a prism on each face, a sector of
/// a cylinder on each edge and a sector of a sphere on each corner.
pub(super) fn add_swept(rounded: &Rounded, about: &Point, all: &mut Moments) {
    add_prisms(rounded, about, all);
    add_cylinders(rounded, about, all);
    add_corners(rounded, about, all);
}

fn both(a: &Vector, b: &Vector) -> Matrix3<f64> {
    a * b.transpose() + b * a.transpose()
}

fn add_prisms(rounded: &Rounded, about: &Point, all: &mut Moments) {
    let r = rounded.radius;
    let normals = normals(&rounded.core);
    for (corners, n) in rounded.core.faces().iter().zip(&normals) {
        for i in 1..corners.len() - 1 {
            let [a, b, c] = [corners[0], corners[i], corners[i + 1]]
                .map(|v| rounded.core.vertices()[v as usize] - about);
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

fn add_cylinders(rounded: &Rounded, about: &Point, all: &mut Moments) {
    let r = rounded.radius;
    for edge in rounded.edges() {
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
fn add_corners(rounded: &Rounded, about: &Point, all: &mut Moments) {
    let r = rounded.radius;
    let normals = normals(&rounded.core);
    for (v, faces) in faces_about(&rounded.core).iter().enumerate() {
        let p = rounded.core.vertices()[v] - about;
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
