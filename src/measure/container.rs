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
    /// a cylinder; grains below z = 0 do not count.
    pub fn around(specimen: &Specimen) -> Self {
        let (mut radius, mut height) = (0.0_f64, 0.0_f64);
        for i in specimen.present() {
            let reach = specimen.grains.grains[i].shape.radius_about_origin();
            let at = specimen.state.bodies[i].body.pose.translation.vector;
            radius = radius.max(at.xy().norm() + reach);
            height = height.max(at.z + reach);
        }
        let or_any = |length: f64| if length > 0.0 { length } else { 1.0 };
        Self { centre_x: 0.0, radius: or_any(radius), height: or_any(height) }
    }

    /// Inner cross-section in m².
    pub fn area(&self) -> f64 {
        std::f64::consts::PI * self.radius * self.radius
    }

    /// Whether a grain belongs to the content of the cylinder.
    ///
    /// It does when its centroid lies within the radius, above the floor, and
    /// below the rim plus one equivalent diameter of that grain: a grain may
    /// rest heaped on others that stand out of the cylinder, but one flying
    /// higher is still on its way.
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
                let centroid = Point::from(specimen.state.bodies[i].body.pose.translation.vector);
                centroid.z < opening
                    && self.holds(&centroid, specimen.grains.grains[i].equivalent_diameter)
            })
            .collect()
    }

    /// Checks that the lengths are positive and finite.
    ///
    /// # Errors
    /// [`MeasureError::BadContainer`].
    pub fn check(&self) -> Result<(), MeasureError> {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        for (what, value) in [("radius", self.radius), ("height", self.height)] {
            if !positive(value) {
                return Err(MeasureError::BadContainer { what, value });
            }
        }
        if !self.centre_x.is_finite() {
            return Err(MeasureError::BadContainer { what: "axis", value: self.centre_x });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{cube, specimen_of};
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

    #[test]
    fn sizes_are_checked() {
        assert_eq!(CUP.check(), Ok(()));
        for bad in [
            Container { radius: 0.0, ..CUP },
            Container { height: -1.0, ..CUP },
            Container { radius: f64::INFINITY, ..CUP },
            Container { centre_x: f64::NAN, ..CUP },
        ] {
            assert!(matches!(bad.check(), Err(MeasureError::BadContainer { .. })), "{bad:?}");
        }
    }
}
