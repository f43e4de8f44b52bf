//! Settings that go with the size of the grains, each by a law.

use super::*;

/// The parts of a scenario that hold these settings, by default for grains of the paper's size.
#[derive(Default)]
struct Settings {
    engine: EngineSettings,
    settle: SettleSpec,
}

/// A field that goes with the size of the grains, and what goes wrong where it is far off.
pub(super) struct BySize {
    pub path: &'static str,
    /// How it grows; of the rates of steps and sub-steps, the stiffness and the speed at which
    /// overlaps are pushed apart, the scenario may ask for more.
    pub law: Law,
    /// The contacts of which it is a setting.
    pub of: Of,
    /// What goes wrong where it is far too low.
    pub low: &'static str,
    /// What goes wrong where it is far too high.
    pub high: &'static str,
    /// Where it stands in the settings.
    place: fn(&mut Settings) -> &mut f64,
}

/// Whether a scenario's contacts are those of which a field is a setting: every engine's, Bullet's
/// own and the native ones, the native contact solver's, or rapier's.
type Of = fn(&EngineSettings) -> bool;
const ALL: Of = |_| true;
const BULLET: Of = |engine| engine.backend == Backend::Bullet;
const NATIVE: Of = EngineSettings::is_native;
const RAPIER: Of = |engine| engine.backend == Backend::Rapier;

macro_rules! by_size {
    ($(
        $group:ident $(.$field:ident)+ => $law:ident, $of:ident:
            low $low:expr;
            high $high:expr;
    )*) => {
        /// The fields in the order in which they are reported.
        pub(super) const BY_SIZE: &[BySize] = &[$(BySize {
            path: concat!(stringify!($group), $(".", stringify!($field)),+),
            law: Law::$law,
            of: $of,
            low: $low,
            high: $high,
            place: |all| &mut all.$group$(.$field)+,
        }),*];
    };
}

const SLOWER: &str = "the run takes longer in proportion and is no more exact";

by_size! {
    engine.grain_size_mm => Fine, ALL:
        low "contacts are found late, and many boxes are renewed in a step";
        high "gaps and clearances are so wide that grains notice them";
    engine.rate_hz => Rate, ALL:
        low "grains sink into each other within a step";
        high SLOWER;
    engine.native.substep_rate_hz => Rate, NATIVE:
        low "impacts, shaking and grains under load are followed too coarsely";
        high SLOWER;
    engine.native.contact_stiffness_n_per_m => Stiffness, NATIVE:
        low "grains sink into each other";
        high "loads need more sub-steps and iterations to get through the packing, which costs \
              time";
    engine.native.max_depenetration_velocity_m_per_s => Speed, NATIVE:
        low "overlaps that impacts leave last, and contacts bear no more than this speed times \
              stiffness and sub-step";
        high "overlaps burst and throw grains apart";
    engine.restitution_velocity_threshold_m_per_s => Speed, BULLET:
        low "contacts at rest go on rebounding, and the specimen settles late";
        high "impacts that should rebound do not";
    engine.length_scale => PerLength, BULLET:
        low "a grain is much smaller than an engine unit, and Bullet's tolerances are gaps that \
              it notices";
        high "a grain is much larger than an engine unit, and Bullet's tolerances are lost in \
              rounding";
    engine.contact_threshold_mm => Fine, BULLET:
        low "contacts are found late and lost between steps";
        high "contacts that bear nothing are kept";
    settle.rms_speed_mm_per_s => Speed, ALL:
        low "a stage may not count as settled before its time limit";
        high "a stage ends while the specimen still moves";
    settle.largest_speed_mm_per_s => Speed, ALL:
        low "a stage may not count as settled before its time limit";
        high "a stage ends while grains still fall";
    settle.hold_s => Time, ALL:
        low "a stage may end at the top of a bounce";
        high "every stage that settles is simulated for longer than it needs";
    engine.rapier.contact_frequency_hz => Rate, RAPIER:
        low "grains sink into each other";
        high "the packing jitters and creeps numerically unless engine.rapier.substeps is raised, \
              which costs time";
    engine.rapier.wall_contact_frequency_hz => Rate, RAPIER:
        low "grains sink into the funnel";
        high "grains jitter in the funnel unless engine.rapier.substeps is raised, which costs \
              time";
    engine.rapier.engine_unit_mm => Fine, RAPIER:
        low "contact points are needlessly recomputed";
        high "contact points are kept that are no longer there";
    engine.rapier.prediction_mm => Fine, RAPIER:
        low "grains sink in before they are met";
        high "contacts that bear nothing are prepared, which costs time";
    engine.rapier.corrective_speed_m_per_s => Speed, RAPIER:
        low "overlaps that impacts leave last";
        high "overlaps burst and throw grains apart";
    engine.rapier.recycling_distance_mm => Fine, RAPIER:
        low "contact points change for nothing, and the packing creeps numerically";
        high "contact normals are out of date";
}

// Paths of fields that follow from the motions and loads of a scenario, too.
pub(super) const RATE: &str = "engine.rate_hz";
pub(super) const STIFFNESS: &str = "engine.native.contact_stiffness_n_per_m";
pub(super) const DEPENETRATION: &str = "engine.native.max_depenetration_velocity_m_per_s";
pub(super) const RMS_SPEED: &str = "settle.rms_speed_mm_per_s";
pub(super) const LARGEST_SPEED: &str = "settle.largest_speed_mm_per_s";
pub(super) const SUBSTEPS: &str = "engine.native.substep_rate_hz";

/// Path of the iterations in a sub-step, a whole number that follows from the loads alone.
pub(super) const ITERATIONS: &str = "engine.native.iterations";

impl BySize {
    /// Its value for grains of the paper's size, which is its default.
    pub fn default_value(&self) -> f64 {
        *(self.place)(&mut Settings::default())
    }
}

impl EngineSettings {
    /// The settings for the same bodies `larger` times as large, under the same gravity.
    pub fn enlarged(&self, larger: f64) -> Self {
        let paper = Scale::PAPER;
        let scale = Scale::of_smallest(paper.sizes.smallest * larger, paper.gravity);
        let mut enlarged = Settings { engine: self.clone(), ..Settings::default() };
        for field in BY_SIZE {
            *(field.place)(&mut enlarged) *= field.law.factor(&scale);
        }
        enlarged.engine
    }
}
