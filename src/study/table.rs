//! A front as a table, with every choice, objective and margin of every design.

use super::outcome::{Front, Judged};
use super::piece_names::{choice_columns, has_parts, joint_columns};
use crate::catalog::Catalogs;
use crate::catalog::gear::GearKind;
use crate::report::front_table::FrontTable;
use crate::report::tube::tube_size;
use crate::sizing::demand::{JointDemand, JointMotion};
use crate::sizing::drive::{Drive, critical_rpm};
use crate::sizing::sheet::JointSizingRow;
use crate::space::design::{Part, id_of, options};
use crate::space::design_space::{DriveChoice, LinkOption, SpacePiece};
use crate::space::levels::OutwardIn;
use crate::space::problem::{ArmProblem, Partial};

/// A front as a table: one row for each design, with its choices, objectives and margins.
pub fn front_table(problem: &ArmProblem, catalogs: &Catalogs, front: &Front) -> FrontTable {
    front_table_with(problem, catalogs, front, |_| ())
}

/// The table of a front. `sized` gets the sizing rows of each design, tip first.
pub(crate) fn front_table_with(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    front: &Front,
    mut sized: impl FnMut(&[JointSizingRow]),
) -> FrontTable {
    FrontTable {
        columns: columns(problem, catalogs),
        rows: front.iter().filter_map(|judged| row(problem, catalogs, judged, &mut sized)).collect(),
    }
}

fn columns(problem: &ArmProblem, catalogs: &Catalogs) -> Vec<String> {
    let mut out = vec!["design_id".to_string()];
    for piece in &problem.space().pieces {
        out.extend(choice_columns(piece));
    }
    out.extend(["tip_deflection_mm", "mass_kg", "lowest_mode_hz", "tie_group"].map(String::from));
    for (i, piece) in problem.space().pieces.iter().enumerate() {
        if problem.sized_joint(i).is_some() || problem.fixed_drive(i, catalogs).is_some() {
            out.extend(joint_columns(piece));
        }
    }
    out.extend(["stress_safety_factor", "material_cost_eur", "extras_mass_kg"].map(String::from));
    out
}

fn row(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    judged: &Judged,
    sized: &mut impl FnMut(&[JointSizingRow]),
) -> Option<Vec<String>> {
    let chosen = options(problem.level_sizes(), judged.design.number)?;
    let mut out = vec![id_of(problem.whole_number(judged.design.number))];
    for (piece, part) in problem.space().pieces.iter().zip(problem.parts(&chosen)?) {
        match (piece, part) {
            (SpacePiece::Choice(_), Part::Link(option)) => out.extend(link_cells(option)),
            (SpacePiece::Joint(_) | SpacePiece::Prismatic(_), Part::Drive(drive)) => {
                out.extend([drive.gear.id.clone(), drive.motor.id.clone()]);
            }
            (SpacePiece::Joint(joint), _) => {
                if let DriveChoice::Given { gear, motor, .. } = &joint.drive
                    && has_parts(&joint.drive)
                {
                    out.extend([gear, motor].map(|part| part.clone().unwrap_or_default()));
                }
            }
            _ => {}
        }
    }
    let o = judged.design.objectives;
    out.extend([o.tip_deflection_m * 1e3, o.mass_kg, o.lowest_mode_hz].map(number));
    out.push(judged.tie_group.to_string());
    let joints = sizing_rows(problem, catalogs, &chosen).ok()?;
    sized(&joints);
    for joint in joints.into_iter().rev() {
        out.push(joint.margin.map_or(String::new(), number));
        out.push(joint.binds.unwrap_or_default().to_string());
        out.push(joint.bearing_margin.map_or(String::new(), number));
        out.push(joint.motor_rms_margin.map_or(String::new(), number));
        out.push(number(joint.input_speed_rpm));
        // only strain-wave gears have a critical speed, because a wave generator excites the arm twice in each turn
        let waves = catalogs.gears.iter().any(|g| g.id == joint.gear && g.kind == GearKind::StrainWave);
        out.push(if waves { number(critical_rpm(o.lowest_mode_hz)) } else { String::new() });
    }
    let complete = problem.walk(&chosen, |_, _| {}).ok()?;
    out.push(problem.stress_safety_factor(&complete).map_or(String::new(), number));
    out.push(problem.material_cost_eur(&complete).map_or(String::new(), number));
    out.push(number(problem.extras_mass_kg(&chosen)?));
    Some(out)
}

fn link_cells(option: &LinkOption) -> [String; 6] {
    let (width, height) = option.section.outer_m();
    [
        option.material_name.clone(),
        option.section.shape().to_string(),
        millimetres(width),
        millimetres(height),
        millimetres(option.section.wall_m()),
        option.profile.clone().unwrap_or_default(),
    ]
}

