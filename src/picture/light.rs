//! Light: a lamp with soft shadows and a sky that crevices see little of.
//!
//! Every pixel takes few samples, pixel by pixel others, and each surface is averaged over a square
//! of pixels that together hold them all (Keller and Heidrich 2001, "Interleaved sampling").
//! Nothing is drawn at random: the same scene gives the same picture.

use std::f64::consts::TAU;

use super::*;

/// Side of the square of pixels that share the samples.
pub const SQUARE: usize = 4;
/// Number of pixels of that square.
const PIXELS: usize = SQUARE * SQUARE;
/// Samples of the sky, and of the lamp, in the square.
const SAMPLES: usize = 2 * PIXELS;
/// Half the angle under which the lamp is seen, in radians: large, for soft edges.
const LAMP_RADIUS: f64 = 0.06;
/// How much of the light of a fully lit surface comes from the sky.
const SKY_SHARE: f32 = 0.50;
/// The same of the lamp, where it shines straight on the surface.
const LAMP_SHARE: f32 = 0.78;

/// What reaches a point: the share of the sky it sees, and of the lamp.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Lit {
    /// 0 to 1, weighted with the cosine to the normal.
    pub sky: f32,
    /// 0 to 1.
    pub lamp: f32,
}

/// Where the light comes from.
pub struct Light {
    lamp: Vector,
    lamps: [Vector; SAMPLES],
    // About the z axis, weighted with the cosine.
    sky: [Vector; SAMPLES],
    // How far off something still takes light from the sky, in m, by sample: apart, so
    // that what ends there leaves no line.
    reach: [f64; SAMPLES],
}

impl Light {
    /// Lamp and sky for a camera's axes; beyond some `reach` (m) nothing takes light from the sky.
    pub fn new(axes: &[Vector; 3], reach: f64) -> Self {
        // From behind the camera's left shoulder.
        let level = axes[0].cross(&Vector::z());
        let lamp = (-0.45 * axes[0] + 0.55 * level + 1.1 * Vector::z()).normalize();
        let [a, b] = across(&lamp);
        let lamps = std::array::from_fn(|n| {
            let (r, angle) = disc(n, SAMPLES);
            (lamp + LAMP_RADIUS * r * (angle.cos() * a + angle.sin() * b)).normalize()
        });
        let sky = std::array::from_fn(|n| {
            let (r, angle) = disc(n, SAMPLES);
            Vector::new(r * angle.cos(), r * angle.sin(), (1.0 - r * r).sqrt())
        });
        let part = |n: usize| (n as f64 * 0.618_033_988_75).fract();
        let reach = std::array::from_fn(|n| reach * (0.3 + 1.4 * part(n)));
        Self { lamp, lamps, sky, reach }
    }

    /// What some of the samples find at a point of body `own`.
    pub fn gather(
        &self,
        scene: &Scene,
        at: Vector,
        normal: &Vector,
        own: u32,
        samples: &[usize],
    ) -> Lit {
        let [a, b] = across(normal);
        let share = |free: usize| free as f32 / samples.len().max(1) as f32;
        let sees = |direction: Vector, most: f64| {
            !scene.is_shaded(&Ray { origin: at, direction }, own, most)
        };
        let sky = samples.iter().filter(|&&n| {
            let s = self.sky[n];
            sees(s.x * a + s.y * b + s.z * normal, self.reach[n])
        });
        let sky = share(sky.count());
        let faces = normal.dot(&self.lamp) > 0.0;
        let lamp = samples.iter().filter(|&&n| faces && sees(self.lamps[n], f64::MAX));
        Lit { sky, lamp: share(lamp.count()) }
    }

    /// The colour of a surface in this light.
    pub fn shade(&self, colour: Colour, normal: &Vector, lit: Lit) -> [f32; 3] {
        // The sky is brighter above; below, the ground throws some light back.
        let dome = 0.8 + 0.2 * normal.z as f32;
        let straight = normal.dot(&self.lamp).max(0.0) as f32;
        let light = SKY_SHARE * dome * lit.sky + LAMP_SHARE * straight * lit.lamp;
        // What light crevices get comes from their own walls.
        let bounced = 0.06 * (1.0 - lit.sky);
        colour.0.map(|c| c * (light + bounced))
    }

