//! Impact of a rigid body on a floor at one point, with friction.
//!
//! With the impulse p at an arm r from the centroid the velocity of the point changes by K p, K =
//! 1/m − [r]× I⁻¹ [r]×. While the point slips the impulse grows along n − μ t, t the direction of
//! slip (Routh 1905, "Dynamics of a System of Rigid Bodies", chapter V; Stronge 2000, "Impact
//! Mechanics"). Where the point sticks from beginning to end, or slips in one direction from
//! beginning to end, the normal velocity is linear in the normal impulse, so that Newton's,
//! Poisson's and Stronge's coefficients of restitution are one and the same, and a contact solver
//! that first brings the normal velocity to zero and then adds the restitution is exact. Where slip
//! stops on the way they agree as long as nothing rebounds: both parts of the velocity are zero at
//! the end, and p = −K⁻¹ u. Otherwise, where slip stops or reverses, they disagree; no energy may
//! come from it, and the impulse stays in the cone.
//!
//! Of the three Stronge's is the one that says what it costs: the work of the normal
//! impulse in restitution is e² of that in compression. In a plane of symmetry that has a closed
//! form ([`Impact::energetic`]). Let t be the direction of slip, and p the normal impulse. While
//! the point slips, u grows by K (n − μ t) for each unit of p: slip stops at
//! p₁ = −uₜ/(t·K (n − μ t)), when the normal velocity is u₁ = uₙ + a₁ p₁ with
//! a₁ = n·K (n − μ t). From then on the impulse grows along one direction d: along
//! K⁻¹ n/(n·K⁻¹ n) if that lies in the cone, and the point sticks; along n + μ t if not, and
//! slip reverses. With a₂ = n·K d compression ends after a further p₂ = −u₁/a₂, and has taken
//!
//! W = ∫ −uₙ dp = (uₙ² − u₁²)/2a₁ + u₁²/2a₂.
//!
//! Restitution begins at rest: its work ½ a₂ p₃² = e² W gives p₃ = e √(2 W/a₂), and the
//! impulse is p₁ (n − μ t) + (p₂ + p₃) d.
//!
//! A law of impact that knows of compression and of restitution only the velocity at the
//! end, as those of Moreau and of Glocker and Pfeiffer (and so the native solver's) do, lets
//! friction oppose the slip that is left at the end, not the slip on the way. Where slip reverses
//! it has another impulse than Routh's even without rebound, and where slip stops, Newton's or
//! Poisson's rebound, which lie on either side of Stronge's.

use super::*;

/// A body at the moment of its impact on a floor with normal +z.
#[derive(Debug, Clone, Copy)]
pub(super) struct Impact {
    /// Mass in kg.
    pub mass: f64,
    /// Inertia about the centroid in world axes, in kg m².
    pub inertia: Matrix3<f64>,
    /// From the centroid to the point, in m.
    pub arm: Vector,
    /// Velocity in m/s; the body does not turn.
    pub velocity: Vector,
    pub friction: f64,
    pub restitution: f64,
}

impl Impact {
    /// K in 1/kg.
    pub fn compliance(&self) -> Option<Matrix3<f64>> {
        let inverse = self.inertia.try_inverse()?;
        let arm = self.arm.cross_matrix();
        Some(Matrix3::identity() / self.mass - arm * inverse * arm)
    }

    /// How much an impulse leaves the cone of friction, in N s; negative inside.
    pub fn outside_cone(&self, impulse: &Vector) -> f64 {
        impulse.xy().norm() - self.friction * impulse.z
    }

    fn in_cone(&self, impulse: &Vector) -> bool {
        self.outside_cone(impulse) < 0.0
    }

    fn slip(&self) -> Vector {
        Vector::new(self.velocity.x, self.velocity.y, 0.0)
    }

    /// Impulse where the point sticks throughout: it has no slip, and what
    /// keeps it from slipping lies in the cone.
    pub fn sticks(&self) -> Option<Vector> {
        let change = Vector::z() * (-(1.0 + self.restitution) * self.velocity.z);
        let impulse = self.compliance()?.try_inverse()? * change;
        (self.slip().norm() == 0.0 && self.in_cone(&impulse)).then_some(impulse)
    }

