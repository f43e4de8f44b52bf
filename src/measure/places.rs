//! Where every grain is at the end of a stage.

use super::*;

/// What became of every grain by where it is, in their order. One that takes part and is in the
/// container is present. Elsewhere it has left the specimen though no stage saw it go: it is left
/// in the funnel while that stands; with the centroid below the floor or in the wall of a thickness
/// in m it has been pressed through the surface; anywhere else it went over the rim.
pub fn fates(specimen: &Specimen, container: &Container, wall: f64) -> Vec<Fate> {
    let specimen = specimen.on_level_table();
    let state = &specimen.state;
    // Half of a wall deep, from which grains on their way count as having passed it.
    let deep = wall / 2.0;
    let fate = |(n, grain): (usize, &crate::specimen::GrainState)| {
        if grain.fate != Fate::Present {
            return grain.fate;
        }
        let at = Point::from(grain.body.pose.translation.vector);
        if state.funnel.is_some_and(|funnel| at.z >= funnel.opening_height) {
            return Fate::LeftInFunnel;
        }
        if container.holds(&at, specimen.grains.grains[n].equivalent_diameter) {
            return Fate::Present;
        }
        let radius = (at.x - container.centre_x).hypot(at.y);
        let in_wall = radius >= container.radius && radius < container.radius + deep;
        let in_floor = radius < container.radius && at.z <= 0.0 && at.z > -deep;
        let walls = state.cylinder && in_wall && at.z > -deep && at.z < container.height;
        if walls || in_floor { Fate::ThroughWall } else { Fate::Spilled }
    };
    state.bodies.iter().enumerate().map(fate).collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{cube, specimen_of};
    use super::*;
    use crate::geometry::Pose;
    use crate::specimen::FunnelState;

    const CUP: Container = Container { centre_x: 0.0, radius: 0.05, height: 0.1 };
    const WALL: f64 = 0.02;

    /// Law: every grain has one fate, the one that a stage saw and else that of its centroid.
    #[test]
    fn every_grain_is_somewhere() {
        use Fate::{LeftInFunnel, Present, Spilled, ThroughWall, Waiting};
        let cases = [
            (0.0, 0.01, Present, Present),
            (0.0, -0.001, Present, ThroughWall),
            (0.0, -0.009, Present, ThroughWall),
            (0.0, -0.2, Present, Spilled),
            (0.055, 0.05, Present, ThroughWall),
            (0.055, 0.105, Present, Spilled),
            (0.09, 0.05, Present, Spilled),
            (0.0, 0.5, Present, Spilled),
            (0.0, 0.05, Spilled, Spilled),
            (0.0, 0.05, ThroughWall, ThroughWall),
            (0.0, 0.05, LeftInFunnel, LeftInFunnel),
            (0.0, 0.05, Waiting, Waiting),
        ];
        let at =
            |&(x, z, _, _): &(f64, f64, Fate, Fate)| (cube(0.01), Pose::translation(x, 0.0, z));
        let mut specimen = specimen_of(cases.iter().map(at).collect());
        specimen.state.cylinder = true;
        for (grain, case) in specimen.state.bodies.iter_mut().zip(&cases) {
            grain.fate = case.2;
        }
        let got = fates(&specimen, &CUP, WALL);
        for ((x, z, noted, expected), got) in cases.iter().zip(&got) {
            assert_eq!(got, expected, "law: a grain at x = {x} m, z = {z} m, {noted:?}");
        }
        let present = got.iter().filter(|fate| **fate == Present).count();
        assert_eq!(present, CUP.members(&specimen).len(), "law: those measured");
        specimen.state.funnel = Some(FunnelState { opening_height: 0.12, lid: true });
        assert_eq!(fates(&specimen, &CUP, WALL)[7], LeftInFunnel, "law: while the funnel stands");
    }

    /// Law: the wall goes along with the table.
    #[test]
    fn the_table_carries_the_places_along() {
        let mut specimen = specimen_of(vec![(cube(0.01), Pose::translation(0.055, 0.0, 0.05))]);
        specimen.state.cylinder = true;
        let moved = Container { centre_x: 0.02, ..CUP };
        assert_eq!(fates(&specimen, &moved, WALL), [Fate::Present]);
        specimen.state.table_z = 0.2;
        assert_eq!(fates(&specimen, &moved, WALL), [Fate::Spilled], "law: below the floor");
    }
}
