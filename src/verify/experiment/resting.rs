//! Bodies that must lie still.

use super::packing::{FRICTION, Packing};
use super::*;

const SIDE: f64 = 0.01;

/// How far the bodies are at most from where they were at the end of the settling time: the
/// largest distance at any time up to the end is measured.
fn movement(y: &str, mut scene: Scene, ids: &[BodyId], settle: f64, duration: f64) -> Measured {
    scene.run(settle)?;
    let start = scene.states(ids)?;
    let curve = scene.sampled(duration, 400, |scene, _| {
        let now = scene.states(ids)?;
        let place = |state: &BodyState| state.pose.translation.vector;
        let moved = now.iter().zip(&start).map(|(a, b)| (place(a) - place(b)).norm());
        Ok((scene.time(), to_mm(largest(moved))))
    })?;
    let worst = largest(curve.iter().map(|point| point.1));
    Ok(steady(y, 0.0, "Engine", curve).got(worst))
}

/// A curve that should stay at a level.
fn steady(y: &str, level: f64, name: &str, curve: Points) -> Outcome {
    let mut outcome = Outcome::new("Time (s)", y);
    if let (Some(first), Some(last)) = (curve.first(), curve.last()) {
        outcome.law("Known solution", vec![(first.0, level), (last.0, level)]);
    }
    outcome.measured(name, curve);
    outcome
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
    let id = scene.add(&body);
    movement("Distance from where it came to rest (mm)", scene, &[id], settle, duration)
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
                let angle = TAU / 3.0 * index as f64;
                (0.006 * Vector::new(angle.cos(), angle.sin(), 0.0), 0.0)
            }
        };
        let rotation = UnitQuaternion::identity();
        let z = height - lowest(&grain.shape, &rotation);
        let pose = Pose::from_parts((at + Vector::z() * z).into(), rotation);
        ids.push(scene.add(&grain_body(grain, pose)));
    }
    movement("Largest distance from the place of rest (mm)", scene, &ids, settle, duration)
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
        for guide in walls_around(off, GUIDE, 0.1, height, Motion::Static)? {
            scene.add(&guide);
        }
    }
    let mut top = None;
    for n in 0..count {
        let at = Vector::new(0.0, 0.0, SIDE * (f64::from(n) + 0.5));
        top = Some(scene.add(&block(Vector::repeat(SIDE), at)?));
    }
    let top = top.ok_or_else(|| VerifyError::Setup("a column needs cubes".into()))?;
    let start = SIDE * (f64::from(count) - 0.5);
    let curve = scene.sampled(duration, 400, |scene, _| {
        let lost = start - scene.state(top)?.pose.translation.vector.z;
        Ok((scene.time(), to_mm(lost)))
    })?;
    let lost = at_end(&curve);
    Ok(steady("Height lost by the uppermost cube (mm)", 0.0, "Engine", curve).got(lost))
}

/// Vertical impulses on the floor over the weight of all grains; the box's
/// sides are frictionless and carry nothing.
pub(super) fn floor_force(bench: &Bench, count: usize, settle: f64, duration: f64) -> Measured {
    let mut packing = Packing::new(bench, count, 0, 0.0)?;
    packing.scene.run(settle)?;
    let weight = packing.mass() * GRAVITY;
    let dt = packing.scene.time_step();
    let (mut total, mut curve) = (0.0, Vec::new());
    for n in 1..=packing.scene.steps_in(duration) {
        packing.scene.step()?;
        total -= packing.scene.impulse_on(packing.floor).z;
        curve.push((packing.scene.time(), total / (n as f64 * dt * weight)));
    }
    let force = at_end(&curve);
    Ok(steady("Force on the floor / weight", 1.0, "Mean so far", curve).got(force))
}
