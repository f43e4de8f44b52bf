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
    let mut text = head("| published | ours, 95 % confidence | realisations | verdict");
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
    let mut text = head("| source | how it was measured, and what was tried");
    for value in rows(all) {
        text += &row(&[typed(value, "quantity"), typed(value, "source"), typed(value, "note")]);
    }
    text
}

/// What may explain a miss of a column, as notes call it where it was tried.
const OF_COLUMN: [&str; 4] =
    ["friction 0.2 in place of 0.5", "spheres", "a column twice as wide", THINLY];
/// How a run-out is read a second time, which is not judged.
const THINLY: &str = "where a tenth of a ring is covered";
/// The same of index densities.
const OF_DENSITIES: [&str; 3] =
    ["longer and flatter grains", "friction between grains of 1.0", "both together"];

/// With which rows of the small design that is tried.
const TRIED: [(&str, &[&str]); 6] = [
    ("column-run-out-0.6", &["a column twice as wide"]),
    ("column-run-out-1.2", &["friction 0.2 in place of 0.5", "spheres", "a column twice as wide"]),
    ("density-basalt-e-max", &OF_DENSITIES),
    ("density-basalt-e-min", &OF_DENSITIES),
    ("density-gravel-e-max", &OF_DENSITIES),
    ("density-gravel-e-min", &OF_DENSITIES),
];

/// The note of a row, and what was left out of its test.
fn note_of(of: &Value) -> (String, String) {
    let note = typed(of, "note");
    let (own, left_out) = note.split_once("; left out of this test: ").unwrap_or((&note, ""));
    (own.to_owned(), left_out.to_owned())
}

/// Of those names that no note says anything of: whose runs a check left out, and the rest.
fn without_result<'a>(names: &[&'a str], notes: &[(String, String)]) -> [Vec<&'a str>; 2] {
    let is_unsaid = |name: &&str| !notes.iter().any(|(own, _)| own.contains(*name));
    let is_left_out = |name: &&str| {
        let run = name.replace(' ', "-") + "-";
        notes.iter().any(|(_, left_out)| left_out.contains(&run))
    };
    let (left_out, rest) = names.iter().copied().filter(is_unsaid).partition(is_left_out);
    [left_out, rest]
}

/// The same in words, for each of both that there is.
fn unsaid(names: &[&str], notes: &[(String, String)]) -> Vec<String> {
    let both =
        ["left out by a check", "no result yet"].into_iter().zip(without_result(names, notes));
    let there = both.filter(|(_, names)| !names.is_empty());
    there.map(|(what, names)| format!("{what}: {}", names.join(", "))).collect()
}

/// What rows say of what was tried, a line each, and what of it has no result, begun with `of`.
fn tries(all: &Value, begin: &str, names: &[&str], of: &str) -> String {
    let rows: Vec<&Value> = rows(all).filter(|row| typed(row, "id").starts_with(begin)).collect();
    let notes: Vec<(String, String)> = rows.iter().map(|row| note_of(row)).collect();
    let mut text = String::new();
    for (row, (note, _)) in rows.iter().zip(&notes) {
        let is_of_one = |sentence: &&str| names.iter().any(|name| sentence.contains(name));
        let told: Vec<&str> = note.split(". ").filter(is_of_one).collect();
        if !told.is_empty() {
            text += &format!("- {}: {}.\n", typed(row, "quantity"), told.join(". "));
        }
    }
    unsaid(names, &notes).iter().for_each(|line| text += &format!("- {of}{line}.\n"));
    text
}

/// What was tried with columns.
pub fn column_tried(all: &Value) -> String {
    tries(all, "column-run-out-", &OF_COLUMN, "")
}

/// What was tried with grains whose index densities are published.
pub fn density_tried(all: &Value) -> String {
    // Rows of both states say what it changes of both.
    let of = |(begin, name): &(&str, &str)| {
        tries(all, &format!("{begin}e-max"), &OF_DENSITIES, &format!("{name}, "))
            + &all_together(all, begin, name)
    };
    PUBLISHED.iter().map(of).collect()
}

/// How far from a published void ratio one counts as the same: the range of the judged rows.
const AS_PUBLISHED: f64 = 0.05;

/// Whether all that was tried together makes grains as they are published, of both states; nothing
/// where it has no result.
fn all_together(all: &Value, begin: &str, name: &str) -> String {
    let state = |id: &str, what: &str| {
        let id = format!("{begin}long-flat-rough-{id}");
        let of = rows(all).find(|row| row["id"] == id.as_str())?;
        let apart = of["ours"].as_f64()? - stated(of)?;
        let is = if apart.abs() <= AS_PUBLISHED { "within" } else { "not within" };
        let sinks = typed(of, "quantity").contains("still sinking");
        let sinks = if sinks { " (still sinking)" } else { "" };
        Some(format!("its {what} state{sinks} is {is} {AS_PUBLISHED} of the published one"))
    };
    let states = [state("e-max", "loosest"), state("e-min", "densest")];
    let [Some(loosest), Some(densest)] = states else { return String::new() };
    format!("- {name}, both together: {loosest}, {densest}.\n")
}