    /// How dark a shadow lies on the ground, 0 to 1.
    pub fn shadow(lit: Lit) -> f32 {
        0.62 * (1.0 - 0.55 * lit.sky - 0.45 * lit.lamp)
    }
}

/// The samples of the pixel in a column and row.
pub fn samples_of(x: usize, y: usize) -> [usize; 2] {
    let pixel = SQUARE * (y % SQUARE) + x % SQUARE;
    [pixel, pixel + PIXELS]
}

/// A quarter of all samples, for points whose surface no pixel shows.
pub fn samples_alone() -> [usize; SAMPLES / 4] {
    std::array::from_fn(|n| 4 * n + n % 4)
}

/// The n-th of a number of points spread evenly over the unit disc: radius and angle
/// (Hammersley's points; the equal areas of rings of equal r²).
fn disc(n: usize, of: usize) -> (f64, f64) {
    let r = ((n as f64 + 0.5) / of as f64).sqrt();
    let turned = (n as u32).reverse_bits();
    (r, TAU * f64::from(turned) / 4_294_967_296.0)
}

/// Two unit vectors that stand upright on a unit vector and on each other
/// (Duff et al. 2017, "Building an orthonormal basis, revisited").
fn across(n: &Vector) -> [Vector; 2] {
    let sign = 1f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [
        Vector::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vector::new(b, sign + n.y * n.y * a, -n.y),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::scene::Body;
    use super::super::solid::Solid;
    use super::*;
    use crate::geometry::{ConvexPolyhedron, Pose};

    fn light() -> Light {
        Light::new(&[Vector::x(), Vector::z(), -Vector::y()], 10.0)
    }

    #[test]
    fn bases_stand_upright() {
        for n in [Vector::z(), -Vector::z(), Vector::new(0.3, -0.8, 0.1).normalize()] {
            let [a, b] = across(&n);
            let off = (a.cross(&b) - n).norm();
            assert!(off < 1e-15, "law: a × b = n, off by {off}");
        }
    }

    #[test]
    fn the_sky_is_weighted_with_the_cosine() {
        let light = light();
        // ∫ cos² over a half-space, weighted with cos / π, is a half; ∫ cos is 2/3.
        let mean =
            |f: &dyn Fn(&Vector) -> f64| light.sky.iter().map(f).sum::<f64>() / SAMPLES as f64;
        let (first, second) = (mean(&|s| s.z), mean(&|s| s.z * s.z));
        assert!((first - 2.0 / 3.0).abs() < 5e-3, "law: mean cosine 2/3, got {first}");
        assert!((second - 0.5).abs() < 1e-9, "law: mean square 1/2, got {second}");
        let sum: Vector = light.sky.iter().sum();
        assert!(sum.xy().norm() < 1.0, "law: to no side more than to another, got {sum}");
    }

    #[test]
    fn half_a_sky_is_seen_beside_a_wall() {
        let shape = ConvexPolyhedron::cuboid(Vector::new(0.1, 100.0, 100.0)).expect("a wall");
        let wall = Solid::new(&shape, &Pose::translation(0.05 + 1e-9, 0.0, 50.0));
        let scene = Scene::new(vec![Body::new(wall, Colour::GREY)], None);
        let mut sky = 0.0;
        let gather = |normal: Vector, samples: &[usize]| {
            light().gather(&scene, Vector::zeros(), &normal, u32::MAX, samples).sky
        };
        for pixel in 0..PIXELS {
            sky += gather(Vector::z(), &samples_of(pixel % SQUARE, pixel / SQUARE));
        }
        let sky = sky / PIXELS as f32;
        assert!((sky - 0.5).abs() < 0.05, "law: a wall hides half the sky, got {sky}");
        let away = gather(-Vector::x(), &samples_alone());
        assert_eq!(away, 1.0, "law: what looks away from the wall sees all of its sky");
    }
}
