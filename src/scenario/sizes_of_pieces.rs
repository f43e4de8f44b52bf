//! How large pieces are, as far as checks ask.

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::UnitQuaternion;

use super::*;
use crate::units::from_deg;

impl PieceSpec {
    /// How it is turned, as it is put up.
    fn turn(&self) -> UnitQuaternion<f64> {
        let [x, y, z] = self.rotation_deg.map(from_deg);
        UnitQuaternion::from_euler_angles(x, y, z)
    }

    /// A unit vector along a direction in its own frame, as it is put up; none of no direction.
    pub(super) fn in_frame(&self, direction: Vector) -> Option<[f64; 3]> {
        Some((self.turn().inverse() * direction.try_normalize(0.0)?).into())
    }

    /// Area in m² that it shows along a direction, as it is put up.
    pub(super) fn shows_m2(&self, direction: Vector) -> Option<f64> {
        Some(self.shape.shows_mm2(self.in_frame(direction)?)? * 1e-6)
    }

    /// Whether grains within it stand on it: in a container with a floor, in a hopper or a drum, as it
    /// is put up. None of what has no inside.
    pub(super) fn bears_within(&self) -> Option<bool> {
        let upright = self.in_frame(Vector::z()).map_or(0.0, |[_, _, z]| z);
        // On its side a wall is below.
        let is_upright = upright > FRAC_1_SQRT_2;
        match &self.shape {
            ShapeSpec { r#box: Some(b), .. } => {
                Some(!(is_upright && b.open.contains(&BoxSide::Bottom)))
            }
            ShapeSpec { cylinder: Some(c), .. } => Some(!(is_upright && c.open_bottom)),
            ShapeSpec { hopper: Some(_), .. } | ShapeSpec { drum: Some(_), .. } => Some(true),
            _ => None,
        }
    }

    /// Lowest and highest coordinates in mm of a box around it, as it is put up.
    pub(super) fn extent_mm(&self) -> Option<[Vector; 2]> {
        let ends = self.shape.extent_mm()?;
        let (turn, at) = (self.turn(), Vector::from(self.at_mm));
        let corner = |n: usize| {
            let [x, y, z] = [0, 1, 2].map(|axis: usize| ends[(n >> axis) & 1][axis]);
            at + turn * Vector::new(x, y, z)
        };
        let first = corner(0);
        Some(
            (1..8)
                .map(corner)
                .fold([first, first], |[low, high], corner| [low.inf(&corner), high.sup(&corner)]),
        )
    }
}

impl ShapeSpec {
    /// The kinds that are given: one of a sound shape.
    pub(super) fn kinds(&self) -> Vec<String> {
        // Of its fields, only those are written that are there.
        let shape = serde_json::to_value(self).unwrap_or_default();
        shape.as_object().into_iter().flatten().map(|(kind, _)| kind.clone()).collect()
    }

    /// Thickness of its walls in mm, with the path of the field; none of a solid.
    pub(super) fn wall_mm(&self) -> Option<(&'static str, f64)> {
        let of_box = self.r#box.as_ref().map(|b| ("box.wall_mm", b.wall_mm));
        let of_cylinder = self.cylinder.as_ref().map(|c| ("cylinder.wall_mm", c.wall_mm));
        let of_hopper = self.hopper.as_ref().map(|h| ("hopper.wall_mm", h.wall_mm));
        let of_drum = self.drum.as_ref().map(|d| ("drum.wall_mm", d.wall_mm));
        of_box.or(of_cylinder).or(of_hopper).or(of_drum)
    }

