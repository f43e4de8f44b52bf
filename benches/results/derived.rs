//! What pages quote of tables of many runs: means with intervals, and differences of runs of the
//! same realisation.

use std::collections::BTreeMap;

use pluvia::measure::{
    inference::MeanTest,
    nested::{Bounded, Nested},
};
use serde_json::{Map, Value, json};

use super::value::Results;

type Work = fn(&Results) -> Result<Value, String>;

/// What works out a source of this name.
pub fn named(name: &str) -> Option<Work> {
    Some(match name {
        "engines" => engines,
        "convergence" => convergence,
        "settlement" => settlement,
        "shaken" => shaken,
        "handed" => handed,
        "twins-means" => twins,
        "twins-differences" => twin_differences,
        "twins-beyond" => twins_beyond,
        "sizes" => sizes,
        "tally" => tally,
        "joint-met" => joint,
        "placements-scatter" => placements,
        "repose-by-volume" => by_volume,
        _ => return None,
    })
}

/// Grains of the quick specimen, and how many must lie in the cylinder: with fewer its funnel
/// has jammed.
const GRAINS: f64 = 364.0;
const LEAST: f64 = 350.0;

/// Smallest and largest angle of the programme's piles by volume, in degrees: `claims.json` has
/// them in a note alone.
fn by_volume(results: &Results) -> Result<Value, String> {
    let claims = results.source("claims")?;
    let claim = claims.as_array().and_then(|all| all.iter().find(|c| c["id"] == "angle-of-repose"));
    let note = claim.and_then(|claim| claim["note"].as_str()).unwrap_or_default();
    let ends = note.split_once("By volume and height ours are ").and_then(|(_, after)| {
        let (low, after) = after.split_once("° to ")?;
        let (high, _) = after.split_once('°')?;
        Some((low.parse::<f64>().ok()?, high.parse::<f64>().ok()?))
    });
    let (low, high) = ends.ok_or("no angles by volume in the note of `angle-of-repose`")?;
    Ok(json!({ "low": low, "high": high }))
}

type Rows = Vec<Map<String, Value>>;

fn rows(results: &Results, source: &str) -> Result<Rows, String> {
    let value = results.source(source)?;
    let items = value.as_array().ok_or("a table has rows")?;
    items.iter().map(|i| i.as_object().cloned().ok_or("a row has fields".to_owned())).collect()
}

fn number(row: &Map<String, Value>, field: &str) -> Option<f64> {
    row.get(field).and_then(Value::as_f64)
}

fn jammed(row: &Map<String, Value>) -> bool {
    let out: f64 = ["grains.spilled", "grains.left_in_funnel", "grains.escaped"]
        .iter()
        .map(|f| number(row, f).unwrap_or(0.0))
        .sum();
    GRAINS - out < LEAST
}

/// Whether a row has something in a cell, as why it failed or does not count.
fn says(row: &Map<String, Value>, field: &str) -> bool {
    row.get(field).is_some_and(|cell| !cell.is_null())
}

/// Rows by realisation.
fn by_realisation(rows: &Rows) -> BTreeMap<u64, &Map<String, Value>> {
    rows.iter().filter_map(|r| Some((number(r, "configuration")? as u64, r))).collect()
}

fn interval(values: &[f64]) -> Value {
    MeanTest::of(values, 0.95).map_or(Value::Null, |t| {
        json!({
            "mean": t.estimate.mean, "half": t.half_width, "sd": t.standard_deviation,
            "count": t.estimate.count,
            "low": values.iter().copied().fold(f64::INFINITY, f64::min),
            "high": values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        })
    })
}

/// Values of a field.
fn values(rows: &Rows, field: &str) -> Vec<f64> {
    rows.iter().filter_map(|r| number(r, field)).collect()
}

/// What a field is beside that of the rows of another list, realisation by realisation.
fn pairs<T>(rows: &Rows, other: &Rows, change: impl Fn(f64, f64) -> T, field: &str) -> Vec<T> {
    let other = by_realisation(other);
    by_realisation(rows)
        .iter()
        .filter_map(|(n, row)| Some(change(number(row, field)?, number(other.get(n)?, field)?)))
        .collect()
}

/// Percent by which the height of two void ratios differs.
fn height_percent(a: f64, b: f64) -> f64 {
    100.0 * ((1.0 + a) / (1.0 + b) - 1.0)
}

/// Differences of pairs in percent of the mean of the second ones. The mean of the ratios would be
/// larger than 1 wherever the second ones scatter, also without a difference.
fn percent_of_mean(pairs: &[(f64, f64)]) -> Vec<f64> {
    let mean = pairs.iter().map(|pair| pair.1).sum::<f64>() / pairs.len() as f64;
    pairs.iter().map(|(a, b)| 100.0 * (a - b) / mean).collect()
}

