//! The convex hull of points, and hulls with fewer vertices.
//!
//! Quickhull (Barber, Dobkin and Huhdanpaa 1996, "The quickhull algorithm for convex hulls"), with
//! the farthest point of all taken next, not that of some face: stopped early, it leaves a hull of
//! few vertices from which no point sticks out far. The crates at hand cannot be stopped so, and
//! refuse or panic on some sets of points that have a hull.

use std::collections::{BinaryHeap, HashMap};

use super::{ConvexPolyhedron, Point, Vector, convex::mean, joined_polyhedron, used};

/// Points nearer to a face than the first of these, as a fraction of the largest distance from the
/// points' mean, are taken to lie on it. Meshes of single precision are no finer.
///
/// A facet about as narrow as that, whose plane is uncertain, may be left turned round. The others
/// are for hulls to which that happened.
pub(crate) const ROUNDINGS: [f64; 3] = [1e-7, 1e-8, 1e-9];

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hull {
    /// Its vertices, in the order of the points they are.
    pub vertices: Vec<Point>,
    /// Triangles, counter-clockwise seen from outside.
    pub triangles: Vec<Vec<u32>>,
    /// How far in m the farthest point left out sticks out of the plane of a
    /// triangle; 0 where none does by more than rounding.
    pub left_out: f64,
}

/// The hull of finite points as a polyhedron, with the first rounding that makes one. `None` where
/// the points lie in a plane within rounding, or no rounding does.
pub(crate) fn convex_hull(points: &[Point]) -> Option<ConvexPolyhedron> {
    for rounding in ROUNDINGS {
        let Hull { vertices, triangles, .. } = hull(points, usize::MAX, rounding)?;
        let shape = joined_polyhedron(&vertices, &triangles);
        if shape.is_some() {
            return shape;
        }
    }
    None
}

/// The hull of finite points, of `most_vertices` at most, with one of the [`ROUNDINGS`]. `None`
/// where the points lie in a plane within rounding.
pub(crate) fn hull(points: &[Point], most_vertices: usize, rounding: f64) -> Option<Hull> {
    let mean = mean(points);
    let radius = points.iter().map(|p| (p.coords - mean).norm()).fold(0.0, f64::max);
    if !(radius > 0.0 && radius.is_finite()) {
        return None;
    }
    // About the mean and of size one, where rounding is known.
    let scaled: Vec<Vector> = points.iter().map(|p| (p.coords - mean) / radius).collect();
    let mut growth = Growth::begin(&scaled, rounding)?;
    let mut vertices = 4;
    while vertices < most_vertices && growth.take_farthest() {
        vertices += 1;
    }
    let facets: Vec<&Facet> = growth.facets.iter().filter(|f| f.alive).collect();
    let left_out = growth
        .dropped
        .iter()
        .chain(facets.iter().flat_map(|f| &f.outside))
        .flat_map(|&p| facets.iter().map(move |f| (f, p)))
        .map(|(f, p)| f.height(&scaled[p as usize]))
        .fold(0.0, f64::max);
    let corners: Vec<[u32; 3]> = facets.iter().map(|f| f.corners).collect();
    let (vertices, triangles) = used(&corners, points);
    Some(Hull { vertices, triangles, left_out: left_out * radius })
}

/// A triangle of the hull as far as it has grown.
struct Facet {
    corners: [u32; 3],
    /// Facets beyond the edges from each corner to the next.
    beyond: [usize; 3],
    normal: Vector,
    offset: f64,
    /// Points in front of it that belong to no other facet.
    outside: Vec<u32>,
    alive: bool,
}

impl Facet {
    fn new(corners: [u32; 3], beyond: [usize; 3], points: &[Vector]) -> Option<Self> {
        let [a, b, c] = corners.map(|v| points[v as usize]);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
        let offset = normal.dot(&((a + b + c) / 3.0));
        Some(Self { corners, beyond, normal, offset, outside: Vec::new(), alive: true })
    }

    fn height(&self, point: &Vector) -> f64 {
        self.normal.dot(point) - self.offset
    }

    fn edge(&self, edge: usize) -> (u32, u32) {
        (self.corners[edge], self.corners[(edge + 1) % 3])
    }
}

struct Growth<'a> {
    points: &'a [Vector],
    rounding: f64,
    /// Also those that are gone, which are no longer alive.
    facets: Vec<Facet>,
    /// Of each facet the farthest point outside: height (positive numbers are
    /// in the order of their bits), point, facet.
    farthest: BinaryHeap<(u64, u32, usize)>,
    /// Points that could not be taken for rounding.
    dropped: Vec<u32>,
}

impl<'a> Growth<'a> {
    fn begin(points: &'a [Vector], rounding: f64) -> Option<Self> {
        let mut growth = Self {
            points,
            rounding,
            facets: tetrahedron(points, rounding)?,
            farthest: BinaryHeap::new(),
            dropped: Vec::new(),
        };
        let first: Vec<u32> = growth.facets.iter().flat_map(|f| f.corners).collect();
        let rest = (0..points.len() as u32).filter(|p| !first.contains(p)).collect();
        growth.share_out(rest, 0);
        Some(growth)
    }

