//! A top on its tip: a square pyramid that stands on its apex.
//!
//! A square pyramid of base s and height h has its centroid at l = 3/4 h from the apex, I₃ = m
//! s²/10 about its axis and I₁ = m (s²/20 + 3 h²/80) about every axis across it: a symmetric top,
//! though it is a polyhedron. With the apex held by friction it precesses steadily at the tilt θ
//! where I₁' Ω² cos θ − I₃ ω₃ Ω + m g l = 0, I₁' = I₁ + m l² (Goldstein, "Classical Mechanics",
//! section 5.7); Ω ≈ m g l/(I₃ ω₃) where it is fast. The slow root is taken. A point contact bears
//! no moment: upright, the spin stays what it is.

use super::*;

/// A square pyramid that spins on its apex.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Top {
    pub side_mm: f64,
    pub height_mm: f64,
    /// Angular velocity about its axis, in rad/s.
    pub spin_rad_per_s: f64,
    /// Angle of its axis with the vertical in degrees.
    pub tilt_deg: f64,
    pub friction: f64,
    pub duration_s: f64,
    pub quantity: Quantity,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Angle of precession over that of the law.
    Precession,
    /// Angle of its axis with the vertical at the end, in degrees.
    Tilt,
    /// Angular velocity about its axis at the end over that at the beginning.
    Spin,
}

/// Moments per mass of a pyramid, in m².
#[derive(Debug, Clone, Copy)]
struct Moments {
    /// l in m.
    centroid: f64,
    /// I₁'/m about the apex.
    across: f64,
    /// I₃/m.
    along: f64,
}

impl Moments {
    fn of(side: f64, height: f64) -> Self {
        let centroid = 0.75 * height;
        let about_centroid = side * side / 20.0 + 3.0 * height * height / 80.0;
        Self { centroid, across: about_centroid + centroid * centroid, along: side * side / 10.0 }
    }

    /// Ω in rad/s of the slow steady precession; `None` where there is none.
    fn precession(&self, spin: f64, tilt: f64) -> Option<f64> {
        let (a, b, c) = (self.across * tilt.cos(), self.along * spin, GRAVITY * self.centroid);
        let under = b * b - 4.0 * a * c;
        // 2c/(b + √…) is the small root without cancellation.
        (under > 0.0).then(|| 2.0 * c / (b + under.sqrt() * b.signum()))
    }
}

/// The pyramid with its centroid in the origin and its apex below.
fn pyramid(side: f64, height: f64) -> Result<ConvexPolyhedron> {
    let (half, base, apex) = (side / 2.0, 0.25 * height, -0.75 * height);
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    let mut vertices: Vec<Point> = corners.iter().map(|(x, y)| Point::new(*x, *y, base)).collect();
    vertices.push(Point::new(0.0, 0.0, apex));
    let mut faces = vec![vec![0, 1, 2, 3]];
    faces.extend((0..4).map(|i| vec![(i + 1) % 4, i, 4]));
    Ok(ConvexPolyhedron::new(vertices, faces)?)
}

/// Sum of the steps by which a direction turns about the vertical, in rad.
struct Heading {
    last: f64,
    total: f64,
}

impl Heading {
    fn follow(&mut self, direction: &Vector) {
        let now = direction.y.atan2(direction.x);
        let turn = (now - self.last).rem_euclid(TAU);
        let back = turn - TAU;
        self.total += if turn < -back { turn } else { back };
        self.last = now;
    }
}

impl Top {
    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let (side, height) = (from_mm(self.side_mm), from_mm(self.height_mm));
        let moments = Moments::of(side, height);
        let tilt = from_deg(self.tilt_deg);
        let rate = if tilt > 0.0 {
            let found = moments.precession(self.spin_rad_per_s, tilt);
            found.ok_or_else(|| VerifyError::Setup("too slow for steady precession".into()))?
        } else {
            0.0
        };
        let rotation = about_y(tilt);
        let axis = rotation * Vector::z();
        let arm = moments.centroid * axis;
        let mut body = free(pyramid(side, height)?, Vector::zeros());
        let turning = Vector::z() * rate;
        body.state = BodyState {
            pose: Pose::from_parts((arm + Vector::z() * START_GAP).into(), rotation),
            linear_velocity: turning.cross(&arm),
            angular_velocity: turning + axis * (self.spin_rad_per_s - rate * tilt.cos()),
        };
        let mut scene = on_floor(bench, 0.2, self.friction)?;
        let id = scene.add(&body);
        let mut heading = Heading { last: 0.0, total: 0.0 };
        let (mut curve, mut last, mut points) = (Vec::new(), body.state, 0);
        for _ in 0..scene.steps_in(self.duration_s) {
            scene.step()?;
            last = scene.state(id)?;
            points += pushing(&scene);
            let axis = last.pose.rotation * Vector::z();
            heading.follow(&axis);
            let shown = match self.quantity {
                Quantity::Precession => heading.total.to_degrees(),
                Quantity::Tilt => axis.angle(&Vector::z()).to_degrees(),
                Quantity::Spin => spin_of(&last),
            };
            curve.push((scene.time(), shown));
        }
        let end = scene.time();
        let now = last.pose.rotation * Vector::z();
        let tip = last.pose.translation.vector - moments.centroid * now;
        let tilted = now.angle(&Vector::z()).to_degrees();
        // The axis of the figure, the law at the beginning and at the end, and what is measured.
        let (y, law, got) = match self.quantity {
            Quantity::Precession => {
                let turned = rate * end;
                ("Precession (°)", [0.0, turned.to_degrees()], heading.total / turned)
            }
            Quantity::Tilt => ("Tilt (°)", [self.tilt_deg; 2], tilted),
            Quantity::Spin => {
                let spin = self.spin_rad_per_s;
                ("Spin (rad/s)", [spin; 2], spin_of(&last) / spin)
            }
        };
        let note = format!(
            "tilt {tilted:.2}° after {:.2}°, spin {:.2} rad/s, tip {:.3} mm from where it was; \
             on {:.1} points",
            self.tilt_deg,
            spin_of(&last),
            1e3 * tip.norm(),
            points as f64 / curve.len() as f64
        );
        let law = vec![(0.0, law[0]), (end, law[1])];
        Ok(Outcome::over_time(y, curve, "Symmetric top", law).said(note).got(got))
    }
}

