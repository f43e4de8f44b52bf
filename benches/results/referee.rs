//! Tables of `make referee`: what an exact solution of the same contact problems says.

use serde_json::Value;

use super::{
    speed::numbers,
    tables::{head, row},
};

fn part<'a>(all: &'a Value, name: &str) -> Result<&'a Vec<Value>, String> {
    all[name].as_array().ok_or_else(|| format!("no {name}"))
}

fn text(of: &Value) -> String {
    of.as_str().unwrap_or_default().to_owned()
}

/// A number of two digits in powers of ten.
fn small(of: &Value) -> String {
    of.as_f64().map_or_else(String::new, |x| format!("{x:.0e}"))
}

/// A row a scene.
pub fn one_step(all: &Value) -> Result<String, String> {
    let mut table = head(
        "scene | grains | instants | contact points | median % | p99 % | worst % | instant median \
         % | residual of the native solver | of the reference",
    );
    for of in part(all, "one_step")? {
        let fields = "grains:0 instants:0 contacts:0 velocity_error_median_percent:2 \
                      velocity_error_p99_percent:1 velocity_error_worst_percent:0 \
                      instant_error_median_percent:2";
        let residuals = ["engine_residual", "reference_residual"].map(|field| small(&of[field]));
        let scene = vec![text(&of["scene"])];
        table += &row(&[scene, numbers(of, fields), residuals.to_vec()].concat());
    }
    Ok(table)
}

/// A row an engine, with the 90 % interval of the two one-sided tests. Means of pours that lost
/// grains through walls say nothing, and are left out.
pub fn pours(all: &Value) -> Result<String, String> {
    let mut table = head(
        "engine | pours | grains lost | height, mm | standard error, mm | less the referee's, % | within \
         ±0.5 % | coordination number | deepest overlap, mm",
    );
    for of in part(all, "pours")? {
        let counts = [vec![text(&of["engine"])], numbers(of, "realisations:0 outside:0")].concat();
        if of["outside"].as_u64() != Some(0) {
            table += &row(&[counts, vec![String::new(); 6]].concat());
            continue;
        }
        let percent =
            |number: &Value| number.as_f64().map(|x| format!("{x:+.2}").replace('-', "−"));
        let ends = &of["difference_interval_percent"];
        let interval = [&of["difference_percent"], &ends[0], &ends[1]].map(percent);
        let interval = match interval {
            [Some(mean), Some(low), Some(high)] => format!("{mean} ({low} to {high})"),
            _ => String::new(),
        };
        let shown = match of["equivalent_within_0_5_percent"].as_bool() {
            Some(true) => "shown",
            Some(false) => "not shown",
            None => "",
        };
        let before = numbers(of, "height_mean_mm:3 height_standard_error_mm:3");
        let after = numbers(of, "coordination_mean:2 deepest_overlap_mm:3");
        let between = vec![interval, shown.to_owned()];
        table += &row(&[counts, before, between, after].concat());
    }
    Ok(table)
}

/// A row a specimen and engine.
pub fn certificates(all: &Value) -> Result<String, String> {
    let mut table = head(
        "specimen | engine | contact points | least friction | of 99 % of the grains | fall | \
         unbalanced | left, worst % | left, all % | stands",
    );
    for of in part(all, "static")? {
        let stands = if of["stands"] == true { "yes" } else { "no" };
        let fields = "contacts:0 least_friction:2 least_friction_of_99_percent:2 fall:0 \
                      unbalanced:0 worst_left_percent:1 left_percent:2";
        let what = vec![text(&of["specimen"]), text(&of["engine"])];
        table += &row(&[what, numbers(of, fields), vec![stands.to_owned()]].concat());
    }
    Ok(table)
}
