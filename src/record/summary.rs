//! `summary.json`: the figures of a run.

use super::*;
use crate::motion::MotionFacts;
use crate::world::BackendInfo;

/// `summary.json`: the figures of one run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Summary {
    /// Name of the scenario.
    pub scenario: String,
    /// The engine.
    pub backend: BackendInfo,
    /// Who found and solved the contacts.
    pub contact_solver: String,
    /// Seed of the random streams.
    pub seed: u64,
    /// Which realisation, counted from 1.
    pub configuration: u32,
    /// Falling height in mm, where grains were poured.
    pub falling_height_mm: Option<f64>,
    /// The grains.
    pub grains: GrainsSummary,
    /// The grains in the virtual sieve, as generated and after the run.
    pub sieve_analysis: Option<SieveSummary>,
    /// Elongation, flatness and sphericity of the grains.
    pub shape: Option<ShapeSummary>,
    /// Figures that are not given because they would make no sense, each with the reason.
    #[serde(default)]
    pub withheld: Vec<Withheld>,
    /// Standing height of the specimen at the end.
    pub standing_height_mm: StandingHeight,
    /// Standing height at the end of pouring, before plate and vibration.
    pub poured_height_mm: Option<StandingHeight>,
    /// Volume of voids over volume of solids, to the mean surface; none of a pile,
    /// where nothing is, or where it is withheld.
    pub void_ratio: Option<f64>,
    /// Relative density at the end, (e_max − e)/(e_max − e_min): 0 of the loosest, 1 of the densest
    /// state, where there is a void ratio and the scenario gives `index_densities`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_density: Option<f64>,
    /// Void ratio at the end of pouring.
    pub poured_void_ratio: Option<f64>,
    /// Volume of voids over total volume, to the mean surface; none as above.
    pub porosity: Option<f64>,
    /// The middle of what lies in the cylinder; none where it is too small, or no cylinder.
    pub core: Option<CoreSummary>,
    /// Settlement of the top plate since the first vibration of this run that began with it, where
    /// there is one.
    pub settlement_mm: Option<Settlement>,
    /// Settlement of the mean surface since the first vibration of this run began, where vibrated.
    pub surface_settlement_mm: Option<Settlement>,
    /// Tilt of the top plate, where it was vibrated with one; missing where it was not, or the summary
    /// is of before this was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plate_tilt_deg: Option<PlateTilt>,
    /// The stages that vibrate: when, how, and how everything came to rest; empty where nothing
    /// was vibrated, or the summary is of before this was recorded.
    #[serde(default)]
    pub vibrations: Vec<VibrationSummary>,
    /// Angle of repose, where a pile was built; null also where what came of it
    /// has no flanks, and `warnings` say why.
    pub angle_of_repose: Option<AngleOfRepose>,
    /// Loads, flows and void ratios of a laboratory of pieces; none of the built-in apparatus.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laboratory: Option<LaboratorySummary>,
    /// Overlap of grains at the end, exact, measured outside the engine.
    pub overlap: Overlap,
    /// Mean number of grains touching a grain; NaN, and null in files, where no grain is left.
    #[serde(deserialize_with = "nan_where_null")]
    pub coordination_number: f64,
    /// How many grains touch 0, 1, 2, ... others.
    #[serde(default)]
    pub coordination_distribution: Vec<usize>,
    /// Loaded contacts; null of an engine that gives none.
    pub contacts: Option<ContactsSummary>,
    /// How the stage of another run came to rest with whose specimen the run began; none where it
    /// began with none, or that was not recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub begun_settling: Option<Settling>,
    /// Energy and rotation of the grains, stage by stage.
    #[serde(default)]
    pub stages: Vec<StageSummary>,
    /// Sinking rate of the mean grain height in the second half of the rest test, in µm/s; null where none was run
    /// or no grain is left.
    pub creep_um_per_s: Option<f64>,
    /// The rest test in full.
    pub rest_test: Option<RestTest>,
    /// Whether overlap and numerical creep are measured and meet the accuracy standard
    /// (docs/accuracy.md).
    pub meets_standard: bool,
    /// Whether the standard is met, or was met before the grains ran out of a laboratory, no
    /// run-time check found anything, and everything had settled where heights and settlement are
    /// read; false where the summary is of before this was recorded.
    #[serde(default)]
    pub valid: bool,
    /// Why the run is left out of means, valid or not (`docs/accuracy.md`); empty where it counts.
    #[serde(default)]
    pub left_out_of_means: Vec<String>,
    /// What was watched while it went on; none where the run is of before this
    /// was recorded.
    pub checks: Option<Checks>,
    /// How well the contacts were solved, over all samples of the run; null of an
    /// engine that does not say.
    pub solver_residual: Option<SolverResidual>,
    /// Kinetic energy at the end in J.
    pub kinetic_energy_j: f64,
    /// Simulated time in s, rest test included.
    pub simulated_s: f64,
    /// Engine steps, rest test included.
    pub steps: u64,
    /// Wall time in s: all stages of the run, whenever they were computed.
    pub wall_s: f64,
    /// The part of it spent inside the engine.
    pub engine_s: f64,
    /// Peak memory of the process in MiB; 0 where the system does not say.
    pub peak_memory_mib: f64,
    /// Findings a reader must know.
    pub warnings: Vec<String>,
}

