//! Void ratio by height and by radius: exact shares of every grain in layers and rings.

use super::*;

/// Sides of the prism that stands for a round ring. It has the circle's area, and lies within
/// 0.1 % of its radius.
const SIDES: u32 = 64;

/// A layer between two heights, or a ring between two radii.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slice {
    /// Where it begins, in m.
    pub from: f64,
    /// Where it ends, in m.
    pub to: f64,
    /// Its volume in m³.
    pub volume: f64,
    /// Volume of the grains in it in m³.
    pub solids: f64,
}

impl Slice {
    /// e = V/Vₛ − 1; `None` where no grain is.
    pub fn void_ratio(&self) -> Option<f64> {
        // What is left of rounding is no grain.
        (self.solids > 1e-9 * self.volume).then(|| self.volume / self.solids - 1.0)
    }
}

/// `count` layers of the same height between two heights in m, of a container of a cross-section
/// in m²; `grains` are those that lie in it.
pub fn layers(
    specimen: &Specimen,
    grains: &[usize],
    area: f64,
    between: (f64, f64),
    count: usize,
) -> Vec<Slice> {
    let edges = edges(between, count);
    let below = |z: f64| -> f64 { grains.iter().map(|&i| solid(specimen, i).below(z)).sum() };
    slices(&edges, |from, to| area * (to - from), below)
}

/// `count` rings of the same width about an upright axis through (x, 0), from it to a radius in m,
/// between two heights in m; `grains` are those that lie in it. What reaches beyond the last
/// radius counts there: walls are polygons.
pub fn rings(
    specimen: &Specimen,
    grains: &[usize],
    (axis_x, radius): (f64, f64),
    between: (f64, f64),
    count: usize,
) -> Vec<Slice> {
    let edges = edges((0.0, radius), count);
    let within = |r: f64| -> f64 {
        let prism = if r >= radius { None } else { Some(r) };
        let part = |&i: &usize| solid(specimen, i).within(axis_x, prism, between);
        grains.iter().map(part).sum()
    };
    let area = |r: f64| std::f64::consts::PI * r * r;
    slices(&edges, |from, to| (area(to) - area(from)) * (between.1 - between.0), within)
}

/// Edges of slices of the same width; the last one is as given, of which a product may fall short.
fn edges((from, to): (f64, f64), count: usize) -> Vec<f64> {
    let count = count.max(1);
    let inner = (0..count).map(|n| from + (to - from) * n as f64 / count as f64);
    inner.chain([to]).collect()
}

/// Slices between edges, by the solids up to an edge.
fn slices(
    edges: &[f64],
    volume: impl Fn(f64, f64) -> f64,
    up_to: impl Fn(f64) -> f64,
) -> Vec<Slice> {
    let solids: Vec<f64> = edges.iter().map(|&edge| up_to(edge)).collect();
    edges
        .windows(2)
        .zip(solids.windows(2))
        .map(|(edge, solids)| Slice {
            from: edge[0],
            to: edge[1],
            volume: volume(edge[0], edge[1]),
            solids: (solids[1] - solids[0]).max(0.0),
        })
        .collect()
}

/// A grain where it lies.
struct Solid {
    faces: Vec<Vec<Vector>>,
    centroid: Vector,
    radius: f64,
    whole: f64,
    sphere: Option<Sphere>,
}

fn solid(specimen: &Specimen, grain: usize) -> Solid {
    let (shape, pose) = specimen.placed(grain);
    let corners = corners_at(shape, pose);
    // The mesh of a sphere reaches beyond it, that of a rounded polyhedron as well.
    let meshed = shape.sphere().is_some() || shape.rounded().is_some();
    let larger = if meshed { 1.02 } else { 1.0 };
    Solid {
        faces: faces_at(shape, &corners),
        centroid: pose.translation.vector,
        radius: larger * shape.radius_about_origin(),
        whole: shape.signed_volume(),
        sphere: shape.sphere().map(|s| Sphere { centre: pose * s.centre, ..s }),
    }
}

impl Solid {
    /// Volume below a height.
    fn below(self, z: f64) -> f64 {
        if self.centroid.z + self.radius <= z {
            return self.whole;
        }
        if self.centroid.z - self.radius >= z {
            return 0.0;
        }
        if let Some(sphere) = self.sphere {
            return sphere.volume_below(z);
        }
        volume(&cut(self.faces, |p| p.z - z, |p| p.z = z), &self.centroid)
    }

