//! What is seen of a packing of polyhedra from the side: faces in the order in
//! which a painter lays them on.

use crate::{
    geometry::{ConvexPolyhedron, Pose, Vector},
    measure::height_cell,
    specimen::Specimen,
};

/// Side of the cells in which it is noted what is hidden, in cells of a height map.
const CELL: f64 = 0.5;

/// A face turned towards the viewer.
#[derive(Debug, Clone, PartialEq)]
pub struct Facet {
    /// Corners as seen: x to the right, z upwards, in m.
    pub corners: Vec<(f64, f64)>,
    /// Outward unit normal.
    pub normal: Vector,
    /// Whether it belongs to a grain fixed to the base.
    pub fixed: bool,
}

/// The faces of all grains that are seen along y, from the farthest grain to
/// the nearest. Grains wholly behind others are left out.
pub fn facets(specimen: &Specimen) -> Vec<Facet> {
    let grains = &specimen.grains.grains;
    let state = &specimen.state;
    let free = specimen.present().map(|i| (&*grains[i].shape, state.bodies[i].body.pose, false));
    let fixed = state.base.iter().flat_map(|base| &base.fixed_grains);
    let fixed = fixed.map(|f| (&*grains[f.grain].shape, f.pose, true));
    let mut bodies: Vec<(&ConvexPolyhedron, Pose, bool)> = free.chain(fixed).collect();
    // The viewer stands at y = −∞: the nearest first.
    bodies.sort_by(|a, b| a.1.translation.y.total_cmp(&b.1.translation.y));
    let mut covered = Cover::over(&bodies, CELL * height_cell(&specimen.grains));
    let mut seen: Vec<Vec<Facet>> = Vec::new();
    for (shape, pose, fixed) in bodies {
        let faces = towards_viewer(shape, &pose, fixed);
        if covered.lay(&faces) {
            seen.push(faces);
        }
    }
    seen.into_iter().rev().flatten().collect()
}

fn towards_viewer(shape: &ConvexPolyhedron, pose: &Pose, fixed: bool) -> Vec<Facet> {
    let corners = |face: &Vec<u32>| {
        let at = |&c: &u32| pose * shape.vertices()[c as usize];
        face.iter().map(at).map(|p| (p.x, p.z)).collect()
    };
    shape
        .faces()
        .iter()
        .enumerate()
        .filter_map(|(n, face)| {
            let normal = pose.rotation * shape.plane(n)?.0;
            (normal.y < 0.0).then(|| Facet { corners: corners(face), normal, fixed })
        })
        .collect()
}

/// Cells of the picture that something nearer covers.
struct Cover {
    /// Side of a cell in m.
    cell: f64,
    low: (f64, f64),
    width: usize,
    cells: Vec<bool>,
}

impl Cover {
    fn over(bodies: &[(&ConvexPolyhedron, Pose, bool)], cell: f64) -> Self {
        let ends = bodies.iter().map(|(shape, pose, _)| {
            let (r, t) = (shape.radius_about_origin(), pose.translation.vector);
            [t.x - r, t.z - r, t.x + r, t.z + r]
        });
        let start = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        let [x0, z0, x1, z1] = ends
            .fold(start, |a, b| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]);
        let cells = |length: f64| (length.max(0.0) / cell) as usize + 1;
        let (width, height) = (cells(x1 - x0), cells(z1 - z0));
        Self { cell, low: (x0, z0), width, cells: vec![false; width * height] }
    }

    /// Covers what the faces cover; says whether any of it was seen before.
    fn lay(&mut self, faces: &[Facet]) -> bool {
        let mut seen = false;
        for facet in faces {
            let zs = facet.corners.iter().map(|c| c.1);
            let low = zs.clone().fold(f64::INFINITY, f64::min);
            let high = zs.fold(f64::NEG_INFINITY, f64::max);
            let rows = ((low - self.low.1) / self.cell) as usize
                ..=((high - self.low.1) / self.cell) as usize;
            for row in rows {
                let z = self.low.1 + (row as f64 + 0.5) * self.cell;
                let Some((from, to)) = span(&facet.corners, z) else { continue };
                // Cells whose centres lie in the face.
                let first = ((from - self.low.0) / self.cell - 0.5).ceil().max(0.0) as usize;
                let end = ((to - self.low.0) / self.cell + 0.5).floor().max(0.0) as usize;
                for column in first..end.min(self.width) {
                    if let Some(cell) = self.cells.get_mut(row * self.width + column) {
                        seen |= !*cell;
                        *cell = true;
                    }
                }
            }
        }
        seen
    }
}

/// From where to where a convex outline reaches at a height.
fn span(corners: &[(f64, f64)], z: f64) -> Option<(f64, f64)> {
    let mut found: Option<(f64, f64)> = None;
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if (a.1 <= z) != (b.1 <= z) {
            let x = a.0 + (b.0 - a.0) * (z - a.1) / (b.1 - a.1);
            found = Some(found.map_or((x, x), |(l, h)| (l.min(x), h.max(x))));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{
        grains::{Grain, GrainSet},
        specimen::{Fate, SpecimenState},
    };

    /// Cubes of 10 mm at places in m.
    fn cubes(places: &[(f64, f64, f64)]) -> Specimen {
        let cube = Arc::new(ConvexPolyhedron::cuboid(Vector::repeat(0.01)).expect("a cube"));
        let grain = Grain {
            shape: cube,
            pose_in_block: Pose::identity(),
            volume: 1e-6,
            mass: 2.7e-3,
            inertia: Vector::repeat(4.5e-8),
            equivalent_diameter: 0.0124,
            fraction: 0,
        };
        let grains = vec![grain; places.len()];
        let mut state = SpecimenState::before_everything(places.len());
        for (body, p) in state.bodies.iter_mut().zip(places) {
            body.body.pose = Pose::translation(p.0, p.1, p.2);
        }
        let set = GrainSet { grains, blocks: vec![], density: 2700.0, meshes: vec![] };
        Specimen { grains: Arc::new(set), state }
    }

    #[test]
    fn the_nearest_is_painted_last_and_the_hidden_not_at_all() {
        // Far and aside, near, and right behind the near one.
        let mut specimen = cubes(&[(0.005, 0.1, 0.0), (0.0, -0.1, 0.0), (0.0, 0.0, 0.0)]);
        let seen = facets(&specimen);
        assert_eq!(seen.len(), 2, "law: the front faces of two cubes, got {seen:?}");
        let left = |f: &Facet| f.corners.iter().map(|c| c.0).fold(f64::INFINITY, f64::min);
        assert!((left(&seen[0]) - 0.0).abs() < 1e-12, "law: the far one first: {seen:?}");
        assert!((left(&seen[1]) + 0.005).abs() < 1e-12, "law: the near one last: {seen:?}");
        assert!((seen[0].normal.y + 1.0).abs() < 1e-12, "law: faces look at the viewer");
        // Without the near one, that behind it is seen.
        specimen.state.bodies[1].fate = Fate::Spilled;
        assert_eq!(facets(&specimen).len(), 2, "law: what nothing hides is seen");
        specimen.state.bodies[2].fate = Fate::Spilled;
        assert_eq!(facets(&specimen).len(), 1, "law: what is gone is not seen");
    }
}
