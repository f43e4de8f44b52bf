//! Shape of grains: elongation, flatness, sphericity.
//!
//! The three dimensions of a grain are the sides of the smallest box that
//! holds it, longest L, intermediate I, shortest S. From them follow the
//! ratios after Zingg (1935, "Beitrag zur Schotteranalyse"): elongation
//! L/I and flatness I/S as in `cells` of a scenario (Zingg's own are their inverses), 1 for
//! what is as long as it is wide, and as wide as it is thick. Sphericity is Wadell's (1932, "Volume, shape and roundness of rock
//! particles"): the surface of the sphere of the grain's volume over the
//! grain's own, 1 for a sphere, 0.806 for a cube, 0.671 for a regular tetrahedron. Of a rounded
//! polyhedron the box is that of its core, each side wider by the ball's diameter.

use rayon::prelude::*;

use super::*;

/// How much larger than the smallest box the box that is taken can be, as a
/// fraction of its volume, before it is narrowed down.
const BOX_TOLERANCE: f64 = 1e-3;

/// Boxes looked at before a body counts as too hard.
const MOST_LOOKS: usize = 100_000;

/// Steps of narrowing down, each to 0.618 of the range.
const NARROWINGS: usize = 40;

/// Shape of one grain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrainShape {
    /// Longest side L of the smallest box, in m.
    pub longest: f64,
    /// Intermediate side I, in m.
    pub intermediate: f64,
    /// Shortest side S, in m.
    pub shortest: f64,
    /// Surface in m².
    pub surface: f64,
    /// Volume in m³.
    pub volume: f64,
    /// Mean radius of curvature of the corners over the radius of the largest sphere inside
    /// (Wadell 1932): 0 for a polyhedron, 1 for a sphere, exact.
    pub roundness: f64,
    /// Number of flat faces; 0 for a sphere.
    pub faces: usize,
    /// Number of corners, rounded or not; 0 for a sphere.
    pub vertices: usize,
}

/// A number without unit that tells of shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ShapeRatio {
    /// L/I, at least 1 (after Zingg 1935).
    Elongation,
    /// I/S, at least 1 (after Zingg 1935).
    Flatness,
    /// Surface of the sphere of the same volume over the surface (Wadell 1932).
    Sphericity,
}

impl ShapeRatio {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Elongation, Self::Flatness, Self::Sphericity];
}

impl GrainShape {
    /// Measures a body.
    pub fn of(body: &ConvexPolyhedron) -> Self {
        let (sides, roundness, faces, vertices) = match body.sphere() {
            Some(sphere) => ([2.0 * sphere.radius; 3], 1.0, 0, 0),
            None => {
                let (core, ball) = body.core();
                let corners: Vec<Vector> = core.vertices().iter().map(|v| v.coords).collect();
                let sides = smallest_box(&corners).map(|side| side + 2.0 * ball);
                let roundness = body.rounded().map_or(0.0, Rounded::roundness);
                (sides, roundness, core.faces().len(), core.vertices().len())
            }
        };
        let [longest, intermediate, shortest] = sides;
        let (surface, volume) = (body.surface(), body.signed_volume());
        Self { longest, intermediate, shortest, surface, volume, roundness, faces, vertices }
    }

    /// Measures the grains of a set, in its order.
    pub fn of_all(set: &GrainSet) -> Vec<Self> {
        set.grains.par_iter().map(|g| Self::of(&g.shape)).collect()
    }

    /// One of the numbers without unit: elongation and flatness at least 1, sphericity above 0
    /// and at most 1.
    pub fn ratio(&self, ratio: ShapeRatio) -> f64 {
        match ratio {
            ShapeRatio::Elongation => self.longest / self.intermediate,
            ShapeRatio::Flatness => self.intermediate / self.shortest,
            ShapeRatio::Sphericity => {
                let surface = std::f64::consts::PI.cbrt() * (6.0 * self.volume).powf(2.0 / 3.0);
                // A sphere's is 1 but for rounding.
                (surface / self.surface).min(1.0)
            }
        }
    }
}

