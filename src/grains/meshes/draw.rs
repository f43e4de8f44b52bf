//! Which meshes become grains, at which size, and where they lie in the file.

use rand_pcg::Pcg64;

use super::*;
use crate::grains::psd::MOST_GRAINS;
use crate::grains::streams::{shuffle, stream, uniform};
use crate::grains::{Block, Fraction, GrainSet, ParticleSizeDistribution};
use crate::scale::{self, Scale};
use crate::units::to_g;

/// How far inside its two sieves a grain stays, as a fraction of its size; less where the sieves
/// themselves are nearer to each other.
const INSIDE: f64 = 1e-6;

/// One grain to be: which grain, and how many times its size.
pub(in crate::grains) type Drawn = (usize, f64);

/// Makes the grain set of the grains, and notes how often each was taken.
pub(super) fn draw(
    spec: &MeshGrains,
    seed: u64,
    prototypes: &[Prototype],
    mut records: Vec<MeshRecord>,
) -> Result<GrainSet, Fault> {
    let blocks = plan(spec, seed, prototypes)?;
    for &(prototype, scale) in blocks.iter().flat_map(|(_, drawn)| drawn) {
        records[prototype].take(scale);
    }
    let mut set = laid_out(spec.density_kg_per_m3, &blocks, prototypes);
    let own_sizes = spec.as_sieved().is_none();
    set.blocks.iter_mut().for_each(|block| block.own_sizes = own_sizes);
    Ok(GrainSet { meshes: records, ..set })
}

/// Sieves (retaining and passed, in m) and grains of a block.
pub(in crate::grains) type PlannedBlock = ((f64, f64), Vec<Drawn>);

fn plan(
    spec: &MeshGrains,
    seed: u64,
    prototypes: &[Prototype],
) -> Result<Vec<PlannedBlock>, Fault> {
    let Some(sieved) = spec.as_sieved() else {
        let indices = match spec.count {
            Some(count) => {
                let mut deck = Deck::new(seed, "stones", prototypes.len());
                (0..count).map(|_| deck.draw()).collect()
            }
            None => (0..prototypes.len()).collect::<Vec<usize>>(),
        };
        return Ok(vec![(bracket(prototypes), indices.into_iter().map(|i| (i, 1.0)).collect())]);
    };
    let psd = ParticleSizeDistribution::new(&sieved).map_err(|e| Fault {
        path: "grains.sieve_table".into(),
        message: e.to_string(),
        ..Fault::default()
    })?;
    by_fraction(&psd, seed, "stones", prototypes).map_err(|unfilled| {
        let (index, fault) = *unfilled;
        let path = format!("grains.sieve_table[{index}].mass_percent");
        Fault { path, ..fault }
    })
}

/// Draws the grains of each fraction. `kind` begins the names of the random streams: other names
/// would draw other grains.
///
/// # Errors
/// The number of a fraction whose mass no whole number of grains has, and what is wrong with it.
pub(in crate::grains) fn by_fraction(
    psd: &ParticleSizeDistribution,
    seed: u64,
    kind: &str,
    prototypes: &[Prototype],
) -> Result<Vec<PlannedBlock>, Box<(usize, Fault)>> {
    let mut blocks = Vec::with_capacity(psd.fractions.len());
    let mut grains = 0;
    // Fractions without grains do not count: they change no grain.
    let mut drawn_from = 0;
    for (index, fraction) in psd.fractions.iter().enumerate() {
        let mut drawn = Vec::new();
        if fraction.grains > 0 {
            let name = format!("{kind} of fraction {drawn_from}");
            drawn_from += 1;
            let most = MOST_GRAINS - grains;
            drawn = fill(fraction, psd.density, prototypes, (seed, &name), most)
                .map_err(|fault| Box::new((index, fault)))?;
            grains += drawn.len();
        }
        blocks.push(((fraction.retained, fraction.passing), drawn));
    }
    Ok(blocks)
}

/// A grain set of blocks one beside the other.
pub(in crate::grains) fn laid_out(
    density: f64,
    blocks: &[PlannedBlock],
    prototypes: &[Prototype],
) -> GrainSet {
    let mut set = GrainSet::empty(density);
    let with_grains = blocks.iter().filter(|(_, drawn)| !drawn.is_empty());
    let smallest = with_grains.map(|((retained, _), _)| *retained).fold(f64::INFINITY, f64::min);
    let gap = scale::BLOCK_GAP.at(&Scale::of_smallest(smallest, Scale::PAPER.gravity));
    let mut x = 0.0;
    for (sieves, drawn) in blocks {
        let cells =
            drawn.iter().map(|&(prototype, scale)| prototypes[prototype].shape.scaled(scale));
        let side = push_laid_out(&mut set, *sieves, cells.collect(), x);
        if !drawn.is_empty() {
            x += side + gap;
        }
    }
    set
}

/// Grains in a random order, each once before any comes again.
struct Deck {
    rng: Pcg64,
    order: Vec<usize>,
    next: usize,
}

impl Deck {
    fn new(seed: u64, name: &str, count: usize) -> Self {
        Self { rng: stream(seed, name), order: (0..count).collect(), next: count }
    }

