//! A grid of heights that polyhedra are laid on from above.

use std::ops::Range;

use crate::geometry::Vector;

/// Side of a tile in cells: small beside a grain, so that the lowest cell of
/// the tiles under a grain says much about whether the grain can be seen.
const TILE: usize = 4;

/// Heights over the cells of a square grid within a circle.
///
/// Positions are in units of cells, with cell centres at whole numbers from 0
/// to `across − 1`; heights in m.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    /// Number of cells along each side.
    pub across: usize,
    /// Cells within the circle, a row.
    pub columns: Vec<Range<usize>>,
    /// Heights of all cells, row by row; 0 where nothing lies.
    pub heights: Vec<f64>,
    /// Lowest cell within the circle, a tile; infinite for tiles outside.
    low: Vec<f64>,
    /// Tiles along each side.
    tiles: usize,
    /// Scratch: from where to where a face reaches in each row.
    rows: Vec<(f64, f64)>,
}

impl Surface {
    /// A flat surface at height 0 within a circle of the given diameter in
    /// cells, at least 1.
    pub fn flat(diameter: f64) -> Self {
        let across = diameter.ceil() as usize;
        let middle = (across - 1) as f64 / 2.0;
        let columns: Vec<Range<usize>> = (0..across)
            .map(|row| {
                let y = row as f64 - middle;
                let half = ((diameter / 2.0).powi(2) - y * y).max(0.0).sqrt();
                let from = (middle - half).ceil().max(0.0) as usize;
                let to = (middle + half).floor() as usize;
                from..(to + 1).clamp(from, across)
            })
            .collect();
        let tiles = across.div_ceil(TILE);
        let mut surface = Self {
            across,
            columns,
            heights: vec![0.0; across * across],
            low: vec![0.0; tiles * tiles],
            tiles,
            rows: vec![],
        };
        let all = 0..surface.tiles;
        surface.update_tiles(all.clone(), all);
        surface
    }

    /// Whether every cell within reach of a body lies at least as high as it
    /// does, so that laying it on would change nothing. The body lies between
    /// the corners of a box (x and y in cells, z in m).
    pub fn hides(&self, low: &Vector, high: &Vector) -> bool {
        let (columns, rows) = (self.tiles_over(low.x, high.x), self.tiles_over(low.y, high.y));
        rows.into_iter()
            .all(|row| self.low[row * self.tiles..][columns.clone()].iter().all(|&l| l >= high.z))
    }

    /// Lays a polyhedron on: raises every cell whose centre lies under one of
    /// its faces to that face. Vertices have x and y in cells, z in m; faces
    /// are loops of their indices, counter-clockwise seen from outside.
    pub fn lay(&mut self, vertices: &[Vector], faces: &[Vec<u32>]) {
        for corners in faces {
            self.raise_to(vertices, corners);
        }
        let Some(&first) = vertices.first() else { return };
        let (low, high) =
            vertices.iter().fold((first, first), |(lo, hi), v| (lo.inf(v), hi.sup(v)));
        self.update_tiles(self.tiles_over(low.x, high.x), self.tiles_over(low.y, high.y));
    }

    /// Tiles that an interval of cell coordinates touches.
    fn tiles_over(&self, low: f64, high: f64) -> Range<usize> {
        let last = self.across as f64;
        let first = low.clamp(0.0, last) as usize / TILE;
        let end = (high.clamp(-1.0, last) + 1.0) as usize;
        first..end.div_ceil(TILE).clamp(first, self.tiles.max(first))
    }

    fn update_tiles(&mut self, columns: Range<usize>, rows: Range<usize>) {
        for tile_row in rows {
            for tile_column in columns.clone() {
                let mut lowest = f64::INFINITY;
                for row in tile_row * TILE..((tile_row + 1) * TILE).min(self.across) {
                    let inside = &self.columns[row];
                    let first = inside.start.max(tile_column * TILE);
                    let end = inside.end.min((tile_column + 1) * TILE);
                    if first < end {
                        let line = &self.heights[row * self.across..][first..end];
                        lowest = line.iter().copied().fold(lowest, f64::min);
                    }
                }
                self.low[tile_row * self.tiles + tile_column] = lowest;
            }
        }
    }

    /// Raises all cells whose centres lie under a face to that face, when the
    /// face looks upwards. Vertices have x and y in cells, z in m.
    ///
    /// Every row's crossing with an edge is computed from the same end points
    /// in the same order by both faces that share it, and both count their
    /// border as inside: no cell falls between two faces by rounding.
    fn raise_to(&mut self, vertices: &[Vector], corners: &[u32]) {
        let Some(plane) = UpwardPlane::of(vertices, corners) else { return };
        let last = (self.across - 1) as f64;
        if plane.y_high < 0.0 || plane.y_low > last {
            return;
        }
        let first_row = plane.y_low.max(0.0).ceil() as usize;
        let end_row = plane.y_high.min(last) as usize + 1;
        if first_row >= end_row {
            return;
        }
        let rows = &mut self.rows;
        rows.clear();
        rows.resize(end_row - first_row, (f64::INFINITY, f64::NEG_INFINITY));
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            let (p, q) = (&vertices[a.min(b) as usize], &vertices[a.max(b) as usize]);
            let (low, high) = if p.y < q.y { (p.y, q.y) } else { (q.y, p.y) };
            if high < first_row as f64 {
                continue;
            }
            let slope = (q.x - p.x) / (q.y - p.y);
            let from = (low.max(first_row as f64)).ceil() as usize;
            for row in from..end_row {
                let y = row as f64;
                if y > high {
                    break;
                }
                let span = &mut rows[row - first_row];
                if low == high {
                    // The whole edge lies on the row.
                    *span = (span.0.min(p.x.min(q.x)), span.1.max(p.x.max(q.x)));
                } else {
                    let x = p.x + (y - p.y) * slope;
                    *span = (span.0.min(x), span.1.max(x));
                }
            }
        }
        for (k, &(x_low, x_high)) in rows.iter().enumerate() {
            let row = first_row + k;
            let (from, to) = (self.columns[row].start, self.columns[row].end);
            if x_high < 0.0 || from == to {
                continue;
            }
            let first = from.max(whole_above(x_low));
            let end = to.min(x_high.min(last) as usize + 1);
            if first >= end {
                continue;
            }
            let line = &mut self.heights[row * self.across..][first..end];
            let (start, per_column) = plane.along_row(row as f64);
            for (column, height) in (first..).zip(line) {
                let z = (start + per_column * column as f64).clamp(plane.z_low, plane.z_high);
                if z > *height {
                    *height = z;
                }
            }
        }
    }
}

