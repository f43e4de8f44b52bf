//! No number of the C++ side has a unit: what has one comes from `src/scale.rs`.

use super::files;

/// Floating-point constants of `cpp/`, each with what it is instead of a length, a speed or a time
/// of the laboratory: those come through the bridge, from `src/scale.rs`.
const OF_CPP: [(&str, &str); 29] = [
    ("contact_impacts.h IMPACT_SHARE", "a share"),
    ("contact_kernels.h TINY", "no number"),
    ("contact_kernels.h TINY_SQUARE", "no number"),
    ("contact_kernels.h UNLIMITED", "no number"),
    ("contact_load.h NEVER", "no number: a gap that nothing crosses"),
    ("contact_memory.cpp SAME_NORMAL", "a cosine"),
    ("contact_run.h FARTHEST", "a share"),
    ("contact_run.h LOCAL_SHARE", "a share"),
    ("contact_run.h WORSE", "a factor"),
    ("core_distance.cpp EXACT", "a share of a distance"),
    ("core_distance.cpp TOUCHING", "a share of a size"),
    ("crowd.cpp CELLS_PER_BODY", "a factor"),
    ("crowd.cpp WIDE_RADII", "a factor of radii"),
    ("hull_axis_kernels.h PARALLEL", "a sine squared"),
    ("hull_axis_kernels.h SAME_SIDE", "a product of sines"),
    ("hull_beside.cpp FLAT", "a cosine"),
    ("hull_bodies.cpp CROWD_MARGINS", "a factor of the margin"),
    ("hull_clip.cpp CHOICE_SLACK", "a factor"),
    ("hull_clip.cpp OPPOSITE_SLACK", "a cosine"),
    ("hull_clip.cpp PARALLEL", "a sine squared"),
    ("hull_data.cpp SHARP", "a sine"),
    ("hull_data.cpp SKEW", "a cosine"),
    ("hull_pair.cpp ANY", "no number"),
    ("hull_pair.h NOT_APART", "no number"),
    ("rounded_pair.cpp ANY", "no number"),
    ("rounded_pair.cpp FLAT", "a cosine"),
    ("rounded_pair.cpp GAP_NOISE", "a share of the hysteresis"),
    ("rounded_pair.cpp NEARLY_FLAT", "a cosine"),
    ("rounded_pair.cpp STILL_FLAT", "a cosine"),
];

/// Names of the floating-point constants of a C++ source.
fn constants_of_cpp(source: &str) -> Vec<String> {
    let statements = source.split([';', '{', '}']);
    let named = |statement: &str| {
        let on_line = statement.split_once("constexpr ");
        let (_, declared) = on_line.or_else(|| statement.split_once("constexpr\n"))?;
        let (left, _) = declared.split_once('=')?;
        let is_float = ["double", "float", "::Number"].iter().any(|of| left.contains(of));
        let name = left.split_whitespace().next_back()?;
        is_float.then(|| name.to_owned())
    };
    statements.filter_map(named).collect()
}

/// Law: no number of the C++ side is a length, a speed or a time of the laboratory.
#[test]
fn numbers_of_cpp_have_no_unit() {
    let mut found = Vec::new();
    for (path, source) in files(&["cpp"], &["h", "cpp"]) {
        let file = path.trim_start_matches("cpp/");
        found.extend(constants_of_cpp(&source).iter().map(|name| format!("{file} {name}")));
    }
    found.sort();
    let known: Vec<&str> = OF_CPP.iter().map(|(name, _)| *name).collect();
    assert_eq!(found, known, "law: found left; each is known for what it is, right");
}

#[test]
fn constants_of_cpp_are_found() {
    let source = "constexpr int A = 1;\nstatic constexpr float B = 2; // C\n\
                  inline constexpr\n    typename L::Number D = static_cast<N>(3);\n\
                  namespace { constexpr double E = 4e-3; }\nconst double f = 5;";
    assert_eq!(constants_of_cpp(source), ["B", "D", "E"], "law: those that are no whole numbers");
}
