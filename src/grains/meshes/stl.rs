//! STL, binary and text, by the crate `stl_io`.
//!
//! What is done before: a binary file is known by its length, because many
//! begin with the word `solid` by which text is known; a text file is cut into
//! its solids, each of which is a grain, and lower-cased, as the format allows
//! both; and normals, which some programs write as `nan`, are left out.

use std::io::Cursor;

use super::*;

/// Bytes of a binary file before its triangles, and of one triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

pub(super) fn parse(bytes: &[u8]) -> Result<Vec<Object>, ReadError> {
    let announced = bytes
        .get(80..HEADER)
        .and_then(|b| b.try_into().ok())
        .map(|b| u32::from_le_bytes(b) as usize);
    let needed = announced.and_then(|n| n.checked_mul(TRIANGLE)?.checked_add(HEADER));
    if needed == Some(bytes.len()) {
        let mut binary = bytes.to_vec();
        // So that the crate does not take it for text.
        binary[..80].fill(b' ');
        return Ok(vec![object("solid 1".into(), &binary)?]);
    }
    let text = without_mark(bytes);
    let begins_as_text =
        text.trim_ascii_start().get(..5).is_some_and(|b| b.eq_ignore_ascii_case(b"solid"));
    // Zero bytes are in every binary file and in no text.
    let binary = announced.is_some() && bytes.contains(&0);
    if begins_as_text && !binary {
        // Names may be of any character set.
        return solids(&String::from_utf8_lossy(text));
    }
    match (announced, needed) {
        (Some(triangles), Some(needed)) => Err(ReadError::fault(
            format!(
                "the binary STL is damaged: it announces {triangles} triangles, which need \
                 {needed} bytes"
            ),
            format!("{} bytes", bytes.len()),
            "84 bytes and 50 for each triangle announced, or a text that begins with `solid`",
        )),
        _ => Err(ReadError::fault(
            "this is no STL file: it is too short for a binary one and does not begin with `solid`",
            format!("{} bytes", bytes.len()),
            "at least 84 bytes, or a text that begins with `solid`",
        )),
    }
}

fn solids(text: &str) -> Result<Vec<Object>, ReadError> {
    let mut solids: Vec<(String, String)> = Vec::new();
    for line in text.lines() {
        let line = line.trim();
        let lower = line.to_ascii_lowercase();
        let mut words = lower.split_whitespace();
        match (words.next(), solids.last_mut()) {
            (Some("solid"), _) => {
                let name = line[5..].trim();
                let number = solids.len() + 1;
                let name = match name.is_empty() {
                    true => format!("solid {number}"),
                    false => format!("solid {number} ({name})"),
                };
                solids.push((name, "solid s\n".into()));
            }
            (Some("facet"), Some((_, body))) => body.push_str("facet normal 0 0 0\n"),
            (Some(_), Some((_, body))) => {
                body.push_str(&lower);
                body.push('\n');
            }
            _ => {}
        }
    }
    solids.into_iter().map(|(name, body)| object(name, body.as_bytes())).collect()
}

fn object(name: String, bytes: &[u8]) -> Result<Object, ReadError> {
    let mesh = stl_io::read_stl(&mut Cursor::new(bytes)).map_err(|error| {
        ReadError::fault(
            format!("{name} cannot be read: {error}"),
            "",
            "facets of three vertices with three finite numbers each",
        )
    })?;
    let point = |v: &stl_io::Vertex| Point::from(v.0.map(f64::from));
    Ok(Object {
        name,
        vertices: mesh.vertices.iter().map(point).collect(),
        faces: mesh.faces.iter().map(|f| f.vertices.map(|v| v as u32).to_vec()).collect(),
    })
}
