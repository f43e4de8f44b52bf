//! Triaxial compression: deviator and mean stress, and the state in which grains go on to be
//! sheared as they are.

use pluvia::measure::statistics::least_squares_slope;

use super::mean_of;

/// A moment of a triaxial test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triaxial {
    /// Axial strain: how much lower the specimen is than at the beginning, over its height then.
    pub strain: f64,
    /// Normal stresses in Pa along x, y and z, the axis; compression is positive.
    pub stress: [f64; 3],
    /// Void ratio.
    pub void_ratio: f64,
}

/// Means over the end of a triaxial test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalState {
    /// M = q/p.
    pub ratio: f64,
    /// Void ratio.
    pub void_ratio: f64,
    /// By how much the void ratio still rises for an axial strain of 1.
    pub dilation: f64,
}

impl Triaxial {
    /// Deviator stress q = σ_z − (σ_x + σ_y)/2 in Pa.
    pub fn deviator(&self) -> f64 {
        let [x, y, z] = self.stress;
        z - (x + y) / 2.0
    }

    /// Mean stress p in Pa.
    pub fn mean(&self) -> f64 {
        self.stress.iter().sum::<f64>() / 3.0
    }

    /// q/p.
    pub fn ratio(&self) -> f64 {
        self.deviator() / self.mean()
    }
}

/// The state at the end: means over what lies beyond an axial strain. `None` where fewer than three
/// moments do.
pub fn critical_state(moments: &[Triaxial], from: f64) -> Option<CriticalState> {
    let end: Vec<&Triaxial> = moments.iter().filter(|m| m.strain >= from).collect();
    if end.len() < 3 {
        return None;
    }
    let points: Vec<(f64, f64)> = end.iter().map(|m| (m.strain, m.void_ratio)).collect();
    Some(CriticalState {
        ratio: mean_of(end.iter().map(|m| m.ratio())),
        void_ratio: mean_of(end.iter().map(|m| m.void_ratio)),
        dilation: least_squares_slope(&points).unwrap_or(0.0),
    })
}

/// The largest mean q/p of `together` moments in succession. `None` where there are fewer.
pub fn peak_ratio(moments: &[Triaxial], together: usize) -> Option<f64> {
    let means = moments.windows(together.max(1)).map(|w| mean_of(w.iter().map(Triaxial::ratio)));
    means.max_by(f64::total_cmp)
}

/// How far p is from what it was at the first moment, as the root of the mean square over all
/// moments, over what it was. `None` without moments.
pub fn mean_stress_deviation(moments: &[Triaxial]) -> Option<f64> {
    let before = moments.first()?.mean();
    let squares = moments.iter().map(|m| (m.mean() / before - 1.0).powi(2));
    Some(mean_of(squares).sqrt())
}

/// Friction angle in rad of M = q/p in triaxial compression: sin φ = 3M/(6 + M).
pub fn angle_of_ratio(ratio: f64) -> f64 {
    (3.0 * ratio / (6.0 + ratio)).asin()
}

#[cfg(test)]
mod tests {
    use super::super::near;
    use super::*;

    fn moment(strain: f64, axial: f64, void_ratio: f64) -> Triaxial {
        Triaxial { strain, stress: [90.0, 110.0, axial], void_ratio }
    }

    #[test]
    fn q_and_p_are_those_of_the_principal_stresses() {
        let one = moment(0.1, 400.0, 0.8);
        near("400 − 100", one.deviator(), 300.0);
        near("600/3", one.mean(), 200.0);
        near("q/p", one.ratio(), 1.5);
        near("isotropic", moment(0.0, 100.0, 0.8).ratio(), 0.0);
    }

    #[test]
    fn a_mean_stress_that_is_kept_deviates_by_nothing() {
        // p is 200 with an axial stress of 400, 300 with 700.
        let kept = [moment(0.0, 400.0, 0.6), moment(0.1, 400.0, 0.7)];
        let risen = [moment(0.0, 400.0, 0.6), moment(0.1, 700.0, 0.7)];
        near("kept", mean_stress_deviation(&kept).expect("moments"), 0.0);
        let half = mean_stress_deviation(&risen).expect("moments");
        near("half as much again in one of two", half, 0.5 / 2.0f64.sqrt());
        assert_eq!(mean_stress_deviation(&[]), None, "law: nothing is kept without moments");
    }

    #[test]
    fn the_angle_of_a_ratio_is_that_of_the_circles_of_mohr() {
        for degrees in [0.0, 20.0, 38.4, 50.0f64] {
            let sine = degrees.to_radians().sin();
            // σ_1/σ_3 = (1 + sin φ)/(1 − sin φ).
            let stress = [1.0, 1.0, (1.0 + sine) / (1.0 - sine)];
            let state = Triaxial { strain: 0.0, stress, void_ratio: 0.7 };
            near("φ", angle_of_ratio(state.ratio()).to_degrees(), degrees);
        }
    }

    #[test]
    fn the_end_is_the_mean_beyond_a_strain_and_the_peak_a_mean_in_succession() {
        let moments = [
            moment(0.0, 100.0, 0.60),
            moment(0.1, 400.0, 0.66),
            moment(0.2, 700.0, 0.70),
            moment(0.3, 400.0, 0.71),
            moment(0.4, 400.0, 0.73),
        ];
        let got = critical_state(&moments, 0.2).expect("an end");
        // 600/300, 300/200 twice.
        near("M", got.ratio, (2.0 + 1.5 + 1.5) / 3.0);
        near("e", got.void_ratio, (0.70 + 0.71 + 0.73) / 3.0);
        near("still rising", got.dilation, 0.15);
        near("two in succession", peak_ratio(&moments, 2).expect("a peak"), 1.75);
        assert_eq!(critical_state(&moments, 0.25), None, "law: two moments are no end");
        assert_eq!(peak_ratio(&moments, 6), None, "law: fewer moments than that");
    }
}
