//! Pieces of a laboratory as solid convex parts in a frame of their own.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix3, Translation3, UnitQuaternion};

use super::walls::{cone, half_width, piece, polygon, unbuilt, vessel};
use super::{ApparatusError, Piece};
use crate::geometry::{ConvexPolyhedron, MassProperties, Point, PolyhedronError, Pose, Vector};
use crate::scenario::{
    BoxSide, BoxSpec, CylinderPieceSpec, DiscSpec, DrumSpec, HopperSpec, MeshPart, PieceSpec,
    ShapeSpec, VaneSpec, WedgeSpec,
};
use crate::units::{from_deg, from_mm};

type Parts = Result<Vec<Piece>, PolyhedronError>;

/// A rigid piece.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidPiece {
    /// Its name in the scenario.
    pub name: String,
    /// Its convex parts, placed in its own frame.
    pub parts: Vec<Piece>,
    /// Where its frame is at the beginning.
    pub at: Pose,
    /// Largest distance in m of a corner from the origin of its frame.
    pub radius: f64,
    /// Whether it may stand in other pieces.
    pub may_cross: bool,
    /// Whether it may hide the grains: containers and plates do; a vane, a rod, a ramp, a mesh of one
    /// solid part and, in a scenario, what a stage releases stand among them.
    pub is_wall: bool,
}

impl RigidPiece {
    /// Builds a piece.
    ///
    /// # Errors
    /// When it has no shape, or one that its dimensions make impossible.
    pub fn new(spec: &PieceSpec) -> Result<Self, ApparatusError> {
        let parts = parts_of(&spec.shape).map_err(unbuilt("piece of the laboratory"))?;
        let [x, y, z] = spec.rotation_deg.map(from_deg);
        let turn = UnitQuaternion::from_euler_angles(x, y, z);
        let at = Pose::from_parts(Translation3::from(spec.at_mm.map(from_mm)), turn);
        let corners = parts.iter().flat_map(|p| p.shape.vertices().iter().map(|v| p.pose * v));
        let radius = corners.map(|corner| corner.coords.norm()).fold(0.0, f64::max);
        let is_wall = match &spec.shape {
            ShapeSpec { vane: Some(_), .. } | ShapeSpec { wedge: Some(_), .. } => false,
            ShapeSpec { disc: Some(disc), .. } => disc.thickness_mm < disc.diameter_mm,
            ShapeSpec { mesh: Some(_), .. } => parts.len() > 1,
            _ => true,
        };
        Ok(Self { name: spec.name.clone(), parts, at, radius, may_cross: spec.may_cross, is_wall })
    }

    /// Volume in m³ of its parts.
    pub fn volume(&self) -> f64 {
        self.parts.iter().map(|part| part.shape.signed_volume()).sum()
    }

    /// Where its centre of mass and its principal axes are in its own frame, with the principal
    /// moments of inertia in m² per mass, of a piece of one density. Parts that overlap count
    /// twice.
    pub fn principal_frame(&self) -> (Pose, Vector) {
        let parts: Vec<(f64, Point, Matrix3<f64>)> = self
            .parts
            .iter()
            .map(|part| {
                let own = MassProperties::of(&part.shape);
                let turn = part.pose.rotation.to_rotation_matrix();
                let inertia = turn * own.inertia_per_density * turn.inverse();
                (own.volume, part.pose * own.centroid, inertia)
            })
            .collect();
        let volume: f64 = parts.iter().map(|(volume, ..)| volume).sum();
        let first: Vector = parts.iter().map(|(volume, at, _)| at.coords * *volume).sum();
        let centroid = Point::from(first / volume);
        let about = parts.iter().map(|(volume, at, inertia)| {
            let d = at - centroid;
            let steiner = Matrix3::identity() * d.norm_squared() - d * d.transpose();
            inertia + steiner * *volume
        });
        let whole = about.sum::<Matrix3<f64>>();
        let whole = MassProperties { volume, centroid, inertia_per_density: whole };
        let frame = whole.principal_frame();
        (frame.pose, frame.moments_per_density / volume)
    }

