//! Figures that make no sense of a specimen that is not there: they are withheld, with the reason.

use crate::measure::Container;
use crate::record::{StandingHeight, Withheld};
use crate::specimen::Specimen;

/// Share of the grains that must lie in the cylinder for a height to be that of the specimen.
/// Ours: of fewer a height tells how many came, not how they lie. Far below the share that a run
/// needs to count in means ([`crate::record::MOST_MISSING`]).
const LEAST_PRESENT: f64 = 0.5;

/// Why heights of a poured specimen are no heights of it; none where they are. `inside` grains
/// of `count` lie in the cylinder.
pub(super) fn no_height(inside: usize, count: usize) -> Option<String> {
    ((inside as f64) < LEAST_PRESENT * count as f64).then(|| {
        format!("only {inside} of {count} grains lie in the cylinder: they are not the specimen")
    })
}

/// Why a void ratio to a mean surface height in m makes no sense; none where it does. Below one
/// grain, the mean surface is that of a floor which is bare in places: voids between the grains
/// that lie apart do not count, and the figure is that of single grains.
pub(super) fn no_voids(
    specimen: &Specimen,
    container: &Container,
    mean_surface: f64,
) -> Option<String> {
    let members = container.members(specimen);
    let grains = &specimen.grains.grains;
    let mean = members.iter().map(|&n| grains[n].equivalent_diameter).sum::<f64>()
        / members.len().max(1) as f64;
    (mean_surface < mean).then(|| {
        format!(
            "the mean surface stands {:.1} mm high, below one grain ({:.1} mm): the floor is bare \
             in places, and there is no layer that voids could be counted in",
            1e3 * mean_surface,
            1e3 * mean
        )
    })
}

/// Figures withheld for one reason, by their fields.
pub(super) fn withheld(fields: &[&str], reason: &str) -> Vec<Withheld> {
    let of = |field: &&str| Withheld { field: (*field).to_owned(), reason: reason.to_owned() };
    fields.iter().map(of).collect()
}

/// A height where there is no reason against it.
pub(super) fn height_unless(height: StandingHeight, reason: Option<&str>) -> StandingHeight {
    if reason.is_some() { StandingHeight::withheld() } else { height }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: 5 of 230 grains are no specimen; half of them are.
    #[test]
    fn heights_of_a_few_grains_are_withheld() {
        assert!(no_height(5, 230).is_some_and(|why| why.contains("5 of 230")));
        assert_eq!(no_height(115, 230), None, "law: half of them");
        assert_eq!(no_height(0, 0), None, "law: nothing is missing of nothing");
        let height = StandingHeight { mean_surface: 1.0, p95: 2.0, highest: 3.0 };
        assert_eq!(height_unless(height, None), height, "law: a height that makes sense is kept");
        let written = serde_json::to_value(height_unless(height, Some("few"))).expect("JSON");
        assert!(written["mean_surface"].is_null(), "law: null in files, got {written}");
        let read: StandingHeight = serde_json::from_value(written).expect("read again");
        assert_eq!(read.mean(), None, "law: and none when read again");
    }
}
