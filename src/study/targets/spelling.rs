//! Fields of several tables under one name, however their paths are spelt.

use super::*;

/// The first spelling of each field.
#[derive(Default)]
pub(super) struct Spellings(Vec<(String, Option<Override>)>);

impl Spellings {
    /// The spelling under which a field is known: this one where it is the first. What is no path is
    /// known as it is.
    pub fn known(&mut self, name: &str) -> String {
        let place: Option<Override> = format!("{name}=0").parse().ok();
        let same = |(known, at): &&(String, Option<Override>)| {
            known == name || at.as_ref().zip(place.as_ref()).is_some_and(|(a, b)| a.is_where(b))
        };
        if let Some((known, _)) = self.0.iter().find(same) {
            return known.clone();
        }
        self.0.push((name.to_owned(), place));
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_has_its_first_spelling() {
        let mut spellings = Spellings::default();
        for (name, expected) in [
            ("stages.1.x", "stages.1.x"),
            ("stages[1].x", "stages.1.x"),
            ("stages[2].x", "stages[2].x"),
            ("stages.2.x", "stages[2].x"),
            ("not a path [", "not a path ["),
            ("not a path [", "not a path ["),
        ] {
            assert_eq!(spellings.known(name), expected, "law: how `{name}` is known");
        }
    }
}
