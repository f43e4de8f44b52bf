//! Convex solids as spheres and the half-spaces that bound them, and where a ray goes through one.

use super::*;
use crate::geometry::Sphere;

/// A ray: every point `origin + t · direction` with t in m along a unit vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it begins, in m.
    pub origin: Vector,
    /// Unit vector.
    pub direction: Vector,
}

impl Ray {
    /// The point at a distance in m.
    pub fn at(&self, t: f64) -> Vector {
        self.origin + t * self.direction
    }
}

/// A plane, as its unit normal and its offset in m: `normal · x <= offset`
/// holds on the side that is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Unit vector that points out of the solid.
    pub normal: Vector,
    /// Distance of the plane from the origin along the normal, in m.
    pub offset: f64,
}

/// The stretch of a ray inside a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Where the ray goes in, in m along it; minus infinity where no plane faces it.
    pub enters: f64,
    /// Which plane it goes in through, or [`BALL`].
    pub through: usize,
    /// Where it comes out.
    pub leaves: f64,
}

/// The number of a sphere's surface, beside those of planes.
pub const BALL: usize = u32::MAX as usize;

/// A convex solid in world coordinates: the points behind all of its planes, and in its sphere.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// One plane a face, in the order of the faces, then those it was cut by.
    pub planes: Vec<Plane>,
    /// The sphere that it is or was cut from, if any; it has no planes for it.
    pub ball: Option<Sphere>,
    /// Lowest corner of a box that holds it, in m.
    pub low: Point,
    /// Highest corner of that box.
    pub high: Point,
    /// Points whose hull holds it, in m: what must be in the picture.
    pub outline: Vec<Point>,
}

impl Solid {
    /// A polyhedron, or a sphere, at a pose.
    pub fn new(shape: &ConvexPolyhedron, pose: &Pose) -> Self {
        let outline: Vec<Point> = shape.vertices().iter().map(|v| pose * v).collect();
        if let Some(Sphere { centre, radius }) = shape.sphere() {
            let centre = pose * centre;
            let reach = Vector::repeat(radius);
            let (low, high) = (centre - reach, centre + reach);
            let ball = Some(Sphere { centre, radius });
            return Self { planes: Vec::new(), ball, low, high, outline };
        }
        let plane = |face| {
            let (normal, offset) = shape.plane(face)?;
            let normal = pose.rotation * normal;
            Some(Plane { normal, offset: offset + normal.dot(&pose.translation.vector) })
        };
        // A checked polyhedron has no face without area.
        let planes = (0..shape.faces().len()).filter_map(plane).collect();
        let first = outline.first().copied().unwrap_or_else(Point::origin);
        let (low, high) = outline.iter().fold((first, first), |(lo, hi), v| (lo.inf(v), hi.sup(v)));
        Self { planes, ball: None, low, high, outline }
    }

    /// The same within a smaller box, which holds all that was left of it.
    pub fn boxed(self, low: Point, high: Point) -> Self {
        let corner = |n: usize| {
            let pick = |axis: usize| if n >> axis & 1 == 0 { low[axis] } else { high[axis] };
            Point::new(pick(0), pick(1), pick(2))
        };
        Self { low, high, outline: (0..8).map(corner).collect(), ..self }
    }

    /// What of it lies behind one more plane; the box stays as it is.
    pub fn cut(mut self, plane: Plane) -> Self {
        self.planes.push(plane);
        self
    }
}

/// Where a ray runs behind all of the planes and in the sphere, if there is one; `None` where
/// it never does.
pub fn stretch_in(ball: Option<&Sphere>, planes: &[Plane], ray: &Ray) -> Option<Stretch> {
    let behind = stretch(planes, ray)?;
    let Some(ball) = ball else { return Some(behind) };
    let to = ball.centre.coords - ray.origin;
    let along = to.dot(&ray.direction);
    let beside = to.norm_squared() - along * along;
    let half = (ball.radius * ball.radius - beside).max(0.0).sqrt();
    if half <= 0.0 {
        return None;
    }
    let (enters, leaves) = (along - half, (along + half).min(behind.leaves));
    let within = if enters > behind.enters {
        Stretch { enters, through: BALL, leaves }
    } else {
        Stretch { leaves, ..behind }
    };
    (within.enters <= within.leaves).then_some(within)
}