/// The rows with a result that did not jam, and how many did.
fn whole(mut rows: Rows) -> (Rows, usize) {
    rows.retain(|row| !says(row, "failure"));
    let (jam, whole): (Rows, Rows) = rows.into_iter().partition(jammed);
    (whole, jam.len())
}

/// The rows that count in means, and how many do not.
fn counted(rows: Rows) -> (Rows, usize) {
    let is_out = |row: &Map<String, Value>| says(row, "failure") || says(row, "left_out_of_means");
    let (out, counted): (Rows, Rows) = rows.into_iter().partition(is_out);
    (counted, out.len())
}

/// Pours by engine, friction and restitution, for [`engines`].
const POURS: [(&str, &str, &str); 6] = [
    ("native", "native", ""),
    ("native, eight iterations", "native-eight", ""),
    ("native, older restitution", "native-older", ""),
    ("native, friction in the middle", "native-middle", ""),
    ("rapier, `simplified`", "rapier", "simplified"),
    ("rapier, `coulomb`", "rapier", "coulomb"),
];

/// `docs/engines.md`: pours by friction and restitution, their heights over the native one.
fn engines(results: &Results) -> Result<Value, String> {
    let mut found = Vec::new();
    for (friction, restitution) in [(0.0, 0.0), (0.0, 0.315), (0.793, 0.0), (0.793, 0.315)] {
        let mut native: Option<Rows> = None;
        for (label, source, model) in POURS {
            let mut rows = rows(results, source)?;
            rows.retain(|r| {
                number(r, "contact.grain_grain_friction") == Some(friction)
                    && number(r, "contact.restitution") == Some(restitution)
                    && (model.is_empty()
                        || r.get("engine.rapier.friction_model").and_then(Value::as_str)
                            == Some(model))
            });
            if rows.is_empty() {
                continue;
            }
            let (rows, jam) = whole(rows);
            let over =
                native.as_ref().map(|n| interval(&pairs(&rows, n, height_percent, "void_ratio")));
            found.push(json!({
                "name": format!("{label}, {friction}, {restitution}"),
                "label": label, "friction": friction, "restitution": restitution,
                "count": rows.len(), "jammed": jam,
                "void_ratio": interval(&values(&rows, "void_ratio")),
                "coordination_number": interval(&values(&rows, "coordination_number")),
                "height_over_native_percent": over,
            }));
            native.get_or_insert(rows);
        }
    }
    Ok(found.into())
}

/// Points of a sweep of one setting at a time, the first of them the default.
fn points(results: &Results, source: &str) -> Result<Vec<Rows>, String> {
    let mut points: BTreeMap<String, Rows> = BTreeMap::new();
    for row in rows(results, source)? {
        let point = row.get("point").and_then(Value::as_str).unwrap_or_default().to_owned();
        points.entry(point).or_default().push(row);
    }
    Ok(points.into_values().collect())
}

/// The setting of a point that differs from the first point's, in words.
fn setting(point: &Rows, first: &Rows) -> String {
    type Written = fn(f64) -> String;
    let fields: [(&str, Written); 5] = [
        ("engine.native.solver_tolerance", |v| format!("tolerance {v}")),
        ("engine.native.iterations", |v| format!("{v} iterations")),
        ("engine.native.substep_rate_hz", |v| format!("{v} sub-steps per second")),
        ("engine.rate_hz", |v| format!("{v} Hz")),
        ("engine.native.contact_stiffness_n_per_m", |v| format!("{} kN/m", v / 1000.0)),
    ];
    let mut words = fields.iter().filter_map(|(field, word)| {
        let (a, b) = (number(point.first()?, field)?, number(first.first()?, field)?);
        (a != b).then(|| word(a))
    });
    words.next().unwrap_or_else(|| "the default".to_owned())
}

/// `docs/accuracy.md`: heights of pours against the default's.
fn convergence(results: &Results) -> Result<Value, String> {
    let points = points(results, "native-convergence")?;
    let default = whole(points.first().cloned().unwrap_or_default()).0;
    let row = |point: &Rows| {
        let (rows, jam) = whole(point.clone());
        let name = setting(point, &points[0]);
        let change = (name != "the default")
            .then(|| interval(&pairs(&rows, &default, height_percent, "void_ratio")));
        json!({
            "name": name, "count": rows.len(), "jammed": jam,
            "void_ratio": interval(&values(&rows, "void_ratio")), "height_percent": change,
            "overlap_p99_percent": interval(&values(&rows, "overlap.p99_percent")),
        })
    };
    Ok(points.iter().map(row).collect())
}

