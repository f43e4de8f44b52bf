//! What is published of the rows: where it was seen, and whether a row is judged by it.
//!
//! *Seen* is said of what stood in front of us, with its address; what is not checked against a
//! source judges nothing. `--judge` applies this file to kept rows.

use serde::{Deserialize, Serialize};

/// What is published.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Published {
    /// From one value to another.
    Range { low: f64, high: f64 },
    /// One value.
    Value { value: f64 },
}

/// What stands beside a row as published.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stated {
    /// Nothing.
    Nothing,
    /// The same, whatever was measured.
    Known(Published),
    /// What the row holds: a law at a value that was measured, too.
    OfTheRow,
}

/// Where a published number comes from, and what follows from that.
pub struct Reference {
    /// The number.
    pub stated: Stated,
    /// Where it was seen, with what was seen; or that it was not.
    pub source: String,
    /// Whether the row is judged by it: by a range; a single value has no ends, and judges none.
    pub is_judged: bool,
}

const EXPONENT: &str = "Mankoc et al. 2007, abstract and introduction seen at \
    ar5iv.labs.arxiv.org/html/0707.4550: the flow rate \"is known to be dependent on its diameter \
    to a 5/2 power law\", the law of Beverloo et al. 1961, which was not seen. ± 0.1 is our choice";
const C: &str = "0.55 to 0.65 with the bulk density: Mankoc et al. 2007, equation 1, as quoted in \
    the specifications of github.com/fsantibanezleal/PitStudio; of the paper itself the beginning \
    was seen (ar5iv.labs.arxiv.org/html/0707.4550), which does not reach to the number. The line \
    in the figure, C = 0.58 and k = 1.4, is Beverloo et al. 1961 and Nedderman et al. 1982 as \
    quoted in github.com/rochi00/moose, modules/dem/doc/content/validation.md";
const K: &str = "1 to 2: not checked against a source, not judged by. Seen: k = 1.4, Beverloo et al. \
    1961 and Nedderman et al. 1982 as quoted in github.com/rochi00/moose, \
    modules/dem/doc/content/validation.md";
const OTHER_C: &str = "Of beads, and ours are angular grains: not judged by";
const RUN_OUT: &str = "Lube et al. 2004, J. Fluid Mech. 508: (r∞ − r₀)/r₀ = 1.24 a below a = 1.7, \
    1.6 √a above, as quoted in github.com/rochi00/moose, modules/dem/doc/content/validation.md. \
    The paper itself was not seen, and so not how it reads r∞. ± 15 % is our choice";
const REPOSE: &str = "Izadi & Bezuijen 2014, section 3, text seen: the tangent of 38.40° is taken \
    as the friction coefficient. No source was seen that gives one for an angle measured by this \
    method: not judged by";
const PEAK: &str = "FHWA-HRT-13-068 (2013): of AASHTO No. 8 aggregates from five sources \"highest \
    and lowest peak friction angle measured at 55° and 43°\", seen only as an excerpt; its \
    beginning was seen at \
    fhwa.dot.gov/publications/research/infrastructure/structures/bridge/13068/index.cfm. \
    Geo-Congress 2014, pp. 47-53, abstract seen at trid.trb.org/view/1303095: \"uncompacted \
    open-graded aggregates are all greater than 45 degrees\". Other grains than ours: not judged \
    by";
const NOT_CRITICAL: &str = "none is published of this state: where the lid still rises (dilation \
    at the end) it is not the critical state. Of that, φ = 42° − 17° R (Cho, Dodds & Santamarina \
    2006, roundness R) is not checked against a source, not judged by";
const WORK: &str = "an estimate of the critical state's angle before it is reached: the work equation \
    of Taylor 1948, from memory, not judged by. Nor is φ = 42° − 17° R (Cho, Dodds & Santamarina \
    2006, roundness R), which is not checked against a source";
