//! Height of the specimen's surface over the cylinder's cross-section.

use super::*;

/// Side in m of a height map's cells where nothing else is asked for: about 10 400
/// cells on the paper's cylinder.
pub fn height_cell(grains: &GrainSet) -> f64 {
    grains.of_size(&scale::HEIGHT_CELL)
}

/// The same over a container, of any width: cells are wider where there would be too many.
pub fn height_cell_over(container: &Container, grains: &GrainSet) -> f64 {
    let (cell, across) = (height_cell(grains), 2.0 * container.radius);
    if across <= MOST_ACROSS as f64 * cell { cell } else { across / ACROSS_WIDE }
}

/// Most cells across a diameter; a finer map is a mistake in the units.
const MOST_ACROSS: usize = 4000;

/// Cells across a container too wide for those that are usual: a quarter as many as the most, as a
/// map is made for every row of a series.
const ACROSS_WIDE: f64 = 2000.0;

/// The height of the highest solid point over every cell of a square grid
/// laid over the cylinder's cross-section.
///
/// The grid is centred on the cylinder's axis: cell (i, j) of an n × n grid has its centre at (i −
/// (n−1)/2, j − (n−1)/2) times the cell's side from the axis, and belongs to the map when that
/// centre lies within the radius. The surface is taken at cell centres only; it is exact there, but
/// for rounded polyhedra, whose edges and corners are those of their mesh, up to 3 % of their
/// radius lower. Where there is no grain the height is 0, the floor.
#[derive(Debug, Clone)]
pub struct HeightMap {
    cell: f64,
    surface: Surface,
    highest: f64,
}

/// Standing height of a specimen above the floor by three definitions, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StandingHeight {
    /// Mean of the height map: volume under the surface over cross-section.
    pub mean_surface: f64,
    /// 95th percentile of the height map by nearest rank: 5 % of the cross-section lies higher.
    pub p95: f64,
    /// Highest point of any grain, 0 without grains.
    pub highest: f64,
}

impl HeightMap {
    /// Maps the grains in the cylinder (see [`Container::members`]) with cells of side `cell` in m.
    /// Parts of grains that stand out of the circle are left out; parts below the floor read 0.
    ///
    /// # Errors
    /// [`MeasureError`] of the container, or when the diameter is less than one or more than 4000
    /// cells.
    pub fn of(specimen: &Specimen, container: &Container, cell: f64) -> Result<Self, MeasureError> {
        let bodies = &specimen.state.bodies;
        let members = container.members(specimen).into_iter();
        let poses: Vec<(usize, Pose)> = members.map(|i| (i, bodies[i].body.pose)).collect();
        Self::of_poses(&specimen.grains, &poses, container, cell)
    }

    /// Maps copies of grains, each by its number and its pose, over the container's cross-section.
    ///
    /// # Errors
    /// As [`HeightMap::of`].
    pub fn of_poses(
        grains: &GrainSet,
        poses: &[(usize, Pose)],
        container: &Container,
        cell: f64,
    ) -> Result<Self, MeasureError> {
        container.check()?;
        let radius = container.radius;
        let diameter = 2.0 * radius / cell;
        if !(1.0..=MOST_ACROSS as f64).contains(&diameter) {
            return Err(MeasureError(format!(
                "height map cells of {cell} m do not fit a container of radius {radius} m: the \
                 diameter must be 1 to {MOST_ACROSS} cells"
            )));
        }
        let mut surface = Surface::flat(diameter);
        let mut highest = 0.0f64;
        let mut vertices: Vec<Vector> = vec![];
        let middle = (surface.across - 1) as f64 / 2.0;
        let in_cells = |p: Vector| {
            Vector::new((p.x - container.centre_x) / cell + middle, p.y / cell + middle, p.z)
        };
        // From above: most grains then lie under cells that are higher
        // already, which is known from a sphere around them.
        let mut poses: Vec<&(usize, Pose)> = poses.iter().collect();
        poses.sort_by(|a, b| b.1.translation.z.total_cmp(&a.1.translation.z));
        for (i, pose) in poses {
            let shape = &grains.grains[*i].shape;
            let radius = shape.radius_about_origin();
            let centre = in_cells(pose.translation.vector);
            let reach = Vector::new(radius / cell, radius / cell, radius);
            if centre.z + radius <= highest && surface.hides(&(centre - reach), &(centre + reach)) {
                continue;
            }
            if let Some(sphere) = shape.sphere() {
                highest = highest.max(shape.heights(pose).1);
                let centre = in_cells((pose * sphere.centre).coords);
                surface.lay_sphere(&centre, sphere.radius, sphere.radius / cell);
                continue;
            }
            if shape.rounded().is_some() {
                highest = highest.max(shape.heights(pose).1);
            }
            let rotation = pose.rotation.to_rotation_matrix();
            vertices.clear();
            vertices.extend(
                shape
                    .vertices()
                    .iter()
                    .map(|v| in_cells(rotation * v.coords + pose.translation.vector)),
            );
            highest = vertices.iter().map(|v| v.z).fold(highest, f64::max);
            surface.lay(&vertices, shape.faces());
        }
        Ok(Self { cell, surface, highest })
    }

