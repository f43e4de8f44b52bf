//! The recipes of docs/laboratory.md, each with a few of its grains: what it is there to show.

use std::{
    path::Path,
    sync::{Arc, atomic::AtomicBool},
};

use pluvia::{
    geometry::Vector,
    grains::{generate, load_scenario},
    measure::steady_rate,
    protocol::{Moment, Observer, Setup, opening, run},
    scenario::{GrainsSpec, Override},
    specimen::{Opening, PieceState, Specimen, SpecimenState, centroids},
    units::to_g,
    world,
};

/// What is seen of a stage at a time in s since it began.
struct Sample {
    time: f64,
    pieces: Vec<PieceState>,
    /// Through the first opening since the sample before, in g.
    passed_g: f64,
}

struct Seen {
    opening: Option<Opening>,
    before: Vec<Option<Vector>>,
    samples: Vec<Sample>,
}

impl Observer for Seen {
    fn observe(&mut self, specimen: &Specimen, moment: Moment) {
        let passed = self.opening.map_or(0.0, |mouth| mouth.mass_passed(&self.before, specimen));
        self.before = centroids(specimen);
        self.samples.push(Sample {
            time: moment.stage_time,
            pieces: specimen.state.pieces.clone(),
            passed_g: to_g(passed),
        });
    }
}

/// A recipe that was run.
struct Recipe {
    names: Vec<String>,
    /// The specimen at the end of each stage; rest test last, where there is one.
    ends: Vec<Specimen>,
    /// What was seen of each stage.
    samples: Vec<Vec<Sample>>,
    gravity: f64,
}

impl Recipe {
    /// Runs a shipped scenario with changes as of `--set`.
    fn run(name: &str, changes: &[&str]) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/laboratory");
        let changes: Vec<Override> =
            changes.iter().map(|text| text.parse().expect("a change")).collect();
        let loaded = load_scenario(&folder.join(format!("{name}.json")), &changes);
        let scenario = loaded.unwrap_or_else(|e| panic!("{name}: {e}")).scenario;
        let setup = Setup::new(&scenario).expect("a laboratory");
        let GrainsSpec::Sieved(spec) = &scenario.grains else { panic!("{name}: sieved grains") };
        let grains = Arc::new(generate(spec, scenario.seed).expect("grains"));
        let state = SpecimenState::before_everything(grains.grains.len());
        let mut recipe = Self {
            names: scenario.pieces.iter().map(|piece| piece.name.clone()).collect(),
            ends: vec![Specimen { grains, state }],
            samples: Vec::new(),
            gravity: setup.gravity,
        };
        let rest = pluvia::scenario::StageSpec::Rest { duration_s: scenario.rest_test_s };
        let rest = (scenario.rest_test_s > 0.0).then_some(rest);
        for stage in scenario.stages.iter().chain(&rest) {
            let before = recipe.ends.last().expect("a specimen").clone();
            let opening = setup.measures.openings.first().map(opening);
            let mut seen = Seen { opening, before: centroids(&before), samples: Vec::new() };
            let never = AtomicBool::new(false);
            let make = &world::create;
            let outcome = run(&setup, make, before, stage, None, &mut seen, &never);
            recipe.ends.push(outcome.unwrap_or_else(|e| panic!("{name}: {e}")).specimen);
            recipe.samples.push(seen.samples);
        }
        recipe.ends.remove(0);
        recipe
    }

    fn number(&self, piece: &str) -> usize {
        self.names.iter().position(|name| name == piece).expect("a piece")
    }

    fn end(&self) -> &Specimen {
        self.ends.last().expect("a stage")
    }

    /// Mean of a number of a piece over the samples of a stage from a time in s on.
    fn mean(&self, stage: usize, from: f64, piece: &str, of: impl Fn(&PieceState) -> f64) -> f64 {
        let n = self.number(piece);
        let late = self.samples[stage].iter().filter(|sample| sample.time >= from);
        let values: Vec<f64> = late.map(|sample| of(&sample.pieces[n])).collect();
        assert!(!values.is_empty(), "the check sees samples of stage {stage}");
        values.iter().sum::<f64>() / values.len() as f64
    }

    /// Height in m of a piece at the end of a stage.
    fn height(&self, stage: usize, piece: &str) -> f64 {
        self.ends[stage].state.pieces[self.number(piece)].pose.translation.z
    }

    fn weight(&self) -> f64 {
        let end = self.end();
        end.present().map(|n| end.grains.grains[n].mass).sum::<f64>() * self.gravity
    }

    /// Law: at rest all pieces together carry the weight of all grains.
    fn is_balanced(&self) {
        let end = self.end();
        assert_eq!(end.present().count(), end.grains.grains.len(), "law: no grain is lost");
        let force: Vector = end.state.pieces.iter().map(|piece| piece.force_n).sum();
        let off = (force + Vector::z() * self.weight()).norm() / self.weight();
        assert!(off < 0.01, "law: the weight within 1 %, off by {:.2} %", 100.0 * off);
    }

    /// Mean height in m of the grains that a test takes.
    fn mean_height(of: &Specimen, takes: impl Fn(usize) -> bool) -> f64 {
        let heights: Vec<f64> = of
            .present()
            .filter(|n| takes(*n))
            .map(|n| of.state.bodies[n].body.pose.translation.z)
            .collect();
        heights.iter().sum::<f64>() / heights.len() as f64
    }

    fn passed_g(&self, stage: usize) -> f64 {
        self.samples[stage].iter().map(|sample| sample.passed_g).sum()
    }
}