/// The void ratio that is published of a row, or the middle of its range.
fn stated(of: &Value) -> Option<f64> {
    let number = |field: &str| of["published"][field].as_f64();
    number("value").or_else(|| Some((number("low")? + number("high")?) / 2.0))
}

/// What must be known of rows by which a vibration has not ended.
pub fn vibration(all: &Value) -> String {
    if !rows(all).any(|row| typed(row, "note").contains("; it fell by ")) {
        return String::new();
    }
    "Rows whose notes say \"it fell by\" are of an earlier build of the test. It compared the \
     moving bed at half time with the bed\nat rest, which lies lower: \"still sinking\" may be \
     wrong there, and no vibration was repeated for longer.\n"
        .to_owned()
}

/// Rows that miss, and what was tried with each.
pub fn missed(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text = String::new();
    for value in rows(all).filter(|value| value["verdict"] == "outside") {
        let notes = note_of(value);
        let read_thinly = notes.0.split(". ").find(|sentence| sentence.contains(THINLY));
        let others = notes.0.find("Tried").map(|at| &notes.0[at..]);
        let mut tried: Vec<String> =
            read_thinly.into_iter().chain(others).map(str::to_owned).collect();
        let designed = TRIED.iter().find(|(id, _)| value["id"] == *id);
        tried.extend(unsaid(designed.map(|of| of.1).unwrap_or_default(), &[notes]));
        if tried.is_empty() {
            tried.push("nothing".to_owned());
        }
        let cells = [
            typed(value, "quantity"),
            published(quote, value)?,
            ours(quote, value)?,
            tried.join("; "),
        ];
        text += &row(&cells);
    }
    if text.is_empty() {
        return Ok("No row misses.\n".to_owned());
    }
    Ok(head("missed | published | ours, 95 % confidence | what was tried") + &text)
}

/// Grains whose index densities are published: how the ids of their rows begin, and their name.
const PUBLISHED: [(&str, &str); 2] =
    [("density-basalt-", "crushed basalt"), ("density-gravel-", "river gravel")];

/// How far void ratios are from the published ones.
pub fn density(quote: Cells, all: &Value) -> Result<String, String> {
    let mut text = head("void ratio | published | ours, 95 % confidence | less published");
    for value in rows(all) {
        let id = typed(value, "id");
        let is_one = PUBLISHED.iter().any(|(begin, _)| id.starts_with(begin));
        let both = stated(value).zip(value["ours"].as_f64());
        let Some((stated, mean)) = both.filter(|_| is_one) else {
            continue;
        };
        let apart = format!("{:+.3}", mean - stated).replace('-', "−");
        let quantity = typed(value, "quantity");
        let quantity = quantity.trim_start_matches("void ratio of ").to_owned();
        text += &row(&[quantity, format!("{stated:.3}"), ours(quote, value)?, apart]);
    }
    Ok(text)
}

/// Whether direct shear ends at the critical state, as far as its interval tells, and what a test
/// that goes further says.
pub fn shear_end(quote: Cells, all: &Value) -> Result<String, String> {
    let find = |id: &str| {
        rows(all).find(|value| value["id"] == id).filter(|value| value["ours"].is_number())
    };
    let mean = |value: &Value| number(quote, value, "ours");
    let ends = find("direct-shear-dilation-end").zip(find("direct-shear-dilation"));
    let Some((end, peak)) = ends else { return Ok(String::new()) };
    let values = end["values"].as_array().into_iter().flatten().filter_map(Value::as_f64);
    let rises: Vec<f64> = values.collect();
    let up = rises.iter().filter(|rise| **rise > 0.0).count();
    let bound = |name: &str| end["interval"][name].as_f64();
    let (interval, told) = match bound("low").zip(bound("high")) {
        Some((low, high)) => (
            format!(
                " ({} to {}°)",
                number(quote, end, "interval/low")?,
                number(quote, end, "interval/high")?
            ),
            match low > 0.0 || high < 0.0 {
                true => "**the end of such a test is not the critical state**",
                false => "the interval does not tell whether its end is the critical state",
            },
        ),
        None => (String::new(), "too few to tell whether its end is the critical state"),
    };
    let mut text = format!(
        "Over the last third of the displacement the lid rises at {}°{interval} on average, \
         against {}° at the peak (50 kPa).\nIt rises there in {up} of {} realisations: {told}.\n",
        mean(end)?,
        mean(peak)?,
        rises.len()
    );
    let far = find("direct-shear-far-end").zip(find("direct-shear-far-dilation-end"));
    text += &match far {
        Some((angle, rise)) => format!(
            "The test that goes twice as far ends at {}°, with the lid rising at {}°; a line in \
             the figure shows it.\n",
            mean(angle)?,
            mean(rise)?
        ),
        None => "No row of a test that goes twice as far is here yet.\n".to_owned(),
    };
    Ok(text)
}

