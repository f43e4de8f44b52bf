//! Piles whose angle is known.

use rand::RngExt;

use super::super::testing::{assert_near, cube, near, random, specimen_of};
use super::*;
use crate::geometry::{ConvexPolyhedron, Point, Pose, Vector};
use crate::specimen::FixedGrain;

const CELL: f64 = 1e-3;
const GRAIN: f64 = 0.01;

/// A surface over a base of 300 mm in diameter.
fn surface(height: impl Fn(f64, f64) -> f64) -> PileSurface {
    let mut cells = vec![];
    for i in -150..150 {
        for j in -150..150 {
            let (x, y) = ((f64::from(i) + 0.5) * CELL, (f64::from(j) + 0.5) * CELL);
            if x.hypot(y) <= 0.15 {
                cells.push(Cell { x, y, height: height(x, y).max(0.0) });
            }
        }
    }
    PileSurface { cells, cell: CELL, grain_size: GRAIN }
}

/// A circular cone of a slope in degrees and a height in m about an axis.
fn cone(degrees: f64, height: f64, axis: (f64, f64)) -> PileSurface {
    let slope = degrees.to_radians().tan();
    surface(|x, y| height - slope * (x - axis.0).hypot(y - axis.1))
}

/// Law: a cone h = H − r tan φ has the angle φ in every sector, meets the base
/// at H / tan φ, and its volume and height give φ, too.
#[test]
fn cones_have_their_angle() {
    for degrees in [20.0, 30.0, 38.4, 45.0] {
        for axis in [(0.0, 0.0), (0.0083, -0.0051)] {
            let height = 0.045;
            let got = cone(degrees, height, axis).repose().expect("a pile");
            assert_near("angle, °", degrees, got.angle.to_degrees(), 0.05);
            assert_near("scatter of a cone, °", 0.0, got.standard_deviation.to_degrees(), 0.3);
            let (low, high) = got.confidence;
            assert!(low <= got.angle && got.angle <= high, "{low} to {high} holds {}", got.angle);
            // The highest cell lies up to 0.7 mm from the tip.
            assert_near("height, m", height, got.height, 0.8e-3);
            assert_near("angle by volume, °", degrees, got.by_volume.to_degrees(), 1.2);
            let toe = height / degrees.to_radians().tan();
            assert_near("toe, m", toe, got.base_radius, 0.3e-3);
            assert_near("axis, m", axis.0, got.axis.0, 0.1e-3);
            assert_near("axis, m", axis.1, got.axis.1, 0.1e-3);
        }
    }
    // The other direction: a degree more or less is seen, by both measures.
    let got = cone(38.4, 0.06, (0.0, 0.0)).repose().expect("a pile");
    for other in [37.9, 38.9] {
        assert!(near("angle", other, got.angle.to_degrees(), 0.05).is_err(), "not {other}°");
    }
    for other in [35.0, 42.0] {
        assert!(near("volume", other, got.by_volume.to_degrees(), 1.2).is_err(), "not {other}°");
    }
}

/// Law: along the azimuth θ an elliptical cone falls by H √((cos θ/a)² + (sin θ/b)²).
#[test]
fn an_elliptical_pile_differs_with_azimuth() {
    let (height, a, b): (f64, f64, f64) = (0.06, 0.1, 0.07);
    let pile = surface(|x, y| height * (1.0 - (x / a).hypot(y / b)));
    let got = pile.repose().expect("a pile");
    let expected =
        |azimuth: f64| (height * (azimuth.cos() / a).hypot(azimuth.sin() / b)).atan().to_degrees();
    for s in &got.sectors {
        let angle = s.angle.expect("a flank").to_degrees();
        assert_near(&format!("angle at {}", s.azimuth), expected(s.azimuth), angle, 0.35);
    }
    let angles: Vec<f64> = got.sectors.iter().map(|s| expected(s.azimuth)).collect();
    let slopes: Vec<f64> = angles.iter().map(|a| a.to_radians().tan()).collect();
    let mean = statistics::mean(&slopes).expect("slopes").atan().to_degrees();
    let scatter = statistics::sample_standard_deviation(&angles).expect("angles");
    assert_near("mean angle, °", mean, got.angle.to_degrees(), 0.1);
    assert_near("scatter, °", scatter, got.standard_deviation.to_degrees(), 0.1);
}

