//! What is measured of a laboratory, against laws of a specimen at rest, and figures of any of it.

use std::{path::Path, sync::OnceLock};

use serde_json::{Value, json};

use super::{
    interruption, near,
    program::{self, Folder, assert_holds, done, refused, words},
    small,
};

const GRAVITY: f64 = 9.81;

/// Grains between smooth walls on a rough floor, lifted by 20 mm.
fn scenario() -> Value {
    json!({
        "name": "measured",
        "grains": small::fine(100.0),
        "pieces": [
            { "name": "floor", "shape": { "plate": { "size_mm": [80, 80, 10] } }, "at_mm": [0, 0, -5] },
            { "name": "walls", "friction": 0,
              "shape": { "box": { "inner_mm": [50, 50, 150], "open": ["bottom", "top"] } } }
        ],
        "stages": [
            { "stage": "deposit", "at_mm": [0, 0, 20], "area_mm": [50, 50], "how": "lattice" },
            { "stage": "move", "velocity_mm_per_s": [0, 0, 50], "travel_mm": 20, "ramp_s": 0.1,
              "settle_limit_s": 3 }
        ],
        "measures": {
            "regions": [
                { "name": "all", "low_mm": [-26, -26, 19], "high_mm": [26, 26, 119] },
                { "name": "layer", "low_mm": [-26, -26, 23], "high_mm": [26, 26, 33] }
            ],
            "groups": [{ "name": "both", "pieces": ["floor", "walls"] }]
        },
        "index_densities": { "e_max": 1.2, "e_min": 0.6 },
        "rest_test_s": 1.0
    })
}

/// The folder that holds the run in `out`, made once.
fn finished() -> &'static Folder {
    static RUN: OnceLock<Folder> = OnceLock::new();
    RUN.get_or_init(|| {
        let folder = Folder::new();
        let file = folder.scenario("measured.json", &scenario());
        done(&["run", &file, "--out", &folder.out("out"), "--quiet", "--no-figures"]);
        folder
    })
}

fn summary() -> Value {
    finished().json("out/summary.json")
}

/// A column of a table of the run.
fn column(table: &str, name: &str) -> Vec<f64> {
    program::column(&finished().path("out").join(table), name)
}

/// Law: empty space above the grains is no void between them; a region within them has a relative
/// density, (e_max − e)/(e_max − e_min).
#[test]
fn a_region_above_the_grains_has_no_relative_density() {
    let summary = summary();
    let regions = &summary["laboratory"]["regions"];
    let (e, got) = (number(regions, "/1/void_ratio"), number(regions, "/1/relative_density"));
    let expected = (1.2 - e) / 0.6;
    assert!((got - expected).abs() < 1e-12, "law: of the layer {expected}, got {got}");
    assert!(regions[0]["relative_density"].is_null(), "law: `all` reaches above the grains");
    assert!(summary["relative_density"].is_null(), "law: no void ratio of the whole, and so none");
    let withheld: Vec<&Value> = summary["withheld"].as_array().expect("a list").iter().collect();
    let told = |w: &&&Value| w["field"] == "laboratory.regions.all.relative_density";
    let told = withheld.iter().filter(told).count();
    assert_eq!(told, 1, "law: it is said why, got {withheld:?}");
}

fn number(value: &Value, pointer: &str) -> f64 {
    let found = value.pointer(pointer).and_then(Value::as_f64);
    found.unwrap_or_else(|| panic!("there is a number at {pointer}"))
}

#[track_caller]
fn near(law: &str, expected: f64, got: f64, share: f64) {
    near::near(law, got, expected, share * expected.abs());
}

