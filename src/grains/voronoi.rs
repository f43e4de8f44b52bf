//! Voronoi cells of points in a cube, as closed convex polyhedra.

use meshless_voronoi::{Dimensionality, VoronoiIntegrator};

use super::*;
use crate::caught::caught;

/// Relative loss of volume above which a tessellation is rejected; rounding leaves about 1e-14.
const VOLUME_TOLERANCE: f64 = 1e-9;

/// How often a block's points are drawn anew when their cells come out
/// degenerate. No draw in some 10⁵ cells needed it.
const ATTEMPTS: u32 = 8;

/// A cube that is cut into cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cube {
    /// Length of its sides in m.
    pub side: f64,
    /// Its lowest corner in m.
    pub origin: Vector,
    /// Edges of cells up to this length in m are merged to a point where the cells
    /// stay convex ([`crate::scale::MERGE_DISTANCE`]).
    pub merge: f64,
}

/// Points in a cube and their Voronoi cells, in the same order.
#[derive(Debug, Clone, PartialEq)]
pub struct Tessellation {
    /// Points in m.
    pub points: Vec<Vector>,
    /// Cells in m.
    pub cells: Vec<ConvexPolyhedron>,
}

/// Cuts a cube into the Voronoi cells of uniformly random points, drawn from
/// the random stream `name`, or of what became of them by relaxation, in a
/// space stretched as the shape of the cells asks for.
///
/// # Errors
/// A side that is not positive; the last attempt's fault, if every attempt gave degenerate cells.
pub fn random_cells(
    count: usize,
    cube: &Cube,
    shape: &CellShape,
    (seed, name): (u64, &str),
) -> Result<Tessellation, GrainsError> {
    let sides = box_sides(shape);
    let mut attempt = 0;
    loop {
        let mut rng = match attempt {
            0 => stream(seed, name),
            n => stream(seed, &format!("{name}, attempt {n}")),
        };
        attempt += 1;
        let made = relaxed(random_points(count, &mut rng), sides, shape.relaxation_steps)
            .and_then(|points| Ok((stretched_cells(&points, sides, cube)?, points)));
        match made {
            Ok((cells, points)) => {
                let points = points.iter().map(|p| cube.origin + p * cube.side).collect();
                return Ok(Tessellation { points, cells });
            }
            Err(error @ (GrainsError::NotPositive { .. } | GrainsError::NoGrains)) => {
                return Err(error);
            }
            Err(error) if attempt == ATTEMPTS => return Err(error),
            Err(error) => tracing::debug!(%error, name, attempt, "points drawn anew"),
        }
    }
}

fn random_points(count: usize, rng: &mut Pcg64) -> Vec<Vector> {
    (0..count).map(|_| Vector::from_fn(|_, _| uniform(rng))).collect()
}

/// The Voronoi cells of points in a box of the given sides, mapped to a cube; the points are given
/// in units of the cube's side, 0 to 1. Nearly coincident vertices are merged.
///
/// # Errors
/// No points, points outside the cube or nearer to each other than 1e-9 of
/// its side, and cells that are no convex polyhedra or do not fill the cube.
fn stretched_cells(
    points: &[Vector],
    sides: Vector,
    &Cube { side, origin, merge }: &Cube,
) -> Result<Vec<ConvexPolyhedron>, GrainsError> {
    positive("side of a block, m", side)?;
    check_points(points)?;
    let complex = caught(|| tessellate(points, sides, side, origin));
    let mut complex = complex.map_err(GrainsError::NoTessellation)?;
    complex.merge_short_edges(merge);
    let cells = complex.into_polyhedra()?;
    let cells_m3: f64 = cells.iter().map(ConvexPolyhedron::signed_volume).sum();
    let block_m3 = side.powi(3);
    let lost = (cells_m3 - block_m3).abs();
    if !lost.is_finite() || lost > VOLUME_TOLERANCE * block_m3 {
        return Err(GrainsError::VolumeLost { block_m3, cells_m3 });
    }
    Ok(cells)
}

