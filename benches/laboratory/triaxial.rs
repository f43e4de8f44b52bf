//! Triaxial compression of a loose and a dense specimen at constant mean stress, and whether both
//! come to one state.

use pluvia::{
    report::{Axis, Chart, Look, Plot},
    units::{from_kpa, from_mm, to_kpa, to_mm},
};
use serde_json::json;

use super::{
    bench::{Bench, Point, Run},
    row::{Found, Row},
    standard_tests::{
        CriticalState, Triaxial, angle_of_ratio, critical_state, inertial_number,
        mean_stress_deviation, peak_ratio,
    },
};

const SPECIMEN: &str = "scenarios/validation/triaxial-specimen.json";
const SCENARIO: &str = "scenarios/validation/triaxial-mean-stress.json";
/// Friction between grains while they are sheared.
const FRICTION: f64 = 0.5;
/// A kind of specimen: how it is made, so that both are about as high.
struct Kind {
    name: &'static str,
    /// Friction between grains until it is compressed.
    friction: f64,
    /// Mass in g in the small design.
    mass_g: f64,
    /// Height of fall in mm above the grains that lie there, and g/s in the small design; where
    /// there is none grains fall as in the scenario.
    rain: Option<[f64; 2]>,
}
/// Poured with their own friction grains lie closer than the critical state: a specimen that
/// contracts needs more. With a friction of 1.5 and 2 most specimens miss the check of the solver.
const KINDS: [Kind; 2] = [
    Kind { name: "loose", friction: 1.0, mass_g: 355.0, rain: Some([3.0, 100.0]) },
    Kind { name: "dense", friction: 0.05, mass_g: 490.0, rain: None },
];
impl Kind {
    /// What it changes in the making of a specimen as wide as this (mm).
    fn making(&self, side: f64) -> Vec<String> {
        let rain = self.rain.map(|[above, rate]| {
            // In the same time.
            let rate = (rate * (side / SIDE_MM).powi(3)).round();
            [
                "stages.0.at_mm=[0,0,10]".to_owned(),
                format!("stages.0.above_surface_mm={above}"),
                format!("stages.0.rate_g_per_s={rate}"),
            ]
        });
        rain.into_iter().flatten().collect()
    }
}

/// Time in s that a specimen has at rest with its new friction, before it is sheared.
const REST: f64 = 0.2;
/// Time in s over which the mean stress is smoothed and restored: see the scenario's notes.
const WINDOW: f64 = 0.03;
/// Time in s in which the top plate comes to its full speed, likewise.
const RAMP: f64 = 0.8;
/// Plates whose forces keep it.
const SIDES: [&str; 4] = ["west", "east", "south", "north"];
/// Stress in kPa from all sides.
const STRESS: f64 = 10.0;
/// How far the top plate goes, in widths of the specimen, and axial strain from which on is the end.
const TRAVEL: f64 = 0.40;
const END: f64 = 0.27;
/// How far it goes in a second.
const RATE: f64 = 0.10;
/// Moments that count together as the peak.
const TOGETHER: usize = 3;
/// Mean equivalent diameter of the grains in mm, and density of the solids in kg/m³.
const SIZE_MM: f64 = 9.0;
const SOLIDS: f64 = 2650.0;
/// Width in mm in which a specimen of the scenario is poured, and that of the full design.
const SIDE_MM: f64 = 66.0;
const WIDE_MM: f64 = 132.0;
/// Half the thickness of the plates in mm.
const HALF_PLATE_MM: f64 = 10.0;

/// A specimen that was sheared.
struct Test {
    /// Number of its kind.
    kind: usize,
    configuration: u32,
    /// Of the inner region.
    moments: Vec<Triaxial>,
    end: CriticalState,
    peak: f64,
    /// Of all that is between the plates.
    between: Vec<Triaxial>,
    whole: CriticalState,
    /// Width along x and y, and height, before it is sheared, in m.
    size: [f64; 3],
}

