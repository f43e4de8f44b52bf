//! Every verification case on every setting of this build, by the same code
//! as `pluvia verify`; and wrong physics, put in on purpose, that must be found.

mod defects;
mod kept;
mod order;

use std::sync::{Arc, atomic::AtomicBool};

use defects::{Defect, made_with};
use pluvia::protocol::Silent;
use pluvia::verify::{
    Case, KnownFailure, Setting, SuiteOptions, Verdict, builtin, run_suite, settings, verify,
};

fn case(id: &str) -> Case {
    let mut cases = builtin().expect("the built-in cases are sound");
    let at = cases.iter().position(|c| c.id == id).unwrap_or_else(|| panic!("no case {id}"));
    cases.swap_remove(at)
}

fn setting(name: &str) -> Setting {
    let known: Vec<String> = settings().into_iter().map(|s| s.name).collect();
    settings()
        .into_iter()
        .find(|s| s.name == name)
        .unwrap_or_else(|| panic!("no setting {name} among {known:?}"))
}

/// What came out otherwise than the case says, one a line.
fn surprises(verdicts: &[Verdict]) -> String {
    verdicts
        .iter()
        .filter(|v| !v.status.as_expected())
        .map(|v| {
            format!(
                "{} on {}: {}: law {}: expected {} {}, got {:?}, tolerance {} {}\n",
                v.id,
                v.setting,
                v.status.words(),
                v.law,
                v.expected,
                v.unit,
                v.got,
                v.tolerance,
                v.note.as_deref().unwrap_or_default()
            )
        })
        .collect()
}

/// Runs every case on some settings, and expects what the case says of each.
fn comes_out(settings: Vec<Setting>) {
    let verdicts = run_suite(
        &SuiteOptions {
            cases: builtin().expect("the built-in cases are sound"),
            settings,
            out: None,
            jobs: std::thread::available_parallelism().map_or(1, usize::from),
            cancel: Arc::new(AtomicBool::new(false)),
            progress: Arc::new(Silent),
        },
        &pluvia::world::create,
    )
    .expect("the suite runs");
    let surprises = surprises(&verdicts);
    assert!(surprises.is_empty(), "cases that came out otherwise than they say:\n{surprises}");
    for verdict in &verdicts {
        let said = verdict.remarks();
        let is_so = !said.contains("by the law");
        assert!(is_so, "law: {} speaks of the analytical solution, got `{said}`", verdict.id);
    }
}

/// The native contacts at the default rate, in the precision that is linked; and all others.
fn by_default() -> (Vec<Setting>, Vec<Setting>) {
    let parts: (Vec<_>, Vec<_>) = settings()
        .into_iter()
        .partition(|s| ["native-480", "native-480-single"].contains(&s.name.as_str()));
    assert_eq!(parts.0.len(), 1, "law: one setting is the default");
    parts
}

#[test]
fn every_case_comes_out_as_it_says_by_default() {
    comes_out(by_default().0);
}

#[test]
#[ignore = "slow: make test-all"]
fn every_case_comes_out_as_it_says_on_every_other_setting() {
    comes_out(by_default().1);
}

/// Settings of rapier, which may be left out of a build.
const RAPIER: [&str; 4] = ["rapier", "rapier-240", "rapier-1000", "rapier-coulomb"];

/// Names of the settings of all builds: of both precisions, with rapier.
fn names_of_all_builds() -> Vec<String> {
    let mut names: Vec<String> = RAPIER.map(str::to_owned).to_vec();
    for Setting { name, .. } in settings() {
        if name.starts_with("rapier") {
            assert!(RAPIER.contains(&name.as_str()), "law: {name} is one of {RAPIER:?}");
        } else {
            let double = name.trim_end_matches("-single");
            names.extend([double.to_owned(), format!("{double}-single")]);
        }
    }
    names
}

#[test]
fn every_known_failure_names_a_setting_that_exists_somewhere() {
    let names = names_of_all_builds();
    for case in builtin().expect("sound") {
        for known in &case.known_failures {
            assert!(
                names.iter().any(|name| known.covers(name)),
                "law: `{}` of {} covers one of {names:?}",
                known.setting,
                case.id
            );
            assert!(known.reason.len() > 20, "{}: the reason must be said", case.id);
        }
    }
    let misspelt = KnownFailure { setting: "stock-241*".to_owned(), reason: String::new() };
    let covered: Vec<&String> = names.iter().filter(|name| misspelt.covers(name)).collect();
    assert!(covered.is_empty(), "law: no setting is called stock-241, got {covered:?}");
}

/// Expects the case to pass with right physics and to fail with the defect,
/// on stock Bullet contacts at the default rate or another one.
fn finds(defect: Defect, id: &str, rate: &str) {
    // Where single precision is linked, names say so.
    let single = settings().iter().any(|s| s.name == "stock-single");
    let name = format!("stock{rate}{}", if single { "-single" } else { "" });
    let (case, setting) = (case(id), setting(&name));
    let right = verify(&case, &setting, &pluvia::world::create);
    assert!(right.pass, "{id} passes with right physics, got {:?} {:?}", right.got, right.note);
    let wrong = verify(&case, &setting, &made_with(defect));
    assert!(
        !wrong.pass,
        "{id} must find {defect:?}: expected to miss {} ± {}, got {:?}",
        wrong.expected, wrong.tolerance, wrong.got
    );
}

#[test]
fn the_inertia_of_the_bounding_box_is_found() {
    finds(Defect::BoundingBoxInertia, "tumbling-momentum", "-960");
}

#[test]
fn friction_as_a_product_is_found() {
    finds(Defect::ProductRule, "slide-pair-friction", "");
}

#[test]
fn a_single_friction_direction_is_found() {
    finds(Defect::OneFrictionDirection, "incline-holds", "");
}

/// What never rebounds obeys "at most e u": no case of an arrested approach may pass for it.
#[test]
fn a_solver_that_never_rebounds_is_found() {
    let setting = by_default().0.remove(0);
    let arrested: Vec<Case> = builtin()
        .expect("sound")
        .into_iter()
        .filter(|c| c.id.starts_with("approach-arrested"))
        .collect();
    assert!(arrested.len() >= 15, "expected the arrested approaches, found {}", arrested.len());
    for case in arrested {
        let wrong = verify(&case, &setting, &made_with(Defect::NoRebound));
        assert!(
            !wrong.pass,
            "{} must find that nothing rebounds: expected to miss {} ± {}, got {:?} {:?}",
            case.id, wrong.expected, wrong.tolerance, wrong.got, wrong.note
        );
    }
}

#[test]
fn a_drifting_solver_is_found() {
    finds(Defect::Drift, "cube-rests", "");
    finds(Defect::Drift, "incline-holds", "");
}
