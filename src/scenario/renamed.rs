//! Old names of fields, choices, stages and results: each is refused with the name of today.

use super::*;

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

/// How the end of a run was asked for, and how it is now.
const STAGES: [(&str, &str); 1] = [("control", "rest_test")];

/// Old names of fields of `summary.json`, which are tables of a run as well, and new ones.
const RESULTS: [(&str, &str); 3] =
    [("control", "rest_test"), ("guards", "checks"), ("contact_path", "contact_solver")];

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

/// What the stage that is asked for by a name is called now.
pub(super) fn stage(name: &str) -> Option<&'static str> {
    STAGES.iter().find(|(old, _)| *old == name).map(|(_, new)| *new)
}

/// The dotted path of a field of a scenario as it is called now; `None` where no name of it has
/// changed.
pub fn renamed_field(path: &str) -> Option<String> {
    let now = path.split('.').fold(String::new(), |group, name| {
        let new = field(&group, name).unwrap_or(name);
        field_path(&group, new)
    });
    (now != path).then_some(now)
}

/// The dotted path of a result, or the name of a table of a run, as it is called now; `None` where
/// no name of it has changed.
pub fn renamed_result(path: &str) -> Option<String> {
    let (first, rest) = path.split_at(path.find('.').unwrap_or(path.len()));
    let renamed = RESULTS.iter().find(|(old, _)| *old == first);
    renamed.map(|(_, new)| format!("{new}{rest}"))
}

/// What is said of a scenario's JSON that an earlier version wrote: each old name in it with the
/// new one; `None` where it has none.
pub fn of_earlier_version(scenario: &Value) -> Option<String> {
    let said = |old: OldName| match old.choice {
        Some(new) => format!("{} of `{}` is now called \"{new}\"", old.value, old.was),
        None => format!("`{}` is now called `{}`", old.was, old.is),
    };
    let found: Vec<String> = old_names(scenario, "", "").into_iter().map(said).collect();
    let said = || format!("an earlier version wrote this scenario: {}", found.join(", "));
    (!found.is_empty()).then(said)
}

/// An old name of a field, or of a choice there.
pub(super) struct OldName<'a> {
    /// Dotted path of the field in the file.
    pub was: String,
    /// That path as it is called now.
    pub is: String,
    /// What stands there.
    pub value: &'a Value,
    /// What the choice is called now, where it is the choice that has another name.
    pub choice: Option<&'static str>,
}

/// The old names in a group that is called `was` in a file, and `is` now.
pub(super) fn old_names<'a>(group: &'a Value, was: &str, is: &str) -> Vec<OldName<'a>> {
    let mut found = Vec::new();
    for (name, value) in group.as_object().into_iter().flatten() {
        let new = field(is, name);
        let (was, is) = (field_path(was, name), field_path(is, new.unwrap_or(name.as_str())));
        let choice = value.as_str().and_then(|word| choice(&is, word));
        let within = old_names(value, &was, &is);
        let of = |choice| OldName { was: was.clone(), is: is.clone(), value, choice };
        found.extend(new.map(|_| of(None)));
        found.extend(choice.map(|new| of(Some(new))));
        found.extend(within);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

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
        // A group and what it holds have other names: all are said at once.
        let said_of_group = said("engine.manifold", json!({ "sweeps": 4, "threads": 1 }));
        for [old, new] in [["engine.manifold", "native"], ["engine.manifold.sweeps", "iterations"]]
        {
            let begin = format!("{old}: this field is now called `{new}`");
            assert!(
                said_of_group.iter().any(|s| s.contains(&begin)),
                "law: `{old}` is refused with `{new}`, got {said_of_group:?}"
            );
        }
        assert_eq!(said_of_group.len(), 2 + said("engine", json!({})).len(), "law: no more");
        for (path, old, new) in CHOICES {
            let said = said(path, json!(old));
            let words = format!("this choice is now called \"{new}\"");
            assert!(said.iter().any(|s| s.contains(&words)), "law: {old} is {new}, got {said:?}");
        }
    }

    /// Law: an old name within a path gives the path of today, also below a group that has
    /// another name.
    #[test]
    fn old_paths_have_new_ones() {
        for (old, new) in [
            ("engine.manifold.sweeps", Some("engine.native.iterations")),
            ("engine.native.sweeps", Some("engine.native.iterations")),
            ("engine.bullet.deactivation", Some("engine.stock.sleeping")),
            ("control_s", Some("rest_test_s")),
            ("engine.native.iterations", None),
            ("stages[0].control_s", None),
            ("", None),
        ] {
            assert_eq!(renamed_field(old).as_deref(), new, "law: what `{old}` is called now");
        }
        for (old, new) in [
            ("control.duration_s", Some("rest_test.duration_s")),
            ("guards.speed.worst", Some("checks.speed.worst")),
            ("control", Some("rest_test")),
            ("checks.control", None),
            ("", None),
        ] {
            assert_eq!(renamed_result(old).as_deref(), new, "law: what `{old}` is called now");
        }
    }

    /// Law: of a scenario that an earlier version wrote every old name is said with the new one,
    /// of one of today nothing.
    #[test]
    fn scenarios_of_earlier_versions_are_known() {
        let old = json!({
            "name": "control_s", "control_s": 2, "stages": [{ "stage": "pour" }],
            "engine": { "contact_path": "manifold", "manifold": { "sweeps": 4 } },
        });
        let expected = "an earlier version wrote this scenario: `control_s` is now called \
             `rest_test_s`, `engine.contact_path` is now called `engine.contact_solver`, \
             \"manifold\" of `engine.contact_path` is now called \"native\", `engine.manifold` is \
             now called `engine.native`, `engine.manifold.sweeps` is now called \
             `engine.native.iterations`";
        assert_eq!(of_earlier_version(&old).as_deref(), Some(expected), "law: all old names");
        let now = json!({
            "rest_test_s": 2, "engine": { "backend": "bullet", "contact_solver": "stock" },
        });
        assert_eq!(of_earlier_version(&now), None, "law: these are today's names");
        assert_eq!(of_earlier_version(&Value::Null), None, "law: nothing has no old name");
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
