//! `grains.json`: the grains as a file that can be read back bit by bit.
//!
//! Lengths are in m, in one frame for the whole file: a block's points and
//! vertices lie between `origin_m` and `origin_m + side_m`.

use std::io::{Read, Write};

use nalgebra::Matrix3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::*;
use crate::geometry::Sphere;
use crate::plain::counted;

/// Relative difference between stated and computed properties that is
/// accepted: files may hold rounded numbers, but not those of another grain.
const STATED_TOLERANCE: f64 = 1e-6;

/// Content of `grains.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GrainsJson {
    /// Density of the solids; without it, it follows from masses and volumes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density_kg_per_m3: Option<f64>,
    /// One block a sieve fraction.
    pub blocks: Vec<BlockJson>,
}

/// One cube and the cells cut from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BlockJson {
    /// The sieves between which its grains belong.
    pub sieve: SieveJson,
    /// Whether nobody specified these sieves, but grains that keep their own size lie between them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub own_sizes: bool,
    /// Side of the cube.
    pub side_m: f64,
    /// Lowest corner of the cube.
    pub origin_m: [f64; 3],
    /// Points of the tessellation, one a cell; none where the cells are no tessellation.
    pub points_m: Vec<[f64; 3]>,
    /// The cells.
    pub cells: Vec<CellJson>,
}

/// Two successive sieves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SieveJson {
    /// Opening of the sieve the grains pass.
    pub passing_mm: f64,
    /// Opening of the sieve that retains them.
    pub retained_mm: f64,
}

/// One grain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellJson {
    /// Radius of a sphere about the centroid, which has neither vertices nor faces here; or of the
    /// ball that sweeps a rounded polyhedron, whose core the vertices and faces are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_m: Option<f64>,
    /// Vertices.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub vertices_m: Vec<[f64; 3]>,
    /// Faces as loops of vertex indices, counter-clockwise seen from outside.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faces: Vec<Vec<u32>>,
    /// Volume.
    pub volume_m3: f64,
    /// Centre of mass, in the frame of the vertices.
    pub centroid_m: [f64; 3],
    /// Mass.
    pub mass_kg: f64,
    /// Inertia tensor about the centroid, axes parallel to those of the vertices.
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// Side of the smallest square opening the grain passes; not read back.
    pub sieve_size_mm: f64,
}

/// The file content of a grain set.
pub fn to_json(grains: &GrainSet) -> GrainsJson {
    let cell = |cell: &ConvexPolyhedron| {
        let properties = MassProperties::of(cell);
        let inertia = properties.inertia_per_density * grains.density;
        let (vertices, faces) = match (cell.sphere(), cell.rounded()) {
            (Some(_), _) => Default::default(),
            (None, Some(rounded)) => (rounded.core.vertices(), rounded.core.faces()),
            (None, None) => (cell.vertices(), cell.faces()),
        };
        let of_ball = cell.rounded().map(|rounded| rounded.radius);
        CellJson {
            radius_m: cell.sphere().map(|sphere| sphere.radius).or(of_ball),
            vertices_m: vertices.iter().map(|v| v.coords.into()).collect(),
            faces: faces.to_vec(),
            volume_m3: properties.volume,
            centroid_m: properties.centroid.coords.into(),
            mass_kg: grains.density * properties.volume,
            inertia_kg_m2: inertia.transpose().into(),
            sieve_size_mm: to_mm(sieve_size(cell)),
        }
    };
    let block = |block: &Block| BlockJson {
        sieve: SieveJson { passing_mm: to_mm(block.passing), retained_mm: to_mm(block.retained) },
        own_sizes: block.own_sizes,
        side_m: block.side,
        origin_m: block.origin.into(),
        points_m: block.points.iter().map(|&p| p.into()).collect(),
        cells: block.cells.par_iter().map(cell).collect(),
    };
    GrainsJson {
        density_kg_per_m3: Some(grains.density),
        blocks: grains.blocks.iter().map(block).collect(),
    }
}

/// The grain set of a file's content. Everything is computed from the meshes;
/// what the file states beside them must agree.
///
/// # Errors
/// The first fault, with the numbers of block and cell.
pub fn from_json(json: &GrainsJson) -> Result<GrainSet, GrainsError> {
    let mut blocks = Vec::with_capacity(json.blocks.len());
    for (index, block) in json.blocks.iter().enumerate() {
        blocks.push(read_block(index, block)?);
    }
    if blocks.iter().all(|b| b.cells.is_empty()) {
        return Err(GrainsError::NoGrains);
    }
    let density = match json.density_kg_per_m3 {
        Some(density) => density,
        None => {
            let stated = || json.blocks.iter().flat_map(|b| &b.cells);
            stated().map(|c| c.mass_kg).sum::<f64>() / stated().map(|c| c.volume_m3).sum::<f64>()
        }
    };
    positive("density of the solids, kg/m³", density)?;
    let mut set = GrainSet::empty(density);
    for (index, (block, stated)) in blocks.into_iter().zip(&json.blocks).enumerate() {
        for (cell, (shape, stated)) in block.cells.iter().zip(&stated.cells).enumerate() {
            check_stated(index, cell, shape, density, stated)?;
        }
        set.push_block(block);
    }
    Ok(set)
}

