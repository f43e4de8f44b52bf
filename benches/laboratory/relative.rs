//! Relative densities of the specimens of other tests, by the index densities of the same grains.

use pluvia::measure::inference::{MeanTest, t_quantile};

use super::row::{Interval, Row};

/// How the ids of these rows begin.
const BEGIN: &str = "relative-density-";
/// Rows with the index densities: the loosest state and the densest.
const FRACTION: [&str; 2] = ["density-fraction-e-max", "density-fraction-e-min"];
/// Rows with a void ratio of a specimen, what it is the void ratio of, and how it is read.
const SPECIMENS: [(&str, &str, &str); 4] = [
    ("direct-shear-void-ratio", "direct shear, before the shearing", BY_THE_LID),
    ("oedometer-void-ratio", "oedometer, at 12.5 kPa", BY_THE_LID),
    ("triaxial-begin-loose", "triaxial, loose, at the beginning", WITHIN),
    ("triaxial-begin-dense", "triaxial, dense, at the beginning", WITHIN),
];
const BY_THE_LID: &str = "the specimen is read up to its lid, which lies on the highest grains, \
                          and walls make its void ratio larger";
const WITHIN: &str = "the specimen is read in an inner region, without the looser grains at its \
                      walls; index densities are read in a whole mould";

/// The void ratio that the vibration of ASTM D4253 makes, its relative density, and rows with the
/// index densities of those grains.
const VIBRATED: &str = "density-d4253";
const VIBRATED_RELATIVE: &str = "density-d4253-relative";
const OWN: [&str; 2] = ["density-e-max", "density-e-min"];

/// Puts these rows anew among all, for those void ratios and index densities that are there. Index
/// densities and what they are applied to may be run at different times.
pub fn derive(rows: &mut Vec<Row>) {
    rows.retain(|row| !row.id.starts_with(BEGIN));
    let find = |id: &str| rows.iter().find(|row| row.id == id);
    let vibrated = find(VIBRATED_RELATIVE).cloned().and_then(|own| {
        let said = "the specimen is read as they are";
        relative(own, find(VIBRATED)?, OWN.map(find), said)
    });
    let specimens = SPECIMENS.iter().filter_map(|(id, what, how)| {
        let of = find(id)?;
        let quantity = format!("relative density, {what}");
        let mut row = Row::of("density", &format!("{BEGIN}{id}"), &quantity, &[]);
        of.design.clone_into(&mut row.design);
        relative(row, of, FRACTION.map(find), how)
    });
    let specimens: Vec<Row> = specimens.collect();
    if let Some(vibrated) = vibrated {
        rows.iter_mut()
            .filter(|row| row.id == vibrated.id)
            .for_each(|row| row.clone_from(&vibrated));
    }
    rows.extend(specimens);
}

/// A row of a relative density, with the values, interval, format and note that follow from those
/// of a specimen, and of the loosest and the densest state; none without means of these.
fn relative(mut row: Row, of: &Row, states: [Option<&Row>; 2], how: &str) -> Option<Row> {
    let [loosest, densest] = states;
    let (loosest, densest) = loosest.zip(densest)?;
    let (e_max, e_min) = loosest.ours.zip(densest.ours)?;
    row.values = of.values.iter().map(|e| (e_max - e) / (e_max - e_min)).collect();
    row.judge();
    let interval = interval([&of.values, &loosest.values, &densest.values]);
    let why = match interval {
        Ok(_) => {
            "its interval is of the specimen and of both (Fieller, degrees of freedom after Welch \
                  and Satterthwaite)"
        }
        Err(why) => why,
    };
    row.interval = interval.ok();
    // That of the oldest: a row without one is older than those that have one.
    let formats = [of.format, loosest.format, densest.format];
    row.format = formats.into_iter().min().flatten();
    let said = |format: Option<u32>| format.map_or("unknown".to_owned(), |f| f.to_string());
    let [own, of_loosest, of_densest] = formats.map(said);
    let builds = match own == of_loosest && own == of_densest {
        true => String::new(),
        false => format!(
            "; specimen of format {own}, loosest state of {of_loosest}, densest of {of_densest}"
        ),
    };
    Some(row.noted(format!(
        "By the means of the loosest and the densest state of these grains; {how}; {why}{builds}"
    )))
}

/// The 95 % interval of D = (x − e)/(x − n) from values of e, x and n: those D for which the mean
/// of e − x + D (x − n) may be 0 (E. C. Fieller 1954, "Some problems in interval estimation"), by
/// Student's t with the degrees of freedom of Welch and Satterthwaite at the D of the means.
/// Propagation to the first order needs an x − n that is known well; here it is of a few
/// realisations.
///
/// # Errors
/// Why there is none.
fn interval(of: [&[f64]; 3]) -> Result<Interval, &'static str> {
    let known = |values: &[f64]| {
        let test = MeanTest::of(values, 0.95)?;
        let error = test.standard_deviation / (values.len() as f64).sqrt();
        Some((test.estimate.mean, error.powi(2), test.freedom))
    };
    let [Some((e, e2, e_free)), Some((x, x2, x_free)), Some((n, n2, n_free))] = of.map(known)
    else {
        return Err("no interval: one of the three is of a single realisation");
    };
    let (least, range) = (x - e, x - n);
    let d = least / range;
    let parts = [(e2, e_free), ((1.0 - d).powi(2) * x2, x_free), (d * d * n2, n_free)];
    let all: f64 = parts.iter().map(|(part, _)| part).sum();
    let shares: f64 = parts.iter().map(|(part, freedom)| part * part / freedom).sum();
    if shares == 0.0 {
        return Ok(Interval { low: d, high: d });
    }
    let t = t_quantile(0.975, all * all / shares).ok_or("no interval: not a number")?;
    // D for which (least − D range)² ≤ t² (e2 + (1 − D)² x2 + D² n2).
    let squared = range * range - t * t * (x2 + n2);
    let middle = least * range - t * t * x2;
    let rest = least * least - t * t * (e2 + x2);
    let root = middle * middle - squared * rest;
    if squared <= 0.0 || root.is_nan() || root < 0.0 {
        return Err("no interval: loosest and densest state may be the same");
    }
    let [low, high] = [-1.0, 1.0].map(|side| (middle + side * root.sqrt()) / squared);
    Ok(Interval { low, high })
}
