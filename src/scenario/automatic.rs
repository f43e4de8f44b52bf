//! Values that follow from the grains where nobody typed them.
//!
//! What is left out of a scenario and depends on the size of the grains is filled in
//! here, before anything is checked: for the paper's gravel every value is its default,
//! for other grains that default times the law of [`crate::scale`]. A value that is typed
//! is taken as it is.

use std::f64::consts::PI;

use serde_json::{Map, Number, Value};

use super::{
    Backend, ContactPath, CylinderSpec, EngineSettings, Fault, FunnelSpec, GrainsSpec,
    ManifoldSettings, MeshGrains, RapierSettings, Scenario, SettleSpec, SievedGrains, TopPlateSpec,
    accessors::field,
    stages::{drop_height, feed_rate, spout_diameter},
    validate::{fault, least_rate_hz, short},
};
use crate::scale::{GrainSizes, Law, Scale, SieveMass};
use crate::units::{from_g, from_mm, to_mm};

/// What of the grains the values follow from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grading {
    /// Sizes by sieves.
    pub sizes: GrainSizes,
    /// Density of the solids in kg/m³.
    pub density: f64,
    /// Volume of the solids in m³.
    pub solids: f64,
}

/// Solids of the paper in m³ (paper, section 3: 2343 g of 2673.9 kg/m³).
fn paper_solids() -> f64 {
    from_g(2343.0) / Scale::PAPER.density
}

/// A load on a specimen in grain sizes of solid weight up to which the default stiffness
/// holds: the paper's specimen and plate press with 8.
const STRESS_OF_DEFAULT: f64 = 10.0;

/// Least diameter and height of a cylinder in sizes of the largest grains.
const CYLINDER_GRAINS: f64 = 4.0;

/// Opening of the funnel in sizes of the largest grains, and at most in cylinder
/// diameters.
const OPENING_GRAINS: f64 = 5.0;
const OPENING_OF_CYLINDER: f64 = 0.9;

impl Grading {
    /// Of grains by a sieve table; `None` where the table has no sizes.
    pub fn of_table(sieved: &SievedGrains) -> Option<Self> {
        let fractions: Vec<SieveMass> = sieved
            .sieve_table
            .iter()
            .map(|f| SieveMass {
                passing: from_mm(f.passing_mm),
                retained: from_mm(f.retained_mm),
                mass: f.mass_percent,
            })
            .collect();
        let solids = from_g(sieved.total_mass_g) / sieved.density_kg_per_m3;
        let sound = sieved.density_kg_per_m3 > 0.0 && solids > 0.0 && solids.is_finite();
        let sizes = GrainSizes::of(&fractions).filter(|_| sound)?;
        Some(Self { sizes, density: sieved.density_kg_per_m3, solids })
    }

    /// Of the `grains` of a scenario's JSON that has a sieve table.
    pub(super) fn of_json(grains: &Value) -> Option<Self> {
        let sieved: Option<SievedGrains> = serde::Deserialize::deserialize(grains).ok();
        let of_meshes = || -> Option<SievedGrains> {
            let meshes: MeshGrains = serde::Deserialize::deserialize(grains).ok()?;
            meshes.as_sieved()
        };
        Self::of_table(&sieved.or_else(of_meshes)?)
    }

    fn scale(&self, gravity: f64) -> Scale {
        Scale { sizes: self.sizes, density: self.density, gravity }
    }
}

/// Fills in what is left out of a scenario's JSON and follows from its grains.
pub(super) fn fill(value: &mut Value, grading: &Grading) {
    let gravity = match value.get("gravity_m_per_s2") {
        None => super::default_gravity(),
        Some(gravity) => gravity.as_f64().unwrap_or(f64::NAN),
    };
    if !(gravity > 0.0) || !value.is_object() {
        return;
    }
    let scale = grading.scale(gravity);
    fill_apparatus(value, grading, &scale);
    fill_stages(value, &scale);
    for (path, law, default) in fields() {
        put(value, path, default, law.factor(&scale));
    }
    let stiffness = stiffness(value, grading, &scale);
    let default = ManifoldSettings::default().contact_stiffness_n_per_m;
    put(value, STIFFNESS, default, stiffness / default);
    let default = EngineSettings::default().rate_hz;
    let rate = default * Law::Rate.factor(&scale);
    let rate = least_rate_hz(value).map_or(rate, |least| rate.max(least.ceil()));
    put(value, "engine.rate_hz", default, rate / default);
}

