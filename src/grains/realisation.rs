//! Realisations: the same grains mixed anew, in another order and turned otherwise, and where
//! they begin their fall.

use std::f64::consts::FRAC_1_SQRT_2 as H;

use nalgebra::{Translation3, UnitQuaternion};

use super::*;

/// Places tried for each grain; the lowest is taken.
const TRIES: usize = 24;

/// One realisation of a grain set: its grains mixed anew.
#[derive(Debug, Clone, PartialEq)]
pub struct Realisation {
    /// Indices of the grains in the order in which they are placed, lowest first.
    pub order: Vec<usize>,
    /// Orientation of each grain's principal axes, by grain index.
    pub orientations: Vec<UnitQuaternion<f64>>,
    /// Seed it was drawn from.
    pub seed: u64,
    /// Its number, `configuration` in a scenario.
    pub configuration: u32,
}

/// Mixes the grains: a random order and uniformly random orientations, others
/// for every seed and configuration (paper, section 3: "three different
/// initial configurations ... obtained by additional mixing").
pub fn mix(grains: &GrainSet, seed: u64, configuration: u32) -> Realisation {
    let mut order: Vec<usize> = (0..grains.grains.len()).collect();
    shuffle(&mut stream(seed, &format!("order of mixing {configuration}")), &mut order);
    let mut rng = stream(seed, &format!("orientations of mixing {configuration}"));
    let orientations = order.iter().map(|_| rotation(&mut rng)).collect();
    Realisation { order, orientations, seed, configuration }
}

/// Poses, by grain index, from which mixed grains can be let fall: their bounding spheres, with a
/// clearance around ([`GrainSet::rain_clearance`]), touch neither each other nor the vertical
/// cylinder of radius `region_radius` (m) about the z axis nor the plane z = `bottom` (m), and form
/// a column about as low as dropped spheres do.
///
/// Each sphere in turn is dropped from random places, rolls down from the
/// lowest of them, and stays there.
///
/// # Errors
/// A realisation of other grains, sizes that are not finite, a grain too large for the region.
pub fn rain(
    grains: &GrainSet,
    mixed: &Realisation,
    region_radius: f64,
    bottom: f64,
) -> Result<Vec<Pose>, GrainsError> {
    positive("radius of the region for the grains, m", region_radius)?;
    if !bottom.is_finite() {
        return Err(GrainsError::NotPositive {
            what: "height of the bottom of the region, m".into(),
            value: bottom,
        });
    }
    let count = grains.grains.len();
    check_realisation(mixed, count)?;
    let clearance = grains.rain_clearance();
    let radii: Vec<f64> =
        grains.grains.iter().map(|g| g.shape.radius_about_origin() + clearance).collect();
    if let Some(grain) = radii.iter().position(|&r| r > region_radius) {
        let (radius_m, region_m) = (radii[grain], region_radius);
        return Err(GrainsError::DoesNotFit { grain, radius_m, region_m });
    }
    let largest = radii.iter().copied().fold(0.0, f64::max);
    let mut stack = Stack::new(region_radius, bottom, largest);
    let name = format!("places of mixing {}", mixed.configuration);
    let mut rng = stream(mixed.seed, &name);
    let mut poses = vec![Pose::identity(); count];
    for &grain in &mixed.order {
        let sphere = stack.drop_sphere(radii[grain], &mut rng);
        let place = Translation3::new(sphere.x, sphere.y, sphere.z);
        poses[grain] = Pose::from_parts(place, mixed.orientations[grain]);
    }
    Ok(poses)
}

fn check_realisation(mixed: &Realisation, grains: usize) -> Result<(), GrainsError> {
    let mut order = mixed.order.clone();
    order.sort_unstable();
    if !order.into_iter().eq(0..grains) || mixed.orientations.len() != grains {
        return Err(GrainsError::ForeignRealisation(grains));
    }
    Ok(())
}

#[derive(Debug, Clone, Copy)]
struct Sphere {
    x: f64,
    y: f64,
    z: f64,
    radius: f64,
}

/// Spheres at rest on each other in a cylinder, in a grid of vertical columns.
struct Stack {
    region_radius: f64,
    bottom: f64,
    largest: f64,
    cell: f64,
    width: usize,
    /// Spheres by column, highest first.
    columns: Vec<Vec<Sphere>>,
}

