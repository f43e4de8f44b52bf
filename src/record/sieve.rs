//! Sieve analysis and shape of the grains, as `summary.json` has them.

use super::*;
use crate::grains::{Gradation, ParticleSizeDistribution, SieveAnalysis};
use crate::units::to_typed_mm;

/// Change of a sieve size, as a fraction of it, up to which a grain counts as the same. Engines
/// hold shapes in single precision, which rounds a corner by up to 6e-8 of the grain's size, and
/// the sieve is proven to 1e-9; a chip of a hundredth of a micrometre off a 10 mm grain is noticed.
pub const UNCHANGED: f64 = 1e-6;

/// What soil mechanics reads off a grain size distribution curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GradationSummary {
    /// Size that 10 % of the mass is finer than, in mm.
    pub d10_mm: f64,
    /// Size that 30 % of the mass is finer than, in mm.
    pub d30_mm: f64,
    /// Size that 50 % of the mass is finer than, in mm.
    pub d50_mm: f64,
    /// Size that 60 % of the mass is finer than, in mm.
    pub d60_mm: f64,
    /// D60 / D10.
    pub coefficient_of_uniformity: f64,
    /// D30² / (D10 · D60).
    pub coefficient_of_curvature: f64,
    /// Group symbol of the Unified Soil Classification System, such as `GP`.
    pub uscs: String,
}

impl From<Gradation> for GradationSummary {
    fn from(g: Gradation) -> Self {
        Self {
            d10_mm: to_mm(g.d10),
            d30_mm: to_mm(g.d30),
            d50_mm: to_mm(g.d50),
            d60_mm: to_mm(g.d60),
            coefficient_of_uniformity: g.uniformity,
            coefficient_of_curvature: g.curvature,
            uscs: g.uscs.to_owned(),
        }
    }
}

/// The grains in the virtual sieve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SieveSummary {
    /// Of the grains as generated.
    #[serde(flatten)]
    pub generated: GradationSummary,
    /// Of the sieve table they were made from; null where there is none.
    pub specified: Option<GradationSummary>,
    /// What stays on each sieve, coarsest first, what passes the finest last.
    pub fractions: Vec<SievedFraction>,
    /// The grains sieved anew after the run; null where the engine could not be asked.
    pub secondary: Option<SecondarySieve>,
}

/// What passes one sieve and stays on the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SievedFraction {
    /// Opening of the sieve it passes, in mm; null for what stays on the coarsest.
    pub passing_mm: Option<f64>,
    /// Opening of the sieve it stays on, in mm; null for what passes the finest.
    pub retained_mm: Option<f64>,
    /// Share of the mass in percent, as the sieve table asks for it.
    pub specified_percent: f64,
    /// Share of the mass in percent, found by sieving.
    pub mass_percent: f64,
    /// Number of grains found.
    pub grains: usize,
}

impl SieveSummary {
    /// Sums up grains as generated, beside the distribution they were made from.
    pub fn of(sieved: &SieveAnalysis, specified: Option<&ParticleSizeDistribution>) -> Self {
        Self {
            generated: sieved.gradation().into(),
            specified: specified.map(|s| s.gradation().into()),
            fractions: specified.map_or_else(Vec::new, |s| fractions(sieved, s)),
            secondary: None,
        }
    }
}

fn fractions(sieved: &SieveAnalysis, psd: &ParticleSizeDistribution) -> Vec<SievedFraction> {
    let total: f64 = sieved.grains().iter().map(|g| g.mass).sum();
    let row = |passing: Option<f64>, retained: Option<f64>, specified_percent| {
        let (grains, mass) =
            sieved.between(passing.unwrap_or(f64::INFINITY), retained.unwrap_or(0.0));
        SievedFraction {
            passing_mm: passing.map(to_typed_mm),
            retained_mm: retained.map(to_typed_mm),
            specified_percent,
            mass_percent: 100.0 * mass / total,
            grains,
        }
    };
    let ends = psd.fractions.first().zip(psd.fractions.last());
    let mut rows: Vec<SievedFraction> =
        ends.map(|(coarsest, _)| row(None, Some(coarsest.passing), 0.0)).into_iter().collect();
    rows.extend(
        psd.fractions.iter().map(|f| row(Some(f.passing), Some(f.retained), f.mass_percent)),
    );
    rows.extend(ends.map(|(_, finest)| row(Some(finest.retained), None, 0.0)));
    rows
}

