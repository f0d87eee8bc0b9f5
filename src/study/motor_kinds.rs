//! The words for kinds of motors in study files.

use crate::catalog::motor::MotorKind;
use crate::input::json::Node;

/// Each word with the kinds of motors that it stands for.
pub(super) const MOTOR_WORDS: [(&str, &[MotorKind]); 7] = [
    (
        "electric",
        &[
            MotorKind::AcServo,
            MotorKind::BrushlessServo,
            MotorKind::FramelessServo,
            MotorKind::FramelessTorque,
        ],
    ),
    ("hydraulic", &[MotorKind::HydraulicPiston, MotorKind::HydraulicOrbital]),
    ("ac_servo", &[MotorKind::AcServo]),
    ("brushless_servo", &[MotorKind::BrushlessServo]),
    ("frameless_servo", &[MotorKind::FramelessServo]),
    ("frameless_torque", &[MotorKind::FramelessTorque]),
    ("stepper", &[MotorKind::Stepper]),
];

/// The kinds of motors if a study names none: servo and hydraulic motors.
pub(super) fn usual_motor_kinds() -> Vec<MotorKind> {
    MotorKind::ALL.into_iter().filter(|kind| *kind != MotorKind::Stepper).collect()
}

/// Reads a list of words for kinds of motors. Returns `None` after recording a fault.
pub(super) fn read_motor_kinds(node: &Node) -> Option<Vec<MotorKind>> {
    let read: Vec<Option<&[MotorKind]>> = node
        .array()?
        .iter()
        .map(|n| {
            let word = n.string()?;
            MOTOR_WORDS.iter().find(|(w, _)| *w == word).map(|(_, kinds)| *kinds).or_else(|| {
                let words: Vec<&str> = MOTOR_WORDS.iter().map(|(w, _)| *w).collect();
                n.fault(format!("\"{word}\" is not known"), &format!("choose among: {}", words.join(", ")))
            })
        })
        .collect();
    Some(read.into_iter().collect::<Option<Vec<_>>>()?.concat())
}
