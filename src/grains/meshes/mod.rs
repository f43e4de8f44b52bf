//! Grains from meshes: scanned grains, read, checked, made convex, and drawn by sieve fractions.
//!
//! The path of a mesh: a file is read into objects ([`read`]); of each the
//! vertices are joined and the surface is checked ([`surface`]); it becomes a
//! convex polyhedron, if it is not one already ([`shape`]); grains
//! are drawn and scaled ([`draw`]). All faults of all files are reported at once.

mod draw;
mod obj;
mod object;
mod piece;
mod ply;
mod read;
mod report;
mod shape;
mod stl;
mod surface;

pub(super) use draw::{by_fraction, laid_out, push_laid_out};
pub use piece::parts_of_piece;
pub use report::{MeshRecord, meshes_csv};

// What its parts are made of, too.
use std::path::{Path, PathBuf};

use super::*;
use crate::plain::{counted, without_zeros};
use crate::scenario::{Fault, MeshGrains, MeshUnit, ScenarioErrors};
use {object::*, surface::*};

/// Sieve sizes in m that a grain may have before it is scaled: what is finer
/// than 0.05 mm is silt, and what is coarser than 1 m no granular soil that
/// this program could carry. Outside, the unit is wrong.
const SIEVE_SIZES: (f64, f64) = (0.05e-3, 1.0);

/// One grain, ready to be drawn.
#[derive(Debug, Clone)]
pub(super) struct Prototype {
    /// Shape about its centroid, in m.
    pub shape: ConvexPolyhedron,
    /// Volume in m³.
    pub volume: f64,
    /// Side of the smallest square opening it passes, in m.
    pub sieve_size: f64,
}

/// Makes grains with the shapes of meshes. The same files, scenario and seed give the same bits.
///
/// # Errors
/// Every fault of every file, each with the file, the object, what was found
/// and what is allowed; and those of the sieve table.
pub fn from_meshes(spec: &MeshGrains, seed: u64) -> Result<GrainSet, ScenarioErrors> {
    let mut faults = Vec::new();
    let mut unreadable: Vec<(PathBuf, String)> = Vec::new();
    let mut prototypes = Vec::new();
    let mut records = Vec::new();
    for path in read::files(&spec.meshes, &mut faults, &mut unreadable) {
        let objects = match read::objects(&path) {
            Ok(objects) => objects,
            Err(ReadError::Unreadable(reason)) => {
                unreadable.push((path, reason));
                continue;
            }
            Err(ReadError::Fault(fault)) => {
                faults.push(Fault { file: path.display().to_string(), ..fault });
                continue;
            }
        };
        let file = path.display().to_string();
        let mut in_file = Vec::new();
        for object in objects {
            let found = each_surface(&object, spec, to_mm(1.0), |surface, name| {
                let (prototype, record) = prototype(surface, spec)?;
                let (file, object) = (file.clone(), name.to_owned());
                records.push(MeshRecord { file, object, ..record });
                prototypes.push(prototype);
                Ok(())
            });
            in_file.extend(found.into_iter().map(|f| Fault { file: file.clone(), ..f }));
        }
        faults.extend(one_of_unit(in_file));
    }
    if faults.is_empty()
        && let Some((file, reason)) = unreadable.first()
    {
        let others = unreadable.len() - 1;
        let more = if others > 0 { format!(", and {others} more") } else { String::new() };
        return Err(ScenarioErrors::Unreadable {
            file: file.clone(),
            reason: format!("{reason} (grains.meshes names it{more})"),
        });
    }
    faults.extend(unreadable.into_iter().map(|(file, reason)| Fault {
        file: file.display().to_string(),
        message: format!("the file cannot be read: {reason}"),
        ..Fault::default()
    }));
    if !faults.is_empty() {
        return Err(ScenarioErrors::Faults(faults));
    }
    draw::draw(spec, seed, &prototypes, records)
        .map_err(|fault| ScenarioErrors::Faults(vec![fault]))
}