/// Where the grains of a run lie at its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Site {
    /// In the cylinder, where they have a standing height.
    Cylinder,
    /// In a pile on its base.
    Base,
    /// In a laboratory of pieces.
    Laboratory,
}

impl Summary {
    /// Where its grains lie. A pile has no walls: no void ratio, and no reason why.
    pub fn site(&self) -> Site {
        let is_withheld = self.withheld.iter().any(|w| w.field == "void_ratio");
        let is_pile = self.void_ratio.is_none() && self.grains.in_cylinder > 0 && !is_withheld;
        match (&self.laboratory, is_pile) {
            (Some(_), _) => Site::Laboratory,
            (None, true) => Site::Base,
            (None, false) => Site::Cylinder,
        }
    }

    /// From the beginning of the first to the end of the last period of vibration, in s of the
    /// run's time; none where nothing was vibrated.
    pub fn shaken_s(&self) -> Option<(f64, f64)> {
        let mut periods = self.vibrations.iter().flat_map(|v| &v.periods_s);
        let first = periods.next()?;
        let last = periods.next_back().unwrap_or(first);
        Some((first[0], last[1]))
    }

    /// The same with `valid` as the accuracy standard, the run-time checks and the settling of its
    /// stages have it, and with why it is left out of means.
    #[must_use]
    pub fn judged(self) -> Self {
        let judged = Self { valid: self.why_not_valid().is_none(), ..self };
        Self { left_out_of_means: judged.why_left_out(), ..judged }
    }

    /// Why the run is not valid, for a reader; none where it is. `valid` says whether it is.
    pub fn why_not_valid(&self) -> Option<String> {
        let below = !self.meets_standard && !self.ran_out();
        let standard = below.then(|| "the accuracy standard is not met".to_owned());
        let checks = self.checks.as_ref().filter(|g| g.passed == Some(false));
        let checks = checks.map(|g| format!("checks {}", g.line()));
        let why: Vec<String> =
            standard.into_iter().chain(checks).chain(self.read_while_moving()).collect();
        (!why.is_empty()).then(|| why.join("; "))
    }
}

/// Residual of the contact solver: the natural map of the laws of contact and
/// friction over the impulses found, both in the kinetic norm. 0 is exact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SolverResidual {
    /// Median of the samples.
    pub median: f64,
    /// 99th percentile (nearest rank).
    pub p99: f64,
    /// The largest.
    pub worst: f64,
}

impl SolverResidual {
    /// Of samples in any order; none of none.
    pub fn of(samples: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = samples.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let rank = |share: f64| (share * sorted.len() as f64).ceil().max(1.0) as usize - 1;
        let worst = *sorted.last()?;
        Some(Self { median: sorted[rank(0.5)], p99: sorted[rank(0.99)], worst })
    }
}

