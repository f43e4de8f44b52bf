//! Numbers that are filled in: within what is allowed of their field, with as many digits as a
//! person would type.

/// What is allowed of a field, by its unit: from, to.
pub(super) fn allowed(path: &str) -> (f64, f64) {
    let ends = |unit: &str| path.ends_with(unit);
    match () {
        () if ends("length_scale") => (1.0, 1e4),
        () if ends("_n_per_m") => (1e-3, 1e9),
        () if ends("_mm_per_s") => (1e-9, 1e6),
        () if ends("_m_per_s") => (1e-12, 100.0),
        () if ends("_per_s") => (1e-6, 1e4),
        () if ends("engine_unit_mm") => (0.01, 1e5),
        () if ends("_mm") => (1e-3, 1e4),
        () if ends("rapier.contact_frequency_hz") => (1e-3, 1e6),
        () if ends("_hz") => (30.0, 1e5),
        () if ends("_g") => (1e-3, 1e9),
        () if ends("hold_s") => (0.0, 60.0),
        () if ends("time_limit_s") || ends("settle_limit_s") => (0.0, 600.0),
        () => (f64::NEG_INFINITY, f64::INFINITY),
    }
}

/// The nearest value to one that is allowed of a field.
pub(super) fn within(path: &str, value: f64) -> f64 {
    let (low, high) = allowed(path);
    value.clamp(low, high)
}

/// A value to a number of significant digits.
pub(super) fn rounded(value: f64, digits: usize) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return value;
    }
    // Through its decimal notation, whose last bit is right.
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}
