//! The loosest and the densest state of grains.

use pluvia::{
    report::{Axis, Chart, Look, Plot},
    scenario::Override,
    study::{self, DensityOptions, IndexDensities, IndexState, OfStates},
};

use super::{
    bench::{Bench, Run},
    legend::{names, realisations},
    references::{BASALT_STATES, GRAVEL_STATES, VOID_RATIO},
    row::{Found, Row},
    tree::root,
};

/// A material whose index densities are looked for.
struct Material {
    /// The scenario's name, and that of its rows.
    name: &'static str,
    /// What it is called in rows.
    title: &'static str,
    /// Of its grains; without one their edges are sharp.
    roundness: Option<f64>,
    /// Void ratios of the loosest and the densest state, where they are published.
    published: Option<(f64, f64)>,
    /// What may explain a miss.
    tried: &'static [Tried],
}

/// A change with which a miss may go away.
struct Tried {
    /// Its name, of folders and rows.
    name: &'static str,
    /// What it is called in rows.
    title: &'static str,
    /// What it changes in the scenario.
    changes: &'static [&'static str],
    /// What else changes with that, for the notes of its rows.
    besides: &'static str,
}

/// Crushed grains, and many of a river, are longer and flatter than cells of random points, whose
/// axes have ratios of 1.3 in the median: with these both are 1.5 to 1.7 (`pluvia grains`), about the
/// end of what counts as equidimensional. Grains are rough, too: more friction stands for what is
/// smaller than the faces of a cell.
const fn tried(besides: &'static str) -> [Tried; 3] {
    let long_flat = Tried {
        name: "long-flat",
        title: "longer and flatter grains (both ratios of their axes 1.5 to 1.7 in the median)",
        changes: &["grains.cells.elongation=1.6", "grains.cells.flatness=1.6"],
        besides,
    };
    let rough = Tried {
        name: "rough",
        title: "friction between grains of 1.0",
        changes: &["contact.grain_grain_friction=1"],
        besides: "",
    };
    let together = Tried {
        name: "long-flat-rough",
        title: "both together",
        changes: &[
            "grains.cells.elongation=1.6",
            "grains.cells.flatness=1.6",
            "contact.grain_grain_friction=1",
        ],
        besides,
    };
    [long_flat, rough, together]
}

const OF_BASALT: [Tried; 3] =
    tried("; medians of the axes 1.66 and 1.63, D50 10.5 in place of 11.2 mm");
const OF_GRAVEL: [Tried; 3] =
    tried("; medians of the axes 1.57 and 1.52, D50 10.8 in place of 11.8 mm");

const GRAVEL: usize = 1;
const MATERIALS: [Material; 3] = [
    Material {
        name: "basalt",
        title: "crushed basalt",
        roundness: Some(0.19),
        published: Some(BASALT_STATES),
        tried: &OF_BASALT,
    },
    Material {
        name: "gravel",
        title: "river gravel",
        roundness: Some(0.45),
        published: Some(GRAVEL_STATES),
        tried: &OF_GRAVEL,
    },
    // What relative densities of the other tests need.
    Material {
        name: "fraction",
        title: "the grains of shear box, oedometer and triaxial test",
        roundness: None,
        published: None,
        tried: &[],
    },
];

/// A vertical vibration.
struct Vibration {
    /// Ending of its folder of runs.
    name: &'static str,
    surcharge_kpa: f64,
    frequency_hz: f64,
    double_amplitude_mm: f64,
    /// How long it is in the small designs, and in the full one, in s.
    duration_s: [f64; 2],
    /// How long it is at most where it has not come to its end by then.
    longest_s: [f64; 2],
    /// Largest number of realisations.
    most: u32,
}

/// What makes grains dense within seconds.
const STRONG: Vibration = Vibration {
    name: "vibrated",
    surcharge_kpa: 0.0,
    frequency_hz: 12.0,
    double_amplitude_mm: 8.0,
    duration_s: [8.0, 60.0],
    longest_s: [32.0, 240.0],
    most: u32::MAX,
};