/// One stage that vibrates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VibrationSummary {
    /// Which stage of the run, counted from 0.
    pub stage: u32,
    /// Beginning and end of each period in s, in the run's time.
    pub periods_s: Vec<[f64; 2]>,
    /// Peaks and jumps of the table's motion.
    pub motion: MotionFacts,
    /// How everything came to rest afterwards; null where that was not recorded.
    pub settling: Option<Settling>,
}

/// A figure that is not given because it would make no sense.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Withheld {
    /// Field of the summary, which is null.
    pub field: String,
    /// Why.
    pub reason: String,
}

/// Number, mass and whereabouts of the grains.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GrainsSummary {
    /// Number of grains generated.
    pub count: usize,
    /// Their mass in g.
    pub mass_g: f64,
    /// Their solid volume in cm³.
    pub solids_volume_cm3: f64,
    /// Grains inside the cylinder at the end, or on a pile's base. With `escaped`, `spilled` and
    /// `left_in_funnel` they are all: `count`.
    pub in_cylinder: usize,
    /// Mass of the grains inside the cylinder in g.
    pub mass_in_cylinder_g: f64,
    /// Grains that passed a wall or the floor, or lie with their centroid in one: an engine
    /// failure.
    pub escaped: usize,
    /// Grains that fell outside over the rim, or off a pile's base.
    pub spilled: usize,
    /// Grains left in the funnel, or never fed; with those of `heaped_above_rim`.
    pub left_in_funnel: usize,
    /// Those of `left_in_funnel` that lay heaped above the cylinder's rim, below the funnel's opening,
    /// and were taken away with it; missing where there were none, or another run poured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heaped_above_rim: Option<usize>,
    /// Grains that were to lie in the specimen at the end and do not: left in the funnel or
    /// the spout, spilled or escaped. What rolled off a pile's base is not missing. In a laboratory
    /// of pieces, grains that deposits let fall beside its container, which was not full. Null where
    /// nothing was poured, or grains may fall out by design.
    pub missing: Option<usize>,
}

impl GrainsSummary {
    /// What went with the funnel, in words.
    pub fn taken_with_funnel(&self) -> String {
        let heaped = self.heaped_above_rim.unwrap_or(0);
        let hung = format!("{} left in the funnel", self.left_in_funnel.saturating_sub(heaped));
        if heaped == 0 { hung } else { format!("{hung}, {heaped} heaped above the rim") }
    }
}

/// Height of the specimen above the floor, by three definitions, in mm; NaN, and null in files,
/// where the summary says in `withheld` why it is not given.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StandingHeight {
    /// Mean of the height map over the cylinder's area.
    #[serde(deserialize_with = "nan_where_null")]
    pub mean_surface: f64,
    /// 95th percentile of the height map.
    #[serde(deserialize_with = "nan_where_null")]
    pub p95: f64,
    /// Highest point of any grain.
    #[serde(deserialize_with = "nan_where_null")]
    pub highest: f64,
}

impl StandingHeight {
    /// What stands in the place of heights that are withheld.
    pub fn withheld() -> Self {
        Self { mean_surface: f64::NAN, p95: f64::NAN, highest: f64::NAN }
    }

    /// The mean of the height map; none where it is withheld.
    pub fn mean(&self) -> Option<f64> {
        Some(self.mean_surface).filter(|height| height.is_finite())
    }
}

fn nan_where_null<'de, D: serde::Deserializer<'de>>(file: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(file)?.unwrap_or(f64::NAN))
}

/// Settlement by vibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Settlement {
    /// At the end of the run's last stage, with the table at rest, in mm.
    #[serde(rename = "final")]
    pub final_mm: f64,
    /// At the end of the last period, while everything still moves, in mm; null where the
    /// summary is of before this was recorded.
    pub end_of_shaking: Option<f64>,
    /// After the first 5 s of vibration, in mm.
    pub after_5_s: Option<f64>,
    /// `after_5_s / final`.
    pub share_after_5_s: Option<f64>,
    /// After each period of vibration, read in the rest that follows, in mm.
    pub after_each_period: Vec<f64>,
}

