//! What is typed, may be meant, and does not suit the grains: reported, not refused.

use std::f64::consts::PI;

use serde_json::Value;

use super::{
    Backend, ContactPath, EngineSettings, Fault, Grading, GrainsSpec, ManifoldSettings, Scenario,
    automatic::{STIFFNESS, largest_stress, stiffness},
    validate::{fault, short},
};
use crate::scale::{Law, Scale};
use crate::units::{from_mm, to_mm};

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
