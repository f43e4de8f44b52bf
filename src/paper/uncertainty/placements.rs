//! Placements of the plate on the same specimens: how far the settlement scatters with the
//! placement, and how far with the specimen.

use super::*;
use crate::measure::nested::{Bounded, Nested, variance_of_one};

/// Name of the quantity that the paper gives a range of.
pub(in crate::paper) const SETTLEMENT_OF_PLATE: &str = "settlement of the plate, final";
/// Name of the other one of which it gives a number.
pub(in crate::paper) const SHARE_AFTER_5_S: &str = "share of it after 5 s";

/// Fewest placements on a specimen of which a scatter is quoted without a word of caution.
const ENOUGH: usize = 10;

/// One quantity over specimens and placements.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlacementScatter {
    /// What was measured.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
    /// The values, specimen by specimen.
    pub specimens: Vec<SpecimenPlacements>,
    /// Mean over the specimens of their mean over placements; null of fewer than two specimens.
    pub mean: Option<f64>,
    /// Its confidence interval, which holds both sources of scatter: by Student's t of the
    /// specimens' means.
    pub interval: Option<Interval>,
    /// Standard deviation between specimens, placements aside.
    pub standard_deviation_of_specimens: Option<f64>,
    /// Its confidence interval.
    pub interval_of_specimens: Option<Interval>,
    /// Standard deviation between placements on one specimen; null where none has two.
    pub standard_deviation_of_placements: Option<f64>,
    /// Its confidence interval.
    pub interval_of_placements: Option<Interval>,
    /// p-value of specimens that do not differ, by the F test.
    pub p_of_equal_specimens: Option<f64>,
    /// What to mind; empty where nothing is.
    pub note: String,
}

/// The placements on one specimen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpecimenPlacements {
    /// The specimen's configuration.
    pub configuration: u32,
    /// One value a placement.
    pub values: Vec<f64>,
    /// The runs they are from.
    pub runs: Vec<String>,
    /// Runs that are left out, as they do not count in means.
    pub left_out: Vec<String>,
}

/// What was measured under the plates of a study's placements; `all` are its runs with those that
/// are left out of `study`.
pub(in crate::paper) fn scatter(all: &StudyView, study: &StudyView) -> Vec<PlacementScatter> {
    if study.of_kind(RunKind::VibrationPlacement).next().is_none() {
        return Vec::new();
    }
    type Of = fn(&RunRecord) -> Option<f64>;
    let quantities: [(&str, &str, Of); 4] = [
        (SETTLEMENT_OF_PLATE, "mm", |r| Some(plate(r)?.final_mm)),
        ("settlement of the plate, after 5 s", "mm", |r| plate(r)?.after_5_s),
        (SHARE_AFTER_5_S, "%", |r| Some(100.0 * plate(r)?.share_after_5_s?)),
        ("settlement of the mean surface, final", "mm", |r| Some(surface(r)?.final_mm)),
    ];
    let found = quantities.iter().map(|(name, unit, of)| one(all, study, (name, unit), of));
    found.filter(|q| q.specimens.iter().any(|s| !s.values.is_empty())).collect()
}

fn one(
    all: &StudyView,
    study: &StudyView,
    (name, unit): (&str, &str),
    of: &dyn Fn(&RunRecord) -> Option<f64>,
) -> PlacementScatter {
    let specimen = |configuration: u32| {
        let placed = study
            .of_kind(RunKind::VibrationPlacement)
            .filter(|r| r.configuration == configuration)
            .filter_map(|r| Some((r.name.clone(), of(r).filter(|v| v.is_finite())?)));
        let (runs, values): (Vec<String>, _) = placed.unzip();
        let left_out = all
            .of_kind(RunKind::VibrationPlacement)
            .filter(|r| r.configuration == configuration && !r.counts_in_means())
            .filter(|r| !runs.contains(&r.name))
            .map(|r| r.name.clone())
            .collect();
        SpecimenPlacements { configuration, values, runs, left_out }
    };
    let specimens: Vec<SpecimenPlacements> = study.configurations().map(specimen).collect();
    let groups: Vec<Vec<f64>> = specimens.iter().map(|s| s.values.clone()).collect();
    let nested = Nested::of(&groups, CONFIDENCE);
    let n = nested.as_ref();
    let root = |b: Option<Bounded>| b.map(|b| b.value.max(0.0).sqrt());
    let ends = |b: Option<Bounded>| b.map(|b| Interval::new(b.low.sqrt(), b.high.sqrt()));
    // One specimen still shows how far its placements scatter.
    let alone = || groups.iter().find_map(|values| variance_of_one(values, CONFIDENCE));
    let (within, between) = (n.map_or_else(alone, |n| n.within), n.and_then(|n| n.between));
    PlacementScatter {
        name: name.to_owned(),
        unit: unit.to_owned(),
        mean: n.map(|n| n.mean.value),
        interval: n.map(|n| Interval::new(n.mean.low, n.mean.high)),
        standard_deviation_of_specimens: root(between),
        interval_of_specimens: ends(between),
        standard_deviation_of_placements: root(within),
        interval_of_placements: ends(within),
        p_of_equal_specimens: n.and_then(|n| n.p_between),
        note: note(&groups, n),
        specimens,
    }
}

