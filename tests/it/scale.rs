//! Grains of any size: what is simulated is similar, whatever the scale.

mod cpp;

use std::{sync::Arc, sync::atomic::AtomicBool};

use pluvia::{
    geometry::{Pose, Vector},
    grains::{self, load_scenario},
    protocol::{self, Moment, Observer, Setup},
    scale,
    scenario::{GrainsSpec, Scenario, warnings},
    specimen::{Specimen, SpecimenState},
    world,
};
use serde_json::{Value, json};

use super::{
    architecture::files,
    program::{Folder, json as read, page, root},
};

/// A scenario as a file gives it, with everything that follows from its grains.
fn loaded(file: &Value) -> Scenario {
    let folder = Folder::new();
    let path = folder.scenario("s.json", file);
    load_scenario(path.as_ref(), &[]).unwrap_or_else(|e| panic!("{e:?}")).scenario
}

/// Thirty grains in a funnel, everything times `larger`.
fn twin(larger: f64, mut engine: Value) -> Scenario {
    engine["native"] = json!({ "contact_stiffness_n_per_m": 8000.0 * larger.powi(2) });
    loaded(&json!({
        "name": "twin",
        "grains": {
            "total_mass_g": 48.0 * larger.powi(3), "density_kg_per_m3": 2673.9,
            "sieve_table": [
                { "passing_mm": 16.0 * larger, "retained_mm": 10.0 * larger, "mass_percent": 40 },
                { "passing_mm": 10.0 * larger, "retained_mm": 8.0 * larger, "mass_percent": 60 },
            ],
        },
        // What is automatic of these is rounded to what a person would type.
        "apparatus": {
            "cylinder": { "inner_diameter_mm": 64.0 * larger, "height_mm": 64.0 * larger },
            "funnel": { "opening_diameter_mm": 56.0 * larger, "top_diameter_mm": 80.0 * larger },
        },
        "engine": engine,
        "stages": [{ "stage": "fill_funnel", "time_limit_s": 0.5 * larger.sqrt() }],
    }))
}

/// Poses and velocities of all grains at every look.
#[derive(Default)]
struct Seen(Vec<Vec<(Pose, Vector, Vector)>>);

impl Observer for Seen {
    fn observe(&mut self, specimen: &Specimen, _: Moment) {
        let of = |g: &pluvia::specimen::GrainState| {
            (g.body.pose, g.body.linear_velocity, g.body.angular_velocity)
        };
        self.0.push(specimen.state.bodies.iter().map(of).collect());
    }
}

/// What happens until the time limit, seen every twentieth of it.
fn filled(scenario: &Scenario, larger: f64) -> Vec<Vec<(Pose, Vector, Vector)>> {
    let GrainsSpec::Sieved(sieved) = &scenario.grains else { panic!("sieved") };
    let grains = Arc::new(grains::generate(sieved, scenario.seed).expect("grains"));
    let state = SpecimenState::before_everything(grains.grains.len());
    let mut setup = Setup::new(scenario).expect("a laboratory");
    setup.look_interval = 0.025 * larger.sqrt();
    let mut seen = Seen::default();
    protocol::run(
        &setup,
        &world::create,
        Specimen { grains, state },
        &scenario.stages[0],
        None,
        &mut seen,
        &AtomicBool::new(false),
    )
    .expect("it can be run");
    seen.0
}

/// Factors whose square roots are powers of two, so that scaling rounds nothing.
const LARGER: [f64; 2] = [0.25, 4.0];

#[test]
fn scaled_twins_agree_to_the_bit() {
    let plain = filled(&twin(1.0, json!({})), 1.0);
    assert!(plain.len() >= 20, "law: it is seen on its way, got {} looks", plain.len());
    for larger in LARGER {
        let other = filled(&twin(larger, json!({})), larger);
        assert_eq!(other.len(), plain.len(), "law: as many looks at {larger} times the size");
        for (look, (a, b)) in plain.iter().zip(&other).enumerate() {
            for (grain, (a, b)) in a.iter().zip(b).enumerate() {
                let same = a.0.translation.vector * larger == b.0.translation.vector
                    && a.0.rotation == b.0.rotation
                    && a.1 * larger.sqrt() == b.1
                    && a.2 / larger.sqrt() == b.2;
                assert!(
                    same,
                    "law: at {larger} times the size lengths, speeds (square root) and spins (its \
                     inverse) are scaled to the bit; look {look}, grain {grain}: {a:?} and {b:?}"
                );
            }
        }
    }
}