/// Size and material of a tube in words: `120 x 100 x 3 mm Aluminium 6061-T6`.
pub(super) fn link_words(option: &LinkOption) -> String {
    let [material, shape, width, height, wall, _] = link_cells(option);
    format!("{} {material}", tube_size(&shape, [&width, &height, &wall]))
}

/// A length in millimetres, written as the user gave it: the shortest decimal that reads back to the same length.
fn millimetres(length_m: f64) -> String {
    let near = (length_m * 1e3 * 1e9).round() / 1e9;
    number(if near / 1e3 == length_m { near } else { length_m * 1e3 })
}

/// The shortest decimal that reads back to the same number.
fn number(x: f64) -> String {
    format!("{x}")
}

/// The sizing of every joint of the design with the options `chosen` that has a drive from the catalogs, chosen or
/// given, tip first. The error is the slot (place in the order in which the arm is built) at which no drive meets the
/// demand.
pub(crate) fn sizing_rows(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    chosen: &[u32],
) -> Result<Vec<JointSizingRow>, usize> {
    let mut rows = Vec::new();
    // the drive of a sized joint is known only after it is added, so its row is completed at the next slot
    let mut open: Option<(usize, JointDemand, f64)> = None;
    let complete = problem.walk(chosen, |slot, partial| {
        rows.extend(close(problem, catalogs, open.take(), partial));
        let piece = problem.piece_of_slot(slot);
        if problem.sized_joint(piece).is_some() {
            open = Some((slot, problem.demand_at(partial, slot), problem.mass_kg(partial)));
        } else if let Some(fixed) = problem.fixed_drive(piece, catalogs) {
            let demand = problem.fixed_demand(partial, slot, &fixed.motion);
            let passed = problem.mass_kg(partial)
                + fixed.mass_kg
                + fixed.drive.extras().total_kg()
                + bearing_kg(problem, piece);
            let name = joint_name(problem, piece);
            let row = JointSizingRow::new(name, &fixed.drive, &fixed.motion, &demand, passed);
            rows.push(at_cycle_efficiency(row, catalogs, &fixed.drive, &fixed.motion, &demand));
        }
    })?;
    rows.extend(close(problem, catalogs, open.take(), &complete));
    Ok(rows)
}

/// Mass of the output bearing of the joint `piece` \[kg\] if the study states the bearing as a separate part; otherwise
/// 0.
fn bearing_kg(problem: &ArmProblem, piece: usize) -> f64 {
    match &problem.space().pieces[piece] {
        SpacePiece::Joint(joint) => joint.bearing.stated().map_or(0.0, |bearing| bearing.mass_kg),
        _ => 0.0,
    }
}

fn joint_name<'p>(problem: &'p ArmProblem, piece: usize) -> &'p str {
    match &problem.space().pieces[piece] {
        SpacePiece::Joint(joint) => &joint.name,
        _ => "",
    }
}

/// Completes the sizing row of a joint whose drive is now known. `open` is the joint's slot, its demand and the mass
/// outboard of it \[kg\]; `with_it` is the arm up to this joint with its drive. `None` if no row is open.
fn close(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    open: Option<(usize, JointDemand, f64)>,
    with_it: &Partial,
) -> Option<JointSizingRow> {
    let (slot, demand, outboard_kg) = open?;
    let piece = problem.piece_of_slot(slot);
    let table = &problem.sized_joint(piece)?.table;
    let index = problem.options(with_it).nth(piece)? as usize;
    let passed = outboard_kg + table.mass_kg(index) + bearing_kg(problem, piece);
    let drive = table.drive(index);
    let row = JointSizingRow::new(table.joint(), &drive, table.motion(), &demand, passed);
    Some(at_cycle_efficiency(row, catalogs, &drive, table.motion(), &demand))
}

/// Adds to `row` the efficiency of the gear at the mean speed and mean torque of the duty cycle, if the catalogs have
/// the data. Otherwise the row is returned unchanged.
fn at_cycle_efficiency(
    row: JointSizingRow,
    catalogs: &Catalogs,
    drive: &Drive,
    motion: &JointMotion,
    demand: &JointDemand,
) -> JointSizingRow {
    let load = drive.gear.rated_torque_nm.map(|rated_nm| row.mean_torque_nm / rated_nm);
    let efficiency =
        load.and_then(|load| catalogs.representative_efficiency(drive.gear, row.mean_input_speed_rpm, load));
    match efficiency {
        Some(efficiency) => row.at_efficiency(efficiency, drive, motion, demand),
        None => row,
    }
}
