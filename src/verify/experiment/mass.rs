//! Volume, centroid and inertia of polyhedra whose values are in any handbook.

use super::*;
use crate::geometry::MassProperties;

/// A polyhedron about its centroid with its exact volume and principal moments for unit density.
struct Known {
    name: &'static str,
    shape: ConvexPolyhedron,
    volume: f64,
    moments: Vector,
}

fn setup(error: impl ToString) -> VerifyError {
    VerifyError::Setup(error.to_string())
}

/// Box: V = abc, I = V/12 (b² + c², ...). Regular tetrahedron of side a:
/// V = a³/(6√2), I = V a²/20. Regular octahedron: V = √2 a³/3, I = V a²/10.
fn known() -> Result<Vec<Known>, VerifyError> {
    let cuboid = |name, s: Vector| -> Result<Known, VerifyError> {
        let volume = s.x * s.y * s.z;
        let q = s.component_mul(&s);
        let moments = volume / 12.0 * Vector::new(q.y + q.z, q.x + q.z, q.x + q.y);
        Ok(Known { name, shape: ConvexPolyhedron::cuboid(s).map_err(setup)?, volume, moments })
    };
    let point = |x: f64, y: f64, z: f64| Point::new(x, y, z);
    // Alternate corners of the cube of half side 1: side 2√2.
    let tetrahedron = ConvexPolyhedron::new(
        vec![
            point(1.0, 1.0, 1.0),
            point(1.0, -1.0, -1.0),
            point(-1.0, 1.0, -1.0),
            point(-1.0, -1.0, 1.0),
        ],
        vec![vec![0, 1, 2], vec![0, 3, 1], vec![0, 2, 3], vec![1, 3, 2]],
    )
    .map_err(setup)?;
    let a2 = 8.0_f64;
    let tetrahedron_volume = a2.powf(1.5) / (6.0 * 2.0_f64.sqrt());
    // The six points at distance 1 on the axes: side √2.
    let octahedron = ConvexPolyhedron::new(
        vec![
            point(1.0, 0.0, 0.0),
            point(-1.0, 0.0, 0.0),
            point(0.0, 1.0, 0.0),
            point(0.0, -1.0, 0.0),
            point(0.0, 0.0, 1.0),
            point(0.0, 0.0, -1.0),
        ],
        vec![
            vec![0, 2, 4],
            vec![2, 1, 4],
            vec![1, 3, 4],
            vec![3, 0, 4],
            vec![2, 0, 5],
            vec![1, 2, 5],
            vec![3, 1, 5],
            vec![0, 3, 5],
        ],
    )
    .map_err(setup)?;
    let octahedron_volume = 2.0_f64.sqrt() / 3.0 * 2.0_f64.powf(1.5);
    Ok(vec![
        cuboid("cube", Vector::repeat(1.0))?,
        cuboid("box 1 × 2 × 3", Vector::new(1.0, 2.0, 3.0))?,
        cuboid("slab 4 × 4 × 0.1", Vector::new(4.0, 4.0, 0.1))?,
        Known {
            name: "regular tetrahedron",
            shape: tetrahedron,
            volume: tetrahedron_volume,
            moments: Vector::repeat(tetrahedron_volume * a2 / 20.0),
        },
        Known {
            name: "regular octahedron",
            shape: octahedron,
            volume: octahedron_volume,
            moments: Vector::repeat(octahedron_volume * 2.0 / 10.0),
        },
    ])
}

pub(super) fn properties() -> Measured {
    let mut outcome = Outcome::new("Scale factor", "Largest relative error");
    let mut worst = 0.0_f64;
    for body in known()? {
        let mut curve = Vec::new();
        for scale in [1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0] {
            let mut largest = 0.0_f64;
            for turn in 0..8 {
                let angle = f64::from(turn);
                let rotation =
                    UnitQuaternion::from_euler_angles(0.7 * angle, 1.3 * angle, -0.4 * angle);
                let shift = scale * Vector::new(3.0, -7.0, 2.0) * f64::from(turn % 3);
                let pose = Pose::from_parts(shift.into(), rotation);
                let got = MassProperties::of(&body.shape.scaled(scale).transformed(&pose));
                let volume = body.volume * scale.powi(3);
                let turned = rotation.to_rotation_matrix();
                let inertia = turned
                    * Matrix3::from_diagonal(&(body.moments * scale.powi(5)))
                    * turned.transpose();
                largest = largest
                    .max((got.volume / volume - 1.0).abs())
                    .max((got.centroid.coords - shift).norm() / scale)
                    .max((got.inertia_per_density - inertia).norm() / inertia.norm());
            }
            curve.push((scale, largest));
            worst = worst.max(largest);
        }
        outcome.measured(body.name, curve);
    }
    Ok(outcome.got(worst))
}
