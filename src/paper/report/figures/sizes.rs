//! Figure 1: the grain size distribution.

use crate::{
    paper::StudyView,
    report::{Figure, ReportError, figures::grains::curves, text::gradation_in_words},
};

/// As specified and as generated.
pub(super) fn figure(study: &StudyView) -> Result<Figure, ReportError> {
    let made = study.generated.as_ref().map_or_else(String::new, |made| {
        format!(
            " The grains generated from it, each through the virtual sieve (the smallest square \
             opening that it passes in any orientation): {}.",
            gradation_in_words(made)
        )
    });
    let caption = format!(
        "Grain size distribution of the simulated gravel, as specified: {}.{made} The paper's \
         curve was not available to us (only its text was); the specified one is ours, chosen so \
         that the numbers of the text (1456 grains of 2343 g, 55 to 65 in 100 g, poorly graded) \
         come out.",
        gradation_in_words(&study.gradation),
    );
    let (stem, title) = ("figure-01-grain-size-distribution", "Figure 1. Grain size distribution");
    curves(stem, title, caption, [&study.sieve, &study.sieved_grains])
}
