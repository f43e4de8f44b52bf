//! The paper's pictures: its Figures 4, 5, 6 and 8, made from a run.

use std::path::Path;

use crate::export::{FramesRead, read_playback};
use crate::picture::{
    PictureError,
    figures::{apparatus, funnel, grains, vibration},
};
use crate::report::Picture;

/// The paper's Figures 4, 5, 6 and 8 from the folder of a run that fills the
/// funnel and vibrates; those that its stages do not give are left out.
///
/// # Errors
/// When the run cannot be read or a picture cannot be drawn.
pub(super) fn of_programme(folder: &Path) -> Result<Vec<Picture>, PictureError> {
    let run = read_playback(folder, FramesRead::Ends, None)?;
    let title = "Figure 5. Funnel, lid and cylinder";
    let mut pictures = vec![
        grains(&run, "figure-04-grains", "Figure 4. Generated grains")?,
        apparatus(&run, "figure-05-apparatus", title)?,
    ];
    pictures.extend(funnel(&run, "figure-06-funnel", "Figure 6. Grains in the funnel")?);
    let title = "Figure 8. Before and after vibration";
    pictures.extend(vibration(&run, "figure-08-vibration", title)?.map(with_the_paper_s_views));
    Ok(pictures)
}

/// A picture of the specimen before and after vibration that says which of its views the paper has.
fn with_the_paper_s_views(picture: Picture) -> Picture {
    let views = "The paper shows the specimen as (a) and (b) do in its 8(c) and 8(d).";
    Picture { caption: format!("{} {views}", picture.caption), ..picture }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: the caption of the programme's picture names the paper's views after what it shows.
    #[test]
    fn the_paper_s_views_are_named() {
        let caption = "Before and after.".to_owned();
        let of_any_run = Picture { stem: "s".into(), title: "t".into(), caption, png: vec![1] };
        let got = with_the_paper_s_views(of_any_run);
        let begins = got.caption.starts_with("Before and after. The paper shows");
        assert!(begins && got.caption.contains("8(c) and 8(d)"), "got {}", got.caption);
        assert_eq!((got.stem.as_str(), got.png), ("s", vec![1]), "law: all else is as it was");
    }
}
