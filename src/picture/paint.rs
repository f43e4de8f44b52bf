//! What grains are coloured by, and the key that says so.

use super::*;
use crate::measure::{WorldHull, pairs_within_of, touching_gap};

/// What the colour of a grain tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum ColourBy {
    /// Sieve fraction.
    #[default]
    Fraction,
    /// Displacement since the stage began, relative to the table.
    Displacement,
    /// Speed relative to the table.
    Speed,
    /// Number of grains that each touches.
    Coordination,
    /// Nothing: one colour.
    Plain,
}

/// What the colours stand for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Key {
    /// The quantity with its unit, in lines.
    pub title: Vec<String>,
    /// A colour and what it stands for, from top to bottom.
    pub steps: Vec<(Colour, String)>,
    /// Upper end of a continuous scale from 0 on, instead of steps.
    pub upper: Option<f64>,
    /// Whether some grains lie beyond the upper end.
    pub beyond: bool,
}

/// The moments that colours are made from.
#[derive(Debug, Clone, Copy)]
pub struct Moments<'a> {
    /// What is shown.
    pub now: &'a Frame,
    /// The frame before it, for speeds; none where there is none in the stage.
    pub before: Option<&'a Frame>,
    /// How the stage began, for displacements; none where no frame tells.
    pub began: Option<&'a Frame>,
}

/// A colour for each grain, and the key, where the frames are there that the quantity needs. A
/// continuous scale ends at `upper`, or where 98 % of the grains lie below, rounded up.
pub fn paint(
    grains: &GrainSet,
    moments: &Moments,
    by: ColourBy,
    upper: Option<f64>,
) -> Result<(Vec<Colour>, Key), PictureError> {
    let count = grains.grains.len();
    match by {
        ColourBy::Plain => Ok((vec![Colour::GRAIN; count], Key::default())),
        ColourBy::Fraction => Ok(by_fraction(grains, moments.now)),
        ColourBy::Coordination => Ok(by_coordination(grains, moments.now)),
        ColourBy::Displacement | ColourBy::Speed => {
            let values = values(moments, by)?;
            let title = match by {
                ColourBy::Speed => ["Speed", "(mm/s)"],
                _ => ["Displacement", "(mm)"],
            };
            let has_scale = upper.is_some() || values.iter().any(Option::is_some);
            let upper = upper.unwrap_or_else(|| upper_end(&values));
            let colour = |v: &Option<f64>| v.map_or(Colour::GREY, |v| scale(v / upper));
            let key = Key {
                title: title.map(str::to_owned).to_vec(),
                steps: added_since(moments.now, &values),
                upper: has_scale.then_some(upper),
                beyond: values.iter().flatten().any(|&v| v > upper),
            };
            Ok((values.iter().map(colour).collect(), key))
        }
    }
}

/// Displacements in mm or speeds in mm/s, where the frames for them are there; none of grains that
/// are not.
pub fn values(moments: &Moments, by: ColourBy) -> Result<Vec<Option<f64>>, PictureError> {
    let now = moments.now;
    let missing = PictureError::NeedsFrames;
    let (from, per) = match by {
        ColourBy::Speed => {
            let before = moments.before.filter(|f| f.time < now.time);
            let before = before.ok_or(missing("speed"))?;
            (before, now.time - before.time)
        }
        _ => (moments.began.ok_or(missing("displacement"))?, 1.0),
    };
    let table = Vector::new(now.table_x - from.table_x, 0.0, 0.0);
    let value = |(now, from): (&Option<Pose>, &Option<Pose>)| {
        let displaced = now.as_ref()?.translation.vector - from.as_ref()?.translation.vector;
        Some(to_mm((displaced - table).norm()) / per)
    };
    Ok(now.grains.iter().zip(&from.grains).map(value).collect())
}

