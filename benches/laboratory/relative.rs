//! Relative densities of the specimens of other tests, by the index densities of the same grains.

use super::row::Row;

/// How the ids of these rows begin.
const BEGIN: &str = "relative-density-";
/// Rows with the index densities.
const LOOSEST: &str = "density-fraction-e-max";
const DENSEST: &str = "density-fraction-e-min";
/// Rows with a void ratio of a specimen, and what it is the void ratio of.
const SPECIMENS: [(&str, &str); 4] = [
    ("direct-shear-void-ratio", "direct shear, before the shearing"),
    ("oedometer-void-ratio", "oedometer, at 12.5 kPa"),
    ("triaxial-begin-loose", "triaxial, loose, at the beginning"),
    ("triaxial-begin-dense", "triaxial, dense, at the beginning"),
];

/// The void ratio that the vibration of ASTM D4253 makes, its relative density, and rows with the
/// index densities of those grains.
const VIBRATED: &str = "density-d4253";
const VIBRATED_RELATIVE: &str = "density-d4253-relative";
const OWN_LOOSEST: &str = "density-e-max";
const OWN_DENSEST: &str = "density-e-min";

/// Puts these rows anew among all, for those void ratios and index densities that are there. Index
/// densities and what they are applied to may be run at different times.
pub fn derive(rows: &mut Vec<Row>) {
    rows.retain(|row| !row.id.starts_with(BEGIN));
    let find = |id: &str| rows.iter().find(|row| row.id == id);
    let mean = |id: &str| find(id).and_then(|row| row.ours);
    let own = mean(OWN_LOOSEST).zip(mean(OWN_DENSEST));
    let vibrated = find(VIBRATED).map(|row| row.values.clone());
    if let Some(((e_max, e_min), values)) = own.zip(vibrated) {
        for row in rows.iter_mut().filter(|row| row.id == VIBRATED_RELATIVE) {
            row.values = values.iter().map(|e| (e_max - e) / (e_max - e_min)).collect();
            row.judge();
        }
    }
    let find = |id: &str| rows.iter().find(|row| row.id == id);
    let mean = |id: &str| find(id).and_then(|row| row.ours);
    let Some((e_max, e_min)) = mean(LOOSEST).zip(mean(DENSEST)) else { return };
    let relative = |(id, what): &(&str, &str)| {
        let of = find(id)?;
        let values: Vec<f64> = of.values.iter().map(|e| (e_max - e) / (e_max - e_min)).collect();
        let quantity = format!("relative density, {what}");
        let mut row = Row::of("density", &format!("{BEGIN}{id}"), &quantity, &values);
        of.design.clone_into(&mut row.design);
        row.format = of.format;
        Some(row.noted(
            "By the means of the loosest and the densest state of these grains; walls make the \
             void ratio of a small specimen larger",
        ))
    };
    let derived: Vec<Row> = SPECIMENS.iter().filter_map(relative).collect();
    rows.extend(derived);
}
