//! Conversions between the units people type and the SI units used inside.
//!
//! Every number inside the program is SI. Fields that a person types or reads
//! carry their unit in their name (`_mm`, `_g`, ...) and pass through here once.

/// Millimetres to metres.
pub fn from_mm(mm: f64) -> f64 {
    mm * 1e-3
}

/// Metres to millimetres.
pub fn to_mm(metres: f64) -> f64 {
    metres * 1e3
}

/// Metres to millimetres as they were typed: the shortest decimal number that gives these metres, so
/// that sieves of 1.18 mm are not of 1.1800000000000002 mm.
pub fn to_typed_mm(metres: f64) -> f64 {
    let mm = to_mm(metres);
    let with_digits = |digits: usize| -> Option<f64> { format!("{mm:.digits$e}").parse().ok() };
    let gives_these = |short: &f64| from_mm(*short) == metres;
    (0..17).filter_map(with_digits).find(gives_these).unwrap_or(mm)
}

/// Grams to kilograms.
pub fn from_g(g: f64) -> f64 {
    g * 1e-3
}

/// Kilograms to grams.
pub fn to_g(kg: f64) -> f64 {
    kg * 1e3
}

/// Kilopascals to pascals.
pub fn from_kpa(kpa: f64) -> f64 {
    kpa * 1e3
}

/// Pascals to kilopascals.
pub fn to_kpa(pascals: f64) -> f64 {
    pascals * 1e-3
}

/// Cubic metres to cubic centimetres.
pub fn to_cm3(m3: f64) -> f64 {
    m3 * 1e6
}

/// Cubic metres to cubic millimetres.
pub fn to_mm3(m3: f64) -> f64 {
    m3 * 1e9
}

/// Degrees to radians.
pub fn from_deg(deg: f64) -> f64 {
    deg.to_radians()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: what was typed in mm is shown as it was typed.
    #[test]
    fn millimetres_come_back_as_they_were_typed() {
        assert_ne!(to_mm(from_mm(1.18)), 1.18, "the product has other last bits");
        for hundredths in 1..=10_000 {
            let typed = f64::from(hundredths) / 100.0;
            let got = to_typed_mm(from_mm(typed));
            assert_eq!(got, typed, "law: {typed} mm, got {got}");
        }
        for metres in [0.0, 1.0 / 3.0, 1e-9, f64::MIN_POSITIVE, 1e300, f64::INFINITY] {
            let got = from_mm(to_typed_mm(metres));
            assert!(
                got == metres || (got / metres - 1.0).abs() < 1e-15,
                "law: {metres}, got {got}"
            );
        }
        assert!(to_typed_mm(f64::NAN).is_nan(), "law: what is no number stays none");
    }
}
