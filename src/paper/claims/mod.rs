//! Every statement of the paper that runs can show, held against a study.

mod material;
mod pluviation;
mod repose;
mod vibration;

#[cfg(test)]
mod tests;

use super::{Claim, StudyView};

/// Computes every claim, in the paper's order. Runs that are missing leave
/// `ours` null; such a claim never reads as within.
pub fn claims(study: &StudyView) -> Vec<Claim> {
    let mut claims = material::claims(study);
    claims.extend(pluviation::claims(study));
    claims.extend(vibration::claims(study));
    if study.quick {
        for claim in claims.iter_mut().filter(|c| c.paper.is_some()) {
            if !claim.note.is_empty() {
                claim.note.push(' ');
            }
            claim.note.push_str("Quick study: its specimen is not the paper's.");
        }
    }
    claims
}

/// "configurations 1, 3" for the reader.
fn list(configurations: &[u32]) -> String {
    let numbers: Vec<String> = configurations.iter().map(u32::to_string).collect();
    let plural = if numbers.len() == 1 { "" } else { "s" };
    format!("configuration{plural} {}", numbers.join(", "))
}