    fn draw(&mut self) -> usize {
        if self.next >= self.order.len() {
            shuffle(&mut self.rng, &mut self.order);
            self.next = 0;
        }
        self.next += 1;
        self.order[self.next - 1]
    }
}

/// Draws grains until their mass is nearest to the fraction's, and scales them
/// so that each stays between the two sieves and together they have that mass.
///
/// Sizes are drawn so that the fraction's curve of mass against the logarithm
/// of size is the straight line it is drawn as: mass goes with size cubed,
/// so by number the density of a size s goes with s⁻⁴.
fn fill(
    fraction: &Fraction,
    density: f64,
    prototypes: &[Prototype],
    (seed, name): (u64, &str),
    most: usize,
) -> Result<Vec<Drawn>, Fault> {
    let inside = INSIDE.min((fraction.passing / fraction.retained - 1.0) / 4.0);
    let (least, largest) = (fraction.retained * (1.0 + inside), fraction.passing * (1.0 - inside));
    let mass = |&(prototype, size): &(usize, f64)| {
        let prototype = &prototypes[prototype];
        density * prototype.volume * (size / prototype.sieve_size).powi(3)
    };
    let fault = |found: String, allowed: &str| {
        let message = "no whole number of grains between these sieves has the mass of the fraction";
        Err(Fault::new(message, found, allowed))
    };
    let inverse_cube = |size: f64| 1.0 / (size * size * size);
    let (fine, coarse) = (inverse_cube(least), inverse_cube(largest));
    let mut deck = Deck::new(seed, name, prototypes.len());
    let mut sizes = stream(seed, &format!("sizes of {name}"));
    let mut next = || {
        let size = 1.0 / (fine + uniform(&mut sizes) * (coarse - fine)).cbrt();
        (deck.draw(), size.clamp(least, largest))
    };
    let mut drawn: Vec<(usize, f64)> = Vec::new();
    let mut total = 0.0;
    while total < fraction.mass {
        if drawn.len() >= most {
            return fault(format!("more than {MOST_GRAINS} grains"), "fewer grains");
        }
        let last = next();
        total += mass(&last);
        drawn.push(last);
    }
    let over = total - fraction.mass;
    let nearest = drawn.len() - usize::from(over > mass(&drawn[drawn.len() - 1]) / 2.0);
    drawn.push(next());
    for count in [nearest, nearest + 1, nearest.saturating_sub(1)] {
        let Some(some) = drawn.get(..count).filter(|some| !some.is_empty()) else { continue };
        let with = |factor: f64| -> f64 {
            some.iter().map(|&(i, s)| mass(&(i, (s * factor).clamp(least, largest)))).sum()
        };
        let (mut low, mut high) = (least / largest, largest / least);
        if !(with(low) <= fraction.mass && fraction.mass <= with(high)) {
            continue;
        }
        // 100 halvings end at neighbouring numbers.
        for _ in 0..100 {
            let middle = f64::midpoint(low, high);
            if with(middle) < fraction.mass { low = middle } else { high = middle }
        }
        let sized = |&(i, s): &(usize, f64)| {
            (i, (s * high).clamp(least, largest) / prototypes[i].sieve_size)
        };
        return Ok(some.iter().map(sized).collect());
    }
    let found = format!("{} g", super::rounded(to_g(fraction.mass)));
    fault(found, "the mass of several grains between these sieves")
}

/// Sieves that grains in their own size lie between: the finest and the
/// coarsest sieve size, made rounder outwards.
fn bracket(prototypes: &[Prototype]) -> (f64, f64) {
    let sizes = || prototypes.iter().map(|s| to_mm(s.sieve_size));
    let least = sizes().fold(f64::INFINITY, f64::min);
    let most = sizes().fold(0.0, f64::max);
    let step = |x: f64| 10_f64.powf(x.log10().floor() - 1.0);
    let down = ((least / step(least)).ceil() - 1.0) * step(least);
    let up = ((most / step(most)).floor() + 1.0) * step(most);
    (from_mm(down), from_mm(up))
}

/// Puts polyhedra, each about its own origin, side by side in a cube that begins at (x, 0, 0), as a
/// block of a set with its sieves (retaining and passed, in m); returns the side of the cube.
pub(in crate::grains) fn push_laid_out(
    set: &mut GrainSet,
    (retained, passing): (f64, f64),
    cells: Vec<ConvexPolyhedron>,
    x: f64,
) -> f64 {
    let radius = cells.iter().map(ConvexPolyhedron::radius_about_origin).fold(0.0, f64::max);
    let pitch = 2.1 * radius;
    let mut rows = 1;
    while rows * rows * rows < cells.len() {
        rows += 1;
    }
    let at = |index: usize| (index as f64 + 0.5) * pitch;
    let placed = cells.iter().enumerate().map(|(i, cell)| {
        let (column, row, layer) = (i % rows, i / rows % rows, i / (rows * rows));
        cell.transformed(&Pose::translation(x + at(column), at(row), at(layer)))
    });
    let side = rows as f64 * pitch;
    set.push_block(Block {
        passing,
        retained,
        own_sizes: false,
        side,
        origin: Vector::new(x, 0.0, 0.0),
        points: Vec::new(),
        first_grain: 0,
        cells: placed.collect(),
    });
    side
}
