//! Deposits whose area reaches beyond the opening of the container that they fall into: reported, not
//! refused.

use super::volumes_of_pieces::flats;
use super::*;
use crate::plain::four_digits;

/// Share of a length that its rounding may make of it.
const ROUNDING: f64 = 1e-9;

/// What an upright container, open above, has for grains to fall into.
struct Opening<'a> {
    piece: &'a PieceSpec,
    /// From this height on it is as wide as at its rim, in mm.
    full_from: f64,
    /// Height of the rim in mm.
    rim: f64,
    inside: Inside,
    /// Its size, for a reader.
    size: String,
}

/// How far an opening reaches from its middle, in mm.
enum Inside {
    /// Along x and y.
    Rectangle([f64; 2]),
    /// In every direction: the corners of the polygon.
    Circle(f64),
}

/// Where a deposit lets grains go, in mm.
struct Area {
    middle: [f64; 3],
    /// Half of its sizes along x and y.
    half: [f64; 2],
    is_round: bool,
}

/// Notes deposits, before any stage that may move a piece, whose area is wider than the opening below;
/// of a begun specimen only its run knows where pieces are.
pub(super) fn check(scenario: &Scenario, grading: &Grading, faults: &mut Faults) {
    if scenario.begin.is_some() {
        return;
    }
    let grain = to_mm(grading.sizes.median) / 2.0;
    for (i, stage) in scenario.stages.iter().enumerate() {
        let deposit = match stage {
            StageSpec::Deposit(deposit) => deposit,
            StageSpec::Rest { .. } => continue,
            _ => return,
        };
        let Some(area) = area(deposit) else { continue };
        let Some(opening) = under(&scenario.pieces, &area) else { continue };
        let (field, found) = match deposit.area_mm {
            Some(sides) => ("area_mm", format!("{sides:?}")),
            None => ("diameter_mm", four_digits(2.0 * area.half[0])),
        };
        let [x, y, _] = opening.piece.at_mm.map(four_digits);
        let allowed = format!("an area within {} about ({x}, {y})", opening.size);
        let why = format!(
            "the area reaches beyond the opening of `{}`: grains that begin outside of it come to lie \
             on its rim, or fall beside it",
            opening.piece.name
        );
        let wrong = !opening.holds(&area, grain);
        faults.add_if(wrong, &format!("stages[{i}].{field}"), found, allowed, why);
    }
}

fn area(deposit: &DepositSpec) -> Option<Area> {
    let half = |size: f64| size / 2.0;
    let rectangle = deposit.area_mm.map(|sides| sides.map(half));
    let circle = deposit.diameter_mm.map(|diameter| [half(diameter); 2]);
    let is_round = rectangle.is_none();
    Some(Area { middle: deposit.at_mm, half: rectangle.or(circle)?, is_round })
}

/// The opening that the middle of an area lies over or in, of several the highest; none where another
/// piece may catch or deflect what would miss it.
fn under<'a>(pieces: &'a [PieceSpec], area: &Area) -> Option<Opening<'a>> {
    let Area { middle, half, .. } = *area;
    let openings = pieces.iter().filter_map(opening);
    let below = openings.filter(|of| middle[2] >= of.full_from && of.holds_middle(&middle));
    let opening = below.max_by(|a, b| a.rim.total_cmp(&b.rim))?;
    let ([low, high], rim) = (opening.piece.extent_mm()?, opening.rim);
    let is_harmless = |piece: &PieceSpec| {
        let Some([from, to]) = piece.extent_mm() else { return false };
        let is_above = from.z >= middle[2];
        let is_beside =
            (0..2).any(|k| to[k] <= middle[k] - half[k] || from[k] >= middle[k] + half[k]);
        let is_within = (0..2).all(|k| from[k] >= low[k] && to[k] <= high[k]) && to.z <= rim;
        is_above || is_beside || is_within
    };
    let mut others = pieces.iter().filter(|piece| piece.name != opening.piece.name);
    others.all(is_harmless).then_some(opening)
}

