//! Exact mass properties of polyhedra.

use nalgebra::{Matrix3, SymmetricEigen, UnitQuaternion};

use super::{ConvexPolyhedron, Point, Pose, Vector};

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
    /// Integrates exactly over the tetrahedra that the surface triangles span
    /// with an inner point.
    ///
    /// The second moments of a tetrahedron with one corner at the origin and
    /// corners a, b, c are V/20 · (Σ xᵢxᵢᵀ + s sᵀ), s = a + b + c: the
    /// canonical covariance of Blow and Binstock, "How to find the inertia
    /// tensor of a polyhedron" (2004); it agrees with Mirtich, "Fast and
    /// accurate computation of polyhedral mass properties" (1996).
    pub fn of(polyhedron: &ConvexPolyhedron) -> Self {
        // Integrating about an inner point, not the origin, keeps the sums
        // free of cancellation when the body lies far from the origin.
        let count = polyhedron.vertices().len() as f64;
        let inner =
            Point::from(polyhedron.vertices().iter().map(|v| v.coords).sum::<Vector>() / count);
        let mut volume = 0.0;
        let mut first = Vector::zeros();
        let mut second = Matrix3::zeros();
        for triangle in polyhedron.triangles() {
            let [a, b, c] = triangle.map(|p| p - inner);
            let v = a.dot(&b.cross(&c)) / 6.0;
            let s = a + b + c;
            volume += v;
            first += v / 4.0 * s;
            second += v / 20.0
                * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
        }
        let offset = first / volume;
        let covariance = second - volume * offset * offset.transpose();
        let inertia = Matrix3::identity() * covariance.trace() - covariance;
        Self {
            volume,
            centroid: inner + offset,
            inertia_per_density: (inertia + inertia.transpose()) / 2.0,
        }
    }

    /// The principal frame: eigenvectors of the inertia tensor, right-handed,
    /// moments ascending.
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
