//! The largest stress that a scenario puts on its grains, as far as it is known beforehand.

use nalgebra::UnitQuaternion;

use super::*;
use crate::units::{from_deg, from_kpa};

/// Largest stress in Pa under weight, plate and pressed pieces, arching left out: everything rests
/// on the floor of the cylinder, of the pile, or of the pieces that hold grains. A table that shakes up and down makes weights so
/// much heavier as it accelerates; a load that seats the plate is taken off before.
pub(super) fn largest_stress(value: &Value, grading: &Grading, gravity: f64) -> f64 {
    let seated = weight_stress(value, grading, gravity) + seating_stress(value);
    let gravity = gravity + upward_acceleration(value);
    let weight = weight_stress(value, grading, gravity).max(seated);
    weight + pressed_stress(value).max(free_stress(value, gravity))
}

/// The largest acceleration in m/s² of the table along z, A (2πf)²; 0 where nothing shakes it so.
/// That of a recorded motion is not read.
fn upward_acceleration(value: &Value) -> f64 {
    largest(stages(value, "vibrate").filter_map(|stage| {
        let up: VerticalSpec = read(&stage["vertical"])?;
        let frequency = up.frequency_hz.or_else(|| stage["frequency_hz"].as_f64())?;
        Some(from_mm(up.amplitude_mm) * (2.0 * PI * frequency).powi(2))
    }))
}

/// The stages of a name.
fn stages<'a>(value: &'a Value, name: &'static str) -> impl Iterator<Item = &'a Value> {
    list(value, "stages").filter(move |stage| stage["stage"] == name)
}

/// The elements of a list; none of what is no list.
fn list<'a>(value: &'a Value, name: &str) -> impl Iterator<Item = &'a Value> {
    value[name].as_array().into_iter().flatten()
}

/// The piece of a name.
fn piece(value: &Value, name: &str) -> Option<PieceSpec> {
    list(value, "pieces").filter_map(read::<PieceSpec>).find(|piece| piece.name == name)
}

/// A direction in the frame of a piece, as it was put up.
fn in_frame(piece: &PieceSpec, direction: Vector) -> Option<[f64; 3]> {
    let [x, y, z] = piece.rotation_deg.map(from_deg);
    let turn = UnitQuaternion::from_euler_angles(x, y, z);
    Some((turn.inverse() * direction.try_normalize(0.0)?).into())
}

/// Area in m² that a piece of a name, as it was put up, shows along a direction.
fn shown_area(value: &Value, name: &str, direction: Vector) -> Option<f64> {
    let piece = piece(value, name)?;
    Some(piece.shape.shows_mm2(in_frame(&piece, direction)?)? * 1e-6)
}

/// Height in m at which a volume of solids in m³ would stand without voids in the pieces that hold
/// grains: in the one where that is highest, as all of it may be in any, but no more than it holds.
/// Where none holds all, they may stand on each other: it is the height over the narrowest. None
/// without such pieces.
fn height_in_pieces(value: &Value, solids: f64) -> Option<f64> {
    let room = |piece: PieceSpec| -> Option<[f64; 2]> {
        let [area, volume] = piece.shape.room(in_frame(&piece, Vector::z())?)?;
        Some([area * 1e-6, volume * 1e-9]).filter(|[area, _]| *area > 0.0)
    };
    let rooms: Vec<[f64; 2]> =
        list(value, "pieces").filter_map(read::<PieceSpec>).filter_map(room).collect();
    let holds_all = rooms.iter().any(|[_, volume]| *volume >= solids);
    let height = |[area, volume]: &[f64; 2]| {
        if holds_all { solids.min(*volume) / area } else { solids / area }
    };
    rooms.iter().map(height).max_by(f64::total_cmp)
}

/// The largest of stresses that are numbers; 0 without any.
fn largest(stresses: impl Iterator<Item = f64>) -> f64 {
    stresses.filter(|stress| stress.is_finite()).fold(0.0, f64::max)
}

/// The largest stress in Pa of the weight of a piece that is let go, lying as it was put up, of
/// those whose mass is given; 0 without any.
fn free_stress(value: &Value, gravity: f64) -> f64 {
    largest(stages(value, "release").flat_map(|stage| {
        let weight = stage["mass_g"].as_f64().map_or(0.0, from_g) * gravity;
        let areas =
            list(stage, "pieces").filter_map(|name| shown_area(value, name.as_str()?, Vector::z()));
        areas.map(move |area| weight / area)
    }))
}

/// The largest stress in Pa of a piece that is pressed; 0 without any.
fn pressed_stress(value: &Value) -> f64 {
    let loads = stages(value, "press").flat_map(|stage| list(stage, "loads"));
    largest(loads.filter_map(read::<LoadSpec>).filter_map(|load| {
        if let Some(stress) = load.stress_kpa {
            return Some(from_kpa(stress));
        }
        if let Some(moment) = load.moment_n_m {
            // Moment in N m by which the piece resists being turned under a pressure of 1 Pa.
            let of_one_pa = piece(value, &load.piece)?.shape.turned_mm3()? * 1e-9;
            return Some(moment / of_one_pa);
        }
        Some(load.force_n? / shown_area(value, &load.piece, load.direction.into())?)
    }))
}

