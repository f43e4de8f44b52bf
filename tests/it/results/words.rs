//! What is said in words, which no mark fills, beside the kept results that it is said of.

use std::fs;

use pluvia::measure::inference::t_quantile;
use serde_json::Value;

use super::{Results, root};

/// Whether the interval of a mean contains zero.
fn within_scatter(of: &Value) -> bool {
    let number = |field: &str| of[field].as_f64().expect("a mean with half its interval");
    number("mean").abs() <= number("half")
}

/// Law: what a choice is said to move, or not to move beyond scatter, is so in the results that its
/// text refers to.
#[test]
fn choices_say_what_kept_results_show() {
    let results = Results::of(root());
    let source = |name: &str| results.source(name).unwrap_or_else(|e| panic!("{name}: {e}"));
    let unmoved = |from: &str, name: &str, fields: &[&str]| {
        let all = source(from);
        let found = all.as_array().and_then(|all| all.iter().find(|item| item["name"] == name));
        let found = found.unwrap_or_else(|| panic!("`{name}` in {from}"));
        fields.iter().all(|field| within_scatter(&found[*field]))
    };
    let shaken = |settings: &[&str]| {
        let fields = ["height_percent", "surface_percent", "plate_percent"];
        settings.iter().all(|name| unmoved("settlement", name, &fields))
    };
    let poured = |settings: &[&str]| {
        settings.iter().all(|name| unmoved("convergence", name, &["height_percent"]))
    };
    let rapier = |restitution: &str| {
        let name = format!("rapier, `simplified`, 0.793, {restitution}");
        unmoved("engines", &name, &["height_over_native_percent"])
    };
    let uncertainty = source("uncertainty");
    let end = |name: &str, end: &str| {
        let all = uncertainty["quantities"].as_array();
        let found = all.and_then(|all| all.iter().find(|item| item["name"] == name));
        let end = found.and_then(|item| item["interval"][end].as_f64());
        end.unwrap_or_else(|| panic!("no interval of `{name}`"))
    };
    let more = |one: &str, other: &str| end(one, "low") > end(other, "high");
    let (plate, surface, intermittent) = (
        "continuous vibration, plate, final",
        "continuous vibration, mean surface, final",
        "intermittent vibration, plate, final",
    );
    let joint = source("joint");
    let targets = joint["targets"].as_array().expect("targets");
    let settled = targets.iter().find(|t| t["result"] == "settlement_mm.final");
    let ramp = settled.map(|t| &t["effects"]["stages.3.ramp_s"]).expect("of the settlement");
    let of_ramp = |n: usize| ramp[n].as_f64().expect("an effect with half its interval");
    let mut relaxed = targets.iter().map(|t| &t["effects"]["grains.cells.relaxation_steps"]);
    let effect = |of: &Value, n: usize| of[n].as_f64().expect("an effect with half its interval");
    let cells_show_none = relaxed.all(|of| effect(of, 0).abs() <= effect(of, 1));
    let stock = source("quick-stock");
    let stock_misses = stock.as_array().expect("rows").iter().all(|row| {
        let number = |field: &str| row[field].as_f64().expect("a number");
        number("creep_um_per_s").abs() > 5.0 && number("overlap.mean_percent") > 0.5
    });

    let text = include_str!("../../../src/paper/report/choices.json");
    let choices: Vec<Value> = serde_json::from_str(text).expect("JSON");
    for (of, parameter, said, holds) in [
        (
            "voronoi",
            "Points of the Voronoi cells",
            "Relaxation showed no effect on the settlement at full size, nor on the angle of piles of \
             364 grains, beyond scatter",
            cells_show_none,
        ),
        (
            "place_top_plate",
            "Placing of the top plate",
            "settles more than the surface",
            more(plate, surface),
        ),
        (
            "vibrate",
            "Motion of the table",
            "Abrupt starts and stops of the table add settlement; a ramp in their place (pluvia run \
             scenarios/paper/vibration-continuous.json --set stages.3.ramp_s=1 --out DIR) makes it \
             smaller",
            more(intermittent, plate) && of_ramp(0) + of_ramp(1) < 0.0,
        ),
        ("native", "Contacts", "numerical creep is too large, and so is the overlap", stock_misses),
        (
            "native",
            "Time step",
            "half of the rate and twice as much move neither height nor settlement beyond scatter",
            shaken(&["240 Hz", "960 Hz"]),
        ),
        (
            "native",
            "Solver iterations",
            "4 to 40 iterations do not move the height beyond scatter",
            poured(&["4 iterations", "16 iterations", "40 iterations"]),
        ),
        (
            "native",
            "Contact spring",
            "half of the stiffness and twice as much move neither height nor settlement beyond \
             scatter",
            shaken(&["5 kN/m", "20 kN/m"]),
        ),
        (
            "rapier",
            "Contacts",
            "as high as with native contacts within scatter; with friction alone they are lower",
            rapier("0.315") && !rapier("0"),
        ),
    ] {
        let choice = choices.iter().find(|c| c["of"] == of && c["parameter"] == parameter);
        let choice = choice.unwrap_or_else(|| panic!("law: `{parameter}` of {of} is a choice"));
        let texts = ["reason", "sensitivity"].map(|field| choice[field].as_str());
        let says = texts.into_iter().flatten().any(|text| text.contains(said));
        assert!(says, "law: `{parameter}` of {of} says `{said}`, got {choice}");
        assert!(holds, "law: kept results show that `{said}` ({parameter}); they do not");
    }
}

