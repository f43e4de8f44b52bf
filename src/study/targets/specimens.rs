//! Which runs are of one specimen: those that begin with the same pour, or the same stored specimen,
//! and differ after it.

use super::*;
use crate::report::SPECIMEN;

/// Results of a pour. The program repeats a pour to the last bit, and no other one gives the same
/// two numbers.
const OF_THE_POUR: [&str; 2] = ["poured_height_mm.mean_surface", "poured_void_ratio"];

/// Numbers the specimens of rows. Runs of one configuration with the same results of their pour are
/// of one, and so are runs whose column of specimens names the same; any other run without a pour is
/// a specimen of its own.
pub(super) fn number(rows: &mut [Row]) {
    let mut known: BTreeMap<(String, [Option<u64>; 2]), usize> = BTreeMap::new();
    let mut next = 0;
    for row in rows {
        let poured = OF_THE_POUR.map(|name| row.results.get(name).copied().map(f64::to_bits));
        let begun = row.columns.get(SPECIMEN).filter(|name| !name.is_empty());
        row.specimen = match (poured, begun) {
            ([None, None], None) => next,
            ([None, None], Some(begun)) => *known.entry((begun.clone(), poured)).or_insert(next),
            _ => *known.entry((row.configuration.clone(), poured)).or_insert(next),
        };
        next = next.max(row.specimen + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(configuration: &str, poured: [Option<f64>; 2]) -> Row {
        let results = OF_THE_POUR
            .iter()
            .zip(poured)
            .filter_map(|(name, x)| x.map(|x| ((*name).to_owned(), x)));
        Row {
            configuration: configuration.to_owned(),
            columns: BTreeMap::new(),
            factors: Vec::new(),
            results: results.collect(),
            specimen: 0,
        }
    }

    /// Law: a pour that is repeated to the last bit is one specimen, all else are several.
    #[test]
    fn runs_of_one_pour_are_of_one_specimen() {
        let next = f64::from_bits(150.0_f64.to_bits() + 1);
        let mut rows = [
            row("1", [Some(150.0), Some(0.8)]),
            row("1", [Some(next), Some(0.8)]),
            row("1", [Some(150.0), Some(0.8)]),
            row("2", [Some(150.0), Some(0.8)]),
            row("1", [None, None]),
            row("1", [None, None]),
            row("1", [Some(150.0), None]),
            row("1", [Some(150.0), None]),
        ];
        number(&mut rows);
        let got: Vec<usize> = rows.iter().map(|row| row.specimen).collect();
        assert_eq!(got, [0, 1, 0, 2, 3, 4, 5, 5]);
    }

    /// Law: runs that begin with one stored specimen are of one, whatever their configuration; where
    /// none is named, each is of its own.
    #[test]
    fn runs_that_begin_with_one_specimen_are_of_it() {
        let begun = |configuration: &str, name: &str| Row {
            columns: BTreeMap::from([(SPECIMEN.to_owned(), name.to_owned())]),
            ..row(configuration, [None, None])
        };
        let mut rows =
            [begun("1", "a"), begun("2", "b"), begun("1", "a"), begun("2", "a"), begun("1", "")];
        number(&mut rows);
        let got: Vec<usize> = rows.iter().map(|row| row.specimen).collect();
        assert_eq!(got, [0, 1, 0, 0, 2], "law: a, b, a, a and one that is not named (got left)");
    }
}
