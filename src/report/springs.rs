//! The balance springs of an arm in a pose, as JSON and as text.

use crate::arm::load::LoadCase;
use crate::arm::springs::Drawn;
use crate::mechanics::chain::Chain;
use serde_json::{Value, json};
use std::fmt::Write;

/// The balance springs of an arm in the pose of a case, each with its name.
pub(crate) fn springs_in(chain: &Chain, case: &LoadCase) -> Vec<(String, Drawn)> {
    let pose_rad = chain.pose_si(&case.pose_deg);
    chain.springs_in(&pose_rad).into_iter().map(|(name, drawn)| (name.to_string(), drawn)).collect()
}

/// A spring with its forces, as `armwright analyze --json` prints it.
pub(super) fn spring_json((name, drawn): &(String, Drawn)) -> Value {
    match drawn {
        Drawn::Line { length_m, force_n, .. } => {
            json!({"name": name, "length_m": length_m, "force_n": force_n})
        }
        Drawn::Torsion { torque_nm } => json!({"name": name, "torque_nm": torque_nm}),
    }
}

/// Adds a table of the springs and a note on what the model leaves out. Adds nothing if there are no springs.
pub(super) fn springs_text(springs: &[(String, Drawn)], out: &mut String) {
    if springs.is_empty() {
        return;
    }
    let _ = writeln!(out, "  spring          length m    what it does in this pose");
    for (name, drawn) in springs {
        let (length, does) = match drawn {
            Drawn::Line { length_m, force_n, .. } if *force_n < 0.0 => {
                (format!("{length_m:.4}"), format!("pushes with {:.1} N", -force_n))
            }
            Drawn::Line { length_m, force_n, .. } => {
                (format!("{length_m:.4}"), format!("pulls with {force_n:.1} N"))
            }
            Drawn::Torsion { torque_nm } => ("-".into(), format!("turns with {torque_nm:.2} N m")),
        };
        let _ = writeln!(out, "  {name:<14} {length:>9}    {does}");
    }
    let _ = writeln!(out, "  The stiffness that springs add to the modes below is left out.");
}
