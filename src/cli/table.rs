//! Results as plain text for people.

use crate::record::{RunRecord, Summary};

/// The figures of one run, a line each.
pub(super) fn summary(s: &Summary) -> String {
    let mut lines = vec![
        ("grains in the cylinder", format!("{} of {}", s.grains.in_cylinder, s.grains.count)),
        (
            "standing height",
            format!(
                "{:.1} mm (mean surface), {:.1} mm (95th percentile), {:.1} mm (highest grain)",
                s.standing_height_mm.mean_surface,
                s.standing_height_mm.p95,
                s.standing_height_mm.highest
            ),
        ),
        ("void ratio", format!("{:.3} (porosity {:.3})", s.void_ratio, s.porosity)),
    ];
    if let Some(settlement) = &s.settlement_mm {
        let share = settlement
            .share_after_5_s
            .map_or(String::new(), |share| format!(", {:.0} % of it after 5 s", 100.0 * share));
        lines.push(("plate settlement", format!("{:.1} mm{share}", settlement.final_mm)));
    }
    lines.push((
        "overlap",
        format!(
            "{:.2} % mean, {:.2} % 99th percentile",
            s.overlap.mean_percent, s.overlap.p99_percent
        ),
    ));
    if let Some(creep) = s.creep_um_per_s {
        lines.push(("creep at rest", format!("{creep:.0} µm/s")));
    }
    let standard = if s.meets_standard { "met" } else { "not met" };
    lines.push(("accuracy standard", standard.to_owned()));
    let mut text: Vec<String> =
        lines.into_iter().map(|(name, value)| format!("{name:<24}{value}")).collect();
    text.extend(s.warnings.iter().map(|w| format!("warning: {w}")));
    text.join("\n")
}

/// One line a run.
pub(super) fn runs(records: &[RunRecord]) -> String {
    let header = format!(
        "{:<30} {:>9} {:>7} {:>11} {:>9} {:>10}",
        "run", "height mm", "void e", "settled mm", "overlap %", "creep µm/s"
    );
    let line = |r: &RunRecord| {
        let s = &r.summary;
        let number = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.1}"));
        format!(
            "{:<30} {:>9.1} {:>7.3} {:>11} {:>9.2} {:>10}",
            r.name,
            s.standing_height_mm.mean_surface,
            s.void_ratio,
            number(s.settlement_mm.as_ref().map(|x| x.final_mm)),
            s.overlap.mean_percent,
            number(s.creep_um_per_s)
        )
    };
    std::iter::once(header).chain(records.iter().map(line)).collect::<Vec<_>>().join("\n")
}
