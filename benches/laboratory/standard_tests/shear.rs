//! Direct shear: stress ratio and dilation against displacement, and the friction angles of
//! several stresses together.

use pluvia::measure::statistics::least_squares_slope;

use super::mean_of;

/// A moment of a direct shear test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheared {
    /// How far the halves have been displaced, in m.
    pub displacement: f64,
    /// Force along the plane of shear in N.
    pub shear: f64,
    /// Force across it in N.
    pub normal: f64,
    /// Height of the lid in m.
    pub height: f64,
}

/// What a direct shear test gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShearStrength {
    /// Largest stress ratio, mean over some moments in succession.
    pub peak: f64,
    /// Rise of the lid over displacement there.
    pub dilation: f64,
    /// Mean stress ratio over the last part of the displacement.
    pub end: f64,
    /// Rise of the lid over displacement there.
    pub dilation_at_end: f64,
}

impl ShearStrength {
    /// The stress ratio at the end less that by which grains lift the lid: of the work τ du that
    /// shears a layer, σ dh lifts it, and friction takes the rest (Taylor 1948, "Fundamentals of
    /// Soil Mechanics"). It is the critical state's where friction takes as much as there.
    pub fn end_without_dilation(&self) -> f64 {
        self.end - self.dilation_at_end
    }
}

impl Sheared {
    /// Shear over normal force: τ/σ, both on the same area.
    pub fn ratio(&self) -> f64 {
        self.shear / self.normal
    }
}

/// Part of the full speed below which halves slow down.
const SLOW: f64 = 0.99;

/// Moments of a test from its samples in the order of their times in s, whose forces are means
/// since the sample before: half way between samples, where these forces belong. What lies at the
/// end, where the halves slow down and stand, is left out.
pub fn between_samples(samples: &[(f64, Sheared)]) -> Vec<Sheared> {
    let fastest = samples.windows(2).map(speed).fold(0.0, f64::max);
    let slow = samples.windows(2).rev().take_while(|pair| speed(pair) < SLOW * fastest).count();
    let moment = |pair: &[(f64, Sheared)]| {
        let (before, now) = (pair[0].1, pair[1].1);
        let displacement = 0.5 * (before.displacement + now.displacement);
        Sheared { displacement, height: 0.5 * (before.height + now.height), ..now }
    };
    let intervals = samples.windows(2);
    let count = intervals.len() - slow;
    intervals.take(count).map(moment).collect()
}

/// Speed in m/s between a sample and the next.
fn speed(pair: &[(f64, Sheared)]) -> f64 {
    (pair[1].1.displacement - pair[0].1.displacement) / (pair[1].0 - pair[0].0)
}

/// Peak and end state of a test. The peak is the largest mean of `together` moments in succession,
/// the end state the mean over what lies beyond `end_from` m. `None` where there are fewer than
/// `together` moments in all, or than two beyond `end_from`.
pub fn shear_strength(
    moments: &[Sheared],
    together: usize,
    end_from: f64,
) -> Option<ShearStrength> {
    let ratio = |of: &[Sheared]| mean_of(of.iter().map(Sheared::ratio));
    let windows = moments.windows(together.max(1));
    let peak = windows.max_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
    let end = &moments[moments.partition_point(|m| m.displacement < end_from)..];
    if end.len() < 2 {
        return None;
    }
    Some(ShearStrength {
        peak: ratio(peak),
        dilation: slope(peak),
        end: ratio(end),
        dilation_at_end: slope(end),
    })
}

/// Slope of height over displacement by least squares; 0 of one moment alone.
fn slope(moments: &[Sheared]) -> f64 {
    let points: Vec<(f64, f64)> = moments.iter().map(|m| (m.displacement, m.height)).collect();
    least_squares_slope(&points).unwrap_or(0.0)
}

/// Friction angle in rad of normal and shear stresses, or forces on one area, by regression through
/// the origin: tan φ = Σ στ/Σ σ². `None` without a normal stress.
pub fn friction_angle(stresses: &[(f64, f64)]) -> Option<f64> {
    let sum = |of: fn(f64, f64) -> f64| -> f64 { stresses.iter().map(|(s, t)| of(*s, *t)).sum() };
    let squares = sum(|s, _| s * s);
    (squares > 0.0).then(|| (sum(|s, t| s * t) / squares).atan())
}

