//! Scenarios that mean harm, or were made by accident: each is answered, soon,
//! in words that `hostile.txt` holds.
//!
//! `PLUVIA_WRITE=1` writes that file anew; what changed in it is to be read.

use std::{
    fs,
    path::Path,
    time::{Duration, Instant},
};

use pluvia::grains::load_scenario;
use serde_json::{Value, json};

use super::{place, sound};

/// A file as bytes, with the name it is told by.
struct Hostile {
    name: String,
    text: Vec<u8>,
}

/// The sound scenario with a vibration, and raw text in place of the value at a
/// path of names and numbers; fields on the way are made.
fn with_raw(path: &str, raw: &str) -> Vec<u8> {
    const HERE: &str = "@here@";
    let mut value = sound();
    let stages = value["stages"].as_array_mut().expect("a list");
    stages.push(json!({ "stage": "place_top_plate" }));
    stages.push(json!({
        "stage": "vibrate", "frequency_hz": 3, "amplitude_mm": 10, "duration_s": 2
    }));
    *place(&mut value, path) = json!(HERE);
    value.to_string().replace(&format!("\"{HERE}\""), raw).into_bytes()
}

/// Every number that a person types, with every kind of bad one.
fn bad_numbers(all: &mut Vec<Hostile>) {
    const VALUES: [&str; 12] = [
        "1e300",
        "-1e300",
        "5e-324",
        "0",
        "-0.0",
        "-1",
        "1e999",
        "18446744073709551616",
        "\"1\"",
        "null",
        "[1]",
        "{\"value\": 1}",
    ];
    let fields = "gravity_m_per_s2 seed configuration rest_test_s grains.total_mass_g \
                  grains.density_kg_per_m3 grains.sieve_table.0.passing_mm \
                  grains.sieve_table.0.mass_percent apparatus.cylinder.inner_diameter_mm \
                  apparatus.cylinder.height_mm apparatus.funnel.opening_diameter_mm \
                  apparatus.top_plate.mass_g contact.restitution contact.grain_grain_friction \
                  engine.rate_hz engine.iterations engine.length_scale \
                  engine.native.checkpoint_every_s settle.hold_s stages.1.falling_height_mm \
                  stages.3.frequency_hz stages.3.duration_s stages.3.settle_limit_s \
                  stages.3.crank_to_rod stages.3.vertical.amplitude_mm \
                  stages.3.video_frames.frames_per_s stages.2.placement stages.2.seating_load_n";
    for field in fields.split_whitespace() {
        for value in VALUES {
            all.push(Hostile { name: format!("{field} = {value}"), text: with_raw(field, value) });
        }
    }
    for value in ["NaN", "Infinity", "-Infinity", "1e", "01", "0x10", ".5", "+1", "1_000", "1,5"] {
        all.push(Hostile {
            name: format!("gravity_m_per_s2 = {value}"),
            text: with_raw("gravity_m_per_s2", value),
        });
    }
}

/// Texts that are no JSON, or hardly.
fn bad_texts(all: &mut Vec<Hostile>) {
    let whole = sound().to_string();
    let utf16: Vec<u8> = whole.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let mut torn = whole.clone().into_bytes();
    torn.truncate(whole.len() / 2);
    let texts: [(&str, Vec<u8>); 24] = [
        ("empty", Vec::new()),
        ("white space", b" \n\t\r\n ".to_vec()),
        ("half a file", torn),
        ("nul bytes", vec![0; 64]),
        ("utf-16", utf16),
        ("invalid utf-8", [b"{\"name\": \"", &[0xff, 0xfe][..], b"\"}"].concat()),
        ("overlong utf-8", [b"{\"name\": \"", &[0xc0, 0xaf][..], b"\"}"].concat()),
        ("byte order mark", format!("\u{feff}{whole}").into_bytes()),
        ("lone surrogate", b"{\"name\": \"\\ud800\"}".to_vec()),
        ("control character", b"{\"name\": \"a\x07b\"}".to_vec()),
        ("comment", format!("// mine\n{whole}").into_bytes()),
        ("trailing comma", b"{\"name\": \"a\",}".to_vec()),
        ("single quotes", b"{'name': 'a'}".to_vec()),
        ("unquoted", b"{name: a}".to_vec()),
        ("two values", format!("{whole}{whole}").into_bytes()),
        ("a number", b"7".to_vec()),
        ("a text", b"\"scenario\"".to_vec()),
        ("null", b"null".to_vec()),
        ("a list", b"[]".to_vec()),
        ("an empty object", b"{}".to_vec()),
        ("lists in lists", [vec![b'['; 100_000], vec![b']'; 100_000]].concat()),
        ("lists never closed", vec![b'['; 1_000_000]),
        ("objects in objects", "{\"a\":".repeat(100_000).into_bytes()),
        ("yaml", b"name: a\nstages:\n  - stage: pour\n".to_vec()),
    ];
    all.extend(texts.map(|(name, text)| Hostile { name: name.into(), text }));
}