#[test]
fn twins_with_a_length_of_their_own_are_told_apart() {
    let plain = filled(&twin(1.0, json!({})), 1.0);
    let larger = 4.0;
    let other = filled(&twin(larger, json!({ "grain_size_mm": 8, "length_scale": 100 })), larger);
    let last = |all: &[Vec<(Pose, Vector, Vector)>]| all.last().expect("looks").clone();
    let differs = last(&plain)
        .iter()
        .zip(last(&other))
        .any(|(a, b)| a.0.translation.vector * larger != b.0.translation.vector);
    assert!(differs, "law: the comparison sees an engine whose gaps are not scaled");
}

/// Sand, gravel and ballast with nothing typed but grains and stages.
#[test]
fn any_grain_size_needs_nothing_else() {
    for (largest, smallest, mass) in [(2.0, 0.5, 2.0), (16.0, 8.0, 2343.0), (63.0, 31.5, 1e5)] {
        let middle = f64::midpoint(largest, smallest);
        let scenario = loaded(&json!({
            "name": "any",
            "grains": {
                "total_mass_g": mass, "density_kg_per_m3": 2650,
                "sieve_table": [
                    { "passing_mm": largest, "retained_mm": middle, "mass_percent": 50 },
                    { "passing_mm": middle, "retained_mm": smallest, "mass_percent": 50 },
                ],
            },
            "stages": [
                { "stage": "fill_funnel" },
                { "stage": "pour", "falling_height_mm": largest },
                { "stage": "place_top_plate" },
            ],
        }));
        assert_eq!(scenario.engine.grain_size_mm, smallest, "law: that of the finest sieve");
        let unusual = warnings(&scenario);
        assert!(
            unusual.is_empty(),
            "law: what follows from the grains suits them; {smallest} to {largest} mm: {unusual:?}"
        );
    }
}

#[test]
fn what_is_typed_is_taken_and_told_where_it_does_not_suit() {
    let of = |engine: Value, apparatus: Value| {
        let scenario = loaded(&json!({
            "name": "ballast",
            "grains": {
                "total_mass_g": 1e5, "density_kg_per_m3": 2650,
                "sieve_table": [{ "passing_mm": 63, "retained_mm": 31.5, "mass_percent": 100 }],
            },
            "engine": engine,
            "apparatus": apparatus,
            "stages": [{ "stage": "fill_funnel" }, { "stage": "pour", "falling_height_mm": 50 }],
        }));
        let told = warnings(&scenario);
        (scenario, told)
    };
    let (scenario, told) =
        of(json!({ "native": { "contact_stiffness_n_per_m": 10000 } }), json!({}));
    assert_eq!(scenario.engine.native.contact_stiffness_n_per_m, 10000.0, "law: typed is kept");
    assert!(
        told.len() == 1 && told[0].contains("contact_stiffness"),
        "law: one is reported: {told:?}"
    );
    let (_, told) = of(json!({ "rate_hz": 480 }), json!({}));
    assert!(told.is_empty(), "law: twice as fine as needed is not unusual: {told:?}");
    let (_, told) = of(json!({ "grain_size_mm": 1 }), json!({}));
    assert!(told.len() == 1 && told[0].contains("grain_size_mm"), "law: one is reported: {told:?}");
    let narrow = json!({
        "cylinder": { "height_mm": 300 }, "funnel": { "opening_diameter_mm": 200 },
    });
    let (_, told) = of(json!({}), narrow);
    assert!(
        told.len() == 2 && told[0].contains("over the rim") && told[1].contains("jam"),
        "law: a cylinder that runs over and a funnel that jams are reported: {told:?}"
    );
}

