//! Names of lines in figures.

/// Names of lines in a figure, each of a kind by its number: the first of a kind has its name, the
/// others have none.
pub fn names(kinds: &[String], lines: &[usize]) -> Vec<String> {
    let name = |(n, kind): (usize, &usize)| {
        let is_first = !lines[..n].contains(kind);
        if is_first { kinds[*kind].clone() } else { String::new() }
    };
    lines.iter().enumerate().map(name).collect()
}