/// Reads `grains.json`.
///
/// # Errors
/// Text that is no such file, and the faults of [`from_json`].
pub fn read_json(from: impl Read) -> Result<GrainSet, GrainsError> {
    from_json(&serde_json::from_reader(std::io::BufReader::new(from))?)
}

/// Writes `grains.json`, ending in a line feed.
///
/// # Errors
/// When writing fails.
pub fn write_json(grains: &GrainSet, into: impl Write) -> Result<(), GrainsError> {
    let mut out = std::io::BufWriter::new(into);
    serde_json::to_writer(&mut out, &to_json(grains))?;
    writeln!(out)?;
    out.flush()?;
    Ok(())
}

fn read_block(index: usize, json: &BlockJson) -> Result<Block, GrainsError> {
    let fault = |reason: String| Err(GrainsError::BadBlock { block: index, reason });
    let SieveJson { passing_mm, retained_mm } = json.sieve;
    // A fraction without grains has a cube without a size.
    let side = (json.side_m != 0.0 || !json.cells.is_empty()).then_some(("side_m", json.side_m));
    let sieves = [("passing_mm", passing_mm), ("retained_mm", retained_mm)];
    for (name, value) in sieves.into_iter().chain(side) {
        positive(&format!("{name} of block {index}"), value)?;
    }
    if passing_mm <= retained_mm {
        return fault(format!("grains cannot pass {passing_mm} mm and stay on {retained_mm} mm"));
    }
    let (points, cells) = (json.points_m.len(), json.cells.len());
    if points != cells && points != 0 {
        let (points, cells) = (counted(points, "point"), counted(cells, "cell"));
        return fault(format!("it has {points} for {cells}"));
    }
    let origin = Vector::from(json.origin_m);
    // Rounding of origin + side.
    let slack = 1e-9 * json.side_m;
    let inside = |p: &[f64; 3]| {
        (Vector::from(*p) - origin).iter().all(|c| (-slack..=json.side_m + slack).contains(c))
    };
    if !origin.iter().all(|c| c.is_finite()) {
        return fault("its origin is not finite".into());
    }
    if let Some(point) = json.points_m.iter().position(|p| !inside(p)) {
        return fault(format!("point {point} does not lie in the block"));
    }
    let mut shapes = Vec::with_capacity(cells);
    for (cell, stated) in json.cells.iter().enumerate() {
        let polyhedron = || {
            let vertices = stated.vertices_m.iter().map(|&v| Point::from(v)).collect();
            ConvexPolyhedron::new(vertices, stated.faces.clone())
        };
        let shape = match stated.radius_m {
            Some(radius) if stated.vertices_m.is_empty() && stated.faces.is_empty() => {
                ConvexPolyhedron::of_sphere(Sphere { centre: stated.centroid_m.into(), radius })
            }
            Some(radius) => {
                polyhedron().and_then(|core| ConvexPolyhedron::of_rounded(core, radius))
            }
            None => polyhedron(),
        };
        shapes.push(shape.map_err(|source| GrainsError::BadShape {
            block: index,
            cell,
            source,
        })?);
    }
    Ok(Block {
        passing: from_mm(passing_mm),
        retained: from_mm(retained_mm),
        own_sizes: json.own_sizes,
        side: json.side_m,
        origin,
        points: json.points_m.iter().map(|&p| p.into()).collect(),
        first_grain: 0,
        cells: shapes,
    })
}