/// Whether loose and dense triaxial specimens end at one void ratio, as far as the intervals tell.
pub fn triaxial_end(quote: Cells, all: &Value) -> Result<String, String> {
    let told = |row: &Value| {
        let bound = |name: &str| row["interval"][name].as_f64();
        match bound("low").zip(bound("high")) {
            None => "too few specimens to tell whether both end at one void ratio".to_owned(),
            Some((low, high)) if low <= 0.0 && high >= 0.0 => {
                "no difference is shown, and none within the interval is excluded".to_owned()
            }
            Some((_, high)) => format!(
                "**they do not end at one void ratio**: dense ones are {} at the end",
                if high < 0.0 { "looser" } else { "still denser" }
            ),
        }
    };
    let mut text = String::new();
    for (id, of) in [
        ("triaxial-end-difference", "of the inner region"),
        ("triaxial-end-plates", "between the plates"),
    ] {
        let row = rows(all).find(|row| row["id"] == id).filter(|row| row["ours"].is_number());
        if let Some(row) = row {
            text += &format!(
                "- Void ratio {of} at the end, loose less dense: {}; {}.\n",
                ours(quote, row)?,
                told(row)
            );
        }
    }
    Ok(text)
}

/// Tests by their names in rows, and what they are called.
const TESTS: [(&str, &str); 10] = [
    ("hopper", "hopper"),
    ("hopper-spheres", "hopper with spheres"),
    ("column", "column"),
    ("repose", "angle of repose"),
    ("density", "index densities"),
    ("d4253", "vibration as in ASTM D4253"),
    ("direct-shear", "direct shear"),
    ("beads", "steel beads"),
    ("oedometer", "oedometer"),
    ("triaxial", "triaxial compression"),
];

/// Format from which on sub-steps get shorter under a load, and runs are left out that a check
/// finds something in.
const SINCE: u64 = 19;
/// What must be known of rows of these tests that are of an earlier one.
const EARLIER: [(&[&str], &str); 2] = [
    (
        &["direct-shear", "beads", "triaxial"],
        "whose sub-steps did not get shorter [under a load](../contacts.md#under-a-load), with \
         values that may change",
    ),
    (&["column", "repose"], "before the rule that leaves runs out"),
];

/// Columns of the small design.
const COLUMNS: [&str; 3] = ["column-run-out-0.6", "column-run-out-1.2", "column-run-out-2.4"];
/// Rows of the small design that a kept file may lack, and what they are of.
const LATER: [(&str, &str); 4] = [
    (
        "density-fraction-e-max",
        "index densities of the grains of shear box, oedometer and triaxial test",
    ),
    ("direct-shear-void-ratio", "void ratios of the shear box"),
    ("direct-shear-far-end", "direct shear twice as far"),
    ("triaxial-begin-loose", "void ratios of loose and dense triaxial specimens at the beginning"),
];

fn of_test<'a>(all: &'a Value, test: &'a str) -> impl Iterator<Item = &'a Value> {
    rows(all).filter(move |row| row["test"] == test)
}

/// Whether a part of a build's formats is of a test alone.
fn is_of(part: &str, test: &str) -> bool {
    part.strip_prefix(test).is_some_and(|rest| rest.starts_with(' '))
}

/// Of which formats the rows of a test are, as the rows say, or else the build of all, which may
/// name tests: `14 and 15, oedometer 19`.
fn formats_of(build: &Build, all: &Value, test: &str) -> Vec<String> {
    let parts: Vec<&str> = build.format.split(", ").collect();
    let is_any = |part: &&str| TESTS.iter().any(|(test, _)| is_of(part, test));
    let own = |part: &str| is_of(part, test).then(|| part[test.len() + 1..].to_owned());
    let mut said: Vec<String> = parts.iter().filter_map(|part| own(part)).collect();
    if said.is_empty() {
        said = parts.iter().filter(|part| !is_any(part)).map(|part| (*part).to_owned()).collect();
    }
    let said = said.join(", ");
    let mut formats: Vec<String> = Vec::new();
    for row in of_test(all, test) {
        let format = row["format"].as_u64().map_or_else(|| said.clone(), |of| of.to_string());
        if !formats.contains(&format) {
            formats.push(format);
        }
    }
    formats
}

