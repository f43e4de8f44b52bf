//! Which corners of a face contacts are clipped against.
//!
//! Parry's clipping knows polygons of up to four corners. Of a larger face of a polyhedron it takes
//! the first four it has stored (`ConvexPolyhedron::local_support_feature`, 0.31, with a note that
//! these should be better chosen): a sliver of a round floor, and often half the face of a grain.
//! What rests on the rest of the face is held by the deepest point alone, and rocks on it for ever.
//! Here the four corners are chosen to span the face. All else is parry's: rapier lets a world be
//! given another dispatcher, and parry's manifold takes any shape that names its features.

use rapier3d_f64::{
    geometry::ContactManifoldData,
    math::{Pose, Real, Vector},
    parry::{
        query::{
            ClosestPoints, Contact, ContactManifold, ContactManifoldsWorkspace,
            DefaultQueryDispatcher, NonlinearRigidMotion, PersistentQueryDispatcher,
            QueryDispatcher, ShapeCastHit, ShapeCastOptions, ShapeDistance, ShapeIntersection,
            Unsupported,
            details::{NormalConstraints, contact_manifold_pfm_pfm},
        },
        shape::{
            ConvexPolyhedron, PackedFeatureId, PolygonalFeature, PolygonalFeatureMap, Shape,
            SupportMap,
        },
    },
    prelude::ContactData,
};

/// Most corners of a face that counts as a grain's: its four are chosen once
/// for all by size. A rounder one, of a floor or a plate, is much larger than
/// what lies on it, and its four are turned towards the contact.
const MOST_CORNERS_OF_GRAINS: usize = 12;

/// Directions in which the four corners of a round face are turned: few, so
/// that a contact that shifts a little keeps its corners.
const TURNS: usize = 16;

/// A polyhedron with its faces as four corners that span them.
struct Spanned<'a>(&'a ConvexPolyhedron);

impl SupportMap for Spanned<'_> {
    fn local_support_point(&self, direction: Vector) -> Vector {
        self.0.local_support_point(direction)
    }
}

impl PolygonalFeatureMap for Spanned<'_> {
    fn local_support_feature(&self, direction: Vector, out: &mut PolygonalFeature) {
        self.local_support_feature_toward(direction, Vector::ZERO, out);
    }

    fn local_support_feature_toward(
        &self,
        direction: Vector,
        near: Vector,
        out: &mut PolygonalFeature,
    ) {
        let polyhedron = self.0;
        let faces = polyhedron.faces();
        // The face most against the other body.
        let (mut best, mut most) = (0, faces[0].normal.dot(direction));
        for (index, face) in faces.iter().enumerate().skip(1) {
            let along = face.normal.dot(direction);
            if along > most {
                (best, most) = (index, along);
            }
        }
        let first = faces[best].first_vertex_or_edge as usize;
        let count = faces[best].num_vertices_or_edges as usize;
        let corners = &polyhedron.vertices_adj_to_face()[first..first + count];
        let edges = &polyhedron.edges_adj_to_face()[first..first + count];
        let place = |i: usize| polyhedron.points()[corners[i] as usize];
        let (chosen, number) = spanning(count, place, near);
        for (slot, &i) in chosen[..number].iter().enumerate() {
            out.vertices[slot] = place(i);
            out.vids[slot] = PackedFeatureId::vertex(corners[i]);
            out.eids[slot] = PackedFeatureId::edge(edges[i]);
        }
        out.fid = PackedFeatureId::face(best as u32);
        out.num_vertices = number;
    }

    fn is_convex_polyhedron(&self) -> bool {
        true
    }
}

/// Up to four corners of a convex polygon, in its order, that span most of it,
/// and how many they are.
fn spanning(count: usize, place: impl Fn(usize) -> Vector, near: Vector) -> ([usize; 4], usize) {
    if count <= 4 {
        return ([0, 1, 2, 3], count);
    }
    if count > MOST_CORNERS_OF_GRAINS {
        let distance = |&i: &usize| (place(i) - near).length_squared();
        let step = count.div_ceil(TURNS);
        let nearest = (0..count)
            .step_by(step)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(0);
        let mut chosen = [0, 1, 2, 3].map(|quarter| (nearest + quarter * count / 4) % count);
        chosen.sort_unstable();
        return (chosen, 4);
    }
    // The corner that cuts off least is dropped, until four are left.
    let mut kept: [usize; MOST_CORNERS_OF_GRAINS] = std::array::from_fn(|i| i);
    let mut left = count;
    while left > 4 {
        let cut_off = |i: usize| {
            let (before, at, after) = (kept[(i + left - 1) % left], kept[i], kept[(i + 1) % left]);
            (place(before) - place(at)).cross(place(after) - place(at)).length_squared()
        };
        let least = (0..left).min_by(|&a, &b| cut_off(a).total_cmp(&cut_off(b))).unwrap_or(0);
        kept.copy_within(least + 1..left, least);
        left -= 1;
    }
    ([kept[0], kept[1], kept[2], kept[3]], 4)
}

/// A polyhedron, or the core of a rounded one, and the radius of its ball.
pub(super) fn polyhedron(shape: &dyn Shape) -> Option<(&ConvexPolyhedron, Real)> {
    match shape.as_round_convex_polyhedron() {
        Some(round) => Some((&round.inner_shape, round.border_radius)),
        None => Some((shape.as_convex_polyhedron()?, 0.0)),
    }
}

