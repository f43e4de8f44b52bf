//! Pieces of a laboratory that begin within each other.

use super::*;

/// Finds pieces that begin within each other, where neither may, as pairs of their numbers.
pub type OverlapsOf = fn(&[PieceSpec]) -> Vec<[usize; 2]>;

/// The faults of such pieces of a document, each at the place of the later one. Pieces that have
/// faults of their own are not looked at.
pub(super) fn faults(document: &Document, overlaps: OverlapsOf, known: &[Fault]) -> Vec<Fault> {
    if known.iter().any(|fault| fault.path.starts_with("pieces")) {
        return Vec::new();
    }
    let pieces: Vec<PieceSpec> = read(field(&document.value, "/pieces")).unwrap_or_default();
    let fault = |[one, other]: [usize; 2]| {
        let message =
            format!("the pieces `{}` and `{}` overlap", pieces[one].name, pieces[other].name);
        let allowed = "a place where they touch or stand apart, or `may_cross` of one of them";
        let found = format!("{:?}", pieces[other].at_mm);
        let path = format!("pieces[{other}].at_mm");
        document.with_origin(Fault::new(message, found, allowed).at(path))
    };
    overlaps(&pieces).into_iter().map(fault).collect()
}
