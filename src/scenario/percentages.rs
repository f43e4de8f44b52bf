//! Mass percentages of a sieve table as people type them: rounded.

use super::*;

/// By how much percentages may miss 100 together, however many digits they have.
const ALWAYS_ALLOWED: f64 = 0.01;

/// Rounding of a sum of decimals, in percent.
const ROUNDING_OF_SUM: f64 = 1e-9;

impl SieveFraction {
    /// Whether any mass stays between its sieves.
    pub(crate) fn has_grains(&self) -> bool {
        self.mass_percent > 0.0
    }

    /// Sum of the mass percentages of a table.
    pub(crate) fn percent_sum(table: &[Self]) -> f64 {
        table.iter().map(|row| row.mass_percent).sum()
    }

    /// The last digit to which a table is typed, in percent: that of the row with most digits, as a
    /// sheet has the same for all of them; 0.1 where all are whole.
    pub(crate) fn last_digit(table: &[Self]) -> f64 {
        let decimals = table.iter().map(|row| decimals(row.mass_percent)).max();
        10_f64.powi(-decimals.unwrap_or(0).max(1))
    }

    /// By how much, in percent, the percentages of a table may miss 100 together: half of the last
    /// digit for each row, which is what rounding takes or adds at most, and 0.01 in any case.
    pub(crate) fn percent_tolerance(table: &[Self]) -> f64 {
        (table.len() as f64 * Self::last_digit(table) / 2.0).max(ALWAYS_ALLOWED)
    }

    /// Whether the percentages of a table add up to 100 but for the rounding of their digits.
    pub(crate) fn add_up(table: &[Self]) -> bool {
        let missed = (Self::percent_sum(table) - 100.0).abs();
        missed <= Self::percent_tolerance(table) + ROUNDING_OF_SUM
    }

    /// By what percentages that add up are multiplied to give 100 exactly; 1 for others, which are a
    /// fault.
    pub(super) fn factor_to_hundred(table: &[Self]) -> f64 {
        if Self::add_up(table) { 100.0 / Self::percent_sum(table) } else { 1.0 }
    }
}

/// Digits behind the point of a number in its shortest decimal notation.
fn decimals(number: f64) -> i32 {
    let text = number.to_string();
    let digits = text.split_once('.').map_or(0, |(_, digits)| digits.len());
    i32::try_from(digits).unwrap_or(i32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(percentages: &[f64]) -> Vec<SieveFraction> {
        let mut passing_mm = 64.0;
        let mut table = Vec::new();
        for &mass_percent in percentages {
            let retained_mm = passing_mm / 1.25;
            table.push(SieveFraction { passing_mm, retained_mm, mass_percent });
            passing_mm = retained_mm;
        }
        table
    }

    /// Law: a sheet rounded to one decimal adds up; one that misses 100 by more than rounding can
    /// does not, and neither do whole percentages that miss it by one.
    #[test]
    fn percentages_add_up_within_the_rounding_of_their_digits() {
        let cases: [(&[f64], bool); 13] = [
            (&[33.3, 33.3, 33.3], true),
            (&[60.0, 39.9], true),
            (&[12.5, 30.1, 57.3], true),
            (&[12.5, 30.1, 57.2], false),
            (&[60.0, 39.8], false),
            (&[33.33, 33.33, 33.33], true),
            (&[33.33, 33.33, 33.3], false),
            (&[50.0, 49.0], false),
            (&[99.9], false),
            (&[99.99], true),
            (&[33.333, 33.333, 33.325], true),
            (&[15.0, 51.95, 33.05], true),
            (&[f64::NAN, 50.0], false),
        ];
        for (percentages, adds_up) in cases {
            let got = SieveFraction::add_up(&table(percentages));
            assert_eq!(got, adds_up, "law: whether {percentages:?} add up to 100");
        }
    }

    /// Law: percentages that add up but for rounding are taken as shares of 100; those that give 100
    /// keep their bits.
    #[test]
    fn percentages_are_scaled_to_hundred() {
        let thirds = table(&[33.3, 33.3, 33.3]);
        let share = thirds[0].mass_percent * SieveFraction::factor_to_hundred(&thirds);
        assert!((share - 100.0 / 3.0).abs() < 1e-12, "law: a third each, got {share} %");
        let exact = SieveFraction::factor_to_hundred(&table(&[15.0, 51.95, 33.05]));
        assert_eq!(exact.to_bits(), 1.0_f64.to_bits(), "law: nothing is scaled");
        let half = SieveFraction::factor_to_hundred(&table(&[50.0]));
        assert_eq!(half, 1.0, "law: a table at fault is left as it is");
        let of = |percentages: &[f64]| {
            let spec = json!({ "total_mass_g": 1000, "density_kg_per_m3": 2650,
                "sieve_table": table(percentages) });
            Grading::of_json(&spec).expect("a grading").count
        };
        let (rounded, exact) = (of(&[50.0, 49.9]), of(&[5000.0 / 99.9, 4990.0 / 99.9]));
        assert!((rounded / exact - 1.0).abs() < 1e-12, "law: {exact} grains, got {rounded}");
    }
}
