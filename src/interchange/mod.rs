//! Exchange with other tools: robots of URDF files become arms, and arms become models for finite elements,
//! simulation and purchase.
//!
//! - Import: `import` makes an arm of the path from the root of a URDF file to a tip. `urdf_file` reads the file with
//!   the crate `urdf-rs` as a tree of links (`urdf_tree`). `urdf_place` finds the lines of faults, which the crate does
//!   not report, and `urdf_faults` what it does not check; `circles` finds loops. `given` reads
//!   the stiffness file, which states the stiffness of the joints. `keys` has the keys of the stiffness file and of
//!   `import.json`. `report` says what became of every link and joint of the URDF.
//! - Export: `request` has the input of an export, and `export` writes an arm in a load case. `snapshot` has the
//!   springs of the arm at their working points. `tree` converts the arm to a chain of rigid bodies, which `mjcf` and
//!   `urdf_out` write. `motors` finds the inertia, peak torque and backlash of the drives in the catalogs. `calculix`
//!   converts the arm to solids, `bill` and `design_table` to tables. `table_notes` names what the tables lack.
//!   `left_out` lists what a file cannot represent, each with its part of the tip deflection.

pub(crate) mod bill;
mod bill_motors;
mod bill_rows;
pub(crate) mod calculix;
mod circles;
mod csv_text;
pub(crate) mod design_table;
pub(crate) mod export;
mod free_name;
pub(crate) mod given;
pub(crate) mod import;
pub(crate) mod keys;
pub(crate) mod left_out;
pub(crate) mod mjcf;
mod motors;
pub(crate) mod report;
pub(crate) mod request;
pub(crate) mod snapshot;
mod table_notes;
mod time_step;
pub(crate) mod tree;
mod urdf_faults;
pub(crate) mod urdf_file;
pub(crate) mod urdf_out;
mod urdf_place;
mod urdf_shapes;
mod urdf_tree;
pub(crate) mod xml;

pub use export::Format;
pub use request::{ExportRequest, Exported};

use crate::arm::Arm;
use crate::catalog::Catalogs;
use crate::input::json::{Document, Faults};
use serde_json::Value;

/// The arm on the path from the root of a URDF file to a link, and the report of the import, the content of
/// `import.json`.
///
/// `file` is the name of the file in messages. `stiffness` is a stiffness file as described in docs/interchange.md.
/// Joints that it does not name are rigid.
///
/// # Errors
/// All faults of the URDF file, or all faults of the stiffness file.
///
/// ```
/// use armwright::catalog::Catalogs;
/// use armwright::interchange::import_urdf;
///
/// let text = r#"<robot name="lever"><link name="base"/>
///     <link name="arm"><inertial><origin xyz="0.4 0 0"/><mass value="2"/>
///       <inertia ixx="0" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
///     <joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint></robot>"#;
/// let (arm, report) = import_urdf("lever.urdf", text, "arm", None, &Catalogs::default()).expect("a sound robot");
/// assert_eq!((arm.mass_kg(), arm.driven_joint_names()), (2.0, vec!["j"]));
/// assert_eq!(report["left_rigid"][0], "j");
/// ```
pub fn import_urdf(
    file: &str,
    text: &str,
    tip: &str,
    stiffness: Option<Document>,
    catalogs: &Catalogs,
) -> Result<(Arm, Value), Faults> {
    let robot = import::Robot::read(file, text, tip)?;
    let given = match stiffness {
        Some(document) => given::read_given(document, &robot.joints(), catalogs)?,
        None => Vec::new(),
    };
    let (arm, report) = robot.arm(&given)?;
    Ok((arm, report.to_json()))
}