/// Law: what a step costs while grains move, over what it costs at rest, is as the page says.
#[test]
fn the_cost_of_moving_grains_is_that_of_the_bench() {
    let results = Results::of(root());
    let bench = results.source("bench").expect("the bench");
    let rows = bench.as_array().expect("rows");
    let one = |row: &&Value| row["threads"] == 1 && row["specimens"] == 1;
    let ms = |row: &Value| row["ms_per_step"].as_f64().expect("a time");
    let mut ratios = Vec::new();
    for rest in rows.iter().filter(one).filter(|row| row["state"] == "rest") {
        let alike = rows.iter().filter(one).filter(|row| row["grains"] == rest["grains"]);
        ratios.extend(alike.filter(|row| row["state"] != "rest").map(|row| ms(row) / ms(rest)));
    }
    ratios.sort_by(f64::total_cmp);
    let ends = [ratios.first(), ratios.last()].map(|end| end.map_or(0.0, |ratio| ratio.round()));
    assert_eq!(ends, [5.0, 9.0], "law: the least and the largest of {ratios:?}");
    let page = fs::read_to_string(root().join("docs/cost.md")).expect("the page");
    let text = page.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = "a step costs five to nine times as much while grains move as at rest";
    assert!(text.contains(said), "law: docs/cost.md says `{said}`");
}