fn within(what: &str, got: f64, low: f64, high: f64) {
    assert!((low..=high).contains(&got), "law: {what}: {low} to {high}, got {got}");
}

#[test]
fn two_layers_lie_on_each_other_and_the_box_carries_them() {
    let recipe = Recipe::run(
        "box-two-layers",
        &[
            "grains.total_mass_g=90",
            "pieces.0.shape.box.inner_mm=[45,45,140]",
            "stages.0.area_mm=[35,35]",
            "stages.1.area_mm=[35,35]",
            "rest_test_s=0.3",
        ],
    );
    recipe.is_balanced();
    let end = recipe.end();
    let of = |fraction: usize| {
        Recipe::mean_height(end, |n| end.grains.grains[n].fraction == fraction) * 1e3
    };
    let (coarse, fine) = (of(0), of(1));
    within("coarse above fine grains, mm", coarse - fine, 8.0, 40.0);
}

#[test]
fn a_hopper_runs_out_at_a_rate_and_the_box_carries_what_ran_out() {
    let recipe = Recipe::run(
        "hopper",
        &[
            "grains.total_mass_g=100",
            "pieces.0.shape.hopper.collar_mm=40",
            "stages.0.at_mm=[0,0,300]",
            "rest_test_s=0.3",
        ],
    );
    recipe.is_balanced();
    within("all of it runs out, g", recipe.passed_g(1), 99.999, 100.001);
    let flow: Vec<(f64, f64)> = recipe.samples[1].iter().map(|s| (s.time, s.passed_g)).collect();
    within("its rate, g/s", steady_rate(&flow).expect("a flow"), 400.0, 1100.0);
    let carried = -recipe.end().state.pieces[recipe.number("box")].force_n.z;
    within("the box carries it, N", carried / recipe.weight(), 0.99, 1.01);
}

#[test]
fn a_tilted_box_runs_off_into_its_tray() {
    let recipe = Recipe::run(
        "tilting-box",
        &[
            "grains.total_mass_g=80",
            "pieces.0.shape.box.inner_mm=[60,45,80]",
            "pieces.1.at_mm=[35,0,160]",
            "measures.openings.0.at_mm=[30,0,60]",
            "stages.0.area_mm=[50,35]",
            r#"stages.2.rotation={"axis":[0,1,0],"about_mm":[30,0,120],"deg_per_s":20}"#,
            "stages.2.travel_deg=30",
            "rest_test_s=0.3",
        ],
    );
    recipe.is_balanced();
    let ran = (recipe.passed_g(1), recipe.passed_g(2));
    within("grains run off while it tilts, g", ran.1, 1.0, 79.0);
    let tray = -recipe.end().state.pieces[recipe.number("tray")].force_n.z / recipe.gravity * 1e3;
    within("the tray has what ran off, g", tray / (ran.0 + ran.1), 0.97, 1.03);
}

#[test]
fn grains_in_a_turning_drum_lie_off_its_axis() {
    let recipe = Recipe::run(
        "rotating-drum",
        &[
            "grains.total_mass_g=60",
            "pieces.0.shape.drum.length_mm=25",
            "stages.0.area_mm=[90,20]",
            "stages.0.rate_g_per_s=200",
            "stages.1.duration_s=2",
            "rest_test_s=0",
        ],
    );
    let moment = recipe.mean(1, 1.2, "drum", |piece| piece.moment_n_m.y);
    let arm = moment / recipe.weight() * 1e3;
    within("against the turn, mm off the axis", arm, -70.0, -15.0);
}

