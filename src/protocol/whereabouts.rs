//! Where grains are, and what became of those that are no longer there.

use crate::apparatus::{Cylinder, Funnel};
use crate::geometry::Vector;
use crate::specimen::Fate;

/// How far below the rim a grain must be, in m, to count as inside the
/// cylinder rather than on its way over the rim: about a grain and a half.
const RIM_ZONE: f64 = 0.015;

/// How far below the lowest floor a lost grain falls, in m, before it is taken away.
const FALL: f64 = 0.05;

/// A region of the laboratory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Zone {
    /// Within the walls of funnel or cylinder.
    Inside,
    /// Between the two, or above them, where a grain may go anywhere.
    Open,
    /// Outside the walls, below their upper edge.
    Outside,
}

/// Follows every grain through the zones.
#[derive(Debug)]
pub(super) struct Whereabouts {
    cylinder: Option<(f64, f64)>,
    funnel: Option<Funnel>,
    /// Radius in m of a pile's base.
    base: Option<f64>,
    wall: f64,
    floor: f64,
    last: Vec<Zone>,
}

impl Whereabouts {
    /// For `grains` grains among the parts of the apparatus that stand; radius of
    /// a pile's base and wall thickness in m.
    pub(super) fn new(
        grains: usize,
        cylinder: Option<&Cylinder>,
        funnel: Option<&Funnel>,
        base: Option<f64>,
        wall: f64,
    ) -> Self {
        let floor = match (cylinder, funnel) {
            (Some(_), _) | (None, None) => -wall,
            (None, Some(f)) => f.opening_height - wall,
        };
        Self {
            cylinder: cylinder.map(|c| (c.radius, c.height)),
            funnel: funnel.cloned(),
            base,
            wall,
            floor,
            last: vec![Zone::Open; grains],
        }
    }

    /// Height in m below which no grain is seen: it is taken away there.
    pub(super) fn lowest(&self) -> f64 {
        self.floor - FALL
    }

    /// Notes where a grain is now; tells what became of it when it has left
    /// for good. `x` is the table's displacement in m.
    pub(super) fn note(&mut self, grain: usize, position: &Vector, x: f64) -> Fate {
        let zone = self.zone(position, x);
        let last = self.last[grain];
        if last == Zone::Inside && zone == Zone::Outside {
            return Fate::ThroughWall;
        }
        self.last[grain] = zone;
        if position.z < self.floor - FALL {
            return if last == Zone::Inside { Fate::ThroughWall } else { Fate::Spilled };
        }
        Fate::Present
    }

    fn zone(&self, position: &Vector, x: f64) -> Zone {
        let radius = (position.x - x).hypot(position.y);
        if let Some((inner, height)) = self.cylinder
            && position.z < height - RIM_ZONE
        {
            // A centroid in the middle of a wall has passed its inner face by
            // more than any contact would allow.
            let inside = radius < inner + self.wall / 2.0 && position.z > -self.wall / 2.0;
            return if inside { Zone::Inside } else { Zone::Outside };
        }
        if let Some(funnel) = &self.funnel
            && position.z > funnel.opening_height + RIM_ZONE
            && position.z < funnel.top_height
        {
            let inner = funnel.inner_radius(position.z);
            return if radius < inner + self.wall / 2.0 { Zone::Inside } else { Zone::Outside };
        }
        if let Some(base) = self.base {
            // Over the edge a grain goes beyond it first.
            if radius < base - RIM_ZONE {
                let above = position.z > -super::base::FLOOR_THICKNESS / 2.0;
                return if above { Zone::Inside } else { Zone::Outside };
            }
        }
        Zone::Open
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{CylinderSpec, FunnelSpec};

    fn laboratory() -> Whereabouts {
        let cylinder = Cylinder::new(&CylinderSpec::default()).expect("cylinder");
        let funnel = Funnel::new(&FunnelSpec::default(), 0.25, 0.0).expect("funnel");
        Whereabouts::new(1, Some(&cylinder), Some(&funnel), None, 0.02)
    }

    fn walk(path: &[[f64; 3]]) -> Vec<Fate> {
        let mut whereabouts = laboratory();
        path.iter().map(|&p| whereabouts.note(0, &Vector::from(p), 0.0)).collect()
    }

    #[test]
    fn a_poured_grain_stays_present() {
        let fates =
            walk(&[[0.0, 0.0, 0.35], [0.0, 0.0, 0.22], [0.04, 0.0, 0.1], [0.05, 0.0, 0.01]]);
        assert!(fates.iter().all(|f| *f == Fate::Present), "{fates:?}");
    }

    #[test]
    fn over_the_rim_is_spilled_and_through_the_wall_is_not() {
        let spilled =
            walk(&[[0.0, 0.0, 0.22], [0.1, 0.0, 0.19], [0.1, 0.0, 0.1], [0.1, 0.0, -0.1]]);
        assert_eq!(spilled.last(), Some(&Fate::Spilled), "{spilled:?}");
        let through = walk(&[[0.0, 0.0, 0.22], [0.05, 0.0, 0.1], [0.09, 0.0, 0.1]]);
        assert_eq!(through.last(), Some(&Fate::ThroughWall), "{through:?}");
        let floor = walk(&[[0.0, 0.0, 0.1], [0.0, 0.0, -0.1]]);
        assert_eq!(floor.last(), Some(&Fate::ThroughWall), "{floor:?}");
        let funnel = walk(&[[0.0, 0.0, 0.30], [0.15, 0.0, 0.30]]);
        assert_eq!(funnel.last(), Some(&Fate::ThroughWall), "{funnel:?}");
    }

    #[test]
    fn the_moving_cylinder_carries_its_inside_along() {
        let mut whereabouts = laboratory();
        whereabouts.note(0, &Vector::new(0.05, 0.0, 0.1), 0.0);
        let fate = whereabouts.note(0, &Vector::new(0.08, 0.0, 0.1), 0.025);
        assert_eq!(fate, Fate::Present, "80 mm from the middle, table displaced by 25 mm");
    }
}
