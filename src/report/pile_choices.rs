//! What is ours of a pile, for the report's table of choices.

use super::choices::{Choice, choice};
use crate::scenario::{BaseKind, Scenario, StageSpec};

/// The choices of a scenario that builds a pile; none of one that does not.
pub fn pile_choices(scenario: &Scenario) -> Vec<Choice> {
    let Some(StageSpec::SlowPluviation {
        feed_rate_grains_per_s,
        drop_height_mm,
        spout_diameter_mm,
        base,
        base_diameter_mm,
        ..
    }) = scenario.stages.iter().find(|s| matches!(s, StageSpec::SlowPluviation { .. }))
    else {
        return Vec::new();
    };
    let base_value = match (base.kind, base.friction) {
        (BaseKind::FixedGrains, _) => "a layer of the same grains, fixed".to_owned(),
        (BaseKind::Plane, friction) => format!("a plane of friction {}", friction.unwrap_or(0.0)),
    };
    vec![
        choice(
            "Feed of the pile",
            format!("{feed_rate_grains_per_s} grains a second"),
            "The paper only says “slowly to avoid dynamic effects”. A grain has landed before the \
             next few are let go.",
            "Faster, grains land on grains that still move, and the pile flattens (docs/repose.md).",
        ),
        choice(
            "Drop height and spout of the pile",
            format!("{drop_height_mm} mm above its top, within {spout_diameter_mm} mm"),
            "About a grain high and three grains wide; the paper gives neither.",
            "From higher, grains bounce and roll off; a wider spout makes a flat top.",
        ),
        choice(
            "Base of the pile",
            format!("{base_value}, {base_diameter_mm} mm in diameter"),
            "The paper says “a rough surface”: as rough as the pile itself, and wide enough to hold \
             all of it.",
            "On a smooth plane grains at the toe roll out; on a small base they fall off.",
        ),
    ]
}