/// Law: between smooth walls the vertical force at every height is the weight of what lies above;
/// the region of all grains holds Σ m g (z − floor), a layer its part of that. To 1 %, at rest.
#[test]
fn stresses_close_with_the_weight_above() {
    let summary = summary();
    let masses: Vec<f64> = column("grains.csv", "mass_g").iter().map(|g| g * 1e-3).collect();
    let heights: Vec<f64> = column("grains.csv", "z_mm").iter().map(|z| z * 1e-3).collect();
    for (n, low, high) in [(0, 0.019, 0.119), (1, 0.023, 0.033)] {
        let floor = 0.02_f64;
        let area = 0.052 * 0.052;
        // The weight of a grain is borne from the floor up to its centroid.
        let borne = |z: f64| (z.min(high) - floor.max(low)).max(0.0);
        let force_times_height: f64 =
            masses.iter().zip(&heights).map(|(m, z)| m * GRAVITY * borne(*z)).sum();
        let expected = 1e-3 * force_times_height / (area * (high - low));
        let region = format!("/laboratory/regions/{n}/stress");
        let got = number(&summary, &format!("{region}/tensor_kpa/2/2"));
        near("σzz in kPa at the end of the rest test", expected, got, 0.01);
        let name = ["all", "layer"][n];
        let series = column("rest_test.csv", &format!("{name}_stress_zz_kpa"));
        near("σzz in kPa in the last row", expected, *series.last().expect("rows"), 0.01);
        assert!(number(&summary, &format!("{region}/mean_kpa")) > 0.0, "law: pressed");
    }
    let all = number(&summary, "/laboratory/regions/0/stress/asymmetry_percent");
    assert!(all < 1.0, "law: moments of whole grains at rest are balanced, got {all} %");
}

#[test]
fn groups_carry_what_their_pieces_carry() {
    let summary = summary();
    let force =
        |list: &str, n: usize| number(&summary, &format!("/laboratory/{list}/{n}/force_n/2"));
    let (both, floor, walls) = (force("groups", 0), force("pieces", 0), force("pieces", 1));
    near("force on the group in N", floor + walls, both, 1e-9);
    near(
        "force on all pieces is the weight in N",
        -number(&summary, "/laboratory/balance/weight_n"),
        both,
        0.01,
    );
    near("smooth walls carry nothing: of N", both, floor, 0.01);
    let last = |name: &str| *column("rest_test.csv", name).last().expect("rows");
    near(
        "column of a group in N",
        last("floor_force_z_n") + last("walls_force_z_n"),
        last("both_force_z_n"),
        1e-9,
    );
}

/// Law: lifting everything slowly by h costs m g h; what is put in is stored or dissipated.
#[test]
fn lifting_costs_what_it_should_and_energies_balance() {
    let summary = summary();
    let mass: f64 = column("grains.csv", "mass_g").iter().map(|g| g * 1e-3).sum();
    assert_eq!(summary["stages"][1]["stage"], json!("move"));
    let put_in = number(&summary, "/stages/1/energy/work_input_j");
    near("work of lifting by 20 mm in J", mass * GRAVITY * 0.02, put_in, 0.02);
    let potential = |n: usize| number(&summary, &format!("/stages/{n}/energy/potential_energy_j"));
    let kinetic = number(&summary, "/stages/0/energy/kinetic_energy_j");
    let lost = number(&summary, "/stages/1/energy/dissipated_j");
    let stored = potential(1) - potential(0) - kinetic;
    near("what is put in is stored or lost, J", put_in, stored + lost, 1e-3);
    let heights = column("grains.csv", "z_mm");
    let masses = column("grains.csv", "mass_g");
    let expected: f64 = heights.iter().zip(&masses).map(|(z, m)| 1e-6 * z * m * GRAVITY).sum();
    near("m g z in J", expected, potential(1), 1e-6);
    assert!(number(&summary, "/stages/0/energy/dissipated_j") > 0.0, "law: a fall ends in impacts");
    assert_eq!(number(&summary, "/stages/0/energy/work_input_j"), 0.0, "law: nothing moved");
    let turned = number(&summary, "/stages/1/rotation/max_deg");
    assert!((0.0..180.0).contains(&turned), "law: an angle, got {turned}");
    let largest = column("grains.csv", "turned_deg").iter().copied().fold(0.0, f64::max);
    near("turned_deg of the grain that turned most", turned, largest, 1e-9);
}

