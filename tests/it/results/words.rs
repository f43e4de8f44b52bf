//! What is said in words, which no mark fills, beside the kept results that it is said of.

use std::fs;

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
    let stock = source("quick-stock");
    let stock_misses = stock.as_array().expect("rows").iter().all(|row| {
        let number = |field: &str| row[field].as_f64().expect("a number");
        number("creep_um_per_s").abs() > 5.0 && number("overlap.mean_percent") > 0.5
    });

    let text = include_str!("../../../src/paper/report/choices.json");
    let choices: Vec<Value> = serde_json::from_str(text).expect("JSON");
    for (of, parameter, said, holds) in [
        (
            "place_top_plate",
            "Placing of the top plate",
            "settles more than the surface",
            more(plate, surface),
        ),
        (
            "vibrate",
            "Motion of the table",
            "Abrupt starts and stops of the table add settlement; a ramp in their place (--set, \
             ramp_s) makes it smaller",
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
