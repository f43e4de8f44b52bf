//! `void_profile.csv`: void ratio by height and by radius. `distributions.csv`: contact forces and
//! coordination numbers.

use super::*;

/// A class of a distribution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DistributionRow {
    /// `normal_force` between grains over its mean, or `coordination`.
    pub of: &'static str,
    /// Middle of a class of forces over their mean; number of grains that a grain touches.
    pub value: f64,
    /// Share of the contacts, or of the grains, in percent.
    pub share_percent: f64,
}

/// The distributions of a summary.
pub fn distributions(summary: &Summary) -> Vec<DistributionRow> {
    let forces = summary.contacts.iter().flat_map(|contacts| &contacts.normal_force);
    let forces = forces.flat_map(|force| {
        let middle = |class: usize| force.class_width_of_mean * (class as f64 + 0.5);
        force.classes_percent.iter().enumerate().map(move |(class, share)| DistributionRow {
            of: "normal_force",
            value: middle(class),
            share_percent: *share,
        })
    });
    let counts = &summary.coordination_distribution;
    let grains: usize = counts.iter().sum();
    let coordination = counts.iter().enumerate().map(|(touched, count)| DistributionRow {
        of: "coordination",
        value: touched as f64,
        share_percent: 100.0 * *count as f64 / grains as f64,
    });
    forces.chain(coordination).collect()
}

/// A layer or a ring.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProfileRow {
    /// `specimen` of the built-in cylinder, or the name of a region.
    pub of: String,
    /// `height` of layers, `radius` of rings.
    pub by: &'static str,
    /// Where it begins in mm.
    pub from_mm: f64,
    /// Where it ends in mm.
    pub to_mm: f64,
    /// Its middle in mm.
    pub middle_mm: f64,
    /// Volume of voids over that of solids; empty where no grain is.
    pub void_ratio: Option<f64>,
    /// Volume of solids in it in mm³.
    pub solids_mm3: f64,
}
