//! Direct shear at three stresses: friction angles at the peak and at the end.

use std::collections::BTreeMap;

use pluvia::{
    plain::counted,
    report::{Axis, Chart, Look, Plot},
    specimen::Specimen,
    units::{from_kpa, from_mm, to_mm},
};

use super::{
    bench::{Bench, Point, Run},
    legend::names,
    row::{Found, Row},
    shear_lines::{NOISE, SHEARING, called, leave_out, moments, panels},
    standard_tests::{
        ShearStrength, Sheared, friction_angle, inertial_number, shear_strength,
        void_ratio_of_height,
    },
};

const SCENARIO: &str = "scenarios/validation/direct-shear.json";
/// Stresses in kPa.
const STRESSES: [f64; 3] = [25.0, 50.0, 100.0];
/// Number of the one at which changes are tried.
const TRIED: usize = 1;
/// Mean equivalent diameter of the grains in mm, and density of the solids in kg/m³.
const SIZE_MM: f64 = 9.0;
const SOLIDS: f64 = 2650.0;
/// Grain sizes over which grains are taken to be sheared, for the inertial number alone.
const BAND: f64 = 5.0;
/// Moments that count together as the peak.
const TOGETHER: usize = 3;
/// The other speed, over that of the design.
const HALF: f64 = 0.5;
/// Part of the displacement from which on is the end.
const END: f64 = 2.0 / 3.0;
/// Roundness of the rounder grains.
const ROUNDER: [f64; 2] = [0.2, 0.45];
/// Numbers of other points, after the stresses: half the speed, stiffer contacts, less friction, and
/// the first of rounder grains.
const HALF_SPEED: usize = STRESSES.len();
const STIFFER: usize = HALF_SPEED + 1;
const SLIPPERY: usize = STIFFER + 1;
const FIRST_ROUNDER: usize = SLIPPERY + 1;
/// How much further the halves go where the approach to the critical state is looked at, and the
/// number of that point.
const FURTHER: f64 = 2.0;
const FAR: usize = FIRST_ROUNDER + ROUNDER.len();
/// Height in mm of the middle of the lid above its lower side.
const HALF_LID_MM: f64 = 5.0;
/// Height in m of the plane between the halves.
const PLANE: f64 = 0.025_25;

/// Box and speed of a design.
struct ShearBox {
    side_mm: f64,
    speed_mm_per_s: f64,
    travel_mm: f64,
}

const SMALL: ShearBox = ShearBox { side_mm: 90.0, speed_mm_per_s: 15.0, travel_mm: 13.5 };
const FULL: ShearBox = ShearBox { side_mm: 180.0, speed_mm_per_s: 5.0, travel_mm: 27.0 };

impl ShearBox {
    /// The same box, whose halves go further; walls are as thick as that asks for.
    fn far(&self) -> Self {
        Self { travel_mm: FURTHER * self.travel_mm, ..*self }
    }

    /// Displacement in m from which on is the end.
    fn end_from(&self) -> f64 {
        END * from_mm(self.travel_mm)
    }

    /// What must be known of the end: which part of the plane the halves no longer share.
    fn at_the_end(&self) -> String {
        let apart = (END + 1.0) / 2.0 * self.travel_mm / self.side_mm;
        format!(
            "mean over the last third of the displacement, in which {:.0} % of the plane are \
             where grains touch the smooth walls of the other half: friction 0.5 on the lower \
             walls, 0.1 under the upper",
            100.0 * apart
        )
    }

    fn changes(&self, stress_kpa: f64, faster: f64) -> Vec<String> {
        let side = self.side_mm;
        let mass_g = (560.0 * (side / SMALL.side_mm).powi(2)).round();
        vec![
            format!("grains.total_mass_g={mass_g}"),
            format!("pieces.0.shape.box.inner_mm=[{side},{side},25]"),
            format!("pieces.0.shape.box.wall_mm={}", (self.travel_mm + 10.0).round()),
            format!("pieces.1.shape.box.inner_mm=[{side},{side},65]"),
            format!("pieces.1.shape.box.wall_mm={}", (self.travel_mm + 10.0).round()),
            format!("pieces.2.shape.plate.size_mm=[{0},{0},10]", side - 1.0),
            format!("stages.0.area_mm=[{0},{0}]", side - 10.0),
            format!("stages.0.rate_g_per_s={}", 500.0 * mass_g / 560.0),
            format!("stages.2.loads.0.stress_kpa={stress_kpa}"),
            format!("stages.3.velocity_mm_per_s=[{},0,0]", self.speed_mm_per_s * faster),
            format!("stages.3.travel_mm={}", self.travel_mm),
        ]
    }

