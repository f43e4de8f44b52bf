//! Void ratio within a box, exact: grains that reach over its sides count with what lies inside.

use super::*;

impl Region {
    /// Volume in m³ of the part of a solid that lies in it.
    pub fn volume_of(&self, shape: &ConvexPolyhedron, pose: &Pose) -> f64 {
        let corners = corners_at(shape, pose);
        let inside = |c: &Vector| (0..3).all(|k| self.low[k] <= c[k] && c[k] <= self.high[k]);
        if corners.iter().all(inside) {
            return shape.signed_volume();
        }
        let beyond = |k: usize| {
            corners.iter().all(|c| c[k] >= self.high[k])
                || corners.iter().all(|c| c[k] <= self.low[k])
        };
        if (0..3).any(beyond) {
            return 0.0;
        }
        let mut faces = faces_at(shape, &corners);
        for k in 0..3 {
            for (sign, offset) in [(1.0, self.high[k]), (-1.0, -self.low[k])] {
                let onto = |p: &mut Vector| p[k] = sign * offset;
                faces = cut(faces, |p| sign * p[k] - offset, onto);
            }
        }
        // About a corner of the region, near enough for rounding.
        volume(&faces, &self.low)
    }
}

/// The vertices of a shape at a pose, in m. Those of the mesh of a sphere or a rounded polyhedron are
/// enlarged about its middle to its volume, a sphere's by 1.2 % of its radius: what is found of a part
/// differs from the sphere's by less than 0.1 % of the whole.
pub(super) fn corners_at(shape: &ConvexPolyhedron, pose: &Pose) -> Vec<Vector> {
    let vertices = shape.vertices().iter();
    let centre = match (shape.sphere(), shape.rounded()) {
        (Some(sphere), _) => sphere.centre,
        (None, Some(_)) => MassProperties::of(shape).centroid,
        (None, None) => return vertices.map(|v| (pose * v).coords).collect(),
    };
    let bare: Vec<Vector> = vertices.map(|v| v.coords).collect();
    let of_mesh = volume(&faces_at(shape, &bare), &centre.coords);
    let larger = (shape.signed_volume() / of_mesh).cbrt();
    bare.iter().map(|v| (pose * (centre + (v - centre.coords) * larger)).coords).collect()
}

/// Corners of the faces of a solid whose corners are where they are.
pub(super) fn faces_at(shape: &ConvexPolyhedron, corners: &[Vector]) -> Vec<Vec<Vector>> {
    let faces = shape.faces().iter();
    faces.map(|face| face.iter().map(|&c| corners[c as usize]).collect()).collect()
}

/// Volume within a closed surface of flat faces, by the divergence theorem about a point.
pub(super) fn volume(faces: &[Vec<Vector>], about: &Vector) -> f64 {
    let triple =
        |a: &Vector, b: &Vector, c: &Vector| (a - about).dot(&(b - about).cross(&(c - about)));
    let fans = faces
        .iter()
        .flat_map(|f| (1..f.len().max(2) - 1).map(move |i| triple(&f[0], &f[i], &f[i + 1])));
    fans.sum::<f64>() / 6.0
}

/// Void ratio e = V/Vₛ − 1 of the grains present within a region; `None` where no grain is.
pub fn void_ratio_in(specimen: &Specimen, region: &Region) -> Option<f64> {
    let part = |i: usize| {
        let (shape, pose) = specimen.placed(i);
        region.volume_of(shape, pose)
    };
    let solids: f64 = specimen.present().map(part).sum();
    // What is left of rounding is no grain.
    (solids > 1e-9 * region.volume()).then(|| region.volume() / solids - 1.0)
}

