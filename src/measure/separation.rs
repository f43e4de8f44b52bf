//! How far two convex polyhedra, rounded or not, or spheres are apart, or how deep they are in each other.
//!
//! For a unit vector n let s(n) be the gap between A and B seen along n: lowest point of B minus
//! highest point of A. Translating B by −s(n) along n brings the two to touch, so that the
//! penetration depth — the length of the smallest translation that separates them — is the minimum
//! of −s(n) over all n. −s is the support function of the Minkowski difference A − B about the
//! origin, and its minimum is met at a face of that polyhedron. Those faces are the faces of A, the
//! faces of B turned round, and the parallelograms spanned by an edge of A and an edge of B whose
//! arcs on the Gauss sphere cross (van den Bergen, "Collision Detection in Interactive 3D
//! Environments", 2004; Gregorius, "The Separating Axis Test between Convex Polyhedra", GDC 2013).

use super::*;

/// Sine of the angle within which an arc end counts as lying on the other arc's great circle.
///
/// Accepting too many edge pairs costs time, never correctness (each is verified with the true
/// supports); rejecting one that belongs would. Faces may be out of plane by 1e-5 of the body
/// (`geometry`), so that the normals of narrow faces are uncertain by several times that.
const ARC_TOLERANCE: f64 = 1e-4;

/// Sine of the angle between two edges below which they count as parallel.
/// The face of the Minkowski difference that parallel edges span is also
/// spanned by a face of A or B, so nothing is lost.
const PARALLEL: f64 = 1e-9;

/// The widest gap between two polyhedra among the axes of the separating axis test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Gap in m. Negative: the penetration depth, exact, with the sign
    /// reversed; a sphere's centre within a body comes out through the face of least
    /// penetration. Positive: of a sphere or a rounded polyhedron exact; of two polyhedra: the bodies are disjoint and at least this far
    /// apart; the true distance is larger when the nearest features are not a
    /// face or two edges (vertex to vertex, vertex to edge).
    pub gap: f64,
    /// Unit vector from A to B along which the gap is measured: moving B by
    /// `-gap` along it makes overlapping bodies touch.
    pub axis: Vector,
}

/// Gap or penetration of two polyhedra.
pub fn separation(a: &WorldHull, b: &WorldHull) -> Separation {
    search(a, b, f64::INFINITY)
}

/// As [`separation`], but `None` once an axis shows the two to be more than
/// `most` (m) apart, which saves most of the work for bodies that are.
pub fn separation_within(a: &WorldHull, b: &WorldHull, most: f64) -> Option<Separation> {
    let found = search(a, b, most);
    (found.gap <= most).then_some(found)
}

/// Searches all axes for the widest gap, ending early when it exceeds `enough`. Between rounded
/// bodies it is exact, as moving two cores towards each other or apart moves what their balls
/// sweep.
fn search(a: &WorldHull, b: &WorldHull, enough: f64) -> Separation {
    let radii = a.rounding + b.rounding;
    for (one, other, sign) in [(a, b, -1.0), (b, a, 1.0)] {
        if let Some(sphere) = one.sphere {
            let Separation { gap, axis } = from_body(other, &sphere.centre.coords);
            return Separation { gap: gap - sphere.radius - radii, axis: axis * sign };
        }
    }
    let found = along_axes(a, b, enough + radii);
    if radii == 0.0 || found.gap <= 0.0 || found.gap > enough + radii {
        return Separation { gap: found.gap - radii, ..found };
    }
    let Separation { gap, axis } = distance(a, b, &found);
    Separation { gap: gap - radii, axis }
}

/// Distance of two polyhedra that are apart, with the gap along an axis between them: of all
/// corners from the other body, and of all edges from each other, that can be as close as that.
fn distance(a: &WorldHull, b: &WorldHull, along: &Separation) -> Separation {
    let n = along.axis;
    let (top, bottom) = (highest_along(&a.vertices, &n), lowest_along(&b.vertices, &n));
    let mut best = Separation { gap: f64::INFINITY, axis: n };
    // What lies so far behind the foremost corner cannot be in the closest pair.
    for v in &b.vertices {
        if v.dot(&n) - top < best.gap {
            let found = from_body(a, v);
            if found.gap < best.gap {
                best = found;
            }
        }
    }
    for v in &a.vertices {
        if bottom - v.dot(&n) < best.gap {
            let Separation { gap, axis } = from_body(b, v);
            if gap < best.gap {
                best = Separation { gap, axis: -axis };
            }
        }
    }
    let reach = |e: &Edge| (e.point.dot(&n), (e.point + e.direction * e.length).dot(&n));
    for e in &a.edges {
        let (one, other) = reach(e);
        if bottom - one.max(other) >= best.gap {
            continue;
        }
        for f in &b.edges {
            let (low, high) = reach(f);
            if low.min(high) - one.max(other) >= best.gap {
                continue;
            }
            // Ends of edges are corners: what is left is where both are closest inside.
            let (cosine, out) = (e.direction.dot(&f.direction), f.point - e.point);
            let square = 1.0 - cosine * cosine;
            if square <= PARALLEL {
                continue;
            }
            let (p, q) = (out.dot(&e.direction), out.dot(&f.direction));
            let (s, t) = ((p - cosine * q) / square, (cosine * p - q) / square);
            if (0.0..=e.length).contains(&s) && (0.0..=f.length).contains(&t) {
                let apart = out + f.direction * t - e.direction * s;
                let gap = apart.norm();
                if gap < best.gap {
                    best = Separation { gap, axis: apart.try_normalize(0.0).unwrap_or(n) };
                }
            }
        }
    }
    best
}

