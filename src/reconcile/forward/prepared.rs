//! Prepares a campaign for fitting: its data, and everything about its poses and tests that does not depend on
//! parameters.

use super::bench::{self, Bench};
use super::coefficients::{Coefficients, Layout, StaticChanges};
use super::datum::{Datum, Groups};
use super::modal::{self, ModalTest};
use super::statics::{self, StaticPose, StaticState};
use crate::arm::JointModel;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::subject::Subject;
use crate::arm::joint_law::Curve;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::DMatrix;
use std::sync::OnceLock;

/// A campaign prepared for fitting: its data, and what does not depend on fitted parameters.
pub struct Forward {
    /// The strain coordinates of the arm.
    pub layout: Layout,
    /// The nominal arm, tested as the campaign describes.
    pub nominal: Subject,
    /// For each entry of a pose, the prepared value minus the value in the files \[rad\], which is the error of the
    /// zero of the angle. Empty if the poses of the files were prepared.
    pub(super) stands_rad: Vec<f64>,
    /// All measured numbers, in the order static, modal, bench.
    pub data: Vec<Datum>,
    /// Poses of the static rows, each with its loads.
    pub statics: Vec<StaticPose>,
    /// The modal tests, one for each pose and payload.
    pub modal: Vec<ModalTest>,
    /// The bench rows of each joint that was on the bench.
    pub(crate) bench: Vec<Bench>,
    /// Index in `data` at which the data of each channel begin: static, modal, bench; then the number of all data.
    pub starts: [usize; 4],
    /// Names of the poses, in the order of `Datum::group`.
    pub groups: Vec<String>,
    /// Density of the payloads \[kg/m³\].
    pub payload_density_kg_m3: f64,
    /// Tolerance of the joints' stiffnesses: a 95 % limit of their relative deviation.
    pub(crate) stiffness_tolerance: f64,
    /// The largest stated payload \[kg\].
    pub largest_payload_kg: f64,
    /// The smallest stated payload above zero \[kg\]; infinite if there is none.
    pub lightest_payload_kg: f64,
    /// For each entry of a pose, the change of every reading per degree of the angle or millimetre of the travel; empty
    /// until it is asked for.
    pub(crate) turn_slopes: OnceLock<Vec<Vec<f64>>>,
    /// For each horizontal axis, the change of every reading by an arm that is out of level; empty until it is asked
    /// for.
    pub(crate) level_columns: OnceLock<Vec<Vec<f64>>>,
    /// For each link, the change of every reading by a length other than drawn; empty until it is asked for.
    pub(crate) length_columns: OnceLock<Vec<Vec<f64>>>,
    /// Whether some static or modal reading has a temperature.
    pub has_temperatures: bool,
    /// Marks of the files of static and of modal readings: numbers made from their content.
    pub(crate) files: [usize; 2],
}

impl Forward {
    /// Prepares a campaign for fitting: lists its data, and computes what does not depend on fitted parameters.
    pub fn new(campaign: &Campaign) -> Self {
        let nominal = nominal_subject(campaign);
        let layout = Layout::new(&nominal.structure);
        Self::prepare(campaign, nominal, layout, None)
    }

    /// Prepares a campaign for the prediction of its nominal arm alone: masses that this arm does not have are left
    /// out, because their factors take most of the time of the preparation.
    pub(crate) fn of_the_nominal_arm(campaign: &Campaign) -> Self {
        let nominal = nominal_subject(campaign);
        let mut layout = Layout::new(&nominal.structure);
        let own = Coefficients::new(&layout, &nominal, &nominal);
        if own.masses.iter().chain(&own.weights).all(|amount| *amount == 0.0) {
            layout.with_mass.clear();
        }
        Self::prepare(campaign, nominal, layout, None)
    }

