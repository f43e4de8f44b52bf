//! Oedometer: void ratio from the height of a lid, and which part of a compression comes back.

/// A state at rest of grains under a lid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compressed {
    /// Stress of the lid in Pa.
    pub stress: f64,
    /// Force of the lid in N.
    pub force: f64,
    /// Height of the grains in m.
    pub height: f64,
    /// Energy in J that contacts hold as springs.
    pub stored: f64,
}

/// Void ratio of solids of a volume in m³ that stand up to a height in m on an area in m².
pub fn void_ratio_of_height(height: f64, area: f64, solids: f64) -> f64 {
    height * area / solids - 1.0
}

/// Compression in m that the springs of contacts can give back from one state to another: as much
/// as the energy that they give up lifts the lid, against its mean force on the way. Exact for
/// springs whose network stays as it is; where grains slide on the way, friction takes a part of
/// that energy, and less comes back.
fn given_back_by_springs(from: &Compressed, to: &Compressed) -> f64 {
    2.0 * (from.stored - to.stored) / (from.force + to.force)
}

/// Which share of a compression comes back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rebound {
    /// Share that does come back, as the height of the lid shows.
    pub came_back: f64,
    /// Share that the springs can give back by their energy, at most.
    pub of_springs: f64,
}

/// That of loading from one state to another and unloading to a third. `None` where the grains
/// were not compressed.
pub fn rebound(before: &Compressed, loaded: &Compressed, after: &Compressed) -> Option<Rebound> {
    let compression = before.height - loaded.height;
    (compression > 0.0).then(|| Rebound {
        came_back: (after.height - loaded.height) / compression,
        of_springs: given_back_by_springs(loaded, after) / compression,
    })
}

/// Fall of the void ratio for ten times the stress between two states of a stress in Pa and a void
/// ratio: C_c where grains are loaded first, C_s where they are unloaded. `None` where the stress
/// is the same.
pub fn compression_index(one: (f64, f64), other: (f64, f64)) -> Option<f64> {
    let decades = (other.0 / one.0).log10();
    (decades.is_finite() && decades != 0.0).then(|| (one.1 - other.1) / decades)
}

#[cfg(test)]
mod tests {
    use super::super::near;
    use super::*;

    /// Grains that have moved by so much, in m, on a spring of 1 MN/m under a force in N.
    fn state(force: f64, moved: f64) -> Compressed {
        let yields = force / 1e6;
        Compressed {
            stress: force / 0.01,
            force,
            height: 0.05 - moved - yields,
            stored: 0.5 * force * yields,
        }
    }

    #[test]
    fn a_spring_alone_comes_back_as_a_whole() {
        let got = rebound(&state(100.0, 0.0), &state(1000.0, 0.0), &state(100.0, 0.0));
        let got = got.expect("compressed");
        near("all of it", got.came_back, 1.0);
        near("all of it is the spring", got.of_springs, 1.0);
    }

    #[test]
    fn what_has_moved_does_not_come_back_and_is_no_spring() {
        // 0.9 mm of the spring and 1.8 mm of grains that move; 0.45 mm of spring come back.
        let got = rebound(&state(100.0, 0.0), &state(1000.0, 1.8e-3), &state(550.0, 1.8e-3));
        let got = got.expect("compressed");
        near("0.45 of 2.7", got.came_back, 1.0 / 6.0);
        near("which is the spring", got.of_springs, 1.0 / 6.0);
        // Grains that move back as well add to the first alone.
        let more = rebound(&state(100.0, 0.0), &state(1000.0, 1.8e-3), &state(550.0, 1.26e-3));
        let more = more.expect("compressed");
        near("0.99 of 2.7", more.came_back, 0.99 / 2.7);
        near("the spring is as it was", more.of_springs, 1.0 / 6.0);
        assert_eq!(
            rebound(&state(100.0, 0.0), &state(50.0, 0.0), &state(100.0, 0.0)),
            None,
            "law: not compressed"
        );
    }

    #[test]
    fn void_ratio_and_index_follow_from_height_and_stress() {
        near("6 cm³ of 2 cm³", void_ratio_of_height(0.06, 1e-4, 2e-6), 2.0);
        let index = compression_index((1e4, 0.9), (1e5, 0.8));
        near("0.1 a decade", index.expect("two stresses"), 0.1);
        let half = compression_index((1e5, 0.8), (1e4, 0.81)).expect("two stresses");
        near("unloaded, 0.01 a decade", half, 0.01);
        assert_eq!(compression_index((1e4, 0.9), (1e4, 0.8)), None, "law: one stress");
    }
}
