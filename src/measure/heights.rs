//! Number, mass and mean height of the grains in the cylinder.

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

/// Mean height in m of the centroids of the grains with the given indices;
/// `None` for no grains.
///
/// Creep is the change of this mean over one fixed list of grains: a grain
/// that leaves the list would move the mean without anything sinking.
pub fn mean_grain_height(specimen: &Specimen, grains: &[usize]) -> Option<f64> {
    let heights: Vec<f64> = grains.iter().map(|&i| specimen.centroid(i).z).collect();
    statistics::mean(&heights)
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
}
