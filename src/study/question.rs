//! Translates a study and its designs into the terms of the verifier.
//!
//! The verifier must not learn from the search what can be chosen. So the study, as it was read, is copied here field
//! by field. Designs are translated by the names of gears and motors and by positions in the study's own lists of
//! sections.

use crate::catalog::Catalogs;
use crate::sizing::demand::LinearReading;
use crate::sizing::duty::{Phase, PhaseKind};
use crate::sizing::fit::MotorPlace;
use crate::sizing::requirement::MotionRequirement;
use crate::sizing::select::DriveFilter;
use crate::sizing::stated::StatedPhase;
use crate::space::constraint::Constraints;
use crate::space::design::{Part, number, options};
use crate::space::design_space::{DesignSpace, DriveChoice, LinkChoice, LinkOption, SpaceJoint, SpacePiece};
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;
use crate::verify::judge::Pick;
use crate::verify::question::{
    AllowedParts, AskedDrive, AskedDutyPhase, AskedFit, AskedJoint, AskedLink, AskedMotion, AskedPhase,
    AskedPhaseKind, AskedPiece, AskedRail, AskedStage, AskedTube, Limits, LinearTorque, Question,
};

/// The question of a study for the verifier, without anything that a search computed.
pub fn question(space: &DesignSpace) -> Question {
    Question {
        gravity_m_s2: space.gravity_m_s2,
        down: space.down,
        pieces: space.pieces.iter().map(piece).collect(),
        cases: space.cases.iter().map(|case| space.load_case(case)).collect(),
        judged_cases: space.judged_cases.clone(),
        sizing_cases: space.sizing_cases.clone(),
        motion: motion(&space.motion),
        links: space.links,
        joints: space.joints,
        limits: limits(&space.constraints),
        effects: space.effects.iter().filter(|effect| !effect.is_of_test()).cloned().collect(),
    }
}

fn piece(piece: &SpacePiece) -> AskedPiece {
    match piece {
        SpacePiece::Joint(joint) => AskedPiece::Joint(asked_joint(joint)),
        SpacePiece::Prismatic(slide) => AskedPiece::Prismatic(AskedRail {
            joint: slide.joint.clone(),
            max_speed_m_s: slide.max_speed_m_s,
        }),
        SpacePiece::Link(link) => AskedPiece::Link(link.clone()),
        SpacePiece::Choice(choice) => AskedPiece::Choice(asked_link(choice)),
    }
}

fn asked_joint(joint: &SpaceJoint) -> AskedJoint {
    let drive = match &joint.drive {
        DriveChoice::Given { curve, mass_kg, .. } => AskedDrive::Given { curve: *curve, mass_kg: *mass_kg },
        DriveChoice::FirstFit(filter) => AskedDrive::FirstFit(allowed(filter)),
        DriveChoice::AllFits(filter) => AskedDrive::AllFits(allowed(filter)),
    };
    let phase = |phase: &StatedPhase| AskedDutyPhase {
        torque_nm: phase.torque_nm,
        time_s: phase.time_s,
        speed_rpm: phase.speed_rpm,
    };
    AskedJoint {
        name: joint.name.clone(),
        axis: joint.axis,
        bearing: joint.bearing,
        extras: joint.extras,
        bodies: joint.bodies.clone(),
        drive,
        max_speed_rad_s: joint.max_speed_rad_s,
        has_brake: joint.has_brake,
        duty: joint.duty.iter().flat_map(|duty| &duty.phases).map(phase).collect(),
        connection_share: joint.connection_share,
        stage: AskedStage {
            ratio: joint.stages.before.ratio,
            efficiency: joint.stages.before.efficiency,
            inertia_kgm2: joint.stages.before.inertia_kgm2,
            rad_per_nm: joint.stages.before.rad_per_nm,
        },
        fit: AskedFit {
            gear_to_link_max: joint.fit.gear_to_link_max,
            motor_in_link: joint.fit.motor == MotorPlace::InLink,
            motor_on_axis: joint.fit.motor == MotorPlace::Behind,
            cable_bore_min_m: joint.fit.cable_bore_min_m,
            drive_length_max_m: joint.fit.drive_length_max_m,
            link_length_m: joint.fit.link_length_m,
        },
    }
}

fn allowed(filter: &DriveFilter) -> AllowedParts {
    AllowedParts {
        gear_mass: filter.gear_mass,
        gear_series: filter.gear_series.clone(),
        ratios: filter.ratios.clone(),
        gear_kinds: filter.gear_kinds.clone(),
        gears: filter.gear_ids.clone(),
        actuators: filter.actuator_ids.clone(),
        motor_kinds: filter.motor_kinds.clone(),
        motors: filter.motor_ids.clone(),
    }
}

fn asked_link(choice: &LinkChoice) -> AskedLink {
    let tube = |option: &LinkOption| AskedTube {
        material: option.material,
        section: option.section,
        cost_eur_per_kg: option.cost_eur_per_kg,
    };
    AskedLink {
        name: choice.name.clone(),
        vector_m: choice.vector_m,
        tubes: choice.options.iter().map(tube).collect(),
        bodies: choice.bodies.clone(),
    }
}

