//! Pieces of a laboratory that begin within each other.

use super::*;

/// Finds pieces that begin within each other, where neither may, as pairs of their numbers.
pub type OverlapsOf = fn(&[PieceSpec]) -> Vec<[usize; 2]>;

/// The faults of such pieces of a document, each at the place of the later one. Pieces of which it is
/// not known where they stand, for faults of their own, are not looked at.
pub(super) fn faults(document: &Document, overlaps: OverlapsOf, known: &[Fault]) -> Vec<Fault> {
    if known.iter().any(|fault| fault.path == "pieces") {
        return Vec::new();
    }
    let says_nothing_of_place = |field: &str| matches!(field, ".name" | ".friction");
    let is_sound = |n: usize| {
        let own = format!("pieces[{n}]");
        let mut of_piece = known.iter().filter_map(|fault| fault.path.strip_prefix(&own));
        of_piece.all(says_nothing_of_place)
    };
    let all = elements(&document.value, "pieces").map(read::<PieceSpec>).enumerate();
    let sound = all.filter_map(|(n, piece)| Some((n, piece.filter(|_| is_sound(n))?)));
    let (numbers, pieces): (Vec<usize>, Vec<PieceSpec>) = sound.unzip();
    let fault = |[one, other]: [usize; 2]| {
        let message =
            format!("the pieces `{}` and `{}` overlap", pieces[one].name, pieces[other].name);
        let allowed = "a place where they touch or stand apart, or `may_cross` of one of them";
        let found = format!("{:?}", pieces[other].at_mm);
        let path = format!("pieces[{}].at_mm", numbers[other]);
        document.with_origin(Fault::new(message, found, allowed).at(path))
    };
    overlaps(&pieces).into_iter().map(fault).collect()
}
