//! Text of files and names as it may be shown: characters that are not seen but change what is
//! seen stand as their code points. All that goes to a terminal passes here. And short numbers.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use serde::Serializer;

/// Whether a character is not seen but changes what is: one that controls a
/// terminal, begins another line, or turns the direction of what follows
/// (Unicode's `Bidi_Control`), so that a name reads as another. The noncharacters
/// U+FDD0 to U+FDEF are among them: the command line marks its own colours by them.
pub fn misleads(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
        || matches!(c, '\u{fdd0}'..='\u{fdef}')
}

/// A text as one line: every character that misleads by its code point.
pub fn plain(text: &str) -> Cow<'_, str> {
    plain_but(text, |_| false)
}

/// A path as one line.
pub fn plain_path(path: &Path) -> String {
    plain(&path.display().to_string()).into_owned()
}

/// A path as JSON has it, which is UTF-8: a mark stands for what is not.
///
/// # Errors
/// Those of the serializer.
pub fn json_path<S: Serializer>(path: &Path, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&path.to_string_lossy())
}

/// The same of several.
///
/// # Errors
/// Those of the serializer.
pub fn json_paths<S: Serializer>(paths: &[PathBuf], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(paths.iter().map(|path| path.to_string_lossy()))
}

/// A text that may have several lines: the same, but ends of lines stay.
pub fn plain_lines(text: &str) -> Cow<'_, str> {
    plain_but(text, |c| c == '\n')
}

/// The same, but for characters that stay as they are.
pub fn plain_but(text: &str, stays: impl Fn(char) -> bool) -> Cow<'_, str> {
    let shown = |c: char| misleads(c) && !stays(c);
    if !text.contains(shown) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        if shown(c) {
            plain += &format!("\\u{:04x}", u32::from(c));
        } else {
            plain.push(c);
        }
    }
    Cow::Owned(plain)
}

/// An argument as a shell reads it back: in quotes where a character has a meaning there.
pub fn in_shell(argument: &str) -> Cow<'_, str> {
    let has_no_meaning = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+".contains(c);
    if !argument.is_empty() && argument.chars().all(has_no_meaning) {
        return Cow::Borrowed(argument);
    }
    Cow::Owned(format!("'{}'", argument.replace('\'', r"'\''")))
}

/// How many of something there are, its name, which is given as that of one, in the same number.
pub fn counted(count: usize, one: &str) -> String {
    format!("{count} {}", in_number(count, one, &several(one)))
}

/// Of the forms of a word the one that goes with a number of things.
pub fn in_number<'a>(count: usize, of_one: &'a str, of_several: &'a str) -> &'a str {
    if count == 1 { of_one } else { of_several }
}

/// The name of several of something: runs, bodies, meshes, vertices.
fn several(one: &str) -> String {
    match (one.strip_suffix("ex"), one.strip_suffix('y')) {
        (Some(stem), _) => format!("{stem}ices"),
        (_, Some(stem)) => format!("{stem}ies"),
        _ if one.ends_with("sh") => format!("{one}es"),
        _ => format!("{one}s"),
    }
}

/// A decimal number without the zeros at its end; a zero without a sign.
pub fn without_zeros(number: &str) -> &str {
    let short = match number.contains('.') {
        true => number.trim_end_matches('0').trim_end_matches('.'),
        false => number,
    };
    if short == "-0" { "0" } else { short }
}

/// A number with up to three decimals.
pub fn three_decimals(value: f64) -> String {
    without_zeros(&format!("{value:.3}")).to_owned()
}

/// A number for people: four significant digits, no zeros at its end; with an exponent where it is
/// longer than twelve digits.
pub fn four_digits(value: f64) -> String {
    let [text] = components([value]);
    text
}

/// Numbers of one quantity, such as the components of a force, for people: with as many decimals as
/// give the largest of them four significant digits.
pub fn components<const N: usize>(values: [f64; N]) -> [String; N] {
    let largest = values.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let exponent = if largest > 0.0 { largest.log10().floor() } else { 0.0 };
    let decimals = (3.0 - exponent).clamp(0.0, 12.0) as usize;
    values.map(|value| match value.abs() < 1e12 {
        true => without_zeros(&format!("{value:.decimals$}")).to_owned(),
        false if value.is_finite() => format!("{value:.3e}"),
        false => value.to_string(),
    })
}

/// A mass in g for people: to a tenth, or of small ones to three digits.
pub fn grams(mass: f64) -> String {
    if !(mass > 0.0 && mass < 10.0) {
        let tenths = format!("{mass:.1}");
        return if tenths == "-0.0" { "0.0".to_owned() } else { tenths };
    }
    let decimals = (2 - mass.log10().floor() as i32).max(0) as usize;
    without_zeros(&format!("{mass:.decimals$}")).to_owned()
}

/// A number for tables that programs read: with these decimals, or more where they would leave less
/// than four digits that count, as of a mass far below a gram.
pub fn decimals_at_least(value: f64, decimals: usize) -> String {
    const DIGITS: i32 = 4;
    let magnitude = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    if magnitude < -9.0 {
        return format!("{value:.3e}");
    }
    let decimals = decimals.max((DIGITS - 1 - magnitude as i32).max(0) as usize);
    format!("{value:.decimals$}")
}

