//! The state of the experiment between stages, as a plain value.

mod free;
mod opening;
mod press;
mod region;

use std::{borrow::Cow, sync::Arc};

pub use free::FreeState;
pub use opening::{Opening, centroids};
pub use press::{PressState, TurnState};
pub use region::Region;

use serde::{Deserialize, Serialize};

use crate::{
    geometry::{ConvexPolyhedron, Pose, Vector},
    grains::GrainSet,
    plain::{counted, in_number},
    world::BodyState,
};

/// Nothing is farther from the middle of the cylinder's floor than this, in m: far
/// beyond any laboratory, and near enough to be computed with.
const FARTHEST: f64 = 1e6;

/// No other number of a state is larger, in the units of [`SpecimenState`].
const LARGEST: f64 = 1e12;

/// Grains, their poses and the state of the apparatus: everything that one
/// stage hands to the next, and nothing of an engine.
#[derive(Debug, Clone, PartialEq)]
pub struct Specimen {
    /// The grains; their order is that of `bodies`.
    pub grains: Arc<GrainSet>,
    /// The rest, which is what a saved specimen holds.
    pub state: SpecimenState,
}

/// Everything that changes about a specimen.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SpecimenState {
    /// One entry a grain, in the order of the grain set: centroid position and
    /// orientation of its principal axes, and velocities.
    pub bodies: Vec<GrainState>,
    /// The funnel, while it stands.
    pub funnel: Option<FunnelState>,
    /// Whether the cylinder stands on the table.
    pub cylinder: bool,
    /// What a pile stands on, where one is built.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<Base>,
    /// Centroid pose and velocity of the top plate, once placed.
    pub top_plate: Option<BodyState>,
    /// The loaded contacts, which engines that take them go on from; empty
    /// where an engine gave none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<SavedContact>,
    /// Displacement of the shaking table along x in m.
    pub table_x: f64,
    /// The same along y.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub table_y: f64,
    /// The same along z.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub table_z: f64,
    /// The pieces of a laboratory, in the order of the scenario; none where it has the
    /// built-in apparatus, and before its first stage.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pieces: Vec<PieceState>,
    /// Simulated time since the first stage began, in s.
    pub time: f64,
}

/// Where a piece of a laboratory is, and what the grains do to it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PieceState {
    /// Whether it stands; false once it was removed.
    pub present: bool,
    /// Where its own frame is, in m.
    pub pose: Pose,
    /// Force of the grains on it in N, mean since the sample before, or since the joint of two
    /// checkpoint segments where that is later.
    pub force_n: Vector,
    /// Moment of that force about the origin of its frame in N m, world axes.
    pub moment_n_m: Vector,
    /// How it is pressed; none of a piece that is fixed or moved as prescribed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub press: Option<PressState>,
    /// How it moves freely; none of every other piece.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free: Option<FreeState>,
}

impl PieceState {
    /// Whether it moves only as prescribed, if at all.
    pub fn is_held(&self) -> bool {
        self.press.is_none() && self.free.is_none()
    }

    /// Lets it move only as prescribed from now on.
    pub fn hold(&mut self) {
        (self.press, self.free) = (None, None);
    }

    /// One that stands, with nothing on it.
    pub fn standing(pose: Pose) -> Self {
        let (force_n, moment_n_m) = (Vector::zeros(), Vector::zeros());
        Self { present: true, pose, force_n, moment_n_m, press: None, free: None }
    }
}

/// A contact that bears something.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SavedContact {
    /// The two that touch.
    pub between: [Party; 2],
    /// Point midway between the surfaces, in m.
    pub point_m: Vector,
    /// Unit normal pointing from the second to the first.
    pub normal: Vector,
    /// Mean force of the last step on the first (opposite on the second), in N.
    pub force_n: Vector,
    /// Share of that force with which the next step is warm-started; less than 1 after an
    /// impact. 1 in files that are older than this field.
    #[serde(default = "whole")]
    pub warm_start: f64,
    /// Which faces or edges touch, and which of their points this is, in the
    /// engine's own numbers.
    pub feature: [u32; 2],
}

/// Before contacts had a share of their own, the whole force was begun with.
fn whole() -> f64 {
    1.0
}

