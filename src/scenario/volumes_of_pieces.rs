//! What pieces are made of: volume and mass of the walls and solids that they are built of.

use super::*;

impl ShapeSpec {
    /// Volume in mm³ of the solid parts that a piece is built of; parts that overlap count twice, as
    /// they do in its mass. None without a shape.
    pub(crate) fn solid_mm3(&self) -> Option<f64> {
        let block = |[a, b, c]: [f64; 3]| a * b * c;
        Some(match self {
            Self { r#box: Some(b), .. } => b.walls_mm3(),
            Self { cylinder: Some(c), .. } => {
                let ends = u32::from(!c.open_bottom) + u32::from(!c.open_top);
                vessel(c.sides, c.inner_diameter_mm / 2.0, c.height_mm, c.wall_mm, ends)
            }
            Self { plate: Some(p), .. } => block(p.size_mm),
            Self { disc: Some(d), .. } => PI / 4.0 * d.diameter_mm.powi(2) * d.thickness_mm,
            Self { hopper: Some(h), .. } => h.walls_mm3(),
            Self { wedge: Some(w), .. } => block(w.size_mm) / 2.0,
            Self { mesh: Some(m), .. } => m.volume_mm3(),
            Self { vane: Some(v), .. } => v.blades_mm3(),
            Self { drum: Some(d), .. } => {
                let bar = (d.lifter_mm + d.wall_mm / 2.0) * d.lifter_mm * d.length_mm;
                vessel(d.sides, d.inner_diameter_mm / 2.0, d.length_mm, d.wall_mm, 2)
                    + f64::from(d.lifters) * bar
            }
            _ => return None,
        })
    }
}

impl PieceSpec {
    /// Mass in kg of a piece whose mass is not given.
    pub(super) fn usual_mass(&self) -> Option<f64> {
        Some(self.shape.solid_mm3()? * 1e-9 * PIECE_DENSITY)
    }
}

impl BoxSpec {
    fn walls_mm3(&self) -> f64 {
        let ([x, y, height], wall) = (self.inner_mm, self.wall_mm);
        let outer_y = y + 2.0 * wall;
        let of_sides = [
            ([BoxSide::Bottom, BoxSide::Top], (x + 2.0 * wall) * outer_y),
            ([BoxSide::LowX, BoxSide::HighX], outer_y * height),
            ([BoxSide::LowY, BoxSide::HighY], x * height),
        ];
        let closed = of_sides.iter().map(|(sides, area)| {
            let count = sides.iter().filter(|side| !self.open.contains(side)).count();
            count as f64 * area * wall
        });
        closed.sum()
    }
}

impl HopperSpec {
    /// Of the ring between opening and top, whose area grows with the height, and of the collar.
    fn walls_mm3(&self) -> f64 {
        let (opening, top) = (self.opening_diameter_mm / 2.0, self.top_diameter_mm / 2.0);
        let angle = self.half_angle_deg.to_radians();
        let height = flats(self.sides, (top - opening).max(0.0)) / angle.tan();
        let across = self.wall_mm / angle.cos();
        let [low, high] = [opening, top].map(|radius| ring(self.sides, radius, across));
        (low + high) / 2.0 * height + ring(self.sides, top, self.wall_mm) * self.collar_mm
    }
}

impl VaneSpec {
    /// Of the blades from where they part, and of the core within.
    fn blades_mm3(&self) -> f64 {
        let (count, core) = (f64::from(self.blades), self.core_mm());
        let blade = (self.diameter_mm / 2.0 - core) * self.blade_mm;
        count * (blade + core * self.blade_mm / 2.0) * self.height_mm
    }
}

impl MeshPieceSpec {
    /// Of tetrahedra between the origin and the triangles of all faces.
    fn volume_mm3(&self) -> f64 {
        let of_face = |part: &MeshPart, face: &[u32]| -> f64 {
            let corner = |n: u32| part.vertices_mm.get(n as usize).copied().unwrap_or_default();
            let corners: Vec<Vector> = face.iter().map(|n| Vector::from(corner(*n))).collect();
            let fan = corners.windows(2).map(|edge| edge[0].cross(&edge[1]).dot(&corners[0]) / 6.0);
            fan.sum()
        };
        let of_part = |part: &MeshPart| -> f64 {
            part.faces.iter().map(|face| of_face(part, face.as_slice())).sum()
        };
        self.parts().iter().map(of_part).sum()
    }
}

/// Distance from the axis to the flats of a regular polygon with the area of a circle of a radius:
/// from N tan(π/N) · w² = π r².
pub(super) fn flats(sides: u32, radius: f64) -> f64 {
    let n = f64::from(sides);
    radius * (PI / (n * (PI / n).tan())).sqrt()
}

/// Area in mm² of a ring of flat walls of a thickness around a polygon that has the area of a circle.
fn ring(sides: u32, radius: f64, thickness: f64) -> f64 {
    let n = f64::from(sides);
    let inner = flats(sides, radius);
    // Of a polygon whose flats are at a distance a: n tan(π/n) a².
    n * (PI / n).tan() * thickness * (2.0 * inner + thickness)
}

/// Volume in mm³ of an upright round wall with a number of ends, which are as wide as it is outside.
fn vessel(sides: u32, radius: f64, height: f64, thickness: f64, ends: u32) -> f64 {
    let end = PI * (radius + thickness).powi(2) * thickness;
    ring(sides, radius, thickness) * height + f64::from(ends) * end
}