/// The box of a region over which its grains reach, none of them further; `None` where no grain is.
pub fn grains_span(specimen: &Specimen, region: &Region) -> Option<Region> {
    let corners = |i: usize| {
        let (shape, pose) = specimen.placed(i);
        (region.volume_of(shape, pose) > 0.0).then(|| corners_at(shape, pose))
    };
    let corners = specimen.present().filter_map(corners).flatten();
    let about = corners
        .map(|corner| Region { low: corner, high: corner })
        .reduce(|a, b| Region { low: a.low.inf(&b.low), high: a.high.sup(&b.high) })?;
    Some(Region { low: about.low.sup(&region.low), high: about.high.inf(&region.high) })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_near, cube, random, random_pose, specimen_of};
    use super::*;

    const UNIT: Region =
        Region { low: Vector::new(0.0, 0.0, 0.0), high: Vector::new(1.0, 1.0, 1.0) };

    #[test]
    fn a_cube_at_a_corner_an_edge_and_a_side_is_cut_as_it_should() {
        for (at, expected) in [
            ([0.5, 0.5, 0.5], 0.064),
            ([0.0, 0.5, 0.5], 0.032),
            ([0.0, 0.0, 0.5], 0.016),
            ([0.0, 0.0, 0.0], 0.008),
            ([1.0, 1.0, 1.0], 0.008),
            ([1.2, 0.5, 0.5], 0.0),
            ([3.0, 0.5, 0.5], 0.0),
            ([0.9, 0.5, 0.5], 0.048),
        ] {
            let pose = Pose::translation(at[0], at[1], at[2]);
            let got = UNIT.volume_of(&cube(0.4), &pose);
            assert_near("what lies inside of a cube of side 0.4", expected, got, 1e-15);
        }
    }

    /// Law: the parts of a solid in boxes that fill space are the solid.
    #[test]
    fn turned_solids_lose_nothing_between_boxes() {
        let mut rng = random(3);
        let shape = ConvexPolyhedron::cuboid(Vector::new(0.5, 0.8, 1.1)).expect("a block");
        for _ in 0..50 {
            let pose = random_pose(&mut rng, 0.4);
            let mut sum = 0.0;
            for n in 0..64_u32 {
                let low = Vector::new(f64::from(n % 4), f64::from(n / 4 % 4), f64::from(n / 16))
                    - Vector::repeat(2.0);
                sum += Region { low, high: low + Vector::repeat(1.0) }.volume_of(&shape, &pose);
            }
            assert_near("volume of all parts", 0.44, sum, 1e-12);
        }
    }

    #[test]
    fn grains_span_a_box_of_those_inside() {
        let grains = vec![
            (cube(0.2), Pose::translation(0.5, 0.5, 0.4)),
            (cube(0.2), Pose::translation(3.0, 0.5, 0.8)),
        ];
        let mut specimen = specimen_of(grains);
        let got = grains_span(&specimen, &UNIT).expect("a grain is inside");
        for (law, expected, got) in [
            ("top of the cube inside", 0.5, got.high.z),
            ("its bottom", 0.3, got.low.z),
            ("its side", 0.6, got.high.x),
            ("the other", 0.4, got.low.x),
        ] {
            assert_near(law, expected, got, 1e-15);
        }
        let low = Region { high: Vector::new(1.0, 1.0, 0.45), ..UNIT };
        let got = grains_span(&specimen, &low).map(|span| span.high.z);
        assert_eq!(got, Some(0.45), "law: no higher than the region");
        specimen = specimen_of(vec![(cube(0.2), Pose::translation(3.0, 0.5, 0.8))]);
        assert_eq!(grains_span(&specimen, &UNIT), None, "law: no grain, no box");
    }

    #[test]
    fn a_lattice_of_cubes_has_its_void_ratio() {
        let grains = (0..27_u32).map(|n| {
            let k = |m: u32| 0.02 * f64::from(n / m % 3);
            (cube(0.01), Pose::translation(k(1), k(3), k(9)))
        });
        let specimen = specimen_of(grains.collect());
        // Between the middles of the outer cubes: eight cells of (20 mm)³ with 1 cm³ each.
        let region = Region { low: Vector::zeros(), high: Vector::repeat(0.04) };
        let got = void_ratio_in(&specimen, &region).expect("a void ratio");
        assert_near("e = 8/1 − 1", 7.0, got, 1e-9);
        let empty = Region { low: Vector::repeat(1.0), high: Vector::repeat(2.0) };
        assert_eq!(void_ratio_in(&specimen, &empty), None, "law: no solids, no ratio");
    }
}
