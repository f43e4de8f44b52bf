//! Whether pieces stand within each other.

use super::{ApparatusError, ApparatusFault, RigidPiece};
use crate::geometry::{ConvexPolyhedron, Point, Pose, Vector};
use crate::scenario::PieceSpec;

/// Pieces that are less than this deep in each other, in m, touch.
const TOUCHING: f64 = 1e-6;

/// Refuses pieces that begin within each other, where neither may.
///
/// # Errors
/// Names every pair of them.
pub fn overlapping(pieces: &[RigidPiece]) -> Result<(), ApparatusError> {
    let named = |[a, b]: [usize; 2]| format!("`{}` and `{}`", pieces[a].name, pieces[b].name);
    let found: Vec<String> = pairs(pieces).into_iter().map(named).collect();
    if found.is_empty() {
        return Ok(());
    }
    let reason = ApparatusFault::Overlap(found.join(", "));
    Err(ApparatusError { part: "laboratory", reason })
}

/// The pieces of a scenario that begin within each other, where neither may, as pairs of their
/// numbers; none where one of them cannot be built, which whoever builds them says.
pub fn overlaps(specs: &[PieceSpec]) -> Vec<[usize; 2]> {
    let pieces: Result<Vec<RigidPiece>, _> = specs.iter().map(RigidPiece::new).collect();
    pieces.map_or_else(|_| Vec::new(), |pieces| pairs(&pieces))
}

/// Numbers of pieces that begin within each other, where neither may.
fn pairs(pieces: &[RigidPiece]) -> Vec<[usize; 2]> {
    let solids: Vec<Vec<Solid>> = pieces.iter().map(|piece| solids(piece, piece.at)).collect();
    let mut found = Vec::new();
    for (a, one) in solids.iter().enumerate() {
        for (b, other) in solids.iter().enumerate().skip(a + 1) {
            let may = pieces[a].may_cross || pieces[b].may_cross;
            if !may && meet(one, other, 0.0) {
                found.push([a, b]);
            }
        }
    }
    found
}

/// The number of a piece that piece number `one` stands in by more than a depth in m, with the
/// places in `at` of those that stand; none where it stands in none that it may not.
pub fn stands_in(
    pieces: &[RigidPiece],
    at: &[Option<Pose>],
    one: usize,
    depth: f64,
) -> Option<usize> {
    let own = solids(&pieces[one], at[one]?);
    let mut others = others(pieces, one);
    others.find(|&n| at[n].is_some_and(|at| meet(&own, &solids(&pieces[n], at), depth)))
}

/// How deep in m piece number `one` stands in the piece that it is deepest in, of those that it may
/// not stand in; 0 where it stands in none of them.
pub fn depth_in_others(pieces: &[RigidPiece], at: &[Option<Pose>], one: usize) -> f64 {
    let Some(place) = at[one] else { return 0.0 };
    let own = solids(&pieces[one], place);
    let depth = |n: usize| at[n].map_or(0.0, |at| deepest(&own, &solids(&pieces[n], at)));
    others(pieces, one).map(depth).fold(0.0, f64::max)
}

/// The numbers of the pieces that piece number `one` may not stand in.
fn others(pieces: &[RigidPiece], one: usize) -> impl Iterator<Item = usize> {
    let may = move |n: usize| pieces[one].may_cross || pieces[n].may_cross;
    (0..pieces.len()).filter(move |n| *n != one && !may(*n))
}

/// The parts of a piece at a place.
fn solids(piece: &RigidPiece, at: Pose) -> Vec<Solid> {
    let parts = piece.parts.iter();
    parts.map(|part| Solid::of(&part.shape.transformed(&(at * part.pose)))).collect()
}

/// Whether one piece reaches into another by more than a depth in m.
fn meet(one: &[Solid], other: &[Solid], depth: f64) -> bool {
    one.iter().any(|x| other.iter().any(|y| x.depth_in(y) > depth + TOUCHING))
}

/// How deep in m one piece reaches into another.
fn deepest(one: &[Solid], other: &[Solid]) -> f64 {
    let depths = one.iter().flat_map(|x| other.iter().map(move |y| x.depth_in(y)));
    depths.fold(0.0, f64::max)
}

/// A convex solid as the separating axis theorem sees it.
struct Solid {
    corners: Vec<Point>,
    normals: Vec<Vector>,
    edges: Vec<Vector>,
    low: Point,
    high: Point,
}

impl Solid {
    fn of(shape: &ConvexPolyhedron) -> Self {
        let corners = shape.vertices().to_vec();
        let edge = |(a, b): (u32, u32)| corners[b as usize] - corners[a as usize];
        let (low, high) = shape.bounding_box();
        Self {
            normals: (0..shape.faces().len()).filter_map(|f| Some(shape.plane(f)?.0)).collect(),
            edges: shape.edges().into_iter().map(edge).collect(),
            corners,
            low,
            high,
        }
    }

    fn span(&self, axis: &Vector) -> (f64, f64) {
        let along = self.corners.iter().map(|corner| axis.dot(&corner.coords));
        along.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
    }