/// A text has all of these words.
#[cfg(test)]
#[track_caller]
pub(crate) fn assert_holds(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "law: `{word}` is said, got `{text}`");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_misleads_is_shown_by_its_code_point() {
        for (text, expected) in [
            ("gravel 8\u{2013}16 mm, \u{540d}\u{524d} \u{1f327}", None),
            ("a\u{200d}b", None), // joins letters, and is part of many a sign
            ("a\u{7}b", Some("a\\u0007b")),
            ("\u{1b}[31ma", Some("\\u001b[31ma")),
            ("a\r\n\tb", Some("a\\u000d\\u000a\\u0009b")),
            ("a\u{85}\u{9b}b", Some("a\\u0085\\u009bb")),
            ("a\u{202e}b", Some("a\\u202eb")),
            ("\u{2066}a\u{2069}", Some("\\u2066a\\u2069")),
            ("a\u{200f}\u{61c}\u{2028}", Some("a\\u200f\\u061c\\u2028")),
            ("a\u{fdd1}b", Some("a\\ufdd1b")),
        ] {
            let expected = expected.unwrap_or(text);
            assert_eq!(plain(text), expected, "law: only what misleads is shown otherwise");
        }
        assert_eq!(plain_lines("a\n\u{1b}b\rc"), "a\n\\u001bb\\u000dc", "law: lines stay lines");
    }

    /// Law: a shell reads one argument, the same.
    #[test]
    fn an_argument_is_quoted_where_a_shell_would_change_it() {
        for (argument, expected) in [
            ("engine.rate_hz=960", "engine.rate_hz=960"),
            ("stages[1].duration_s=5", "'stages[1].duration_s=5'"),
            ("engine.backend=\"rapier\"", "'engine.backend=\"rapier\"'"),
            ("description=it's", r"'description=it'\''s'"),
            ("", "''"),
        ] {
            assert_eq!(
                in_shell(argument),
                expected,
                "law: {argument} in quotes where it needs them"
            );
        }
    }

    /// Law: what is counted has the number of its count.
    #[test]
    fn names_follow_their_number() {
        for (count, one, expected) in [
            (1, "grain", "1 grain"),
            (0, "grain", "0 grains"),
            (2, "point", "2 points"),
            (1, "body", "1 body"),
            (3, "body", "3 bodies"),
            (2, "mesh", "2 meshes"),
            (8, "vertex", "8 vertices"),
        ] {
            assert_eq!(counted(count, one), expected, "law: {count} of `{one}`");
        }
        let verbs = [0, 1, 2].map(|count| in_number(count, "lies", "lie"));
        assert_eq!(verbs, ["lie", "lies", "lie"], "law: of none as of several");
    }

    #[test]
    fn a_rounded_zero_has_no_sign() {
        for (value, expected) in [
            (-0.0004, "0"),
            (-0.0, "0"),
            (0.0004, "0"),
            (-0.0006, "-0.001"),
            (-10.0, "-10"),
            (-0.5, "-0.5"),
        ] {
            assert_eq!(three_decimals(value), expected, "law: {value} to three decimals");
        }
        assert_eq!(without_zeros("-0"), "0", "law: also where nothing follows the point");
    }

    /// Law: forces between grains of sand have digits; what is small beside the largest component is
    /// not told more exactly than that.
    #[test]
    fn components_have_the_digits_of_the_largest() {
        for (values, expected) in [
            ([0.0, -0.0, 0.0], ["0", "0", "0"]),
            ([1.2e-9, -0.25, -24.0123], ["0", "-0.25", "-24.01"]),
            ([1.234_56e-5, -2e-6, 0.0], ["0.00001235", "-0.000002", "0"]),
            ([123_456.7, -0.4, 12.3], ["123457", "0", "12"]),
            ([f64::NAN, 2.0, f64::INFINITY], ["NaN", "2", "inf"]),
            ([-3e300, 0.0, 1.0], ["-3.000e300", "0", "1"]),
        ] {
            assert_eq!(components(values), expected, "law: {values:?} for people");
        }
    }

    #[test]
    fn small_masses_keep_their_digits() {
        for (mass, expected) in [
            (2343.0, "2343.0"),
            (12.34, "12.3"),
            (0.6, "0.6"),
            (0.0437, "0.0437"),
            (0.000_02, "0.00002"),
            (0.0, "0.0"),
            (-0.04, "0.0"),
            (-3.0, "-3.0"),
        ] {
            assert_eq!(grams(mass), expected, "law: {mass} g to three digits");
        }
    }

    /// Law: where four decimals hold four digits, nothing else is written than ever.
    #[test]
    fn tables_keep_digits_of_small_numbers() {
        for (value, expected) in [
            (2343.0, "2343.0000"),
            (0.35, "0.3500"),
            (-0.35, "-0.3500"),
            (0.034_567_89, "0.03457"),
            (0.000_02, "0.00002000"),
            (1.234_567e-12, "1.235e-12"),
            (0.0, "0.0000"),
        ] {
            assert_eq!(
                decimals_at_least(value, 4),
                expected,
                "law: {value} to four digits at least"
            );
        }
        assert_eq!(decimals_at_least(1.5, 6), "1.500000", "law: as many decimals as asked");
    }
}
