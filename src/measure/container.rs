//! The container whose content is measured.

use super::*;

/// An upright circular cylinder standing on the plane z = 0.
///
/// It is described by plain numbers, not by the apparatus' wall pieces: the
/// polygon of walls has the circle's area, and the laboratory measures a circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Container {
    /// x of the axis in m: the displacement of the table it stands on. The
    /// axis passes through y = 0.
    pub centre_x: f64,
    /// Inner radius in m.
    pub radius: f64,
    /// Inner height, floor to rim, in m.
    pub height: f64,
}

impl Container {
    /// The smallest about the z axis that holds every grain present, for a laboratory without
    /// a cylinder; grains whose centroid is not above z = 0 do not count. Without grains it is as
    /// small as the largest of them.
    pub fn around(specimen: &Specimen) -> Self {
        let (mut radius, mut height) = (0.0_f64, 0.0_f64);
        for i in specimen.present() {
            let (shape, pose) = specimen.placed(i);
            if pose.translation.z > 0.0 {
                radius = radius.max(reach_from_axis(shape, pose));
                height = height.max(shape.heights(pose).1);
            }
        }
        if radius > 0.0 && height > 0.0 {
            return Self { centre_x: 0.0, radius, height };
        }
        // A metre would be too many cells of a height map for fine grains.
        let sizes = specimen.grains.grains.iter().map(|grain| grain.equivalent_diameter);
        let largest = sizes.reduce(f64::max).unwrap_or(1.0);
        Self { centre_x: 0.0, radius: largest, height: largest }
    }

    /// Inner cross-section in m².
    pub fn area(&self) -> f64 {
        std::f64::consts::PI * self.radius * self.radius
    }

    /// Whether a grain belongs to the content of the cylinder.
    ///
    /// It does when its centroid lies within the radius, above the floor, and below the rim plus
    /// one equivalent diameter of that grain: a grain may rest heaped on others that stand out of
    /// the cylinder, but one flying higher is still on its way.
    pub fn holds(&self, centroid: &Point, equivalent_diameter: f64) -> bool {
        let (x, y) = (centroid.x - self.centre_x, centroid.y);
        x * x + y * y < self.radius * self.radius
            && centroid.z > 0.0
            && centroid.z < self.height + equivalent_diameter
    }

    /// Indices of the grains in the cylinder, ascending: present, held (see
    /// [`Container::holds`]), and below the opening of the funnel while that stands.
    ///
    /// Grains falling through the cylinder count; measure a specimen at rest.
    pub fn members(&self, specimen: &Specimen) -> Vec<usize> {
        let opening = specimen.state.funnel.map_or(f64::INFINITY, |f| f.opening_height);
        specimen
            .present()
            .filter(|&i| {
                let centroid = Point::from(specimen.centroid(i));
                centroid.z < opening
                    && self.holds(&centroid, specimen.grains.grains[i].equivalent_diameter)
            })
            .collect()
    }

    /// Checks that the lengths are positive and finite.
    ///
    /// # Errors
    /// [`MeasureError`] naming the first that is not.
    pub fn check(&self) -> Result<(), MeasureError> {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        for (what, value, is_sound) in [
            ("radius", self.radius, positive(self.radius)),
            ("height", self.height, positive(self.height)),
            ("axis", self.centre_x, self.centre_x.is_finite()),
        ] {
            if !is_sound {
                return Err(MeasureError(format!(
                    "the container's {what} is {value} m, it must be a positive number"
                )));
            }
        }
        Ok(())
    }
}