/// How long ASTM D4253 vibrates, in s.
const EIGHT_MINUTES_S: f64 = 480.0;

/// As that has it, but beginning shorter.
const STANDARD: Vibration = Vibration {
    name: "d4253",
    surcharge_kpa: 13.8,
    frequency_hz: 60.0,
    double_amplitude_mm: 0.33,
    duration_s: [4.0, 60.0],
    longest_s: [32.0, EIGHT_MINUTES_S],
    most: 1,
};

/// A fall of the void ratio in the second half of a vibration, in motion, from which on it is not
/// at its end.
const ENDED: f64 = 0.1 * VOID_RATIO;

/// Runs the test: of the paper's grains, and of those that are published.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let mut rows = Vec::new();
    if !bench.is_quick() {
        let (found, _) = states(bench, paper(bench), &STRONG)?;
        rows.extend(index_rows("density", "the paper's grains", &found, ["", ""]));
    }
    let mut points = Vec::new();
    let materials = if bench.is_quick() { &MATERIALS[GRAVEL..=GRAVEL] } else { &MATERIALS[..] };
    for material in materials {
        let scenario = format!("validation/density-{}", material.name);
        let (found, duration_s) = states(bench, &scenario, &STRONG)?;
        let edges = match material.roundness {
            Some(roundness) => format!("; roundness {roundness}"),
            None => "; sharp edges".to_owned(),
        };
        let grains = [&edges[..], ", friction between grains 0.5"];
        let begin = format!("density-{}", material.name);
        let mut own = index_rows(&begin, material.title, &found, grains);
        let mut others = Vec::new();
        for tried in bench.unless_quick(material.tried.iter().collect()) {
            let made_of_it = match with_change(bench, &scenario, tried, duration_s) {
                Ok(changed) => {
                    others.extend(tried_rows(&begin, material.title, tried, &changed));
                    told(tried, &found, &changed)
                }
                // What is only tried costs no other row.
                Err(why) => {
                    eprintln!("{scenario}, {}: {why}", tried.name);
                    format!(". Tried with {}, but failed: {}", tried.title, why.replace('\n', " "))
                }
            };
            // The loosest and the densest state.
            own[..2].iter_mut().for_each(|row| row.note += &made_of_it);
        }
        rows.extend(own);
        rows.extend(others);
        if let (Some(roundness), Some(published)) = (material.roundness, material.published) {
            points.push(Compared { roundness, published, found });
        }
    }
    Ok(Found { rows, charts: vec![chart(&points), settling(bench)?] })
}

/// Runs the vibration of ASTM D4253 with the paper's grains.
pub fn vibrate_as_in_the_standard(bench: &Bench) -> Result<Found, String> {
    let (found, _) = states(bench, paper(bench), &STRONG)?;
    let (standard, duration_s) = states(bench, paper(bench), &STANDARD)?;
    let mut rows = as_in_the_standard(&found, &standard, duration_s);
    rows.iter_mut().for_each(|row| "d4253".clone_into(&mut row.test));
    Ok(Found { rows, charts: vec![settling(bench)?] })
}

/// The scenario of the paper's grains.
fn paper(bench: &Bench) -> &'static str {
    if bench.is_small() { "quick/pluviation" } else { "paper/pluviation" }
}

/// Rows of the loosest and the densest state, how far they are from each other, and the bound; with
/// what notes say of the grains' edges, and of their friction, which the bound has not.
fn index_rows(
    begin: &str,
    grains: &str,
    found: &IndexDensities,
    [edges, friction]: [&str; 2],
) -> Vec<Row> {
    let of = |id: &str, what: &str, state: &IndexState, note: &str| {
        let quantity = format!("void ratio of {grains}, {what}");
        let note = made(found, state) + edges + note;
        row(&format!("{begin}-{id}"), &quantity, &state.values).noted(note)
    };
    let states = &found.states;
    // Realisations belong together only where none is left out.
    let is_whole = states.e_max.failures.is_empty() && states.e_min.failures.is_empty();
    let pairs = states.e_max.values.iter().zip(&states.e_min.values);
    let ranges: Vec<f64> = pairs.filter(|_| is_whole).map(|(loose, dense)| loose - dense).collect();
    let less = format!("void ratio of {grains}, loosest less densest");
    let densest = format!("densest{}", sinking(found));
    vec![
        of("e-max", "loosest", &states.e_max, friction),
        of("e-min", &densest, &states.e_min, &(friction.to_owned() + &still_falls(found))),
        row(&format!("{begin}-range"), &less, &ranges),
        of("frictionless", "without friction, a bound", &states.frictionless, ""),
    ]
}

