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
