//! The fields of `out/referee.json`: what others may rely on, and what stands beside it.

use serde_json::Value;

/// One part of the file: its name, the fields of an entry that are agreed upon, and
/// those that may change, with spaces between.
pub struct Part {
    pub name: &'static str,
    agreed: &'static str,
    beside: &'static str,
}

pub const PARTS: [Part; 3] = [
    Part {
        name: "one_step",
        agreed: "scene grains contacts engine velocity_error_median_percent \
                 velocity_error_p99_percent reference_residual",
        beside: "instants instants_below_1e_10 velocity_error_worst_percent \
                 instant_error_median_percent instant_error_worst_percent engine_residual \
                 siconos_error_worst other_solution_p99_percent inconsistency \
                 reference_wall_s_per_instant",
    },
    Part {
        name: "pours",
        agreed: "engine friction restitution realisations height_mean_mm \
                 height_standard_error_mm difference_percent equivalent_within_0_5_percent",
        beside: "difference_standard_error_percent difference_interval_percent correlation \
                 coordination_mean coordination_standard_error sliding_share deepest_overlap_mm \
                 outside unsolved_share worst_residual energy_gain_worst wall_s_per_pour",
    },
    Part {
        name: "static",
        agreed: "specimen engine least_friction",
        beside: "grains contacts gap_mm friction least_friction_of_99_percent fall unbalanced \
                 worst_left_percent left_percent stands wall_s",
    },
];

/// Whether a specimen can stand: no grain falls, and the coefficients with which the others stand,
/// over those that it has, are at most 1; `None`: none is large enough.
pub fn stands(fall: u64, least_factor: Option<f64>) -> bool {
    fall == 0 && least_factor.is_some_and(|factor| factor <= 1.0)
}

/// What is wrong with the fields of a file's entries: those that are missing, and those
/// that nothing tells of.
pub fn faults(file: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    let names = file.as_object().into_iter().flat_map(|parts| parts.keys());
    let unknown = names.filter(|name| PARTS.iter().all(|p| p.name != *name));
    faults.extend(unknown.map(|name| format!("`{name}` is no part of the file")));
    for Part { name, agreed, beside } in PARTS {
        let Some(entries) = file[name].as_array() else {
            faults.push(format!("`{name}` is not a list"));
            continue;
        };
        let all: Vec<&str> = agreed.split_whitespace().chain(beside.split_whitespace()).collect();
        for (n, entry) in entries.iter().enumerate() {
            let missing = all.iter().filter(|field| entry.get(**field).is_none());
            faults.extend(missing.map(|field| format!("`{name}[{n}]` has no `{field}`")));
            let known = entry.as_object().into_iter().flat_map(|fields| fields.keys());
            let surplus = known.filter(|field| !all.contains(&field.as_str()));
            faults.extend(
                surplus.map(|field| format!("`{name}[{n}]` has `{field}`, which is unknown")),
            );
        }
    }
    faults
}
