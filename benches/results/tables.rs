//! Tables of pages, drawn from result files.

use serde_json::Value;

use super::{builds, joint, laboratory, list, missed::missed, referee, speed, value::Results};

pub(super) type Cells<'a> = &'a dyn Fn(&str) -> Result<String, String>;

/// The table of a name, as Markdown.
pub fn named(name: &str, results: &Results) -> Result<String, String> {
    let quote = |key: &str| results.quote(key).map_err(|e| format!("{key}: {e}"));
    match name {
        "ten-realisations" => ten(&quote),
        "first-three" => three(&quote, true),
        "measured" => three(&quote, false),
        "engines" => engines(&quote, results.source("engines")?.as_ref()),
        "handed-over" => handed(&quote),
        "settlement" => settlement(&quote, results.source("settlement")?.as_ref()),
        "twins" => twins(&quote),
        "calibration" => calibration(results.source("calibration")?.as_ref()),
        "stock" => stock(&quote),
        "missed" => missed(results.source("verify")?.as_ref()),
        "laboratory" => laboratory::verdicts(&quote, results.source("laboratory")?.as_ref()),
        "laboratory-sources" => Ok(laboratory::sources(results.source("laboratory")?.as_ref())),
        "laboratory-missed" => laboratory::missed(&quote, results.source("laboratory")?.as_ref()),
        "laboratory-density" => laboratory::density(&quote, results.source("laboratory")?.as_ref()),
        "laboratory-shear" => laboratory::shear_end(&quote, results.source("laboratory")?.as_ref()),
        "laboratory-build" => {
            let builds = builds::read(results.root())?;
            Ok(laboratory::build(&builds, results.source("laboratory")?.as_ref()))
        }
        "laboratory-column-tried" => {
            Ok(laboratory::column_tried(results.source("laboratory")?.as_ref()))
        }
        "laboratory-density-tried" => {
            Ok(laboratory::density_tried(results.source("laboratory")?.as_ref()))
        }
        "laboratory-vibration" => Ok(laboratory::vibration(results.source("laboratory")?.as_ref())),
        "grain-sieve" => grain_sieve(&quote, results.source("grains")?.as_ref()),
        "grain-sizes" => grain_sizes(&quote),
        "grain-shape" => grain_shape(&quote),
        "joint-targets" => joint::targets(results.source("joint")?.as_ref()),
        "joint-together" => joint::together(results.source("joint")?.as_ref()),
        "peers" => speed::peers(results.source("peers")?.as_ref()),
        "referee-one-step" => referee::one_step(results.source("referee")?.as_ref()),
        "referee-static" => referee::certificates(results.source("referee")?.as_ref()),
        "steps" => speed::steps(results.source("bench")?.as_ref()),
        "files" => Ok(files(&builds::read(results.root())?)),
        _ => Err("no table has this name".to_owned()),
    }
}

pub(super) fn row(cells: &[String]) -> String {
    let mut text = String::from("|");
    for cell in cells {
        text += if cell.is_empty() { " |" } else { " " };
        if !cell.is_empty() {
            text += cell;
            text += " |";
        }
    }
    text + "\n"
}

pub(super) fn head(names: &[&str]) -> String {
    row(&names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>())
        + "|"
        + &" --- |".repeat(names.len())
        + "\n"
}

/// Quantities of the programme, with what the paper's text says of them.
const TEN: [(&str, &str, usize, &str, &str); 11] = [
    ("mean surface, poured from 0 cm, mm", "standing height from 0 cm", 1, "", ""),
    ("from 5 cm", "standing height from 5 cm", 1, "", ""),
    ("from 10 cm", "standing height from 10 cm", 1, "", ""),
    ("from 20 cm", "standing height from 20 cm", 1, "", ""),
    (
        "plate settlement after 5 s, continuous, mm",
        "continuous vibration, plate, after 5 s",
        1,
        "",
        "",
    ),
    ("after 20 s", "continuous vibration, plate, final", 1, "", "14 to 19.61"),
    (
        "share in the first 5 s",
        "continuous vibration, plate, share after 5 s",
        0,
        " %",
        "about 80 %",
    ),
    ("surface settlement after 20 s, mm", "continuous vibration, mean surface, final", 1, "", ""),
    ("plate settlement, intermittent, mm", "intermittent vibration, plate, final", 1, "", ""),
    (
        "share in the first period",
        "intermittent vibration, plate, share after the first period",
        0,
        " %",
        "about 85 %",
    ),
    (
        "surface settlement, intermittent, mm",
        "intermittent vibration, mean surface, final",
        1,
        "",
        "",
    ),
];

