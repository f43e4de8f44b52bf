//! Tests of targets on runs that share specimens.

use std::fmt::Write;

use super::*;

/// Poured heights of `specimens`, each shaken without and with a ramp; friction 0.1 to 0.1 n.
fn shaken(path: &Path, specimens: u32) -> TargetRuns {
    let mut csv = String::from(
        "run,point,configuration,friction,ramp,poured_height_mm.mean_surface,settlement_mm.final,\
         left_out_of_means,failure\n",
    );
    for ramp in [0_u32, 1] {
        for n in 0..specimens {
            let friction = 0.1 * f64::from(n + 1);
            let own = f64::from(n * n % 5);
            let settled = 10.0 + own - 3.0 * f64::from(ramp) + 0.1 * f64::from(ramp * (n % 3));
            let height = 150.0 + own;
            let height = height + 1e-3 * f64::from(n);
            let _ = writeln!(csv, "r,p,1,{friction},{ramp},{height},{settled},,");
        }
    }
    std::fs::write(path, csv).expect("a table");
    TargetRuns { name: "t".to_owned(), path: path.to_owned() }
}

fn target(text: &str) -> Target {
    text.parse().expect("a target")
}

/// Law: the ramp is judged by paired differences, friction by means of specimens, and intervals of
/// shares count eight specimens, not sixteen runs.
#[test]
fn runs_of_one_pour_are_no_two_specimens() {
    let folder = tempfile::tempdir().expect("a folder");
    let runs = shaken(&folder.path().join("sweep.csv"), 8);
    let found = meet_targets(&[runs], &[target("t:settlement_mm.final=10..20")], &[]);
    let found = found.expect("an answer");
    let of = &found.targets[0];
    assert_eq!((of.runs_counted, of.specimens), (16, 8));
    assert_eq!(of.within_specimens, ["ramp"]);
    let [friction, ramp] = ["friction", "ramp"].map(|name| of.freedom[name]);
    assert!((friction - 6.0).abs() < 1e-9, "law: 8 specimens less 2 terms, got {friction}");
    assert!((ramp - 7.0).abs() < 1e-9, "law: 8 differences less 1, got {ramp}");
    // Differences are −3 with 0, 0.1 and 0.2 for n of 0, 1 and 2 modulo 3.
    let differences: Vec<f64> = (0..8_u32).map(|n| -3.0 + 0.1 * f64::from(n % 3)).collect();
    let mean = differences.iter().sum::<f64>() / 8.0;
    let squares: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum();
    let half = 2.364_624_251_592_785 * (squares / 7.0 / 8.0).sqrt();
    let (change, got) = of.effects["ramp"];
    assert!((change - mean).abs() < 1e-9, "law: expected {mean}, got {change}, tolerance 1e-9");
    assert!((got - half).abs() < 1e-8, "law: expected {half}, got {got}, tolerance 1e-8");
    let expected = wilson_interval(of.runs_meeting as f64 / 16.0, 8);
    assert_eq!(of.share_meeting, expected, "law: eight specimens");
    let points = found.all.points.expect("law: points of one table");
    assert_eq!((points.of, points.independent, points.share), (16, 8, expected));
    let page = found.page().markdown();
    let said = "of ramp by the scatter of differences within specimens, of all others by that";
    assert!(page.contains(said), "law: `{said}` in {page}");
}

/// Law: two specimens do not tell how friction acts, however often they are shaken.
#[test]
fn too_few_specimens_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let runs = shaken(&folder.path().join("sweep.csv"), 2);
    let refused = meet_targets(&[runs], &[target("t:settlement_mm.final=10..20")], &[]);
    let refused = refused.expect_err("law: refused").to_string();
    for said in [
        "4 runs that count and have it, of 2 specimens",
        "between specimens of 1 factor, friction (at least 3 specimens are needed",
        "within them of 1 factor, ramp (at least 4 runs are needed",
    ] {
        assert!(refused.contains(said), "law: `{said}` is said, got `{refused}`");
    }
}

/// A table with so many factors x1, x2, ... from 0 to 1, with y = x1 − the last of them.
fn of_factors(path: &Path, count: usize) -> TargetRuns {
    let names: Vec<String> = (1..=count).map(|n| format!("x{n}")).collect();
    let mut csv = format!(
        "run,point,configuration,{},void_ratio,left_out_of_means,failure\n",
        names.join(",")
    );
    // One factor at each end by itself: the ends of all others are in the middle.
    for n in 0..2 * count {
        let x = |factor: usize| if factor == n / 2 { (n % 2) as f64 } else { 0.5 };
        let cells: Vec<String> = (0..count).map(|factor| x(factor).to_string()).collect();
        let _ = writeln!(csv, "r,p,1,{},{},,", cells.join(","), x(0) - x(count - 1));
    }
    std::fs::write(path, csv).expect("a table");
    TargetRuns { name: "t".to_owned(), path: path.to_owned() }
}

/// Law: of 13 factors the first and the last are searched apart: y = x1 − x13 is wanted where it is
/// met near (1, 0) alone.
#[test]
fn the_thirteenth_factor_is_not_the_first() {
    let folder = tempfile::tempdir().expect("a folder");
    let runs = of_factors(&folder.path().join("sweep.csv"), 13);
    let found = meet_targets(&[runs], &[target("t:void_ratio=0.8..1")], &[]).expect("an answer");
    let (best, at) = (found.all.best, &found.all.at);
    assert!(best > 0.99, "law: certain at (1, 0), got {best}");
    let y = at["x1"] - at["x13"];
    assert!((0.8..=1.0).contains(&y), "law: 0.8 to 1 at the best place, got {y}");
}

/// Law: what no even places are known of is refused.
#[test]
fn more_factors_than_bases_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let runs = of_factors(&folder.path().join("sweep.csv"), 65);
    let refused = meet_targets(&[runs], &[target("t:void_ratio=0.8..1")], &[]);
    let refused = refused.expect_err("law: refused").to_string();
    assert!(refused.contains("65 factors") && refused.contains("at most 64"), "got `{refused}`");
    let runs = of_factors(&folder.path().join("other.csv"), 2);
    let wanted = vec![target("t:void_ratio=0.8..1"); 65];
    let refused = meet_targets(&[runs], &wanted, &[]).expect_err("law: refused").to_string();
    assert!(refused.contains("65 targets"), "got `{refused}`");
}
