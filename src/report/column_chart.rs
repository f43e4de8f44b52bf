//! A figure of any columns of a table over another: one panel for each unit, with the units on its
//! axes.

use super::*;
use super::{
    columns::quantity_and_unit,
    plot::{Series, aligned},
};
use crate::in_order::each_once;

/// A column: its name and its numbers, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartColumn {
    /// Name, with the unit.
    pub name: String,
    /// A number for each row, or none.
    pub numbers: Vec<Option<f64>>,
    /// What its numbers are of and their unit, where its name says neither: of the column `value` of
    /// a table that has other columns for that.
    pub of: Option<(String, String)>,
}

impl ChartColumn {
    /// Its quantity in words, and its unit; empty where it has none.
    fn quantity_and_unit(&self) -> (String, &str) {
        match &self.of {
            Some((quantity, unit)) => (quantity.clone(), unit.as_str()),
            None => quantity_and_unit(&self.name),
        }
    }
}

/// What is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnChart {
    /// Along the horizontal axis.
    pub x: ChartColumn,
    /// Over it.
    pub y: Vec<ChartColumn>,
    /// Whether the horizontal and the vertical axes are logarithmic.
    pub log: [bool; 2],
    /// Whether rows are joined in their order; else each has a marker.
    pub is_line: bool,
    /// Values of x at which a stage begins.
    pub stages: Vec<f64>,
}

/// Words that say nothing without the quantity that they are of.
const QUALIFIERS: [&str; 3] = ["mean", "largest", "smallest"];

/// Characters of an axis' name, at most, where it is made of those of several columns.
const LONGEST_NAME: usize = 40;

impl ColumnChart {
    /// The figure as SVG.
    ///
    /// # Errors
    /// A sentence on what has no place on the axes or cannot be drawn.
    pub fn svg(&self) -> Result<String, String> {
        stacked(&self.panels()?)
    }

    /// The panels, from the top.
    fn panels(&self) -> Result<Vec<Plot>, String> {
        let units = each_once(self.y.iter().map(|column| column.quantity_and_unit().1));
        let plots = units.iter().map(|unit| self.panel(unit));
        Ok(aligned(plots.collect::<Result<_, String>>()?))
    }

    /// The columns of one unit.
    fn panel(&self, unit: &str) -> Result<Plot, String> {
        let columns: Vec<(usize, &ChartColumn)> = self
            .y
            .iter()
            .enumerate()
            .filter(|(_, column)| column.quantity_and_unit().1 == unit)
            .collect();
        let (x, x_unit) = self.x.quantity_and_unit();
        let names: Vec<String> = columns.iter().map(|(_, c)| c.quantity_and_unit().0).collect();
        let mut plot = Plot::new(
            Axis::scaled(self.log[0], label(&x, x_unit)),
            Axis::scaled(self.log[1], label(&in_common(&names), unit)),
        );
        for (n, column) in &columns {
            let of = self.curves(*n, column, columns.len() > 1);
            if of.is_empty() {
                let wanted = |log: bool| if log { "a positive number" } else { "a number" };
                let [x, y] = self.log.map(wanted);
                let why = match self.log {
                    [false, false] => "",
                    _ => ": a logarithmic axis shows positive numbers alone",
                };
                let [of_x, of_y] = [&self.x.name, &column.name];
                return Err(format!("no row has {x} in `{of_x}` and {y} in `{of_y}`{why}"));
            }
            plot.series.extend(of);
        }
        plot.mark_upright("Beginning of a stage", self.stages_drawn());
        Ok(plot)
    }

    /// Values of x at which a stage begins, of those between which any column has numbers: others would
    /// lengthen the axis by what is empty.
    fn stages_drawn(&self) -> Vec<f64> {
        let rows = self.y.iter().flat_map(|column| self.x.numbers.iter().zip(&column.numbers));
        let Some(drawn) = Interval::of(rows.filter_map(|(x, y)| (*y).and(*x))) else {
            return Vec::new();
        };
        let is_drawn = |at: &f64| (drawn.low..=drawn.high).contains(at);
        self.stages.iter().copied().filter(is_drawn).collect()
    }