    /// Inertial number at a stress in kPa.
    fn inertial(&self, stress_kpa: f64) -> f64 {
        let rate = self.speed_mm_per_s / (BAND * SIZE_MM);
        inertial_number(rate, from_mm(SIZE_MM), SOLIDS, from_kpa(stress_kpa))
    }
}

/// A test of a realisation.
struct Test {
    point: usize,
    configuration: u32,
    moments: Vec<Sheared>,
    strength: ShearStrength,
    /// Void ratio of all grains in the box before they are sheared, and at the end.
    void_ratios: [f64; 2],
    /// Mean displacement of the grains along the box in m, by their height before in m.
    profile: Vec<(f64, f64)>,
}

/// Runs the test.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let design = if bench.is_small() { SMALL } else { FULL };
    let loads = loads(bench);
    let mut points: Vec<Point> = loads
        .iter()
        .map(|(_, stress)| Point {
            name: format!("stress-{stress}"),
            changes: design.changes(*stress, 1.0),
            most: None,
        })
        .collect();
    // What numbers must not depend on, and friction, which they must.
    let once = bench.is_small().then_some(1);
    let tried = |name: &str, faster: f64, more: &[&str], most: Option<u32>| {
        let mut changes = design.changes(STRESSES[TRIED], faster);
        changes.extend(more.iter().map(|change| (*change).to_owned()));
        Point { name: name.to_owned(), changes, most }
    };
    let mut others = vec![
        tried("half-speed", HALF, &[], None),
        tried("stiffer", 1.0, &["engine.native.contact_stiffness_n_per_m=860000"], None),
        tried("friction-0.3", 1.0, &["contact.grain_grain_friction=0.3"], once),
    ];
    others.extend(ROUNDER.map(|roundness| {
        let change = format!("grains.cells.rounding={roundness}");
        tried(&format!("roundness-{roundness}"), 1.0, &[&change[..]], None)
    }));
    let far = design.far().changes(STRESSES[TRIED], 1.0);
    others.push(Point { name: "far".to_owned(), changes: far, most: once });
    points.extend(bench.unless_quick(others));
    let runs = bench.run("direct-shear", SCENARIO, &points)?;
    let mut tests = Vec::new();
    for run in &runs {
        let moments = moments(run, PLANE)?;
        let point = loads[0].0 + run.point;
        // The peak is a mean over the same displacement at either speed.
        let together = if point == HALF_SPEED { 2 * TOGETHER } else { TOGETHER };
        let end_from = if point == FAR { design.far().end_from() } else { design.end_from() };
        match shear_strength(&moments, together, end_from) {
            Some(strength) => {
                let void_ratios = void_ratios(run, &design)?;
                let configuration = run.configuration;
                let profile = profile(run)?;
                tests.push(Test { point, configuration, moments, strength, void_ratios, profile });
            }
            None => leave_out(bench, run),
        }
    }
    let mut rows = rows(bench, &design, &tests);
    for row in &mut rows {
        row.decimals = if row.id.contains("void-ratio") { 3 } else { 1 };
    }
    Ok(Found { rows, charts: vec![chart(&tests), profiles(&tests)] })
}

/// Stresses in kPa, each with its number among [`STRESSES`]: the quick design has one.
fn loads(bench: &Bench) -> Vec<(usize, f64)> {
    let all = STRESSES.into_iter().enumerate();
    all.filter(|(n, _)| *n == TRIED || !bench.is_quick()).collect()
}