const STIFFNESS: &str = "engine.manifold.contact_stiffness_n_per_m";

/// Fields that are their default times the factor of a law.
fn fields() -> [(&'static str, Law, f64); 16] {
    let engine = EngineSettings::default();
    let (manifold, rapier) = (ManifoldSettings::default(), RapierSettings::default());
    let settle = SettleSpec::default();
    [
        ("engine.grain_size_mm", Law::Fine, engine.grain_size_mm),
        ("engine.length_scale", Law::PerLength, engine.length_scale),
        ("engine.contact_threshold_mm", Law::Fine, engine.contact_threshold_mm),
        (
            "engine.restitution_velocity_threshold_m_per_s",
            Law::Speed,
            engine.restitution_velocity_threshold_m_per_s,
        ),
        ("engine.manifold.substep_rate_hz", Law::Rate, manifold.substep_rate_hz),
        ("engine.manifold.push_out_speed_m_per_s", Law::Speed, manifold.push_out_speed_m_per_s),
        ("engine.rapier.contact_frequency_hz", Law::Rate, rapier.contact_frequency_hz),
        ("engine.rapier.wall_contact_frequency_hz", Law::Rate, rapier.wall_contact_frequency_hz),
        ("engine.rapier.engine_unit_mm", Law::Fine, rapier.engine_unit_mm),
        ("engine.rapier.prediction_mm", Law::Fine, rapier.prediction_mm),
        ("engine.rapier.corrective_speed_m_per_s", Law::Speed, rapier.corrective_speed_m_per_s),
        ("engine.rapier.recycling_distance_mm", Law::Fine, rapier.recycling_distance_mm),
        ("settle.rms_speed_mm_per_s", Law::Speed, settle.rms_speed_mm_per_s),
        ("settle.largest_speed_mm_per_s", Law::Speed, settle.largest_speed_mm_per_s),
        ("settle.hold_s", Law::Time, settle.hold_s),
        (
            "apparatus.cylinder.wall_thickness_mm",
            Law::Coarse,
            CylinderSpec::default().wall_thickness_mm,
        ),
    ]
}

/// Funnel, cylinder and plate have the paper's proportions for the volume of the solids;
/// what is typed of the cylinder is kept to. The funnel's opening follows the grains.
fn fill_apparatus(value: &mut Value, grading: &Grading, scale: &Scale) {
    let (cylinder, funnel, plate) =
        (CylinderSpec::default(), FunnelSpec::default(), TopPlateSpec::default());
    let more = grading.solids / paper_solids();
    let wider = more.cbrt();
    let mut length = |path: &str, default: f64, factor: f64| {
        let factor = if factor == 1.0 { factor } else { rounded(default * factor, 4) / default };
        put(value, path, default, factor);
        number_at(value, path).unwrap_or(default)
    };
    let least = CYLINDER_GRAINS * to_mm(grading.sizes.largest);
    let factor = wider.max(least / cylinder.inner_diameter_mm);
    let diameter =
        length("apparatus.cylinder.inner_diameter_mm", cylinder.inner_diameter_mm, factor);
    let across = diameter / cylinder.inner_diameter_mm;
    let factor = (more / across.powi(2)).max(least / cylinder.height_mm);
    length("apparatus.cylinder.height_mm", cylinder.height_mm, factor);
    let opening = OPENING_GRAINS * to_mm(grading.sizes.largest);
    let opening = opening.min(OPENING_OF_CYLINDER * diameter) / funnel.opening_diameter_mm;
    length("apparatus.funnel.opening_diameter_mm", funnel.opening_diameter_mm, opening);
    let factor = wider.max(across);
    length("apparatus.funnel.top_diameter_mm", funnel.top_diameter_mm, factor);
    let coarser = Law::Coarse.factor(scale);
    length("apparatus.funnel.wall_thickness_mm", funnel.wall_thickness_mm, coarser);
    length("apparatus.top_plate.diameter_mm", plate.diameter_mm, across);
    length("apparatus.top_plate.thickness_mm", plate.thickness_mm, across);
    let heavier = across.powi(3) * grading.density / Scale::PAPER.density;
    length("apparatus.top_plate.mass_g", plate.mass_g, heavier);
}

fn fill_stages(value: &mut Value, scale: &Scale) {
    let stages = value.get_mut("stages").and_then(Value::as_array_mut);
    for stage in stages.into_iter().flatten() {
        if stage["stage"] != "slow_pluviation" {
            continue;
        }
        for (name, law, default) in [
            ("feed_rate_grains_per_s", Law::Rate, feed_rate()),
            ("drop_height_mm", Law::Coarse, drop_height()),
            ("spout_diameter_mm", Law::Coarse, spout_diameter()),
        ] {
            put(stage, name, default, law.factor(scale));
        }
    }
}

/// Stiffness of a contact point in N/m, to two digits: that of the law, and so much more as
/// the largest stress exceeds what the default is for.
fn stiffness(value: &Value, grading: &Grading, scale: &Scale) -> f64 {
    let default = ManifoldSettings::default().contact_stiffness_n_per_m;
    let light = scale.density * scale.gravity * STRESS_OF_DEFAULT * scale.sizes.median;
    let heavier = (largest_stress(value, grading, scale.gravity) / light).max(1.0);
    rounded(default * Law::Stiffness.factor(scale) * heavier, 2)
}

/// Largest stress in Pa under weight and plate, arching left out: everything rests on the
/// floor of the cylinder, or of the pile.
pub(super) fn largest_stress(value: &Value, grading: &Grading, gravity: f64) -> f64 {
    let number = |path: &str, default: f64| number_at(value, path).unwrap_or(default);
    let area = |diameter_mm: f64| PI / 4.0 * from_mm(diameter_mm).powi(2);
    let stages = || value["stages"].as_array().into_iter().flatten();
    let base = stages()
        .filter(|s| s["stage"] == "slow_pluviation")
        .find_map(|s| s["base_diameter_mm"].as_f64());
    let cylinder =
        number("apparatus.cylinder.inner_diameter_mm", CylinderSpec::default().inner_diameter_mm);
    let weight = grading.density * grading.solids * gravity / area(base.unwrap_or(cylinder));
    if !stages().any(|s| s["stage"] == "place_top_plate") {
        return weight;
    }
    let plate = TopPlateSpec::default();
    let mass = from_g(number("apparatus.top_plate.mass_g", plate.mass_g));
    weight + mass * gravity / area(number("apparatus.top_plate.diameter_mm", plate.diameter_mm))
}

/// Sets a field that is left out to its default times a factor; nothing where that is the
/// default, or where something else stands in the way.
fn put(value: &mut Value, path: &str, default: f64, factor: f64) {
    let Some(number) = Number::from_f64(default * factor).filter(|_| factor != 1.0) else { return };
    let (parents, name) = path.rsplit_once('.').unwrap_or(("", path));
    let mut at = value;
    for step in parents.split('.').filter(|step| !step.is_empty()) {
        let Some(object) = at.as_object_mut() else { return };
        at = object.entry(step).or_insert_with(|| Value::Object(Map::new()));
    }
    if let Some(object) = at.as_object_mut() {
        object.entry(name).or_insert(Value::Number(number));
    }
}

fn number_at(value: &Value, path: &str) -> Option<f64> {
    field(value, &format!("/{}", path.replace('.', "/"))).as_f64()
}

/// A number to so many significant digits.
fn rounded(value: f64, digits: usize) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return value;
    }
    // Through its decimal notation, whose last bit is right.
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// A typed value is unusual when it is off from the automatic one by more than this factor.
const UNUSUAL: f64 = 4.0;