const FAR: &str = "none is published of this box. Dołżyk-Szypcio 2019, Int. J. Civ. Eng., abstract \
    seen at scribd.com/document/550894597: a large direct shear box, \"critical frictional state \
    angle Φ° = 41.2° of tested coarse granular soil is independent of soil moisture and \
    compaction\": an angle of frictional state theory, not of τ/σ in a box, and of another soil. On \
    how far a box goes: \"Take readings until the limit of travel of the shear box is reached\", AS \
    1289.6.2.2:2020, 7.1.2, seen at xxhh8.cn/as-1289-6-2-2-2020-pdf-free-download.html; that ASTM \
    D3080 asks for at least a tenth of the width is from memory";
const FAR_DILATION: &str = "0° is what the critical state is defined by, \"the ultimate state at \
    which a soil continues to deform at constant stress and constant void ratio\": Roscoe et al. \
    1958 as quoted in The Scientific World Journal 2014, 290207, Table 1, seen at \
    hindawi.com/journals/tswj/2014/290207/tab1; a test that ends before it is not judged by it";
const ROUNDER: &str = "Cho, Dodds & Santamarina 2006, abstract of the manuscript seen at \
    vi.scribd.com/document/294689621: particle irregularity leads to \"an increase in critical \
    state friction angle\"; by how much was not seen";
const CRITICAL: &str = "φ = 42° − 17° R of Cho, Dodds & Santamarina 2006, with roundness R of 0.1 \
    to 0.3: not checked against a source, not judged by. Seen: the abstract of the manuscript, \
    vi.scribd.com/document/294689621, by which the angle rises with angularity";
const ONE_STATE: &str = "Casagrande 1940 as quoted in The Scientific World Journal 2014, 290207, \
    Table 1, seen at hindawi.com/journals/tswj/2014/290207/tab1: \"the same void ratio where \
    contracted loose soil and dilated dense soil approach after sheared to large strains\"; Been \
    et al. 1991, abstract seen at scribd.com/document/423343571: the critical state of a sand is \
    \"independent of stress path, sample preparation method and initial density\". Specimens whose \
    void ratio still changes at the end (its rows say by how much) are not at the critical state: \
    not judged by";
const BEADS: &str = "Izadi & Bezuijen 2018, PLoS ONE 13(4), e0195073, abstract seen at \
    journals.plos.org/plosone/article?id=10.1371/journal.pone.0195073: uniform-sized metal beads \
    in the laboratory and with Bullet, \"the difference in the average angle of mobilized \
    frictions was found to be only 1.0°\". How large the angles are was not seen; size of box and \
    beads not checked against a source";
const TABLE: &str = "Mathematical Problems in Engineering 2021, 5092612, Table 1, seen at \
    preview.hindawi.com/journals/mpe/2021/5092612/tab1";
const BASALT: &str = "CB-Mix-No. 1, two halves of 0.50 to 0.70 and 0.70 to 1.00 mm, roundness 0.19";
const GRAVEL: &str = "G2-8, 7.49 to 19.21 mm in four fractions of roundness 0.59, 0.59, 0.41 and \
    0.30, coarse to fine";
const BY_ITS_STATES: &str =
    "follows from the two published void ratios, by which their rows are judged";
const TRIED: &str = "as in the row of these grains without the change: a try of what may explain \
    its miss, not judged. Aggregates count as equidimensional with ratios of their axes \"above \
    about 0.6\"; \"flaky particles with high aspect ratios of the same grading can have much more \
    space between the particles\": Encyclopedia of Geology 2005, Aggregates, seen at \
    123docz.net/document/11561486-encyclopedia-of-geology-five-volume-set-volume-1-5-\
    encyclopedia-of-geology-series-pdfdrive-77.htm. No source was seen with the axes of such \
    grains or their friction";
const OWN: &str = "our own check; none is published";
const NONE: &str = "none is published for these grains";
const OEDOMETER: &str = "no number was seen that this could be compared with";

/// How far a void ratio may be from a published one.
pub const VOID_RATIO: f64 = 0.05;
/// Published void ratios of the loosest and the densest state.
pub const BASALT_STATES: (f64, f64) = (1.257, 0.705);
pub const GRAVEL_STATES: (f64, f64) = (0.774, 0.546);