/// The grains that are there and have no value, if any, for the key: a stage that drops them began
/// without them.
fn added_since(now: &Frame, values: &[Option<f64>]) -> Vec<(Colour, String)> {
    let there = now.grains.iter().zip(values);
    match there.filter(|(pose, value)| pose.is_some() && value.is_none()).count() {
        0 => Vec::new(),
        count => vec![(Colour::GREY, format!("added since: {count}"))],
    }
}

/// A round number that 98 % of the values do not exceed; 1 without values.
pub fn upper_end(values: &[Option<f64>]) -> f64 {
    let mut sorted: Vec<f64> = values.iter().flatten().copied().collect();
    sorted.sort_by(f64::total_cmp);
    let place = (0.98 * sorted.len() as f64).ceil() as usize;
    round_up(sorted.get(place.saturating_sub(1)).copied().unwrap_or(0.0))
}

/// The colour of each sieve fraction, and of the top plate, as pages write them: `#rrggbb`.
pub fn palette(grains: &GrainSet) -> (Vec<String>, String) {
    let of_fractions = fractions(grains).1.into_iter().map(Colour::to_hex);
    (of_fractions.collect(), Colour::PLATE.to_hex())
}

/// The fractions that have grains, from small to large, whatever the order of the table; and the
/// colour of each fraction.
fn fractions(grains: &GrainSet) -> (Vec<usize>, Vec<Colour>) {
    let has_grains = |&fraction: &usize| grains.grains.iter().any(|g| g.fraction == fraction);
    let mut order: Vec<usize> = (0..grains.blocks.len()).filter(has_grains).collect();
    order.sort_by(|&a, &b| grains.blocks[a].retained.total_cmp(&grains.blocks[b].retained));
    let mut colours = vec![Colour::GRAIN; grains.blocks.len()];
    for (n, &fraction) in order.iter().enumerate() {
        colours[fraction] = step(n, order.len());
    }
    (order, colours)
}

fn by_fraction(grains: &GrainSet, now: &Frame) -> (Vec<Colour>, Key) {
    let (order, colours) = fractions(grains);
    let mut steps = Vec::new();
    for &fraction in &order {
        let block = &grains.blocks[fraction];
        let there = grains.grains.iter().zip(&now.grains);
        let count = there.filter(|(g, pose)| g.fraction == fraction && pose.is_some()).count();
        let sizes =
            format!("{} to {}", number(to_mm(block.retained)), number(to_mm(block.passing)));
        steps.push((colours[fraction], format!("{sizes}: {count}")));
    }
    steps.reverse();
    let of = |g: &crate::grains::Grain| colours.get(g.fraction).copied().unwrap_or(Colour::GRAIN);
    let title = ["Sieve fraction (mm)", "and number of grains"].map(str::to_owned).to_vec();
    let key = Key { title, steps, ..Key::default() };
    (grains.grains.iter().map(of).collect(), key)
}

