//! What an engine refuses, and the checks of settings that all engines share.

use std::fmt::Display;

use super::BodyId;
use crate::geometry::Vector;

/// What can go wrong in a world.
#[derive(Debug, thiserror::Error)]
pub enum WorldError {
    /// A body, or what is asked of it, was refused, and why.
    #[error("a request about a body was refused: {0}")]
    BadBody(String),
    /// No body of that number is in the world.
    #[error("there is no body {0:?} in this world")]
    NoSuchBody(BodyId),
    /// Only kinematic bodies can be moved.
    #[error("body {0:?} is not kinematic")]
    NotKinematic(BodyId),
    /// Only pressed bodies have a force.
    #[error("body {0:?} is not pressed")]
    NotPressed(BodyId),
    /// Settings the engine cannot take, or did not keep.
    #[error("engine setting `{setting}`: {reason}")]
    BadSetting {
        /// Name of the setting.
        setting: String,
        /// Why.
        reason: String,
    },
    /// The engine reported a fault of its own.
    #[error("the engine failed: {0}")]
    Engine(String),
    /// A check found the state unphysical.
    #[error("the simulation became unphysical at {time_s:.4} s: {what}")]
    Unphysical {
        /// Simulated time since the run began, in s.
        time_s: f64,
        /// What was found, with the body and the limit.
        what: String,
    },
}

impl WorldError {
    pub(super) fn bad_setting(setting: &str, reason: impl ToString) -> Self {
        Self::BadSetting { setting: setting.to_owned(), reason: reason.to_string() }
    }
}

/// A setting that is sound, or else what it is.
pub(super) fn sound<T: Display>(
    setting: &str,
    value: T,
    is_sound: bool,
    else_it_is: &str,
) -> Result<T, WorldError> {
    let bad = WorldError::bad_setting(setting, format!("{value} is {else_it_is}"));
    is_sound.then_some(value).ok_or(bad)
}

/// A setting that must be a positive number.
pub(super) fn positive(setting: &str, value: f64) -> Result<f64, WorldError> {
    sound(setting, value, value.is_finite() && value > 0.0, "not a positive number")
}

/// Gravity in m/s², as an engine takes it.
pub(super) fn finite(gravity: &Vector) -> Result<(), WorldError> {
    let bad = || WorldError::bad_setting("gravity", format!("{gravity:?} is not finite"));
    gravity.iter().all(|g| g.is_finite()).then_some(()).ok_or_else(bad)
}