    /// Prepares a campaign for the nominal arm. The prepared poses are those in which an arm with the zeros of `turned`
    /// stands, or the nominal arm if `turned` is `None`. `layout` lists the strain coordinates of the nominal arm.
    pub(super) fn prepare(
        campaign: &Campaign,
        mut nominal: Subject,
        layout: Layout,
        turned: Option<&Subject>,
    ) -> Self {
        let files = [mark(&campaign.statics, |row| row.file), mark(&campaign.modal, |row| row.file)];
        for (channel, file) in [Channel::Static, Channel::Modal].into_iter().zip(files) {
            nominal.setups[channel as usize].keep_events_of(file);
        }
        let zeros_rad = turned.map_or(&nominal.zeros_rad, |subject| &subject.zeros_rad).clone();
        let standing = Subject { zeros_rad, ..nominal.clone() };
        let mut groups = Groups::default();
        let mut data = Vec::new();
        let statics = statics::prepare(campaign, &layout, &standing, &mut groups, &mut data);
        let modal_start = data.len();
        let modal = modal::prepare(campaign, &layout, &standing, &mut groups, &mut data);
        let windup_start = data.len();
        let bench = bench::prepare(campaign, &layout, &mut data);
        // the data are sorted by channel, so one index range selects a channel
        let starts = [0, modal_start, windup_start, data.len()];
        let payloads_kg = campaign.statics.iter().map(|r| r.payload.mass_kg);
        let payloads_kg: Vec<f64> =
            payloads_kg.chain(campaign.modal.iter().map(|r| r.payload.mass_kg)).collect();
        Self {
            layout,
            nominal,
            stands_rad: standing.turns_rad(),
            data,
            statics,
            modal,
            bench,
            starts,
            groups: groups.names,
            payload_density_kg_m3: campaign.statement.payload_density_kg_m3,
            stiffness_tolerance: campaign.statement.tolerance.joint_stiffness,
            turn_slopes: OnceLock::new(),
            level_columns: OnceLock::new(),
            length_columns: OnceLock::new(),
            has_temperatures: campaign.statics.iter().any(|r| r.temperature_c.is_some())
                || campaign.modal.iter().any(|r| r.temperature_c.is_some()),
            files,
            largest_payload_kg: payloads_kg.iter().copied().fold(0.0, f64::max),
            lightest_payload_kg: payloads_kg
                .iter()
                .copied()
                .filter(|kg| *kg > 0.0)
                .fold(f64::INFINITY, f64::min),
        }
    }

    /// Renumbers the modes of frequency lists in which the frequencies do not rise with the mode number, unless a
    /// single wrong frequency explains this better. Returns a sentence for each list that was changed.
    pub fn put_modes_in_order(&mut self) -> Vec<String> {
        let nominal = self.coefficients(&self.nominal);
        let (layout, data) = (&self.layout, &self.data);
        let lists = self.modal.iter_mut().enumerate();
        lists
            .filter_map(|(i, test)| test.put_in_order(layout, &nominal, data).then_some(i + 1))
            .map(|list| {
                format!(
                    "the modes of list {list} of the frequencies are not numbered as they rise: put in order"
                )
            })
            .collect()
    }

    /// Renumbers the modes of frequency lists from which a mode is missing, by comparison with the frequencies of an
    /// arm with these coefficients. Returns a sentence for each list that was changed.
    pub fn find_missed_modes(&mut self, coefficients: &Coefficients) -> Vec<String> {
        // the slopes belong to the modes of the readings, and these may be renumbered
        self.turn_slopes = OnceLock::new();
        self.length_columns = OnceLock::new();
        let mut out = Vec::new();
        for (i, test) in self.modal.iter_mut().enumerate() {
            if let Some(mode) = test.find_missed_mode(&self.layout, coefficients, &self.data) {
                out.push(format!("mode {mode} appears to be missing from list {} of the frequencies", i + 1));
            }
        }
        out
    }

    /// Computes the trial shapes of all modal tests again, from the modes of an arm with these coefficients.
    pub fn refresh(&mut self, coefficients: &Coefficients) {
        let layout = &self.layout;
        self.modal.iter_mut().for_each(|test| test.refresh(layout, coefficients));
    }

    /// Indices in `data` of the data of a channel.
    pub fn range(&self, channel: Channel) -> std::ops::Range<usize> {
        match channel {
            Channel::Static => self.starts[0]..self.starts[1],
            Channel::Modal => self.starts[1]..self.starts[2],
            Channel::Windup => self.starts[2]..self.starts[3],
            Channel::Positions => 0..0,
        }
    }

    /// Number of rows of the static readings: of the loads over all poses or, where some rows of the file are not used, of
    /// the rows up to the last one that is.
    pub fn static_rows(&self) -> usize {
        let own = &self.data[self.range(Channel::Static)];
        let last = own.iter().map(|datum| datum.row + 1).max().unwrap_or(0);
        self.statics.iter().map(StaticPose::count).sum::<usize>().max(last)
    }

