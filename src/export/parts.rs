//! The apparatus as parts that move as one: cylinder wall, floor, funnel, lid,
//! top plate and a pile's base.

use std::collections::HashMap;

use super::*;
use crate::geometry::Point;
use crate::specimen::Base;

/// What a part is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartKind {
    /// The wall of the cylinder; it goes with the table.
    CylinderWall,
    /// Its floor.
    Floor,
    /// The funnel.
    Funnel,
    /// The lid under the funnel.
    Lid,
    /// The top plate.
    TopPlate,
    /// The floor under a pile with the grains fixed to it.
    Base,
    /// A piece of a laboratory, by its number.
    Piece(usize),
}

/// A part with its surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// What it is.
    pub kind: PartKind,
    /// Its name in files.
    pub name: String,
    /// The outer surface: polygons, counter-clockwise seen from outside, in m
    /// in the part's own frame. Faces where pieces of a wall meet are left out.
    pub faces: Vec<Vec<Point>>,
}

impl Part {
    /// Where its frame was; none where the part did not stand.
    pub fn pose(&self, frame: &Frame) -> Option<Pose> {
        let on_the_table = || Pose::translation(frame.table_x, 0.0, 0.0);
        match self.kind {
            PartKind::CylinderWall | PartKind::Floor => frame.cylinder.then(on_the_table),
            PartKind::Funnel => Some(Pose::translation(0.0, 0.0, frame.funnel?.opening_height)),
            PartKind::Lid => {
                let funnel = frame.funnel.filter(|f| f.lid)?;
                Some(Pose::translation(0.0, 0.0, funnel.opening_height))
            }
            PartKind::TopPlate => frame.top_plate,
            PartKind::Base => frame.base.is_some().then(Pose::identity),
            PartKind::Piece(n) => frame.pieces.get(n).copied().flatten(),
        }
    }
}

/// Every part of a laboratory, and the base of a pile where there is one. The
/// collar that funnels have while they are filled is left out.
///
/// # Errors
/// When the dimensions of the funnel or of the base make none.
pub fn parts(
    setup: &Setup,
    grains: &GrainSet,
    base: Option<&Base>,
) -> Result<Vec<Part>, ApparatusError> {
    let (floor, wall) = match setup.cylinder.pieces.split_last() {
        Some((floor, wall)) => (std::slice::from_ref(floor), wall),
        None => (&[][..], &[][..]),
    };
    let funnel = Funnel::new(&setup.funnel, 0.0, 0.0)?;
    let plate = Piece { shape: setup.plate.shape.clone(), pose: Pose::identity() };
    let part = |name: &str, kind: PartKind, pieces: &[Piece]| Part {
        kind,
        name: name.to_owned(),
        faces: surface(pieces),
    };
    if !setup.pieces.is_empty() {
        let pieces = setup.pieces.iter().enumerate();
        let pieces = pieces.map(|(n, piece)| part(&piece.name, PartKind::Piece(n), &piece.parts));
        return Ok(pieces.collect());
    }
    let mut found = vec![
        part("cylinder", PartKind::CylinderWall, wall),
        part("floor", PartKind::Floor, floor),
        part("funnel", PartKind::Funnel, &funnel.pieces),
        part("lid", PartKind::Lid, &[funnel.lid]),
        part("top_plate", PartKind::TopPlate, &[plate]),
    ];
    if base.is_some() {
        let pieces: Vec<Piece> =
            base_pieces(grains, base)?.into_iter().map(|(piece, _)| piece).collect();
        found.push(part("base", PartKind::Base, &pieces));
    }
    Ok(found)
}

pub(super) fn corners<'a>(
    shape: &'a ConvexPolyhedron,
    face: &'a [u32],
    pose: &'a Pose,
) -> impl Iterator<Item = Point> + 'a {
    face.iter().map(move |&v| pose * shape.vertices()[v as usize])
}