#[test]
fn a_column_collapses_when_its_tube_is_lifted() {
    let recipe = Recipe::run(
        "column-collapse",
        &[
            "grains.total_mass_g=80",
            "pieces.1.shape.cylinder.inner_diameter_mm=45",
            "stages.0.diameter_mm=40",
            "rest_test_s=0.3",
        ],
    );
    recipe.is_balanced();
    let far = |of: &Specimen| {
        let away = |n: usize| of.state.bodies[n].body.pose.translation.vector.xy().norm() * 1e3;
        let mut all: Vec<f64> = of.present().map(away).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() * 95 / 100]
    };
    within("within the tube before, mm", far(&recipe.ends[0]), 10.0, 22.5);
    within("beyond it after, mm", far(recipe.end()), 30.0, 150.0);
    let height = |of: &Specimen| Recipe::mean_height(of, |_| true);
    within("lower than before", height(recipe.end()) / height(&recipe.ends[0]), 0.1, 0.8);
}

#[test]
fn vertical_vibration_makes_grains_denser() {
    let recipe = Recipe::run(
        "vertical-vibration",
        &[
            "grains.total_mass_g=80",
            "pieces.0.shape.cylinder.inner_diameter_mm=45",
            "stages.0.diameter_mm=40",
            "stages.1.duration_s=1",
            "rest_test_s=0.3",
        ],
    );
    recipe.is_balanced();
    let height = |stage: usize| Recipe::mean_height(&recipe.ends[stage], |_| true) * 1e3;
    within("the grains sink, mm", height(0) - height(1), 0.2, 10.0);
}

#[test]
fn a_lid_under_load_follows_the_grains_that_are_shaken() {
    let recipe = Recipe::run(
        "vibration-under-load",
        &[
            "grains.total_mass_g=70",
            "pieces.0.shape.cylinder.inner_diameter_mm=45",
            "pieces.1.shape.disc.diameter_mm=44",
            "stages.0.diameter_mm=35",
            "stages.1.travel_mm=110",
            "stages.3.duration_s=2.4",
            "rest_test_s=0.3",
        ],
    );
    let sunk = (recipe.height(2, "lid") - recipe.height(3, "lid")) * 1e3;
    within("the lid sinks while it is shaken, mm", sunk, 0.1, 30.0);
    let load = 13.8e3 * std::f64::consts::PI * 0.022 * 0.022;
    let force = recipe.end().state.pieces[recipe.number("lid")].force_n.z;
    within("and bears the stress at rest", force / load, 0.98, 1.02);
}

#[test]
fn an_oedometer_settles_under_load_and_springs_back_by_less() {
    let press =
        |kpa: f64| format!(r#"{{"stage":"press","loads":[{{"piece":"lid","stress_kpa":{kpa}}}]}}"#);
    let stages = format!(
        r#"stages=[{{"stage":"deposit","at_mm":[0,0,130],"diameter_mm":35,"rate_g_per_s":250}},
           {{"stage":"move","pieces":["lid"],"velocity_mm_per_s":[0,0,-200],"travel_mm":100,
             "ramp_s":0.05}},{},{},{}]"#,
        press(12.5),
        press(100.0),
        press(12.5)
    );
    let recipe = Recipe::run(
        "oedometer",
        &[
            "grains.total_mass_g=60",
            "pieces.0.shape.cylinder.inner_diameter_mm=45",
            "pieces.1.shape.disc.diameter_mm=44",
            &stages,
            "rest_test_s=0.3",
        ],
    );
    let [first, loaded, unloaded] = [2, 3, 4].map(|stage| recipe.height(stage, "lid") * 1e3);
    within("settlement from 12.5 to 100 kPa, mm", first - loaded, 0.05, 10.0);
    within("it springs back by less", (unloaded - loaded) / (first - loaded), 0.0, 0.9);
    let load = 12.5e3 * std::f64::consts::PI * 0.022 * 0.022;
    let cell = -recipe.end().state.pieces[recipe.number("cell")].force_n.z;
    within("the cell carries load and grains", cell / (load + recipe.weight()), 0.98, 1.02);
}

#[test]
#[ignore = "slow: make test-all"]
fn grains_lie_still_under_a_lid_that_bears_a_thousand_times_their_weight() {
    let stages = r#"stages=[
        {"stage":"deposit","at_mm":[0,0,100],"diameter_mm":65,"rate_g_per_s":600},
        {"stage":"move","pieces":["lid"],"velocity_mm_per_s":[0,0,-200],"travel_mm":60,"ramp_s":0.05},
        {"stage":"press","loads":[{"piece":"lid","stress_kpa":200}]},
        {"stage":"rest","duration_s":0.3}]"#;
    let recipe = Recipe::run(
        "oedometer",
        &[
            "grains.total_mass_g=300",
            "pieces.0.shape.cylinder.inner_diameter_mm=85",
            "pieces.1.shape.disc.diameter_mm=84",
            stages,
            "rest_test_s=0",
        ],
    );
    // Where the load on the lid counts in what iterations may leave, it sinks by 0.3 mm.
    let sunk = (recipe.height(2, "lid") - recipe.height(3, "lid")) * 1e3;
    within("a lid that has settled sinks in 0.3 s, mm", sunk, -0.02, 0.02);
}

