//! Bodies that must lie still.

use super::*;
use crate::verify::experiment::packing::Packing;

/// Friction of the gravel (paper, section 4).
const FRICTION: f64 = 0.793;
const SIDE: f64 = 0.01;

/// Largest distance in m that any of the bodies has from where it was at the
/// end of the settling time, at any time up to the end; with the curve in mm.
fn movement(
    scene: &mut Scene,
    ids: &[BodyId],
    settle: f64,
    duration: f64,
) -> Result<(f64, Vec<(f64, f64)>), VerifyError> {
    scene.run(settle)?;
    let start = scene.states(ids)?;
    let steps = scene.steps_in(duration);
    let (mut curve, mut worst) = (Vec::new(), 0.0_f64);
    for n in 1..=steps {
        scene.step()?;
        if n % (steps / 400).max(1) != 0 && n != steps {
            continue;
        }
        let now = scene.states(ids)?;
        let furthest = now
            .iter()
            .zip(&start)
            .map(|(a, b)| (a.pose.translation.vector - b.pose.translation.vector).norm())
            .fold(0.0_f64, f64::max);
        worst = worst.max(furthest);
        curve.push((scene.time(), to_mm(furthest)));
    }
    Ok((worst, curve))
}

fn still(outcome: &mut Outcome, curve: Vec<(f64, f64)>) {
    if let (Some(first), Some(last)) = (curve.first(), curve.last()) {
        outcome.law("Law", vec![(first.0, 0.0), (last.0, 0.0)]);
    }
    outcome.measured("Engine", curve);
}

pub(super) fn rests(bench: &Bench, body: RestingBody, settle: f64, duration: f64) -> Measured {
    let mut scene = on_floor(bench, 0.1, FRICTION)?;
    let body = match body {
        RestingBody::Cube => block(Vector::repeat(SIDE), Vector::new(0.0, 0.0, SIDE / 2.0))?,
        RestingBody::Grain => {
            let grain = &grains(20, 3)?.grains[0];
            let rotation = UnitQuaternion::from_euler_angles(0.3, 0.2, 0.1);
            let height = -lowest(&grain.shape, &rotation);
            grain_body(grain, Pose::from_parts(Vector::new(0.0, 0.0, height).into(), rotation))
        }
    };
    let id = scene.add(&body)?;
    let (moved, curve) = movement(&mut scene, &[id], settle, duration)?;
    let mut outcome = Outcome::new("Time (s)", "Distance from where it came to rest (mm)");
    still(&mut outcome, curve);
    Ok(outcome.got(to_mm(moved)))
}

pub(super) fn grain_on_three(bench: &Bench, settle: f64, duration: f64) -> Measured {
    let set = grains(20, 3)?;
    let mut scene = on_floor(bench, 0.1, FRICTION)?;
    let mut ids = Vec::new();
    for (index, grain) in set.grains.iter().take(4).enumerate() {
        // Three around the middle, close to each other; the fourth above them.
        let (at, height) = match index {
            3 => (Vector::zeros(), 0.02),
            _ => {
                let angle = std::f64::consts::TAU / 3.0 * index as f64;
                (0.006 * Vector::new(angle.cos(), angle.sin(), 0.0), 0.0)
            }
        };
        let rotation = UnitQuaternion::identity();
        let z = height - lowest(&grain.shape, &rotation);
        let pose = Pose::from_parts((at + Vector::z() * z).into(), rotation);
        ids.push(scene.add(&grain_body(grain, pose))?);
    }
    let (moved, curve) = movement(&mut scene, &ids, settle, duration)?;
    let mut outcome = Outcome::new("Time (s)", "Largest distance from the place of rest (mm)");
    still(&mut outcome, curve);
    Ok(outcome.got(to_mm(moved)))
}

/// Cubes set on top of each other; with `guided` between four frictionless
/// walls a tenth of a millimetre away.
pub(super) fn cubes(bench: &Bench, count: u32, guided: bool, duration: f64) -> Measured {
    const GUIDE_GAP: f64 = 1e-4;
    const GUIDE: f64 = 0.01;
    let friction = if guided { 0.0 } else { FRICTION };
    let mut scene = on_floor(bench, 0.1, friction)?;
    if guided {
        let height = SIDE * f64::from(count + 2);
        let off = SIDE / 2.0 + GUIDE_GAP + GUIDE / 2.0;
        for side in [-1.0, 1.0] {
            for (sides, at) in [
                (Vector::new(GUIDE, 0.1, height), Vector::new(side * off, 0.0, height / 2.0)),
                (Vector::new(0.1, GUIDE, height), Vector::new(0.0, side * off, height / 2.0)),
            ] {
                scene.add(&wall(sides, at, Motion::Static)?)?;
            }
        }
    }
    let mut top = None;
    for n in 0..count {
        let at = Vector::new(0.0, 0.0, SIDE * (f64::from(n) + 0.5));
        top = Some(scene.add(&block(Vector::repeat(SIDE), at)?)?);
    }
    let top = top.ok_or_else(|| VerifyError::Setup("a column needs cubes".into()))?;
    let start = SIDE * (f64::from(count) - 0.5);
    let steps = scene.steps_in(duration);
    let (mut curve, mut lost) = (Vec::new(), 0.0);
    for n in 1..=steps {
        scene.step()?;
        if n % (steps / 400).max(1) == 0 || n == steps {
            lost = start - scene.state(top)?.pose.translation.vector.z;
            curve.push((scene.time(), to_mm(lost)));
        }
    }
    let mut outcome = Outcome::new("Time (s)", "Height lost by the uppermost cube (mm)");
    still(&mut outcome, curve);
    Ok(outcome.got(to_mm(lost)))
}

/// Vertical impulses on the floor over the weight of all grains; the box's
/// sides are frictionless and carry nothing.
pub(super) fn floor_force(bench: &Bench, count: usize, settle: f64, duration: f64) -> Measured {
    let mut packing = Packing::new(bench, count, 0, 0.0)?;
    packing.scene.run(settle)?;
    let weight = packing.mass() * GRAVITY;
    let dt = packing.scene.time_step();
    let steps = packing.scene.steps_in(duration);
    let mut outcome = Outcome::new("Time (s)", "Force on the floor / weight");
    let (mut total, mut curve) = (0.0, Vec::new());
    for n in 1..=steps {
        packing.scene.step()?;
        total -= packing.scene.impulse_on(packing.floor).z;
        curve.push((packing.scene.time(), total / (n as f64 * dt * weight)));
    }
    if let (Some(first), Some(last)) = (curve.first(), curve.last()) {
        outcome.law("Law", vec![(first.0, 1.0), (last.0, 1.0)]);
    }
    outcome.measured("Mean so far", curve);
    Ok(outcome.got(total / (steps as f64 * dt * weight)))
}
