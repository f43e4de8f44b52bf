//! Pictures in memory, laid over each other and written as PNG.

use super::*;

/// Pixels in linear intensities with alpha, multiplied already, row by row from
/// the upper left corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Red, green, blue, alpha.
    pub pixels: Vec<[f32; 4]>,
}

/// What lies behind a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Background {
    /// White paper.
    #[default]
    White,
    /// Nothing, for slides.
    Transparent,
}

impl Image {
    /// Nothing, of a size.
    pub fn clear(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![[0.0; 4]; width as usize * height as usize] }
    }

    /// Lays another picture over this one, with its upper left corner at a pixel;
    /// what juts out is left away.
    pub fn lay(&mut self, over: &Self, x: u32, y: u32) {
        let columns = over.width.min(self.width.saturating_sub(x)) as usize;
        let rows = over.height.min(self.height.saturating_sub(y)) as usize;
        for row in 0..rows {
            let from = row * over.width as usize;
            let to = (y as usize + row) * self.width as usize + x as usize;
            let over = &over.pixels[from..from + columns];
            for (below, over) in self.pixels[to..to + columns].iter_mut().zip(over) {
                let through = 1.0 - over[3];
                *below = std::array::from_fn(|n| over[n] + through * below[n]);
            }
        }
    }

    /// From straight sRGB bytes with alpha.
    pub fn from_rgba(width: u32, height: u32, bytes: &[u8]) -> Self {
        let pixel = |p: &[u8]| {
            let alpha = f32::from(p[3]) / 255.0;
            let [r, g, b] = Colour::from_srgb([p[0], p[1], p[2]]).0.map(|c| c * alpha);
            [r, g, b, alpha]
        };
        Self { width, height, pixels: bytes.chunks_exact(4).map(pixel).collect() }
    }

    /// As sRGB bytes on white, three a pixel.
    pub fn to_rgb(&self) -> Vec<u8> {
        let on_white = |p: &[f32; 4]| {
            let white = 1.0 - p[3];
            Colour([p[0] + white, p[1] + white, p[2] + white]).to_srgb()
        };
        self.pixels.iter().flat_map(on_white).collect()
    }

    /// As straight sRGB bytes with alpha, four a pixel.
    pub fn to_rgba(&self) -> Vec<u8> {
        let straight = |p: &[f32; 4]| {
            let alpha = p[3].clamp(0.0, 1.0);
            let part = if alpha > 0.0 { 1.0 / alpha } else { 0.0 };
            let [r, g, b] = Colour([p[0] * part, p[1] * part, p[2] * part]).to_srgb();
            [r, g, b, (255.0 * alpha).round() as u8]
        };
        self.pixels.iter().flat_map(straight).collect()
    }

    /// As PNG, which names its colours as sRGB.
    ///
    /// # Errors
    /// When the size makes no PNG.
    pub fn to_png(&self, background: Background) -> Result<Vec<u8>, PictureError> {
        let (colours, bytes) = match background {
            Background::White => (png::ColorType::Rgb, self.to_rgb()),
            Background::Transparent => (png::ColorType::Rgba, self.to_rgba()),
        };
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(colours);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_compression(png::Compression::High);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&bytes)?;
        writer.finish()?;
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(pixel: [f32; 4]) -> Image {
        Image { width: 1, height: 1, pixels: vec![pixel] }
    }

    #[test]
    fn pictures_lie_over_each_other_as_glass_does() {
        let mut below = dot([0.5, 0.0, 0.0, 0.5]);
        below.lay(&dot([0.0, 0.25, 0.0, 0.25]), 0, 0);
        // 0.25 + 0.75 · 0.5: what lies behind shines through three quarters.
        assert_eq!(below.pixels[0], [0.375, 0.25, 0.0, 0.625]);
        let mut wide = Image::clear(2, 2);
        wide.lay(&dot([1.0; 4]), 1, 1);
        wide.lay(&dot([1.0; 4]), 2, 0);
        assert_eq!(wide.pixels.iter().filter(|p| p[3] == 1.0).count(), 1, "what juts out is cut");
    }

    #[test]
    fn a_png_holds_the_bytes() {
        let image = Image { width: 2, height: 1, pixels: vec![[0.0; 4], [0.5, 0.25, 0.0, 0.5]] };
        for (background, expected) in [
            (Background::White, vec![255, 255, 255, 255, 225, 188]),
            (Background::Transparent, vec![0, 0, 0, 0, 255, 188, 0, 128]),
        ] {
            let file = image.to_png(background).expect("a PNG");
            let mut reader =
                png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("info");
            let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
            reader.next_frame(&mut bytes).expect("a frame");
            assert_eq!(bytes, expected, "law: sRGB of the light, {background:?}");
        }
        assert!(Image::clear(0, 4).to_png(Background::White).is_err(), "no PNG has no columns");
    }

    #[test]
    fn bytes_there_and_back() {
        let bytes = [10, 200, 30, 255, 0, 0, 0, 0];
        assert_eq!(Image::from_rgba(2, 1, &bytes).to_rgba(), bytes);
    }
}
