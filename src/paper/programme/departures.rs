//! What a changed programme has otherwise than the paper gives it: specimen, plate and motion of the
//! table. Friction, restitution and the engine are none of them, for the laboratory's gravel had no
//! values of these.

use super::*;
use crate::in_order::each_once;

/// A table has no short form.
const SIEVE_TABLE: &str = "sieve table";

/// What is changed in scenarios of the programme, each with the same one without the changes.
pub(super) fn departures(scenarios: &[(&Scenario, &Scenario)]) -> Vec<Departure> {
    let changed = |(own, changed): &(&Scenario, &Scenario)| {
        let now = given(changed);
        let departure = |(of, what, was): (Departs, &'static str, String)| {
            let words = match now.iter().find(|(_, name, _)| *name == what) {
                Some((_, _, now)) if *now == was => return None,
                Some(_) if what == SIEVE_TABLE => "another sieve table".to_owned(),
                Some((_, _, now)) => format!("{what} {now} instead of {was}"),
                None => format!("no {what}"),
            };
            Some(Departure { of, words })
        };
        given(own).into_iter().filter_map(departure).collect::<Vec<_>>()
    };
    each_once(scenarios.iter().flat_map(changed))
}

/// The values that the paper gives, each with what it is.
fn given(scenario: &Scenario) -> Vec<(Departs, &'static str, String)> {
    let length = |mm: f64| format!("{mm} mm");
    let or_none = |value: Option<f64>, unit: &str| {
        value.map_or_else(|| "not given".to_owned(), |value| format!("{value} {unit}"))
    };
    let mut all = Vec::new();
    if let GrainsSpec::Sieved(grains) = &scenario.grains {
        let table = format!("{:?}", grains.sieve_table);
        all.extend([
            (Departs::Grains, "mass of the grains", format!("{} g", grains.total_mass_g)),
            (
                Departs::Grains,
                "density of the solids",
                format!("{} kg/m³", grains.density_kg_per_m3),
            ),
            (Departs::Grains, SIEVE_TABLE, table),
        ]);
    }
    let (cylinder, plate) = (&scenario.apparatus.cylinder, &scenario.apparatus.top_plate);
    all.extend([
        (Departs::Cylinder, "diameter of the cylinder", length(cylinder.inner_diameter_mm)),
        (Departs::Cylinder, "height of the cylinder", length(cylinder.height_mm)),
        (Departs::Shaking, "mass of the plate", format!("{} g", plate.mass_g)),
    ]);
    for stage in &scenario.stages {
        if let StageSpec::Vibrate(stage) = stage {
            all.extend([
                (Departs::Shaking, "frequency of the table", or_none(stage.frequency_hz, "Hz")),
                (Departs::Shaking, "amplitude of the table", or_none(stage.amplitude_mm, "mm")),
                (Departs::Shaking, "duration of a period", or_none(stage.duration_s, "s")),
                (Departs::Shaking, "number of periods", stage.periods.to_string()),
            ]);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::reproduce::Scenarios;
    use super::*;

    /// Law: what the paper gives and a change makes otherwise is said, once, with both values; what
    /// the text leaves open is none of it, nor what an interpretation has.
    #[test]
    fn what_the_paper_gives_is_told_from_what_it_leaves_open() {
        let found = |interpretation: Option<&str>, typed: &str| {
            let of = interpretation.map(|name| Interpretation::named(name).expect("one"));
            let change: Override = typed.parse().expect("a change");
            let loaded = Scenarios::load(false, of.as_ref(), &[change]);
            let departures = loaded.unwrap_or_else(|e| panic!("{typed}: {e}")).departures;
            departures.into_iter().map(|d| (d.of, d.words)).collect::<Vec<_>>()
        };
        for (typed, of, words) in [
            (
                "grains.total_mass_g=1200",
                Departs::Grains,
                "mass of the grains 1200 g instead of 2343 g",
            ),
            (
                "apparatus.cylinder.height_mm=250",
                Departs::Cylinder,
                "height of the cylinder 250 mm instead of 200 mm",
            ),
            (
                "apparatus.top_plate.mass_g=500",
                Departs::Shaking,
                "mass of the plate 500 g instead of 104 g",
            ),
        ] {
            let got = found(None, typed);
            assert_eq!(got, [(of, words.to_owned())], "law: of {typed} (got left)");
        }
        for typed in ["contact.grain_grain_friction=0.35", "engine.rate_hz=960", "rest_test_s=9"] {
            assert_eq!(found(None, typed), [], "law: {typed} is no departure");
        }
        assert_eq!(found(Some("full_stroke"), "seed=3"), [], "law: nor an interpretation");
    }
}
