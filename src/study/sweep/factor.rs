//! What a sweep varies: values of a field one by one, or a range to draw from.

use super::*;

/// A field of the scenario and the values that it takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// The field, as after `--set`.
    pub path: String,
    /// Its values as they were typed, each with the change it makes.
    pub values: Vec<(Value, Override)>,
    /// As it was typed.
    pub text: String,
}

/// A field of the scenario and the range from which its values are drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledRange {
    /// The field, as after `--set`.
    pub path: String,
    /// Least value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// As it was typed.
    pub text: String,
}

impl Factor {
    /// The value of a field, with the change that it makes; the option by which it is given.
    pub(super) fn value(
        path: &str,
        text: &str,
        option: &'static str,
    ) -> Result<(Value, Override), String> {
        let change: Override =
            format!("{path}={text}").parse().map_err(|e| format!("`{path}={text}`: {e}"))?;
        let value = serde_json::from_str(text).unwrap_or_else(|_| Value::from(text));
        Ok((value, change.typed_with(option)))
    }
}

impl FromStr for Factor {
    type Err = String;

    /// Reads `path=value,value,...`; commas within brackets, braces and quotes do not divide.
    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || format!("`{text}` is not path=value,value as in engine.rate_hz=480,960");
        let (path, list) = text.split_once('=').ok_or_else(bad)?;
        let path = path.trim();
        let mut values: Vec<(Value, Override)> = Vec::new();
        for value in divided(list) {
            if value.is_empty() {
                return Err(bad());
            }
            let value = Self::value(path, value, "--over")?;
            if values.iter().any(|(known, _)| same(known, &value.0)) {
                return Err(format!("`{text}` has the value {} twice", value.0));
            }
            values.push(value);
        }
        Ok(Self { path: path.to_owned(), values, text: text.to_owned() })
    }
}

/// Whether two values are the same to an engine: 480 and 480.0 are.
pub(super) fn same(a: &Value, b: &Value) -> bool {
    a == b || a.as_f64().is_some_and(|a| Some(a) == b.as_f64())
}

/// The parts between the commas that divide.
fn divided(list: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut from, mut depth, mut quoted) = (0, 0_i32, false);
    let mut before = ' ';
    for (at, c) in list.char_indices() {
        match c {
            '"' if before != '\\' => quoted = !quoted,
            '[' | '{' if !quoted => depth += 1,
            ']' | '}' if !quoted => depth -= 1,
            ',' if !quoted && depth == 0 => {
                parts.push(list[from..at].trim());
                from = at + 1;
            }
            _ => {}
        }
        before = c;
    }
    parts.push(list[from..].trim());
    parts
}

impl FromStr for SampledRange {
    type Err = String;

    /// Reads `path=low..high`.
    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || {
            format!("`{text}` is not path=low..high as in contact.grain_grain_friction=0.3..0.9")
        };
        let (path, ends) = text.split_once('=').ok_or_else(bad)?;
        let (low, high) = range(ends).ok_or_else(bad)?;
        if low >= high {
            return Err(format!("`{text}`: {low} is not below {high}"));
        }
        Ok(Self { path: path.trim().to_owned(), low, high, text: text.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn values_are_divided_by_commas_outside_of_brackets() {
        let of = |text: &str| -> Result<Vec<Value>, String> {
            Ok(text.parse::<Factor>()?.values.into_iter().map(|(v, _)| v).collect())
        };
        assert_eq!(of("engine.rate_hz=480, 960"), Ok(vec![json!(480), json!(960)]));
        assert_eq!(of("engine.backend=bullet,rapier"), Ok(vec![json!("bullet"), json!("rapier")]));
        assert_eq!(of("a=[1,2],[3,4]"), Ok(vec![json!([1, 2]), json!([3, 4])]));
        assert_eq!(of("a=\"b,c\",d"), Ok(vec![json!("b,c"), json!("d")]));
        for wrong in
            ["engine.rate_hz", "engine.rate_hz=", "a=1,,2", "a=1,2,1", "=1", r#"a={"b":1,"b":2}"#]
        {
            assert!(of(wrong).is_err(), "law: `{wrong}` is refused");
        }
    }

    /// Law: a number typed in two ways is one value, of which there would be two equal points.
    #[test]
    fn a_number_typed_in_two_ways_is_one_value() {
        for wrong in ["a=10,10.0", "a=10,0.4,1e1", "a=0.1,1e-1", "a=0,-0.0"] {
            let refused = wrong.parse::<Factor>().expect_err("law: refused");
            assert!(refused.contains("twice"), "law: `{wrong}`, got `{refused}`");
        }
        let words = "a=\"10\",10".parse::<Factor>().expect("law: a word is no number");
        assert_eq!(words.values.len(), 2);
    }

    #[test]
    fn ranges_have_two_ends() {
        let range: SampledRange = "seed=0.3..0.9".parse().expect("a range");
        assert_eq!((range.low, range.high), (0.3, 0.9));
        for wrong in ["seed", "seed=1", "seed=2..1", "seed=1..1", "seed=a..b", "seed=1..inf"] {
            assert!(wrong.parse::<SampledRange>().is_err(), "law: `{wrong}` is refused");
        }
    }
}