    /// Impulse where the point slips in one direction throughout, in a
    /// plane of symmetry of the body.
    pub fn slips(&self) -> Option<Vector> {
        let way = self.slip().try_normalize(0.0)?;
        let along = Vector::z() - self.friction * way;
        let rate = self.compliance()? * along;
        let normal = -(1.0 + self.restitution) * self.velocity.z / rate.z;
        let after = self.velocity + rate * normal;
        // In the plane of symmetry nothing turns the slip aside.
        let across = rate - Vector::z() * rate.z - way * rate.dot(&way);
        let straight = across.norm() < 1e-9 * rate.norm();
        (rate.z > 0.0 && straight && after.dot(&way) > 0.0).then(|| along * normal)
    }

    /// Whether slip along one direction stops while the body still comes; and K⁻¹.
    fn slip_ends_in_time(&self) -> Option<(bool, Matrix3<f64>)> {
        let way = self.slip().try_normalize(0.0)?;
        let compliance = self.compliance()?;
        let slipping = compliance * (Vector::z() - self.friction * way);
        let stops = -self.velocity.dot(&way) / slipping.dot(&way);
        let in_time = stops > 0.0 && self.velocity.z + slipping.z * stops < 0.0;
        Some((in_time, compliance.try_inverse()?))
    }

    /// Impulse without rebound where slip stops before the body does, and does not begin again.
    pub fn slip_stops(&self) -> Option<Vector> {
        let (in_time, inverse) = self.slip_ends_in_time()?;
        let impulse = -(inverse * self.velocity);
        let ok = self.restitution == 0.0 && in_time && self.in_cone(&(inverse * Vector::z()));
        ok.then_some(impulse)
    }

    /// Impulse (N s) with Stronge's energetic coefficient where slip stops before the body does:
    /// the point then sticks or slips the other way. In a plane of symmetry of the body.
    pub fn energetic(&self) -> Option<Vector> {
        let way = self.slip().try_normalize(0.0)?;
        let compliance = self.compliance()?;
        let slips = Vector::z() - self.friction * way;
        let rate = compliance * slips;
        let stops = -self.velocity.dot(&way) / rate.dot(&way);
        let arrives = self.velocity.z + rate.z * stops;
        let hold = compliance.try_inverse()? * Vector::z();
        let holds = self.in_cone(&hold);
        let then = if holds { hold / hold.z } else { Vector::z() + self.friction * way };
        let after = compliance * then;
        // In the plane of symmetry nothing turns the slip aside.
        let aside = |v: Vector| v - Vector::z() * v.z - way * v.dot(&way);
        let straight = aside(rate).norm() < 1e-9 * rate.norm() && aside(then).norm() < 1e-9;
        // Slip that has stopped and is not held goes the other way.
        let reverses = holds || after.dot(&way) < 0.0;
        if !(straight && reverses && stops > 0.0 && arrives < 0.0 && after.z > 0.0) {
            return None;
        }
        let slipping = if rate.z == 0.0 {
            -self.velocity.z * stops
        } else {
            0.5 * (self.velocity.z.powi(2) - arrives.powi(2)) / rate.z
        };
        let work = slipping + 0.5 * arrives.powi(2) / after.z;
        let rest = -arrives / after.z + self.restitution * (2.0 * work / after.z).sqrt();
        Some(slips * stops + then * rest)
    }