    /// A column in pieces between rows that have no place.
    fn curves(&self, n: usize, column: &ChartColumn, named: bool) -> Vec<Series> {
        let look = match (self.is_line, named) {
            (true, true) => Look::spaced(n),
            (true, false) => Look::line(n),
            (false, _) => Look::dots(n),
        };
        let name = if named { capital(&column.quantity_and_unit().0) } else { String::new() };
        let placed = |(x, y): (&Option<f64>, &Option<f64>)| {
            let (x, y) = ((*x)?, (*y)?);
            ((!self.log[0] || x > 0.0) && (!self.log[1] || y > 0.0)).then_some((x, y))
        };
        let rows: Vec<Option<(f64, f64)>> =
            self.x.numbers.iter().zip(&column.numbers).map(placed).collect();
        let pieces = rows
            .split(Option::is_none)
            .map(|piece| -> Vec<(f64, f64)> { piece.iter().copied().flatten().collect() });
        let mut name = Some(name);
        pieces
            .filter(|points| !points.is_empty())
            .map(|points| {
                // A row alone between rows without a number has no line.
                let alone = self.is_line && points.len() == 1;
                let look = if alone { Look::marked(n) } else { look };
                Series { label: name.take().unwrap_or_default(), look, points }
            })
            .collect()
    }
}

fn label(quantity: &str, unit: &str) -> String {
    match unit {
        "" => capital(quantity),
        unit => format!("{} ({unit})", capital(quantity)),
    }
}

