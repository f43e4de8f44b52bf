//! How a measured mean with its interval is judged against what is published.

use serde::{Deserialize, Serialize};

/// What a comparison came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The whole interval lies in the published range.
    Within,
    /// The whole interval lies beside the published range: a miss.
    Outside,
    /// The interval reaches over an end of the range, or there is none.
    Undecided,
    /// The published number was not seen in a source.
    NotJudged,
    /// Nothing was measured, whether it would be judged or not.
    NotRun,
}

/// As the page of results calls it.
impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Within => "within",
            Self::Outside => "missed",
            Self::Undecided => "undecided",
            Self::NotJudged => "not judged",
            Self::NotRun => "not run",
        })
    }
}

/// Judges a mean with its 95 % confidence interval against a published range, its ends included.
pub fn judge(published: (f64, f64), ours: Option<f64>, interval: Option<(f64, f64)>) -> Verdict {
    let Some(_) = ours.filter(|v| v.is_finite()) else { return Verdict::NotRun };
    let Some((low, high)) = interval else { return Verdict::Undecided };
    if published.0 <= low && high <= published.1 {
        Verdict::Within
    } else if high < published.0 || published.1 < low {
        Verdict::Outside
    } else {
        Verdict::Undecided
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_is_judged_as_a_whole() {
        for (interval, expected) in [
            ((2.45, 2.55), Verdict::Within),
            ((2.4, 2.6), Verdict::Within),
            ((2.39, 2.55), Verdict::Undecided),
            ((2.45, 2.7), Verdict::Undecided),
            ((1.0, 9.0), Verdict::Undecided),
            ((2.61, 2.8), Verdict::Outside),
            ((2.0, 2.39), Verdict::Outside),
        ] {
            let mean = (interval.0 + interval.1) / 2.0;
            let got = judge((2.4, 2.6), Some(mean), Some(interval));
            assert_eq!(got, expected, "law: {interval:?} against 2.4 to 2.6");
        }
        let one = judge((2.4, 2.6), Some(2.5), None);
        assert_eq!(one, Verdict::Undecided, "law: a single realisation decides nothing");
        assert_eq!(judge((2.4, 2.6), None, None), Verdict::NotRun, "law: nothing measured");
    }

    #[test]
    fn verdicts_are_called_as_on_the_page() {
        let missed = judge((2.4, 2.6), Some(2.0), Some((1.9, 2.1)));
        assert_eq!(missed.to_string(), "missed", "law: outside is a miss");
        assert_eq!(Verdict::NotJudged.to_string(), "not judged", "law: words, no name of code");
    }
}
