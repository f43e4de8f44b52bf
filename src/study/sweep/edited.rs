//! Whether a plan in a folder is still the plan of what is asked for, and if
//! not, what has changed since.

use std::path::absolute;

use super::*;

/// Most differences that are reported one by one.
const MOST_TOLD: usize = 5;

/// What a scenario may name, of which the copy in the folder has the paths.
const FILES: &str = "files (motions, grains, meshes or specimens)";

/// Refuses a folder that holds the plan of another sweep, or that of this one when its scenario was
/// another, and says what has changed. More configurations of the same sweep are none; fewer would
/// take runs out of its tables.
pub(super) fn refuse(
    out: &Path,
    now: &SweepPlan,
    options: &super::SweepOptions,
    scenario: &Scenario,
) -> Result<(), StudyError> {
    let path = out.join(PLAN_FILE);
    if !path.exists() {
        return Ok(());
    }
    let there = SweepPlan::read(out)?;
    let other = asked_otherwise(&there, now);
    if !other.is_empty() {
        return refused(format!(
            "{} is the plan of another sweep: {}. Nothing was written; choose another folder with \
             --out",
            path.display(),
            other.join("; ")
        ));
    }
    if same_runs(&there, now) {
        return not_fewer(&path, &there, now);
    }
    let why = built_otherwise(&there, now).unwrap_or_else(|| {
        let kept = load_scenario(&out.join(SCENARIO_FILE), &options.common());
        let told = kept.map_or_else(
            |_| vec![format!("{SCENARIO_FILE} there, which says what it was, cannot be read")],
            |kept| differences(&kept.scenario, scenario),
        );
        if told.is_empty() && is_edited(&there, now) {
            return format!("{PLAN_FILE} there was edited");
        }
        let told = if told.is_empty() {
            format!("{FILES} that it names have changed")
        } else {
            told.join("; ")
        };
        format!("{} has changed since: {told}", options.scenario.display())
    });
    refused(format!(
        "{} was made before a change: {why}. Nothing was written. Choose another folder with --out, \
         or undo the change",
        path.display()
    ))
}

/// What two plans were asked that differs, by fields of `plan.json`; configurations aside, which may
/// be added to a sweep.
fn asked_otherwise(there: &SweepPlan, now: &SweepPlan) -> Vec<String> {
    let design = |plan: &SweepPlan| match plan.samples {
        Some(count) => vec![format!("{} of {count} samples", plan.design)],
        None => vec![plan.design.clone()],
    };
    let ends = |plan: &SweepPlan| -> Vec<String> {
        let of_each =
            |p: &Parameter| [p.low_changes.join(" "), p.high_changes.join(" ")].join(", ");
        plan.parameters.iter().map(of_each).collect()
    };
    let fields: [(&str, [Vec<String>; 2]); 5] = [
        ("`design`", [there, now].map(design)),
        ("`over`", [there, now].map(|plan| plan.over.clone())),
        ("`ranges`", [there, now].map(|plan| plan.ranges.clone())),
        ("`changes` (--set, --seed, --backend)", [there, now].map(|plan| plan.changes.clone())),
        ("`parameters`", [there, now].map(ends)),
    ];
    let differing = fields.iter().filter(|(_, [before, after])| before != after);
    let told = |(field, [before, after]): &(&str, [Vec<String>; 2])| {
        let only = |of: &[String], other: &[String]| -> Vec<String> {
            of.iter().filter(|one| !other.contains(one)).cloned().collect()
        };
        let mut parts = [only(before, after), only(after, before)];
        if parts.iter().all(Vec::is_empty) {
            // The same in another order.
            parts = [before.clone(), after.clone()];
        }
        let [was, is] = parts.map(|part| match part.is_empty() {
            true => "nothing more".to_owned(),
            false => part.join(" and "),
        });
        format!("{field}: {was} there, {is} now")
    };
    differing.map(told).collect()
}

/// Refuses a plan with fewer configurations than the one that is there.
fn not_fewer(path: &Path, there: &SweepPlan, now: &SweepPlan) -> Result<(), StudyError> {
    let (were, are) = (there.configurations, now.configurations);
    if are >= were {
        return Ok(());
    }
    refused(format!(
        "{}: `configurations` is {were} there and {are} now, which would take runs out of its tables \
         (allowed: --configurations of at least {were}). Nothing was written. Choose another folder \
         with --out, or `pluvia sweep --collect` for the tables of what is there",
        path.display()
    ))
}