/// Computes the cells in a box that fits the unit cube, where the tessellation's absolute
/// error bounds (1e-13) fit, and scales them.
///
/// A Voronoi vertex is named by the four things equally far from it: points,
/// or sides of the cube. Cells that share it compute it independently; by its
/// name they agree, and the position is the one of the first cell.
fn tessellate(points: &[Vector], sides: Vector, side: f64, origin: Vector) -> CellComplex {
    // `into`: the vector type belongs to a crate that is not re-exported.
    let generators: Vec<_> =
        points.iter().map(|p| [p.x * sides.x, p.y * sides.y, p.z * sides.z].into()).collect();
    let tessellation = VoronoiIntegrator::build(
        &generators,
        None,
        [0.0; 3].into(),
        [sides.x, sides.y, sides.z].into(),
        Dimensionality::ThreeD,
        false,
    )
    .with_faces();

    let mut number_of: HashMap<[usize; 4], u32> = HashMap::new();
    let mut vertices = Vec::new();
    let mut cells = Vec::with_capacity(points.len());
    for cell in tessellation.cells_iter() {
        let numbers: Vec<u32> = cell
            .vertices
            .iter()
            .map(|vertex| {
                let [i, j, k] = vertex.dual.map(|plane| {
                    cell.clipping_planes[plane].right_idx.unwrap_or(points.len() + plane)
                });
                let mut name = [cell.idx, i, j, k];
                name.sort_unstable();
                *number_of.entry(name).or_insert_with(|| {
                    let loc = [vertex.loc.x, vertex.loc.y, vertex.loc.z];
                    let at = Vector::from(loc).component_div(&sides).into();
                    let on = vertex.dual.iter().filter(|&&plane| plane < 6);
                    vertices.push(place(at, on.copied(), side, origin));
                    vertices.len() as u32 - 1
                })
            })
            .collect();
        let mut faces: Vec<Vec<u32>> = (0..cell.face_count())
            .map(|face| cell.face_vertices(face).iter().map(|&v| numbers[v]).collect())
            .collect();
        let at = |v: u32| vertices[v as usize].position;
        let first = at(faces[0][0]);
        // Then they run the wrong way round.
        if volume_of_loops(&faces, |v| at(v) - first) < 0.0 {
            faces.iter_mut().for_each(|face| face.reverse());
        }
        cells.push(faces);
    }
    CellComplex::new(vertices, cells)
}

