//! The table `sieve.csv`.

use super::*;
use crate::plain::decimals_at_least;
use crate::units::{to_g, to_typed_mm};

/// Writes `sieve.csv`: a row a fraction, with what the sieve table asks for, what the generated
/// grains weigh, and how much of them the virtual sieve finds in the fraction.
///
/// # Errors
/// When writing fails, or the grains have not as many blocks as the distribution has fractions.
pub fn sieve_csv(
    psd: &ParticleSizeDistribution,
    grains: &GrainSet,
) -> Result<Vec<u8>, GrainsError> {
    let (fractions, blocks) = (psd.fractions.len(), grains.blocks.len());
    if fractions != blocks {
        return Err(GrainsError::BadBlock {
            block: fractions.min(blocks),
            reason: format!("there are {blocks} blocks for {fractions} sieve fractions"),
        });
    }
    let (sieved, total) = (SieveAnalysis::of(grains), grains.total_mass());
    let four = |number: f64| decimals_at_least(number, 4);
    // Of all grains, however small they are.
    let percent = |number: f64| format!("{number:.4}");
    let nine_digits = |number: f64| format!("{number:.8e}").parse().unwrap_or(number);
    let row = |(index, (fraction, block)): (usize, (&Fraction, &Block))| {
        let own = || grains.grains.iter().filter(|g| g.fraction == index);
        let generated = own().fold(0.0, |mass, g| mass + g.mass);
        let passing_mm = to_typed_mm(fraction.passing);
        let retained_mm = to_typed_mm(fraction.retained);
        let (count, mass) = sieved.between(fraction.passing, fraction.retained);
        vec![
            ("passing_mm", passing_mm.to_string()),
            ("retained_mm", retained_mm.to_string()),
            ("mass_percent", percent(fraction.mass_percent)),
            ("mass_g", four(to_g(fraction.mass))),
            ("solids_volume_cm3", four(to_cm3(fraction.volume))),
            ("mean_size_mm", nine_digits(f64::midpoint(passing_mm, retained_mm)).to_string()),
            ("grains", own().count().to_string()),
            ("generated_mass_g", four(to_g(generated))),
            ("cube_side_mm", four(to_mm(block.side))),
            ("sieved_grains", count.to_string()),
            ("sieved_mass_g", four(to_g(mass))),
            ("sieved_mass_percent", percent(100.0 * mass / total)),
            ("sieved_passing_percent", percent(sieved.percent_finer(fraction.passing))),
            ("sieved_finer_percent", percent(sieved.percent_finer(fraction.retained))),
        ]
    };
    Ok(table_csv(psd.fractions.iter().zip(&grains.blocks).enumerate().map(row))?)
}

