//! From an engine's poses to a row of the results, by Pluvia's own exact check.

use std::sync::Arc;

use pluvia::{
    export::{Carrier, Scene},
    geometry::{Pose, Vector},
    grains::{Grain, GrainSet},
    measure::{mean_grain_height, overlap_statistics, pairs_within, touching_gap},
    specimen::{Specimen, SpecimenState},
    world::BodyState,
};
use serde::Serialize;

use super::{
    SceneName,
    engines::{Engine, Job, PeerResult, Sample},
    verdict::{meets_standard, rate_hz},
};

/// Simulated time in s below which poses tell more of the specimen than of the
/// engine, and heights nothing.
const ENOUGH: f64 = 0.1;
/// Simulated time in s of rest below which its second half is no rest yet.
const ENOUGH_REST: f64 = 1.0;
/// How far beyond a wall or below the floor, in m, a grain's centroid is lost.
const BEYOND: f64 = 0.01;
/// How far below the rim walls are taken to hold, in m: above, grains may
/// rightly go over it.
const RIM: f64 = 0.015;

/// One engine on one scene; null where something is not known.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    pub engine: String,
    pub version: Option<String>,
    pub scene: String,
    pub grains: usize,
    pub rate_hz: Option<f64>,
    pub iterations: Option<u32>,
    pub wall_s_per_simulated_s: Option<f64>,
    pub overlap_mean_percent: Option<f64>,
    pub overlap_p99_percent: Option<f64>,
    pub creep_um_per_s: Option<f64>,
    pub meets_standard: Option<bool>,
    pub peak_memory_mib: Option<f64>,
}

/// A row, and what must be said beside it.
pub struct Measured {
    pub row: Row,
    pub notes: Vec<String>,
}

/// Measures a result. `creep_at_rest` is what the same engine showed in the
/// scene `rest`, where it was run.
pub fn measure(
    engine: &Engine,
    name: SceneName,
    job: &Job,
    scene: &Scene,
    result: Result<PeerResult, String>,
    creep_at_rest: Option<f64>,
) -> Measured {
    let mut row = Row {
        engine: engine.name.to_owned(),
        version: None,
        scene: name.to_string(),
        grains: scene.grains.len(),
        rate_hz: Some(job.rate_hz).filter(|&rate| rate > 0.0),
        iterations: job.iterations,
        wall_s_per_simulated_s: None,
        overlap_mean_percent: None,
        overlap_p99_percent: None,
        creep_um_per_s: None,
        meets_standard: None,
        peak_memory_mib: None,
    };
    let mut notes = Vec::new();
    let result = match result {
        Ok(result) if result.poses.len() == scene.grains.len() && result.simulated_s > 0.0 => {
            result
        }
        Ok(result) => {
            let (poses, time) = (result.poses.len(), result.simulated_s);
            let what = format!("{poses} poses after {time} s are no result");
            return Measured { row, notes: vec![what] };
        }
        Err(why) => return Measured { row, notes: vec![why] },
    };
    row.version = Some(result.version.clone());
    row.rate_hz = Some(rate_hz(job.rate_hz, result.steps, result.simulated_s));
    row.wall_s_per_simulated_s = Some(result.wall_s / result.simulated_s);
    row.peak_memory_mib = Some(result.peak_memory_mib);
    if result.simulated_s < job.seconds - 1e-9 {
        notes.push(format!(
            "stopped after {:.0} s, having simulated {:.3e} of {} s",
            result.wall_s, result.simulated_s, job.seconds
        ));
    }
    if result.simulated_s < ENOUGH - 1e-9 {
        notes.push("too little simulated to measure overlap or numerical creep".to_owned());
        return Measured { row, notes };
    }
    let (specimen, kept) = specimen(scene, &result);
    let lost = scene.grains.len() - kept.len();
    if lost > 0 {
        // Poured grains may rightly go over the rim.
        let how = if name == SceneName::Pour { "spilled, " } else { "" };
        notes.push(format!(
            "{lost} grains {how}went through walls or floor, or have no place that is a number"
        ));
    }
    let overlap = overlap_statistics(
        &specimen,
        &pairs_within(&specimen, &kept, touching_gap(&specimen.grains)),
    );
    let (mean, p99) = (100.0 * overlap.mean, 100.0 * overlap.p99);
    row.overlap_mean_percent = Some(mean);
    row.overlap_p99_percent = Some(p99);
    notes.push(format!(
        "mean grain height {:.1} mm, largest overlap {:.1} %",
        1e3 * mean_grain_height(&specimen, &kept).unwrap_or(f64::NAN),
        100.0 * overlap.max
    ));
    if name == SceneName::Rest && result.simulated_s >= ENOUGH_REST - 1e-9 {
        row.creep_um_per_s = creep_um_per_s(&result.series, &kept);
    }
    let creep = if name == SceneName::Rest { row.creep_um_per_s } else { creep_at_rest };
    let must_stay = if name == SceneName::Pour { 0 } else { lost };
    row.meets_standard = meets_standard(must_stay, mean, p99, creep);
    Measured { row, notes }
}

