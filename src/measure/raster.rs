//! A grid of heights that polyhedra are laid on from above.

use std::ops::Range;

use super::*;

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
    /// A flat surface at height 0 within a circle of the given diameter in cells, at least 1.
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
        surface.update_tiles(&Vector::zeros(), &Vector::repeat(across as f64));
        surface
    }

    /// Whether every cell within reach of a body lies at least as high as it
    /// does, so that laying it on would change nothing. The body lies between
    /// the corners of a box (x and y in cells, z in m).
    pub fn hides(&self, low: &Vector, high: &Vector) -> bool {
        let [columns, rows] = self.tiles_over(low, high);
        rows.into_iter()
            .all(|row| self.low[row * self.tiles..][columns.clone()].iter().all(|&l| l >= high.z))
    }

    /// Lays a polyhedron on: raises every cell whose centre lies under one of
    /// its faces to that face. Vertices have x and y in cells, z in m; faces
    /// are loops of their indices, counter-clockwise seen from outside.
    pub fn lay(&mut self, vertices: &[Vector], faces: &[Vec<u32>]) {
        let mut raised = false;
        for corners in faces {
            raised |= self.raise_to(vertices, corners);
        }
        let (true, Some(&first)) = (raised, vertices.first()) else { return };
        let (low, high) =
            vertices.iter().fold((first, first), |(lo, hi), v| (lo.inf(v), hi.sup(v)));
        self.update_tiles(&low, &high);
    }

    /// Lays a sphere on, exactly: its centre has x and y in cells, z in m; its radius in m is
    /// `across` cells.
    pub fn lay_sphere(&mut self, centre: &Vector, radius: f64, across: f64) {
        let reach = Vector::new(across, across, radius);
        let (low, high) = (centre - reach, centre + reach);
        if self.hides(&low, &high) {
            return;
        }
        let mut raised = false;
        let first_row = low.y.ceil().max(0.0) as usize;
        for row in first_row..self.across {
            let off = row as f64 - centre.y;
            let half = across * across - off * off;
            if off > across {
                break;
            }
            if half < 0.0 {
                continue;
            }
            let within = &self.columns[row];
            let half = half.sqrt();
            let first = (centre.x - half).ceil().max(within.start as f64) as usize;
            let end = ((centre.x + half).floor() + 1.0).clamp(0.0, within.end as f64) as usize;
            for column in first..end {
                let aside = column as f64 - centre.x;
                let share = (1.0 - (off * off + aside * aside) / (across * across)).max(0.0);
                let z = centre.z + radius * share.sqrt();
                let height = &mut self.heights[row * self.across + column];
                raised |= z > *height;
                *height = height.max(z);
            }
        }
        if raised {
            self.update_tiles(&low, &high);
        }
    }

    /// Columns and rows of the tiles that a box touches; its corners have x and y in cells.
    fn tiles_over(&self, low: &Vector, high: &Vector) -> [Range<usize>; 2] {
        let last = self.across as f64;
        [0, 1].map(|axis| {
            let first = low[axis].clamp(0.0, last) as usize / TILE;
            let end = (high[axis].clamp(-1.0, last) + 1.0) as usize;
            first..end.div_ceil(TILE).clamp(first, self.tiles.max(first))
        })
    }

    /// Finds anew how low each tile is that a box touches, as in [`Self::tiles_over`].
    fn update_tiles(&mut self, low: &Vector, high: &Vector) {
        let [columns, rows] = self.tiles_over(low, high);
        for tile_row in rows {
            for tile_column in columns.clone() {
                let mut lowest = f64::INFINITY;
                for row in tile_row * TILE..((tile_row + 1) * TILE).min(self.across) {
                    let inside = &self.columns[row];
                    let first = inside.start.max(tile_column * TILE);
                    let end = inside.end.min((tile_column + 1) * TILE);
                    if first < end {
                        let line = &self.heights[row * self.across..][first..end];
                        lowest = line.iter().fold(lowest, |m, &h| if h < m { h } else { m });
                    }
                }
                self.low[tile_row * self.tiles + tile_column] = lowest;
            }
        }
    }

    /// Raises all cells whose centres lie under a face to that face, when the face looks upwards;
    /// says whether it raised any. Vertices have x and y in cells, z in m.
    ///
    /// Every row's crossing with an edge is computed from the same end points
    /// in the same order by both faces that share it, and both count their
    /// border as inside: no cell falls between two faces by rounding.
    fn raise_to(&mut self, vertices: &[Vector], corners: &[u32]) -> bool {
        if !looks_up(vertices, corners) {
            return false;
        }
        let first = vertices[corners[0] as usize];
        let (low, high) = corners.iter().fold((first, first), |(lo, hi), &c| {
            (lo.inf(&vertices[c as usize]), hi.sup(&vertices[c as usize]))
        });
        let last = (self.across - 1) as f64;
        if high.y < 0.0 || low.y > last || self.hides(&low, &high) {
            return false;
        }
        let first_row = whole_above(low.y);
        let end_row = high.y.min(last) as i32 + 1;
        if first_row >= end_row {
            return false;
        }
        self.rows.clear();
        self.rows.resize((end_row - first_row) as usize, (f64::INFINITY, f64::NEG_INFINITY));
        let mut a = corners[corners.len() - 1];
        for &b in corners {
            let (p, q) = (&vertices[a.min(b) as usize], &vertices[a.max(b) as usize]);
            cross_rows(p, q, first_row, &mut self.rows);
            a = b;
        }
        let plane = Plane::of(vertices, corners);
        let mut raised = false;
        for (row, &(x_low, x_high)) in (first_row..).zip(&self.rows) {
            let within = &self.columns[row as usize];
            if x_high < 0.0 || within.is_empty() {
                continue;
            }
            let first = whole_above(x_low).max(within.start as i32);
            let end = (x_high.min(last) as i32 + 1).min(within.end as i32);
            if first >= end {
                continue;
            }
            let line = &mut self.heights[row as usize * self.across..];
            let start =
                plane.z + plane.rise_y * (f64::from(row) - plane.y) - plane.rise_x * plane.x;
            for (column, height) in (first..end).zip(&mut line[first as usize..]) {
                let z = start + plane.rise_x * f64::from(column);
                // A nearly upright face turns rounding in x and y into
                // height: its corners bound what it can reach.
                let z = if z > high.z { high.z } else { z };
                let z = if z < low.z { low.z } else { z };
                raised |= z > *height;
                *height = if z > *height { z } else { *height };
            }
        }
        raised
    }
}

