//! What a comparison of engines compares: figures of every run, and the bands within which engines
//! agree.

use super::*;
use crate::record::{OpeningSummary, RegionSummary, Site, left_out_with_reasons};
use crate::report::ComparedQuantity;

/// Largest difference of standing height between two engines that is not a finding, as a fraction
/// of the height: pours of a few hundred grains differ by up to 4 % from one mixing to the next, of
/// 1456 grains by about 1 % (both measured), and 5 % is beyond both.
pub const HEIGHT_BAND: f64 = 0.05;

/// The same for the void ratio, which is height over the height of the solids
/// less one: 5 % of the height are 0.05 (1 + e), 0.1 for e near 0.95.
pub const VOID_RATIO_BAND: f64 = 0.1;

/// The band about a value of the first engine within which those of the others agree with it.
type Band = fn(f64) -> f64;

const HEIGHT: Band = |height| HEIGHT_BAND * height;
const VOID_RATIO: Band = |_| VOID_RATIO_BAND;

/// Whether engines are judged by a quantity.
#[derive(Clone, Copy)]
enum Judged {
    /// They are.
    By(Band),
    /// They are where none of them pours: the specimen has no height but that at the end.
    WithoutPour(Band),
    /// No band is known.
    Not,
}

impl Judged {
    fn band(self, is_poured: bool) -> Option<Band> {
        match self {
            Self::By(band) => Some(band),
            Self::WithoutPour(band) => Some(band).filter(|_| !is_poured),
            Self::Not => None,
        }
    }
}

/// What is compared: its name, its unit, its value of a run, and whether engines are judged by it.
type Compared = (&'static str, &'static str, fn(&CompareRun) -> Option<f64>, Judged);

const QUANTITIES: [Compared; 16] = [
    (
        "standing height after pouring, mean surface",
        "mm",
        |r| r.summary.poured_height_mm?.mean(),
        Judged::By(HEIGHT),
    ),
    ("void ratio after pouring", "", |r| r.summary.poured_void_ratio, Judged::By(VOID_RATIO)),
    (
        "standing height at the end, mean surface",
        "mm",
        |r| in_cylinder(r)?.standing_height_mm.mean(),
        Judged::WithoutPour(HEIGHT),
    ),
    ("void ratio at the end", "", |r| r.summary.void_ratio, Judged::WithoutPour(VOID_RATIO)),
    (
        "settlement of the plate",
        "mm",
        |r| Some(r.summary.settlement_mm.as_ref()?.final_mm),
        Judged::Not,
    ),
    (
        "settlement of the surface",
        "mm",
        |r| Some(r.summary.surface_settlement_mm.as_ref()?.final_mm),
        Judged::Not,
    ),
    ("angle of repose", "°", |r| Some(r.summary.angle_of_repose.as_ref()?.degrees), Judged::Not),
    ("overlap, mean", "%", |r| Some(r.summary.overlap.known()?.mean_percent), Judged::Not),
    (
        "overlap, 99th percentile",
        "%",
        |r| Some(r.summary.overlap.known()?.p99_percent),
        Judged::Not,
    ),
    ("numerical creep at rest", "µm/s", |r| r.summary.creep_um_per_s, Judged::Not),
    (
        "coordination number",
        "",
        |r| Some(r.summary.coordination_number).filter(|number| number.is_finite()),
        Judged::Not,
    ),
    ("grains in the cylinder", "", |r| grains_in(r, Site::Cylinder), Judged::Not),
    ("grains on the base", "", |r| grains_in(r, Site::Base), Judged::Not),
    ("grains in the laboratory", "", |r| grains_in(r, Site::Laboratory), Judged::Not),
    ("grains through a wall", "", |r| Some(r.summary.grains.escaped as f64), Judged::Not),
    ("wall time per simulated second", "s", wall_time, Judged::Not),
];

/// The figures of a run whose grains lie in the cylinder: heights of a pile and of a laboratory are
/// no standing heights.
fn in_cylinder(of: &CompareRun) -> Option<&Summary> {
    Some(&of.summary).filter(|summary| summary.site() == Site::Cylinder)
}

/// Wall time over simulated time of an engine that carried the whole run out: with a specimen that
/// was handed on it is that of two engines.
fn wall_time(of: &CompareRun) -> Option<f64> {
    of.specimen_by.is_none().then_some(of.wall_s_per_simulated_s)
}

/// How many grains lie where those of a run do, if this is it.
fn grains_in(of: &CompareRun, site: Site) -> Option<f64> {
    (of.summary.site() == site).then_some(of.summary.grains.in_cylinder as f64)
}