/// What several quantities have in common: the words with which all begin or end.
fn in_common(names: &[String]) -> String {
    let words: Vec<Vec<&str>> = names.iter().map(|name| name.split(' ').collect()).collect();
    let Some(first) = words.first().filter(|_| words.len() > 1) else {
        return names.first().cloned().unwrap_or_default();
    };
    let alike = |k: usize, from_end: bool| {
        let word = |words: &[&str]| {
            let at = if from_end { words.len().checked_sub(k + 1)? } else { k };
            words.get(at).map(|word| (*word).to_owned())
        };
        let of_first = word(first);
        of_first.is_some() && words.iter().all(|words| word(words) == of_first)
    };
    let begin = (0..first.len()).take_while(|&k| alike(k, false)).count();
    let names_something = first[..begin].iter().any(|word| !QUALIFIERS.contains(word));
    let begin = if names_something { begin } else { 0 };
    let end = (0..first.len()).take_while(|&k| alike(k, true)).count();
    match (begin, end) {
        (0, 0) => {
            let all = names.join(", ");
            if all.chars().count() <= LONGEST_NAME { all } else { "value".to_owned() }
        }
        (begin, end) if begin >= end => first[..begin].join(" "),
        (_, end) => first[first.len() - end..].join(" "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, numbers: &[Option<f64>]) -> ChartColumn {
        ChartColumn { name: name.to_owned(), numbers: numbers.to_vec(), of: None }
    }

    fn chart(y: Vec<ChartColumn>) -> ColumnChart {
        ColumnChart {
            x: column("time_s", &[Some(0.0), Some(1.0), Some(2.0), Some(3.0)]),
            y,
            log: [false; 2],
            is_line: true,
            stages: vec![2.0],
        }
    }

    #[test]
    fn what_quantities_have_in_common_names_their_axis() {
        for (names, expected) in [
            (&["box force z", "gate force z"][..], "force z"),
            (&["box force x", "box force y"], "box force"),
            (&["box force z"], "box force z"),
            (&["settlement", "table x"], "settlement, table x"),
            (&["longest", "shortest", "intermediate", "sphericity"], "value"),
            (&["settlement", "surface settlement"], "settlement"),
            (&["mean surface", "mean grain height"], "mean surface, mean grain height"),
        ] {
            let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
            assert_eq!(in_common(&names), expected, "law: of {names:?}");
        }
    }

    #[test]
    fn axes_have_units_and_units_have_panels() {
        let force = |name| column(name, &[Some(1.0), None, Some(3.0), Some(4.0)]);
        let svg =
            chart(vec![force("box_force_z_n"), force("gate_force_z_n")]).svg().expect("drawn");
        for text in
            ["Time (s)", "Force z (N)", "Box force z", "Gate force z", "Beginning of a stage"]
        {
            assert!(svg.contains(text), "law: {text} stands in the figure");
        }
        let two = chart(vec![force("box_force_z_n"), force("core_void_ratio")]);
        let svg = two.svg().expect("drawn");
        assert_eq!(svg.matches("Time (s)").count(), 2, "law: a panel for each unit");
        assert!(svg.contains("Core void ratio"), "law: what has no unit has its name");
        assert!(!svg.contains("Core void ratio ("), "law: and nothing in brackets");
    }

    /// Law: panels line up: what one has no numbers of is empty in it, and a place across the figure is
    /// one value in all.
    #[test]
    fn panels_line_up() {
        let late = column("settlement_mm", &[None, None, Some(1.0), Some(2.0)]);
        let wide = column("force_n", &[Some(0.0), Some(1e6), Some(2e6), Some(1_234_567.0)]);
        let panels = chart(vec![late, wide]).panels().expect("drawn");
        let [upper, lower] = &panels[..] else { panic!("law: a panel for each unit") };
        let [above, below] = [upper, lower].map(|plot| plot.scales().0);
        assert_eq!(above, below, "law: one horizontal axis (left: above, right: below)");
        let [above, below] = [upper, lower].map(Plot::left);
        assert_eq!(above, below, "law: frames begin at one place (left: above, right: below)");
    }

    /// Law: a stage is marked where something is drawn, so that no axis begins long before its curves.
    #[test]
    fn stages_are_marked_where_something_is_drawn() {
        let late = column("settlement_mm", &[None, None, Some(1.0), Some(2.0)]);
        let of = ColumnChart { stages: vec![1.0, 2.0, 2.5], ..chart(vec![late]) };
        assert_eq!(of.stages_drawn(), [2.0, 2.5], "law: there is no number before 2 s");
        let none = ColumnChart { stages: vec![1.0], ..chart(Vec::new()) };
        assert_eq!(none.stages_drawn(), [0.0; 0], "law: nothing is drawn");
    }

    /// Law: a column that is called `value` is named by what it is of, with its unit.
    #[test]
    fn a_value_is_named_by_what_it_is_of() {
        let of = Some(("normal force".to_owned(), "of mean".to_owned()));
        let share = column("share_percent", &[Some(1.0), Some(2.0), Some(3.0), Some(4.0)]);
        let mut long = chart(vec![share]);
        long.x = ChartColumn { name: "value".to_owned(), of, ..long.x };
        let svg = long.svg().expect("drawn");
        assert!(svg.contains("Normal force (of mean)"), "law: not `Value`: {svg}");
    }

    #[test]
    fn rows_without_a_number_part_the_line_and_nothing_is_refused() {
        let of = chart(Vec::new());
        let gap = column("a_n", &[Some(1.0), None, Some(3.0), Some(4.0)]);
        let pieces = of.curves(0, &gap, true);
        let lengths: Vec<usize> = pieces.iter().map(|s| s.points.len()).collect();
        assert_eq!(lengths, [1, 2], "law: a gap parts the line");
        assert_eq!(pieces[1].label, "", "law: one entry in the legend");
        let none = chart(vec![column("a_n", &[None; 4])]).svg().expect_err("law: nothing to draw");
        assert!(none.contains("`time_s`") && none.contains("`a_n`"), "{none}");
        let log =
            ColumnChart { log: [false, true], ..chart(vec![column("a_n", &[Some(-1.0); 4])]) };
        let said = log.svg().expect_err("law: no logarithm of −1");
        let words = "a number in `time_s` and a positive number in `a_n`: a logarithmic axis";
        assert!(said.contains(words), "law: the axis that has no numbers is named, got {said}");
    }
}
