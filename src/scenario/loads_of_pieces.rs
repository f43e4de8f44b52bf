//! What pieces press on grains that are pressed or let go, as far as it is known beforehand: by their
//! loads, by their weights, and by what stands on them.

use std::collections::BTreeSet;

use super::*;
use crate::units::from_kpa;

/// Overlap in mm, seen from above, that is rounding: pieces side by side do not stand on each other.
const SIDE_BY_SIDE: f64 = 1e-6;

/// A piece that is pressed or has been let go.
#[derive(Debug, Clone, Copy)]
struct Load {
    /// Stress in Pa along the direction in which it moves.
    stress: f64,
    /// Area in m² that it shows along that.
    area: f64,
    /// Share of a weight that acts along that: 1 downwards, 0 sideways, upwards and of what turns.
    falls: f64,
    /// Whether it moves freely: pieces that do not pass through each other.
    is_free: bool,
}

impl Load {
    /// Force in N with which it presses what it stands on.
    fn downwards(&self) -> f64 {
        self.stress * self.area * self.falls
    }
}

/// The largest stress in Pa that pressed and free pieces put on what lies below or before them, in
/// any stage, as they were put up; 0 without any. `gravity` in m/s² makes weights of masses, and `up`
/// is the largest acceleration in m/s² with which everything is shaken upwards beside that.
pub(super) fn stress_of_pieces(value: &Value, gravity: f64, up: f64) -> f64 {
    let pieces: Vec<PieceSpec> = elements(value, "pieces").filter_map(read::<PieceSpec>).collect();
    let extents: Vec<Option<[Vector; 2]>> = pieces.iter().map(PieceSpec::extent_mm).collect();
    let mut loads: Vec<Option<Load>> = vec![None; pieces.len()];
    let mut most = 0.0_f64;
    for stage in elements(value, "stages") {
        change(&mut loads, &pieces, stage, [gravity, up]);
        for n in 0..loads.len() {
            // Not of numbers that are faults.
            most = most
                .max(stress_under(n, &loads, &extents).filter(|s| s.is_finite()).unwrap_or(0.0));
        }
    }
    most
}

/// Notes which pieces are pressed and free from a stage on.
fn change(
    loads: &mut [Option<Load>],
    pieces: &[PieceSpec],
    stage: &Value,
    [gravity, up]: [f64; 2],
) {
    let number = |name: &str| pieces.iter().position(|piece| piece.name == name);
    let named = elements(stage, "pieces").filter_map(Value::as_str).filter_map(number);
    let named: Vec<usize> = named.collect();
    match stage["stage"].as_str() {
        Some("release") => {
            let mass = stage["mass_g"].as_f64().map(from_g);
            for n in named {
                loads[n] = let_go(&pieces[n], mass, gravity + up);
            }
        }
        Some("press") => {
            for load in elements(stage, "loads").filter_map(read::<LoadSpec>) {
                if let Some(n) = number(&load.piece) {
                    loads[n] = pressed(&pieces[n], &load, up);
                }
            }
        }
        Some("move" | "remove") => {
            for n in named {
                loads[n] = None;
            }
        }
        _ => {}
    }
}

/// A piece that is let go, with a mass in kg where one is given.
fn let_go(piece: &PieceSpec, mass: Option<f64>, gravity: f64) -> Option<Load> {
    let weight = mass.or_else(|| piece.usual_mass())? * gravity;
    let area = piece.shows_m2(Vector::z())?;
    Some(Load { stress: weight / area, area, falls: 1.0, is_free: true })
}

/// A piece that is pressed; its weight is part of the load. None where it is locked.
fn pressed(piece: &PieceSpec, load: &LoadSpec, up: f64) -> Option<Load> {
    if load.locked {
        return None;
    }
    if let (None, Some(moment)) = (load.stress_kpa, load.moment_n_m) {
        // Moment in N m by which the piece resists being turned under a pressure of 1 Pa.
        let of_one_pa = piece.shape.turned_mm3()? * 1e-9;
        return Some(Load { stress: moment / of_one_pa, area: 1.0, falls: 0.0, is_free: false });
    }
    let direction = Vector::from(load.direction).try_normalize(0.0)?;
    let area = piece.shows_m2(direction)?;
    let stress = match load.stress_kpa {
        Some(stress) => from_kpa(stress),
        None => load.force_n? / area,
    };
    let falls = (-direction.z).max(0.0);
    let mass = load.mass_g.map(from_g).or_else(|| piece.usual_mass()).unwrap_or(0.0);
    Some(Load { stress: stress + mass * up * falls / area, area, falls, is_free: false })
}

