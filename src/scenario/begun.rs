//! What a scenario that begins with a specimen may not say otherwise than the run that made it,
//! and which automatic values it takes over.

use super::*;

/// The faults of what contradicts the specimen: its grains are what they are, and its pieces stand
/// where the run has left them. `run` is that run's scenario, `own` what is laid over it.
pub(super) fn contradictions(run: &Map<String, Value>, own: &Value) -> Vec<Fault> {
    let fault = |(path, found, allowed): (String, Value, String), why: &str| {
        Fault::new(format!("{why}: leave the field out"), found, allowed).at(path)
    };
    let grains = own.get("grains").and_then(|own| {
        let run = run.get("grains").unwrap_or(&Value::Null);
        let is_file_of_sieved =
            !own["file"].is_null() && !run["sieve_table"].is_null() && run["meshes"].is_null();
        let of_file = || ("grains.file".to_owned(), own["file"].clone(), "nothing".to_owned());
        difference("grains", run, own).or(is_file_of_sieved.then(of_file))
    });
    let grains = grains.map(|d| fault(d, "a specimen that is begun with has its grains"));
    let mut faults: Vec<Fault> = grains.into_iter().collect();
    let none = Vec::new();
    let there = run.get("pieces").and_then(Value::as_array).unwrap_or(&none);
    let Some(pieces) = own.get("pieces").and_then(Value::as_array) else { return faults };
    if pieces.len() != there.len() {
        let names: Vec<&str> = there.iter().filter_map(|p| p["name"].as_str()).collect();
        let message = "the specimen has other pieces: leave the field out";
        faults.push(Fault::new(message, pieces.len(), names.join(", ")).at("pieces"));
        return faults;
    }
    for (n, (piece, own)) in there.iter().zip(pieces).enumerate() {
        let path = format!("pieces[{n}]");
        let place = ["name", "shape", "at_mm", "rotation_deg"];
        let found = place.iter().find_map(|field| {
            let own = own.get(field)?;
            difference(&format!("{path}.{field}"), piece.get(*field).unwrap_or(&Value::Null), own)
        });
        faults
            .extend(found.map(|d| fault(d, "the specimen's pieces are as the run has left them")));
    }
    faults
}

/// The faults of another apparatus than that in which the specimen stands after stages of these
/// names: grains would lie within it, or away from it. A plate that lies there may get another mass.
pub(super) fn other_apparatus(
    run: &Map<String, Value>,
    own: &Value,
    after: &[String],
) -> Vec<Fault> {
    let done = |stage: &str| after.iter().any(|name| name == stage);
    let parts = [
        ("funnel", done("fill_funnel") && !done("pour")),
        ("cylinder", done("pour")),
        ("top_plate", done("place_top_plate")),
    ];
    let mut faults = Vec::new();
    for (part, _) in parts.into_iter().filter(|(_, stands)| *stands) {
        let there = run.get("apparatus").map_or(&Value::Null, |all| &all[part]);
        let typed = own["apparatus"][part].as_object().into_iter().flatten();
        for (field, own) in typed.filter(|(field, _)| field.as_str() != "mass_g") {
            let path = format!("apparatus.{part}.{field}");
            let found = difference(&path, &there[field], own).map(|(path, found, allowed)| {
                let message = "the specimen stands in the run's apparatus: leave the field out";
                Fault::new(message, found, allowed).at(path)
            });
            faults.extend(found);
        }
    }
    faults
}

/// The first field of `own` that the run has otherwise: its path, what was found, and what the run
/// has. What `own` leaves out is as in the run; files may have other names.
fn difference(path: &str, run: &Value, own: &Value) -> Option<(String, Value, String)> {
    match (run, own) {
        (Value::Object(run), Value::Object(own)) => {
            own.iter().filter(|(field, _)| field.as_str() != "file").find_map(|(field, own)| {
                let there = run.get(field).unwrap_or(&Value::Null);
                difference(&field_path(path, field), there, own)
            })
        }
        (Value::Array(run), Value::Array(own)) if run.len() == own.len() => {
            let mut both = run.iter().zip(own).enumerate();
            both.find_map(|(n, (run, own))| difference(&format!("{path}[{n}]"), run, own))
        }
        (Value::Number(one), Value::Number(two)) if one.as_f64() == two.as_f64() => None,
        (run, own) if run == own => None,
        (run, own) => {
            let allowed = if run.is_null() { "nothing".to_owned() } else { run.to_string() };
            Some((path.to_owned(), own.clone(), allowed))
        }
    }
}

