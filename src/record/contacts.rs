//! Contacts at the end of a run, as `summary.json` has them.

use nalgebra::Matrix3;

use super::*;
use crate::measure::{self, FORCE_CLASS, LoadedContact, force_distribution, sliding_share};

/// `contacts` in `summary.json`: loaded contacts, each pair of bodies once however many points it
/// touches in, at the end of the rest test where one is run, or else of the last stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ContactsSummary {
    /// Number of loaded contacts between grains.
    pub between_grains: usize,
    /// Number of loaded contacts of grains with anything else.
    pub with_apparatus: usize,
    /// Normal forces between grains; null without any.
    pub normal_force: Option<ForceSummary>,
    /// Share of contacts between grains that slide, in percent: every point of them bears at least
    /// 0.999 of the friction it can. Null without any.
    pub sliding_percent: Option<f64>,
    /// The same of contacts with anything else.
    pub sliding_at_apparatus_percent: Option<f64>,
    /// Directions of the contact normals between grains; null without any.
    pub fabric: Option<FabricSummary>,
    /// Number of grains present that bear no load.
    pub unloaded_grains: usize,
    /// What all that stands carries in the last step against the weight of grains and plate: at
    /// rest they are the same.
    pub balance: Balance,
}

impl ContactsSummary {
    /// Of loaded contacts, the number of grains present, and what carries them.
    pub fn of(contacts: &[LoadedContact], present: usize, balance: Balance) -> Self {
        use crate::specimen::Party::Grain;
        let (grains, other): (Vec<LoadedContact>, Vec<LoadedContact>) =
            contacts.iter().copied().partition(LoadedContact::is_of_grains);
        let parties = contacts.iter().flat_map(|c| c.between);
        let mut loaded: Vec<usize> =
            parties.filter_map(|p| if let Grain(n) = p { Some(n) } else { None }).collect();
        loaded.sort_unstable();
        loaded.dedup();
        let percent = |share: Option<f64>| share.map(|share| 100.0 * share);
        Self {
            between_grains: grains.len(),
            with_apparatus: other.len(),
            normal_force: ForceSummary::of(&grains),
            sliding_percent: percent(sliding_share(&grains)),
            sliding_at_apparatus_percent: percent(sliding_share(&other)),
            fabric: measure::fabric(&grains).map(|fabric| FabricSummary::of(&fabric)),
            unloaded_grains: present.saturating_sub(loaded.len()),
            balance,
        }
    }
}

/// Whether forces are complete: at rest the pieces carry the weight of the grains.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Balance {
    /// Weight of the grains that are present, and of a plate on them, in N.
    pub weight_n: f64,
    /// Downward force on all pieces together, in N.
    pub carried_n: f64,
    /// Horizontal force on all pieces together, in N: 0 at rest.
    pub sideways_n: f64,
    /// Carried over weight less 1, in percent; null without grains.
    pub difference_percent: Option<f64>,
}

/// Normal forces between grains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ForceSummary {
    /// Their mean in N.
    pub mean_n: f64,
    /// 10th percentile over the mean (nearest rank).
    pub p10_of_mean: f64,
    /// Median over the mean.
    pub p50_of_mean: f64,
    /// 90th percentile over the mean.
    pub p90_of_mean: f64,
    /// 99th percentile over the mean.
    pub p99_of_mean: f64,
    /// Largest over the mean.
    pub max_of_mean: f64,
    /// Width of a class of the histogram, in means.
    pub class_width_of_mean: f64,
    /// Share of contacts in each class in percent, from 0 up to the largest force, or to 50 means,
    /// where the last class holds all that is beyond.
    pub classes_percent: Vec<f64>,
}

impl ForceSummary {
    fn of(contacts: &[LoadedContact]) -> Option<Self> {
        let of = force_distribution(contacts.iter().map(|c| c.normal_force))?;
        let [p10, p50, p90, p99, max] = of.percentiles;
        Some(Self {
            mean_n: of.mean,
            p10_of_mean: p10,
            p50_of_mean: p50,
            p90_of_mean: p90,
            p99_of_mean: p99,
            max_of_mean: max,
            class_width_of_mean: FORCE_CLASS,
            classes_percent: of.classes.iter().map(|share| 100.0 * share).collect(),
        })
    }
}

