//! Claims on the grains: sections 2 and 3, Figure 1.

use crate::paper::{
    Band, Claim, StudyView, Verdict, bands, claim::Draft, constants, gradation_in_words,
    text::number,
};
use crate::record::{RunRecord, UNCHANGED};

pub(super) fn claims(study: &StudyView) -> Vec<Claim> {
    let mut claims = vec![
        grain_count(study),
        total_mass(study),
        grains_in_100_g(study),
        density(study),
        poorly_graded(study),
        friction_is_repose(),
    ];
    claims.extend(super::repose::claims(study));
    claims.push(no_crushing(study));
    claims
}

/// A value that only grains give; a study without grains has none.
fn of_grains(study: &StudyView, value: f64) -> Option<f64> {
    (study.grain_count > 0).then_some(value)
}

fn grain_count(study: &StudyView) -> Claim {
    Draft::new(
        "grain-count",
        "Section 3",
        "1456 polyhedra come out of the sieve data for the total mass of the laboratory tests.",
    )
    .paper(Band::count(constants::GRAIN_COUNT))
    .ours(of_grains(study, study.grain_count as f64), "grains")
    .note(
        "The paper's sieve table stood in Figure 1, which was not available to us (only its text \
         was); ours was chosen among those that give this number, so that this shows consistency \
         and is no test.",
    )
    .input()
    .full_size()
    .judge()
}

fn total_mass(study: &StudyView) -> Claim {
    Draft::new("total-mass", "Section 2", "The gravel has a total mass of 2343 g.")
        .paper(bands::total_mass_g())
        .ours(of_grains(study, study.total_mass_g), "g")
        .input()
        .full_size()
        .judge()
}

fn grains_in_100_g(study: &StudyView) -> Claim {
    Draft::new("grains-in-100-g", "Section 3", "A sample of 100 g contains 55 to 65 gravel stones.")
        .paper(bands::grains_in_100_g())
        .ours(of_grains(study, study.grain_count as f64 / study.total_mass_g * 100.0), "grains")
        .input()
        .judge()
}

fn density(study: &StudyView) -> Claim {
    let kg_per_m3 = study.total_mass_g / study.solids_volume_cm3 * 1e3;
    Draft::new("solid-density", "Section 2", "The density of the gravels is 2673.9 kg/m³.")
        .paper(bands::solid_density_kg_per_m3())
        .ours(of_grains(study, kg_per_m3), "kg/m³")
        .note("Ours is the mass of the generated polyhedra over their volume.")
        .input()
        .judge()
}

fn poorly_graded(study: &StudyView) -> Claim {
    let g = &study.gradation;
    let mut band = Band::range(1.0, WELL_GRADED_FROM_CU);
    band.interpretation = format!(
        "\"USCS: GP\" is read as a coefficient of uniformity below {WELL_GRADED_FROM_CU} (ASTM \
         D2487); the class itself decides."
    );
    let mut claim = Draft::new(
        "poorly-graded-gravel",
        "Section 2, Figure 1",
        "The gravels are poorly graded (USCS: GP).",
    )
    .paper(band)
    .ours(Some(g.coefficient_of_uniformity).filter(|_| !study.sieve.is_empty()), "Cu")
    .note(format!("As specified: {}.", gradation_in_words(g)))
    .note(study.generated.as_ref().map_or_else(String::new, |made| {
        format!("The generated grains, sieved virtually: {}.", gradation_in_words(made))
    }))
    .input()
    .judge();
    if claim.ours.is_some() {
        let made = study.generated.as_ref().unwrap_or(g);
        let is_poor = g.uscs == "GP" && made.uscs == "GP";
        claim.verdict = if is_poor { Verdict::Within } else { Verdict::Outside };
    }
    claim
}

/// Coefficient of uniformity from which gravel can be well graded (ASTM D2487, table 1).
const WELL_GRADED_FROM_CU: f64 = 4.0;

fn friction_is_repose() -> Claim {
    let tangent = constants::ANGLE_OF_REPOSE_DEG.to_radians().tan();
    let angle = constants::FRICTION_RATIO.atan().to_degrees();
    Draft::new(
        "friction-is-tangent-of-repose",
        "Sections 2 and 3",
        "The friction ratio 0.793 follows from the angle of repose of 38.40°.",
    )
    .paper(Band::printed(constants::FRICTION_RATIO, 3))
    .ours(Some(tangent), "–")
    .note(format!(
        "Arithmetic, no run: tan 38.40° = {}, atan 0.793 = {}°.",
        number(tangent, 4),
        number(angle, 2)
    ))
    .input()
    .judge()
}

fn no_crushing(study: &StudyView) -> Claim {
    let secondary =
        |r: &RunRecord| r.summary.sieve_analysis.as_ref().and_then(|s| s.secondary.clone());
    // Against the grains as generated, whatever the run's own summary counts from.
    let others = |r: &RunRecord| {
        let s = secondary(r)?;
        Some(s.changed + s.lost + r.summary.grains.count.abs_diff(study.grain_count))
    };
    // A run that was not sieved anew shows nothing.
    let each: Option<Vec<usize>> = study.runs.iter().map(others).collect();
    let largest = each.as_ref().and_then(|each| each.iter().max());
    let change = study.runs.iter().filter_map(|r| Some(secondary(r)?.largest_change_percent));
    let change = change.fold(0.0_f64, |most, c| if most.is_nan() || c <= most { most } else { c });
    Draft::new(
        "no-crushing",
        "Section 4",
        "A secondary sieve analysis proved that no crushing occurred.",
    )
    .paper(Band::count(0))
    .ours(largest.map(|n| *n as f64), "grains changed or lost")
    .spread(each.iter().flatten().map(|n| *n as f64))
    .runs(study.runs)
    .note(format!(
        "After each run the grains are sieved anew with the shapes that the engine held at its \
         end, and compared one by one with the grains as generated. Ours is the largest number in \
         any run of grains whose sieve size changed by more than {:.0e} of it, or that are nowhere; \
         those that spilled over the rim or hung in the funnel are accounted for. The largest \
         change is {change:.1e} %. Grains are rigid and cannot break: this shows that the engine \
         kept every one as it was made.",
        UNCHANGED
    ))
    .input()
    .judge()
}