/// Whether a row of a test is of a build before [`SINCE`].
fn is_earlier(build: &Build, all: &Value, test: &str) -> bool {
    formats_of(build, all, test).iter().any(|format| {
        let numbers = format.split(|c: char| !c.is_ascii_digit());
        let numbers: Vec<u64> = numbers.filter_map(|n| n.parse().ok()).collect();
        numbers.is_empty() || numbers.iter().any(|of| *of < SINCE)
    })
}

/// Of which formats the rows are, test by test where they differ.
fn formats(build: &Build, all: &Value) -> String {
    const LINK: &str = "[format](README.md#the-files)";
    let mut by_format: Vec<(String, Vec<&str>)> = Vec::new();
    for (test, name) in TESTS {
        let of = formats_of(build, all, test).join(" and ");
        let at = by_format.iter().position(|(format, _)| *format == of);
        match at {
            _ if of.is_empty() => {}
            Some(at) => by_format[at].1.push(name),
            None => by_format.push((of, vec![name])),
        }
    }
    by_format.sort();
    match &by_format[..] {
        [] => format!("{LINK} {}", build.format),
        [(one, _)] if one.parse::<u32>().is_ok() => format!("{LINK} {one}"),
        [(one, _)] => format!("{LINK} {one}: rows of different tests may be of different builds"),
        several => {
            let of =
                |(format, names): &(String, Vec<&str>)| format!("{format} ({})", names.join(", "));
            let parts: Vec<String> = several.iter().map(of).collect();
            format!(
                "and tests are of different builds, by {LINK}: {}. The \
                 [changelog](../../CHANGELOG.md#changed) says what changed with each",
                parts.join(", ")
            )
        }
    }
}

/// Of which builds the rows are, with how many realisations, and what is not there yet.
pub fn build(builds: &[Build], all: &Value) -> String {
    let Some(build) = builds::of(builds, "laboratory") else { return String::new() };
    let mut text = format!("- The newest rows are of {}, {}.\n", build.day, formats(build, all));
    for (tests, why) in EARLIER {
        let mut named = Vec::new();
        for (test, name) in TESTS {
            if tests.contains(&test) && is_earlier(build, all, test) {
                named.push(name);
            }
        }
        if !named.is_empty() {
            text += &format!("- Of an earlier build, {why}: {}.\n", named.join(", "));
        }
    }
    let count = |verdict: &str| rows(all).filter(|row| row["verdict"] == verdict).count();
    let [within, outside, undecided] = ["within", "outside", "undecided"].map(count);
    if within + outside + undecided > 0 {
        let not = count("not_judged");
        text += &format!(
            "- Judged rows: {within} within, {outside} missed, {undecided} undecided. Not judged: \
             {not}.\n"
        );
    }
    let counts = TESTS.iter().filter_map(|(test, name)| {
        let count = |row: &Value| row["values"].as_array().map(Vec::len).filter(|n| *n > 0);
        let counts: Vec<usize> = of_test(all, test).filter_map(count).collect();
        let (least, most) = (counts.iter().min()?, counts.iter().max()?);
        let range = if least == most { String::new() } else { format!("{least} to ") };
        Some(format!("{name} {range}{most}"))
    });
    let counts: Vec<String> = counts.collect();
    if !counts.is_empty() {
        text += &format!("- Realisations in a row, by test: {}.\n", counts.join(", "));
    }
    let former = of_test(all, "column")
        .filter(|row| row["design"] == "small" && !COLUMNS.iter().any(|id| row["id"] == *id));
    for row in former {
        let quantity = typed(row, "quantity");
        text += &format!("- Of an earlier design, which no command runs today: {quantity}.\n");
    }
    let notes = |begin: &str| -> Vec<(String, String)> {
        rows(all).filter(|row| typed(row, "id").starts_with(begin)).map(note_of).collect()
    };
    let later = LATER.iter().filter(|(id, _)| !rows(all).any(|row| row["id"] == *id));
    let later = later.map(|(_, name)| (*name).to_owned());
    let densities = PUBLISHED
        .map(|(begin, name)| (name, without_result(&OF_DENSITIES, &notes(&format!("{begin}e-")))));
    let left = [("column", without_result(&OF_COLUMN, &notes("column-run-out-")))]
        .into_iter()
        .chain(densities);
    let left = left.filter(|(_, [_, names])| !names.is_empty());
    let left = left.map(|(of, [_, names])| format!("{of} ({})", names.join(", ")));
    let left: Vec<String> = later.chain(left).collect();
    if !left.is_empty() {
        text += &format!("- No result yet: {}.\n", left.join("; "));
    }
    text
}
