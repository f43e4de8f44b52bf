//! Results as tables for people.

use super::{
    cells::Cell,
    certificate::Certificate,
    nearness::{Instant, Nearness},
};

/// One instant in a few words, as it is done.
pub fn instant(i: &Instant) -> String {
    format!(
        "{:.3} s, {} contact points: velocity error median {:.3} %, p99 {:.2} %; reference {:.0e} \
         in {:.0} s",
        i.time_s,
        i.contacts,
        i.error_percent(50.0),
        i.error_percent(99.0),
        i.residual,
        i.wall_s
    )
}

/// All scenes of the native solver.
pub fn one_step(all: &[Nearness]) -> String {
    let rows = all.iter().map(|n| {
        vec![
            n.scene.clone(),
            n.engine.clone(),
            n.grains.to_string(),
            format!("{:.0}", n.contacts),
            n.instants.to_string(),
            n.instants_below_1e_10.to_string(),
            format!("{:.3}", n.velocity_error_median_percent),
            format!("{:.2}", n.velocity_error_p99_percent),
            format!("{:.1}", n.velocity_error_worst_percent),
            format!("{:.2}", n.instant_error_median_percent),
            format!("{:.1e}", n.engine_residual),
            format!("{:.0e}", n.reference_residual),
            format!("{:.0e}", n.siconos_error_worst),
            format!("{:.0}", n.reference_wall_s_per_instant),
        ]
    });
    aligned(
        "One sub-step: velocity error in % of what contacts change, over bodies and over instants",
        "scene | engine | grains | points | instants | < 1e-10 | median | p99 | worst | instant | \
         residual | reference | Siconos | s each",
        rows,
    )
}

/// All pours.
pub fn pours(all: &[Cell]) -> String {
    let rows = all.iter().map(|c| {
        let known = |value: Option<f64>, digits: usize| {
            value.map_or("-".to_owned(), |v| format!("{v:.digits$}"))
        };
        let equivalent = match c.equivalent_within_0_5_percent {
            Some(true) => "yes",
            Some(false) => "not shown",
            None => "-",
        };
        vec![
            c.restitution.to_string(),
            c.friction.to_string(),
            c.engine.name().to_owned(),
            c.realisations.to_string(),
            format!("{:.3} ± {:.3}", c.height_mean_mm, c.height_standard_error_mm),
            match (c.difference_percent, c.difference_standard_error_percent) {
                (Some(d), Some(error)) => format!("{d:+.2} ± {error:.2}"),
                _ => "-".to_owned(),
            },
            equivalent.to_owned(),
            format!("{:.2} ± {:.2}", c.coordination_mean, c.coordination_standard_error),
            known(c.sliding_share.map(|s| 100.0 * s), 1),
            format!("{:.3}", c.deepest_overlap_mm),
            c.outside.to_string(),
            known(c.unsolved_share.map(|s| 100.0 * s), 2),
            format!("{:.1}", c.wall_s_per_pour),
        ]
    });
    aligned(
        "Pours of 30 grains: mean ± standard error",
        "e | mu | engine | pours | height mm | to referee % | within 0.5 % | coordination | \
         sliding % | overlap mm | outside | unsolved % | s each",
        rows,
    )
}

/// All specimens.
pub fn certificates(all: &[Certificate]) -> String {
    let rows = all.iter().map(|c| {
        let known = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.3}"));
        vec![
            c.specimen.clone(),
            c.engine.name().to_owned(),
            c.grains.to_string(),
            c.contacts.to_string(),
            c.friction.to_string(),
            c.least_friction.map_or("none".to_owned(), |f| format!("{f:.3}")),
            c.least_friction_of_99_percent.map_or("none".to_owned(), |f| format!("{f:.3}")),
            c.fall.to_string(),
            c.unbalanced.to_string(),
            known(c.worst_left_percent),
            known(c.left_percent),
            if c.stands { "yes" } else { "no" }.to_owned(),
            format!("{:.0}", c.wall_s),
        ]
    });
    aligned(
        "Static certificate: friction that a specimen needs",
        "specimen | engine | grains | points | friction | least | of 99 % | fall | unbalanced | \
         worst left % | left % | stands | s each",
        rows,
    )
}

/// Columns as wide as their widest cell, numbers to the right; `|` between names in the head.
fn aligned(title: &str, head: &str, rows: impl Iterator<Item = Vec<String>>) -> String {
    let head: Vec<String> = head.split(" | ").map(str::to_owned).collect();
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    let widths: Vec<usize> = (0..rows[0].len())
        .map(|k| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0))
        .collect();
    let is_text = |k: usize| {
        rows[1..].iter().all(|r| r[k].starts_with(char::is_alphabetic) && r[k] != "none")
    };
    let left: Vec<bool> = (0..widths.len()).map(is_text).collect();
    let mut text = format!("\n{title}\n");
    for row in &rows {
        let mut line = String::new();
        for ((cell, &width), left) in row.iter().zip(&widths).zip(&left) {
            line += &if *left { format!("  {cell:<width$}") } else { format!("  {cell:>width$}") };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}