/// Whether a run has poured, though the height of what lay there may be withheld.
fn has_poured(of: &CompareRun) -> bool {
    let Summary { poured_height_mm, withheld, .. } = &of.summary;
    poured_height_mm.is_some() || withheld.iter().any(|w| w.field == "poured_height_mm")
}

/// Why engines cannot be compared: a run from grains of its own that is not
/// valid, or lacks grains, shows its fault and not its engine. What is handed on decides no band.
pub(super) fn left_out(runs: &[CompareRun]) -> Option<String> {
    let own = runs.iter().filter(|r| r.specimen_by.is_none());
    let against = left_out_with_reasons(own.map(|r| (r.name.as_str(), &r.summary)));
    (!against.is_empty()).then(|| against.join(", "))
}

/// Why engines are not judged by what runs measure: no band is known for any of it.
pub(super) fn without_band(quantities: &[ComparedQuantity]) -> Option<String> {
    quantities.iter().all(|quantity| quantity.band.is_none()).then(|| {
        "bands are known for the height and the void ratio of a specimen in the cylinder alone, \
         which these runs do not have"
            .to_owned()
    })
}

/// What at least one of the runs measures.
pub(super) fn quantities(runs: &[CompareRun]) -> Vec<ComparedQuantity> {
    let is_judged = left_out(runs).is_none();
    let is_poured = runs.iter().any(has_poured);
    QUANTITIES
        .iter()
        .map(|(quantity, unit, value, judged)| {
            let values: Vec<Option<f64>> = runs.iter().map(value).collect();
            // A band holds between engines that made their own specimen, where each has a value.
            let own = runs.iter().zip(&values).filter(|(r, _)| r.specimen_by.is_none());
            let own: Vec<Option<f64>> = own.map(|(_, v)| *v).collect();
            let first = own.first().copied().flatten();
            let band = judged.band(is_poured).zip(first).map(|(band, first)| band(first));
            let all: Option<Vec<f64>> = own.into_iter().collect();
            let within = band.filter(|_| is_judged).zip(all).map(|(band, all)| {
                all.iter().all(|other| first.is_some_and(|first| (other - first).abs() <= band))
            });
            ComparedQuantity {
                quantity: (*quantity).to_owned(),
                unit: (*unit).to_owned(),
                values,
                band,
                within_band: within,
            }
        })
        .filter(|quantity| quantity.values.iter().any(Option::is_some))
        .chain(of_parts(runs, openings, &OF_OPENINGS))
        .chain(of_parts(runs, regions, &OF_REGIONS))
        .collect()
}

/// What is measured of a part of a laboratory: its name, its unit, and its value.
type OfPart<P> = (&'static str, &'static str, fn(&P) -> Option<f64>);

const OF_OPENINGS: [OfPart<OpeningSummary>; 2] = [
    ("mass passed", "g", |opening| Some(opening.passed_g)),
    ("rate", "g/s", |opening| opening.rate_g_per_s),
];

const OF_REGIONS: [OfPart<RegionSummary>; 4] = [
    ("void ratio", "", |region| region.void_ratio),
    ("relative density", "", |region| region.relative_density),
    ("mean stress", "kPa", |region| Some(region.stress.as_ref()?.mean_kpa)),
    ("deviatoric stress", "kPa", |region| Some(region.stress.as_ref()?.deviatoric_kpa)),
];

/// Of every part of the runs' laboratories, each with its name, what any run has of it.
fn of_parts<P: 'static>(
    runs: &[CompareRun],
    parts: fn(&CompareRun) -> Vec<(&String, &P)>,
    measured: &[OfPart<P>],
) -> Vec<ComparedQuantity> {
    let named = runs.first().map_or_else(Vec::new, parts).into_iter().enumerate();
    let all = named.flat_map(|(n, (name, _))| measured.iter().map(move |what| (n, name, what)));
    all.filter_map(|(n, name, (what, unit, value))| {
        let of_run = |run: &CompareRun| parts(run).get(n).and_then(|(_, part)| value(part));
        let values: Vec<Option<f64>> = runs.iter().map(of_run).collect();
        values.iter().any(Option::is_some).then(|| ComparedQuantity {
            quantity: format!("{what}, {name}"),
            unit: (*unit).to_owned(),
            values,
            band: None,
            within_band: None,
        })
    })
    .collect()
}

/// The openings of a run; none without a laboratory.
fn openings(of: &CompareRun) -> Vec<(&String, &OpeningSummary)> {
    let all = of.summary.laboratory.iter().flat_map(|laboratory| &laboratory.openings);
    all.map(|opening| (&opening.name, opening)).collect()
}

