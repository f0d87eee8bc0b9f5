//! The catalogs of parts as a Python class. They are read once and used by every call that gets the object.

use crate::errors::catalog_fault;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// The catalogs of parts.
#[pyclass(module = "armwright", frozen)]
pub(crate) struct Catalogs {
    pub(crate) parts: Arc<armwright::catalog::Catalogs>,
    /// Folder whose rows were added to the built-in rows or replace them; `None` for the built-in rows alone.
    folder: Option<PathBuf>,
}

#[pymethods]
impl Catalogs {
    #[staticmethod]
    fn builtin() -> Self {
        Self { parts: Arc::new(armwright::catalog::Catalogs::builtin()), folder: None }
    }

    #[staticmethod]
    fn load(folder: PathBuf) -> PyResult<Self> {
        let parts = armwright::catalog::Catalogs::load(Some(&folder)).map_err(catalog_fault)?;
        Ok(Self { parts: Arc::new(parts), folder: Some(folder) })
    }

    #[getter]
    fn folder(&self) -> Option<PathBuf> {
        self.folder.clone()
    }

    #[getter]
    fn gears(&self) -> Vec<String> {
        self.parts.gears.iter().map(|gear| gear.id.clone()).collect()
    }

    #[getter]
    fn motors(&self) -> Vec<String> {
        self.parts.motors.iter().map(|motor| motor.id.clone()).collect()
    }

    #[getter]
    fn materials(&self) -> Vec<String> {
        self.parts.materials.iter().map(|material| material.name.clone()).collect()
    }

    fn __repr__(&self) -> String {
        let parts = &self.parts;
        format!(
            "<armwright.Catalogs: {} gears, {} motors, {} materials, {} profiles>",
            parts.gears.len(),
            parts.motors.len(),
            parts.materials.len(),
            parts.profiles.len()
        )
    }
}
