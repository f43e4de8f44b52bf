//! Triaxial compression of a loose and a dense specimen at constant mean stress, and whether both
//! come to one state.

use pluvia::{
    report::{Axis, Chart, Look, Plot},
    units::{from_kpa, from_mm, to_kpa},
};
use serde_json::json;

use super::{
    bench::{Bench, Point, Run},
    row::{Found, Row},
    standard_tests::{
        CriticalState, Triaxial, angle_of_ratio, critical_state, inertial_number, peak_ratio,
    },
};

const SPECIMEN: &str = "scenarios/validation/triaxial-specimen.json";
const SCENARIO: &str = "scenarios/validation/triaxial-mean-stress.json";
/// Friction between grains while they are sheared, and while each kind of specimen is made.
const FRICTION: f64 = 0.5;
const KINDS: [(&str, f64); 2] = [("loose", FRICTION), ("dense", 0.05)];
/// Time in s that a specimen has at rest with its new friction, before it is sheared.
const REST: f64 = 0.2;
/// Time in s over which the mean stress is smoothed and restored: see the scenario's notes.
const WINDOW: f64 = 0.05;
/// Time in s in which the top plate comes to its full speed, likewise.
const RAMP: f64 = 0.4;
/// Plates whose forces keep it.
const SIDES: [&str; 4] = ["west", "east", "south", "north"];
/// Stress in kPa from all sides.
const STRESS: f64 = 10.0;
/// How far the top plate goes, in widths of the cube, and axial strain from which on is the end.
const TRAVEL: f64 = 0.32;
const END: f64 = 0.20;
/// How far it goes in a second.
const RATE: f64 = 0.20;
/// Moments that count together as the peak.
const TOGETHER: usize = 3;
/// Mean equivalent diameter of the grains in mm, and density of the solids in kg/m³.
const SIZE_MM: f64 = 9.0;
const SOLIDS: f64 = 2650.0;
/// Width in mm of the compressed cube of the scenario, and of the full design.
const SIDE_MM: f64 = 66.0;
const WIDE_MM: f64 = 132.0;
/// Width in which it is poured, over that.
const POURED: f64 = 72.0 / 66.0;

/// A specimen that was sheared.
struct Test {
    /// Number of its kind.
    kind: usize,
    configuration: u32,
    moments: Vec<Triaxial>,
    end: CriticalState,
    peak: f64,
}

/// Runs the test.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let side = if bench.is_small() { SIDE_MM } else { WIDE_MM };
    let changes = |friction: f64| {
        let mut changes = if bench.is_small() { Vec::new() } else { wide() };
        changes.push(format!("contact.grain_grain_friction={friction}"));
        changes
    };
    let made: Vec<Point> = KINDS
        .iter()
        .map(|(name, friction)| {
            let mut changes = changes(*friction);
            if !bench.is_small() {
                changes.extend(wide_stages());
            }
            Point { name: (*name).to_owned(), changes, most: None }
        })
        .collect();
    let specimens = bench.run("triaxial-specimen", SPECIMEN, &made)?;
    // A point for each specimen, which all have the same friction from then on.
    let points = specimens.iter().map(|run| {
        let folder = run.folder.canonicalize().map_err(|e| e.to_string())?;
        let stages = json!([
            { "stage": "rest", "duration_s": REST },
            { "stage": "move", "pieces": ["top"], "velocity_mm_per_s": [0, 0, -RATE * side],
              "travel_mm": TRAVEL * side, "ramp_s": RAMP,
              "keep_mean_stress": { "region": "core", "pieces": SIDES, "window_s": WINDOW } },
        ]);
        let mut changes = changes(FRICTION);
        changes.push(format!("begin.specimen={}", folder.display()));
        changes.push(format!("stages={stages}"));
        let name = format!("{}-{}", KINDS[run.point].0, run.configuration);
        Ok(Point { name, changes, most: Some(1) })
    });
    let points: Vec<Point> = points.collect::<Result<_, String>>()?;
    let mut tests = Vec::new();
    for run in bench.run("triaxial", SCENARIO, &points)? {
        let specimen = &specimens[run.point];
        let moments = moments(&run)?;
        match critical_state(&moments, END).zip(peak_ratio(&moments, TOGETHER)) {
            Some((end, peak)) => {
                let (kind, configuration) = (specimen.point, specimen.configuration);
                tests.push(Test { kind, configuration, moments, end, peak });
            }
            None => eprintln!("{}: not sheared", run.folder.display()),
        }
    }
    let rows = rows(bench, &tests, side);
    Ok(Found { rows, charts: vec![chart(&tests), path(&tests)] })
}

