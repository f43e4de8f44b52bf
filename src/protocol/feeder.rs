//! The spout: when the next grain of a pile is let go, and where.

use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::geometry::{Pose, Vector};
use crate::grains::{
    self, Mixing,
    streams::{in_unit_disc, stream},
};
use crate::scale;
use crate::specimen::Specimen;

/// Places under the spout that are tried before a grain waits for the next check.
const TRIES: usize = 16;

/// A grain counts as landed so many times the time of its free fall after it
/// was let go, and [`scale::LANDED_AFTER`] later.
const FALLS: f64 = 2.0;

/// How grains are fed, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Feed {
    /// Grains a second.
    pub rate: f64,
    /// From the top of the pile to the sphere around a grain let go, in m.
    pub drop_height: f64,
    /// Radius in m of the disc in which centres of grains are let go.
    pub spout_radius: f64,
    /// Gravitational acceleration in m/s².
    pub gravity: f64,
}

/// Grains waiting in the spout.
pub(super) struct Feeder {
    feed: Feed,
    mixing: Mixing,
    /// Radius of the sphere around each grain with its clearance, in m.
    radii: Vec<f64>,
    /// How long after its fall a grain counts as landed, in s.
    landed_after: f64,
    /// Highest point of the base in m.
    base_top: f64,
    so_far: Fed,
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
}

impl Fed {
    /// Whether it can be of so many grains.
    ///
    /// # Errors
    /// What does not fit, for a reader.
    pub(super) fn check(&self, grains: usize) -> Result<(), String> {
        if self.count > grains {
            return Err(format!("`fed.count` is {}, and there are {grains} grains", self.count));
        }
        Ok(())
    }
}

impl Feeder {
    /// All grains of a specimen, mixed, of which some may have been let go.
    pub(super) fn new(
        specimen: &Specimen,
        feed: Feed,
        seed: u64,
        configuration: u32,
        so_far: Option<Fed>,
    ) -> Self {
        let set = &specimen.grains;
        let fixed = specimen.state.base.iter().flat_map(|base| &base.fixed_grains);
        let base_top = fixed
            .flat_map(|f| set.grains[f.grain].shape.vertices().iter().map(|v| (f.pose * v).z))
            .fold(0.0, f64::max);
        let clearance = set.rain_clearance();
        let radius = |g: &grains::Grain| g.shape.radius_about_origin() + clearance;
        Self {
            feed,
            landed_after: scale::LANDED_AFTER.at(&set.scale(feed.gravity)),
            mixing: grains::mix(set, seed, configuration),
            radii: set.grains.iter().map(radius).collect(),
            base_top,
            so_far: so_far.unwrap_or_else(|| Fed {
                count: 0,
                falling: Vec::new(),
                rng: stream(seed, &format!("places under the spout of mixing {configuration}")),
            }),
        }
    }

    /// What has changed so far.
    pub(super) fn into_fed(self) -> Fed {
        self.so_far
    }

    /// Whether every grain has been let go.
    pub(super) fn is_empty(&self) -> bool {
        self.so_far.count == self.mixing.order.len()
    }

    /// Number of grains not let go yet.
    pub(super) fn waiting(&self) -> usize {
        self.mixing.order.len() - self.so_far.count
    }

    /// The grains to let go at a time, in s since feeding began, with their poses.
    /// A grain that is due waits while others are where it would begin.
    pub(super) fn due(&mut self, specimen: &Specimen, time: f64) -> Vec<(usize, Pose)> {
        self.so_far.falling.retain(|(_, landed)| *landed > time);
        let mut released: Vec<(usize, Pose)> = Vec::new();
        let mut top = None;
        while !self.is_empty() && self.so_far.count as f64 <= time * self.feed.rate {
            let top = *top.get_or_insert_with(|| self.top_of_pile(specimen));
            let grain = self.mixing.order[self.so_far.count];
            let Some(place) = self.find_room(grain, top, specimen, &released) else { break };
            let pose = Pose::from_parts(place.into(), self.mixing.orientations[grain]);
            let fall =
                (2.0 * (self.feed.drop_height + self.radii[grain]) / self.feed.gravity).sqrt();
            self.so_far.falling.push((grain, time + FALLS * fall + self.landed_after));
            released.push((grain, pose));
            self.so_far.count += 1;
        }
        released
    }

    /// Highest point in m of the base and of the grains that have landed.
    fn top_of_pile(&self, specimen: &Specimen) -> f64 {
        let landed =
            specimen.present().filter(|i| !self.so_far.falling.iter().any(|(g, _)| g == i));
        landed.map(|i| highest_point(specimen, i)).fold(self.base_top, f64::max)
    }

    /// A place for a grain above the top of the pile, clear of every other grain.
    fn find_room(
        &mut self,
        grain: usize,
        top: f64,
        specimen: &Specimen,
        released: &[(usize, Pose)],
    ) -> Option<Vector> {
        let z = top + self.feed.drop_height + self.radii[grain];
        let radius = self.radii[grain];
        (0..TRIES).find_map(|_| {
            let (x, y, _) = in_unit_disc(&mut self.so_far.rng);
            let place = Vector::new(x * self.feed.spout_radius, y * self.feed.spout_radius, z);
            let clear = |other: usize, at: &Vector| {
                (at - place).norm_squared() > (radius + self.radii[other]).powi(2)
            };
            let present = specimen
                .present()
                .all(|i| clear(i, &specimen.state.bodies[i].body.pose.translation.vector));
            let place_is_clear =
                present && released.iter().all(|(i, pose)| clear(*i, &pose.translation.vector));
            place_is_clear.then_some(place)
        })
    }
}

/// Height of a grain's highest vertex in m.
fn highest_point(specimen: &Specimen, grain: usize) -> f64 {
    let pose = &specimen.state.bodies[grain].body.pose;
    let vertices = specimen.grains.grains[grain].shape.vertices();
    vertices.iter().map(|v| (pose * v).z).fold(f64::NEG_INFINITY, f64::max)
}
