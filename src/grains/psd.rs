//! The particle size distribution of a sieve analysis and what follows from it.

use super::gradation::SAME_PERCENT;
use super::*;
use crate::scenario::SieveFraction;
use crate::units::from_g;

/// Largest number of grains the program makes.
pub const MOST_GRAINS: usize = 1_000_000;

/// A validated sieve table with the number of grains of each fraction.
#[derive(Debug, Clone, PartialEq)]
pub struct ParticleSizeDistribution {
    /// Fractions, coarsest first.
    pub fractions: Vec<Fraction>,
    /// Density of the solids in kg/m³.
    pub density: f64,
}

/// What passes one sieve and stays on the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fraction {
    /// Opening of the sieve the fraction passes, in m.
    pub passing: f64,
    /// Opening of the sieve that retains the fraction, in m.
    pub retained: f64,
    /// Share of the total mass, in percent; the shares add up to 100.
    pub mass_percent: f64,
    /// Mass in kg.
    pub mass: f64,
    /// Solid volume in m³.
    pub volume: f64,
    /// Number of grains.
    pub grains: usize,
}

impl ParticleSizeDistribution {
    /// Validates a sieve table and counts the grains of each fraction.
    ///
    /// Paper, section 3: the mass on each sieve and the density give the fraction's solid volume V;
    /// "the average size of polyhedrons ... was set by the average mesh openings of the two
    /// successive sieves". The size d is read as the diameter of the sphere of the grain's mean
    /// volume, so that n = V / (π/6·d³): with sieves of 8, 10, 12.5 and 16 mm this can give the
    /// paper's 1456 grains, d as the edge of a cube cannot.
    ///
    /// These n are made whole by largest remainders, so that the total is Σn rounded: each n is
    /// rounded down, and the fractions with the largest remainders get one grain more until the
    /// total is reached. (Rounding each n alone lets the errors of several fractions add up; for
    /// the paper's table it gives 1457 where Σn is 1456.05.)
    ///
    /// Percentages that miss 100 by the rounding of their digits are scaled to 100 exactly. A
    /// fraction of 0 % has no grains.
    ///
    /// # Errors
    /// Values that are not positive, negative percentages, rows out of order, percentages that do not add up to 100,
    /// fractions of less than half a grain, and more than [`MOST_GRAINS`] grains.
    pub fn new(spec: &SievedGrains) -> Result<Self, GrainsError> {
        positive("total_mass_g", spec.total_mass_g)?;
        positive("density_kg_per_m3", spec.density_kg_per_m3)?;
        check_table(&spec.sieve_table)?;
        let sum = SieveFraction::percent_sum(&spec.sieve_table);
        let mut fractions = Vec::with_capacity(spec.sieve_table.len());
        let mut quotas = Vec::with_capacity(spec.sieve_table.len());
        for row in &spec.sieve_table {
            let mass = from_g(spec.total_mass_g) * row.mass_percent / sum;
            let volume = mass / spec.density_kg_per_m3;
            let mean_size = from_mm((row.passing_mm + row.retained_mm) / 2.0);
            let quota = volume / (std::f64::consts::FRAC_PI_6 * mean_size.powi(3));
            if row.has_grains() && quota < 0.5 {
                return Err(GrainsError::EmptyFraction {
                    passing_mm: row.passing_mm,
                    retained_mm: row.retained_mm,
                    volume_cm3: to_cm3(volume),
                });
            }
            quotas.push(quota);
            fractions.push(Fraction {
                passing: from_mm(row.passing_mm),
                retained: from_mm(row.retained_mm),
                mass_percent: row.mass_percent * 100.0 / sum,
                mass,
                volume,
                grains: 0,
            });
        }
        let grains: f64 = quotas.iter().sum();
        // A division by the cube of a tiny size may give infinity or NaN.
        if !grains.is_finite() || grains > MOST_GRAINS as f64 {
            return Err(GrainsError::TooManyGrains { grains, limit: MOST_GRAINS });
        }
        for (fraction, count) in fractions.iter_mut().zip(whole_numbers(&quotas)) {
            fraction.grains = count;
        }
        Ok(Self { fractions, density: spec.density_kg_per_m3 })
    }