fn by_coordination(grains: &GrainSet, now: &Frame) -> (Vec<Colour>, Key) {
    let present: Vec<usize> = (0..now.grains.len()).filter(|&n| now.grains[n].is_some()).collect();
    let hull = |&n: &usize| {
        let pose = now.grains[n].as_ref()?;
        Some(WorldHull::new(&grains.grains.get(n)?.shape, pose))
    };
    let hulls: Vec<WorldHull> = present.iter().filter_map(hull).collect();
    let mut touching = vec![0_usize; now.grains.len()];
    for (a, b, _) in pairs_within_of(&hulls, touching_gap(grains)) {
        touching[present[a]] += 1;
        touching[present[b]] += 1;
    }
    // Few grains touch more than ten others; one colour a number stays legible.
    let most = touching.iter().copied().max().unwrap_or(0);
    let last = most.min(10);
    let colour = |n: usize| step(n.min(last), last + 1);
    let name = |n: usize| match n == last && most > last {
        true => format!("{n} or more"),
        false => n.to_string(),
    };
    let steps = (0..=last).rev().map(|n| (colour(n), name(n))).collect();
    let title = ["Coordination:", "grains touched"].map(str::to_owned).to_vec();
    let key = Key { title, steps, ..Key::default() };
    (touching.into_iter().map(colour).collect(), key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    fn frame(time: f64, table_x: f64, xs: &[Option<f64>]) -> Frame {
        let pose = |x: &Option<f64>| x.map(|x| Pose::translation(x, 0.0, 0.0));
        let grains = xs.iter().map(pose).collect();
        Frame { time, cylinder: true, table_x, grains, ..Frame::default() }
    }

    #[test]
    fn displacement_and_speed_are_those_seen_from_the_table() {
        let began = frame(1.0, 0.0, &[Some(0.0), Some(0.1), Some(0.0)]);
        let before = frame(1.5, 0.01, &[Some(0.01), Some(0.1), None]);
        let now = frame(1.75, 0.02, &[Some(0.025), Some(0.12), None]);
        let moments = Moments { now: &now, before: Some(&before), began: Some(&began) };
        for (by, expected) in [
            (ColourBy::Displacement, [Some(5.0), Some(0.0), None]),
            (ColourBy::Speed, [Some(20.0), Some(40.0), None]),
        ] {
            let got = values(&moments, by).expect("values");
            for (got, expected) in got.iter().zip(expected) {
                let close = match (got, expected) {
                    (Some(a), Some(b)) => (a - b).abs() < 1e-9,
                    (a, b) => a.is_none() && b.is_none(),
                };
                assert!(close, "law: {by:?} {expected:?}, got {got:?}, tolerance 1e-9");
            }
        }
        let alone = Moments { before: None, began: None, ..moments };
        for by in [ColourBy::Displacement, ColourBy::Speed] {
            assert!(matches!(values(&alone, by), Err(PictureError::NeedsFrames(_))), "{by:?}");
        }
    }

    /// Law: grains that a stage adds have no displacement in it; they are grey, and the key says so.
    #[test]
    fn grains_added_since_the_stage_began_are_grey() {
        let grains = super::super::moment::tests::canned().grains;
        let now = frame(2.0, 0.0, &[Some(0.005), Some(0.1), None]);
        let key_of = |began: [Option<f64>; 3], upper| {
            let began = frame(1.0, 0.0, &began);
            let moments = Moments { now: &now, before: None, began: Some(&began) };
            let painted = paint(&grains, &moments, ColourBy::Displacement, upper);
            let (colours, key) = painted.expect("colours");
            assert_eq!(colours[1], Colour::GREY, "law: the second grain has no displacement");
            key
        };
        let added = |count: u32| vec![(Colour::GREY, format!("added since: {count}"))];
        let some = key_of([Some(0.0), None, None], None);
        assert_eq!((some.upper, some.steps), (Some(5.0), added(1)));
        let none = key_of([None; 3], None);
        assert_eq!((none.upper, none.steps), (None, added(2)), "law: no scale of no values");
        let moving = key_of([None; 3], Some(7.0));
        assert_eq!(moving.upper, Some(7.0), "law: an animation has one scale");
        let began = frame(1.0, 0.0, &[Some(0.0), Some(0.0), Some(0.0)]);
        let moments = Moments { now: &now, before: None, began: Some(&began) };
        let (_, key) = paint(&grains, &moments, ColourBy::Displacement, None).expect("colours");
        assert!(key.steps.is_empty(), "law: grains that are gone are not in the key");
    }

    #[test]
    fn scales_end_where_nearly_all_grains_lie_below() {
        let values: Vec<Option<f64>> =
            (1..=100).map(|n| Some(f64::from(n))).chain([None]).collect();
        assert_eq!(upper_end(&values), 100.0, "law: 98 of 100 up to 98, rounded up");
        assert_eq!(upper_end(&[None]), 1.0, "nothing moves: a scale all the same");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([12.5, 16.0, 0.063].map(number), ["12.5", "16", "0.063"]);
    }
}
