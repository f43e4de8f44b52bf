//! The settings of the engine as they stand in the key of a stage: what all engines read, and what
//! the one that carries the grains asks for alone. Those of others change no key.
//!
//! They are types of their own, so that settings may be written otherwise without a new key.
//! Fields, their order and the words of choices are part of the key: who changes them raises
//! `FORMAT` of `stage_key.rs`.

use super::*;
use crate::scenario::{
    ContactSolver, FrictionModel, InertiaRule, NativeSettings, RapierSettings, StockSettings,
};

/// The key of some settings, each by its name: a new one must be put here, or left out, on purpose.
macro_rules! key {
    (
        $(#[$about:meta])*
        $key:ident of $settings:ident {
            $($(#[$of_field:meta])* $field:ident: $type:ty,)*
        } without { $($left_out:ident),* }
    ) => {
        $(#[$about])*
        #[derive(Serialize)]
        struct $key {
            $($(#[$of_field])* $field: $type,)*
        }

        impl $key {
            fn of(settings: &$settings) -> Self {
                let $settings { $($field,)* $($left_out: _,)* } = settings;
                Self { $($field: *$field,)* }
            }
        }
    };
}

key! {
/// What all engines read.
CommonKey of EngineSettings {
    backend: Backend,
    contact_solver: ContactSolver,
    grain_size_mm: f64,
    rate_hz: f64,
    iterations: u32,
    length_scale: f64,
    friction_directions: u32,
    contact_threshold_mm: f64,
    erp: f64,
    warm_start: f64,
    split_impulse: bool,
    restitution_velocity_threshold_m_per_s: f64,
    linear_damping: f64,
    angular_damping: f64,
    gyroscopic: bool,
    allow_coarse_steps: bool,
} without { stock, native, rapier }
}

key! {
/// What stock Bullet contacts ask for.
StockKey of StockSettings {
    collision_margin_mm: f64,
    inertia: InertiaRule,
    least_mass_g: f64,
    relative_contact_threshold: f64,
    sleeping: bool,
    sleeping_speed_m_per_s: f64,
    sleeping_spin_rad_per_s: f64,
} without {}
}

key! {
/// What the native contact solver asks for; its threads change no bit.
NativeKey of NativeSettings {
    substep_rate_hz: f64,
    iterations: u32,
    solver_tolerance: f64,
    contact_stiffness_n_per_m: f64,
    contact_damping_ratio: f64,
    max_depenetration_velocity_m_per_s: f64,
    contacts_at_once: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    checkpoint_every_s: Option<f64>,
} without { threads, may_leave_threads, portable }
}

key! {
/// What rapier asks for.
RapierKey of RapierSettings {
    substeps: u32,
    iterations: u32,
    relaxing_iterations: u32,
    contact_frequency_hz: f64,
    contact_damping_ratio: f64,
    wall_contact_frequency_hz: f64,
    wall_contact_damping_ratio: f64,
    warm_start: f64,
    engine_unit_mm: f64,
    prediction_mm: f64,
    corrective_speed_m_per_s: f64,
    friction_model: FrictionModel,
    friction_while_correcting: bool,
    spanned_faces: bool,
    contact_recycling: bool,
    recycling_distance_mm: f64,
} without {}
}

/// What all engines read, and one of the groups.
#[derive(Serialize)]
pub(super) struct EngineKey {
    #[serde(flatten)]
    common: CommonKey,
    #[serde(skip_serializing_if = "Option::is_none")]
    stock: Option<StockKey>,
    #[serde(skip_serializing_if = "Option::is_none")]
    native: Option<NativeKey>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rapier: Option<RapierKey>,
}

impl EngineKey {
    pub(super) fn of(settings: &EngineSettings) -> Self {
        let mut key =
            Self { common: CommonKey::of(settings), stock: None, native: None, rapier: None };
        match (settings.backend, settings.contact_solver) {
            (Backend::Rapier, _) => key.rapier = Some(RapierKey::of(&settings.rapier)),
            (Backend::Bullet, ContactSolver::Stock) => {
                key.stock = Some(StockKey::of(&settings.stock));
            }
            (Backend::Bullet, ContactSolver::Native) => {
                key.native = Some(NativeKey::of(&settings.native));
            }
        }
        key
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(settings: &EngineSettings) -> String {
        serde_json::to_string(&EngineKey::of(settings)).expect("a key has JSON")
    }

    /// Law: settings that act on a stage change its key, those of another engine do not.
    #[test]
    fn settings_change_a_key_where_they_are_read() {
        let of = |backend, contact_solver| EngineSettings {
            backend,
            contact_solver,
            ..EngineSettings::default()
        };
        let rapier = of(Backend::Rapier, ContactSolver::Native);
        let native = of(Backend::Bullet, ContactSolver::Native);
        let stock = of(Backend::Bullet, ContactSolver::Stock);
        let of_rapier = |of: &EngineSettings| EngineSettings {
            rapier: RapierSettings { substeps: 17, ..of.rapier },
            ..of.clone()
        };
        assert_ne!(key(&of_rapier(&rapier)), key(&rapier), "law: rapier reads its own");
        for others in [&native, &stock] {
            assert_eq!(key(&of_rapier(others)), key(others), "law: Bullet reads none of rapier's");
        }
        let faster = |of: &EngineSettings| EngineSettings { rate_hz: 481.0, ..of.clone() };
        for any in [&rapier, &native, &stock] {
            assert_ne!(key(&faster(any)), key(any), "law: all read the rate");
        }
        let threads = NativeSettings { threads: Some(3), portable: true, ..native.native.clone() };
        let threads = EngineSettings { native: threads, ..native.clone() };
        assert_eq!(key(&threads), key(&native), "law: threads change no result, and no key");
        assert!(key(&native).contains("\"native\":{") && !key(&native).contains("\"stock\":{"));
        assert!(key(&stock).contains("\"stock\":{") && !key(&stock).contains("\"native\":{"));
    }

    /// What every key of the defaults has beside the group that acts.
    const COMMON: &str = "\"grain_size_mm\":8.0,\"rate_hz\":480.0,\"iterations\":20,\
        \"length_scale\":100.0,\"friction_directions\":2,\"contact_threshold_mm\":1.0,\"erp\":0.2,\
        \"warm_start\":0.85,\"split_impulse\":false,\
        \"restitution_velocity_threshold_m_per_s\":0.002,\"linear_damping\":0.0,\
        \"angular_damping\":0.0,\"gyroscopic\":true,\"allow_coarse_steps\":false";

    /// Law: stages that are stored are found: the bytes of a key stay.
    #[test]
    fn the_keys_of_the_defaults_are_as_they_were_stored() {
        let native = "\"native\":{\"substep_rate_hz\":1440.0,\"iterations\":8,\
            \"solver_tolerance\":0.002,\"contact_stiffness_n_per_m\":10000.0,\
            \"contact_damping_ratio\":1.0,\"max_depenetration_velocity_m_per_s\":0.3,\
            \"contacts_at_once\":8}";
        let stock = "\"stock\":{\"collision_margin_mm\":0.0,\"inertia\":\"exact\",\
            \"least_mass_g\":0.0,\"relative_contact_threshold\":0.0,\"sleeping\":false,\
            \"sleeping_speed_m_per_s\":0.8,\"sleeping_spin_rad_per_s\":1.0}";
        let rapier = "\"rapier\":{\"substeps\":4,\"iterations\":1,\"relaxing_iterations\":2,\
            \"contact_frequency_hz\":500.0,\"contact_damping_ratio\":1.0,\
            \"wall_contact_frequency_hz\":500.0,\"wall_contact_damping_ratio\":1.0,\
            \"warm_start\":1.0,\"engine_unit_mm\":10.0,\"prediction_mm\":0.3,\
            \"corrective_speed_m_per_s\":3.0,\"friction_model\":\"simplified\",\
            \"friction_while_correcting\":false,\"spanned_faces\":true,\
            \"contact_recycling\":true,\"recycling_distance_mm\":0.2}";
        for (backend, contact_solver, words, group) in [
            (Backend::Bullet, ContactSolver::Native, ["bullet", "native"], native),
            (Backend::Bullet, ContactSolver::Stock, ["bullet", "stock"], stock),
            (Backend::Rapier, ContactSolver::Native, ["rapier", "native"], rapier),
        ] {
            let settings = EngineSettings { backend, contact_solver, ..EngineSettings::default() };
            let [backend, solver] = words;
            let expected = format!(
                "{{\"backend\":\"{backend}\",\"contact_solver\":\"{solver}\",{COMMON},{group}}}"
            );
            assert_eq!(key(&settings), expected, "law: left what it is, right what was stored");
        }
    }

    /// Law: likewise the words of choices.
    #[test]
    fn the_words_of_choices_are_as_they_were_stored() {
        let boxes = [InertiaRule::BoundingBox, InertiaRule::BoundingBoxWithDefaultMargin];
        let expected = json!(["bounding_box", "bounding_box_with_default_margin"]);
        assert_eq!(json!(boxes), expected, "law: left what it is, right what was stored");
        assert_eq!(json!(FrictionModel::Coulomb), "coulomb", "law: likewise of rapier");
    }

    /// Law: the words of choices, and what is left out where it is not typed, are as settings are
    /// written.
    #[test]
    fn the_words_of_a_key_are_those_of_the_settings() {
        let of = EngineSettings::default;
        let mut all = vec![of()];
        for inertia in [
            InertiaRule::Exact,
            InertiaRule::BoundingBox,
            InertiaRule::BoundingBoxWithDefaultMargin,
        ] {
            let stock = StockSettings { inertia, least_mass_g: 0.5, ..of().stock };
            all.push(EngineSettings { contact_solver: ContactSolver::Stock, stock, ..of() });
        }
        for friction_model in [FrictionModel::Coulomb, FrictionModel::Simplified] {
            let rapier = RapierSettings { friction_model, substeps: 7, ..of().rapier };
            all.push(EngineSettings { backend: Backend::Rapier, rapier, ..of() });
        }
        let native = NativeSettings { checkpoint_every_s: Some(0.5), ..of().native };
        all.push(EngineSettings { native, allow_coarse_steps: true, ..of() });
        for settings in all {
            let mut written = serde_json::to_value(&settings).expect("settings have JSON");
            let fields = written.as_object_mut().expect("an object");
            let group = settings.solver_name();
            let mut expected =
                serde_json::to_value(EngineKey::of(&settings)).expect("a key has JSON");
            let own = expected.as_object_mut().expect("an object");
            let mut unwritten = own.keys().filter(|name| !fields.contains_key(*name));
            let may_be_left_out =
                |name: &String| ["allow_coarse_steps", "stock"].contains(&name.as_str());
            assert!(
                unwritten.all(may_be_left_out),
                "law: fields have the names of settings, of {group}: {own:?} and {fields:?}"
            );
            // What is written leaves out defaults, and has groups that do not act.
            fields.retain(|name, _| own.contains_key(name));
            own.retain(|name, _| fields.contains_key(name));
            assert_eq!(own, fields, "law: of {group}, left the key, right the settings");
        }
    }
}
