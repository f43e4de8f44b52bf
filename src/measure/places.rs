//! Where every grain is at the end of a stage.

use super::*;

/// Where a grain is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// In the cylinder ([`Container::holds`]), or on a pile's base.
    InCylinder,
    /// In the funnel, or taken away with it, or not yet fed.
    LeftInFunnel,
    /// Over the rim, or off a pile's base.
    Spilled,
    /// Through a wall or a floor, or with its centroid in one.
    Escaped,
}

/// How many grains are where; together as many as there are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Places {
    /// See [`Place::InCylinder`].
    pub in_cylinder: usize,
    /// See [`Place::LeftInFunnel`].
    pub left_in_funnel: usize,
    /// See [`Place::Spilled`].
    pub spilled: usize,
    /// See [`Place::Escaped`].
    pub escaped: usize,
}

/// Place of every grain, in their order. A grain that takes part and is not in the container
/// counts by where it is: in the funnel while that stands; with the centroid below the floor or
/// in the wall of a thickness in m it has been pressed through the surface; elsewhere it went
/// over the rim.
pub fn places(specimen: &Specimen, container: &Container, wall: f64) -> Vec<Place> {
    let specimen = specimen.on_level_table();
    let state = &specimen.state;
    // Half of a wall deep, from which grains on their way count as having passed it.
    let deep = wall / 2.0;
    let place = |(n, grain): (usize, &crate::specimen::GrainState)| {
        if grain.fate != Fate::Present {
            return Place::by_fate(grain.fate);
        }
        let at = Point::from(grain.body.pose.translation.vector);
        if state.funnel.is_some_and(|funnel| at.z >= funnel.opening_height) {
            return Place::LeftInFunnel;
        }
        if container.holds(&at, specimen.grains.grains[n].equivalent_diameter) {
            return Place::InCylinder;
        }
        let radius = (at.x - container.centre_x).hypot(at.y);
        let in_wall = radius >= container.radius && radius < container.radius + deep;
        let in_floor = radius < container.radius && at.z <= 0.0 && at.z > -deep;
        let walls = state.cylinder && in_wall && at.z > -deep && at.z < container.height;
        if walls || in_floor { Place::Escaped } else { Place::Spilled }
    };
    state.bodies.iter().enumerate().map(place).collect()
}

/// Place of every grain by what became of it alone, as in a laboratory of named pieces, which has
/// no cylinder: what takes part counts as in it.
pub fn places_by_fate(specimen: &Specimen) -> Vec<Place> {
    specimen.state.bodies.iter().map(|grain| Place::by_fate(grain.fate)).collect()
}

impl Place {
    /// What became of a grain, by where it is: a grain that takes part, and lies where none
    /// belongs, has left the specimen though no stage saw it go.
    pub fn fate(self, noted: Fate) -> Fate {
        match (noted, self) {
            (Fate::Present, Self::LeftInFunnel) => Fate::LeftInFunnel,
            (Fate::Present, Self::Spilled) => Fate::Spilled,
            (Fate::Present, Self::Escaped) => Fate::ThroughWall,
            (noted, _) => noted,
        }
    }

    /// By what became of a grain alone.
    fn by_fate(fate: Fate) -> Self {
        match fate {
            Fate::Present => Self::InCylinder,
            Fate::Spilled => Self::Spilled,
            Fate::ThroughWall => Self::Escaped,
            Fate::LeftInFunnel | Fate::Waiting => Self::LeftInFunnel,
        }
    }
}

impl Places {
    /// Counted.
    pub fn of(places: &[Place]) -> Self {
        let count = |place| places.iter().filter(|p| **p == place).count();
        Self {
            in_cylinder: count(Place::InCylinder),
            left_in_funnel: count(Place::LeftInFunnel),
            spilled: count(Place::Spilled),
            escaped: count(Place::Escaped),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{cube, specimen_of};
    use super::*;
    use crate::geometry::Pose;
    use crate::specimen::FunnelState;

    const CUP: Container = Container { centre_x: 0.0, radius: 0.05, height: 0.1 };
    const WALL: f64 = 0.02;

    /// Law: every grain has one place, by its fate and else by its centroid; the fates that tables
    /// give by it add up to what the summary counts by it.
    #[test]
    fn every_grain_is_somewhere() {
        use Place::{Escaped, InCylinder, LeftInFunnel, Spilled};
        let cases = [
            (0.0, 0.01, Fate::Present, InCylinder),
            (0.0, -0.001, Fate::Present, Escaped),
            (0.0, -0.009, Fate::Present, Escaped),
            (0.0, -0.2, Fate::Present, Spilled),
            (0.055, 0.05, Fate::Present, Escaped),
            (0.055, 0.105, Fate::Present, Spilled),
            (0.09, 0.05, Fate::Present, Spilled),
            (0.0, 0.5, Fate::Present, Spilled),
            (0.0, 0.05, Fate::Spilled, Spilled),
            (0.0, 0.05, Fate::ThroughWall, Escaped),
            (0.0, 0.05, Fate::LeftInFunnel, LeftInFunnel),
            (0.0, 0.05, Fate::Waiting, LeftInFunnel),
        ];
        let at =
            |&(x, z, _, _): &(f64, f64, Fate, Place)| (cube(0.01), Pose::translation(x, 0.0, z));
        let mut specimen = specimen_of(cases.iter().map(at).collect());
        specimen.state.cylinder = true;
        for (grain, case) in specimen.state.bodies.iter_mut().zip(&cases) {
            grain.fate = case.2;
        }
        let got = places(&specimen, &CUP, WALL);
        for ((x, z, fate, expected), got) in cases.iter().zip(&got) {
            assert_eq!(got, expected, "law: a grain at x = {x} m, z = {z} m, {fate:?}");
        }
        let counted = Places::of(&got);
        let sum = counted.in_cylinder + counted.left_in_funnel + counted.spilled + counted.escaped;
        assert_eq!(sum, cases.len(), "law: places add up to the number of grains");
        assert_eq!(counted.in_cylinder, CUP.members(&specimen).len(), "law: those measured");
        // What tables say of the grains, counted, is what the summary says.
        let fates = got.iter().zip(&cases).map(|(place, case)| Place::by_fate(place.fate(case.2)));
        let counted_by_fate = Places::of(&fates.collect::<Vec<_>>());
        assert_eq!(counted_by_fate, counted, "law: fates and places have the same counts");
        assert_eq!(InCylinder.fate(Fate::Present), Fate::Present, "law: it stays what it was");
        assert_eq!(LeftInFunnel.fate(Fate::Waiting), Fate::Waiting, "law: known better");
        specimen.state.funnel = Some(FunnelState { opening_height: 0.12, lid: true });
        assert_eq!(places(&specimen, &CUP, WALL)[7], LeftInFunnel, "law: while the funnel stands");
    }

    /// Law: the wall goes along with the table.
    #[test]
    fn the_table_carries_the_places_along() {
        let mut specimen = specimen_of(vec![(cube(0.01), Pose::translation(0.055, 0.0, 0.05))]);
        specimen.state.cylinder = true;
        let moved = Container { centre_x: 0.02, ..CUP };
        assert_eq!(places(&specimen, &moved, WALL), [Place::InCylinder]);
        specimen.state.table_z = 0.2;
        assert_eq!(places(&specimen, &moved, WALL), [Place::Spilled], "law: below the floor");
    }
}