/// Overlap at the 99th percentile in multiples of σ d₅₀ / k: 2.2 in a specimen of 364 grains
/// with 5, 10 and 20 kN/m (docs/accuracy.md).
const OVERLAP_OF_STRESS: f64 = 2.2;

/// Largest overlap of the accuracy standard at the 99th percentile.
const OVERLAP_ALLOWED: f64 = 0.03;

/// Void ratio of a very loose specimen: more than the cylinder holds then may go over its rim.
const LOOSE: f64 = 1.1;

/// Opening of a funnel in median grain sizes below which it jams now and then.
const JAMS_BELOW: f64 = 5.0;

/// What is typed in a scenario, of which `value` is the JSON, and does not suit its grains.
pub(super) fn unusual(scenario: &Scenario, value: &Value) -> Vec<Fault> {
    let grading = match &scenario.grains {
        GrainsSpec::Sieved(sieved) => Grading::of_table(sieved),
        GrainsSpec::Meshes(meshes) => meshes.as_sieved().and_then(|s| Grading::of_table(&s)),
        GrainsSpec::File(_) => None,
    };
    let scale = scenario.scale();
    let mut found = Vec::new();
    unusual_engine(scenario, &scale, &mut found);
    if let Some(grading) = grading {
        unusual_load(scenario, value, &grading, &scale, &mut found);
        unusual_apparatus(scenario, &grading, &mut found);
    }
    found
}

