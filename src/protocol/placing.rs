//! Where the top plate is laid, and how it is seated.

use super::*;
use crate::scenario::PlaceTopPlateSpec;

/// Share of the clearance between plate and cylinder that is drawn from where no offset is
/// given: the rest keeps the plate's corners off the flat pieces of the wall.
const SHARE_OF_CLEARANCE: f64 = 0.8;

/// How a plate is laid on the grains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placing {
    /// Horizontal offset from the axis in m.
    pub offset: Vector,
    /// Rotation about the vertical in radians.
    pub turn: f64,
    /// Mass in kg of the weight that seats it; 0 for none.
    pub weight: f64,
    /// Longest time in s of each settling.
    pub limit: f64,
}

impl Placing {
    /// That of a stage.
    pub(super) fn of(stage: &PlaceTopPlateSpec, setup: &Setup) -> Self {
        let clearance = (setup.cylinder.radius - setup.plate.radius).max(0.0);
        let largest = stage.offset_mm.map_or(SHARE_OF_CLEARANCE * clearance, from_mm);
        let (offset, turn) = match stage.placement {
            0 => (Vector::zeros(), 0.0),
            n => drawn(setup, n, largest, stage.rotation_deg.to_radians()),
        };
        let weight = stage.seating_load_n / setup.gravity;
        Self { offset, turn, weight, limit: stage.time_limit_s }
    }

    /// Parts of the stage: the plate is laid; with a weight, it is loaded, and unloaded.
    pub(super) fn parts(&self) -> u32 {
        if self.weight > 0.0 { 3 } else { 1 }
    }

    /// The plate as it is in a part of the stage: with the weight on it, as if it filled the
    /// plate's volume, it is heavier.
    pub(super) fn plate(&self, plate: &TopPlate, part: u32) -> TopPlate {
        let mut plate = plate.clone();
        if part == 1 {
            plate.inertia *= (plate.mass + self.weight) / plate.mass;
            plate.mass += self.weight;
        }
        plate
    }

    /// Where the plate begins, its centre at a height in m above a table at a place.
    pub(super) fn pose(&self, table: Vector, height: f64) -> Pose {
        let mut pose = Pose::translation(table.x, table.y, height);
        if (self.offset, self.turn) != (Vector::zeros(), 0.0) {
            pose.translation.vector += self.offset;
            pose.rotation = nalgebra::UnitQuaternion::from_axis_angle(&Vector::z_axis(), self.turn);
        }
        pose
    }
}

/// Offset and turn of a placement, within limits in m and radians.
fn drawn(setup: &Setup, placement: u32, offset: f64, turn: f64) -> (Vector, f64) {
    let name = format!("placement {placement} of the plate, configuration {}", setup.configuration);
    let mut rng = stream(setup.seed, &name);
    let (x, y, _) = in_unit_disc(&mut rng);
    (Vector::new(offset * x, offset * y, 0.0), turn * (2.0 * uniform(&mut rng) - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::testing::*;

    fn setup(configuration: u32) -> Setup {
        let scenario = scenario_of(json!({
            "configuration": configuration,
            "grains": { "total_mass_g": 60, "density_kg_per_m3": 2673.9,
                "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] }
        }));
        Setup::new(&scenario).expect("a laboratory")
    }

    fn placing(fields: &str, configuration: u32) -> Placing {
        let stage = format!("{{\"stage\": \"place_top_plate\"{fields}}}");
        let StageSpec::PlaceTopPlate(stage) = serde_json::from_str(&stage).expect("a stage") else {
            panic!("it lays a plate");
        };
        Placing::of(&stage, &setup(configuration))
    }

    #[test]
    fn the_first_placement_is_on_the_axis_whatever_the_limits() {
        let got = placing(", \"offset_mm\": 1, \"rotation_deg\": 90", 1);
        assert_eq!((got.offset, got.turn, got.parts()), (Vector::zeros(), 0.0, 1));
        let at = got.pose(Vector::new(0.01, 0.0, 0.0), 0.2);
        assert_eq!(at, Pose::translation(0.01, 0.0, 0.2), "law: the bits of a plain pose");
    }

    #[test]
    fn placements_are_drawn_within_their_limits_and_each_by_itself() {
        let clearance = 1e-3;
        let mut offsets = Vec::new();
        for n in 1..=400 {
            let got = placing(&format!(", \"placement\": {n}"), 1);
            assert_eq!(
                got,
                placing(&format!(", \"placement\": {n}"), 1),
                "law: same seed, same draw"
            );
            assert!(
                got.offset.norm() <= 0.8 * clearance && got.offset.z == 0.0,
                "{:?}",
                got.offset
            );
            assert!(got.turn.abs() <= std::f64::consts::PI, "{}", got.turn);
            offsets.push(got.offset);
        }
        // A uniform disc of radius R has the mean squared radius R²/2; its standard error here is 3 %.
        let mean = offsets.iter().map(|o| o.norm_squared()).sum::<f64>() / 400.0;
        let expected = (0.8 * clearance).powi(2) / 2.0;
        near("uniform on a disc", mean, expected, 0.12 * expected);
        assert_ne!(placing(", \"placement\": 1", 1), placing(", \"placement\": 1", 2));
        let own = placing(", \"placement\": 3, \"offset_mm\": 0, \"rotation_deg\": 0", 1);
        assert_eq!((own.offset, own.turn), (Vector::zeros(), 0.0), "law: no limit, no draw");
    }

    #[test]
    fn a_seating_load_is_a_weight_in_the_second_part_alone() {
        let got = placing(", \"seating_load_n\": 9.81", 1);
        let plate = setup(1).plate;
        assert_eq!(got.parts(), 3, "law: laid, loaded, unloaded");
        for part in [0, 2] {
            assert_eq!(got.plate(&plate, part), plate);
        }
        let loaded = got.plate(&plate, 1);
        assert!(
            (loaded.mass - plate.mass - 1.0).abs() < 1e-12,
            "law: m = F/g, expected 1 kg more, got {}",
            loaded.mass - plate.mass
        );
        let (ratio, expected) = (loaded.inertia.z / plate.inertia.z, loaded.mass / plate.mass);
        assert!((ratio - expected).abs() < 1e-12, "law: inertia as mass, {ratio}, {expected}");
    }
}