    /// Puts the farthest point outside on the hull; `false` where none is left.
    fn take_farthest(&mut self) -> bool {
        while let Some((_, point, facet)) = self.farthest.pop() {
            if !self.facets[facet].alive {
                continue;
            }
            if self.take(point, facet).is_some() {
                return true;
            }
            self.facets[facet].outside.retain(|&p| p != point);
            self.dropped.push(point);
            self.announce(facet);
        }
        false
    }

    /// Facets that see the point go, and their outline is joined to it. `None`,
    /// with nothing changed, where rounding makes the outline no single loop.
    fn take(&mut self, point: u32, facet: usize) -> Option<()> {
        let place = &self.points[point as usize];
        let mut seen = vec![facet];
        let mut is_seen = std::collections::HashSet::from([facet]);
        let mut outline: HashMap<u32, (u32, usize)> = HashMap::new();
        let mut visited = 0;
        while let Some(&at) = seen.get(visited) {
            visited += 1;
            for edge in 0..3 {
                let beyond = self.facets[at].beyond[edge];
                // Facets in whose plane the point lies go as well: those left
                // standing would have new ones of no area beside them.
                if self.facets[beyond].height(place) > -self.rounding && is_seen.insert(beyond) {
                    seen.push(beyond);
                }
            }
        }
        for &at in &seen {
            for edge in 0..3 {
                let beyond = self.facets[at].beyond[edge];
                let (a, b) = self.facets[at].edge(edge);
                if !is_seen.contains(&beyond) && outline.insert(a, (b, beyond)).is_some() {
                    return None;
                }
            }
        }
        let start = *outline.keys().min()?;
        let (first, count) = (self.facets.len(), outline.len());
        let mut new = Vec::with_capacity(count);
        let mut at = start;
        for index in 0..count {
            let &(to, beyond) = outline.get(&at)?;
            let following = first + (index + 1) % count;
            let preceding = first + (index + count - 1) % count;
            let corners = [at, to, point];
            new.push(Facet::new(corners, [beyond, following, preceding], self.points)?);
            at = to;
            // Back too early: there are several loops.
            if at == start && index + 1 < count {
                return None;
            }
        }
        if at != start {
            return None;
        }
        for (index, facet) in new.iter().enumerate() {
            let (a, b) = facet.edge(0);
            let other = &mut self.facets[facet.beyond[0]];
            let edge = (0..3).find(|&e| other.edge(e) == (b, a))?;
            other.beyond[edge] = first + index;
        }
        let mut orphans = Vec::new();
        for &gone in &seen {
            self.facets[gone].alive = false;
            orphans.append(&mut self.facets[gone].outside);
        }
        orphans.retain(|&p| p != point);
        self.facets.extend(new);
        self.share_out(orphans, first);
        Some(())
    }

    /// Gives each point to the facet, of those from number `first`, that it
    /// sticks out of the most; points that stick out of none are inside.
    fn share_out(&mut self, candidates: Vec<u32>, first: usize) {
        for candidate in candidates {
            let place = &self.points[candidate as usize];
            let heights = self.facets[first..].iter().map(|f| f.height(place)).enumerate();
            let highest = heights.max_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((facet, _)) = highest.filter(|h| h.1 > self.rounding) {
                self.facets[first + facet].outside.push(candidate);
            }
        }
        (first..self.facets.len()).for_each(|facet| self.announce(facet));
    }

    fn announce(&mut self, index: usize) {
        let facet = &self.facets[index];
        let height = |&p: &u32| (facet.height(&self.points[p as usize]).to_bits(), p);
        if let Some((bits, point)) = facet.outside.iter().map(height).max() {
            self.farthest.push((bits, point, index));
        }
    }
}

/// Four points far apart, as a tetrahedron with outward faces.
fn tetrahedron(points: &[Vector], rounding: f64) -> Option<Vec<Facet>> {
    let farthest = |distance: &dyn Fn(&Vector) -> f64| {
        let index = (0..points.len())
            .max_by(|&a, &b| distance(&points[a]).total_cmp(&distance(&points[b])))?;
        (distance(&points[index]) > rounding).then_some(index)
    };
    let a = farthest(&|p| p.norm())?;
    let b = farthest(&|p| (p - points[a]).norm())?;
    let along = (points[b] - points[a]).try_normalize(0.0)?;
    let c = farthest(&|p| (p - points[a]).cross(&along).norm())?;
    let normal = (points[b] - points[a]).cross(&(points[c] - points[a])).try_normalize(0.0)?;
    let d = farthest(&|p| (p - points[a]).dot(&normal).abs())?;
    // So that d lies behind the face a, b, c.
    let (b, c) = if (points[d] - points[a]).dot(&normal) > 0.0 { (c, b) } else { (b, c) };
    let [a, b, c, d] = [a, b, c, d].map(|v| v as u32);
    [([a, b, c], [1, 2, 3]), ([b, a, d], [0, 3, 2]), ([c, b, d], [0, 1, 3]), ([a, c, d], [0, 2, 1])]
        .map(|(corners, beyond)| Facet::new(corners, beyond, points))
        .into_iter()
        .collect()
}
