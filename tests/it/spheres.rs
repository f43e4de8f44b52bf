//! Spheres as a user meets them: grains, a run on every engine, exports, and faults.

use std::{fs, path::Path};

use assert_cmd::Command;
use serde_json::{Value, json};

/// Runs the program; gives its exit code, standard output and standard error.
fn run(args: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = command.args(args).output().expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn done(args: &[&str]) -> String {
    let (code, text, err) = run(args);
    assert_eq!(code, Some(0), "law: {args:?} ends well: {err}");
    text
}

fn read_json(folder: &Path, name: &str) -> Value {
    let text = fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    serde_json::from_str(&text).expect("JSON")
}

/// Some 380 beads in a cylinder of ten.
fn beads() -> Value {
    json!({
        "name": "beads",
        "grains": {
            "shape": "spheres", "total_mass_g": 200, "density_kg_per_m3": 2500,
            "sieve_table": [{ "passing_mm": 8, "retained_mm": 7, "mass_percent": 100 }]
        },
        "contact": { "grain_grain_friction": 0.3, "grain_wall_friction": 0.3, "restitution": 0.5 },
        "apparatus": {
            "cylinder": { "inner_diameter_mm": 75, "height_mm": 120 },
            "funnel": { "opening_diameter_mm": 60, "top_diameter_mm": 160 }
        },
        "stages": [
            { "stage": "fill_funnel", "time_limit_s": 1.5 },
            { "stage": "pour", "falling_height_mm": 20, "time_limit_s": 2.5 }
        ],
        "rest_test_s": 0.5
    })
}

/// Law: poured spheres with friction fill 0.55 to 0.64 of their room: random loose to dense packing,
/// less what is lost along the walls of a narrow cylinder.
#[test]
fn beads_pour_settle_and_are_exported() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    fs::write(folder.path().join("beads.json"), beads().to_string()).expect("a file");
    let scenario = out("beads.json");

    let made = done(&["grains", &scenario, "--json", "--quiet", "--out", &out("made")]);
    let made: Value = serde_json::from_str(&made).expect("JSON");
    let mass = made["mass_g"].as_f64().expect("a number");
    assert!((mass - 200.0).abs() < 1e-9, "law: total mass 200 g, got {mass}");
    let round = made["shape"]["sphericity"]["p50"].as_f64().expect("a number");
    assert!((round - 1.0).abs() < 1e-12, "law: a sphere has sphericity 1, got {round}");

    for (name, settings) in [
        ("native", &[][..]),
        ("stock", &["--set", "engine.contact_solver=stock"][..]),
        ("rapier", &["--set", "engine.backend=rapier"][..]),
    ] {
        if name == "rapier" && !cfg!(feature = "rapier") {
            continue;
        }
        let ran = out(name);
        let mut args = vec!["run", &scenario, "--quiet", "--out", &ran];
        args.extend(settings);
        done(&args);
        let summary = read_json(&folder.path().join(name), "summary.json");
        let grains = &summary["grains"];
        assert_eq!(grains["count"], made["grains"], "law: the same grains are poured");
        assert_eq!(grains["escaped"], 0, "{name}, law: none passes a wall");
        let e = summary["void_ratio"].as_f64().expect("a void ratio");
        let solid = 1.0 / (1.0 + e);
        println!("{name}: solid fraction {solid:.4}, {grains}");
        assert!((0.52..0.66).contains(&solid), "{name}, law: solid fraction, got {solid}");
        let sieved = &summary["sieve_analysis"]["secondary"];
        assert_eq!(sieved["unchanged"], true, "{name}, law: no sphere changes: {sieved}");
    }

    let native = out("native");
    for format in ["vtk", "glb", "stl", "ply", "obj", "json", "csv"] {
        let to = out(format);
        done(&["export", &native, "--format", format, "--quiet", "--out", &to]);
    }
    let scene = read_json(&folder.path().join("json"), "scene.json");
    let text = scene.to_string();
    assert!(text.contains("sphere_m") && text.contains("vertices_m"), "law: both are handed on");
    let picture = out("beads.png");
    done(&["picture", &native, "--width", "200", "--quiet", "--out", &picture]);
    let picture = out("grains.png");
    done(&["picture", &native, "--grains", "--width", "200", "--quiet", "--out", &picture]);

    // From their file, the same grains.
    let mut again = beads();
    again["grains"] = json!({ "file": out("made/grains.json") });
    fs::write(folder.path().join("again.json"), again.to_string()).expect("a file");
    done(&["grains", &out("again.json"), "--quiet", "--out", &out("again")]);
    let text =
        |folder: &str| fs::read(Path::new(&out(folder)).join("grains.json")).expect("grains");
    assert!(text("made") == text("again"), "law: grains.json comes back bit by bit");
}

#[test]
fn what_does_not_go_with_spheres_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("s.json");
    for (field, value, words) in [
        ("cells", json!({ "relaxation_steps": 3 }), "spheres are cut from no cells"),
        ("shape", json!("balls"), "\"spheres\""),
        ("shape", json!(3), "grains.shape"),
        ("largest_vertex_count", json!(64), "largest_vertex_count"),
    ] {
        let mut scenario = beads();
        scenario["grains"][field] = value;
        fs::write(&path, scenario.to_string()).expect("a file");
        let out = folder.path().join("out");
        let args = ["run", path.to_str().expect("UTF-8"), "--quiet", "--out"];
        let (code, _, err) = run(&[&args[..], &[out.to_str().expect("UTF-8")]].concat());
        assert_eq!(code, Some(2), "law: refused: {err}");
        assert!(err.contains(words), "law: it says `{words}`, got {err}");
    }
    let mut scenario = beads();
    // More than one of 0.66 g, less than two.
    scenario["grains"]["sieve_table"][0]["retained_mm"] = json!(7.9);
    scenario["grains"]["total_mass_g"] = json!(0.9);
    fs::write(&path, scenario.to_string()).expect("a file");
    let out = folder.path().join("out");
    let args = ["grains", path.to_str().expect("UTF-8"), "--quiet", "--out"];
    let (code, _, err) = run(&[&args[..], &[out.to_str().expect("UTF-8")]].concat());
    assert_eq!(code, Some(2), "law: a mass that no spheres have is refused: {err}");
    assert!(err.contains("no whole number of spheres"), "law: it says so, got {err}");
}