/// A table in memory, of rows of names and cells; the names are those of the first row.
///
/// # Errors
/// The writer's; writing to memory does not fail.
pub fn table_csv<N: AsRef<[u8]>>(
    rows: impl Iterator<Item = Vec<(N, String)>>,
) -> Result<Vec<u8>, csv::Error> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    for (n, row) in rows.enumerate() {
        if n == 0 {
            csv.write_record(row.iter().map(|(name, _)| name))?;
        }
        csv.write_record(row.iter().map(|(_, cell)| cell))?;
    }
    csv.into_inner().map_err(|e| e.into_error().into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grains::generate;
    use crate::grains::tests::{few_grains, near, table};

    #[test]
    fn the_table_has_units_and_the_generated_mass() {
        let spec = few_grains();
        let psd = ParticleSizeDistribution::new(&spec).unwrap();
        let grains = generate(&spec, 1).unwrap();
        let bytes = sieve_csv(&psd, &grains).unwrap();
        let mut csv = csv::Reader::from_reader(&bytes[..]);
        let header = csv.headers().unwrap().iter().collect::<Vec<_>>().join(",");
        assert_eq!(
            header,
            "passing_mm,retained_mm,mass_percent,mass_g,solids_volume_cm3,mean_size_mm,grains,\
             generated_mass_g,cube_side_mm,sieved_grains,sieved_mass_g,sieved_mass_percent,\
             sieved_passing_percent,sieved_finer_percent"
        );
        let rows: Vec<_> = csv.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), spec.sieve_table.len(), "a row a fraction");
        let sum =
            |column: usize| -> f64 { rows.iter().map(|r| r[column].parse::<f64>().unwrap()).sum() };
        for (name, column, expected) in
            [("mass", 3, spec.total_mass_g), ("generated mass", 7, spec.total_mass_g)]
        {
            let got = sum(column);
            assert!((got - expected).abs() < 1e-3, "{name}: expected {expected} g, got {got} g");
        }
        assert_eq!(sum(6) as usize, grains.grains.len(), "number of grains");
        for row in &rows {
            let number = |column: usize| row[column].parse::<f64>().unwrap();
            let (got, expected) = (number(11), number(12) - number(13));
            near("share found in a fraction = passing less finer", got, expected, 2e-4);
        }
        let (found, finest) = (sum(11), rows.last().unwrap()[13].parse::<f64>().unwrap());
        let coarsest: f64 = 100.0 - rows[0][12].parse::<f64>().unwrap();
        let all = found + finest + coarsest;
        assert!((all - 100.0).abs() < 1e-3, "fractions, finer and coarser: 100 %, got {all} %");
        let mut one_less = grains.clone();
        one_less.blocks.pop();
        assert!(sieve_csv(&psd, &one_less).is_err(), "a block is missing");
    }

    /// Law: openings stand in the table as they were typed.
    #[test]
    fn openings_are_shown_as_they_were_typed() {
        let rows = [(2.0, 1.18, 45.0), (1.18, 0.85, 35.0), (0.85, 0.6, 20.0)];
        let spec = SievedGrains { total_mass_g: 0.1, ..table(&rows) };
        let set = generate(&spec, 1).expect("grains");
        let psd = set.specified().expect("a distribution");
        let bytes = sieve_csv(&psd, &set).expect("a table");
        let mut csv = csv::Reader::from_reader(&bytes[..]);
        let got: Vec<String> = csv
            .records()
            .map(|row| row.expect("a row"))
            .map(|row| format!("{} {} {}", &row[0], &row[1], &row[5]))
            .collect();
        assert_eq!(got, ["2 1.18 1.59", "1.18 0.85 1.015", "0.85 0.6 0.725"], "law: as typed");
    }

    /// Law: a hundredth in size is a millionth in mass and volume, to the same digits.
    #[test]
    fn small_samples_keep_their_mass_and_volume() {
        let table = |scale: f64| -> Vec<Vec<f64>> {
            let mut spec = few_grains();
            spec.total_mass_g *= scale.powi(3);
            for fraction in &mut spec.sieve_table {
                fraction.passing_mm *= scale;
                fraction.retained_mm *= scale;
            }
            let psd = ParticleSizeDistribution::new(&spec).unwrap();
            let bytes = sieve_csv(&psd, &generate(&spec, 1).unwrap()).unwrap();
            let mut csv = csv::Reader::from_reader(&bytes[..]);
            let numbers = |row: csv::StringRecord| -> Vec<f64> {
                row.iter().map(|cell| cell.parse().unwrap()).collect()
            };
            csv.records().map(|row| numbers(row.unwrap())).collect()
        };
        for (small, large) in table(1e-2).iter().zip(table(1.0)) {
            // Mass, volume of solids, mass of the generated grains; the side of the cube.
            for (column, scale) in [(3, 1e-6), (4, 1e-6), (7, 1e-6), (8, 1e-2)] {
                let (expected, got) = (large[column], small[column] / scale);
                near(&format!("column {column} keeps its digits"), got, expected, 1e-3 * expected);
            }
        }
    }
}
