//! Kinetic and potential energy, and speeds.

use super::*;

/// Energy of one or more bodies, in J.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Energy {
    /// ½ m |v − v₀|², v₀ the velocity of the table.
    pub translational: f64,
    /// ½ ω · I ω.
    pub rotational: f64,
    /// m g z, zero for a centroid at floor level.
    pub potential: f64,
}

impl Energy {
    /// Translational and rotational energy together, in J.
    pub fn kinetic(&self) -> f64 {
        self.translational + self.rotational
    }
}

/// Energy of a body of the given mass (kg) and principal moments of inertia
/// about its body axes (kg m²), relative to a table that moves at
/// `table_velocity` (m/s) without turning; `gravity` in m/s² acts along −z.
pub fn body_energy(
    state: &BodyState,
    mass: f64,
    inertia: &Vector,
    gravity: f64,
    table_velocity: &Vector,
) -> Energy {
    Energy {
        translational: 0.5 * mass * (state.linear_velocity - table_velocity).norm_squared(),
        rotational: state.rotational_energy(inertia),
        potential: mass * gravity * state.pose.translation.z,
    }
}

/// Energy of all grains that take part, wherever they are; arguments as in [`body_energy`].
pub fn grain_energy(specimen: &Specimen, gravity: f64, table_velocity: &Vector) -> Energy {
    let mut sum = Energy::default();
    for i in specimen.present() {
        let (grain, state) = (&specimen.grains.grains[i], &specimen.state.bodies[i].body);
        let own = body_energy(state, grain.mass, &grain.inertia, gravity, table_velocity);
        sum.translational += own.translational;
        sum.rotational += own.rotational;
        sum.potential += own.potential;
    }
    sum
}

/// Largest speed of any grain's centroid relative to the table, in m/s; 0 without grains.
pub fn largest_speed(specimen: &Specimen, table_velocity: &Vector) -> f64 {
    specimen
        .present()
        .map(|i| (specimen.state.bodies[i].body.linear_velocity - table_velocity).norm())
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{
        assert_near, cube, random, random_direction, random_polyhedron, random_rotation,
        specimen_of,
    };
    use super::*;
    use crate::{
        geometry::{MassProperties, Pose},
        specimen::Fate,
    };

    /// Law: the rotational energy is ½ ω·(R I Rᵀ)ω with the inertia tensor of
    /// the turned polyhedron, integrated anew in world axes.
    #[test]
    fn rotation_in_world_axes() {
        let mut rng = random(3);
        for _ in 0..50 {
            let shape = random_polyhedron(&mut rng, 0.02, 6);
            let pose = Pose::from_parts(Vector::zeros().into(), random_rotation(&mut rng));
            let mut specimen = specimen_of(vec![(shape.clone(), pose)]);
            let spin = random_direction(&mut rng) * 30.0;
            specimen.state.bodies[0].body.angular_velocity = spin;
            let inertia = MassProperties::of(&shape.transformed(&pose)).inertia_per_density
                * specimen.grains.density;
            let expected = 0.5 * spin.dot(&(inertia * spin));
            let got = grain_energy(&specimen, 9.81, &Vector::zeros());
            assert_near("½ω·Iω", expected, got.rotational, 1e-12 * expected);
            assert_eq!(got.translational, 0.0);
        }
    }

    /// Law: ½mv² relative to the table, mgz; both add up over the grains that take part.
    #[test]
    fn translation_and_height() {
        let place = |z| (cube(0.01), Pose::translation(0.0, 0.0, z));
        let mut specimen = specimen_of(vec![place(0.1), place(0.2), place(0.7)]);
        for body in &mut specimen.state.bodies {
            body.body.linear_velocity = Vector::new(0.5, 0.0, -1.0);
        }
        specimen.state.bodies[1].body.linear_velocity = Vector::new(0.5, 0.0, 0.0);
        specimen.state.bodies[2].fate = Fate::Spilled;
        let mass = specimen.grains.grains[0].mass;
        let table = Vector::new(0.5, 0.0, 0.0);
        let got = grain_energy(&specimen, 9.81, &table);
        assert_near("½mv² against the table", 0.5 * mass, got.translational, 1e-16);
        assert_near("mgz", mass * 9.81 * 0.3, got.potential, 1e-16);
        assert_near("kinetic", 0.5 * mass, got.kinetic(), 1e-16);
        assert_near("fastest against the table", 1.0, largest_speed(&specimen, &table), 1e-15);
        let ground = largest_speed(&specimen, &Vector::zeros());
        assert_near("fastest against the ground", 1.25f64.sqrt(), ground, 1e-15);
        assert_eq!(largest_speed(&specimen_of(vec![]), &table), 0.0, "no grains");
    }
}
