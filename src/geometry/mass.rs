//! Exact mass properties of polyhedra.

use nalgebra::{Matrix3, SymmetricEigen, UnitQuaternion};

use super::{
    ConvexPolyhedron, Point, Pose, Rounded, Vector,
    convex::mean,
    moments::{Moments, add_swept},
};

/// Volume, centroid and inertia of a homogeneous polyhedron.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassProperties {
    /// Volume in cubic metres.
    pub volume: f64,
    /// Centre of mass in metres, in the coordinates of the polyhedron.
    pub centroid: Point,
    /// Inertia tensor about the centroid for a density of 1 kg/m³, axes
    /// parallel to those of the polyhedron, in m⁵; times the density it is in kg m².
    pub inertia_per_density: Matrix3<f64>,
}

/// The frame in which a body's inertia tensor is diagonal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrincipalFrame {
    /// Maps principal coordinates (origin at the centroid) to the polyhedron's coordinates.
    pub pose: Pose,
    /// Principal moments for a density of 1 kg/m³, in m⁵, ascending.
    pub moments_per_density: Vector,
}

impl MassProperties {
    /// Integrates exactly over the tetrahedra that the surface triangles span with an inner point.
    ///
    /// The second moments of a tetrahedron with one corner at the origin and corners a, b, c are
    /// V/20 · (Σ xᵢxᵢᵀ + s sᵀ), s = a + b + c: the canonical covariance of Blow and Binstock, "How
    /// to find the inertia tensor of a polyhedron" (2004); it agrees with Mirtich, "Fast and
    /// accurate computation of polyhedral mass properties" (1996).
    ///
    /// Of a sphere 4/3 π r³ and 2/5 V r²; of a rounded polyhedron with its prisms and sectors.
    pub fn of(polyhedron: &ConvexPolyhedron) -> Self {
        if let Some(sphere) = polyhedron.sphere() {
            let volume = sphere.volume();
            let moment = 0.4 * volume * sphere.radius * sphere.radius;
            return Self {
                volume,
                centroid: sphere.centre,
                inertia_per_density: Matrix3::identity() * moment,
            };
        }
        if let Some(rounded) = polyhedron.rounded() {
            return Self::of_rounded(rounded);
        }
        // Integrating about an inner point, not the origin, keeps the sums
        // free of cancellation when the body lies far from the origin.
        let inner = Point::from(mean(polyhedron.vertices()));
        let mut all = Moments::default();
        for triangle in polyhedron.triangles() {
            let [a, b, c] = triangle.map(|p| p - inner);
            let v = a.dot(&b.cross(&c)) / 6.0;
            let s = a + b + c;
            let square =
                a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose();
            all.add(v, v / 4.0 * s, v / 20.0 * square);
        }
        Self::of_moments(&all, inner)
    }

    /// Those of the core, and of what the ball adds to it.
    fn of_rounded(rounded: &Rounded) -> Self {
        let core = Self::of(&rounded.core);
        let about = core.centroid;
        let mut all = Moments::default();
        let covariance = Matrix3::identity() * (core.inertia_per_density.trace() / 2.0)
            - core.inertia_per_density;
        all.add(core.volume, Vector::zeros(), covariance);
        add_swept(rounded, &about, &mut all);
        Self::of_moments(&all, about)
    }

    /// Those of a body by its moments about a point.
    fn of_moments(moments: &Moments, point: Point) -> Self {
        let offset = moments.first / moments.volume;
        let covariance = moments.second - moments.volume * offset * offset.transpose();
        let inertia = Matrix3::identity() * covariance.trace() - covariance;
        Self {
            volume: moments.volume,
            centroid: point + offset,
            inertia_per_density: (inertia + inertia.transpose()) / 2.0,
        }
    }

