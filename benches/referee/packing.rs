//! Small packings: a few grains dropped into a box, by any engine.

use std::sync::Arc;

use pluvia::{
    geometry::{ConvexPolyhedron, Pose, Vector},
    grains::streams,
    scenario::EngineSettings,
    verify::grains,
    world::{
        Body, BodyId, BodyState, Contact, Material, Motion, PairCoefficients, PairTable, Snapshot,
        create,
    },
};
use serde_json::{Value, json};

const GRAVITY: f64 = 9.81;
/// Thickness of the box's floor and sides in m, where an engine needs one.
const WALL: f64 = 0.02;
/// Least distance in m between the spheres around grains before they fall.
const CLEARANCE: f64 = 1e-4;

/// What is poured into what.
#[derive(Debug, Clone, Copy)]
pub struct Recipe {
    /// Number of grains.
    pub grains: usize,
    /// Inner width of the box in m.
    pub width: f64,
    /// Friction coefficient of every pair, walls too.
    pub friction: f64,
    /// Coefficient of restitution of every pair.
    pub restitution: f64,
    /// Approach velocity in m/s below which nothing rebounds.
    pub restitution_threshold: f64,
    /// Gap in m up to which a contact point that bears nothing takes part in impacts.
    pub closed_gap: f64,
    /// Gap in m up to which such a point may be an impact itself.
    pub met_gap: f64,
}

/// How a pour ended.
pub struct Ended {
    /// Poses and velocities of the grains.
    pub states: Vec<BodyState>,
    /// Share of the loaded contact points that slide, as the engine has them;
    /// `None` where it names no impulses.
    pub sliding: Option<f64>,
}

/// The grains of a realisation where they begin to fall: turned at random, each
/// as low as the spheres around those before it allow.
pub fn start(recipe: &Recipe, seed: u64) -> Result<Vec<Body>, String> {
    let set = grains(recipe.grains, seed).map_err(|e| e.to_string())?;
    let mut placed: Vec<(Vector, f64)> = Vec::new();
    let mut bodies = Vec::new();
    for (n, grain) in set.grains.iter().enumerate() {
        let mut rng = streams::stream(seed, &format!("referee grain {n}"));
        let rotation = streams::rotation(&mut rng);
        let radius = grain.shape.radius_about_origin();
        let room = (recipe.width / 2.0 - radius - CLEARANCE).max(0.0);
        let mut at = Vector::new(
            room * (2.0 * streams::uniform(&mut rng) - 1.0),
            room * (2.0 * streams::uniform(&mut rng) - 1.0),
            radius + CLEARANCE,
        );
        for (other, other_radius) in &placed {
            let reach = radius + other_radius + CLEARANCE;
            let beside = (at.xy() - other.xy()).norm_squared();
            if beside < reach * reach {
                at.z = at.z.max(other.z + (reach * reach - beside).sqrt());
            }
        }
        placed.push((at, radius));
        bodies.push(Body {
            shape: grain.shape.clone(),
            motion: Motion::Free { mass: grain.mass, inertia: grain.inertia },
            material: Material::Grain,
            state: BodyState::at_rest(Pose::from_parts(at.into(), rotation)),
        });
    }
    Ok(bodies)
}

/// Floor and sides of the box as bodies that stand still, `height` m high.
fn walls(width: f64, height: f64) -> Result<Vec<Body>, String> {
    let wall = |sides: Vector, at: Vector| {
        let shape = ConvexPolyhedron::cuboid(sides).map_err(|e| e.to_string())?;
        Ok::<_, String>(Body {
            shape: Arc::new(shape),
            motion: Motion::Kinematic,
            material: Material::Wall,
            state: BodyState::at_rest(Pose::translation(at.x, at.y, at.z)),
        })
    };
    let across = width + 2.0 * WALL;
    let off = (width + WALL) / 2.0;
    let mut all =
        vec![wall(Vector::new(across, across, WALL), Vector::new(0.0, 0.0, -WALL / 2.0))?];
    for side in [-1.0, 1.0] {
        all.push(wall(
            Vector::new(WALL, across, height),
            Vector::new(side * off, 0.0, height / 2.0),
        )?);
        all.push(wall(
            Vector::new(across, WALL, height),
            Vector::new(0.0, side * off, height / 2.0),
        )?);
    }
    Ok(all)
}