#[test]
#[ignore = "slow: make test-all"]
fn a_sheared_box_resists() {
    let recipe = Recipe::run(
        "direct-shear",
        &[
            "grains.total_mass_g=100",
            "pieces.0.shape.box.inner_mm=[45,45,20]",
            "pieces.1.shape.box.inner_mm=[45,45,70]",
            "pieces.1.at_mm=[0,0,20.5]",
            "pieces.2.shape.plate.size_mm=[44,44,10]",
            "stages.0.area_mm=[35,35]",
            "stages.3.velocity_mm_per_s=[8,0,0]",
            "stages.3.travel_mm=4",
            "stages.3.settle_limit_s=0",
            "rest_test_s=0",
        ],
    );
    let load = 50e3 * 0.044 * 0.044;
    let lid = recipe.mean(3, 0.3, "lid", |piece| piece.force_n.z);
    within("the lid bears its stress", lid / load, 0.9, 1.1);
    let shear = recipe.mean(3, 0.3, "upper", |piece| piece.force_n.x);
    within("the upper half is dragged along, stress ratio", shear / load, 0.2, 4.0);
    // The lid does not go aside, and grains below it drag at it, too.
    let held = shear + recipe.mean(3, 0.3, "lid", |piece| piece.force_n.x);
    let drawn = recipe.mean(3, 0.3, "lower", |piece| piece.force_n.x);
    within("the lower half is held back as much", -drawn / held, 0.9, 1.1);
}

#[test]
#[ignore = "slow: make test-all"]
fn a_footing_comes_to_rest_on_its_bed_and_bears_more_the_deeper_it_is() {
    let recipe = Recipe::run(
        "footing",
        &[
            // So wide that the block lies on grains alone, however it tilts.
            "grains.total_mass_g=240",
            "pieces.0.shape.box.inner_mm=[60,60,120]",
            "pieces.1.shape.plate.size_mm=[20,40,20]",
            "stages.0.area_mm=[50,50]",
            "stages.1.mass_g=130",
            "stages.2.loads.0.force_n=60",
            r#"stages.2.until=[{"piece":"block","moved_mm":6},
                {"piece":"block","direction":[0,0,1],"force_n":58}]"#,
            "rest_test_s=0",
        ],
    );
    let block = recipe.number("block");
    let free = &recipe.ends[1].state.pieces;
    let weight = 0.13 * recipe.gravity;
    let moving = free[block].free.expect("let go").body.linear_velocity.norm();
    within("at rest, m/s", moving, 0.0, 0.01);
    within("the bed carries it", free[block].force_n.z / weight, 0.97, 1.03);
    let all: Vector = free.iter().map(|piece| piece.force_n).sum();
    within("the box carries all", -all.z / recipe.weight(), 0.98, 1.02);
    within("it fell onto the bed, mm", 110.0 - recipe.height(1, "block") * 1e3, 5.0, 60.0);
    let last = &recipe.ends[2].state.pieces[block];
    let press = last.press.expect("pressed");
    assert!(last.free.is_none(), "law: what is pressed is not free");
    within("the bed bears more than its weight, N", press.force_n, 3.0 * weight, 60.0);
    let sunk = (recipe.height(1, "block") - recipe.height(2, "block")) * 1e3;
    within("it settles by mm", sunk, 0.05, 8.0);
}

#[test]
#[ignore = "slow: make test-all"]
fn a_vane_is_turned_by_a_moment_until_its_bed_fails() {
    let recipe = Recipe::run(
        "vane",
        &[
            "grains.total_mass_g=250",
            "contact.grain_grain_friction=0.3",
            "pieces.0.shape.cylinder.inner_diameter_mm=80",
            "pieces.1.shape.vane.diameter_mm=20",
            "pieces.1.shape.vane.height_mm=20",
            "pieces.1.at_mm=[0,0,25]",
            "stages.0.diameter_mm=70",
            "rest_test_s=0.2",
        ],
    );
    recipe.is_balanced();
    let vane = recipe.number("vane");
    let turned = |stage: usize| {
        let press = recipe.ends[stage].state.pieces[vane].press.expect("pressed");
        press.turns.expect("by a moment").turned_rad.to_degrees()
    };
    within("it has turned, degrees", turned(1), 45.0, 60.0);
    let most = recipe.samples[1]
        .iter()
        .filter_map(|sample| Some(sample.pieces[vane].press?.force_n))
        .fold(0.0, f64::max);
    within("its strength, below the moment that was wanted, N m", most, 0.002, 0.49);
}