impl Stack {
    fn new(region_radius: f64, bottom: f64, largest: f64) -> Self {
        // Columns as wide as the largest sphere: whatever touches a sphere
        // stands in its own column or one of the eight around it.
        let cell = (2.0 * largest).max(region_radius / 512.0);
        let width = (2.0 * region_radius / cell) as usize + 1;
        let columns = vec![Vec::new(); width * width];
        Self { region_radius, bottom, largest, cell, width, columns }
    }

    fn index(&self, x: f64) -> usize {
        (((x + self.region_radius) / self.cell) as usize).min(self.width - 1)
    }

    /// Height of the centre at which a sphere coming down at (x, y) stops.
    fn resting_height(&self, x: f64, y: f64, radius: f64) -> f64 {
        let mut height = self.bottom + radius;
        let (i, j) = (self.index(x), self.index(y));
        // Its own column first: what it finds there lets the others, which
        // often hold nothing in reach, be left after a glance at their tops.
        height = self.height_on(j * self.width + i, height, (x, y, radius));
        for j in j.saturating_sub(1)..=(j + 1).min(self.width - 1) {
            for i in i.saturating_sub(1)..=(i + 1).min(self.width - 1) {
                height = self.height_on(j * self.width + i, height, (x, y, radius));
            }
        }
        height
    }

    /// Raises the height of a sphere (x, y, radius) to where it lies on those of a column.
    fn height_on(&self, column: usize, mut height: f64, (x, y, radius): (f64, f64, f64)) -> f64 {
        for other in &self.columns[column] {
            // All further ones are lower still.
            if other.z + radius + self.largest <= height {
                break;
            }
            let reach = radius + other.radius;
            let apart2 = (x - other.x).powi(2) + (y - other.y).powi(2);
            if apart2 < reach * reach {
                height = height.max(other.z + (reach * reach - apart2).sqrt());
            }
        }
        height
    }

    /// Drops a sphere and keeps it.
    fn drop_sphere(&mut self, radius: f64, rng: &mut Pcg64) -> Sphere {
        let room = self.region_radius - radius;
        let mut best = Sphere { x: 0.0, y: 0.0, z: f64::INFINITY, radius };
        for _ in 0..TRIES {
            let (x, y, _) = in_unit_disc(rng);
            self.improve(&mut best, x * room, y * room);
        }
        self.roll(&mut best, room);
        let column = self.index(best.y) * self.width + self.index(best.x);
        let spheres = &mut self.columns[column];
        let place = spheres.partition_point(|s| s.z > best.z);
        spheres.insert(place, best);
        best
    }

    /// Puts a sphere elsewhere if it comes to lie lower there.
    fn improve(&self, best: &mut Sphere, x: f64, y: f64) {
        let z = self.resting_height(x, y, best.radius);
        if z < best.z {
            *best = Sphere { x, y, z, ..*best };
        }
    }

