//! What the cylinder holds: number, mass and mean height of its grains, and the voids between them.

use super::*;

/// The grains in the cylinder, added up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Content {
    /// Number of grains.
    pub grains: usize,
    /// Their mass in kg.
    pub mass: f64,
    /// Their solid volume in m³.
    pub volume: f64,
    /// Mean height of their centroids above the floor, every grain counting
    /// alike, in m; `None` without grains.
    pub mean_grain_height: Option<f64>,
}

/// Adds up the grains in the cylinder, see [`Container::members`].
pub fn content(specimen: &Specimen, container: &Container) -> Content {
    let members = container.members(specimen);
    let grains = &specimen.grains.grains;
    Content {
        grains: members.len(),
        mass: members.iter().map(|&i| grains[i].mass).sum(),
        volume: members.iter().map(|&i| grains[i].volume).sum(),
        mean_grain_height: mean_grain_height(specimen, &members),
    }
}

/// Mean height in m of the centroids of the grains with the given indices; `None` for no grains.
///
/// Numerical creep is the change of this mean over one fixed list of grains: a grain
/// that leaves the list would move the mean without anything sinking.
pub fn mean_grain_height(specimen: &Specimen, grains: &[usize]) -> Option<f64> {
    let heights: Vec<f64> = grains.iter().map(|&i| specimen.centroid(i).z).collect();
    statistics::mean(&heights)
}

/// How much of the specimen is empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Voids {
    /// Volume of voids over volume of solids.
    pub void_ratio: f64,
    /// Volume of voids over total volume.
    pub porosity: f64,
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
    let solids = content(specimen, container).volume;
    let whole = container.area() * mean_surface;
    let positive = |v: f64| v.is_finite() && v > 0.0;
    (positive(solids) && positive(whole))
        .then(|| Voids { void_ratio: whole / solids - 1.0, porosity: 1.0 - solids / whole })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{DENSITY, assert_near, cube, specimen_of};
    use super::*;
    use crate::geometry::Pose;

    const CUP: Container = Container { centre_x: 0.0, radius: 0.05, height: 0.1 };

    #[test]
    fn sums_over_the_cylinder_only() {
        let specimen = specimen_of(vec![
            (cube(0.01), Pose::translation(0.0, 0.0, 0.01)),
            (cube(0.02), Pose::translation(0.0, 0.0, 0.04)),
            (cube(0.03), Pose::translation(0.2, 0.0, 0.07)),
        ]);
        let got = content(&specimen, &CUP);
        assert_eq!(got.grains, 2);
        assert_near("volume", 9e-6, got.volume, 1e-18);
        assert_near("mass", 9e-6 * DENSITY, got.mass, 1e-14);
        let height = got.mean_grain_height.unwrap();
        assert_near("mean of centroids, not weighted", 0.025, height, 1e-15);
        let all = mean_grain_height(&specimen, &[0, 1, 2]).unwrap();
        assert_near("mean over a given list", 0.04, all, 1e-15);
    }

    #[test]
    fn empty_cylinder() {
        let got = content(&specimen_of(vec![]), &CUP);
        assert_eq!(got, Content { grains: 0, mass: 0.0, volume: 0.0, mean_grain_height: None });
    }

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
