//! The model's values for every reading of a campaign, and how they change with every parameter.
//!
//! The poses are fixed, so all that depends on them is prepared once by [`mechanics`](crate::mechanics):
//! the twists of all coordinates an arm can have (absent effects are compliance 0), the parts of the
//! mass matrix, the torques of dead weight. A [`Subject`] is then seen through its [`Coefficients`]:
//! compliances, laws of the joints and masses, in which all of this is linear.

pub mod coefficients;
pub mod modal;
pub mod statics;

pub use coefficients::{Coefficients, Layout};

use super::readings::campaign::Campaign;
use crate::arm::JointModel;
use crate::arm::effect::{Channel, Subject};
use crate::arm::joint_law::JointLaw;
use modal::ModalTest;
use statics::StaticPose;

/// Arc minutes in a radian.
pub const ARCMIN_PER_RAD: f64 = 10800.0 / std::f64::consts::PI;

/// One measured number.
#[derive(Debug, Clone, PartialEq)]
pub struct Datum {
    /// Channel.
    pub channel: Channel,
    /// Row of its file, from 0.
    pub row: usize,
    /// Component 0-2 of a vector.
    pub component: usize,
    /// Which pose: data of one pose are kept out together.
    pub group: usize,
    /// Measured value, in the unit of the file.
    pub value: f64,
    /// Standard deviation.
    pub sigma: f64,
}

/// One joint's rows on the bench, in the order of the file.
#[derive(Debug, Clone)]
struct Bench {
    joint: usize,
    torques_nm: Vec<f64>,
    rows: Vec<usize>,
}

/// A campaign prepared for fitting.
pub struct Forward {
    /// The coordinates.
    pub layout: Layout,
    /// The nominal arm under a test as described.
    pub nominal: Subject,
    /// Every measured number: static, modal, bench.
    pub data: Vec<Datum>,
    /// Poses of the static rows.
    pub statics: Vec<StaticPose>,
    /// Tests of the modal rows.
    pub modal: Vec<ModalTest>,
    bench: Vec<Bench>,
    /// Where each channel's data begin: static, modal, windup, end.
    pub starts: [usize; 4],
    /// Names of the poses that can be kept out.
    pub groups: Vec<String>,
    /// Density of the payloads \[kg/m³\].
    pub payload_density_kg_m3: f64,
    /// The largest payload that was stated \[kg\].
    pub largest_payload_kg: f64,
    /// The lightest that was stated and is not nothing \[kg\].
    pub lightest_payload_kg: f64,
}

impl Forward {
    /// Prepares a campaign.
    pub fn new(campaign: &Campaign) -> Self {
        let mut nominal = campaign.arm.subject(JointModel::ThreeSegment);
        if campaign.statement.rigid_links {
            make_links_rigid(&mut nominal);
        }
        let layout = Layout::new(&nominal.structure);
        let mut groups: Vec<(Vec<f64>, String)> = Vec::new();
        let mut data = Vec::new();
        let statics = statics::prepare(campaign, &layout, &nominal, &mut groups, &mut data);
        let modal_start = data.len();
        let modal = modal::prepare(campaign, &layout, &nominal, &mut groups, &mut data);
        let windup_start = data.len();
        let bench = prepare_bench(campaign, &layout, &mut data);
        let starts = [0, modal_start, windup_start, data.len()];
        let payloads_kg = campaign.statics.iter().map(|r| r.payload.mass_kg);
        let payloads_kg: Vec<f64> =
            payloads_kg.chain(campaign.modal.iter().map(|r| r.payload.mass_kg)).collect();
        Self {
            layout,
            nominal,
            data,
            statics,
            modal,
            bench,
            starts,
            groups: groups.into_iter().map(|(_, name)| name).collect(),
            payload_density_kg_m3: campaign.statement.payload_density_kg_m3,
            largest_payload_kg: payloads_kg.iter().copied().fold(0.0, f64::max),
            lightest_payload_kg: payloads_kg
                .iter()
                .copied()
                .filter(|kg| *kg > 0.0)
                .fold(f64::INFINITY, f64::min),
        }
    }

    /// Numbers lists of frequencies anew that do not rise with the number of the mode, though frequencies are
    /// numbered as they rise, unless one wrong frequency is the simpler cause; says which.
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

    /// Counts lists of frequencies from which a mode is missing one higher; says which.
    pub fn find_missed_modes(&mut self, coefficients: &Coefficients) -> Vec<String> {
        let mut out = Vec::new();
        for (i, test) in self.modal.iter_mut().enumerate() {
            if let Some(mode) = test.find_missed_mode(&self.layout, coefficients, &self.data) {
                out.push(format!("mode {mode} appears to be missing from list {} of the frequencies", i + 1));
            }
        }
        out
    }

    /// Takes the trial shapes of all modal tests from these coefficients.
    pub fn refresh(&mut self, coefficients: &Coefficients) {
        let layout = &self.layout;
        self.modal.iter_mut().for_each(|test| test.refresh(layout, coefficients));
    }

