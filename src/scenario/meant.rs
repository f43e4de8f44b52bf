//! Which stage of a run is meant by a number or a name.

use super::*;

/// What a number or a name means among the stages of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MeantStage {
    /// The stage of this number.
    One(usize),
    /// Several stages of that name, by their numbers: which of them is not said.
    Several(Vec<usize>),
    /// No stage.
    None,
}

impl MeantStage {
    /// What a text means among the stages of these names: a number from 0, or else a name.
    pub fn of<'a>(asked: &str, names: impl IntoIterator<Item = &'a str>) -> Self {
        let names: Vec<&str> = names.into_iter().collect();
        if let Some(number) = asked.parse().ok().filter(|n: &usize| *n < names.len()) {
            return Self::One(number);
        }
        let of_name: Vec<usize> = (0..names.len()).filter(|n| names[*n] == asked).collect();
        match of_name.len() {
            0 => Self::None,
            1 => Self::One(of_name[0]),
            _ => Self::Several(of_name),
        }
    }

    /// The number of the one stage of these names that is meant; `also` is what else the run has.
    ///
    /// # Errors
    /// In words, where no stage is meant, or several, with what there is.
    pub fn one<'a>(
        asked: &str,
        names: impl IntoIterator<Item = &'a str>,
        also: Option<&str>,
    ) -> Result<usize, String> {
        let names: Vec<&str> = names.into_iter().collect();
        match Self::of(asked, names.iter().copied()) {
            Self::One(number) => Ok(number),
            Self::Several(numbers) => Err(format!(
                "several stages are named `{asked}`; give the number of one: {}",
                Self::choice(&numbers)
            )),
            Self::None => {
                let known = names.iter().enumerate().map(|(n, name)| format!("{n} {name}"));
                let known: Vec<String> = known.chain(also.map(str::to_owned)).collect();
                let stages = known.join(", ");
                let now = Self::now_called(asked, &stages);
                Err(format!("no stage `{asked}`{now}; the run has {stages}"))
            }
        }
    }

    /// What follows a name that no stage has in a message that lists those that are `there`, as in
    /// `0 pour, rest_test`: ` (now called ...)` where it is the old name of one of them, else
    /// nothing.
    pub fn now_called(asked: &str, there: &str) -> String {
        let is_there = |now: &&str| there.split([',', ' ']).any(|word| word == *now);
        let now = renamed::stage(asked).filter(is_there);
        now.map_or(String::new(), |now| format!(" (now called `{now}`)"))
    }

    /// Numbers of stages as a choice: `1, 3 or 5`.
    pub fn choice(numbers: &[usize]) -> String {
        let texts: Vec<String> = numbers.iter().map(usize::to_string).collect();
        match texts.split_last() {
            Some((last, others)) if !others.is_empty() => {
                format!("{} or {last}", others.join(", "))
            }
            _ => texts.concat(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: a number is itself, a name the one stage that has it; several stages of a name are
    /// reported, and none of them is taken.
    #[test]
    fn a_name_means_one_stage_alone() {
        let names = ["deposit", "press", "rest", "press", "press"];
        for (asked, expected) in [
            ("0", MeantStage::One(0)),
            ("4", MeantStage::One(4)),
            ("rest", MeantStage::One(2)),
            ("press", MeantStage::Several(vec![1, 3, 4])),
            ("5", MeantStage::None),
            ("pres", MeantStage::None),
            ("", MeantStage::None),
        ] {
            assert_eq!(MeantStage::of(asked, names), expected, "law: what `{asked}` means");
        }
        let there = "0 deposit, 1 press, rest_test";
        let control = MeantStage::now_called("control", there);
        assert_eq!(control, " (now called `rest_test`)", "law: an old name gives the new one");
        assert_eq!(MeantStage::now_called("press", there), "", "law: no other does");
        let without = MeantStage::now_called("control", "0 deposit, 1 press");
        assert_eq!(without, "", "law: a run without a rest test has nothing of that name");
        assert_eq!(MeantStage::choice(&[1, 3, 4]), "1, 3 or 4", "law: each is listed");
        assert_eq!(MeantStage::choice(&[1, 3]), "1 or 3", "law: each is listed");
    }
}