/// Scales a vertex from the unit cube, putting it exactly on the sides it lies on. The cube's sides
/// are numbered x = 0, x = 1, y = 0, ... as the first six clipping planes of every cell are.
fn place(
    mut at: [f64; 3],
    on: impl Iterator<Item = usize>,
    side: f64,
    origin: Vector,
) -> SharedVertex {
    let mut sides = 0;
    for plane in on {
        at[plane / 2] = (plane % 2) as f64;
        sides |= 1 << plane;
    }
    SharedVertex { position: Point::from(origin + Vector::from(at) * side), sides }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const MERGE: f64 = 1e-6;

    fn cube(side: f64, origin: Vector) -> Cube {
        Cube { side, origin, merge: MERGE }
    }

    fn cells(points: &[Vector], cube: &Cube) -> Result<Vec<ConvexPolyhedron>, GrainsError> {
        stretched_cells(points, Vector::repeat(1.0), cube)
    }

    fn check(cells: &[ConvexPolyhedron], side: f64) -> Result<(), String> {
        for (i, cell) in cells.iter().enumerate() {
            cell.sanity_check().map_err(|e| format!("cell {i}: {e}"))?;
        }
        let (got, expected) =
            (cells.iter().map(ConvexPolyhedron::signed_volume).sum::<f64>(), side.powi(3));
        if (got - expected).abs() > 1e-12 * expected {
            return Err(format!("cells fill the block: expected {expected:e} m³, got {got:e}"));
        }
        Ok(())
    }

    fn shortest_edge(cell: &ConvexPolyhedron) -> f64 {
        let at = |v: u32| cell.vertices()[v as usize];
        cell.edges().iter().map(|&(a, b)| (at(a) - at(b)).norm()).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_helper_can_fail() {
        let unit = |side| ConvexPolyhedron::cuboid(Vector::repeat(side)).unwrap();
        assert!(check(&[unit(1.0)], 1.0).is_ok());
        assert!(check(&[unit(1.0 + 1e-11)], 1.0).is_err(), "too large");
        assert!(check(&[unit(1.0 - 1e-11)], 1.0).is_err(), "too small");
    }

    #[test]
    fn one_point_gives_the_cube_and_two_give_its_halves() {
        let origin = Vector::new(0.3, -0.1, 0.2);
        let one = cells(&[Vector::repeat(0.5)], &cube(0.02, origin)).unwrap();
        assert_eq!((one[0].vertices().len(), one[0].faces().len()), (8, 6), "a cube");
        check(&one, 0.02).unwrap();
        let halves =
            cells(&[Vector::new(0.25, 0.5, 0.5), Vector::new(0.75, 0.5, 0.5)], &cube(0.02, origin))
                .unwrap();
        check(&halves, 0.02).unwrap();
        for (half, low) in halves.iter().zip([0.3, 0.31]) {
            let (lo, hi) = half.bounding_box();
            assert!(
                (lo.x - low).abs() < 1e-15 && (hi.x - low - 0.01).abs() < 1e-15,
                "half from x = {low} to {}: got {} to {}",
                low + 0.01,
                lo.x,
                hi.x
            );
        }
    }

    #[test]
    fn every_place_belongs_to_the_nearest_point() {
        // The law that defines the tessellation, at places drawn at random.
        let tessellation = {
            let origin = Vector::new(0.1, 0.0, 0.0);
            random_cells(60, &cube(0.04, origin), &CellShape::default(), (11, "law")).unwrap()
        };
        let mut rng = stream(12, "places");
        for _ in 0..300 {
            let place = Vector::new(0.1, 0.0, 0.0) + random_points(1, &mut rng)[0] * 0.04;
            let distance = |i: &usize| (tessellation.points[*i] - place).norm();
            let nearest = (0..60).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
            let cell = &tessellation.cells[nearest];
            let outside = (0..cell.faces().len())
                .map(|f| cell.plane(f).unwrap())
                .map(|(normal, offset)| normal.dot(&place) - offset)
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(
                outside < MERGE,
                "place {place:?} is nearest to point {nearest}, but {outside:e} m outside its cell"
            );
        }
    }

    #[test]
    fn regular_grids_of_points_are_no_obstacle() {
        // Eight points are equally far from every vertex: the tie of all ties.
        let n = 4;
        let points: Vec<Vector> = (0..n * n * n)
            .map(|i| {
                let index = [i % n, i / n % n, i / n / n];
                Vector::from(index.map(|k| (k as f64 + 0.5) / n as f64))
            })
            .collect();
        let cells = cells(&points, &cube(0.04, Vector::zeros())).unwrap();
        check(&cells, 0.04).unwrap();
        for cell in &cells {
            let got = cell.signed_volume();
            assert!((got - 1e-6).abs() < 1e-18, "each cell is a 1 cm cube, got {got:e} m³");
        }
    }

    /// Law: steps after relaxation has arrived change nothing; twenty points once arrived, after some
    /// 350 steps, at ties to the last bit that made the tessellation panic.
    #[test]
    fn few_cells_may_be_relaxed_to_the_limit() {
        let made = |relaxation_steps| {
            let shape = CellShape { relaxation_steps, ..CellShape::default() };
            let block = cube(0.02, Vector::zeros());
            random_cells(20, &block, &shape, (1, "points of block 0")).unwrap()
        };
        let (arrived, limit) = (made(300), made(1000));
        assert_eq!(check(&limit.cells, 0.02), Ok(()));
        for (a, b) in arrived.points.iter().zip(&limit.points) {
            assert!((a - b).norm() < 1e-3 * 0.02, "they stay: {a:?} after 300 steps, then {b:?}");
        }
    }

    #[test]
    fn ten_thousand_cells_are_sound_and_without_tiny_edges() {
        let mut shortest = f64::INFINITY;
        for seed in 0..10 {
            let side = 0.0854;
            // Not `random_cells`, which would draw again: the first draw must do.
            let points = random_points(1000, &mut stream(seed, "many"));
            let cells = cells(&points, &cube(side, Vector::zeros())).unwrap();
            check(&cells, side).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
            for cell in &cells {
                shortest = shortest.min(shortest_edge(cell));
            }
        }
        assert!(
            shortest > 5e-8,
            "shortest edge after merging: expected > 5e-8 m, got {shortest:e}"
        );
    }

    #[test]
    fn merging_nearly_coincident_vertices_loses_nothing() {
        // A grid shaken by a millionth of its spacing: around each of its vertices, inside and on
        // the sides of the block, lie several vertices a hundredth of a micrometre apart.
        let n = 4;
        let mut rng = stream(3, "nearly regular");
        let points: Vec<Vector> = random_points(n * n * n, &mut rng)
            .iter()
            .enumerate()
            .map(|(i, shake)| {
                let index = [i % n, i / n % n, i / n / n].map(|k| k as f64 + 0.5);
                (Vector::from(index) + shake * 1e-6) / n as f64
            })
            .collect();
        let mut complex = tessellate(&points, Vector::repeat(1.0), 0.04, Vector::zeros());
        let mergers = complex.merge_short_edges(MERGE);
        assert!(mergers > 100, "most of 125 clusters have vertices to merge, merged {mergers}");
        let cells = complex.into_polyhedra().unwrap();
        check(&cells, 0.04).unwrap();
        for (i, cell) in cells.iter().enumerate() {
            // Slivers along an edge leave a vertex where they tapered to a point.
            assert_eq!(cell.faces().len(), 6, "cell {i} has the faces of a cube again");
            let shortest = shortest_edge(cell);
            assert!(shortest > 1e-6, "cell {i} has an edge of {shortest:e} m left");
            let inside = |v: &Point| v.iter().all(|c| (0.0..=0.04).contains(c));
            assert!(cell.vertices().iter().all(inside), "cell {i} lies in the block");
        }
    }

    #[test]
    fn bad_points_are_refused() {
        let good = Vector::repeat(0.5);
        for bad in [f64::NAN, f64::INFINITY, -0.1, 1.1] {
            let error = cells(&[good, Vector::new(0.2, bad, 0.2)], &cube(1.0, Vector::zeros()));
            assert!(matches!(error, Err(GrainsError::BadPoint { point: 1, .. })), "{error:?}");
        }
        let close = good + Vector::new(0.0, 1e-10, 0.0);
        let error = cells(&[good, Vector::zeros(), close], &cube(1.0, Vector::zeros()));
        assert!(matches!(error, Err(GrainsError::BadPoint { point: 2, .. })), "{error:?}");
        assert!(matches!(cells(&[], &cube(1.0, Vector::zeros())), Err(GrainsError::NoGrains)));
        for side in [0.0, -1.0, f64::NAN] {
            let error = cells(&[good], &cube(side, Vector::zeros()));
            assert!(matches!(error, Err(GrainsError::NotPositive { .. })), "{error:?}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn cells_fill_any_block(
            seed: u64, count in 1_usize..120, side in 1e-3..1.0, x in -2.0..2.0,
            steps in 0_u32..4, elongation in 1.0..3.0, flatness in 1.0..3.0,
        ) {
            let shape = CellShape { relaxation_steps: steps, elongation, flatness, rounding: 0.0 };
            let origin = Vector::new(x, 0.0, 0.5);
            let tessellation = random_cells(count, &cube(side, origin), &shape, (seed, "any")).unwrap();
            prop_assert_eq!(tessellation.cells.len(), count);
            prop_assert_eq!(check(&tessellation.cells, side), Ok(()));
            let again = random_cells(count, &cube(side, origin), &shape, (seed, "any")).unwrap();
            prop_assert_eq!(tessellation, again);
        }
    }
}
