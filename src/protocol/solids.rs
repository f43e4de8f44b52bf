//! The space that pieces of a laboratory take.

use super::*;

/// The space that pieces take.
#[derive(Debug, Clone)]
pub(super) struct Solids {
    /// The half-spaces of each part in the frame of its piece: outward normal and offset.
    parts: Vec<Vec<Vec<(Vector, f64)>>>,
    /// Radius in m about the origin of that frame that holds the piece.
    pub(super) radii: Vec<f64>,
}

impl Solids {
    pub(super) fn of(setup: &Setup) -> Self {
        Self {
            parts: setup.pieces.iter().map(|p| p.parts.iter().map(planes).collect()).collect(),
            radii: setup.pieces.iter().map(|piece| piece.radius).collect(),
        }
    }

    /// Whether a ball is clear of every part; it may be called not clear near an edge.
    pub(super) fn is_clear(&self, centre: &Vector, radius: f64, state: &SpecimenState) -> bool {
        self.touched(centre, radius, state).next().is_none()
    }

    /// The pieces, by number, that a ball is not clear of.
    pub(super) fn touched(
        &self,
        centre: &Vector,
        radius: f64,
        state: &SpecimenState,
    ) -> impl Iterator<Item = usize> {
        let centre = Point::from(*centre);
        let present = state.pieces.iter().enumerate().filter(|(_, piece)| piece.present);
        let touches = move |(n, piece): &(usize, &PieceState)| {
            let at = piece.pose.inverse() * centre;
            at.coords.norm() <= self.radii[*n] + radius
                && self.parts[*n].iter().any(|part| depth(part, &at) >= -radius)
        };
        present.filter(touches).map(|(n, _)| n)
    }

    /// The pieces, by number, that hold a place within a part: no grain's centroid can lie there.
    pub(super) fn holding(
        &self,
        place: &Vector,
        state: &SpecimenState,
    ) -> impl Iterator<Item = usize> {
        let place = Point::from(*place);
        let present = state.pieces.iter().enumerate().filter(|(_, piece)| piece.present);
        let holds = move |(n, piece): &(usize, &PieceState)| {
            let at = piece.pose.inverse() * place;
            at.coords.norm() < self.radii[*n]
                && self.parts[*n].iter().any(|part| depth(part, &at) > 0.0)
        };
        present.filter(holds).map(|(n, _)| n)
    }
}

/// The half-spaces of a part in the frame of its piece.
fn planes(part: &Piece) -> Vec<(Vector, f64)> {
    let shape = part.shape.transformed(&part.pose);
    (0..shape.faces().len()).filter_map(|face| shape.plane(face)).collect()
}

/// How deep a point lies within half-spaces, in m; negative outside.
fn depth(planes: &[(Vector, f64)], at: &Point) -> f64 {
    planes.iter().map(|(normal, offset)| offset - normal.dot(&at.coords)).fold(f64::MAX, f64::min)
}
