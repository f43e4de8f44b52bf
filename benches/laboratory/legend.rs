//! Lines in figures: their names, and of which realisations they are.

/// Names of lines in a figure, each of a kind by its number: the first of a kind has its name, the
/// others have none.
pub fn names(kinds: &[String], lines: &[usize]) -> Vec<String> {
    let name = |(n, kind): (usize, &usize)| {
        let is_first = !lines[..n].contains(kind);
        if is_first { kinds[*kind].clone() } else { String::new() }
    };
    lines.iter().enumerate().map(name).collect()
}

/// Realisations of a state that have a value: how many have one is known, and why others have none,
/// in words that begin with the name of the run.
pub fn realisations(state: &str, values: usize, failures: &[String]) -> Vec<u32> {
    let has_value = |n: &u32| {
        let run = format!("{state}-c{n}: ");
        !failures.iter().any(|why| why.starts_with(&run))
    };
    let all = u32::try_from(values + failures.len()).unwrap_or(u32::MAX);
    (1..=all).filter(has_value).collect()
}
