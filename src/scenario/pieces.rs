//! Pieces of a laboratory: what a scenario builds its own apparatus of, and how they move.

use super::*;

/// Density in kg/m³ of pieces whose mass is not given where they are pressed or let go: that of
/// aluminium.
pub const PIECE_DENSITY: f64 = 2700.0;

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

/// How grains are deposited.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DepositKind {
    /// They are let go one by one, at a rate.
    #[default]
    Rain,
    /// All of them begin at once, at rest and apart, on a lattice above the area, below the first
    /// piece over it. Its layers are as high as the largest grain, and each grain falls from its
    /// own: the last from the full height of the lattice.
    Lattice,
}

parts! {
/// A rigid piece of the apparatus. Where a scenario has any, they stand in place of the
/// built-in funnel, cylinder and top plate.
pub struct PieceSpec {
    /// Name, by which stages and results speak of it: letters, digits, `-` and `_`.
    pub name: String, length 1 to 40;
    /// Its shape: one field, named by the kind.
    pub shape: ShapeSpec;
    /// Where the origin of its shape is, in mm.
    pub at_mm: [f64; 3], or default;
    /// Turns about the fixed axes x, then y, then z, in degrees.
    pub rotation_deg: [f64; 3], or default;
    /// Friction coefficient between grains, or a piece that moves freely, and this piece; left
    /// out, `contact.grain_wall_friction`.
    pub friction: Option<f64>, skip "Option::is_none", from 0.0 to 10.0;
    /// Whether it may stand in other pieces, which pieces do not feel: plates around a specimen
    /// whose planes cross. Left out, pieces that stand in each other are refused.
    pub may_cross: bool, skip "std::ops::Not::not";
}

/// The shape of a piece: exactly one of these.
#[derive(Default)]
#[serde(default)]
pub struct ShapeSpec {
    /// A container of flat walls. Origin: middle of the floor's upper side.
    pub r#box: Option<BoxSpec>, skip "Option::is_none";
    /// A round container, upright. Origin: middle of the floor's upper side.
    pub cylinder: Option<CylinderPieceSpec>, skip "Option::is_none";
    /// A solid plate or block. Origin: its middle.
    pub plate: Option<PlateSpec>, skip "Option::is_none";
    /// A solid round plate or rod, upright. Origin: its middle.
    pub disc: Option<DiscSpec>, skip "Option::is_none";
    /// A cone, or with four sides a pyramid, open above and below. Origin: middle of the
    /// opening below.
    pub hopper: Option<HopperSpec>, skip "Option::is_none";
    /// A solid ramp that rises along x. Origin: middle of its lower side.
    pub wedge: Option<WedgeSpec>, skip "Option::is_none";
    /// A closed round drum whose axis lies along y. Origin: its middle.
    pub drum: Option<DrumSpec>, skip "Option::is_none";
    /// Solid convex parts from a mesh file. Origin: that of the file.
    pub mesh: Option<MeshPieceSpec>, skip "Option::is_none";
    /// Flat blades about an upright axis, as of a vane shear test. Origin: its middle.
    pub vane: Option<VaneSpec>, skip "Option::is_none";
}

/// A container of flat walls.
pub struct BoxSpec {
    /// Inner sizes along x, y and z in mm.
    pub inner_mm: [f64; 3], schemars(inner(range(min = 0.001, max = 10000.0)));
    /// Thickness of the walls in mm; they lie outside of the inner sizes.
    pub wall_mm: f64, else "wall", from 0.001 to 10000.0;
    /// Sides that are missing, of `bottom`, `top`, `low_x`, `high_x`, `low_y` and `high_y`.
    pub open: Vec<BoxSide>, else "open_above", schemars(length(max = 6));
}

/// A round container.
pub struct CylinderPieceSpec {
    /// Inner diameter in mm; the polygon of the walls has the circle's area.
    pub inner_diameter_mm: f64, from 0.001 to 10000.0;
    /// Inner height in mm.
    pub height_mm: f64, from 0.001 to 10000.0;
    /// Thickness of walls, floor and lid in mm.
    pub wall_mm: f64, else "wall", from 0.001 to 10000.0;
    /// Number of flat wall parts.
    pub sides: u32, else "sides", from 8 to 256;
    /// Whether it has no lid.
    pub open_top: bool, else "yes";
    /// Whether it has no floor.
    pub open_bottom: bool, or default;
}

/// A solid plate or block.
pub struct PlateSpec {
    /// Sizes along x, y and z in mm.
    pub size_mm: [f64; 3], schemars(inner(range(min = 0.001, max = 10000.0)));
}

/// A solid round plate or rod.
pub struct DiscSpec {
    /// Diameter in mm; the polygon has the circle's area.
    pub diameter_mm: f64, from 0.001 to 10000.0;
    /// Thickness in mm.
    pub thickness_mm: f64, from 0.001 to 10000.0;
    /// Number of sides of the polygon.
    pub sides: u32, else "sides", from 8 to 256;
}

/// A cone or a pyramid, open above and below.
pub struct HopperSpec {
    /// Diameter of the opening in mm, of the circle of the same area.
    pub opening_diameter_mm: f64, from 0.001 to 10000.0;
    /// Diameter at the top in mm, likewise.
    pub top_diameter_mm: f64, from 0.001 to 10000.0;
    /// Angle of the wall from the vertical, in degrees.
    pub half_angle_deg: f64, from 1.0 to 89.0;
    /// Height of an upright collar on top of it in mm.
    pub collar_mm: f64, or default, from 0.0 to 10000.0;
    /// Thickness of the walls in mm, along their normal. Walls of the cone end at its lower and its
    /// upper edge: those of a flat cone are wide sheets, as thick as it is high.
    pub wall_mm: f64, else "wall", from 0.001 to 10000.0;
    /// Number of flat sides; 4 make a pyramid.
    pub sides: u32, else "sides", from 4 to 256;
}

/// A solid ramp.
pub struct WedgeSpec {
    /// Length along x, width along y and height in mm at its high end.
    pub size_mm: [f64; 3], schemars(inner(range(min = 0.001, max = 10000.0)));
}

/// A closed drum.
pub struct DrumSpec {
    /// Inner diameter in mm; the polygon of the walls has the circle's area.
    pub inner_diameter_mm: f64, from 0.001 to 10000.0;
    /// Inner length along its axis in mm.
    pub length_mm: f64, from 0.001 to 10000.0;
    /// Thickness of the walls in mm.
    pub wall_mm: f64, else "wall", from 0.001 to 10000.0;
    /// Number of flat parts of the round wall.
    pub sides: u32, else "sides", from 8 to 256;
    /// Number of bars along the inside of the wall; each is as thick as it is high.
    pub lifters: u32, or default, schemars(range(max = 64));
    /// Height of these bars in mm.
    pub lifter_mm: f64, else "wall", from 0.001 to 1000.0;
}

/// Flat blades about an upright axis.
pub struct VaneSpec {
    /// Diameter in mm of the circle on which the blades end.
    pub diameter_mm: f64, from 0.001 to 10000.0;
    /// Height of the blades in mm.
    pub height_mm: f64, from 0.001 to 10000.0;
    /// Number of blades, the first along x.
    pub blades: u32, else "four", from 2 to 16;
    /// Thickness of the blades in mm.
    pub blade_mm: f64, else "blade", from 0.001 to 1000.0;
}

/// A turn about an axis.
#[derive(Copy)]
pub struct RotationSpec {
    /// Direction of the axis; its length does not matter.
    pub axis: [f64; 3];
    /// A point of the axis in mm.
    pub about_mm: [f64; 3], or default, schemars(inner(range(min = -1e6, max = 1e6)));
    /// Speed in degrees per second, right-handed about the axis.
    pub deg_per_s: f64, schemars(range(min = -36000.0, max = 36000.0));
}

/// A sinusoidal displacement, A sin(2πft).
#[derive(Copy)]
pub struct SineSpec {
    /// Amplitude along x, y and z in mm.
    pub amplitude_mm: [f64; 3], schemars(inner(range(min = -1000.0, max = 1000.0)));
    /// Frequency in Hz.
    pub frequency_hz: f64, above 0.0 to 1000.0;
}

/// How a piece is pressed.
pub struct LoadSpec {
    /// Name of the piece.
    pub piece: String;
    /// The direction in which a force presses it, and the only one along which it moves; its length
    /// does not matter.
    pub direction: [f64; 3], else "down";
    /// Force in N, of which the weight of the piece is a part; or `stress_kpa`.
    pub force_n: Option<f64>, skip "Option::is_none", from 0.0 to 1e9;
    /// The force over the area that the piece shows along the direction, in kPa.
    pub stress_kpa: Option<f64>, skip "Option::is_none", from 0.0 to 1e6;
    /// A moment in N m that turns the piece about an axis, and about nothing else, in place of a
    /// force; its weight is part of the moment.
    pub moment_n_m: Option<f64>, skip "Option::is_none", from 0.0 to 1e6;
    /// Direction of the axis of a moment, right-handed; its length does not matter.
    pub axis: Option<[f64; 3]>, skip "Option::is_none";
    /// A point of that axis in mm; left out, the origin of the laboratory.
    pub about_mm: Option<[f64; 3]>, skip "Option::is_none",
        schemars(inner(range(min = -1e6, max = 1e6)));
    /// Mass in g that the force accelerates; left out, that of the piece in aluminium,
    /// 2700 kg/m³.
    pub mass_g: Option<f64>, skip "Option::is_none", above 0.0 to 1e9;
    /// In place of a load: the piece stays where it is from now on.
    pub locked: bool, skip "std::ops::Not::not";
}

/// Which pieces keep the mean stress in which region.
pub struct KeepMeanStressSpec {
    /// Name of a region of `measures.regions`. The mean stress of its contacts, a third of the
    /// trace, is to stay what it was when the stage began.
    pub region: String, length 1 to 40;
    /// Names of pieces that forces press: all these forces are multiplied by the same factor.
    pub pieces: Vec<String>, length 1 to 100;
    /// Time in s over which the mean stress is smoothed, and within which the factor follows it.
    pub window_s: f64, else "stress_window", above 0.0 to 60.0;
}

/// What is measured of a laboratory beside the forces on its pieces.
#[derive(Default)]
#[serde(default)]
pub struct MeasuresSpec {
    /// Boxes in which void ratio, stress and fabric are measured.
    pub regions: Vec<RegionSpec>, schemars(length(max = 20));
    /// Openings through which mass flow is measured.
    pub openings: Vec<OpeningSpec>, schemars(length(max = 20));
    /// Pieces whose forces are also reported together.
    pub groups: Vec<GroupSpec>, skip "Vec::is_empty", schemars(length(max = 20));
}

/// Pieces that are taken together.
pub struct GroupSpec {
    /// Name in the results.
    pub name: String, length 1 to 40;
    /// Names of its pieces.
    pub pieces: Vec<String>, length 1 to 1000;
}

/// A box along the axes. Choose it within the grains, away from walls.
pub struct RegionSpec {
    /// Name in the results.
    pub name: String, length 1 to 40;
    /// Its lowest corner in mm.
    pub low_mm: [f64; 3], schemars(inner(range(min = -1e6, max = 1e6)));
    /// Its highest corner in mm.
    pub high_mm: [f64; 3], schemars(inner(range(min = -1e6, max = 1e6)));
}

/// A disc that grains pass through.
pub struct OpeningSpec {
    /// Name in the results.
    pub name: String, length 1 to 40;
    /// Its middle in mm.
    pub at_mm: [f64; 3], schemars(inner(range(min = -1e6, max = 1e6)));
    /// Its diameter in mm: no less than that of the opening, so that nothing passes beside it.
    pub diameter_mm: f64, above 0.0 to 10000.0;
    /// The direction in which flow counts as positive.
    pub direction: [f64; 3], else "down";
}
}

impl MeasuresSpec {
    /// Whether nothing is asked for.
    pub fn is_empty(&self) -> bool {
        self.regions.is_empty() && self.openings.is_empty() && self.groups.is_empty()
    }
}

defaults! {
    pub(super) stress_window: f64 = 0.1;
    wall: f64 = 10.0;
    four: u32 = 4;
    blade: f64 = 2.0;
    sides: u32 = 32;
    yes: bool = true;
    open_above: Vec<BoxSide> = vec![BoxSide::Top];
    down: [f64; 3] = [0.0, 0.0, -1.0];
}
