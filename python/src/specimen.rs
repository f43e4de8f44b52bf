//! A specimen at the end of a stage, as a run folder holds it.

use std::path::PathBuf;

use pluvia::export::{
    ExportError, Exported, contacts_csv, grains_csv, pairs_csv, read_at_rest, read_run,
};
use pluvia::measure::{Container, HeightMap, Layer, height_cell, void_profile};
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
    container: Container,
}

fn bytes<'py>(py: Python<'py>, numbers: impl IntoIterator<Item = f64>) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> = numbers.into_iter().flat_map(f64::to_ne_bytes).collect();
    PyBytes::new(py, &bytes)
}

fn integers<'py>(py: Python<'py>, numbers: impl IntoIterator<Item = usize>) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> = numbers.into_iter().flat_map(|n| (n as i64).to_ne_bytes()).collect();
    PyBytes::new(py, &bytes)
}

/// A value error where what was asked for is not there, else one of the system.
fn raised(error: &ExportError) -> PyErr {
    let what = error.to_string();
    match error {
        ExportError::NoStage { .. } => PyValueError::new_err(what),
        _ => PyOSError::new_err(what),
    }
}

fn table<E: ToString>(py: Python<'_>, made: Result<Vec<u8>, E>) -> PyResult<Bound<'_, PyBytes>> {
    let text = made.map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok(PyBytes::new(py, &text))
}

#[pymethods]
impl Specimen {
    /// Reads the specimen of a run folder at the end of a stage: its number from 0, its name, or
    /// `rest_test`; at rest without one.
    #[staticmethod]
    #[pyo3(signature = (folder, stage=None))]
    fn read(py: Python<'_>, folder: PathBuf, stage: Option<&str>) -> PyResult<Self> {
        let run = py.detach(|| match stage {
            Some(stage) => read_run(&folder, Some(stage)),
            None => read_at_rest(&folder),
        });
        let run = run.map_err(|error| raised(&error))?;
        let container = container(&run.setup, &run.specimen);
        Ok(Self { run, container })
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

    /// The container: x of the axis, inner radius and inner height, in m.
    #[getter]
    fn container_m(&self) -> (f64, f64, f64) {
        (self.container.centre_x, self.container.radius, self.container.height)
    }

    /// Height of the mean surface above the floor in m, as in `summary.json`.
    fn mean_surface_m(&self, py: Python<'_>) -> PyResult<f64> {
        let specimen = &self.run.specimen;
        let cell = height_cell(&specimen.grains);
        let map = py.detach(|| HeightMap::of(specimen, &self.container, cell));
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

    /// Layers of equal thickness from the floor to a height in m: lower side and upper side in m,
    /// volume of solids in m³, void ratio (NaN where no grain is), of each.
    fn void_profile<'py>(
        &self,
        py: Python<'py>,
        height: f64,
        layers: usize,
    ) -> Bound<'py, PyBytes> {
        let found = py.detach(|| void_profile(&self.run.specimen, &self.container, height, layers));
        let row = |l: &Layer| [l.low, l.high, l.solids_volume, l.void_ratio.unwrap_or(f64::NAN)];
        bytes(py, found.iter().flat_map(row).collect::<Vec<_>>())
    }
}