/// Widens the span of every row that an edge crosses, rows counted from `first_row`.
fn cross_rows(p: &Vector, q: &Vector, first_row: i32, rows: &mut [(f64, f64)]) {
    let (low, high) = if p.y < q.y { (p.y, q.y) } else { (q.y, p.y) };
    let from = whole_above(low).max(first_row);
    if high < f64::from(from) {
        return;
    }
    if low == high {
        // The whole edge lies on the row.
        if let Some(span) = rows.get_mut((from - first_row) as usize) {
            *span = (span.0.min(p.x.min(q.x)), span.1.max(p.x.max(q.x)));
        }
        return;
    }
    let slope = (q.x - p.x) / (q.y - p.y);
    for (row, span) in (from..).zip(rows.iter_mut().skip((from - first_row) as usize)) {
        let y = f64::from(row);
        if y > high {
            break;
        }
        let x = p.x + (y - p.y) * slope;
        *span = (if x < span.0 { x } else { span.0 }, if x > span.1 { x } else { span.1 });
    }
}

/// Smallest whole number not below a value, 0 for negative ones. Written out because `ceil` is a
/// call on processors without SSE 4.1, and this is the innermost but one loop.
fn whole_above(x: f64) -> i32 {
    let x = if x > 0.0 { x } else { 0.0 };
    let below = x as i32;
    below.saturating_add(i32::from(f64::from(below) != x))
}

/// Whether the projection of a face on the ground runs counter-clockwise.
fn looks_up(vertices: &[Vector], corners: &[u32]) -> bool {
    let origin = vertices[corners[0] as usize];
    let mut doubled_area = 0.0;
    let mut a = vertices[corners[1] as usize];
    for &c in &corners[2..] {
        let b = vertices[c as usize];
        doubled_area += (a.x - origin.x) * (b.y - origin.y) - (a.y - origin.y) * (b.x - origin.x);
        a = b;
    }
    doubled_area > 0.0
}

/// A plane through (x, y, z) that rises by so much a cell.
struct Plane {
    x: f64,
    y: f64,
    z: f64,
    rise_x: f64,
    rise_y: f64,
}

impl Plane {
    /// The plane of a face that looks up. The normal is Newell's, as in
    /// [`crate::geometry::ConvexPolyhedron::plane`].
    fn of(vertices: &[Vector], corners: &[u32]) -> Self {
        let origin = vertices[corners[0] as usize];
        let (mut normal, mut sum) = (Vector::zeros(), Vector::zeros());
        let mut a = Vector::zeros();
        for &c in &corners[1..] {
            let b = vertices[c as usize] - origin;
            normal += a.cross(&b);
            sum += b;
            a = b;
        }
        let centre = origin + sum / corners.len() as f64;
        Self {
            x: centre.x,
            y: centre.y,
            z: centre.z,
            rise_x: -normal.x / normal.z,
            rise_y: -normal.y / normal.z,
        }
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
            surface.update_tiles(&Vector::zeros(), &Vector::repeat(surface.across as f64));
            assert_eq!(kept, surface.low);
        }
        assert!(surface.heights.iter().any(|&h| h > 5.0), "nothing was laid on");
    }
}
