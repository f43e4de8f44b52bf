//! Tables of `make referee`: what an exact solution of the same contact problems says.

use serde_json::Value;

use super::{
    speed::number,
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
        table += &row(&[
            text(&of["scene"]),
            number(&of["grains"], 0),
            number(&of["instants"], 0),
            number(&of["contacts"], 0),
            number(&of["velocity_error_median_percent"], 2),
            number(&of["velocity_error_p99_percent"], 1),
            number(&of["velocity_error_worst_percent"], 0),
            number(&of["instant_error_median_percent"], 2),
            small(&of["engine_residual"]),
            small(&of["reference_residual"]),
        ]);
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
        table += &row(&[
            text(&of["specimen"]),
            text(&of["engine"]),
            number(&of["contacts"], 0),
            number(&of["least_friction"], 2),
            number(&of["least_friction_of_99_percent"], 2),
            number(&of["fall"], 0),
            number(&of["unbalanced"], 0),
            number(&of["worst_left_percent"], 1),
            number(&of["left_percent"], 2),
            stands.to_owned(),
        ]);
    }
    Ok(table)
}
