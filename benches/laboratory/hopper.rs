//! Discharge of a flat-bottomed bin through round openings: Beverloo's law.

use pluvia::{
    measure::inference::MeanTest,
    report::{Axis, Chart, Look, Plot},
    units::{from_mm, to_g, to_mm},
};

use super::{
    bench::{Bench, Design, Point, Run},
    row::{Found, Row},
    standard_tests::{
        BeverlooFit, Discharge, Held, Outflow, fit_beverloo, k_in_words, steady_outflow,
    },
};

const SCENARIO: &str = "scenarios/validation/hopper-flat.json";
/// Pieces of the floor from the middle outwards, with the opening in mm that there is without them
/// and the time in s for which the flow through it is watched.
const FLOOR: [(&str, f64, f64); 6] = [
    ("disc", 45.0, 1.3),
    ("ring54", 54.0, 1.2),
    ("ring63", 63.0, 1.0),
    ("ring72", 72.0, 0.9),
    ("ring81", 81.0, 0.8),
    ("ring90", 90.0, 0.7),
];
/// Density of the solids in kg/m³, as in the scenario.
const SOLIDS: f64 = 2650.0;
/// Mean equivalent diameter of the grains in m: that of the fraction from 8 to 10 mm.
const SIZE: f64 = 0.009;
const GRAVITY: f64 = 9.81;
/// Time in s after the opening in which the flow has become steady.
const SETTLED: f64 = 0.24;
/// Share of the grains after which the bin counts as no longer full.
const FULL: f64 = 0.4;
/// Number of the opening through which changes are tried.
const TRIED: usize = 3;
/// k where only the exponent is fitted, and the coefficient that belongs to it: of beads, as quoted
/// in [`super::references`].
const USUAL_K: f64 = 1.4;
const USUAL_C: f64 = 0.58;

/// Grains of one shape, and the bin that they fill.
struct Grains {
    /// Beginning of the names of points and rows.
    id: &'static str,
    /// What quantities say of them.
    called: &'static str,
    /// What the figure calls them.
    kind: &'static str,
    /// What they change in the scenario.
    shape: Option<&'static str>,
    /// Mass in kg in the small designs: rates through the widest opening are steady until two fifths
    /// have left.
    small: f64,
    /// Factor on the times of [`FLOOR`] in the small designs.
    longer: f64,
}

/// Mass in kg in the quick design, whose widest opening is narrower.
const QUICK: f64 = 3.0;

const ANGULAR: Grains = Grains {
    id: "hopper",
    called: "",
    kind: "angular grains",
    shape: None,
    small: 5.5,
    longer: 1.5,
};
/// The constants that are usually given are those of spheres, or nearly.
const SPHERES: Grains = Grains {
    id: "hopper-spheres",
    called: "spheres, ",
    kind: "spheres",
    shape: Some("grains.shape=spheres"),
    small: 6.0,
    longer: 1.0,
};

impl Grains {
    /// Mass of a bin in kg.
    fn total(&self, bench: &Bench) -> f64 {
        match bench.design {
            Design::Quick => QUICK,
            Design::Small => self.small,
            Design::Full => 28.0,
        }
    }

    /// A point an opening.
    fn points(&self, bench: &Bench) -> Vec<Point> {
        let of = |n: &usize| {
            let names: Vec<&str> = FLOOR[..=*n].iter().map(|f| f.0).collect();
            let (_, opening, watched) = FLOOR[*n];
            // What a bin that is so much wider gives.
            let longer = if bench.is_small() { self.longer } else { 2.0 };
            let mut changes = vec![
                format!("stages.1.pieces={}", serde_json::json!(names)),
                format!("stages.1.time_limit_s={}", longer * watched),
                format!("grains.total_mass_g={}", 1e3 * self.total(bench)),
            ];
            if !bench.is_small() {
                changes.extend(wide());
            }
            changes.extend(self.shape.map(str::to_owned));
            Point { name: format!("{}-opening-{opening}", self.id), changes, most: None }
        };
        openings(bench).iter().map(of).collect()
    }
}

