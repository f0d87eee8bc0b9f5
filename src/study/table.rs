//! A front as a table, with every choice, objective and margin of every design.

use super::outcome::{Front, Judged};
use super::piece_names::{choice_columns, has_parts, joint_columns};
use crate::arm::section::millimetres;
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
use crate::space::problem::ArmProblem;

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
        number(millimetres(width)),
        number(millimetres(height)),
        number(millimetres(option.section.wall_m())),
        option.profile.clone().unwrap_or_default(),
    ]
}

/// Size and material of a tube in words: `120 x 100 x 3 mm Aluminium 6061-T6`.
pub(super) fn link_words(option: &LinkOption) -> String {
    let [material, shape, width, height, wall, _] = link_cells(option);
    format!("{} {material}", tube_size(&shape, [&width, &height, &wall]))
}

/// The number as the shortest decimal text from which the same number is read back.
fn number(x: f64) -> String {
    format!("{x}")
}

/// A joint of a design with its drive from the catalogs, chosen or given.
pub(super) struct DrivenJoint<'c> {
    /// Piece of the joint, counted from the base.
    pub piece: usize,
    /// The drive of the joint.
    pub drive: Drive<'c>,
    /// The motion that the study asks of the joint.
    pub motion: JointMotion,
    /// The demand at the output of the gear.
    pub demand: JointDemand,
    /// Torque at the joint divided by torque at the output of the gear; 1 unless stages are behind the gear.
    pub gain_after_gear: f64,
    /// Mass of the drive that the study states \[kg\]; `None` if the drive is chosen.
    stated_mass_kg: Option<f64>,
    /// Mass of the arm outboard of the joint plus mass of the joint's drive \[kg\].
    inward_kg: f64,
}

/// Every joint of the design with the options `chosen` that has a drive from the catalogs, tip first. The error is the
/// slot (place in the order in which the arm is built) at which no drive meets the demand.
pub(super) fn driven_joints<'c>(
    problem: &ArmProblem<'c>,
    catalogs: &'c Catalogs,
    chosen: &[u32],
) -> Result<Vec<DrivenJoint<'c>>, usize> {
    let mut demands: Vec<(usize, JointDemand)> = Vec::new();
    let complete = problem.walk(chosen, |slot, partial| {
        let piece = problem.piece_of_slot(slot);
        if problem.sized_joint(piece).is_some() {
            demands.push((piece, problem.demand_at(partial, slot)));
        } else if let Some(fixed) = problem.fixed_drive(piece, catalogs) {
            demands.push((piece, problem.fixed_demand(partial, slot, &fixed)));
        }
    })?;
    let options: Vec<u32> = problem.options(&complete).collect();
    let inward_kg = problem.masses_inward_kg(&complete);
    let driven = |(piece, demand): (usize, JointDemand)| {
        let (drive, motion, gain_after_gear, stated_mass_kg) = match problem.sized_joint(piece) {
            Some(sized) => (sized.table.drive(options[piece] as usize), *sized.table.motion(), 1.0, None),
            None => {
                let fixed = problem.fixed_drive(piece, catalogs)?;
                (fixed.drive, fixed.motion, fixed.gain_after_gear(), Some(fixed.mass_kg))
            }
        };
        let inward_kg = inward_kg[piece];
        Some(DrivenJoint { piece, drive, motion, demand, gain_after_gear, stated_mass_kg, inward_kg })
    };
    Ok(demands.into_iter().filter_map(driven).collect())
}

/// The sizing of every joint of the design with the options `chosen` that has a drive from the catalogs, chosen or
/// given, tip first. The error is the slot (place in the order in which the arm is built) at which no drive meets the
/// demand.
pub(crate) fn sizing_rows(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    chosen: &[u32],
) -> Result<Vec<JointSizingRow>, usize> {
    let row = |joint: &DrivenJoint| {
        let DrivenJoint { piece, drive, motion, demand, inward_kg, .. } = joint;
        let name = problem.space().pieces[*piece].name();
        let row = JointSizingRow::new(name, drive, motion, demand, *inward_kg);
        let row = JointSizingRow { mass_kg: joint.stated_mass_kg.or(row.mass_kg), ..row };
        at_cycle_efficiency(row, catalogs, drive, motion, demand)
    };
    Ok(driven_joints(problem, catalogs, chosen)?.iter().map(row).collect())
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
