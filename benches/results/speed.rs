//! Tables of `make bench` and `make bench-peers`: what steps cost, here and in other engines.

use serde_json::Value;

use super::tables::{head, row};

fn rows(all: &Value) -> Result<&Vec<Value>, String> {
    all.as_array().ok_or_else(|| "no rows".to_owned())
}

/// A number with its decimals; empty where it is not known.
pub(super) fn number(of: &Value, decimals: usize) -> String {
    // Adding nothing to what is rounded to nothing takes its sign away.
    let rounded = |x: f64| format!("{x:.decimals$}").parse::<f64>().unwrap_or(x) + 0.0;
    of.as_f64().map_or_else(String::new, |x| format!("{:.decimals$}", rounded(x)))
}

/// Numbers of fields, each field with its number of decimals, as in `grains:0 growth:2`.
pub(super) fn numbers(of: &Value, fields: &str) -> Vec<String> {
    let cell = |field: &str| {
        let (name, decimals) = field.split_once(':').unwrap_or((field, "0"));
        number(&of[name], decimals.parse().unwrap_or(0))
    };
    fields.split_whitespace().map(cell).collect()
}

/// A row an engine: wall time by scene, and what its grains look like at rest.
pub fn peers(all: &Value) -> Result<String, String> {
    let all = rows(all)?;
    let of = |engine: &str, scene: &str| {
        all.iter().find(|r| r["engine"] == engine && r["scene"] == scene).unwrap_or(&Value::Null)
    };
    let wall = |engine: &str, scene: &str| of(engine, scene)["wall_s_per_simulated_s"].as_f64();
    let mut engines: Vec<&str> = Vec::new();
    for name in all.iter().filter_map(|r| r["engine"].as_str()) {
        if !engines.contains(&name) {
            engines.push(name);
        }
    }
    let mut text = head(
        "engine | rest | shaken | pour | time over Pluvia's, shaken | overlap at rest, mean / p99, \
         % | overlap shaken | numerical creep, µm/s | MiB",
    );
    for engine in engines {
        let rest = of(engine, "rest");
        let settings = match (rest["rate_hz"].as_f64(), rest["iterations"].as_u64()) {
            (Some(rate), Some(iterations)) => format!(", {rate:.0} Hz × {iterations}"),
            (Some(rate), None) => format!(", {rate:.0} Hz"),
            _ => String::new(),
        };
        let time = |scene: &str| wall(engine, scene).map_or(String::new(), |s| format!("{s:.1}"));
        let times = wall(engine, "shaken").zip(wall("pluvia", "shaken"));
        let overlap = |scene: &str| {
            let both = ["overlap_mean_percent", "overlap_p99_percent"]
                .map(|field| number(&of(engine, scene)[field], 2));
            both.join(" / ").trim_matches([' ', '/']).to_owned()
        };
        text += &row(&[
            format!("{engine}{settings}"),
            time("rest"),
            time("shaken"),
            time("pour"),
            times.map_or(String::new(), |(own, pluvia)| format!("{:.1}", own / pluvia)),
            overlap("rest"),
            overlap("shaken"),
            number(&rest["creep_um_per_s"], 1),
            number(&of(engine, "shaken")["peak_memory_mib"], 0),
        ]);
    }
    Ok(text)
}

/// A row a specimen, state and number of threads, or of several worlds at once.
pub fn steps(all: &Value) -> Result<String, String> {
    let mut text = head(
        "state | grains | threads | ms per step | µs per grain and step | growth | serial share, % \
         | speed-up | KiB per grain",
    );
    for of in rows(all)? {
        let mut state = of["state"].as_str().ok_or("a row without a state")?.replace('_', ", ");
        match of["specimens"].as_u64().ok_or("a row without a number of specimens")? {
            1 => {}
            2 => state += ", two worlds at once",
            more => state += &format!(", {more} worlds at once"),
        }
        let serial = of["serial_share"].as_f64();
        let serial = serial.map_or(String::new(), |share| format!("{:.0}", 100.0 * share));
        let cost = numbers(of, "grains:0 threads:0 ms_per_step:2 us_per_grain_step:1 growth:2");
        let more = numbers(of, "speed_up:2 memory_kib_per_grain:1");
        text += &row(&[vec![state], cost, vec![serial], more].concat());
    }
    Ok(text)
}

/// A row a specimen, state and number of threads of one world: what each phase of a step takes per
/// grain.
pub fn phases(all: &Value) -> Result<String, String> {
    let mut text = head(
        "state | grains | threads | boxes, µs | contacts, µs | solver, µs | motion, µs | loaded \
         points per grain",
    );
    for of in rows(all)?.iter().filter(|of| of["specimens"].as_u64() == Some(1)) {
        let state = of["state"].as_str().ok_or("a row without a state")?.replace('_', ", ");
        let grains = of["grains"].as_f64().ok_or("a row without a number of grains")?;
        let phase = |name: &str| {
            let per_grain = of["phases"][name].as_f64().map(|ms| 1e3 * ms / grains);
            per_grain.map_or_else(String::new, |us| format!("{us:.2}"))
        };
        let phases = ["broadphase_ms", "collision_ms", "solver_ms", "integration_ms"].map(phase);
        let [given, points] =
            ["grains:0 threads:0", "contacts_per_grain:2"].map(|f| numbers(of, f));
        text += &row(&[vec![state], given, phases.to_vec(), points].concat());
    }
    Ok(text)
}