    /// Moment of inertia in kg m² about an axis in its own frame, by a unit vector and a point in m,
    /// of a piece of one density and a mass in kg.
    pub fn inertia_about(&self, axis: &Vector, about: &Point, mass: f64) -> f64 {
        let per_density = self.parts.iter().map(|part| {
            let turned = part.pose.rotation.inverse() * axis;
            let own = MassProperties::of(&part.shape);
            let away = (part.pose * own.centroid - about).cross(axis).norm_squared();
            turned.dot(&(own.inertia_per_density * turned)) + own.volume * away
        });
        per_density.sum::<f64>() * mass / self.volume()
    }

    /// Distance in m from an axis in its own frame that no corner exceeds.
    pub fn reach_from(&self, axis: &Vector, about: &Point) -> f64 {
        let corners = self.parts.iter().flat_map(|p| p.shape.vertices().iter().map(|v| p.pose * v));
        corners.map(|corner| (corner - about).cross(axis).norm()).fold(0.0, f64::max)
    }

    /// Area in m² of the shadow that a piece of one convex part throws along a unit vector in its
    /// own frame; of several parts, the sum of theirs. Half of what its faces have together
    /// (Cauchy).
    pub fn area_along(&self, direction: &Vector) -> f64 {
        let shadow = |part: &Piece| {
            let along = part.pose.rotation.inverse() * direction;
            let areas = part.shape.triangles().map(|[a, b, c]| (b - a).cross(&(c - a)) / 2.0);
            areas.map(|area| area.dot(&along).abs()).sum::<f64>() / 2.0
        };
        self.parts.iter().map(shadow).sum()
    }

    /// Name of one of its parts in files.
    pub fn part_name(&self, part: usize) -> String {
        format!("{}_{part:02}", self.name)
    }
}

fn parts_of(shape: &ShapeSpec) -> Parts {
    match shape {
        ShapeSpec { r#box: Some(spec), .. } => walls_of_box(spec),
        ShapeSpec { cylinder: Some(spec), .. } => cylinder(spec),
        ShapeSpec { plate: Some(spec), .. } => {
            let cuboid = ConvexPolyhedron::cuboid(Vector::from(spec.size_mm.map(from_mm)))?;
            Ok(vec![piece(cuboid)])
        }
        ShapeSpec { disc: Some(spec), .. } => disc(spec),
        ShapeSpec { hopper: Some(spec), .. } => hopper(spec),
        ShapeSpec { wedge: Some(spec), .. } => wedge(spec),
        ShapeSpec { mesh: Some(spec), .. } => spec.parts().iter().map(of_mesh).collect(),
        ShapeSpec { vane: Some(spec), .. } => vane(spec),
        ShapeSpec { drum: Some(spec), .. } => drum(spec),
        _ => Err(PolyhedronError::TooSmall { vertices: 0, faces: 0 }),
    }
}

fn of_mesh(part: &MeshPart) -> Result<Piece, PolyhedronError> {
    let corners = part.vertices_mm.iter().map(|v| Point::from(v.map(from_mm))).collect();
    ConvexPolyhedron::new(corners, part.faces.clone()).map(piece)
}

fn block(low: [f64; 3], high: [f64; 3]) -> Result<Piece, PolyhedronError> {
    let outline = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])];
    ConvexPolyhedron::prism(&outline, low[2], high[2]).map(piece)
}

/// The same block a number of times, evenly turned about the z axis.
fn around(count: u32, low: [f64; 3], high: [f64; 3]) -> Parts {
    let turned = |k: u32| {
        let block = block(low, high)?;
        let angle = 2.0 * PI * f64::from(k) / f64::from(count);
        let turn = UnitQuaternion::from_axis_angle(&Vector::z_axis(), angle);
        let pose = Pose::from_parts(Translation3::identity(), turn) * block.pose;
        Ok(Piece { pose, ..block })
    };
    (0..count).map(turned).collect()
}

fn walls_of_box(spec: &BoxSpec) -> Parts {
    let [x, y, h] = spec.inner_mm.map(from_mm);
    let (x, y, t) = (x / 2.0, y / 2.0, from_mm(spec.wall_mm));
    let all = [
        (BoxSide::Bottom, [-x - t, -y - t, -t], [x + t, y + t, 0.0]),
        (BoxSide::LowX, [-x - t, -y - t, 0.0], [-x, y + t, h]),
        (BoxSide::HighX, [x, -y - t, 0.0], [x + t, y + t, h]),
        (BoxSide::LowY, [-x, -y - t, 0.0], [x, -y, h]),
        (BoxSide::HighY, [-x, y, 0.0], [x, y + t, h]),
        (BoxSide::Top, [-x - t, -y - t, h], [x + t, y + t, h + t]),
    ];
    let closed = all.iter().filter(|(side, ..)| !spec.open.contains(side));
    closed.map(|(_, low, high)| block(*low, *high)).collect()
}