/// Angular velocity (rad/s) of a body about its own z.
fn spin_of(state: &BodyState) -> f64 {
    (state.pose.rotation.inverse() * state.angular_velocity).z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::MassProperties;

    #[test]
    fn moments_are_those_of_the_polyhedron() {
        let (side, height) = (0.04, 0.015);
        let properties = MassProperties::of(&pyramid(side, height).expect("a pyramid"));
        let moments = Moments::of(side, height);
        let per_mass = properties.inertia_per_density / properties.volume;
        let centroid = properties.centroid.coords.norm();
        assert!(centroid < 1e-12, "law: the centroid is the origin, off by {centroid:e}");
        let across = per_mass[(0, 0)] + moments.centroid * moments.centroid;
        for (law, got, expected) in [
            ("along", per_mass[(2, 2)], moments.along),
            ("across x", across, moments.across),
            ("a symmetric top", per_mass[(1, 1)], per_mass[(0, 0)]),
        ] {
            assert!((got / expected - 1.0).abs() < 1e-9, "{law}: expected {expected}, got {got}");
        }
    }

    #[test]
    fn steady_precession_balances_the_moment_of_the_weight() {
        let moments = Moments::of(0.04, 0.015);
        for (spin, tilt) in [(100.0, 0.35), (300.0, 0.6), (-100.0, 0.35)] {
            let rate = moments.precession(spin, tilt).expect("fast enough");
            // dL/dt = Ω ẑ × L about the tip, against m g l sin θ.
            let axis = Vector::new(f64::sin(tilt), 0.0, f64::cos(tilt));
            let turning = Vector::z() * rate;
            let across = turning - axis * turning.dot(&axis);
            let momentum = moments.across * across + axis * (moments.along * spin);
            let change = turning.cross(&momentum);
            let weight = (moments.centroid * axis).cross(&(-GRAVITY * Vector::z()));
            let off = (change - weight).norm() / weight.norm();
            assert!(off < 1e-9, "law: Euler about the tip, off by {off:e} of the moment");
        }
        let fast = moments.precession(5000.0, 0.35).expect("fast enough");
        let approximate = GRAVITY * moments.centroid / (moments.along * 5000.0);
        assert!((fast / approximate - 1.0).abs() < 1e-3, "law: m g l/I₃ω₃ where it is fast");
        assert_eq!(moments.precession(10.0, 0.35), None, "law: a slow top falls");
    }

    #[test]
    fn a_heading_is_followed_round_and_back() {
        let mut heading = Heading { last: 0.0, total: 0.0 };
        let at = |a: f64| Vector::new(a.cos(), a.sin(), 1.0);
        for n in 1..=100 {
            heading.follow(&at(0.1 * f64::from(n)));
        }
        assert!((heading.total - 10.0).abs() < 1e-9, "law: 10 rad, got {}", heading.total);
        for n in (0..100).rev() {
            heading.follow(&at(0.1 * f64::from(n)));
        }
        assert!(heading.total.abs() < 1e-9, "law: and back, got {}", heading.total);
    }

    #[test]
    fn only_the_tip_of_the_files_tops_touches_and_friction_holds_it() {
        for (case, top) in cases_of!(Top, 2) {
            // The lowest line of the pyramid is an edge to a corner of the base.
            let edge = (top.height_mm * 2.0_f64.sqrt() / top.side_mm).atan().to_degrees();
            assert!(top.tilt_deg < 0.9 * edge, "{}: an edge lies at {edge}°", case.id);
            let moments = Moments::of(from_mm(top.side_mm), from_mm(top.height_mm));
            let tilt = from_deg(top.tilt_deg);
            let rate = moments.precession(top.spin_rad_per_s, tilt).expect("fast enough");
            // Its weight is all that is borne; sideways m Ω² l sin θ.
            let needed = rate * rate * moments.centroid * tilt.sin() / GRAVITY;
            assert!(needed < 0.5 * top.friction, "{}: needs {needed}", case.id);
        }
    }
}
