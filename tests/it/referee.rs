//! The fields of the referee's results (`benches/referee/fields.rs`), and what earlier runs kept
//! (`benches/referee/kept.rs`) beside them (`benches/programs/beside.rs`).

use std::path::Path;

use clap::Parser;
use pluvia::{grains::load_scenario, scenario::Override};
use serde_json::{Value, json};

#[path = "../../benches/programs/beside.rs"]
mod beside;
#[path = "../../benches/referee/fields.rs"]
mod fields;
#[allow(dead_code)] // nothing is kept here
#[path = "../../benches/referee/kept.rs"]
mod kept;
#[allow(dead_code)] // only what is refused is asked
#[path = "../../benches/referee/options.rs"]
mod options;

/// A result with one entry of each kind, as `make referee` writes it.
fn result() -> Value {
    json!({
        "one_step": [{
            "scene": "quick pour", "grains": 364, "contacts": 2309.0, "engine": "native",
            "instants": 1, "instants_below_1e_10": 0, "velocity_error_median_percent": 0.05,
            "velocity_error_p99_percent": 1.8, "velocity_error_worst_percent": 10.0,
            "instant_error_median_percent": 0.28, "instant_error_worst_percent": 0.4,
            "reference_residual": 5e-9, "engine_residual": 1.6e-3, "siconos_error_worst": 2e-12,
            "other_solution_p99_percent": null, "inconsistency": 1e-6,
            "reference_wall_s_per_instant": 9.0
        }],
        "pours": [{
            "engine": "referee", "friction": 0.4, "restitution": 0.0, "realisations": 2,
            "height_mean_mm": 10.7, "height_standard_error_mm": 0.5, "difference_percent": null,
            "difference_standard_error_percent": null, "difference_interval_percent": null,
            "equivalent_within_0_5_percent": null, "correlation": null,
            "coordination_mean": 3.8, "coordination_standard_error": 0.2, "sliding_share": 0.07,
            "deepest_overlap_mm": 0.01, "outside": 0, "unsolved_share": 0.0,
            "worst_residual": 1e-4, "energy_gain_worst": 0.0, "wall_s_per_pour": 9.0
        }],
        "static": [{
            "specimen": "quick", "engine": "native", "grains": 364, "contacts": 2905,
            "gap_mm": 0.05, "friction": 0.793, "least_friction": 0.756,
            "least_friction_of_99_percent": 0.6, "fall": 0, "unbalanced": 0,
            "worst_left_percent": 0.0, "left_percent": 0.0, "stands": true, "wall_s": 20.0
        }]
    })
}

/// The fields that other programs rely on, by the parts of the file.
const AGREED: [(&str, &str); 3] = [
    (
        "one_step",
        "scene grains contacts engine velocity_error_median_percent \
         velocity_error_p99_percent reference_residual",
    ),
    (
        "pours",
        "engine friction restitution realisations height_mean_mm height_standard_error_mm \
         difference_percent equivalent_within_0_5_percent",
    ),
    ("static", "specimen engine least_friction"),
];

#[test]
fn results_of_the_referee_have_their_fields() {
    let got = fields::faults(&result());
    assert!(got.is_empty(), "a whole result: no faults expected, got {got:?}");
    for (part, agreed) in AGREED {
        for field in agreed.split_whitespace() {
            let mut short = result();
            short[part][0].as_object_mut().expect("an entry").remove(field);
            let expected = vec![format!("`{part}[0]` has no `{field}`")];
            assert_eq!(fields::faults(&short), expected, "without {field} of {part}");
        }
        let mut long = result();
        long[part][0]["surplus"] = json!(1);
        let expected = vec![format!("`{part}[0]` has `surplus`, which is unknown")];
        assert_eq!(fields::faults(&long), expected, "with a field more in {part}");
        let mut none = result();
        none.as_object_mut().expect("a file").remove(part);
        assert_eq!(fields::faults(&none), vec![format!("`{part}` is not a list")]);
    }
    let mut more = result();
    more["surplus"] = json!([]);
    assert_eq!(fields::faults(&more), vec!["`surplus` is no part of the file".to_owned()]);
}

