//! The spout: when the next grain of a pile is let go, and where.

use nalgebra::UnitQuaternion;
use rand_pcg::Pcg64;

use super::*;
use crate::grains::{self, Realisation};
use crate::in_order::each_once;
use crate::plain::counted;
use crate::units::to_mm;

/// Places under the spout that are tried before a grain waits for the next check.
const TRIES: usize = 16;

/// Looks in a row at which a grain is due and finds no place, though everything is at rest, before
/// feeding counts as stuck: about 2 s of the paper's gravel, less where samples fall between
/// checks, as both are looks. Ours: of [`TRIES`] random places at each none was free, so that with
/// 95 % confidence less than 0.2 % of the area is (3 over their number).
const STUCK_AFTER: u32 = 100;

/// A grain counts as landed this number of times of free fall after it was let go, and
/// [`scale::LANDED_AFTER`] later.
const FALLS: f64 = 2.0;

/// How grains are fed, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Feed {
    pub rate: Rate,
    pub outlet: Outlet,
    /// Which grains, in their order; left out, all of them as they are mixed.
    pub grains: Option<Vec<usize>>,
}

/// How fast grains are fed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rate {
    /// Grains per second.
    Grains(f64),
    /// kg/s.
    Mass(f64),
}

/// Where grains are let go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Outlet {
    /// From a spout that rises with the pile.
    Spout {
        /// From the top of the pile to the sphere around a grain let go, in m.
        drop_height: f64,
        /// Radius in m of the disc in which centres of grains are let go.
        radius: f64,
    },
    /// From an area that stays where it is.
    Area(Area),
    /// From above what lies beneath, within an area seen from above.
    Above {
        /// Grains begin at its height or above it.
        area: Area,
        /// From the sphere around a grain let go to where it meets that around another, in m.
        fall: f64,
    },
}

/// An area from which grains are let go, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub middle: Vector,
    /// Half of its sizes along x and y.
    pub half: [f64; 2],
    /// Whether it is an ellipse, not a rectangle.
    pub round: bool,
}

impl Area {
    /// A place in it for the centre of a ball of a radius in m that stays within it.
    fn place(&self, radius: f64, rng: &mut Pcg64) -> Vector {
        let half = self.half.map(|half| (half - radius).max(0.0));
        let (x, y) = match self.round {
            true => {
                let (x, y, _) = in_unit_disc(rng);
                (x, y)
            }
            false => (2.0 * uniform(rng) - 1.0, 2.0 * uniform(rng) - 1.0),
        };
        self.middle + Vector::new(x * half[0], y * half[1], 0.0)
    }

    /// Places for balls of a radius in m side by side, from its height upwards without end.
    pub(super) fn lattice(&self, radius: f64) -> impl Iterator<Item = Vector> + use<> {
        let (area, counts) = (*self, self.counts(radius));
        (0..i64::MAX).flat_map(move |level| {
            let up = (2 * level + 1) as f64 * radius;
            let place = move |[x, y]: [f64; 2]| area.middle + Vector::new(x, y, up);
            (0..counts[0] * counts[1])
                .filter_map(move |n| area.in_layer(n, counts, radius).map(place))
        })
    }

    /// Numbers of balls in a layer along x and y.
    fn counts(&self, radius: f64) -> [i64; 2] {
        let counts = self.half.map(|half| ((half / radius).floor() as i64).max(1));
        let mut all = 0..counts[0] * counts[1];
        // Two by two stand in the corners: a circle that just holds two side by side has none of them.
        let has_any = all.any(|n| self.in_layer(n, counts, radius).is_some());
        if has_any { counts } else { [1; 2] }
    }

    /// Where a ball of a layer is, off its middle; none where that is not within the area.
    fn in_layer(&self, n: i64, counts: [i64; 2], radius: f64) -> Option<[f64; 2]> {
        let along = |k: i64, count: i64| (2 * k + 1 - count) as f64 * radius;
        let x = along(n % counts[0], counts[0]);
        let y = along(n / counts[0], counts[1]);
        let room = self.half.map(|half| (half - radius).max(radius / 2.0));
        let within = (x / room[0]).powi(2) + (y / room[1]).powi(2) <= 1.0;
        (within || !self.round).then_some([x, y])
    }
}

