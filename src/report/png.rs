//! Pictures as PNG: those that something else has made, and SVG, alike on every machine: the font is
//! part of the program.

use std::{
    path::Path,
    sync::{Arc, OnceLock},
};

use base64::{Engine, prelude::BASE64_STANDARD};
use resvg::{
    tiny_skia::{Pixmap, Transform},
    usvg::{Options, Tree, fontdb},
};

use crate::record::{FileError, create_folder, write_file};

/// A picture with its words.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Name of its file, without extension.
    pub stem: String,
    /// Title.
    pub title: String,
    /// What is shown, what the colours tell, and how it was made.
    pub caption: String,
    /// The picture as PNG.
    pub png: Vec<u8>,
}

impl Picture {
    /// Writes `STEM.png` into a folder, which is made where it is missing.
    ///
    /// # Errors
    /// [`FileError`] naming the file.
    pub fn write(&self, folder: &Path) -> Result<(), FileError> {
        create_folder(folder)?;
        write_file(&folder.join(format!("{}.png", self.stem)), &self.png)
    }

    /// As a page holds it within itself.
    pub(super) fn as_data(&self) -> String {
        format!("data:image/png;base64,{}", BASE64_STANDARD.encode(&self.png))
    }
}

/// DejaVu Sans alone, as the font for every family.
fn fonts() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    FONTS
        .get_or_init(|| {
            let mut fonts = fontdb::Database::new();
            fonts.load_font_data(dejavu::sans::regular().to_vec());
            fonts.set_sans_serif_family("DejaVu Sans");
            Arc::new(fonts)
        })
        .clone()
}

/// Renders an SVG at its own size as PNG.
///
/// # Errors
/// A sentence on what is wrong with the SVG or its size.
pub fn render(svg: &str) -> Result<Vec<u8>, String> {
    pixels(svg)?.encode_png().map_err(|e| e.to_string())
}

/// Draws an SVG at its own size on nothing: width, height, and four bytes a pixel of
/// sRGB with straight alpha.
///
/// # Errors
/// A sentence on what is wrong with the SVG or its size.
pub fn draw(svg: &str) -> Result<(u32, u32, Vec<u8>), String> {
    let pixels = pixels(svg)?;
    Ok((pixels.width(), pixels.height(), pixels.take_demultiplied()))
}

fn pixels(svg: &str) -> Result<Pixmap, String> {
    let options =
        Options { fontdb: fonts(), font_family: "DejaVu Sans".to_owned(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|e| e.to_string())?;
    let size = tree.size().to_int_size();
    let mut pixels = Pixmap::new(size.width(), size.height())
        .ok_or_else(|| format!("no picture of {} × {}", size.width(), size.height()))?;
    resvg::render(&tree, Transform::identity(), &mut pixels.as_mut());
    Ok(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark_pixels(svg: &str) -> usize {
        let png = render(svg).expect("rendered");
        let pixels = Pixmap::decode_png(&png).expect("a PNG");
        assert_eq!((pixels.width(), pixels.height()), (80, 40), "the SVG's own size");
        pixels.pixels().iter().filter(|p| p.red() < 128 && p.alpha() > 128).count()
    }

    #[test]
    fn text_is_drawn_without_fonts_of_the_system() {
        let svg = |text: &str| {
            format!(
                r#"<svg xmlns="http://www.w3.org/2000/svg" width="80" height="40"><rect
                width="80" height="40" fill="white"/><text x="5" y="30" font-size="24"
                font-family="sans-serif">{text}</text></svg>"#
            )
        };
        assert_eq!(dark_pixels(&svg("")), 0, "no text, no ink");
        for text in ["Hg", "−5", "µm", "10⁻⁷"] {
            let ink = dark_pixels(&svg(text));
            assert!(ink > 30, "\"{text}\": expected ink, got {ink} dark pixels");
        }
    }

    #[test]
    fn what_is_no_svg_is_refused() {
        assert!(render("<svg").is_err(), "half a tag is no SVG");
    }
}
