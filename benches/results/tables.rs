//! Tables of pages, drawn from result files.

use serde_json::Value;

use super::{
    builds, derived, joint, laboratory, list, missed::missed, referee, speed, value::Results,
};

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
        "shaken" => shaken(&quote, results.source("shaken")?.as_ref()),
        "sizes" => sizes(&quote),
        "twins" => twins(&quote),
        "twins-differences" => {
            twin_differences(&quote, results.source("twins-differences")?.as_ref())
        }
        "calibration" => calibration(results.source("calibration")?.as_ref()),
        "stock" => by_realisation(&quote, "stock", &STOCK),
        "stock-at-rest" => by_realisation(&quote, "stock-at-rest", &STOCK_AT_REST),
        "missed" => missed(results.source("verify")?.as_ref()),
        "laboratory" => laboratory::verdicts(&quote, results.source("laboratory")?.as_ref()),
        "laboratory-sources" => Ok(laboratory::sources(results.source("laboratory")?.as_ref())),
        "laboratory-missed" => laboratory::missed(&quote, results.source("laboratory")?.as_ref()),
        "laboratory-density" => laboratory::density(&quote, results.source("laboratory")?.as_ref()),
        "laboratory-shear" => laboratory::shear_end(&quote, results.source("laboratory")?.as_ref()),
        "laboratory-triaxial" => {
            laboratory::triaxial_end(&quote, results.source("laboratory")?.as_ref())
        }
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
        "referee-frictionless" => referee::pours(results.source("referee-frictionless")?.as_ref()),
        "referee-static" => referee::certificates(results.source("referee")?.as_ref()),
        "steps" => speed::steps(results.source("bench")?.as_ref()),
        "phases" => speed::phases(results.source("bench")?.as_ref()),
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

/// The names of columns, with `|` between them, and the line below.
pub(super) fn head(names: &str) -> String {
    format!("| {names} |\n|{}\n", " --- |".repeat(names.matches('|').count() + 1))
}

/// Quantities of the programme, with what the paper's text says of them. Shares are in whole
/// percent, lengths have one decimal.
const TEN: [(&str, &str, &str, &str); 11] = [
    ("mean surface, poured from 0 cm, mm", "standing height from 0 cm", "", ""),
    ("from 5 cm", "standing height from 5 cm", "", ""),
    ("from 10 cm", "standing height from 10 cm", "", ""),
    ("from 20 cm", "standing height from 20 cm", "", ""),
    (
        "plate settlement after 5 s, continuous, mm",
        "continuous vibration, plate, after 5 s",
        "",
        "",
    ),
    ("after 20 s", "continuous vibration, plate, final", "", "14 to 19.61"),
    ("share in the first 5 s", "continuous vibration, plate, share after 5 s", " %", "about 80 %"),
    ("surface settlement after 20 s, mm", "continuous vibration, mean surface, final", "", ""),
    ("plate settlement, intermittent, mm", "intermittent vibration, plate, final", "", ""),
    (
        "share in the first period",
        "intermittent vibration, plate, share after the first period",
        " %",
        "about 85 %",
    ),
    ("surface settlement, intermittent, mm", "intermittent vibration, mean surface, final", "", ""),
];