/// Sides in m of the box of the smallest volume that holds the hull of some
/// corners, the longest first.
///
/// Two faces of it that meet lie on edges of the hull (O'Rourke 1985, "Finding minimal enclosing
/// boxes"), so that the arcs of [`EdgeFan`] hold the normal of one of them, and the rest of the box
/// is the smallest rectangle about the shadow along it. Turned by δ about the edge, the widths of
/// the shadow change by at most δ times the width along the normal, which bounds what a range of
/// angles can hold; ranges are halved until no box in them can be smaller by more than
/// [`BOX_TOLERANCE`], then the best is narrowed down.
fn smallest_box(corners: &[Vector]) -> [f64; 3] {
    let fans = EdgeFan::all(corners);
    let mut search = Search { best: None, looks: 0, shadow: Shadow::default() };
    let mut open = Vec::new();
    for fan in &fans {
        for piece in &fan.pieces {
            let range = [piece.from, piece.to];
            let (area, _) = search.look(fan, piece, (piece.from + piece.to) / 2.0, range);
            let volume = area * piece.width((piece.from + piece.to) / 2.0);
            open.push((volume, fan, piece, range));
        }
    }
    // The most promising one is the last, which is the next.
    open.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut open: Vec<_> =
        open.into_iter().map(|(_, fan, piece, range)| (fan, piece, range)).collect();
    while let Some((fan, piece, [from, to])) = open.pop() {
        let (least, largest) = {
            let ends = [from, to].map(|angle| piece.width(angle));
            (ends[0].min(ends[1]), piece.largest([from, to], ends))
        };
        let middle = (from + to) / 2.0;
        let (area, sides) = search.look(fan, piece, middle, [from, to]);
        // The sides of any rectangle about the shadow are at most its
        // diameter, which the rectangle's diagonal is not below.
        let change = (to - from) / 2.0 * largest;
        let at_least = least * (area - change * 2.0_f64.sqrt() * sides[0].hypot(sides[1]));
        if at_least < search.volume() * (1.0 - BOX_TOLERANCE) && search.looks < MOST_LOOKS {
            open.extend([(fan, piece, [from, middle]), (fan, piece, [middle, to])]);
        }
    }
    search.narrow_down();
    let mut sides = search.best.map_or([f64::NAN; 3], |b| b.sides);
    sides.sort_by(|a, b| b.total_cmp(a));
    sides
}

/// A box on the fan of an edge.
#[derive(Clone, Copy)]
struct Candidate<'a> {
    volume: f64,
    sides: [f64; 3],
    fan: &'a EdgeFan,
    piece: &'a Piece,
    /// The angles about it in which it was found.
    range: [f64; 2],
}

struct Search<'a> {
    best: Option<Candidate<'a>>,
    looks: usize,
    shadow: Shadow,
}