    /// Whether slip along one direction stops while the body still comes, and
    /// begins again the other way because friction cannot hold the point.
    pub fn slip_reverses(&self) -> Option<bool> {
        let (in_time, inverse) = self.slip_ends_in_time()?;
        Some(in_time && !self.in_cone(&(inverse * Vector::z())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Impact {
        /// Velocity of the point after an impulse (N s).
        fn point_after(&self, impulse: &Vector) -> Option<Vector> {
            Some(self.velocity + self.compliance()? * impulse)
        }

        /// Kinetic energy in J after an impulse.
        fn energy_after(&self, impulse: &Vector) -> Option<f64> {
            let velocity = self.velocity + impulse / self.mass;
            let momentum = self.arm.cross(impulse);
            let turning = momentum.dot(&(self.inertia.try_inverse()? * momentum));
            Some(0.5 * (self.mass * velocity.norm_squared() + turning))
        }
    }

    /// A rod-like body that meets the floor beside its centroid.
    fn rod(slip: f64, friction: f64, restitution: f64) -> Impact {
        Impact {
            mass: 0.05,
            inertia: Matrix3::from_diagonal(&Vector::new(4e-6, 8e-6, 6e-6)),
            arm: Vector::new(0.0123, 0.0, -0.0187),
            velocity: Vector::new(slip, 0.0, -0.2),
            friction,
            restitution,
        }
    }

    /// What ends restitution.
    #[derive(Clone, Copy)]
    enum Ends {
        /// e times the normal velocity of the approach.
        Newton,
        /// e times the normal impulse of the compression.
        Poisson,
        /// e² of the work of the compression.
        Stronge,
    }

    /// The law itself in small steps of normal impulse: slip where the point
    /// slips, stick where friction can hold it.
    fn routh(impact: &Impact, ends: Ends) -> Vector {
        const STEPS: f64 = 4e5;
        let compliance = impact.compliance().expect("a body");
        let inverse = compliance.try_inverse().expect("a body");
        let hold = inverse * Vector::z();
        let hold = hold / hold.z;
        let step = impact.mass * impact.velocity.z.abs() / STEPS;
        let (mut impulse, mut point) = (Vector::zeros(), impact.velocity);
        let (mut compression, mut work) = (None, 0.0);
        loop {
            let before = point.z;
            let slip = Vector::new(point.x, point.y, 0.0);
            // What a step can change is no slip.
            let tiny = 2.0 * step * (compliance * (Vector::z() + Vector::x())).norm();
            let way = if slip.norm() > tiny {
                Vector::z() - impact.friction * slip / slip.norm()
            } else if impact.outside_cone(&hold) < 0.0 {
                hold
            } else {
                let begins = Vector::new(compliance.column(2).x, compliance.column(2).y, 0.0);
                Vector::z() - impact.friction * begins / begins.norm()
            };
            impulse += way * step;
            point += compliance * way * step;
            work += 0.5 * (before + point.z) * step;
            if compression.is_none() && point.z >= 0.0 {
                compression = Some((impulse.z, work));
            }
            let e = impact.restitution;
            let over = compression.is_some_and(|(normal, taken)| match ends {
                Ends::Newton => point.z >= -e * impact.velocity.z,
                Ends::Poisson => impulse.z >= (1.0 + e) * normal,
                Ends::Stronge => work - taken >= -e * e * taken,
            });
            if over {
                return impulse;
            }
        }
    }

    fn near(law: &str, got: Vector, expected: Vector) {
        let (off, size) = ((got - expected).norm(), expected.norm());
        crate::geometry::testing::near(law, off, 0.0, 1e-3 * size);
    }

    #[test]
    fn every_closed_solution_is_that_of_the_small_steps() {
        let stick = rod(0.0, 0.7, 0.5);
        near("stick", routh(&stick, Ends::Poisson), stick.sticks().expect("sticks"));
        for (slip, friction) in [(0.3, 0.3), (-1.0, 0.3)] {
            let slips = rod(slip, friction, 0.5);
            near("slip", routh(&slips, Ends::Poisson), slips.slips().expect("slips"));
        }
        let stops = rod(-0.1, 0.7, 0.0);
        near("slip stops", routh(&stops, Ends::Poisson), stops.slip_stops().expect("stops"));
    }

    #[test]
    fn the_energetic_solution_is_that_of_the_small_steps() {
        // Of a friction coefficient the first stops slip, the second reverses it.
        for friction in [0.7, 0.3] {
            for restitution in [0.0, 0.5, 1.0] {
                let impact = rod(-0.1, friction, restitution);
                let expected = routh(&impact, Ends::Stronge);
                near("Stronge", impact.energetic().expect("stops"), expected);
            }
        }
        let stops = rod(-0.1, 0.7, 0.0);
        let (a, b) = (stops.energetic().expect("stops"), stops.slip_stops().expect("stops"));
        assert!((a - b).norm() < 1e-12 * b.norm(), "law: one impulse without rebound, {a} and {b}");
    }

    #[test]
    fn the_energetic_rebound_lies_between_newton_and_poisson_and_takes_energy() {
        for friction in [0.7, 0.3] {
            let impact = rod(-0.1, friction, 1.0);
            let stronge = impact.energetic().expect("stops").z;
            let (newton, poisson) =
                (routh(&impact, Ends::Newton).z, routh(&impact, Ends::Poisson).z);
            let (low, high) = (newton.min(poisson), newton.max(poisson));
            assert!(high > 1.01 * low, "they differ: {low} and {high} N s");
            assert!((low..high).contains(&stronge), "law: {low} to {high} N s, got {stronge}");
            let before = impact.energy_after(&Vector::zeros()).expect("a body");
            let after = impact.energy_after(&impact.energetic().expect("stops")).expect("a body");
            assert!(after < before, "law: friction takes energy, {before} J to {after} J");
        }
        assert_eq!(rod(-1.0, 0.3, 0.5).energetic(), None, "law: this slip does not stop");
        assert_eq!(rod(0.0, 0.7, 0.5).energetic(), None, "law: nothing slips");
    }

    #[test]
    fn a_regime_that_is_not_there_has_no_solution() {
        assert_eq!(rod(0.0, 0.1, 0.5).sticks(), None, "law: too little friction to stick");
        assert_eq!(rod(0.3, 0.7, 0.5).sticks(), None, "law: slip is no stick");
        assert_eq!(rod(-0.1, 0.3, 0.5).slips(), None, "law: this slip stops");
        assert_eq!(rod(-0.1, 0.7, 0.5).slip_stops(), None, "law: hypotheses disagree on rebound");
        assert_eq!(rod(-0.1, 0.3, 0.0).slip_stops(), None, "law: this slip reverses");
        assert_eq!(rod(-0.1, 0.3, 0.5).slip_reverses(), Some(true));
        assert_eq!(rod(-0.1, 0.7, 0.5).slip_reverses(), Some(false));
        assert_eq!(rod(-1.0, 0.3, 0.5).slip_reverses(), Some(false));
    }

    #[test]
    fn energy_falls_and_the_point_does_what_its_regime_says() {
        for impact in [rod(0.0, 0.7, 0.5), rod(0.3, 0.3, 0.5), rod(-1.0, 0.3, 0.5)] {
            let impulse = impact.sticks().or_else(|| impact.slips()).expect("a regime");
            let before = impact.energy_after(&Vector::zeros()).expect("a body");
            let after = impact.energy_after(&impulse).expect("a body");
            assert!(after < before, "law: energy falls, {before} J to {after} J");
            let point = impact.point_after(&impulse).expect("a body");
            let off = (point.z - 0.5 * 0.2).abs();
            assert!(off < 1e-12, "law: e of the approach, off by {off:e}");
            assert!(impact.outside_cone(&impulse) < 1e-12, "law: Coulomb");
        }
    }

    /// Newton's coefficient with the friction that the end asks for creates energy where slip
    /// reverses (Kane 1984, "A dynamics puzzle"): the case of the suite can find it.
    #[test]
    fn where_slip_reverses_newton_would_create_energy() {
        let impact = rod(-0.1, 0.3, 1.0);
        let along = Vector::z() - 0.3 * Vector::x();
        let rate = impact.compliance().expect("a body") * along;
        let impulse = along * (0.4 / rate.z);
        let point = impact.point_after(&impulse).expect("a body");
        assert!(point.x > 0.0, "the slip at the end is that of the friction");
        let before = impact.energy_after(&Vector::zeros()).expect("a body");
        let after = impact.energy_after(&impulse).expect("a body");
        assert!(after > 1.05 * before, "law: {before} J becomes {after} J");
    }
}
