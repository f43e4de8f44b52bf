//! Settings of the contact path `manifold` as a person types them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How contacts yield in the contact path `manifold`: an implicit spring and
/// damper in every contact point. Rates, iterations and the speed below which
/// nothing rebounds are those of the engine settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ManifoldSettings {
    /// Sub-steps of the solver in a step: contacts are found once a step,
    /// and its iterations are shared among the sub-steps. Fewer: blows and
    /// shaking are followed more coarsely; more: fewer iterations in each.
    #[schemars(range(min = 1, max = 1000))]
    pub substeps: u32,
    /// Stiffness of a contact point in N/m. Lower: grains sink in further, by
    /// their load over it; higher: more iterations are needed for the load to
    /// get through the packing. 5000 N/m make a grain of 1.6 g on four points
    /// sink by 0.8 µm.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 1e9))]
    pub contact_stiffness_n_per_m: f64,
    /// Damping ratio of the spring with the bodies it stands between. Lower
    /// than 1: contacts swing; higher: overlaps last longer.
    #[schemars(range(min = 0.0, max = 100.0))]
    pub contact_damping_ratio: f64,
    /// Largest speed in m/s at which an overlap is pushed apart. Lower:
    /// overlaps last; higher: they burst.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 100.0))]
    pub push_out_speed_m_per_s: f64,
    /// Threads that find contacts in one world. They change no bit of the
    /// result, and are therefore left out of what is kept of a run; stages that
    /// do not need each other already run at the same time (`--jobs`).
    #[schemars(range(min = 1, max = 1024))]
    #[serde(skip_serializing)]
    pub threads: u32,
    /// Use the instructions that every processor has, not the fastest of this
    /// one: slower, and the same bits.
    #[serde(skip_serializing)]
    pub portable: bool,
    /// Contacts solved at once: 8, in single precision, or 1, in double,
    /// which is slower and there to compare with.
    #[schemars(extend("enum" = [1, 8]))]
    pub contacts_at_once: u32,
}

impl Default for ManifoldSettings {
    fn default() -> Self {
        Self {
            substeps: 4,
            contact_stiffness_n_per_m: 5000.0,
            contact_damping_ratio: 1.0,
            push_out_speed_m_per_s: 0.3,
            threads: 1,
            portable: false,
            contacts_at_once: 8,
        }
    }
}
