//! Engine settings that do not go together.

use serde_json::Value;

use super::{Parts, fault};
use crate::scenario::{Backend, ContactPath, Fault, StockSettings};

/// Bullet's own contacts alone have a margin, inertia by boxes, a least mass
/// and sleep; elsewhere these fields would be without effect, which nobody who
/// sets them means.
pub(super) fn check(parts: &Parts, faults: &mut Vec<Fault>) {
    let Some(engine) = &parts.engine else { return };
    let who = match (engine.backend, engine.contact_path) {
        (Backend::Bullet, ContactPath::Bullet) => return,
        (Backend::Bullet, ContactPath::Manifold) => {
            "the contact path `manifold`, whose hulls have no margin and whose bodies never sleep"
        }
        (Backend::Rapier, _) => "the backend `rapier`",
    };
    let as_json = |s: &StockSettings| serde_json::to_value(s).unwrap_or(Value::Null);
    let (asked, default) = (as_json(&engine.bullet), as_json(&StockSettings::default()));
    for (field, value) in asked.as_object().into_iter().flatten() {
        if *value != default[field] {
            faults.push(fault(
                &format!("engine.bullet.{field}"),
                value,
                format!("{}, or \"contact_path\": \"bullet\" on Bullet", default[field]),
                format!("a setting of Bullet's own contacts, which is not for {who}"),
            ));
        }
    }
}