/// Law: the flank of a cone whose tip is cut off keeps its slope; the cone of
/// its volume and height is flatter.
#[test]
fn a_truncated_cone_keeps_its_flank() {
    let (degrees, height) = (38.4, 0.05);
    let slope = f64::to_radians(degrees).tan();
    let pile = surface(|x, y| (0.075 - slope * x.hypot(y)).min(height));
    let got = pile.repose().expect("a pile");
    assert_near("angle of the flank, °", degrees, got.angle.to_degrees(), 0.05);
    let by_volume = got.by_volume.to_degrees();
    assert!(by_volume < degrees - 3.0, "expected well below {degrees}°, got {by_volume}°");
}

/// Law: a steep upper and a flat lower half have the slope of neither.
#[test]
fn a_broken_flank_is_seen_as_such() {
    let pile = surface(|x, y| {
        let r = x.hypot(y);
        if r < 0.04 { 0.06 - r } else { (0.02 - 0.4 * (r - 0.04)).max(0.0) }
    });
    let angle = pile.repose().expect("a pile").angle.to_degrees();
    assert!(angle > 25.0 && angle < 44.0, "between 21.8° and 45°, got {angle}°");
}

/// Patches of a grain's size, up or down at random, on a cone.
fn rough_cone(degrees: f64, seed: u64) -> PileSurface {
    let mut rng = random(seed);
    let bumps: Vec<f64> = (0..40 * 40).map(|_| rng.random_range(-0.005..0.005)).collect();
    let shift = rng.random_range(0.0..GRAIN);
    let slope = degrees.to_radians().tan();
    surface(|x, y| {
        let patch = |v: f64| ((v + 0.2 + shift) / GRAIN) as usize % 40;
        let smooth = 0.06 - slope * x.hypot(y);
        if smooth > 0.0 { smooth + bumps[patch(x) * 40 + patch(y)] } else { 0.0 }
    })
}

/// Law: about 95 of 100 intervals hold the true angle. Sectors taken as
/// independent would hold it less often, because neighbours share grains.
#[test]
fn confidence_intervals_hold_the_truth_as_often_as_they_say() {
    let (truth, piles) = (38.4, 100);
    let (mut held, mut held_by_sectors, mut errors) = (0, 0, vec![]);
    for seed in 0..piles {
        let got = rough_cone(truth, seed).repose().expect("a pile");
        let (low, high) = (got.confidence.0.to_degrees(), got.confidence.1.to_degrees());
        held += usize::from(low <= truth && truth <= high);
        let half = 2.03 * got.standard_deviation.to_degrees() / (SECTORS as f64).sqrt();
        held_by_sectors += usize::from((got.angle.to_degrees() - truth).abs() <= half);
        errors.push(got.angle.to_degrees() - truth);
    }
    let bias = statistics::mean(&errors).expect("errors");
    assert_near("mean error over 100 rough cones, °", 0.0, bias, 0.35);
    // Binomial: 95 % of 100 with 3.5 standard deviations downwards.
    assert!(held >= 87, "expected about 95 of 100 intervals to hold {truth}°, got {held}");
    assert!(held_by_sectors < held, "by sectors {held_by_sectors}, by batches {held}");
}

