//! The exchange format: one JSON file that holds all that another engine needs
//! to carry on from a specimen. `docs/exchange.md` describes it.

use super::*;
use crate::motion::{Start, Waveform};
use crate::protocol;
use crate::world::PairTable;

/// What `format` says in every such file.
pub const FORMAT: &str = "pluvia-exchange";

/// Raised whenever a reader of the format before would misread the file.
pub const VERSION: u32 = 1;

/// The version of a file whose table moves by samples: readers of [`VERSION`] would take it for
/// one that stands still.
pub const VERSION_OF_SAMPLES: u32 = 2;

/// A specimen with everything around it. SI units; z is up; the cylinder's
/// floor lies at z = 0 and its axis at x = y = 0 when the table is in its middle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`], or [`VERSION_OF_SAMPLES`].
    pub version: u32,
    /// Where the scene comes from.
    pub made_by: MadeBy,
    /// Gravitational acceleration.
    pub gravity_m_per_s2: Vector,
    /// Friction and restitution of each pair of materials, once a pair.
    pub pairs: Vec<PairValue>,
    /// Damping of every free body.
    pub damping: Damping,
    /// The shaking table.
    pub table: Table,
    /// The grains that take part.
    pub grains: Vec<ExchangeGrain>,
    /// Walls, floor, funnel, lid: convex pieces without mass.
    pub apparatus: Vec<ApparatusPiece>,
    /// The top plate, once it was laid on the grains.
    pub top_plate: Option<PlateBody>,
    /// The loaded contacts; none where the engine gave none.
    pub contacts: Vec<ExchangeContact>,
}

/// Where a scene comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MadeBy {
    /// Program and version.
    pub program: String,
    /// Name of the scenario.
    pub scenario: String,
    /// Stage at whose end the specimen was taken.
    pub stage: String,
    /// Simulated time since the first stage began.
    pub time_s: f64,
}

/// What a contact between two materials gets, with no rule of combination.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairValue {
    /// The two materials.
    pub between: [Material; 2],
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

/// Share of a velocity lost in a second.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Damping {
    /// Of the linear velocity.
    pub linear_per_s: f64,
    /// Of the angular velocity.
    pub angular_per_s: f64,
}

/// Where the shaking table is and what it does next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Displacement along x from its middle.
    pub x_m: f64,
    /// What it does from this state on, where that is a sine from the middle; else none.
    pub motion: Option<TableLaw>,
    /// What it does where that is no sine from the middle: left out where it is, or where the
    /// table stands still.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub samples: Option<TableSamples>,
}

/// Displacement of the table at the end of each step of the engine it is for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TableSamples {
    /// Length of a step; the first sample is at its end.
    pub step_s: f64,
    /// Displacement along x, y and z.
    pub displacement_m: Vec<[f64; 3]>,
}

/// x(t) = A sin(2πft) along x in each period, x = 0 between periods; t begins with the scene. With
/// a ramp r, A grows in each period as (1 - cos πt/r)/2 and dies away so at its end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TableLaw {
    /// A, half the stroke.
    pub amplitude_m: f64,
    /// f.
    pub frequency_hz: f64,
    /// Length of one period of vibration.
    pub duration_s: f64,
    /// Number of periods.
    pub periods: u32,
    /// Rest between periods.
    pub rest_s: f64,
    /// r; left out where it is 0.
    #[serde(default, skip_serializing_if = "is_none")]
    pub ramp_s: f64,
}

fn is_none(ramp_s: &f64) -> bool {
    *ramp_s == 0.0
}

impl TableLaw {
    /// Of a motion that is a sine from the middle, moved all the time along x alone.
    fn of(m: &TableMotion) -> Option<Self> {
        let plain = m.waveform == Waveform::Sine(Start::Middle)
            && m.vertical.is_none()
            && m.frames_per_s.is_none();
        plain.then_some(Self {
            amplitude_m: m.amplitude,
            frequency_hz: m.frequency,
            duration_s: m.duration,
            periods: m.periods,
            rest_s: m.rest,
            ramp_s: m.ramp,
        })
    }
}

impl TableSamples {
    /// Of a motion in steps of a length in s.
    fn of(motion: &TableMotion, step_s: f64) -> Self {
        let steps = (motion.total() / step_s).round().max(1.0) as u64;
        let place = |n: u64| motion.displacement(n as f64 * step_s).into();
        Self { step_s, displacement_m: (1..=steps).map(place).collect() }
    }
}

impl From<TableLaw> for TableMotion {
    fn from(law: TableLaw) -> Self {
        Self {
            periods: law.periods,
            rest: law.rest_s,
            ramp: law.ramp_s,
            ..Self::sine(law.amplitude_m, law.frequency_hz, law.duration_s)
        }
    }
}

