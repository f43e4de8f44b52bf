//! Contacts as links between bodies, for pictures of how forces go.

use crate::specimen::{Other, Party, SavedContact};

/// Who a link leads to, where that is no grain.
const WALL: i32 = -1;
const PLATE: i32 = -2;
const FUNNEL: i32 = -3;

/// What two bodies do to each other, over all points in which they touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Link {
    /// The first is a grain; the second a grain or one of the numbers above.
    pub between: [i32; 2],
    /// Mean of the points in m.
    pub point: [f64; 3],
    /// Sum of the forces on the first in N.
    pub force: [f64; 3],
}

/// The contacts of two bodies taken together; those between pieces of the
/// apparatus are left out. They come in order of who takes part.
pub(super) fn links(contacts: &[SavedContact]) -> Vec<Link> {
    let number = |party: Party| match party {
        Party::Grain(n) => n as i32,
        Party::Other(Other::Cylinder(_) | Other::Base(_) | Other::Piece(..)) => WALL,
        Party::Other(Other::TopPlate) => PLATE,
        Party::Other(Other::Funnel(_)) => FUNNEL,
    };
    // Pieces of the cylinder are walls of one body, but each pushes its own way.
    let order = |c: &SavedContact| {
        let piece = c.between.map(|party| match party {
            Party::Other(Other::Cylinder(n) | Other::Funnel(n) | Other::Base(n)) => n,
            // Walls of one body, too; no piece has more than a thousand parts.
            Party::Other(Other::Piece(piece, part)) => 1000 * piece + part,
            _ => 0,
        });
        let parties = c.between.map(number);
        let turned = parties[0] < parties[1];
        let first_is_larger = if turned { [parties[1], parties[0]] } else { parties };
        (first_is_larger, piece[0].max(piece[1]), turned)
    };
    let mut all: Vec<_> = contacts.iter().map(|c| (order(c), c)).collect();
    all.retain(|((between, _, _), _)| between[0] >= 0);
    all.sort_by_key(|((between, piece, _), _)| (*between, *piece));
    all.chunk_by(|a, b| (a.0.0, a.0.1) == (b.0.0, b.0.1))
        .map(|points| {
            let mut link = Link { between: points[0].0.0, point: [0.0; 3], force: [0.0; 3] };
            for ((_, _, turned), contact) in points {
                let sign = if *turned { -1.0 } else { 1.0 };
                for axis in 0..3 {
                    link.point[axis] += contact.point_m[axis] / points.len() as f64;
                    link.force[axis] += sign * contact.force_n[axis];
                }
            }
            link
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;

    fn contact(between: [Party; 2], x: f64, force: f64) -> SavedContact {
        SavedContact {
            between,
            point_m: Vector::new(x, 0.0, 0.0),
            normal: Vector::z(),
            force_n: Vector::new(0.0, 0.0, force),
            warm_start: 1.0,
            feature: [0, 0],
        }
    }

    /// Law: the force of a link is the sum over its points of what acts on the
    /// first, so that a contact told the other way round counts with the other sign.
    #[test]
    fn points_of_a_pair_add_up_whichever_way_they_are_told() {
        let (a, b) = (Party::Grain(3), Party::Grain(7));
        let got = links(&[contact([b, a], 0.1, 2.0), contact([a, b], 0.3, -5.0)]);
        assert_eq!(got.len(), 1, "law: one link a pair, got {got:?}");
        assert_eq!(got[0].between, [7, 3], "law: the grain of the larger number comes first");
        assert!((got[0].point[0] - 0.2).abs() < 1e-15, "law: the mean point, got {got:?}");
        assert_eq!(got[0].force, [0.0, 0.0, 7.0], "law: 2 N and 5 N the other way round are 7 N");
    }

    #[test]
    fn walls_plate_and_funnel_come_second_and_pieces_stay_apart() {
        let grain = Party::Grain(0);
        let wall = |n| Party::Other(Other::Cylinder(n));
        let plate = Party::Other(Other::TopPlate);
        let got = links(&[
            contact([wall(4), grain], 0.0, 1.0),
            contact([grain, wall(5)], 0.0, 1.0),
            contact([plate, grain], 0.0, 3.0),
            contact([plate, wall(5)], 0.0, 9.0),
            contact([grain, Party::Other(Other::Funnel(1))], 0.0, 1.0),
        ]);
        let mut seen: Vec<_> = got.iter().map(|l| (l.between, l.force[2])).collect();
        seen.sort_by_key(|(between, force)| (between[1], *force as i64));
        let expected =
            [([0, FUNNEL], 1.0), ([0, PLATE], -3.0), ([0, WALL], -1.0), ([0, WALL], 1.0)];
        assert_eq!(seen, expected, "law: who, and the force on the grain; plate on wall is none");
    }
}
