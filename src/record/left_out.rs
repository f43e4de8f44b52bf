//! Which runs count in means: the one rule that every study, table, figure and claim asks.
//!
//! A run is left out of means where it is not valid (`docs/accuracy.md`), also because a height or a
//! settlement was read while its grains still moved, or where too many of its grains are not where
//! they were poured. What is left out is counted, and said.

use super::*;

/// Largest share of the grains that may be missing at the end of a run that counts in means:
/// left in the funnel or the spout, spilled or escaped; of a pile what rolled off its base
/// is not missing. In a laboratory of pieces, of those deposited, that fell beside its container.
///
/// Ours. A specimen stands lower by the share of its grains that it lacks. Pours of a few
/// hundred grains differ by up to 4 % of their height from one realisation to the next
/// (`HEIGHT_BAND`, `study/compared.rs`): a run that lacks more than 5 % shows its jam, not its
/// packing. Losses are a few grains or a jam, hardly anything between.
pub const MOST_MISSING: f64 = 0.05;

/// What stands in the place of a mean where every run is left out of it.
pub const NO_VALID_RUN: &str = "no valid run";

impl Summary {
    /// Why the run is left out of means, each reason for a reader; empty where it counts.
    pub fn why_left_out(&self) -> Vec<String> {
        let not_valid = match self.why_not_valid() {
            None if !self.valid => Some("it does not say that it is valid".to_owned()),
            why => why,
        };
        let too_few = self.grains.too_few_in_place(self.laboratory.is_some());
        not_valid.into_iter().chain(too_few).collect()
    }

    /// Whether the run counts in means.
    pub fn counts_in_means(&self) -> bool {
        self.why_left_out().is_empty()
    }

    /// Stages at whose end a height or a settlement is read though they had not settled when their
    /// time was over, each for a reader: a pour, the stage before the first vibration, from whose
    /// end settlement counts, also if another run has done it, and the last one. What comes to rest
    /// later is read later.
    pub fn read_while_moving(&self) -> Vec<String> {
        let shaken_first = self.stages.iter().position(|stage| stage.stage == "vibrate");
        let of = |(n, stage): (usize, &StageSummary)| {
            // Earlier summaries say it of vibrations alone.
            let vibration = || self.vibrations.iter().find(|v| v.stage as usize == n)?.settling;
            let settling = stage.settling.or_else(vibration)?;
            let is_read =
                stage.stage == "pour" || Some(n + 1) == shaken_first || n + 1 == self.stages.len();
            (is_read && !settling.settled).then(|| {
                format!(
                    "stage {n}, {}, had not settled within {} s, and what is read at its end \
                     (height, settlement, angle of repose) does not count",
                    stage.stage, settling.limit_s
                )
            })
        };
        let begun = self.begun_settling.filter(|of| shaken_first == Some(0) && !of.settled);
        let begun = begun.map(|of| {
            format!(
                "the specimen that the run began with had not settled within {} s, and settlement \
                 counts from there",
                of.limit_s
            )
        });
        begun.into_iter().chain(self.stages.iter().enumerate().filter_map(of)).collect()
    }

    /// Whether grains have run out of a laboratory until no two of them touch, so that its end has
    /// no overlap to judge: what flowed counts if the overlap was within the standard while they
    /// touched, at the ends of stages. The numerical creep of those that are left is judged as ever,
    /// by its check.
    pub fn ran_out(&self) -> bool {
        // Where grains never touched every look found 0.
        let within = |check: &CheckSummary| {
            check.passed == Some(true) && check.worst.is_some_and(|worst| worst > 0.0)
        };
        let checks = self.checks.as_ref();
        self.laboratory.is_some()
            && self.overlap.pairs == 0
            && self.grains.spilled > 0
            && (self.grains.in_cylinder == 0 || self.creep_um_per_s.is_some())
            && checks.is_some_and(|c| within(&c.overlap_mean) && within(&c.overlap_p99))
    }
}