/// Law: a quantity that the page lists is one that the program uses.
#[test]
fn every_quantity_is_used() {
    let text: String = files(&["src"], &["rs"]).into_iter().map(|(_, text)| text).collect();
    let named = |line: &str| {
        let (name, rest) = line.trim().split_once(" = ")?;
        let capitals = name.chars().all(|c| c.is_ascii_uppercase() || c == '_');
        (capitals && rest.contains(", \"")).then(|| name.to_owned())
    };
    let source = include_str!("../../src/scale.rs");
    let names: Vec<String> = source.lines().filter_map(named).collect();
    assert_eq!(names.len(), pluvia::scale::ALL.len(), "law: all are found: {names:?}");
    for name in names {
        let used = text.match_indices(&format!("scale::{name}")).any(|(at, found)| {
            let after = &text[at + found.len()..];
            [".at(", ".no_less(", ")"].iter().any(|used| after.starts_with(used))
        });
        assert!(used, "law: {name} is used");
    }
}

/// The words of the comment above a constant, and its name, of all constants of a file.
fn constants(source: &str) -> Vec<(String, String)> {
    let mut comment = String::new();
    let mut found = Vec::new();
    for line in source.lines() {
        let line = line.trim();
        // What comes after belongs to tests.
        if line.starts_with("#[cfg(test)]") {
            break;
        }
        if let Some(words) = line.strip_prefix("///") {
            comment += words;
            continue;
        }
        let shown = line.strip_prefix("pub ").or(line.strip_prefix("pub(super) ")).unwrap_or(line);
        let constant = shown.strip_prefix("const ").and_then(|rest| rest.split_once(": "));
        if let Some((name, _)) = constant.filter(|(_, of)| of.contains("f64")) {
            found.push((name.to_owned(), std::mem::take(&mut comment)));
        }
        comment.clear();
    }
    found
}

/// Whether a comment says "in m", "in s" and the like.
fn has_unit(comment: &str) -> bool {
    let words: Vec<&str> = comment.split_whitespace().collect();
    let units = ["m", "mm", "s", "m/s", "m/s²", "Hz", "rad/s", "N/m"];
    words.windows(2).any(|w| {
        let unit = w[1].trim_end_matches([',', '.', ':', ';', ')']);
        w[0].eq_ignore_ascii_case("in") && units.contains(&unit)
    })
}

/// Law: a number in m, s or what is made of them stands in `src/scale.rs`, or `docs/scale.md` says
/// why it is the same for all grains.
#[test]
fn numbers_with_a_unit_are_of_the_scale_or_explained() {
    let page = page("docs/scale.md");
    let (_, rest) = page.split_once("<!-- ABSOLUTE -->").expect("a mark");
    let (table, _) = rest.split_once("<!-- END -->").expect("an end");
    let mut explained: Vec<String> =
        table.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    let mut found = Vec::new();
    // What draws, what quotes the paper and what sets up experiments of its own is not the laboratory.
    let of_laboratory =
        "apparatus export grains measure protocol record scenario specimen.rs study world";
    for (path, source) in files(&["src"], &["rs"]) {
        let of_file = path.trim_start_matches("src/");
        let part = of_file.split('/').next().unwrap_or_default();
        let counts = of_laboratory.split_whitespace().any(|of| of == part);
        if counts && !of_file.contains("test") {
            let with_unit = constants(&source).into_iter().filter(|(_, c)| has_unit(c));
            found.extend(with_unit.map(|(name, _)| format!("{of_file} {name}")));
        }
    }
    found.sort();
    explained.sort();
    assert!(found.len() >= 10, "law: constants are found: {found:?}");
    assert_eq!(
        found, explained,
        "law: docs/scale.md explains each number that is not of the scale"
    );
}