fn rows(bench: &Bench, design: &ShearBox, tests: &[Test]) -> Vec<Row> {
    let of = |point: usize, configuration: u32| {
        tests.iter().find(|t| t.point == point && t.configuration == configuration)
    };
    let loads = loads(bench);
    let angles = |ratio: fn(&ShearStrength) -> f64| {
        angles(bench, &loads, |point, c| Some(ratio(&of(point, c)?.strength)))
    };
    let change = |point: usize, ratio: fn(&ShearStrength) -> f64| {
        changes(bench, [TRIED, point], |point, c| Some(ratio(&of(point, c)?.strength)))
    };
    let peak: fn(&ShearStrength) -> f64 = |s| s.peak;
    let end: fn(&ShearStrength) -> f64 = |s| s.end;
    let row = |id: &str, quantity: &str, values: &[f64], note: String| {
        let id = format!("direct-shear-{id}");
        Row::of("direct-shear", &id, quantity, values).noted(note)
    };
    let (stresses, inertial) = match bench.is_quick() {
        true => ("50 kPa".to_owned(), format!("{:.0e}", design.inertial(STRESSES[TRIED]))),
        false => {
            let [low, _, high] = STRESSES.map(|stress| design.inertial(stress));
            let all = "25, 50 and 100 kPa, regression through the origin";
            (all.to_owned(), format!("{low:.0e} to {high:.0e}"))
        }
    };
    let how = format!(
        "{stresses}. The box is {:.0} grains wide; {} mm/s, I = (v/h) d √(ρ/p) over h = 5 d is \
         {inertial}. Friction between grains 0.5. Poured, not compacted",
        design.side_mm / SIZE_MM,
        design.speed_mm_per_s
    );
    let slippery: Vec<String> = [("peak", peak), ("end", end)]
        .iter()
        .filter_map(|(name, ratio)| {
            let changes = change(SLIPPERY, *ratio);
            let mean = pluvia::measure::statistics::mean(&changes)?;
            Some(format!("{name} {mean:+.1}°"))
        })
        .collect();
    let void_ratio = |point: usize, c: u32| Some(of(point, c)?.void_ratios[0]);
    let emptier = |c: u32| Some(void_ratio(SLIPPERY, c)? - void_ratio(TRIED, c)?);
    let emptier: Vec<f64> = (1..=bench.configurations).filter_map(emptier).collect();
    let with_less = match pluvia::measure::statistics::mean(&emptier) {
        None => String::new(),
        Some(mean) => format!(
            ". With friction between grains of 0.3, at 50 kPa in {}, poured anew with it (void \
             ratio before the shearing {mean:+.3}), while lid, floor and lower walls keep 0.5: {}",
            counted(emptier.len(), "realisation"),
            slippery.join(", ")
        ),
    };
    let each = |point: usize, what: &dyn Fn(&Test) -> f64| -> Vec<f64> {
        (1..=bench.configurations).filter_map(|c| of(point, c).map(what)).collect()
    };
    let rise = |test: &Test| test.strength.dilation.atan().to_degrees();
    let rise_at_end = |test: &Test| test.strength.dilation_at_end.atan().to_degrees();
    let mean_at_end = |point: usize| -> Option<String> {
        let mean = pluvia::measure::statistics::mean(&each(point, &rise_at_end))?;
        Some(format!("{mean:.1}° at {} kPa", STRESSES[point]))
    };
    let others: Vec<String> =
        (0..STRESSES.len()).filter(|n| *n != TRIED).filter_map(mean_at_end).collect();
    let at_others = match others.is_empty() {
        true => String::new(),
        false => format!("; {}", others.join(", ")),
    };
    let still = format!(
        "Rise of the lid over displacement in the last third: where it is not zero, the test ends \
         before the critical state{at_others}"
    );
    let box_wide = "By the height of the lid, over the whole box: the sheared layer is looser";
    let samples = tests.iter().find(|test| test.point == TRIED).map_or_else(String::new, |test| {
        let pairs = test.moments.windows(2);
        let apart = pairs.map(|pair| pair[1].displacement - pair[0].displacement);
        let apart = apart.fold(0.0, f64::max);
        format!(
            ". The peak is the largest mean of {TOGETHER} samples in succession of {}, over {:.1} mm: \
             {NOISE}",
            test.moments.len(),
            to_mm(TOGETHER as f64 * apart)
        )
    });
    let half = format!(
        "{} in place of {} mm/s, at 50 kPa: I {:.0e} in place of {:.0e}. The peak is a mean over as \
         many mm, of twice as many samples: noise raises it by another amount",
        HALF * design.speed_mm_per_s,
        design.speed_mm_per_s,
        HALF * design.inertial(STRESSES[TRIED]),
        design.inertial(STRESSES[TRIED])
    );
    let stiffer = "860 in place of 430 kN/m, at 50 kPa; poured anew".to_owned();
    let end_angle = |test: &Test| test.strength.end.atan().to_degrees();
    let rounder = ROUNDER.iter().enumerate().map(|(n, roundness)| {
        row(
            &format!("roundness-{roundness}"),
            &format!("direct shear, grains of roundness {roundness}, change of the end, °"),
            &change(FIRST_ROUNDER + n, end),
            "At 50 kPa, against grains with sharp edges of the same realisation".to_owned(),
        )
    });
    let mut rows = vec![
        row(
            "peak",
            "direct shear, friction angle at the peak, °",
            &angles(peak),
            how.clone() + &samples,
        ),
        row(
            "end",
            "direct shear, friction angle at the end of the test, °",
            &angles(end),
            format!("{how}. The end is the {}{with_less}", design.at_the_end()),
        ),
        row(
            "friction",
            "direct shear, friction angle at the end less what lifts the lid, °",
            &angles(ShearStrength::end_without_dilation),
            format!(
                "{how}. τ/σ less the rise of the lid over displacement, both of the {}: the work \
                 that lifts the lid is none of friction (Taylor 1948)",
                design.at_the_end()
            ),
        ),
        row(
            "dilation",
            "direct shear, angle of dilation at the peak, 50 kPa, °",
            &each(TRIED, &rise),
            "Rise of the lid over displacement".to_owned(),
        ),
        row(
            "dilation-end",
            "direct shear, angle of dilation at the end of the test, 50 kPa, °",
            &each(TRIED, &rise_at_end),
            still,
        ),
        row(
            "void-ratio",
            "direct shear, void ratio before the shearing, 50 kPa",
            &each(TRIED, &|test| test.void_ratios[0]),
            box_wide.to_owned(),
        ),
        row(
            "void-ratio-end",
            "direct shear, void ratio at the end of the test, 50 kPa",
            &each(TRIED, &|test| test.void_ratios[1]),
            box_wide.to_owned(),
        ),
    ];
    for (point, id, what, note) in [
        (HALF_SPEED, "rate", "direct shear at half the speed", &half),
        (STIFFER, "stiffness", "direct shear, contacts twice as stiff", &stiffer),
    ] {
        for (name, ratio) in [("peak", peak), ("end", end)] {
            let quantity = format!("{what}, change of the {name}, °");
            let values = change(point, ratio);
            rows.push(row(&format!("{id}-{name}"), &quantity, &values, note.clone()));
        }
    }
    rows.extend(rounder);
    let far = design.far();
    let over = format!(
        "{} in place of {} mm: {:.0} % of the width of the box, {:.0} grains; {}. Walls are \
         thicker, and the specimen is poured anew",
        far.travel_mm,
        design.travel_mm,
        100.0 * far.travel_mm / far.side_mm,
        far.travel_mm / SIZE_MM,
        far.at_the_end()
    );
    let own: Vec<ShearStrength> = (1..=bench.configurations)
        .filter_map(|c| over_the_usual_part(of(FAR, c)?, design))
        .collect();
    let before = |of: fn(&ShearStrength) -> f64| {
        let angles: Vec<f64> = own.iter().map(|s| of(s).atan().to_degrees()).collect();
        let mean = pluvia::measure::statistics::mean(&angles);
        mean.map_or(String::new(), |mean| {
            let (from, to) = (to_mm(design.end_from()), design.travel_mm);
            format!(". From {from:.1} to {to:.1} mm, where the other tests end, it has {mean:.1}°")
        })
    };
    rows.push(row(
        "far-end",
        "direct shear twice as far, friction angle at the end, 50 kPa, °",
        &each(FAR, &end_angle),
        over.clone() + &before(end),
    ));
    rows.push(row(
        "far-dilation-end",
        "direct shear twice as far, angle of dilation at the end, 50 kPa, °",
        &each(FAR, &rise_at_end),
        over + &before(|s| s.dilation_at_end),
    ));
    rows
}