/// The cube of the full design.
fn wide() -> Vec<String> {
    let (side, out) = (WIDE_MM, POURED * WIDE_MM / 2.0 + 10.0);
    let wide = WIDE_MM + 90.0;
    let high = 225.0;
    let core = 0.3 * side;
    vec![
        format!("grains.total_mass_g={}", (430.0 * (side / SIDE_MM).powi(3)).round()),
        format!("pieces.0.shape.plate.size_mm=[{wide},{wide},20]"),
        format!("pieces.1.shape.plate.size_mm=[20,{wide},{high}]"),
        format!("pieces.1.at_mm=[-{out},0,{}]", high / 2.0),
        format!("pieces.2.shape.plate.size_mm=[20,{wide},{high}]"),
        format!("pieces.2.at_mm=[{out},0,{}]", high / 2.0),
        format!("pieces.3.shape.plate.size_mm=[{wide},20,{high}]"),
        format!("pieces.3.at_mm=[0,-{out},{}]", high / 2.0),
        format!("pieces.4.shape.plate.size_mm=[{wide},20,{high}]"),
        format!("pieces.4.at_mm=[0,{out},{}]", high / 2.0),
        format!("pieces.5.shape.plate.size_mm=[{wide},{wide},20]"),
        format!("pieces.5.at_mm=[0,0,{}]", high + 40.0),
        format!("measures.regions.0.low_mm=[-{core},-{core},{}]", 0.18 * side),
        format!("measures.regions.0.high_mm=[{core},{core},{}]", 0.55 * side),
    ]
}

/// How it is filled and pressed.
fn wide_stages() -> Vec<String> {
    let force = from_kpa(STRESS) * from_mm(WIDE_MM).powi(2);
    let mut changes = vec![
        "stages.0.at_mm=[0,0,215]".to_owned(),
        format!("stages.0.area_mm=[{0},{0}]", POURED * WIDE_MM - 12.0),
        "stages.0.rate_g_per_s=1800".to_owned(),
        "stages.0.time_limit_s=10".to_owned(),
        "stages.1.travel_mm=90".to_owned(),
    ];
    changes.extend((0..5).map(|n| format!("stages.2.loads.{n}.force_n={force}")));
    changes
}

fn moments(run: &Run) -> Result<Vec<Triaxial>, String> {
    let rows = run.series([
        "stage",
        "top_z_mm",
        "core_stress_xx_kpa",
        "core_stress_yy_kpa",
        "core_stress_zz_kpa",
        "core_void_ratio",
        "time_s",
    ])?;
    // The lower side of the top plate, which is 20 mm thick.
    let height = |row: &[f64; 7]| row[1] - 10.0;
    // Less than half as fast, the plate lets the deviator go.
    let end = rows.last().map_or(0.0, |row| row[6]) - RAMP / 2.0;
    let is_sheared = |row: &&[f64; 7]| row[0] == 1.0 && row[6] <= end;
    let sheared: Vec<&[f64; 7]> = rows.iter().filter(is_sheared).collect();
    let Some(first) = sheared.first().map(|row| height(row)) else { return Ok(Vec::new()) };
    let moment = |row: &&[f64; 7]| Triaxial {
        strain: 1.0 - height(row) / first,
        stress: [row[2], row[3], row[4]].map(from_kpa),
        void_ratio: row[5],
    };
    Ok(sheared.iter().map(moment).filter(|m| m.ratio().is_finite()).collect())
}

/// What is read of a test.
type Read = fn(&Test) -> f64;

