//! Faults of the scenarios that this study makes itself, in terms of what it was asked: nobody
//! typed its moulds and stages.

use super::*;

/// A fault of the scenario of a state, as whoever asked for that state can fix it.
pub(super) fn told(
    state: &str,
    fault: Fault,
    options: &DensityOptions,
    grains: usize,
    mould: &Mould,
) -> Fault {
    let first = fault.path.split(['.', '[']).next().unwrap_or_default();
    let is_vibration = state == "densest" && ["stages", "engine"].contains(&first);
    let option = |name: &str, fault: Fault| Fault { path: name.to_owned(), ..fault };
    let own = Fault { file: String::new(), ..fault.clone() };
    if is_vibration && fault.path.ends_with(".duration_s") {
        let message = "the vibration takes whole cycles, so that the table ends where it began";
        return option("--seconds", Fault { message: message.to_owned(), ..own });
    }
    if is_vibration && fault.path == "stages" {
        return option("--seconds", own);
    }
    if is_vibration && (fault.path == "engine.rate_hz" || fault.message.contains("resolve")) {
        let found = options.double_amplitude_mm.to_string();
        let allowed = "a smaller one, or a lower --frequency-hz".to_owned();
        return option("--double-amplitude-mm", Fault { found, allowed, ..own });
    }
    let is_mould =
        ["apparatus", "pieces"].contains(&first) || state == "loosest" && first == "stages";
    if is_mould {
        let message = format!(
            "there are too few grains: the mould that they fill is {:.0} mm wide, too narrow for \
             their size",
            to_mm(mould.diameter)
        );
        let allowed = "more grains, as by a larger total_mass_g";
        return Fault::new(message, counted(grains, "grain"), allowed)
            .at("grains")
            .of(options.scenario.display());
    }
    // Of what was typed, which does not go with what this state needs.
    Fault { file: format!("the {state} state: {}", fault.file), ..fault }
}

/// Each fault once: states share moulds and stages.
pub(super) fn without_repeats(errors: ScenarioErrors) -> ScenarioErrors {
    let ScenarioErrors::Faults(found) = errors else { return errors };
    ScenarioErrors::Faults(each_once(found))
}
