//! What stands before the camera, and what a ray meets of it.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector as Corner;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhLeafCost, BvhNode, TraversalAction};

use super::*;

/// A solid and how it looks.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Its shape in its place.
    pub solid: Solid,
    /// Its colour.
    pub colour: Colour,
    /// From this plane on, the planes are sections it was cut along, shown in [`Colour::SECTION`].
    pub sections_from: usize,
    /// Whether light and view go through it.
    pub glass: bool,
}

impl Body {
    /// An opaque body without sections.
    pub fn new(solid: Solid, colour: Colour) -> Self {
        let sections_from = usize::MAX;
        Self { solid, colour, sections_from, glass: false }
    }
}

/// What a ray meets first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Number of the body, in the order of the scene.
    pub body: u32,
    /// Number of its plane, or [`BALL`].
    pub plane: u32,
    /// Distance along the ray in m.
    pub t: f64,
}

impl BvhLeafCost for Hit {
    fn cost(&self) -> f64 {
        self.t
    }
}

/// Bodies, sorted for rays.
///
/// The tree of boxes is that of parry, the collision library of the second
/// engine; what a ray makes of a body is exact and our own.
pub struct Scene {
    /// The bodies.
    pub bodies: Vec<Body>,
    /// Height of the ground in m, which shows nothing but shadows; none where there is no ground.
    pub ground: Option<f64>,
    opaque: Tree,
    glass: Tree,
    // The planes of all bodies in one row, and where those of a body begin.
    planes: Vec<Plane>,
    first: Vec<u32>,
}

/// Bodies sorted by their boxes. Leaves are numbered from 0 without gaps: with one
/// or two of them parry 0.31.1 takes their places for their numbers.
#[derive(Debug, Clone)]
struct Tree {
    boxes: Bvh,
    bodies: Vec<u32>, // by leaf
}

impl Tree {
    /// Hands on the bodies whose boxes a ray meets up to a distance in m.
    fn each_near(&self, ray: &Ray, most: f64, mut body: impl FnMut(u32) -> TraversalAction) {
        let boxes = Boxes::new(ray);
        self.boxes.traverse(|node| {
            if boxes.enters(node, most) == f64::MAX {
                return TraversalAction::Prune;
            }
            let leaf = node.leaf_data().map(|leaf| self.bodies[leaf as usize]);
            leaf.map_or(TraversalAction::Continue, &mut body)
        });
    }
}

impl Scene {
    /// Sorts bodies.
    pub fn new(bodies: Vec<Body>, ground: Option<f64>) -> Self {
        let tree = |glass: bool| {
            let corner = |p: &Point| Corner::new(p.x, p.y, p.z);
            let leaf = |(n, body): (usize, &u32)| {
                let solid = &bodies[*body as usize].solid;
                (n, Aabb::new(corner(&solid.low), corner(&solid.high)))
            };
            let chosen = bodies.iter().enumerate().filter(|(_, b)| b.glass == glass);
            let numbers: Vec<u32> = chosen.map(|(n, _)| n as u32).collect();
            let leaves: Vec<_> = numbers.iter().enumerate().map(leaf).collect();
            Tree { boxes: Bvh::from_iter(BvhBuildStrategy::Binned, leaves), bodies: numbers }
        };
        let (opaque, glass) = (tree(false), tree(true));
        let mut planes = Vec::new();
        let mut first = vec![0];
        for body in &bodies {
            planes.extend_from_slice(&body.solid.planes);
            first.push(planes.len() as u32);
        }
        Self { bodies, ground, opaque, glass, planes, first }
    }

    fn planes_of(&self, body: u32) -> &[Plane] {
        let n = body as usize;
        &self.planes[self.first[n] as usize..self.first[n + 1] as usize]
    }

    /// The normal of a body at a point of its surface that a ray met on a plane or the sphere.
    pub fn normal(&self, body: u32, plane: u32, at: &Vector) -> Vector {
        match self.bodies[body as usize].solid.ball {
            Some(ball) if plane as usize == BALL => (at - ball.centre.coords) / ball.radius,
            _ => self.planes_of(body)[plane as usize].normal,
        }
    }

    fn stretch(&self, body: u32, ray: &Ray) -> Option<Stretch> {
        let ball = self.bodies[body as usize].solid.ball.as_ref();
        stretch_in(ball, self.planes_of(body), ray)
    }

