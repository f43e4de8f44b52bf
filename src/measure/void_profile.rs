//! Void ratio in layers from the floor up, exact: grains are cut where layers meet.

use super::{Container, Region};
use crate::geometry::Vector;
use crate::specimen::Specimen;

/// A horizontal layer of the specimen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Height of its lower side above the floor, in m.
    pub low: f64,
    /// Height of its upper side above the floor, in m.
    pub high: f64,
    /// Volume in m³ of the grains within it; where grains overlap, both count.
    pub solids_volume: f64,
    /// Void ratio e = V/Vₛ − 1; `None` where no grain is.
    pub void_ratio: Option<f64>,
}

/// Void ratio of `layers` layers of equal thickness from the floor up to a height in m.
///
/// V is the container's cross-section times the thickness, Vₛ the volume of the
/// parts of its grains ([`Container::members`]) that lie between the layer's sides. Grains are
/// cut exactly, so that the layers' solids add up to those of all grains where the height is that
/// of the highest point.
///
/// No layers where the height is not a positive number.
pub fn void_profile(
    specimen: &Specimen,
    container: &Container,
    height: f64,
    layers: usize,
) -> Vec<Layer> {
    if !(height > 0.0 && height.is_finite()) {
        return Vec::new();
    }
    let at = |n: usize| height * n as f64 / layers as f64;
    let mut solids = vec![0.0; layers];
    for i in container.members(specimen) {
        let shape = &specimen.grains.grains[i].shape;
        let pose = &specimen.state.bodies[i].body.pose;
        let centre = pose.translation.vector;
        // Sides that hold the whole grain, near to it: only heights cut.
        let reach = Vector::repeat(2.0 * shape.radius_about_origin());
        let (low, high) = (centre - reach, centre + reach);
        for (n, solids) in solids.iter_mut().enumerate() {
            if at(n) >= high.z || at(n + 1) <= low.z {
                continue;
            }
            let layer = Region {
                low: Vector::new(low.x, low.y, at(n)),
                high: Vector::new(high.x, high.y, at(n + 1)),
            };
            *solids += layer.volume_of(shape, pose);
        }
    }
    let whole = container.area() * height / layers as f64;
    let layer = |(n, solids_volume): (usize, f64)| Layer {
        low: at(n),
        high: at(n + 1),
        solids_volume,
        // What is left of rounding is no grain.
        void_ratio: (solids_volume > 1e-9 * whole).then(|| whole / solids_volume - 1.0),
    };
    solids.into_iter().enumerate().map(layer).collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_near, cube, random, random_pose, specimen_of};
    use super::*;
    use crate::geometry::Pose;

    const CUP: Container = Container { centre_x: 0.0, radius: 0.05, height: 0.2 };

    /// Law: of a cube of 10 mm between 5 and 15 mm above the floor, layers of 10 mm hold half
    /// each: e = A · 10 mm / 0.5 cm³ − 1; a layer above holds nothing.
    #[test]
    fn a_cube_is_shared_by_two_layers() {
        let specimen = specimen_of(vec![(cube(0.01), Pose::translation(0.0, 0.0, 0.01))]);
        let got = void_profile(&specimen, &CUP, 0.03, 3);
        let whole = std::f64::consts::PI * 0.05 * 0.05 * 0.01;
        assert_eq!(got.len(), 3, "law: as many layers as asked for");
        for (n, layer) in got.iter().take(2).enumerate() {
            assert_near("lower side", 0.01 * n as f64, layer.low, 1e-15);
            assert_near("upper side", 0.01 * (n + 1) as f64, layer.high, 1e-15);
            assert_near("half of the cube", 0.5e-6, layer.solids_volume, 1e-18);
            let e = layer.void_ratio.expect("a void ratio");
            assert_near("e = V/Vs - 1", whole / 0.5e-6 - 1.0, e, 1e-9);
        }
        assert_eq!(got[2].void_ratio, None, "law: no solids, no ratio");
    }

    /// Law: layers that hold all grains hold their volume, however they lie; grains outside of
    /// the container do not count.
    #[test]
    fn layers_lose_nothing_between_them() {
        let mut rng = random(5);
        let mut grains: Vec<_> = (0..20)
            .map(|n| {
                let lift = Pose::translation(0.0, 0.0, 0.03 + 0.005 * f64::from(n));
                (cube(0.01), lift * random_pose(&mut rng, 0.01))
            })
            .collect();
        grains.push((cube(0.01), Pose::translation(1.0, 0.0, 0.05)));
        let specimen = specimen_of(grains);
        let sum: f64 = void_profile(&specimen, &CUP, 0.2, 17).iter().map(|l| l.solids_volume).sum();
        assert_near("solids of twenty cubes in all layers", 20e-6, sum, 1e-17);
    }

    #[test]
    fn without_a_height_there_are_no_layers() {
        let specimen = specimen_of(vec![(cube(0.01), Pose::translation(0.0, 0.0, 0.01))]);
        for height in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(void_profile(&specimen, &CUP, height, 3), [], "law: no layers at {height}");
        }
        assert_eq!(void_profile(&specimen, &CUP, 0.1, 0), [], "law: none were asked for");
    }
}
