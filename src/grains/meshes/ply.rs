//! PLY, text and binary, by the crate `ply-rs-bw`.
//!
//! Of the vertices `x`, `y` and `z` are read, of the faces the list
//! `vertex_indices` (or `vertex_index`) and, where it is there, `grain`: the
//! number of the grain that a face belongs to, as `pluvia grains` writes it.

use std::collections::BTreeMap;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Header, Property, PropertyAccess, PropertyAccessResult};

use super::*;

/// A vertex or a face; what a property does not say stays empty.
#[derive(Debug, Clone, Default)]
struct Element {
    place: [Option<f64>; 3],
    corners: Option<Vec<i64>>,
    grain: Option<i64>,
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match name {
            "x" => self.place[0] = number(&property),
            "y" => self.place[1] = number(&property),
            "z" => self.place[2] = number(&property),
            "vertex_indices" | "vertex_index" => self.corners = list(&property),
            "grain" => self.grain = number(&property).map(|n| n as i64),
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

fn number(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(v) => v.into(),
        Property::UChar(v) => v.into(),
        Property::Short(v) => v.into(),
        Property::UShort(v) => v.into(),
        Property::Int(v) => v.into(),
        Property::UInt(v) => v.into(),
        Property::Float(v) => v.into(),
        Property::Double(v) => v,
        _ => return None,
    })
}

fn list(property: &Property) -> Option<Vec<i64>> {
    fn all<T: Copy + Into<i64>>(items: &[T]) -> Vec<i64> {
        items.iter().map(|&i| i.into()).collect()
    }
    Some(match property {
        Property::ListChar(v) => all(v),
        Property::ListUChar(v) => all(v),
        Property::ListShort(v) => all(v),
        Property::ListUShort(v) => all(v),
        Property::ListInt(v) => all(v),
        Property::ListUInt(v) => all(v),
        _ => return None,
    })
}

pub(super) fn parse(bytes: &[u8]) -> Result<Vec<Object>, ReadError> {
    let parser = Parser::<Element>::new();
    let unusable = |error: ParseError| {
        // The crate's messages run over several lines.
        let words: Vec<String> =
            error.to_string().split_whitespace().take(40).map(str::to_owned).collect();
        ReadError::fault(
            format!("this is no PLY file that can be read: {}", words.join(" ")),
            "",
            "PLY 1.0 with the elements `vertex` and `face`",
        )
    };
    let mut reader = Reader::new(bytes);
    let header = parser.read_header(&mut reader).map_err(unusable)?;
    check_header(&header, bytes.len())?;
    let payload = parser.read_payload(&mut reader, &header).map_err(unusable)?;
    let elements = |name: &str| payload.get(name).map(Vec::as_slice).unwrap_or_default();
    let vertices = elements("vertex").iter().enumerate().map(|(index, e)| match e.place {
        [Some(x), Some(y), Some(z)] => Ok(Point::new(x, y, z)),
        _ => Err(ReadError::fault(
            format!("vertex {index} lacks a coordinate"),
            "",
            "the number properties `x`, `y` and `z`",
        )),
    });
    let vertices: Vec<Point> = vertices.collect::<Result<_, _>>()?;
    let mut grains: BTreeMap<Option<i64>, Vec<Vec<u32>>> = BTreeMap::new();
    for (index, face) in elements("face").iter().enumerate() {
        let corners = face.corners.as_deref().unwrap_or_default();
        let number = |corner: &i64| {
            let known = u32::try_from(*corner).ok().filter(|c| (*c as usize) < vertices.len());
            known.ok_or_else(|| {
                let message = format!("face {index} names a vertex that is not there");
                let last = vertices.len().saturating_sub(1);
                ReadError::fault(message, corner, &format!("whole numbers from 0 to {last}"))
            })
        };
        let corners: Vec<u32> = corners.iter().map(number).collect::<Result<_, _>>()?;
        if corners.len() < 3 {
            return Err(ReadError::fault(
                format!("face {index} has too few corners"),
                corners.len(),
                "a list `vertex_indices` of at least 3 whole numbers",
            ));
        }
        grains.entry(face.grain).or_default().push(corners);
    }
    let object = |(grain, faces): (Option<i64>, Vec<Vec<u32>>)| {
        let name = grain.map_or_else(|| "object 1".into(), |number| format!("grain {number}"));
        let (vertices, faces) = used(&faces, &vertices);
        Object { name, vertices, faces }
    };
    Ok(grains.into_iter().map(object).collect())
}

/// Counts that the file cannot hold would keep the crate reading for ever:
/// each element takes at least one byte.
fn check_header(header: &Header, bytes: usize) -> Result<(), ReadError> {
    for element in header.elements.values() {
        if element.count > bytes || (element.count > 0 && element.properties.is_empty()) {
            return Err(ReadError::fault(
                format!(
                    "the header announces more `{}` elements than the file holds",
                    element.name
                ),
                element.count,
                &format!("less than the file's {bytes} bytes, each with a property"),
            ));
        }
    }
    Ok(())
}