/// `docs/accuracy.md`: heights and settlements of the quick specimen against the default's.
fn settlement(results: &Results) -> Result<Value, String> {
    Ok(against_first(&points(results, "native-settlement")?, whole))
}

/// `docs/accuracy.md`: settlements of the paper's specimen against the default's.
fn shaken(results: &Results) -> Result<Value, String> {
    Ok(against_first(&points(results, "shaken-tolerance")?, counted))
}

/// Heights and settlements of points against those of the first, by rows that count.
fn against_first(points: &[Rows], counting: impl Fn(Rows) -> (Rows, usize)) -> Value {
    let default = counting(points.first().cloned().unwrap_or_default()).0;
    let row = |point: &Rows| {
        let (rows, left) = counting(point.clone());
        let name = setting(point, &points[0]);
        let change = |field: &str| {
            let both = || pairs(&rows, &default, |a, b| (a, b), field);
            (name != "the default").then(|| interval(&percent_of_mean(&both())))
        };
        let [height, surface, plate] =
            ["poured_height_mm.mean_surface", "surface_settlement_mm.final", "settlement_mm.final"];
        json!({
            "name": name, "count": rows.len(), "left_out": left,
            "height_percent": change(height),
            "surface_mm": interval(&values(&rows, surface)), "surface_percent": change(surface),
            "plate_mm": interval(&values(&rows, plate)), "plate_percent": change(plate),
        })
    };
    points.iter().map(row).collect()
}

/// `docs/engines.md`: specimens handed over, by who poured and who shook, and differences.
fn handed(results: &Results) -> Result<Value, String> {
    let all = rows(results, "handed-over")?;
    let text = |row: &Map<String, Value>, f: &str| {
        row.get(f).and_then(Value::as_str).unwrap_or_default().to_owned()
    };
    let of = |by: &str, engine: &str| -> Rows {
        let is =
            |r: &&Map<String, Value>| text(r, "specimen_by") == by && text(r, "engine") == engine;
        all.iter().filter(is).cloned().collect()
    };
    let less = |a: f64, b: f64| a - b;
    let surface = "surface_settlement_mm";
    let mut found = Map::new();
    for (by, by_name) in [("bullet", "native"), ("rapier", "rapier")] {
        for (engine, name) in [("bullet", "native"), ("rapier", "rapier")] {
            let rows = of(by, engine);
            let creep = values(&rows, "creep_um_per_s").into_iter().map(f64::abs);
            found.insert(
                format!("{by_name} {name}"),
                json!({
                    "surface_mm": interval(&values(&rows, surface)),
                    "plate_mm": interval(&values(&rows, "plate_settlement_mm")),
                    "largest_creep_um_per_s": creep.fold(0.0, f64::max),
                }),
            );
        }
        let change = pairs(&of(by, "rapier"), &of(by, "bullet"), less, surface);
        found.insert(format!("{by_name} specimens, rapier less native"), interval(&change));
    }
    for (engine, name) in [("bullet", "native"), ("rapier", "rapier")] {
        let change = pairs(&of("bullet", engine), &of("rapier", engine), less, surface);
        found.insert(format!("{name} shaking, native less rapier specimens"), interval(&change));
    }
    Ok(found.into())
}

const HEIGHT: &str = "standing_height_mm.mean_surface";

/// Twins of a size that have a result, are valid and did not jam, and how many of those jammed.
fn twins_of(all: &Rows, larger: f64) -> (Rows, usize) {
    let is_not_valid = |r: &Map<String, Value>| r.get("valid").is_some_and(|v| v == "false");
    let of_size = all.iter().filter(|r| {
        number(r, "larger") == Some(larger) && number(r, "void_ratio").is_some() && !is_not_valid(r)
    });
    whole(of_size.cloned().collect())
}