/// Runs the test.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let side = if bench.is_small() { SIDE_MM } else { WIDE_MM };
    let changes = |kind: &Kind, friction: f64| {
        let mut changes = if bench.is_small() { Vec::new() } else { wide() };
        let mass_g = (kind.mass_g * (side / SIDE_MM).powi(3)).round();
        changes.push(format!("grains.total_mass_g={mass_g}"));
        changes.push(format!("contact.grain_grain_friction={friction}"));
        changes
    };
    let made: Vec<Point> = KINDS
        .iter()
        .map(|kind| {
            let mut changes = changes(kind, kind.friction);
            let own = kind.making(side);
            if !bench.is_small() {
                // A value is changed once.
                let path = |change: &str| change.split('=').next().map(str::to_owned);
                let is_own = |change: &String| own.iter().any(|own| path(own) == path(change));
                changes.extend(wide_stages().into_iter().filter(|change| !is_own(change)));
            }
            changes.extend(own);
            Point { name: kind.name.to_owned(), changes, most: None }
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
        let kind = &KINDS[run.point];
        let mut changes = changes(kind, FRICTION);
        changes.push(format!("begin.specimen={}", folder.display()));
        changes.push(format!("stages={stages}"));
        let name = format!("{}-{}", kind.name, run.configuration);
        Ok(Point { name, changes, most: Some(1) })
    });
    let points: Vec<Point> = points.collect::<Result<_, String>>()?;
    let mut tests = Vec::new();
    for run in bench.run("triaxial", SCENARIO, &points)? {
        let specimen = &specimens[run.point];
        let Moments { core, between, size } = moments(&run)?;
        let ends = critical_state(&core, END).zip(critical_state(&between, END));
        match ends.zip(peak_ratio(&core, TOGETHER)) {
            Some(((end, whole), peak)) => {
                let (kind, configuration) = (specimen.point, specimen.configuration);
                let moments = core;
                tests.push(Test { kind, configuration, moments, end, peak, between, whole, size });
            }
            None => bench.leave_out(format!("{}: not sheared to the end", run.folder.display())),
        }
    }
    let rows = rows(bench, &tests, side);
    Ok(Found { rows, charts: vec![chart(&tests), path(&tests)] })
}

/// The specimen of the full design.
fn wide() -> Vec<String> {
    let (side, out) = (WIDE_MM, WIDE_MM / 2.0 + HALF_PLATE_MM);
    let wide = WIDE_MM + 110.0;
    let high = 225.0;
    let core = side / 3.0;
    vec![
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
        format!("measures.regions.0.low_mm=[-{core},-{core},{}]", 0.15 * side),
        format!("measures.regions.0.high_mm=[{core},{core},{}]", 0.48 * side),
    ]
}

/// How it is filled and pressed.
fn wide_stages() -> Vec<String> {
    let force = from_kpa(STRESS) * from_mm(WIDE_MM).powi(2);
    let mut changes = vec![
        "stages.0.at_mm=[0,0,215]".to_owned(),
        format!("stages.0.area_mm=[{0},{0}]", WIDE_MM - 12.0),
        "stages.0.rate_g_per_s=1800".to_owned(),
        "stages.0.time_limit_s=10".to_owned(),
        "stages.1.time_limit_s=6".to_owned(),
        "stages.1.until.force_n=8".to_owned(),
    ];
    changes.extend((0..5).map(|n| format!("stages.2.loads.{n}.force_n={force}")));
    changes
}

/// A test as it is sheared.
struct Moments {
    /// Of the inner region.
    core: Vec<Triaxial>,
    /// Of all that is between the plates, by their places and forces.
    between: Vec<Triaxial>,
    /// Width along x and y, and height, before, in m.
    size: [f64; 3],
}