/// Its regions, likewise.
fn regions(of: &CompareRun) -> Vec<(&String, &RegionSummary)> {
    let all = of.summary.laboratory.iter().flat_map(|laboratory| &laboratory.regions);
    all.map(|region| (&region.name, region)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Balance, LaboratorySummary, canned};

    /// Two engines' own runs, and one from the first's specimen.
    fn three() -> Vec<CompareRun> {
        let mut record = canned::valid_runs()[0].clone();
        let summary = &mut record.summary;
        summary.poured_height_mm = Some(summary.standing_height_mm);
        summary.poured_void_ratio = summary.void_ratio;
        let run = |backend: &str, by: Option<&str>| CompareRun {
            backend: backend.to_owned(),
            specimen_by: by.map(str::to_owned),
            name: backend.to_owned(),
            wall_s_per_simulated_s: 1.0,
            summary: record.summary.clone(),
            series: Vec::new(),
        };
        vec![run("bullet", None), run("rapier", None), run("rapier-from-bullet", Some("bullet"))]
    }

    fn laboratory(openings: Vec<OpeningSummary>, regions: Vec<RegionSummary>) -> LaboratorySummary {
        let balance =
            Balance { weight_n: 0.0, carried_n: 0.0, sideways_n: 0.0, difference_percent: None };
        let (pieces, groups) = Default::default();
        LaboratorySummary { pieces, groups, balance, openings, regions }
    }

    fn verdicts(runs: &[CompareRun]) -> Vec<bool> {
        quantities(runs).iter().filter_map(|q| q.within_band).collect()
    }

    /// Law: no band is judged by a single value, as where the other one's is withheld, and what no
    /// grain has is no number.
    #[test]
    fn a_band_is_judged_where_every_engine_has_a_value() {
        for lacks in 0..2 {
            let mut runs = three();
            let summary = &mut runs[lacks].summary;
            (summary.poured_void_ratio, summary.void_ratio) = (None, None);
            (summary.overlap, summary.coordination_number) = (Overlap::of_none(), f64::NAN);
            let found = quantities(&runs);
            let of = |name: &str| found.iter().find(|q| q.quantity == name).expect("a row");
            let voids = of("void ratio after pouring");
            assert_eq!(voids.within_band, None, "law: run {lacks} has none: {voids:?}");
            let height = of("standing height after pouring, mean surface");
            assert_eq!(height.within_band, Some(true), "law: both have a height: {height:?}");
            for name in ["overlap, mean", "overlap, 99th percentile", "coordination number"] {
                let lacking = of(name).values.iter().map(Option::is_none);
                let expected = (0..3).map(|n| n == lacks);
                assert!(lacking.eq(expected), "law: {name} of run {lacks}: {:?}", of(name));
            }
        }
    }

    /// Law: no engine is charged with the time in which another made its specimen.
    #[test]
    fn wall_times_are_those_of_one_engine() {
        let found = quantities(&three());
        let row = found.iter().find(|q| q.quantity == "wall time per simulated second");
        let got = &row.expect("a row").values;
        let expected = [Some(1.0), Some(1.0), None];
        assert_eq!(*got, expected, "law: expected {expected:?}, got {got:?}");
    }

    /// Law: piles are compared by their angles of repose.
    #[test]
    fn piles_are_compared_by_their_angles() {
        let mut runs = three();
        runs[1].summary = canned::pile(1, Some(38.4)).summary;
        let found = quantities(&runs);
        let angle = found.iter().find(|q| q.quantity == "angle of repose").expect("a row");
        assert_eq!(angle.values, [None, Some(38.4), None], "law: of the run with a pile");
    }

    /// Law: what runs measure of openings and regions is compared by their names, of each what any
    /// run has.
    #[test]
    fn openings_and_regions_are_compared_by_their_names() {
        let mut runs = three();
        let is_of_all = |of: &str| QUANTITIES.iter().any(|(quantity, ..)| *quantity == of);
        let rows = |runs: &[CompareRun]| {
            let all = quantities(runs).into_iter();
            all.filter(|q| !is_of_all(&q.quantity)).collect::<Vec<ComparedQuantity>>()
        };
        assert!(rows(&runs).is_empty(), "law: without a laboratory there is no region");
        let stress = |mean_kpa| StressSummary {
            tensor_kpa: [[0.0; 3]; 3],
            mean_kpa,
            deviatoric_kpa: 2.0 * mean_kpa,
            asymmetry_percent: 0.0,
        };
        let region = |name: &str, void_ratio, stress| RegionSummary {
            name: name.to_owned(),
            void_ratio,
            stress,
            fabric: None,
            relative_density: None,
        };
        for (run, e) in runs.iter_mut().zip([0.8, 0.7, 0.6]) {
            let regions = vec![
                region("low", Some(e), Some(stress(10.0 * e)).filter(|_| e > 0.65)),
                region("top", None, None),
            ];
            let mouth = |rate_g_per_s| OpeningSummary {
                name: "mouth".to_owned(),
                passed_g: 100.0 * e,
                rate_g_per_s,
            };
            let openings = vec![mouth(Some(50.0).filter(|_| e < 0.75))];
            run.summary.laboratory = Some(laboratory(openings, regions));
        }
        let found = rows(&runs);
        let told: Vec<(&str, &str, &[Option<f64>])> =
            found.iter().map(|q| (q.quantity.as_str(), q.unit.as_str(), &q.values[..])).collect();
        let expected: [(&str, &str, &[Option<f64>]); 5] = [
            ("mass passed, mouth", "g", &[Some(80.0), Some(70.0), Some(60.0)]),
            ("rate, mouth", "g/s", &[None, Some(50.0), Some(50.0)]),
            ("void ratio, low", "", &[Some(0.8), Some(0.7), Some(0.6)]),
            ("mean stress, low", "kPa", &[Some(8.0), Some(7.0), None]),
            ("deviatoric stress, low", "kPa", &[Some(16.0), Some(14.0), None]),
        ];
        assert_eq!(told, expected, "law: nothing of a region that no run has");
        assert!(found.iter().all(|q| q.band.is_none()), "law: shown only, as the end is");
    }

    /// Law: bands are judged between runs that count, in both directions; with a run that lacks
    /// grains, or is not valid, they are not.
    #[test]
    fn bands_are_judged_between_runs_that_count() {
        let mut runs = three();
        assert_eq!(left_out(&runs), None);
        let same = verdicts(&runs);
        assert!(!same.is_empty() && same.iter().all(|within| *within), "law: the same agree");
        let mut higher = runs[1].summary.standing_height_mm;
        higher.mean_surface *= 2.0;
        runs[1].summary.poured_height_mm = Some(higher);
        assert!(verdicts(&runs).contains(&false), "law: twice the height does not agree");

        // Handed on: no band is judged by it.
        runs[2].summary.grains.missing = Some(1000);
        assert!(verdicts(&runs).contains(&false) && left_out(&runs).is_none());

        runs[1].summary.grains.missing = Some(1000);
        assert!(verdicts(&runs).is_empty(), "law: nothing is judged by a jammed run");
        let why = left_out(&runs).expect("law: and it says why");
        assert!(why.starts_with("rapier (1000 of "), "law: with the run named: {why}");
    }

    /// Law: piles and laboratories have no standing height and no height after pouring, by which
    /// nothing of them is compared or judged; a specimen that was begun with has one at the end.
    #[test]
    fn only_what_lies_in_the_cylinder_is_judged_by_heights() {
        let of = |change: &dyn Fn(&mut Summary)| {
            let mut runs = three();
            for run in &mut runs {
                run.summary.poured_height_mm = None;
                run.summary.poured_void_ratio = None;
                change(&mut run.summary);
            }
            quantities(&runs)
        };
        let named = |found: &[ComparedQuantity], words: &str| {
            found.iter().any(|quantity| quantity.quantity.contains(words))
        };
        let pile = of(&|summary| {
            *summary = canned::pile(1, Some(38.4)).summary;
            summary.void_ratio = None;
        });
        let in_pieces = of(&|summary| {
            summary.void_ratio = None;
            summary.laboratory = Some(laboratory(Vec::new(), Vec::new()));
        });
        for (found, grains) in [(pile, "on the base"), (in_pieces, "in the laboratory")] {
            for words in ["height", "void ratio", "cylinder"] {
                assert!(!named(&found, words), "law: no {words} of grains {grains}: {found:?}");
            }
            assert!(named(&found, grains), "law: grains {grains} are counted: {found:?}");
            assert!(found.iter().all(|q| q.within_band.is_none()), "law: not judged: {found:?}");
            let why = without_band(&found).expect("law: and it says why");
            assert!(why.contains("specimen in the cylinder"), "law: of what bands are: {why}");
        }
        let begun = of(&|_| {});
        let judged: Vec<&str> = begun
            .iter()
            .filter(|q| q.within_band == Some(true))
            .map(|q| q.quantity.as_str())
            .collect();
        let expected = ["standing height at the end, mean surface", "void ratio at the end"];
        assert_eq!(judged, expected, "law: nothing was poured, and the end has a height");
        assert_eq!(without_band(&begun), None, "law: bands are known for it");
    }
}
