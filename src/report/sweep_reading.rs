//! How the page of a sweep is read.

use super::*;

const HOW_TO_READ: &str = "Every point is run in the same realisations, each a new random \
     arrangement of the same grains. Intervals are 95 % confidence intervals of the mean over \
     realisations, by Student's t; sweep.json has those of the bootstrap as well. A change for \
     one unit is the slope of a line through each realisation's own results, its mean and \
     interval over realisations; where one field at a time is varied, it is the change from the \
     least to the largest value, over their distance; where values were drawn from ranges, it is \
     the coefficient in a linear model of all of them. Factors that change together in all runs cannot be told apart: \
     none of them has a change of its own. Numbers of seed and configuration only name realisations: nothing \
     changes for one unit of them, and their points differ by chance. The test by ranks (Page 1963) \
     asks whether results rise or fall from value to value without assuming a line, either of them \
     (two-sided). A run is valid if it meets the accuracy standard, \
     no run-time check found anything, and grains had settled where heights are read. Means and \
     effects leave out runs that are not valid, \
     and runs of which too many grains are missing (docs/accuracy.md); each point says how many. \
     Where others withhold a result, its mean says over how many runs it is. \
     Realisations needed: the number that would show a slope of this size among this scatter with \
     a probability of 80 %, where at least three were run. Every run stands in sweep.csv, the \
     scenario that all of them share in scenario.json, the numbers of this page in sweep.json.";

/// What is added where specimens are the realisations.
const OF_SPECIMENS: &str = "The runs of a point begin with specimens that were made alike but for \
     seed and configuration: these specimens are its realisations, and what is said of \
     realisations is said of them. Their numbers and names are the columns configuration and \
     begin.specimen of sweep.csv; a point is called after the first of its runs.";

/// What a reader of the page must know.
pub(super) fn how_to_read(of: &Sweep) -> Vec<Block> {
    let of_specimens = (!of.specimens.is_empty()).then_some(OF_SPECIMENS);
    let said = of_specimens.into_iter().chain([HOW_TO_READ]);
    said.map(|said| Block::Text(said.to_owned())).collect()
}