/// The reference of a row.
pub fn of(id: &str) -> Reference {
    let range = |low, high| Stated::Known(Published::Range { low, high });
    let value = |value| Stated::Known(Published::Value { value });
    let about = |value: f64| range(value - VOID_RATIO, value + VOID_RATIO);
    let seen = |stated, source: &str| (stated, source.to_owned(), true);
    let unseen = |stated, source: &str| (stated, source.to_owned(), false);
    let table = |row: &str, value: f64| {
        seen(about(value), &format!("{TABLE}: {row}: {value}. ± {VOID_RATIO} is our choice"))
    };
    let apart = |(e_max, e_min): (f64, f64)| unseen(value(e_max - e_min), BY_ITS_STATES);
    let (stated, source, is_judged) = match id {
        "hopper-exponent"
        | "hopper-exponent-at-k"
        | "hopper-spheres-exponent"
        | "hopper-spheres-exponent-at-k" => seen(range(2.4, 2.6), EXPONENT),
        "hopper-c" => unseen(range(0.55, 0.65), &format!("{C}. {OTHER_C}")),
        "hopper-spheres-c" => seen(range(0.55, 0.65), C),
        "hopper-k" | "hopper-spheres-k" => unseen(range(1.0, 2.0), K),
        "density-basalt-e-max" => table(BASALT, BASALT_STATES.0),
        "density-basalt-e-min" => table(BASALT, BASALT_STATES.1),
        "density-gravel-e-max" => table(GRAVEL, GRAVEL_STATES.0),
        "density-gravel-e-min" => table(GRAVEL, GRAVEL_STATES.1),
        "density-basalt-range" => apart(BASALT_STATES),
        "density-gravel-range" => apart(GRAVEL_STATES),
        "direct-shear-peak" => unseen(range(43.0, 55.0), PEAK),
        "direct-shear-end" => unseen(Stated::Nothing, NOT_CRITICAL),
        "direct-shear-friction" => unseen(Stated::Nothing, WORK),
        "direct-shear-far-end" => unseen(Stated::Nothing, FAR),
        "direct-shear-far-dilation-end" => unseen(value(0.0), FAR_DILATION),
        "triaxial-end-difference"
        | "triaxial-end-plates"
        | "triaxial-ratio-difference"
        | "triaxial-ratio-plates" => unseen(value(0.0), ONE_STATE),
        "triaxial-angle-loose" | "triaxial-angle-dense" => unseen(range(36.9, 40.3), CRITICAL),
        "oedometer-came-back"
        | "oedometer-compression-index"
        | "oedometer-swelling-index"
        | "oedometer-swelling-index-stiffer" => unseen(Stated::Nothing, OEDOMETER),
        "oedometer-springs" | "oedometer-again" => unseen(Stated::Nothing, OWN),
        // With a change that is only tried, whatever it is called.
        _ if id.starts_with("density-basalt-") && id.ends_with("-e-max") => {
            unseen(about(BASALT_STATES.0), TRIED)
        }
        _ if id.starts_with("density-basalt-") && id.ends_with("-e-min") => {
            unseen(about(BASALT_STATES.1), TRIED)
        }
        _ if id.starts_with("density-gravel-") && id.ends_with("-e-max") => {
            unseen(about(GRAVEL_STATES.0), TRIED)
        }
        _ if id.starts_with("density-gravel-") && id.ends_with("-e-min") => {
            unseen(about(GRAVEL_STATES.1), TRIED)
        }
        _ if id.starts_with("column-run-out-") => seen(Stated::OfTheRow, RUN_OUT),
        _ if id.starts_with("repose-") => unseen(value(0.793), REPOSE),
        _ if id.starts_with("beads-") => unseen(Stated::Nothing, BEADS),
        _ if id.starts_with("direct-shear-roundness-") => unseen(Stated::Nothing, ROUNDER),
        _ if id.starts_with("direct-shear-rate-") || id.starts_with("direct-shear-stiffness-") => {
            unseen(Stated::Nothing, OWN)
        }
        _ => unseen(Stated::Nothing, NONE),
    };
    Reference { stated, source, is_judged }
}
