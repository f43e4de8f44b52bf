//! The angle of repose of the same grains by three methods, over the friction between them.

use pluvia::{
    report::{Axis, Chart, Look, Plot},
    units::from_mm,
};

use super::{
    bench::{Bench, Design, Point, Run},
    row::{Found, Row},
    standard_tests::{Borne, Crossing, Tilted, Turned, carried_up, crossing, sliding_tilt},
};

/// The angle that the paper measured, in degrees.
const WANTED: f64 = 38.40;
/// Mean equivalent diameter of the grains in m.
const SIZE: f64 = 0.0105;
/// Share of a grain by which grains have slid where a box is read.
const SLID: f64 = 0.2;
/// Tilt in degrees up to which they turn with the box.
const RIGID: f64 = 10.0;
/// Axis of the tilting box in m along x.
const AXIS: f64 = 0.060;

/// Part of its turn from which on a drum is read, and time in s in which `drum.json` slows it down
/// at the end.
const LATER: f64 = 0.5;
const SLOWS_DOWN: f64 = 0.5;

/// A method of measuring.
struct Method {
    id: &'static str,
    name: &'static str,
    scenario: &'static str,
    read: fn(&Run) -> Result<Option<f64>, String>,
}

const METHODS: [Method; 3] = [
    Method { id: "pile", name: "Pile", scenario: "scenarios/quick/repose.json", read: pile },
    Method {
        id: "tilting-box",
        name: "Tilting box",
        scenario: "scenarios/validation/tilting-box.json",
        read: tilting_box,
    },
    Method {
        id: "drum",
        name: "Drum, 5 revolutions a minute",
        scenario: "scenarios/validation/drum.json",
        read: drum,
    },
];

/// Runs the test.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let frictions: &[f64] = match bench.design {
        Design::Quick => &[0.2, 0.5],
        Design::Small => &[0.1, 0.3, 0.5, 0.8],
        Design::Full => &[0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0],
    };
    let mut rows = Vec::new();
    let mut plot = Plot::new(
        Axis::linear("Friction coefficient between grains").from_zero(),
        Axis::linear("Angle (degrees)").from_zero(),
    );
    plot.mark_level("38.40°", WANTED);
    let methods = if bench.is_quick() { &METHODS[..2] } else { &METHODS[..] };
    for (kind, method) in methods.iter().enumerate() {
        let point = |mu: &f64| Point {
            name: format!("friction-{mu}"),
            changes: vec![format!("contact.grain_grain_friction={mu}")],
            most: None,
        };
        let points: Vec<Point> = frictions.iter().map(point).collect();
        let name = format!("repose-{}", method.id);
        let runs = bench.run(&name, method.scenario, &points)?;
        let mut angles: Vec<(u32, f64, f64)> = Vec::new();
        for run in &runs {
            match (method.read)(run)? {
                Some(angle) => angles.push((run.configuration, frictions[run.point], angle)),
                None => {
                    let run = run.folder.file_name().unwrap_or_default().to_string_lossy();
                    bench.leave_out(format!("{run} of {name} (no angle)"));
                }
            }
        }
        let curve = |configuration: u32| -> Vec<(f64, Option<f64>)> {
            let is_of = |mu: f64, a: &(u32, f64, f64)| a.0 == configuration && a.1 == mu;
            let at = |mu: &f64| (*mu, angles.iter().find(|a| is_of(*mu, a)).map(|a| a.2));
            frictions.iter().map(at).collect()
        };
        let found: Vec<Crossing> =
            (1..=bench.configurations).map(|c| crossing(&curve(c), WANTED)).collect();
        let place = |found: &Crossing| match found {
            Crossing::At { place, .. } => Some(*place),
            _ => None,
        };
        let values: Vec<f64> = found.iter().filter_map(place).collect();
        let all_angles: Vec<f64> = angles.iter().map(|a| a.2).collect();
        let quantity = format!("friction coefficient at 38.40°, {}", method.name.to_lowercase());
        let note = note(&found, frictions, &all_angles);
        let id = format!("repose-{}", method.id);
        rows.push(Row::of("repose", &id, &quantity, &values).noted(note));
        let at = |mu: f64| {
            let own: Vec<f64> = angles.iter().filter(|a| a.1 == mu).map(|a| a.2).collect();
            Some((mu, pluvia::measure::statistics::mean(&own)?))
        };
        let points = frictions.iter().filter_map(|mu| at(*mu)).collect();
        plot.add(method.name, Look::marked(kind), points);
    }
    let identity = (0..=40).map(|n| 0.025 * f64::from(n)).map(|mu| (mu, mu.atan().to_degrees()));
    plot.add("atan μ", Look::law(4), identity.collect());
    let seen = "Angle against the friction between grains, means over realisations.";
    let chart = Chart::new("repose", "Angle of repose by three methods", seen, vec![plot]);
    Ok(Found { rows, charts: vec![chart] })
}