fn motion(motion: &MotionRequirement) -> AskedMotion {
    AskedMotion {
        tip_speed_m_s: motion.tip_speed_m_s,
        ramp_time_s: motion.ramp_time_s,
        emergency_deceleration_m_s2: motion.emergency_deceleration_m_s2,
        min_lever_m: motion.min_lever_m,
        phases: motion.duty_cycle.phases.iter().map(phase).collect(),
        life_h: motion.life_h,
        linear_torque: match motion.linear_reading {
            LinearReading::Exact => LinearTorque::OfInertia,
            LinearReading::Paper => LinearTorque::OfStaticTorque,
        },
        gravity_m_s2: motion.gravity_m_s2,
        checks_motor_heat: motion.checks_motor_heat,
        emergency_stops: motion.emergency_stops,
    }
}

fn phase(phase: &Phase) -> AskedPhase {
    let kind = match phase.kind {
        PhaseKind::Accelerate => AskedPhaseKind::Accelerate,
        PhaseKind::Constant => AskedPhaseKind::Constant,
        PhaseKind::Decelerate => AskedPhaseKind::Decelerate,
        PhaseKind::Rest => AskedPhaseKind::Rest,
        PhaseKind::Fraction { of_static_torque, of_speed } => {
            AskedPhaseKind::Fraction { of_static_torque, of_speed }
        }
    };
    AskedPhase { duration_s: phase.duration_s, kind }
}

fn limits(constraints: &Constraints) -> Limits {
    Limits {
        tip_deflection_max_m: constraints.tip_deflection_max_m,
        mass_max_kg: constraints.mass_max_kg,
        lowest_mode_min_hz: constraints.lowest_mode_min_hz,
        servo_hz_and_ratio: constraints.servo.map(|servo| [servo.bandwidth_hz, servo.ratio]),
        stress_safety_factor_min: constraints.stress_safety_factor_min,
        wall_slenderness_max: constraints.wall_slenderness_max,
        material_cost_max_eur: constraints.material_cost_max_eur,
    }
}

/// The parts of the design with the number `design` in `problem`, base to tip. Tubes are given by their positions in
/// the study's complete lists. `None` if the design does not meet its limits by the search's rules.
pub fn picks(problem: &ArmProblem, catalogs: &Catalogs, design: u128) -> Option<Vec<Pick>> {
    let chosen = options(problem.level_sizes(), design)?;
    let parts = problem.parts(&chosen)?;
    let mut levels = chosen.into_iter();
    let mut picks = Vec::new();
    for (piece, part) in problem.space().pieces.iter().zip(parts).rev() {
        let level = is_level(piece).then(|| levels.next()).flatten();
        picks.push(match (piece, part) {
            (SpacePiece::Choice(choice), _) => {
                let option = level?;
                let places = choice.excerpt.as_ref().map(|excerpt| &excerpt.places);
                Pick::Tube(places.map_or(option, |places| places[option as usize]) as usize)
            }
            (_, Part::Drive(drive)) => Pick::Drive {
                gear: catalogs.gears.iter().position(|gear| gear.id == drive.gear.id)?,
                motor: catalogs.motors.iter().position(|motor| motor.id == drive.motor.id)?,
            },
            _ => Pick::Given,
        });
    }
    picks.reverse();
    Some(picks)
}

/// The number, in the whole study, of the design with the parts `picks`. `whole_sizes` are the numbers of options of
/// the levels of the whole study. `None` if the search's tables lack one of its drives.
pub fn number_of_picks(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    whole_sizes: &[u32],
    picks: &[Pick],
) -> Option<u128> {
    let mut chosen = Vec::new();
    for (piece, (what, pick)) in problem.space().pieces.iter().zip(picks).enumerate().rev() {
        if !is_level(what) {
            continue;
        }
        chosen.push(match *pick {
            Pick::Tube(place) => place as u32,
            Pick::Drive { gear, motor } => {
                let table = &problem.sized_joint(piece)?.table;
                table.index_of(&catalogs.gears[gear].id, &catalogs.motors[motor].id)? as u32
            }
            Pick::Given => return None,
        });
    }
    Some(number(whole_sizes, &chosen))
}

/// The drives and tubes of the design with the parts `picks` in words, for messages on designs without a number.
pub fn words(space: &DesignSpace, catalogs: &Catalogs, picks: &[Pick]) -> String {
    let word = |(piece, pick): (&SpacePiece, &Pick)| match (piece, *pick) {
        (SpacePiece::Joint(joint), Pick::Drive { gear, motor }) => {
            let (gear, motor) = (&catalogs.gears[gear].id, &catalogs.motors[motor].id);
            Some(format!("{}: {gear} + {motor}", joint.name))
        }
        (SpacePiece::Choice(choice), Pick::Tube(place)) => {
            Some(format!("{}: section {} of its list", choice.name, place + 1))
        }
        _ => None,
    };
    space.pieces.iter().zip(picks).filter_map(word).collect::<Vec<_>>().join(", ")
}

fn is_level(piece: &SpacePiece) -> bool {
    match piece {
        SpacePiece::Joint(joint) => joint.drive.is_open(),
        SpacePiece::Prismatic(_) | SpacePiece::Link(_) => false,
        SpacePiece::Choice(_) => true,
    }
}
