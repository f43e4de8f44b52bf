//! What is found in a run beside what the accuracy standard judges.

use super::*;

impl Summary {
    /// Whether something is found in the run that the accuracy standard does not judge: by a
    /// run-time check, or because a height or a settlement was read while its grains still moved.
    /// The standard is one of the end: what a check of overlap or numerical creep found counts here
    /// unless the end is beyond that limit, too.
    pub fn has_finding_beside_standard(&self) -> bool {
        let overlap = self.overlap.known();
        let at_end = |name: &str| match name {
            "overlap_mean" => Some(overlap?.mean_percent),
            "overlap_p99" => Some(overlap?.p99_percent),
            "creep" => Some(self.creep_um_per_s?.abs()),
            _ => None,
        };
        let is_of_standard = |name: &str, check: &CheckSummary| {
            at_end(name).zip(check.limit).is_some_and(|(value, limit)| value >= limit)
        };
        let mut checks = self.checks.iter().flat_map(Checks::each);
        checks.any(|(name, check)| check.passed == Some(false) && !is_of_standard(name, check))
            || !self.read_while_moving().is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::super::summary::tests::summary;

    /// Law: a miss of the standard at the end is no finding beside it, whatever else misses the
    /// standard; what a check found earlier alone is one, as is any other check, and a run that
    /// misses more has not fewer findings.
    #[test]
    fn findings_beside_the_standard_are_not_hidden_by_its_misses() {
        let of = |energy: bool, found: &[&str], mean_percent: f64, creep: Option<f64>| {
            let mut run = summary(false, Some(energy));
            let checks = run.checks.as_mut().expect("checks");
            for (name, check) in
                [("overlap_mean", &mut checks.overlap_mean), ("creep", &mut checks.creep)]
            {
                check.passed = Some(!found.contains(&name));
            }
            run.overlap.mean_percent = mean_percent;
            run.creep_um_per_s = creep;
            run.has_finding_beside_standard()
        };
        // The limits of these checks are 1.
        for (case, got, expected) in [
            ("nothing", of(true, &[], 0.1, Some(0.1)), false),
            ("overlap at the end", of(true, &["overlap_mean"], 1.5, Some(0.1)), false),
            ("overlap before", of(true, &["overlap_mean"], 0.1, Some(0.1)), true),
            ("that, and creep", of(true, &["overlap_mean", "creep"], 0.1, Some(-9.0)), true),
            ("overlap of none at the end", of(true, &["overlap_mean"], f64::NAN, None), true),
            ("both at the end", of(true, &["overlap_mean", "creep"], 1.5, Some(-9.0)), false),
            ("both, and energy", of(false, &["overlap_mean", "creep"], 1.5, Some(9.0)), true),
        ] {
            assert_eq!(got, expected, "law: {case}: expected {expected}, got {got}");
        }
    }
}