    /// The first opaque body that a ray meets.
    pub fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        let boxes = Boxes::new(ray);
        let leaf = |leaf: u32, _: f64| {
            let body = self.opaque.bodies[leaf as usize];
            let s = self.stretch(body, ray)?;
            (s.enters > 0.0).then_some(Hit { body, plane: s.through as u32, t: s.enters })
        };
        let found =
            self.opaque.boxes.find_best(f64::MAX, |node, best| boxes.enters(node, best), leaf);
        found.map(|(_, hit)| hit)
    }

    /// Whether an opaque body other than `own` stands on a ray nearer than `most` (m).
    pub fn is_shaded(&self, ray: &Ray, own: u32, most: f64) -> bool {
        let mut shaded = false;
        self.opaque.each_near(ray, most, |body| {
            let met = if body == own { None } else { self.stretch(body, ray) };
            shaded |= met.is_some_and(|s| s.leaves > 0.0 && s.enters < most);
            if shaded { TraversalAction::EarlyExit } else { TraversalAction::Continue }
        });
        shaded
    }

    /// How far a ray runs through glass up to a distance, both in m.
    pub fn glass_on(&self, ray: &Ray, up_to: f64) -> f64 {
        let mut length = 0.0;
        self.glass.each_near(ray, up_to, |body| {
            if let Some(s) = self.stretch(body, ray) {
                length += (s.leaves.min(up_to) - s.enters.max(0.0)).max(0.0);
            }
            TraversalAction::Continue
        });
        length
    }

    /// Points whose hull holds all bodies, for framing.
    pub fn outline(&self) -> Vec<Point> {
        self.bodies.iter().flat_map(|b| b.solid.outline.iter().copied()).collect()
    }

    /// Half the diagonal of the box around everything, in m; 0 of nothing.
    pub fn radius(&self) -> f64 {
        let boxes = self.bodies.iter().map(|b| [b.solid.low, b.solid.high]);
        let whole = boxes.reduce(|[a, b], [low, high]| [a.inf(&low), b.sup(&high)]);
        whole.map_or(0.0, |[low, high]| (high - low).norm() / 2.0)
    }
}

/// A ray as the test against boxes wants it.
struct Boxes {
    origin: Vector,
    inverse: Vector,
}

impl Boxes {
    fn new(ray: &Ray) -> Self {
        Self { origin: ray.origin, inverse: ray.direction.map(|d| 1.0 / d) }
    }