fn unusual_engine(scenario: &Scenario, scale: &Scale, found: &mut Vec<Fault>) {
    let EngineSettings { manifold, .. } = &scenario.engine;
    let default = (EngineSettings::default(), ManifoldSettings::default());
    let native = scenario.engine.backend == Backend::Bullet
        && scenario.engine.contact_path == ContactPath::Manifold;
    let of_native = [
        (
            "engine.manifold.substep_rate_hz",
            manifold.substep_rate_hz,
            default.1.substep_rate_hz,
            Law::Rate,
        ),
        (
            STIFFNESS,
            manifold.contact_stiffness_n_per_m,
            default.1.contact_stiffness_n_per_m,
            Law::Stiffness,
        ),
        (
            "engine.manifold.push_out_speed_m_per_s",
            manifold.push_out_speed_m_per_s,
            default.1.push_out_speed_m_per_s,
            Law::Speed,
        ),
        (
            "engine.restitution_velocity_threshold_m_per_s",
            scenario.engine.restitution_velocity_threshold_m_per_s,
            default.0.restitution_velocity_threshold_m_per_s,
            Law::Speed,
        ),
    ];
    let of_both = [
        ("engine.grain_size_mm", scenario.engine.grain_size_mm, default.0.grain_size_mm, Law::Fine),
        ("engine.rate_hz", scenario.engine.rate_hz, default.0.rate_hz, Law::Rate),
    ];
    for (path, typed, default, law) in
        of_both.into_iter().chain(native.then_some(of_native).into_iter().flatten())
    {
        let automatic = default * law.factor(scale);
        // Faster and stiffer than needed costs time alone; the load may ask for it.
        let costly = matches!(law, Law::Rate | Law::Stiffness);
        if typed < automatic / UNUSUAL || (typed > automatic * UNUSUAL && !costly) {
            found.push(fault(
                path,
                short(typed),
                format!("{} for these grains, or the field left out", short(automatic)),
                format!("the value differs by more than a factor of {UNUSUAL} from what the size of the grains asks for"),
            ));
        }
    }
}

/// Grains that would sink into each other by more than the accuracy standard allows.
fn unusual_load(
    scenario: &Scenario,
    value: &Value,
    grading: &Grading,
    scale: &Scale,
    found: &mut Vec<Fault>,
) {
    let native = scenario.engine.backend == Backend::Bullet
        && scenario.engine.contact_path == ContactPath::Manifold;
    let typed = scenario.engine.manifold.contact_stiffness_n_per_m;
    let stress = largest_stress(value, grading, scale.gravity);
    let overlap = OVERLAP_OF_STRESS * stress * scale.sizes.median / typed;
    if native && overlap > OVERLAP_ALLOWED && !found.iter().any(|f| f.path == STIFFNESS) {
        found.push(fault(
            STIFFNESS,
            short(typed),
            format!(
                "at least {} N/m, or the field left out",
                short(stiffness(value, grading, scale))
            ),
            format!(
                "contacts too soft for {} Pa at the bottom of the specimen: grains would overlap \
                 by some {} % of their size",
                short(stress),
                short(100.0 * overlap)
            ),
        ));
    }
}

/// A cylinder that runs over, or a funnel that jams.
fn unusual_apparatus(scenario: &Scenario, grading: &Grading, found: &mut Vec<Fault>) {
    if !scenario.stages.iter().any(|s| s.name() == "pour") {
        return;
    }
    let (cylinder, funnel) = (&scenario.apparatus.cylinder, &scenario.apparatus.funnel);
    let area = PI / 4.0 * from_mm(cylinder.inner_diameter_mm).powi(2);
    let height = to_mm(grading.solids * (1.0 + LOOSE) / area);
    if height > cylinder.height_mm {
        found.push(fault(
            "apparatus.cylinder.height_mm",
            short(cylinder.height_mm),
            format!("at least {} mm", short(height)),
            format!("grains may fall over the rim: a specimen with a void ratio of {LOOSE} stands higher than the cylinder"),
        ));
    }
    let least = JAMS_BELOW * to_mm(grading.sizes.median);
    if funnel.opening_diameter_mm < least {
        found.push(fault(
            "apparatus.funnel.opening_diameter_mm",
            short(funnel.opening_diameter_mm),
            format!("at least {} mm", short(least)),
            format!(
                "the funnel may jam: its opening is narrower than {JAMS_BELOW} median grain sizes"
            ),
        ));
    }
}