#[test]
fn what_is_no_pile_has_no_angle() {
    let says = |surface: &PileSurface, fault: &str| {
        let got = surface.repose();
        assert!(got.as_ref().is_err_and(|why| why.0.contains(fault)), "{fault}: {got:?}");
    };
    says(&surface(|_, _| 0.0), "no grain");
    let mut rng = random(5);
    let bumps: Vec<f64> = (0..40 * 40).map(|_| rng.random_range(0.0..0.012)).collect();
    let patch = |v: f64| ((v + 0.2) / GRAIN) as usize % 40;
    let layer = surface(|x, y| bumps[patch(x) * 40 + patch(y)]);
    says(&layer, "mm high, a pile is at least 30.0 mm, 3 mean grains");
    // Three mean grains are enough, a hair less is not.
    assert!(cone(38.4, 0.031, (0.0, 0.0)).repose().is_ok(), "3.1 grains high");
    assert!(cone(38.4, 0.0295, (0.0, 0.0)).repose().is_err(), "2.95 grains high");
    // Upright walls, and a bowl that rises outwards.
    let block = surface(|x, y| if x.hypot(y) < 0.08 { 0.05 } else { 0.0 });
    says(&block, "only 0 of 36 sectors");
    let bowl = surface(|x, y| 0.5 * x.hypot(y));
    says(&bowl, "of 36 sectors");
    says(&PileSurface { cells: vec![], cell: CELL, grain_size: GRAIN }, "no grain");
    says(&surface(|x, y| if x.hypot(y) < 0.08 { 0.012 } else { 0.0 }), "is 12.0 mm high");
}

/// A pointed cone of many sides with its base at z = 0.
fn solid_cone(radius: f64, height: f64) -> ConvexPolyhedron {
    let n = 180;
    let mut vertices = vec![Point::new(0.0, 0.0, height)];
    vertices.extend((0..n).map(|i| {
        let turn = TAU * f64::from(i) / f64::from(n);
        Point::new(radius * turn.cos(), radius * turn.sin(), 0.0)
    }));
    let mut faces: Vec<Vec<u32>> = (0..n).map(|i| vec![0, 1 + i, 1 + (i + 1) % n]).collect();
    faces.push((1..=n).rev().collect());
    ConvexPolyhedron::new(vertices, faces).expect("a cone")
}

/// Law: heights are above the mean height of the base, and the base is none of the pile.
#[test]
fn the_surface_of_a_specimen_stands_on_its_base() {
    let (radius, height) = (0.08, 0.06);
    let at = |z| Pose::translation(0.0, 0.0, z);
    let slab = ConvexPolyhedron::cuboid(Vector::new(0.6, 0.6, 0.02)).expect("a slab");
    for level in [0.0, 0.01] {
        let mut specimen =
            specimen_of(vec![(solid_cone(radius, height), at(level)), (slab.clone(), at(-1.0))]);
        assert_eq!(pile_surface(&specimen).expect("measured"), None, "no base, no pile");
        // The slab is no grain of the pile but one fixed to the base.
        specimen.state.bodies[1].fate = crate::specimen::Fate::Waiting;
        let fixed = FixedGrain { grain: 1, pose: specimen.state.bodies[1].body.pose };
        let fixed = FixedGrain { pose: at(1.0) * fixed.pose, ..fixed };
        let fixed_grains = if level > 0.0 { vec![fixed] } else { vec![] };
        specimen.state.base = Some(Base { radius: 0.12, friction: None, fixed_grains });
        assert_near("level of the base", level, base_level(&specimen).expect("a level"), 1e-12);
        let pile = pile_surface(&specimen).expect("measured").expect("a base");
        let pile = PileSurface { grain_size: GRAIN, ..pile }.repose().expect("a pile");
        let expected = (height / radius).atan().to_degrees();
        assert_near("angle, °", expected, pile.angle.to_degrees(), 0.1);
        assert_near("height, m", height, pile.height, 0.8e-3);
        let volume = PI * radius * radius * height / 3.0;
        assert_near("volume, m³", volume, pile.volume, 0.01 * volume);
        let top = pile_top(&specimen).expect("a top");
        assert_near("top above z = 0", height + level, top, 1e-9);
    }
}

#[test]
fn a_falling_grain_is_no_part_of_the_pile() {
    let at = |z| (cube(0.01), Pose::translation(0.0, 0.0, z));
    let mut specimen = specimen_of(vec![at(0.005), at(0.1)]);
    assert_near("both lie", 0.105, pile_top(&specimen).expect("a top"), 1e-12);
    specimen.state.bodies[1].body.linear_velocity.z = -0.3;
    assert_near("one falls", 0.01, pile_top(&specimen).expect("a top"), 1e-12);
    specimen.state.bodies[0].fate = crate::specimen::Fate::Spilled;
    assert_eq!(pile_top(&specimen), None, "nothing lies");
}
