//! Openings, and which grains went through them.

use super::Specimen;
use crate::geometry::Vector;

/// A disc that grains pass through, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// Its middle.
    pub middle: Vector,
    /// Its radius.
    pub radius: f64,
    /// Unit vector in which flow counts as positive.
    pub direction: Vector,
}

impl Opening {
    /// 1 where a point went through it in its direction, −1 where it went against it,
    /// 0 where it did not, on a straight line between two places.
    pub fn passed(&self, before: &Vector, after: &Vector) -> f64 {
        let along = |p: &Vector| self.direction.dot(&(p - self.middle));
        let (a, b) = (along(before), along(after));
        // What begins on the disc is behind it: each crossing counts once.
        if (a >= 0.0) == (b >= 0.0) {
            return 0.0;
        }
        let at = before + (after - before) * (a / (a - b));
        if (at - self.middle).norm() <= self.radius { (b - a).signum() } else { 0.0 }
    }

    /// Mass in kg that went through between two looks, by the centroids of the grains;
    /// `before` has their places at the first, of those that were there. One that was taken away
    /// since then counts by where it was last seen.
    pub fn mass_passed(&self, before: &[Option<Vector>], specimen: &Specimen) -> f64 {
        let there = before.iter().enumerate().filter_map(|(i, place)| Some((i, (*place)?)));
        let passed = |(i, before): (usize, Vector)| {
            self.passed(&before, &specimen.centroid(i)) * specimen.grains.grains[i].mass
        };
        there.map(passed).sum()
    }
}

/// Where the centroids of the grains are that are present, in m.
pub fn centroids(specimen: &Specimen) -> Vec<Option<Vector>> {
    let mut places = vec![None; specimen.state.bodies.len()];
    for i in specimen.present() {
        places[i] = Some(specimen.centroid(i));
    }
    places
}