impl GrainsSummary {
    /// That too many grains are missing in a specimen, or beside the container of a laboratory, for a
    /// reader.
    pub fn too_few_in_place(&self, of_laboratory: bool) -> Option<String> {
        let missing = self.missing?;
        if of_laboratory {
            let deposited = self.count.saturating_sub(self.left_in_funnel);
            return (missing as f64 > MOST_MISSING * deposited as f64).then(|| {
                format!(
                    "of {} that {} deposited {missing} fell out beside the container, which was not \
                     full: at most {:.0} % may",
                    counted(deposited, "grain"),
                    in_number(deposited, "was", "were"),
                    100.0 * MOST_MISSING
                )
            });
        }
        (missing as f64 > MOST_MISSING * self.count as f64).then(|| {
            format!(
                "{missing} of {} {} missing in the specimen, of which {:.0} % may be: {}, {} spilled, {} \
                 escaped",
                counted(self.count, "grain"),
                in_number(missing, "is", "are"),
                100.0 * MOST_MISSING,
                self.taken_with_funnel(),
                self.spilled,
                self.escaped
            )
        })
    }
}

/// The runs of those that are left out of means, each with its reasons: `name (why; why)`.
pub fn left_out_with_reasons<'a>(
    runs: impl IntoIterator<Item = (&'a str, &'a Summary)>,
) -> Vec<String> {
    let named = |(name, summary): (&str, &Summary)| {
        let why = summary.why_left_out();
        (!why.is_empty()).then(|| format!("{name} ({})", why.join("; ")))
    };
    runs.into_iter().filter_map(named).collect()
}

impl RunRecord {
    /// Whether the run counts in means.
    pub fn counts_in_means(&self) -> bool {
        self.summary.counts_in_means()
    }
}

impl RunRow {
    /// Whether the run counts in means: it has a result, is valid, and nothing else is against it.
    pub fn counts_in_means(&self) -> bool {
        self.failure.is_none() && self.valid == Some(true) && self.left_out_of_means.is_none()
    }

    /// Whether the run failed, or something is found in it beside what the accuracy standard
    /// judges. Rows from before this was recorded say so only of runs that meet the standard.
    pub fn is_spoilt(&self) -> bool {
        let is_not_valid_by_others = self.meets_standard == Some(true) && self.valid != Some(true);
        self.failure.is_some()
            || is_not_valid_by_others
            || self.finding_beside_standard == Some(true)
    }

    /// Whether the run has a result that is left out of means.
    pub fn is_left_out(&self) -> bool {
        self.failure.is_none() && !self.counts_in_means()
    }

    /// Why its result is left out of means; none where it counts or there is none.
    pub fn why_left_out(&self) -> Option<String> {
        let why = || self.left_out_of_means.clone();
        self.is_left_out()
            .then(|| why().unwrap_or_else(|| "it is not known to be valid".to_owned()))
    }
}

/// How many runs with a result are left out of means, in a sentence; none where none is.
pub fn left_out_in_words(left_out: usize, with_result: usize) -> Option<String> {
    let (runs, are) = (counted(with_result, "run"), in_number(left_out, "is", "are"));
    (left_out > 0).then(|| format!("{left_out} of {runs} with a result {are} left out of means"))
}

#[cfg(test)]
mod tests {
    use super::super::{VariationRow, summary::tests::summary};
    use super::*;
    use crate::motion::{MotionFacts, TableMotion};

    /// A run that meets everything, of which some of its 1456 grains are missing.
    fn run(missing: Option<usize>) -> Summary {
        let of = summary(true, Some(true));
        let grains = GrainsSummary { count: 1456, missing, ..of.grains };
        Summary { grains, ..of }.judged()
    }

    /// A row of that run, which stood so high.
    fn row(configuration: u32, height: f64, of: Summary) -> RunRow {
        let scenario = serde_json::from_value(serde_json::json!({
            "name": "s", "grains": { "file": "g.json" }, "stages": [{ "stage": "fill_funnel" }]
        }))
        .expect("a scenario");
        let row = RunRow::of_scenario("r", "v", "group", &scenario).with_results(&of);
        RunRow { configuration, poured_height_mm: Some(height), ..row }
    }

    /// Law: more than 5 % of the grains missing leave a run out, valid or not; 1456 · 0.05 = 72.8.
    #[test]
    fn a_jammed_run_is_valid_and_left_out() {
        for (missing, expected) in [
            (Some(0), true),
            (Some(72), true),
            (Some(73), false),
            (Some(1456), false),
            (None, true),
        ] {
            let summary = run(missing).judged();
            assert!(summary.valid, "law: `valid` knows the standard and the checks alone");
            let got = summary.counts_in_means();
            assert_eq!(got, expected, "law: at most 72 grains missing, {missing:?}");
            assert_eq!(summary.left_out_of_means.is_empty(), expected, "law: the file says so");
            let said = summary.left_out_of_means.join("; ");
            let told = said.contains("grains are missing");
            assert_eq!(told, !expected, "law: the reason is reported, got `{said}`");
        }
        let grains = GrainsSummary { count: 0, missing: Some(0), ..run(None).grains };
        let few = Summary { grains, ..run(None) };
        assert!(few.counts_in_means(), "law: nothing poured, nothing missing");
    }