/// A grain: its frame has the centroid as origin and the principal axes of
/// inertia as axes, so that `position_m` is that of the centre of mass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExchangeGrain {
    /// `grain_00012` and so on, as in `grains.csv`; grains that left the apparatus are missing.
    /// Empty where another program left it out.
    #[serde(default)]
    pub name: String,
    /// The number in that name: the place in the grain set.
    pub grain: usize,
    /// `vertices_m` in the grain's frame, and `faces`: loops of vertex numbers
    /// from 0, counter-clockwise seen from outside.
    #[serde(flatten)]
    pub shape: ConvexPolyhedron,
    /// Volume.
    pub volume_m3: f64,
    /// Mass.
    pub mass_kg: f64,
    /// Principal moments of inertia about the frame's x, y, z.
    pub inertia_kg_m2: Vector,
    /// Pose and velocity.
    #[serde(flatten)]
    pub at: Place,
}

/// Pose and velocity of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Origin of the body's frame in the world.
    pub position_m: Vector,
    /// Unit quaternion that turns the body's frame into the world's; scalar last.
    pub quaternion_xyzw: [f64; 4],
    /// Velocity of that origin.
    pub linear_velocity_m_per_s: Vector,
    /// Angular velocity in world axes, right-handed.
    pub angular_velocity_rad_per_s: Vector,
}

impl From<&BodyState> for Place {
    fn from(state: &BodyState) -> Self {
        Self {
            position_m: state.pose.translation.vector,
            quaternion_xyzw: state.pose.rotation.coords.into(),
            linear_velocity_m_per_s: state.linear_velocity,
            angular_velocity_rad_per_s: state.angular_velocity,
        }
    }
}

impl From<&Place> for BodyState {
    fn from(place: &Place) -> Self {
        Self {
            pose: pose(&place.position_m, place.quaternion_xyzw),
            linear_velocity: place.linear_velocity_m_per_s,
            angular_velocity: place.angular_velocity_rad_per_s,
        }
    }
}

/// A convex piece of the apparatus, without mass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ApparatusPiece {
    /// `cylinder_00` and so on, `floor`, `funnel_00` and so on, `lid`;
    /// `base_0000` and so on, the last of them the floor under a pile; of a piece of a
    /// laboratory its own with the number of the part.
    pub name: String,
    /// What carries it: it is fixed, goes with the table, or is moved by a stage of a laboratory.
    pub motion: Carrier,
    /// What it is made of.
    pub material: Material,
    /// `vertices_m` and `faces` as those of grains.
    #[serde(flatten)]
    pub shape: ConvexPolyhedron,
    /// Origin of its frame in the world, with the table where it is now.
    pub position_m: Vector,
    /// Its orientation; scalar last.
    pub quaternion_xyzw: [f64; 4],
}

impl ApparatusPiece {
    /// Where it stands, with the table where the scene has it.
    pub fn pose(&self) -> Pose {
        pose(&self.position_m, self.quaternion_xyzw)
    }
}

/// The top plate, a free body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlateBody {
    /// `vertices_m` and `faces` as those of grains.
    #[serde(flatten)]
    pub shape: ConvexPolyhedron,
    /// Mass.
    pub mass_kg: f64,
    /// Principal moments of inertia about its x, y, z.
    pub inertia_kg_m2: Vector,
    /// Pose and velocity.
    #[serde(flatten)]
    pub at: Place,
}

/// A contact that bears something.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExchangeContact {
    /// Names of the two: `grain_00012`, `top_plate`, or that of a piece.
    pub between: [String; 2],
    /// Point midway between the surfaces.
    pub point_m: Vector,
    /// Unit normal from the second to the first.
    pub normal: Vector,
    /// Force on the first; the opposite acts on the second.
    pub force_n: Vector,
}

/// A file that is no scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{field}` is {found}, expected {expected}")]
pub struct SceneError {
    /// The field.
    pub field: &'static str,
    /// What it holds.
    pub found: String,
    /// What it must hold.
    pub expected: String,
}

