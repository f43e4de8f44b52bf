//! Sieve sizes, remembered: the same grains are sieved as they are made, for every table and at the
//! end of every stage, and the exact search takes some milliseconds per grain.

use std::sync::{Mutex, PoisonError};

use sha2::{Digest, Sha256};

use super::*;

/// Sizes that are remembered at most; with more, all are forgotten. Those of a
/// quarter of a million grains take some 16 MiB.
const MOST: usize = 1 << 18;

/// Sizes in m by the SHA-256 of the corners' bits.
static KNOWN: Mutex<Option<HashMap<[u8; 32], f64>>> = Mutex::new(None);

/// Side in m of the smallest square opening that the hull of a body's corners
/// passes: [`Passage::of`], or what that gave for these corners, to the bit, before. One corner is
/// a sphere's, on its surface ([`crate::world::World::corners`]).
pub fn sieve_size_of(corners: &[Vector]) -> f64 {
    if let [on_sphere] = corners {
        return 2.0 * on_sphere.norm();
    }
    let name = name(corners);
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(side) = known().as_ref().and_then(|known| known.get(&name)) {
        return *side;
    }
    let side = Passage::of(corners).side;
    let mut known = known();
    let known = known.get_or_insert_with(HashMap::new);
    if known.len() >= MOST {
        known.clear();
    }
    known.insert(name, side);
    side
}

/// Side in m of the smallest square opening that a grain passes, moving
/// straight in its best orientation: [`Passage::of`].
///
/// ```
/// use pluvia::{geometry::{ConvexPolyhedron, Vector}, grains::sieve_size};
///
/// // A box of 10 × 12 × 30 mm goes through lengthwise, and must have room for its 12 mm.
/// let grain = ConvexPolyhedron::cuboid(Vector::new(0.010, 0.012, 0.030))?;
/// assert!((sieve_size(&grain) - 0.012).abs() < 1e-9);
/// # Ok::<(), pluvia::geometry::PolyhedronError>(())
/// ```
pub fn sieve_size(shape: &ConvexPolyhedron) -> f64 {
    if let Some(sphere) = shape.sphere() {
        return 2.0 * sphere.radius;
    }
    // The shadow of what a ball sweeps is as much wider as the ball, in every direction.
    let (shape, radius) = shape.core();
    let corners: Vec<Vector> = shape.vertices().iter().map(|v| v.coords).collect();
    sieve_size_of(&corners) + 2.0 * radius
}

fn name(corners: &[Vector]) -> [u8; 32] {
    let mut hash = Sha256::new();
    for x in corners.iter().flat_map(|corner| corner.iter()) {
        hash.update(x.to_bits().to_le_bytes());
    }
    hash.finalize().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_remembered_is_what_is_found_and_a_bit_makes_another_body() {
        let mut brick: Vec<Vector> = (0..8)
            .map(|n| {
                let side = |bit: usize, length: f64| if n >> bit & 1 == 1 { length } else { 0.0 };
                Vector::new(side(0, 0.0101), side(1, 0.0123), side(2, 0.03))
            })
            .collect();
        let found = Passage::of(&brick).side;
        for _ in 0..2 {
            assert_eq!(sieve_size_of(&brick), found, "law: the same bits, first and later");
        }
        let before = name(&brick);
        brick[7].y = f64::from_bits(brick[7].y.to_bits() + 1);
        assert_ne!(name(&brick), before, "law: a changed bit is seen");
        for corner in &mut brick {
            corner.y *= 2.0;
        }
        let wider = sieve_size_of(&brick);
        assert!(wider > 1.5 * found, "law: a wider body is sieved anew, got {wider} after {found}");
    }
}