    /// Law: of grains that are missing those heaped above the rim are counted apart from those left in
    /// the funnel, whose number a file keeps.
    #[test]
    fn a_heap_above_the_rim_is_counted_apart() {
        let of = GrainsSummary { left_in_funnel: 31, spilled: 2, ..run(Some(200)).grains };
        for (heaped_above_rim, expected) in [
            (None, "31 left in the funnel, 2 spilled"),
            (Some(29), "2 left in the funnel, 29 heaped above the rim, 2 spilled"),
        ] {
            let grains = GrainsSummary { heaped_above_rim, ..of };
            let said = grains.too_few_in_place(false).expect("too few are in place");
            assert!(said.contains(expected), "law: expected `{expected}`, got `{said}`");
        }
    }

    /// Law: what a check of the energy finds spoils a run, whether it meets the accuracy standard
    /// or not; that it does not meet the standard is no finding of its own.
    #[test]
    fn findings_beside_the_standard_spoil_a_run() {
        for (meets, passed, expected) in [
            (true, Some(true), false),
            (false, Some(true), false),
            (true, Some(false), true),
            (false, Some(false), true),
        ] {
            let row = row(1, 160.0, summary(meets, passed).judged());
            let case = format!("standard met: {meets}, energy passed: {passed:?}");
            assert_eq!(row.is_spoilt(), expected, "law: {case}");
            let spoilt = VariationRow::of(&[row]).remove(0).spoilt;
            assert_eq!(spoilt, usize::from(expected), "law: {case}, counted");
        }
    }

    /// Stages by name, and whether they settled, where that is known.
    fn stages(of: &[(&str, Option<bool>)]) -> Vec<StageSummary> {
        let stage = |&(name, settled): &(&str, Option<bool>)| StageSummary {
            stage: name.to_owned(),
            duration_s: 1.0,
            energy: None,
            rotation: None,
            until: None,
            settling: settled.map(|settled| Settling { time_s: 1.0, limit_s: 0.5, settled }),
            fall: None,
            motion: None,
        };
        of.iter().map(stage).collect()
    }

    /// Law: a run whose height or settlement is read while grains still move is not valid, left out
    /// of means and counted there; one that comes to rest before it is read is neither, nor one
    /// whose stages end by design.
    #[test]
    fn what_is_read_from_a_specimen_that_had_not_settled_does_not_count() {
        let (yes, no, by_design) = (Some(true), Some(false), None);
        let shaken = |pour, plate, first, last| {
            stages(&[
                ("fill_funnel", by_design),
                ("pour", pour),
                ("place_top_plate", plate),
                ("vibrate", first),
                ("vibrate", last),
            ])
        };
        for (of, at) in [
            (shaken(yes, yes, yes, yes), None),
            (shaken(yes, yes, no, yes), None),
            (shaken(yes, yes, yes, no), Some("stage 4, vibrate")),
            (shaken(yes, no, yes, yes), Some("stage 2, place_top_plate")),
            (shaken(no, yes, yes, yes), Some("stage 1, pour")),
            (stages(&[("slow_pluviation", no)]), Some("stage 0, slow_pluviation")),
            (stages(&[("pour", yes), ("vibrate", no), ("rest", by_design)]), None),
            (stages(&[("deposit", by_design), ("remove", by_design)]), None),
        ] {
            let got = Summary { stages: of, ..run(Some(0)) }.judged();
            let why = got.left_out_of_means.join("; ");
            assert_eq!(got.valid, at.is_none(), "law: valid, expected {at:?}, got `{why}`");
            assert_eq!(got.counts_in_means(), at.is_none(), "law: counts, {at:?}, got `{why}`");
            let said = at.is_none_or(|at| why.contains(at) && why.contains("within 0.5 s"));
            assert!(said, "law: expected `{at:?}` with its limit, got `{why}`");
            let rows = [row(1, 160.0, run(Some(0))), row(2, 90.0, got)];
            let mean = VariationRow::of(&rows).remove(0);
            let height = mean.poured_height_mm.map(|h| h.mean);
            let expected = if at.is_none() { (Some(125.0), 0) } else { (Some(160.0), 1) };
            assert_eq!((height, mean.left_out), expected, "law: the mean and its number left out");
        }
        // Summaries of before stages said so.
        let mut of = stages(&[("pour", None), ("vibrate", None)]);
        let vibration = VibrationSummary {
            stage: 1,
            periods_s: Vec::new(),
            motion: MotionFacts::of(&TableMotion::sine(0.025, 3.0, 5.0), 1.0 / 480.0),
            settling: Some(Settling { time_s: 0.5, limit_s: 0.5, settled: false }),
        };
        let earlier =
            |stages| Summary { stages, vibrations: vec![vibration.clone()], ..run(Some(0)) };
        assert!(!earlier(of.clone()).judged().valid, "law: the vibration says it");
        of.extend(stages(&[("rest", None)]));
        assert!(earlier(of).judged().valid, "law: at rest since");
    }