fn ten(quote: Cells) -> Result<String, String> {
    let mut text = head(&[
        "ten realisations",
        "mean, 95 % confidence",
        "standard deviation",
        "smallest to largest",
        "paper",
    ]);
    for (label, quantity, decimals, unit, paper) in TEN {
        let key = |path: &str, word: &str| {
            quote(&format!("uncertainty:quantities/{quantity}{path}:{word}.{decimals}"))
        };
        text += &row(&[
            label.to_owned(),
            key("", "±")? + unit,
            key("/standard_deviation", "")? + unit,
            key("/range", "range")? + unit,
            paper.to_owned(),
        ]);
    }
    Ok(text)
}

/// The paper's three realisations; `all`: with rows that the short table leaves out.
fn three(quote: Cells, all: bool) -> Result<String, String> {
    let mut text = head(&["", "realisation 1", "realisation 2", "realisation 3"]);
    let value = |quantity: &str, n: usize, decimals: usize| {
        quote(&format!("uncertainty:quantities/{quantity}/values/{n}:.{decimals}"))
    };
    let mut heights = vec!["mean surface, poured from 0 / 5 / 10 / 20 cm, mm".to_owned()];
    for n in 0..3 {
        let cells: Result<Vec<_>, _> = [0, 5, 10, 20]
            .iter()
            .map(|cm| value(&format!("standing height from {cm} cm"), n, 1))
            .collect();
        heights.push(cells?.join(" / "));
    }
    text += &row(&heights);
    let continuous = [
        (
            "plate settlement after 20 s, continuous, mm",
            "continuous vibration, plate, final",
            1,
            "",
        ),
        ("surface settlement, the same, mm", "continuous vibration, mean surface, final", 1, ""),
        (
            "share of the plate's in the first 5 s",
            "continuous vibration, plate, share after 5 s",
            0,
            " %",
        ),
        ("plate settlement, intermittent, mm", "intermittent vibration, plate, final", 1, ""),
        (
            "share of the plate's in the first period",
            "intermittent vibration, plate, share after the first period",
            0,
            " %",
        ),
    ];
    for (label, quantity, decimals, unit) in continuous {
        if !all && label.starts_with("surface") {
            continue;
        }
        let mut cells = vec![label.to_owned()];
        for n in 0..3 {
            cells.push(value(quantity, n, decimals)? + unit);
        }
        text += &row(&cells);
    }
    Ok(text)
}

fn items(value: &Value) -> Vec<(String, &Value)> {
    let name = |v: &Value| v.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    value.as_array().into_iter().flatten().map(|v| (name(v), v)).collect()
}

/// A cell; empty where its value is null.
fn cell(
    quote: Cells,
    value: &Value,
    source: &str,
    path: &str,
    format: &str,
) -> Result<String, String> {
    let field = path.rsplit('/').next().unwrap_or_default();
    if value.get(field).is_some_and(Value::is_null) {
        return Ok(String::new());
    }
    quote(&format!("{source}:{path}:{format}"))
}

fn engines(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text = head(&[
        "contacts",
        "μ",
        "e",
        "realisations",
        "jammed",
        "void ratio",
        "standard deviation",
        "height over the native one, %",
    ]);
    for (name, value) in items(all) {
        let at = |path: &str, format: &str| {
            cell(quote, value, "engines", &format!("{name}/{path}"), format)
        };
        let typed = |field: &str| value.get(field).map_or(String::new(), Value::to_string);
        text += &row(&[
            at("label", "text")?,
            typed("friction").replace("0.0", "0"),
            typed("restitution").replace("0.0", "0"),
            at("count", "")?,
            at("jammed", "")?,
            at("void_ratio", "±.3")?,
            at("void_ratio/sd", ".3")?,
            at("height_over_native_percent", "±.1")?,
        ]);
    }
    Ok(text)
}