impl<'a> Search<'a> {
    fn volume(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |b| b.volume)
    }

    /// The smallest rectangle about the shadow along the direction at an
    /// angle; takes over a box that is smaller than the best.
    fn look(
        &mut self,
        fan: &'a EdgeFan,
        piece: &'a Piece,
        angle: f64,
        range: [f64; 2],
    ) -> (f64, [f64; 2]) {
        self.looks += 1;
        fan.cast(angle, &mut self.shadow);
        let (area, [a, b]) = self.shadow.least_rectangle();
        let width = piece.width(angle);
        if area * width < self.volume() {
            let volume = area * width;
            self.best = Some(Candidate { volume, sides: [a, b, width], fan, piece, range });
        }
        (area, [a, b])
    }

    /// Golden section search in the range of the best box.
    fn narrow_down(&mut self) {
        let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
        let Some(Candidate { fan, piece, range: [mut from, mut to], .. }) = self.best else {
            return;
        };
        for _ in 0..NARROWINGS {
            let [low, high] = [to - golden * (to - from), from + golden * (to - from)];
            let [at_low, at_high] = [low, high].map(|angle| {
                let (area, _) = self.look(fan, piece, angle, [from, to]);
                area * piece.width(angle)
            });
            if at_low < at_high {
                to = high;
            } else {
                from = low;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::{
        geometry::Pose,
        grains::{
            generate,
            streams::{rotation, stream},
            tests::{few_grains, near, regular_tetrahedron},
        },
    };

    #[test]
    fn shapes_of_known_bodies() {
        let cuboid = |x, y, z| ConvexPolyhedron::cuboid(Vector::new(x, y, z)).unwrap();
        let pi = std::f64::consts::PI;
        let cube = (pi / 6.0).cbrt();
        // Volume 6, surface 22.
        let brick = pi.cbrt() * 36.0_f64.powf(2.0 / 3.0) / 22.0;
        // Edge s: volume s³/(6√2), surface √3·s²; the smallest box is the cube
        // of side s/√2 whose face diagonals are the edges.
        let tetrahedron = pi.cbrt() * 2.0_f64.powf(-1.0 / 3.0) / 3.0_f64.sqrt();
        let mut rng = stream(1, "test of shapes");
        for (name, body, sides, sphericity) in [
            ("cube", cuboid(1.0, 1.0, 1.0), [1.0, 1.0, 1.0], cube),
            ("brick 1 × 2 × 3", cuboid(2.0, 1.0, 3.0), [3.0, 2.0, 1.0], brick),
            ("regular tetrahedron", regular_tetrahedron(), [2.0, 2.0, 2.0], tetrahedron),
        ] {
            for turn in [UnitQuaternion::identity(), rotation(&mut rng), rotation(&mut rng)] {
                let pose = Pose::from_parts([0.3, 0.0, -0.2].into(), turn);
                let shape = GrainShape::of(&body.transformed(&pose));
                let got = [shape.longest, shape.intermediate, shape.shortest];
                for (side, expected) in got.iter().zip(sides) {
                    near(&format!("side of the smallest box of a {name}"), *side, expected, 1e-7);
                }
                let expected = sides[0] / sides[1];
                near("elongation L/I", shape.ratio(ShapeRatio::Elongation), expected, 1e-7);
                let expected = sides[1] / sides[2];
                near("flatness I/S", shape.ratio(ShapeRatio::Flatness), expected, 1e-7);
                let got = shape.ratio(ShapeRatio::Sphericity);
                near(&format!("sphericity of a {name}"), got, sphericity, 1e-12);
                assert_eq!(shape.faces, body.faces().len());
                assert_eq!(shape.vertices, body.vertices().len());
            }
        }
        near("sphericity of a cube (Wadell 1932)", cube, 0.806, 5e-4);
        near("sphericity of a regular tetrahedron", tetrahedron, 0.671, 5e-4);
    }

    #[test]
    fn boxes_of_grains_hold_them_and_no_trial_finds_a_smaller_one() {
        let set = generate(&few_grains(), 2).unwrap();
        let mut rng = stream(1, "trial of boxes");
        for (n, grain) in set.grains.iter().enumerate() {
            let shape = GrainShape::of(&grain.shape);
            assert!(
                shape.longest >= shape.intermediate && shape.intermediate >= shape.shortest,
                "grain {n}: L ≥ I ≥ S, got {shape:?}"
            );
            let volume = shape.longest * shape.intermediate * shape.shortest;
            assert!(volume > grain.volume, "grain {n}: its box holds it");
            for ratio in ShapeRatio::ALL {
                let value = shape.ratio(ratio);
                let range = match ratio {
                    ShapeRatio::Sphericity => 0.0..=1.0,
                    _ => 1.0..=f64::MAX,
                };
                assert!(range.contains(&value), "grain {n}: {ratio:?} is {value}");
            }
            let corners: Vec<Vector> = grain.shape.vertices().iter().map(|v| v.coords).collect();
            for _ in 0..300 {
                let turn = rotation(&mut rng);
                let tried: f64 = [Vector::x(), Vector::y(), Vector::z()]
                    .iter()
                    .map(|axis| crate::grains::fan::width(&corners, &(turn * axis)))
                    .product();
                assert!(
                    tried >= volume * (1.0 - BOX_TOLERANCE),
                    "grain {n}: a box of {tried} m³ was found, the smallest has {volume} m³"
                );
            }
        }
    }
}
