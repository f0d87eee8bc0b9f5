//! The load on the guide of a prismatic joint (rail) of an arm.

use crate::arm::Arm;
use crate::arm::load::LoadCase;
use crate::mechanics::GuideLoad;
use crate::mechanics::chain::Chain;

/// The load on the guide of the prismatic joint `name` of an arm in a case, while everything outboard has the
/// acceleration `acceleration_m_s2` along the travel \[m/s²\]; 0 at rest. The acceleration acts like an additional
/// gravity in the opposite direction. `None` if the arm has no such guide.
pub(crate) fn guide_load(
    arm: &Arm,
    case: &LoadCase,
    name: &str,
    acceleration_m_s2: f64,
) -> Option<GuideLoad> {
    let mut structure = arm.structure_in(case);
    let of_guide = |structure: &_| {
        let statics = Chain::new(structure, case.links).pose(case).statics();
        statics.guide_loads.into_iter().find(|load| load.name == name)
    };
    let at_rest = of_guide(&structure)?;
    if acceleration_m_s2 == 0.0 {
        return Some(at_rest);
    }
    // The inertia load is the difference between two computations without water. Buoyancy must not change with the
    // acceleration, and added mass is left out.
    structure.water = None;
    let dry = of_guide(&structure)?;
    let gravity = structure.down * structure.gravity_m_s2 - at_rest.travel * acceleration_m_s2;
    structure.gravity_m_s2 = gravity.norm();
    structure.down = gravity.try_normalize(0.0).unwrap_or(structure.down);
    let stopped = of_guide(&structure)?;
    Some(GuideLoad {
        force_n: at_rest.force_n + stopped.force_n - dry.force_n,
        moment_nm: at_rest.moment_nm + stopped.moment_nm - dry.moment_nm,
        ..at_rest
    })
}