/// Numbers of the openings that are used. In the narrowest most flows jam.
fn openings(bench: &Bench) -> &'static [usize] {
    if bench.is_quick() { &[1, 2, 3] } else { &[0, 1, 2, 3, 4, 5] }
}

/// The test with angular grains.
pub fn with_angular(bench: &Bench) -> Result<Found, String> {
    carry_out(bench, &ANGULAR)
}

/// The test with spheres.
pub fn with_spheres(bench: &Bench) -> Result<Found, String> {
    carry_out(bench, &SPHERES)
}

/// What may be why it misses: tried at one opening in one realisation.
fn tried(bench: &Bench, total: f64) -> Vec<Tried> {
    let mut all = vec![
        (
            "friction-0.2",
            "friction between grains of 0.2",
            total,
            vec!["contact.grain_grain_friction=0.2".to_owned()],
        ),
        (
            "no-rebound",
            "a coefficient of restitution of 0",
            total,
            vec!["contact.restitution=0".to_owned()],
        ),
        ("wider", "a bin of twice the area, filled as high", 2.0 * total, wider()),
    ];
    // The wider bin takes as long as all of the small design.
    all.truncate(match bench.design {
        Design::Quick => 0,
        Design::Small => 2,
        Design::Full => 3,
    });
    all
}

/// What is tried: name, description, mass in kg and what it changes.
type Tried = (&'static str, &'static str, f64, Vec<String>);

fn carry_out(bench: &Bench, grains: &Grains) -> Result<Found, String> {
    let own = grains.points(bench);
    let tried = tried(bench, grains.total(bench));
    let others = tried.iter().map(|(name, _, _, changes)| Point {
        name: (*name).to_owned(),
        changes: own[TRIED].changes.iter().chain(changes).cloned().collect(),
        most: Some(1),
    });
    let others: Vec<Point> = others.collect();
    let points: Vec<Point> = own.into_iter().chain(others).collect();
    let openings = openings(bench);
    let runs = bench.run(grains.id, SCENARIO, &points)?;
    let mut flows = Flows::default();
    let mut changed: Vec<(&str, Discharge)> = Vec::new();
    for run in &runs {
        let tried = run.point.checked_sub(openings.len()).map(|n| &tried[n]);
        let (total, opening) = match tried {
            None => (grains.total(bench), FLOOR[openings[run.point]].1),
            Some((_, _, total, _)) => (*total, FLOOR[TRIED].1),
        };
        match (discharge(run, opening, total)?, tried) {
            (Flow::Steady(flow), None) => flows.steady.push((run.configuration, flow)),
            (Flow::Steady(flow), Some((_, what, _, _))) => changed.push((what, flow)),
            (Flow::Without(why), _) => {
                bench.leave_out(format!("{}, {} ({why})", grains.id, run.name()));
            }
        }
    }
    let is_own = |f: &&(u32, Discharge)| f.0 == 1 && f.1.opening == from_mm(FLOOR[TRIED].1);
    let own = flows.steady.iter().find(is_own).filter(|_| !changed.is_empty());
    let changed = own.map_or_else(String::new, |(_, own)| {
        let of = |(what, flow): &(&str, Discharge)| {
            let more = 100.0 * (flow.rate / flow.bulk_density * own.bulk_density / own.rate - 1.0);
            format!("with {what} {more:+.0} %")
        };
        let told: Vec<String> = changed.iter().map(of).collect();
        format!(
            ". Tried through {} mm in one realisation, rate over bulk density: {}",
            FLOOR[TRIED].1,
            told.join(", ")
        )
    });
    let charts = vec![chart(bench, grains, &flows)];
    Ok(Found { rows: rows(bench, grains, &flows, &changed), charts })
}