fn rows(bench: &Bench, tests: &[Test], side: f64) -> Vec<Row> {
    let values = |kind: usize, of: Read| -> Vec<f64> {
        tests.iter().filter(|test| test.kind == kind).map(of).collect()
    };
    // Of the loose specimen of a realisation less that of the dense one.
    let difference = |of: Read| -> Vec<f64> {
        let find = |kind: usize, configuration: u32| {
            tests.iter().find(|t| t.kind == kind && t.configuration == configuration)
        };
        (1..=bench.configurations).filter_map(|c| Some(of(find(0, c)?) - of(find(1, c)?))).collect()
    };
    let row = |id: &str, quantity: &str, values: &[f64], note: &str, decimals| {
        let (id, quantity) = (format!("triaxial-{id}"), format!("triaxial, {quantity}"));
        Row { decimals, ..Row::of("triaxial", &id, &quantity, values).noted(note) }
    };
    let less = |id: &str, what: &str, when: &str, of: Read, note: &str, decimals| {
        let quantity = format!("{what} of loose less dense, {when}");
        row(id, &quantity, &difference(of), note, decimals)
    };
    // A row for each kind of specimen.
    let each = |id: &str, what: &str, when: &str, of: Read, notes: [&str; 2], decimals| {
        let of_kind = |(kind, (name, _)): (usize, &(&str, f64))| {
            let (id, quantity) = (format!("{id}-{name}"), format!("{what} of the {name} {when}"));
            row(&id, &quantity, &values(kind, of), notes[kind], decimals)
        };
        KINDS.iter().enumerate().map(of_kind).collect::<Vec<Row>>()
    };
    let begin: Read = |test| test.moments[0].void_ratio;
    let void_ratio: Read = |test| test.end.void_ratio;
    let ratio: Read = |test| test.end.ratio;
    let peak: Read = |test| angle_of_ratio(test.peak).to_degrees();
    let angle: Read = |test| angle_of_ratio(test.end.ratio).to_degrees();
    let still = |kind: usize| {
        let mean = pluvia::measure::statistics::mean(&values(kind, |test| test.end.dilation));
        mean.map_or(String::new(), |slope| {
            format!("; it still changes by {:+.3} for an axial strain of 0.1", 0.1 * slope)
        })
    };
    let inertial = inertial_number(RATE, from_mm(SIZE_MM), SOLIDS, from_kpa(STRESS));
    let how = format!(
        "A cube {:.0} grains wide, smooth plates, void ratio and stress of an inner region, whose \
         mean stress the plates at the sides keep; means beyond an axial strain of {:.0} %, \
         I = ε̇ d √(ρ/p) = {inertial:.0e}",
        side / SIZE_MM,
        100.0 * END
    );
    let made = "Poured and compressed by 10 kPa with friction between grains of 0.5 and of 0.05, \
                sheared with 0.5";
    let at_end = [0, 1].map(|kind| how.clone() + &still(kind));
    let at_end = at_end.each_ref().map(String::as_str);
    let how = how.as_str();
    let mut rows = vec![less("begin", "void ratio", "at the beginning", begin, made, 3)];
    rows.extend(each("begin", "void ratio", "at the beginning", begin, [made; 2], 3));
    rows.push(less("end-difference", "void ratio", "at the end", void_ratio, how, 3));
    rows.extend(each("end", "void ratio", "at the end", void_ratio, at_end, 3));
    rows.push(less("ratio-difference", "q/p", "at the end", ratio, how, 2));
    rows.extend(each("ratio", "q/p", "at the end", ratio, [how; 2], 2));
    rows.extend(each("peak", "friction angle", "at its peak, °", peak, [how; 2], 1));
    rows.extend(each("angle", "friction angle", "at the end, °", angle, [how; 2], 1));
    rows
}

/// A line for each test: what is to the right and what is upwards at a moment.
fn plot(
    tests: &[Test],
    axes: [Axis; 2],
    x: impl Fn(&Triaxial) -> f64,
    y: impl Fn(&Triaxial) -> f64,
) -> Plot {
    let [right, up] = axes;
    let mut plot = Plot::new(right, up);
    for (n, test) in tests.iter().enumerate() {
        let is_first = tests[..n].iter().all(|earlier| earlier.kind != test.kind);
        let name = match (is_first, test.kind) {
            (true, 0) => "Loose",
            (true, _) => "Dense",
            _ => "",
        };
        let points = test.moments.iter().map(|m| (x(m), y(m))).collect();
        plot.add(name, Look::marked(test.kind), points);
    }
    plot
}

fn chart(tests: &[Test]) -> Chart {
    let panel = |up: Axis, y: fn(&Triaxial) -> f64| {
        let strain = Axis::linear("Axial strain (%)").from_zero();
        plot(tests, [strain, up], |m| 100.0 * m.strain, y)
    };
    Chart::new(
        "triaxial",
        "Triaxial compression of loose and dense specimens",
        "q/p and void ratio of an inner region against axial strain, each realisation a line.",
        vec![
            panel(Axis::linear("q/p").from_zero(), Triaxial::ratio),
            panel(Axis::linear("Void ratio"), |m| m.void_ratio),
        ],
    )
}

/// The path in the plane of p and q.
fn path(tests: &[Test]) -> Chart {
    let axes =
        ["Mean stress p (kPa)", "Deviator stress q (kPa)"].map(|of| Axis::linear(of).from_zero());
    Chart::new(
        "triaxial-path",
        "Stress paths of loose and dense specimens",
        "Deviator stress against mean stress of an inner region, each realisation a line: p is \
         kept by the forces at the sides, and q grows to its peak and falls.",
        vec![plot(tests, axes, |m| to_kpa(m.mean()), |m| to_kpa(m.deviator()))],
    )
}