/// Who takes part in a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Party {
    /// A grain, by its number.
    Grain(usize),
    /// What is no grain.
    Other(Other),
}

/// What grains touch beside each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Other {
    /// The top plate.
    TopPlate,
    /// A piece of the cylinder, by its number.
    Cylinder(usize),
    /// A piece of the funnel, by its number; the lid is the last.
    Funnel(usize),
    /// A piece of a pile's base, by its number; the floor is the last.
    Base(usize),
    /// A part of a piece of a laboratory, both by their numbers.
    Piece(usize, usize),
}

/// One grain's state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GrainState {
    /// Where the grain is and how it moves; for a grain that left the
    /// apparatus, where it was last seen.
    #[serde(flatten)]
    pub body: BodyState,
    /// What became of it.
    pub fate: Fate,
}

/// What became of a grain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// It takes part in the simulation.
    Present,
    /// It went over the rim of cylinder or funnel, rolled off a pile's base or fell below all
    /// pieces of a laboratory, and was taken away.
    Spilled,
    /// It passed through a wall or the floor, or its centroid was found in a piece of a laboratory,
    /// which no grain should get into.
    ThroughWall,
    /// It was left in the funnel when the funnel was taken away.
    LeftInFunnel,
    /// It has not been fed yet.
    Waiting,
}

/// What a pile stands on: a round floor whose upper face lies at z = 0, and
/// the grains fixed to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Base {
    /// Radius in m, about the z axis.
    pub radius: f64,
    /// Coulomb friction coefficient between floor and grains; `None` where the floor
    /// is of the grains' own material.
    pub friction: Option<f64>,
    /// The grains fixed to the floor.
    pub fixed_grains: Vec<FixedGrain>,
}

/// A copy of a grain that never moves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FixedGrain {
    /// Number of the grain whose shape it has.
    pub grain: usize,
    /// Centroid position (m) and orientation of the principal axes.
    pub pose: Pose,
}

/// Where the funnel stands.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FunnelState {
    /// Height of the bottom opening above the cylinder's floor, in m.
    pub opening_height: f64,
    /// Whether the lid closes the opening.
    pub lid: bool,
}