/// Which of the values that follow from loads a document takes over from a run.
pub(super) fn taken_over(run: &Map<String, Value>, own: &Value) -> Vec<String> {
    let run = Value::Object(run.clone());
    let is_there = |path: &&&str| number_at(own, path).is_none() && number_at(&run, path).is_some();
    BY_LOAD.iter().filter(is_there).map(|path| (*path).to_owned()).collect()
}

/// The automatic value of a field, whatever stands there.
fn automatic_value(value: &Value, path: &str, grading: &Grading) -> f64 {
    let mut free = value.clone();
    let (parent, name) = path.rsplit_once('.').unwrap_or(("", path));
    if let Some(fields) = free.pointer_mut(&pointer(parent)).and_then(Value::as_object_mut) {
        fields.remove(name);
    }
    automatic::fill(&mut free, grading);
    let by_size = || BY_SIZE.iter().find(|field| field.path == path).map(BySize::default_value);
    let whole = || (path == ITERATIONS).then(|| f64::from(NativeSettings::default().iterations));
    number_at(&free, path).or_else(by_size).or_else(whole).unwrap_or(f64::NAN)
}

/// Makes contacts as stiff as a scenario's own loads ask for, where they were softer in the run
/// that it begins with, and nobody typed how stiff. Values that were automatic there grow with the
/// scenario's own loads, and never shrink: with softer contacts, or in longer sub-steps, a pressed
/// specimen would sink into itself. Deposits before the first load stay calm.
///
/// The faults of paths that are listed as taken over and have a value of their own: they would keep
/// it from being judged, or lose it.
pub(super) fn stiffen(
    value: &mut Value,
    run: &Map<String, Value>,
    grading: &Grading,
) -> Vec<Fault> {
    let run = Value::Object(run.clone());
    let listed = |value: &Value, path: &str| {
        let paths = value["begin"]["taken_over"].as_array();
        paths.is_some_and(|paths| paths.iter().any(|of| of == path))
    };
    let mut faults = unknown_taken_over(value);
    let mut is_speed_automatic = false;
    for path in BY_LOAD {
        let there = number_at(value, path).filter(|_| listed(value, path));
        let (Some(there), Some(of_run)) = (there, number_at(&run, path)) else { continue };
        let was_automatic = listed(&run, path)
            || (of_run / automatic_value(&run, path, grading) - 1.0).abs() < 1e-9;
        is_speed_automatic |= was_automatic && path == DEPENETRATION;
        let asked = automatic_value(value, path, grading);
        let grows = was_automatic && asked > of_run;
        let taken = if grows { asked } else { of_run };
        if there != of_run && there != taken {
            faults.push(typed_and_taken_over(path, there, taken));
        } else if grows && let Some(field) = value.pointer_mut(&pointer(path)) {
            *field = automatic::written(path, asked).map_or(Value::Null, Value::Number);
        }
    }
    if let Some(scale) = automatic::scale_of(value, grading).filter(|_| is_speed_automatic) {
        calm_begun(value, &run, grading, &scale);
    }
    faults
}

/// Where the paths of what is taken over are listed.
const TAKEN_OVER: &str = "begin.taken_over";

/// The fault of a value that is listed as taken over and is another: it was typed.
fn typed_and_taken_over(path: &str, typed: f64, taken: f64) -> Fault {
    let message = format!(
        "the list is filled in when a scenario is loaded, and this value is not the one that is \
         taken over: leave {path} out of it"
    );
    let allowed = format!("{taken}, or the value left out, or {TAKEN_OVER} without it");
    Fault::new(message, format!("{path} = {typed}"), allowed).at(TAKEN_OVER)
}