/// The largest stress in Pa of a load that seats the top plate; 0 without any.
fn seating_stress(value: &Value) -> f64 {
    let stages = stages(value, "place_top_plate");
    let loads = stages.filter_map(|stage| stage["seating_load_n"].as_f64());
    largest(loads.map(|load| load / plate_area(value)))
}

/// Area in m² of the top plate.
fn plate_area(value: &Value) -> f64 {
    let diameter = number_at(value, "apparatus.top_plate.diameter_mm");
    area(diameter.unwrap_or(TopPlateSpec::default().diameter_mm))
}

/// Area in m² of a circle of a diameter in mm.
fn area(diameter_mm: f64) -> f64 {
    PI / 4.0 * from_mm(diameter_mm).powi(2)
}

/// The stress in Pa of the weight of all grains and the top plate on the floor of the cylinder, of the
/// pile, or of the pieces that hold grains.
pub(super) fn weight_stress(value: &Value, grading: &Grading, gravity: f64) -> f64 {
    let number = |path: &str, default: f64| number_at(value, path).unwrap_or(default);
    if let Some(height) = height_in_pieces(value, grading.solids) {
        return grading.density * gravity * height;
    }
    let base = stages(value, "slow_pluviation").find_map(|s| s["base_diameter_mm"].as_f64());
    let cylinder =
        number("apparatus.cylinder.inner_diameter_mm", CylinderSpec::default().inner_diameter_mm);
    let weight = grading.density * grading.solids * gravity / area(base.unwrap_or(cylinder));
    if stages(value, "place_top_plate").next().is_none() {
        return weight;
    }
    let mass = from_g(number("apparatus.top_plate.mass_g", TopPlateSpec::default().mass_g));
    weight + mass * gravity / plate_area(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::near;

    #[test]
    fn a_force_presses_by_the_area_that_the_piece_shows_along_it() {
        let stress = |load: Value, turn: [f64; 3]| {
            pressed_stress(&json!({
                "pieces": [{ "name": "lid", "shape": { "plate": { "size_mm": [100, 50, 10] } },
                    "rotation_deg": turn }],
                "stages": [{ "stage": "press", "loads": [load] }, { "stage": "rest" }]
            }))
        };
        let near = |what: &str, got: f64, expected: f64| near(what, got, expected, 1e-9 * expected);
        let down = json!({ "piece": "lid", "force_n": 10 });
        near("10 N on 50 cm²", stress(down.clone(), [0.0; 3]), 2000.0);
        near("on its edge of 10 cm²", stress(down, [90.0, 0.0, 0.0]), 10_000.0);
        let aside = json!({ "piece": "lid", "force_n": 10, "direction": [-2, 0, 0] });
        near("along x on 5 cm²", stress(aside, [0.0; 3]), 20_000.0);
        let typed = json!({ "piece": "lid", "stress_kpa": 7 });
        near("as typed", stress(typed, [0.0; 3]), 7000.0);
        let dropped = free_stress(
            &json!({
                "pieces": [{ "name": "lid", "shape": { "plate": { "size_mm": [100, 50, 10] } } }],
                "stages": [{ "stage": "release", "pieces": ["lid"], "mass_g": 1000 }]
            }),
            9.81,
        );
        near("1 kg let go on 50 cm²", dropped, 1962.0);
        let vane = json!({
            "pieces": [{ "name": "vane", "shape": { "vane": { "diameter_mm": 50, "height_mm": 40,
                "blade_mm": 3, "blades": 4 } } }],
            "stages": [{ "stage": "press",
                "loads": [{ "piece": "vane", "moment_n_m": 2, "axis": [0, 0, 1] }] }]
        });
        near("2 N m on four blades of 25 by 40 mm", pressed_stress(&vane), 40_000.0);
        let shaken = json!({ "stages": [
            { "stage": "vibrate", "frequency_hz": 10, "vertical": { "amplitude_mm": 5 } },
            { "stage": "vibrate", "frequency_hz": 10,
                "vertical": { "amplitude_mm": 1, "frequency_hz": 20 } },
            { "stage": "vibrate", "frequency_hz": 50, "amplitude_mm": 5 } ] });
        near("A ω², m/s²", upward_acceleration(&shaken), 0.005 * (20.0 * PI).powi(2));
        let other = json!({ "piece": "other", "force_n": 10 });
        assert_eq!(stress(other, [0.0; 3]), 0.0, "law: what cannot be read counts for nothing");
    }

    /// Law: the largest load that seats the plate presses by the plate's area, beside the weights
    /// at rest; a table that shakes does so without it.
    #[test]
    fn a_seating_load_presses_by_the_area_of_the_plate() {
        let grains = json!({ "total_mass_g": 600, "density_kg_per_m3": 2650,
            "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] });
        let grading = Grading::of_json(&grains).expect("a grading");
        let stress = |loads: &[f64], up_mm: f64| {
            let stage = "place_top_plate";
            let placed = |load: &f64| json!({ "stage": stage, "seating_load_n": load });
            let mut stages: Vec<Value> = loads.iter().map(placed).collect();
            stages.push(json!({ "stage": "vibrate", "frequency_hz": 10,
                "vertical": { "amplitude_mm": up_mm } }));
            let value = json!({
                "apparatus": { "top_plate": { "diameter_mm": 50, "mass_g": 100 } },
                "stages": stages
            });
            largest_stress(&value, &grading, 9.81)
        };
        let near = |what: &str, got: f64, expected: f64| near(what, got, expected, 1e-9 * expected);
        let weights = stress(&[0.0], 0.0);
        let of_load = |load: f64| load / (PI / 4.0 * 0.05_f64.powi(2));
        near("100 N on 19.6 cm²", stress(&[100.0], 0.0) - weights, of_load(100.0));
        near("the larger of two", stress(&[30.0, 100.0, 0.0], 0.0), weights + of_load(100.0));
        let shaken = stress(&[0.0], 20.0);
        assert!(shaken > 2.0 * weights, "law: by 79 m/s², from {weights} to {shaken} Pa");
        near("taken off before it shakes", stress(&[1.0], 20.0), shaken);
    }
    /// Law: in a laboratory grains weigh on the floor of the piece that holds them, however wide the
    /// built-in cylinder is: of several that could, where they stand highest.
    #[test]
    fn grains_weigh_on_the_floor_of_the_piece_that_holds_them() {
        // 1 kg, 400 cm³ of solids.
        let grading = Grading {
            sizes: crate::scale::GrainSizes::PAPER,
            density: 2500.0,
            solids: 4e-4,
            count: 1000.0,
        };
        let stress = |pieces: Value| {
            let value = json!({
                "apparatus": { "cylinder": { "inner_diameter_mm": 50 } }, "pieces": pieces
            });
            weight_stress(&value, &grading, 10.0)
        };
        let box_of = |inner: [f64; 3]| json!({ "box": { "inner_mm": inner } });
        let piece = |shape: Value| json!({ "name": "a", "shape": shape });
        let near = |what: &str, got: f64, expected: f64| near(what, got, expected, 1e-9 * expected);
        let wide = box_of([200.0, 100.0, 50.0]);
        near("10 N on 200 cm²", stress(json!([piece(wide.clone())])), 500.0);
        let mut on_its_side = piece(wide.clone());
        on_its_side["rotation_deg"] = json!([90, 0, 0]);
        near("put up on a side of 100 cm²", stress(json!([on_its_side])), 1000.0);
        let tube = json!({ "cylinder": { "inner_diameter_mm": 80, "height_mm": 150 } });
        let circle = PI / 4.0 * 0.08_f64.powi(2);
        near("10 N in a tube", stress(json!([piece(tube.clone())])), 10.0 / circle);
        let both = json!([piece(wide.clone()), piece(tube)]);
        near("a tube on a tray", stress(both), 10.0 / circle);
        let drum = json!({ "drum": { "inner_diameter_mm": 100, "length_mm": 80 } });
        near("a drum, by its middle", stress(json!([piece(drum)])), 1250.0);
        // A ring of 4 cm³ bears what fits into it; of two halves each may bear all.
        let ring = box_of([20.0, 20.0, 10.0]);
        near("a low ring on a tray", stress(json!([piece(wide), piece(ring)])), 500.0);
        let half = box_of([60.0, 60.0, 70.0]);
        near("two halves", stress(json!([piece(half.clone()), piece(half)])), 10.0 / 36e-4);
        let bin = json!({ "hopper": { "opening_diameter_mm": 80, "top_diameter_mm": 160,
            "half_angle_deg": 45, "collar_mm": 100 } });
        let of_top = 10.0 / (PI / 4.0 * 0.16_f64.powi(2));
        near("a bin as wide as its top", stress(json!([piece(bin.clone())])), of_top);
        let low = json!({ "hopper": { "opening_diameter_mm": 30, "top_diameter_mm": 50,
            "half_angle_deg": 89 } });
        near("a ring in its floor", stress(json!([piece(bin), piece(low)])), of_top);
        let plate = json!({ "plate": { "size_mm": [500, 500, 10] } });
        let of_cylinder = 10.0 / (PI / 4.0 * 0.05_f64.powi(2));
        near("nothing holds grains", stress(json!([piece(plate)])), of_cylinder);
        near("no pieces", stress(json!([])), of_cylinder);
    }
}
