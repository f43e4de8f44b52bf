//! Directions in which a convex body rests on an edge: where all that is least
//! about its widths is found.
//!
//! The width of a body in a direction u is h(u) = max (p − q)·u over its corners p, q. Where a
//! single pair of corners makes it, it is the cosine of an angle times a length, which has no
//! minimum: turning u one way or the other makes it smaller. So what is least (a square opening, a
//! box) has a direction in which two corners are foremost at the same time, that is, one normal to
//! an edge and between the normals of the two faces that meet there. These directions are arcs of
//! great circles, one an edge, and a search over all directions becomes one along lines.
//!
//! The arcs are computed from the corners alone, so that they are those of the
//! hull of the corners, whose faces may be plane within rounding only.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::*;

/// How far, as a fraction of the body's size, a corner may lie before an edge
/// that still counts as one. Corners of a Voronoi cell that lie in one plane do
/// so within some 1e-14 of its size; the arcs come out this little too long,
/// and the widths on what is too much of them this little too small.
const SLACK: f64 = 1e-12;

/// Arcs shorter than this, in radians, are left out: those of the diagonals of faces, which the
/// slack makes of points. Their directions are a few times this from the ends of the arcs they lie
/// between, and the widths there differ by as small a fraction.
const SHORTEST: f64 = 1e-11;

/// What [`SLACK`] and [`SHORTEST`] can do to what is found on the arcs, as a fraction of it.
pub(super) const ROUNDING: f64 = 1e-10;

#[derive(Debug, Clone)]
pub(super) struct EdgeFan {
    /// Unit vector along the edge.
    axis: Vector,
    /// With `axis` a right-handed frame; an angle is counted from the first to the second.
    across: [Vector; 2],
    /// Corners in this frame (along the axis, along the first, along the
    /// second), ordered along the axis.
    corners: Vec<[f64; 3]>,
    /// The directions, cut where another corner becomes the hindmost.
    pub pieces: Vec<Piece>,
}

/// Directions for which the same two corners are the foremost and the hindmost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// First angle, in radians.
    pub from: f64,
    /// Last angle, in radians.
    pub to: f64,
    /// The width is x·cos + y·sin of the angle, in m.
    x: f64,
    y: f64,
}

impl Piece {
    /// Width in m of the body in the direction at an angle.
    pub fn width(&self, angle: f64) -> f64 {
        self.x * angle.cos() + self.y * angle.sin()
    }

    /// Largest width in m between two angles, whose widths are given.
    pub fn largest(&self, [from, to]: [f64; 2], [first, last]: [f64; 2]) -> f64 {
        // It is a cosine: its top is where its derivative changes sign.
        let slope = |angle: f64| self.y * angle.cos() - self.x * angle.sin();
        if slope(from) > 0.0 && slope(to) < 0.0 { self.x.hypot(self.y) } else { first.max(last) }
    }
}

/// Corners of a body as seen along a direction.
#[derive(Debug, Clone, Default)]
pub(super) struct Shadow {
    points: Vec<[f64; 2]>,
    /// Corners of the outline, counter-clockwise.
    outline: Vec<[f64; 2]>,
}

impl EdgeFan {
    /// The fans of all edges of the hull of some corners, in m.
    pub fn all(corners: &[Vector]) -> Vec<Self> {
        // About their mean, numbers are as small as they can be.
        let mean = corners.iter().sum::<Vector>() / corners.len().max(1) as f64;
        let corners: Vec<Vector> = corners.iter().map(|p| p - mean).collect();
        let size = corners.iter().map(Vector::norm).fold(0.0, f64::max);
        let pairs = (0..corners.len()).flat_map(|i| (i + 1..corners.len()).map(move |j| (i, j)));
        pairs.filter_map(|(i, j)| Self::of_edge(&corners, i, j, SLACK * size)).collect()
    }

    fn of_edge(corners: &[Vector], i: usize, j: usize, slack: f64) -> Option<Self> {
        let axis = (corners[j] - corners[i]).try_normalize(slack)?;
        let first = axis.cross(&least_axis(&axis)).normalize();
        let across = [first, axis.cross(&first)];
        let flat = |p: &Vector| [p.dot(&axis), p.dot(&across[0]), p.dot(&across[1])];
        let edge = Edge { frame: corners.iter().map(flat).collect(), foremost: i, slack };
        let mut fan = Self { axis, across, corners: Vec::new(), pieces: Vec::new() };
        for (from, to) in edge.directions().into_iter().filter(|(a, b)| b - a > SHORTEST) {
            fan.cut(&edge, [from, to], [from, to].map(|angle| edge.hindmost(angle)));
        }
        if fan.pieces.is_empty() {
            return None;
        }
        fan.corners = edge.frame;
        fan.corners.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        Some(fan)
    }

