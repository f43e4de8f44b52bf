//! Standing height and void ratio of a specimen, and why they are withheld.

use super::{
    StudyError,
    withheld::{no_height, no_voids, withheld},
};
use crate::measure::{Container, HeightMap, height_cell, void_ratio};
use crate::record::{StandingHeight, Withheld};
use crate::specimen::Specimen;
use crate::units::{from_mm, to_mm};

/// Standing height and void ratio of a specimen.
pub(super) struct Standing {
    /// Its heights in mm.
    pub height: StandingHeight,
    /// Why the height is withheld.
    pub no_height: Option<String>,
    /// Why void ratio and porosity are withheld.
    pub no_voids: Option<String>,
    /// Void ratio up to the mean surface.
    pub void_ratio: Option<f64>,
    /// Porosity, likewise.
    pub porosity: Option<f64>,
}

impl Standing {
    /// Of a specimen that was poured into a cylinder, or was not.
    pub(super) fn of(
        specimen: &Specimen,
        container: &Container,
        is_poured: bool,
    ) -> Result<Self, StudyError> {
        let height = HeightMap::of(specimen, container, height_cell(&specimen.grains))
            .map_err(StudyError::measure)?
            .standing_height();
        // A pile has no walls that its voids could be counted within.
        let voids = match specimen.state.base {
            Some(_) => None,
            // Of a laboratory the void ratio is that of its regions.
            None if !specimen.state.pieces.is_empty() => None,
            None => void_ratio(specimen, container, height.mean_surface),
        };
        let inside = container.members(specimen).len();
        let no_height =
            is_poured.then(|| no_height(inside, specimen.grains.grains.len())).flatten();
        let no_voids = no_height
            .clone()
            .or_else(|| voids.and_then(|_| no_voids(specimen, container, height.mean_surface)));
        let voids = voids.filter(|_| no_voids.is_none());
        Ok(Self {
            no_height,
            no_voids,
            height: StandingHeight {
                mean_surface: to_mm(height.mean_surface),
                p95: to_mm(height.p95),
                highest: to_mm(height.highest),
            },
            void_ratio: voids.map(|v| v.void_ratio),
            porosity: voids.map(|v| v.porosity),
        })
    }
}

impl Standing {
    /// Height of the mean surface in m; 0 where it is withheld.
    pub(super) fn surface(&self) -> f64 {
        if self.no_height.is_some() { 0.0 } else { from_mm(self.height.mean_surface) }
    }
}

/// What is not given of the end and of the end of pouring.
pub(super) fn withheld_figures(end: &Standing, poured: Option<&Standing>) -> Vec<Withheld> {
    let of = |fields: &[&str], why: Option<&String>| match why {
        Some(why) => withheld(fields, why),
        None => Vec::new(),
    };
    [
        of(&["standing_height_mm"], end.no_height.as_ref()),
        of(&["void_ratio", "porosity"], end.no_voids.as_ref()),
        of(&["poured_height_mm"], poured.and_then(|p| p.no_height.as_ref())),
        of(&["poured_void_ratio"], poured.and_then(|p| p.no_voids.as_ref())),
    ]
    .concat()
}
