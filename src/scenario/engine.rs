//! Engine settings as a person types them.

use serde::{Deserializer, Serializer, ser};

use super::*;

/// Which physics engine carries the bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Backend {
    /// Debian's Bullet.
    Bullet,
    /// The Rust engine rapier, for comparison.
    Rapier,
}

/// Who finds the contacts and who solves them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactSolver {
    /// The collision algorithms and the sequential impulse solver of stock Bullet.
    Stock,
    /// Contact points that are kept from step to step, from our own hull–hull test, and the native
    /// solver.
    Native,
}

parts! {
/// Settings of the engine. Nothing is inherited silently: every value is set
/// and read back into the manifest.
#[serde(default, remote = "Self")]
pub struct EngineSettings {
    /// The physics engine.
    pub backend: Backend = Backend::Bullet;
    /// Who finds and solves contacts on Bullet.
    pub contact_solver: ContactSolver = ContactSolver::Native;
    /// Size of the smallest grains in mm, from which the engine's own lengths
    /// follow: gaps, clearances and margins (`docs/scale.md`). Left out, it is that of
    /// the grains. Smaller: contacts are found later and more boxes are renewed; larger:
    /// gaps that a grain notices.
    pub grain_size_mm: f64 = 8.0, schemars(extend("exclusiveMinimum" = 0.0), range(max = 10000.0));
    /// Steps per second of simulated time. Lower: grains sink into each
    /// other; higher: slower.
    pub rate_hz: f64 = 480.0, from 30.0 to 100000.0;
    /// Iterations per step of stock Bullet contacts. Fewer: contacts give way; more: slower.
    pub iterations: u32 = 20, from 1 to 10000;
    /// Engine length units in a metre. Bullet's absolute tolerances are made
    /// for bodies of about one unit; 100 makes a 10 mm grain one unit.
    pub length_scale: f64 = 100.0, from 1.0 to 10000.0;
    /// Friction directions per contact: 2 resists sliding in every direction of
    /// the contact plane, 1 (Bullet's default) only along the sliding direction.
    pub friction_directions: u32 = 2, from 1 to 2;
    /// Distance up to which a contact is kept, in mm.
    pub contact_threshold_mm: f64 = 1.0, schemars(extend("exclusiveMinimum" = 0.0));
    /// Share of the overlap removed per step (Bullet's `m_erp2`).
    pub erp: f64 = 0.2, from 0.0 to 1.0;
    /// Share of the last step's normal impulses with which the solver starts.
    pub warm_start: f64 = 0.85, from 0.0 to 1.0;
    /// Correct overlaps by a separate pseudo-velocity (Bullet's split impulse).
    pub split_impulse: bool = false;
    /// Approach speed in m/s below which contacts do not rebound.
    pub restitution_velocity_threshold_m_per_s: f64 = 0.002, from 0.0 to 100.0;
    /// Linear velocity lost per second, as a fraction.
    pub linear_damping: f64 = 0.0, from 0.0 to 1.0;
    /// Angular velocity lost per second, as a fraction.
    pub angular_damping: f64 = 0.0, from 0.0 to 1.0;
    /// Integrate the gyroscopic term of the rotation of uneven bodies.
    pub gyroscopic: bool = true;
    /// Run also where steps are so coarse that bodies can pass through each
    /// other or vibration is not followed: what would refuse the scenario
    /// becomes a warning of every result. Left out of what is written where it
    /// is `false`.
    pub allow_coarse_steps: bool = false;
    /// What only stock Bullet contacts ask for.
    pub stock: StockSettings = StockSettings::default();
    /// What only the native contact solver asks for.
    pub native: NativeSettings = NativeSettings::default();
    /// What only rapier asks for.
    pub rapier: RapierSettings = RapierSettings::default();
}
}

// Serde's derive makes inherent functions for `remote = "Self"`, which these
// traits call.
impl<'de> Deserialize<'de> for EngineSettings {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::deserialize(deserializer)
    }
}