/// Lets an engine pour grains for a time in s.
pub fn pour(
    recipe: &Recipe,
    grains: &[Body],
    settings: &EngineSettings,
    duration: f64,
) -> Result<Ended, String> {
    let told = |e: pluvia::world::WorldError| e.to_string();
    let settings = EngineSettings {
        restitution_velocity_threshold_m_per_s: recipe.restitution_threshold,
        ..settings.clone()
    };
    let pairs = PairTable::uniform(PairCoefficients {
        friction: recipe.friction,
        restitution: recipe.restitution,
    });
    let mut world = create(&settings, Vector::new(0.0, 0.0, -GRAVITY), &pairs).map_err(told)?;
    let highest = grains.iter().map(|b| b.state.pose.translation.z).fold(0.0, f64::max);
    for wall in walls(recipe.width, highest + 0.05)? {
        world.add(&wall).map_err(told)?;
    }
    let ids: Vec<BodyId> =
        grains.iter().map(|g| world.add(g)).collect::<Result<_, _>>().map_err(told)?;
    let steps = (duration / world.time_step()).round() as usize;
    for _ in 0..steps {
        world.step().map_err(told)?;
    }
    let mut snapshot = Snapshot::new();
    world.read(&mut snapshot);
    let states = ids
        .iter()
        .map(|id| snapshot[id.0 as usize].ok_or("a grain is gone"))
        .collect::<Result<_, _>>()?;
    let mut contacts = Vec::new();
    world.contacts(&mut contacts);
    Ok(Ended { states, sliding: sliding(&contacts, recipe.friction) })
}

fn sliding(contacts: &[Contact], friction: f64) -> Option<f64> {
    let loaded: Vec<_> = contacts.iter().filter(|c| c.impulse.dot(&c.normal) > 0.0).collect();
    let slides = |c: &&&Contact| {
        let normal = c.impulse.dot(&c.normal);
        (c.impulse - c.normal * normal).norm() > 0.999 * friction * normal
    };
    (!loaded.is_empty()).then(|| loaded.iter().filter(slides).count() as f64 / loaded.len() as f64)
}

/// The same packing as the referee's program reads it (docs/exchange.md, with walls as
/// planes).
pub fn as_json(recipe: &Recipe, grains: &[Body], states: &[BodyState]) -> Value {
    let list = |v: &Vector| json!([v.x, v.y, v.z]);
    let grains: Vec<Value> = grains
        .iter()
        .zip(states)
        .map(|(body, state)| {
            let (mass, inertia) = match body.motion {
                Motion::Free { mass, inertia } => (mass, inertia),
                Motion::Static
                | Motion::Kinematic
                | Motion::Pressed { .. }
                | Motion::Turned { .. } => (f64::INFINITY, Vector::repeat(f64::INFINITY)),
            };
            let vertices: Vec<Value> =
                body.shape.vertices().iter().map(|v| list(&v.coords)).collect();
            let q = state.pose.rotation.coords;
            json!({
                "vertices_m": vertices,
                "faces": body.shape.faces(),
                "mass_kg": mass,
                "inertia_kg_m2": list(&inertia),
                "position_m": list(&state.pose.translation.vector),
                "quaternion_xyzw": [q.x, q.y, q.z, q.w],
                "linear_velocity_m_per_s": list(&state.linear_velocity),
                "angular_velocity_rad_per_s": list(&state.angular_velocity),
            })
        })
        .collect();
    let half = recipe.width / 2.0;
    let materials = [Material::Grain, Material::Wall];
    let pairs: Vec<Value> = materials
        .iter()
        .map(|other| {
            json!({
                "between": [Material::Grain, other],
                "friction": recipe.friction,
                "restitution": recipe.restitution,
            })
        })
        .collect();
    json!({
        "grains": grains,
        "apparatus": [],
        "walls_m": [
            [0, 0, 1, 0], [1, 0, 0, -half], [-1, 0, 0, -half], [0, 1, 0, -half], [0, -1, 0, -half]
        ],
        "gravity_m_per_s2": [0, 0, -GRAVITY],
        "pairs": pairs,
        "restitution_threshold_m_per_s": recipe.restitution_threshold,
        "closed_gap_m": recipe.closed_gap,
        "met_gap_m": recipe.met_gap,
    })
}
