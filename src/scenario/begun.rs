//! What a scenario that begins with a specimen may not say otherwise than the run that made it,
//! and which automatic values it takes over.

use super::automatic::{self, Grading, number_at};
use super::*;

/// Automatic values that are as in the run that a scenario begins with, unless its own loads ask
/// for more: softer contacts would let a pressed specimen sink into itself.
const KEPT: [&str; 2] = [automatic::STIFFNESS, automatic::DEPENETRATION];

/// The faults of what contradicts the specimen: its grains are what they are, and its pieces stand
/// where the run has left them. `run` is that run's scenario, `own` what is laid over it.
pub(super) fn contradictions(run: &Map<String, Value>, own: &Value) -> Vec<Fault> {
    let fault = |(path, found, allowed): (String, Value, String), why: &str| {
        Fault::new(format!("{why}: leave the field out"), found, allowed).at(path)
    };
    let grains = own.get("grains").and_then(|own| difference("grains", &run["grains"], own));
    let mut faults: Vec<Fault> = grains
        .map(|d| fault(d, "a specimen that is begun with has its grains"))
        .into_iter()
        .collect();
    let none = Vec::new();
    let there = run.get("pieces").and_then(Value::as_array).unwrap_or(&none);
    let Some(pieces) = own.get("pieces").and_then(Value::as_array) else { return faults };
    for (n, piece) in there.iter().enumerate() {
        let path = format!("pieces[{n}]");
        let Some(own) = pieces.get(n) else {
            let names: Vec<&str> = there.iter().filter_map(|p| p["name"].as_str()).collect();
            let message = "the specimen has more pieces: leave the field out, or append to them";
            let allowed = format!("at first {}", names.join(", "));
            faults.push(Fault::new(message, pieces.len(), allowed).at("pieces"));
            break;
        };
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

/// Which automatic values a document would take over from a run.
pub(super) fn taken_over(run: &Map<String, Value>, own: &Value) -> Vec<String> {
    let run = Value::Object(run.clone());
    let is_there = |path: &&&str| number_at(own, path).is_none() && number_at(&run, path).is_some();
    KEPT.iter().filter(is_there).map(|path| (*path).to_owned()).collect()
}

/// Makes contacts as stiff as a scenario's own loads ask for, where they were softer in the run
/// that it begins with.
pub(super) fn stiffen(value: &mut Value, grading: &Grading) {
    let listed: Vec<String> = value["begin"]["taken_over"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|path| path.as_str().map(str::to_owned))
        .collect();
    for path in listed {
        let Some(there) = number_at(value, &path) else { continue };
        let mut free = value.clone();
        let parent = path.rsplit_once('.').map_or("", |(parent, _)| parent).replace('.', "/");
        let name = path.rsplit('.').next().unwrap_or_default();
        let parent = format!("/{parent}");
        if let Some(fields) = free.pointer_mut(&parent).and_then(Value::as_object_mut) {
            fields.remove(name);
        }
        automatic::fill(&mut free, grading);
        let default = match path == automatic::STIFFNESS {
            true => NativeSettings::default().contact_stiffness_n_per_m,
            false => NativeSettings::default().max_depenetration_velocity_m_per_s,
        };
        let asked = number_at(&free, &path).unwrap_or(default);
        if asked > there
            && let Some(fields) = value.pointer_mut(&parent).and_then(Value::as_object_mut)
        {
            fields.insert(name.to_owned(), json!(asked));
        }
    }
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
        let pieces = |change: &dyn Fn(&mut Value)| {
            let mut pieces = run()["pieces"].clone();
            change(&mut pieces);
            paths(&json!({ "pieces": pieces }))
        };
        assert_eq!(pieces(&|p| p[0]["friction"] = json!(0.9)), [""; 0], "law: friction may change");
        let append = |p: &mut Value| p.as_array_mut().expect("a list").push(json!({ "name": "c" }));
        assert_eq!(pieces(&append), [""; 0], "law: pieces may be added");
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

    /// Law: a press of 100 kPa asks for stiffer contacts than those of the run; a rest asks for
    /// none, and leaves them.
    #[test]
    fn contacts_get_as_stiff_as_the_new_loads_ask_for() {
        let grains = json!({ "total_mass_g": 100, "density_kg_per_m3": 2650, "sieve_table":
            [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] });
        let grading = Grading::of_json(&grains).expect("a grading");
        let stiffness = |stage: Value| {
            let mut value = json!({
                "grains": grains,
                "begin": { "specimen": "run", "taken_over": [automatic::STIFFNESS] },
                "engine": { "native": { "contact_stiffness_n_per_m": 6900 } },
                "pieces": [{ "name": "lid", "shape": { "plate": { "size_mm": [50, 50, 10] } } }],
                "stages": [stage]
            });
            stiffen(&mut value, &grading);
            number_at(&value, automatic::STIFFNESS).expect("a stiffness")
        };
        let rest = stiffness(json!({ "stage": "rest", "duration_s": 1 }));
        assert!((6900.0..2e4).contains(&rest), "law: as in the run, or as weight asks, got {rest}");
        let load = json!({ "piece": "lid", "stress_kpa": 100 });
        let pressed = stiffness(json!({ "stage": "press", "loads": [load] }));
        assert!(pressed > 1e5, "law: some hundred kN/m under 100 kPa, got {pressed}");
    }
}