/// Smallest whole number not below a value, 0 for negative ones.
fn whole_above(x: f64) -> usize {
    let below = x.max(0.0) as usize;
    below + usize::from(below as f64 != x.max(0.0))
}

/// A face that looks upwards: z = z₀ − (nₓ(x − x₀) + n_y(y − y₀))/n_z.
struct UpwardPlane {
    centre: Vector,
    /// Rise per cell along x and y.
    rise_x: f64,
    rise_y: f64,
    y_low: f64,
    y_high: f64,
    z_low: f64,
    z_high: f64,
}

impl UpwardPlane {
    /// `None` for faces that look down or sideways. The normal is Newell's,
    /// as in [`crate::geometry::ConvexPolyhedron::plane`].
    fn of(vertices: &[Vector], corners: &[u32]) -> Option<Self> {
        let origin = vertices[corners[0] as usize];
        let mut doubled_area = 0.0;
        let mut a = vertices[corners[corners.len() - 1] as usize] - origin;
        for &c in corners {
            let b = vertices[c as usize] - origin;
            doubled_area += a.x * b.y - a.y * b.x;
            a = b;
        }
        // Two faces in three end here, before anything else is computed.
        if !(doubled_area > 0.0) {
            return None;
        }
        let mut normal = Vector::new(0.0, 0.0, doubled_area);
        let mut sum = Vector::zeros();
        let (mut low, mut high) = (origin, origin);
        let mut a = vertices[corners[corners.len() - 1] as usize] - origin;
        for &c in corners {
            let corner = vertices[c as usize];
            let b = corner - origin;
            normal.x += a.y * b.z - a.z * b.y;
            normal.y += a.z * b.x - a.x * b.z;
            sum += b;
            low = low.inf(&corner);
            high = high.sup(&corner);
            a = b;
        }
        Some(Self {
            centre: origin + sum / corners.len() as f64,
            rise_x: -normal.x / normal.z,
            rise_y: -normal.y / normal.z,
            y_low: low.y,
            y_high: high.y,
            // A nearly upright face turns rounding in x and y into height:
            // its corners bound what it can reach.
            z_low: low.z,
            z_high: high.z,
        })
    }

    /// Height at column 0 of a row, and the rise per column.
    fn along_row(&self, y: f64) -> (f64, f64) {
        let start = self.centre.z + self.rise_y * (y - self.centre.y) - self.rise_x * self.centre.x;
        (start, self.rise_x)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{random, random_polyhedron, random_pose};
    use super::*;
    use rand::RngExt;

    /// Law: a body that is said to be hidden changes no cell; one that stands
    /// out over the whole of a tile is not said to be hidden.
    #[test]
    fn hidden_bodies_change_nothing() {
        let mut rng = random(41);
        let mut surface = Surface::flat(40.5);
        let (mut hidden, mut seen) = (0, 0);
        for _ in 0..4000 {
            let shape = random_polyhedron(&mut rng, 12.0, 5);
            let mut place = random_pose(&mut rng, 30.0);
            place.translation.vector += Vector::new(20.0, 20.0, rng.random_range(-30.0..20.0));
            let body = shape.transformed(&place);
            let vertices: Vec<Vector> = body.vertices().iter().map(|v| v.coords).collect();
            let (low, high) = body.bounding_box();
            let before = surface.heights.clone();
            let said = surface.hides(&low.coords, &high.coords);
            surface.lay(&vertices, body.faces());
            if said {
                hidden += 1;
                assert_eq!(before, surface.heights, "a hidden body changed the surface");
            } else {
                seen += 1;
            }
        }
        assert!(hidden > 500 && seen > 200, "{hidden} hidden, {seen} seen");
        let top = surface.heights.iter().copied().fold(0.0, f64::max) + 1.0;
        let proud = (Vector::new(15.0, 15.0, 0.0), Vector::new(25.0, 25.0, top));
        assert!(!surface.hides(&proud.0, &proud.1), "a body above all others is seen");
    }

    /// Law: the kept minimum of each tile is the minimum of its cells.
    #[test]
    fn tiles_keep_their_minimum() {
        let mut rng = random(42);
        let mut surface = Surface::flat(37.0);
        for _ in 0..100 {
            let body =
                random_polyhedron(&mut rng, 9.0, 5).transformed(&random_pose(&mut rng, 40.0));
            let vertices: Vec<Vector> =
                body.vertices().iter().map(|v| v.coords + Vector::new(18.0, 18.0, 0.0)).collect();
            surface.lay(&vertices, body.faces());
            let kept = surface.low.clone();
            surface.update_tiles(0..surface.tiles, 0..surface.tiles);
            assert_eq!(kept, surface.low);
        }
        assert!(surface.heights.iter().any(|&h| h > 5.0), "nothing was laid on");
    }
}
