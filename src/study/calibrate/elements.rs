//! Targets that are elements of lists of a laboratory: refused before anything runs where the
//! scenario has no such element.

use super::*;

/// Checks that a scenario has the piece, group, opening or region that a target is about.
///
/// # Errors
/// [`StudyError::Scenario`] with what the scenario has.
pub(super) fn there(target: &CalibrationTarget, scenario: &Scenario) -> Result<(), StudyError> {
    let steps = target.field.split(['.', '[', ']']).map(str::trim);
    let steps: Vec<&str> = steps.filter(|step| !step.is_empty()).collect();
    let ["laboratory", list, number, ..] = steps.as_slice() else { return Ok(()) };
    let measures = &scenario.measures;
    let names: Vec<&str> = match *list {
        "pieces" => scenario.pieces.iter().map(|piece| piece.name.as_str()).collect(),
        "groups" => measures.groups.iter().map(|group| group.name.as_str()).collect(),
        "openings" => measures.openings.iter().map(|opening| opening.name.as_str()).collect(),
        "regions" => measures.regions.iter().map(|region| region.name.as_str()).collect(),
        _ => return Ok(()),
    };
    if !number.parse::<usize>().is_ok_and(|number| number >= names.len()) {
        return Ok(());
    }
    let there: Vec<String> =
        names.iter().enumerate().map(|(number, name)| format!("{number} `{name}`")).collect();
    let why = match there.is_empty() {
        true => format!("that needs `measures.{list}`"),
        false => format!("its {list} are {}", there.join(", ")),
    };
    refused(format!(
        "--target {}: the scenario `{}` does not measure it: {why}",
        target.field, scenario.name
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::bare_scenario;

    /// Law: what a scenario does not have is refused before anything runs, with what it has; its
    /// other results are not.
    #[test]
    fn elements_that_no_scenario_has_are_refused() {
        let mut scenario = bare_scenario();
        scenario.measures = serde_json::from_value(json!({
            "openings": [{ "name": "mouth", "at_mm": [0, 0, 1], "diameter_mm": 9 }]
        }))
        .expect("measures");
        let said = |field: &str| {
            let target: CalibrationTarget = format!("{field}=1").parse().expect("a target");
            there(&target, &scenario).err().map(|error| error.to_string()).unwrap_or_default()
        };
        for (field, words) in [
            ("laboratory.openings.1.rate_g_per_s", "its openings are 0 `mouth`"),
            ("laboratory.openings[1].passed_g", "its openings are 0 `mouth`"),
            ("laboratory.regions.0.void_ratio", "that needs `measures.regions`"),
            ("laboratory.groups[0].force_n[2]", "that needs `measures.groups`"),
        ] {
            let said = said(field);
            let both = said.contains(field) && said.contains(words);
            assert!(both, "law: `{words}` is said of {field}, got `{said}`");
        }
        for field in ["laboratory.openings.0.rate_g_per_s", "laboratory.balance.load_n", "a.b"] {
            assert_eq!(said(field), "", "law: {field} is not refused");
        }
    }
}
