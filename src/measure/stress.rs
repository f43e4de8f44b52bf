//! Stress tensor of the contact forces within a box (Love–Weber).
//!
//! A force between two grains goes along the lines from the centroid of one to the contact
//! point and on to the centroid of the other; the tensor sums force ⊗ line over the parts of
//! these lines that lie in the box, and divides by its volume. At a wall the line ends in the
//! contact point: this is the boundary term. The field so averaged is in equilibrium with the
//! weight of the grains, taken at their centroids, for every box, whatever it cuts
//! (Goldhirsch 2010, "Stress, stress asymmetry and couple stress"; Bagi 1996). Of whole grains
//! at rest it is symmetric; what a box cuts off leaves an asymmetry, which is reported.

use nalgebra::Matrix3;

use super::*;

/// A stress tensor in Pa, compression positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stress {
    /// Its symmetric part.
    pub tensor: Matrix3<f64>,
    /// Frobenius norm of the antisymmetric part over that of the symmetric one; 0 without stress.
    pub asymmetry: f64,
}

impl Stress {
    /// Of a tensor in Pa.
    pub fn of(whole: &Matrix3<f64>) -> Self {
        let tensor = 0.5 * (whole + whole.transpose());
        let size = tensor.norm();
        let asymmetry = if size > 0.0 { (whole - tensor).norm() / size } else { 0.0 };
        Self { tensor, asymmetry }
    }

    /// Mean of the three normal stresses, in Pa.
    pub fn mean(&self) -> f64 {
        self.tensor.trace() / 3.0
    }

    /// √(3/2 s:s) of the deviator s, in Pa: the difference between axial and radial stress of
    /// a triaxial state.
    pub fn deviatoric(&self) -> f64 {
        let deviator = self.tensor - Matrix3::identity() * self.mean();
        (1.5 * deviator.norm_squared()).sqrt()
    }
}