/// What came through the openings.
#[derive(Default)]
struct Flows {
    /// Realisations and flows.
    steady: Vec<(u32, Discharge)>,
}

impl Flows {
    /// The law fitted to the flows of each realisation.
    fn fits(&self, bench: &Bench, held: Held) -> Vec<BeverlooFit> {
        let of = |configuration: u32| {
            let is_own = |f: &&(u32, Discharge)| f.0 == configuration;
            let own: Vec<Discharge> = self.steady.iter().filter(is_own).map(|f| f.1).collect();
            fit_beverloo(&own, SIZE, GRAVITY, held)
        };
        (1..=bench.configurations).filter_map(of).collect()
    }

    /// The mean exponent, with its interval, of the flows through all openings but the narrowest.
    fn exponent_of_wider(&self, bench: &Bench) -> Option<String> {
        let narrowest = self.steady.iter().map(|f| f.1.opening).fold(f64::INFINITY, f64::min);
        let wider = self.steady.iter().filter(|f| f.1.opening > narrowest).copied();
        let wider = Self { steady: wider.collect() };
        let fits = wider.fits(bench, Held::default());
        let exponents: Vec<f64> = fits.iter().map(|f| f.exponent).collect();
        let MeanTest { estimate, half_width, .. } = MeanTest::of(&exponents, 0.95)?;
        let (low, high) = (estimate.mean - half_width, estimate.mean + half_width);
        let mean = estimate.mean;
        Some(format!("{mean:.2} ({low:.2} to {high:.2}), {}", k_in_words(&fits)))
    }

    /// C and k by the usual exponent.
    fn usual(&self, bench: &Bench) -> Vec<BeverlooFit> {
        self.fits(bench, Held { exponent: Some(2.5), k: None })
    }
}

fn rows(bench: &Bench, grains: &Grains, flows: &Flows, changed: &str) -> Vec<Row> {
    let values = |fits: &[BeverlooFit], of: fn(&BeverlooFit) -> f64| -> Vec<f64> {
        fits.iter().map(of).collect()
    };
    let bin = match bench.is_small() {
        true => format!(
            "The bin is 170 mm wide, less than D + 30 d, and holds {} kg",
            grains.total(bench)
        ),
        false => "The bin is 360 mm wide, D + 30 d of all openings".to_owned(),
    };
    let row = |id: &str, quantity: &str, values: Vec<f64>| {
        let id = format!("{}-{id}", grains.id);
        let quantity = format!("hopper, {}{quantity}", grains.called);
        Row::of(grains.id, &id, &quantity, &values)
    };
    let all = openings(bench);
    let across = |n: usize| FLOOR[n].1 / to_mm(SIZE);
    let free = flows.fits(bench, Held::default());
    let wider = flows.exponent_of_wider(bench);
    let wider = wider.map_or_else(String::new, |exponent| {
        format!(". Tried: without the narrowest opening {exponent}")
    });
    let over = format!(
        "{} openings of {:.0} to {:.0} d. {bin}. Exponent and k make up for each other over \
         so short a range: {}{wider}",
        all.len(),
        across(all[0]),
        across(all[all.len() - 1]),
        k_in_words(&free)
    );
    let usual = flows.usual(bench);
    let k_of_usual = k_in_words(&usual);
    let contact = format!(
        "{bin}. Fitted with {k_of_usual}. Friction between grains 0.5, restitution 0.315{changed}"
    );
    let free = values(&free, |f| f.exponent);
    let with_k = Held { exponent: None, k: Some(USUAL_K) };
    let with_k = values(&flows.fits(bench, with_k), |f| f.exponent);
    let (c, k) = (values(&usual, |f| f.c), values(&usual, |f| f.k));
    vec![
        row("exponent", "exponent, with C and k fitted", free).noted(over),
        row("exponent-at-k", "exponent, with k held at 1.4", with_k)
            .noted("Of the same flows: what is left to the exponent where k is that of beads"),
        row("c", "C, with the exponent held at 2.5", c).noted(contact),
        row("k", "k, with the exponent held at 2.5", k)
            .noted(format!("{k_of_usual}. d is the equivalent diameter, 9.0 mm")),
    ]
}