/// Law: a ratio that a page gives in words is that of the kept results.
#[test]
fn ratios_in_words_are_those_of_the_results() {
    let results = Results::of(root());
    let source = |name: &str| results.source(name).unwrap_or_else(|e| panic!("{name}: {e}"));
    let number = |of: &Value| of.as_f64().unwrap_or_else(|| panic!("`{of}` is no number"));
    let named = |items: &Value, name: &str| -> Value {
        let found = items.as_array().and_then(|items| items.iter().find(|i| i["name"] == name));
        found.unwrap_or_else(|| panic!("no `{name}`")).clone()
    };
    let settled = |what: &str| {
        let name = format!("continuous vibration, {what}, final");
        number(&named(&source("uncertainty")["quantities"], &name)["mean"])
    };
    let placed = |what: &str| {
        number(&named(&source("placements-scatter"), what)["between_placements"]["value"])
    };
    let (studies, settlement) = ("docs/studies.md", "docs/concepts/settlement.md");
    let (repose, peers) = ("docs/repose.md", "docs/peers.md");
    let took = |engine: &str, scene: &str| {
        let all = source("peers");
        let mut rows = all.as_array().expect("rows").iter();
        let row = rows.find(|row| row["engine"] == engine && row["scene"] == scene);
        number(&row.unwrap_or_else(|| panic!("no {scene} by {engine}"))["wall_s_per_simulated_s"])
    };
    let times = |one: &str, other: &str, scene: &str| took(one, scene) / took(other, scene);
    let rapier = "While grains move it takes half as long again as rapier";
    let box3d = "half as long again as rapier and two to three times as long as Box3D";
    let shaken = "takes two thirds of rapier's time when shaken and as long in the pour";
    let poured = "as long in the pour, with less than half its overlap";
    let ours = number(&source("calibration")["solution"]["value"]);
    for (page, said, ratio, least, most) in [
        (
            studies,
            "about five times as much as the surface's",
            placed("plate") / placed("surface"),
            4.5,
            5.5,
        ),
        (
            settlement,
            "about twice as much as the surface",
            settled("plate") / settled("mean surface"),
            1.5,
            2.5,
        ),
        (repose, "less than half of the paper's 0.793", ours / 0.793, 0.0, 0.5),
        (peers, rapier, times("pluvia", "rapier", "shaken"), 1.35, 1.65),
        (peers, rapier, times("pluvia", "rapier", "pour"), 1.35, 1.65),
        (peers, box3d, times("pluvia", "box3d-patched", "shaken"), 1.5, 3.5),
        (peers, box3d, times("pluvia", "box3d-patched", "pour"), 1.5, 3.5),
        (peers, shaken, times("pluvia-counted", "rapier", "shaken"), 0.58, 0.75),
        (peers, poured, times("pluvia-counted", "rapier", "pour"), 0.9, 1.1),
    ] {
        let text = fs::read_to_string(root().join(page)).expect("the page");
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(said), "law: {page} says `{said}`");
        let holds = (least..most).contains(&ratio);
        assert!(holds, "law: {page} says `{said}`; it is {ratio:.3}, not {least} to {most}");
    }
}

/// Law: the angle of repose by which deposits of columns are explained is that of kept piles with
/// the columns' friction, 0.5, on straight lines between frictions.
#[test]
fn deposits_of_columns_are_explained_by_the_angle_of_kept_piles() {
    let of = Results::of(root()).source("calibration").expect("kept piles");
    let number = |value: &Value, field: &str| value[field].as_f64().expect("a number");
    let values = of["values"].as_array().expect("values");
    let mut angles: Vec<(f64, f64)> =
        values.iter().map(|v| (number(v, "value"), number(v, "mean"))).collect();
    angles.sort_by(|a, b| a.0.total_cmp(&b.0));
    let about = angles.windows(2).find(|pair| pair[0].0 <= 0.5 && 0.5 < pair[1].0);
    let [(x0, y0), (x1, y1)] = about.expect("piles about 0.5") else { panic!("two of them") };
    let kept = y0 + (y1 - y0) * (0.5 - x0) / (x1 - x0);
    assert!((kept - 42.0).abs() < 1.5, "law: 42° at 0.5, piles say {kept}, tolerance 1.5°");
    for (file, said) in [
        ("benches/laboratory/column.rs", "const REPOSE: f64 = 42.0;"),
        ("docs/results/laboratory.md", "such grains pile up at about 42°"),
    ] {
        let text = fs::read_to_string(root().join(file)).expect("the file");
        assert!(text.contains(said), "law: {file} says `{said}`");
    }
}