/// What is written of settings is what the engine reads: rapier's are left out where Bullet
/// carries the grains, those of the native contact solver where contacts are Bullet's, those of
/// stock Bullet contacts and the leave for coarse steps everywhere, if they are the defaults.
impl Serialize for EngineSettings {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let written = Self::serialize(self, serde_json::value::Serializer);
        let mut written = written.map_err(ser::Error::custom)?;
        let is_bullet = self.backend == Backend::Bullet;
        for (field, is_left_out) in [
            ("rapier", is_bullet && self.rapier == RapierSettings::default()),
            ("native", !self.is_native() && self.native == NativeSettings::default()),
            ("stock", self.stock == StockSettings::default()),
            ("allow_coarse_steps", !self.allow_coarse_steps),
        ] {
            if let Some(fields) = written.as_object_mut().filter(|_| is_left_out) {
                fields.shift_remove(field);
            }
        }
        written.serialize(serializer)
    }
}

impl EngineSettings {
    /// Whether the native contact solver finds and solves the contacts.
    pub fn is_native(&self) -> bool {
        self.backend == Backend::Bullet && self.contact_solver == ContactSolver::Native
    }

    /// Whether stock Bullet finds and solves the contacts, as in the engine of the paper.
    pub fn is_stock(&self) -> bool {
        self.backend == Backend::Bullet && self.contact_solver == ContactSolver::Stock
    }

    /// Who finds and solves the contacts, as results name it: a contact solver on Bullet, or the
    /// other engine itself.
    pub fn solver_name(&self) -> &'static str {
        match (self.backend, self.contact_solver) {
            (Backend::Rapier, _) => "rapier",
            (Backend::Bullet, ContactSolver::Stock) => "stock",
            (Backend::Bullet, ContactSolver::Native) => "native",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the version before rapier wrote the defaults: manifests have these bytes. Keys of stages
    /// are made from all fields of the groups that act (`src/study/engine_key.rs`).
    const BULLET_DEFAULTS: &str = "{\"backend\":\"bullet\",\"contact_solver\":\"stock\",\
        \"grain_size_mm\":8.0,\"rate_hz\":480.0,\"iterations\":20,\"length_scale\":100.0,\"friction_directions\":2,\
        \"contact_threshold_mm\":1.0,\"erp\":0.2,\"warm_start\":0.85,\
        \"split_impulse\":false,\"restitution_velocity_threshold_m_per_s\":0.002,\
        \"linear_damping\":0.0,\"angular_damping\":0.0,\"gyroscopic\":true}";

    fn bullets_own() -> EngineSettings {
        EngineSettings { contact_solver: ContactSolver::Stock, ..Default::default() }
    }

    fn written(settings: &EngineSettings) -> String {
        serde_json::to_string(settings).expect("settings have JSON")
    }

    #[test]
    fn settings_of_bullet_are_written_as_before_rapier() {
        assert_eq!(
            written(&bullets_own()),
            BULLET_DEFAULTS,
            "law: rapier's default settings change nothing in what is written for Bullet"
        );
    }

    #[test]
    fn settings_of_a_group_are_written_where_they_matter() {
        let rapier = EngineSettings { backend: Backend::Rapier, ..Default::default() };
        let chosen = RapierSettings { substeps: 17, ..Default::default() };
        let bullet = EngineSettings { rapier: chosen, ..bullets_own() };
        let sleeping = StockSettings { sleeping: true, ..Default::default() };
        let stock = EngineSettings { stock: sleeping, allow_coarse_steps: true, ..bullets_own() };
        for (settings, group) in [(rapier, "rapier"), (bullet, "rapier"), (stock, "stock")] {
            let text = written(&settings);
            assert!(text.contains(&format!("\"{group}\":{{")), "expected `{group}`, got {text}");
            let back: EngineSettings = serde_json::from_str(&text).expect("they can be read");
            assert_eq!(back, settings, "law: settings come back as they were written");
        }
        for unknown in ["{\"rapier\":{\"speed\":1}}", "{\"stock\":{\"margin\":1}}"] {
            let read = serde_json::from_str::<EngineSettings>(unknown);
            assert!(read.is_err(), "law: a field that is not there is refused: {unknown}");
        }
    }
}