    /// Rolls a sphere downhill by steps that halve where no direction leads down.
    fn roll(&self, best: &mut Sphere, room: f64) {
        // A table, not sines: their last bit differs between platforms.
        const DIRECTIONS: [(f64, f64); 8] =
            [(1.0, 0.0), (H, H), (0.0, 1.0), (-H, H), (-1.0, 0.0), (-H, -H), (0.0, -1.0), (H, -H)];
        const MOST_STEPS: usize = 64;
        let mut step = best.radius / 2.0;
        for _ in 0..MOST_STEPS {
            let from = *best;
            for (dx, dy) in DIRECTIONS {
                let (x, y) = (from.x + step * dx, from.y + step * dy);
                // Along the wall a step outwards ends on the wall.
                let far = (room / (x * x + y * y).sqrt().max(f64::MIN_POSITIVE)).min(1.0);
                self.improve(best, x * far, y * far);
            }
            if best.z >= from.z {
                step /= 2.0;
            }
            if step < best.radius / 64.0 {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grains::{
        generate,
        tests::{few_grains, paper_grains},
    };

    /// Smallest gap between two bounding spheres without clearance, smallest
    /// gap to the wall, to the bottom, and the height of the column, all in m.
    fn gaps(grains: &GrainSet, poses: &[Pose], region: f64, bottom: f64) -> [f64; 4] {
        let radius: Vec<f64> =
            grains.grains.iter().map(|g| g.shape.radius_about_origin()).collect();
        let at = |i: usize| poses[i].translation.vector;
        let mut gaps = [f64::INFINITY, f64::INFINITY, f64::INFINITY, 0.0];
        for i in 0..poses.len() {
            gaps[1] = gaps[1].min(region - at(i).xy().norm() - radius[i]);
            gaps[2] = gaps[2].min(at(i).z - radius[i] - bottom);
            gaps[3] = gaps[3].max(at(i).z + radius[i] - bottom);
            for j in 0..i {
                gaps[0] = gaps[0].min((at(i) - at(j)).norm() - radius[i] - radius[j]);
            }
        }
        gaps
    }

    #[test]
    fn rained_grains_are_apart_inside_and_compact() {
        let grains = generate(&paper_grains(), 1).unwrap();
        let (region, bottom) = (0.08, 0.25);
        let poses = rain(&grains, &mix(&grains, 1, 1), region, bottom).unwrap();
        let [apart, wall, floor, height] = gaps(&grains, &poses, region, bottom);
        let rounding = 1e-9;
        let clearance = grains.rain_clearance();
        for (what, gap, least) in [
            ("between spheres", apart, 2.0 * clearance),
            ("to the wall", wall, clearance),
            ("to the bottom", floor, clearance),
        ] {
            assert!(gap > least - rounding, "gap {what}: expected ≥ {least} m, got {gap} m");
        }
        let spheres: f64 = grains
            .grains
            .iter()
            .map(|g| 4.0 / 3.0 * std::f64::consts::PI * g.shape.radius_about_origin().powi(3))
            .sum();
        let share = spheres / (std::f64::consts::PI * region * region * height);
        assert!(share >= 0.30, "bounding spheres fill ≥ 30 % of the column, got {share}");
    }

    #[test]
    fn the_gap_helper_sees_spheres_that_overlap_and_leave() {
        let grains = generate(&few_grains(), 1).unwrap();
        let n = grains.grains.len();
        let together = vec![Pose::translation(0.0, 0.0, -1.0); n];
        let [apart, _, floor, _] = gaps(&grains, &together, 0.1, 0.0);
        assert!(apart < 0.0 && floor < 0.0, "grains in one place below the floor: {apart} {floor}");
        let far = vec![Pose::translation(1.0, 0.0, 0.0); n];
        assert!(gaps(&grains, &far, 0.1, 0.0)[1] < 0.0, "grains outside the wall");
    }

    #[test]
    fn same_configuration_same_bits_another_one_differs() {
        let grains = generate(&few_grains(), 1).unwrap();
        let one = mix(&grains, 1, 1);
        assert_eq!(one, mix(&grains, 1, 1), "same seed and configuration, same bits");
        for (seed, configuration) in [(1, 2), (2, 1)] {
            let other = mix(&grains, seed, configuration);
            assert_ne!(one.order, other.order, "another order");
            assert_ne!(one.orientations, other.orientations, "other orientations");
        }
        let poses = |mixed: &Realisation| rain(&grains, mixed, 0.05, 0.0).unwrap();
        assert_eq!(poses(&one), poses(&one), "same realisation, same places");
        assert_ne!(poses(&one), poses(&mix(&grains, 1, 2)), "another realisation, other places");
        for (i, pose) in poses(&one).iter().enumerate() {
            assert_eq!(pose.rotation, one.orientations[i], "grain {i} is turned as mixed");
        }
    }

    #[test]
    fn a_narrow_region_is_a_column_and_a_narrower_one_an_error() {
        let grains = generate(&few_grains(), 1).unwrap();
        let mixed = mix(&grains, 1, 1);
        let needed = grains.largest_bounding_radius() + grains.rain_clearance();
        let poses = rain(&grains, &mixed, needed, 0.0).unwrap();
        let [apart, wall, ..] = gaps(&grains, &poses, needed, 0.0);
        assert!(apart > 0.0 && wall > 0.0, "gaps in a tight column: {apart} m, {wall} m");
        let error = rain(&grains, &mixed, needed * 0.999, 0.0);
        assert!(matches!(error, Err(GrainsError::DoesNotFit { .. })), "{error:?}");
        for bad in [0.0, -1.0, f64::NAN] {
            assert!(rain(&grains, &mixed, bad, 0.0).is_err(), "region radius {bad}");
        }
        assert!(rain(&grains, &mixed, 0.1, f64::NAN).is_err(), "bottom NaN");
        let mut foreign = mixed.clone();
        foreign.order[0] = foreign.order[1];
        let error = rain(&grains, &foreign, 0.1, 0.0);
        assert!(matches!(error, Err(GrainsError::ForeignRealisation(_))), "{error:?}");
    }
}