/// The index densities of a material with a change, vibrated as long as it is without, in one
/// realisation where specimens are small.
fn with_change(
    bench: &Bench,
    scenario: &str,
    tried: &Tried,
    duration_s: f64,
) -> Result<IndexDensities, String> {
    let most = if bench.is_small() { 1 } else { u32::MAX };
    let out = format!("{}-{}", folder(scenario, &STRONG), tried.name);
    let change = |text: &&str| text.parse::<Override>().map_err(|e| e.to_string());
    let changes = tried.changes.iter().map(change).collect::<Result<Vec<_>, String>>()?;
    vibrated(bench, scenario, &STRONG, duration_s, (changes, most, &out[..]))
}

/// What a change makes of the void ratios of both states, against the same realisations without it.
fn told(tried: &Tried, found: &IndexDensities, changed: &IndexDensities) -> String {
    let by = |of: fn(&IndexDensities) -> &IndexState| {
        // Realisations are in the order of their numbers only where none is left out.
        let is_whole = of(found).failures.is_empty() && of(changed).failures.is_empty();
        let pairs = of(changed).values.iter().zip(&of(found).values);
        let changes: Vec<f64> = pairs.filter(|_| is_whole).map(|(with, own)| with - own).collect();
        let mean = pluvia::measure::statistics::mean(&changes);
        mean.map_or("not known".to_owned(), |mean| format!("{mean:+.3}"))
    };
    format!(
        ". Tried, changes of the loosest and the densest: with {} {} and {}",
        tried.title,
        by(|of| &of.states.e_max),
        by(|of| &of.states.e_min)
    )
}

/// Rows of a material with a change.
fn tried_rows(begin: &str, grains: &str, tried: &Tried, changed: &IndexDensities) -> [Row; 2] {
    let states = &changed.states;
    let of = |id: &str, state: &str, values: &IndexState, more: &str| {
        let quantity = format!("void ratio of {grains}, {state}, tried: {}", tried.title);
        let id = format!("{begin}-{}-{id}", tried.name);
        let note = made(changed, values) + tried.besides + more;
        row(&id, &quantity, &values.values).noted(note)
    };
    [
        of("e-max", "loosest", &states.e_max, ""),
        of("e-min", &format!("densest{}", sinking(changed)), &states.e_min, &still_falls(changed)),
    ]
}

/// What the vibration of ASTM D4253 makes of the paper's grains in some seconds, and the relative
/// density of that by the index densities found.
fn as_in_the_standard(
    found: &IndexDensities,
    standard: &IndexDensities,
    duration_s: f64,
) -> Vec<Row> {
    let state = &standard.states.e_min;
    let shorter = match duration_s < EIGHT_MINUTES_S {
        true => format!(", but for {duration_s} s"),
        false => String::new(),
    };
    let vibrated = format!("vibrated as in ASTM D4253{shorter}{}", sinking(standard));
    let quantity = format!("void ratio of the paper's grains, {vibrated}");
    let note = made(standard, state) + &still_falls(standard);
    let mut rows = vec![row("density-d4253", &quantity, &state.values).noted(note)];
    if let Some((e_max, e_min)) = found.means.e_max.zip(found.means.e_min) {
        // Its interval and note are derived beside the rows of those states.
        let values: Vec<f64> = state.values.iter().map(|e| (e_max - e) / (e_max - e_min)).collect();
        let quantity = format!("relative density of the paper's grains, {vibrated}");
        rows.push(Row::of("density", "density-d4253-relative", &quantity, &values));
    }
    rows
}