/// The opening of a container that stands as it is drawn, with walls all around.
fn opening(piece: &PieceSpec) -> Option<Opening<'_>> {
    if piece.rotation_deg != [0.0; 3] {
        return None;
    }
    let round = |sides: u32, diameter: f64| {
        let corner = flats(sides, diameter / 2.0) / (PI / f64::from(sides)).cos();
        (Inside::Circle(corner), format!("a diameter of {} mm", four_digits(diameter)))
    };
    let (full_from, rim, (inside, size)) = match &piece.shape {
        ShapeSpec { r#box: Some(b), .. } if b.open.contains(&BoxSide::Top) => {
            // Of a box without one of its walls this is none.
            piece.shape.holds_mm3()?;
            let [x, y, height] = b.inner_mm;
            let size = format!("{} × {} mm", four_digits(x), four_digits(y));
            (0.0, height, (Inside::Rectangle([x / 2.0, y / 2.0]), size))
        }
        ShapeSpec { cylinder: Some(c), .. } if c.open_top => {
            (0.0, c.height_mm, round(c.sides, c.inner_diameter_mm))
        }
        ShapeSpec { hopper: Some(h), .. } => {
            let slope = h.height_mm();
            (slope, slope + h.collar_mm, round(h.sides, h.top_diameter_mm))
        }
        _ => return None,
    };
    let z = piece.at_mm[2];
    Some(Opening { piece, full_from: z + full_from, rim: z + rim, inside, size })
}