/// Mean stress of the loaded contacts within a region. `None` where the engine gave no
/// contacts; zero where none of them reaches into the region.
///
/// The contacts' own momentum alone: what moving grains carry along does not count.
pub fn stress_in(specimen: &Specimen, region: &Region) -> Option<Stress> {
    let state = &specimen.state;
    (!state.contacts.is_empty()).then(|| Stress::of(&region.stress_of(state)))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{
        assert_near, contact, cube, random, random_direction, specimen_of,
    };
    use super::*;
    use crate::geometry::Pose;
    use crate::specimen::Other;

    const G: f64 = 9.81;
    const FLOOR: Party = Party::Other(Other::Piece(0, 0));
    const WALL: Party = Party::Other(Other::Piece(0, 1));

    fn region(low: [f64; 3], high: [f64; 3]) -> Region {
        Region { low: Vector::from(low), high: Vector::from(high) }
    }

    /// Blocks of side 10 mm on top of each other from z = 0 on, under their own weight.
    fn column(count: usize) -> (Specimen, f64) {
        let z = |n: usize| 0.01 * n as f64;
        let blocks =
            (0..count).map(|n| (cube(0.01), Pose::translation(0.0, 0.0, z(n) + 0.005))).collect();
        let mut specimen = specimen_of(blocks);
        let weight = specimen.grains.grains[0].mass * G;
        for n in 0..count {
            let below = if n == 0 { FLOOR } else { Party::Grain(n - 1) };
            // Four corners of the face share the load.
            for (x, y) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                let point = Vector::new(0.005 * x, 0.005 * y, z(n));
                let force = Vector::z() * weight * (count - n) as f64 / 4.0;
                specimen.state.contacts.push(contact([Party::Grain(n), below], point, force));
            }
        }
        (specimen, weight)
    }

    /// Law: in block n of a column of N the vertical stress is the weight of the blocks above and
    /// of half of its own over the area; of the whole column N W / 2 A; nothing stands sideways.
    #[test]
    fn a_column_of_blocks_bears_its_weight() {
        let (specimen, weight) = column(5);
        let area = 1e-4;
        for n in 0..5 {
            let low = 0.01 * f64::from(n);
            let got =
                stress_in(&specimen, &region([-0.005, -0.005, low], [0.005, 0.005, low + 0.01]))
                    .expect("contacts");
            let expected = (4.5 - f64::from(n)) * weight / area;
            assert_near("σzz of a block in Pa", expected, got.tensor[(2, 2)], 1e-9);
            for (i, j) in [(0, 0), (1, 1), (0, 1), (0, 2), (1, 2)] {
                assert_near("no other stress in Pa", 0.0, got.tensor[(i, j)], 1e-9);
            }
            assert_near("symmetric", 0.0, got.asymmetry, 1e-12);
        }
        let got = stress_in(&specimen, &region([-0.005, -0.005, 0.0], [0.005, 0.005, 0.05]))
            .expect("contacts");
        assert_near("σzz of the column in Pa", 2.5 * weight / area, got.tensor[(2, 2)], 1e-9);
        assert_near("mean", got.tensor[(2, 2)] / 3.0, got.mean(), 1e-9);
        assert_near("deviatoric of one axis", got.tensor[(2, 2)], got.deviatoric(), 1e-9);
    }

    /// Law: in any layer across everything the vertical force is, at each height, the weight of
    /// the centroids above, exactly; a layer from 3 to 17 mm holds 2 mm under the first centroid
    /// of 5 at 5 mm, 10 mm under the second, 2 mm under the third.
    #[test]
    fn a_layer_that_cuts_grains_is_in_equilibrium() {
        let (specimen, weight) = column(5);
        let layer = region([-0.02, -0.02, 0.003], [0.02, 0.02, 0.017]);
        let got = stress_in(&specimen, &layer).expect("contacts").tensor[(2, 2)];
        let force = weight * (2.0 * 5.0 + 10.0 * 4.0 + 2.0 * 3.0) / 14.0;
        assert_near("σzz of a layer in Pa", force / 1.6e-3, got, 1e-9);
    }

    /// Law: a weightless cube of side a, pressed into a corner by P, Q and R along the axes, has
    /// σ = diag(P, Q, R)/a²; friction on its faces that turns it neither way adds σxz = S/a².
    #[test]
    fn a_cube_in_a_corner_is_pressed_as_it_should() {
        let a = 0.02;
        let mut specimen = specimen_of(vec![(cube(a), Pose::translation(0.01, 0.01, 0.01))]);
        let whole = region([0.0; 3], [a; 3]);
        let pressed = [3.0, 5.0, 7.0];
        for (k, force) in pressed.into_iter().enumerate() {
            let axis = Vector::ith(k, 1.0);
            let at = |side: f64| Vector::repeat(0.01) + axis * (side - 0.01);
            let contacts = &mut specimen.state.contacts;
            contacts.push(contact([Party::Grain(0), FLOOR], at(0.0), axis * force));
            // The other way round: the force that is kept is that on the wall.
            contacts.push(contact([WALL, Party::Grain(0)], at(a), axis * force));
        }
        let got = stress_in(&specimen, &whole).expect("contacts");
        for (i, force) in pressed.into_iter().enumerate() {
            for j in 0..3 {
                let expected = if i == j { force / (a * a) } else { 0.0 };
                assert_near("σ of the cube in Pa", expected, got.tensor[(i, j)], 1e-9);
            }
        }
        // Compression is positive: a shear that pushes the bottom towards +x, the top to −x.
        for (at, force) in [
            ([0.01, 0.01, 0.0], [2.0, 0.0, 0.0]),
            ([0.01, 0.01, a], [-2.0, 0.0, 0.0]),
            ([0.0, 0.01, 0.01], [0.0, 0.0, 2.0]),
            ([a, 0.01, 0.01], [0.0, 0.0, -2.0]),
        ] {
            let (at, force) = (Vector::from(at), Vector::from(force));
            specimen.state.contacts.push(contact([Party::Grain(0), WALL], at, force));
        }
        let got = stress_in(&specimen, &whole).expect("contacts");
        assert_near("σxz in Pa", 2.0 / (a * a), got.tensor[(0, 2)], 1e-9);
        assert_near("moments are balanced", 0.0, got.asymmetry, 1e-12);
        // Half of these alone turns the cube: the tensor says so.
        specimen.state.contacts.truncate(8);
        let got = stress_in(&specimen, &whole).expect("contacts");
        let sum = Matrix3::from_diagonal(&Vector::from(pressed)).norm_squared();
        let expected = (0.5 * 4.0 / (sum + 0.5 * 4.0_f64)).sqrt();
        assert_near("asymmetry of a cube that turns", expected, got.asymmetry, 1e-12);
    }

    /// Law: stresses of boxes that fill space, weighted by volume, are the stress of all.
    #[test]
    fn boxes_lose_no_force_between_them() {
        let mut rng = random(11);
        let parts = (0..8).map(|n| {
            let place = |k: u32| 0.02 * f64::from(n / k % 2);
            (cube(0.01), Pose::translation(place(1), place(2), place(4)))
        });
        let mut specimen = specimen_of(parts.collect());
        for a in 0..8 {
            for b in 0..a {
                let point = random_direction(&mut rng) * 0.02;
                let force = random_direction(&mut rng) * 3.0;
                let between = [Party::Grain(a), Party::Grain(b)];
                specimen.state.contacts.push(contact(between, point, force));
            }
        }
        let whole = region([-0.06; 3], [0.06; 3]);
        let expected = stress_in(&specimen, &whole).expect("contacts").tensor;
        let mut sum = Matrix3::zeros();
        for n in 0..27_u32 {
            let low = [n % 3, n / 3 % 3, n / 9].map(|k| -0.06 + 0.04 * f64::from(k));
            let part = region(low, low.map(|x| x + 0.04));
            sum += stress_in(&specimen, &part).expect("contacts").tensor / 27.0;
        }
        assert_near("sum of all boxes in Pa", 0.0, (sum - expected).norm(), 1e-9);
        assert!(expected.norm() > 1.0, "law: there is something to compare");
    }

    #[test]
    fn without_contacts_there_is_no_stress_to_tell() {
        let (mut specimen, _) = column(2);
        let far = region([1.0; 3], [2.0; 3]);
        let got = stress_in(&specimen, &far).expect("contacts");
        assert_eq!((got.tensor, got.asymmetry), (Matrix3::zeros(), 0.0), "law: nothing is there");
        specimen.state.contacts.clear();
        assert_eq!(stress_in(&specimen, &far), None, "law: not known is not zero");
    }
}
