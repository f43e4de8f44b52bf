//! What can go wrong in making, reading and placing grains.

use super::*;

/// What can go wrong in making, reading and placing grains.
#[derive(Debug, thiserror::Error)]
pub enum GrainsError {
    /// A quantity is not a positive finite number.
    #[error("{what} is {value}, it must be a positive finite number")]
    NotPositive {
        /// The quantity, with its unit.
        what: String,
        /// The value given.
        value: f64,
    },
    /// A row of the sieve table contradicts itself or its neighbour.
    #[error("sieve table, row {row}: {reason}")]
    BadSieveTable {
        /// Row, counted from 1.
        row: usize,
        /// What is wrong.
        reason: String,
    },
    /// The sieve table has no rows.
    #[error("the sieve table has no rows")]
    EmptySieveTable,
    /// The mass percentages do not add up, but to this.
    #[error("the mass percentages of the sieve table add up to {0}, not to 100")]
    PercentSum(f64),
    /// A fraction's mass is less than half a grain.
    #[error(
        "the fraction {retained_mm}-{passing_mm} mm holds {volume_cm3:.4} cm³ of solids, which is \
         less than half a grain of its mean size: raise its mass or leave it out"
    )]
    EmptyFraction {
        /// Opening of the sieve it passes, in mm.
        passing_mm: f64,
        /// Opening of the sieve that retains it, in mm.
        retained_mm: f64,
        /// Its solid volume in cm³.
        volume_cm3: f64,
    },
    /// More grains than the program is made for.
    #[error("the sieve table asks for {grains} grains, at most {limit} are possible")]
    TooManyGrains {
        /// Number asked for.
        grains: f64,
        /// Largest number possible.
        limit: usize,
    },
    /// A cell that cannot be rounded.
    #[error(
        "cell {cell} of a block of {cells} cannot be rounded: moved inwards by {rounding} times the \
         radius of its largest inner sphere, its planes leave no polyhedron that can be meshed; a \
         larger `rounding`, a smaller `flatness` or another seed may leave one"
    )]
    NoRoundedCell {
        /// Index of the cell.
        cell: usize,
        /// Cells of its block.
        cells: usize,
        /// The roundness asked for.
        rounding: f64,
    },
    /// Points that no tessellation can be made from.
    #[error("point {point} of the tessellation {reason}")]
    BadPoint {
        /// Index of the point.
        point: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A tessellation that panicked, with what it said.
    #[error("the points of a block cannot be tessellated: {0}")]
    NoTessellation(String),
    /// A cell of the tessellation is no valid polyhedron.
    #[error("cell {cell} of the tessellation is invalid: {source}")]
    BadCell {
        /// Index of the cell.
        cell: usize,
        /// What is wrong with it.
        source: PolyhedronError,
    },
    /// The cells of a block do not fill it.
    #[error("the cells of a block of {block_m3:e} m³ hold {cells_m3:e} m³: the tessellation leaks")]
    VolumeLost {
        /// Volume of the block in m³.
        block_m3: f64,
        /// Volume of its cells in m³.
        cells_m3: f64,
    },
    /// A grain read from a file is no valid polyhedron.
    #[error("block {block}, cell {cell}: {source}")]
    BadShape {
        /// Index of the block in the file.
        block: usize,
        /// Index of the cell in the block.
        cell: usize,
        /// What is wrong with it.
        source: PolyhedronError,
    },
    /// A stated property of a grain contradicts its mesh.
    #[error(
        "block {block}, cell {cell}: the file states {property} {stated:e}, its mesh gives \
         {computed:e} (they may differ by {tolerance:e})"
    )]
    Contradiction {
        /// Index of the block in the file.
        block: usize,
        /// Index of the cell in the block.
        cell: usize,
        /// The property, with its unit.
        property: &'static str,
        /// Value in the file.
        stated: f64,
        /// Value from the mesh.
        computed: f64,
        /// Largest difference accepted.
        tolerance: f64,
    },
    /// Something about a whole block of a file is wrong.
    #[error("block {block}: {reason}")]
    BadBlock {
        /// Index of the block in the file.
        block: usize,
        /// What is wrong.
        reason: String,
    },
    /// The file holds no grains.
    #[error("there are no grains")]
    NoGrains,
    /// A grain does not fit into the region where it should be placed.
    #[error(
        "{} needs a sphere of radius {radius_m} m, the region's radius is {region_m} m",
        grain_name(*grain)
    )]
    DoesNotFit {
        /// Index of the grain.
        grain: usize,
        /// Radius of its bounding sphere with clearance, in m.
        radius_m: f64,
        /// Radius of the region in m.
        region_m: f64,
    },
    /// A realisation that is no permutation of this number of grains.
    #[error("the realisation is not a permutation of the {0} grains")]
    ForeignRealisation(usize),
    /// Text that is no `grains.json`.
    #[error("not a grains.json: {0}")]
    Json(#[from] serde_json::Error),
    /// A file could not be read or written.
    #[error("reading or writing grains failed: {0}")]
    Io(#[from] std::io::Error),
    /// A CSV table could not be written.
    #[error("writing a table of grains failed: {0}")]
    Csv(#[from] csv::Error),
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: it is flat cells with little rounding that fail, so less rounding is no advice.
    #[test]
    fn a_cell_that_cannot_be_rounded_names_what_helps() {
        let error = GrainsError::NoRoundedCell { cell: 3, cells: 20, rounding: 0.01 };
        let got = error.to_string();
        for expected in ["cell 3", "larger `rounding`", "smaller `flatness`", "another seed"] {
            assert!(got.contains(expected), "law: expected `{expected}`, got `{got}`");
        }
    }
}