/// Inertial number I = γ̇ d √(ρ/p) of grains of size d in m and density ρ in kg/m³ that are sheared
/// at a rate γ̇ in 1/s under a pressure p in Pa: the time that a grain takes to fall into a hole,
/// over that in which one is sheared past.
pub fn inertial_number(rate: f64, size: f64, density: f64, pressure: f64) -> f64 {
    rate * size * (density / pressure).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::near;
    use super::*;

    /// Ratio 100 μ over 100 N at displacements of whole mm, and the height in mm.
    fn test_of(points: &[(f64, f64)]) -> Vec<Sheared> {
        points
            .iter()
            .enumerate()
            .map(|(n, (ratio, height_mm))| Sheared {
                displacement: 1e-3 * n as f64,
                shear: 100.0 * ratio,
                normal: 100.0,
                height: 1e-3 * height_mm,
            })
            .collect()
    }

    #[test]
    fn peak_and_end_are_means_of_moments_in_succession() {
        let moments = test_of(&[
            (0.0, 40.0),
            (0.9, 40.0),
            (1.1, 40.3),
            (1.0, 40.6),
            (0.7, 40.8),
            (0.6, 40.8),
            (0.8, 40.8),
        ]);
        let got = shear_strength(&moments, 3, 4.5e-3).expect("a test");
        near("the mean of 0.9, 1.1 and 1.0", got.peak, 1.0);
        near("0.6 mm up on 2 mm", got.dilation, 0.3);
        near("the mean of 0.6 and 0.8", got.end, 0.7);
        near("level at the end", got.dilation_at_end, 0.0);
        let alone = shear_strength(&moments, 1, 4.5e-3).expect("a test");
        near("one moment alone", alone.peak, 1.1);
        near("has no slope", alone.dilation, 0.0);
        assert_eq!(shear_strength(&moments, 8, 4e-3), None, "law: fewer moments than that");
        assert_eq!(shear_strength(&moments, 1, 5.5e-3), None, "law: one alone is no end state");
        assert_eq!(shear_strength(&[], 1, 0.0), None, "law: no test");
    }

    #[test]
    fn what_lifts_the_lid_is_no_friction() {
        let of =
            |dilation_at_end| ShearStrength { peak: 1.2, dilation: 0.3, end: 1.0, dilation_at_end };
        near("rising", of(0.2).end_without_dilation(), 0.8);
        near("still", of(0.0).end_without_dilation(), 1.0);
        near("sinking", of(-0.1).end_without_dilation(), 1.1);
    }

    #[test]
    fn forces_that_are_means_belong_to_the_middle_of_their_interval() {
        // 10 mm/s, then 0.5 mm in a ramp, then still.
        let moves = [(0.0, 0.0), (0.1, 1.0), (0.2, 2.0), (0.3, 3.0), (0.4, 3.5), (0.5, 3.5)];
        // The ratio is 0.1 for each mm, on average over an interval that of its middle.
        let mut before = 0.0;
        let samples = moves.map(|(time, mm)| {
            let middle = 0.5 * (before + mm);
            before = mm;
            let (displacement, height) = (1e-3 * mm, 0.04 + 2e-4 * mm);
            (time, Sheared { displacement, shear: 10.0 * middle, normal: 100.0, height })
        });
        let got = between_samples(&samples);
        assert_eq!(got.len(), 3, "law: three intervals at full speed, got {got:?}");
        for (moment, mm) in got.iter().zip([0.5, 1.5, 2.5]) {
            near("the middle of an interval", 1e3 * moment.displacement, mm);
            near("the ratio of that displacement", moment.ratio(), 0.1 * mm);
            near("the height there", moment.height, 0.04 + 2e-4 * mm);
        }
        assert!(between_samples(&samples[..1]).is_empty(), "law: one sample is no interval");
        assert!(between_samples(&[]).is_empty(), "law: no test");
    }

    #[test]
    fn an_angle_of_several_stresses_goes_through_the_origin() {
        let exact = friction_angle(&[(25.0, 20.0), (50.0, 40.0), (100.0, 80.0)]);
        near("τ = 0.8 σ", exact.expect("stresses"), 0.8f64.atan());
        // (1·2 + 2·1)/(1 + 4).
        near(
            "by least squares",
            friction_angle(&[(1.0, 2.0), (2.0, 1.0)]).expect("two"),
            0.8f64.atan(),
        );
        assert_eq!(friction_angle(&[]), None, "law: no stress");
        assert_eq!(friction_angle(&[(0.0, 1.0)]), None, "law: no normal stress");
    }

    #[test]
    fn the_inertial_number_is_that_of_its_formula() {
        // 0.5/s · 8 mm · √(2500/10 000) s/m.
        near("I", inertial_number(0.5, 8e-3, 2500.0, 1e4), 2e-3);
        near("a quarter of the pressure", inertial_number(0.5, 8e-3, 2500.0, 2.5e3), 4e-3);
    }
}
