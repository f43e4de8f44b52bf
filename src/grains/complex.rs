//! Cells that share vertices, and the merging of vertices that nearly coincide.
//!
//! Neighbouring cells name the same vertex by the same number and cut every shared face into the
//! same triangles. Whatever moves a vertex therefore takes from one cell what it gives to the next:
//! the block's volume is conserved to rounding, however many vertices are merged.

use std::collections::{BTreeMap, HashSet};

use super::*;

/// A vertex of the complex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SharedVertex {
    /// Position in m.
    pub position: Point,
    /// Which of the block's six sides it lies on, one bit each; merging keeps
    /// it there, so that the block stays a cube.
    pub sides: u8,
}

/// Cells with shared vertices.
#[derive(Debug, Clone)]
pub(super) struct CellComplex {
    vertices: Vec<SharedVertex>,
    /// Per cell the loops of its faces, counter-clockwise seen from outside.
    cells: Vec<Vec<Vec<u32>>>,
    /// The vertex each vertex was merged into; itself where it was not.
    merged_into: Vec<u32>,
}

/// Vertices to be merged into the first of them.
struct Cluster {
    members: Vec<u32>,
    /// What the first one becomes.
    merged: SharedVertex,
    /// What it was.
    before: SharedVertex,
}

/// Follows a chain of mergers to its end.
fn root(merged_into: &[u32], mut vertex: u32) -> u32 {
    while merged_into[vertex as usize] != vertex {
        vertex = merged_into[vertex as usize];
    }
    vertex
}

impl CellComplex {
    /// Joins vertices and the face loops (vertex numbers) of each cell.
    pub fn new(vertices: Vec<SharedVertex>, cells: Vec<Vec<Vec<u32>>>) -> Self {
        let merged_into = (0..vertices.len() as u32).collect();
        Self { vertices, cells, merged_into }
    }

    /// Merges the ends of edges shorter than `distance` (m) where all cells around remain valid
    /// polyhedra, the shortest first. Returns the number of vertices that went.
    ///
    /// Vertices joined by short edges go together, and all at once: a sliver
    /// of a face has short edges at both ends, and with only one of them gone
    /// its normal would point anywhere. What spoils a cell is undone.
    ///
    /// Nearly coincident vertices are where four planes almost meet in a point; their edges have no
    /// meaningful direction, which spoils edge-edge tests in collision detection. With a
    /// ten-thousandth of a grain (`scale::MERGE_DISTANCE`), a merged vertex lies up to half of that
    /// beside the planes it belongs to, and [`ConvexPolyhedron::new`] accepts 1e-5 of the bounding
    /// radius: of the edges between 0.1 and 1 µm of 8 mm grains only a part can go; of 10⁵ cells
    /// none kept an edge below 0.1 µm.
    pub fn merge_short_edges(&mut self, distance: f64) -> usize {
        // From a thousandth upwards, so that a cluster that is too wide to
        // merge as a whole can still lose its shortest edges.
        (0..=6).map(|level| self.merge_at_once(distance * 10_f64.powi(level - 6).sqrt())).sum()
    }

    fn merge_at_once(&mut self, distance: f64) -> usize {
        let mut clusters = self.clusters(distance);
        if clusters.is_empty() {
            return 0;
        }
        let mut cells_of: HashMap<u32, Vec<usize>> =
            clusters.iter().flat_map(|c| &c.members).map(|&v| (v, Vec::new())).collect();
        for (cell, faces) in self.cells.iter().enumerate() {
            for &vertex in faces.iter().flatten() {
                if let Some(cells) = cells_of.get_mut(&self.root(vertex))
                    && cells.last() != Some(&cell)
                {
                    cells.push(cell);
                }
            }
        }
        let around = |cluster: &Cluster| -> Vec<usize> {
            cluster.members.iter().flat_map(|v| &cells_of[v]).copied().collect()
        };
        let mut touched: Vec<usize> = clusters.iter().flat_map(&around).collect();
        touched.sort_unstable();
        touched.dedup();
        touched.retain(|&cell| self.cell(cell).is_ok());
        clusters.iter().for_each(|cluster| self.apply(cluster));
        loop {
            let spoiled: HashSet<usize> =
                touched.iter().copied().filter(|&cell| self.cell(cell).is_err()).collect();
            let (undo, keep): (Vec<_>, Vec<_>) = clusters
                .into_iter()
                .partition(|cluster| around(cluster).iter().any(|cell| spoiled.contains(cell)));
            undo.iter().for_each(|cluster| self.undo(cluster));
            clusters = keep;
            if undo.is_empty() {
                return clusters.iter().map(|cluster| cluster.members.len() - 1).sum();
            }
        }
    }

