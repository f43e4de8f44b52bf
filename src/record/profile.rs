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
    /// Unit of `value`: `of_mean` of forces, `grains` of the grains touched.
    pub unit: &'static str,
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
            unit: "of_mean",
        })
    });
    let counts = &summary.coordination_distribution;
    let grains: usize = counts.iter().sum();
    let coordination = counts.iter().enumerate().map(|(touched, count)| DistributionRow {
        of: "coordination",
        value: touched as f64,
        share_percent: 100.0 * *count as f64 / grains as f64,
        unit: "grains",
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: each row of the long table says in which unit its value is.
    #[test]
    fn every_value_of_the_distributions_has_its_unit() {
        let forces = ForceSummary {
            mean_n: 2.0,
            p10_of_mean: 0.1,
            p50_of_mean: 0.9,
            p90_of_mean: 2.0,
            p99_of_mean: 3.0,
            max_of_mean: 4.0,
            class_width_of_mean: 0.5,
            classes_percent: vec![75.0, 25.0],
        };
        let balance =
            Balance { weight_n: 0.0, carried_n: 0.0, sideways_n: 0.0, difference_percent: None };
        let contacts =
            ContactsSummary { normal_force: Some(forces), ..ContactsSummary::of(&[], 0, balance) };
        let summary = Summary {
            contacts: Some(contacts),
            coordination_distribution: vec![1, 3],
            ..Summary::default()
        };
        let table = to_csv(distributions(&summary)).expect("a table");
        let expected = "of,value,share_percent,unit\n\
                        normal_force,0.25,75.0,of_mean\n\
                        normal_force,0.75,25.0,of_mean\n\
                        coordination,0.0,25.0,grains\n\
                        coordination,1.0,75.0,grains\n";
        assert_eq!(String::from_utf8(table).expect("UTF-8"), expected);
    }
}