fn ten(quote: Cells) -> Result<String, String> {
    let mut text = head(
        "ten realisations | mean, 95 % confidence | standard deviation | smallest to largest | \
         paper",
    );
    for (label, quantity, unit, paper) in TEN {
        let decimals = usize::from(unit.is_empty());
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
    let mut text = head("| realisation 1 | realisation 2 | realisation 3");
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
        ("plate settlement after 20 s, continuous, mm", "continuous vibration, plate, final", ""),
        ("surface settlement, the same, mm", "continuous vibration, mean surface, final", ""),
        (
            "share of the plate's in the first 5 s",
            "continuous vibration, plate, share after 5 s",
            " %",
        ),
        ("plate settlement, intermittent, mm", "intermittent vibration, plate, final", ""),
        (
            "share of the plate's in the first period",
            "intermittent vibration, plate, share after the first period",
            " %",
        ),
    ];
    for (label, quantity, unit) in continuous {
        let decimals = usize::from(unit.is_empty());
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

/// Cells of fields by their formats, written as `count void_ratio:±.3`.
fn cells(
    at: &dyn Fn(&str, &str) -> Result<String, String>,
    fields: &str,
) -> Result<Vec<String>, String> {
    let cell = |field: &str| {
        let (path, format) = field.split_once(':').unwrap_or((field, ""));
        at(path, format)
    };
    fields.split_whitespace().map(cell).collect()
}

fn engines(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text = head(
        "contacts | μ | e | realisations | jammed | void ratio | standard deviation | height over \
         the native one, %",
    );
    for (name, value) in items(all) {
        let at = |path: &str, format: &str| {
            cell(quote, value, "engines", &format!("{name}/{path}"), format)
        };
        let typed = |field: &str| value.get(field).map_or(String::new(), Value::to_string);
        let given = ["friction", "restitution"].map(|field| typed(field).replace("0.0", "0"));
        let found = "count jammed void_ratio:±.3 void_ratio/sd:.3 height_over_native_percent:±.1";
        let [label, found] = ["label:text", found].map(|fields| cells(&at, fields));
        text += &row(&[label?, given.to_vec(), found?].concat());
    }
    Ok(text)
}

fn handed(quote: Cells) -> Result<String, String> {
    let mut text = head(
        "poured by | shaken by | settlement of the surface, mm | of the plate, mm | largest \
         numerical creep, µm/s",
    );
    for by in ["native", "rapier"] {
        for engine in ["native", "rapier"] {
            let at =
                |path: &str, format: &str| quote(&format!("handed:{by} {engine}/{path}:{format}"));
            let decimals = if engine == "native" { ".2" } else { ".0" };
            let fields = format!("surface_mm:±.1 plate_mm:±.1 largest_creep_um_per_s:{decimals}");
            text += &row(&[vec![by.to_owned(), engine.to_owned()], cells(&at, &fields)?].concat());
        }
    }
    Ok(text)
}

fn settlement(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text = head(
        "setting | height, % | surface settlement, mm | deviation, % | plate, mm | deviation, %",
    );
    for (n, (name, value)) in items(all).into_iter().enumerate() {
        let at = |path: &str, format: &str| {
            cell(quote, value, "settlement", &format!("{n}/{path}"), format)
        };
        let fields = "height_percent:+±.1 surface_mm:mean.1 surface_percent:+±.0 \
                      plate_mm:mean.1 plate_percent:+±.0";
        text += &row(&[vec![name.clone()], cells(&at, fields)?].concat());
    }
    Ok(text)
}

fn shaken(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text = head(
        "setting | specimens | settlement of the surface, mm | deviation, % | of the plate, mm | deviation, %",
    );
    for (n, (name, value)) in items(all).into_iter().enumerate() {
        let at =
            |path: &str, format: &str| cell(quote, value, "shaken", &format!("{n}/{path}"), format);
        let fields =
            "count surface_mm:mean.1 surface_percent:+±.0 plate_mm:mean.1 plate_percent:+±.0";
        text += &row(&[vec![name.clone()], cells(&at, fields)?].concat());
    }
    Ok(text)
}

fn sizes(quote: Cells) -> Result<String, String> {
    let mut text = head(
        "grains | seeds | that meet the standard | void ratio | largest overlap, mean % | 99th \
         percentile % | largest numerical creep, µm/s (allowed)",
    );
    for (name, label) in [
        ("sand", "sand, 0.5 to 2 mm"),
        ("gravel", "gravel, 8 to 16 mm"),
        ("ballast", "ballast, 31.5 to 63 mm"),
    ] {
        let at = |path: &str, format: &str| quote(&format!("sizes:name={name}/0/{path}:{format}"));
        let creep = at("largest_creep_um_per_s", ".2")?;
        let creep = format!("{creep} ({})", at("allowed_creep_um_per_s", ".2")?);
        let fields = "count met void_ratio:±.2 overlap_mean_percent:.3 overlap_p99_percent:.2";
        text += &row(&[vec![label.to_owned()], cells(&at, fields)?, vec![creep]].concat());
    }
    Ok(text)
}

fn twins(quote: Cells) -> Result<String, String> {
    let mut text = head(
        "times as large | runs | left out | void ratio | height / size, mm | coordination number | \
         overlap, mean % | 99th percentile % | largest numerical creep, µm/s (allowed)",
    );
    for larger in ["0.1", "1", "5"] {
        let at = |path: &str, format: &str| {
            quote(&format!("twins-means:name={larger}/0/{path}:{format}"))
        };
        let creep = at("largest_creep_um_per_s", ".1")?;
        let creep = format!("{creep} ({})", at("allowed_creep_um_per_s", ".1")?);
        let fields = "count left_out void_ratio:±.3 height_over_size_mm:±.1 \
                      coordination_number:±.2 overlap_mean_percent:mean.3 \
                      overlap_p99_percent:mean.2";
        text += &row(&[vec![larger.to_owned()], cells(&at, fields)?, vec![creep]].concat());
    }
    Ok(text)
}

fn twin_differences(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text =
        head("times as large | pairs | height / size, % | void ratio, % | coordination number, %");
    for (n, (name, value)) in items(all).into_iter().enumerate() {
        let mut found = vec![name, quote(&format!("twins-differences:{n}/count:"))?];
        for field in ["height_percent", "void_ratio_percent", "coordination_percent"] {
            let path = format!("{n}/{field}");
            let difference = cell(quote, value, "twins-differences", &path, "+±.2")?;
            let is_plain = difference.is_empty() || derived::lacks_zero(&value[field]);
            found.push(difference + if is_plain { "" } else { " ~" });
        }
        text += &row(&found);
    }
    Ok(text)
}

fn calibration(found: &Value) -> Result<String, String> {
    let mut text = head(
        "friction coefficient μ | atan μ | angle of repose, 95 % confidence | piles that count",
    );
    for of in found["values"].as_array().ok_or("a calibration has values")? {
        let at = |field: &str| of[field].as_f64().ok_or(format!("a value has its {field}"));
        text += &row(&[
            format!("{:.2}", at("value")?),
            format!("{:.1}°", at("value")?.atan().to_degrees()),
            format!("{:.1} ± {:.1}°", at("mean")?, at("half_width_95")?),
            format!("{}", at("runs")? - at("failed")? - at("left_out")?),
        ]);
    }
    Ok(text)
}

/// Rows of a table of three realisations: label, the paper's number, field and decimals.
type Field = (&'static str, &'static str, &'static str, usize);

fn by_realisation(quote: Cells, source: &str, fields: &[Field]) -> Result<String, String> {
    let mut text = head("| paper | realisation 1 | 2 | 3");
    for (label, paper, field, decimals) in fields {
        let mut cells = vec![(*label).to_owned(), (*paper).to_owned()];
        for n in 0..3 {
            cells.push(quote(&format!("{source}:{n}/{field}:.{decimals}"))?);
        }
        text += &row(&cells);
    }
    Ok(text)
}

const STOCK: [Field; 6] = [
    ("standing height from 0 cm, mm", "", "height_from_0_cm_mm", 1),
    ("from 5 cm", "", "height_from_5_cm_mm", 1),
    ("from 20 cm", "lower", "height_from_20_cm_mm", 1),
    ("plate, after 5 s, mm", "", "plate_after_5_s_mm", 1),
    ("plate, after 20 s, mm", "14 to 19.61", "plate_after_20_s_mm", 1),
    ("numerical creep of the poured specimen, µm/s", "", "creep_um_per_s", 0),
];

const STOCK_AT_REST: [Field; 7] = [
    ("stock, at rest: plate, after 5 s, mm", "", "stock_rest_plate_after_5_s_mm", 1),
    ("after 20 s", "", "stock_rest_plate_after_20_s_mm", 1),
    ("mean surface, after 20 s", "", "stock_rest_surface_after_20_s_mm", 1),
    ("stock, shaken: plate, after 5 s, mm", "", "stock_shaken_plate_after_5_s_mm", 1),
    ("at the end of shaking, 20 s", "14 to 19.61", "stock_shaken_plate_after_20_s_mm", 1),
    ("mean surface, likewise", "", "stock_shaken_surface_after_20_s_mm", 1),
    ("native, at rest: plate, after 20 s, mm", "", "native_rest_plate_after_20_s_mm", 2),
];

fn grain_sieve(quote: Cells, grains: &Value) -> Result<String, String> {
    let mut text =
        head("stays between, mm | specified, % of mass | found, % of mass | grains found");
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
        let found = cells(&at, "specified_percent:.2 mass_percent:.1 grains")?;
        text += &row(&[vec![sieves], found].concat());
    }
    Ok(text)
}

fn grain_sizes(quote: Cells) -> Result<String, String> {
    let mut text = head("| D10, mm | D30, mm | D50, mm | D60, mm | Cu | Cc | USCS");
    for (label, path) in [("specified", "specified/"), ("generated", "")] {
        let at = |field: &str, format: &str| {
            quote(&format!("grains:sieve_analysis/{path}{field}:{format}"))
        };
        let fields = "d10_mm:.2 d30_mm:.2 d50_mm:.2 d60_mm:.2 coefficient_of_uniformity:.2 \
                      coefficient_of_curvature:.2 uscs:text";
        text += &row(&[vec![label.to_owned()], cells(&at, fields)?].concat());
    }
    Ok(text)
}

fn grain_shape(quote: Cells) -> Result<String, String> {
    let mut text = head("| 10th percentile | median | 90th percentile | mean");
    for (label, field, decimals) in [
        ("elongation L/I", "elongation", 2),
        ("flatness I/S", "flatness", 2),
        ("sphericity", "sphericity", 2),
        ("faces", "faces", 0),
        ("vertices", "vertices", 0),
    ] {
        let at =
            |which: &str, format: &str| quote(&format!("grains:shape/{field}/{which}:{format}"));
        let of_mean = decimals.max(1);
        let fields = format!("p10:.{decimals} p50:.{decimals} p90:.{decimals} mean:.{of_mean}");
        text += &row(&[vec![label.to_owned()], cells(&at, &fields)?].concat());
    }
    Ok(text)
}

/// What each file of `docs/results/` is.
fn files(builds: &[builds::Build]) -> String {
    let mut text = head("files | what | made by | build");
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
