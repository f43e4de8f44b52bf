//! Named random streams and the few samplers drawn from them.
//!
//! Every use of randomness has its own name, hence its own generator: a draw added in one place
//! shifts nothing elsewhere. The samplers are written from raw 64-bit words with additions,
//! multiplications, divisions and square roots only, which IEEE 754 rounds alike everywhere, so
//! that the same seed gives the same bits on any platform and with any version of `rand`.

use nalgebra::{Quaternion, UnitQuaternion};
use rand_pcg::rand_core::Rng;
use sha2::{Digest, Sha256};

use super::*;

/// The random stream of a name under a seed.
///
/// State and increment of PCG-64 (O'Neill 2014, "PCG: a family of simple fast
/// space-efficient statistically good algorithms for random number
/// generation") are the two halves of SHA-256(seed, little endian ‖ name).
pub fn stream(seed: u64, name: &str) -> Pcg64 {
    let mut hash = Sha256::new();
    hash.update(seed.to_le_bytes());
    hash.update(name.as_bytes());
    let digest = hash.finalize();
    let half = |from: usize| {
        digest[from..from + 16].iter().rev().fold(0_u128, |n, &byte| n << 8 | u128::from(byte))
    };
    Pcg64::new(half(0), half(16))
}

/// A number uniform in [0, 1): one of the 2⁵³ multiples of 2⁻⁵³.
pub fn uniform(rng: &mut Pcg64) -> f64 {
    const SCALE: f64 = 1.0 / (1_u64 << 53) as f64;
    (rng.next_u64() >> 11) as f64 * SCALE
}

/// A whole number uniform in 0..n, without bias: multiply and reject (Lemire
/// 2019, "Fast random integer generation in an interval"). 0 for `n` = 0.
pub fn below(rng: &mut Pcg64, n: u64) -> u64 {
    if n == 0 {
        return 0;
    }
    // The 2⁶⁴ mod n lowest remainders would be hit once too often.
    let threshold = n.wrapping_neg() % n;
    loop {
        let product = u128::from(rng.next_u64()) * u128::from(n);
        if product as u64 >= threshold {
            return (product >> 64) as u64;
        }
    }
}

/// Puts a slice into a uniformly random order (Fisher and Yates 1938, in Durstenfeld's form).
pub fn shuffle<T>(rng: &mut Pcg64, items: &mut [T]) {
    for i in (1..items.len()).rev() {
        items.swap(i, below(rng, i as u64 + 1) as usize);
    }
}

/// A point uniform in the disc of radius 1, by rejection, with its squared radius.
pub fn in_unit_disc(rng: &mut Pcg64) -> (f64, f64, f64) {
    loop {
        let x = 2.0 * uniform(rng) - 1.0;
        let y = 2.0 * uniform(rng) - 1.0;
        let s = x * x + y * y;
        if s < 1.0 && s > 0.0 {
            return (x, y, s);
        }
    }
}