/// The faces of pieces that stand side by side, without those that two share.
fn surface(pieces: &[Piece]) -> Vec<Vec<Point>> {
    let all: Vec<Vec<Point>> = pieces
        .iter()
        .flat_map(|p| p.shape.faces().iter().map(|f| corners(&p.shape, f, &p.pose).collect()))
        .collect();
    let mut met: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (n, face) in all.iter().enumerate() {
        met.entry(middle(face)).or_default().push(n);
    }
    // A post on the middle of a plinth: two faces have one middle, and neither is the other.
    let is_shared = |n: usize| {
        let mut others = met[&middle(&all[n])].iter().filter(|&&other| other != n);
        others.any(|&other| are_one(&all[n], &all[other]))
    };
    let shared: Vec<bool> = (0..all.len()).map(is_shared).collect();
    let kept = all.into_iter().zip(shared).filter(|(_, shared)| !shared);
    kept.map(|(face, _)| face).collect()
}

/// Whether two faces have the same corners within rounding.
fn are_one(one: &[Point], other: &[Point]) -> bool {
    let is_corner = |p: &Point| other.iter().any(|q| (p - q).norm() < ROUNDING);
    one.len() == other.len() && one.iter().all(is_corner)
}

/// Corners that are less than this apart, in m, are one.
const ROUNDING: f64 = 1e-6;

/// The mean corner in µm: pieces that meet have it within rounding.
fn middle(face: &[Point]) -> [i64; 3] {
    let sum = face.iter().fold([0.0; 3], |s, p| [s[0] + p.x, s[1] + p.y, s[2] + p.z]);
    sum.map(|x| (x / face.len() as f64 * 1e6).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{export::testing, geometry::volume_of_loops, measure::testing::assert_near};

    /// Law: leaving out what two pieces share leaves a closed surface, which
    /// encloses the volume of the pieces.
    #[test]
    fn surfaces_are_closed_without_their_inner_faces() {
        let moments = testing::moments(&[3], 0.08);
        let setup = &moments.setup;
        let parts = &moments.parts;
        let wall = &parts[0];
        let pieces = setup.cylinder.pieces.len() - 1;
        assert_eq!(wall.faces.len(), 4 * pieces, "law: in, out, below and above of each piece");
        let expected: f64 =
            setup.cylinder.pieces[..pieces].iter().map(|p| p.shape.signed_volume()).sum();
        let got = volume_of_loops(&wall.faces, |p| p.coords);
        assert_near("volume of the wall in m³", expected, got, 1e-9 * expected);
        let plate = parts.last().expect("a top plate");
        assert_eq!(plate.faces.len(), setup.plate.shape.faces().len(), "law: one piece, all faces");
    }

    /// Law: two faces with one middle are left out where they have the same corners alone.
    #[test]
    fn faces_of_two_sizes_that_meet_in_their_middles_stay() {
        let block = |[x, y, z]: [f64; 3], height: f64| Piece {
            shape: Arc::new(ConvexPolyhedron::cuboid(Vector::new(x, y, z)).expect("a block")),
            pose: Pose::translation(0.0, 0.0, height),
        };
        let plinth = || block([0.1, 0.1, 0.02], -0.01);
        let post = surface(&[plinth(), block([0.04, 0.04, 0.06], 0.03)]);
        assert_eq!(post.len(), 12, "law: a post hides no face of its plinth");
        let column = surface(&[plinth(), block([0.1, 0.1, 0.06], 0.03)]);
        assert_eq!(column.len(), 10, "law: two blocks of one width share a face");
    }

    #[test]
    fn parts_stand_where_the_frame_has_them() {
        let moments = testing::moments(&[3], 0.08);
        let mut frame = moments.stages[0].frames[1].clone();
        let at = |kind, frame: &Frame| {
            Part { kind, name: String::new(), faces: Vec::new() }
                .pose(frame)
                .map(|pose| pose.translation.vector)
        };
        frame.table_x = 0.02;
        frame.funnel = None;
        assert_eq!(at(PartKind::Floor, &frame).map(|p| p.x), Some(0.02), "law: with the table");
        assert_eq!(at(PartKind::Funnel, &frame), None, "law: it was taken away");
        frame.funnel = Some(crate::specimen::FunnelState { opening_height: 0.25, lid: false });
        assert_eq!(at(PartKind::Funnel, &frame).map(|p| p.z), Some(0.25), "law: its height");
        assert_eq!(at(PartKind::Lid, &frame), None, "law: the lid is open");
    }
}