    /// Cuts an arc where its hindmost corner changes. A corner is the hindmost in a connected range
    /// of directions, so that one that is it at both ends is it in between.
    fn cut(&mut self, edge: &Edge, [from, to]: [f64; 2], [first, last]: [usize; 2]) {
        let across = [1, 2].map(|c| edge.frame[first][c] - edge.frame[last][c]);
        // Where the two lie equally far back.
        let mut middle = (-across[0]).atan2(across[1]);
        while middle < from {
            middle += PI;
        }
        if first == last || middle <= from || middle >= to {
            let last = if first == last { last } else { edge.hindmost((from + to) / 2.0) };
            let [x, y] = [1, 2].map(|c| edge.frame[edge.foremost][c] - edge.frame[last][c]);
            return self.pieces.push(Piece { from, to, x, y });
        }
        let between = edge.hindmost(middle);
        if edge.along(between, middle) < edge.along(first, middle) - edge.slack {
            self.cut(edge, [from, middle], [first, between]);
            self.cut(edge, [middle, to], [between, last]);
        } else {
            self.cut(edge, [from, middle], [first; 2]);
            self.cut(edge, [middle, to], [last; 2]);
        }
    }

    /// The unit direction at an angle.
    pub fn direction(&self, angle: f64) -> Vector {
        let (sin, cos) = angle.sin_cos();
        self.across[0] * cos + self.across[1] * sin
    }

    /// The direction in space of one in the shadow that is cast along the direction at an angle.
    pub fn in_space(&self, angle: f64, along: [f64; 2]) -> Vector {
        self.axis * along[0] + self.axis.cross(&self.direction(angle)) * along[1]
    }

    /// Looks along the direction at an angle.
    pub fn cast(&self, angle: f64, shadow: &mut Shadow) {
        let (sin, cos) = angle.sin_cos();
        let Shadow { points, outline } = shadow;
        points.clear();
        points.extend(self.corners.iter().map(|c| [c[0], c[2] * cos - c[1] * sin]));
        // They are in order along the axis; those that are equally far along
        // it are put in order across it.
        let before = |a: &[f64; 2], b: &[f64; 2]| a[0] == b[0] && a[1] < b[1];
        for n in 1..points.len() {
            let mut k = n;
            while k > 0 && before(&points[k], &points[k - 1]) {
                points.swap(k, k - 1);
                k -= 1;
            }
        }
        // Andrew's monotone chains, there and back.
        outline.clear();
        points.iter().for_each(|p| add(outline, 0, *p));
        let base = outline.len().saturating_sub(1);
        points.iter().rev().for_each(|p| add(outline, base, *p));
        outline.pop();
    }
}

/// Adds a point to a chain that turns left, which begins at `base`.
fn add(outline: &mut Vec<[f64; 2]>, base: usize, p: [f64; 2]) {
    while let [.., a, b] = outline[base..] {
        if (b[0] - a[0]) * (p[1] - a[1]) > (b[1] - a[1]) * (p[0] - a[0]) {
            break;
        }
        outline.pop();
    }
    outline.push(p);
}

impl Shadow {
    /// The least width of the shadow in m, over all directions in its plane, and its direction, a
    /// unit vector: it is square to one of its sides.
    pub fn least_width(&self) -> (f64, [f64; 2]) {
        let mut least = (f64::INFINITY, [1.0, 0.0]);
        for along in self.normals() {
            // Both ways: corners that coincide but for rounding have a side
            // between them that points anywhere.
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for p in &self.outline {
                let at = p[0] * along[0] + p[1] * along[1];
                (low, high) = (low.min(at), high.max(at));
                if high - low >= least.0 {
                    break;
                }
            }
            let width = high - low;
            if width < least.0 {
                least = (width, along);
            }
        }
        least
    }

    /// The smallest rectangle about the shadow: it lies on one of its sides
    /// (Freeman and Shapira 1975, "Determining the minimum-area encasing
    /// rectangle for an arbitrary closed curve"). Its area in m², and its sides in m.
    pub fn least_rectangle(&self) -> (f64, [f64; 2]) {
        let mut least = (f64::INFINITY, [f64::INFINITY; 2]);
        for along in self.normals() {
            let extent = |x: f64, y: f64| spread(self.outline.iter().map(|p| p[0] * x + p[1] * y));
            let sides = [extent(along[0], along[1]), extent(along[1], -along[0])];
            let area = sides[0] * sides[1];
            if area < least.0 {
                least = (area, sides);
            }
        }
        least
    }