/// Tilt of the top plate from the horizontal, in degrees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlateTilt {
    /// At the end of the run's last stage, with the table at rest.
    #[serde(rename = "final")]
    pub final_deg: f64,
    /// At the last sample of the last period, while everything still moves.
    pub end_of_shaking: Option<f64>,
}

/// Slope of a pile, measured as `docs/repose.md` says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AngleOfRepose {
    /// That of the mean slope of straight lines fitted to the flank in sectors about the axis.
    pub degrees: f64,
    /// Standard deviation of the sectors' angles.
    pub standard_deviation_degrees: f64,
    /// Lower end of the 95 % confidence interval of this pile's mean slope.
    pub confidence_low_degrees: f64,
    /// Upper end.
    pub confidence_high_degrees: f64,
    /// Slope of the cone of the same volume and height.
    pub by_volume_degrees: f64,
    /// Height of the highest cell above the mean height of the base: read at the centres of cells,
    /// up to about half a cell below the highest corner.
    pub pile_height_mm: f64,
    /// Radius at which the mean of the fitted lines meets the base.
    pub base_radius_mm: f64,
    /// Radii between which the lines are fitted.
    pub flank_radii_mm: [f64; 2],
    /// Volume under the pile's surface, voids included.
    pub volume_cm3: f64,
    /// Where the pile's axis stands.
    pub axis_mm: [f64; 2],
    /// Grains that fell off the base's edge.
    pub fallen_off: usize,
    /// The sectors, in turn from the direction of x.
    pub by_azimuth: Vec<AzimuthAngle>,
}

/// The slope of one sector of a pile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AzimuthAngle {
    /// Direction of the sector's middle, counter-clockwise from x.
    pub azimuth_degrees: f64,
    /// Its slope; null where it has no flank.
    pub degrees: Option<f64>,
    /// Radius at which its fitted line meets the base, negative where the flank does not fall
    /// outwards; null where it does not meet it.
    pub toe_radius_mm: Option<f64>,
}

/// Penetration depth over the mean equivalent diameter of the two grains, in percent; NaN, and null
/// in files, where no grain is left.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Overlap {
    /// Number of overlapping pairs of grains.
    pub pairs: usize,
    /// Mean over overlapping pairs.
    #[serde(deserialize_with = "nan_where_null")]
    pub mean_percent: f64,
    /// 99th percentile.
    #[serde(deserialize_with = "nan_where_null")]
    pub p99_percent: f64,
    /// Largest.
    #[serde(deserialize_with = "nan_where_null")]
    pub max_percent: f64,
    /// Largest, in mm.
    #[serde(deserialize_with = "nan_where_null")]
    pub max_mm: f64,
}

impl Overlap {
    /// What stands in the place of the overlap of no grains.
    pub fn of_none() -> Self {
        let [mean_percent, p99_percent, max_percent, max_mm] = [f64::NAN; 4];
        Self { pairs: 0, mean_percent, p99_percent, max_percent, max_mm }
    }

    /// The same where it is that of grains.
    pub fn known(self) -> Option<Self> {
        Some(self).filter(|of| !of.mean_percent.is_nan())
    }
}

/// The rest test: the finished specimen left alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RestTest {
    /// Length in s.
    pub duration_s: f64,
    /// Drop of the mean grain height in mm; null in a laboratory of pieces without grains.
    pub mean_grain_height_drop_mm: Option<f64>,
    /// Drop of the mean surface in mm; null in a laboratory of pieces.
    pub mean_surface_drop_mm: Option<f64>,
    /// Drop of the plate in mm, where there is one.
    pub plate_drop_mm: Option<f64>,
}

#[cfg(test)]
pub(super) mod tests {
    use serde_json::{Value, json};

    use super::*;