    /// The channel's data.
    pub fn range(&self, channel: Channel) -> std::ops::Range<usize> {
        match channel {
            Channel::Static => self.starts[0]..self.starts[1],
            Channel::Modal => self.starts[1]..self.starts[2],
            Channel::Windup => self.starts[2]..self.starts[3],
            Channel::Positions => 0..0,
        }
    }

    /// Sizes of a joint's torques on the bench \[N m\].
    pub fn bench_torques_nm(&self, joint: usize) -> impl Iterator<Item = f64> + '_ {
        self.bench.iter().filter(move |b| b.joint == joint).flat_map(|b| b.torques_nm.iter().map(|t| t.abs()))
    }

    /// Torque on every joint at each static or modal datum \[N m\].
    pub fn torques_nm(&self, coefficients: &Coefficients) -> Vec<Vec<f64>> {
        let mut out = vec![Vec::new(); self.starts[2]];
        let statics = self.statics.iter().flat_map(|pose| {
            let loads = pose.torques_nm(&self.layout, coefficients);
            loads.into_iter().skip(1)
        });
        for (row, torques) in statics.enumerate() {
            out[3 * row..3 * row + 3].fill(torques);
        }
        for test in &self.modal {
            let torques = test.torques_nm(&self.layout, coefficients);
            test.modes.iter().for_each(|(datum, _)| out[*datum] = torques.clone());
        }
        out
    }

    /// What the subject is seen through.
    pub fn coefficients(&self, subject: &Subject) -> Coefficients {
        Coefficients::new(&self.layout, &self.nominal, subject)
    }

    /// The model's value for every datum.
    pub fn predict(&self, coefficients: &Coefficients) -> Vec<f64> {
        let mut out = vec![0.0; self.data.len()];
        self.predict_smooth(coefficients, &mut out);
        for test in &self.modal {
            test.predict(&self.layout, coefficients, &mut out);
        }
        self.read(coefficients, &mut out);
        out
    }

    /// Statics and bench only; the modal entries are left as they are.
    pub fn predict_smooth(&self, coefficients: &Coefficients, out: &mut [f64]) {
        for pose in &self.statics {
            pose.predict(&self.layout, coefficients, out);
        }
        for bench in &self.bench {
            bench.predict(&coefficients.laws[bench.joint], out);
        }
    }

    /// Turns truth into readings.
    pub fn read(&self, coefficients: &Coefficients, out: &mut [f64]) {
        for (value, datum) in out.iter_mut().zip(&self.data) {
            *value = coefficients.channels[datum.channel as usize].of(*value, datum.component, datum.row);
        }
    }
}

/// A nominal model without flexible links.
pub fn make_links_rigid(subject: &mut Subject) {
    let names: Vec<String> = subject.structure.links().map(|l| l.name.clone()).collect();
    for name in names {
        if let Some(beam) = subject.structure.link_mut(&name).and_then(|l| l.beam.as_mut()) {
            beam.flexibility = 0.0;
        }
    }
}

fn prepare_bench(campaign: &Campaign, layout: &Layout, data: &mut Vec<Datum>) -> Vec<Bench> {
    let mut bench: Vec<Bench> = Vec::new();
    for row in &campaign.windup {
        let Some(joint) = layout.joints.iter().position(|j| j.name == row.joint) else { continue };
        let index = data.len();
        data.push(Datum {
            channel: Channel::Windup,
            row: row.row,
            component: 0,
            group: usize::MAX,
            value: row.windup_arcmin,
            sigma: row.sigma_arcmin,
        });
        match bench.iter_mut().find(|b| b.joint == joint) {
            Some(b) => {
                b.torques_nm.push(row.torque_nm);
                b.rows.push(index);
            }
            None => bench.push(Bench { joint, torques_nm: vec![row.torque_nm], rows: vec![index] }),
        }
    }
    bench
}

impl Bench {
    fn predict(&self, law: &JointLaw, out: &mut [f64]) {
        let twists = bench_twists_rad(law, &self.torques_nm);
        for (&index, twist) in self.rows.iter().zip(twists) {
            out[index] = twist * ARCMIN_PER_RAD;
        }
    }
}

/// Twists of a joint on the bench \[rad\]: the cycle runs once unrecorded, then once recorded.
pub fn bench_twists_rad(law: &JointLaw, torques_nm: &[f64]) -> Vec<f64> {
    let mut state = 0.0;
    for &torque in torques_nm {
        law.play_angle_rad(torque, &mut state);
    }
    torques_nm.iter().map(|&torque| law.play_angle_rad(torque, &mut state)).collect()
}

/// The group of a pose; a new one if it was not seen before.
pub fn group_of(pose_deg: &[f64], groups: &mut Vec<(Vec<f64>, String)>) -> usize {
    if let Some(found) = groups.iter().position(|(p, _)| p == pose_deg) {
        return found;
    }
    let name = pose_deg.iter().map(|a| format!("{a}")).collect::<Vec<_>>().join(",");
    groups.push((pose_deg.to_vec(), name));
    groups.len() - 1
}
