//! Points: runs of different sweeps that have the same values of all factors that both have.

use super::*;
use crate::report::{MetAt, PointsMet};

/// A point that has all of several targets: the row of each, and its value.
pub(super) type Point<'a> = Vec<(&'a Row, f64)>;

/// The points that have all of several targets. Goes through the runs of the table with most
/// columns, and seeks for each those of the other tables that agree with it, and with each other, in
/// all factors that both have and in their configuration.
pub(super) fn points<'a>(targets: &[&Modelled<'a>]) -> Vec<Point<'a>> {
    let mut order: Vec<usize> = (0..targets.len()).collect();
    order.sort_by_key(|n| std::cmp::Reverse(targets[*n].table.columns.len()));
    let Some(first) = order.first() else { return Vec::new() };
    let point = |row: &'a Row| -> Option<Point<'a>> {
        let mut rows: Vec<&Row> = vec![row];
        let mut of_target = BTreeMap::new();
        for n in &order {
            let agrees = |other: &&Row| rows.iter().all(|row| agree(row, other));
            let table = targets[*n].table;
            let own = if std::ptr::eq(table, targets[*first].table) {
                row
            } else {
                table.rows.iter().find(agrees)?
            };
            rows.push(own);
            of_target.insert(*n, (own, value(targets[*n].target, own)?));
        }
        Some(of_target.into_values().collect())
    };
    targets[*first].table.rows.iter().filter_map(point).collect()
}

/// How many points there are, how many meet all targets, and how many are independent.
pub(super) fn met(points: &[Point], targets: &[&Modelled]) -> Option<PointsMet> {
    let met = points.iter().filter(|point| meets(point, targets)).count();
    PointsMet::new(met, points.len(), apart(points, targets))
}

/// Number of groups of points of which no two share a specimen.
fn apart(points: &[Point], targets: &[&Modelled]) -> usize {
    let mut first: BTreeMap<(*const Runs, usize), usize> = BTreeMap::new();
    let mut parents: Vec<usize> = (0..points.len()).collect();
    for (n, point) in points.iter().enumerate() {
        for (target, (row, _)) in targets.iter().zip(point) {
            let specimen = (std::ptr::from_ref(target.table), row.specimen);
            let earlier = *first.entry(specimen).or_insert(n);
            let (a, b) = (root(&parents, earlier), root(&parents, n));
            parents[a.max(b)] = a.min(b);
        }
    }
    parents.iter().enumerate().filter(|(n, parent)| n == *parent).count()
}

/// The first point of the group of a point.
fn root(parents: &[usize], mut point: usize) -> usize {
    while parents[point] != point {
        point = parents[point];
    }
    point
}

/// Those that meet all targets.
pub(super) fn met_at(points: &[Point], targets: &[&Modelled]) -> Vec<MetAt> {
    let at = |point: &Point| {
        let own = targets.iter().zip(point).flat_map(|(target, (row, _))| {
            target.table.factors.iter().cloned().zip(row.factors.iter().copied())
        });
        MetAt { at: own.collect(), values: point.iter().map(|(_, value)| *value).collect() }
    };
    points.iter().filter(|point| meets(point, targets)).map(at).collect()
}

fn meets(point: &[(&Row, f64)], targets: &[&Modelled]) -> bool {
    point.iter().zip(targets).all(|((_, value), target)| target.target.met(*value))
}

/// Whether two runs are of the same configuration and agree in every factor that both have.
pub(super) fn agree(a: &Row, b: &Row) -> bool {
    let same = |x: &String, y: &String| match (x.parse::<f64>(), y.parse::<f64>()) {
        (Ok(x), Ok(y)) => x == y,
        _ => x == y,
    };
    same(&a.configuration, &b.configuration)
        && a.columns.iter().all(|(name, x)| b.columns.get(name).is_none_or(|y| same(x, y)))
}
