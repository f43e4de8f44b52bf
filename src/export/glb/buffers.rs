//! The binary part of a glTF file, and the accessors that say what its bytes are.

use super::*;

/// What the bytes of a stretch of the buffer are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Use {
    Positions,
    /// Their normals.
    Normals,
    /// Numbers of the corners of triangles.
    Indices,
    /// Times and values of animations.
    Animation,
}

/// glTF's `FLOAT`, `UNSIGNED_SHORT` and `UNSIGNED_INT`, and the targets
/// `ARRAY_BUFFER` and `ELEMENT_ARRAY_BUFFER` (glTF 2.0, sections 3.6.2 and 5.11.5).
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A buffer in the making: one view a use.
#[derive(Debug, Default)]
pub struct Buffers {
    views: Vec<(Use, Vec<u8>)>,
    accessors: Vec<Value>,
}

impl Buffers {
    /// Number and bytes of the view of a use.
    fn view(&mut self, of: Use) -> (usize, &mut Vec<u8>) {
        let number = self.views.iter().position(|(u, _)| *u == of).unwrap_or(self.views.len());
        if number == self.views.len() {
            self.views.push((of, Vec::new()));
        }
        (number, &mut self.views[number].1)
    }

    fn add(&mut self, of: Use, bytes: impl Iterator<Item = u8>, mut accessor: Value) -> usize {
        let (number, view) = self.view(of);
        accessor["bufferView"] = number.into();
        accessor["byteOffset"] = view.len().into();
        view.extend(bytes);
        // Numbers begin at multiples of their own size, four at most here.
        view.resize(view.len().next_multiple_of(4), 0);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds vectors of `N` numbers; gives the accessor. Bounds go with
    /// positions and with times, where glTF demands them.
    pub fn floats<const N: usize>(&mut self, of: Use, values: &[[f32; N]]) -> usize {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let mut accessor = json!({ "componentType": FLOAT, "count": values.len(), "type": kind });
        if of == Use::Positions || N == 1 {
            let bound = |best: fn(f32, f32) -> f32| -> Vec<Value> {
                let least = |n: usize| values.iter().map(|v| v[n]).reduce(best).unwrap_or(0.0);
                (0..N).map(|n| number(f64::from(least(n)))).collect()
            };
            accessor["min"] = bound(f32::min).into();
            accessor["max"] = bound(f32::max).into();
        }
        self.add(of, values.iter().flatten().flat_map(|x| x.to_le_bytes()), accessor)
    }

    /// Adds the corners of triangles; gives the accessor.
    pub fn indices(&mut self, corners: &[u32]) -> usize {
        let largest = corners.iter().max().copied().unwrap_or(0);
        // The largest number of a kind is kept for other ends.
        let (kind, size) =
            if largest < u32::from(u16::MAX) { (UNSIGNED_SHORT, 2) } else { (UNSIGNED_INT, 4) };
        let accessor = json!({ "componentType": kind, "count": corners.len(), "type": "SCALAR" });
        // The lower bytes come first.
        let bytes = corners.iter().flat_map(|n| n.to_le_bytes().into_iter().take(size));
        self.add(Use::Indices, bytes, accessor)
    }

    /// Puts the views one after the other: `bufferViews`, `accessors`, and the bytes.
    pub fn finish(self) -> (Vec<Value>, Vec<Value>, Vec<u8>) {
        let (mut views, mut bytes) = (Vec::new(), Vec::new());
        for (of, content) in self.views {
            let mut view = json!({
                "buffer": 0, "byteOffset": bytes.len(), "byteLength": content.len()
            });
            match of {
                Use::Positions | Use::Normals => {
                    view["target"] = ARRAY_BUFFER.into();
                    view["byteStride"] = 12.into();
                }
                Use::Indices => view["target"] = ELEMENT_ARRAY_BUFFER.into(),
                Use::Animation => {}
            }
            views.push(view);
            bytes.extend(content);
        }
        (views, self.accessors, bytes)
    }
}

/// A number in single precision, with no more digits than it needs.
pub fn number(x: f64) -> Value {
    // Negative zero is a zero to every reader but one that compares texts.
    let single = x as f32 + 0.0;
    single.to_string().parse::<f64>().unwrap_or_default().into()
}

/// Numbers in single precision.
pub fn numbers(of: impl IntoIterator<Item = f64>) -> Value {
    of.into_iter().map(number).collect::<Vec<_>>().into()
}
