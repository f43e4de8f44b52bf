//! From an object of a file to closed surfaces: vertices joined, edges counted.

use std::collections::HashMap;

use super::*;

/// A closed surface with outward faces, in m; of a piece, in the file's unit of length.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Surface {
    /// Vertices, no two at one place.
    pub vertices: Vec<Point>,
    /// Faces as loops of vertex numbers, counter-clockwise seen from outside.
    pub faces: Vec<Vec<u32>>,
    /// Enclosed volume, positive.
    pub volume: f64,
}

/// Largest coordinate of a vertex: what it encloses has a volume that is a finite number, in m³ or in
/// mm³ of any unit of length that a scenario may give.
const LARGEST_COORDINATE: f64 = 1e90;

/// The closed surfaces of an object: one, or as many as it holds where the
/// scenario lets them be split. `to_mm` are the millimetres of their unit of length, for people.
///
/// # Errors
/// Everything that is wrong with the object, without file and object.
pub(super) fn surfaces(
    object: &Object,
    spec: &MeshGrains,
    to_mm: f64,
) -> Result<Vec<Surface>, Vec<Fault>> {
    let is_near = |v: &Point| v.coords.iter().all(|c| c.abs() <= LARGEST_COORDINATE);
    if let Some(vertex) = object.vertices.iter().position(|v| !is_near(v)) {
        let v = object.vertices[vertex];
        let (what, allowed) = match v.coords.iter().all(|c| c.is_finite()) {
            true => ("lies too far away", format!("coordinates of at most {LARGEST_COORDINATE:e}")),
            false => ("has a coordinate that is no finite number", "finite numbers".to_owned()),
        };
        let [x, y, z] = [v.x, v.y, v.z].map(|c| match c.abs() > 1e9 {
            true => format!("{c:e}"),
            false => c.to_string(),
        });
        let (what, found) = (format!("vertex {vertex} {what}"), format!("({x}, {y}, {z})"));
        return Err(vec![Fault::new(what, found, allowed)]);
    }
    let (vertices, faces) = welded(object, spec.mesh_unit.metres());
    if faces.is_empty() {
        return Err(vec![Fault::new(
            "no face of the object has an area",
            counted(object.faces.len(), "face"),
            "a closed surface",
        )]);
    }
    let mut faults = edge_faults(&faces);
    let pieces = pieces(vertices.len(), &faces);
    if pieces.len() > 1 && !spec.split_surfaces {
        faults.push(Fault::new(
            "the object holds several surfaces that are not joined",
            format!("{} surfaces", pieces.len()),
            "one grain in an object; or `\"split_surfaces\": true`, where each is a grain",
        ));
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let part = |piece: &Vec<&[u32]>| {
        let (vertices, faces) = used(piece, &vertices);
        let volume = enclosed_volume(&vertices, &faces);
        Surface { vertices, faces, volume }
    };
    let surfaces: Vec<Surface> = pieces.iter().map(part).collect();
    for surface in &surfaces {
        faults.extend(volume_fault(surface, to_mm));
    }
    if faults.is_empty() { Ok(surfaces) } else { Err(faults) }
}

/// Vertices at one place joined (an STL file repeats them for every triangle,
/// an OBJ file along seams of its texture), in m; faces that are left with
/// less than three corners have no area and go.
fn welded(object: &Object, metres: f64) -> (Vec<Point>, Vec<Vec<u32>>) {
    let mut known: HashMap<[u64; 3], u32> = HashMap::new();
    let mut vertices = Vec::new();
    let numbers: Vec<u32> = object
        .vertices
        .iter()
        .map(|v| {
            // Adding zero makes -0 the same place as 0.
            let place = [v.x, v.y, v.z].map(|c| (c + 0.0).to_bits());
            *known.entry(place).or_insert_with(|| {
                vertices.push(Point::from(v.coords * metres));
                vertices.len() as u32 - 1
            })
        })
        .collect();
    let joined = |corners: &Vec<u32>| loop_of(corners.iter().map(|&c| numbers[c as usize]));
    let faces = object.faces.iter().filter_map(joined).collect();
    (vertices, faces)
}

/// Says how many edges are not shared by two faces that run around alike.
fn edge_faults(faces: &[Vec<u32>]) -> Vec<Fault> {
    // Of each edge, how often it is run along upwards and downwards.
    let mut uses: HashMap<(u32, u32), [usize; 2]> = HashMap::new();
    for face in faces {
        for (a, b) in edges_of(face) {
            uses.entry((a.min(b), a.max(b))).or_default()[usize::from(a > b)] += 1;
        }
    }
    let count = |is: fn(&[usize; 2]) -> bool| uses.values().filter(|u| is(u)).count();
    let all = uses.len();
    let mut faults = Vec::new();
    let mut add = |edges: usize, message: &str, allowed: &str| {
        if edges > 0 {
            let found = format!("{edges} of {all} edges");
            faults.push(Fault::new(message, found, allowed));
        }
    };
    add(
        count(|u| u[0] + u[1] == 1),
        "the surface is open: edges belong to one face only",
        "a closed surface; fill the holes of the scan first",
    );
    add(
        count(|u| u[0] + u[1] > 2),
        "edges belong to more than two faces, as where grains touch or surfaces cross",
        "two faces at each edge, and each grain in an object or file of its own",
    );
    add(
        count(|u| u[0] + u[1] == 2 && u[0] != 1),
        "faces that meet there run around in opposite senses",
        "faces all counter-clockwise seen from outside; make the normals consistent",
    );
    faults
}

/// Faces by the surface they belong to: those that share vertices.
fn pieces(vertices: usize, faces: &[Vec<u32>]) -> Vec<Vec<&[u32]>> {
    let mut joined: Vec<u32> = (0..vertices as u32).collect();
    fn root(joined: &mut [u32], mut v: u32) -> u32 {
        while joined[v as usize] != v {
            // Halves the way for the next time.
            joined[v as usize] = joined[joined[v as usize] as usize];
            v = joined[v as usize];
        }
        v
    }
    for face in faces {
        for pair in face.windows(2) {
            let (a, b) = (root(&mut joined, pair[0]), root(&mut joined, pair[1]));
            joined[a.max(b) as usize] = a.min(b);
        }
    }
    let mut number: HashMap<u32, usize> = HashMap::new();
    let mut pieces: Vec<Vec<&[u32]>> = Vec::new();
    for face in faces {
        let own = root(&mut joined, face[0]);
        let piece = *number.entry(own).or_insert_with(|| {
            pieces.push(Vec::new());
            pieces.len() - 1
        });
        pieces[piece].push(face);
    }
    pieces
}

/// Least volume of a grain, as a fraction of the cube of its largest
/// dimension: a square sheet a ten-thousandth as thick as it is wide is none.
const LEAST_VOLUME: f64 = 1e-4;

fn volume_fault(surface: &Surface, to_mm: f64) -> Option<Fault> {
    let largest = extent(&surface.vertices);
    let least = LEAST_VOLUME * largest.powi(3);
    let in_mm3 = |volume: f64| format!("{} mm³", rounded(volume * to_mm.powi(3)));
    if surface.volume < -least {
        return Some(Fault::new(
            "the surface is turned inside out: it encloses a negative volume",
            in_mm3(surface.volume),
            "faces counter-clockwise seen from outside; flip the normals of the mesh",
        ));
    }
    if !(surface.volume > least) {
        return Some(Fault::new(
            "the grain has no volume to speak of for its size",
            in_mm3(surface.volume),
            format!("more than {}", in_mm3(least)),
        ));
    }
    None
}

/// Largest side of the bounding box in m.
pub(super) fn extent(vertices: &[Point]) -> f64 {
    let Some(first) = vertices.first() else { return 0.0 };
    let (low, high) = vertices.iter().fold((*first, *first), |(lo, hi), v| (lo.inf(v), hi.sup(v)));
    (high - low).max()
}