    /// Magnitudes of the torques that a joint bears on the bench \[N m\]; none if the joint is not on the bench.
    /// `joint` is the joint's index in the layout.
    pub fn bench_torques_nm(&self, joint: usize) -> impl Iterator<Item = f64> + '_ {
        self.bench.iter().filter(move |b| b.joint == joint).flat_map(Bench::sizes_nm)
    }

    /// Torque on every joint of an arm with these coefficients at each static or modal datum \[N m\]: one list per
    /// datum, joints from base to tip.
    pub fn torques_nm(&self, coefficients: &Coefficients) -> Vec<Vec<f64>> {
        let mut out = vec![Vec::new(); self.starts[2]];
        for pose in &self.statics {
            for (load, torques) in pose.torques_nm(&self.layout, coefficients).iter().skip(1).enumerate() {
                pose.measured(load).for_each(|(_, datum)| out[datum].clone_from(torques));
            }
        }
        for test in &self.modal {
            let torques = test.torques_nm(&self.layout, coefficients);
            test.modes.iter().for_each(|(datum, _)| out[*datum] = torques.clone());
        }
        out
    }

    /// Whether the torque on a joint in some modal test is so near a break point of the joint's gear that the
    /// logarithm of their ratio is less than `close`. A small change of a mass may then change the slope of the
    /// curve, and frequencies jump.
    pub(crate) fn is_close_to_a_step(&self, coefficients: &Coefficients, close: f64) -> bool {
        let breaks = coefficients.laws.iter().map(|law| match law.curve {
            Curve::Windup(curve) => vec![curve.t1_nm, curve.t2_nm],
            _ => Vec::new(),
        });
        let breaks: Vec<Vec<f64>> = breaks.collect();
        breaks.iter().any(|own| !own.is_empty())
            && self.modal.iter().any(|test| {
                let torques = test.torques_nm(&self.layout, coefficients);
                torques.iter().zip(&breaks).any(|(torque_nm, own)| {
                    own.iter().any(|at_nm| libm::log(torque_nm.abs() / at_nm).abs() < close)
                })
            })
    }

    /// Expresses a subject (an arm under test) as compliances, joint laws and masses. The masses are given as
    /// differences from those of the nominal arm.
    pub fn coefficients(&self, subject: &Subject) -> Coefficients {
        let turned_deg = self.turned_deg(subject);
        Coefficients { turned_deg, ..Coefficients::new(&self.layout, &self.nominal, subject) }
    }

    /// For each entry of a pose, how far `subject` is turned from the pose that was prepared \[deg\]; empty if it is not.
    fn turned_deg(&self, subject: &Subject) -> Vec<f64> {
        let own_rad = subject.turns_rad();
        if own_rad == self.stands_rad {
            return Vec::new();
        }
        let at = |list: &[f64], entry: usize| list.get(entry).copied().unwrap_or(0.0);
        let entries = own_rad.len().max(self.stands_rad.len());
        (0..entries).map(|i| (at(&own_rad, i) - at(&self.stands_rad, i)).to_degrees()).collect()
    }

    /// The predicted reading of an arm with these coefficients for every datum, in the unit of the datum's file.
    pub fn predict(&self, coefficients: &Coefficients) -> Vec<f64> {
        let mut out = vec![0.0; self.data.len()];
        self.predict_smooth(coefficients, &mut out);
        for test in &self.modal {
            test.predict(&self.layout, coefficients, &mut out);
        }
        self.read(coefficients, &mut out);
        out
    }

    /// Predicted displacement readings of an arm with these coefficients in every static row \[mm\], including
    /// components that were not measured.
    pub fn displacements_mm(&self, coefficients: &Coefficients) -> Vec<[f64; 3]> {
        let reading = &coefficients.channels[Channel::Static as usize];
        let mut out = Vec::new();
        for pose in &self.statics {
            let state = pose.state(&self.layout, coefficients);
            for load in 0..pose.count() {
                let seen_mm = pose.seen_mm(&state, coefficients, load);
                // every component of a row is read at the same time
                let row = pose.measured(load).next().map_or(0, |(_, datum)| self.data[datum].row);
                out.push(std::array::from_fn(|c| reading.of(seen_mm[c], c, row)));
            }
        }
        out
    }

    /// Writes the predictions for static and bench data to `out`. The entries of modal data stay as they are. Returns
    /// the state of each static pose.
    pub fn predict_smooth(&self, coefficients: &Coefficients, out: &mut [f64]) -> Vec<StaticState> {
        for bench in &self.bench {
            bench.predict(&coefficients.law(bench.joint, Channel::Windup), out);
        }
        let state = |pose: &StaticPose| {
            let state = pose.state(&self.layout, coefficients);
            pose.write(&state, coefficients, out);
            state
        };
        self.statics.iter().map(state).collect()
    }

    /// Predicts static and bench readings for each of the coefficient sets `to`, starting from the predictions with
    /// `from`. `states` has the loads and deflections in the static poses with `from`. `out` has one column per entry
    /// of `to`. On entry each column contains the predictions with `from`. Parts that do not differ are not computed
    /// again.
    pub fn change_smooth(
        &self,
        states: &[StaticState],
        from: &Coefficients,
        to: &[Coefficients],
        out: &mut DMatrix<f64>,
    ) {
        let changes: Vec<StaticChanges> = to.iter().map(|to| from.static_changes(to)).collect();
        for (k, to) in to.iter().enumerate() {
            let law = |c: &Coefficients, bench: &Bench| c.law(bench.joint, Channel::Windup);
            for bench in self.bench.iter().filter(|bench| law(from, bench) != law(to, bench)) {
                bench.predict(&law(to, bench), out.column_mut(k).as_mut_slice());
            }
        }
        let changed: Vec<usize> = (0..to.len()).filter(|k| !changes[*k].is_none()).collect();
        let mut moved = StaticState::default();
        // pose by pose, so that a pose is read from memory once for all changes
        for (pose, state) in self.statics.iter().zip(states) {
            for &k in &changed {
                moved.copy_from(state);
                pose.update(&self.layout, &to[k], &changes[k], &mut moved);
                pose.write(&moved, &to[k], out.column_mut(k).as_mut_slice());
            }
        }
    }

    /// Adds the errors of the measuring channels: turns the value of each datum in `out` into the reading that the
    /// channel shows. Then adds what changes if the arm is turned from the pose that was prepared.
    pub fn read(&self, coefficients: &Coefficients, out: &mut [f64]) {
        for (value, datum) in out.iter_mut().zip(&self.data) {
            *value = coefficients.channels[datum.channel as usize].of(*value, datum.component, datum.row);
        }
        let slopes = self.turn_slopes.get().into_iter().flatten();
        for (turned_deg, slope) in coefficients.turned_deg.iter().zip(slopes) {
            out.iter_mut().zip(slope).for_each(|(value, slope)| *value += turned_deg * slope);
        }
    }
}