/// Grains waiting in the spout.
pub(super) struct Feeder {
    feed: Feed,
    /// Gravitational acceleration in m/s².
    gravity: f64,
    order: Vec<usize>,
    orientations: Vec<UnitQuaternion<f64>>,
    /// Mass in kg of the first grains of the order, by their number.
    masses: Vec<f64>,
    /// Radius of the sphere around each grain with its clearance, in m.
    radii: Vec<f64>,
    /// How long after its fall a grain counts as landed, in s.
    landed_after: f64,
    /// Highest point of the base in m.
    base_top: f64,
    /// What has changed so far.
    pub(super) so_far: Fed,
}

/// What changes about a spout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fed {
    /// Number of grains let go so far.
    count: usize,
    /// Grains let go, and when they count as landed, in s since feeding began.
    falling: Vec<(usize, f64)>,
    /// Where the places under the spout come from.
    rng: Pcg64,
    /// Looks in a row at which a grain was due and found no place, though everything was at rest;
    /// not in a checkpoint of before these were counted.
    #[serde(default)]
    blocked: u32,
    /// Grains let go above a surface, and the heights of their centroids then in m.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    let_go: Vec<(usize, f64)>,
}

impl Fed {
    /// Whether it can be of a number of grains.
    ///
    /// # Errors
    /// What does not fit, for a reader.
    pub(super) fn check(&self, grains: usize) -> Result<(), String> {
        if self.count > grains {
            let of = counted(grains, "grain");
            return Err(format!("`fed.count` is {}, more than {of}", self.count));
        }
        if let Some((grain, _)) = self.let_go.iter().find(|(grain, _)| *grain >= grains) {
            return Err(format!("`fed.let_go` names grain {grain} of {grains}"));
        }
        Ok(())
    }
}

