//! Boxes of a laboratory, and the stress of the contact forces in them (Love–Weber).

use nalgebra::Matrix3;

use super::{Party, SpecimenState};
use crate::geometry::Vector;

/// A box along the axes, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Its lowest corner.
    pub low: Vector,
    /// Its highest corner.
    pub high: Vector,
}

impl Region {
    /// Its volume in m³.
    pub fn volume(&self) -> f64 {
        let sides = self.high - self.low;
        sides.x * sides.y * sides.z
    }

    /// Whether a point lies in it; boxes side by side share none.
    pub fn holds(&self, point: &Vector) -> bool {
        (0..3).all(|k| self.low[k] <= point[k] && point[k] < self.high[k])
    }

    /// Share of the straight line between two points that lies in the box.
    pub fn share_of_line(&self, from: &Vector, to: &Vector) -> f64 {
        let (mut begins, mut ends) = (0.0_f64, 1.0_f64);
        for k in 0..3 {
            let way = to[k] - from[k];
            if way == 0.0 {
                if from[k] < self.low[k] || from[k] >= self.high[k] {
                    return 0.0;
                }
                continue;
            }
            let (a, b) = ((self.low[k] - from[k]) / way, (self.high[k] - from[k]) / way);
            begins = begins.max(a.min(b));
            ends = ends.min(a.max(b));
        }
        (ends - begins).max(0.0)
    }

    /// Stress tensor in Pa of the loaded contacts within it, compression positive: the sum of
    /// force ⊗ line over the parts of the lines that lie in it, over its volume. Not yet symmetric.
    pub fn stress_of(&self, state: &SpecimenState) -> Matrix3<f64> {
        let centroid = |party: &Party| match party {
            Party::Grain(n) => Some(state.bodies[*n].body.pose.translation.vector),
            Party::Other(_) => None,
        };
        let mut sum = Matrix3::zeros();
        for contact in &state.contacts {
            let forces = [contact.force_n, -contact.force_n];
            for (party, force) in contact.between.iter().zip(forces) {
                let Some(centroid) = centroid(party) else { continue };
                // A force on a grain that presses points from the contact to the centroid.
                let line = centroid - contact.point_m;
                sum += force * (line * self.share_of_line(&contact.point_m, &centroid)).transpose();
            }
        }
        sum / self.volume()
    }

    /// Mean of the three normal stresses of [`Region::stress_of`] in Pa.
    pub fn mean_stress_of(&self, state: &SpecimenState) -> f64 {
        self.stress_of(state).trace() / 3.0
    }
}