/// JSON whose content is out of all proportion.
fn bad_sizes(all: &mut Vec<Hostile>) {
    let row = "{\"passing_mm\":16,\"retained_mm\":11.2,\"mass_percent\":0.001},";
    let long = "x".repeat(1_000_000);
    let twice = |path: &str, raw: &str| with_raw(path, raw);
    let many = |text: &str, count: usize| format!("[{}]", text.repeat(count).trim_end_matches(','));
    let fields: String = (0..20_000).map(|n| format!("\"field_{n}\":{n},")).collect();
    let of = [
        ("a name of a megabyte", twice("name", &format!("\"{long}\""))),
        ("a field's name of a megabyte", twice("engine", &format!("{{\"{long}\":1}}"))),
        ("a number of a megabyte", twice("rest_test_s", &"9".repeat(1_000_000))),
        ("decimals of a megabyte", twice("rest_test_s", &format!("0.{}", "3".repeat(1_000_000)))),
        ("twenty thousand sieves", twice("grains.sieve_table", &many(row, 20_000))),
        ("no sieve", twice("grains.sieve_table", "[]")),
        ("no stage", twice("stages", "[]")),
        (
            "a hundred thousand stages",
            twice("stages", &many("{\"stage\":\"fill_funnel\"},", 100_000)),
        ),
        ("a million sieves", twice("grains.sieve_table", &many(row, 1_000_000))),
        ("a thousand bad stages", twice("stages", &many("7,", 1_000))),
        (
            "twenty thousand fields",
            twice("engine", &format!("{{{}}}", fields.trim_end_matches(','))),
        ),
        ("a thousand notes", twice("notes", &many("\"note\",", 1_000))),
        ("deep notes", twice("notes", &format!("{}{}", "[".repeat(100), "]".repeat(100)))),
        ("a list where an object is", twice("grains", &many("1,", 1_000))),
        ("a field twice", twice("seed", "1,\"seed\":2")),
        ("an object twice", twice("engine", "{\"rate_hz\":480},\"engine\":{\"rate_hz\":960}")),
        ("a field a hundred times", twice("seed", &format!("1{}", ",\"seed\":2".repeat(100)))),
        ("a field twice below", twice("engine", "{\"rate_hz\":480,\"rate_hz\":960}")),
        ("an escaped name twice", twice("seed", "1,\"\\u0073eed\":2")),
    ];
    all.extend(of.map(|(name, text)| Hostile { name: name.into(), text }));
}

/// Names and paths that lead elsewhere.
fn bad_names(all: &mut Vec<Hostile>) {
    let names = [
        "",
        " ",
        ".",
        "..",
        "/",
        "../../../../../../../../etc/passwd",
        "/etc/passwd",
        "/dev/zero/x",
        "s.json",
        "./s.json",
        "sub/../s.json",
        "own-link.json",
        "circle-a.json",
        "list.json",
        "file:///etc/passwd",
        "http://example.org/a.json",
        "~/a.json",
        "$HOME/a.json",
        "a\\u0000b.json",
        "nowhere.json",
        "sub",
        "CON",
        "\\u202egnp.json",
        "ｓ.json",
    ];
    for name in names {
        let text = with_raw("extends", &format!("\"{name}\""));
        all.push(Hostile { name: format!("extends = {name:?}"), text });
    }
    for raw in ["1", "null", "[\"a.json\"]", "{}", "true"] {
        let text = with_raw("extends", raw);
        all.push(Hostile { name: format!("extends = {raw}"), text });
    }
    for raw in ["\"\"", "\"a/b\"", "\"../x\"", "\"\\u0000\"", "\"\\u202e\"", "\"名前\"", "\"🌧\""]
    {
        all.push(Hostile { name: format!("name = {raw}"), text: with_raw("name", raw) });
    }
    for raw in
        ["{\"file\":\"\"}", "{\"file\":\"/dev/null\"}", "{\"meshes\":[]}", "{\"meshes\":[\"[\"]}"]
    {
        all.push(Hostile { name: format!("grains = {raw}"), text: with_raw("grains", raw) });
    }
    for raw in
        ["\"Pour\"", "\"pour \"", "\"pоur\"", "\"\"", "\"vibrate\\u0000\"", "\"__proto__\"", "7"]
    {
        let text = with_raw("stages.1.stage", raw);
        all.push(Hostile { name: format!("stages.1.stage = {raw}"), text });
    }
}