    /// Law: settlement that counts from a begun specimen counts only if that had settled.
    #[test]
    fn a_begun_specimen_that_had_not_settled_gives_no_settlement() {
        let (shaken, rested) =
            ([("vibrate", Some(true))], [("rest", None), ("vibrate", Some(true))]);
        for (of, settled, valid) in [
            (&shaken[..], Some(true), true),
            (&shaken[..], Some(false), false),
            (&shaken[..], None, true),
            (&rested[..], Some(false), true),
        ] {
            let begun = settled.map(|settled| Settling { time_s: 0.5, limit_s: 0.5, settled });
            let got =
                Summary { stages: stages(of), begun_settling: begun, ..run(Some(0)) }.judged();
            let why = got.left_out_of_means.join("; ");
            assert_eq!(got.valid, valid, "law: {of:?} begun with {begun:?}, got `{why}`");
            assert_eq!(why.contains("began with"), !valid, "law: and says why, got `{why}`");
        }
    }

    /// Law: what is not valid is left out, with its reason, whatever its grains do.
    #[test]
    fn what_is_not_valid_is_left_out() {
        let below = Summary { meets_standard: false, ..run(Some(0)) }.judged();
        assert!(!below.counts_in_means() && !below.valid, "law: below the standard");
        let both = Summary { meets_standard: false, ..run(Some(500)) }.judged();
        assert_eq!(both.left_out_of_means.len(), 2, "law: each reason is reported: {both:?}");
        let silent = Summary { valid: false, ..run(Some(0)) };
        assert!(
            !silent.counts_in_means(),
            "law: what does not say that it is valid does not count"
        );
    }

    /// A laboratory out of which some of ten grains have fallen, and no two of the others touch;
    /// `worst` is the largest overlap that was seen, within its limit.
    fn emptied(fallen: usize, worst: f64, creep: Option<f64>) -> Summary {
        let of = summary(false, Some(true));
        let mut checks = of.checks.clone().expect("checks");
        for check in [&mut checks.overlap_mean, &mut checks.overlap_p99] {
            check.worst = Some(worst);
        }
        let balance =
            Balance { weight_n: 0.0, carried_n: 0.0, sideways_n: 0.0, difference_percent: None };
        let (pieces, groups, openings, regions) = Default::default();
        Summary {
            laboratory: Some(LaboratorySummary { pieces, groups, balance, openings, regions }),
            grains: GrainsSummary {
                count: 10,
                in_cylinder: 10 - fallen,
                spilled: fallen,
                ..of.grains
            },
            checks: Some(checks),
            creep_um_per_s: creep,
            ..of
        }
        .judged()
    }

    /// Law: a hopper that has run empty is valid where its grains met the standard of overlap while
    /// they were there; where none ever touched another, or none fell, nothing was measured.
    #[test]
    fn a_laboratory_that_ran_empty_is_judged_by_what_was_there() {
        for (fallen, worst, creep, expected) in [
            (10, 0.1, None, true),
            (10, 0.0, None, false),
            (9, 0.1, Some(0.1), true),
            (9, 0.1, None, false),
            (0, 0.1, Some(0.1), false),
        ] {
            let got = emptied(fallen, worst, creep);
            let case = format!("{fallen} of 10 fell out, overlap {worst} %, creep {creep:?}");
            assert_eq!(got.valid, expected, "law: {case}");
            assert!(!got.meets_standard, "law: the end is not measured, {case}");
            assert_eq!(got.counts_in_means(), expected, "law: {case}");
        }
        let mut soft = emptied(10, 0.9, None);
        let checks = soft.checks.as_mut().expect("checks");
        (checks.overlap_mean.passed, checks.passed) = (Some(false), Some(false));
        assert!(!soft.judged().valid, "law: beyond the standard while they were there");
        let built_in = Summary { laboratory: None, ..emptied(10, 0.1, None) };
        assert!(!built_in.judged().valid, "law: what is poured into a cylinder stays there");
    }