#[test]
fn numbers_with_a_unit_are_found() {
    let source = "/// How far, in m.\nconst FAR: f64 = 20.0;\n/// Any share.\nconst SHARE: f64 = 0.1;\n\
                  /// Where, in\n/// mm, from to.\npub const ENDS: (f64, f64) = (1.0, 2.0);\n\
                  #[cfg(test)]\n/// In s.\nconst LATER: f64 = 1.0;";
    let found: Vec<String> =
        constants(source).into_iter().filter(|(_, c)| has_unit(c)).map(|(name, _)| name).collect();
    assert_eq!(found, ["FAR", "ENDS"], "law: those whose comment names a unit, tests left out");
}

/// Law: the factors in the page's table of laws are those of the program.
#[test]
fn factors_of_the_page_are_those_of_the_program() {
    let page = page("docs/scale.md");
    for words in [
        format!("more than {} ρ g d₅₀", scale::STRESS_OF_DEFAULT),
        format!("{} √(P/ρ)/d", 1.0 / scale::SUBSTEP_OF_INERTIAL_TIME),
        format!("at most {} cylinder diameters", scale::OPENING_OF_CYLINDER),
    ] {
        assert!(page.contains(&words), "law: the page says `{words}`");
    }
    for (factor, expected, words) in [
        (scale::FASTER_UNDER_LOAD, 10.0, "ten times as much where the stiffness follows"),
        (scale::RMS_OF_PILE, 0.25, "a quarter of the root mean square speed"),
        (scale::LARGEST_OF_PILE, 0.1, "a tenth of the largest"),
    ] {
        assert_eq!(factor, expected, "law: `{words}` is the program's factor");
        assert!(page.contains(words), "law: the page says `{words}`");
    }
}

/// By which power of the size a field grows, by the unit at the end of its name.
fn power(field: &str) -> Option<f64> {
    let ends = |unit: &str| field.ends_with(unit);
    Some(match () {
        () if ends("length_scale") => -1.0,
        () if ends("_n_per_m") => 2.0,
        () if ends("_m_per_s") || ends("_mm_per_s") => 0.5,
        () if ends("_hz") => -0.5,
        () if ends("_mm") => 1.0,
        () if ends("_g") => 3.0,
        () if ends("_s") && !ends("_rad_per_s") && !ends("_per_s") => 0.5,
        () => return None,
    })
}

/// Where two scenarios are no twins: fields that are not as many times as large as they should be.
fn unlike(path: &str, a: &Value, b: &Value, larger: f64, found: &mut Vec<String>) {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            let fields: std::collections::BTreeSet<_> = a.keys().chain(b.keys()).collect();
            for field in fields {
                let of = |object: &serde_json::Map<String, Value>| {
                    object.get(field).cloned().unwrap_or(Value::Null)
                };
                unlike(&format!("{path}.{field}"), &of(a), &of(b), larger, found);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (n, (a, b)) in a.iter().zip(b).enumerate() {
                unlike(&format!("{path}[{n}]"), a, b, larger, found);
            }
        }
        (Value::Number(x), Value::Number(y)) => {
            let (x, y) = (x.as_f64().expect("a number"), y.as_f64().expect("a number"));
            let field = path.rsplit('.').next().unwrap_or(path);
            let expected = x * larger.powf(power(field).unwrap_or(0.0));
            // The automatic rate is a multiple of 12 Hz.
            if (y - expected).abs() > 0.01 * expected.abs() {
                found.push(format!("{path}: expected {expected}, got {y}"));
            }
        }
        (a, b) if a == b => {}
        _ => found.push(format!("{path}: {a} and {b}")),
    }
}

