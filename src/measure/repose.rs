//! Angle of repose of a pile, from the poses of its grains.
//!
//! The pile's surface is taken from a height map over the base, less the mean
//! height of the base itself. Two measures that share nothing but that map:
//!
//! - *By profile.* The flank is what lies between the radii at which the pile
//!   stands at 80 % and at 20 % of its height: the rounded top and the toe,
//!   where single grains lie, are left out. The radius at a height is that of
//!   the circle with the area of all cells as high or higher. About the axis,
//!   the line through the centroid of the pile's volume, the flank is cut into
//!   sectors, and in each a straight line is fitted to the height over the
//!   distance from the axis by least squares, every distance weighing alike.
//!   The angle of repose is that of the mean of their slopes. Radii are the
//!   pile's, not each sector's: chosen by the heights to which the line is then
//!   fitted, they made rough cones of 38.4° read 37.0 to 38.1°. The mean is of
//!   slopes, not of angles: these grow more slowly than slopes, so that their
//!   mean falls short by what the sectors scatter.
//! - *By volume.* The circular cone of the pile's volume V and height h has the
//!   base radius r = √(3V / πh) and the slope h/r. It depends on one grain, the
//!   highest, and is there as a check.
//!
//! Sectors side by side share grains, so that their angles are no independent samples. The
//! confidence interval is that of batch means: neighbouring sectors are put together into
//! [`BATCHES`] parts of the circumference, each several grains wide, and Student's t interval is
//! taken over the parts (as in the analysis of correlated series: Law & Kelton, *Simulation
//! Modeling and Analysis*, chapter 9). It says how well the slope of *this* pile is known; piles of
//! other grains scatter besides.

use std::f64::consts::{PI, TAU};

use super::*;
use crate::{specimen::Base, units::to_mm};

/// Sectors about the axis: of 10° each.
pub const SECTORS: usize = 36;
/// Parts of the circumference whose angles are taken as independent: of 60° each.
pub const BATCHES: usize = 6;
/// Shares of the pile's height between which the flank is fitted.
pub const FLANK: (f64, f64) = (0.2, 0.8);
/// Least height of a pile in mean equivalent diameters of its grains: below, there
/// is no flank between top and toe.
pub const LEAST_HEIGHT_GRAINS: f64 = 3.0;
/// Share of the sectors that must have a flank.
const LEAST_SECTORS: f64 = 2.0 / 3.0;
/// Fewest cells of a sector's flank.
const LEAST_CELLS: usize = 12;
/// Confidence of the interval.
const CONFIDENCE: f64 = 0.95;

/// Height of the surface over one cell of a square grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Position of its centre in m.
    pub x: f64,
    /// Position of its centre in m.
    pub y: f64,
    /// Height of the surface above the base in m; 0 where the base is bare.
    pub height: f64,
}

/// The surface of a pile.
#[derive(Debug, Clone, PartialEq)]
pub struct PileSurface {
    /// The cells over the base.
    pub cells: Vec<Cell>,
    /// Side of a cell in m.
    pub cell: f64,
    /// Mean equivalent diameter of the grains in m.
    pub grain_size: f64,
}

/// One sector of a pile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    /// Direction of its middle from the axis, in rad counter-clockwise from x.
    pub azimuth: f64,
    /// Slope of its flank in rad, positive where it falls outwards; `None` where
    /// there is too little to fit.
    pub angle: Option<f64>,
    /// Radius in m at which the fitted line meets the base, where it does; negative, beyond the
    /// axis, where the flank does not fall outwards.
    pub toe: Option<f64>,
}

/// The angle of repose of a pile; angles in rad, lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct Repose {
    /// That of the mean slope of the sectors.
    pub angle: f64,
    /// Standard deviation of the sectors' angles.
    pub standard_deviation: f64,
    /// Confidence interval (95 %) of the mean by batch means; see the module's text.
    pub confidence: (f64, f64),
    /// Slope of the cone of the same volume and height.
    pub by_volume: f64,
    /// Height of the highest cell above the base, read at its centre: a corner between centres is
    /// up to about half a cell higher.
    pub height: f64,
    /// Radii between which the flank is fitted.
    pub flank: (f64, f64),
    /// Radius at which the mean of the fitted lines meets the base.
    pub base_radius: f64,
    /// Volume under the surface, voids included, in m³.
    pub volume: f64,
    /// Where the axis stands, x and y.
    pub axis: (f64, f64),
    /// The sectors in turn, from azimuth 0 on.
    pub sectors: Vec<Sector>,
}