/// The stress in Pa under a piece, with all that stands on it; none of one that is neither pressed
/// nor free.
fn stress_under(n: usize, loads: &[Option<Load>], extents: &[Option<[Vector; 2]>]) -> Option<f64> {
    let load = loads[n]?;
    let on_top = standing_on(n, loads, extents);
    let borne: f64 = on_top.into_iter().filter_map(|n| Some(loads[n]?.downwards())).sum();
    Some(load.stress + borne * load.falls / load.area)
}

/// Numbers of the pressed and free pieces that stand on one, or on others that do: those that were put
/// up higher and, seen from above, over it.
fn standing_on(
    n: usize,
    loads: &[Option<Load>],
    extents: &[Option<[Vector; 2]>],
) -> BTreeSet<usize> {
    let touch = |one: usize, other: usize| {
        let [one, other] = [one, other].map(|n| loads[n].map(|load| load.is_free));
        one.zip(other).is_some_and(|(one, other)| one || other)
    };
    let is_over = |above: usize, below: usize| {
        let Some(([low, high], [floor, roof])) = extents[above].zip(extents[below]) else {
            return false;
        };
        let overlaps =
            |axis: usize| high[axis].min(roof[axis]) - low[axis].max(floor[axis]) > SIDE_BY_SIDE;
        overlaps(0) && overlaps(1) && low.z + high.z > floor.z + roof.z
    };
    let (mut found, mut below) = (BTreeSet::new(), vec![n]);
    while let Some(below_it) = below.pop() {
        let stands = |above: &usize| touch(*above, below_it) && is_over(*above, below_it);
        for above in (0..loads.len()).filter(stands) {
            if found.insert(above) {
                below.push(above);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::near;

    fn close(what: &str, got: f64, expected: f64) {
        near(what, got, expected, 1e-9 * expected);
    }

    /// The largest stress under 10 m/s² of pieces and stages.
    fn stress(pieces: &[Value], stages: &[Value]) -> f64 {
        stress_of_pieces(&json!({ "pieces": pieces, "stages": stages }), 10.0, 0.0)
    }

    fn plate(name: &str, size_mm: [f64; 3], at_mm: [f64; 3]) -> Value {
        json!({ "name": name, "shape": { "plate": { "size_mm": size_mm } }, "at_mm": at_mm })
    }

    fn release(names: &[&str], mass_g: f64) -> Value {
        json!({ "stage": "release", "pieces": names, "mass_g": mass_g })
    }

    #[test]
    fn a_force_presses_by_the_area_that_the_piece_shows_along_it() {
        let stress = |load: Value, turn: [f64; 3]| {
            let mut lid = plate("lid", [100.0, 50.0, 10.0], [0.0; 3]);
            lid["rotation_deg"] = json!(turn);
            stress(
                &[lid],
                &[json!({ "stage": "press", "loads": [load] }), json!({ "stage": "rest" })],
            )
        };
        let down = json!({ "piece": "lid", "force_n": 10 });
        close("10 N on 50 cm²", stress(down.clone(), [0.0; 3]), 2000.0);
        close("on its edge of 10 cm²", stress(down, [90.0, 0.0, 0.0]), 10_000.0);
        let aside = json!({ "piece": "lid", "force_n": 10, "direction": [-2, 0, 0] });
        close("along x on 5 cm²", stress(aside, [0.0; 3]), 20_000.0);
        let typed = json!({ "piece": "lid", "stress_kpa": 7 });
        close("as typed", stress(typed, [0.0; 3]), 7000.0);
        let other = json!({ "piece": "other", "force_n": 10 });
        assert_eq!(stress(other, [0.0; 3]), 0.0, "law: what cannot be read counts for nothing");
    }

    #[test]
    fn a_moment_presses_by_the_blades_that_it_turns() {
        let vane = json!({ "name": "vane", "shape": { "vane": { "diameter_mm": 50, "height_mm": 40,
            "blade_mm": 3, "blades": 4 } } });
        let load = json!({ "piece": "vane", "moment_n_m": 2, "axis": [0, 0, 1] });
        let got = stress(&[vane], &[json!({ "stage": "press", "loads": [load] })]);
        close("2 N m on four blades of 25 by 40 mm", got, 40_000.0);
    }

    /// Law: a piece that is let go weighs what is given, or else what it does in aluminium.
    #[test]
    fn pieces_that_are_let_go_weigh_with_the_mass_that_they_get() {
        let pieces = [plate("lid", [100.0, 50.0, 10.0], [0.0; 3])];
        close("1 kg on 50 cm²", stress(&pieces, &[release(&["lid"], 1000.0)]), 2000.0);
        let stage = json!({ "stage": "release", "pieces": ["lid"] });
        close("50 cm³ of aluminium on 50 cm²", stress(&pieces, &[stage]), 270.0);
    }

    /// Law: pieces that stand on each other press together, those side by side each for itself; the
    /// lowest by its own area, whichever is named first.
    #[test]
    fn pieces_that_stand_on_each_other_press_together() {
        let wide = plate("wide", [100.0, 100.0, 10.0], [0.0, 0.0, 0.0]);
        let small = plate("small", [10.0, 100.0, 10.0], [20.0, 0.0, 20.0]);
        let aside = plate("aside", [100.0, 100.0, 10.0], [100.0, 0.0, 40.0]);
        let both = |pieces: &[Value], names: &[&str]| stress(pieces, &[release(names, 1000.0)]);
        let two = [wide.clone(), small.clone()];
        close("1 kg on 10 cm², on a wide plate", both(&two, &["small", "wide"]), 10_000.0);
        let mut under = small;
        under["at_mm"] = json!([20, 0, -20]);
        let two = [wide.clone(), under];
        close("2 kg on 10 cm²", both(&two, &["small", "wide"]), 20_000.0);
        let same = plate("same", [100.0, 100.0, 10.0], [0.0, 0.0, 30.0]);
        let top = plate("top", [100.0, 100.0, 10.0], [60.0, 60.0, 50.0]);
        let three = [top, same.clone(), wide.clone()];
        close("3 kg, one on another", both(&three, &["top", "same", "wide"]), 3000.0);
        let two = [wide.clone(), aside];
        close("side by side", both(&two, &["wide", "aside"]), 1000.0);
        // In stages one after the other, until one is held again.
        let pieces = [wide, same];
        let [first, second] = ["wide", "same"].map(|name| release(&[name], 1000.0));
        close("from two stages", stress(&pieces, &[first.clone(), second.clone()]), 2000.0);
        let load = json!({ "piece": "wide", "locked": true });
        let held = json!({ "stage": "press", "loads": [load] });
        close(
            "one is locked before",
            stress(&pieces, &[first.clone(), held, second.clone()]),
            1000.0,
        );
        let gone = json!({ "stage": "remove", "pieces": ["wide"] });
        close("one is removed before", stress(&pieces, &[first, gone, second]), 1000.0);
    }

    /// Law: a weight on a pressed lid presses beside its load, one on a plate that is pressed sideways
    /// does not; pressed pieces pass through each other.
    #[test]
    fn a_weight_on_a_pressed_piece_adds_to_its_load() {
        let lid = plate("lid", [100.0, 100.0, 10.0], [0.0, 0.0, 0.0]);
        let weight = plate("weight", [20.0, 20.0, 20.0], [0.0, 0.0, 30.0]);
        let pieces = [lid, weight];
        let press = |piece: &str, direction: [f64; 3]| {
            let load = json!({ "piece": piece, "force_n": 100, "direction": direction });
            json!({ "stage": "press", "loads": [load] })
        };
        let down = [0.0, 0.0, -1.0];
        let let_go = release(&["weight"], 100.0);
        let got = stress(&pieces, &[press("lid", down), let_go.clone()]);
        close("100 N and 1 N on 100 cm²", got, 10_100.0);
        let aside = stress(&pieces, &[press("lid", [1.0, 0.0, 0.0]), let_go]);
        close("100 N sideways on 10 cm²", aside, 100_000.0);
        let both = stress(&pieces, &[press("lid", down), press("weight", down)]);
        close("100 N on 4 cm²", both, 250_000.0);
    }

    /// Law: what is pressed down has to be lifted with what is shaken: m a beside its load.
    #[test]
    fn a_pressed_piece_is_shaken_with_its_mass() {
        let lid = plate("lid", [100.0, 50.0, 10.0], [0.0; 3]);
        let shaken = |load: Value| {
            let value = json!({
                "pieces": [lid], "stages": [{ "stage": "press", "loads": [load] }]
            });
            stress_of_pieces(&value, 10.0, 30.0)
        };
        let load = json!({ "piece": "lid", "force_n": 10, "mass_g": 500 });
        close("10 N and 0.5 kg × 30 m/s² on 50 cm²", shaken(load), 5000.0);
        let load = json!({ "piece": "lid", "stress_kpa": 1 });
        close("1 kPa and 135 g of aluminium", shaken(load), 1810.0);
    }
}
