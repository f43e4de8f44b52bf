//! Grains that something pressed through a floor or a wall.

use std::sync::Arc;

use super::recorder::container;
use crate::grains::GrainSet;
use crate::measure::{Place, places};
use crate::protocol::Setup;
use crate::record::StoredStage;
use crate::specimen::{Fate, Specimen};
use crate::units::from_mm;

/// Grains that lay with their centroid in a floor or a wall when a stage ended, and that no stage
/// itself saw pass.
pub(super) fn pressed_through<'a>(
    grains: &Arc<GrainSet>,
    stages: impl Iterator<Item = &'a StoredStage>,
    setup: &Setup,
) -> usize {
    // Pieces of a laboratory are no cylinder: whether grains pass them is watched stage by stage.
    if !setup.pieces.is_empty() {
        return 0;
    }
    let mut pressed = vec![false; grains.grains.len()];
    for stage in stages {
        let specimen = Specimen { grains: grains.clone(), state: stage.state.clone() };
        let there = places(&specimen, &container(setup, &specimen), wall(setup));
        let bodies = specimen.state.bodies.iter().zip(&there);
        for (pressed, (grain, place)) in pressed.iter_mut().zip(bodies) {
            match grain.fate {
                Fate::Present => *pressed |= *place == Place::Escaped,
                // Seen by the stage.
                Fate::ThroughWall => *pressed = false,
                _ => {}
            }
        }
    }
    pressed.into_iter().filter(|pressed| *pressed).count()
}

/// Thickness of walls and floors in m, as grains on their way are held to have passed them.
pub(super) fn wall(setup: &Setup) -> f64 {
    from_mm(setup.funnel.wall_thickness_mm)
}
