//! Tables and sentences of the page of the standard tests, so that it says what its rows say,
//! whatever they are.

use serde_json::Value;

use super::{
    builds::{self, Build},
    tables::{Cells, head, row},
};

fn rows(all: &Value) -> impl Iterator<Item = &Value> {
    all.as_array().into_iter().flatten()
}

fn typed(of: &Value, field: &str) -> String {
    of[field].as_str().unwrap_or_default().to_owned()
}

/// A number of a row, as the row is shown.
fn number(quote: Cells, of: &Value, path: &str) -> Result<String, String> {
    let decimals = of["decimals"].as_u64().unwrap_or(2);
    quote(&format!("laboratory:{}/{path}:.{decimals}", typed(of, "id")))
}

/// What is published of a row.
fn published(quote: Cells, of: &Value) -> Result<String, String> {
    let at = |path: &str| number(quote, of, path);
    let published = &of["published"];
    Ok(if published["value"].is_number() {
        at("published/value")?
    } else if published["low"].is_number() {
        format!("{} to {}", at("published/low")?, at("published/high")?)
    } else {
        String::new()
    })
}

/// The mean of a row with its interval.
fn ours(quote: Cells, of: &Value) -> Result<String, String> {
    let at = |path: &str| number(quote, of, path);
    let mut text = match of["ours"].is_number() {
        true => at("ours")?,
        false => String::new(),
    };
    if of["interval"].is_object() {
        text += &format!(" ({} to {})", at("interval/low")?, at("interval/high")?);
    }
    Ok(text)
}

/// All rows: what is published, ours, and what came of it.
pub fn verdicts(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text = head(&["", "published", "ours, 95 % confidence", "realisations", "verdict"]);
    for value in rows(all) {
        let verdict = match typed(value, "verdict").as_str() {
            "outside" => "**missed**".to_owned(),
            other => other.replace('_', " "),
        };
        let count = value["values"].as_array().map_or(0, Vec::len);
        text += &row(&[
            typed(value, "quantity"),
            published(quote, value)?,
            ours(quote, value)?,
            count.to_string(),
            verdict,
        ]);
    }
    Ok(text)
}

/// Where the published numbers were seen, and what a reader must know.
pub fn sources(all: &Value) -> String {
    let mut text = head(&["", "source", "how it was measured, and what was tried"]);
    for value in rows(all) {
        text += &row(&[typed(value, "quantity"), typed(value, "source"), typed(value, "note")]);
    }
    text
}

/// Rows that miss, and what was tried with each.
pub fn missed(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text = String::new();
    for value in rows(all).filter(|value| value["verdict"] == "outside") {
        let note = typed(value, "note");
        let tried = note.find("Tried").map_or("nothing with these grains", |at| &note[at..]);
        let cells = [
            typed(value, "quantity"),
            published(quote, value)?,
            ours(quote, value)?,
            tried.to_owned(),
        ];
        text += &row(&cells);
    }
    if text.is_empty() {
        return Ok("No row misses.\n".to_owned());
    }
    Ok(head(&["missed", "published", "ours, 95 % confidence", "what was tried"]) + &text)
}

/// Grains whose index densities are published.
const PUBLISHED: [&str; 2] = ["density-basalt-", "density-gravel-"];

/// How far void ratios are from the published ones, with what was tried.
pub fn density(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text = head(&["void ratio", "published", "ours, 95 % confidence", "less published"]);
    for value in rows(all) {
        let id = typed(value, "id");
        let is_one = PUBLISHED.iter().any(|begin| id.starts_with(begin));
        let of = |field: &str| value["published"][field].as_f64();
        let stated = of("value").or_else(|| Some((of("low")? + of("high")?) / 2.0));
        let Some((stated, mean)) = stated.zip(value["ours"].as_f64()).filter(|_| is_one) else {
            continue;
        };
        let apart = format!("{:+.3}", mean - stated).replace('-', "−");
        let quantity = typed(value, "quantity");
        let quantity = quantity.trim_start_matches("void ratio of ").to_owned();
        text += &row(&[quantity, format!("{stated:.3}"), ours(quote, value)?, apart]);
    }
    Ok(text)
}

/// Whether direct shear ends at the critical state, and what a test that goes further says.
pub fn shear_end(quote: Cells, all: &Value) -> Result<String, String> {
    let find = |id: &str| {
        rows(all).find(|value| value["id"] == id).filter(|value| value["ours"].is_number())
    };
    let mean = |value: &Value| number(quote, value, "ours");
    let ends = find("direct-shear-dilation-end").zip(find("direct-shear-dilation"));
    let Some((end, peak)) = ends else { return Ok(String::new()) };
    let values = end["values"].as_array().into_iter().flatten().filter_map(Value::as_f64);
    let rises: Vec<f64> = values.collect();
    let still = rises.iter().filter(|rise| **rise > 0.0).count();
    let mut text = format!(
        "Over the last third of the displacement the lid rises at {}° on average, against {}° at \
         the peak (50 kPa).\nIt still rises there in {still} of {} realisations{}.\n",
        mean(end)?,
        mean(peak)?,
        rises.len(),
        if still > 0 { ": **the end of such a test is not the critical state**" } else { "" }
    );
    if let Some((angle, rise)) =
        find("direct-shear-far-end").zip(find("direct-shear-far-dilation-end"))
    {
        text += &format!(
            "A test that goes twice as far ends at {}°, with the lid rising at {}°.\n",
            mean(angle)?,
            mean(rise)?
        );
    }
    Ok(text)
}

/// Of which builds the rows are.
pub fn build(builds: &[Build]) -> String {
    builds::of(builds, "laboratory").map_or_else(String::new, |build| {
        let several = match build.format.contains("and") {
            true => ": rows of different tests may be of different builds",
            false => "",
        };
        format!(
            "Rows and figures are of {}, [format](README.md#the-files) {}{several}.\n",
            build.day, build.format
        )
    })
}
