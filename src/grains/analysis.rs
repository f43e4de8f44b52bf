//! Sieve analysis of grains as they are: each through the virtual sieve.

use rayon::prelude::*;

use super::gradation::SAME_PERCENT;
use super::*;

/// One grain in the sieve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sieved {
    /// Side of the smallest square opening it passes, in m.
    pub size: f64,
    /// Its mass in kg.
    pub mass: f64,
}

/// What sieving every grain by itself gives: a curve with a step a grain.
#[derive(Debug, Clone, PartialEq)]
pub struct SieveAnalysis {
    /// In the order of the grain set.
    grains: Vec<Sieved>,
    /// Sizes in m, ascending, with the share of the mass in percent up to and with that grain.
    curve: Vec<(f64, f64)>,
}

impl SieveAnalysis {
    /// Sieves the grains of a set.
    pub fn of(set: &GrainSet) -> Self {
        let sieved = |g: &super::Grain| Sieved { size: sieve_size(&g.shape), mass: g.mass };
        Self::new(set.grains.par_iter().map(sieved).collect())
    }

    /// The analysis of grains that were sieved.
    pub fn new(grains: Vec<Sieved>) -> Self {
        let mut sorted = grains.clone();
        sorted.sort_by(|a, b| a.size.total_cmp(&b.size));
        let total: f64 = sorted.iter().map(|g| g.mass).sum();
        let mut passed = 0.0;
        let curve = sorted
            .iter()
            .map(|g| {
                passed += g.mass;
                (g.size, 100.0 * passed / total)
            })
            .collect();
        Self { grains, curve }
    }

    /// The grains, in the order of their set.
    pub fn grains(&self) -> &[Sieved] {
        &self.grains
    }

    /// Percent of the mass that passes a sieve with square openings of a side in m.
    pub fn percent_finer(&self, opening: f64) -> f64 {
        let passing = self.curve.partition_point(|p| p.0 <= opening);
        passing.checked_sub(1).map_or(0.0, |last| self.curve[last].1)
    }

    /// Opening in m of the finest sieve that at least a percentage of the
    /// mass passes (D₁₀, D₃₀, ...); NaN without grains.
    pub fn size_at_percent(&self, percent: f64) -> f64 {
        // A last digit of the sums must not ask for the next grain.
        let at = self.curve.partition_point(|p| p.1 < percent - SAME_PERCENT);
        self.curve.get(at).or(self.curve.last()).map_or(f64::NAN, |p| p.0)
    }

    /// Number and mass in kg of the grains that pass a sieve and stay on
    /// another, openings in m. What is as large as an opening passes it.
    pub fn between(&self, passing: f64, retained: f64) -> (usize, f64) {
        let own = self.grains.iter().filter(|g| g.size <= passing && g.size > retained);
        own.fold((0, 0.0), |(count, mass), g| (count + 1, mass + g.mass))
    }

    /// Characteristic sizes, coefficients and class.
    pub fn gradation(&self) -> Gradation {
        Gradation::of(|percent| self.size_at_percent(percent), |size| self.percent_finer(size))
    }

    /// Points of the curve for drawing: size in m and percent of the mass
    /// that passes, at the finest grain, at every percent, and at the coarsest grain.
    pub fn points(&self) -> Vec<(f64, f64)> {
        // Others may be as fine as the finest.
        let finest = self.curve.first().map(|p| (p.0, self.percent_finer(p.0)));
        let mut points: Vec<(f64, f64)> = finest.into_iter().collect();
        for percent in 1..=100 {
            let size = self.size_at_percent(f64::from(percent));
            let next = (size, self.percent_finer(size));
            if points.last().is_some_and(|last| last.0 < next.0) {
                points.push(next);
            }
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grains::{
        generate,
        tests::{few_grains, near},
    };

    #[test]
    fn ten_grains_of_one_gram() {
        let grain = |n: u32| Sieved { size: 1e-3 * f64::from(n), mass: 1e-3 };
        let analysis = SieveAnalysis::new([3, 1, 2, 10, 5, 4, 9, 6, 8, 7].map(grain).into());
        for (percent, size_mm) in [(10.0, 1.0), (30.0, 3.0), (31.0, 4.0), (50.0, 5.0), (60.0, 6.0)]
        {
            let got = 1e3 * analysis.size_at_percent(percent);
            near(&format!("D{percent}, mm"), got, size_mm, 1e-12);
        }
        for (opening_mm, percent) in
            [(0.9, 0.0), (1.0, 10.0), (5.5, 50.0), (10.0, 100.0), (11.0, 100.0)]
        {
            let got = analysis.percent_finer(1e-3 * opening_mm);
            near(&format!("percent finer than {opening_mm} mm"), got, percent, 1e-9);
        }
        let g = analysis.gradation();
        near("Cu = D60/D10", g.uniformity, 6.0, 1e-12);
        near("Cc = D30²/(D60·D10)", g.curvature, 1.5, 1e-12);
        // Six of ten stay on 4.75 mm: gravel; Cu ≥ 4 and 1 ≤ Cc ≤ 3.
        assert_eq!(g.uscs, "GW");
        let (count, mass) = analysis.between(5e-3, 2e-3);
        assert_eq!(count, 3, "3, 4 and 5 mm pass 5 mm and stay on 2 mm");
        near("their mass, kg", mass, 3e-3, 1e-15);
        assert!(SieveAnalysis::new(Vec::new()).gradation().d50.is_nan(), "no grains have no D50");
    }

    /// Law: a curve begins with what a sieve of the finest size passes, and ends at 100 %.
    #[test]
    fn grains_of_one_size_are_a_step_of_the_curve() {
        let curve = |sizes: &[f64]| {
            let sieved = |&size: &f64| Sieved { size, mass: 1e-3 };
            SieveAnalysis::new(sizes.iter().map(sieved).collect()).points()
        };
        let [one] = curve(&[6e-3; 10])[..] else { panic!("law: one size is one step") };
        near("percent of equal grains that pass their size", one.1, 100.0, 1e-9);
        let [fine, coarse] = curve(&[8e-3, 6e-3, 6e-3, 8e-3])[..] else { panic!("law: two steps") };
        near("percent that passes the finer of two sizes", fine.1, 50.0, 1e-9);
        near("percent that passes the coarser", coarse.1, 100.0, 1e-9);
    }

    #[test]
    fn every_grain_is_in_one_fraction_and_the_curve_ends_at_100() {
        let set = generate(&few_grains(), 1).unwrap();
        let analysis = SieveAnalysis::of(&set);
        let sieves = [1.0, 16e-3, 12.5e-3, 10e-3, 8e-3, 0.0];
        let (count, mass) = sieves
            .windows(2)
            .map(|w| analysis.between(w[0], w[1]))
            .fold((0, 0.0), |(n, m), (count, mass)| (n + count, m + mass));
        assert_eq!(count, set.grains.len(), "law: every grain is in one fraction");
        near("their mass, kg", mass, set.total_mass(), 1e-15);
        let points = analysis.points();
        assert!(points.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 < w[1].1), "{points:?}");
        near("the curve ends at, %", points.last().unwrap().1, 100.0, 1e-9);
        for (size, percent) in points {
            near("percent finer than D_p is p", analysis.percent_finer(size), percent, 0.0);
        }
    }
}