impl Feeder {
    /// All grains of a specimen, mixed, of which some may have been let go.
    pub(super) fn new(setup: &Setup, specimen: &Specimen, feed: Feed, so_far: Option<Fed>) -> Self {
        let Setup { seed, configuration, gravity, .. } = *setup;
        let set = &specimen.grains;
        let fixed = specimen.state.base.iter().flat_map(|base| &base.fixed_grains);
        let base_top =
            fixed.map(|f| set.grains[f.grain].shape.heights(&f.pose).1).fold(0.0, f64::max);
        let clearance = set.rain_clearance();
        let radius = |g: &grains::Grain| g.shape.radius_about_origin() + clearance;
        let Realisation { order, orientations, .. } = grains::mix(set, seed, configuration);
        let order = feed.grains.clone().unwrap_or(order);
        let mut mass = 0.0;
        let masses = order.iter().map(|&grain| {
            let before = mass;
            mass += set.grains[grain].mass;
            before
        });
        Self {
            masses: masses.collect(),
            order,
            orientations,
            landed_after: scale::LANDED_AFTER.at(&set.scale(gravity)),
            radii: set.grains.iter().map(radius).collect(),
            base_top,
            so_far: so_far.unwrap_or_else(|| Fed {
                count: 0,
                falling: Vec::new(),
                rng: stream(seed, &format!("places under the spout of mixing {configuration}")),
                blocked: 0,
                let_go: Vec::new(),
            }),
            feed,
            gravity,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.so_far.count == self.order.len()
    }

    /// Number of grains not let go yet.
    pub(super) fn waiting(&self) -> usize {
        self.order.len() - self.so_far.count
    }

    /// The grains to let go at a time, in s since feeding began, with their poses.
    /// A grain that is due waits while others are where it would begin.
    /// `clear` tells of a ball whether it would not touch the apparatus.
    pub(super) fn due(
        &mut self,
        specimen: &Specimen,
        time: f64,
        clear: &dyn Fn(&Vector, f64) -> bool,
    ) -> Vec<(usize, Pose)> {
        self.so_far.falling.retain(|(_, landed)| *landed > time);
        let mut released: Vec<(usize, Pose)> = Vec::new();
        let mut top = None;
        while !self.is_empty() && self.is_due(time) {
            let grain = self.order[self.so_far.count];
            let (drop_height, top) = match self.feed.outlet {
                Outlet::Spout { drop_height, .. } => {
                    (drop_height, *top.get_or_insert_with(|| self.top_of_pile(specimen)))
                }
                Outlet::Area(area) => (0.0, area.middle.z),
                Outlet::Above { area, fall } => (fall, area.middle.z),
            };
            let room = self.find_room(grain, top, specimen, &released, clear);
            let Some(place) = room else { break };
            let pose = Pose::from_parts(place.into(), self.orientations[grain]);
            let fall = (2.0 * (drop_height + self.radii[grain]) / self.gravity).sqrt();
            self.so_far.falling.push((grain, time + FALLS * fall + self.landed_after));
            if matches!(self.feed.outlet, Outlet::Above { .. }) {
                self.so_far.let_go.push((grain, place.z));
            }
            released.push((grain, pose));
            self.so_far.count += 1;
        }
        released
    }

    /// Whether a grain is due that has found no place at a time in s.
    pub(super) fn is_blocked(&self, time: f64) -> bool {
        !self.is_empty() && self.is_due(time)
    }

    /// Counts looks in a row at which a grain is blocked by what is at rest.
    pub(super) fn note_blocked(&mut self, by_what_rests: bool) {
        self.so_far.blocked = if by_what_rests { self.so_far.blocked + 1 } else { 0 };
    }

    /// Whether no grain will find a place any more, as far as that can be known.
    pub(super) fn is_stuck(&self) -> bool {
        self.so_far.blocked >= STUCK_AFTER
    }

    /// The pieces, by number, that leave the next grain no place somewhere in the area that it is let
    /// go from; none under a spout.
    pub(super) fn in_the_way(&self, specimen: &Specimen, solids: &Solids) -> Vec<usize> {
        let (Outlet::Area(area) | Outlet::Above { area, .. }) = self.feed.outlet else {
            return Vec::new();
        };
        let Some(&grain) = self.order.get(self.so_far.count) else { return Vec::new() };
        let radius = self.radii[grain];
        let half = area.half.map(|half| (half - radius).max(0.0));
        let quarters = |n: i32| f64::from(n) / 4.0;
        let all = (-4..=4).flat_map(|x| (-4..=4).map(move |y| [x, y])).map(|at| at.map(quarters));
        let within = all.filter(|[x, y]| !area.round || x.hypot(*y) <= 1.0);
        let touched = within.flat_map(|[x, y]| {
            let place = area.middle + Vector::new(x * half[0], y * half[1], 0.0);
            solids.touched(&place, radius, &specimen.state).collect::<Vec<usize>>()
        });
        each_once(touched)
    }

    /// Whether the next grain is due at a time in s.
    fn is_due(&self, time: f64) -> bool {
        match self.feed.rate {
            Rate::Grains(rate) => self.so_far.count as f64 <= time * rate,
            Rate::Mass(rate) => self.masses[self.so_far.count] <= time * rate,
        }
    }

    /// Highest point in m of the base and of the grains that have landed.
    fn top_of_pile(&self, specimen: &Specimen) -> f64 {
        let landed =
            specimen.present().filter(|i| !self.so_far.falling.iter().any(|(g, _)| g == i));
        landed.map(|i| specimen.top(i)).fold(self.base_top, f64::max)
    }

    /// How far grains that were let go above a surface have sunk since, of those that are there;
    /// none where grains were not let go so.
    pub(super) fn fall(&self, specimen: &Specimen) -> Option<Fall> {
        let is_there = |grain: usize| specimen.state.bodies[grain].fate == Fate::Present;
        let let_go = self.so_far.let_go.iter().filter(|(grain, _)| is_there(*grain));
        let sunk: Vec<f64> =
            let_go.map(|(grain, from)| to_mm(from - specimen.centroid(*grain).z)).collect();
        let largest_mm = sunk.iter().copied().reduce(f64::max)?;
        Some(Fall { mean_mm: sunk.iter().sum::<f64>() / sunk.len() as f64, largest_mm })
    }

    /// Height in m of the centre of a ball of a radius that comes down at a place, where it meets
    /// the first ball around a grain that has landed; −∞ where it meets none.
    fn meets(&self, place: &Vector, radius: f64, specimen: &Specimen) -> f64 {
        let landed =
            specimen.present().filter(|i| !self.so_far.falling.iter().any(|(g, _)| g == i));
        let met = landed.filter_map(|i| {
            let at = specimen.centroid(i);
            let across = (at.xy() - place.xy()).norm_squared();
            let up = (radius + self.radii[i]).powi(2) - across;
            (up > 0.0).then(|| at.z + up.sqrt())
        });
        met.fold(f64::NEG_INFINITY, f64::max)
    }

    /// A place for a grain above the top of the pile, clear of every other grain.
    fn find_room(
        &mut self,
        grain: usize,
        top: f64,
        specimen: &Specimen,
        released: &[(usize, Pose)],
        clear_of_apparatus: &dyn Fn(&Vector, f64) -> bool,
    ) -> Option<Vector> {
        let radius = self.radii[grain];
        (0..TRIES).find_map(|_| {
            let place = match self.feed.outlet {
                Outlet::Spout { drop_height, radius: spout } => {
                    let (x, y, _) = in_unit_disc(&mut self.so_far.rng);
                    Vector::new(x * spout, y * spout, top + drop_height + radius)
                }
                Outlet::Area(area) => area.place(radius, &mut self.so_far.rng),
                Outlet::Above { area, fall } => {
                    let mut place = area.place(radius, &mut self.so_far.rng);
                    place.z = place.z.max(self.meets(&place, radius, specimen) + fall);
                    place
                }
            };
            let clear = |other: usize, at: &Vector| {
                (at - place).norm_squared() > (radius + self.radii[other]).powi(2)
            };
            let present = specimen.present().all(|i| clear(i, &specimen.centroid(i)));
            let place_is_clear =
                present && released.iter().all(|(i, pose)| clear(*i, &pose.translation.vector));
            (place_is_clear && clear_of_apparatus(&place, radius)).then_some(place)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: a lattice has places on every level, however little of a grid lies within a round area.
    #[test]
    fn every_layer_of_a_lattice_has_a_place() {
        for round in [false, true] {
            for tenths in 1..=100 {
                let half = f64::from(tenths) / 10.0;
                let area = Area { middle: Vector::zeros(), half: [half; 2], round };
                let counts = area.counts(1.0);
                let all = 0..counts[0] * counts[1];
                let layer: Vec<[f64; 2]> =
                    all.filter_map(|n| area.in_layer(n, counts, 1.0)).collect();
                assert!(!layer.is_empty(), "law: one at least, half {half} radii, round {round}");
                let beyond = layer.iter().find(|[x, y]| x.hypot(*y) + 1.0 > half + 1e-12);
                let fits = !round || half < 1.0 || beyond.is_none();
                assert!(fits, "law: all lie in a circle of {half} radii, got {beyond:?}");
            }
        }
        let area = Area { middle: Vector::new(0.0, 0.0, 5.0), half: [2.2; 2], round: true };
        let places: Vec<Vector> = area.lattice(1.0).take(2).collect();
        let expected = [Vector::new(0.0, 0.0, 6.0), Vector::new(0.0, 0.0, 8.0)];
        assert_eq!(places, expected, "law: one above the other, side by side there is no room");
    }
}