impl Opening<'_> {
    /// How far a place is off its middle along x and y, in mm.
    fn off(&self, place: &[f64; 3]) -> [f64; 2] {
        [0, 1].map(|k: usize| (place[k] - self.piece.at_mm[k]).abs())
    }

    fn holds_middle(&self, place: &[f64; 3]) -> bool {
        let [x, y] = self.off(place);
        match self.inside {
            Inside::Rectangle(half) => x < half[0] && y < half[1],
            Inside::Circle(radius) => x.hypot(y) < radius,
        }
    }

    /// Whether balls of a radius in mm that begin within an area begin within the opening.
    fn holds(&self, area: &Area, ball: f64) -> bool {
        let (off, half) = (self.off(&area.middle), area.half);
        let (reach, radius) = match self.inside {
            Inside::Rectangle(inner) => {
                let fits = |k: usize| off[k] + half[k] <= inner[k] * (1.0 + ROUNDING);
                return fits(0) && fits(1);
            }
            Inside::Circle(radius) if area.is_round => (off[0].hypot(off[1]) + half[0], radius),
            Inside::Circle(radius) => {
                // They do not reach the corners.
                let [x, y] = [0, 1].map(|k: usize| off[k] + (half[k] - ball).max(0.0));
                (x.hypot(y) + ball, radius)
            }
        };
        reach <= radius * (1.0 + ROUNDING)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of the areas of deposits above pieces.
    fn said(pieces: &Value, deposit: &Value) -> Vec<String> {
        let mut stage = json!({ "stage": "deposit", "rate_g_per_s": 60 });
        for (field, value) in deposit.as_object().expect("fields") {
            stage[field] = value.clone();
        }
        let scenario = json!({
            "name": "s",
            "grains": { "total_mass_g": 10, "density_kg_per_m3": 2710, "sieve_table":
                [{ "passing_mm": 8, "retained_mm": 6.3, "mass_percent": 100 }] },
            "pieces": pieces,
            "stages": [stage]
        });
        let scenario: Scenario = serde_json::from_value(scenario).expect("a scenario");
        let mut found = Vec::new();
        let grading = scenario.grading().expect("sizes");
        check(&scenario, &grading, &mut Faults::of(&mut found));
        found.iter().map(ToString::to_string).collect()
    }

    /// A piece of a name, at a height above the origin.
    fn piece(name: &str, z: f64, shape: Value) -> Value {
        json!({ "name": name, "shape": shape, "at_mm": [0, 0, z] })
    }

    fn shear_box() -> Vec<Value> {
        let of = |height: f64, open: Value| {
            let inner_mm = [40.0, 40.0, height];
            json!({ "box": { "inner_mm": inner_mm, "wall_mm": 5, "open": open } })
        };
        let lid = json!({ "plate": { "size_mm": [39, 39, 5] } });
        vec![
            piece("lower", 0.0, of(14.0, json!(["top"]))),
            piece("upper", 14.0, of(40.0, json!(["top", "bottom"]))),
            piece("lid", 90.0, lid),
        ]
    }

    /// Law: an area that is wider than the opening below is known before the run, in a box, a cylinder
    /// and a hopper; one that fits is fine.
    #[test]
    fn an_area_wider_than_the_opening_below_is_known() {
        let cup = json!([piece(
            "cup",
            0.0,
            json!({ "cylinder": { "inner_diameter_mm": 80, "height_mm": 50 } })
        )]);
        let bin = json!([piece(
            "bin",
            100.0,
            json!({ "hopper": { "opening_diameter_mm": 40,
            "top_diameter_mm": 80, "half_angle_deg": 30, "collar_mm": 20 } })
        )]);
        let boxes = Value::from(shear_box());
        for (pieces, name, deposit, is_wide) in [
            (&boxes, "upper", json!({ "at_mm": [0, 0, 60], "area_mm": [60, 60] }), true),
            (&boxes, "upper", json!({ "at_mm": [0, 0, 60], "area_mm": [40, 41] }), true),
            (&boxes, "upper", json!({ "at_mm": [9, 0, 60], "area_mm": [30, 30] }), true),
            (&boxes, "upper", json!({ "at_mm": [0, 0, 60], "diameter_mm": 42 }), true),
            (&boxes, "upper", json!({ "at_mm": [5, 0, 60], "area_mm": [30, 40] }), false),
            (&boxes, "upper", json!({ "at_mm": [0, 0, 40], "diameter_mm": 40 }), false),
            (&cup, "cup", json!({ "at_mm": [0, 0, 60], "diameter_mm": 82 }), true),
            (&cup, "cup", json!({ "at_mm": [0, 0, 60], "area_mm": [70, 70] }), true),
            (&cup, "cup", json!({ "at_mm": [0, 0, 60], "diameter_mm": 80 }), false),
            (&cup, "cup", json!({ "at_mm": [0, 0, 60], "area_mm": [58, 58] }), false),
            (&bin, "bin", json!({ "at_mm": [0, 0, 170], "diameter_mm": 82 }), true),
            (&bin, "bin", json!({ "at_mm": [0, 0, 170], "diameter_mm": 80 }), false),
            (&bin, "bin", json!({ "at_mm": [0, 0, 110], "diameter_mm": 82 }), false),
        ] {
            let got = said(pieces, &deposit);
            let words = format!("the area reaches beyond the opening of `{name}`");
            let is_said = got.len() == 1 && got[0].contains(&words);
            assert_eq!(
                (is_said, got.is_empty()),
                (is_wide, !is_wide),
                "law: {deposit}, got {got:?}"
            );
        }
        let got = said(&boxes, &json!({ "at_mm": [0, 0, 60], "area_mm": [60, 60] }));
        let place = "stages[0].area_mm: ";
        let allowed = "(found [60.0, 60.0]; allowed: an area within 40 × 40 mm about (0, 0))";
        let is_whole = got[0].starts_with(place) && got[0].ends_with(allowed);
        assert!(is_whole, "law: expected `{place}…{allowed}`, got {got:?}");
    }

    /// Law: nothing is said where another piece may catch or deflect what begins outside an opening:
    /// a floor below, a hopper above, a second container, a plate between.
    #[test]
    fn what_other_pieces_catch_may_be_meant() {
        let wide = json!({ "at_mm": [0, 0, 60], "area_mm": [60, 60] });
        let plate = |size: [f64; 3]| json!({ "plate": { "size_mm": size } });
        let mut beside =
            piece("second", 0.0, json!({ "box": { "inner_mm": [40, 40, 40], "wall_mm": 5 } }));
        beside["at_mm"] = json!([50, 0, 0]);
        let mouth = json!({ "hopper": { "opening_diameter_mm": 30, "top_diameter_mm": 90,
            "half_angle_deg": 60 } });
        let mut turned = shear_box();
        turned[1]["rotation_deg"] = json!([0, 10, 0]);
        let with = |other: Value| [shear_box(), vec![other]].concat();
        let above = json!({ "at_mm": [0, 0, 85], "area_mm": [60, 60] });
        for (what, pieces, deposit) in [
            ("a floor", with(piece("floor", -20.0, plate([300.0, 300.0, 10.0]))), &wide),
            ("a hopper's mouth", with(piece("hopper", 55.0, mouth)), &above),
            ("a second box", with(beside), &wide),
            ("a chute between", with(piece("chute", 57.0, plate([20.0, 20.0, 4.0]))), &wide),
            ("a box that is turned", turned, &wide),
        ] {
            let got = said(&Value::from(pieces), deposit);
            assert!(got.is_empty(), "law: {what} may be meant, got {got:?}");
        }
        let floor = json!([
            piece("floor", -5.0, plate([300.0, 300.0, 10.0])),
            piece("cup", 0.0, json!({ "cylinder": { "inner_diameter_mm": 30, "height_mm": 20 } }))
        ]);
        let got = said(&floor, &json!({ "at_mm": [60, 0, 60], "area_mm": [60, 60] }));
        assert!(got.is_empty(), "law: beside a piece on a floor, got {got:?}");
    }
}
