//! A specimen at the end of a stage, as a run folder holds it.

use std::path::PathBuf;

use pluvia::export::{
    ExportError, Exported, contacts_csv, grains_csv, pairs_csv, read_at_rest, read_run,
};
use pluvia::geometry::Vector;
use pluvia::measure::{
    Container, FORCE_CLASS, HeightMap, LoadedContact, Region, Slice, contacts_of_grains_in, fabric,
    force_distribution, height_cell_over, layers, loaded_contacts, rings, stress_in,
};
use pluvia::protocol::friction_between;
use pluvia::specimen::Fate;
use pluvia::study::container;
use pyo3::{
    exceptions::{PyOSError, PyValueError},
    prelude::*,
    types::PyBytes,
};

/// A specimen at the end of a stage. Arrays are given as bytes of doubles, native in order.
#[pyclass(frozen, module = "pluvia._pluvia")]
pub struct Specimen {
    run: Exported,
    /// The same with the table brought back along y and z: what is measured is measured there.
    level: pluvia::specimen::Specimen,
    container: Container,
    contacts: Vec<LoadedContact>,
}

fn bytes<'py>(py: Python<'py>, numbers: impl IntoIterator<Item = f64>) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> = numbers.into_iter().flat_map(f64::to_ne_bytes).collect();
    PyBytes::new(py, &bytes)
}

fn integers<'py>(py: Python<'py>, numbers: impl IntoIterator<Item = usize>) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> = numbers.into_iter().flat_map(|n| (n as i64).to_ne_bytes()).collect();
    PyBytes::new(py, &bytes)
}

/// A tensor, row by row.
fn tensor<'py>(py: Python<'py>, at: impl Fn(usize, usize) -> f64) -> Bound<'py, PyBytes> {
    bytes(py, (0..9).map(|n| at(n / 3, n % 3)))
}

/// A value error where what was asked for is not there, else one of the system.
fn raised(error: &ExportError) -> PyErr {
    let what = error.to_string();
    match error {
        ExportError::Stage { .. } => PyValueError::new_err(what),
        _ => PyOSError::new_err(what),
    }
}