/// The surface of the pile on a specimen's base; `None` where there is no base.
///
/// Heights are above the mean height of the base: that of the fixed grains and
/// the floor between them.
///
/// # Errors
/// [`MeasureError`] of the height map.
pub fn pile_surface(specimen: &Specimen) -> Result<Option<PileSurface>, MeasureError> {
    let Some(base) = &specimen.state.base else { return Ok(None) };
    let over = over(base, &specimen.grains);
    let map = HeightMap::of(specimen, &over, height_cell_over(&over, &specimen.grains))?;
    let level = base_level(specimen)?;
    let middle = (map.across() - 1) as f64 / 2.0;
    let place = |n: usize| (n as f64 - middle) * map.cell();
    let mut cells = Vec::new();
    for j in 0..map.across() {
        for i in 0..map.across() {
            let Some(height) = map.height(i, j) else { continue };
            cells.push(Cell { x: place(i), y: place(j), height: (height - level).max(0.0) });
        }
    }
    let sizes: Vec<f64> = specimen.grains.grains.iter().map(|g| g.equivalent_diameter).collect();
    let grain_size = statistics::mean(&sizes).unwrap_or(0.0);
    Ok(Some(PileSurface { cells, cell: map.cell(), grain_size }))
}

/// The space over a base as a container of the grains that lie on it.
pub fn over(base: &Base, grains: &GrainSet) -> Container {
    Container { centre_x: 0.0, radius: base.radius, height: grains.of_size(&scale::HIGHEST_PILE) }
}

/// Mean height in m of a specimen's base above z = 0; 0 without fixed grains.
///
/// # Errors
/// [`MeasureError`] of the height map.
pub fn base_level(specimen: &Specimen) -> Result<f64, MeasureError> {
    let Some(base) = specimen.state.base.as_ref().filter(|b| !b.fixed_grains.is_empty()) else {
        return Ok(0.0);
    };
    let poses: Vec<_> = base.fixed_grains.iter().map(|f| (f.grain, f.pose)).collect();
    let grains = &specimen.grains;
    let over = over(base, grains);
    let map = HeightMap::of_poses(grains, &poses, &over, height_cell_over(&over, grains))?;
    Ok(map.standing_height().mean_surface)
}

/// Height in m, above z = 0, of the highest point of the grains that lie on a
/// pile: those that do not move just now. `None` without any.
pub fn pile_top(specimen: &Specimen) -> Option<f64> {
    let SpecimenState { bodies, .. } = &specimen.state;
    let slow = specimen.grains.of_size(&scale::SLOW);
    let lying = specimen.present().filter(|&i| bodies[i].body.linear_velocity.norm() < slow);
    lying.map(|i| specimen.top(i)).reduce(f64::max)
}