    /// Area in mm² that a piece shows along a unit vector in its own frame: of a solid, a wedge as
    /// much as its block at most; of what has walls, their edges and, upright, one wall.
    pub(super) fn shows_mm2(&self, along: [f64; 3]) -> Option<f64> {
        let [x, y, z] = along.map(f64::abs);
        let block = |[a, b, c]: [f64; 3]| x * b * c + y * a * c + z * a * b;
        match self {
            Self { plate: Some(p), .. } => Some(block(p.size_mm)),
            Self { disc: Some(d), .. } => {
                let side = d.diameter_mm * d.thickness_mm * x.hypot(y);
                Some(PI / 4.0 * d.diameter_mm * d.diameter_mm * z + side)
            }
            Self { wedge: Some(w), .. } => Some(block(w.size_mm)),
            Self { mesh: Some(m), .. } => Some(m.shows_mm2(along)),
            Self { vane: Some(v), .. } => {
                let side = v.diameter_mm * v.height_mm * x.hypot(y);
                Some(side + v.blade_mm * v.diameter_mm / 2.0 * f64::from(v.blades) * z)
            }
            Self { r#box: Some(b), .. } => {
                let [a, w, h] = b.inner_mm;
                let edges = 2.0 * b.wall_mm * (a + w);
                Some(x * w * h + y * a * h + z * edges)
            }
            Self { cylinder: Some(c), .. } => {
                let edge = PI * c.wall_mm * c.inner_diameter_mm;
                Some(c.inner_diameter_mm * c.height_mm * x.hypot(y) + edge * z)
            }
            Self { hopper: Some(h), .. } => {
                let slope = PI / 4.0 * (h.top_diameter_mm.powi(2) - h.opening_diameter_mm.powi(2));
                Some(h.opening_diameter_mm * h.height_mm() * x.hypot(y) + slope.max(0.0) * z)
            }
            Self { drum: Some(d), .. } => {
                let edge = PI * d.wall_mm * d.inner_diameter_mm;
                Some(d.inner_diameter_mm * d.length_mm * x.hypot(z) + edge * y)
            }
            _ => None,
        }
    }

    /// First moment in mm³ about its upright axis of the faces that push grains when it is turned:
    /// a pressure on them resists by as much. Known of a vane: of each blade's length times width
    /// times half of that.
    pub(super) fn turned_mm3(&self) -> Option<f64> {
        let vane = self.vane.as_ref()?;
        let arm = vane.diameter_mm / 2.0;
        Some(f64::from(vane.blades) * vane.height_mm * arm * arm / 2.0)
    }

    /// Lowest and highest coordinates in mm of a box around it, in its own frame.
    fn extent_mm(&self) -> Option<[[f64; 3]; 2]> {
        let about = |[x, y]: [f64; 2], low: f64, high: f64| Some([[-x, -y, low], [x, y, high]]);
        let middle = |[x, y, z]: [f64; 3]| about([x / 2.0, y / 2.0], -z / 2.0, z / 2.0);
        match self {
            Self { r#box: Some(b), .. } => {
                let ([x, y, z], wall) = (b.inner_mm, b.wall_mm);
                about([x / 2.0 + wall, y / 2.0 + wall], -wall, z + wall)
            }
            Self { cylinder: Some(c), .. } => {
                let radius = c.inner_diameter_mm / 2.0 + c.wall_mm;
                about([radius; 2], -c.wall_mm, c.height_mm + c.wall_mm)
            }
            Self { plate: Some(p), .. } => middle(p.size_mm),
            Self { disc: Some(d), .. } => middle([d.diameter_mm, d.diameter_mm, d.thickness_mm]),
            Self { hopper: Some(h), .. } => {
                let radius = h.top_diameter_mm.max(h.opening_diameter_mm) / 2.0 + h.wall_mm;
                about([radius; 2], 0.0, h.height_mm() + h.collar_mm)
            }
            Self { wedge: Some(w), .. } => {
                let [x, y, z] = w.size_mm;
                about([x / 2.0, y / 2.0], 0.0, z)
            }
            Self { mesh: Some(m), .. } => m.extent_mm(),
            Self { vane: Some(v), .. } => middle([v.diameter_mm, v.diameter_mm, v.height_mm]),
            Self { drum: Some(d), .. } => {
                let across = d.inner_diameter_mm + 2.0 * d.wall_mm;
                middle([across, d.length_mm + 2.0 * d.wall_mm, across])
            }
            _ => None,
        }
    }