/// Law: where pages say in words what is reproduced, the kept scorecard says the same.
#[test]
fn pages_judge_as_the_kept_scorecard_does() {
    let read = |path: &str| {
        fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
    };
    let card: Value = serde_json::from_str(&read("docs/results/scorecard.json")).expect("JSON");
    let rows = card["rows"].as_array().expect("rows");
    let stands = |id: &str| {
        let row = rows.iter().find(|row| row["id"] == id);
        let row = row.unwrap_or_else(|| panic!("law: there is a row `{id}`"));
        let verdict = row["verdict"].as_str().expect("a verdict");
        if row["decided"] == false { "not decided" } else { verdict }
    };
    let (front, results) = ("README.md", "docs/results/README.md");
    let trends =
        ["standing-height-falls", "denser-after-vibration", "intermittent-fluctuation-at-ends"];
    let (settled, share) = ("continuous-final-settlement", "continuous-share-after-5-s");
    let (first, angle) = ("intermittent-share-in-first-period", "angle-of-repose");
    for (page, said, ids, expected) in [
        (front, "Trends: yes.", trends.to_vec(), "within"),
        (front, "Continuous settlement: undecided.", vec![settled], "not decided"),
        (front, "which we read as 75 to 85: undecided, too.", vec![share], "not decided"),
        (
            front,
            "First intermittent period and angle of repose: no.",
            vec![first, angle],
            "outside",
        ),
        (
            results,
            "**Height decreases with increasing falling height** (Figure 7): reproduced.",
            trends[..1].to_vec(),
            "within",
        ),
        (
            results,
            "**Gravel is denser after vibration** (Figure 8): reproduced",
            trends[1..2].to_vec(),
            "within",
        ),
        (
            results,
            "**Continuous vibration** (Figure 9): within the range on average, but not decided.",
            vec![settled],
            "not decided",
        ),
        (results, "**Intermittent vibration** (Figure 10): outside.", vec![first], "outside"),
        (results, "**The angle of repose**: outside.", vec![angle], "outside"),
    ] {
        let text = read(page).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(said), "law: {page} says `{said}`");
        for id in ids {
            let got = stands(id);
            assert_eq!(got, expected, "law: `{id}` as {page} says: `{said}`");
        }
    }
}

/// Law: specimens with stock contacts that are left alone sink as the paper says that its own
/// settled when shaken; those with native contacts do not sink.
#[test]
fn stock_specimens_sink_at_rest_as_far_as_the_paper_s_when_shaken() {
    let results = Results::of(root());
    let rows = results.source("stock-at-rest").expect("specimens left alone");
    let rows = rows.as_array().expect("rows");
    assert_eq!(rows.len(), 3, "law: three realisations");
    let mut shares = Vec::new();
    for row in rows {
        let of = |field: &str| row[field].as_f64().expect("a number");
        let sunk = of("stock_rest_plate_after_20_s_mm");
        assert!((14.0..=19.61).contains(&sunk), "law: in the laboratory's range, got {sunk} mm");
        shares.push(of("stock_rest_share_after_5_s_percent"));
        let native = of("native_rest_plate_after_20_s_mm");
        assert!(native.abs() < 0.005, "law: with native contacts none, got {native} mm");
    }
    // "About 80 %" as the scorecard reads it.
    let share = shares.iter().sum::<f64>() / shares.len() as f64;
    assert!((75.0..=85.0).contains(&share), "law: about 80 % in the first 5 s, got {share} %");
    for (page, said) in [
        ("README.md", "three [specimens sink as far unshaken]"),
        ("docs/results/interpretations.md", "**Without any shaking, specimens with stock contacts"),
        ("docs/accuracy.md", "[sink as far in 20 s as"),
    ] {
        let text = fs::read_to_string(root().join(page)).expect("the page");
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(said), "law: {page} says `{said}`");
    }
}

