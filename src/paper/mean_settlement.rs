//! Settlement over time, of several runs as one curve with its band, and of the same specimens
//! unshaken.

use super::view::is_poured_from;
use super::*;
use crate::record::SeriesRow;

/// A curve: time in s, settlement in mm.
type Curve = Vec<(f64, f64)>;

/// Settlement of the plate under continuous vibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeanSettlement {
    /// Time since vibration began in s; mean, smallest and largest settlement in mm. The mean is
    /// of the programme's own runs, the band also of other placements of the plate.
    pub shaken: Vec<[f64; 4]>,
    /// Runs in the mean.
    pub runs: usize,
    /// Runs in the band.
    pub band_runs: usize,
    /// Whether the runs count in means; where none does, all are shown.
    pub valid: bool,
    /// Runs left out.
    pub left_out: usize,
    /// The specimens as poured, left alone: time in s and mean drop of their surface in mm, as
    /// long as their rest tests took. Where no shaken run counts it may be of poured ones that do.
    pub unshaken: Curve,
    /// Specimens in it.
    pub unshaken_runs: usize,
}

impl MeanSettlement {
    /// Of a study; none where nothing was vibrated.
    pub fn of(study: &StudyView) -> Option<Self> {
        let shaken = study.runs.iter().filter(|r| {
            matches!(r.kind, RunKind::VibrationContinuous | RunKind::VibrationPlacement)
        });
        let (of, left_out) = never_mixed(shaken);
        let valid = !left_out.all;
        let curves = |wanted: fn(&RunRecord) -> bool| -> Vec<Curve> {
            let of = of.iter().filter(|r| wanted(r));
            let curves = of.map(|r| settlement_curve(r, |row| row.settlement_mm));
            curves.filter(|c| !c.is_empty()).collect()
        };
        let (own, all) = (curves(|r| r.kind == RunKind::VibrationContinuous), curves(|_| true));
        // Beside shaken runs that count stand no poured ones that do not.
        let poured = |r: &&RunRecord| is_poured_from(r, VIBRATED_FALLING_HEIGHT_MM);
        let (poured, poured_left_out) = never_mixed(study.runs.iter().filter(poured));
        let rests: Vec<Curve> = poured
            .into_iter()
            .filter(|_| !(valid && poured_left_out.all))
            .map(|r| sinking(&r.rest_test))
            .filter(|c| c.len() > 1)
            .collect();
        let times: Vec<f64> = longest(&all)?.iter().map(|p| p.0).collect();
        let row = |t: &f64| {
            let at = |c: &Curve| held(c, *t);
            let (low, high) = all
                .iter()
                .map(at)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |e, v| (e.0.min(v), e.1.max(v)));
            let mean = own.iter().map(at).sum::<f64>() / own.len() as f64;
            [*t, mean, low, high]
        };
        (!own.is_empty()).then(|| Self {
            shaken: times.iter().map(row).collect(),
            runs: own.len(),
            band_runs: all.len(),
            valid,
            left_out: left_out.runs,
            unshaken: mean_curve(&rests),
            unshaken_runs: rests.len(),
        })
    }
}

/// Drop of the mean surface of a specimen left alone.
fn sinking(rest_test: &[SeriesRow]) -> Curve {
    let Some(first) = rest_test.first() else { return Vec::new() };
    rest_test
        .iter()
        .filter_map(|r| {
            Some((r.time_s - first.time_s, first.mean_surface_mm? - r.mean_surface_mm?))
        })
        .filter(|(t, s)| t.is_finite() && s.is_finite())
        .collect()
}

fn longest(curves: &[Curve]) -> Option<&Curve> {
    let end = |c: &&Curve| c.last().map_or(0.0, |p| p.0);
    curves.iter().max_by(|a, b| end(a).total_cmp(&end(b)))
}

/// A curve's value at a time, between its points on a straight line. Beyond its end it keeps its
/// last value: there everything is at rest.
fn held(curve: &[(f64, f64)], time: f64) -> f64 {
    let after = curve.partition_point(|p| p.0 < time);
    match (after.checked_sub(1).map(|i| curve[i]), curve.get(after)) {
        (Some(a), Some(b)) if b.0 > time && b.0 > a.0 => {
            a.1 + (b.1 - a.1) * (time - a.0) / (b.0 - a.0)
        }
        (_, Some(b)) => b.1,
        (Some(a), None) => a.1,
        (None, None) => f64::NAN,
    }
}