    /// How deep two solids are in each other, in m; not above 0 where they are apart
    /// (Gottschalk, Lin and Manocha 1996, "OBBTree", on the axes that can separate).
    fn depth_in(&self, other: &Self) -> f64 {
        let apart = (0..3).any(|k| self.high[k] <= other.low[k] || other.high[k] <= self.low[k]);
        if apart {
            return 0.0;
        }
        let crossed = self.edges.iter().flat_map(|a| other.edges.iter().map(move |b| a.cross(b)));
        let axes = self.normals.iter().chain(&other.normals).copied().chain(crossed);
        let mut least = f64::MAX;
        for axis in axes {
            let length = axis.norm();
            // Edges side by side separate nothing that faces do not.
            if length < 1e-12 {
                continue;
            }
            let axis = axis / length;
            let (a, b) = (self.span(&axis), other.span(&axis));
            least = least.min((a.1 - b.0).min(b.1 - a.0));
            if least <= TOUCHING {
                return least;
            }
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(specs: &[&str]) -> Vec<RigidPiece> {
        let built = |text: &&str| {
            let spec: PieceSpec = serde_json::from_str(text).expect("a piece");
            RigidPiece::new(&spec).expect("built")
        };
        specs.iter().map(built).collect()
    }

    #[test]
    fn pieces_that_touch_stand_and_pieces_in_each_other_do_not() {
        let block = r#"{ "name": "box", "shape": { "box": { "inner_mm": [100, 100, 100] } } }"#;
        let lid = |height: f64| {
            format!(
                r#"{{ "name": "lid", "shape": {{ "plate": {{ "size_mm": [120, 120, 10] }} }}, "at_mm": [0, 0, {height}] }}"#
            )
        };
        assert_eq!(overlapping(&pieces(&[block, &lid(105.0)])), Ok(()), "law: it lies on the rim");
        let error =
            overlapping(&pieces(&[block, &lid(104.9)])).expect_err("law: it is in the wall");
        assert!(error.to_string().contains("`box` and `lid`"), "law: both are named, {error}");
        let inside = r#"{ "name": "in", "shape": { "plate": { "size_mm": [98, 98, 10] } }, "at_mm": [0, 0, 50] }"#;
        assert_eq!(overlapping(&pieces(&[block, inside])), Ok(()), "law: inside of it is room");
    }

    #[test]
    fn plates_whose_planes_cross_stand_where_one_of_them_may() {
        let plate = |name: &str, size: &str, cross: &str| {
            format!(
                r#"{{ "name": "{name}", "shape": {{ "plate": {{ "size_mm": {size} }} }}, "at_mm": [5, 5, 0]{cross} }}"#
            )
        };
        let own = r#", "may_cross": true"#;
        let two = |one: &str, other: &str| {
            let (a, b) = (plate("a", "[10, 90, 50]", one), plate("b", "[90, 10, 50]", other));
            pieces(&[a.as_str(), b.as_str()])
        };
        let standing = |pieces: &[RigidPiece]| -> Vec<Option<Pose>> {
            pieces.iter().map(|piece| Some(piece.at)).collect()
        };
        for (one, other) in [(own, ""), ("", own), (own, own)] {
            let both = two(one, other);
            assert_eq!(overlapping(&both), Ok(()), "law: one that may is enough");
            let into = stands_in(&both, &standing(&both), 0, 0.0);
            assert_eq!(into, None, "law: nor is it one pressed into another");
        }
        let neither = two("", "");
        assert!(overlapping(&neither).is_err(), "law: neither may");
        let into = stands_in(&neither, &standing(&neither), 0, 0.0);
        assert_eq!(into, Some(1), "law: one stands in the other");
    }

    /// Law: a block 0.2 mm deep in a floor is in it by 0.2 mm, in a post that it touches not at all,
    /// and by more than 0.1 mm, not by more than 0.3 mm.
    #[test]
    fn the_depth_is_that_of_the_deepest_piece() {
        let plate = |name: &str, x: f64, z: f64| {
            format!(
                r#"{{ "name": "{name}", "shape": {{ "plate": {{ "size_mm": [20, 20, 20] }} }}, "at_mm": [{x}, 0, {z}] }}"#
            )
        };
        let texts =
            [plate("block", 0.0, 0.0), plate("post", 20.0, 0.0), plate("floor", 3.0, -19.8)];
        let three = pieces(&texts.each_ref().map(String::as_str));
        let mut at: Vec<Option<Pose>> = three.iter().map(|piece| Some(piece.at)).collect();
        let depth = depth_in_others(&three, &at, 0);
        assert!((depth - 2e-4).abs() < 1e-12, "law: 0.2 mm, got {depth} m");
        for (allowed, into) in [(0.0, Some(2)), (1e-4, Some(2)), (3e-4, None)] {
            assert_eq!(stands_in(&three, &at, 0, allowed), into, "law: by more than {allowed} m?");
        }
        at[2] = None;
        let depth = depth_in_others(&three, &at, 0);
        assert!(depth < TOUCHING, "law: in what is gone nothing stands, got {depth} m");
    }

    #[test]
    fn a_turned_piece_is_judged_as_it_stands() {
        let plate = |name: &str, x: f64, turn: f64| {
            format!(
                r#"{{ "name": "{name}", "shape": {{ "plate": {{ "size_mm": [20, 20, 20] }} }}, "at_mm": [{x}, 0, 0], "rotation_deg": [0, 0, {turn}] }}"#
            )
        };
        // Corner to face: half a diagonal and half a side.
        let touching = 10.0 + 200_f64.sqrt();
        for (x, sound) in [(touching + 0.01, true), (touching - 0.01, false)] {
            let got = overlapping(&pieces(&[&plate("a", 0.0, 0.0), &plate("b", x, 45.0)]));
            assert_eq!(got.is_ok(), sound, "law: they touch at {touching} mm, tried {x} mm");
        }
    }
}
