//! Where grains are, and what became of those that are no longer there.

use super::*;

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
    /// See [`scale::RIM_ZONE`], [`scale::FALL_BELOW`] and [`scale::FLOOR_THICKNESS`]; in m.
    rim_zone: f64,
    fall_below: f64,
    floor_thickness: f64,
    last: Vec<Zone>,
}

impl Whereabouts {
    /// For grains among the parts of the apparatus that stand.
    pub(super) fn of(setup: &Setup, specimen: &Specimen, funnel: Option<&Funnel>) -> Self {
        let Specimen { grains, state } = specimen;
        let cylinder = state.cylinder.then_some(&setup.cylinder);
        let wall = from_mm(setup.funnel.wall_thickness_mm);
        let floor = match (cylinder, funnel) {
            (Some(_), _) | (None, None) => -wall,
            (None, Some(f)) => f.opening_height - wall,
        };
        Self {
            cylinder: cylinder.map(|c| (c.radius, c.height)),
            funnel: funnel.cloned(),
            base: state.base.as_ref().map(|base| base.radius),
            wall,
            floor,
            rim_zone: grains.of_size(&scale::RIM_ZONE),
            fall_below: grains.of_size(&scale::FALL_BELOW),
            floor_thickness: grains.of_size(&scale::FLOOR_THICKNESS),
            last: vec![Zone::Open; grains.grains.len()],
        }
    }

    /// Lowers the floor to a height in m, that of the pieces of a laboratory.
    pub(super) fn floor_at(&mut self, height: f64) {
        self.floor = height;
    }

    /// Height in m below which no grain is seen: it is taken away there.
    pub(super) fn lowest(&self) -> f64 {
        self.floor - self.fall_below
    }

    /// Height in m from which what is outside at a height `z` has fallen at least.
    pub(super) fn rim(&self, z: f64) -> f64 {
        let cylinder = self.cylinder.map(|(_, height)| height - self.rim_zone);
        let funnel = self.funnel.as_ref().map(|f| self.edge_of(f));
        cylinder.filter(|rim| z < *rim).or(funnel).unwrap_or(0.0)
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
        if position.z < self.floor - self.fall_below {
            return if last == Zone::Inside { Fate::ThroughWall } else { Fate::Spilled };
        }
        Fate::Present
    }

    /// Whether a place is within or behind walls, where nothing can rest.
    pub(super) fn is_outside(&self, position: &Vector, x: f64) -> bool {
        self.zone(position, x) == Zone::Outside
    }

    /// Height in m up to which a funnel has an inside: to the top of its cone, and in a collar to where
    /// grains may lean on the edge.
    fn edge_of(&self, funnel: &Funnel) -> f64 {
        funnel.top_height.max(funnel.edge_height - self.rim_zone)
    }

    fn zone(&self, position: &Vector, x: f64) -> Zone {
        let radius = (position.x - x).hypot(position.y);
        if let Some((inner, height)) = self.cylinder
            && position.z < height - self.rim_zone
        {
            // A centroid in the middle of a wall has passed its inner face by
            // more than any contact would allow.
            let inside = radius < inner + self.wall / 2.0 && position.z > -self.wall / 2.0;
            return if inside { Zone::Inside } else { Zone::Outside };
        }
        if let Some(funnel) = &self.funnel
            && position.z > funnel.opening_height + self.rim_zone
            && position.z < self.edge_of(funnel)
        {
            let inner = funnel.inner_radius(position.z);
            return if radius < inner + self.wall / 2.0 { Zone::Inside } else { Zone::Outside };
        }
        if let Some(base) = self.base {
            // Over the edge a grain goes beyond it first.
            if radius < base - self.rim_zone {
                let above = position.z > -self.floor_thickness / 2.0;
                return if above { Zone::Inside } else { Zone::Outside };
            }
        }
        Zone::Open
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::testing::*;

    /// One grain between cylinder and funnel, which has a collar of a height in m.
    fn laboratory_with(collar: f64) -> Whereabouts {
        let scenario = scenario_of(json!({
            "grains": { "total_mass_g": 2, "density_kg_per_m3": 2673.9, "sieve_table":
                [{ "passing_mm": 16, "retained_mm": 8, "mass_percent": 100 }] }
        }));
        let setup = Setup::new(&scenario).expect("a laboratory");
        let mut specimen = specimen_of(&scenario, 1);
        specimen.state.cylinder = true;
        let funnel = Funnel::new(&setup.funnel, 0.25, collar).expect("funnel");
        Whereabouts::of(&setup, &specimen, Some(&funnel))
    }

    fn laboratory() -> Whereabouts {
        laboratory_with(0.0)
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

    /// Law: through the collar is through a wall, over its edge is spilled; without a collar the funnel
    /// ends with its cone.
    #[test]
    fn the_collar_is_a_wall_of_the_funnel() {
        let funnel = laboratory().funnel.expect("a funnel");
        let (top, beside) = (funnel.top_height, funnel.top_radius + 0.05);
        let last = |collar: f64, path: &[[f64; 2]]| {
            let mut whereabouts = laboratory_with(collar);
            let fates =
                path.iter().map(|&[x, z]| whereabouts.note(0, &Vector::new(x, 0.0, z), 0.0));
            fates.collect::<Vec<Fate>>()[path.len() - 1]
        };
        let through = [[0.0, top + 0.05], [beside, top + 0.05], [beside, -0.1]];
        let got = last(0.1, &through[..2]);
        assert_eq!(got, Fate::ThroughWall, "law: the collar is 0.1 m high");
        assert_eq!(last(0.0, &through), Fate::Spilled, "law: there is none");
        let over = [[0.0, top + 0.05], [beside, top + 0.12], [beside, top + 0.05], [beside, -0.1]];
        assert_eq!(last(0.1, &over), Fate::Spilled, "law: over the edge");
        let at_edge = last(0.1, &[[0.0, top + 0.05], [beside, top + 0.09]]);
        assert_eq!(at_edge, Fate::Present, "law: near the edge a grain may lean on it");
    }

    #[test]
    fn the_moving_cylinder_carries_its_inside_along() {
        let mut whereabouts = laboratory();
        whereabouts.note(0, &Vector::new(0.05, 0.0, 0.1), 0.0);
        let fate = whereabouts.note(0, &Vector::new(0.08, 0.0, 0.1), 0.025);
        assert_eq!(fate, Fate::Present, "80 mm from the middle, table displaced by 25 mm");
    }
}