fn cylinder(spec: &CylinderPieceSpec) -> Parts {
    let (radius, height) = (from_mm(spec.inner_diameter_mm) / 2.0, from_mm(spec.height_mm));
    let closed = [!spec.open_bottom, !spec.open_top];
    vessel(spec.sides, radius, (0.0, height), from_mm(spec.wall_mm), closed)
}

fn disc(spec: &DiscSpec) -> Parts {
    let outline = polygon(from_mm(spec.diameter_mm) / 2.0, spec.sides);
    let half = from_mm(spec.thickness_mm) / 2.0;
    Ok(vec![piece(ConvexPolyhedron::prism(&outline, -half, half)?)])
}

fn hopper(spec: &HopperSpec) -> Parts {
    let opening = from_mm(spec.opening_diameter_mm) / 2.0;
    let top = from_mm(spec.top_diameter_mm) / 2.0;
    let (angle, t) = (from_deg(spec.half_angle_deg), from_mm(spec.wall_mm));
    // The angle is that of the flats, which are nearer to the axis than the circle.
    let share = half_width(1.0, spec.sides);
    let height = share * (top - opening) / angle.tan();
    cone(spec.sides, (0.0, height), (opening, top), from_mm(spec.collar_mm), t, angle)
}

/// A triangle in x and z, with its right angle at high x, drawn along y.
fn wedge(spec: &WedgeSpec) -> Parts {
    let [length, width, height] = spec.size_mm.map(from_mm);
    let (x, y) = (length / 2.0, width / 2.0);
    let triangle =
        |y: f64| [Point::new(-x, y, 0.0), Point::new(x, y, height), Point::new(x, y, 0.0)];
    // Counter-clockwise seen from high y.
    let solid = ConvexPolyhedron::frustum(triangle(-y).to_vec(), triangle(y).to_vec())?;
    Ok(vec![piece(solid)])
}

fn drum(spec: &DrumSpec) -> Parts {
    let (radius, t) = (from_mm(spec.inner_diameter_mm) / 2.0, from_mm(spec.wall_mm));
    let half = from_mm(spec.length_mm) / 2.0;
    let mut parts = vessel(spec.sides, radius, (-half, half), t, [true; 2])?;
    let high = from_mm(spec.lifter_mm);
    // Their outer side lies within the wall, however its flats lie.
    let (inner, outer) = (radius - high, radius + t / 2.0);
    let (low, top) = ([inner, -high / 2.0, -half], [outer, high / 2.0, half]);
    parts.extend(around(spec.lifters, low, top)?);
    // From an upright axis to one along y.
    let lie = UnitQuaternion::from_axis_angle(&Vector::x_axis(), -FRAC_PI_2);
    let lie = Pose::from_parts(Translation3::identity(), lie);
    Ok(parts.into_iter().map(|p| Piece { pose: lie * p.pose, ..p }).collect())
}