    /// The distribution that grains have by the sieves of their blocks.
    ///
    /// # Errors
    /// No grains, or blocks that do not run from the coarsest sieve to the finest without gaps.
    pub fn of(grains: &GrainSet) -> Result<Self, GrainsError> {
        let total_mass = grains.total_mass();
        if grains.grains.is_empty() {
            return Err(GrainsError::NoGrains);
        }
        let mut fractions = Vec::with_capacity(grains.blocks.len());
        let mut table = Vec::with_capacity(grains.blocks.len());
        for (index, block) in grains.blocks.iter().enumerate() {
            let own = || grains.grains.iter().filter(|g| g.fraction == index);
            // Not `sum`: that of no numbers is minus zero.
            let mass = own().fold(0.0, |mass, g| mass + g.mass);
            let fraction = Fraction {
                passing: block.passing,
                retained: block.retained,
                mass_percent: mass / total_mass * 100.0,
                mass,
                volume: own().fold(0.0, |volume, g| volume + g.volume),
                grains: own().count(),
            };
            table.push(SieveFraction {
                passing_mm: to_mm(fraction.passing),
                retained_mm: to_mm(fraction.retained),
                mass_percent: fraction.mass_percent,
            });
            fractions.push(fraction);
        }
        check_table(&table)?;
        Ok(Self { fractions, density: grains.density })
    }

    /// Number of grains of all fractions.
    pub fn grains(&self) -> usize {
        self.fractions.iter().map(|f| f.grains).sum()
    }

    /// Opening in m of the finest sieve that retains grains; infinite without grains.
    pub(super) fn finest_with_grains(&self) -> f64 {
        let with_grains = self.fractions.iter().filter(|f| f.grains > 0);
        with_grains.map(|f| f.retained).fold(f64::INFINITY, f64::min)
    }

    /// The curve of the grain size distribution (paper, Figure 1) as points
    /// (sieve opening in mm, percent of mass finer), finest sieve first.
    pub fn passing_curve(&self) -> Vec<(f64, f64)> {
        let mut finer = 0.0;
        let mut curve: Vec<(f64, f64)> = Vec::with_capacity(self.fractions.len() + 1);
        for fraction in self.fractions.iter().rev() {
            curve.push((to_mm(fraction.retained), finer));
            finer += fraction.mass_percent;
        }
        // The shares add up to 100 but for rounding.
        curve.push((to_mm(self.fractions[0].passing), 100.0));
        curve
    }

    /// Percent of mass finer than a size in m: linear in the logarithm of the
    /// size between two sieves; 0 and 100 outside the table.
    pub fn percent_finer(&self, size: f64) -> f64 {
        let curve = self.passing_curve();
        let size_mm = to_mm(size);
        if size_mm <= curve[0].0 {
            return 0.0;
        }
        curve
            .windows(2)
            .find(|w| size_mm <= w[1].0)
            .map_or(100.0, |w| w[0].1 + (w[1].1 - w[0].1) * log_share(size_mm, w[0].0, w[1].0))
    }

    /// Size in m than which the given percent of the mass is finer (D₁₀, D₃₀,
    /// ...): linear in the logarithm of the size between two sieves, as the
    /// curve is drawn (Das, "Principles of Geotechnical Engineering", chapter
    /// on grain size). Percentages outside 0..100 give the finest or coarsest sieve.
    pub fn size_at_percent(&self, percent: f64) -> f64 {
        let curve = self.passing_curve();
        // A last digit of the sums must not lead to the other side of a gap.
        let Some(w) = curve.windows(2).find(|w| percent <= w[1].1 + SAME_PERCENT) else {
            return self.fractions[0].passing;
        };
        let share = (percent - w[0].1) / (w[1].1 - w[0].1);
        // Not a number in a gap at the finest sieve.
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        from_mm(w[0].0 * (w[1].0 / w[0].0).powf(share))
    }

    /// Characteristic sizes, coefficients and class.
    pub fn gradation(&self) -> Gradation {
        Gradation::of(|percent| self.size_at_percent(percent), |size| self.percent_finer(size))
    }
}