fn table<E: ToString>(py: Python<'_>, made: Result<Vec<u8>, E>) -> PyResult<Bound<'_, PyBytes>> {
    let text = made.map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok(PyBytes::new(py, &text))
}

impl Specimen {
    /// The box around the container between two heights in m.
    fn layer(&self, low: f64, high: f64) -> Region {
        let Container { centre_x, radius, .. } = self.container;
        // Walls are polygons, whose corners lie beyond the radius.
        let reach = 2.0 * radius;
        Region {
            low: Vector::new(centre_x - reach, -reach, low),
            high: Vector::new(centre_x + reach, reach, high),
        }
    }
}

#[pymethods]
impl Specimen {
    /// Reads the specimen of a run folder at the end of a stage: its number from 0, its name, or
    /// `rest_test`; at rest without one.
    #[staticmethod]
    #[pyo3(signature = (folder, stage=None))]
    fn read(py: Python<'_>, folder: PathBuf, stage: Option<&str>) -> PyResult<Self> {
        py.detach(|| {
            let run = match stage {
                Some(stage) => read_run(&folder, Some(stage))?,
                None => read_at_rest(&folder)?,
            };
            let container = container(&run.setup, &run.specimen);
            let level = run.specimen.on_level_table().into_owned();
            let friction = friction_between(&run.setup, &level.state);
            let contacts = loaded_contacts(&level.state.contacts, friction);
            Ok(Self { run, level, container, contacts })
        })
        .map_err(|error| raised(&error))
    }

    /// Name of the stage.
    #[getter]
    fn stage(&self) -> &str {
        &self.run.made_by.stage
    }

    /// Simulated time in s since the first stage began.
    #[getter]
    fn time_s(&self) -> f64 {
        self.run.made_by.time_s
    }

    /// Why layers and rings have no volume to divide by, in a sentence: a pile has no walls, and the
    /// circle around all grains of a laboratory is not their container. None in the built-in cylinder.
    #[getter]
    fn no_cylinder(&self) -> Option<String> {
        let setup = &self.run.setup;
        if self.run.specimen.state.base.is_some() {
            return Some(
                "a pile has no walls between which its void ratio and mean stress could be measured; \
                 `contacts`, `loaded` and `fabric` are of a pile, too"
                    .to_owned(),
            );
        }
        if setup.pieces.is_empty() {
            return None;
        }
        let instead = setup.measures.regions.first().map_or_else(
            || {
                "name regions in `measures` of the scenario, and `series` has their void ratios and \
                 stresses"
                    .to_owned()
            },
            |region| {
                let name = &region.name;
                format!(
                    "`series` has those of its regions, as in `{name}_void_ratio` and \
                     `{name}_stress_zz_kpa`"
                )
            },
        );
        Some(format!(
            "a laboratory of pieces has no built-in cylinder, and the circle around all grains is not \
             their container: layers of it have no void ratio or mean stress; {instead}"
        ))
    }

    /// Cross-section in m² of the cylinder, of a pile's base, or of the circle around all grains of a
    /// laboratory.
    #[getter]
    fn area_m2(&self) -> f64 {
        self.container.area()
    }

    /// Height of the mean surface above the floor in m, as in `summary.json`.
    fn mean_surface_m(&self, py: Python<'_>) -> PyResult<f64> {
        let cell = height_cell_over(&self.container, &self.level.grains);
        let map = py.detach(|| HeightMap::of(&self.level, &self.container, cell));
        let map = map.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(map.standing_height().mean_surface)
    }

    /// Whether each grain still takes part.
    #[getter]
    fn present(&self) -> Vec<bool> {
        self.run.specimen.state.bodies.iter().map(|b| b.fate == Fate::Present).collect()
    }

    /// Table of the grains, as `pluvia export --format csv` writes it.
    fn grains_csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        table(py, py.detach(|| grains_csv(&self.run.specimen)))
    }

    /// Table of the loaded contacts.
    fn contacts_csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        table(py, py.detach(|| contacts_csv(&self.run.setup, &self.run.specimen)))
    }

    /// Table of the grains that touch.
    fn pairs_csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        table(py, py.detach(|| pairs_csv(&self.run.specimen)))
    }

    /// Centroids in m, x y z of every grain.
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let bodies = self.run.specimen.state.bodies.iter();
        bytes(py, bodies.flat_map(|b| <[f64; 3]>::from(b.body.pose.translation.vector)))
    }

    /// Unit quaternions that turn each grain's principal axes into those of the world, x y z w.
    fn orientations<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let bodies = self.run.specimen.state.bodies.iter();
        bytes(py, bodies.flat_map(|b| <[f64; 4]>::from(b.body.pose.rotation.coords)))
    }

    /// Corners of the grains in m, x y z, where the grains are or, `local`, about their centroids
    /// in principal axes; and how many corners each grain has.
    fn hulls<'py>(
        &self,
        py: Python<'py>,
        local: bool,
    ) -> (Bound<'py, PyBytes>, Bound<'py, PyBytes>) {
        let grains = &self.run.specimen.grains.grains;
        let corners = py.detach(|| {
            let mut corners = Vec::new();
            for (grain, state) in grains.iter().zip(&self.run.specimen.state.bodies) {
                for corner in grain.shape.vertices() {
                    let at = if local { *corner } else { state.body.pose * corner };
                    corners.extend(<[f64; 3]>::from(at.coords));
                }
            }
            corners
        });
        let counts = grains.iter().map(|grain| grain.shape.vertices().len());
        (bytes(py, corners), integers(py, counts))
    }

    /// Faces of a grain: the numbers of their corners, counter-clockwise seen from outside.
    fn faces(&self, grain: usize) -> PyResult<Vec<Vec<u32>>> {
        let grains = &self.run.specimen.grains.grains;
        let found = grains.get(grain).map(|grain| grain.shape.faces().to_vec());
        found.ok_or_else(|| {
            PyValueError::new_err(format!("there is no grain {grain}; there are {}", grains.len()))
        })
    }

    /// Void ratio in `count` layers between two heights in m or, `by_radius`, in rings about the
    /// axis: where each begins and ends in m, volume of its solids in m³, void ratio (NaN where
    /// no grain is).
    fn void_profile<'py>(
        &self,
        py: Python<'py>,
        by_radius: bool,
        low: f64,
        high: f64,
        count: usize,
    ) -> Bound<'py, PyBytes> {
        let found = py.detach(|| {
            let grains = self.container.members(&self.level);
            let Container { centre_x, radius, .. } = self.container;
            match by_radius {
                true => rings(&self.level, &grains, (centre_x, radius), (low, high), count),
                false => layers(&self.level, &grains, self.container.area(), (low, high), count),
            }
        });
        let row = |s: &Slice| [s.from, s.to, s.solids, s.void_ratio().unwrap_or(f64::NAN)];
        bytes(py, found.iter().flat_map(row).collect::<Vec<_>>())
    }

    /// Mean stress in Pa between two heights in m, compression positive, row by row; none where
    /// the engine gave no contacts.
    fn stress<'py>(&self, py: Python<'py>, low: f64, high: f64) -> Option<Bound<'py, PyBytes>> {
        let layer = self.layer(low, high);
        let found = py.detach(|| stress_in(&self.level, &layer))?;
        // The box is wider than the container.
        let share = layer.volume() / (self.container.area() * (high - low));
        Some(tensor(py, |i, j| found.tensor[(i, j)] * share))
    }

    /// Fabric tensor of the contacts between grains between two heights in m, row by row; none
    /// where there are none.
    fn fabric<'py>(&self, py: Python<'py>, low: f64, high: f64) -> Option<Bound<'py, PyBytes>> {
        // Grains below z = 0 and in a funnel may lie farther out than the container.
        let layer = Region {
            low: Vector::new(f64::NEG_INFINITY, f64::NEG_INFINITY, low),
            high: Vector::new(f64::INFINITY, f64::INFINITY, high),
        };
        let found = fabric(contacts_of_grains_in(&self.contacts, &layer))?;
        Some(tensor(py, |i, j| found.tensor[(i, j)]))
    }

    /// Normal forces between grains: their mean in N; width of the classes in means; share of
    /// contacts in each, the last open; 10th, 50th, 90th, 99th percentile and largest in means.
    fn force_distribution(&self) -> Option<(f64, f64, Vec<f64>, [f64; 5])> {
        let between = self.contacts.iter().filter(|contact| contact.is_of_grains());
        let found = force_distribution(between.map(|contact| contact.normal_force))?;
        Some((found.mean, FORCE_CLASS, found.classes, found.percentiles))
    }

    /// Contacts between grains, each counted once: height in m, upward part of the unit normal,
    /// normal force in N, whether it slides (1 or 0).
    fn loaded<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let between = self.contacts.iter().filter(|contact| contact.is_of_grains());
        let row = |c: &LoadedContact| {
            [c.point.z, c.normal.z, c.normal_force, f64::from(u8::from(c.slides))]
        };
        bytes(py, between.flat_map(row))
    }
}
