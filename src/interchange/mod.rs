//! To other tools and back: robots of URDF files as arms, and arms as models for finite elements, simulation and purchase.
//!
//! - In: [`import`] makes an arm of the way from the root of a URDF file ([`urdf_file`], read by the crate `urdf-rs`) to a tip.
//!   [`given`] reads what a URDF does not know, the stiffness of the joints; [`report`] says what became of the rest.
//! - Out: [`export`] writes an arm in a load case. [`snapshot`] has its springs at their working points, and [`tree`] makes it a chain
//!   of rigid bodies for [`mjcf`] and [`urdf_out`]. [`calculix`] makes solids of it, [`bill`] and [`design_table`] make tables.
//!   [`left_out`] says what a file cannot carry, with its share of the tip's deflection.

pub(crate) mod bill;
pub(crate) mod calculix;
mod csv_text;
pub(crate) mod design_table;
pub(crate) mod export;
pub(crate) mod given;
pub(crate) mod import;
pub(crate) mod left_out;
pub(crate) mod mjcf;
pub(crate) mod report;
pub(crate) mod snapshot;
pub(crate) mod tree;
pub(crate) mod urdf_file;
pub(crate) mod urdf_out;
mod xml;