fn row(id: &str, quantity: &str, values: &[f64]) -> Row {
    Row { decimals: 3, ..Row::of("density", id, quantity, values) }
}

/// How a state was made.
fn made(found: &IndexDensities, state: &IndexState) -> String {
    let mut note = format!(
        "{} grains in a mould {:.0} mm wide, {}",
        found.grains, found.mould_diameter_mm, state.method
    );
    for failure in &state.failures {
        note += &format!("; {failure}");
    }
    note
}

/// By how much the void ratio fell in the second half of the vibration; `None` where no realisation
/// says so.
fn second_half(found: &IndexDensities) -> Option<f64> {
    pluvia::measure::statistics::mean(&found.second_half)
}

/// What is said beside a state whose vibration has not come to an end, or where that is not known.
fn sinking(found: &IndexDensities) -> &'static str {
    match second_half(found) {
        Some(fall) if fall > ENDED => ", still sinking",
        Some(_) => "",
        None => ", end not known",
    }
}

/// Whether the vibration has come to an end.
fn still_falls(found: &IndexDensities) -> String {
    second_half(found).map_or_else(String::new, |fall| {
        format!("; in motion it changed by {:+.3} in the second half of that time", -fall)
    })
}

/// Share of a cycle within which two moments are the same.
const SAME_MOMENT: f64 = 0.02;

/// The folder of a scenario's runs, in that of all.
fn folder(scenario: &str, vibration: &Vibration) -> String {
    format!("{}-{}", scenario.replace("validation/", "").replace('/', "-"), vibration.name)
}

/// How specimens sink while they are vibrated, of what was run now, and of what earlier commands
/// have noted of other vibrations: runs that a command has left in these folders unfinished are of
/// no row.
fn settling(bench: &Bench) -> Result<Chart, String> {
    let mut plot = Plot::new(
        Axis::linear("Time of vibration (s)").from_zero(),
        Axis::linear("Mean surface over its height at the end"),
    );
    let paper = paper(bench);
    let own = [(paper, "The paper's grains", &STRONG), (paper, "The same, 60 Hz", &STANDARD)];
    let published: Vec<(String, &str)> = MATERIALS
        .iter()
        .filter(|material| material.published.is_some())
        .map(|material| (format!("validation/density-{}", material.name), material.title))
        .collect();
    let published = published.iter().map(|(path, title)| (&path[..], *title, &STRONG));
    let (mut kinds, mut lines) = (Vec::new(), Vec::new());
    for (kind, (scenario, title, vibration)) in own.into_iter().chain(published).enumerate() {
        kinds.push(title.to_owned());
        let name = folder(scenario, vibration);
        let out = bench.options(&name).out;
        for configuration in bench.shaken(&name) {
            let folder = out.join(format!("runs/densest-c{configuration}"));
            // Those of an earlier command may be gone.
            if !folder.is_dir() {
                continue;
            }
            let run = Run { point: 0, configuration, folder };
            let rows = run.series(["time_s", "stage", "mean_surface_mm"])?;
            let Some(last) = rows.last() else { continue };
            let shaken: Vec<&[f64; 3]> = rows.iter().filter(|row| row[1] == last[1]).collect();
            // Beds heave with the table: only heights at the same moment of its cycle compare.
            let off = |time: f64| {
                let cycles = time * vibration.frequency_hz;
                (cycles - cycles.round()).abs()
            };
            let points = shaken.iter().map(|row| (row[0] - shaken[0][0], row[2] / last[2]));
            let points = points.filter(|(time, _)| off(*time) < SAME_MOMENT);
            lines.push((kind, points.collect::<Vec<_>>()));
        }
    }
    let of: Vec<usize> = lines.iter().map(|line| line.0).collect();
    for ((kind, points), name) in lines.into_iter().zip(names(&kinds, &of)) {
        plot.add(name, Look::marked(kind), points);
    }
    Ok(Chart::new(
        "density-vibration",
        "How specimens sink while they are vibrated",
        "Mean surface against time, at the same moment of the table's cycle, each realisation a \
         line. Where it still falls, the vibration has not come to its end.",
        vec![plot],
    ))
}