fn all() -> Vec<Hostile> {
    let mut all = Vec::new();
    bad_numbers(&mut all);
    bad_texts(&mut all);
    bad_sizes(&mut all);
    bad_names(&mut all);
    all
}

/// What loading a file answers, with its folder left out, on one line.
fn answer(folder: &Path, text: &[u8]) -> String {
    fs::write(folder.join("s.json"), text).expect("written");
    let said = match load_scenario(&folder.join("s.json"), &[]) {
        Ok(_) => "loads".to_owned(),
        Err(errors) => errors.to_string(),
    };
    let folder = folder.to_str().expect("UTF-8");
    said.replace(&format!("{folder}/"), "").replace(folder, "DIR").replace('\n', " |")
}

/// An answer as it is kept: one that is long by its beginning and its hash.
fn kept(said: &str) -> String {
    const LONG: usize = 1500;
    if said.chars().count() <= LONG {
        return said.to_owned();
    }
    let begin: String = said.chars().take(LONG / 2).collect();
    format!("{begin} … {} bytes, {}", said.len(), pluvia::record::hash_bytes(said.as_bytes()))
}

/// A folder in which names can lead astray.
fn labyrinth() -> tempfile::TempDir {
    let whole = sound().to_string();
    let folder = super::folder(&[
        ("circle-a.json", r#"{ "extends": "circle-b.json" }"#),
        ("circle-b.json", r#"{ "extends": "circle-a.json" }"#),
        ("list.json", "[1]"),
        ("ｓ.json", &whole),
    ]);
    fs::create_dir(folder.path().join("sub")).expect("a folder");
    std::os::unix::fs::symlink("s.json", folder.path().join("own-link.json")).expect("a link");
    folder
}

#[test]
fn every_hostile_scenario_has_its_answer_and_soon() {
    let folder = labyrinth();
    let mut got = String::new();
    let all = all();
    assert!(all.len() >= 300, "law: at least 300 of them, got {}", all.len());
    for Hostile { name, text } in &all {
        let started = Instant::now();
        let said = answer(folder.path(), text);
        let took = started.elapsed();
        assert!(took < Duration::from_secs(10), "law: `{name}` is answered soon, took {took:?}");
        assert!(
            said.len() < 60_000,
            "law: a hundred faults at most are reported, each in a line, `{name}`: {} bytes: {}",
            said.len(),
            said.chars().take(300).collect::<String>()
        );
        got += &format!("{name}\n    {}\n", kept(&said));
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/scenario/hostile.txt");
    if std::env::var_os("PLUVIA_WRITE").is_some() {
        fs::write(&file, &got).expect("written");
    }
    let expected = fs::read_to_string(&file).expect("hostile.txt");
    for (got, expected) in got.lines().zip(expected.lines()) {
        assert_eq!(got, expected, "law: answers are as in {}", file.display());
    }
    assert_eq!(got.lines().count(), expected.lines().count(), "law: as many answers");
}

/// Puts a value in place of the one numbered so, counted depth first.
fn replace(value: &mut Value, number: &mut usize, by: &Value) {
    if *number == 0 {
        *value = by.clone();
    }
    *number = number.wrapping_sub(1);
    match value {
        Value::Object(fields) => fields.values_mut().for_each(|v| replace(v, number, by)),
        Value::Array(values) => values.iter_mut().for_each(|v| replace(v, number, by)),
        _ => {}
    }
}

#[test]
fn any_value_in_any_place_is_answered() {
    let others = [
        json!(null),
        json!(true),
        json!(""),
        json!([]),
        json!({}),
        json!(-1),
        json!(1e308),
        json!([{ "stage": "pour" }]),
        json!({ "stage": "vibrate" }),
    ];
    let folder = labyrinth();
    let (mut tried, mut refused) = (0, 0);
    let text = String::from_utf8(with_raw("seed", "1")).expect("UTF-8");
    let whole: Value = serde_json::from_str(&text).expect("JSON");
    let mut places = 0;
    while {
        let (mut number, mut seen) = (places, whole.clone());
        replace(&mut seen, &mut number, &json!("@"));
        seen.to_string().contains("\"@\"")
    } {
        for other in &others {
            let mut spoilt = whole.clone();
            let mut number = places;
            replace(&mut spoilt, &mut number, other);
            tried += 1;
            refused += usize::from(answer(folder.path(), spoilt.to_string().as_bytes()) != "loads");
        }
        places += 1;
    }
    assert!(tried > 200 && refused * 3 > tried * 2, "{refused} of {tried} refused");
}