/// The faults of listed paths of which no value is taken over.
fn unknown_taken_over(value: &Value) -> Vec<Fault> {
    let paths = elements(&value["begin"], "taken_over").filter_map(Value::as_str);
    let unknown = paths.filter(|path| !BY_LOAD.contains(path));
    let fault = |path: &str| {
        let message = "the list is filled in when a scenario is loaded: leave the field out";
        Fault::new(message, path, BY_LOAD.join(", ")).at(TAKEN_OVER)
    };
    unknown.map(fault).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run() -> Map<String, Value> {
        let value = json!({
            "grains": { "total_mass_g": 100, "sieve_table": [{ "passing_mm": 10 }] },
            "pieces": [
                { "name": "box", "shape": { "box": { "inner_mm": [50, 50, 20] } }, "friction": 0.2 },
                { "name": "lid", "shape": { "mesh": { "file": "/a/lid.stl" } }, "at_mm": [0, 0, 3] }
            ]
        });
        value.as_object().expect("an object").clone()
    }

    fn paths(own: &Value) -> Vec<String> {
        contradictions(&run(), own).into_iter().map(|fault| fault.path).collect()
    }

    /// Law: what says the same, or nothing, is no contradiction; other grains and pieces are.
    #[test]
    fn a_specimen_keeps_its_grains_and_pieces() {
        let same = run();
        assert_eq!(paths(&Value::Object(same)), [""; 0], "law: the same");
        assert_eq!(paths(&json!({ "grains": { "total_mass_g": 100.0 } })), [""; 0], "law: 100.0");
        let own = json!({ "grains": { "density_kg_per_m3": 5300 } });
        assert_eq!(paths(&own), ["grains.density_kg_per_m3"]);
        assert_eq!(paths(&json!({ "grains": { "file": "other.json" } })), ["grains.file"]);
        let pieces = |change: &dyn Fn(&mut Value)| {
            let mut pieces = run()["pieces"].clone();
            change(&mut pieces);
            paths(&json!({ "pieces": pieces }))
        };
        assert_eq!(pieces(&|p| p[0]["friction"] = json!(0.9)), [""; 0], "law: friction may change");
        let append = |p: &mut Value| p.as_array_mut().expect("a list").push(json!({ "name": "c" }));
        assert_eq!(pieces(&append), ["pieces"], "law: none is added");
        let other = pieces(&|p| p[1]["shape"]["mesh"]["file"] = json!("lid.stl"));
        assert_eq!(other, [""; 0], "law: from another folder");
        assert_eq!(pieces(&|p| p[1]["at_mm"][2] = json!(9)), ["pieces[1].at_mm[2]"]);
        assert_eq!(
            pieces(&|p| p[0]["shape"]["box"]["inner_mm"][0] = json!(60)),
            ["pieces[0].shape.box.inner_mm[0]"]
        );
        let swapped = pieces(&|p| p.as_array_mut().expect("a list").swap(0, 1));
        assert_eq!(swapped, ["pieces[0].name", "pieces[1].name"], "law: the order counts");
        let fewer = pieces(&|p| drop(p.as_array_mut().expect("a list").pop()));
        assert_eq!(fewer, ["pieces"]);
    }

    /// Law: what stands about the specimen is as the run has left it, each field that is not is
    /// named; what was taken away, or is to come, may be another.
    #[test]
    fn a_specimen_keeps_the_apparatus_that_it_stands_in() {
        let apparatus = json!({
            "funnel": { "opening_diameter_mm": 80 },
            "cylinder": { "inner_diameter_mm": 115, "height_mm": 200 },
            "top_plate": { "diameter_mm": 113, "mass_g": 104 }
        });
        let run = Map::from_iter([("apparatus".to_owned(), apparatus)]);
        let own = json!({ "apparatus": {
            "funnel": { "opening_diameter_mm": 70 },
            "cylinder": { "inner_diameter_mm": 130, "height_mm": 20 },
            "top_plate": { "diameter_mm": 100, "mass_g": 50 }
        } });
        let [funnel, plate] =
            ["apparatus.funnel.opening_diameter_mm", "apparatus.top_plate.diameter_mm"];
        let [across, height] =
            ["inner_diameter_mm", "height_mm"].map(|field| format!("apparatus.cylinder.{field}"));
        let cases: [(&[&str], &[&str]); 4] = [
            (&["fill_funnel"], &[funnel]),
            (&["fill_funnel", "pour"], &[&across, &height]),
            (&["fill_funnel", "pour", "place_top_plate"], &[&across, &height, plate]),
            (&["slow_pluviation"], &[]),
        ];
        for (after, expected) in cases {
            let after: Vec<String> = after.iter().map(|stage| (*stage).to_owned()).collect();
            let mut paths: Vec<String> =
                other_apparatus(&run, &own, &after).into_iter().map(|fault| fault.path).collect();
            paths.sort_by_key(|path| expected.iter().position(|of| of == path));
            assert_eq!(paths, expected, "law: after {after:?}");
            let same = other_apparatus(&run, &Value::Object(run.clone()), &after);
            assert!(same.is_empty(), "law: what repeats the run is none, got {same:?}");
        }
    }

    /// Law: a press of 100 kPa asks for stiffer contacts than those of the run; a rest asks for
    /// none, and leaves them.
    #[test]
    fn contacts_get_as_stiff_as_the_new_loads_ask_for() {
        let grains = json!({ "total_mass_g": 100, "density_kg_per_m3": 2650, "sieve_table":
            [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] });
        let grading = Grading::of_json(&grains).expect("a grading");
        let rest = json!({ "stage": "rest", "duration_s": 1 });
        let of = |stiffness: f64, stage: &Value| {
            json!({
                "grains": grains,
                "engine": { "native": { "contact_stiffness_n_per_m": stiffness } },
                "pieces": [{ "name": "lid", "shape": { "plate": { "size_mm": [50, 50, 10] } } }],
                "stages": [stage]
            })
        };
        let own = automatic_value(&of(1.0, &rest), STIFFNESS, &grading);
        let stiffness = |there: f64, stage: &Value| {
            let run = of(there, &rest);
            let mut value = of(there, stage);
            value["begin"] = json!({ "specimen": "run", "taken_over": [STIFFNESS] });
            let faults = stiffen(&mut value, run.as_object().expect("an object"), &grading);
            assert!(faults.is_empty(), "law: what is taken over is no fault, got {faults:?}");
            number_at(&value, STIFFNESS).expect("a stiffness")
        };
        assert_eq!(stiffness(own, &rest), own, "law: a rest asks for no more");
        let load = json!({ "piece": "lid", "stress_kpa": 100 });
        let press = json!({ "stage": "press", "loads": [load] });
        let pressed = stiffness(own, &press);
        assert!(pressed > 1e5, "law: some hundred kN/m under 100 kPa, got {pressed}");
        assert_eq!(stiffness(own / 2.0, &press), own / 2.0, "law: what was typed stays");
    }

    /// Law: what is listed as taken over has the run's value, or the larger one that loads ask for;
    /// another one was typed, and would be lost or not judged, and what follows from no load is not
    /// taken over.
    #[test]
    fn what_is_typed_is_not_taken_over() {
        let grains = json!({ "total_mass_g": 100, "density_kg_per_m3": 2650, "sieve_table":
            [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] });
        let grading = Grading::of_json(&grains).expect("a grading");
        let of = |stiffness: f64| {
            let load = json!({ "piece": "lid", "stress_kpa": 100 });
            json!({
                "grains": grains,
                "engine": { "native": { "contact_stiffness_n_per_m": stiffness } },
                "pieces": [{ "name": "lid", "shape": { "plate": { "size_mm": [50, 50, 10] } } }],
                "stages": [{ "stage": "press", "loads": [load] }]
            })
        };
        let mut unloaded = of(1.0);
        unloaded["stages"] = json!([{ "stage": "rest", "duration_s": 1 }]);
        let own = automatic_value(&unloaded, STIFFNESS, &grading);
        unloaded["engine"]["native"]["contact_stiffness_n_per_m"] = json!(own);
        let run = unloaded.as_object().expect("an object");
        // The value that a scenario ends with, and its faults.
        let after = |typed: f64, listed: &str| {
            let mut value = of(typed);
            value["begin"] = json!({ "specimen": "run", "taken_over": [listed] });
            let faults = stiffen(&mut value, run, &grading);
            (number_at(&value, STIFFNESS).expect("a stiffness"), faults)
        };
        let (loaded, faults) = after(own, STIFFNESS);
        assert!(loaded > 2.0 * own && faults.is_empty(), "law: it grows, got {loaded}, {faults:?}");
        let again = after(loaded, STIFFNESS);
        assert_eq!(again, (loaded, Vec::new()), "law: a scenario that was loaded loads again");
        for (typed, listed) in [(own / 3.0, STIFFNESS), (9.0 * loaded, STIFFNESS), (own, RATE)] {
            let (left, faults) = after(typed, listed);
            let at: Vec<&str> = faults.iter().map(|fault| fault.path.as_str()).collect();
            assert_eq!(at, [TAKEN_OVER], "law: {typed} N/m is typed, listed is {listed}");
            assert!(faults[0].to_string().contains(listed), "law: it is named, got {faults:?}");
            assert_eq!(left, typed, "law: what was typed stays");
        }
    }

    /// Law: deposits onto a specimen that no load has been on are calm before the first load, whichever
    /// scenario has it, as in a single run; after a load, and where the speed was typed, they have the
    /// engine's.
    #[test]
    fn deposits_onto_a_specimen_without_a_load_are_calm() {
        let grains = json!({ "total_mass_g": 100, "density_kg_per_m3": 2650, "sieve_table":
            [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] });
        let grading = Grading::of_json(&grains).expect("a grading");
        let of = |speed: f64, stages: &Value| {
            json!({
                "grains": grains,
                "engine": { "native": { "max_depenetration_velocity_m_per_s": speed } },
                "pieces": [{ "name": "lid", "shape": { "plate": { "size_mm": [50, 50, 10] } } }],
                "stages": stages
            })
        };
        let deposit = json!({ "stage": "deposit" });
        let load = json!({ "piece": "lid", "stress_kpa": 100 });
        let press = json!({ "stage": "press", "loads": [load] });
        let alone = json!([deposit]);
        let (pressed, twice) = (json!([deposit, press]), json!([deposit, deposit, press]));
        let fast = automatic_value(&of(1.0, &pressed), DEPENETRATION, &grading);
        let slow = automatic_value(&of(1.0, &alone), DEPENETRATION, &grading);
        assert!(fast > 9.0 * slow, "law: faster under a load, got {fast} and {slow} m/s");
        // The engine's speed and that of the first deposit, in µm/s.
        let speeds = |there: f64, of_run: &Value, after: &[&str], stages: &Value| {
            let run = of(there, of_run);
            let mut value = of(there, stages);
            value["begin"] =
                json!({ "specimen": "run", "after": after, "taken_over": [DEPENETRATION] });
            let faults = stiffen(&mut value, run.as_object().expect("an object"), &grading);
            assert!(faults.is_empty(), "law: what is taken over is no fault, got {faults:?}");
            let both = [number_at(&value, DEPENETRATION), value["stages"][0][OWN_SPEED].as_f64()];
            both.map(|speed| speed.map(|m_per_s| (m_per_s * 1e6).round()))
        };
        let micro = |m_per_s: f64| Some((m_per_s * 1e6).round());
        let (calm, onto) = ([micro(fast), micro(slow)], ["deposit"]);
        assert_eq!(speeds(fast, &twice, &onto, &pressed), calm, "law: the run's load came later");
        assert_eq!(speeds(fast, &twice, &onto, &alone), calm, "law: there alone, too");
        assert_eq!(speeds(slow, &alone, &onto, &pressed), calm, "law: the first load is its own");
        let unloaded = [micro(slow), None];
        assert_eq!(speeds(slow, &alone, &onto, &alone), unloaded, "law: no load, no higher speed");
        let loaded = ["deposit", "deposit", "press"];
        let after = [micro(fast), None];
        assert_eq!(speeds(fast, &twice, &loaded, &pressed), after, "law: it has been under a load");
        let typed = [micro(2.0 * fast), None];
        assert_eq!(speeds(2.0 * fast, &twice, &onto, &pressed), typed, "law: typed for the run");
    }
}
