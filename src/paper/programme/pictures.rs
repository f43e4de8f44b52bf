//! The paper's pictures: its Figures 4, 5, 6 and 8, made from a run.

use std::path::Path;

use crate::export::read_playback_ends;
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
    let run = read_playback_ends(folder)?;
    let title = "Figure 5: funnel, lid and cylinder";
    let mut pictures = vec![
        grains(&run, "figure-04-grains", "Figure 4: generated grains")?,
        apparatus(&run, "figure-05-apparatus", title)?,
    ];
    pictures.extend(funnel(&run, "figure-06-funnel", "Figure 6: grains in the funnel")?);
    let title = "Figure 8: before and after vibration";
    pictures.extend(vibration(&run, "figure-08-vibration", title)?);
    Ok(pictures)
}
