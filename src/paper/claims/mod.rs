//! Every statement of the paper that runs can show, compared with a study.

mod material;
mod pluviation;
mod repose;
mod vibration;

#[cfg(test)]
mod tests;

pub(super) use vibration::edge_ratio;

use super::claim::TOO_SHORT;
use super::constants::GRAIN_COUNT;
use super::*;

/// Computes every claim, in the paper's order, of the runs that count in means. Runs that are
/// missing leave `ours` null; such a claim reads neither as within nor as outside. Where runs were
/// done and none that would show it counts, it is not comparable, nor is what depends on the full
/// size in the quick study, or on what is changed of the paper's specimen and programme.
pub fn claims(study: &StudyView) -> Vec<Claim> {
    let (counting, others) = study.split();
    let ours = drafted(&study.of_runs(&counting, &others));
    let they = drafted(&study.of_runs(&others, &counting));
    let all = drafted(study);
    let against = |name: &String| -> Option<(String, String)> {
        let run: &RunRecord = others.iter().find(|r| r.name == *name)?;
        Some((name.clone(), run.summary.why_left_out().join("; ")))
    };
    let mut claims: Vec<Claim> = ours
        .into_iter()
        .zip(they)
        .zip(all)
        .map(|((ours, they), all)| {
            let left_out: Vec<_> = all.runs.iter().filter_map(against).collect();
            ours.leaving_out(&left_out, &they)
        })
        .collect();
    for claim in claims.iter_mut().filter(|c| c.full_size) {
        let Some(reason) = why_not_comparable(study, &claim.id) else { continue };
        match claim.verdict {
            Verdict::Within | Verdict::Outside => {
                claim.not_comparable(&reason);
                claim.add_note(&format!("Not compared: {reason}."));
            }
            // What it counts is itself a comparison with the laboratory.
            Verdict::NotStated if claim.ours.is_some() || claim.not_valid.is_some() => {
                (claim.ours, claim.not_valid) = (None, None);
                claim.add_note(&format!("Not compared: {reason}."));
            }
            // The runs are there, and too short to show it.
            Verdict::NotRun
                if study.quick
                    && is_shaken(&claim.id)
                    && claim.ours.is_none()
                    && !claim.runs.is_empty() =>
            {
                TOO_SHORT.clone_into(&mut claim.reason);
            }
            // What was not run, or in no run that counts, has its own reason.
            _ => {}
        }
    }
    claims
}

/// Whether a claim is of what is shaken.
fn is_shaken(id: &str) -> bool {
    ["continuous-", "intermittent-"].iter().any(|of| id.starts_with(of))
}

/// Why a study does not compare a claim that needs the paper's own specimen and programme; none
/// where it has these.
pub(super) fn why_not_comparable(study: &StudyView, id: &str) -> Option<String> {
    let is_shaken = is_shaken(id);
    if study.quick {
        let smaller = format!("{} grains instead of {GRAIN_COUNT}", study.grain_count);
        return Some(if is_shaken { format!("{smaller}, {TOO_SHORT}") } else { smaller });
    }
    let depends = |of: Departs| match of {
        Departs::Grains => true,
        // Neither grains nor piles are in it.
        Departs::Cylinder => is_shaken || id.starts_with("standing-height-"),
        Departs::Shaking => is_shaken,
    };
    let reasons = study.departures.iter().filter(|departure| depends(departure.of));
    let reasons: Vec<&str> = reasons.map(|departure| departure.words.as_str()).collect();
    (!reasons.is_empty()).then(|| reasons.join(", "))
}

/// Every claim of a view's runs, in the paper's order: the same ones, whichever of the runs
/// the view leaves out.
fn drafted(study: &StudyView) -> Vec<Claim> {
    let mut claims = material::claims(study);
    claims.extend(pluviation::claims(study));
    claims.extend(vibration::claims(study));
    claims
}

/// "configurations 1, 3" for the reader.
fn list(configurations: &[u32]) -> String {
    let numbers: Vec<String> = configurations.iter().map(u32::to_string).collect();
    let plural = if numbers.len() == 1 { "" } else { "s" };
    format!("configuration{plural} {}", numbers.join(", "))
}
