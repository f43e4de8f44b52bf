//! What is published of the rows: where it was seen, and whether a row is judged by it.
//!
//! *Seen* is said of what stood in front of us, with its address; what is not checked against a
//! source judges nothing. `--judge` applies this file to kept rows.

/// Where a published number comes from, and what follows from that.
pub struct Reference {
    /// Where it was seen, with what was seen; or that it was not.
    pub source: String,
    /// Whether the row is judged by it.
    pub is_judged: bool,
    /// Half the width that the interval may have for the row to be *within* a single value.
    pub widest: Option<f64>,
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
const NOT_CRITICAL: &str = "none is published of this state: the lid still rises (dilation at the \
    end), so that it is not the critical state. Of that, φ = 42° − 17° R (Cho, Dodds & Santamarina \
    2006, roundness R) is not checked against a source, not judged by";
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
    \"independent of stress path, sample preparation method and initial density\". Both specimens \
    still dilate at the end, so that it is not the critical state: not judged by";
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
const OWN: &str = "our own check; none is published";
const NONE: &str = "none is published for these grains";
const OEDOMETER: &str = "no number was seen that this could be compared with";

/// How far a void ratio may be from a published one.
pub const VOID_RATIO: f64 = 0.05;

/// The reference of a row.
pub fn of(id: &str) -> Reference {
    let seen = |source: &str| (source.to_owned(), true, None::<f64>);
    let unseen = |source: &str| (source.to_owned(), false, None::<f64>);
    let table = |row: &str, value: f64| {
        seen(&format!("{TABLE}: {row}: {value}. ± {VOID_RATIO} is our choice"))
    };
    let (source, is_judged, widest) = match id {
        "hopper-exponent"
        | "hopper-exponent-at-k"
        | "hopper-spheres-exponent"
        | "hopper-spheres-exponent-at-k" => seen(EXPONENT),
        "hopper-c" => unseen(&format!("{C}. {OTHER_C}")),
        "hopper-spheres-c" => seen(C),
        "hopper-k" | "hopper-spheres-k" => unseen(K),
        "density-basalt-e-max" => table(BASALT, 1.257),
        "density-basalt-e-min" => table(BASALT, 0.705),
        "density-gravel-e-max" => table(GRAVEL, 0.774),
        "density-gravel-e-min" => table(GRAVEL, 0.546),
        "density-basalt-range" | "density-gravel-range" => {
            unseen("follows from the two published void ratios, by which their rows are judged")
        }
        "direct-shear-peak" => unseen(PEAK),
        "direct-shear-end" => unseen(NOT_CRITICAL),
        "triaxial-end-difference" | "triaxial-ratio-difference" => unseen(ONE_STATE),
        "triaxial-angle-loose" | "triaxial-angle-dense" => unseen(CRITICAL),
        "oedometer-came-back"
        | "oedometer-compression-index"
        | "oedometer-swelling-index"
        | "oedometer-swelling-index-stiffer" => unseen(OEDOMETER),
        "oedometer-springs" | "oedometer-again" => unseen(OWN),
        _ if id.starts_with("column-run-out-") => seen(RUN_OUT),
        _ if id.starts_with("repose-") => unseen(REPOSE),
        _ if id.starts_with("beads-") => unseen(BEADS),
        _ if id.starts_with("direct-shear-roundness-") => unseen(ROUNDER),
        _ if id.starts_with("direct-shear-rate-") || id.starts_with("direct-shear-stiffness-") => {
            unseen(OWN)
        }
        _ => unseen(NONE),
    };
    Reference { source, is_judged, widest }
}