/// Makes something of each surface of an object, by its name; faults tell that name, and volumes in
/// mm³ by the millimetres of the surfaces' unit of length.
fn each_surface(
    object: &Object,
    spec: &MeshGrains,
    to_mm: f64,
    mut make: impl FnMut(&Surface, &str) -> Result<(), Fault>,
) -> Vec<Fault> {
    let named = |fault: Fault, name: &str| Fault { path: name.to_owned(), ..fault };
    let surfaces = match surfaces(object, spec, to_mm) {
        Ok(surfaces) => surfaces,
        Err(faults) => return faults.into_iter().map(|f| named(f, &object.name)).collect(),
    };
    let several = surfaces.len() > 1;
    let faults = surfaces.iter().enumerate().filter_map(|(index, surface)| {
        let of_several = || format!("{}, surface {}", object.name, index + 1);
        let name = if several { of_several() } else { object.name.clone() };
        make(surface, &name).err().map(|fault| named(fault, &name))
    });
    faults.collect()
}

/// A closed surface as a grain, and what was done to it.
fn prototype(
    surface: &surface::Surface,
    spec: &MeshGrains,
) -> Result<(Prototype, MeshRecord), Fault> {
    let (convex, record) = shape::convex(surface, spec)?;
    let centroid = MassProperties::of(&convex).centroid;
    let shape = convex.transformed(&Pose::translation(-centroid.x, -centroid.y, -centroid.z));
    let sieve_size = sieve_size(&shape);
    check_size(sieve_size, spec.mesh_unit)?;
    let record = MeshRecord {
        mesh_vertices: surface.vertices.len(),
        mesh_faces: surface.faces.len(),
        mesh_volume: surface.volume,
        vertices: shape.vertices().len(),
        faces: shape.faces().len(),
        volume: shape.signed_volume(),
        sieve_size,
        ..record
    };
    Ok((Prototype { volume: record.volume, shape, sieve_size }, record))
}

/// What is wrong with a size that no grain has.
const NO_SIZE: &str = "the grain's sieve size is out of range";

/// The faults of a file; a size that no grain has, which a wrong unit gives to all of them, only of
/// the first grain, with how many others have one.
fn one_of_unit(faults: Vec<Fault>) -> Vec<Fault> {
    let is_size = |fault: &Fault| fault.message.starts_with(NO_SIZE);
    let (sizes, mut faults): (Vec<Fault>, Vec<Fault>) = faults.into_iter().partition(is_size);
    let others = sizes.len().saturating_sub(1);
    let first = sizes.into_iter().next().map(|first| match others {
        0 => first,
        n => {
            Fault { message: format!("{}; likewise {n} more in this file", first.message), ..first }
        }
    });
    faults.extend(first);
    faults
}

/// Refuses sizes that no grain has, and says which unit would give one.
fn check_size(sieve_size: f64, unit: MeshUnit) -> Result<(), Fault> {
    let (least, most) = SIEVE_SIZES;
    if (least..=most).contains(&sieve_size) {
        return Ok(());
    }
    // Gravel and sand: the likeliest sizes of grains that people have scanned.
    let likely = |other: &MeshUnit| {
        let size = sieve_size / unit.metres() * other.metres();
        (from_mm(0.06)..=from_mm(200.0)).contains(&size).then_some((other.name(), size))
    };
    let hints: Vec<String> = MeshUnit::ALL
        .iter()
        .filter_map(likely)
        .map(|(name, size)| format!("\"{name}\" would give {} mm", rounded(to_mm(size))))
        .collect();
    let hint = match hints.is_empty() {
        true => String::new(),
        false => format!("; is the `mesh_unit` right? {}", hints.join(", ")),
    };
    Err(Fault::new(
        format!("{NO_SIZE}{hint}"),
        format!("{} mm with `mesh_unit` \"{}\"", rounded(to_mm(sieve_size)), unit.name()),
        format!("{} to {} mm", rounded(to_mm(least)), rounded(to_mm(most))),
    ))
}

/// A number for people: three significant digits.
fn rounded(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let exponent = value.abs().log10().floor();
    if !(-4.0..6.0).contains(&exponent) {
        return format!("{value:.2e}");
    }
    let digits = (2.0 - exponent).max(0.0) as usize;
    without_zeros(&format!("{value:.digits$}")).to_owned()
}

#[cfg(test)]
mod hull_tests;
#[cfg(test)]
mod tests;
