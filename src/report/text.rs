//! Numbers and words for readers.

use crate::{plain::without_zeros, record::GradationSummary};

/// A number with a fixed count of decimals; a dash for what is none.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.decimals$}");
    // −0.0 is no finding.
    let zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if zero { text.replace('-', "") } else { text.replace('-', "\u{2212}") }
}

/// A length in mm to a thousandth; of one that is nothing to that the bound.
pub(crate) fn thousandths(mm: f64) -> String {
    if mm.abs() < 5e-4 { "less than 0.001".to_owned() } else { number(mm, 3) }
}

/// "It falls by a, b." where there is something.
pub(crate) fn listed(what: &str, items: &[String]) -> String {
    if items.is_empty() { String::new() } else { format!("{what} {}.", items.join(", ")) }
}

/// A number with four digits that count, five from 1000 on, without trailing zeros.
pub(crate) fn compact(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if magnitude < -4.0 {
        return format!("{value:.2e}").replace('-', "\u{2212}");
    }
    let decimals = (if magnitude >= 3.0 { 4.0 } else { 3.0 } - magnitude).clamp(0.0, 8.0) as usize;
    without_zeros(&number(value, decimals)).to_owned()
}

/// A text with a capital letter at its beginning; names of fields stay as they are.
pub(crate) fn capital(text: &str) -> String {
    let field = text.split(' ').next().is_some_and(|word| word.contains(['.', '_']));
    let mut letters = text.chars();
    match letters.next() {
        Some(first) if !field => first.to_uppercase().chain(letters).collect(),
        _ => text.to_owned(),
    }
}

/// Class, sizes and coefficients of a grain size distribution in a line.
pub(crate) fn gradation_in_words(of: &GradationSummary) -> String {
    format!(
        "{}, D10 {} mm, D30 {} mm, D50 {} mm, D60 {} mm, Cu {}, Cc {}",
        of.uscs,
        number(of.d10_mm, 2),
        number(of.d30_mm, 2),
        number(of.d50_mm, 2),
        number(of.d60_mm, 2),
        number(of.coefficient_of_uniformity, 2),
        number(of.coefficient_of_curvature, 2),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_honest() {
        for (value, expected) in [
            (0.0, "0"),
            (3.0, "3"),
            (19.61, "19.61"),
            (2673.9, "2673.9"),
            (1456.0, "1456"),
            (-0.4, "\u{2212}0.4"),
            (0.792_590_233, "0.7926"),
            (123_456.7, "123457"),
            (1.234e-6, "1.23e\u{2212}6"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(compact(value), expected, "{value} for the reader (got left)");
        }
        for (mm, expected) in [
            (0.0, "less than 0.001"),
            (-4.9e-4, "less than 0.001"),
            (5.1e-4, "0.001"),
            (-0.0123, "\u{2212}0.012"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(
                thousandths(mm),
                expected,
                "law: a length that is not seen is bounded: {mm}"
            );
        }
        assert_eq!(number(-0.04, 1), "0.0", "no negative zero");
        assert_eq!(number(-0.06, 1), "\u{2212}0.1");
    }
}