/// Where a ray runs behind all of the planes; `None` where it never does.
///
/// Each plane that the ray goes in through moves the entry farther, each that it comes out of
/// brings the exit nearer (Cyrus and Beck 1978, "Generalized two- and three-dimensional clipping").
/// That is exact for a convex solid; a ray within a face counts as inside it.
pub fn stretch(planes: &[Plane], ray: &Ray) -> Option<Stretch> {
    let (mut enters, mut through, mut leaves) = (f64::NEG_INFINITY, 0, f64::INFINITY);
    for (n, plane) in planes.iter().enumerate() {
        let along = plane.normal.dot(&ray.direction);
        let before = plane.offset - plane.normal.dot(&ray.origin);
        if along == 0.0 {
            if before < 0.0 {
                return None;
            }
            continue;
        }
        let t = before / along;
        if along < 0.0 {
            if t > enters {
                (enters, through) = (t, n);
            }
        } else if t < leaves {
            leaves = t;
        }
        if enters > leaves {
            return None;
        }
    }
    Some(Stretch { enters, through, leaves })
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;

    fn ray(origin: [f64; 3], towards: [f64; 3]) -> Ray {
        Ray { origin: origin.into(), direction: Vector::from(towards).normalize() }
    }

    fn cube() -> Solid {
        let shape = ConvexPolyhedron::cuboid(Vector::new(2.0, 2.0, 2.0)).expect("a cube");
        Solid::new(&shape, &Pose::identity())
    }

    /// A turned and shifted block without symmetry.
    fn block() -> (ConvexPolyhedron, Pose) {
        let upper = [(-0.3, -0.4), (0.5, -0.2), (0.2, 0.6)];
        let level =
            |z: f64, k: f64| upper.iter().map(|&(x, y)| Point::new(k * x, k * y, z)).collect();
        let shape = ConvexPolyhedron::frustum(level(-0.4, 1.3), level(0.5, 0.7)).expect("a block");
        let turn = nalgebra::UnitQuaternion::from_euler_angles(0.4, -0.9, 1.7);
        (shape, Pose::from_parts(nalgebra::Translation3::new(0.1, -0.2, 0.3), turn))
    }

    /// Entry and exit of a ray by its crossings of all surface triangles
    /// (Möller and Trumbore 1997).
    fn crossings(shape: &ConvexPolyhedron, ray: &Ray) -> Vec<f64> {
        let cross = |[a, b, c]: [Point; 3]| {
            let (e, f) = (b - a, c - a);
            let p = ray.direction.cross(&f);
            let det = e.dot(&p);
            if det.abs() < 1e-14 {
                return None;
            }
            let s = ray.origin - a.coords;
            let u = s.dot(&p) / det;
            let q = s.cross(&e);
            let v = ray.direction.dot(&q) / det;
            (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| f.dot(&q) / det)
        };
        let mut found: Vec<f64> = shape.triangles().filter_map(cross).collect();
        found.sort_by(f64::total_cmp);
        found
    }

    #[test]
    fn a_cube_is_met_where_it_must_be() {
        let planes = cube().planes;
        let got = stretch(&planes, &ray([-5.0, 0.3, -0.2], [1.0, 0.0, 0.0])).expect("a hit");
        assert_eq!((got.enters, got.leaves), (4.0, 6.0), "law: faces at x = -1 and 1");
        assert_eq!(planes[got.through].normal, Vector::new(-1.0, 0.0, 0.0), "law: in at -x");
        let got = stretch(&planes, &ray([0.0; 3], [0.0, 0.0, 1.0])).expect("from inside");
        assert_eq!((got.enters, got.leaves), (-1.0, 1.0), "law: a ray from inside began before");
        let got = stretch(&planes, &ray([-2.0, -2.0, -2.0], [1.0, 1.0, 1.0])).expect("a diagonal");
        let root = 3.0_f64.sqrt();
        for (got, expected) in [(got.enters, root), (got.leaves, 3.0 * root)] {
            assert!((got - expected).abs() < 1e-14, "law: corners, expected {expected}, got {got}");
        }
    }

    #[test]
    fn grazing_rays_are_told_from_missing_ones() {
        let planes = cube().planes;
        // Parallel to a face: within it, just inside, just outside.
        for (y, hits) in [(1.0, true), (1.0 - 1e-12, true), (1.0 + 1e-12, false), (-1.0, true)] {
            let got = stretch(&planes, &ray([-5.0, y, 0.0], [1.0, 0.0, 0.0]));
            assert_eq!(got.is_some(), hits, "law: a ray at y = {y} along the face at y = 1");
        }
        // Past an edge, by a hair on either side of it.
        for (shift, hits) in [(-1e-9, true), (1e-9, false)] {
            let got = stretch(&planes, &ray([-1.0 + shift, 3.0, 0.0], [1.0, -1.0, 0.0]));
            assert_eq!(got.is_some(), hits, "law: a ray {shift} from the edge at (1, 1)");
        }
        let behind = stretch(&planes, &ray([5.0, 0.0, 0.0], [1.0, 0.0, 0.0])).expect("the line");
        assert!(behind.leaves < 0.0, "law: what is behind is met at t < 0, got {behind:?}");
    }

    #[test]
    fn random_rays_meet_what_all_triangles_say() {
        let (shape, pose) = block();
        let world = shape.transformed(&pose);
        let solid = Solid::new(&shape, &pose);
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(7);
        let mut hits = 0;
        for _ in 0..20_000 {
            let mut point = |half: f64| Vector::from_fn(|_, _| random.random_range(-half..half));
            let ray = Ray { origin: point(1.5), direction: point(1.0).normalize() };
            let expected = crossings(&world, &ray);
            let got = stretch(&solid.planes, &ray);
            match (got, expected.first(), expected.last()) {
                (None, None, None) => {}
                (Some(got), Some(first), Some(last)) => {
                    hits += 1;
                    let off = (got.enters - first).abs().max((got.leaves - last).abs());
                    assert!(off < 1e-9, "law: {first} to {last}, got {got:?}, tolerance 1e-9");
                    let plane = solid.planes[got.through];
                    let off = plane.normal.dot(&ray.at(got.enters)) - plane.offset;
                    assert!(off.abs() < 1e-12, "law: the entry lies on its plane, off by {off}");
                }
                // Both are right only where a ray touches an edge within rounding.
                (Some(got), None, None) => {
                    assert!(got.leaves - got.enters < 1e-9, "law: no triangle, got {got:?}");
                }
                (got, first, _) => panic!("law: {first:?}, got {got:?}"),
            }
        }
        assert!(hits > 1000, "law: the test hits the block, {hits} times");
    }

    #[test]
    fn a_cut_solid_ends_at_the_plane() {
        let plane = Plane { normal: Vector::x(), offset: 0.25 };
        let cut = cube().cut(plane);
        let got = stretch(&cut.planes, &ray([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0])).expect("a hit");
        assert_eq!((got.enters, got.leaves), (4.0, 5.25), "law: it ends at x = 0.25");
        let got = stretch(&cut.planes, &ray([5.0, 0.0, 0.0], [-1.0, 0.0, 0.0])).expect("a hit");
        assert_eq!(got.through, 6, "law: the seventh plane is the section, got {got:?}");
    }

    #[test]
    fn a_sphere_is_met_where_it_must_be() {
        let shape = ConvexPolyhedron::of_sphere(Sphere { centre: Point::origin(), radius: 2.0 });
        let pose = Pose::translation(1.0, 0.0, 0.0);
        let solid = Solid::new(&shape.expect("a sphere"), &pose);
        let met = |solid: &Solid, ray: &Ray| stretch_in(solid.ball.as_ref(), &solid.planes, ray);
        let through = ray([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let got = met(&solid, &through).expect("a hit");
        assert_eq!(
            (got.enters, got.through, got.leaves),
            (4.0, BALL, 8.0),
            "law: the sphere from x = -1 to 3"
        );
        let beside = |y: f64| met(&solid, &ray([-5.0, y, 0.0], [1.0, 0.0, 0.0]));
        assert!(beside(1.999).is_some(), "law: just inside its outline");
        assert!(beside(2.001).is_none(), "law: just outside its outline");
        let cut = solid.cut(Plane { normal: -Vector::x(), offset: 0.0 });
        let got = met(&cut, &through).expect("a hit");
        assert_eq!(
            (got.enters, got.through, got.leaves),
            (5.0, 0, 8.0),
            "law: cut at x = 0, it begins there"
        );
        assert_eq!(
            (cut.low, cut.high),
            (Point::new(-1.0, -2.0, -2.0), Point::new(3.0, 2.0, 2.0)),
            "law: its box is that of the sphere"
        );
    }

    #[test]
    fn the_box_holds_every_vertex() {
        let (shape, pose) = block();
        let solid = Solid::new(&shape, &pose);
        let (low, high) = shape.transformed(&pose).bounding_box();
        assert_eq!((solid.low, solid.high), (low, high));
    }
}