impl Scene {
    /// The scene of a specimen in its laboratory; `motion` is what the table does next.
    ///
    /// # Errors
    /// When the apparatus cannot be built.
    pub fn of(
        setup: &Setup,
        specimen: &Specimen,
        motion: Option<&TableMotion>,
        made_by: MadeBy,
    ) -> Result<Self, ApparatusError> {
        let state = &specimen.state;
        let standing = standing(setup, &specimen.grains, state)?.into_iter();
        let apparatus = standing.map(|s| ApparatusPiece {
            name: s.name,
            motion: s.carrier,
            material: s.material,
            shape: (*s.piece.shape).clone(),
            position_m: s.piece.pose.translation.vector,
            quaternion_xyzw: s.piece.pose.rotation.coords.into(),
        });
        let grains = specimen.present().map(|n| {
            let grain = &specimen.grains.grains[n];
            ExchangeGrain {
                name: grain_name(n),
                grain: n,
                shape: (*grain.shape).clone(),
                volume_m3: grain.volume,
                mass_kg: grain.mass,
                inertia_kg_m2: grain.inertia,
                at: (&state.bodies[n].body).into(),
            }
        });
        let top_plate = state.top_plate.as_ref().map(|body| PlateBody {
            shape: (*setup.plate.shape).clone(),
            mass_kg: setup.plate.mass,
            inertia_kg_m2: setup.plate.inertia,
            at: body.into(),
        });
        let contacts = state.contacts.iter().map(|c| ExchangeContact {
            between: c.between.map(|party| party_name(setup, party)),
            point_m: c.point_m,
            normal: c.normal,
            force_n: c.force_n,
        });
        let law = motion.and_then(TableLaw::of);
        let other = motion.filter(|_| law.is_none());
        let samples = other.map(|m| TableSamples::of(m, 1.0 / setup.engine.rate_hz));
        Ok(Self {
            format: FORMAT.to_owned(),
            version: if samples.is_some() { VERSION_OF_SAMPLES } else { VERSION },
            made_by,
            gravity_m_per_s2: Vector::new(0.0, 0.0, -setup.gravity),
            pairs: pairs(&protocol::pairs(setup, state)),
            damping: Damping {
                linear_per_s: setup.engine.linear_damping,
                angular_per_s: setup.engine.angular_damping,
            },
            table: Table { x_m: state.table_x, motion: law, samples },
            grains: grains.collect(),
            apparatus: apparatus.collect(),
            top_plate,
            contacts: contacts.collect(),
        })
    }

    /// Whether a reader of this version may use what it has read.
    ///
    /// # Errors
    /// The field that says otherwise.
    pub fn check(&self) -> Result<(), SceneError> {
        if self.format != FORMAT {
            let (found, expected) = (format!("`{}`", self.format), format!("`{FORMAT}`"));
            return Err(SceneError { field: "format", found, expected });
        }
        let known = if self.table.samples.is_some() { VERSION_OF_SAMPLES } else { VERSION };
        if self.version != known {
            let (found, expected) = (self.version.to_string(), known.to_string());
            return Err(SceneError { field: "version", found, expected });
        }
        Ok(())
    }
}

fn pose(position: &Vector, xyzw: [f64; 4]) -> Pose {
    let quaternion = nalgebra::Quaternion::from(nalgebra::Vector4::from(xyzw));
    let rotation = nalgebra::UnitQuaternion::new_unchecked(quaternion);
    Pose::from_parts((*position).into(), rotation)
}

fn pairs(table: &PairTable) -> Vec<PairValue> {
    use Material::{Grain, Plate, Wall};
    let all = [[Grain, Grain], [Grain, Wall], [Grain, Plate], [Plate, Wall]];
    let pieces = table.materials().into_iter().skip(3).map(|piece| [Grain, piece]);
    all.into_iter()
        .chain(pieces)
        .map(|between| {
            let value = table.get(between[0], between[1]);
            PairValue { between, friction: value.friction, restitution: value.restitution }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::testing;
    use crate::specimen::Base;

    /// Law: pairs are those of the run: on a plane base grains and walls have the friction of its
    /// floor, elsewhere that of walls.
    #[test]
    fn pairs_have_the_friction_of_a_plane_base() {
        let moments = testing::moments(&[3], 0.08);
        let friction = |base: Option<Base>| {
            let state = SpecimenState { base, ..moments.stages[0].end.clone() };
            let specimen = Specimen { grains: moments.grains.clone(), state };
            let [program, scenario, stage] = [(); 3].map(|()| String::new());
            let made_by = MadeBy { program, scenario, stage, time_s: 0.0 };
            let scene = Scene::of(&moments.setup, &specimen, None, made_by).expect("a scene");
            let of_walls = |p: &&PairValue| p.between == [Material::Grain, Material::Wall];
            scene.pairs.iter().find(of_walls).expect("a pair").friction
        };
        let of_walls = moments.setup.pairs.get(Material::Grain, Material::Wall).friction;
        let base = |friction| Some(Base { radius: 0.1, friction, fixed_grains: Vec::new() });
        for (base, expected) in [
            (None, of_walls),
            (base(None), of_walls),
            (base(Some(of_walls + 0.25)), of_walls + 0.25),
        ] {
            let law = format!("law: a friction of {expected} with {base:?}");
            assert_eq!(friction(base), expected, "{law}");
        }
    }
}