    /// Where the ray comes into a node's box, 0 inside it; `f64::MAX` where it does not up to
    /// `most`. Boxes touched within a face count as met.
    #[inline]
    fn enters(&self, node: &BvhNode, most: f64) -> f64 {
        let (low, high) = (node.mins(), node.maxs());
        let (mut near, mut far) = (0.0_f64, most);
        for (axis, (low, high)) in
            [(low.x, high.x), (low.y, high.y), (low.z, high.z)].into_iter().enumerate()
        {
            let (origin, inverse) = (self.origin[axis], self.inverse[axis]);
            // Across the ray, between two faces or within one, nothing bounds it: 0 · ∞ is no number.
            if inverse.is_infinite() && low <= origin && origin <= high {
                continue;
            }
            let a = (low - origin) * inverse;
            let b = (high - origin) * inverse;
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        if near <= far { near } else { f64::MAX }
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::super::solid::stretch;
    use super::*;
    use crate::geometry::{ConvexPolyhedron, Pose, testing::near};

    fn many(glass: bool) -> (Vec<Body>, rand_pcg::Pcg64Mcg) {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        let bodies = (0..200)
            .map(|_| {
                let mut within =
                    |low: f64, high: f64| Vector::from_fn(|_, _| random.random_range(low..high));
                let shape = ConvexPolyhedron::cuboid(within(0.02, 0.2)).expect("a box");
                let pose = Pose::new(within(-1.0, 1.0), within(-2.0, 2.0));
                let colour = Colour::GREY;
                Body { glass, ..Body::new(Solid::new(&shape, &pose), colour) }
            })
            .collect();
        (bodies, random)
    }

    fn random_ray(random: &mut rand_pcg::Pcg64Mcg) -> Ray {
        let mut point = |half: f64| Vector::from_fn(|_, _| random.random_range(-half..half));
        Ray { origin: point(2.0), direction: point(1.0).normalize() }
    }

    #[test]
    fn the_tree_loses_nothing() {
        let (bodies, mut random) = many(false);
        let scene = Scene::new(bodies, None);
        let (mut hits, mut shaded) = (0, 0);
        for _ in 0..30_000 {
            let ray = random_ray(&mut random);
            let all = scene
                .bodies
                .iter()
                .enumerate()
                .filter_map(|(n, b)| stretch(&b.solid.planes, &ray).map(|s| (n as u32, s)));
            let all: Vec<_> = all.collect();
            let nearest = all
                .iter()
                .filter(|(_, s)| s.enters > 0.0)
                .min_by(|a, b| a.1.enters.total_cmp(&b.1.enters));
            let got = scene.first_hit(&ray);
            assert_eq!(
                got.map(|h| (h.body, h.t)),
                nearest.map(|(n, s)| (*n, s.enters)),
                "law: the nearest of all bodies"
            );
            hits += usize::from(got.is_some());
            let own = nearest.map_or(u32::MAX, |n| n.0);
            let expected = all.iter().any(|(n, s)| *n != own && s.leaves > 0.0 && s.enters < 1.5);
            assert_eq!(scene.is_shaded(&ray, own, 1.5), expected, "law: any other body counts");
            shaded += usize::from(expected);
        }
        assert!(hits > 300 && shaded > 300, "the test meets bodies: {hits} and {shaded} times");
    }

    /// Law: a body is met by a ray that runs within one of its faces, as by one inside of it.
    #[test]
    fn rays_within_a_face_meet_the_body() {
        let body = |n: u32| {
            let shape = ConvexPolyhedron::cuboid(Vector::repeat(0.5)).expect("a box");
            let pose = Pose::translation(f64::from(n), 0.0, 0.0);
            Body::new(Solid::new(&shape, &pose), Colour::GREY)
        };
        let scene = Scene::new((0..3).map(body).collect(), None);
        for side in [[0.0, 0.25], [0.0, -0.25], [0.25, 0.0], [-0.25, 0.0], [0.25, -0.25]] {
            for (from, sign, expected) in [(-1.0, 1.0, 0), (3.0, -1.0, 2)] {
                // Of -0 the inverse is negative.
                for zero in [0.0, -0.0] {
                    let origin = Vector::new(from, side[0], side[1]);
                    let ray = Ray { origin, direction: Vector::new(sign, zero, zero) };
                    let got = scene.first_hit(&ray).map(|hit| (hit.body, hit.t));
                    assert_eq!(got, Some((expected, 0.75)), "law: body {expected} at {side:?}");
                    assert!(scene.is_shaded(&ray, u32::MAX, 1.0), "law: it shades, at {side:?}");
                }
            }
            let beside = Vector::new(-1.0, 2.0 * side[0], 2.0 * side[1]);
            let ray = Ray { origin: beside, direction: Vector::x() };
            assert_eq!(scene.first_hit(&ray), None, "law: nothing beside it, at {side:?}");
        }
    }

    #[test]
    fn glass_adds_up_and_hides_nothing() {
        let (bodies, mut random) = many(true);
        let scene = Scene::new(bodies, None);
        for _ in 0..1000 {
            let ray = random_ray(&mut random);
            assert!(scene.first_hit(&ray).is_none(), "law: glass is no opaque body");
            let expected: f64 = scene
                .bodies
                .iter()
                .filter_map(|b| stretch(&b.solid.planes, &ray))
                .map(|s| (s.leaves.min(1.2) - s.enters.max(0.0)).max(0.0))
                .sum();
            let got = scene.glass_on(&ray, 1.2);
            near("lengths add up", got, expected, 1e-12);
        }
    }

    #[test]
    fn an_empty_scene_is_met_by_no_ray() {
        let scene = Scene::new(Vec::new(), None);
        let ray = Ray { origin: Vector::zeros(), direction: Vector::x() };
        assert!(scene.first_hit(&ray).is_none() && !scene.is_shaded(&ray, 0, 1.0));
        assert_eq!((scene.glass_on(&ray, 1.0), scene.radius()), (0.0, 0.0));
    }
}