    fn normals(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let next = self.outline.iter().cycle().skip(1);
        self.outline.iter().zip(next).filter_map(|(p, q)| {
            let [x, y] = [q[0] - p[0], q[1] - p[1]];
            let length = x.hypot(y);
            (length > 0.0).then(|| [y / length, -x / length])
        })
    }
}

/// Width in m of some corners along a unit direction.
pub(super) fn width(corners: &[Vector], direction: &Vector) -> f64 {
    spread(corners.iter().map(|p| p.dot(direction)))
}

/// The largest of some numbers less the smallest.
fn spread(numbers: impl Iterator<Item = f64>) -> f64 {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = numbers.fold(none, |(low, high), x| (low.min(x), high.max(x)));
    high - low
}

/// The coordinate axis furthest from a direction.
fn least_axis(direction: &Vector) -> Vector {
    let mut axis = Vector::zeros();
    axis[direction.iamin()] = 1.0;
    axis
}

/// An edge while its directions are looked for.
struct Edge {
    /// The body's corners in the frame of the edge.
    frame: Vec<[f64; 3]>,
    /// One of the edge's ends.
    foremost: usize,
    /// Differences in m that count as none.
    slack: f64,
}

impl Edge {
    /// How far forward a corner is in the direction at an angle, in m.
    fn along(&self, corner: usize, angle: f64) -> f64 {
        let (sin, cos) = angle.sin_cos();
        self.frame[corner][1] * cos + self.frame[corner][2] * sin
    }

    /// The corner that is the least forward.
    fn hindmost(&self, angle: f64) -> usize {
        let (sin, cos) = angle.sin_cos();
        let along = self.frame.iter().map(|p| p[1] * cos + p[2] * sin);
        let first = (0, f64::INFINITY);
        along.enumerate().fold(first, |least, next| if next.1 < least.1 { next } else { least }).0
    }

    /// Whether the other corners surround it, seen along it, so that no
    /// direction can have it foremost. Only what is certain counts.
    fn is_surrounded(&self) -> bool {
        let origin = self.frame[self.foremost];
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let mut cone: Option<[[f64; 2]; 2]> = None;
        for corner in &self.frame {
            let c = [corner[1] - origin[1], corner[2] - origin[2]];
            if c[0] * c[0] + c[1] * c[1] <= 4.0 * self.slack * self.slack {
                continue;
            }
            let Some([right, left]) = &mut cone else {
                cone = Some([c, c]);
                continue;
            };
            // What the slack turns both directions by, at most.
            let little = |a: [f64; 2]| {
                -4.0 * self.slack * (a[0].abs() + a[1].abs() + c[0].abs() + c[1].abs())
            };
            let (after_right, before_left) = (cross(*right, c), cross(c, *left));
            if after_right >= 0.0 && before_left >= 0.0 {
                continue;
            } else if before_left < 0.0 && after_right >= little(*right) {
                *left = c;
            } else if after_right < 0.0 && before_left >= little(*left) {
                *right = c;
            } else {
                return true;
            }
        }
        false
    }

    /// Ranges of angles in which no corner is further forward than the edge.
    fn directions(&self) -> Vec<(f64, f64)> {
        if self.is_surrounded() {
            return Vec::new();
        }
        let mut allowed = vec![(-PI, PI)];
        for corner in &self.frame {
            let [x, y] = [1, 2].map(|c| corner[c] - self.frame[self.foremost][c]);
            let beside = x.hypot(y);
            if beside <= 2.0 * self.slack {
                continue;
            }
            // Within this angle of (x, y) the corner is further forward; up to
            // 1/2 an arc sine is at most 1.05 times its argument.
            let half = FRAC_PI_2 - 1.1 * self.slack / beside;
            let middle = y.atan2(x);
            for turn in [0.0, if middle < 0.0 { TAU } else { -TAU }] {
                forbid(&mut allowed, middle - half + turn, middle + half + turn);
            }
            if allowed.is_empty() {
                break;
            }
        }
        allowed
    }
}

/// Takes what lies between two angles out of ranges of angles.
fn forbid(allowed: &mut Vec<(f64, f64)>, from: f64, to: f64) {
    if allowed.iter().all(|&(low, high)| to <= low || high <= from) {
        return;
    }
    let mut left = Vec::with_capacity(allowed.len() + 1);
    for &(low, high) in allowed.iter() {
        if low < from.min(high) {
            left.push((low, from.min(high)));
        }
        if to.max(low) < high {
            left.push((to.max(low), high));
        }
    }
    *allowed = left;
}
