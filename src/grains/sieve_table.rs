//! The table `sieve.csv`.

use std::io::Write;

use super::{GrainSet, GrainsError, analysis::SieveAnalysis, psd::ParticleSizeDistribution};
use crate::units::{to_cm3, to_g, to_mm};

/// Writes `sieve.csv`: a row a fraction, with what the sieve table asks for,
/// what the generated grains weigh, and how much of them the virtual sieve
/// finds in the fraction.
///
/// # Errors
/// When writing fails, or the grains have not as many blocks as the
/// distribution has fractions.
pub fn sieve_csv(
    psd: &ParticleSizeDistribution,
    grains: &GrainSet,
    into: impl Write,
) -> Result<(), GrainsError> {
    sieve_table(psd, grains, &SieveAnalysis::of(grains), into)
}

/// [`sieve_csv`] of grains that were sieved already.
///
/// # Errors
/// As [`sieve_csv`].
pub fn sieve_table(
    psd: &ParticleSizeDistribution,
    grains: &GrainSet,
    sieved: &SieveAnalysis,
    into: impl Write,
) -> Result<(), GrainsError> {
    let (fractions, blocks) = (psd.fractions.len(), grains.blocks.len());
    if fractions != blocks {
        return Err(GrainsError::BadBlock {
            block: fractions.min(blocks),
            reason: format!("there are {blocks} blocks for {fractions} sieve fractions"),
        });
    }
    let total = grains.total_mass();
    let mut csv = csv::Writer::from_writer(into);
    csv.write_record([
        "passing_mm",
        "retained_mm",
        "mass_percent",
        "mass_g",
        "solids_volume_cm3",
        "mean_size_mm",
        "grains",
        "generated_mass_g",
        "cube_side_mm",
        "sieved_grains",
        "sieved_mass_g",
        "sieved_mass_percent",
        "sieved_passing_percent",
        "sieved_finer_percent",
    ])?;
    for (index, (fraction, block)) in psd.fractions.iter().zip(&grains.blocks).enumerate() {
        let own = || grains.grains.iter().filter(|g| g.fraction == index);
        let generated: f64 = own().map(|g| g.mass).sum();
        let (count, mass) = sieved.between(fraction.passing, fraction.retained);
        csv.write_record([
            to_mm(fraction.passing).to_string(),
            to_mm(fraction.retained).to_string(),
            format!("{:.4}", fraction.mass_percent),
            format!("{:.4}", to_g(fraction.mass)),
            format!("{:.4}", to_cm3(fraction.volume)),
            to_mm(fraction.mean_size).to_string(),
            own().count().to_string(),
            format!("{:.4}", to_g(generated)),
            format!("{:.4}", to_mm(block.side)),
            count.to_string(),
            format!("{:.4}", to_g(mass)),
            format!("{:.4}", 100.0 * mass / total),
            format!("{:.4}", sieved.percent_finer(fraction.passing)),
            format!("{:.4}", sieved.percent_finer(fraction.retained)),
        ])?;
    }
    csv.flush()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grains::{generate, tests::few_grains};

    #[test]
    fn the_table_has_units_and_the_generated_mass() {
        let spec = few_grains();
        let psd = ParticleSizeDistribution::new(&spec).unwrap();
        let grains = generate(&spec, 1).unwrap();
        let mut bytes = Vec::new();
        sieve_csv(&psd, &grains, &mut bytes).unwrap();
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
            assert!(
                (got - expected).abs() < 2e-4,
                "share found in a fraction = passing less finer: expected {expected} %, got {got} %"
            );
        }
        let (found, finest) = (sum(11), rows.last().unwrap()[13].parse::<f64>().unwrap());
        let coarsest: f64 = 100.0 - rows[0][12].parse::<f64>().unwrap();
        let all = found + finest + coarsest;
        assert!((all - 100.0).abs() < 1e-3, "fractions, finer and coarser: 100 %, got {all} %");
        let mut one_less = grains.clone();
        one_less.blocks.pop();
        assert!(sieve_csv(&psd, &one_less, Vec::new()).is_err(), "a block is missing");
    }
}
