//! Changes that must not matter to a result: a turned laboratory, another order of bodies, another
//! unit of length.

use super::*;
use crate::verify::view::View;

/// What is changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "change", rename_all = "snake_case", deny_unknown_fields)]
pub enum Change {
    /// The whole laboratory is turned: gravity, motion and bodies.
    Frame {
        /// Turns as roll, pitch and yaw in degrees.
        turns_deg: Vec<[f64; 3]>,
    },
    /// Left and right are exchanged: the scene and the scene in the mirror.
    Mirror,
    /// Bodies are added to the engine first first and last first.
    Order,
    /// The whole laboratory moves steadily, walls and floor with it (Galilei).
    Boost {
        /// Velocities of the laboratory in m/s.
        velocities_m_per_s: Vec<[f64; 3]>,
    },
    /// Lengths inside the engine.
    LengthScale {
        /// Engine units in a metre.
        scales: Vec<f64>,
    },
    /// Everything, with the times and masses that belong to it.
    Size {
        /// How many times as large.
        larger: Vec<f64>,
    },
}

pub(super) fn invariance(bench: &Bench, over: &Change, of: &Experiment) -> Measured {
    let seen = |name: String, view: View| (name, bench.seen(view));
    let benches: Vec<(String, Bench)> = match over {
        Change::Frame { turns_deg } => turns_deg
            .iter()
            .map(|turn| {
                let [roll, pitch, yaw] = turn.map(f64::to_radians);
                let frame = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
                let name = format!("{}°, {}°, {}°", turn[0], turn[1], turn[2]);
                seen(name, View { frame, ..bench.view })
            })
            .collect(),
        Change::Mirror => [("as it is", false), ("mirrored", true)]
            .map(|(name, mirrored)| seen(name.into(), View { mirrored, ..bench.view }))
            .into(),
        Change::Order => [("first first", false), ("last first", true)]
            .map(|(name, last_first)| seen(name.into(), View { last_first, ..bench.view }))
            .into(),
        Change::Boost { velocities_m_per_s } => velocities_m_per_s
            .iter()
            .map(|v| {
                let name = format!("{}, {}, {} m/s", v[0], v[1], v[2]);
                seen(name, View { velocity: (*v).into(), ..bench.view })
            })
            .collect(),
        Change::LengthScale { scales } => {
            scales.iter().map(|s| (format!("{s} units/m"), bench.at_length_scale(*s))).collect()
        }
        Change::Size { larger } => {
            larger.iter().map(|l| (format!("{l} times as large"), bench.enlarged(*l))).collect()
        }
    };
    let mut outcome = Outcome::default();
    let mut values = Vec::new();
    for (name, bench) in benches {
        let inner = of.run(&bench)?;
        (outcome.x, outcome.y) = (inner.x, inner.y);
        // One curve a change, and the law once.
        if let Some(law) = inner.curves.iter().find(|c| c.law)
            && values.is_empty()
        {
            outcome.law(law.name.clone(), law.points.clone());
        }
        if let Some(curve) = inner.curves.into_iter().find(|c| !c.law) {
            outcome.measured(format!("{name}: {:.4}", inner.got), curve.points);
        }
        values.push(inner.got);
    }
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    outcome.note = Some(format!("from {lowest:.4} to {highest:.4}, mean {mean:.4}"));
    // NaN in any value makes the mean NaN, and with it the difference.
    Ok(outcome.got(highest - lowest + 0.0 * mean))
}
