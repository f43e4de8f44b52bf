//! Pictures of small scenes against what they must show.

use super::*;
use crate::geometry::{ConvexPolyhedron, Pose, testing::near};
use crate::picture::camera::View;
use crate::picture::scene::Body;
use crate::picture::solid::Solid;

const SIZE: u32 = 120;

fn body(sides: Vector, at: Vector, colour: Colour) -> Body {
    let shape = ConvexPolyhedron::cuboid(sides).expect("a box");
    Body::new(Solid::new(&shape, &Pose::translation(at.x, at.y, at.z)), colour)
}

fn picture(scene: &Scene, view: &View) -> (Camera, Image) {
    let camera = Camera::framing(&scene.outline(), view, SIZE, SIZE);
    let image = render(scene, &camera, SIZE, SIZE, 0.1);
    (camera, image)
}

fn covered(image: &Image) -> f64 {
    image.pixels.iter().map(|p| f64::from(p[3])).sum()
}

/// A many-sided hull around the unit sphere: a prism over a polygon, cut along
/// tangent planes spread over the sphere.
fn ball(planes: usize) -> Solid {
    let shape = ConvexPolyhedron::cuboid(Vector::new(2.0, 2.0, 2.0)).expect("a cube");
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..planes).fold(Solid::new(&shape, &Pose::identity()), |solid, n| {
        let z = 1.0 - (2 * n + 1) as f64 / planes as f64;
        let (r, angle) = ((1.0 - z * z).sqrt(), golden * n as f64);
        let normal = Vector::new(r * angle.cos(), r * angle.sin(), z);
        solid.cut(crate::picture::solid::Plane { normal, offset: 1.0 })
    })
}

#[test]
fn the_silhouette_of_a_ball_has_its_area() {
    let scene = Scene::new(vec![Body::new(ball(2000), Colour::GRAIN)], None);
    let view = View { azimuth_deg: 0.0, elevation_deg: 0.0 };
    let (camera, image) = picture(&scene, &view);
    // The cone that touches a unit ball from the distance d opens by asin(1/d): on
    // the plane at distance 1 its radius is 1/√(d² - 1).
    let middle = camera.ray(f64::from(SIZE) / 2.0, f64::from(SIZE) / 2.0);
    let d = middle.origin.norm();
    let (x0, _) = camera.project(&crate::geometry::Point::origin()).expect("seen");
    let (x1, _) = camera.project(&crate::geometry::Point::new(1.0, 0.0, 0.0)).expect("seen");
    let pixels_per_tangent = (x1 - x0) * d;
    let expected = std::f64::consts::PI * pixels_per_tangent.powi(2) / (d * d - 1.0);
    let got = covered(&image);
    near("silhouette of a ball", got, expected, 4e-3 * expected);
}

#[test]
fn a_face_on_covers_what_its_corners_enclose() {
    let scene =
        Scene::new(vec![body(Vector::new(0.4, 1e-3, 0.2), Vector::zeros(), Colour::GRAIN)], None);
    let (camera, image) = picture(&scene, &View { azimuth_deg: 0.0, elevation_deg: 0.0 });
    let corner = |x, z| camera.project(&crate::geometry::Point::new(x, -0.5e-3, z)).expect("seen");
    let (low, high) = (corner(-0.2, -0.1), corner(0.2, 0.1));
    let expected = (high.0 - low.0) * (low.1 - high.1);
    let got = covered(&image);
    // Nine rays a pixel: a straight edge is off by up to a sixth of a pixel.
    let most = 2.0 * (high.0 - low.0 + low.1 - high.1) / 6.0;
    near("width times height", got, expected, most);
}

#[test]
fn threads_change_no_bit() {
    let bodies = (0..30)
        .map(|n| {
            let n = f64::from(n);
            let at = Vector::new((n * 0.7).sin(), (n * 1.3).cos(), 0.1 * n);
            let b = body(Vector::new(0.5, 0.3, 0.2), at, Colour::GRAIN);
            Body { glass: n > 25.0, ..b }
        })
        .collect();
    let scene = Scene::new(bodies, Some(-0.5));
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| picture(&scene, &View::default()).1)
    };
    let (one, three) = (on(1), on(3));
    let bits = |image: &Image| -> Vec<u32> {
        image.pixels.iter().flatten().map(|c| c.to_bits()).collect()
    };
    assert!(bits(&one) == bits(&three), "law: one thread and three give the same bits");
    assert!(covered(&one) > 100.0, "something is seen");
}

#[test]
fn shadows_fall_on_the_ground_and_nowhere_else() {
    let block = body(Vector::new(0.1, 0.1, 0.1), Vector::new(0.0, 0.0, 0.05), Colour::GRAIN);
    let bare = Scene::new(vec![block.clone()], None);
    let on_ground = Scene::new(vec![block], Some(0.0));
    let view = View { azimuth_deg: 0.0, elevation_deg: 30.0 };
    let (bare, shaded) = (picture(&bare, &view).1, picture(&on_ground, &view).1);
    let (a, b) = (covered(&bare), covered(&shaded));
    // Most of it lies behind the block, and it is not black throughout.
    assert!(b > a + 50.0, "law: a shadow covers more than the block, {a} and {b} pixels");
    let black = |p: &&[f32; 4]| p[3] > 0.05 && p[0] == 0.0 && p[1] == 0.0 && p[2] == 0.0;
    assert!(shaded.pixels.iter().filter(black).count() > 50, "law: shadows are black");
    assert_eq!(bare.pixels.iter().filter(black).count(), 0, "law: no ground, no shadow");
    let worst = shaded.pixels.iter().map(|p| p[3]).fold(0.0, f32::max);
    assert!(worst <= 1.0 + 1e-6, "law: alpha is at most 1, got {worst}");
}

#[test]
fn glass_lets_through_by_its_thickness() {
    let glass =
        Body { glass: true, ..body(Vector::new(1.0, 0.1, 1.0), Vector::zeros(), Colour::GREY) };
    let scene = Scene::new(vec![glass], None);
    let (_, image) = picture(&scene, &View { azimuth_deg: 0.0, elevation_deg: 0.0 });
    let middle = image.pixels[(SIZE / 2 * SIZE + SIZE / 2) as usize][3];
    let expected = 1.0 - (-1.0f32).exp();
    assert!(
        (middle - expected).abs() < 1e-3,
        "law: 0.1 m of glass of depth 0.1 m hold back 1 - 1/e = {expected}, got {middle}"
    );
}
