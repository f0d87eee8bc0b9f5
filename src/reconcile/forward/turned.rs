//! Predictions for angles whose zero is off: the arm stands in another pose than the one that a file states.
//!
//! Everything that is prepared depends on the pose, so a fit cannot turn the arm far. If the poses are prepared at the
//! zero `z0` and the zero of the fit is `z`, a reading is `r(z0) + (z - z0) dr/dz` for a small difference. The fit is
//! repeated in poses that are prepared at the zero of the fit before, until the difference is negligible.

use super::coefficients::Layout;
use super::prepared::Forward;
use crate::arm::effect::subject::Subject;
use crate::reconcile::readings::campaign::Campaign;
use rayon::prelude::*;

/// Step of an angle \[deg\] or a travel \[mm\] for difference quotients of readings.
const STEP_DEG: f64 = 0.1;

impl Forward {
    /// For each entry of a pose, the change of every reading of the nominal arm per degree of the angle or millimetre of
    /// the travel, in the units of the files. All poses have to be prepared anew for this. It is therefore computed once
    /// about the nominal arm, and not for every fit.
    pub(crate) fn turn_slopes(&self, campaign: &Campaign) -> &[Vec<f64>] {
        self.turn_slopes.get_or_init(|| {
            let stated = self.nominal_readings(campaign);
            let slope = |entry: usize| -> Vec<f64> {
                let turned = self.nominal_readings(&turned_by(campaign, entry, STEP_DEG));
                turned.iter().zip(&stated).map(|(turned, stated)| (turned - stated) / STEP_DEG).collect()
            };
            (0..campaign.arm.driven_joint_names().len()).into_par_iter().map(slope).collect()
        })
    }

    /// Predicted readings of the nominal arm of `campaign`, in the units of the files. The campaign must have as many
    /// rows as the one that `self` was prepared from; their poses and loads, or the arm's geometry, may differ. Modes
    /// are numbered as in this campaign.
    pub(crate) fn nominal_readings(&self, campaign: &Campaign) -> Vec<f64> {
        let mut forward = Forward::of_the_nominal_arm(campaign);
        forward.number_modes_as(self);
        forward.predict(&forward.coefficients(&forward.nominal))
    }

    /// The campaign prepared in the poses in which `subject` stands, with the readings and the mode numbers of `self`.
    /// The slopes of angles whose zero is off are computed for `subject` itself.
    pub(crate) fn turned(&self, campaign: &Campaign, subject: &Subject) -> Self {
        let out = self.standing(campaign, subject);
        let here = out.predict(&out.coefficients(subject));
        let entries = subject.structure.driven_joints();
        let known = self.turn_slopes.get().cloned().unwrap_or_default();
        let slope = |(entry, turn_rad): (usize, f64)| -> Vec<f64> {
            if turn_rad == 0.0 {
                return known.get(entry).cloned().unwrap_or_default();
            }
            let mut further = subject.clone();
            further.zeros_rad.push((entries[entry].name.clone(), STEP_DEG.to_radians()));
            let there = self.standing(campaign, &further);
            let readings = there.predict(&there.coefficients(&further));
            readings.iter().zip(&here).map(|(there, here)| (there - here) / STEP_DEG).collect()
        };
        // if no zero is off, the list of turns is empty, and the known slopes of all entries are used
        let off = subject.turns_rad();
        let turns: Vec<(usize, f64)> =
            (0..entries.len()).map(|entry| (entry, off.get(entry).copied().unwrap_or(0.0))).collect();
        // the cell is new, so setting it cannot fail
        let _ = out.turn_slopes.set(turns.into_par_iter().map(slope).collect());
        out
    }

    /// The campaign prepared in the poses in which `subject` stands, without slopes. The trial shapes of the modes are
    /// those of `subject`.
    fn standing(&self, campaign: &Campaign, subject: &Subject) -> Self {
        let layout = Layout::new(&self.nominal.structure);
        let mut out = Self::prepare(campaign, self.nominal.clone(), layout, Some(subject));
        out.data.clone_from(&self.data);
        out.number_modes_as(self);
        let coefficients = out.coefficients(subject);
        out.refresh(&coefficients);
        out
    }