#[test]
fn contacts_and_voids_are_counted_whole() {
    let summary = summary();
    let grains = number(&summary, "/grains/count");
    let list = |pointer: &str| -> Vec<f64> {
        let list = summary.pointer(pointer).and_then(Value::as_array).expect("a list");
        list.iter().map(|n| n.as_f64().expect("a number")).collect()
    };
    let distribution = list("/coordination_distribution");
    near("every grain is counted once", grains, distribution.iter().sum(), 1e-12);
    let touched: f64 = distribution.iter().enumerate().map(|(n, count)| n as f64 * count).sum();
    near("its mean", number(&summary, "/coordination_number"), touched / grains, 1e-9);
    let classes = list("/contacts/normal_force/classes_percent");
    near("every contact has a class, in %", 100.0, classes.iter().sum(), 1e-9);
    assert!(number(&summary, "/contacts/between_grains") > grains / 2.0);
    assert!((0.0..=100.0).contains(&number(&summary, "/contacts/sliding_percent")));
    let shares: f64 = column("distributions.csv", "share_percent").iter().sum();
    near("both distributions are whole, in %", 200.0, shares, 1e-9);
    let fabric = list("/contacts/fabric/principal");
    near("trace of the fabric", 1.0, fabric.iter().sum(), 1e-9);
    // All grains lie in the first region; its layers hold all of them.
    let layers = column("void_profile.csv", "solids_mm3");
    let of_layer =
        column("void_profile.csv", "to_mm").iter().position(|z| *z > 118.9).expect("all");
    let solids: f64 = layers[..=of_layer].iter().sum();
    near("solids in mm³", 1e3 * number(&summary, "/grains/solids_volume_cm3"), solids, 1e-4);
}

/// `pluvia plot` of a run, with what else is typed.
fn plot<'a>(run: &'a str, line: &'a str) -> Vec<&'a str> {
    [&["plot", run][..], &words(line)].concat()
}

#[test]
fn any_columns_can_be_drawn_and_others_are_refused_with_the_nearest() {
    let run = finished().out("out");
    let folder = Folder::new();
    let (svg, png) = (folder.out("a/forces.svg"), folder.out("profile.png"));
    let forces = "--x time_s --y floor_force_z_n,both_force_z_n,all_void_ratio";
    let forces = [plot(&run, forces), vec!["--out", &*svg]].concat();
    done(&forces);
    let titles = ["Time (s)", "Force z (N)", "All void ratio", "Floor force z"];
    assert_holds(&folder.text("a/forces.svg"), &titles);
    assert_holds(&folder.text("a/forces.svg"), &["Beginning of a stage"]);
    refused(&forces, 2, &["--force"]);
    done(&[&forces[..], &["--force"]].concat());
    let profile =
        "--file void_profile --where of=layer --where by=height --x void_ratio --y middle_mm --out";
    done(&[plot(&run, profile), vec![&*png]].concat());
    assert_eq!(folder.bytes("profile.png")[1..4], *b"PNG");
    let rest = folder.out("rest.svg");
    let at_rest = "--stage rest_test --x all_stress_xx_kpa --y all_stress_zz_kpa --out";
    done(&[plot(&run, at_rest), vec![&*rest]].concat());
    let cases: [(&str, &[&str]); 11] = [
        (
            "--x tine_s --y box_n,floor_force_z",
            &[
                "--x tine_s",
                "did you mean `time_s`",
                "--y box_n",
                "--y floor_force_z",
                "`floor_force_z_n`",
                "There are: time_s, stage",
            ],
        ),
        (
            "--x time_s --y all_void_ratio --stage shake",
            &["no such stage", "0 deposit, 1 move", "rest_test"],
        ),
        (
            "--x time_s --y all_void_ratio --stage control",
            &["no such stage (now called `rest_test`)"],
        ),
        ("--x time_s --y all_void_ratio --out x.pdf", &[".svg or .png"]),
        (
            "--x tine_s --y stage --stage shake --where by=radius --out x.pdf",
            &["--stage shake", "--where by=radius", ".svg or .png", "--x tine_s"],
        ),
        ("--file grain --x x_mm --y z_mm", &["no table `grain`", "grains, rest_test, series"]),
        (
            "--file control --x time_s --y all_void_ratio",
            &["no table `control` (now called `rest_test`)"],
        ),
        ("--file ../out/series --x time_s --y stage", &["no table"]),
        ("--file grains --x x_mm --y fate", &["--y fate", "it holds text, such as `present`"]),
        (
            "--file grains --where fate=lost --x x_mm --y z_mm",
            &["fate=lost: no row has it; there are present"],
        ),
        ("--x time_s --y plate_height_mm", &["--y plate_height_mm", "empty"]),
    ];
    for (line, words) in cases {
        let out = if line.contains("--out") { "" } else { "--out x.svg" };
        refused(&plot(&run, &format!("{line} {out}")), 2, words);
    }
    let empty = ["plot", &run, "--x", "time_s", "--y", "stage,,time_s", "--out", "x.svg"];
    refused(&empty, 2, &["--y", "name of a column is missing"]);
    assert!(!Path::new("x.svg").exists(), "law: nothing is written");
    let spaced = folder.out("spaced.svg");
    let names = "floor_force_z_n, both_force_z_n";
    done(&["plot", &run, "--x", "time_s", "--y", names, "--out", &spaced]);
    let listed: Value = serde_json::from_str(&done(&plot(&run, "--list --json"))).expect("JSON");
    let columns = listed["columns"].as_array().expect("columns");
    let time = columns.iter().find(|c| c["name"] == "time_s").expect("time_s");
    assert_eq!(time["smallest"], json!(0.0), "law: the range of a column");
    assert_holds(&done(&plot(&run, "--list")), &["floor_force_z_n"]);
    let one = done(&plot(&run, "--file grains --where grain=grain_00000 --list"));
    assert_holds(&one, &["grains.csv, 1 row\n"]);
}

