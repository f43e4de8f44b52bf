//! Cylinder, funnel and top plate as solid convex pieces, walls as rings of them.
//!
//! A round wall of N flat pieces has the circle's area, not its radius: the inner half-width is
//! r·√(π / (N tan(π/N))), from N tan(π/N) · w² = π r². With 48 pieces the flats lie 0.07 % inside
//! the circle and the corners 0.14 % outside; the area has no error at all.

use std::{f64::consts::PI, sync::Arc};

use super::{ApparatusError, Piece};
use crate::geometry::{ConvexPolyhedron, MassProperties, Point, PolyhedronError, Pose, Vector};
use crate::scenario::{CylinderSpec, FunnelSpec, TopPlateSpec};
use crate::units::{from_deg, from_g, from_mm};

/// Distance from the axis to the flats of a regular polygon with the area of
/// the circle of the given radius.
pub(super) fn half_width(radius: f64, sides: u32) -> f64 {
    let n = f64::from(sides);
    radius * (PI / (n * (PI / n).tan())).sqrt()
}

/// Corners of a regular polygon with the circle's area, counter-clockwise, first flat along +x.
pub(super) fn polygon(radius: f64, sides: u32) -> Vec<(f64, f64)> {
    let half = PI / f64::from(sides);
    let corner = half_width(radius, sides) / half.cos();
    (0..sides)
        .map(|i| {
            let angle = (2.0 * f64::from(i) - 1.0) * half;
            (corner * angle.cos(), corner * angle.sin())
        })
        .collect()
}

/// A piece around its own centroid, so that engines see coordinates of its own size.
pub(super) fn piece(shape: ConvexPolyhedron) -> Piece {
    let centroid = MassProperties::of(&shape).centroid;
    let pose = Pose::translation(centroid.x, centroid.y, centroid.z);
    Piece { shape: Arc::new(shape.transformed(&pose.inverse())), pose }
}

/// A ring of `sides` solid pieces whose inner radius goes linearly from `radii.0` at height
/// `heights.0` to `radii.1` at `heights.1`, with the given horizontal thickness, all in m.
pub(super) fn ring(
    sides: u32,
    heights: (f64, f64),
    radii: (f64, f64),
    thickness: f64,
) -> Result<Vec<Piece>, PolyhedronError> {
    let half = PI / f64::from(sides);
    let level = |i: u32, z: f64, radius: f64| -> Vec<Point> {
        let inner = half_width(radius, sides) / half.cos();
        let outer = inner + thickness / half.cos();
        let (from, to) = ((2.0 * f64::from(i) - 1.0) * half, (2.0 * f64::from(i) + 1.0) * half);
        [(inner, from), (outer, from), (outer, to), (inner, to)]
            .map(|(r, angle): (f64, f64)| Point::new(r * angle.cos(), r * angle.sin(), z))
            .to_vec()
    };
    (0..sides)
        .map(|i| {
            let lower = level(i, heights.0, radii.0);
            let upper = level(i, heights.1, radii.1);
            ConvexPolyhedron::frustum(lower, upper).map(piece)
        })
        .collect()
}

/// An upright cylinder between two heights, of an inner radius, with its bottom and its top where
/// these are closed; all in m.
pub(super) fn vessel(
    sides: u32,
    radius: f64,
    (low, high): (f64, f64),
    thickness: f64,
    [bottom, top]: [bool; 2],
) -> Result<Vec<Piece>, PolyhedronError> {
    let mut pieces = ring(sides, (low, high), (radius, radius), thickness)?;
    let across = polygon(radius + thickness, sides);
    if bottom {
        pieces.push(piece(ConvexPolyhedron::prism(&across, low - thickness, low)?));
    }
    if top {
        pieces.push(piece(ConvexPolyhedron::prism(&across, high, high + thickness)?));
    }
    Ok(pieces)
}

/// A cone between two heights that widens upwards by its half angle in rad from one inner radius to
/// another, and above it an upright collar of a height; all in m, the thickness along the wall's
/// normal. Parts of the cone end at its heights: those of a flat one are sheets as thick as it is
/// high, and as wide as the thickness over the cosine of its half angle.
pub(super) fn cone(
    sides: u32,
    heights: (f64, f64),
    radii: (f64, f64),
    collar: f64,
    thickness: f64,
    angle: f64,
) -> Result<Vec<Piece>, PolyhedronError> {
    let mut pieces = ring(sides, heights, radii, thickness / angle.cos())?;
    if collar > 0.0 {
        let heights = (heights.1, heights.1 + collar);
        pieces.extend(ring(sides, heights, (radii.1, radii.1), thickness)?);
    }
    Ok(pieces)
}