/// Blades that begin where their neighbours do, about a core of that size.
fn vane(spec: &VaneSpec) -> Parts {
    let (radius, half) = (from_mm(spec.diameter_mm) / 2.0, from_mm(spec.height_mm) / 2.0);
    let (n, side) = (f64::from(spec.blades), from_mm(spec.blade_mm) / 2.0);
    let inner = if spec.blades == 2 { 0.0 } else { side / (PI / n).tan() };
    // Corners of the core lie between blades: halfway from one to the next.
    let corner = |k: u32| {
        let (sine, cosine) = (2.0 * PI * (f64::from(k) + 0.5) / n).sin_cos();
        (inner.hypot(side) * cosine, inner.hypot(side) * sine)
    };
    let mut parts = Vec::new();
    if spec.blades > 2 {
        let outline: Vec<(f64, f64)> = (0..spec.blades).map(corner).collect();
        parts.push(piece(ConvexPolyhedron::prism(&outline, -half, half)?));
    }
    parts.extend(around(spec.blades, [inner, -side, -half], [radius, side, half])?);
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built(shape: &str) -> RigidPiece {
        let text = format!(r#"{{ "name": "a", "shape": {shape} }}"#);
        let spec: PieceSpec = serde_json::from_str(&text).expect("a piece");
        RigidPiece::new(&spec).expect("it can be built")
    }

    fn volume(piece: &RigidPiece) -> f64 {
        piece.parts.iter().map(|p| p.shape.signed_volume()).sum::<f64>() * 1e9
    }

    fn is_solid_at(piece: &RigidPiece, [x, y, z]: [f64; 3]) -> bool {
        let place = Point::new(x, y, z) * 1e-3;
        piece.parts.iter().any(|part| {
            let at = part.pose.inverse() * place;
            (0..part.shape.faces().len())
                .all(|f| part.shape.plane(f).is_some_and(|(n, offset)| n.dot(&at.coords) < offset))
        })
    }

    #[test]
    fn the_area_along_a_direction_is_that_of_the_shadow() {
        let plate = built(r#"{ "plate": { "size_mm": [100, 50, 10] } }"#);
        let wedge = built(r#"{ "wedge": { "size_mm": [100, 50, 20] } }"#);
        let slanted = Vector::new(0.6, 0.0, 0.8);
        for (piece, along, expected) in [
            (&plate, Vector::z(), 5000.0),
            (&plate, -Vector::z(), 5000.0),
            (&plate, Vector::x(), 500.0),
            (&plate, slanted, 0.6 * 500.0 + 0.8 * 5000.0),
            (&wedge, Vector::z(), 5000.0),
            (&wedge, Vector::y(), 1000.0),
        ] {
            let got = piece.area_along(&along) * 1e6;
            assert!((got - expected).abs() < 1e-6, "law: {expected} mm², got {got} mm²");
        }
        let disc = built(r#"{ "disc": { "diameter_mm": 20, "thickness_mm": 2 } }"#);
        let (got, expected) = (disc.area_along(&Vector::z()) * 1e6, PI * 100.0);
        assert!((got / expected - 1.0).abs() < 1e-9, "law: the circle's area, got {got} mm²");
        assert!((plate.volume() * 1e9 - 5e4).abs() < 1e-6, "law: 50 cm³");
    }

    #[test]
    fn the_inertia_about_an_axis_is_that_of_a_block() {
        let plate = built(r#"{ "plate": { "size_mm": [100, 50, 10] } }"#);
        let (mass, middle) = (0.6, Point::origin());
        let aside = Point::new(0.05, 0.0, 7.0);
        for (about, expected) in [(middle, (0.01 + 0.0025) / 12.0), (aside, 0.0125 / 12.0 + 0.0025)]
        {
            let got = plate.inertia_about(&Vector::z(), &about, mass);
            let expected = mass * expected;
            assert!((got - expected).abs() < 1e-15, "law: m ((a² + b²)/12 + d²), got {got}");
        }
        let reach = plate.reach_from(&Vector::z(), &aside);
        assert!((reach - 0.1_f64.hypot(0.025)).abs() < 1e-15, "law: to its far corner, {reach} m");
    }

    /// Law: a block of two halves, put up turned and aside, has centre, axes and moments of the
    /// whole block.
    #[test]
    fn the_principal_frame_of_parts_is_that_of_the_whole() {
        let whole = built(r#"{ "plate": { "size_mm": [100, 50, 10] } }"#);
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.9);
        let aside = Pose::from_parts(Translation3::new(0.2, -0.1, 0.4), turn);
        let half = ConvexPolyhedron::cuboid(Vector::new(0.05, 0.05, 0.01)).expect("a block");
        let parts = [-0.025, 0.025]
            .map(|x| Piece { pose: aside * Pose::translation(x, 0.0, 0.0), ..piece(half.clone()) });
        let halves = RigidPiece { parts: parts.into(), ..whole.clone() };
        let (frame, moments) = halves.principal_frame();
        let (own, alone) = whole.principal_frame();
        let expected: [[f64; 2]; 3] = [[0.05, 0.01], [0.1, 0.01], [0.1, 0.05]];
        for (k, [a, b]) in expected.into_iter().enumerate() {
            let law = (a * a + b * b) / 12.0;
            for got in [moments[k], alone[k]] {
                assert!((got / law - 1.0).abs() < 1e-12, "law: {law} m², got {got}");
            }
        }
        let centre = frame.translation.vector - aside.translation.vector;
        assert!(centre.norm() < 1e-15, "law: its middle, off by {centre}");
        for axis in [Vector::x(), Vector::y(), Vector::z()] {
            let (got, law) = (frame.rotation * axis, aside.rotation * (own.rotation * axis));
            assert!((got.dot(&law).abs() - 1.0).abs() < 1e-12, "law: its axes, {got} and {law}");
        }
    }

    #[test]
    fn a_vane_is_blades_and_a_core_that_fill_each_place_once() {
        for (blades, core) in [(2, 0.0), (3, 0.75_f64.sqrt() / 2.0 * 2.0 * 2.0), (4, 4.0)] {
            let vane = built(&format!(
                r#"{{ "vane": {{ "diameter_mm": 40, "height_mm": 30, "blades": {blades} }} }}"#
            ));
            // A regular polygon of sides of 2 mm, from which blades reach to 20 mm.
            let n = f64::from(blades);
            let inner = if blades == 2 { 0.0 } else { 1.0 / (PI / n).tan() };
            let polygon = if blades == 2 { 0.0 } else { n * inner };
            assert!((polygon - core).abs() < 1e-12, "law: n r s/2 = {core}, got {polygon}");
            let (got, law) = (volume(&vane), 30.0 * (polygon + n * 2.0 * (20.0 - inner)));
            assert!((got / law - 1.0).abs() < 1e-9, "law: {law} mm³, got {got}");
            assert!(is_solid_at(&vane, [19.0, 0.9, 14.0]) && is_solid_at(&vane, [-0.2, 0.1, 0.0]));
            assert!(!is_solid_at(&vane, [5.0, 5.0, 0.0]), "law: open between blades");
            let frame = vane.principal_frame().0.translation.vector;
            assert!(frame.norm() < 1e-15, "law: its centre is on its axis, {frame}");
        }
    }

    #[test]
    fn walls_of_a_box_fill_what_lies_between_inside_and_outside() {
        let inner = 100.0 * 60.0 * 80.0;
        for (open, expected) in [
            ("[]", 120.0 * 80.0 * 100.0 - inner),
            (r#"["top"]"#, 120.0 * 80.0 * 90.0 - inner),
            (r#"["top", "bottom"]"#, 120.0 * 80.0 * 80.0 - inner),
        ] {
            let of = format!(r#"{{ "box": {{ "inner_mm": [100, 60, 80], "open": {open} }} }}"#);
            let got = volume(&built(&of));
            assert!((got / expected - 1.0).abs() < 1e-12, "law: {expected} mm³, got {got}");
        }
        let without = built(r#"{ "box": { "inner_mm": [100, 60, 80], "open": ["high_x"] } }"#);
        assert!(!is_solid_at(&without, [55.0, 0.0, 40.0]), "law: that side is open");
        assert!(is_solid_at(&without, [-55.0, 0.0, 40.0]), "law: the other is not");
    }

    #[test]
    fn a_drum_lies_along_y_and_is_closed() {
        let drum = built(
            r#"{ "drum": { "inner_diameter_mm": 100, "length_mm": 40, "lifters": 4, "lifter_mm": 8 } }"#,
        );
        for (at, solid) in [
            ([0.0, 0.0, 0.0], false),
            ([0.0, 25.0, 0.0], true),
            ([0.0, -25.0, 0.0], true),
            ([0.0, 0.0, 55.0], true),
            ([55.0, 19.0, 0.0], true),
            ([45.0, 0.0, 0.0], true),
            ([0.0, 0.0, -45.0], true),
            ([32.0, 0.0, 32.0], false),
        ] {
            assert_eq!(is_solid_at(&drum, at), solid, "law: walls and bars at {at:?} mm");
        }
    }

    #[test]
    fn a_hopper_with_four_sides_is_a_pyramid_of_its_angle() {
        let hopper = built(
            r#"{ "hopper": { "opening_diameter_mm": 40, "top_diameter_mm": 120, "half_angle_deg": 30, "sides": 4 } }"#,
        );
        assert_eq!(hopper.parts.len(), 4);
        // Half of the side of the square of the circle's area, a tangent of 30° higher up.
        let half = |diameter: f64| diameter / 2.0 * (PI / 4.0).sqrt();
        let height = (half(120.0) - half(40.0)) / 30_f64.to_radians().tan();
        let side = |z: f64| half(40.0) + (half(120.0) - half(40.0)) * z / height;
        for z in [1.0, 0.5 * height, height - 1.0] {
            assert!(!is_solid_at(&hopper, [side(z) - 0.1, 0.0, z]), "law: open inside, at {z} mm");
            assert!(is_solid_at(&hopper, [side(z) + 0.1, 0.0, z]), "law: a wall, at {z} mm");
        }
        assert!(!is_solid_at(&hopper, [side(height) + 1.0, 0.0, height + 0.1]), "law: its top");
    }

    /// Law: what a scenario takes for the volume of a piece before it is built is what is built.
    #[test]
    fn shapes_have_the_volumes_that_the_scenario_knows() {
        for shape in [
            r#"{ "box": { "inner_mm": [100, 60, 80], "wall_mm": 5 } }"#,
            r#"{ "box": { "inner_mm": [100, 60, 80], "open": ["bottom", "low_x", "high_y"] } }"#,
            r#"{ "cylinder": { "inner_diameter_mm": 80, "height_mm": 100 } }"#,
            r#"{ "cylinder": { "inner_diameter_mm": 80, "height_mm": 100, "wall_mm": 3,
                "sides": 8, "open_top": false, "open_bottom": true } }"#,
            r#"{ "plate": { "size_mm": [10, 20, 30] } }"#,
            r#"{ "disc": { "diameter_mm": 20, "thickness_mm": 5, "sides": 8 } }"#,
            r#"{ "hopper": { "opening_diameter_mm": 40, "top_diameter_mm": 120,
                "half_angle_deg": 30, "sides": 4 } }"#,
            r#"{ "hopper": { "opening_diameter_mm": 40, "top_diameter_mm": 90, "wall_mm": 4,
                "half_angle_deg": 60, "collar_mm": 30 } }"#,
            r#"{ "wedge": { "size_mm": [10, 20, 30] } }"#,
            r#"{ "vane": { "diameter_mm": 40, "height_mm": 30, "blades": 2 } }"#,
            r#"{ "vane": { "diameter_mm": 40, "height_mm": 30, "blades": 6, "blade_mm": 3 } }"#,
            r#"{ "drum": { "inner_diameter_mm": 100, "length_mm": 40 } }"#,
            r#"{ "drum": { "inner_diameter_mm": 100, "length_mm": 40, "wall_mm": 6,
                "lifters": 4, "lifter_mm": 8 } }"#,
            r#"{ "mesh": { "parts": [{
                "vertices_mm": [[1, 2, 3], [31, 2, 3], [1, 42, 3], [1, 2, 53]],
                "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] }] } }"#,
        ] {
            let spec: ShapeSpec = serde_json::from_str(shape).expect("a shape");
            let (got, built) = (spec.solid_mm3().expect("it is known"), volume(&built(shape)));
            let is_near = (got / built - 1.0).abs() < 1e-9;
            assert!(is_near, "law: {built} mm³ as it is built, got {got} of {shape}");
        }
    }

    #[test]
    fn solids_have_their_volumes() {
        for (shape, expected) in [
            (r#"{ "plate": { "size_mm": [10, 20, 30] } }"#, 6000.0),
            (r#"{ "wedge": { "size_mm": [10, 20, 30] } }"#, 3000.0),
            (r#"{ "disc": { "diameter_mm": 20, "thickness_mm": 5 } }"#, 500.0 * PI),
        ] {
            let got = volume(&built(shape));
            assert!((got / expected - 1.0).abs() < 1e-12, "law: {expected} mm³, got {got}");
        }
        let ramp = built(r#"{ "wedge": { "size_mm": [10, 20, 30] } }"#);
        assert!(is_solid_at(&ramp, [4.0, 0.0, 20.0]), "law: high at high x");
        assert!(!is_solid_at(&ramp, [-4.0, 0.0, 20.0]), "law: low at low x");
    }

    #[test]
    fn a_piece_stands_where_it_is_put() {
        let spec: PieceSpec = serde_json::from_str(
            r#"{ "name": "a", "shape": { "plate": { "size_mm": [6, 0.1, 8] } },
                "at_mm": [1, 2, 3], "rotation_deg": [0, 0, 90] }"#,
        )
        .expect("a piece");
        let piece = RigidPiece::new(&spec).expect("built");
        let got = piece.at * Point::new(1.0, 0.0, 0.0);
        assert!((got - Point::new(0.001, 1.002, 0.003)).norm() < 1e-12, "law: x to y, got {got}");
        assert!((piece.radius - 5e-3).abs() < 1e-6, "law: half of its diagonal");
    }
}
