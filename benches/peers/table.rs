//! The results for people.

use super::measured::Row;

/// One row in a few words, as it is done.
pub fn line(row: &Row) -> String {
    let [cost, mean, p99, creep, standard, memory] = cells(row);
    format!(
        "{cost} s per simulated s, overlap {mean} / {p99} %, numerical creep {creep} µm/s, \
         standard {standard}, {memory} MiB"
    )
}

fn number(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(v) if v != 0.0 && (v.abs() >= 1e5 || v.abs() < 1e-3) => format!("{v:.1e}"),
        Some(v) if v.abs() >= 100.0 => format!("{v:.0}"),
        Some(v) if v.abs() >= 10.0 => format!("{v:.1}"),
        Some(v) => format!("{v:.2}"),
    }
}

fn cells(row: &Row) -> [String; 6] {
    let standard = match row.meets_standard {
        Some(true) => "met",
        Some(false) => "missed",
        None => "-",
    };
    [
        number(row.wall_s_per_simulated_s),
        number(row.overlap_mean_percent),
        number(row.overlap_p99_percent),
        number(row.creep_um_per_s),
        standard.to_owned(),
        number(row.peak_memory_mib),
    ]
}

/// All rows, scene by scene, with how many times faster than stock Bullet each
/// is (the first engine, where it was run).
pub fn of(rows: &[Row]) -> String {
    let mut text = String::new();
    for scene in ["rest", "shaken", "pour"] {
        let rows: Vec<&Row> = rows.iter().filter(|r| r.scene == scene).collect();
        let Some(first) = rows.first() else { continue };
        text += &format!("\n{scene}, {} grains\n", first.grains);
        text += &format!(
            "  {:23} {:>8} {:>5} {:>11} {:>9} {:>9} {:>9} {:>10} {:>8} {:>7}\n",
            "engine",
            "rate Hz",
            "iter.",
            "s per sim s",
            "x bullet",
            "overlap %",
            "p99 %",
            "creep µm/s",
            "standard",
            "MiB"
        );
        let bullet = rows.iter().find(|r| r.engine == "bullet");
        let bullet = bullet.and_then(|r| r.wall_s_per_simulated_s);
        for row in rows {
            let ratio = bullet.zip(row.wall_s_per_simulated_s).map(|(b, own)| b / own);
            let [cost, mean, p99, creep, standard, memory] = cells(row);
            let rate = row.rate_hz.map_or("-".to_owned(), |r| format!("{r:.0}"));
            let iterations = row.iterations.map_or("-".to_owned(), |i| i.to_string());
            text += &format!(
                "  {:23} {rate:>8} {iterations:>5} {cost:>11} {:>9} {mean:>9} {p99:>9} {creep:>10} \
                 {standard:>8} {memory:>7}\n",
                row.engine,
                number(ratio)
            );
        }
    }
    text + "\nx bullet: how many times faster than stock Bullet in double precision\n\
            creep: numerical creep in the second half of `rest`\n"
}
