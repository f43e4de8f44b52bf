//! Wavefront OBJ: the statements `v`, `f`, `o` and `g`; all others (normals,
//! textures, materials, smoothing) do not concern the shape and are passed over.
//!
//! Read here and not by a crate: those at hand part an object wherever its
//! material changes, which would make several open surfaces of one textured
//! scan, and do not say in which line a fault stands.

use std::borrow::Cow;

use super::*;

/// Reads the objects of an OBJ file. Where objects (`o`) are named, they are
/// the grains; where only groups (`g`) are, the groups; else all is one grain.
pub(super) fn parse(bytes: &[u8]) -> Result<Vec<Object>, ReadError> {
    let Ok(text) = std::str::from_utf8(without_mark(bytes)) else {
        let message = "the file is not text, as OBJ files are";
        return Err(ReadError::fault(message, "other bytes", "text in UTF-8"));
    };
    let statements = statements(text);
    let is_object = |line: &str| line.split_whitespace().next() == Some("o");
    let key = if statements.iter().any(|(_, line)| is_object(line)) { "o" } else { "g" };
    let mut vertices: Vec<Point> = Vec::new();
    let mut parts: Vec<(String, Vec<Vec<u32>>)> = Vec::new();
    let mut current = None;
    for (line_number, line) in &statements {
        let line_number = *line_number;
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => vertices.push(vertex(words, line, line_number)?),
            Some("f") => {
                let words = words.take_while(|word| !word.starts_with('#'));
                let face = face(words, line, line_number, vertices.len())?;
                let part = *current.get_or_insert_with(|| {
                    parts.push(("object 1".into(), Vec::new()));
                    parts.len() - 1
                });
                parts[part].1.push(face);
            }
            Some(word) if word == key => {
                let name = words.collect::<Vec<_>>().join(" ");
                let name = match name.is_empty() {
                    true => format!("object {}", parts.len() + 1),
                    false => name,
                };
                // A group may be left and come back to.
                let known = parts.iter().position(|(other, _)| *other == name);
                current = Some(known.filter(|_| key == "g").unwrap_or_else(|| {
                    parts.push((name, Vec::new()));
                    parts.len() - 1
                }));
            }
            _ => {}
        }
    }
    let object = |(name, faces): (String, Vec<Vec<u32>>)| {
        let (vertices, faces) = used(&faces, &vertices);
        Object { name, vertices, faces }
    };
    Ok(parts.into_iter().map(object).collect())
}

/// The statements with the numbers of the lines that they begin in. A line that ends in a backslash
/// goes on in the next, but a comment does not: paths of Windows may end in one.
fn statements(text: &str) -> Vec<(usize, Cow<'_, str>)> {
    let mut statements: Vec<(usize, Cow<'_, str>)> = Vec::new();
    let mut goes_on = false;
    for (index, line) in text.lines().enumerate() {
        let is_comment = !goes_on && line.trim_start().starts_with('#');
        let begun = line.strip_suffix('\\').filter(|_| !is_comment);
        let words = begun.unwrap_or(line);
        match statements.last_mut() {
            Some((_, before)) if goes_on => {
                let before = before.to_mut();
                before.push(' ');
                before.push_str(words);
            }
            _ => statements.push((index + 1, Cow::Borrowed(words))),
        }
        goes_on = begun.is_some();
    }
    statements
}

fn vertex<'a>(
    words: impl Iterator<Item = &'a str>,
    line: &str,
    number: usize,
) -> Result<Point, ReadError> {
    let coordinates: Vec<f64> = words.take(3).map_while(|word| word.parse().ok()).collect();
    match coordinates[..] {
        [x, y, z] => Ok(Point::new(x, y, z)),
        _ => Err(ReadError::fault(
            format!("line {number}: a vertex lacks a coordinate"),
            shortened(line),
            "`v` and three numbers",
        )),
    }
}

/// Corners as indices from 0. A file counts vertices from 1, and from the last
/// one backwards with negative numbers.
fn face<'a>(
    words: impl Iterator<Item = &'a str>,
    line: &str,
    number: usize,
    vertices: usize,
) -> Result<Vec<u32>, ReadError> {
    let index = |word: &str| -> Option<u32> {
        // `7/2/5`: vertex, texture, normal.
        let given: i64 = word.split('/').next()?.parse().ok()?;
        let from_zero = if given < 0 { i64::try_from(vertices).ok()? + given } else { given - 1 };
        u32::try_from(from_zero).ok().filter(|index| (*index as usize) < vertices)
    };
    let mut corners = Vec::new();
    for word in words {
        match index(word) {
            Some(index) => corners.push(index),
            None => {
                return Err(ReadError::fault(
                    format!("line {number}: a face names a vertex that is not there"),
                    word,
                    &format!("whole numbers from 1 to {vertices}, the vertices given before"),
                ));
            }
        }
    }
    if corners.len() < 3 {
        let message = format!("line {number}: a face has too few corners");
        return Err(ReadError::fault(message, shortened(line), "`f` and at least three vertices"));
    }
    Ok(corners)
}

fn shortened(line: &str) -> String {
    let line = line.trim();
    match line.char_indices().nth(60) {
        Some((end, _)) => format!("`{}…`", &line[..end]),
        None => format!("`{line}`"),
    }
}