    /// Numbers the modes of each list as in `known`, where they may have been put in order or renumbered after a missed
    /// mode.
    fn number_modes_as(&mut self, known: &Self) {
        for (own, known) in self.modal.iter_mut().zip(&known.modal) {
            own.modes.clone_from(&known.modes);
        }
    }
}

/// The campaign with the entry `entry` of every pose larger by `off` \[deg, mm\].
fn turned_by(campaign: &Campaign, entry: usize, off: f64) -> Campaign {
    let mut out = campaign.clone();
    out.statics.iter_mut().for_each(|row| row.pose_deg[entry] += off);
    out.modal.iter_mut().for_each(|row| row.pose_deg[entry] += off);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::effect::entry::Effect;
    use crate::catalog::Catalogs;
    use crate::reconcile::model::direct::Direct;
    use std::path::Path;

    /// Predictions of mechanics, row by row.
    fn by_mechanics(campaign: &Campaign, subject: &Subject) -> Vec<f64> {
        let direct = Direct::new(subject);
        let mut out: Vec<f64> = direct.statics_mm(&campaign.statics).into_iter().flatten().collect();
        out.extend(direct.frequencies_hz(&campaign.modal).into_iter().map(|f| f.expect("mode")));
        out.extend(direct.windups_arcmin(&campaign.windup));
        out
    }

    #[test]
    fn a_campaign_prepared_at_a_zero_is_mechanics_and_linear_near_it() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let mut campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        campaign.statics.truncate(20);
        campaign.modal.truncate(16);
        let forward = Forward::new(&campaign);
        forward.turn_slopes(&campaign);
        let subject = |joint: &str, zero_rad: f64| {
            let mut out = forward.nominal.clone();
            // an arm that differs from the nominal one in other ways too
            out.structure.joint_mut("j3").expect("j3").law.connection_rad_per_nm += 3e-6;
            let parameters = vec![("zero_rad".to_string(), vec![zero_rad])];
            out.apply(&Effect { effect: "empirical".into(), at: joint.into(), parameters, source: None });
            out
        };
        let off = |prepared: &Forward, subject: &Subject| -> f64 {
            let fast = prepared.predict(&prepared.coefficients(subject));
            let pairs = fast.iter().zip(by_mechanics(&campaign, subject)).zip(&prepared.data);
            pairs.map(|((fast, slow), datum)| ((fast - slow) / datum.sigma).abs()).fold(0.0, f64::max)
        };
        // an arm that stands as stated keeps the slopes
        let back = forward.turned(&campaign, &forward.nominal);
        assert_eq!(back.turn_slopes.get(), forward.turn_slopes.get());
        for (joint, zero_rad) in [("j2", 0.05), ("j4", -0.08)] {
            let here = subject(joint, zero_rad);
            let turned = forward.turned(&campaign, &here);
            assert!(turned.coefficients(&here).turned_deg.is_empty());
            assert!(off(&turned, &here) < 0.02, "{joint}: {}", off(&turned, &here));
            // far from the prepared pose a straight line is not enough, near it it is
            assert!(off(&forward, &here) > 0.2, "{joint}: {}", off(&forward, &here));
            let near = subject(joint, zero_rad + 2e-3);
            assert_eq!(turned.coefficients(&near).turned_deg.len(), 6);
            assert!(off(&turned, &near) < 0.02, "{joint}: {}", off(&turned, &near));
            let moved = turned.predict(&turned.coefficients(&here));
            let further = turned.predict(&turned.coefficients(&near));
            let moves =
                moved.iter().zip(&further).zip(&turned.data).map(|((a, b), d)| ((a - b) / d.sigma).abs());
            assert!(moves.fold(0.0, f64::max) > 0.005, "{joint} shows");
        }
    }
}