fn moments(run: &Run) -> Result<Moments, String> {
    let rows = run.series([
        "stage",
        "time_s",
        "core_stress_xx_kpa",
        "core_stress_yy_kpa",
        "core_stress_zz_kpa",
        "core_void_ratio",
        "west_x_mm",
        "east_x_mm",
        "south_y_mm",
        "north_y_mm",
        "top_z_mm",
        "west_force_x_n",
        "south_force_y_n",
        "top_force_z_n",
    ])?;
    let solids = run.summary("/grains/solids_volume_cm3")?.ok_or("no volume of solids")? * 1e-6;
    // Between the inner sides of the plates, above the floor at 0.
    let size = |row: &[f64; 14]| {
        let between = |low: f64, high: f64| from_mm(high - low - 2.0 * HALF_PLATE_MM);
        [between(row[6], row[7]), between(row[8], row[9]), from_mm(row[10] - HALF_PLATE_MM)]
    };
    // Less than half as fast, the plate lets the deviator go.
    let end = rows.last().map_or(0.0, |row| row[1]) - RAMP / 2.0;
    let is_sheared = |row: &&[f64; 14]| row[0] == 1.0 && row[1] <= end;
    let sheared: Vec<&[f64; 14]> = rows.iter().filter(is_sheared).collect();
    let size_before = sheared.first().map_or([f64::NAN; 3], |row| size(row));
    let strain = |row: &[f64; 14]| 1.0 - size(row)[2] / size_before[2];
    let core = |row: &&[f64; 14]| Triaxial {
        strain: strain(row),
        stress: [row[2], row[3], row[4]].map(from_kpa),
        void_ratio: row[5],
    };
    let between = |row: &&[f64; 14]| {
        let [wide, deep, high] = size(row);
        Triaxial {
            strain: strain(row),
            stress: [
                row[11].abs() / (deep * high),
                row[12].abs() / (wide * high),
                row[13].abs() / (wide * deep),
            ],
            void_ratio: wide * deep * high / solids - 1.0,
        }
    };
    let finite = |moments: Vec<Triaxial>| -> Vec<Triaxial> {
        moments.into_iter().filter(|m| m.ratio().is_finite()).collect()
    };
    Ok(Moments {
        core: finite(sheared.iter().map(core).collect()),
        between: finite(sheared.iter().map(between).collect()),
        size: size_before,
    })
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
        let of_kind = |(kind, kind_of): (usize, &Kind)| {
            let name = kind_of.name;
            let (id, quantity) = (format!("{id}-{name}"), format!("{what} of the {name} {when}"));
            row(&id, &quantity, &values(kind, of), notes[kind], decimals)
        };
        KINDS.iter().enumerate().map(of_kind).collect::<Vec<Row>>()
    };
    let begin: Read = |test| test.moments[0].void_ratio;
    let void_ratio: Read = |test| test.end.void_ratio;
    let ratio: Read = |test| test.end.ratio;
    let whole_void_ratio: Read = |test| test.whole.void_ratio;
    let whole_ratio: Read = |test| test.whole.ratio;
    let change: Read = |test| test.whole.void_ratio - test.between[0].void_ratio;
    let peak: Read = |test| angle_of_ratio(test.peak).to_degrees();
    let angle: Read = |test| angle_of_ratio(test.end.ratio).to_degrees();
    let deviation: Read = |test| 100.0 * mean_stress_deviation(&test.moments).unwrap_or(f64::NAN);
    let still = |kind: usize| {
        let mean = pluvia::measure::statistics::mean(&values(kind, |test| test.end.dilation));
        mean.map_or(String::new(), |slope| {
            format!("; it still changes by {:+.3} for an axial strain of 0.1", 0.1 * slope)
        })
    };
    let inertial = inertial_number(RATE, from_mm(SIZE_MM), SOLIDS, from_kpa(STRESS));
    let core_mm = 2.0 * side / 3.0;
    let region = format!(
        "An inner region of {core_mm:.0} by {core_mm:.0} by {:.0} mm in a specimen {:.0} grains \
         wide between smooth plates; those at the sides keep its mean stress; \
         I = ε̇ d √(ρ/p) = {inertial:.0e}",
        side / 3.0,
        side / SIZE_MM
    );
    let how = format!("{region}; means beyond an axial strain of {:.0} %", 100.0 * END);
    let plates = format!(
        "By places and forces of the plates: all grains, with the looser ones at the plates; \
         means beyond an axial strain of {:.0} %",
        100.0 * END
    );
    let highest = format!(
        "{region}; the largest mean of {TOGETHER} samples in succession, which their scatter raises"
    );
    let made = [0, 1].map(|kind| made(tests, kind));
    let made_both = format!("{}. {}", made[0], made[1]);
    let made = made.each_ref().map(String::as_str);
    let at_end = [0, 1].map(|kind| how.clone() + &still(kind));
    let at_end = at_end.each_ref().map(String::as_str);
    let (how, highest, plates) = (how.as_str(), highest.as_str(), plates.as_str());
    let mut rows = vec![less("begin", "void ratio", "at the beginning", begin, &made_both, 3)];
    rows.extend(each("begin", "void ratio", "at the beginning", begin, made, 3));
    let kept = "root mean square deviation of the mean stress";
    let since = "from that at the beginning, %";
    let regulated = format!("{region}. Few grains bear it, and each of their shifts shows in it");
    rows.extend(each("kept", kept, since, deviation, [&regulated; 2], 0));
    rows.push(less("end-difference", "void ratio", "at the end", void_ratio, how, 3));
    rows.extend(each("end", "void ratio", "at the end", void_ratio, at_end, 3));
    let all = "void ratio between the plates";
    rows.push(less("end-plates", all, "at the end", whole_void_ratio, plates, 3));
    let changes = "change of the void ratio between the plates";
    rows.extend(each("change", changes, "from the beginning to the end", change, [plates; 2], 3));
    rows.push(less("ratio-difference", "q/p", "at the end", ratio, how, 2));
    rows.extend(each("ratio", "q/p", "at the end", ratio, [how; 2], 2));
    rows.push(less("ratio-plates", "q/p by the plates", "at the end", whole_ratio, plates, 2));
    rows.extend(each("peak", "friction angle", "at its peak, °", peak, [highest; 2], 1));
    rows.extend(each("angle", "friction angle", "at the end, °", angle, [how; 2], 1));
    rows
}