fn handed(quote: Cells) -> Result<String, String> {
    let mut text = head(&[
        "poured by",
        "shaken by",
        "settlement of the surface, mm",
        "of the plate, mm",
        "largest numerical creep, µm/s",
    ]);
    for by in ["native", "rapier"] {
        for engine in ["native", "rapier"] {
            let at =
                |path: &str, format: &str| quote(&format!("handed:{by} {engine}/{path}:{format}"));
            let decimals = if engine == "native" { ".2" } else { ".0" };
            text += &row(&[
                by.to_owned(),
                engine.to_owned(),
                at("surface_mm", "±.1")?,
                at("plate_mm", "±.1")?,
                at("largest_creep_um_per_s", decimals)?,
            ]);
        }
    }
    Ok(text)
}

fn settlement(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text = head(&[
        "setting",
        "height, %",
        "surface settlement, mm",
        "deviation, %",
        "plate, mm",
        "deviation, %",
    ]);
    for (n, (name, value)) in items(all).into_iter().enumerate() {
        let at = |path: &str, format: &str| {
            cell(quote, value, "settlement", &format!("{n}/{path}"), format)
        };
        text += &row(&[
            name.clone(),
            at("height_percent", "+±.1")?,
            at("surface_mm", "mean.1")?,
            at("surface_percent", "+±.0")?,
            at("plate_mm", "mean.1")?,
            at("plate_percent", "+±.0")?,
        ]);
    }
    Ok(text)
}

fn twins(quote: Cells) -> Result<String, String> {
    let mut text = head(&[
        "times as large",
        "runs",
        "void ratio",
        "height / size, mm",
        "coordination number",
        "overlap, mean %",
        "99th percentile %",
        "largest numerical creep, µm/s (allowed)",
    ]);
    for larger in ["0.1", "1", "5"] {
        let at = |path: &str, format: &str| {
            quote(&format!("twins-means:name={larger}/0/{path}:{format}"))
        };
        let creep = at("largest_creep_um_per_s", ".1")?;
        text += &row(&[
            larger.to_owned(),
            at("count", "")?,
            at("void_ratio", "±.3")?,
            at("height_over_size_mm", "±.1")?,
            at("coordination_number", "±.2")?,
            at("overlap_mean_percent", "mean.3")?,
            at("overlap_p99_percent", "mean.2")?,
            format!("{creep} ({})", at("allowed_creep_um_per_s", ".1")?),
        ]);
    }
    Ok(text)
}

fn calibration(found: &Value) -> Result<String, String> {
    let mut text =
        head(&["friction coefficient μ", "atan μ", "angle of repose, 95 % confidence", "piles"]);
    for of in found["values"].as_array().ok_or("a calibration has values")? {
        let at = |field: &str| of[field].as_f64().ok_or(format!("a value has its {field}"));
        text += &row(&[
            format!("{:.2}", at("value")?),
            format!("{:.1}°", at("value")?.atan().to_degrees()),
            format!("{:.1} ± {:.1}°", at("mean")?, at("half_width_95")?),
            format!("{}", at("runs")?),
        ]);
    }
    Ok(text)
}

fn stock(quote: Cells) -> Result<String, String> {
    let mut text = head(&["", "paper", "realisation 1", "2", "3"]);
    for (label, paper, field, decimals) in [
        ("standing height from 0 cm, mm", "", "height_from_0_cm_mm", 1),
        ("from 5 cm", "", "height_from_5_cm_mm", 1),
        ("from 20 cm", "lower", "height_from_20_cm_mm", 1),
        ("plate, after 5 s, mm", "", "plate_after_5_s_mm", 1),
        ("plate, after 20 s, mm", "14 to 19.61", "plate_after_20_s_mm", 1),
        ("numerical creep of the poured specimen, µm/s", "", "creep_um_per_s", 0),
    ] {
        let mut cells = vec![label.to_owned(), paper.to_owned()];
        for n in 0..3 {
            cells.push(quote(&format!("stock:{n}/{field}:.{decimals}"))?);
        }
        text += &row(&cells);
    }
    Ok(text)
}