    /// A length in mm from its origin that nothing of it exceeds.
    pub(super) fn reach_mm(&self) -> f64 {
        let sizes: Vec<f64> = match self {
            Self { r#box: Some(b), .. } => {
                let [x, y, z] = b.inner_mm;
                vec![x / 2.0 + b.wall_mm, y / 2.0 + b.wall_mm, z + b.wall_mm]
            }
            Self { cylinder: Some(c), .. } => {
                vec![c.inner_diameter_mm + c.wall_mm, c.height_mm + c.wall_mm]
            }
            Self { mesh: Some(m), .. } => vec![m.reach_mm()],
            Self { plate: Some(p), .. } => p.size_mm.map(|size| size / 2.0).to_vec(),
            Self { disc: Some(d), .. } => vec![d.diameter_mm, d.thickness_mm],
            Self { hopper: Some(h), .. } => {
                vec![h.top_diameter_mm + h.wall_mm, h.height_mm() + h.collar_mm]
            }
            Self { wedge: Some(w), .. } => w.size_mm.to_vec(),
            Self { vane: Some(v), .. } => {
                vec![(v.diameter_mm / 2.0).hypot(v.blade_mm), v.height_mm / 2.0]
            }
            Self { drum: Some(d), .. } => {
                vec![d.inner_diameter_mm + d.wall_mm, d.length_mm / 2.0 + d.wall_mm]
            }
            _ => Vec::new(),
        };
        sizes.iter().map(|size| size * size).sum::<f64>().sqrt()
    }

    /// What it holds in mm³, filled to its rim and as it stands upright, without a floor as well,
    /// which another piece may be; none of what holds nothing.
    pub(super) fn holds_mm3(&self) -> Option<f64> {
        let round = |diameter: f64, height: f64| PI / 4.0 * diameter * diameter * height;
        match self {
            Self { r#box: Some(b), .. } => {
                let walls = [BoxSide::LowX, BoxSide::HighX, BoxSide::LowY, BoxSide::HighY];
                let whole = walls.iter().all(|side| !b.open.contains(side));
                whole.then(|| b.inner_mm.iter().product())
            }
            Self { cylinder: Some(c), .. } => Some(round(c.inner_diameter_mm, c.height_mm)),
            Self { drum: Some(d), .. } => Some(round(d.inner_diameter_mm, d.length_mm)),
            _ => None,
        }
    }
}

impl ShapeSpec {
    /// Of a container: the area in mm² that the room within its walls shows along a unit vector in its
    /// own frame, on which grains stand that weigh along that, and what it holds in mm³. A hopper
    /// counts as wide as its top: what does not stand on its opening stands on its slope.
    pub(super) fn room(&self, along: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y, z] = along.map(f64::abs);
        let circle = |diameter: f64| PI / 4.0 * diameter * diameter;
        let area = match self {
            Self { r#box: Some(b), .. } => {
                let [a, w, h] = b.inner_mm;
                x * w * h + y * a * h + z * a * w
            }
            Self { cylinder: Some(c), .. } => {
                let side = c.inner_diameter_mm * c.height_mm;
                circle(c.inner_diameter_mm) * z + side * x.hypot(y)
            }
            Self { drum: Some(d), .. } => {
                let side = d.inner_diameter_mm * d.length_mm;
                circle(d.inner_diameter_mm) * y + side * x.hypot(z)
            }
            Self { hopper: Some(h), .. } => {
                let (top, opening, height) =
                    (h.top_diameter_mm, h.opening_diameter_mm, h.height_mm());
                let cone = PI / 12.0 * height * (top * top + top * opening + opening * opening);
                let side = top * (height + h.collar_mm);
                let area = circle(top) * z + side * x.hypot(y);
                return Some([area, cone + circle(top) * h.collar_mm]);
            }
            _ => return None,
        };
        Some([area, self.holds_mm3()?])
    }
}