/// A round floor about the z axis with its upper face at z = 0; radius and thickness in m.
///
/// # Errors
/// When a dimension makes it impossible.
pub fn round_floor(radius: f64, thickness: f64) -> Result<Piece, ApparatusError> {
    ConvexPolyhedron::prism(&polygon(radius, FLOOR_SIDES), -thickness, 0.0)
        .map(piece)
        .map_err(unbuilt("base"))
}

/// Says of a part that its dimensions make no convex solid.
pub(super) fn unbuilt(part: &'static str) -> impl Fn(PolyhedronError) -> ApparatusError {
    move |reason| ApparatusError { part, reason: reason.into() }
}

/// Sides of a round floor: those of the paper's cylinder here.
const FLOOR_SIDES: u32 = 48;

/// The container, open at the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Cylinder {
    /// Inner radius in m.
    pub radius: f64,
    /// Inner height in m.
    pub height: f64,
    /// Wall pieces and floor.
    pub pieces: Vec<Piece>,
}

impl Cylinder {
    /// Builds the container.
    ///
    /// # Errors
    /// When a dimension makes a piece impossible.
    pub fn new(spec: &CylinderSpec) -> Result<Self, ApparatusError> {
        let (radius, height) = (from_mm(spec.inner_diameter_mm) / 2.0, from_mm(spec.height_mm));
        let thickness = from_mm(spec.wall_thickness_mm);
        let closed = [true, false]; // at the bottom alone
        let pieces = vessel(spec.wall_pieces, radius, (0.0, height), thickness, closed);
        let pieces = pieces.map_err(unbuilt("cylinder"))?;
        Ok(Self { radius, height, pieces })
    }
}

/// The funnel: a cone, and above it a collar as high as is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Funnel {
    /// Height of the bottom opening above the cylinder's floor, in m.
    pub opening_height: f64,
    /// Height of the cone's top above the cylinder's floor, in m.
    pub top_height: f64,
    /// Height of the upper edge above the cylinder's floor, in m: that of the collar, if there is one.
    pub edge_height: f64,
    /// Inner radius of the opening, in m.
    pub opening_radius: f64,
    /// Inner radius at the top, in m.
    pub top_radius: f64,
    /// Pieces of cone and collar.
    pub pieces: Vec<Piece>,
    /// The lid under the opening.
    pub lid: Piece,
}

impl Funnel {
    /// Builds the funnel with its opening at a height above the cylinder's
    /// floor and a collar of the given height on top, both in m.
    ///
    /// # Errors
    /// When a dimension makes a piece impossible.
    pub fn new(
        spec: &FunnelSpec,
        opening_height: f64,
        collar: f64,
    ) -> Result<Self, ApparatusError> {
        let opening = from_mm(spec.opening_diameter_mm) / 2.0;
        let top_radius = from_mm(spec.top_diameter_mm) / 2.0;
        let thickness = from_mm(spec.wall_thickness_mm);
        let angle = from_deg(spec.half_angle_deg);
        let top_height = opening_height + (top_radius - opening) / angle.tan();
        let sides = spec.wall_pieces;
        let build = || -> Result<_, PolyhedronError> {
            let (heights, radii) = ((opening_height, top_height), (opening, top_radius));
            let pieces = cone(sides, heights, radii, collar, thickness, angle)?;
            let lid = polygon(opening + thickness, sides);
            let lid = ConvexPolyhedron::prism(&lid, opening_height - thickness, opening_height)?;
            Ok((pieces, piece(lid)))
        };
        let (pieces, lid) = build().map_err(unbuilt("funnel"))?;
        Ok(Self {
            opening_height,
            top_height,
            edge_height: top_height + collar,
            opening_radius: opening,
            top_radius,
            pieces,
            lid,
        })
    }

    /// Inner radius of the cone in m at a height in m, of its ends beyond them.
    pub fn inner_radius(&self, height: f64) -> f64 {
        let share = (height - self.opening_height) / (self.top_height - self.opening_height);
        self.opening_radius + (self.top_radius - self.opening_radius) * share.clamp(0.0, 1.0)
    }
}

/// The plate laid on the grains.
#[derive(Debug, Clone, PartialEq)]
pub struct TopPlate {
    /// Shape around its centroid, flat faces normal to z.
    pub shape: Arc<ConvexPolyhedron>,
    /// Mass in kg.
    pub mass: f64,
    /// Principal moments of inertia about x, y, z in kg m².
    pub inertia: Vector,
    /// Thickness in m.
    pub thickness: f64,
    /// Radius in m.
    pub radius: f64,
}

