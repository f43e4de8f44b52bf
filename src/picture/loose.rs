//! Grains alone, laid out in rows by sieve fraction.

use std::collections::VecDeque;

use nalgebra::UnitQuaternion;

use super::paint::paint;
use super::sheet::sheet;
use super::*;
use crate::grains::Grain;
use crate::plain::{counted, grams, without_zeros};
use crate::units::to_g;

/// Rows of each fraction, at most.
pub const ROWS: usize = 3;
/// Grains in a row of the coarsest fraction; finer ones have as many as fit.
const ROW: f64 = 13.0;
/// Angle from one grain to the next about the vertical: the golden angle, so that
/// none lies as its neighbours do.
const TURN: f64 = 2.399_963_229_728_653;
/// Space between grains and between rows, in mean widths of the coarsest fraction.
const SPACE: f64 = 0.22;

/// How loose grains are looked at: from the front, from well above.
pub const VIEW: View = View { azimuth_deg: 0.0, elevation_deg: 60.0 };

/// A picture of up to three rows of grains of each fraction, evenly picked, the
/// coarsest at the back, each on its largest face, beside a bar of known length.
///
/// # Errors
/// Numbers out of range, colours that need a run, text that cannot be drawn.
pub fn loose_grains(grains: &GrainSet, shot: &Shot) -> Result<Image, PictureError> {
    shot.check()?;
    let grains_there = vec![Some(Pose::identity()); grains.grains.len()];
    let all = Frame { grains: grains_there, ..Frame::default() };
    let missing = match shot.colour_by {
        ColourBy::Fraction | ColourBy::Plain => None,
        ColourBy::Displacement => Some("displacement"),
        ColourBy::Speed => Some("speed"),
        ColourBy::Coordination => Some("contacts"),
    };
    if let Some(missing) = missing {
        return Err(PictureError::NeedsRun(missing));
    }
    let moments = Moments { now: &all, before: None, began: None };
    let (colours, key) = paint(grains, &moments, shot.colour_by, None)?;
    let (bodies, bar) = laid_out(grains, &colours)?;
    let shown = bodies.len() - 1;
    let scene = Scene::new(bodies, Some(0.0));
    let notes = Notes {
        key,
        things: vec![(Colour::BAR, format!("bar: {} mm", number(to_mm(bar))))],
        lines: vec![
            counted(grains.grains.len(), "grain"),
            format!("{shown} shown"),
            mass(grains.total_mass()),
        ],
    };
    // No glass here.
    let panel = expose(&scene, &scene.outline(), shot, 1.0);
    sheet(&[(panel, String::new())], 1, shot.width, shot.notes.then_some(&notes))
}

/// A mass in kg for the key, in g.
fn mass(kg: f64) -> String {
    format!("{} g", without_zeros(&grams(to_g(kg))))
}

/// The grains in their places, then the bar; and the bar's length in m.
fn laid_out(grains: &GrainSet, colours: &[Colour]) -> Result<(Vec<Body>, f64), PictureError> {
    let mut order: Vec<usize> = (0..grains.blocks.len()).collect();
    order.sort_by(|&a, &b| grains.blocks[b].retained.total_cmp(&grains.blocks[a].retained));
    let lying = |n: usize| Solid::new(&grains.grains[n].shape, &at_rest(&grains.grains[n], n));
    let width = |s: &Solid| s.high.x - s.low.x;
    let mut bodies = Vec::new();
    let (mut space, mut widest) = (0.0, 0.0);
    let mut y = 0.0;
    for fraction in order {
        let members: Vec<usize> =
            (0..grains.grains.len()).filter(|&n| grains.grains[n].fraction == fraction).collect();
        if members.is_empty() {
            continue;
        }
        let mean = members.iter().map(|&n| width(&lying(n))).sum::<f64>() / members.len() as f64;
        if widest == 0.0 {
            (space, widest) = (SPACE * mean, ROW * (1.0 + SPACE) * mean);
        }
        // About as many as fill the rows, from all over the fraction.
        let fit = ROWS as f64 * widest / (mean + space);
        let picked = (fit as usize).clamp(1, members.len());
        let mut left: VecDeque<usize> =
            (0..picked).map(|n| members[n * members.len() / picked]).collect();
        for _ in 0..ROWS {
            let mut row: Vec<(usize, Solid)> = Vec::new();
            let mut taken = 0.0;
            while let Some(&n) = left.front() {
                let solid = lying(n);
                if !row.is_empty() && taken + width(&solid) + space > widest {
                    break;
                }
                taken += width(&solid) + space;
                row.push((n, solid));
                left.pop_front();
            }
            let depth = row.iter().map(|(_, s)| s.high.y - s.low.y).fold(0.0, f64::max);
            // What is left over is shared out, but in a last row that is not full.
            let more = if left.is_empty() { 0.0 } else { (widest - taken) / row.len() as f64 };
            let mut x = -widest / 2.0;
            y -= depth / 2.0;
            for (n, s) in row {
                let to = Vector::new(x - s.low.x, y - (s.low.y + s.high.y) / 2.0, 0.0);
                let pose = Pose::from_parts(to.into(), UnitQuaternion::identity())
                    * at_rest(&grains.grains[n], n);
                x += width(&s) + space + more;
                bodies.push(Body::new(Solid::new(&grains.grains[n].shape, &pose), colours[n]));
            }
            if depth > 0.0 {
                y -= depth / 2.0 + space;
            }
        }
    }
    // The largest of 1, 2, 5 times a power of ten that a third of a row holds.
    let third: f64 = widest / 3.0;
    let power = 10f64.powf(third.log10().floor());
    let bar = [5.0, 2.0, 1.0].into_iter().map(|k| k * power).find(|b| *b <= third).unwrap_or(power);
    let thickness = 0.03 * bar;
    let drawing = |e: crate::geometry::PolyhedronError| PictureError::Drawing(e.to_string());
    let sides = Vector::new(bar, 2.0 * thickness, thickness);
    let shape = ConvexPolyhedron::cuboid(sides).map_err(drawing)?;
    let at = Pose::translation((bar - widest) / 2.0, y - 3.0 * thickness, thickness / 2.0);
    bodies.push(Body::new(Solid::new(&shape, &at), Colour::BAR));
    Ok((bodies, bar))
}