/// `docs/scale.md`: twins by size.
fn twins(results: &Results) -> Result<Value, String> {
    let all = rows(results, "twins")?;
    // A table of before runs without result had rows lacks them: sizes have the same realisations.
    let planned = by_realisation(&all).into_keys().max().unwrap_or_default();
    let mut found = Vec::new();
    for larger in [0.1, 1.0, 5.0] {
        let (rows, jam) = twins_of(&all, larger);
        let heights: Vec<f64> = values(&rows, HEIGHT).iter().map(|h| h / larger).collect();
        let creep = values(&rows, "creep_um_per_s").into_iter().map(f64::abs);
        let [voids, coordination] =
            ["void_ratio", "coordination_number"].map(|field| values(&rows, field));
        found.push(json!({
            "name": larger.to_string(), "larger": larger, "count": rows.len(), "jammed": jam,
            "left_out": planned.saturating_sub(rows.len() as u64),
            "void_ratio": interval(&voids),
            "height_over_size_mm": interval(&heights),
            "coordination_number": interval(&coordination),
            "overlap_mean_percent": interval(&values(&rows, "overlap.mean_percent")),
            "overlap_p99_percent": interval(&values(&rows, "overlap.p99_percent")),
            "largest_creep_um_per_s": creep.fold(0.0, f64::max),
            "allowed_creep_um_per_s": 5.0 * larger.sqrt(),
        }));
    }
    Ok(found.into())
}

/// Fields of [`twin_differences`]: intervals, and how far each reaches from zero.
const TWIN_FIELDS: [(&str, &str, &str); 3] = [
    (HEIGHT, "height_percent", "height_reach_percent"),
    ("void_ratio", "void_ratio_percent", "void_ratio_reach_percent"),
    ("coordination_number", "coordination_percent", "coordination_reach_percent"),
];

/// `docs/scale.md`: twins of two sizes, realisation by realisation; heights over the size.
fn twin_differences(results: &Results) -> Result<Value, String> {
    let all = rows(results, "twins")?;
    let mut found = Vec::new();
    for (one, other) in [(0.1, 1.0), (5.0, 1.0), (5.0, 0.1)] {
        let [(rows, _), (others, _)] = [one, other].map(|larger| twins_of(&all, larger));
        let mut row = Map::new();
        row.insert("name".to_owned(), format!("{one} less {other}").into());
        for (field, percent, reach) in TWIN_FIELDS {
            let over = if field == HEIGHT { [one, other] } else { [1.0; 2] };
            let both = pairs(&rows, &others, |a, b| (a / over[0], b / over[1]), field);
            let of = percent_of_mean(&both);
            row.insert("count".to_owned(), of.len().into());
            let reaches = MeanTest::of(&of, 0.95).map(|t| t.estimate.mean.abs() + t.half_width);
            row.insert(reach.to_owned(), reaches.into());
            row.insert(percent.to_owned(), interval(&of));
        }
        found.push(Value::Object(row));
    }
    Ok(found.into())
}

/// How many intervals of [`twin_differences`] there are, and how many lack zero.
fn twins_beyond(results: &Results) -> Result<Value, String> {
    let all = rows(results, "twins-differences")?;
    let of_row = |row: &Map<String, Value>| {
        TWIN_FIELDS.map(|(_, percent, _)| row.get(percent).is_some_and(lacks_zero))
    };
    let beyond: Vec<bool> = all.iter().flat_map(of_row).collect();
    let count = beyond.iter().filter(|is| **is).count();
    Ok(json!({ "differences": beyond.len(), "beyond": count }))
}

/// Whether an interval, by its `mean` and `half`, lacks zero.
pub fn lacks_zero(interval: &Value) -> bool {
    let of = |field: &str| interval[field].as_f64();
    of("mean").zip(of("half")).is_some_and(|(mean, half)| mean.abs() > half)
}

/// `docs/scale.md`: grains of other sizes with nothing typed but grains and stages; `finest_mm` is
/// the opening of the finest sieve, in whose square root the allowed creep grows.
fn sizes(results: &Results) -> Result<Value, String> {
    let mut found = Vec::new();
    for (name, finest_mm) in [("sand", 0.5), ("gravel", 8.0), ("ballast", 31.5)] {
        let rows = rows(results, &format!("size-{name}"))?;
        let is_met = |row: &&Map<String, Value>| row["meets_standard"] == "true";
        let most = |field: &str| values(&rows, field).into_iter().map(f64::abs).fold(0.0, f64::max);
        found.push(json!({
            "name": name,
            "count": rows.len(),
            "met": rows.iter().filter(is_met).count(),
            "void_ratio": interval(&values(&rows, "void_ratio")),
            "overlap_mean_percent": most("overlap.mean_percent"),
            "overlap_p99_percent": most("overlap.p99_percent"),
            "largest_creep_um_per_s": most("creep_um_per_s"),
            "allowed_creep_um_per_s": 5.0 * (finest_mm / 8.0_f64).sqrt(),
        }));
    }
    Ok(found.into())
}