fn check_stated(
    block: usize,
    cell: usize,
    shape: &ConvexPolyhedron,
    density: f64,
    stated: &CellJson,
) -> Result<(), GrainsError> {
    let properties = MassProperties::of(shape);
    let agree = |property, stated: f64, computed: f64, scale: f64| {
        let tolerance = STATED_TOLERANCE * scale;
        // Not `>`: a NaN agrees with nothing.
        if (stated - computed).abs() <= tolerance {
            return Ok(());
        }
        Err(GrainsError::Contradiction { block, cell, property, stated, computed, tolerance })
    };
    let mass = density * properties.volume;
    agree("volume_m3", stated.volume_m3, properties.volume, properties.volume)?;
    agree("mass_kg", stated.mass_kg, mass, mass)?;
    let size = shape.equivalent_diameter();
    for (stated, computed) in stated.centroid_m.iter().zip(properties.centroid.iter()) {
        agree("centroid_m", *stated, *computed, size)?;
    }
    let inertia = properties.inertia_per_density * density;
    let stated = Matrix3::from(stated.inertia_kg_m2).transpose();
    for (stated, computed) in stated.iter().zip(inertia.iter()) {
        agree("inertia_kg_m2", *stated, *computed, inertia.trace())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grains::generate;
    use crate::grains::tests::{few_grains, near};

    fn written(grains: &GrainSet) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_json(grains, &mut bytes).unwrap();
        bytes
    }

    #[test]
    fn what_is_read_back_is_what_was_written_bit_by_bit() {
        let grains = generate(&few_grains(), 7).unwrap();
        let bytes = written(&grains);
        let back = read_json(&bytes[..]).unwrap();
        assert_eq!(grains, back, "the grains read back are those written");
        assert!(bytes == written(&back), "writing them again gives the same bytes");
        for grain in &back.grains {
            grain.shape.sanity_check().unwrap();
        }
    }

    #[test]
    fn the_fields_are_those_of_the_contract() {
        let json = serde_json::to_value(to_json(&generate(&few_grains(), 1).unwrap())).unwrap();
        let keys =
            |v: &serde_json::Value| v.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
        let block = &json["blocks"][0];
        assert_eq!(keys(block), ["sieve", "side_m", "origin_m", "points_m", "cells"]);
        assert_eq!(keys(&block["sieve"]), ["passing_mm", "retained_mm"]);
        assert_eq!(
            keys(&block["cells"][0]),
            [
                "vertices_m",
                "faces",
                "volume_m3",
                "centroid_m",
                "mass_kg",
                "inertia_kg_m2",
                "sieve_size_mm"
            ]
        );
        assert_eq!(block["points_m"][0].as_array().unwrap().len(), 3, "a point is [x, y, z]");
        assert_eq!(block["sieve"]["passing_mm"], 16.0, "sieves survive the change of units");
    }

    #[test]
    fn the_density_follows_from_the_masses_where_it_is_not_stated() {
        let grains = generate(&few_grains(), 1).unwrap();
        let json = GrainsJson { density_kg_per_m3: None, ..to_json(&grains) };
        let got = from_json(&json).unwrap().density;
        let expected = grains.density;
        near("density = mass / volume", got, expected, 1e-9 * expected);
    }

    #[test]
    fn faults_name_block_and_cell() {
        let good = to_json(&generate(&few_grains(), 1).unwrap());
        let fault = |change: &dyn Fn(&mut GrainsJson)| {
            let mut json = good.clone();
            change(&mut json);
            from_json(&json).expect_err("the change must be noticed")
        };
        for off in [1.0 - 2e-6, 1.0 + 2e-6] {
            for (name, e) in [
                ("volume_m3", fault(&|j| j.blocks[1].cells[2].volume_m3 *= off)),
                ("mass_kg", fault(&|j| j.blocks[1].cells[2].mass_kg *= off)),
                ("centroid_m", fault(&|j| j.blocks[1].cells[2].centroid_m[0] *= off)),
                (
                    "inertia_kg_m2",
                    fault(&|j| {
                        j.blocks[1].cells[2].inertia_kg_m2.iter_mut().flatten().for_each(|i| {
                            *i *= 1.0 + 5.0 * (off - 1.0);
                        });
                    }),
                ),
            ] {
                assert!(
                    matches!(e, GrainsError::Contradiction { block: 1, cell: 2, property, .. } if property == name),
                    "{name} off by a factor {off}: {e}"
                );
            }
        }
        let e = fault(&|j| drop(j.blocks[1].cells[2].faces.pop()));
        assert!(matches!(e, GrainsError::BadShape { block: 1, cell: 2, .. }), "open: {e}");
        let e = fault(&|j| j.blocks[0].cells[1].faces.iter_mut().for_each(|f| f.reverse()));
        assert!(matches!(e, GrainsError::BadShape { block: 0, cell: 1, .. }), "inside out: {e}");
        let e = fault(&|j| j.blocks[0].cells[1].vertices_m[0][1] = f64::NAN);
        assert!(matches!(e, GrainsError::BadShape { block: 0, cell: 1, .. }), "NaN: {e}");
        let e = fault(&|j| j.blocks[1].points_m.truncate(1));
        assert!(matches!(e, GrainsError::BadBlock { block: 1, .. }), "a point too few: {e}");
        let e = fault(&|j| j.blocks[0].points_m[0][2] = 1.0);
        assert!(matches!(e, GrainsError::BadBlock { block: 0, .. }), "a point outside: {e}");
        let e = fault(&|j| j.blocks[0].sieve.passing_mm = 1.0);
        assert!(matches!(e, GrainsError::BadBlock { block: 0, .. }), "sieves swapped: {e}");
        let e = fault(&|j| j.blocks[0].origin_m[0] = f64::NAN);
        assert!(matches!(e, GrainsError::BadBlock { block: 0, .. }), "origin NaN: {e}");
        let e = fault(&|j| j.blocks[0].side_m = 0.0);
        assert!(matches!(e, GrainsError::NotPositive { .. }), "no side: {e}");
        let e = fault(&|j| j.density_kg_per_m3 = Some(-1.0));
        assert!(matches!(e, GrainsError::NotPositive { .. }), "density: {e}");
        assert!(matches!(fault(&|j| j.blocks.clear()), GrainsError::NoGrains));
        assert!(matches!(read_json(&b"{}"[..]), Err(GrainsError::Json(_))));
    }
}
