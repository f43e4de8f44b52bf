//! The native part of the Python package `pluvia`: runs commands of the program within the
//! interpreter's process, and reads specimens of run folders back.

mod command;
mod specimen;

use pyo3::prelude::*;

/// Native part of the package; `pluvia` is what to import.
#[pymodule]
mod _pluvia {
    #[pymodule_export]
    use super::command::command;
    #[pymodule_export]
    use super::specimen::Specimen;

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