/// A uniformly random rotation: a point uniform on the unit 3-sphere taken as
/// a quaternion (Shoemake 1992, "Uniform random rotations", Graphics Gems III).
///
/// The point is found by Marsaglia's rejection (1972, "Choosing a point from
/// the surface of a sphere"), which has the same distribution as Shoemake's
/// formula but needs no sine or cosine, whose last bit differs between platforms.
pub fn rotation(rng: &mut Pcg64) -> UnitQuaternion<f64> {
    let (a, b, s) = in_unit_disc(rng);
    let (c, d, t) = in_unit_disc(rng);
    let factor = ((1.0 - s) / t).sqrt();
    UnitQuaternion::new_normalize(Quaternion::new(d * factor, a, b, c * factor))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::near;

    #[test]
    fn same_name_and_seed_give_the_same_bits_others_do_not() {
        let draw = |seed, name| {
            let mut rng = stream(seed, name);
            [rng.next_u64(), rng.next_u64(), rng.next_u64()]
        };
        assert_eq!(draw(1, "points"), draw(1, "points"), "same stream, same bits");
        assert_ne!(draw(1, "points"), draw(2, "points"), "another seed, other bits");
        assert_ne!(draw(1, "points"), draw(1, "point"), "another name, other bits");
    }

    #[test]
    fn bits_are_those_of_every_platform_and_release() {
        // Canned: a change here changes every specimen ever published.
        let mut rng = stream(1, "test");
        let got = [rng.next_u64(), rng.next_u64()];
        assert_eq!(got, CANNED, "stream(1, \"test\") must never change");
    }
    const CANNED: [u64; 2] = [4_326_633_327_560_244_740, 2_006_919_212_999_461_249];

    #[test]
    fn uniform_has_the_moments_of_the_uniform_law() {
        let mut rng = stream(3, "moments");
        let n = 200_000;
        let draws: Vec<f64> = (0..n).map(|_| uniform(&mut rng)).collect();
        assert!(draws.iter().all(|u| (0.0..1.0).contains(u)), "all draws in [0, 1)");
        let mean = draws.iter().sum::<f64>() / n as f64;
        let variance = draws.iter().map(|u| (u - mean).powi(2)).sum::<f64>() / n as f64;
        // Five standard errors: sqrt(1/12/n) and sqrt(1/180/n).
        assert!((mean - 0.5).abs() < 3.3e-3, "mean of U[0,1): expected 0.5, got {mean} ± 3.3e-3");
        let expected = 1.0 / 12.0;
        near("variance of U[0,1)", variance, expected, 8.4e-4);
    }

    #[test]
    fn below_hits_every_number_equally_often() {
        let mut rng = stream(4, "below");
        let mut hits = [0_u32; 7];
        for _ in 0..70_000 {
            hits[below(&mut rng, 7) as usize] += 1;
        }
        // Chi-square with 6 degrees of freedom: 99.99 % lie below 27.9.
        let chi2: f64 = hits.iter().map(|&h| (f64::from(h) - 1e4).powi(2) / 1e4).sum();
        assert!(
            chi2 < 27.9,
            "chi-square of 7 equal classes: expected < 27.9, got {chi2} ({hits:?})"
        );
    }

    #[test]
    fn shuffle_keeps_every_item_and_reaches_every_order() {
        let mut rng = stream(5, "shuffle");
        let mut seen = std::collections::HashSet::new();
        for _ in 0..500 {
            let mut items = [0, 1, 2, 3];
            shuffle(&mut rng, &mut items);
            let mut sorted = items;
            sorted.sort_unstable();
            assert_eq!(sorted, [0, 1, 2, 3], "a shuffle is a permutation");
            seen.insert(items);
        }
        assert_eq!(seen.len(), 24, "all 4! = 24 orders occur in 500 shuffles");
    }

    #[test]
    fn rotations_are_uniform() {
        // For the uniform (Haar) measure every entry of the rotation matrix
        // has mean 0 and mean square 1/3, and the trace has mean square 1.
        let mut rng = stream(6, "rotation");
        let n = 40_000;
        let mut mean = nalgebra::Matrix3::zeros();
        let mut square = nalgebra::Matrix3::zeros();
        let mut trace2 = 0.0;
        for _ in 0..n {
            let m = rotation(&mut rng).to_rotation_matrix().into_inner();
            mean += m / f64::from(n);
            square += m.component_mul(&m) / f64::from(n);
            trace2 += m.trace().powi(2) / f64::from(n);
        }
        for (what, got, expected, tolerance) in [
            ("largest mean of an entry", mean.amax(), 0.0, 0.015),
            ("largest mean square of an entry", square.max(), 1.0 / 3.0, 0.01),
            ("smallest mean square of an entry", square.min(), 1.0 / 3.0, 0.01),
            ("mean square of the trace", trace2, 1.0, 0.035),
        ] {
            near(&format!("{what} of random rotations"), got, expected, tolerance);
        }
    }
}