impl Specimen {
    /// Indices of the grains that still take part.
    pub fn present(&self) -> impl Iterator<Item = usize> + '_ {
        self.state
            .bodies
            .iter()
            .enumerate()
            .filter(|(_, g)| g.fate == Fate::Present)
            .map(|(i, _)| i)
    }

    /// Shape and pose of a grain.
    pub fn placed(&self, grain: usize) -> (&ConvexPolyhedron, &Pose) {
        (self.grains.grains[grain].shape.as_ref(), &self.state.bodies[grain].body.pose)
    }

    /// Where the centroid of a grain is, in m.
    pub fn centroid(&self, grain: usize) -> Vector {
        self.state.bodies[grain].body.pose.translation.vector
    }

    /// Height in m of the highest point of a grain.
    pub fn top(&self, grain: usize) -> f64 {
        let (shape, pose) = self.placed(grain);
        shape.heights(pose).1
    }

    /// The same with the table brought back along y and z, where it is off there: what is
    /// measured about an axis that moves along x alone, above a floor at z = 0.
    pub fn on_level_table(&self) -> Cow<'_, Self> {
        match self.state.on_level_table() {
            Cow::Borrowed(_) => Cow::Borrowed(self),
            Cow::Owned(state) => Cow::Owned(Self { grains: self.grains.clone(), state }),
        }
    }
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl SpecimenState {
    /// Displacement of the shaking table in m.
    pub fn table(&self) -> Vector {
        Vector::new(self.table_x, self.table_y, self.table_z)
    }

    /// Sets the displacement of the shaking table in m; bodies stay where they are.
    pub fn set_table(&mut self, at: Vector) {
        (self.table_x, self.table_y, self.table_z) = (at.x, at.y, at.z);
    }

    /// As [`Specimen::on_level_table`].
    pub fn on_level_table(&self) -> Cow<'_, Self> {
        let off = Vector::new(0.0, self.table_y, self.table_z);
        if off == Vector::zeros() {
            return Cow::Borrowed(self);
        }
        let mut state = self.clone();
        let bodies = state.bodies.iter_mut().map(|g| &mut g.body);
        for body in bodies.chain(&mut state.top_plate) {
            body.pose.translation.vector -= off;
        }
        for contact in &mut state.contacts {
            contact.point_m -= off;
        }
        (state.table_y, state.table_z) = (0.0, 0.0);
        Cow::Owned(state)
    }

    /// Whether it can be a state of a number of grains. One that was read from a file may
    /// speak of others, or of places and directions that are none.
    ///
    /// # Errors
    /// What does not fit, for a reader.
    pub fn check(&self, grains: usize) -> Result<(), String> {
        let found = self.bodies.len();
        let are = in_number(grains, "there is", "there are");
        let there = format!("{are} {}", counted(grains, "grain"));
        if found != grains {
            return Err(format!("`bodies` has {}, and {there}", counted(found, "entry")));
        }
        let fixed = self.base.iter().flat_map(|base| &base.fixed_grains);
        for (n, fixed) in fixed.clone().enumerate() {
            if fixed.grain >= grains {
                return Err(format!("`fixed_grains[{n}].grain` is {}, and {there}", fixed.grain));
            }
        }
        let parties = self.contacts.iter().flat_map(|contact| contact.between);
        for party in parties {
            if let Party::Grain(n) = party
                && n >= grains
            {
                return Err(format!("a contact is of grain {n}, and {there}"));
            }
        }
        if let Some(base) = &self.base {
            let named = |party: &Party| matches!(party, Party::Other(Other::Base(n)) if *n > base.fixed_grains.len());
            if self.contacts.iter().flat_map(|contact| &contact.between).any(named) {
                return Err("a contact is of a piece of the base that is not there".to_owned());
            }
            if !(base.radius > 0.0 && base.radius <= FARTHEST) {
                return Err(format!("`base.radius` is {:e} m", base.radius));
            }
        }
        self.pieces.iter().filter_map(|piece| piece.press).try_for_each(|press| press.check())?;
        self.pieces.iter().filter_map(|piece| piece.free).try_for_each(|free| free.check())?;
        let moving = self.bodies.iter().map(|g| &g.body).chain(&self.top_plate);
        let moving = moving.flat_map(|b| [&b.linear_velocity, &b.angular_velocity]);
        let touching = self.contacts.iter().flat_map(|c| [&c.point_m, &c.normal, &c.force_n]);
        let vectors = moving.chain(touching).flat_map(|vector| vector.iter().copied());
        let loads = self.pieces.iter().flat_map(|p| [&p.force_n, &p.moment_n_m]);
        let vectors = vectors.chain(loads.flat_map(|vector| vector.iter().copied()));
        let table = [self.table_x, self.table_y, self.table_z];
        let others = [self.time, self.funnel.map_or(0.0, |f| f.opening_height)];
        if let Some(number) =
            vectors.chain(table).chain(others).find(|number| !(number.abs() <= LARGEST))
        {
            return Err(format!("a velocity, contact, height or time is {number:e}"));
        }
        let mut shares = self.contacts.iter().map(|contact| contact.warm_start);
        if let Some(share) = shares.find(|share| !(0.0..=LARGEST).contains(share)) {
            return Err(format!("`warm_start` of a contact is {share:e}"));
        }
        let present = self.bodies.iter().filter(|g| g.fate == Fate::Present).map(|g| &g.body.pose);
        let plate = self.top_plate.iter().map(|plate| &plate.pose);
        let pieces = self.pieces.iter().map(|piece| &piece.pose);
        let free = self.pieces.iter().filter_map(|piece| Some(&piece.free.as_ref()?.body.pose));
        let pieces = pieces.chain(free);
        let poses = present.chain(plate).chain(fixed.map(|fixed| &fixed.pose)).chain(pieces);
        for pose in poses {
            let place = pose.translation.vector;
            if !(place.norm() <= FARTHEST) {
                let [x, y, z] = place.into();
                return Err(format!("a body is at ({x:e}, {y:e}, {z:e}) m"));
            }
            let length = pose.rotation.coords.norm();
            if !((length - 1.0).abs() <= 1e-3) {
                return Err(format!("a rotation is a quaternion of length {length:e}, not 1"));
            }
        }
        Ok(())
    }

    /// Before anything has been done: grains nowhere in particular, nothing standing.
    pub fn before_everything(grains: usize) -> Self {
        let nowhere = BodyState::at_rest(Pose::identity());
        Self {
            bodies: vec![GrainState { body: nowhere, fate: Fate::Present }; grains],
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;

    #[test]
    fn a_contact_of_an_older_file_begins_whole() {
        let contact = SavedContact {
            between: [Party::Grain(0), Party::Other(Other::TopPlate)],
            point_m: Vector::zeros(),
            normal: Vector::z(),
            force_n: Vector::z(),
            warm_start: 0.25,
            feature: [1, 2],
        };
        let mut json = serde_json::to_value(contact).expect("written");
        let read = |json: &serde_json::Value| {
            serde_json::from_value::<SavedContact>(json.clone()).expect("read")
        };
        assert_eq!(read(&json), contact, "law: what is written is read");
        json.as_object_mut().expect("an object").remove("warm_start");
        assert_eq!(read(&json).warm_start, 1.0, "law: the whole force, as before the field");
    }

    #[test]
    fn a_state_of_other_grains_is_refused_with_the_field() {
        let of = |change: &dyn Fn(&mut SpecimenState)| {
            let mut state = SpecimenState::before_everything(3);
            change(&mut state);
            state.check(3)
        };
        let fixed = |grain| Base {
            radius: 0.1,
            friction: None,
            fixed_grains: vec![FixedGrain { grain, pose: Pose::identity() }],
        };
        let contact = |grain| SavedContact {
            between: [Party::Grain(grain), Party::Other(Other::TopPlate)],
            point_m: Vector::zeros(),
            normal: Vector::z(),
            force_n: Vector::z(),
            warm_start: 1.0,
            feature: [0, 0],
        };
        assert_eq!(of(&|s| s.base = Some(fixed(2))), Ok(()), "law: the last grain is one");
        assert_eq!(of(&|s| s.contacts.push(contact(2))), Ok(()), "law: the last grain is one");
        type Change<'a> = &'a dyn Fn(&mut SpecimenState);
        let cases: [(Change, &str); 14] = [
            (&|s| s.bodies.push(s.bodies[0]), "`bodies` has 4 entries, and there are 3 grains"),
            (&|s| s.base = Some(fixed(3)), "`fixed_grains[0].grain` is 3"),
            (&|s| s.base = Some(fixed(usize::MAX)), "`fixed_grains[0].grain` is 1844"),
            (&|s| s.contacts.push(contact(3)), "a contact is of grain 3"),
            (
                &|s| {
                    s.base = Some(fixed(2));
                    s.contacts.push(contact(2));
                    s.contacts[0].between[1] = Party::Other(Other::Base(2));
                },
                "a piece of the base that is not there",
            ),
            (&|s| s.base = Some(Base { radius: 0.0, ..fixed(2) }), "`base.radius` is 0e0"),
            (&|s| s.bodies[2].body.linear_velocity.x = 1e13, "is 1e13"),
            (&|s| s.time = f64::NAN, "is NaN"),
            (&|s| s.table_y = f64::NAN, "is NaN"),
            (&|s| s.table_z = 1e13, "is 1e13"),
            (
                &|s| s.contacts.push(SavedContact { warm_start: f64::NAN, ..contact(2) }),
                "`warm_start` of a contact is NaN",
            ),
            (
                &|s| s.contacts.push(SavedContact { warm_start: -0.5, ..contact(2) }),
                "`warm_start` of a contact is -5e-1",
            ),
            (&|s| s.bodies[1].body.pose.translation.vector.x = f64::NAN, "a body is at (NaN"),
            (
                &|s| {
                    let none = nalgebra::Quaternion::new(0.0, 0.0, 0.0, 0.0);
                    s.bodies[1].body.pose.rotation = nalgebra::Unit::new_unchecked(none);
                },
                "a quaternion of length 0e0",
            ),
        ];
        for (change, expected) in cases {
            let got = of(change).expect_err(expected);
            assert!(got.contains(expected), "law: expected `{expected}`, got `{got}`");
        }
    }
}
