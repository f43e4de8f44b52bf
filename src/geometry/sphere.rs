//! Spheres, and the polyhedra that stand for them where faces are needed.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use super::{Point, Vector};

/// How often each triangle of an icosahedron is cut into four: 162 vertices, 320 faces.
const SUBDIVISIONS: u32 = 2;

/// A sphere, exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Its centre in m.
    pub centre: Point,
    /// Its radius in m.
    pub radius: f64,
}

impl Sphere {
    /// Volume in m³.
    pub fn volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius.powi(3)
    }

    /// Surface in m².
    pub fn surface(&self) -> f64 {
        4.0 * std::f64::consts::PI * self.radius.powi(2)
    }

    /// Volume in m³ of what lies below a height of z in m: a cap's, πh²(r − h/3).
    pub fn volume_below(&self, z: f64) -> f64 {
        let h = (z - self.centre.z + self.radius).clamp(0.0, 2.0 * self.radius);
        std::f64::consts::PI * h * h * (self.radius - h / 3.0)
    }
}

/// Vertices and triangles of a body.
pub(super) type Mesh = (Vec<Point>, Arc<Vec<Vec<u32>>>);

/// The mesh that stands for every sphere: an icosahedron with its triangles divided and all
/// vertices on the unit sphere about the origin.
pub(super) fn unit_mesh() -> &'static Mesh {
    static MESH: OnceLock<Mesh> = OnceLock::new();
    MESH.get_or_init(|| {
        let (mut vertices, mut faces) = icosahedron();
        for _ in 0..SUBDIVISIONS {
            faces = divided(&mut vertices, &faces);
        }
        let faces = faces.into_iter().map(Vec::from).collect();
        (vertices.into_iter().map(Point::from).collect(), Arc::new(faces))
    })
}

fn icosahedron() -> (Vec<Vector>, Vec<[u32; 3]>) {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut vertices = Vec::with_capacity(12);
    for axis in 0..3 {
        for (one, other) in [(-1.0, -golden), (1.0, -golden), (-1.0, golden), (1.0, golden)] {
            let mut vertex = Vector::zeros();
            vertex[axis] = one;
            vertex[(axis + 1) % 3] = other;
            vertices.push(vertex);
        }
    }
    // Vertices of an edge are two apart; all triangles of such are faces.
    let near = |a: usize, b: usize| (vertices[a] - vertices[b]).norm() < 2.1;
    let mut faces = Vec::with_capacity(20);
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let [p, q, r] = [a, b, c].map(|v| vertices[v]);
                    let outward = (q - p).cross(&(r - p)).dot(&p) > 0.0;
                    let [a, b, c] = [a, b, c].map(|v| v as u32);
                    faces.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    (vertices.into_iter().map(|v| v.normalize()).collect(), faces)
}

/// Each triangle as four, by the middles of its sides, which are put on the unit sphere.
fn divided(vertices: &mut Vec<Vector>, faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            vertices.push((vertices[a as usize] + vertices[b as usize]).normalize());
            vertices.len() as u32 - 1
        })
    };
    let parts = faces.iter().flat_map(|&[a, b, c]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
    });
    parts.collect()
}

#[cfg(test)]
mod tests {
    use super::super::{ConvexPolyhedron, MassProperties, Pose, testing::near};
    use super::*;

    #[test]
    fn the_mesh_is_a_closed_convex_body_on_the_sphere() {
        let (vertices, faces) = unit_mesh();
        assert_eq!((vertices.len(), faces.len()), (162, 320), "law: 10·4ⁿ + 2 and 20·4ⁿ");
        let mesh = ConvexPolyhedron::new(vertices.clone(), faces.to_vec()).expect("convex");
        for vertex in vertices {
            near("a vertex lies on the unit sphere", vertex.coords.norm(), 1.0, 1e-15);
        }
        let deepest = (0..320).map(|f| mesh.plane(f).expect("a plane").1).fold(1.0, f64::min);
        near("the deepest face, of the radius", deepest, 0.98, 0.003);
        let volume = mesh.signed_volume() / (4.0 / 3.0 * std::f64::consts::PI);
        near("share of the sphere's volume", volume, 0.97, 0.006);
    }

    #[test]
    fn a_sphere_s_properties_are_exact_wherever_it_is() {
        let r = 0.0031_f64;
        let ball = ConvexPolyhedron::ball(r);
        let turn = nalgebra::UnitQuaternion::from_euler_angles(0.7, -0.4, 2.1);
        let pose = Pose::from_parts(nalgebra::Translation3::new(0.3, -1.0, 2.0), turn);
        let volume = 4.0 / 3.0 * std::f64::consts::PI * r.powi(3);
        for (body, k, centre) in [
            (ball.clone(), 1.0, Vector::zeros()),
            (ball.transformed(&pose), 1.0, pose.translation.vector),
            (ball.scaled(2.5), 2.5, Vector::zeros()),
        ] {
            body.sanity_check().expect("a body");
            let got = MassProperties::of(&body);
            let v = volume * k * k * k;
            near("volume 4/3 π r³", got.volume, v, 1e-14 * v);
            near("centroid", (got.centroid.coords - centre).norm(), 0.0, 1e-15);
            let moment = 0.4 * v * (r * k).powi(2);
            let expected = nalgebra::Matrix3::identity() * moment;
            near("moment 2/5 V r²", (got.inertia_per_density - expected).amax(), 0.0, 1e-20);
            near("equivalent diameter", body.equivalent_diameter(), 2.0 * r * k, 1e-15);
            let (low, high) = body.bounding_box();
            near("the box is as wide as the sphere", (high - low).amax(), 2.0 * r * k, 1e-15);
            near("bounding radius", body.radius_about_origin(), centre.norm() + r * k, 1e-15);
            let far = body.vertices().iter().map(|v| (v.coords - centre).norm());
            near("vertices on the sphere", far.fold(0.0, f64::max), r * k, 1e-15);
        }
    }

    #[test]
    fn a_sphere_comes_back_from_text() {
        let ball = ConvexPolyhedron::ball(0.003).transformed(&Pose::translation(0.1, 0.2, 0.3));
        let text = serde_json::to_string(&ball).expect("text");
        assert!(text.contains("vertices_m"), "law: its mesh is there for others");
        let back: ConvexPolyhedron = serde_json::from_str(&text).expect("a sphere");
        assert_eq!(back.sphere(), ball.sphere());
        let end = text.rfind("sphere_m").expect("a sphere");
        let spoilt = format!("{}{}", &text[..end], text[end..].replace("0.003", "-0.003"));
        let said = serde_json::from_str::<ConvexPolyhedron>(&spoilt).expect_err("bad").to_string();
        assert!(said.contains("radius of a sphere"), "law: it says so, got {said}");
    }

    #[test]
    fn caps_have_their_volume() {
        let sphere = Sphere { centre: Point::new(0.0, 0.0, 2.0), radius: 0.5 };
        let whole = sphere.volume();
        for (z, share) in [(1.0, 0.0), (1.5, 0.0), (2.0, 0.5), (2.5, 1.0), (3.0, 1.0)] {
            near("share below a height", sphere.volume_below(z) / whole, share, 1e-15);
        }
        // h = r/2: π r²/4 (r − r/6) of 4/3 π r³ is 5/32.
        near("a cap of half the radius", sphere.volume_below(1.75) / whole, 5.0 / 32.0, 1e-15);
    }
}
