//! Tables of `make joint`: which runs meet the paper's numbers, and what moves each.

use serde_json::Value;

use super::tables::{head, row};

/// What a page calls the targets, in their order in `scripts/joint.sh`.
const TARGETS: [&str; 4] =
    ["angle of repose", "settlement after 20 s", "share of it in 5 s", "share in the first period"];

/// Factors of the sweeps, and what a page calls them.
const FACTORS: [(&str, &str); 5] = [
    ("contact.grain_grain_friction", "friction between grains"),
    ("grains.cells.relaxation_steps", "steps of cell relaxation"),
    ("stages.3.amplitude_mm", "amplitude of the table, mm"),
    ("stages.3.crank_to_rod", "crank over rod"),
    ("stages.3.ramp_s", "ramp, s"),
];

fn number(of: &Value) -> Result<f64, String> {
    of.as_f64().ok_or_else(|| format!("`{of}` is no number"))
}

fn list<'a>(of: &'a Value, name: &str) -> Result<&'a Vec<Value>, String> {
    of[name].as_array().ok_or_else(|| format!("there is no list `{name}`"))
}

fn unit(target: &Value) -> &'static str {
    match (target["share_of"].is_null(), target["runs"].as_str()) {
        (false, _) => " %",
        (true, Some("pile")) => "°",
        _ => " mm",
    }
}

/// A row a target: what is wanted, what came out, how many meet it, and what moves it.
pub fn targets(found: &Value) -> Result<String, String> {
    let factors = FACTORS.map(|(_, name)| name).join(" | ");
    let mut text = head(&format!("| wanted | smallest to largest | runs that meet it | {factors}"));
    for (target, name) in list(found, "targets")?.iter().zip(TARGETS) {
        let unit = unit(target);
        let of = |path: &str| number(&target[path]);
        let values = list(target, "values")?;
        let mut cells = vec![
            name.to_owned(),
            format!("{} to {}{unit}", of("low")?, of("high")?),
            format!("{:.1} to {:.1}{unit}", number(&values[0])?, number(&values[1])?),
            format!("{} of {}", target["runs_meeting"], target["runs_counted"]),
        ];
        for (factor, _) in FACTORS {
            let effect = &target["effects"][factor];
            cells.push(match effect.as_array() {
                None => String::new(),
                Some(of) => {
                    format!("{:+.1} ± {:.1}", number(&of[0])?, number(&of[1])?).replace('-', "−")
                }
            });
        }
        text += &row(&cells);
    }
    Ok(text)
}

/// A row a pair of targets, and one of all: how probable it is to meet them together, and where.
pub fn together(found: &Value) -> Result<String, String> {
    let factors = FACTORS.map(|(_, name)| name).join(" | ");
    let mut text =
        head(&format!("together | points that meet them | on average | at best | {factors}"));
    for group in list(found, "pairs")?.iter().chain([&found["all"]]) {
        let of = list(group, "targets")?;
        let is_all = of.len() == TARGETS.len();
        let name = |n: &Value| n.as_u64().and_then(|n| TARGETS.get(n as usize)).copied();
        let named: Option<Vec<&str>> = of.iter().map(name).collect();
        let named = named.ok_or("a target without a name")?;
        let percent =
            |path: &str| Ok::<_, String>(format!("{:.0} %", 100.0 * number(&group[path])?));
        let mut cells = vec![
            if is_all { "all four".to_owned() } else { named.join("; ") },
            match &group["points"] {
                Value::Null => String::new(),
                points => format!("{} of {}", points["met"], points["of"]),
            },
            percent("mean")?,
            percent("best")?,
        ];
        for (factor, _) in FACTORS {
            let at = &group["at"][factor];
            cells.push(if at.is_null() { String::new() } else { format!("{:.2}", number(at)?) });
        }
        text += &row(&cells);
    }
    Ok(text)
}
