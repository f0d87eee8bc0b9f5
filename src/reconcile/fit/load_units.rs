//! Asks whether the loads in the file of displacements are in another unit than their columns state, although other
//! loads of the file are not.
//!
//! If every row has a payload, or every row a force, the effect `wrong_unit` describes it. If the file has both, the
//! payloads (or the forces) of all rows are converted from each unit that they may be in. A unit is named if the
//! calibrated arm is then several times nearer to the displacements.

use super::descent::{Effort, fit};
use super::noise::Noise;
use super::weights::Weights;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::wrong_unit::{self, UnitColumn, UnitSlip};
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::calibration::Nuisance;
use crate::reconcile::model::parameters::Model;
use crate::reconcile::readings::campaign::Campaign;
use crate::report::number::significant;

/// A unit is named only if its conversion divides the misfit of the calibrated arm by at least this.
const LEAST_IMPROVEMENT: f64 = 3.0;

/// Sentence on the column of payloads, or the columns of forces, that seem to be in another unit; `None` if none does.
pub(crate) fn other_units(campaign: &Campaign, nuisance: &Nuisance) -> Option<String> {
    if campaign.statics.is_empty() {
        return None;
    }
    let as_given = misfit(campaign, nuisance, None);
    let is_load = |unit: &&UnitSlip| unit.is_of(Channel::Static) && is_loaded(campaign, unit.column);
    let units = wrong_unit::SLIPS.iter().filter(is_load);
    let tried = units.map(|unit| (misfit(campaign, nuisance, Some(unit)), unit));
    let (nearest, unit) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let rows = if unit.column == UnitColumn::Payload { "payload" } else { "force" };
    (LEAST_IMPROVEMENT * nearest < as_given).then(|| {
        format!(
            "every reading under a {rows} is about {} times what the arm as given says, and with its loads converted the \
             calibrated arm is {} times nearer: {}? It was taken as it is",
            significant(unit.factor, 3),
            significant(as_given / nearest, 2),
            unit.cause
        )
    })
}

/// Whether some rows have a load of this column.
fn is_loaded(campaign: &Campaign, column: UnitColumn) -> bool {
    match column {
        UnitColumn::Payload => campaign.statics.iter().any(|row| row.payload.mass_kg > 0.0),
        UnitColumn::Force => campaign.statics.iter().any(|row| row.force_n.amax() > 0.0),
        UnitColumn::Reading => false,
    }
}

/// Misfit of the calibrated arm to the displacements alone, if the loads of one column are converted from `unit`.
fn misfit(campaign: &Campaign, nuisance: &Nuisance, unit: Option<&UnitSlip>) -> f64 {
    let mut converted =
        Campaign { modal: Vec::new(), windup: Vec::new(), positions: Vec::new(), ..campaign.clone() };
    for (row, unit) in converted.statics.iter_mut().zip(std::iter::repeat(unit)) {
        match unit.map(|unit| (unit.column, unit.factor)) {
            Some((UnitColumn::Payload, factor)) => row.payload.mass_kg *= factor,
            Some((UnitColumn::Force, factor)) => row.force_n *= factor,
            _ => {}
        }
    }
    let forward = Forward::new(&converted);
    let model = Model::baseline(nuisance);
    let weights: Weights = Noise::default().weights(&forward);
    fit(&forward, &model, &vec![0.0; model.len()], &weights, Effort::default()).point.objective
}
