//! The largest stress that a scenario puts on its grains, as far as it is known beforehand.

use super::*;

/// Largest stress in Pa under weight, plate, and pieces that are pressed or let go, arching left out:
/// everything rests on the floor of the cylinder, of the pile, or of the pieces that hold grains. What
/// shakes the grains up and down makes weights so much heavier as it accelerates; a load that seats the
/// plate is taken off before.
pub(super) fn largest_stress(value: &Value, grading: &Grading, gravity: f64) -> f64 {
    let seated = weight_stress(value, grading, gravity) + seating_stress(value);
    let up = upward_acceleration(value);
    let weight = weight_stress(value, grading, gravity + up).max(seated);
    weight + stress_of_pieces(value, gravity, up)
}

/// The largest acceleration upwards in m/s² of the table, or of pieces that carry the grains: of a sine
/// A (2πf)², its whole amplitude; of a recorded motion as its rows say. 0 where nothing shakes them so;
/// the jumps of a motion that starts or stops abruptly are not known as one.
fn upward_acceleration(value: &Value) -> f64 {
    let of_sine = |amplitude_mm: f64, frequency_hz: f64| {
        from_mm(amplitude_mm.abs()) * (2.0 * PI * frequency_hz).powi(2)
    };
    let of_table = stages_of(value, "vibrate").filter_map(|stage| {
        if stage["waveform"] == "file" {
            return recorded_acceleration(stage);
        }
        let up: VerticalSpec = read(&stage["vertical"])?;
        let frequency = up.frequency_hz.or_else(|| stage["frequency_hz"].as_f64())?;
        Some(of_sine(up.amplitude_mm, frequency))
    });
    let of_pieces = stages_of(value, "move").filter(|stage| carries_grains(value, stage));
    let of_pieces = of_pieces.filter_map(|stage| match read::<SineSpec>(&stage["sine"]) {
        Some(sine) => Some(of_sine(sine.amplitude_mm[2], sine.frequency_hz)),
        None => recorded_acceleration(stage),
    });
    largest(of_table.chain(of_pieces))
}

/// The largest acceleration upwards in m/s² of a stage that moves as recorded; none of others.
fn recorded_acceleration(stage: &Value) -> Option<f64> {
    let rows: Vec<[f64; 4]> = read(&stage["motion_rows"])?;
    let how: Interpolation = read(&stage["interpolation"]).unwrap_or_default();
    Some(RecordedMotion::of_piece(&rows, how).ok()?.upward_acceleration())
}

/// Whether a stage moves what the grains stand on: a container with a floor, or where there is none, any
/// piece but a wall around them.
fn carries_grains(value: &Value, stage: &Value) -> bool {
    let names = stage["pieces"].as_array().filter(|names| !names.is_empty());
    let moves =
        |piece: &PieceSpec| names.is_none_or(|names| names.iter().any(|name| *name == piece.name));
    let pieces: Vec<PieceSpec> = elements(value, "pieces").filter_map(read::<PieceSpec>).collect();
    let bears = PieceSpec::bears_within;
    let is_floor_apart = !pieces.iter().any(|piece| bears(piece) == Some(true));
    let carries = |piece: &PieceSpec| bears(piece).unwrap_or(is_floor_apart);
    pieces.iter().any(|piece| moves(piece) && carries(piece))
}

