//! The native part of the Python package `armwright`. Arms, cases and results are passed between Python and Rust as
//! JSON text. It is the text that the program reads and prints, so that numbers are equal to the last digit. The Python
//! code in `python/armwright` turns it into Python objects.

mod catalogs;
mod conduct;
mod errors;
mod questions;
mod run;
mod source;

use pyo3::prelude::*;

#[pymodule]
fn _armwright(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<catalogs::Catalogs>()?;
    module.add_function(wrap_pyfunction!(questions::analyze, module)?)?;
    module.add_function(wrap_pyfunction!(questions::driven_joints, module)?)?;
    module.add_function(wrap_pyfunction!(questions::size, module)?)?;
    module.add_function(wrap_pyfunction!(questions::capacity, module)?)?;
    module.add_function(wrap_pyfunction!(questions::design, module)?)?;
    module.add_function(wrap_pyfunction!(questions::export, module)?)?;
    module.add_function(wrap_pyfunction!(questions::from_urdf, module)?)?;
    module.add_function(wrap_pyfunction!(questions::paper, module)?)?;
    module.add_function(wrap_pyfunction!(questions::study_names, module)?)?;
    module.add_function(wrap_pyfunction!(questions::study_text, module)?)?;
    module.add_function(wrap_pyfunction!(questions::reconcile, module)?)?;
    module.add_function(wrap_pyfunction!(questions::predict, module)?)?;
    module.add_function(wrap_pyfunction!(run::run, module)?)?;
    Ok(())
}