impl PileSurface {
    /// The angle of repose, or why there is none.
    ///
    /// # Errors
    /// [`MeasureError`] where the base is bare, or what lies there is too low or has no flanks.
    pub fn repose(&self) -> Result<Repose, MeasureError> {
        let area = self.cell * self.cell;
        let sum: f64 = self.cells.iter().map(|c| c.height).sum();
        if !(sum > 0.0) {
            return Err(MeasureError("there is no grain on the base".to_owned()));
        }
        let height = self.cells.iter().map(|c| c.height).fold(0.0, f64::max);
        let least = LEAST_HEIGHT_GRAINS * self.grain_size;
        if height < least {
            return Err(MeasureError(format!(
                "what lies on the base is {:.1} mm high, a pile is at least {:.1} mm, \
                 {LEAST_HEIGHT_GRAINS} mean grains",
                to_mm(height),
                to_mm(least)
            )));
        }
        let moment =
            |of: fn(&Cell) -> f64| self.cells.iter().map(|c| c.height * of(c)).sum::<f64>() / sum;
        let axis = (moment(|c| c.x), moment(|c| c.y));
        let flank = (self.radius_at(FLANK.1 * height), self.radius_at(FLANK.0 * height));
        let lines = self.lines(axis, flank);
        let found: Vec<Line> = lines.iter().copied().flatten().collect();
        let falling = found.iter().filter(|line| line.slope > 0.0).count();
        let no_flanks = || {
            MeasureError(format!(
                "only {falling} of {SECTORS} sectors about the axis have a flank that slopes down"
            ))
        };
        if (falling as f64) < LEAST_SECTORS * SECTORS as f64 {
            return Err(no_flanks());
        }
        let mean =
            |of: fn(&Line) -> f64| statistics::mean(&found.iter().map(of).collect::<Vec<_>>());
        let slope = mean(|l| l.slope).filter(|s| *s > 0.0).ok_or_else(no_flanks)?;
        let base_radius = mean(|l| l.at_axis).ok_or_else(no_flanks)? / slope;
        let angles: Vec<f64> = found.iter().map(|line| line.slope.atan()).collect();
        let standard_deviation =
            statistics::sample_standard_deviation(&angles).ok_or_else(no_flanks)?;
        let half = half_width(&lines).ok_or_else(no_flanks)?;
        let volume = sum * area;
        let sectors = (0..).zip(&lines).map(|(n, line)| Sector {
            azimuth: (f64::from(n) + 0.5) * TAU / SECTORS as f64,
            angle: line.map(|l| l.slope.atan()),
            toe: line.map(|l| l.at_axis / l.slope).filter(|toe| toe.is_finite()),
        });
        Ok(Repose {
            angle: slope.atan(),
            standard_deviation,
            confidence: ((slope - half).atan(), (slope + half).atan()),
            by_volume: (height / (3.0 * volume / (PI * height)).sqrt()).atan(),
            height,
            flank,
            base_radius,
            volume,
            axis,
            sectors: sectors.collect(),
        })
    }

    /// Radius in m of the circle with the area of all cells at least so high.
    fn radius_at(&self, level: f64) -> f64 {
        let higher = self.cells.iter().filter(|c| c.height >= level).count();
        (higher as f64 * self.cell * self.cell / PI).sqrt()
    }

    /// The line of each sector between two radii.
    fn lines(&self, axis: (f64, f64), flank: (f64, f64)) -> Vec<Option<Line>> {
        // Distance from the axis and height of the cells of each sector.
        let mut cells: Vec<Vec<(f64, f64)>> = vec![Vec::new(); SECTORS];
        for c in &self.cells {
            let (x, y) = (c.x - axis.0, c.y - axis.1);
            let distance = x.hypot(y);
            if distance < flank.0 || distance > flank.1 || distance == 0.0 {
                continue;
            }
            let turn = y.atan2(x).rem_euclid(TAU) / TAU;
            let sector = ((turn * SECTORS as f64) as usize).min(SECTORS - 1);
            cells[sector].push((distance, c.height));
        }
        cells.iter().map(|cells| Line::fit(cells)).collect()
    }
}

/// A straight line through a sector's flank.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// Positive where it falls outwards.
    slope: f64,
    /// Height in m at which it meets the axis.
    at_axis: f64,
}

impl Line {
    /// By least squares through distances and heights; the number of cells grows
    /// with the distance, so that each weighs less.
    fn fit(cells: &[(f64, f64)]) -> Option<Self> {
        if cells.len() < LEAST_CELLS {
            return None;
        }
        let weighed = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            cells.iter().map(|(r, h)| of(*r, *h) / r).sum::<f64>()
        };
        let all = weighed(&|_, _| 1.0);
        let (mr, mh) = (weighed(&|r, _| r) / all, weighed(&|_, h| h) / all);
        let across = weighed(&|r, _| (r - mr).powi(2));
        let slope = -weighed(&|r, h| (r - mr) * (h - mh)) / across;
        slope.is_finite().then_some(Self { slope, at_axis: mh + slope * mr })
    }
}

/// Half of the confidence interval of the mean slope, from the means of parts of the circumference.
fn half_width(lines: &[Option<Line>]) -> Option<f64> {
    let batches: Vec<f64> = lines
        .chunks(SECTORS / BATCHES)
        .filter_map(|part| {
            let slopes: Vec<f64> = part.iter().flatten().map(|line| line.slope).collect();
            statistics::mean(&slopes)
        })
        .collect();
    MeanTest::of(&batches, CONFIDENCE).map(|test| test.half_width)
}

#[cfg(test)]
mod tests;