/// Points of the joint sweeps, `abrupt` and with a `ramp`: how many there are, in how many the
/// share of the first period is as wanted, and in how many all four numbers are. A point's pile,
/// continuous and intermittent shaking have its friction. And the `models`: `all`, and those that
/// predict `worse` than the mean.
fn joint(results: &Results) -> Result<Value, String> {
    let [piles, continuous, intermittent] =
        ["joint-pile", "joint-continuous", "joint-intermittent"]
            .map(|source| rows(results, source));
    let (piles, intermittent) = (piles?, intermittent?);
    let found = results.source("joint")?;
    let met = |target: usize, value: Option<f64>| {
        let end = |name: &str| found["targets"][target][name].as_f64().unwrap_or(f64::NAN);
        value.is_some_and(|value| (end("low")..=end("high")).contains(&value))
    };
    let share = |row: &Map<String, Value>, of: &str| {
        Some(100.0 * number(row, of)? / number(row, "settlement_mm.final")?)
    };
    let mut counts: BTreeMap<&str, [u32; 3]> = BTreeMap::new();
    for shaken in &continuous? {
        let same = |row: &&Map<String, Value>, field: &str| row.get(field) == shaken.get(field);
        let alike = |row: &&Map<String, Value>| same(row, "contact.grain_grain_friction");
        let pile = piles.iter().find(alike).ok_or("a point without a pile")?;
        let other = intermittent.iter().find(|row| alike(row) && same(row, "stages.3.ramp_s"));
        let other = other.ok_or("a point that is not shaken intermittently")?;
        let first = met(3, share(other, "settlement_mm.after_each_period.0"));
        let all = first
            && met(0, number(pile, "angle_of_repose.degrees"))
            && met(1, number(shaken, "settlement_mm.final"))
            && met(2, share(shaken, "settlement_mm.after_5_s"));
        let is_abrupt = number(shaken, "stages.3.ramp_s") == Some(0.0);
        let count = counts.entry(if is_abrupt { "abrupt" } else { "ramp" }).or_default();
        for (n, is) in [true, first, all].into_iter().enumerate() {
            count[n] += u32::from(is);
        }
    }
    // Models that predict specimens which they have not seen worse than the mean does.
    let models = found["targets"].as_array().ok_or("there is no list `targets`")?;
    let is_worse = |of: &&Value| of["fit"]["predicted"].as_f64().is_some_and(|share| share < 0.0);
    let worse = models.iter().filter(is_worse).count();
    let of =
        |[points, first, all]: [u32; 3]| json!({ "points": points, "first": first, "all": all });
    let models = ("models".to_owned(), json!({ "all": models.len(), "worse": worse }));
    let counts = counts.into_iter().map(|(name, count)| (name.to_owned(), of(count)));
    Ok(counts.chain([models]).collect())
}

/// Verdicts on the statements of the paper's programme.
fn tally(results: &Results) -> Result<Value, String> {
    let mut counts = Map::new();
    for claim in rows(results, "claims")? {
        let verdict = claim.get("verdict").and_then(Value::as_str).unwrap_or_default();
        let before = counts.get(verdict).and_then(Value::as_u64).unwrap_or(0);
        counts.insert(verdict.to_owned(), (before + 1).into());
    }
    Ok(counts.into())
}

/// `docs/studies.md`: how far settlements scatter between placements on one specimen, and between
/// specimens, of the runs that count.
fn placements(results: &Results) -> Result<Value, String> {
    let mut specimens: BTreeMap<u64, Rows> = BTreeMap::new();
    let counts = |row: &Map<String, Value>| !says(row, "left_out_of_means");
    for row in rows(results, "placements")?.into_iter().filter(counts) {
        let number = number(&row, "configuration").ok_or("a run without a configuration")?;
        specimens.entry(number as u64).or_default().push(row);
    }
    let fields = [("plate", "settlement_mm.final"), ("surface", "surface_settlement_mm.final")];
    let one = |(name, field): &(&str, &str)| {
        let groups: Vec<Vec<f64>> = specimens.values().map(|rows| values(rows, field)).collect();
        let found = Nested::of(&groups, 0.95)
            .ok_or_else(|| format!("`{field}` has too few values to tell scatters apart"))?;
        let deviation = |variance: Option<Bounded>| {
            variance.map(
                |v| json!({ "value": v.value.sqrt(), "low": v.low.sqrt(), "high": v.high.sqrt() }),
            )
        };
        let interval = json!({ "low": found.mean.low, "high": found.mean.high });
        Ok(json!({
            "name": name, "specimens": found.groups, "values": found.values,
            "mean": found.mean.value, "interval": interval,
            "between_placements": deviation(found.within),
            "between_specimens": deviation(found.between),
            "p_of_equal_specimens": found.p_between,
        }))
    };
    fields.iter().map(one).collect()
}
