//! Names of fields and choices that a scenario had once: each is refused with the name of today.

/// Paths of the groups that hold a field, its old name and its new one.
const FIELDS: [(&[&str], &str, &str); 11] = [
    (&[""], "control_s", "rest_test_s"),
    (&["engine"], "contact_path", "contact_solver"),
    (&["engine"], "manifold", "native"),
    (&["engine"], "bullet", "stock"),
    (&["engine"], "error_reduction", "erp"),
    (&["engine.native", "engine.rapier"], "sweeps", "iterations"),
    (&["engine.rapier"], "relaxing_sweeps", "relaxing_iterations"),
    (&["engine.native"], "push_out_speed_m_per_s", "max_depenetration_velocity_m_per_s"),
    (&["engine.stock"], "deactivation", "sleeping"),
    (&["engine.stock"], "deactivation_speed_m_per_s", "sleeping_speed_m_per_s"),
    (&["engine.stock"], "deactivation_spin_rad_per_s", "sleeping_spin_rad_per_s"),
];

/// Path of a field, an old choice there and its new name.
const CHOICES: [(&str, &str, &str); 2] =
    [("engine.contact_solver", "manifold", "native"), ("engine.contact_solver", "bullet", "stock")];

/// What the field `name` of the group at a dotted path is called now; `None` where it never
/// had another name.
pub(super) fn field(group: &str, name: &str) -> Option<&'static str> {
    let renamed =
        |(groups, old, _): &&(&[&str], &str, &str)| *old == name && groups.contains(&group);
    FIELDS.iter().find(renamed).map(|(_, _, new)| *new)
}

/// What the choice `word` of the field at a dotted path is called now.
pub(super) fn choice(path: &str, word: &str) -> Option<&'static str> {
    let renamed = |(at, old, _): &&(&str, &str, &str)| *at == path && *old == word;
    CHOICES.iter().find(renamed).map(|(_, _, new)| *new)
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::scenario::structure;

    /// What is said of a scenario that has one field at a dotted path.
    fn said(path: &str, value: Value) -> Vec<String> {
        let inner = path.rsplit('.').fold(value, |inner, name| json!({ name: inner }));
        structure::check(&inner).faults.iter().map(ToString::to_string).collect()
    }

    /// Law: an old name is refused, and the message has the new one.
    #[test]
    fn old_names_are_refused_with_the_new_one() {
        for (groups, old, new) in FIELDS {
            for group in groups.iter() {
                let path =
                    if group.is_empty() { (*old).to_owned() } else { format!("{group}.{old}") };
                let said = said(&path, json!(1));
                let words = format!("this field is now called `{new}`");
                assert!(
                    said.iter().any(|s| s.contains(&path) && s.contains(&words)),
                    "law: `{path}` is refused with `{new}`, got {said:?}"
                );
            }
        }
        for (path, old, new) in CHOICES {
            let said = said(path, json!(old));
            let words = format!("this choice is now called \"{new}\"");
            assert!(said.iter().any(|s| s.contains(&words)), "law: {old} is {new}, got {said:?}");
        }
    }

    /// Law: names of today, and old names elsewhere, are no old names.
    #[test]
    fn new_names_and_other_places_are_left_alone() {
        for (groups, _, new) in FIELDS {
            assert_eq!(field(groups[0], new), None, "law: `{new}` is today's");
        }
        assert_eq!(field("engine", "sweeps"), None);
        assert_eq!(field("grains", "control_s"), None);
        assert_eq!(choice("engine.backend", "bullet"), None, "law: the engine is called so");
        assert!(
            said("engine.native.iterations", json!(4)).iter().all(|s| !s.contains("iterations"))
        );
    }
}