/// Refuses a plan whose stages are no longer those that were planned, and says why.
pub(super) fn refuse_planned(
    out: &Path,
    there: &SweepPlan,
    now: &SweepPlan,
) -> Result<(), StudyError> {
    if there.runs == now.runs {
        return Ok(());
    }
    let file = out.join(SCENARIO_FILE);
    let why = built_otherwise(there, now).unwrap_or_else(|| {
        let kept: Option<Value> = read_json(&file).ok();
        match kept.is_some_and(|kept| hash_json(&kept) == there.scenario_sha256) {
            true if is_edited(there, now) => "it was edited, and lists other runs".to_owned(),
            true => format!("{FILES} that it names have changed"),
            false => format!("{} was edited", file.display()),
        }
    });
    refused(format!(
        "{} is no longer what its stages would be made by: {why}. Undo that, or plan the sweep \
         again with `pluvia sweep --plan-only` into another folder",
        out.join(PLAN_FILE).display()
    ))
}

/// Whether the runs that both have are the same, and they differ in configurations alone.
fn same_runs(there: &SweepPlan, now: &SweepPlan) -> bool {
    let fewer = there.configurations.min(now.configurations);
    shared(there, fewer) == shared(now, fewer)
}

/// The runs of the first configurations of each point, up to a number of them.
fn shared(plan: &SweepPlan, configurations: u32) -> Vec<&PlannedPoint> {
    let of_all = plan.configurations.max(1) as usize;
    let points = plan.runs.chunks(of_all);
    points.flat_map(|point| point.iter().take(configurations as usize)).collect()
}

/// Whether the runs that both have are others by what a plan says of them: no file that a scenario
/// names changes that, but for what they are stored under and which random numbers they have.
fn is_edited(there: &SweepPlan, now: &SweepPlan) -> bool {
    let fewer = there.configurations.min(now.configurations);
    let (were, are) = (shared(there, fewer), shared(now, fewer));
    let alike = |(a, b): (&&PlannedPoint, &&PlannedPoint)| {
        (&a.run, &a.point, &a.values, &a.changes) == (&b.run, &b.point, &b.values, &b.changes)
    };
    were.len() != are.len() || !were.iter().zip(&are).all(alike)
}

/// Whether program or engine are others.
fn built_otherwise(there: &SweepPlan, now: &SweepPlan) -> Option<String> {
    let of = |plan: &SweepPlan| format!("{} with {}", plan.program, plan.engines.join(" and "));
    let (before, after) = (of(there), of(now));
    (before != after).then(|| format!("it was made by {before}, this is {after}"))
}

/// What is different in two scenarios, field by field; nothing of what they
/// are called and said to be for.
fn differences(before: &Scenario, after: &Scenario) -> Vec<String> {
    let json = |s: &Scenario| serde_json::to_value(s).unwrap_or_default();
    let mut found = Vec::new();
    compare("", Some(&json(before)), Some(&json(after)), &mut found);
    if found.len() > MOST_TOLD {
        let more = found.len() - MOST_TOLD;
        found.truncate(MOST_TOLD);
        found.push(format!("and {more} more"));
    }
    found
}

fn compare(path: &str, before: Option<&Value>, after: Option<&Value>, found: &mut Vec<String>) {
    // Fields that no result depends on.
    if path == "name" || WORDS.contains(&path) || before == after {
        return;
    }
    match (before, after) {
        (Some(Value::Object(a)), Some(Value::Object(b))) => {
            let added = b.keys().filter(|key| !a.contains_key(*key));
            for key in a.keys().chain(added) {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                compare(&path, a.get(key), b.get(key), found);
            }
        }
        (Some(Value::Array(a)), Some(Value::Array(b))) => {
            for n in 0..a.len().max(b.len()) {
                compare(&format!("{path}[{n}]"), a.get(n), b.get(n), found);
            }
        }
        // The copy in the folder has whole paths.
        (Some(Value::String(a)), Some(Value::String(b)))
            if absolute(a).is_ok_and(|a| absolute(b).is_ok_and(|b| a == b)) => {}
        _ => found.push(format!("{path} was {}, is {}", shown(before), shown(after))),
    }
}