/// The same bin, as wide and as full as the law asks for.
fn wide() -> Vec<String> {
    vec![
        "grains.total_mass_g=28000".into(),
        "pieces.6.shape.hopper.top_diameter_mm=360".into(),
        "stages.0.diameter_mm=355".into(),
        "measures.openings.0.diameter_mm=300".into(),
    ]
}

/// A wider bin, for what is only tried.
fn wider() -> Vec<String> {
    vec![
        "grains.total_mass_g=56000".into(),
        "pieces.6.shape.hopper.top_diameter_mm=510".into(),
        "stages.0.diameter_mm=505".into(),
    ]
}

/// What ran out of an opening (mm) while the bin, filled with `total` kg, was full.
fn discharge(run: &Run, opening: f64, total: f64) -> Result<Flow, String> {
    let rows = run.series(["time_s", "stage", "mouth_passed_g", "above_void_ratio"])?;
    let Some(full) = rows.iter().rfind(|row| row[1] == 0.0) else {
        return Ok(Flow::Without("it was not filled"));
    };
    let flow: Vec<(f64, f64)> = rows.iter().map(|row| (row[0], row[2] * 1e-3)).collect();
    Ok(match steady_outflow(&flow, full[0], SETTLED, FULL * total) {
        Outflow::Steady(rate) if rate > 0.0 => Flow::Steady(Discharge {
            opening: from_mm(opening),
            rate,
            bulk_density: SOLIDS / (1.0 + full[3]),
        }),
        Outflow::Steady(_) | Outflow::Jammed => Flow::Without("the flow jammed"),
        Outflow::Unsteady => Flow::Without("the flow died away or grew"),
        Outflow::Short => {
            Flow::Without("too little of the flow was seen, or it stood still at the end")
        }
    })
}

/// What came of an opening.
enum Flow {
    Steady(Discharge),
    /// No rate, and why.
    Without(&'static str),
}

fn chart(bench: &Bench, grains: &Grains, flows: &Flows) -> Chart {
    let count = flows.steady.len().max(1) as f64;
    let density = flows.steady.iter().map(|f| f.1.bulk_density).sum::<f64>() / count;
    let law = |c: f64, k: f64| -> Vec<(f64, f64)> {
        (40..=95)
            .map(|mm| {
                let gap = (from_mm(f64::from(mm)) - k * SIZE).max(0.0);
                (f64::from(mm), to_g(c * density * GRAVITY.sqrt() * gap.powf(2.5)))
            })
            .collect()
    };
    let mut plot =
        Plot::new(Axis::linear("Opening (mm)").from_zero(), Axis::linear("Rate (g/s)").from_zero());
    let measured = flows.steady.iter().map(|(_, f)| (to_mm(f.opening), to_g(f.rate))).collect();
    plot.add("Measured", Look::points(0), measured);
    let fits = flows.usual(bench);
    if !fits.is_empty() {
        let mean =
            |of: &dyn Fn(&BeverlooFit) -> f64| fits.iter().map(of).sum::<f64>() / fits.len() as f64;
        let (c, k) = (mean(&|f| f.c), mean(&|f| f.k));
        plot.add(format!("Fitted, C {c:.2}, k {k:.2}"), Look::law(0), law(c, k));
    }
    plot.add(format!("C {USUAL_C}, k {USUAL_K}"), Look::law(2), law(USUAL_C, USUAL_K));
    Chart::new(
        grains.id,
        &format!("Discharge of a flat-bottomed bin: {}", grains.kind),
        "Steady rate against the diameter of the opening, each realisation a point.",
        vec![plot],
    )
}