/// A grain on its largest face, the face at height 0, turned by its number.
fn at_rest(grain: &Grain, n: usize) -> Pose {
    let shape = &grain.shape;
    let area = |face: usize| -> f64 {
        let corners: Vec<Vector> =
            shape.faces()[face].iter().map(|&c| shape.vertices()[c as usize].coords).collect();
        let fan = (1..corners.len() - 1)
            .map(|i| (corners[i] - corners[0]).cross(&(corners[i + 1] - corners[0])));
        fan.sum::<Vector>().norm()
    };
    let largest = (0..shape.faces().len()).max_by(|&a, &b| area(a).total_cmp(&area(b)));
    let plane = largest.and_then(|face| shape.plane(face));
    let (normal, _) = plane.unwrap_or((-Vector::z(), 0.0));
    let down = UnitQuaternion::rotation_between(&normal, &-Vector::z()).unwrap_or_else(|| {
        UnitQuaternion::from_axis_angle(&Vector::x_axis(), std::f64::consts::PI)
    });
    let turn = UnitQuaternion::from_axis_angle(&Vector::z_axis(), TURN * n as f64) * down;
    let lowest = shape.vertices().iter().map(|v| (turn * v).z).fold(f64::INFINITY, f64::min);
    Pose::from_parts(nalgebra::Translation3::new(0.0, 0.0, -lowest), turn)
}

#[cfg(test)]
mod tests {
    use super::super::moment::tests::canned;
    use super::*;

    #[test]
    fn grains_lie_on_a_face_and_apart() {
        let run = canned();
        let count = run.grains.grains.len();
        let (bodies, bar) = laid_out(&run.grains, &vec![Colour::GRAIN; count]).expect("in rows");
        assert_eq!(bodies.len(), count + 1, "law: every grain of a few, and the bar");
        assert!((0.02..=0.1).contains(&bar), "a bar of a few cm, got {bar} m");
        for body in &bodies {
            assert!(body.solid.low.z.abs() < 1e-12, "law: all lie on the ground");
            let flat = body.solid.planes.iter().any(|p| p.normal.z < -1.0 + 1e-9);
            assert!(flat, "law: each on a face");
        }
        for (n, a) in bodies.iter().enumerate() {
            for b in &bodies[n + 1..] {
                let apart = (0..2).any(|k| {
                    a.solid.high[k] <= b.solid.low[k] || b.solid.high[k] <= a.solid.low[k]
                });
                assert!(apart, "law: no two share their ground");
            }
        }
    }

    #[test]
    fn the_key_has_the_mass_of_small_samples() {
        for (kg, expected) in
            [(2.343, "2343 g"), (0.585_76, "585.8 g"), (0.35e-3, "0.35 g"), (2e-8, "0.00002 g")]
        {
            assert_eq!(mass(kg), expected, "law: {kg} kg to three digits at least");
        }
    }

    #[test]
    fn only_colours_of_grains_themselves_are_theirs() {
        let run = canned();
        let shot =
            |colour_by| Shot { width: 200, height: 150, colour_by, view: VIEW, ..Shot::default() };
        for by in [ColourBy::Fraction, ColourBy::Plain] {
            let image = loose_grains(&run.grains, &shot(by)).expect("a picture");
            assert!(image.pixels.iter().filter(|p| p[3] > 0.9).count() > 500, "{by:?}");
        }
        for (by, missing) in [
            (ColourBy::Speed, "no speed"),
            (ColourBy::Displacement, "no displacement"),
            (ColourBy::Coordination, "no contacts"),
        ] {
            let error = loose_grains(&run.grains, &shot(by)).expect_err("no run");
            assert!(error.is_usage() && error.to_string().contains(missing), "{by:?}: {error}");
            assert!(error.to_string().contains("grains alone"), "law: why, got {error}");
        }
    }
}