/// Law: the page of the sensitivity marks a row as within scatter where its own numbers say so. How
/// many pairs a row has it does not say: at most all realisations, at least those left when every
/// run that is left out, and that of the default, takes a pair with it.
#[test]
fn the_sensitivity_page_marks_what_its_numbers_say() {
    let page = fs::read_to_string(root().join("docs/results/sensitivity-quick.md"));
    let page = page.expect("the page");
    let command = page.split("--configurations ").nth(1).and_then(|rest| rest.split(' ').next());
    let most: usize = command.and_then(|n| n.parse().ok()).expect("how many realisations");
    // Means and errors have two digits.
    const ROUNDING: f64 = 1.06;
    let mut beyond = 0;
    for table in page.split("\n## ").skip(1).take(3) {
        for row in table.lines().filter(|line| line.starts_with("| ")).skip(2) {
            let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
            let number = |text: &str| text.replace('−', "-").parse::<f64>().expect("a number");
            let t = |cell: &&str| {
                let (mean, error) = cell.split_once(" ± ")?;
                let (mean, error) = (number(mean), number(error));
                Some(if mean == 0.0 { 0.0 } else { mean.abs() / error })
            };
            let largest = cells[2..5].iter().filter_map(t).fold(0.0, f64::max);
            let tests = if cells[2..4].contains(&"default") { 1.0 } else { 3.0 };
            let left_out = cells[6].split(", ").find_map(|said| said.strip_suffix(" left out"));
            let left_out: usize = left_out.map_or(0, |n| n.parse().expect("a number"));
            let needed = |pairs: usize| {
                let freedom = pairs.max(2) as f64 - 1.0;
                t_quantile(1.0 - 0.025 / tests, freedom).expect("a quantile")
            };
            if cells[6].contains('~') {
                let least = most.saturating_sub(left_out + 1);
                let allowed = ROUNDING * needed(least);
                assert!(largest <= allowed, "law: t = {largest:.2} is at most {allowed:.2}: {row}");
            } else {
                let allowed = needed(most) / ROUNDING;
                assert!(
                    largest >= allowed,
                    "law: t = {largest:.2} is at least {allowed:.2}: {row}"
                );
                beyond += 1;
            }
        }
    }
    assert!(beyond > 0, "law: some rows are beyond scatter");
}

/// Law: with which friction coefficients pours miss the check of the solver is as the page says.
#[test]
fn pours_with_high_friction_miss_the_check_of_the_solver_as_the_page_says() {
    let rows = Results::of(root()).source("high-friction").expect("pours with high friction");
    let rows = rows.as_array().expect("rows");
    let missed = |friction: f64| {
        let of = |row: &&Value| row["contact.grain_grain_friction"].as_f64() == Some(friction);
        let why = |row: &Value| row["left_out_of_means"].as_str().map(str::to_owned);
        let of: Vec<_> = rows.iter().filter(of).map(why).collect();
        let missed = of.iter().flatten().filter(|why| why.contains("solver_residual")).count();
        [of.len(), missed]
    };
    let got = [1.0, 1.5, 2.0, 3.0].map(missed);
    let expected = [[5, 0], [5, 0], [5, 3], [5, 5]];
    assert_eq!(got, expected, "law: pours, and those that miss it, with 1, 1.5, 2 and 3");
    let text = fs::read_to_string(root().join("docs/accuracy.md")).expect("the page");
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = "none misses `solver_residual` with 1 or 1.5, three do with 2, and all with 3";
    assert!(text.contains(said), "law: docs/accuracy.md says `{said}`");
}

/// Law: counted iterations are said to move no settlement of the paper's specimen beyond scatter
/// exactly where they do not.
#[test]
fn counted_iterations_are_said_to_move_what_they_move() {
    let all = Results::of(root()).source("shaken").unwrap_or_else(|e| panic!("shaken: {e}"));
    let counted =
        all.as_array().and_then(|all| all.iter().find(|row| row["name"] == "tolerance 1"));
    let counted = counted.expect("a row of counted iterations");
    let unmoved =
        ["surface_percent", "plate_percent"].iter().all(|of| within_scatter(&counted[*of]));
    let page = fs::read_to_string(root().join("docs/accuracy.md")).expect("the page");
    let said = page.contains("Counted iterations move neither settlement beyond scatter");
    assert_eq!(said, unmoved, "law: said (left) where both settlements are within scatter (right)");
}
