//! Colours, and the scales that give grains theirs.
//!
//! Light adds up in linear intensities; files hold those of the sRGB standard
//! (IEC 61966-2-1). The scales are viridis (van der Walt and Smith 2015), even to
//! the eye and readable by colour-blind people, from the crate `colorous`.

/// A colour in linear intensities of red, green and blue, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Colour(pub [f32; 3]);

impl Colour {
    /// Grains without a scale.
    pub const GRAIN: Self = Self([0.45, 0.40, 0.33]);
    /// What has no value.
    pub const GREY: Self = Self([0.45, 0.45, 0.45]);
    /// Walls that are not of glass.
    pub const WALL: Self = Self([0.50, 0.56, 0.64]);
    /// Where a wall was cut away.
    pub const SECTION: Self = Self([0.20, 0.26, 0.35]);
    /// The top plate.
    pub const PLATE: Self = Self([0.62, 0.30, 0.12]);
    /// The floor of the cylinder, and the lid of the funnel.
    pub const FLOOR: Self = Self([0.40, 0.43, 0.47]);
    /// What glass takes on where one looks through much of it.
    pub const GLASS: Self = Self([0.10, 0.22, 0.34]);
    /// The bar of a known length beside loose grains.
    pub const BAR: Self = Self([0.03, 0.03, 0.03]);

    /// From the three bytes of sRGB.
    pub fn from_srgb(bytes: [u8; 3]) -> Self {
        Self(bytes.map(|byte| {
            let v = f32::from(byte) / 255.0;
            if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        }))
    }

    /// The three bytes of sRGB.
    pub fn to_srgb(self) -> [u8; 3] {
        self.0.map(|v| {
            let v = v.clamp(0.0, 1.0);
            let v = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
            (255.0 * v).round() as u8
        })
    }

    /// As SVG writes it.
    pub fn to_hex(self) -> String {
        let [r, g, b] = self.to_srgb();
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}

/// Viridis at 0 to 1, without its darkest end, which shading would swallow.
pub fn scale(share: f64) -> Colour {
    const FIRST: f64 = 0.18;
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    let c = colorous::VIRIDIS.eval_continuous(FIRST + (1.0 - FIRST) * share);
    Colour::from_srgb([c.r, c.g, c.b])
}

/// The colour of the n-th of several steps, from small to large.
pub fn step(n: usize, of: usize) -> Colour {
    match of {
        0 | 1 => Colour::GRAIN,
        // Few steps are told apart in the middle of the scale, which shading spares most.
        5.. => scale(n as f64 / (of - 1) as f64),
        _ => scale(0.14 + 0.66 * n as f64 / (of - 1) as f64),
    }
}

/// The smallest of 1, 2, 2.5, 5 times a power of ten that is not below a value;
/// 1 where the value is no positive number.
pub fn round_up(value: f64) -> f64 {
    if !(value > 0.0) || !value.is_finite() {
        return 1.0;
    }
    let power = 10f64.powf(value.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().find(|s| s * power >= value * (1.0 - 1e-9));
    step.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::near;

    #[test]
    fn bytes_come_back() {
        for byte in 0..=255 {
            let bytes = [byte, 255 - byte, byte / 2];
            assert_eq!(Colour::from_srgb(bytes).to_srgb(), bytes, "law: there and back");
        }
        let middle = Colour::from_srgb([188, 188, 188]).0[0];
        assert!((middle - 0.5).abs() < 0.005, "law: byte 188 is half the light, got {middle}");
    }

    /// Law: no two of some fractions have one colour, however many there are.
    #[test]
    fn steps_are_told_apart() {
        for count in [1, 4, 5, 9, 20] {
            let colours: std::collections::BTreeSet<String> =
                (0..count).map(|n| step(n, count).to_hex()).collect();
            assert_eq!(colours.len(), count, "law: {count} colours, got {colours:?}");
        }
    }

    #[test]
    fn the_scale_gets_steadily_lighter() {
        let light = |share: f64| {
            let [r, g, b] = scale(share).0;
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for n in 0..20 {
            let (a, b) = (light(f64::from(n) / 20.0), light(f64::from(n + 1) / 20.0));
            assert!(b > a, "law: viridis gets lighter, got {a} then {b}");
        }
        assert_eq!(scale(f64::NAN), scale(0.0), "what is no number is the lowest");
    }

    #[test]
    fn ends_of_scales_are_round() {
        for (value, expected) in [
            (0.0, 1.0),
            (-3.0, 1.0),
            (f64::NAN, 1.0),
            (1.0, 1.0),
            (1.01, 2.0),
            (23.0, 25.0),
            (0.031, 0.05),
            (870.0, 1000.0),
        ] {
            let got = round_up(value);
            near(&format!("of {value}"), got, expected, 1e-12 * expected);
        }
    }
}