fn note(groups: &[Vec<f64>], nested: Option<&Nested>) -> String {
    let mut notes = Vec::new();
    if nested.is_none() {
        notes.push("With one specimen, the scatter between specimens is unknown.".to_owned());
    }
    if let Some(estimated) = nested.and_then(|n| n.between_as_estimated).filter(|v| *v < 0.0) {
        notes.push(format!(
            "The variance between specimens comes out as {}, and is taken to be 0: they differ by \
             less than their placements make expect.",
            number(estimated, 2)
        ));
    }
    let least = groups.iter().map(Vec::len).filter(|n| *n > 0).min().unwrap_or(0);
    if least < ENOUGH {
        let least = counted(least, "placement");
        notes.push(format!("Only {least} on a specimen; {ENOUGH} are asked for."));
    }
    if nested.is_some_and(|n| n.groups < 3) {
        notes.push("Two specimens: their scatter is hardly known.".to_owned());
    }
    notes.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::canned;

    /// A study with placements whose final settlements are given, specimen by specimen.
    fn scattered(values: &[&[f64]]) -> Vec<RunRecord> {
        let mut runs = canned::runs();
        for (n, values) in values.iter().enumerate() {
            let configuration = n as u32 + 1;
            let like = runs
                .iter()
                .find(|r| {
                    r.kind == RunKind::VibrationContinuous && r.configuration == configuration
                })
                .expect("a run")
                .clone();
            for (p, value) in values.iter().enumerate() {
                let mut run = like.clone();
                run.kind = RunKind::VibrationPlacement;
                run.name = format!("{}-placement{:02}", like.name, p + 1);
                run.summary.settlement_mm.as_mut().expect("shaken").final_mm = *value;
                runs.push(run);
            }
        }
        runs
    }

    /// The hand-computed example of the analysis of variance: 2 | 4, 6 | 8, 9, 10.
    #[test]
    fn both_sources_are_reported_apart() {
        let runs = scattered(&[&[2.0], &[4.0, 6.0], &[8.0, 9.0, 10.0]]);
        let study = canned::study(&runs);
        let found = scatter(&study, &study);
        let plate = &found[0];
        assert_eq!(plate.name, "settlement of the plate, final");
        let counts: Vec<usize> = plate.specimens.iter().map(|s| s.values.len()).collect();
        assert_eq!(counts, [1, 2, 3]);
        for (what, expected, got) in [
            ("mean of the specimens' means", 16.0 / 3.0, plate.mean),
            ("σ of specimens", (245.0_f64 / 22.0).sqrt(), plate.standard_deviation_of_specimens),
            ("σ of placements", (4.0_f64 / 3.0).sqrt(), plate.standard_deviation_of_placements),
        ] {
            let got = got.expect("a number");
            assert!((got - expected).abs() < 1e-12, "law: {what}, expected {expected}, got {got}");
        }
        assert!(plate.note.contains("Only 1 placement on"), "{}", plate.note);
        let interval = plate.interval.expect("an interval");
        assert!(interval.low < 0.0 && interval.high > 13.0, "law: 5.33 ± 4.30 · 3.51/√3");
    }

    /// Law: a placement that counts and does not tell is not left out; one that does not count is.
    #[test]
    fn what_does_not_tell_is_not_left_out() {
        let mut runs = scattered(&[&[2.0, 3.0], &[4.0, 6.0]]);
        let from = runs.len() - 2;
        let [silent, spoilt] = &mut runs[from..] else { panic!("two placements") };
        silent.summary.settlement_mm.as_mut().expect("shaken").share_after_5_s = None;
        (spoilt.summary.meets_standard, spoilt.summary.valid) = (false, false);
        let (spoilt, all) = (spoilt.name.clone(), canned::study(&runs));
        let (counting, others) = all.split();
        let found = scatter(&all, &all.of_runs(&counting, &others));
        let share = found.iter().find(|q| q.name == SHARE_AFTER_5_S).expect("shares");
        let got = &share.specimens[1];
        assert_eq!((got.values.len(), &got.left_out), (0, &vec![spoilt]), "law: one of two");
    }

    #[test]
    fn the_programme_s_own_runs_are_none_of_them() {
        let own = canned::runs();
        assert!(
            scatter(&canned::study(&own), &canned::study(&own)).is_empty(),
            "law: the plate was laid once"
        );
        let runs = scattered(&[&[1.0, 2.0]]);
        let study = canned::study(&runs);
        // Whether grains were crushed is asked of every run.
        let claims = |runs: &[RunRecord]| {
            let claims = crate::paper::claims(&canned::study(runs));
            claims.into_iter().filter(|c| c.id != "no-crushing").collect::<Vec<_>>()
        };
        assert_eq!(claims(&own), claims(&runs), "law: placements answer no claim of the paper");
        let found = scatter(&study, &study);
        assert_eq!(found[0].mean, None, "law: one specimen tells nothing of others");
        for said in ["With one specimen, ", " Only 2 placements on a specimen; 10 are asked for."] {
            assert!(found[0].note.contains(said), "law: `{said}` in {}", found[0].note);
        }
        // 1 and 2: s² = ½ with 1 of freedom.
        let placements = found[0].standard_deviation_of_placements.expect("of two placements");
        assert!((placements - 0.5_f64.sqrt()).abs() < 1e-12, "law: √½, got {placements}");
        assert_eq!(found[0].standard_deviation_of_specimens, None, "law: not of specimens");
    }
}