/// Fabric tensor: mean of n ⊗ n over unit contact normals n.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FabricSummary {
    /// Number of contacts.
    pub contacts: usize,
    /// Rows and columns x, y, z; the trace is 1.
    pub tensor: [[f64; 3]; 3],
    /// Principal values, the largest first; 1/3 each where no direction is preferred.
    pub principal: [f64; 3],
    /// From 0, no direction preferred, to 1, all normals parallel.
    pub anisotropy: f64,
}

impl FabricSummary {
    /// Of what was measured.
    pub fn of(fabric: &measure::Fabric) -> Self {
        Self {
            contacts: fabric.contacts,
            tensor: rows(&fabric.tensor, 1.0),
            principal: fabric.principal(),
            anisotropy: fabric.anisotropy(),
        }
    }
}

/// Stress tensor of a region in kPa, compression positive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StressSummary {
    /// Symmetric part; rows and columns x, y, z.
    pub tensor_kpa: [[f64; 3]; 3],
    /// Mean of the normal stresses.
    pub mean_kpa: f64,
    /// √(3/2 s:s) of the deviator s.
    pub deviatoric_kpa: f64,
    /// Norm of the antisymmetric part over that of the symmetric one, in percent: what the sides
    /// of the region cut off.
    pub asymmetry_percent: f64,
}

impl StressSummary {
    /// Of a stress in Pa.
    pub fn of(stress: &measure::Stress) -> Self {
        Self {
            tensor_kpa: rows(&stress.tensor, 1e-3),
            mean_kpa: 1e-3 * stress.mean(),
            deviatoric_kpa: 1e-3 * stress.deviatoric(),
            asymmetry_percent: 100.0 * stress.asymmetry,
        }
    }
}

/// `core` in `summary.json`: the largest box about the cylinder's axis that keeps two median grains
/// off wall, floor and mean surface, at the end of the rest test where one is run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CoreSummary {
    /// Its lowest corner in mm.
    pub low_mm: [f64; 3],
    /// Its highest corner in mm.
    pub high_mm: [f64; 3],
    /// Void ratio in it; null where no grain is.
    pub void_ratio: Option<f64>,
    /// Mean stress of the contacts in it; null where the engine gave none.
    pub stress: Option<StressSummary>,
    /// Fabric of the contacts between grains in it; null where there are none.
    pub fabric: Option<FabricSummary>,
}

fn rows(tensor: &Matrix3<f64>, factor: f64) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| factor * tensor[(i, j)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;
    use crate::specimen::{Other, Party};

    #[test]
    fn contacts_of_grains_and_with_walls_are_told_apart() {
        let of = |between, normal_force, slides| LoadedContact {
            between,
            point: Vector::zeros(),
            normal: Vector::z(),
            normal_force,
            slides,
        };
        let grain = Party::Grain;
        let wall = Party::Other(Other::Cylinder(3));
        let contacts = [
            of([grain(0), grain(1)], 1.0, true),
            of([grain(1), grain(2)], 3.0, false),
            of([wall, grain(1)], 9.0, false),
        ];
        let balance = Balance {
            weight_n: 1.0,
            carried_n: 1.0,
            sideways_n: 0.0,
            difference_percent: Some(0.0),
        };
        let got = ContactsSummary::of(&contacts, 5, balance);
        assert_eq!((got.between_grains, got.with_apparatus, got.unloaded_grains), (2, 1, 2));
        assert_eq!(
            (got.sliding_percent, got.sliding_at_apparatus_percent),
            (Some(50.0), Some(0.0))
        );
        let force = got.normal_force.expect("forces");
        assert_eq!((force.mean_n, force.max_of_mean), (2.0, 1.5), "law: of grains alone");
        assert_eq!(got.fabric.expect("normals").tensor[2], [0.0, 0.0, 1.0]);
        let none = ContactsSummary::of(&[], 5, balance);
        assert_eq!(
            (none.unloaded_grains, none.sliding_percent, none.normal_force),
            (5, None, None)
        );
    }

    #[test]
    fn stresses_are_in_kpa() {
        let stress =
            measure::Stress::of(&Matrix3::new(1e3, 2.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 2e3));
        let got = StressSummary::of(&stress);
        assert_eq!((got.tensor_kpa[0], got.mean_kpa), ([1.0, 3e-3, 0.0], 1.0));
    }
}