    /// Volume between two heights, and within a radius about an axis where one is given.
    fn within(self, axis_x: f64, radius: Option<f64>, (low, high): (f64, f64)) -> f64 {
        let Self { mut faces, centroid, radius: reach, whole, .. } = self;
        if centroid.z - reach >= high || centroid.z + reach <= low {
            return 0.0;
        }
        let mut is_cut = false;
        if centroid.z + reach > high || centroid.z - reach < low {
            faces = cut(faces, |p| p.z - high, |p| p.z = high);
            faces = cut(faces, |p| low - p.z, |p| p.z = low);
            is_cut = true;
        }
        if let Some(radius) = radius {
            let half_angle = std::f64::consts::PI / f64::from(SIDES);
            let apothem = radius * (half_angle / half_angle.tan()).sqrt();
            let (x, y) = (centroid.x - axis_x, centroid.y);
            if x.hypot(y) - reach >= apothem / half_angle.cos() {
                return 0.0;
            }
            for side in 0..SIDES {
                let (sin, cos) = (2.0 * half_angle * f64::from(side)).sin_cos();
                if x * cos + y * sin + reach > apothem {
                    let height = |p: &Vector| (p.x - axis_x) * cos + p.y * sin - apothem;
                    faces = cut(faces, height, |_| {});
                    is_cut = true;
                }
            }
        }
        if is_cut { volume(&faces, &centroid).max(0.0) } else { whole }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{
        assert_near, cube, random, random_polyhedron, random_pose, specimen_of,
    };
    use super::*;
    use crate::geometry::{ConvexPolyhedron, Pose};

    /// Law: blocks of 10 mm in layers of 5 mm fill the layers that they lie in, and no other.
    #[test]
    fn layers_of_blocks_have_their_void_ratio() {
        let at = |x: f64, z: f64| (cube(0.01), Pose::translation(x, 0.0, z));
        let specimen = specimen_of(vec![at(0.0, 0.005), at(0.02, 0.005), at(0.0, 0.0175)]);
        let got = layers(&specimen, &[0, 1, 2], 4e-4, (0.0, 0.025), 5);
        // Two blocks of 1 cm² on 4 cm²; half of a layer of one; a whole layer of one.
        let expected = [1.0, 1.0, 7.0, 3.0, 7.0];
        for (slice, e) in got.iter().zip(expected) {
            let e_got = slice.void_ratio().expect("grains");
            assert_near(&format!("e from {} m", slice.from), e, e_got, 1e-9);
        }
        let empty = layers(&specimen, &[], 4e-4, (0.0, 0.025), 2);
        assert_eq!(empty[0].void_ratio(), None, "law: no grains, no ratio");
        let sum: f64 = got.iter().map(|s| s.solids).sum();
        assert_near("all solids", 3e-6, sum, 1e-15);
    }

    /// Law: nothing is lost between layers, nor between rings.
    #[test]
    fn slices_hold_all_of_every_grain() {
        let mut rng = random(5);
        let parts: Vec<_> = (0..20)
            .map(|_| (random_polyhedron(&mut rng, 0.012, 6), random_pose(&mut rng, 0.03)))
            .collect();
        let specimen = specimen_of(parts);
        let all: Vec<usize> = (0..20).collect();
        let whole: f64 = specimen.grains.grains.iter().map(|g| g.volume).sum();
        let sum = |slices: &[Slice]| slices.iter().map(|s| s.solids).sum::<f64>();
        let got = layers(&specimen, &all, 1.0, (-0.1, 0.1), 40);
        assert_near("all layers", whole, sum(&got), 1e-9 * whole);
        let got = rings(&specimen, &all, (0.003, 0.02), (-0.1, 0.1), 9);
        assert_near("all rings, with what lies beyond", whole, sum(&got), 1e-9 * whole);
    }

    /// Law: what reaches beyond the last radius counts in the last ring, also where a product of
    /// radius and share falls short of the radius by rounding, as 115 mm in 37 rings.
    #[test]
    fn the_last_ring_ends_at_the_radius_as_given() {
        let block = ConvexPolyhedron::cuboid(Vector::new(0.4, 0.4, 0.02)).expect("a block");
        let specimen = specimen_of(vec![(block, Pose::translation(0.0, 0.0, 0.01))]);
        for (radius, count) in [(0.115, 37), (0.06, 11), (0.06, 15), (0.06, 12)] {
            let got = rings(&specimen, &[0], (0.0, radius), (0.005, 0.015), count);
            let law = format!("all of a block, radius {radius} m, {count} rings");
            let sum: f64 = got.iter().map(|s| s.solids).sum();
            assert_near(&law, 0.16 * 0.01, sum, 1e-9);
            let outermost = got.last().map(|s| s.to);
            assert_eq!(outermost, Some(radius), "law: the radius as given, {count} rings");
        }
    }

    /// Law: a block as wide as everything fills each ring alike: e = 0 between its faces; a round
    /// rod of radius 10 mm fills the rings up to there.
    #[test]
    fn rings_of_a_block_and_a_rod_have_their_void_ratio() {
        let block = ConvexPolyhedron::cuboid(Vector::new(0.2, 0.2, 0.02)).expect("a block");
        let specimen = specimen_of(vec![(block, Pose::translation(0.0, 0.0, 0.01))]);
        let got = rings(&specimen, &[0], (0.01, 0.05), (0.005, 0.025), 5);
        for slice in &got[..4] {
            let e = slice.void_ratio().expect("grains");
            assert_near("15 of 20 mm are filled: e", 20.0 / 15.0 - 1.0, e, 1e-9);
        }
        let sum: f64 = got.iter().map(|s| s.solids).sum();
        assert_near("what reaches beyond counts in the last", 0.04 * 0.015, sum, 1e-12);
        // A polygon of 48 sides with the area of the circle, turned against the prism.
        let angle = std::f64::consts::PI / 24.0;
        let out = 0.01 * (angle / angle.sin()).sqrt();
        let corner = |n: u32| {
            let (sin, cos) = (angle * f64::from(n)).sin_cos();
            (out * cos, out * sin)
        };
        let polygon: Vec<(f64, f64)> = (0..48).map(corner).collect();
        let rod = ConvexPolyhedron::prism(&polygon, -0.01, 0.01).expect("a rod");
        let specimen = specimen_of(vec![(rod, Pose::rotation(Vector::z() * 0.07))]);
        let between = (-0.003, 0.003);
        let got = rings(&specimen, &[0], (0.0, 0.02), between, 4);
        let shares: Vec<f64> = got.iter().map(|s| s.solids / s.volume).collect();
        for (got, expected) in shares.iter().zip([1.0, 1.0, 0.0, 0.0]) {
            assert_near("share of solids of a ring", expected, *got, 0.01);
        }
    }
}