/// A value in few letters.
fn shown(value: Option<&Value>) -> String {
    let text = match value {
        None | Some(Value::Null) => return "not given".to_owned(),
        Some(value) => value.to_string(),
    };
    if text.chars().count() <= 60 {
        return text;
    }
    format!("{}…", text.chars().take(60).collect::<String>())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn scenario(height: f64, description: &str, more: bool) -> Scenario {
        let mut stages = vec![
            json!({ "stage": "fill_funnel" }),
            json!({ "stage": "pour", "falling_height_mm": height }),
        ];
        if more {
            stages.push(json!({ "stage": "rest", "duration_s": 1 }));
        }
        serde_json::from_value(json!({
            "name": "s", "description": description, "grains": { "file": "g.json" },
            "stages": stages
        }))
        .expect("a scenario")
    }

    /// Law: the copy's whole path of a file is no change, wherever a scenario names one; another is.
    #[test]
    fn a_whole_path_is_no_other_file() {
        let named = |specimen: &str, file: &str| -> Scenario {
            serde_json::from_value(json!({
                "name": "s", "grains": { "file": file }, "begin": { "specimen": specimen },
                "stages": [{ "stage": "rest", "duration_s": 1 }]
            }))
            .expect("a scenario")
        };
        let whole = |path: &str| absolute(path).expect("a path").display().to_string();
        let (own, copy) = (named("out/a", "g.json"), named(&whole("out/a"), &whole("g.json")));
        assert_eq!(differences(&copy, &own), [""; 0], "law: the same files");
        let told = differences(&copy, &named("out/b", "g.json"));
        assert!(told.len() == 1 && told[0].starts_with("begin.specimen was"), "{told:?}");
    }

    /// Law: what two sweeps were asked that differs is named with both; equal questions differ in
    /// nothing.
    #[test]
    fn another_question_is_named() {
        let plan = |change: &dyn Fn(&mut Value)| -> SweepPlan {
            let mut plan = json!({
                "format": "", "version": 2, "program": "", "engines": [], "scenario": "a.json",
                "name": "a", "scenario_sha256": "", "design": "grid", "samples": null,
                "over": ["seed=1,2", "contact.restitution=0.1,0.3"], "parameters": [],
                "quick": false, "ranges": [], "changes": ["rest_test_s=1"], "configurations": 2,
                "runs": []
            });
            change(&mut plan);
            serde_json::from_value(plan).expect("a plan")
        };
        let own = plan(&|_: &mut Value| ());
        let more = plan(&|plan: &mut Value| plan["configurations"] = 5.into());
        assert_eq!(asked_otherwise(&own, &more), [""; 0], "law: configurations may be added");
        for (field, value, expected) in [
            (
                "changes",
                json!(["rest_test_s=2"]),
                "`changes` (--set, --seed, --backend): rest_test_s=1 there, rest_test_s=2 now",
            ),
            (
                "changes",
                json!(["rest_test_s=1", "seed=3"]),
                "`changes` (--set, --seed, --backend): nothing more there, seed=3 now",
            ),
            (
                "over",
                json!(["contact.restitution=0.1,0.3", "seed=1,2"]),
                "`over`: seed=1,2 and contact.restitution=0.1,0.3 there, \
                 contact.restitution=0.1,0.3 and seed=1,2 now",
            ),
            ("samples", json!(4), "`design`: grid there, grid of 4 samples now"),
        ] {
            let other = plan(&|plan: &mut Value| plan[field] = value.clone());
            assert_eq!(asked_otherwise(&own, &other), [expected], "law: {field} is named");
        }
    }

    #[test]
    fn what_has_changed_is_told_by_its_path_and_words_are_not() {
        let before = scenario(0.0, "one", false);
        assert!(differences(&before, &scenario(0.0, "two", false)).is_empty(), "law: words");
        let told = differences(&before, &scenario(50.0, "one", false));
        assert_eq!(told, ["stages[1].falling_height_mm was 0.0, is 50.0"]);
        let told = differences(&before, &scenario(0.0, "one", true));
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].starts_with("stages[2] was not given, is {"), "{told:?}");
    }
}