impl super::VaneSpec {
    /// Distance from the axis in mm at which its blades part.
    pub(super) fn core_mm(&self) -> f64 {
        let half = self.blade_mm / 2.0;
        if self.blades == 2 { 0.0 } else { half / (PI / f64::from(self.blades)).tan() }
    }
}

impl super::HopperSpec {
    /// Height of its slope in mm.
    pub(super) fn height_mm(&self) -> f64 {
        (self.top_diameter_mm - self.opening_diameter_mm).max(0.0)
            / 2.0
            / self.half_angle_deg.to_radians().tan()
    }
}

/// The lowest height in mm that pieces may reach where they begin: of the boxes around them.
pub(super) fn lowest_mm<'a>(pieces: impl Iterator<Item = &'a PieceSpec>) -> Option<f64> {
    let lowest = |piece: &PieceSpec| match piece.extent_mm() {
        Some([low, _]) => low.z,
        None => piece.at_mm[2] - piece.shape.reach_mm(),
    };
    pieces.map(lowest).min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: the lowest of pieces is the lower side of a floor or of a wall, not as far below its
    /// origin as its walls are high.
    #[test]
    fn the_lowest_of_pieces_is_their_lowest_side() {
        let piece = |shape: Value, turn: [f64; 3]| -> PieceSpec {
            let piece = json!({ "name": "a", "shape": shape, "at_mm": [0, 0, 5],
                "rotation_deg": turn });
            read(&piece).expect("a piece")
        };
        let tall = json!({ "box": { "inner_mm": [60, 60, 300], "wall_mm": 10 } });
        let plate = json!({ "plate": { "size_mm": [50, 50, 8] } });
        for (what, pieces, expected) in [
            ("a floor", vec![piece(tall.clone(), [0.0; 3])], -5.0),
            ("a wall of what lies", vec![piece(tall.clone(), [90.0, 0.0, 0.0])], -35.0),
            ("the lower of two", vec![piece(plate, [0.0; 3]), piece(tall, [0.0; 3])], -5.0),
        ] {
            let found = lowest_mm(pieces.iter()).expect("pieces");
            assert!((found - expected).abs() < 1e-9, "law: {what}: {found}, expected {expected}");
        }
        assert_eq!(lowest_mm(std::iter::empty()), None, "law: of none there is none");
    }

    /// Law: the box around a piece is that of its walls, turned and put up with it.
    #[test]
    fn the_box_around_a_piece_is_turned_with_it() {
        let ends = |shape: Value, turn: [f64; 3]| {
            let piece = json!({ "name": "a", "shape": shape, "at_mm": [1, 2, 3],
                "rotation_deg": turn });
            let piece: PieceSpec = read(&piece).expect("a piece");
            // Without the rounding of turns.
            let [low, high] = piece.extent_mm().expect("a box").map(|end| end.map(f64::round));
            [<[f64; 3]>::from(low), high.into()]
        };
        let plate = json!({ "plate": { "size_mm": [100, 50, 10] } });
        let got = ends(plate.clone(), [0.0; 3]);
        assert_eq!(got, [[-49.0, -23.0, -2.0], [51.0, 27.0, 8.0]], "law: a plate about its middle");
        let got = ends(plate, [0.0, 0.0, 90.0]);
        assert_eq!(got, [[-24.0, -48.0, -2.0], [26.0, 52.0, 8.0]], "law: turned");
        let cup = json!({ "cylinder": { "inner_diameter_mm": 80, "height_mm": 100 } });
        let got = ends(cup, [0.0; 3]);
        assert_eq!(got, [[-49.0, -48.0, -7.0], [51.0, 52.0, 113.0]], "law: with its walls");
        let mesh = json!({ "mesh": { "parts": [{
            "vertices_mm": [[0, 0, 0], [30, 0, 0], [0, 40, 0], [0, 0, 50]],
            "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] }] } });
        let got = ends(mesh, [180.0, 0.0, 0.0]);
        assert_eq!(got, [[1.0, -38.0, -47.0], [31.0, 2.0, 3.0]], "law: its corners");
    }
}