/// Makes quotas of zero, or of at least one half, whole by the method of largest remainders; only
/// those of zero are zero then.
fn whole_numbers(quotas: &[f64]) -> Vec<usize> {
    let least = |quota: f64| usize::from(quota > 0.0);
    let mut counts: Vec<usize> =
        quotas.iter().map(|&quota| (quota.floor() as usize).max(least(quota))).collect();
    let total = quotas.iter().sum::<f64>().round() as usize;
    let mut order: Vec<usize> = (0..quotas.len()).filter(|&i| quotas[i] >= 1.0).collect();
    order.sort_by(|&a, &b| quotas[b].fract().total_cmp(&quotas[a].fract()));
    let missing = total.saturating_sub(counts.iter().sum());
    for &i in order.iter().take(missing) {
        counts[i] += 1;
    }
    counts
}

/// Where `x` lies between `low` and `high` on a logarithmic axis, 0 to 1.
fn log_share(x: f64, low: f64, high: f64) -> f64 {
    (x / low).ln() / (high / low).ln()
}

pub(super) fn positive(what: &str, value: f64) -> Result<(), GrainsError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(GrainsError::NotPositive { what: what.into(), value })
}

fn check_table(table: &[SieveFraction]) -> Result<(), GrainsError> {
    if table.is_empty() {
        return Err(GrainsError::EmptySieveTable);
    }
    for (i, row) in table.iter().enumerate() {
        let fault = |reason: String| Err(GrainsError::BadSieveTable { row: i + 1, reason });
        let what = |name: &str| format!("{name} of row {} of the sieve table", i + 1);
        for (name, value) in [("passing_mm", row.passing_mm), ("retained_mm", row.retained_mm)] {
            positive(&what(name), value)?;
        }
        if row.mass_percent != 0.0 {
            positive(&what("mass_percent"), row.mass_percent)?;
        }
        if row.passing_mm <= row.retained_mm {
            return fault(format!(
                "the fraction passes {} mm and stays on {} mm, which is not finer",
                row.passing_mm, row.retained_mm
            ));
        }
        if i > 0 && (row.passing_mm - table[i - 1].retained_mm).abs() > 1e-9 * row.passing_mm {
            return fault(format!(
                "the fraction passes {} mm, the one above it stays on {} mm; rows run from the \
                 coarsest to the finest without gaps",
                row.passing_mm,
                table[i - 1].retained_mm
            ));
        }
    }
    if !SieveFraction::add_up(table) {
        return Err(GrainsError::PercentSum(SieveFraction::percent_sum(table)));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grains::tests::{near, paper_grains, table};

    #[test]
    fn the_paper_s_mass_gives_1456_grains() {
        let psd = ParticleSizeDistribution::new(&paper_grains()).unwrap();
        let counts: Vec<usize> = psd.fractions.iter().map(|f| f.grains).collect();
        assert_eq!(counts, [87, 610, 759], "n = V / (π/6·d³) by fraction");
        assert_eq!(psd.grains(), 1456, "number of grains (paper, section 3)");
        let volume: f64 = psd.fractions.iter().map(|f| f.volume).sum();
        near("solids = 2343 g / 2673.9 kg/m³, m³", volume, 2.343 / 2673.9, 1e-18);
    }

    #[test]
    fn whole_numbers_keep_the_total_and_stay_next_to_their_quota() {
        for quotas in
            [vec![86.75, 610.6, 758.7], vec![0.6, 0.7], vec![3.0], vec![0.5; 5], vec![2.5; 4]]
        {
            let counts = whole_numbers(&quotas);
            for (count, quota) in counts.iter().zip(&quotas) {
                let off = (*count as f64 - quota).abs();
                assert!(off < 1.0 && *count > 0, "quota {quota} of {quotas:?} became {count}");
            }
        }
        assert_eq!(whole_numbers(&[86.75, 610.6, 758.7]), [87, 610, 759]);
        assert_eq!(whole_numbers(&[2.5; 4]), [3, 3, 2, 2], "4 × 2.5 = 10");
        assert_eq!(whole_numbers(&[0.6, 5.0]), [1, 5], "half a grain and more is a grain");
    }

    #[test]
    fn characteristic_sizes_lie_on_the_log_linear_curve() {
        let psd = ParticleSizeDistribution::new(&paper_grains()).unwrap();
        let curve = psd.passing_curve();
        let expected = [(8.0, 0.0), (10.0, 33.05), (12.5, 85.0), (16.0, 100.0)];
        for (got, expected) in curve.iter().zip(expected) {
            near("sieve opening, mm", got.0, expected.0, 1e-12);
            near("percent finer", got.1, expected.1, 1e-12);
        }
        assert_eq!(curve.len(), 4);
        let d10 = 8.0 * (10.0_f64 / 8.0).powf(10.0 / 33.05);
        let d30 = 8.0 * (10.0_f64 / 8.0).powf(30.0 / 33.05);
        let d60 = 10.0 * (12.5_f64 / 10.0).powf((60.0 - 33.05) / 51.95);
        near("D10, mm", to_mm(psd.size_at_percent(10.0)), d10, 1e-12);
        near("D60, mm", to_mm(psd.size_at_percent(60.0)), d60, 1e-12);
        near("Cu = D60/D10", psd.gradation().uniformity, d60 / d10, 1e-12);
        near("Cc = D30²/(D60·D10)", psd.gradation().curvature, d30 * d30 / d60 / d10, 1e-12);
        near("D0 is the finest sieve, mm", to_mm(psd.size_at_percent(0.0)), 8.0, 1e-12);
        near("D100 is the coarsest, mm", to_mm(psd.size_at_percent(100.0)), 16.0, 1e-12);
        for percent in [0.5, 10.0, 33.05, 50.0, 85.0, 99.0] {
            let back = psd.percent_finer(psd.size_at_percent(percent));
            near("percent finer than D_p is p", back, percent, 1e-9);
        }
    }

    /// Law: where 30 % are below a gap, D30 is where the gap begins, whatever the shares are that
    /// add up to 30.
    #[test]
    fn last_digits_of_shares_do_not_cross_a_gap() {
        for [b, c, d] in [[10.0, 10.0, 10.0], [22.7, 2.4, 4.9], [11.4, 10.9, 7.7]] {
            let rows =
                [(16.0, 8.0, 70.0), (8.0, 4.0, 0.0), (4.0, 2.0, b), (2.0, 1.0, c), (1.0, 0.5, d)];
            let spec = SievedGrains { total_mass_g: 500.0, ..table(&rows) };
            let psd = ParticleSizeDistribution::new(&spec).unwrap();
            let law = format!("D30 of {b} + {c} + {d} % below a gap from 4 to 8 mm, mm");
            near(&law, to_mm(psd.size_at_percent(30.0)), 4.0, 1e-9);
        }
    }

    /// Law: half of the coarse fraction on 4.75 mm is not more than half, and a Cu of 0.6 mm over
    /// 0.1 mm is 6, whatever the last digits are.
    #[test]
    fn last_digits_do_not_change_a_class() {
        let gradation = |total_mass_g: f64, rows: &[(f64, f64, f64)]| {
            let spec = SievedGrains { total_mass_g, ..table(rows) };
            ParticleSizeDistribution::new(&spec).unwrap().gradation()
        };
        for [b, c, d] in [[38.4, 7.7, 3.9], [38.0, 8.0, 4.0]] {
            let rows = [(19.0, 4.75, 50.0), (4.75, 2.36, b), (2.36, 1.18, c), (1.18, 0.6, d)];
            assert_eq!(gradation(500.0, &rows).uscs, "SP", "{b} + {c} + {d} % below 4.75 mm");
        }
        let rows = [(1.2, 0.6, 40.0), (0.6, 0.25, 30.0), (0.25, 0.1, 20.0), (0.1, 0.08, 10.0)];
        let found = gradation(1.0, &rows);
        near("Cu = 0.6 mm / 0.1 mm", found.uniformity, 6.0, 1e-12);
        near("Cc = 0.25² / (0.6 · 0.1)", found.curvature, 0.0625 / 0.06, 1e-12);
        assert_eq!(found.uscs, "SW", "Cu of 6 and Cc from 1 to 3, got Cu {}", found.uniformity);
    }

    #[test]
    fn uscs_classes() {
        let of = |total_mass_g: f64, rows: &[(f64, f64, f64)]| {
            let spec = SievedGrains { total_mass_g, ..table(rows) };
            ParticleSizeDistribution::new(&spec).unwrap().gradation().uscs
        };
        let class = |rows: &[(f64, f64, f64)]| of(500.0, rows);
        let heavy = |rows: &[(f64, f64, f64)]| of(10_000.0, rows);
        let paper = ParticleSizeDistribution::new(&paper_grains()).unwrap();
        assert_eq!(paper.gradation().uscs, "GP", "paper, section 2: USCS GP");
        let wide = [(40.0, 20.0, 45.0), (20.0, 10.0, 30.0), (10.0, 5.0, 10.0), (5.0, 2.5, 15.0)];
        assert_eq!(class(&wide), "GW", "Cu ≈ 5.4, Cc ≈ 1.5: GW");
        let hollow = [(40.0, 20.0, 40.0), (20.0, 10.0, 25.0), (10.0, 5.0, 17.0), (5.0, 2.5, 18.0)];
        assert_eq!(class(&hollow), "GP", "Cu ≈ 5.4, Cc ≈ 0.9: GP");
        // Of what passes 75 mm, 20 of 50 % stay on 4.75 mm: cobbles do not make it gravel.
        let sand = [(150.0, 75.0, 50.0), (75.0, 4.75, 20.0), (4.75, 2.36, 30.0)];
        assert_eq!(heavy(&sand), "SP", "more than half of the soil passes 4.75 mm: SP");
        assert_eq!(heavy(&[(150.0, 100.0, 100.0)]), "cobbles", "nothing passes 75 mm");
        let sand = [(5.0, 4.5, 40.0), (4.5, 4.0, 60.0)];
        assert_eq!(class(&sand), "SP", "all but a fifth passes 4.75 mm: SP");
    }

    #[test]
    fn faults_are_named() {
        let fault = |spec: &SievedGrains| ParticleSizeDistribution::new(spec).unwrap_err();
        let good = paper_grains();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let spec = SievedGrains { total_mass_g: bad, ..good.clone() };
            assert!(matches!(fault(&spec), GrainsError::NotPositive { .. }), "mass {bad}");
            let spec = SievedGrains { density_kg_per_m3: bad, ..good.clone() };
            assert!(matches!(fault(&spec), GrainsError::NotPositive { .. }), "density {bad}");
            let spec = table(&[(bad, 8.0, 100.0)]);
            assert!(matches!(fault(&spec), GrainsError::NotPositive { .. }), "opening {bad}");
        }
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            let spec = table(&[(16.0, 8.0, bad)]);
            assert!(matches!(fault(&spec), GrainsError::NotPositive { .. }), "percent {bad}");
        }
        let e = fault(&table(&[(16.0, 8.0, 0.0)]));
        assert!(matches!(e, GrainsError::PercentSum(_)), "nothing at all: {e}");
        assert!(matches!(fault(&table(&[])), GrainsError::EmptySieveTable));
        let e = fault(&table(&[(8.0, 10.0, 100.0)]));
        assert!(matches!(e, GrainsError::BadSieveTable { row: 1, .. }), "upside down: {e}");
        let e = fault(&table(&[(16.0, 12.0, 50.0), (10.0, 8.0, 50.0)]));
        assert!(matches!(e, GrainsError::BadSieveTable { row: 2, .. }), "gap: {e}");
        let e = fault(&table(&[(16.0, 12.0, 50.0), (12.0, 8.0, 49.0)]));
        assert!(matches!(e, GrainsError::PercentSum(_)), "99 %: {e}");
        let e = fault(&table(&[(160.0, 120.0, 50.0), (120.0, 100.0, 50.0)]));
        assert!(matches!(e, GrainsError::EmptyFraction { passing_mm: 160.0, .. }), "{e}");
        let e = fault(&table(&[(1e-3, 1e-200, 100.0)]));
        assert!(matches!(e, GrainsError::TooManyGrains { .. }), "dust: {e}");
    }

    #[test]
    fn rounded_percentages_keep_the_total_mass() {
        let spec = table(&[(16.0, 12.0, 33.3), (12.0, 10.0, 33.3), (10.0, 8.0, 33.3)]);
        let psd = ParticleSizeDistribution::new(&spec).unwrap();
        let mass: f64 = psd.fractions.iter().map(|f| f.mass).sum();
        near("total mass, kg", mass, spec.total_mass_g / 1e3, 1e-15);
    }
}
