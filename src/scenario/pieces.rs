//! Pieces of a laboratory: what a scenario builds its own apparatus of, and how they move.

use super::*;

/// A rigid piece of the apparatus. Where a scenario has any, they stand in place of the
/// built-in funnel, cylinder and top plate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PieceSpec {
    /// Name, by which stages and results speak of it: letters, digits, `-` and `_`.
    #[schemars(length(min = 1, max = 40))]
    pub name: String,
    /// Its shape: one field, named by the kind.
    pub shape: ShapeSpec,
    /// Where the origin of its shape is, in mm.
    #[serde(default)]
    pub at_mm: [f64; 3],
    /// Turns about the fixed axes x, then y, then z, in degrees.
    #[serde(default)]
    pub rotation_deg: [f64; 3],
    /// Friction coefficient between grains, or a piece that moves freely, and this piece; left
    /// out, `contact.grain_wall_friction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub friction: Option<f64>,
    /// Whether it may stand in other pieces, which pieces do not feel: plates around a specimen
    /// whose planes cross. Left out, pieces that stand in each other are refused.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub may_cross: bool,
}

/// The shape of a piece: exactly one of these.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ShapeSpec {
    /// A container of flat walls. Origin: middle of the floor's upper side.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub r#box: Option<BoxSpec>,
    /// A round container, upright. Origin: middle of the floor's upper side.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cylinder: Option<CylinderPieceSpec>,
    /// A solid plate or block. Origin: its middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plate: Option<PlateSpec>,
    /// A solid round plate or rod, upright. Origin: its middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disc: Option<DiscSpec>,
    /// A cone, or with four sides a pyramid, open above and below. Origin: middle of the
    /// opening below.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hopper: Option<HopperSpec>,
    /// A solid ramp that rises along x. Origin: middle of its lower side.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wedge: Option<WedgeSpec>,
    /// A closed round drum whose axis lies along y. Origin: its middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drum: Option<DrumSpec>,
    /// Solid convex parts from a mesh file. Origin: that of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshPieceSpec>,
    /// Flat blades about an upright axis, as of a vane shear test. Origin: its middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vane: Option<VaneSpec>,
}

/// A side of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BoxSide {
    /// The floor.
    Bottom,
    /// The lid.
    Top,
    /// The wall at low x.
    LowX,
    /// The wall at high x.
    HighX,
    /// The wall at low y.
    LowY,
    /// The wall at high y.
    HighY,
}

/// A container of flat walls.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// Inner sizes along x, y and z in mm.
    #[schemars(inner(range(min = 0.001, max = 10000.0)))]
    pub inner_mm: [f64; 3],
    /// Thickness of the walls in mm; they lie outside of the inner sizes.
    #[serde(default = "wall")]
    #[schemars(range(min = 0.001, max = 10000.0))]
    pub wall_mm: f64,
    /// Sides that are missing.
    #[serde(default = "open_above")]
    #[schemars(length(max = 6))]
    pub open: Vec<BoxSide>,
}

/// A round container.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderPieceSpec {
    /// Inner diameter in mm; the polygon of the walls has the circle's area.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub inner_diameter_mm: f64,
    /// Inner height in mm.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub height_mm: f64,
    /// Thickness of walls, floor and lid in mm.
    #[serde(default = "wall")]
    #[schemars(range(min = 0.001, max = 10000.0))]
    pub wall_mm: f64,
    /// Number of flat wall parts.
    #[serde(default = "sides")]
    #[schemars(range(min = 8, max = 256))]
    pub sides: u32,
    /// Whether it has no lid.
    #[serde(default = "yes")]
    pub open_top: bool,
    /// Whether it has no floor.
    #[serde(default)]
    pub open_bottom: bool,
}

/// A solid plate or block.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlateSpec {
    /// Sizes along x, y and z in mm.
    #[schemars(inner(range(min = 0.001, max = 10000.0)))]
    pub size_mm: [f64; 3],
}

/// A solid round plate or rod.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscSpec {
    /// Diameter in mm; the polygon has the circle's area.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub diameter_mm: f64,
    /// Thickness in mm.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub thickness_mm: f64,
    /// Number of sides of the polygon.
    #[serde(default = "sides")]
    #[schemars(range(min = 8, max = 256))]
    pub sides: u32,
}

/// A cone or a pyramid, open above and below.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HopperSpec {
    /// Diameter of the opening in mm, of the circle of the same area.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub opening_diameter_mm: f64,
    /// Diameter at the top in mm, likewise.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub top_diameter_mm: f64,
    /// Angle of the wall from the vertical, in degrees.
    #[schemars(range(min = 1.0, max = 89.0))]
    pub half_angle_deg: f64,
    /// Height of an upright collar on top of it in mm.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10000.0))]
    pub collar_mm: f64,
    /// Thickness of the walls in mm.
    #[serde(default = "wall")]
    #[schemars(range(min = 0.001, max = 10000.0))]
    pub wall_mm: f64,
    /// Number of flat sides; 4 make a pyramid.
    #[serde(default = "sides")]
    #[schemars(range(min = 4, max = 256))]
    pub sides: u32,
}

/// A solid ramp.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WedgeSpec {
    /// Length along x, width along y and height in mm at its high end.
    #[schemars(inner(range(min = 0.001, max = 10000.0)))]
    pub size_mm: [f64; 3],
}