#[test]
fn groups_that_make_no_sense_are_refused_with_the_field() {
    let folder = Folder::new();
    for (groups, words) in [
        (json!([{ "name": "floor", "pieces": ["floor"] }]), "measures.groups[0].name: a piece has"),
        (json!([{ "name": "table", "pieces": ["floor"] }]), "measures.groups[0].name: columns of"),
        (json!([{ "name": "a", "pieces": ["flor"] }]), "measures.groups[0].pieces[0]"),
        (
            json!([{ "name": "a", "pieces": ["floor", "floor"] }]),
            "group already (found \"floor\"; allowed: each piece once)",
        ),
        (json!([{ "name": "a", "pieces": [] }]), "measures.groups[0].pieces"),
        (json!([{ "name": "all", "pieces": ["floor"] }]), "measures.groups[0].name: a region"),
    ] {
        let mut value = scenario();
        value["measures"]["groups"] = groups;
        let file = folder.scenario("s.json", &value);
        refused(&["run", &file, "--out", &folder.out("out")], 2, &[words]);
    }
    let mut value = scenario();
    value["measures"]["regions"][1]["name"] = json!("walls");
    let file = folder.scenario("s.json", &value);
    let words = ["measures.regions[1].name: a piece has this name", "found \"walls\""];
    refused(&["run", &file, "--out", &folder.out("out")], 2, &words);
}

/// Law: at rest the cylinder carries the grains and the plate.
#[test]
fn the_built_in_cylinder_carries_the_weight() {
    let summary = program::json(&interruption::finished().join("summary.json"));
    let weight = number(&summary, "/contacts/balance/weight_n");
    let grains = number(&summary, "/grains/mass_in_cylinder_g") * 1e-3 * GRAVITY;
    assert!(weight > grains, "law: grains and plate, {weight} N of {grains} N");
    near("carried in N", weight, number(&summary, "/contacts/balance/carried_n"), 0.01);
    assert!(number(&summary, "/contacts/balance/sideways_n") < 0.01 * weight, "law: nothing pulls");
}

/// Law: what friction and impacts have taken does not come back, however the table moves, starts
/// and stops; the work of the table is what it lets the contacts take and what lifts the grains.
#[test]
fn a_table_gives_and_contacts_take() {
    let series = interruption::finished().join("series.csv");
    let names = ["stage", "dissipated_j", "work_input_j", "table_x_mm"];
    let [stage, dissipated, put_in, x] = names.map(|name| program::column(&series, name));
    let rows: Vec<[f64; 4]> =
        (0..stage.len()).map(|n| [stage[n], dissipated[n], put_in[n], x[n]]).collect();
    assert!(rows.iter().flatten().all(|cell| cell.is_finite()), "law: every cell has a number");
    let shaken = rows.iter().filter(|row| row[3].abs() > 1.0).count();
    assert!(shaken > 3, "law: the table moved in some rows, got {shaken}");
    for pair in rows.windows(2).filter(|pair| pair[0][0] == pair[1][0]) {
        let of_stage = rows.iter().filter(|row| row[0] == pair[0][0]);
        let all = of_stage.map(|row| row[1]).fold(0.0, f64::max);
        let fall = pair[0][1] - pair[1][1];
        assert!(fall <= 0.01 * all, "law: of {all} J dissipated {fall} J came back in {pair:?}");
    }
    let put_in =
        |stage: f64| rows.iter().filter(|r| r[0] == stage).map(|r| r[2]).fold(0.0, f64::max);
    let last = rows.last().expect("rows")[0];
    assert!(put_in(last) > 0.0, "law: shaking puts energy in");
    assert_eq!(put_in(0.0), 0.0, "law: nothing moves while the funnel is filled");
}