/// What must be known of where the curves of realisations cross the line, by all angles in degrees.
fn note(found: &[Crossing], frictions: &[f64], angles: &[f64]) -> String {
    let all = found.len();
    let count = |is: fn(&Crossing) -> bool| found.iter().filter(|of| is(of)).count();
    let several = count(|of| matches!(of, Crossing::At { times: 2.., .. }));
    let nowhere = count(|of| matches!(of, Crossing::Nowhere));
    let unknown = count(|of| matches!(of, Crossing::Unknown));
    let mut text =
        "On straight lines between neighbouring frictions, realisation by realisation".to_owned();
    if several > 0 {
        text += &format!(
            "; {several} of {all} cross 38.40° several times, of which the middle counts, of an \
             even number the mean of the middle two"
        );
    }
    if let (1.., [first, .., last]) = (nowhere, frictions) {
        let lowest = angles.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        text += &format!(
            "; {nowhere} of {all} do not cross 38.40° between {first} and {last}: angles of all \
             are {lowest:.1}° to {highest:.1}°"
        );
    }
    let missing = all * frictions.len() - angles.len();
    if missing > 0 {
        let runs = all * frictions.len();
        text += &format!("; {missing} of {runs} runs are left out or have no angle");
    }
    if unknown > 0 {
        text += &format!(", so that the crossing of {unknown} of {all} realisations is not known");
    }
    text
}

/// Slope of a pile, in degrees.
fn pile(run: &Run) -> Result<Option<f64>, String> {
    run.summary("/angle_of_repose/degrees")
}

/// Tilt in degrees at which the grains of a box slide.
fn tilting_box(run: &Run) -> Result<Option<f64>, String> {
    let mut names = vec!["stage"];
    let columns: Vec<String> = ["floor", "walls"]
        .iter()
        .flat_map(|piece| {
            ["x_mm", "z_mm", "force_x_n", "force_z_n", "moment_y_n_m"]
                .map(|c| format!("{piece}_{c}"))
        })
        .collect();
    names.extend(columns.iter().map(String::as_str));
    let names: [&str; 11] = names.try_into().map_err(|_| "11 columns")?;
    let rows = run.series(names)?;
    // The origin of the walls is the middle of the level floor, that of the floor lies below it.
    let borne = |row: &[f64; 11]| -> [Borne; 2] {
        [6, 1].map(|n| Borne {
            at: [from_mm(row[n]), from_mm(row[n + 1])],
            force: [row[n + 2], row[n + 3]],
            moment: row[n + 4],
        })
    };
    let Some(level) = rows.iter().rfind(|row| row[0] == 0.0).map(borne) else { return Ok(None) };
    // The first of these is at the moment at which the box begins to turn.
    let samples: Vec<[Borne; 2]> = rows.iter().filter(|row| row[0] == 1.0).map(borne).collect();
    let turning = samples.windows(2).map(|pair| Tilted::between(&pair[0], &pair[1], AXIS));
    let moments: Vec<Tilted> =
        std::iter::once(Tilted::between(&level, &level, AXIS)).chain(turning).collect();
    Ok(sliding_tilt(&moments, RIGID.to_radians(), SLID * SIZE).map(f64::to_degrees))
}

/// Angle in degrees by which the centre of mass of the grains in a turning drum is carried up,
/// on average over the second half of the turn until it slows down.
fn drum(run: &Run) -> Result<Option<f64>, String> {
    let rows = run.series(["time_s", "stage", "potential_energy_j", "drum_moment_y_n_m"])?;
    let turning: Vec<&[f64; 4]> = rows.iter().filter(|row| row[1] == 1.0).collect();
    let [first, .., last] = turning[..] else { return Ok(None) };
    let (began, duration) = (first[0], last[0] - first[0]);
    let samples: Vec<Turned> = turning
        .iter()
        .map(|row| Turned { time: row[0] - began, energy: row[2], moment: row[3] })
        .collect();
    // The axis is at height 0, above which energies are.
    let angle = carried_up(&samples, LATER * duration, duration - SLOWS_DOWN);
    Ok(angle.map(f64::to_degrees))
}