/// The grains where the engine left them, and the numbers of those that are
/// still where grains can be.
fn specimen(scene: &Scene, result: &PeerResult) -> (Specimen, Vec<usize>) {
    let grains = scene.grains.iter().map(|g| Grain {
        shape: Arc::new(g.shape.clone()),
        pose_in_block: Pose::identity(),
        volume: g.volume_m3,
        mass: g.mass_kg,
        inertia: g.inertia_kg_m2,
        equivalent_diameter: g.shape.equivalent_diameter(),
        fraction: 0,
    });
    let grains: Vec<Grain> = grains.collect();
    let density = grains[0].mass / grains[0].volume;
    let mut state = SpecimenState::before_everything(grains.len());
    state.table_x = result.table_x_m;
    let room = Room::of(scene);
    let mut kept = Vec::new();
    for (n, (numbers, grain)) in result.poses.iter().zip(&mut state.bodies).enumerate() {
        let Some(pose) = pose(numbers) else { continue };
        grain.body = BodyState::at_rest(pose);
        if room.holds(&pose.translation.vector, result.table_x_m) {
            kept.push(n);
        }
    }
    let set = GrainSet { grains, blocks: Vec::new(), density, meshes: Vec::new() };
    (Specimen { grains: Arc::new(set), state }, kept)
}

fn pose(numbers: &[Option<f64>; 7]) -> Option<Pose> {
    let [x, y, z, i, j, k, w] = *numbers;
    let quaternion = nalgebra::Quaternion::new(w?, i?, j?, k?);
    let rotation = nalgebra::UnitQuaternion::try_new(quaternion, 1e-6)?;
    Some(Pose::from_parts(Vector::new(x?, y?, z?).into(), rotation))
}

/// Where grains can be, read off the walls that go with the table.
struct Room {
    radius: f64,
    rim: f64,
}

impl Room {
    fn of(scene: &Scene) -> Self {
        let walls = scene
            .apparatus
            .iter()
            .filter(|p| p.motion == Carrier::Table && p.name != "floor")
            .flat_map(|p| {
                let pose = p.pose();
                p.shape.vertices().iter().map(move |v| pose * v).collect::<Vec<_>>()
            });
        let (mut radius, mut rim) = (f64::INFINITY, 0.0_f64);
        for corner in walls {
            radius = radius.min((corner.x - scene.table.x_m).hypot(corner.y));
            rim = rim.max(corner.z);
        }
        Self { radius, rim }
    }

    fn holds(&self, at: &Vector, table_x: f64) -> bool {
        let beside = (at.x - table_x).hypot(at.y) > self.radius + BEYOND;
        at.z > -BEYOND && !(beside && at.z < self.rim - RIM)
    }
}

/// Speed in µm/s at which the mean of the grains in `kept` sinks in the second
/// half of the series, positive downwards (docs/accuracy.md).
fn creep_um_per_s(series: &[Sample], kept: &[usize]) -> Option<f64> {
    let (first, last) = (series.first()?, series.last()?);
    let half = f64::midpoint(first.time_s, last.time_s);
    let from = series.iter().find(|s| s.time_s >= half)?;
    let mean = |sample: &Sample| -> Option<f64> {
        let heights: Option<Vec<f64>> = kept.iter().map(|&n| *sample.z_m.get(n)?).collect();
        let heights = heights?;
        Some(heights.iter().sum::<f64>() / heights.len() as f64)
    };
    let duration = last.time_s - from.time_s;
    Some(1e6 * (mean(from)? - mean(last)?) / duration).filter(|c| c.is_finite())
}
