//! VTK's XML file of polygons, lines and points (`.vtp`): a head of XML, then
//! the numbers as they are in memory, each array compressed by zlib. The format
//! is VTK's own default, and described in its documentation under "VTK XML
//! formats"; `make test-exports` has VTK itself read what is written here.

use std::{
    fmt::Write as _,
    io::{self, Write as _},
};

use flate2::{Compression, write::ZlibEncoder};

use crate::geometry::{Point, Vector};

/// Numbers of an array, one entry a point or cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// VTK's name of their type.
    kind: &'static str,
    /// Numbers of an entry.
    components: usize,
    /// The numbers, little-endian.
    numbers: Vec<[u8; 4]>,
}

impl Values {
    /// Whole numbers.
    pub fn ints(of: impl IntoIterator<Item = i32>) -> Self {
        let numbers = of.into_iter().map(i32::to_le_bytes).collect();
        Self { kind: "Int32", components: 1, numbers }
    }

    /// Numbers rounded to single precision; NaN where there is none.
    pub fn floats(of: impl Iterator<Item = Option<f64>>) -> Self {
        let single = of.map(|x| x.map_or(f32::NAN, |x| x as f32));
        Self { kind: "Float32", components: 1, numbers: single.map(f32::to_le_bytes).collect() }
    }

    /// Vectors rounded to single precision.
    pub fn vectors(of: impl Iterator<Item = Vector>) -> Self {
        let numbers = of.flat_map(|v| [v.x, v.y, v.z]).map(|x| (x as f32).to_le_bytes());
        Self { kind: "Float32", components: 3, numbers: numbers.collect() }
    }

    /// Every entry as often as is said for it.
    pub fn repeated(&self, times: &[usize]) -> Self {
        let entries = self.numbers.chunks_exact(self.components).zip(times);
        Self { numbers: entries.flat_map(|(entry, &n)| entry.repeat(n)).collect(), ..*self }
    }
}

/// An array with its name.
pub type Named = (&'static str, Values);

/// VTK's name of cells that are points.
pub const VERTS: &str = "Verts";
/// VTK's name of cells that are lines.
pub const LINES: &str = "Lines";
/// VTK's name of cells that are polygons, counter-clockwise seen from outside.
pub const POLYS: &str = "Polys";

/// A file in the making: cells of one kind and what is known of them.
#[derive(Debug, Clone, PartialEq)]
pub struct PolyData {
    kind: &'static str,
    points: Vec<Vector>,
    corners: Vec<i32>,
    /// Number of corners up to the end of each cell.
    ends: Vec<i32>,
    /// Arrays with an entry a point.
    pub point_data: Vec<Named>,
    /// Arrays with an entry a cell.
    pub cell_data: Vec<Named>,
}

impl PolyData {
    /// A file without cells, which are to be [`VERTS`], [`LINES`] or [`POLYS`].
    pub fn new(kind: &'static str) -> Self {
        let (points, corners, ends) = (Vec::new(), Vec::new(), Vec::new());
        Self { kind, points, corners, ends, point_data: Vec::new(), cell_data: Vec::new() }
    }

    /// Adds a point, in m; gives its number.
    pub fn point(&mut self, at: &Point) -> usize {
        self.points.push(at.coords);
        self.points.len() - 1
    }

    /// Adds a cell with the given points.
    pub fn cell(&mut self, points: impl Iterator<Item = usize>) {
        self.corners.extend(points.map(|n| n as i32));
        self.ends.push(self.corners.len() as i32);
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.ends.len()
    }

    /// The file's bytes, for a time in s; nothing in memory makes compression fail.
    pub fn to_bytes(&self, time: f64) -> io::Result<Vec<u8>> {
        let mut appended = Vec::new();
        let mut xml = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\" \
             compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n<FieldData>\n\
             <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
             format=\"ascii\">",
        );
        // Writing into a string cannot fail.
        let _ = writeln!(xml, "{time}</DataArray>\n</FieldData>");
        let _ = write!(xml, "<Piece NumberOfPoints=\"{}\" NumberOfStrips=\"0\"", self.points.len());
        for kind in [VERTS, LINES, POLYS] {
            let count = if kind == self.kind { self.cells() } else { 0 };
            let _ = write!(xml, " NumberOf{kind}=\"{count}\"");
        }
        xml += ">\n";
        for (section, arrays) in [("PointData", &self.point_data), ("CellData", &self.cell_data)] {
            let _ = writeln!(xml, "<{section}>");
            for (name, values) in arrays {
                append(&mut appended, &mut xml, name, values)?;
            }
            let _ = writeln!(xml, "</{section}>");
        }
        xml += "<Points>\n";
        append(&mut appended, &mut xml, "Points", &Values::vectors(self.points.iter().copied()))?;
        let _ = writeln!(xml, "</Points>\n<{}>", self.kind);
        append(
            &mut appended,
            &mut xml,
            "connectivity",
            &Values::ints(self.corners.iter().copied()),
        )?;
        append(&mut appended, &mut xml, "offsets", &Values::ints(self.ends.iter().copied()))?;
        let _ = writeln!(xml, "</{}>\n</Piece>\n</PolyData>", self.kind);
        // The numbers begin after the underscore.
        xml += "<AppendedData encoding=\"raw\">\n_";
        let mut bytes = xml.into_bytes();
        bytes.extend(appended);
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        Ok(bytes)
    }
}

/// Adds an array: its head to the XML, and its numbers, compressed, to those before them.
fn append(bytes: &mut Vec<u8>, xml: &mut String, name: &str, values: &Values) -> io::Result<()> {
    let Values { kind, components, numbers } = values;
    let _ = writeln!(
        xml,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
         format=\"appended\" offset=\"{}\"/>",
        bytes.len()
    );
    let plain = numbers.as_flattened();
    // Head of an array: number of blocks, size of a block, size of a last block that is not
    // full, then the compressed size of each block. An array is one full block here, or none.
    let blocks = u64::from(!plain.is_empty());
    for number in [blocks, plain.len() as u64, 0] {
        bytes.extend(number.to_le_bytes());
    }
    if !plain.is_empty() {
        let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
        packed.write_all(plain)?;
        let packed = packed.finish()?;
        bytes.extend((packed.len() as u64).to_le_bytes());
        bytes.extend(packed);
    }
    Ok(())
}

/// ParaView's list of files by time (`.pvd`); paths are relative to it.
pub fn collection(entries: &[(f64, String)]) -> String {
    let mut xml = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" \
         byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, file) in entries {
        let _ =
            writeln!(xml, "<DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}\"/>");
    }
    xml + "</Collection>\n</VTKFile>\n"
}