/// Height in m at which a volume of solids in m³ would stand without voids in the pieces that hold
/// grains: in the one where that is highest, as all of it may be in any, but no more than it holds.
/// Where none holds all, they may stand on each other: it is the height over the narrowest. None
/// without such pieces.
fn height_in_pieces(value: &Value, solids: f64) -> Option<f64> {
    let room = |piece: PieceSpec| -> Option<[f64; 2]> {
        let [area, volume] = piece.shape.room(piece.in_frame(Vector::z())?)?;
        Some([area * 1e-6, volume * 1e-9]).filter(|[area, _]| *area > 0.0)
    };
    let rooms: Vec<[f64; 2]> =
        elements(value, "pieces").filter_map(read::<PieceSpec>).filter_map(room).collect();
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

/// The largest stress in Pa of a load that seats the top plate; 0 without any.
fn seating_stress(value: &Value) -> f64 {
    let stages = stages_of(value, "place_top_plate");
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
    let base = stages_of(value, "slow_pluviation").find_map(|s| s["base_diameter_mm"].as_f64());
    let cylinder =
        number("apparatus.cylinder.inner_diameter_mm", CylinderSpec::default().inner_diameter_mm);
    let weight = grading.density * grading.solids * gravity / area(base.unwrap_or(cylinder));
    if stages_of(value, "place_top_plate").next().is_none() {
        return weight;
    }
    let mass = from_g(number("apparatus.top_plate.mass_g", TopPlateSpec::default().mass_g));
    weight + mass * gravity / plate_area(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::near;

    fn close(what: &str, got: f64, expected: f64) {
        near(what, got, expected, 1e-9 * expected);
    }

    /// Law: a table that shakes up and down accelerates by A ω² of its vertical component, a recorded
    /// one by the largest bend upwards of its rows.
    #[test]
    fn a_table_accelerates_upwards_as_it_moves() {
        let shaken = json!({ "stages": [
            { "stage": "vibrate", "frequency_hz": 10, "vertical": { "amplitude_mm": 5 } },
            { "stage": "vibrate", "frequency_hz": 10,
                "vertical": { "amplitude_mm": 1, "frequency_hz": 20 } },
            { "stage": "vibrate", "frequency_hz": 50, "amplitude_mm": 5 } ] });
        close("A ω², m/s²", upward_acceleration(&shaken), 0.005 * (20.0 * PI).powi(2));
        let recorded = |z_mm: f64, how: Value| {
            let rows = json!([[0, 0, 0, 0], [0.1, 9, 0, z_mm], [0.2, 0, 0, 0]]);
            upward_acceleration(&json!({ "stages": [{ "stage": "vibrate", "waveform": "file",
                "motion_rows": rows, "interpolation": how }] }))
        };
        // A natural spline through three rows bends by 3 h/τ² in the middle.
        close("down by 10 mm and up", recorded(-10.0, Value::Null), 3.0);
        close("from 0.1 m/s down to 0.1 m/s up", recorded(-10.0, json!("linear")), 2.0);
        for how in ["cubic", "linear"] {
            let (up, level) = (recorded(10.0, json!(how)), recorded(0.0, json!(how)));
            assert_eq!([up, level], [0.0; 2], "law: up and down again is the other one, {how}");
        }
    }

    /// Law: pieces that shake up and down count as the table does where the grains stand on them.
    #[test]
    fn pieces_that_carry_grains_accelerate_them() {
        let shape = |name: &str, shape: Value| json!({ "name": name, "shape": shape });
        let tube = |open: bool| {
            let size = json!({ "inner_diameter_mm": 80, "height_mm": 100, "open_bottom": open });
            json!({ "cylinder": size })
        };
        let cup = shape("cup", tube(false));
        let ring = shape("ring", tube(true));
        let lid = shape("lid", json!({ "plate": { "size_mm": [80, 80, 10] } }));
        let moved = |pieces: &[&Value], names: Value, motion: &Value| {
            let mut stage = motion.clone();
            (stage["stage"], stage["pieces"]) = (json!("move"), names);
            upward_acceleration(&json!({ "pieces": pieces, "stages": [stage] }))
        };
        let sine = json!({ "sine": { "amplitude_mm": [3, 0, -2], "frequency_hz": 20 } });
        let expected = 0.002 * (40.0 * PI).powi(2);
        let held = [&cup, &lid];
        close("with the cup", moved(&held, json!(["cup"]), &sine), expected);
        close("with all that stands", moved(&held, json!([]), &sine), expected);
        assert_eq!(moved(&held, json!(["lid"]), &sine), 0.0, "law: a lid carries nothing");
        let apart = [&ring, &lid];
        close("with a floor of its own", moved(&apart, json!(["lid"]), &sine), expected);
        assert_eq!(moved(&apart, json!(["ring"]), &sine), 0.0, "law: nor does a ring");
        let rows = json!([[0, 0, 0, 0], [0.1, 0, 0, -10], [0.2, 0, 0, 0]]);
        let recorded = json!({ "motion_rows": rows });
        close("as recorded", moved(&held, json!(["cup"]), &recorded), 3.0);
        let level = json!({ "velocity_mm_per_s": [0, 0, 50], "ramp_s": 0.1 });
        assert_eq!(moved(&held, json!(["cup"]), &level), 0.0, "law: a velocity shakes nothing");
    }

    /// 1 kg of grains, 400 cm³ of solids.
    fn kilogram() -> Grading {
        let sizes = crate::scale::GrainSizes::PAPER;
        Grading { sizes, density: 2500.0, solids: 4e-4, count: 1000.0 }
    }

    /// Law: shaken, everything weighs more: the grains, and what is let go or pressed on them.
    #[test]
    fn what_is_shaken_is_heavier() {
        let grading = kilogram();
        let of = |amplitude_mm: f64| {
            let value = json!({
                "pieces": [
                    { "name": "box", "shape": { "box": { "inner_mm": [100, 100, 50] } } },
                    { "name": "lid", "shape": { "plate": { "size_mm": [100, 100, 10] } } }
                ],
                "stages": [{ "stage": "release", "pieces": ["lid"], "mass_g": 200 },
                    { "stage": "move", "pieces": ["box"], "duration_s": 1,
                      "sine": { "amplitude_mm": [0, 0, amplitude_mm], "frequency_hz": 10 } }]
            });
            largest_stress(&value, &grading, 10.0)
        };
        // 1 kg of grains and 200 g on 100 cm².
        close("at rest", of(0.0), 1200.0);
        close("with 3.9 g", of(10.0), 1200.0 * (1.0 + 0.001 * (20.0 * PI).powi(2)));
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
        let weights = stress(&[0.0], 0.0);
        let of_load = |load: f64| load / (PI / 4.0 * 0.05_f64.powi(2));
        close("100 N on 19.6 cm²", stress(&[100.0], 0.0) - weights, of_load(100.0));
        close("the larger of two", stress(&[30.0, 100.0, 0.0], 0.0), weights + of_load(100.0));
        let shaken = stress(&[0.0], 20.0);
        assert!(shaken > 2.0 * weights, "law: by 79 m/s², from {weights} to {shaken} Pa");
        close("taken off before it shakes", stress(&[1.0], 20.0), shaken);
    }

    /// Law: in a laboratory grains weigh on the floor of the piece that holds them, however wide the
    /// built-in cylinder is: of several that could, where they stand highest.
    #[test]
    fn grains_weigh_on_the_floor_of_the_piece_that_holds_them() {
        let grading = kilogram();
        let stress = |pieces: Value| {
            let value = json!({
                "apparatus": { "cylinder": { "inner_diameter_mm": 50 } }, "pieces": pieces
            });
            weight_stress(&value, &grading, 10.0)
        };
        let box_of = |inner: [f64; 3]| json!({ "box": { "inner_mm": inner } });
        let piece = |shape: Value| json!({ "name": "a", "shape": shape });
        let wide = box_of([200.0, 100.0, 50.0]);
        close("10 N on 200 cm²", stress(json!([piece(wide.clone())])), 500.0);
        let mut on_its_side = piece(wide.clone());
        on_its_side["rotation_deg"] = json!([90, 0, 0]);
        close("put up on a side of 100 cm²", stress(json!([on_its_side])), 1000.0);
        let tube = json!({ "cylinder": { "inner_diameter_mm": 80, "height_mm": 150 } });
        let circle = PI / 4.0 * 0.08_f64.powi(2);
        close("10 N in a tube", stress(json!([piece(tube.clone())])), 10.0 / circle);
        let both = json!([piece(wide.clone()), piece(tube)]);
        close("a tube on a tray", stress(both), 10.0 / circle);
        let drum = json!({ "drum": { "inner_diameter_mm": 100, "length_mm": 80 } });
        close("a drum, by its middle", stress(json!([piece(drum)])), 1250.0);
        // A ring of 4 cm³ bears what fits into it; of two halves each may bear all.
        let ring = box_of([20.0, 20.0, 10.0]);
        close("a low ring on a tray", stress(json!([piece(wide), piece(ring)])), 500.0);
        let half = box_of([60.0, 60.0, 70.0]);
        close("two halves", stress(json!([piece(half.clone()), piece(half)])), 10.0 / 36e-4);
        let bin = json!({ "hopper": { "opening_diameter_mm": 80, "top_diameter_mm": 160,
            "half_angle_deg": 45, "collar_mm": 100 } });
        let of_top = 10.0 / (PI / 4.0 * 0.16_f64.powi(2));
        close("a bin as wide as its top", stress(json!([piece(bin.clone())])), of_top);
        let low = json!({ "hopper": { "opening_diameter_mm": 30, "top_diameter_mm": 50,
            "half_angle_deg": 89 } });
        close("a ring in its floor", stress(json!([piece(bin), piece(low)])), of_top);
        let plate = json!({ "plate": { "size_mm": [500, 500, 10] } });
        let of_cylinder = 10.0 / (PI / 4.0 * 0.05_f64.powi(2));
        close("nothing holds grains", stress(json!([piece(plate)])), of_cylinder);
        close("no pieces", stress(json!([])), of_cylinder);
    }
}