/// Peak and end of a test over that part of its displacement which the others have.
fn over_the_usual_part(test: &Test, design: &ShearBox) -> Option<ShearStrength> {
    let travel = from_mm(design.travel_mm);
    let part = &test.moments[..test.moments.partition_point(|m| m.displacement <= travel)];
    shear_strength(part, TOGETHER, design.end_from())
}

/// Friction angles in degrees, realisation by realisation, of the stress ratios at stresses in kPa
/// and their numbers.
pub fn angles(
    bench: &Bench,
    loads: &[(usize, f64)],
    ratio: impl Fn(usize, u32) -> Option<f64>,
) -> Vec<f64> {
    let angle = |configuration: u32| {
        let point =
            |(n, stress): &(usize, f64)| Some((*stress, stress * ratio(*n, configuration)?));
        let points: Option<Vec<(f64, f64)>> = loads.iter().map(point).collect();
        friction_angle(&points?).map(f64::to_degrees)
    };
    (1..=bench.configurations).filter_map(angle).collect()
}

/// Angles of a change less those of the same realisation without it, by the numbers of both points.
pub fn changes(
    bench: &Bench,
    [without, with]: [usize; 2],
    ratio: impl Fn(usize, u32) -> Option<f64>,
) -> Vec<f64> {
    let angle = |point: usize, c: u32| Some(ratio(point, c)?.atan().to_degrees());
    (1..=bench.configurations).filter_map(|c| Some(angle(with, c)? - angle(without, c)?)).collect()
}