    /// A summary by the two things that decide whether it is valid.
    pub(in crate::record) fn summary(meets_standard: bool, passed: Option<bool>) -> Summary {
        let check = |passed: Option<bool>| {
            json!({ "watches": "w", "unit": "u", "looks": 1, "worst": 1.0, "limit": 1.0,
                "worst_at_s": null, "first_beyond_s": null, "passed": passed })
        };
        let mut checks = json!({ "passed": passed });
        for name in
            ["finite", "lost", "through_walls", "speed", "overlap_mean", "overlap_p99", "creep"]
        {
            checks[name] = check(Some(true));
        }
        checks["energy"] = check(passed);
        let value: Value = json!({
            "scenario": "s", "backend": { "name": "b", "version": "1", "precision": "double" },
            "contact_solver": "p", "seed": 1, "configuration": 1, "falling_height_mm": null,
            "grains": { "count": 1, "mass_g": 1.0, "solids_volume_cm3": 1.0, "in_cylinder": 1,
                "mass_in_cylinder_g": 1.0, "escaped": 0, "spilled": 0, "left_in_funnel": 0 },
            "standing_height_mm": { "mean_surface": 1.0, "p95": 1.0, "highest": 1.0 },
            "poured_height_mm": null, "void_ratio": null, "poured_void_ratio": null,
            "porosity": null, "settlement_mm": null, "surface_settlement_mm": null,
            "overlap": { "pairs": 0, "mean_percent": 0.0, "p99_percent": 0.0,
                "max_percent": 0.0, "max_mm": 0.0 },
            "coordination_number": 0.0, "creep_um_per_s": null, "rest_test": null,
            "meets_standard": meets_standard, "checks": checks, "kinetic_energy_j": 0.0,
            "simulated_s": 1.0, "steps": 1, "wall_s": 1.0, "engine_s": 1.0,
            "peak_memory_mib": 1.0, "warnings": [],
        });
        serde_json::from_value(value).expect("a summary without `valid` is read")
    }

    /// Law: a run is valid exactly where the standard is met and no check found anything.
    #[test]
    fn a_run_is_valid_where_the_standard_is_met_and_no_check_found_anything() {
        for (meets, passed, reasons) in [
            (true, Some(true), &[][..]),
            (true, None, &[]),
            (false, Some(true), &["standard"]),
            (true, Some(false), &["energy"]),
            (false, Some(false), &["standard", "energy"]),
        ] {
            let read = summary(meets, passed);
            assert!(!read.valid, "law: what does not say that it is valid is not");
            let why = read.why_not_valid();
            let got = read.judged();
            let case = format!("standard met: {meets}, checks passed: {passed:?}");
            assert_eq!(got.valid, reasons.is_empty(), "law: {case}, got {why:?}");
            assert_eq!(why.is_none(), reasons.is_empty(), "law: {case}, got {why:?}");
            let why = why.unwrap_or_default();
            assert!(reasons.iter().all(|r| why.contains(r)), "law: {case}, got `{why}`");
            let written = serde_json::to_value(&got).expect("JSON");
            assert_eq!(written["valid"], json!(got.valid), "law: summary.json says so");
        }
    }

    /// Law: the overlap of no grains is null in files, and is read back as none.
    #[test]
    fn an_overlap_of_no_grains_is_null() {
        let written = serde_json::to_value(Overlap::of_none()).expect("JSON");
        let expected = json!({ "pairs": 0, "mean_percent": null, "p99_percent": null,
            "max_percent": null, "max_mm": null });
        assert_eq!(written, expected, "law: left what is written, right what is expected");
        let read: Overlap = serde_json::from_value(written).expect("it is read");
        assert_eq!((read.pairs, read.known()), (0, None), "law: none");
        let of_some = Overlap::default();
        assert_eq!(of_some.known(), Some(of_some), "law: grains that lie apart have one");
    }

    #[test]
    fn residuals_are_ranked() {
        let of = |samples: &[f64]| SolverResidual::of(samples.iter().copied());
        assert_eq!(of(&[]), None, "law: no sample, no residual");
        let hundred: Vec<f64> = (1..=200).rev().map(f64::from).collect();
        let got = of(&hundred).expect("some");
        assert_eq!((got.median, got.p99, got.worst), (100.0, 198.0, 200.0));
        assert_eq!(of(&[3.0]).map(|r| (r.median, r.p99, r.worst)), Some((3.0, 3.0, 3.0)));
    }
}