/// Index densities after the shortest vibration that has come to its end, and its duration in s:
/// one that has not is done anew, twice as long, up to the longest; not in the quick design. Where
/// no realisation says whether it has, a longer one is not tried.
fn states(
    bench: &Bench,
    scenario: &str,
    vibration: &Vibration,
) -> Result<(IndexDensities, f64), String> {
    let design = usize::from(!bench.is_small());
    let out = folder(scenario, vibration);
    let mut duration_s = vibration.duration_s[design];
    bench.note_shaken(&out, None)?;
    loop {
        let alike = (Vec::new(), vibration.most, &out[..]);
        let found = vibrated(bench, scenario, vibration, duration_s, alike)?;
        let longer = 2.0 * duration_s;
        let sinks_on = second_half(&found).is_some_and(|fall| fall > ENDED);
        if !sinks_on || bench.is_quick() || longer > vibration.longest_s[design] {
            let of = &found.states.e_min;
            let shaken = realisations("densest", of.values.len(), &of.failures);
            bench.note_shaken(&out, Some(shaken))?;
            return Ok((found, duration_s));
        }
        duration_s = longer;
    }
}

/// Index densities after a vibration of a duration, with changes in the scenario, in at most `most`
/// realisations, in a folder.
fn vibrated(
    bench: &Bench,
    scenario: &str,
    vibration: &Vibration,
    duration_s: f64,
    (changes, most, out): (Vec<Override>, u32, &str),
) -> Result<IndexDensities, String> {
    let options = DensityOptions {
        scenario: root().join(format!("scenarios/{scenario}.json")),
        changes,
        configurations: bench.configurations.min(most),
        surcharge_kpa: vibration.surcharge_kpa,
        frequency_hz: vibration.frequency_hz,
        double_amplitude_mm: vibration.double_amplitude_mm,
        duration_s,
    };
    let run = bench.options(out);
    study::density(options).and_then(|study| study.carry_out(&run)).map_err(|e| e.to_string())
}

/// States of a material whose index densities are published.
struct Compared {
    roundness: f64,
    /// Loosest and densest.
    published: (f64, f64),
    found: IndexDensities,
}

fn chart(compared: &[Compared]) -> Chart {
    type Value = fn(&Compared) -> Vec<f64>;
    let roundness = Axis::linear("Roundness").holding(compared.iter().map(|of| of.roundness));
    let all = compared.iter().flat_map(|of| {
        let OfStates { e_max, e_min, frictionless } = &of.found.states;
        let ours = [e_max, e_min, frictionless].into_iter().flat_map(|state| &state.values);
        ours.copied().chain(<[f64; 2]>::from(of.published)).collect::<Vec<f64>>()
    });
    let void_ratio = Axis::linear("Void ratio").holding(all).clear_of_frame();
    let mut plot = Plot::new(roundness.clear_of_frame(), void_ratio);
    let mut add = |name: &str, look, values: Value| {
        let points =
            compared.iter().flat_map(|of| values(of).into_iter().map(|e| (of.roundness, e)));
        plot.add(name, look, points.collect());
    };
    add("Loosest", Look::points(0), |of| of.found.states.e_max.values.clone());
    add("Densest", Look::points(1), |of| of.found.states.e_min.values.clone());
    add("Without friction", Look::points(2), |of| of.found.states.frictionless.values.clone());
    add("Published, loosest", Look::points(3), |of| vec![of.published.0]);
    add("Published, densest", Look::points(4), |of| vec![of.published.1]);
    Chart::new(
        "density",
        "Loosest and densest states of published materials",
        "Void ratio over roundness: each realisation, and what is published.",
        vec![plot],
    )
}