/// Searches the axes of faces and pairs of edges.
fn along_axes(a: &WorldHull, b: &WorldHull, enough: f64) -> Separation {
    let mut best = Separation { gap: f64::NEG_INFINITY, axis: Vector::zeros() };
    for (body, other, sign) in [(a, b, 1.0), (b, a, -1.0)] {
        for (normal, top) in &body.faces {
            let gap = lowest_along(&other.vertices, normal) - top;
            if gap > best.gap {
                best = Separation { gap, axis: normal * sign };
            }
            if best.gap > enough {
                return best;
            }
        }
    }
    for e in &a.edges {
        for f in &b.edges {
            if !arcs_cross(e, f) {
                continue;
            }
            let Some(axis) = common_normal(e, f) else { continue };
            // The gap between two chosen points bounds that between the
            // bodies from above: most edge pairs end here.
            if axis.dot(&(f.point - e.point)) <= best.gap {
                continue;
            }
            let gap = lowest_along(&b.vertices, &axis) - highest_along(&a.vertices, &axis);
            if gap > best.gap {
                best = Separation { gap, axis };
            }
            if best.gap > enough {
                return best;
            }
        }
    }
    best
}

/// Distance of a point from the surface of a body, negative inside, with the direction out of it:
/// exact, unlike [`search`] also between bodies that are apart.
fn from_body(body: &WorldHull, point: &Vector) -> Separation {
    if let Some(sphere) = body.sphere {
        let out = point - sphere.centre.coords;
        let axis = out.try_normalize(0.0).unwrap_or_else(Vector::z);
        return Separation { gap: out.norm() - sphere.radius, axis };
    }
    let above = |(normal, top): &(Vector, f64)| normal.dot(point) - top;
    let mut best = Separation { gap: f64::NEG_INFINITY, axis: Vector::z() };
    for face in &body.faces {
        if above(face) > best.gap {
            best = Separation { gap: above(face), axis: face.0 };
        }
    }
    if best.gap <= 0.0 {
        return best;
    }
    // The foot on a plane is the closest point where it lies on the body.
    let slack = 1e-12 * (body.high - body.low).norm();
    let on_body = |foot: Vector| body.faces.iter().all(|(n, top)| n.dot(&foot) <= top + slack);
    for face in body.faces.iter().filter(|face| above(face) > 0.0) {
        if on_body(point - face.0 * above(face)) {
            return Separation { gap: above(face), axis: face.0 };
        }
    }
    let mut nearest = f64::INFINITY;
    for edge in &body.edges {
        let out = point - edge.point;
        let apart = out - edge.direction * out.dot(&edge.direction).clamp(0.0, edge.length);
        if apart.norm() < nearest {
            nearest = apart.norm();
            let axis = apart.try_normalize(0.0).unwrap_or(best.axis);
            best = Separation { gap: nearest, axis };
        }
    }
    best
}

/// Unit normal of both edges, pointing out of the body of `e`.
fn common_normal(e: &Edge, f: &Edge) -> Option<Vector> {
    let cross = e.direction.cross(&f.direction);
    let length = cross.norm();
    if length < PARALLEL {
        return None;
    }
    // The axis lies on the arc between the two face normals, which is shorter
    // than a half circle: its sum of cosines with them is positive.
    let outward = if cross.dot(&(e.left + e.right)) < 0.0 { -length } else { length };
    Some(cross / outward)
}

/// Whether an edge of A and an edge of B span a face of A − B: the arc between
/// A's face normals crosses the arc between B's reversed face normals
/// (Gregorius 2013). Doubtful cases count as crossing.
fn arcs_cross(e: &Edge, f: &Edge) -> bool {
    // Ends of B's arc must lie on both sides of the plane of A's arc ...
    let (fl, fr) = (f.left.dot(&e.direction), f.right.dot(&e.direction));
    if same_side(fl, fr) {
        return false;
    }
    // ... and the other way round ...
    let (el, er) = (e.left.dot(&f.direction), e.right.dot(&f.direction));
    if same_side(el, er) {
        return false;
    }
    // ... and both on the same hemisphere: B's normals are reversed, hence
    // the arcs cross when these are opposite.
    !same_side(fl, er) && !same_side(fr, el)
}

/// Whether both values are clearly positive or both clearly negative.
fn same_side(x: f64, y: f64) -> bool {
    (x > ARC_TOLERANCE && y > ARC_TOLERANCE) || (x < -ARC_TOLERANCE && y < -ARC_TOLERANCE)
}

#[cfg(test)]
mod rounded_tests;
#[cfg(test)]
mod sphere_tests;
#[cfg(test)]
mod tests;