    /// Side of a cell in m.
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Number of cells along each side of the grid.
    pub fn across(&self) -> usize {
        self.surface.across
    }

    /// Height in m over the cell in column `i` (along x) and row `j` (along
    /// y); `None` outside the circle.
    pub fn height(&self, i: usize, j: usize) -> Option<f64> {
        let within = self.surface.columns.get(j)?.contains(&i);
        within.then(|| self.surface.heights[j * self.surface.across + i])
    }

    /// Heights in m of all cells within the circle, row by row.
    pub fn heights(&self) -> impl Iterator<Item = f64> + '_ {
        let surface = &self.surface;
        surface.columns.iter().enumerate().flat_map(move |(row, within)| {
            surface.heights[row * surface.across..][within.clone()].iter().copied()
        })
    }

    /// The three standing heights.
    pub fn standing_height(&self) -> StandingHeight {
        let heights: Vec<f64> = self.heights().collect();
        StandingHeight {
            mean_surface: statistics::mean(&heights).unwrap_or(0.0),
            p95: statistics::percentile(&heights, 95.0).unwrap_or(0.0),
            highest: self.highest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{
        assert_near, cube, random, random_polyhedron, random_rotation, specimen_of,
    };
    use super::*;

    const DEFAULT_CELL: f64 = 1e-3;
    use crate::{geometry::ConvexPolyhedron, specimen::Fate};
    use std::f64::consts::PI;

    const CUP: Container = Container { centre_x: 0.0, radius: 0.05, height: 0.1 };

    fn at(x: f64, y: f64, z: f64) -> Pose {
        Pose::translation(x, y, z)
    }

    /// Height of the highest point of a polyhedron over (x, y), from the
    /// definition: the vertical line cut with all half-spaces.
    fn top_over(body: &ConvexPolyhedron, x: f64, y: f64) -> Option<f64> {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for face in 0..body.faces().len() {
            let (n, d) = body.plane(face).unwrap();
            let rest = d - n.x * x - n.y * y;
            if n.z > 1e-14 {
                high = high.min(rest / n.z);
            } else if n.z < -1e-14 {
                low = low.max(rest / n.z);
            } else if rest < 0.0 {
                return None;
            }
        }
        (low <= high).then_some(high)
    }

    /// Law: the number of cell centres in a circle tends to its area over the cell's.
    #[test]
    fn cells_cover_the_circle() {
        for cell in [0.001, 0.0013, 0.0005] {
            let map = HeightMap::of(&specimen_of(vec![]), &CUP, cell).unwrap();
            let middle = (map.across() - 1) as f64 / 2.0;
            let mut inside = 0;
            for j in 0..map.across() {
                for i in 0..map.across() {
                    let (x, y) = ((i as f64 - middle) * cell, (j as f64 - middle) * cell);
                    let within = x.hypot(y) <= CUP.radius;
                    assert_eq!(map.height(i, j).is_some(), within, "cell {i}, {j} of {cell}");
                    inside += usize::from(within);
                }
            }
            assert_eq!(map.heights().count(), inside);
            let area = inside as f64 * cell * cell;
            assert_near("area of the cells", CUP.area(), area, 0.005 * CUP.area());
        }
    }

    /// Law: a slab that covers the floor has its own height everywhere; an
    /// empty cylinder has none; a spilled or outlying grain does not count.
    #[test]
    fn slab_and_nothing() {
        let slab = ConvexPolyhedron::cuboid(Vector::new(0.2, 0.2, 0.03)).unwrap();
        let mut specimen = specimen_of(vec![
            (slab, at(0.0, 0.0, 0.015)),
            (cube(0.02), at(0.06, 0.0, 0.09)),
            (cube(0.02), at(0.0, 0.0, 0.13)),
        ]);
        let got = HeightMap::of(&specimen, &CUP, DEFAULT_CELL).unwrap().standing_height();
        for (what, value) in [("mean", got.mean_surface), ("p95", got.p95), ("top", got.highest)] {
            assert_near(what, 0.03, value, 1e-12);
        }
        specimen.state.bodies[0].fate = Fate::Spilled;
        let got = HeightMap::of(&specimen, &CUP, DEFAULT_CELL).unwrap().standing_height();
        assert_eq!(got, StandingHeight { mean_surface: 0.0, p95: 0.0, highest: 0.0 });
    }

    /// Law: the sum over the map times the cell's area tends to the volume under the surface; for a
    /// cone of slope k within the radius that is the cone's own volume, and its 95th percentile
    /// lies where 5 % of the area is higher. The table's displacement moves the map along.
    #[test]
    fn pyramid_on_the_floor() {
        let n = 64;
        let mut vertices = vec![crate::geometry::Point::new(0.0, 0.0, 0.08)];
        let ring = |i: u32| 2.0 * PI * f64::from(i) / f64::from(n);
        vertices.extend((0..n).map(|i| {
            crate::geometry::Point::new(0.049 * ring(i).cos(), 0.049 * ring(i).sin(), 0.0)
        }));
        let mut faces: Vec<Vec<u32>> = (0..n).map(|i| vec![0, 1 + i, 1 + (i + 1) % n]).collect();
        faces.push((1..=n).rev().collect());
        let cone = ConvexPolyhedron::new(vertices, faces).unwrap();
        let volume = cone.signed_volume();
        for shift in [0.0, 0.0213] {
            let cup = Container { centre_x: shift, ..CUP };
            let specimen = specimen_of(vec![(cone.clone(), at(shift, 0.0, 0.0))]);
            let map = HeightMap::of(&specimen, &cup, 0.0005).unwrap();
            let got = map.standing_height();
            let mean = volume / cup.area();
            assert_near("volume over area", mean, got.mean_surface, 0.003 * mean);
            assert_near("tip", 0.08, got.highest, 1e-12);
            let p95 = 0.08 * (1.0 - 0.05f64.sqrt() * 0.05 / 0.049);
            assert_near("height of the highest 5 % of the area", p95, got.p95, 3e-4);
        }
    }

    /// Law: over every cell the map holds the highest of all grains' tops,
    /// each computed from its half-spaces; nothing falls between faces.
    #[test]
    fn map_agrees_with_ray_casting() {
        let mut rng = random(31);
        let mut parts = vec![];
        for i in 0..40 {
            let shape = random_polyhedron(&mut rng, 0.03, 7);
            let (x, y) = ((f64::from(i % 6) - 2.5) * 0.013, (f64::from(i / 6) - 2.5) * 0.014);
            let place = Vector::new(x, y, 0.01 + 0.002 * f64::from(i));
            parts.push((shape, Pose::from_parts(place.into(), random_rotation(&mut rng))));
        }
        let specimen = specimen_of(parts);
        let bodies: Vec<ConvexPolyhedron> = CUP
            .members(&specimen)
            .iter()
            .map(|&i| {
                let pose = &specimen.state.bodies[i].body.pose;
                specimen.grains.grains[i].shape.transformed(pose)
            })
            .collect();
        let map = HeightMap::of(&specimen, &CUP, DEFAULT_CELL).unwrap();
        let middle = (map.across() - 1) as f64 / 2.0;
        let mut covered = 0;
        for j in 0..map.across() {
            for i in 0..map.across() {
                let Some(got) = map.height(i, j) else { continue };
                let (x, y) = ((i as f64 - middle) * 1e-3, (j as f64 - middle) * 1e-3);
                let tops = bodies.iter().filter_map(|b| top_over(b, x, y));
                let expected = tops.fold(0.0, f64::max);
                assert_near(&format!("height over cell {i}, {j}"), expected, got, 1e-9);
                covered += usize::from(expected > 0.0);
            }
        }
        assert!(covered > 4000, "only {covered} cells covered");
    }

    /// Cells exactly under shared edges, corners and along grid rows: a block
    /// of cubes whose faces meet at cell centres leaves no hole.
    #[test]
    fn no_holes_where_faces_meet() {
        let mut roof = ConvexPolyhedron::cuboid(Vector::new(0.2, 0.2, 0.02)).unwrap();
        // A ridge along a row of cell centres: 0.5 mm off the axis with an even count.
        let ridge = |y: f64| -> ConvexPolyhedron {
            let p = crate::geometry::Point::new;
            let v = vec![
                p(-0.1, -0.1, 0.0),
                p(0.1, -0.1, 0.0),
                p(0.1, 0.1, 0.0),
                p(-0.1, 0.1, 0.0),
                p(-0.1, y, 0.02),
                p(0.1, y, 0.02),
            ];
            let f = [
                vec![3, 2, 1, 0],
                vec![0, 1, 5, 4],
                vec![2, 3, 4, 5],
                vec![1, 2, 5],
                vec![3, 0, 4],
            ];
            ConvexPolyhedron::new(v, f.to_vec()).unwrap()
        };
        for _ in 0..2 {
            let specimen = specimen_of(vec![(roof.clone(), at(0.0, 0.0, 0.01))]);
            let map = HeightMap::of(&specimen, &CUP, DEFAULT_CELL).unwrap();
            let lowest = map.heights().fold(f64::INFINITY, f64::min);
            assert!(lowest > 0.01, "a hole: {lowest}");
            roof = ridge(0.0005);
        }
    }

    /// Law: a container of any width has a height map: of usual cells up to the most, then of wider
    /// ones. Grains of 8 mm that roll over a floor of 9 m are measured, too.
    #[test]
    fn wide_containers_have_wider_cells() {
        let specimen = specimen_of(vec![(cube(0.01), at(0.0, 0.0, 0.005))]);
        let usual = height_cell(&specimen.grains);
        let over = |radius: f64| Container { radius, ..CUP };
        let cell = |radius: f64| height_cell_over(&over(radius), &specimen.grains);
        for (radius, expected) in
            [(0.05, usual), (1999.5 * usual, usual), (2500.0 * usual, 2.5 * usual), (4.5, 0.0045)]
        {
            let law = format!("cell over a radius of {radius} m");
            assert_near(&law, expected, cell(radius), 1e-12);
        }
        let wide = HeightMap::of(&specimen, &over(4.5), cell(4.5)).expect("law: a height map");
        assert_near("highest grain", 0.01, wide.standing_height().highest, 1e-12);
    }

    #[test]
    fn sizes_are_checked() {
        let specimen = specimen_of(vec![]);
        for cell in [0.0, -1.0, f64::NAN, 0.11, 1e-6, f64::INFINITY] {
            let got = HeightMap::of(&specimen, &CUP, cell);
            let said = got.as_ref().is_err_and(|why| why.0.starts_with("height map cells of "));
            assert!(said, "{cell}: {got:?}");
        }
        let flat = Container { radius: -1.0, ..CUP };
        let got = HeightMap::of(&specimen, &flat, DEFAULT_CELL);
        assert!(got.is_err_and(|why| why.0.starts_with("the container's radius")));
    }
}