impl TopPlate {
    /// Builds the plate.
    ///
    /// # Errors
    /// When a dimension makes it impossible.
    pub fn new(spec: &TopPlateSpec) -> Result<Self, ApparatusError> {
        let (radius, thickness) = (from_mm(spec.diameter_mm) / 2.0, from_mm(spec.thickness_mm));
        let outline = polygon(radius, spec.sides);
        let shape = ConvexPolyhedron::prism(&outline, -thickness / 2.0, thickness / 2.0)
            .map_err(unbuilt("top plate"))?;
        let mass = from_g(spec.mass_g);
        let properties = MassProperties::of(&shape);
        // The prism is symmetric about its axes: the tensor is diagonal already.
        let inertia = properties.inertia_per_density.diagonal() * (mass / properties.volume);
        Ok(Self { shape: Arc::new(shape), mass, inertia, thickness, radius })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::near;

    fn volume(pieces: &[Piece]) -> f64 {
        pieces.iter().map(|p| p.shape.signed_volume()).sum()
    }

    /// Law: parts of a cone end at its heights: those of a flat one are sheets as thick as it is
    /// high, and as wide as the thickness over the cosine of its half angle.
    #[test]
    fn parts_of_a_flat_cone_are_sheets() {
        let (angle, radii, thickness) = (from_deg(89.0), (0.0225, 0.0268), 0.01);
        let height = (radii.1 - radii.0) / angle.tan();
        for part in cone(32, (0.0, height), radii, 0.0, thickness, angle).expect("a cone") {
            let (low, high) = part.shape.heights(&part.pose);
            near("as thick as it is high", high - low, height, 1e-9);
            let away = |p: &Point| p.x.hypot(p.y);
            let corners = || part.shape.vertices().iter().map(|v| away(&(part.pose * v)));
            let (inner, outer) = corners()
                .fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
            // Corners lie off the flats, and the upper edge off the lower one.
            let corner = 1.0 / (PI / 32.0).cos();
            let wide = thickness / angle.cos() + half_width(radii.1, 32) - half_width(radii.0, 32);
            near("as wide as its wall is across", outer - inner, wide * corner, 1e-9);
        }
    }

    #[test]
    fn polygon_has_the_area_of_the_circle() {
        for sides in [12, 48, 256] {
            let corners = polygon(0.0575, sides);
            let prism = ConvexPolyhedron::prism(&corners, 0.0, 1.0).expect("a prism");
            let (expected, got) = (PI * 0.0575 * 0.0575, prism.signed_volume());
            near(&format!("area πr² with {sides} sides"), got, expected, 1e-12 * expected);
        }
    }

    #[test]
    fn cylinder_walls_leave_no_gap_and_the_paper_s_room() {
        let spec = CylinderSpec::default();
        let cylinder = Cylinder::new(&spec).expect("the paper's cylinder");
        let n = f64::from(spec.wall_pieces);
        let (inner, thick) = (half_width(0.0575, spec.wall_pieces), 0.020);
        let ring_area = n * (PI / n).tan() * ((inner + thick).powi(2) - inner * inner);
        let expected = ring_area * 0.2;
        let got = volume(&cylinder.pieces[..spec.wall_pieces as usize]);
        near("the pieces fill the ring", got, expected, 1e-9 * expected);
        for p in &cylinder.pieces {
            p.shape.sanity_check().expect("a sound piece");
        }
    }

    #[test]
    fn funnel_opens_at_its_height_and_narrows_downwards() {
        let funnel = Funnel::new(&FunnelSpec::default(), 0.25, 0.3).expect("the default funnel");
        assert_eq!(funnel.pieces.len(), 64, "32 pieces of cone and 32 of collar");
        let lowest = funnel
            .pieces
            .iter()
            .map(|p| p.shape.transformed(&p.pose).bounding_box().0.z)
            .fold(f64::INFINITY, f64::min);
        assert!((lowest - 0.25).abs() < 1e-12, "law: opening at 0.25 m, got {lowest}");
        let lid_top = funnel.lid.shape.transformed(&funnel.lid.pose).bounding_box().1.z;
        assert!((lid_top - 0.25).abs() < 1e-12, "law: lid closes at 0.25 m, got {lid_top}");
    }

    #[test]
    fn plate_has_a_disc_s_inertia() {
        let plate = TopPlate::new(&TopPlateSpec::default()).expect("the paper's plate");
        let (m, r, h) = (0.104, 0.0565, 0.01);
        let expected = [m * (3.0 * r * r + h * h) / 12.0, m * r * r / 2.0];
        for (got, expected) in [(plate.inertia.x, expected[0]), (plate.inertia.z, expected[1])] {
            near("inertia of a disc within the polygon's 0.2 %", got, expected, 2e-3 * expected);
        }
    }
}
