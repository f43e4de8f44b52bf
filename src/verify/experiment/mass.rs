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

/// A polyhedron of corners and faces.
fn of(
    name: &'static str,
    corners: impl IntoIterator<Item = [f64; 3]>,
    faces: &[[u32; 3]],
    volume: f64,
    moment: f64,
) -> Result<Known> {
    let corners = corners.into_iter().map(Point::from).collect();
    let shape = ConvexPolyhedron::new(corners, faces.iter().map(|face| face.to_vec()).collect())?;
    Ok(Known { name, shape, volume, moments: Vector::repeat(moment) })
}

/// Box: V = abc, I = V/12 (b² + c², ...). Regular tetrahedron of side a:
/// V = a³/(6√2), I = V a²/20. Regular octahedron: V = √2 a³/3, I = V a²/10.
fn known() -> Result<Vec<Known>> {
    let cuboid = |name, s: Vector| -> Result<Known> {
        let volume = s.x * s.y * s.z;
        let q = s.component_mul(&s);
        let moments = volume / 12.0 * Vector::new(q.y + q.z, q.x + q.z, q.x + q.y);
        Ok(Known { name, shape: ConvexPolyhedron::cuboid(s)?, volume, moments })
    };
    // Alternate corners of the cube of half side 1: side 2√2.
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let a2 = 8.0_f64;
    let volume = a2.powf(1.5) / (6.0 * 2.0_f64.sqrt());
    let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    let tetrahedron = of("regular tetrahedron", corners, &faces, volume, volume * a2 / 20.0)?;
    // The six points at distance 1 on the axes: side √2.
    let corners = (0..3)
        .flat_map(|axis| [1.0, -1.0].map(|at| [0, 1, 2].map(|k| if k == axis { at } else { 0.0 })));
    let above = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    let below = [[2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let volume = 2.0_f64.sqrt() / 3.0 * 2.0_f64.powf(1.5);
    let octahedron =
        of("regular octahedron", corners, &[above, below].concat(), volume, volume * 2.0 / 10.0)?;
    Ok(vec![
        cuboid("cube", Vector::repeat(1.0))?,
        cuboid("box 1 × 2 × 3", Vector::new(1.0, 2.0, 3.0))?,
        cuboid("slab 4 × 4 × 0.1", Vector::new(4.0, 4.0, 0.1))?,
        tetrahedron,
        octahedron,
    ])
}

pub(super) fn properties() -> Measured {
    let mut outcome = Outcome::new("Scale factor", "Largest relative error");
    let mut worst = 0.0_f64;
    for body in known()? {
        let mut curve = Vec::new();
        for scale in [1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0] {
            let mut off = 0.0;
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
                off = largest([
                    off,
                    (got.volume / volume - 1.0).abs(),
                    (got.centroid.coords - shift).norm() / scale,
                    (got.inertia_per_density - inertia).norm() / inertia.norm(),
                ]);
            }
            curve.push((scale, off));
            worst = largest([worst, off]);
        }
        outcome.measured(body.name, curve);
    }
    Ok(outcome.got(worst))
}