    /// Groups of vertices joined by edges shorter than `distance`.
    fn clusters(&self, distance: f64) -> Vec<Cluster> {
        let mut joined = self.merged_into.clone();
        for corners in self.cells.iter().flatten() {
            for (a, b) in edges_of(corners) {
                let (a, b) = (self.root(a), self.root(b));
                if a != b && self.length(a, b) < distance {
                    let (a, b) = (root(&joined, a), root(&joined, b));
                    joined[a.max(b) as usize] = a.min(b);
                }
            }
        }
        let mut groups: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for v in 0..self.vertices.len() as u32 {
            if self.root(v) == v {
                groups.entry(root(&joined, v)).or_default().push(v);
            }
        }
        groups
            .into_values()
            .filter(|members| members.len() > 1)
            .filter_map(|members| self.cluster(members))
            .collect()
    }

    /// A cluster's place is the mean of its vertices on the most sides of the
    /// block; `None` if it lies on sides that no single vertex of it lies on.
    fn cluster(&self, members: Vec<u32>) -> Option<Cluster> {
        let own = || members.iter().map(|&v| &self.vertices[v as usize]);
        let sides = own().fold(0, |sides, v| sides | v.sides);
        let decisive: Vec<Point> = own().filter(|v| v.sides == sides).map(|v| v.position).collect();
        let first = *decisive.first()?;
        // The mean of the differences, so that equal coordinates stay equal.
        let mean = decisive.iter().map(|p| p - first).sum::<Vector>() / decisive.len() as f64;
        let merged = SharedVertex { position: first + mean, sides };
        let before = self.vertices[members[0] as usize];
        Some(Cluster { members, merged, before })
    }

    fn apply(&mut self, cluster: &Cluster) {
        let keep = cluster.members[0];
        self.vertices[keep as usize] = cluster.merged;
        for &v in &cluster.members {
            self.merged_into[v as usize] = keep;
        }
    }

    fn undo(&mut self, cluster: &Cluster) {
        self.vertices[cluster.members[0] as usize] = cluster.before;
        for &v in &cluster.members {
            self.merged_into[v as usize] = v;
        }
    }

    fn root(&self, vertex: u32) -> u32 {
        root(&self.merged_into, vertex)
    }

    fn length(&self, a: u32, b: u32) -> f64 {
        (self.vertices[a as usize].position - self.vertices[b as usize].position).norm()
    }

    /// One cell as a polyhedron. Its vertices are in the order of their shared
    /// numbers and every face begins at its lowest one, so that two cells cut
    /// their common face into the same triangles.
    fn cell(&self, cell: usize) -> Result<ConvexPolyhedron, PolyhedronError> {
        // A face whose corners all merged into two or one has no area left.
        let own = self.cells[cell].iter();
        let loops = own.filter_map(|corners| loop_of(corners.iter().map(|&c| self.root(c))));
        let faces = loops.map(|mut face| {
            let lowest = (0..face.len()).min_by_key(|&i| face[i]).unwrap_or(0);
            face.rotate_left(lowest);
            face
        });
        let faces: Vec<Vec<u32>> = faces.collect();
        let (vertices, faces) = used(&faces, &self.vertices);
        ConvexPolyhedron::new(vertices.iter().map(|v| v.position).collect(), faces)
    }

    /// All cells as polyhedra.
    ///
    /// # Errors
    /// [`GrainsError::BadCell`] for the first cell that is none.
    pub fn into_polyhedra(self) -> Result<Vec<ConvexPolyhedron>, GrainsError> {
        (0..self.cells.len())
            .map(|cell| self.cell(cell).map_err(|source| GrainsError::BadCell { cell, source }))
            .collect()
    }
}
