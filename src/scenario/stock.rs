//! Settings that only stock Bullet contacts have, as a person types them.

use super::*;

/// How the moments of inertia of grains and plate are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InertiaRule {
    /// Of the polyhedron itself.
    Exact,
    /// Of the box around it, as Bullet's `calculateLocalInertia` has it: about
    /// twice too large for a grain.
    BoundingBox,
    /// The same, of a box that was stored while the shape still had Bullet's
    /// collision margin of 0.04 length units, as happens where a hull is made
    /// first and its margin set afterwards: at one unit a metre a thousand
    /// times too large for a grain of 10 mm.
    BoundingBoxWithDefaultMargin,
}

parts! {
/// What stock Bullet contacts (`"contact_solver": "stock"`) take beside
/// the settings that both contact solvers share. The defaults switch everything off that
/// is there for games; the interpretations of what the paper's authors had switch it
/// on again.
#[serde(default)]
pub struct StockSettings {
    /// Distance in mm by which every surface stands off its hull in contacts
    /// (Bullet's collision margin). 0: none. More: bodies seem larger by it.
    pub collision_margin_mm: f64 = 0.0, from 0.0 to 1000.0;
    /// How moments of inertia are found.
    pub inertia: InertiaRule = InertiaRule::Exact;
    /// Mass in g that no grain and no plate falls below in the engine: lighter
    /// ones are made as heavy. 0: none is changed.
    pub least_mass_g: f64 = 0.0, from 0.0 to 1e6;
    /// Contacts kept up to this share of the smaller body's radius (Bullet's
    /// relative contact breaking threshold, 0.02 where nothing is said), in
    /// place of `contact_threshold_mm`. 0: not used.
    pub relative_contact_threshold: f64 = 0.0, from 0.0 to 1.0;
    /// Whether grains that stay slow for two seconds (Bullet's
    /// `gDeactivationTime`) are no longer moved until something touches them.
    /// Walls that stand still sleep; a table that moves wakes what it carries.
    pub sleeping: bool = false;
    // The two speeds are Bullet's (`btRigidBodyConstructionInfo`, 3.24); without effect while
    // `sleeping` is off.
    /// Speed in m/s below which a body counts as slow.
    pub sleeping_speed_m_per_s: f64 = 0.8, from 0.0 to 1000.0;
    /// Angular speed in rad/s below which a body counts as slow.
    pub sleeping_spin_rad_per_s: f64 = 1.0, from 0.0 to 1000.0;
}
}