/// The mean at the times of the shortest curve, as far as it goes: a specimen that sinks does not
/// rest at its end.
pub(super) fn mean_curve(curves: &[Curve]) -> Curve {
    let end = |c: &Curve| c.last().map_or(0.0, |p| p.0);
    let Some(shortest) = curves.iter().min_by(|a, b| end(a).total_cmp(&end(b))) else {
        return Vec::new();
    };
    let mean = |t: f64| curves.iter().map(|c| held(c, t)).sum::<f64>() / curves.len() as f64;
    shortest.iter().map(|p| (p.0, mean(p.0))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::canned;

    #[test]
    fn curves_are_followed_between_their_points_and_kept_after_their_end() {
        let curve = vec![(0.0, 0.0), (1.0, 2.0), (2.0, 3.0)];
        for (time, expected) in
            [(-1.0, 0.0), (0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (1.5, 2.5), (9.0, 3.0)]
        {
            assert_eq!(held(&curve, time), expected, "law: at {time} s (got left)");
        }
        assert!(held(&[], 1.0).is_nan());
        let short = vec![(0.0, 0.0), (1.0, 4.0)];
        assert_eq!(mean_curve(&[curve, short]), [(0.0, 0.0), (1.0, 3.0)], "law: as far as both go");
    }

    /// Law: the mean and the band are of the runs that count; where none does they are of all, and
    /// it says so.
    #[test]
    fn runs_that_count_and_others_never_mix() {
        let end = |m: &MeanSettlement| m.shaken.last().map(|r| [r[1], r[2], r[3]].map(f64::round));
        // Configurations settle by 16, 18 and 20 mm; the third is not valid.
        let runs = canned::runs();
        let of = MeanSettlement::of(&canned::study(&runs)).expect("vibrated");
        assert_eq!(end(&of), Some([17.0, 16.0, 18.0]), "law: of the two that count");
        assert_eq!((of.runs, of.band_runs, of.left_out, of.valid), (2, 2, 1, true));
        let third: Vec<_> = runs.iter().filter(|r| r.configuration == 3).cloned().collect();
        let of = MeanSettlement::of(&canned::study(&third)).expect("vibrated");
        assert_eq!((end(&of), of.valid, of.runs), (Some([20.0; 3]), false, 1), "law: marked");
        // Its surface sinks by 1.5 · 45 µm/s for 2 s.
        let last = of.unshaken.last().copied().expect("a rest test");
        assert!((last.0 - 2.0).abs() < 1e-9 && (last.1 - 0.135).abs() < 1e-9, "got {last:?}");
        // No shaken run counts, and the poured ones of two configurations do.
        let mut shaken = runs.clone();
        for run in shaken.iter_mut().filter(|r| r.kind.is_vibration()) {
            (run.summary.meets_standard, run.summary.valid) = (false, false);
        }
        let of = MeanSettlement::of(&canned::study(&shaken)).expect("vibrated");
        assert_eq!((of.valid, of.runs, of.unshaken_runs), (false, 3, 2), "law: never in one mean");
        let poured = &runs[..4];
        assert_eq!(MeanSettlement::of(&canned::study(poured)), None, "law: nothing was vibrated");
    }

    /// Law: other placements of the plate widen the band and leave the mean alone.
    #[test]
    fn placements_are_in_the_band_alone() {
        let mut runs = canned::valid_runs();
        let mut placed =
            runs.iter().find(|r| r.kind == RunKind::VibrationContinuous).expect("a run").clone();
        placed.kind = RunKind::VibrationPlacement;
        for row in &mut placed.series {
            row.settlement_mm = row.settlement_mm.map(|s| 0.5 * s);
        }
        runs.push(placed);
        let of = MeanSettlement::of(&canned::study(&runs)).expect("vibrated");
        let last = of.shaken.last().expect("a row").map(f64::round);
        assert_eq!([last[1], last[2], last[3]], [18.0, 8.0, 20.0], "law: 16, 18, 20 and 8 mm");
        assert_eq!((of.runs, of.band_runs), (3, 4));
    }
}
