//! From a sieve table, or from polyhedra, to grains.

use rayon::prelude::*;

use super::meshes::push_laid_out;
use super::spheres::spheres;
use super::*;
use crate::geometry::rounded_within;
use crate::scenario::SievedShape;

/// Makes the grains of a sieve table (paper, section 3): for every fraction a cube of its solid
/// volume, cut into as many Voronoi cells of uniformly random points as the fraction has grains,
/// relaxed and stretched as the scenario asks for. The same table and seed give the same bits. Or,
/// where the scenario asks for them, spheres.
///
/// # Errors
/// The faults of the sieve table ([`ParticleSizeDistribution::new`]).
pub fn generate(spec: &SievedGrains, seed: u64) -> Result<GrainSet, GrainsError> {
    let psd = ParticleSizeDistribution::new(spec)?;
    if spec.shape == SievedShape::Spheres {
        return spheres(&psd, seed);
    }
    let mut set = GrainSet::empty(psd.density);
    let scale = Scale::of_smallest(psd.finest_with_grains(), Scale::PAPER.gravity);
    let merge = scale::MERGE_DISTANCE.at(&scale);
    let mut x = 0.0;
    // Fractions without grains do not count: they change no grain.
    let mut cubes = 0;
    for fraction in &psd.fractions {
        if fraction.grains == 0 {
            push_laid_out(&mut set, (fraction.retained, fraction.passing), Vec::new(), x);
            continue;
        }
        let side = fraction.volume.cbrt();
        let origin = Vector::new(x, 0.0, 0.0);
        let name = format!("points of block {cubes}");
        cubes += 1;
        let tessellation = random_cells(
            fraction.grains,
            &Cube { side, origin, merge },
            &spec.cells,
            (seed, &name),
        )?;
        set.push_block(Block {
            passing: fraction.passing,
            retained: fraction.retained,
            own_sizes: false,
            side,
            origin,
            points: tessellation.points,
            first_grain: 0,
            cells: rounded(tessellation.cells, spec.cells.rounding)?,
        });
        x += side + scale::BLOCK_GAP.at(&scale);
    }
    Ok(set)
}

/// Cells with rounded corners and edges, each about the cell's centroid and of its volume; the cells
/// themselves with a roundness of 0.
///
/// # Errors
/// A cell whose planes, moved inwards, leave no polyhedron.
fn rounded(
    cells: Vec<ConvexPolyhedron>,
    roundness: f64,
) -> Result<Vec<ConvexPolyhedron>, GrainsError> {
    if roundness == 0.0 {
        return Ok(cells);
    }
    let round = |cell: &ConvexPolyhedron| {
        let Rounded { core, radius } = rounded_within(cell, roundness)?;
        let whole = ConvexPolyhedron::of_rounded(core, radius).ok()?;
        let (cell, found) = (MassProperties::of(cell), MassProperties::of(&whole));
        let larger = (cell.volume / found.volume).cbrt();
        let back = Pose::from(-found.centroid.coords);
        let core = whole.rounded()?.core.transformed(&back).scaled(larger);
        let core = core.transformed(&Pose::from(cell.centroid.coords));
        ConvexPolyhedron::of_rounded(core, radius * larger).ok()
    };
    let all: Vec<Option<ConvexPolyhedron>> = cells.par_iter().map(round).collect();
    let count = all.len();
    all.into_iter()
        .enumerate()
        .map(|(cell, shape)| {
            shape.ok_or(GrainsError::NoRoundedCell { cell, cells: count, rounding: roundness })
        })
        .collect()
}

impl GrainSet {
    /// Adds a block and the grains of its cells. Generation and reading from
    /// a file both come through here, so that both give the same grains.
    pub(super) fn push_block(&mut self, mut block: Block) {
        let fraction = self.blocks.len();
        block.first_grain = self.grains.len();
        let density = self.density;
        self.grains.extend(block.cells.iter().map(|cell| Grain::of_cell(cell, density, fraction)));
        self.blocks.push(block);
    }
}

impl Grain {
    /// The grain of a cell in block coordinates (m), of a density in kg/m³,
    /// in the sieve fraction of that index.
    pub fn of_cell(cell: &ConvexPolyhedron, density: f64, fraction: usize) -> Self {
        let properties = MassProperties::of(cell);
        let principal = properties.principal_frame();
        Self {
            shape: Arc::new(cell.transformed(&principal.pose.inverse())),
            pose_in_block: principal.pose,
            volume: properties.volume,
            mass: density * properties.volume,
            inertia: density * principal.moments_per_density,
            equivalent_diameter: (6.0 * properties.volume / std::f64::consts::PI).cbrt(),
            fraction,
        }
    }
}
