//! The objectives of an arm by the full model.

use crate::arm::Arm;
use crate::arm::load::LoadCase;
use crate::arm::structure::Structure;
use crate::mechanics::chain::Chain;
use crate::pareto::objectives::Objectives;

/// Objectives of an arm over load cases: the largest tip deflection \[m\], the mass \[kg\] and the smallest lowest
/// mode \[Hz\]. `armwright analyze` uses the same full model.
pub fn full_objectives(arm: &Arm, cases: &[LoadCase]) -> Objectives {
    objectives_with(arm, cases, |_| ())
}

/// Objectives of an arm by the full model, after `change` has altered its structure (the arm as the mechanics sees it,
/// with all effects). The mass is the mass of the arm before the change.
pub fn objectives_with(arm: &Arm, cases: &[LoadCase], change: impl Fn(&mut Structure)) -> Objectives {
    let mut out = Objectives { tip_deflection_m: 0.0, mass_kg: arm.mass_kg(), lowest_mode_hz: f64::INFINITY };
    for case in cases {
        let mut structure = arm.structure_in(case);
        change(&mut structure);
        let chain = Chain::new(&structure, case.links);
        let posed = chain.pose(case);
        let statics = posed.statics();
        out.tip_deflection_m = out.tip_deflection_m.max(statics.tip_displacement_m.norm());
        out.lowest_mode_hz = out.lowest_mode_hz.min(posed.lowest_frequency_hz(&statics));
    }
    out
}

/// Largest tip deflection of an arm over load cases by the full model \[m\]. It takes a small part of the time of
/// [`full_objectives`], most of which goes into the modes.
pub(crate) fn full_deflection_m(arm: &Arm, cases: &[LoadCase]) -> f64 {
    let deflection_m = |case: &LoadCase| {
        let structure = arm.structure_in(case);
        Chain::new(&structure, case.links).pose(case).statics().tip_displacement_m.norm()
    };
    cases.iter().map(deflection_m).fold(0.0, f64::max)
}