/// Largest distance in m of any point of a shape at a pose from the z axis. The distance is convex,
/// so that a corner has it; the ball of a rounded polyhedron, like a sphere, adds its radius.
fn reach_from_axis(shape: &ConvexPolyhedron, pose: &Pose) -> f64 {
    let from_axis = |at: &Point| (pose * at).coords.xy().norm();
    if let Some(sphere) = shape.sphere() {
        return from_axis(&sphere.centre) + sphere.radius;
    }
    let (core, ball) = shape.core();
    core.vertices().iter().map(from_axis).fold(0.0, f64::max) + ball
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_near, cube, specimen_of};
    use super::*;
    use crate::specimen::{Fate, FunnelState};

    const CUP: Container = Container { centre_x: 0.02, radius: 0.05, height: 0.1 };

    /// Law: membership is decided by the centroid alone, by strict bounds that
    /// move with the table. Each bound is tried on both sides.
    #[test]
    fn bounds_are_where_the_documentation_says() {
        let inside = [(0.02, 0.0, 0.01), (0.0699, 0.0, 0.01), (-0.0299, 0.0, 0.01)];
        let outside = [(0.0701, 0.0, 0.01), (-0.0301, 0.0, 0.01), (0.02, 0.0501, 0.01)];
        for (x, y, z) in inside {
            assert!(CUP.holds(&Point::new(x, y, z), 0.01), "({x}, {y}, {z}) should be inside");
        }
        for (x, y, z) in outside {
            assert!(!CUP.holds(&Point::new(x, y, z), 0.01), "({x}, {y}, {z}) should be outside");
        }
        assert!(CUP.holds(&Point::new(0.02, 0.0, 0.1099), 0.01), "heaped grain should be inside");
        assert!(!CUP.holds(&Point::new(0.02, 0.0, 0.1101), 0.01), "flying grain is not inside");
        assert!(!CUP.holds(&Point::new(0.02, 0.0, -1e-9), 0.01), "grain below the floor");
        assert!(!CUP.holds(&Point::new(f64::NAN, 0.0, 0.01), 0.01), "grain at no place at all");
    }

    #[test]
    fn members_are_present_and_below_the_funnel() {
        let at = |x, z| (cube(0.01), crate::geometry::Pose::translation(x, 0.0, z));
        let mut specimen = specimen_of(vec![at(0.0, 0.02), at(0.0, 0.09), at(0.0, 0.05)]);
        assert_eq!(CUP.members(&specimen), [0, 1, 2]);
        specimen.state.bodies[2].fate = Fate::Spilled;
        assert_eq!(CUP.members(&specimen), [0, 1], "a spilled grain is gone");
        specimen.state.funnel = Some(FunnelState { opening_height: 0.08, lid: false });
        assert_eq!(CUP.members(&specimen), [0], "a grain above the opening is in the funnel");
    }

    /// Law: the smallest cylinder reaches to the farthest corner, not to the sphere about a grain.
    #[test]
    fn the_smallest_cylinder_reaches_to_corners() {
        let slab = || ConvexPolyhedron::cuboid(Vector::new(0.02, 0.002, 0.002)).expect("a slab");
        // Its long side lies along x, across the way from the axis.
        let across = Pose::translation(0.0, 0.03, 0.001);
        let got = Container::around(&specimen_of(vec![(slab(), across)]));
        assert_near(
            "radius: 10 mm along x, 31 mm along y, m",
            0.01_f64.hypot(0.031),
            got.radius,
            1e-12,
        );
        assert_near("height of its upper side, m", 0.002, got.height, 1e-12);
        let ball = (ConvexPolyhedron::ball(0.004), Pose::translation(0.03, 0.0, 0.01));
        let got = Container::around(&specimen_of(vec![ball]));
        assert_near("a sphere: centre and radius, m", 0.034, got.radius, 1e-12);
        assert_near("its top, m", 0.014, got.height, 1e-12);
        let rounded = ConvexPolyhedron::of_rounded(cube(0.006), 0.001).expect("rounded");
        let got =
            Container::around(&specimen_of(vec![(rounded, Pose::translation(0.0, 0.0, 0.004))]));
        assert_near(
            "corners of the core and the ball, m",
            0.003 * 2f64.sqrt() + 0.001,
            got.radius,
            1e-9,
        );
        assert_near("its top, m", 0.008, got.height, 1e-9);
    }

    /// Law: what does not lie above z = 0 does not count; without grains there is a cylinder all
    /// the same, no larger than a grain.
    #[test]
    fn the_smallest_cylinder_is_that_of_grains_above_zero() {
        let at = |x: f64, z: f64| (cube(0.01), Pose::translation(x, 0.0, z));
        let mut specimen = specimen_of(vec![at(0.0, 0.005), at(0.5, -0.3)]);
        let got = Container::around(&specimen);
        assert_near("radius of the grain on the floor, m", 0.005 * 2f64.sqrt(), got.radius, 1e-12);
        for grain in &mut specimen.state.bodies {
            grain.fate = Fate::Spilled;
        }
        let got = Container::around(&specimen);
        assert_eq!(got.check(), Ok(()));
        assert!(got.radius < 0.02, "law: as small as a grain, got {} m", got.radius);
    }

    #[test]
    fn sizes_are_checked() {
        assert_eq!(CUP.check(), Ok(()));
        for bad in [
            Container { radius: 0.0, ..CUP },
            Container { height: -1.0, ..CUP },
            Container { radius: f64::INFINITY, ..CUP },
            Container { centre_x: f64::NAN, ..CUP },
        ] {
            let got = bad.check();
            let said = got.as_ref().is_err_and(|why| why.0.contains("the container's "));
            assert!(said, "{bad:?}: {got:?}");
        }
    }
}