/// The grains sieved anew, with the shapes that the engine held at the end of
/// a run, against the grains as generated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SecondarySieve {
    /// Grains that were sieved.
    pub grains: usize,
    /// Those of them whose sieve size is another than before.
    pub changed: usize,
    /// Grains that are nowhere: not in the engine, and neither spilled over
    /// the rim nor left in the funnel. One that passed a wall is lost.
    pub lost: usize,
    /// Grains that spilled over the rim, which are not sieved.
    pub spilled: usize,
    /// Grains that hung in the funnel when it was taken away, which are not sieved.
    pub left_in_funnel: usize,
    /// Largest change of any grain's sieve size, in percent of it; null where one is no number.
    pub largest_change_percent: Option<f64>,
    /// Of the grains that were sieved; null where there are none.
    pub gradation: Option<GradationSummary>,
    /// Whether no grain changed and none was lost.
    pub unchanged: bool,
}

impl SecondarySieve {
    /// Compares what was found of each grain, its sieve size in mm or the fate of one that was not
    /// sieved, with the grains before. Grains that nothing is said of are lost; what was found
    /// beyond the grains before counts as changed.
    pub fn of(before: &[Sieved], found: &[Result<f64, Fate>]) -> Self {
        let mut after = Vec::with_capacity(before.len());
        let (mut grains, mut changed, mut largest) = (0, 0, Some(0.0_f64));
        for (grain, size_mm) in
            before.iter().zip(found).filter_map(|(g, f)| Some((g, *f.as_ref().ok()?)))
        {
            let change = (size_mm / to_mm(grain.size) - 1.0).abs();
            // Not `>`: what is no number is no grain that was there before.
            if !(change <= UNCHANGED) {
                changed += 1;
            }
            // `max` passes over what is no number, and a curve has no place for it.
            largest = largest.filter(|_| change.is_finite()).map(|most| most.max(change));
            if size_mm.is_finite() {
                after.push(Sieved { size: from_mm(size_mm), mass: grain.mass });
            }
            grains += 1;
        }
        let count = |fates: &[Fate]| {
            found.iter().filter(|f| f.is_err_and(|fate| fates.contains(&fate))).count()
        };
        let added = found.iter().skip(before.len()).filter(|f| f.is_ok()).count();
        // What takes part must be in the engine.
        let lost =
            count(&[Fate::Present, Fate::ThroughWall]) + before.len().saturating_sub(found.len());
        changed += added;
        Self {
            grains: grains + added,
            changed,
            lost,
            spilled: count(&[Fate::Spilled]),
            // What was not fed was left behind as well.
            left_in_funnel: count(&[Fate::LeftInFunnel, Fate::Waiting]),
            largest_change_percent: largest.map(|most| 100.0 * most),
            gradation: (!after.is_empty()).then(|| SieveAnalysis::new(after).gradation().into()),
            unchanged: changed == 0 && lost == 0,
        }
    }

    /// What a reader must know; none where the grains are as they were.
    pub fn warning(&self) -> Option<String> {
        if self.unchanged {
            return None;
        }
        let most = self.largest_change_percent;
        let most = most.map_or("what is no number".to_owned(), |most| format!("{most:.2e} %"));
        // Where none has changed, the largest change is rounding.
        let by = if self.changed > 0 { format!(" (by up to {most})") } else { String::new() };
        Some(format!(
            "the secondary sieve analysis does not find the grains as they were: {} of {} {} \
             another sieve size{by}, lost: {}",
            self.changed,
            self.grains,
            in_number(self.changed, "has", "have"),
            self.lost
        ))
    }
}

