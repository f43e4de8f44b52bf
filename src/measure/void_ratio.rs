//! Void ratio and porosity of the specimen in the cylinder.

use super::*;

/// How much of the specimen is empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Voids {
    /// Volume of voids over volume of solids.
    pub void_ratio: f64,
    /// Volume of voids over total volume.
    pub porosity: f64,
    /// Volume of the grains in the cylinder, in m³.
    pub solids_volume: f64,
    /// Cross-section of the cylinder times mean surface height, in m³.
    pub total_volume: f64,
}

/// Void ratio e = V/Vₛ − 1 and porosity n = 1 − Vₛ/V of the grains in the
/// cylinder (Lambe and Whitman, "Soil Mechanics", chapter 3).
///
/// V is the cylinder's cross-section times `mean_surface` (m, see
/// [`super::StandingHeight`]); Vₛ the sum of the grains' own volumes, as a
/// balance would give it, so that overlap of grains makes e smaller.
///
/// `None` when there is no grain, or no positive height, to divide by.
pub fn void_ratio(specimen: &Specimen, container: &Container, mean_surface: f64) -> Option<Voids> {
    let solids_volume: f64 =
        container.members(specimen).iter().map(|&i| specimen.grains.grains[i].volume).sum();
    let total_volume = container.area() * mean_surface;
    let positive = |v: f64| v.is_finite() && v > 0.0;
    (positive(solids_volume) && positive(total_volume)).then(|| Voids {
        void_ratio: total_volume / solids_volume - 1.0,
        porosity: 1.0 - solids_volume / total_volume,
        solids_volume,
        total_volume,
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_near, cube, specimen_of};
    use super::*;
    use crate::geometry::Pose;

    const CUP: Container = Container { centre_x: 0.0, radius: 0.05, height: 0.1 };

    /// Law: eight cubes of 1 cm³ under a mean height of 8 mm in a cylinder of
    /// area A: e = A · 8 mm / 8 cm³ − 1, and n = e/(1 + e).
    #[test]
    fn cubes_in_a_cylinder() {
        let grains = (0..9).map(|i| {
            let x = if i == 8 { 1.0 } else { 0.0 };
            (cube(0.01), Pose::translation(x, 0.0, 0.01 * f64::from(i + 1)))
        });
        let specimen = specimen_of(grains.collect());
        let got = void_ratio(&specimen, &CUP, 0.008).unwrap();
        let expected = std::f64::consts::PI * 0.05 * 0.05 * 0.008 / 8e-6 - 1.0;
        assert_near("void ratio, ninth cube outside", expected, got.void_ratio, 1e-12);
        assert_near("n = e/(1+e)", expected / (1.0 + expected), got.porosity, 1e-12);
        assert_near("solids", 8e-6, got.solids_volume, 1e-18);
    }

    #[test]
    fn nothing_to_divide_by() {
        let outside = specimen_of(vec![(cube(0.01), Pose::translation(1.0, 0.0, 0.01))]);
        assert_eq!(void_ratio(&outside, &CUP, 0.01), None, "no solids");
        let inside = specimen_of(vec![(cube(0.01), Pose::translation(0.0, 0.0, 0.01))]);
        assert_eq!(void_ratio(&inside, &CUP, 0.0), None, "no height");
        assert_eq!(void_ratio(&inside, &CUP, f64::NAN), None, "no number");
    }
}
