//! Pluvia's own worlds on a scene, in a process of their own.

use std::{sync::Arc, time::Instant};

use pluvia::{
    export::{Carrier, Scene},
    geometry::Pose,
    motion::TableMotion,
    record::{read_json, write_json},
    scenario::{Backend, EngineSettings},
    study::peak_memory_mib,
    world::{
        Body, BodyId, BodyState, Material, Motion, PairCoefficients, PairTable, Snapshot, World,
        create, info,
    },
};

use super::{
    engines::{PeerResult, Sample},
    handed,
};

/// First argument of a process that does this.
pub const CARRY: &str = "carry";

/// Interval of the heights in s, as in `series.csv`.
const SAMPLE: f64 = 0.08;

/// A scene in a world.
struct Stage {
    world: Box<dyn World + Send>,
    grains: Vec<BodyId>,
    /// With their poses where the table is in its middle.
    on_table: Vec<(BodyId, Pose)>,
}

/// Carries a scene on. Arguments: scene, result, rate in Hz, iterations,
/// simulated time in s, limit of wall time in s, engine settings as JSON, threads.
pub fn carry(args: &[String]) -> Result<(), String> {
    let [scene, result, rate, iterations, seconds, limit, settings, threads] = args else {
        return Err("eight arguments are needed".to_owned());
    };
    let number = |text: &String| text.parse::<f64>().map_err(|e| format!("{text}: {e}"));
    let (rate, seconds, limit) = (number(rate)?, number(seconds)?, number(limit)?);
    let iterations: u32 = iterations.parse().map_err(|e| format!("{iterations}: {e}"))?;
    let mut settings = handed::settings(settings, threads)?;
    settings.rate_hz = rate;
    match settings.backend {
        Backend::Bullet => {
            let substeps = settings.native.substeps(rate);
            settings.native.iterations = iterations.div_ceil(substeps).max(1);
        }
        Backend::Rapier => settings.rapier.substeps = iterations,
    }
    let path = std::path::Path::new(scene);
    let scene: Scene = read_json(path).map_err(|e| e.to_string())?;
    scene.check().map_err(|e| format!("{}: {e}", path.display()))?;
    let motion = scene.table.motion.map(TableMotion::from);
    let mut stage = Stage::of(&scene, &settings).map_err(|e| e.to_string())?;
    handed::check_threads(&settings, &stage.world.effective())?;

    let dt = stage.world.time_step();
    let last = (seconds / dt).round() as u64;
    let mut series = vec![stage.sample(0.0)];
    let (mut wall, mut next, mut x, mut steps) = (0.0, SAMPLE, scene.table.x_m, 0);
    while steps < last && wall < limit {
        let started = Instant::now();
        steps += 1;
        let time = steps as f64 * dt;
        if let Some(motion) = &motion {
            x = motion.displacement(time).x;
            stage.drive(x).map_err(|e| e.to_string())?;
        }
        stage.world.step().map_err(|e| e.to_string())?;
        wall += started.elapsed().as_secs_f64();
        if time >= next - dt / 2.0 || steps == last {
            next += SAMPLE;
            series.push(stage.sample(time));
        }
    }
    let version = info(settings.backend);
    let version = match settings.backend {
        Backend::Bullet => format!(
            "{} on {} {} {}",
            env!("CARGO_PKG_VERSION"),
            version.name,
            version.version,
            version.precision
        ),
        Backend::Rapier => format!("{} {}", version.version, version.precision),
    };
    let result_of = PeerResult {
        version,
        steps,
        simulated_s: steps as f64 * dt,
        wall_s: wall,
        peak_memory_mib: peak_memory_mib(),
        table_x_m: x,
        poses: stage.states().iter().map(pose_numbers).collect(),
        series,
    };
    write_json(std::path::Path::new(result), &result_of).map_err(|e| e.to_string())
}

fn pose_numbers(state: &BodyState) -> [Option<f64>; 7] {
    let (p, q) = (state.pose.translation.vector, state.pose.rotation.coords);
    [p.x, p.y, p.z, q.x, q.y, q.z, q.w].map(|number| Some(number).filter(|n| n.is_finite()))
}

impl Stage {
    fn of(scene: &Scene, settings: &EngineSettings) -> Result<Self, pluvia::world::WorldError> {
        let none = PairCoefficients { friction: 0.0, restitution: 0.0 };
        let mut pairs = PairTable::uniform(none);
        for pair in &scene.pairs {
            let (friction, restitution) = (pair.friction, pair.restitution);
            let value = PairCoefficients { friction, restitution };
            pairs.set(pair.between[0], pair.between[1], value);
        }
        let mut world = create(settings, scene.gravity_m_per_s2, &pairs)?;
        let (mut grains, mut on_table) = (Vec::new(), Vec::new());
        for piece in &scene.apparatus {
            let mut pose = piece.pose();
            let motion = match piece.motion {
                Carrier::Table | Carrier::Kinematic => Motion::Kinematic,
                Carrier::Fixed => Motion::Static,
            };
            let state = BodyState::at_rest(pose);
            let shape = Arc::new(piece.shape.clone());
            let id = world.add(&Body { shape, motion, material: piece.material, state })?;
            if piece.motion == Carrier::Table {
                pose.translation.vector.x -= scene.table.x_m;
                on_table.push((id, pose));
            }
        }
        if let Some(plate) = &scene.top_plate {
            world.add(&Body {
                shape: Arc::new(plate.shape.clone()),
                motion: Motion::Free { mass: plate.mass_kg, inertia: plate.inertia_kg_m2 },
                material: Material::Plate,
                state: (&plate.at).into(),
            })?;
        }
        for grain in &scene.grains {
            grains.push(world.add(&Body {
                shape: Arc::new(grain.shape.clone()),
                motion: Motion::Free { mass: grain.mass_kg, inertia: grain.inertia_kg_m2 },
                material: Material::Grain,
                state: (&grain.at).into(),
            })?);
        }
        Ok(Self { world, grains, on_table })
    }

    fn drive(&mut self, x: f64) -> Result<(), pluvia::world::WorldError> {
        for (id, middle) in &self.on_table {
            let mut pose = *middle;
            pose.translation.vector.x += x;
            self.world.drive(*id, &pose)?;
        }
        Ok(())
    }

    fn states(&self) -> Vec<BodyState> {
        let mut snapshot = Snapshot::new();
        self.world.read(&mut snapshot);
        let state = |id: &BodyId| snapshot[id.0 as usize].expect("grains are not removed");
        self.grains.iter().map(state).collect()
    }

    fn sample(&self, time_s: f64) -> Sample {
        let z_m = self.states().iter().map(|s| pose_numbers(s)[2]).collect();
        Sample { time_s, z_m }
    }
}