    /// The principal frame: eigenvectors of the inertia tensor, right-handed, moments ascending.
    pub fn principal_frame(&self) -> PrincipalFrame {
        let eigen = SymmetricEigen::new(self.inertia_per_density);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let x: Vector = eigen.eigenvectors.column(order[0]).into();
        let y: Vector = eigen.eigenvectors.column(order[1]).into();
        let axes = Matrix3::from_columns(&[x, y, x.cross(&y)]);
        let rotation =
            UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(axes));
        PrincipalFrame {
            pose: Pose::from_parts(self.centroid.coords.into(), rotation),
            moments_per_density: Vector::new(
                eigen.eigenvalues[order[0]],
                eigen.eigenvalues[order[1]],
                eigen.eigenvalues[order[2]],
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::{near, regular_tetrahedron};
    use nalgebra::Translation3;

    fn poses() -> Vec<Pose> {
        let turn = UnitQuaternion::from_euler_angles(0.7, -0.4, 2.1);
        vec![
            Pose::identity(),
            Pose::from_parts(Translation3::new(0.3, -1.0, 2.0), turn),
            // Far from the origin, where careless sums cancel.
            Pose::from_parts(Translation3::new(100.0, 50.0, -70.0), turn.inverse()),
        ]
    }

    /// Expects a body's volume, a centroid at the origin and an inertia tensor
    /// in its own frame, under every pose.
    fn expect(body: &ConvexPolyhedron, volume: f64, inertia: Matrix3<f64>) {
        for pose in poses() {
            let moved = body.transformed(&pose);
            moved.sanity_check().unwrap();
            let got = MassProperties::of(&moved);
            // Vertices rounded at a distance L carry errors of L·1e-16.
            let rounding = 1e-13 * (1.0 + pose.translation.vector.norm());
            near("volume", got.volume, volume, rounding * volume);
            let centroid = Point::from(pose.translation.vector);
            near("distance of the centroid", (got.centroid - centroid).norm(), 0.0, rounding);
            let r = pose.rotation.to_rotation_matrix();
            let expected = r * inertia * r.transpose();
            let error = (got.inertia_per_density - expected).amax();
            near("largest error of the inertia R·I·Rᵀ", error, 0.0, rounding * inertia.amax());
        }
    }

    #[test]
    fn cuboid_has_the_textbook_inertia() {
        let (a, b, c) = (1.0, 2.0, 3.0);
        let body = ConvexPolyhedron::cuboid(Vector::new(a, b, c)).unwrap();
        let volume = a * b * c;
        let diagonal = Vector::new(b * b + c * c, a * a + c * c, a * a + b * b) * (volume / 12.0);
        expect(&body, volume, Matrix3::from_diagonal(&diagonal));
    }

    #[test]
    fn regular_tetrahedron_has_the_textbook_inertia() {
        // Edge s = 2√2: V = s³/(6√2), I = V·s²/20 about every axis through the centroid.
        let s2: f64 = 8.0;
        let volume = s2.powf(1.5) / (6.0 * 2.0_f64.sqrt());
        expect(&regular_tetrahedron(), volume, Matrix3::identity() * (volume * s2 / 20.0));
    }

    #[test]
    fn parts_add_up_by_the_parallel_axis_theorem() {
        // A cuboid cut by an oblique plane into two prisms.
        let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 3.0), (0.0, 3.0)];
        let part = |polygon: &[(f64, f64)]| {
            MassProperties::of(&ConvexPolyhedron::prism(polygon, 0.0, 1.0).unwrap())
        };
        let whole = part(&corners);
        let parts = [
            part(&[corners[0], corners[1], (2.0, 1.0), (0.0, 0.5)]),
            part(&[(0.0, 0.5), (2.0, 1.0), corners[2], corners[3]]),
        ];
        let mut inertia = Matrix3::zeros();
        for p in &parts {
            let d = p.centroid - whole.centroid;
            let steiner = Matrix3::identity() * d.norm_squared() - d * d.transpose();
            inertia += p.inertia_per_density + steiner * p.volume;
        }
        near("volumes add up", parts[0].volume + parts[1].volume, whole.volume, 1e-14);
        let error = (inertia - whole.inertia_per_density).amax();
        near("inertias add up with Steiner's terms", error, 0.0, 1e-13);
    }

    #[test]
    fn principal_frame_is_right_handed_ascending_and_diagonal() {
        let body = ConvexPolyhedron::cuboid(Vector::new(3.0, 1.0, 2.0)).unwrap();
        for pose in poses() {
            let moved = body.transformed(&pose);
            let frame = MassProperties::of(&moved).principal_frame();
            // Moments V/12·(sum of the squares of the other two sides).
            for (got, expected) in frame.moments_per_density.iter().zip([2.5, 5.0, 6.5]) {
                near("principal moment, ascending", *got, expected, 1e-11);
            }
            let rotation = frame.pose.rotation.to_rotation_matrix();
            near("right-handed: determinant", rotation.matrix().determinant(), 1.0, 1e-14);
            let own = MassProperties::of(&moved.transformed(&frame.pose.inverse()));
            let diagonal = Matrix3::from_diagonal(&frame.moments_per_density);
            let error = (own.inertia_per_density - diagonal).amax();
            near("inertia in its principal frame is diagonal", error, 0.0, 1e-11);
            near("centroid in its principal frame", own.centroid.coords.amax(), 0.0, 1e-12);
        }
    }
}