/// Mark (a number made from the content) of the file whose rows are `rows`; 0 if there are none. `of` returns the mark
/// that a row has.
pub(crate) fn mark<R>(rows: &[R], of: impl Fn(&R) -> usize) -> usize {
    rows.first().map_or(0, of)
}

/// The nominal arm of a campaign, with rigid links if the campaign says so.
fn nominal_subject(campaign: &Campaign) -> Subject {
    let mut nominal = campaign.arm.subject(JointModel::ThreeSegment);
    if campaign.statement.rigid_links {
        make_links_rigid(&mut nominal);
    }
    nominal
}

/// Makes all links of the subject rigid.
pub(crate) fn make_links_rigid(subject: &mut Subject) {
    let names: Vec<String> = subject.structure.links().map(|l| l.name.clone()).collect();
    for name in names {
        if let Some(beam) = subject.structure.link_mut(&name).and_then(|l| l.beam.as_mut()) {
            beam.flexibility = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use std::path::Path;

    #[test]
    fn a_change_from_kept_states_gives_the_readings_of_a_fresh_prediction() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        let forward = Forward::new(&campaign);
        let from = forward.coefficients(&forward.nominal);
        let changed = |change: &dyn Fn(&mut Coefficients)| {
            let mut out = from.clone();
            change(&mut out);
            out
        };
        let to = [
            from.clone(),
            changed(&|c| c.linear[0] = 1e-6),
            changed(&|c| c.weights[2] = 1.5),
            changed(&|c| c.payload_delta_kg = 0.3),
            changed(&|c| c.laws[1].hysteresis_rad = 1e-4),
            changed(&|c| {
                c.laws[2].connection_rad_per_nm = 1e-5;
                c.weights[1] = -0.5;
            }),
        ];
        let mut before = vec![0.0; forward.data.len()];
        let states = forward.predict_smooth(&from, &mut before);
        let mut after = DMatrix::zeros(before.len(), to.len());
        after.column_iter_mut().for_each(|mut column| column.copy_from_slice(&before));
        forward.change_smooth(&states, &from, &to, &mut after);
        for (k, to) in to.iter().enumerate() {
            let mut fresh = vec![0.0; before.len()];
            forward.predict_smooth(to, &mut fresh);
            let largest =
                |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            // weights do not show where twists are proportional to torques, except in the last digits
            let (off, moved) = (largest(after.column(k).as_slice(), &fresh), largest(&fresh, &before));
            assert!(off < 1e-12 && (k == 2 || off == 0.0), "change {k}: {off}");
            assert_eq!(moved > 1e-9, k != 0 && k != 2, "change {k}: {moved}");
        }
    }
}