/// Shape of the grains (docs/grains.md has the definitions).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShapeSummary {
    /// Longest over intermediate side of the smallest box, at least 1 (after Zingg 1935).
    pub elongation: Spread,
    /// Intermediate over shortest side of the smallest box, at least 1 (after Zingg 1935).
    pub flatness: Spread,
    /// Surface of the sphere of the same volume over the surface (Wadell 1932).
    pub sphericity: Spread,
    /// Mean radius of curvature of the corners over the radius of the largest sphere inside
    /// (Wadell 1932); left out where it is 0 for all, as for polyhedra that are not rounded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roundness: Option<Spread>,
    /// Number of faces.
    pub faces: Spread,
    /// Number of vertices.
    pub vertices: Spread,
}

/// How a number is spread over grains, each counted once.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// 10th percentile: the smallest value that a tenth of the grains do not exceed.
    pub p10: f64,
    /// Median.
    pub p50: f64,
    /// 90th percentile.
    pub p90: f64,
}

impl Spread {
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        let n = values.len();
        let at = |percent: usize| values.get((n * percent).div_ceil(100).max(1) - 1).copied();
        Some(Self {
            mean: values.iter().sum::<f64>() / n as f64,
            p10: at(10)?,
            p50: at(50)?,
            p90: at(90)?,
        })
    }
}

