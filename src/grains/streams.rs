//! Named random streams: a new draw in one place shifts nothing elsewhere.

use nalgebra::{Quaternion, UnitQuaternion};
use rand::{Rng as _, SeedableRng as _};
use rand_pcg::Pcg64;
use sha2::{Digest, Sha256};

/// A stream of random numbers, the same on every machine for the same seed and name.
pub struct Stream(Pcg64);

impl Stream {
    /// The stream of that name under a seed.
    pub fn new(seed: u64, name: &str) -> Self {
        let mut digest = Sha256::new();
        digest.update(seed.to_le_bytes());
        digest.update(name.as_bytes());
        let hash = digest.finalize();
        let mut state = [0; 32];
        state.copy_from_slice(&hash);
        Self(Pcg64::from_seed(state))
    }

    /// Uniform in [0, 1), from the upper 53 bits of a draw.
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform among 0, 1, ..., `below` - 1.
    pub fn index(&mut self, below: usize) -> usize {
        // The bias of the product rule is below 2⁻⁵³ · below: nothing here.
        ((self.uniform() * below as f64) as usize).min(below.saturating_sub(1))
    }

    /// A random order of 0, 1, ..., `count` - 1 (Fisher and Yates).
    pub fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, self.index(last + 1));
        }
        order
    }

    /// A rotation drawn uniformly from all rotations (Shoemake 1992, "Uniform
    /// random rotations", Graphics Gems III).
    pub fn rotation(&mut self) -> UnitQuaternion<f64> {
        let (u, v, w) = (self.uniform(), self.uniform(), self.uniform());
        let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
        let (tv, tw) = (std::f64::consts::TAU * v, std::f64::consts::TAU * w);
        UnitQuaternion::new_normalize(Quaternion::new(
            b * tw.cos(),
            a * tv.sin(),
            a * tv.cos(),
            b * tw.sin(),
        ))
    }
}