/// Law: a specimen stands only where no grain falls and the others need no more friction than they
/// have. In kept results, too.
#[test]
fn a_specimen_with_a_falling_grain_does_not_stand() {
    let cases = [
        (0, Some(0.8), true),
        (0, Some(1.0), true),
        (0, Some(1.1), false),
        (0, None, false),
        (1, Some(0.8), false),
        (1, None, false),
    ];
    for (fall, factor, expected) in cases {
        let got = fields::stands(fall, factor);
        assert_eq!(got, expected, "law: {fall} that fall, coefficients times {factor:?}");
    }
    for name in ["referee.json", "referee-frictionless.json"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/results").join(name);
        let kept: Value = pluvia::record::read_json(&path).expect("kept results can be read");
        for of in kept["static"].as_array().expect("a list") {
            let fall = of["fall"].as_u64().expect("a number");
            let factor =
                of["least_friction"].as_f64().zip(of["friction"].as_f64()).map(|(l, f)| l / f);
            let expected = json!(fields::stands(fall, factor));
            assert_eq!(
                of["stands"], expected,
                "law: {name}, {} of {}",
                of["specimen"], of["engine"]
            );
        }
    }
}

/// Law: an instant that was solved again, as `--twice` does, counts once, as it was solved last.
#[test]
fn what_was_computed_again_counts_once() {
    let all =
        vec![("pour", 7, "once"), ("rest", 2, "once"), ("pour", 7, "twice"), ("pour", 3, "once")];
    let got = kept::last_of_each(all, |(scene, step, _)| (*step, *scene));
    let expected = [("rest", 2, "once"), ("pour", 3, "once"), ("pour", 7, "twice")];
    assert_eq!(got, expected, "law: the last of each instant, by steps");
}

/// Law: what was computed of a scenario is not taken for another's, nor for another program's.
#[test]
fn parts_of_another_scenario_or_program_are_computed_anew() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/quick/pluviation.json");
    let by = |programs: &[&str], changes: &[&str]| {
        let change = |text: &&str| text.parse::<Override>().expect("a change");
        let changes: Vec<Override> = changes.iter().map(change).collect();
        let scenario = load_scenario(&path, &changes).expect("it loads").scenario;
        kept::computed_by(programs, &scenario).expect("a fingerprint")
    };
    let own = by(&["engines", "referee"], &[]);
    assert_eq!(own, by(&["engines", "referee"], &[]), "law: the same of the same");
    for (programs, changes) in [
        (["engines", "referee"], ["seed=2"]),
        (["engines", "referee"], ["contact.grain_grain_friction=0.5"]),
        (["engines", "other"], ["seed=1"]),
        (["other", "referee"], ["seed=1"]),
    ] {
        let got = by(&programs, &changes);
        assert_ne!(got, own, "law: of {programs:?} with {changes:?} it is another");
    }
}

/// Law: results and what a later run goes on with have two names.
#[test]
fn a_folder_beside_results_has_another_name() {
    for (file, expected) in [
        ("out/referee.json", Some("out/referee")),
        ("first.try.json", Some("first.try")),
        ("out.d/referee", None),
        ("referee", None),
    ] {
        let got = beside::folder_of(Path::new(file));
        assert_eq!(got.as_deref().ok(), expected.map(Path::new), "law: beside {file}");
        let names = got.err().is_none_or(|why| why.contains(&format!("as {file}.json")));
        assert!(names, "law: `{file}` is refused with a name that is taken");
    }
}

/// Law: options that ask for nothing are refused: their empty list would take the place of results.
#[test]
fn the_referee_refuses_what_asks_for_nothing() {
    for (text, expected) in [
        ("--instants 0", false),
        ("--pours 1", false),
        ("--specimens large", false),
        ("--only nothing", false),
        ("--instants 1 --pours 2 --specimens quick,paper --only one-step,pours", true),
    ] {
        let words = std::iter::once("referee").chain(text.split_whitespace());
        let got = options::Options::try_parse_from(words).is_ok();
        assert_eq!(got, expected, "law: whether `{text}` is taken");
    }
}