/// Parry's dispatcher, but for the manifolds of two polyhedra, rounded or not.
pub(super) fn spanned_faces() -> impl PersistentQueryDispatcher<ContactManifoldData, ContactData> {
    SpannedFaces.chain(DefaultQueryDispatcher)
}

/// Knows the manifolds of two polyhedra, and nothing else.
struct SpannedFaces;

type Manifold = ContactManifold<ContactManifoldData, ContactData>;
type Answer<T> = Result<T, Unsupported>;

impl PersistentQueryDispatcher<ContactManifoldData, ContactData> for SpannedFaces {
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        shape1: &dyn Shape,
        shape2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<Manifold>,
        _: &mut Option<ContactManifoldsWorkspace>,
    ) -> Answer<()> {
        if polyhedron(shape1).is_none() || polyhedron(shape2).is_none() {
            return Err(Unsupported);
        }
        if manifolds.is_empty() {
            manifolds.push(ContactManifold::new());
        }
        let manifold = &mut manifolds[0];
        self.contact_manifold_convex_convex(pos12, shape1, shape2, None, None, prediction, manifold)
    }

    fn contact_manifold_convex_convex(
        &self,
        pos12: &Pose,
        shape1: &dyn Shape,
        shape2: &dyn Shape,
        constraints1: Option<&dyn NormalConstraints>,
        constraints2: Option<&dyn NormalConstraints>,
        prediction: Real,
        manifold: &mut Manifold,
    ) -> Answer<()> {
        let (first, radius1) = polyhedron(shape1).ok_or(Unsupported)?;
        let (second, radius2) = polyhedron(shape2).ok_or(Unsupported)?;
        contact_manifold_pfm_pfm(
            pos12,
            &Spanned(first),
            radius1,
            constraints1,
            &Spanned(second),
            radius2,
            constraints2,
            prediction,
            manifold,
        );
        Ok(())
    }
}

impl QueryDispatcher for SpannedFaces {
    fn intersection_test(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
    ) -> Answer<ShapeIntersection> {
        Err(Unsupported)
    }

    fn distance(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape) -> Answer<ShapeDistance> {
        Err(Unsupported)
    }

    fn contact(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape, _: Real) -> Answer<Option<Contact>> {
        Err(Unsupported)
    }

    fn closest_points(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
        _: Real,
    ) -> Answer<ClosestPoints> {
        Err(Unsupported)
    }

    fn cast_shapes(
        &self,
        _: &Pose,
        _: Vector,
        _: &dyn Shape,
        _: &dyn Shape,
        _: ShapeCastOptions,
    ) -> Answer<Option<ShapeCastHit>> {
        Err(Unsupported)
    }

    fn cast_shapes_nonlinear(
        &self,
        _: &NonlinearRigidMotion,
        _: &dyn Shape,
        _: &NonlinearRigidMotion,
        _: &dyn Shape,
        _: Real,
        _: Real,
        _: bool,
    ) -> Answer<Option<ShapeCastHit>> {
        Err(Unsupported)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn regular(count: usize) -> impl Fn(usize) -> Vector {
        move |i| {
            let angle = std::f64::consts::TAU * i as f64 / count as f64;
            Vector::new(angle.cos(), angle.sin(), 0.0)
        }
    }

    fn area(corners: &[Vector]) -> f64 {
        let fan = corners[1..].windows(2);
        fan.map(|w| (w[0] - corners[0]).cross(w[1] - corners[0]).length() / 2.0).sum()
    }

    #[test]
    fn four_corners_span_most_of_a_face() {
        for count in 3..=60 {
            let place = regular(count);
            for near in [Vector::ZERO, place(1) * 0.9, place(count - 1) * 0.5] {
                let (chosen, number) = spanning(count, &place, near);
                assert_eq!(number, count.min(4));
                assert!(
                    chosen[..number].windows(2).all(|w| w[0] < w[1]),
                    "corners of {count} in their order: {chosen:?}"
                );
                let spanned: Vec<Vector> = chosen[..number].iter().map(|&i| place(i)).collect();
                let whole: Vec<Vector> = (0..count).map(&place).collect();
                let share = area(&spanned) / area(&whole);
                // The square in a circle has 2/π = 0.637 of it; parry's first
                // four corners of 48 have 0.003.
                assert!(share > 0.6, "of {count} corners, four span {share}, expected over 0.6");
            }
        }
    }

    #[test]
    fn a_long_face_keeps_its_ends() {
        // A sliver with many corners at one end.
        let points = [(0.0, 0.0), (9.7, 0.0), (9.9, 0.1), (10.0, 0.3), (9.9, 0.6), (0.0, 1.0)];
        let place = |i: usize| Vector::new(points[i].0, points[i].1, 0.0);
        let (chosen, number) = spanning(points.len(), place, Vector::ZERO);
        let spanned: Vec<Vector> = chosen[..number].iter().map(|&i| place(i)).collect();
        let whole: Vec<Vector> = (0..points.len()).map(place).collect();
        let share = area(&spanned) / area(&whole);
        assert!(share > 0.95, "the four span {share} of the face, expected over 0.95");
    }

    #[test]
    fn corners_do_not_change_with_a_small_shift() {
        let place = regular(48);
        let near = place(3) * 0.8 + place(4) * 0.1;
        let (before, _) = spanning(48, &place, near);
        let (after, _) = spanning(48, &place, near + place(10) * 0.01);
        assert_eq!(before, after, "law: a shift of a hundredth keeps the corners");
    }
}