/// A closed drum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DrumSpec {
    /// Inner diameter in mm; the polygon of the walls has the circle's area.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub inner_diameter_mm: f64,
    /// Inner length along its axis in mm.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub length_mm: f64,
    /// Thickness of the walls in mm.
    #[serde(default = "wall")]
    #[schemars(range(min = 0.001, max = 10000.0))]
    pub wall_mm: f64,
    /// Number of flat parts of the round wall.
    #[serde(default = "sides")]
    #[schemars(range(min = 8, max = 256))]
    pub sides: u32,
    /// Number of bars along the inside of the wall; each is as thick as it is high.
    #[serde(default)]
    #[schemars(range(max = 64))]
    pub lifters: u32,
    /// Height of these bars in mm.
    #[serde(default = "wall")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1000.0))]
    pub lifter_mm: f64,
}

/// Flat blades about an upright axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VaneSpec {
    /// Diameter in mm of the circle on which the blades end.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub diameter_mm: f64,
    /// Height of the blades in mm.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub height_mm: f64,
    /// Number of blades, the first along x.
    #[serde(default = "four")]
    #[schemars(range(min = 2, max = 16))]
    pub blades: u32,
    /// Thickness of the blades in mm.
    #[serde(default = "blade")]
    #[schemars(range(min = 0.001, max = 1000.0))]
    pub blade_mm: f64,
}

/// A turn about an axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotationSpec {
    /// Direction of the axis; its length does not matter.
    pub axis: [f64; 3],
    /// A point of the axis in mm.
    #[serde(default)]
    pub about_mm: [f64; 3],
    /// Speed in degrees per second, right-handed about the axis.
    #[schemars(range(min = -36000.0, max = 36000.0))]
    pub deg_per_s: f64,
}

/// A sinusoidal displacement, A sin(2πft).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SineSpec {
    /// Amplitude along x, y and z in mm.
    #[schemars(inner(range(min = -1000.0, max = 1000.0)))]
    pub amplitude_mm: [f64; 3],
    /// Frequency in Hz.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1000.0))]
    pub frequency_hz: f64,
}

/// How a piece is pressed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadSpec {
    /// Name of the piece.
    pub piece: String,
    /// The direction in which a force presses it, and the only one along which it moves; its length
    /// does not matter.
    #[serde(default = "down")]
    pub direction: [f64; 3],
    /// Force in N, of which the weight of the piece is a part; or `stress_kpa`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e9))]
    pub force_n: Option<f64>,
    /// The force over the area that the piece shows along the direction, in kPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub stress_kpa: Option<f64>,
    /// A moment in N m that turns the piece about an axis, and about nothing else, in place of a
    /// force; its weight is part of the moment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub moment_n_m: Option<f64>,
    /// Direction of the axis of a moment, right-handed; its length does not matter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<[f64; 3]>,
    /// A point of that axis in mm; left out, the origin of the laboratory.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about_mm: Option<[f64; 3]>,
    /// Mass in g that the force accelerates; left out, that of the piece in aluminium,
    /// 2700 kg/m³.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
    pub mass_g: Option<f64>,
    /// In place of a load: the piece stays where it is from now on.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub locked: bool,
}

/// How grains are deposited.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DepositKind {
    /// They are let go one by one, at a rate.
    #[default]
    Rain,
    /// All of them begin at once, at rest and apart, on a lattice above the area, below the first
    /// piece over it.
    Lattice,
}

/// What is measured of a laboratory beside the forces on its pieces.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MeasuresSpec {
    /// Boxes in which void ratio, stress and fabric are measured.
    #[schemars(length(max = 20))]
    pub regions: Vec<RegionSpec>,
    /// Openings through which mass flow is measured.
    #[schemars(length(max = 20))]
    pub openings: Vec<OpeningSpec>,
    /// Pieces whose forces are also reported together.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 20))]
    pub groups: Vec<GroupSpec>,
}

impl MeasuresSpec {
    /// Whether nothing is asked for.
    pub fn is_empty(&self) -> bool {
        self.regions.is_empty() && self.openings.is_empty() && self.groups.is_empty()
    }
}

/// Pieces that are taken together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GroupSpec {
    /// Name in the results.
    #[schemars(length(min = 1, max = 40))]
    pub name: String,
    /// Names of its pieces.
    #[schemars(length(min = 1, max = 1000))]
    pub pieces: Vec<String>,
}

/// A box along the axes. Choose it within the grains, away from walls.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionSpec {
    /// Name in the results.
    #[schemars(length(min = 1, max = 40))]
    pub name: String,
    /// Its lowest corner in mm.
    pub low_mm: [f64; 3],
    /// Its highest corner in mm.
    pub high_mm: [f64; 3],
}

/// A disc that grains pass through.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OpeningSpec {
    /// Name in the results.
    #[schemars(length(min = 1, max = 40))]
    pub name: String,
    /// Its middle in mm.
    pub at_mm: [f64; 3],
    /// Its diameter in mm: no less than that of the opening, so that nothing passes beside it.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 10000.0))]
    pub diameter_mm: f64,
    /// The direction in which flow counts as positive.
    #[serde(default = "down")]
    pub direction: [f64; 3],
}

defaults! {
    wall: f64 = 10.0;
    four: u32 = 4;
    blade: f64 = 2.0;
    sides: u32 = 32;
    yes: bool = true;
    open_above: Vec<BoxSide> = vec![BoxSide::Top];
    down: [f64; 3] = [0.0, 0.0, -1.0];
}