impl ShapeSummary {
    /// Sums up shapes; `None` without grains.
    pub fn of(shapes: &[GrainShape]) -> Option<Self> {
        let ratio = |ratio| Spread::of(shapes.iter().map(|s| s.ratio(ratio)));
        Some(Self {
            elongation: ratio(ShapeRatio::Elongation)?,
            flatness: ratio(ShapeRatio::Flatness)?,
            sphericity: ratio(ShapeRatio::Sphericity)?,
            roundness: Spread::of(shapes.iter().map(|s| s.roundness)).filter(|s| s.mean > 0.0),
            faces: Spread::of(shapes.iter().map(|s| s.faces as f64))?,
            vertices: Spread::of(shapes.iter().map(|s| s.vertices as f64))?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::SievedGrains;

    fn grains() -> Vec<Sieved> {
        (1..=10).map(|n| Sieved { size: 1e-3 * f64::from(n), mass: 1e-3 }).collect()
    }

    fn found() -> Vec<Result<f64, Fate>> {
        (1..=10).map(|n| Ok(f64::from(n))).collect()
    }

    #[test]
    fn what_comes_back_the_same_is_unchanged() {
        let secondary = SecondarySieve::of(&grains(), &found());
        assert!(secondary.unchanged, "{secondary:?}");
        assert_eq!((secondary.grains, secondary.changed, secondary.lost), (10, 0, 0));
        let gradation: GradationSummary = SieveAnalysis::new(grains()).gradation().into();
        assert_eq!(secondary.gradation, Some(gradation), "law: that of the grains before");
        // Grains whose whereabouts are known are not lost.
        let mut some = found();
        (some[2], some[5]) = (Err(Fate::Spilled), Err(Fate::LeftInFunnel));
        let secondary = SecondarySieve::of(&grains(), &some);
        assert!(secondary.unchanged && secondary.grains == 8, "{secondary:?}");
        assert_eq!((secondary.spilled, secondary.left_in_funnel), (1, 1));
    }

    /// Law: where grains are lost and none has changed, no change is reported.
    #[test]
    fn a_lost_grain_is_no_change_of_size() {
        let of = |third| {
            let mut found = found();
            found[2] = third;
            SecondarySieve::of(&grains(), &found).warning()
        };
        assert_eq!(of(Ok(3.0)), None, "law: as they were");
        let lost = of(Err(Fate::ThroughWall)).expect("law: a warning");
        assert!(lost.ends_with(": 0 of 9 have another sieve size, lost: 1"), "got {lost}");
        let chipped = of(Ok(1.5)).expect("law: a warning");
        let said = ": 1 of 10 has another sieve size (by up to 5.00e1 %), lost: 0";
        assert!(chipped.ends_with(said), "got {chipped}");
    }

    #[test]
    fn a_chip_a_lost_grain_and_an_additional_one_are_noticed() {
        for factor in [1.0 - 2.0 * UNCHANGED, 1.0 + 2.0 * UNCHANGED, 0.5, f64::NAN] {
            let mut found = found();
            found[3] = Ok(4.0 * factor);
            let secondary = SecondarySieve::of(&grains(), &found);
            assert!(!secondary.unchanged && secondary.changed == 1, "{factor}: {secondary:?}");
        }
        for factor in [1.0 - UNCHANGED / 2.0, 1.0 + UNCHANGED / 2.0] {
            let mut found = found();
            found[3] = Ok(4.0 * factor);
            let secondary = SecondarySieve::of(&grains(), &found);
            assert!(secondary.unchanged, "rounding is no change, {factor}: {secondary:?}");
        }
        let mut lost = found();
        lost[3] = Err(Fate::Present);
        let secondary = SecondarySieve::of(&grains(), &lost);
        assert!(!secondary.unchanged && secondary.lost == 1, "{secondary:?}");
        let secondary = SecondarySieve::of(&grains(), &found()[..9]);
        assert!(!secondary.unchanged && secondary.lost == 1, "{secondary:?}");
        // Broken in two: one grain is smaller, and there is one more.
        let mut broken = found();
        broken[9] = Ok(8.0);
        broken.push(Ok(6.0));
        let secondary = SecondarySieve::of(&grains(), &broken);
        assert!(!secondary.unchanged && secondary.changed == 2, "{secondary:?}");
        assert_eq!(secondary.grains, 11);
    }

    /// Law: a size that is no number is a change, wherever it stands: it is not passed over for the
    /// next grain's, and numbers of the summary stay numbers, or are null, so that it can be read
    /// again; also where no grain was sieved.
    #[test]
    fn what_is_no_number_is_not_passed_over() {
        let read_again = |secondary: &SecondarySieve| {
            let text = serde_json::to_string(secondary).expect("JSON");
            serde_json::from_str::<SecondarySieve>(&text).map_err(|e| e.to_string())
        };
        for (place, size) in [(0, f64::NAN), (4, f64::NAN), (9, f64::NAN), (4, f64::INFINITY)] {
            let mut found = found();
            found[place] = Ok(size);
            let secondary = SecondarySieve::of(&grains(), &found);
            let case = format!("grain {place} of {size} mm: {secondary:?}");
            assert_eq!((secondary.grains, secondary.changed), (10, 1), "law: it changed, {case}");
            assert_eq!(secondary.largest_change_percent, None, "law: by no number, {case}");
            assert_eq!(read_again(&secondary), Ok(secondary.clone()), "law: it reads, {case}");
        }
        let spilled = SecondarySieve::of(&grains(), &[Err(Fate::Spilled); 10]);
        assert_eq!((spilled.grains, spilled.gradation.clone()), (0, None), "law: none was sieved");
        assert_eq!(read_again(&spilled), Ok(spilled.clone()), "law: it reads without grains");
    }

    /// Law: sieves have the openings that were typed.
    #[test]
    fn openings_are_those_that_were_typed() {
        let typed: SievedGrains = serde_json::from_value(serde_json::json!({
            "total_mass_g": 100, "density_kg_per_m3": 2650,
            "sieve_table": [
                { "passing_mm": 4.75, "retained_mm": 2.36, "mass_percent": 50 },
                { "passing_mm": 2.36, "retained_mm": 1.18, "mass_percent": 50 }
            ]
        }))
        .expect("sieved grains");
        let psd = ParticleSizeDistribution::new(&typed);
        let rows = fractions(&SieveAnalysis::new(grains()), &psd.expect("a distribution"));
        let openings: Vec<_> = rows.iter().map(|row| (row.passing_mm, row.retained_mm)).collect();
        let [a, b, c] = [4.75, 2.36, 1.18].map(Some);
        assert_eq!(
            openings,
            [(None, a), (a, b), (b, c), (c, None)],
            "law: 1.18, not 1.1800000000000002"
        );
    }

    #[test]
    fn percentiles_of_ten_numbers() {
        let s = Spread::of((1..=10).map(f64::from)).expect("ten numbers");
        assert_eq!((s.mean, s.p10, s.p50, s.p90), (5.5, 1.0, 5.0, 9.0));
        assert!(Spread::of(std::iter::empty()).is_none(), "no numbers have no mean");
    }
}