/// Void ratio of all grains in the box before they are sheared and at the end.
fn void_ratios(run: &Run, design: &ShearBox) -> Result<[f64; 2], String> {
    let solids = run.summary("/grains/solids_volume_cm3")?.ok_or("no volume of solids")? * 1e-6;
    let area = from_mm(design.side_mm).powi(2);
    let rows = run.series(["stage", "lid_z_mm"])?;
    let shearing: Vec<f64> =
        rows.iter().filter(|row| row[0] == SHEARING).map(|row| row[1]).collect();
    let of = |lid_mm: Option<&f64>| {
        let height = from_mm(lid_mm.map_or(f64::NAN, |mm| mm - HALF_LID_MM));
        void_ratio_of_height(height, area, solids)
    };
    Ok([of(shearing.first()), of(shearing.last())])
}

/// How far grains have come along the box in the end, in layers a grain high.
fn profile(run: &Run) -> Result<Vec<(f64, f64)>, String> {
    let (before, after) = (run.specimen(Some("2"))?, run.specimen(Some("3"))?);
    let place = |of: &Specimen, i: usize| of.state.bodies[i].body.pose.translation.vector;
    let mut layers: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for i in before.present() {
        let from = place(&before, i);
        let layer = layers.entry((to_mm(from.z) / SIZE_MM).max(0.0) as usize).or_default();
        *layer = (layer.0 + 1.0, layer.1 + place(&after, i).x - from.x);
    }
    let middle = |layer: usize| from_mm(SIZE_MM) * (layer as f64 + 0.5);
    Ok(layers.into_iter().map(|(layer, (count, sum))| (middle(layer), sum / count)).collect())
}

/// Tests at the stresses, of which the quick design has one, and that which goes further.
fn chart(tests: &[Test]) -> Chart {
    let mut kinds = called(&STRESSES);
    kinds.push(format!("{} kPa, twice as far", STRESSES[TRIED]));
    let kind = |test: &Test| match test.point {
        FAR => Some(STRESSES.len()),
        point => (point < STRESSES.len()).then_some(point),
    };
    let curves: Vec<(usize, &[Sheared])> =
        tests.iter().filter_map(|test| Some((kind(test)?, &test.moments[..]))).collect();
    let seen = "Stress ratio and height of the lid against displacement, each realisation a line.";
    let panels = panels(&kinds, &curves);
    let title = match curves.iter().all(|(kind, _)| *kind == TRIED) {
        true => format!("Direct shear at {} kPa", STRESSES[TRIED]),
        false => "Direct shear at three stresses".to_owned(),
    };
    Chart::new("direct-shear", &title, seen, panels)
}

fn profiles(tests: &[Test]) -> Chart {
    let mut plot = Plot::new(
        Axis::linear("Mean displacement of grains (mm)"),
        Axis::linear("Height before (mm)").from_zero(),
    );
    plot.mark_level("Plane between the halves", to_mm(PLANE));
    let tests: Vec<&Test> = tests.iter().filter(|test| test.point < STRESSES.len()).collect();
    let lines: Vec<usize> = tests.iter().map(|test| test.point).collect();
    for (test, name) in tests.into_iter().zip(names(&called(&STRESSES), &lines)) {
        let points = test.profile.iter().map(|(height, way)| (to_mm(*way), to_mm(*height)));
        plot.add(name, Look::marked(test.point), points.collect());
    }
    Chart::new(
        "direct-shear-profile",
        "Where a shear box shears",
        "How far grains have come with the lower half at the end, by layers a grain high, each \
         realisation a line.",
        vec![plot],
    )
}
