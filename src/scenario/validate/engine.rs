//! Engine settings that do not go together.

use super::*;

/// Stock Bullet contacts alone have a margin, inertia by boxes, a least mass
/// and sleep; elsewhere these fields would be without effect, which nobody who
/// sets them means.
pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    let Some(engine) = &parts.engine else { return };
    let who = match (engine.backend, engine.contact_solver) {
        (Backend::Bullet, ContactSolver::Stock) => return,
        (Backend::Bullet, ContactSolver::Native) => {
            "the native contact solver, whose hulls have no margin and whose bodies never sleep"
        }
        (Backend::Rapier, _) => "the backend `rapier`",
    };
    let as_json = |s: &StockSettings| serde_json::to_value(s).unwrap_or(Value::Null);
    let (asked, default) = (as_json(&engine.stock), as_json(&StockSettings::default()));
    for (field, value) in asked.as_object().into_iter().flatten() {
        let default = &default[field];
        let allowed = format!("{default}, or \"contact_solver\": \"stock\" on Bullet");
        let why = format!("a setting of stock Bullet contacts, which is not for {who}");
        faults.add_if(value != default, &format!("engine.stock.{field}"), value, allowed, why);
    }
}
