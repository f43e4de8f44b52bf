//! The table of analytical cases that some engine misses.

use pluvia::plain::without_zeros;
use serde_json::Value;

use super::tables::{head, row};

/// Settings of `docs/verification.md`, in its order.
const SETTINGS: [&str; 6] =
    ["stock", "stock-960", "native-240", "native-480", "native-1000", "rapier"];

/// Every analytical case that one of these settings misses, with what each got; misses in bold.
pub fn missed(all: &Value) -> Result<String, String> {
    let verdicts: Vec<&Value> = all.as_array().into_iter().flatten().collect();
    let mut cases: Vec<&str> = Vec::new();
    for verdict in &verdicts {
        let case = verdict["case"].as_str().ok_or("a verdict names its case")?;
        let is_shown = SETTINGS.iter().any(|setting| verdict["setting"] == *setting);
        if is_shown && verdict["status"] != "pass" && !cases.contains(&case) {
            cases.push(case);
        }
    }
    let mut text = head(&format!("case | expected ± tolerance | {}", SETTINGS.join(" | ")));
    for case in cases {
        let of = |setting: &str| {
            verdicts.iter().find(|v| v["case"] == case && v["setting"] == setting).copied()
        };
        let any = of("native-480").ok_or_else(|| format!("{case}: not run on native-480"))?;
        let unit = any["unit"].as_str().unwrap_or_default();
        let mut cells = vec![
            format!("`{case}`"),
            format!("{} ± {} {unit}", short(&any["expected"]), short(&any["tolerance"]))
                .trim_end()
                .to_owned(),
        ];
        cells.extend(SETTINGS.iter().map(|setting| match of(setting) {
            None => String::new(),
            Some(v) if v["status"] == "pass" => short(&v["got"]),
            Some(v) if v["got"].is_null() => "**none**".to_owned(),
            Some(v) => format!("**{}**", short(&v["got"])),
        }));
        text += &row(&cells);
    }
    Ok(text)
}

/// A number with three significant digits at most.
fn short(value: &Value) -> String {
    let Some(number) = value.as_f64() else { return String::new() };
    let digits = if number == 0.0 { 0.0 } else { number.abs().log10().floor() };
    let decimals = (2.0 - digits).clamp(0.0, 4.0) as usize;
    without_zeros(&format!("{number:.decimals$}")).replace('-', "−")
}
