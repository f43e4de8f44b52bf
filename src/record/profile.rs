//! `void_profile.csv`: void ratio by height and by radius.

use serde::Serialize;

/// A layer or a ring.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProfileRow {
    /// `specimen` of the built-in cylinder, or the name of a region.
    pub of: String,
    /// `height` of layers, `radius` of rings.
    pub by: &'static str,
    /// Where it begins in mm.
    pub from_mm: f64,
    /// Where it ends in mm.
    pub to_mm: f64,
    /// Volume of voids over that of solids; empty where no grain is.
    pub void_ratio: Option<f64>,
    /// Volume of solids in it in mm³.
    pub solids_mm3: f64,
}