#[test]
fn the_twins_of_the_design_are_twins() {
    let folder = root().join("scenarios/studies");
    let design = read(&folder.join("twins.json"));
    let specimen = folder.join(design["full"]["scenario"].as_str().expect("a path"));
    let with = |changes: &Value| -> Value {
        let texts = changes.as_array().into_iter().flatten();
        let changes: Vec<_> =
            texts.map(|c| c.as_str().expect("a text").parse().expect("a change")).collect();
        let loaded = load_scenario(&specimen, &changes).unwrap_or_else(|e| panic!("{e}"));
        assert!(warnings(&loaded.scenario).is_empty(), "law: twins suit their grains");
        let mut value = serde_json::to_value(loaded.scenario).expect("JSON");
        // Written only where they are not the defaults, and not read by Bullet.
        value["engine"].as_object_mut().expect("settings").remove("rapier");
        value
    };
    let size = &design["parameters"][0];
    let plain = with(&json!([]));
    for end in ["low", "high"] {
        let larger = size[end].as_f64().expect("a size");
        let twin = with(&size[format!("{end}_changes")]);
        let mut found = Vec::new();
        unlike("", &plain, &twin, larger, &mut found);
        assert!(found.is_empty(), "law: all of a twin grows by its law, within 1 %: {found:?}");
        let mut spoilt = twin;
        spoilt["apparatus"]["funnel"]["opening_diameter_mm"] = json!(65.0 * larger * 1.02);
        unlike("", &plain, &spoilt, larger, &mut found);
        assert_eq!(found.len(), 1, "law: the comparison sees an opening off by 2 %: {found:?}");
    }
}

/// The script of `make twins` on the table of a sweep whose runs are made up.
#[test]
fn the_table_of_twins_has_a_row_for_each_run() {
    let folder = Folder::new();
    let sweep = |rows: &str| {
        std::fs::write(folder.path("sweep.csv"), rows).expect("written");
        let mut bash = std::process::Command::new("bash");
        bash.arg(root().join("scripts/twins.sh")).env("PLUVIA", "true");
        bash.args([folder.path(""), folder.path("twins.csv")]);
        let output = bash.output().expect("bash starts");
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        output.status.success().then_some(said)
    };
    let rows = "run,point,configuration,size,poured_height_mm.mean_surface,void_ratio,\
                standing_height_mm.mean_surface,coordination_number,overlap.mean_percent,\
                overlap.p99_percent,creep_um_per_s,grains.left_in_funnel,meets_standard,valid,failure\n\
                a,p,1,1,110,1.05,110,4.6,0.06,0.3,0.1,0,true,true,\n\
                b,p,1,0.1,11,1.04,10.8,4.5,0.06,0.3,0.1,2,true,true,\n\
                d,p,2,0.1,11,1.3,10.9,4.4,0.06,0.3,9.5,2,true,false,\n\
                c,p,2,1,,,,,,,,,,,\"it failed, badly:\n1,2,3,4\"\n";
    let said = sweep(rows).expect("law: two runs make a table");
    let expected = "4 runs in";
    assert!(said.contains(expected), "law: expected `{expected}`, got `{said}`");
    let expected = ", 2 of them without result or not valid";
    assert!(said.contains(expected), "law: expected `{expected}`, got `{said}`");
    let got = folder.text("twins.csv");
    let expected = "larger,configuration,void_ratio,standing_height_mm.mean_surface,\
                    coordination_number,overlap.mean_percent,overlap.p99_percent,creep_um_per_s,\
                    grains.left_in_funnel,meets_standard,valid\n\
                    0.1,1,1.04,10.8,4.5,0.06,0.3,0.1,2,true,true\n\
                    0.1,2,1.3,10.9,4.4,0.06,0.3,9.5,2,true,false\n\
                    1,1,1.05,110,4.6,0.06,0.3,0.1,0,true,true\n\
                    1,2,,,,,,,,,\n";
    assert_eq!(got, expected, "law: by size, those that are left out, too");
    let kept = include_str!("../../docs/results/scale/twins.csv").lines().next().expect("a header");
    assert!(got.starts_with(kept), "law: the columns of the table that is kept: {kept}");
    for rows in [
        rows.replace("void_ratio", "other"),
        rows.replace("a,p,1,1,110,1.05", "a,p,1,1,,")
            .replace("b,p,1,0.1,11,1.04", "b,p,1,0.1,,")
            .replace("d,p,2,0.1,11,1.3", "d,p,2,0.1,,"),
    ] {
        let said = sweep(&rows);
        assert_eq!(said, None, "law: a missing column or no result at all is an error");
        assert_eq!(folder.text("twins.csv"), got, "law: and the table stays as it was");
    }
}
