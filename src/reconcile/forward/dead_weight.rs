//! Torques and moments of an arm's own weight in a pose.

use crate::mechanics::chain::{Compliance, ElasticElement, Item, Posed};
use crate::mechanics::{Wrench, angular};

/// Torque of the dead weight on each joint, base to tip, and moments of the dead weight on the base about world x and y
/// \[N m\].
pub(super) fn dead_torques(posed: &Posed) -> (Vec<f64>, [f64; 2]) {
    let mut torques = Vec::new();
    let carried = posed.transferred();
    let all = inward(posed, |element, wrench| {
        if let Compliance::Joint(_) = element.compliance {
            let passive = carried.iter().filter(|c| c.driver == element.name);
            let passive_nm: f64 = passive.map(|c| c.torque_nm).sum();
            torques.push(element.twists[0].dot(wrench) + element.torque_nm + passive_nm);
        }
    });
    torques.reverse();
    let moment = angular(&all);
    (torques, [moment.x, moment.y])
}

/// Generalized force of the dead weight on each strain coordinate, base to tip \[N m for a rotation\]. Of a link, the
/// weight outboard of it counts, and not its own.
pub(super) fn dead_forces(posed: &Posed) -> Vec<f64> {
    let mut forces = Vec::new();
    inward(posed, |element, wrench| {
        forces.extend(element.twists.iter().rev().map(|twist| twist.dot(wrench)));
    });
    forces.reverse();
    forces
}

/// Calls `each` for every elastic element, from the tip to the base, with the weight of everything outboard of it. Returns
/// the weight of the whole arm.
fn inward(posed: &Posed, mut each: impl FnMut(&ElasticElement, &Wrench)) -> Wrench {
    let mut wrench = Wrench::zeros();
    for item in posed.items.iter().rev() {
        match item {
            Item::Body(body) => wrench += body.weight(),
            Item::Load(load) => wrench += load,
            Item::Elastic(element) => {
                each(element, &wrench);
                if let Some(own) = &element.own {
                    wrench += own.weight;
                }
            }
        }
    }
    wrench
}
