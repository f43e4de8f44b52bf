//! Results as lines for people.

use super::{certificate::Certificate, pours::Cell, steps::Nearness};

/// One scene of the native solver.
pub fn nearness(n: &Nearness) -> String {
    format!(
        "{:14} {:22} {:5} grains, {:6.0} contact points: velocity error median {:.3} %, p99 {:.2} %, \
         worst {:.1} %; residual {:.1e} (reference {:.0e}), other solutions p99 {:.1e} %",
        n.scene,
        n.engine,
        n.grains,
        n.contacts,
        n.velocity_error_median_percent,
        n.velocity_error_p99_percent,
        n.velocity_error_worst_percent,
        n.engine_residual,
        n.reference_residual,
        n.other_solution_p99_percent,
    )
}

/// One engine's pours of one kind.
pub fn cell(c: &Cell) -> String {
    let difference = match (c.difference_percent, c.difference_standard_error_percent) {
        (Some(d), Some(error)) => format!(
            "{d:+.2} ± {error:.2} %, {}",
            if c.equivalent_within_0_5_percent == Some(true) {
                "equivalent within 0.5 %"
            } else {
                "equivalence within 0.5 % not shown"
            }
        ),
        _ => "the reference".to_owned(),
    };
    format!(
        "e {:5} mu {:5} {:8} {:5} pours: height {:.3} ± {:.3} mm, {difference}; coordination \
         {:.2}, sliding {}",
        c.restitution,
        c.friction,
        c.engine.name(),
        c.realisations,
        c.height_mean_mm,
        c.height_standard_error_mm,
        c.coordination_mean,
        c.sliding_share.map_or("not told".to_owned(), |s| format!("{:.0} %", 100.0 * s)),
    )
}

/// One specimen.
pub fn certificate(c: &Certificate) -> String {
    let least = c.least_friction.map_or("none".to_owned(), |f| format!("{f:.3}"));
    format!(
        "{:6} {:8} {:5} grains, {:6} contact points: least friction {least} of {}, {} fall: {}",
        c.specimen,
        c.engine,
        c.grains,
        c.contacts,
        c.friction,
        c.fall,
        if c.stands { "stands" } else { "WRONG" },
    )
}
