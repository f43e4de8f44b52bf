//! Claims on the grains: sections 2 and 3, Figure 1.

use crate::paper::{Claim, StudyView, Verdict, claim::Draft, constants};
use crate::record::{RunRecord, UNCHANGED};
use crate::report::text::{gradation_in_words, number};

pub(super) fn claims(study: &StudyView) -> Vec<Claim> {
    let count = study.grain_count as f64;
    // What only grains give; a study without grains has none of it.
    let of_grains =
        |id: &str, value: f64| Draft::of(id).ours((study.grain_count > 0).then_some(value)).judge();
    let mut claims = vec![
        of_grains("grain-count", count),
        of_grains("total-mass", study.total_mass_g),
        of_grains("grains-in-100-g", count / study.total_mass_g * 100.0),
        of_grains("solid-density", study.total_mass_g / study.solids_volume_cm3 * 1e3),
        poorly_graded(study),
        friction_is_repose(),
    ];
    claims.extend(super::repose::claims(study));
    claims.push(no_crushing(study));
    claims
}

fn poorly_graded(study: &StudyView) -> Claim {
    let g = &study.gradation;
    let mut claim = Draft::of("poorly-graded-gravel")
        .ours(Some(g.coefficient_of_uniformity).filter(|_| !study.sieve.is_empty()))
        .note(format!("As specified: {}.", gradation_in_words(g)))
        .note(study.generated.as_ref().map_or_else(String::new, |made| {
            format!("The generated grains, sieved virtually: {}.", gradation_in_words(made))
        }))
        .judge();
    if claim.ours.is_some() {
        let made = study.generated.as_ref().unwrap_or(g);
        let is_poor = g.uscs == "GP" && made.uscs == "GP";
        claim.verdict = if is_poor { Verdict::Within } else { Verdict::Outside };
    }
    claim
}

fn friction_is_repose() -> Claim {
    let tangent = constants::ANGLE_OF_REPOSE_DEG.to_radians().tan();
    let angle = constants::FRICTION_COEFFICIENT.atan().to_degrees();
    Draft::of("friction-is-tangent-of-repose")
        .ours(Some(tangent))
        .note(format!(
            "Arithmetic, no run: tan 38.40° = {}, atan 0.793 = {}°.",
            number(tangent, 4),
            number(angle, 2)
        ))
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
    let change = study.runs.iter().filter_map(secondary);
    let change = change.map(|s| s.largest_change_percent.unwrap_or(f64::NAN));
    let change = change.reduce(|most, c| if most.is_nan() || c <= most { most } else { c });
    // Of grains that were not sieved anew nothing is shown.
    let change = change.map_or_else(String::new, |c| match c.is_nan() {
        true => " The largest change is no number.".to_owned(),
        false => format!(" The largest change is {c:.1e} %."),
    });
    let kept = match largest {
        Some(0) => {
            " Grains are rigid and cannot break: this shows that the engine kept every one as it was \
             made."
        }
        _ => "",
    };
    Draft::of("no-crushing")
    .ours(largest.map(|n| *n as f64))
    .spread(each.iter().flatten().map(|n| *n as f64))
    .runs(study.runs)
    .note(format!(
        "After each run the grains are sieved anew with the shapes that the engine held at its \
         end, and compared one by one with the grains as generated. Ours is the largest number in \
         any run of grains whose sieve size changed by more than {:.0e} of it, or that are nowhere; \
         those that spilled over the rim or hung in the funnel are accounted for.{change}{kept}",
        UNCHANGED
    ))
    .judge()
}