/// How a kind of specimen was made, and what it was before it was sheared.
fn made(tests: &[Test], kind: usize) -> String {
    let of = |read: &dyn Fn(&Test) -> f64| {
        let values: Vec<f64> = tests.iter().filter(|t| t.kind == kind).map(read).collect();
        pluvia::measure::statistics::mean(&values).unwrap_or(f64::NAN)
    };
    let Kind { name, friction, rain, .. } = KINDS[kind];
    let rain = rain.map_or_else(String::new, |[above, _]| format!(" from {above} mm"));
    format!(
        "{name}: poured{rain} and compressed by 10 kPa from all sides with friction between grains \
         of {friction}, sheared with {FRICTION}; {:.0} by {:.0} mm wide and {:.0} mm high, q/p {:.2}, \
         means",
        to_mm(of(&|t| t.size[0])),
        to_mm(of(&|t| t.size[1])),
        to_mm(of(&|t| t.size[2])),
        of(&|t| t.moments[0].ratio())
    )
}

/// A line for each test: what is to the right and what is upwards at each of its moments.
fn plot(
    tests: &[Test],
    axes: [Axis; 2],
    moments: fn(&Test) -> &[Triaxial],
    x: fn(&Triaxial) -> f64,
    y: fn(&Triaxial) -> f64,
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
        let points = moments(test).iter().map(|m| (x(m), y(m))).collect();
        plot.add(name, Look::marked(test.kind), points);
    }
    plot
}

fn chart(tests: &[Test]) -> Chart {
    let panel = |up: Axis, moments: fn(&Test) -> &[Triaxial], y: fn(&Triaxial) -> f64| {
        let strain = Axis::linear("Axial strain (%)").from_zero();
        plot(tests, [strain, up], moments, |m| 100.0 * m.strain, y)
    };
    let core: fn(&Test) -> &[Triaxial] = |test| &test.moments;
    let between: fn(&Test) -> &[Triaxial] = |test| &test.between;
    Chart::new(
        "triaxial",
        "Triaxial compression of loose and dense specimens",
        "q/p and void ratio of an inner region, and void ratio of all between the plates, against \
         axial strain, each realisation a line.",
        vec![
            panel(Axis::linear("q/p").from_zero(), core, Triaxial::ratio),
            panel(Axis::linear("Void ratio, inner region"), core, |m| m.void_ratio),
            panel(Axis::linear("Void ratio between plates"), between, |m| m.void_ratio),
        ],
    )
}

/// The path in the plane of p and q, and p by itself.
fn path(tests: &[Test]) -> Chart {
    let [p, q] =
        ["Mean stress p (kPa)", "Deviator stress q (kPa)"].map(|of| Axis::linear(of).from_zero());
    let strain = Axis::linear("Axial strain (%)").from_zero();
    let core: fn(&Test) -> &[Triaxial] = |test| &test.moments;
    let mean: fn(&Triaxial) -> f64 = |m| to_kpa(m.mean());
    Chart::new(
        "triaxial-path",
        "Stress paths of loose and dense specimens",
        "Deviator stress against mean stress of an inner region, and that mean stress against axial \
         strain, each realisation a line: the forces at the sides keep p, once they can follow.",
        vec![
            plot(tests, [p.clone(), q], core, mean, |m| to_kpa(m.deviator())),
            plot(tests, [strain, p], core, |m| 100.0 * m.strain, mean),
        ],
    )
}
