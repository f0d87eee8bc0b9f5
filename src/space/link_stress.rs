//! The largest stress in a link, for the links that the search chooses and for the tubes that the study gives.

use super::design_space::SpacePiece;
use super::problem::{ArmProblem, Partial};
use super::station::{OnTube, Place, StationSlot};
use crate::arm::LinkBody;
use crate::mechanics::Wrench;
use crate::mechanics::link_stress::StressCheck;

impl StressCheck {
    /// Largest ratio of the equivalent stress to the strength in a link at rest. `outboard` is the load on the end of the
    /// link and `own` its weight, both about the world's origin. `carried` are the bodies on the link and the springs that
    /// pull on it.
    ///
    /// Between the ends, only the weight of the link, its bodies and the springs change force and moment. The stress is
    /// therefore checked at both ends and at the points where springs pull.
    pub(crate) fn largest(&self, place: &Place, carried: &OnTube, outboard: &Wrench, own: &Wrench) -> f64 {
        let at_root = outboard + own + carried.weight;
        let of_ends = self
            .ratio(place.local(outboard, &place.end_m))
            .max(self.ratio(place.local(&at_root, &place.root_m)));
        let of_pulls = carried
            .at_pulls(place, outboard, own)
            .flat_map(|(at_m, loads)| loads.map(|wrench| self.ratio(place.local(&wrench, &at_m))));
        of_pulls.fold(of_ends, f64::max)
    }
}

impl ArmProblem<'_> {
    /// Largest ratio of the equivalent stress to the strength in the tube that the study gives in `slot`, over `cases`. In
    /// a sizing case the arm accelerates, in the others it is at rest. `outboard` is the arm outboard of the tube. `None`
    /// if the slot has no given tube, or if the strength of its material is unknown.
    pub(crate) fn given_tube_stress(&self, cases: &[usize], outboard: &Partial, slot: usize) -> Option<f64> {
        let SpacePiece::Link(link) = self.piece_in_slot(slot)? else { return None };
        let LinkBody::Tube { material, section, .. } = &link.body else { return None };
        let check = StressCheck::new(material, section)?;
        let ratio = |case: &usize| {
            let StationSlot::Link { options, place, carried } = &self.stations()[*case].slots[slot] else {
                return 0.0;
            };
            let is_sizing = self.space().sizing_cases.contains(case);
            let factor = if is_sizing { self.peak_factor() } else { 1.0 };
            let load = &outboard.stations[*case].wrench;
            options.first().map_or(0.0, |own| check.largest(place, carried, load, &own.weight) * factor)
        };
        cases.iter().map(ratio).reduce(f64::max)
    }
}