fn grain_sieve(quote: Cells, grains: &Value) -> Result<String, String> {
    let mut text =
        head(&["stays between, mm", "specified, % of mass", "found, % of mass", "grains found"]);
    let fractions = grains["sieve_analysis"]["fractions"].as_array().map_or(0, Vec::len);
    for n in 0..fractions {
        let fraction = &grains["sieve_analysis"]["fractions"][n];
        let sieves = match (fraction["retained_mm"].as_f64(), fraction["passing_mm"].as_f64()) {
            (Some(low), Some(high)) => format!("{low}–{high}"),
            (Some(low), None) => format!("over {low}"),
            (None, high) => format!("under {}", high.unwrap_or_default()),
        };
        let at = |field: &str, format: &str| {
            quote(&format!("grains:sieve_analysis/fractions/{n}/{field}:{format}"))
        };
        text += &row(&[
            sieves,
            at("specified_percent", ".2")?,
            at("mass_percent", ".1")?,
            at("grains", "")?,
        ]);
    }
    Ok(text)
}

fn grain_sizes(quote: Cells) -> Result<String, String> {
    let mut text = head(&["", "D10, mm", "D30, mm", "D50, mm", "D60, mm", "Cu", "Cc", "USCS"]);
    for (label, path) in [("specified", "specified/"), ("generated", "")] {
        let mut cells = vec![label.to_owned()];
        for field in [
            "d10_mm",
            "d30_mm",
            "d50_mm",
            "d60_mm",
            "coefficient_of_uniformity",
            "coefficient_of_curvature",
        ] {
            cells.push(quote(&format!("grains:sieve_analysis/{path}{field}:.2"))?);
        }
        cells.push(quote(&format!("grains:sieve_analysis/{path}uscs:text"))?);
        text += &row(&cells);
    }
    Ok(text)
}

fn grain_shape(quote: Cells) -> Result<String, String> {
    let mut text = head(&["", "10th percentile", "median", "90th percentile", "mean"]);
    for (label, field, decimals) in [
        ("elongation L/I", "elongation", 2),
        ("flatness I/S", "flatness", 2),
        ("sphericity", "sphericity", 2),
        ("faces", "faces", 0),
        ("vertices", "vertices", 0),
    ] {
        let at = |which: &str, more: usize| {
            quote(&format!("grains:shape/{field}/{which}:.{}", decimals + more))
        };
        let more = usize::from(decimals == 0);
        text += &row(&[
            label.to_owned(),
            at("p10", 0)?,
            at("p50", 0)?,
            at("p90", 0)?,
            at("mean", more)?,
        ]);
    }
    Ok(text)
}

/// What each file of `docs/results/` is.
fn files(builds: &[builds::Build]) -> String {
    let mut text = head(&["files", "what", "made by", "build"]);
    for kept in list::KEPT {
        let names: Vec<String> =
            kept.files.iter().map(|(file, _)| format!("[{file}]({file})")).collect();
        let made = match &kept.made {
            list::Made::Pluvia(commands) => {
                commands.iter().map(|c| format!("`pluvia {c}`")).collect::<Vec<_>>().join(", then ")
            }
            list::Made::Make(target) => format!("`make {target}`"),
            list::Made::Once(command) => format!("{command}; not made by `make results`"),
        };
        let build = builds::of(builds, kept.name);
        let build = build.map(|build| format!("{}, format {}", build.day, build.format));
        text += &row(&[names.join(", "), kept.what.to_owned(), made, build.unwrap_or_default()]);
    }
    for (file, what) in list::OTHERS {
        text +=
            &row(&[format!("[{file}]({file})"), (*what).to_owned(), String::new(), String::new()]);
    }
    text
}
