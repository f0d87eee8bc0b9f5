//! Torques and moments of an arm's own weight in a pose.

use crate::mechanics::chain::{Compliance, Item, Posed};
use crate::mechanics::{Wrench, angular};

/// Torque of the dead weight on each joint, base to tip, and moments of the dead weight on the base about world x and y
/// \[N m\].
pub(super) fn dead_torques(posed: &Posed) -> (Vec<f64>, [f64; 2]) {
    let mut wrench = Wrench::zeros();
    let mut torques = Vec::new();
    let carried = posed.transferred();
    for item in posed.items.iter().rev() {
        match item {
            Item::Body(body) => wrench += body.weight(),
            Item::Load(load) => wrench += load,
            Item::Elastic(element) => {
                if let Compliance::Joint(_) = element.compliance {
                    let passive = carried.iter().filter(|c| c.driver == element.name);
                    let passive_nm: f64 = passive.map(|c| c.torque_nm).sum();
                    torques.push(element.twists[0].dot(&wrench) + element.torque_nm + passive_nm);
                }
                if let Some(own) = &element.own {
                    wrench += own.weight;
                }
            }
        }
    }
    torques.reverse();
    let moment = angular(&wrench);
    (torques, [moment.x, moment.y])
}

/// Generalized force of the dead weight on each strain coordinate, base to tip \[N m for a rotation\]. Of a link, the
/// weight outboard of it counts, and not its own.
pub(super) fn dead_forces(posed: &Posed) -> Vec<f64> {
    let mut wrench = Wrench::zeros();
    let mut forces = Vec::new();
    for item in posed.items.iter().rev() {
        match item {
            Item::Body(body) => wrench += body.weight(),
            Item::Load(load) => wrench += load,
            Item::Elastic(element) => {
                forces.extend(element.twists.iter().rev().map(|twist| twist.dot(&wrench)));
                if let Some(own) = &element.own {
                    wrench += own.weight;
                }
            }
        }
    }
    forces.reverse();
    forces
}
