//! How things look: a colour a sieve fraction, clear apparatus.

use super::*;
use crate::grains::GrainSet;
use crate::plain::three_decimals;
use crate::units::to_mm;

/// Colours that colour-blind readers tell apart (Okabe & Ito 2008), in sRGB,
/// for the sieve fractions from the coarsest on.
const COLOURS: [[u8; 3]; 6] =
    [[0, 114, 178], [230, 159, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [213, 94, 0]];

/// How much of what is behind the apparatus it hides.
const CLEAR: f64 = 0.1;

/// The materials of the sieve fractions, by their numbers, and that of the
/// apparatus, whose number comes with them.
pub fn materials(grains: &GrainSet) -> (Vec<Value>, usize) {
    let fractions = grains.grains.iter().map(|g| g.fraction + 1).max().unwrap_or(0);
    let short = |length: f64| three_decimals(to_mm(length));
    let of_fraction = |n: usize| {
        let name = match grains.blocks.get(n) {
            Some(b) => format!("sieve {} to {} mm", short(b.retained), short(b.passing)),
            None => format!("sieve fraction {n}"),
        };
        let [r, g, b] = COLOURS[n % COLOURS.len()].map(linear);
        json!({
            "name": name,
            "pbrMetallicRoughness": {
                "baseColorFactor": numbers([r, g, b, 1.0]),
                "metallicFactor": 0,
                "roughnessFactor": number(0.85),
            },
        })
    };
    let mut list: Vec<Value> = (0..fractions).map(of_fraction).collect();
    list.push(json!({
        "name": "apparatus",
        "alphaMode": "BLEND",
        "pbrMetallicRoughness": {
            "baseColorFactor": numbers([0.6, 0.65, 0.7, CLEAR]),
            "metallicFactor": 0,
            "roughnessFactor": number(0.4),
        },
    }));
    (list, fractions)
}

/// From the sRGB of screens to the linear scale of glTF's factors (IEC 61966-2-1).
fn linear(byte: u8) -> f64 {
    let c = f64::from(byte) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}