    /// Law: more than 5 % of the grains that a laboratory's deposits let go, not of all there are,
    /// leave a run out that is valid.
    #[test]
    fn grains_that_missed_the_container_leave_a_laboratory_out() {
        for (count, left, missing, counts) in
            [(100, 0, Some(5), true), (100, 0, Some(6), false), (200, 160, Some(3), false)]
        {
            let of = emptied(9, 0.1, Some(0.1));
            let grains = GrainsSummary { count, left_in_funnel: left, missing, ..of.grains };
            let got = Summary { grains, ..of }.judged();
            let case = format!("{missing:?} of {count} grains, {left} not let go");
            assert!(got.valid, "law: `valid` knows the standard and the checks alone, {case}");
            assert_eq!(got.counts_in_means(), counts, "law: {case}");
            let said = got.left_out_of_means.join("; ");
            let expected = if counts { "" } else { "beside the container" };
            assert!(said.contains(expected) && said.is_empty() == counts, "law: {case}: {said}");
        }
    }

    /// Law: a mean is that of the runs that count, with the number left out beside it; overlap
    /// and grains outside, by which runs are judged, are of all. Where all count nothing changes.
    #[test]
    fn means_leave_out_what_does_not_count_and_say_how_many() {
        let overlap = |percent: f64, of: Summary| {
            let overlap = super::super::Overlap { mean_percent: percent, ..of.overlap };
            Summary { overlap, ..of }
        };
        let good =
            [row(1, 160.0, overlap(0.2, run(Some(0)))), row(2, 162.0, overlap(0.2, run(Some(1))))];
        let jammed = row(3, 100.0, overlap(0.2, run(Some(500))));
        let below = Summary { meets_standard: false, ..run(Some(0)) }.judged();
        let below = row(4, 10.0, overlap(9.8, below));
        let of = |rows: &[RunRow]| VariationRow::of(rows).remove(0);
        let told =
            |v: &VariationRow| (v.poured_height_mm.map(|h| (h.mean, h.count)), v.left_out, v.valid);
        assert_eq!(told(&of(&good)), (Some((161.0, 2)), 0, 2), "law: all count");
        let all = [good.to_vec(), vec![jammed.clone(), below.clone()]].concat();
        let v = of(&all);
        assert_eq!(
            told(&v),
            (Some((161.0, 2)), 2, 3),
            "law: the mean of 160 and 162 mm; the jam is valid"
        );
        let overlap = v.overlap_mean_percent.expect("measured");
        assert!(
            (overlap.mean - 2.6).abs() < 1e-12 && overlap.count == 4,
            "law: of all: {overlap:?}"
        );
        let pairs: Vec<&RunRow> = all.iter().collect();
        let pairs = RunRow::paired(&pairs, |r| r.poured_height_mm);
        assert_eq!(pairs, [(1, 160.0), (2, 162.0)], "law: pairs are of those that count");
        let none = of(&[jammed, below]);
        assert_eq!(told(&none), (None, 2, 1), "law: nothing is made of nothing");
        assert!(none.has_no_valid_run() && !v.has_no_valid_run());
        let why = all[2].why_left_out().expect("a reason");
        assert!(why.contains("500 of 1456 grains are missing"), "law: the row says why: {why}");
        assert_eq!(
            (all[0].why_left_out(), all[0].is_left_out()),
            (None, false),
            "law: nothing against it"
        );
        let failed = RunRow { failure: Some("it blew up".into()), ..all[3].clone() };
        assert!(
            !failed.is_left_out() && !failed.counts_in_means(),
            "law: what failed is no result"
        );
    }

    #[test]
    fn what_is_left_out_is_counted_in_words() {
        assert_eq!(left_out_in_words(0, 3), None);
        let words = |left_out| left_out_in_words(left_out, 3).expect("words");
        let one = left_out_in_words(1, 1).unwrap_or_default();
        assert_eq!(one, "1 of 1 run with a result is left out of means");
        assert_eq!(words(1), "1 of 3 runs with a result is left out of means");
        assert_eq!(words(2), "2 of 3 runs with a result are left out of means");
    }
}
