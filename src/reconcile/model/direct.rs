//! Predicts readings by [`mechanics`](crate::mechanics) directly, one row at a time. `predict` writes these
//! values, and tests check the prepared model of the fits against them.

use crate::arm::effect::channel::Channel;
use crate::arm::effect::setup::Setup;
use crate::arm::effect::subject::Subject;
use crate::arm::effect::warming::Moment;
use crate::arm::joint_law::JointLaw;
use crate::arm::load::Payload;
use crate::arm::structure::{FrameCompliance, LinkPiece, Piece, Structure};
use crate::arm::{Arm, JointModel, LinkModel};
use crate::mechanics::chain::Chain;
use crate::mechanics::chain::{Compliance, Posed};
use crate::mechanics::{Twist, displacement_at};
use crate::reconcile::forward::bench::{ARCMIN_PER_RAD, bench_twists_rad};
use crate::reconcile::forward::prepared::{make_links_rigid, mark};
use crate::reconcile::readings::campaign::Statement;
use crate::reconcile::readings::placement::Placement;
use crate::reconcile::readings::rows::{ModalRow, PositionRow, StaticRow, WindupRow};
use nalgebra::Vector3;
use std::borrow::Cow;

/// The arm under test (subject), with all effects of its file. `statement` is what `campaign.json` says about the
/// tests: whether links are rigid, and the density of payloads.
pub(crate) fn subject(arm: &Arm, statement: &Statement) -> Subject {
    let mut nominal = Arm { effects: Vec::new(), ..arm.clone() }.subject(JointModel::ThreeSegment);
    if statement.rigid_links {
        make_links_rigid(&mut nominal);
    }
    arm.effects.iter().for_each(|effect| nominal.apply(effect));
    if let Some(water) = &mut nominal.structure.water {
        water.payload_density_kg_m3 = statement.payload_density_kg_m3;
    }
    nominal
}

/// An arm under test (subject), prepared for the prediction of readings by the full model.
pub struct Direct<'a> {
    subject: &'a Subject,
    chain: Chain,
    /// For each channel, the arm with the special set-up of the channel's tests; `None` if there is no special
    /// set-up.
    special: [Option<Chain>; 4],
}

impl<'a> Direct<'a> {
    /// Prepares an arm under test (subject) for the prediction of readings.
    pub fn new(subject: &'a Subject) -> Self {
        let chain = |structure: &Structure| Chain::new(structure, LinkModel::Full);
        let special = Channel::ALL.map(|channel| {
            let is_plain = subject.setups[channel as usize].is_plain();
            (!is_plain).then(|| chain(&subject.structure_in(channel)))
        });
        Self { subject, chain: chain(&subject.structure), special }
    }

    /// Predicted displacement readings \[mm\], one per row. The rows must be in the order of their file, because
    /// friction play depends on it.
    pub fn statics_mm(&self, rows: &[StaticRow]) -> Vec<[f64; 3]> {
        let reading = &self.subject.channels[Channel::Static as usize];
        let setup = self.setup_of(Channel::Static, mark(rows, |row| row.file));
        let mut out = Vec::with_capacity(rows.len());
        let mut pose: &[f64] = &[];
        let (mut play, mut lag) = (Vec::new(), Vector3::zeros());
        let mut before_m = Vector3::zeros();
        for row in rows {
            let chain = self.chain_at(Channel::Static, &row.moment());
            // the links are taken to be as warm at the reference as at the reading
            let reference = self.reference_at(&row.moment());
            let unloaded = self.posed(&reference, &row.pose_deg, &Payload::default(), Vector3::zeros());
            let unloaded_m = unloaded.statics().tip_displacement_m;
            if row.pose_deg != pose || out.is_empty() {
                pose = &row.pose_deg;
                before_m = Vector3::zeros();
                play = rest(&unloaded);
                lag = tip_m(&unloaded, &mut play) - unloaded_m;
            }
            let payload = self.payload_in(&setup, row.row, &row.payload);
            let weight_n = payload.mass_kg * self.subject.structure.gravity_m_s2;
            let force_n = setup.loading.force_n(&row.force_n, weight_n, &unloaded.tip_rotation);
            let loaded = self.posed(&chain, pose, &payload, force_n);
            let load_n = force_n - Vector3::z() * (weight_n * self.buoyed_part());
            let turned_m: Vector3<f64> =
                setup.turned.iter().map(|t| t.moved_m(&unloaded.tip_m, row.row)).sum();
            let twisted_m = load_twists_m(&setup, &unloaded, &loaded);
            let deflected_m = tip_m(&loaded, &mut play) - (unloaded_m + lag) + twisted_m;
            let seen_too_m = setup.loading.sway_m(&load_n) + setup.loading.remaining * before_m;
            let d = deflected_m + turned_m + seen_too_m;
            before_m = deflected_m;
            let seen_mm = reading.along_own_axes(&(1e3 * d));
            out.push(std::array::from_fn(|c| reading.of(seen_mm[c], c, row.row)));
        }
        out
    }

    /// Predicted frequency readings \[Hz\], one per row; `None` where the arm has no mode of this number.
    pub fn frequencies_hz(&self, rows: &[ModalRow]) -> Vec<Option<f64>> {
        let reading = &self.subject.channels[Channel::Modal as usize];
        let setup = self.setup_of(Channel::Modal, mark(rows, |row| row.file));
        let mut last: Option<(&ModalRow, Vec<f64>)> = None;
        rows.iter()
            .map(|row| {
                let is_of_list = |first: &ModalRow| {
                    first.pose_deg == row.pose_deg && first.payload == row.payload && first.mode != row.mode
                };
                if !last.as_ref().is_some_and(|(first, _)| is_of_list(first)) {
                    let chain = self.chain_at(Channel::Modal, &row.moment());
                    let payload = self.payload_in(&setup, row.row, &row.payload);
                    let posed = self.posed(&chain, &row.pose_deg, &payload, Vector3::zeros());
                    let modes = posed.solve_modes(&posed.statics());
                    last = Some((row, modes.finite().map(|(_, f)| f).collect()));
                }
                let frequency = last.as_ref().and_then(|(_, f)| f.get(row.mode - 1).copied());
                frequency.map(|f| reading.of(f, 0, row.row))
            })
            .collect()
    }

    /// Predicted bench readings (twist of a joint) \[arcmin\], one per row.
    pub fn windups_arcmin(&self, rows: &[WindupRow]) -> Vec<f64> {
        let reading = &self.subject.channels[Channel::Windup as usize];
        let mut out = vec![0.0; rows.len()];
        let structure = self.subject.structure_in(Channel::Windup);
        for joint in structure.joints() {
            let own: Vec<usize> = (0..rows.len()).filter(|&i| rows[i].joint == joint.name).collect();
            let torques: Vec<f64> = own.iter().map(|&i| rows[i].torque_nm).collect();
            for (i, twist) in own.into_iter().zip(bench_twists_rad(&joint.law, &torques)) {
                out[i] = reading.of(twist * ARCMIN_PER_RAD, 0, rows[i].row);
            }
        }
        out
    }

    /// Predicted positions of the measured points under gravity and payload, in the instrument's frame \[mm\], one
    /// per row. `placement` says where the arm and the points stand.
    pub fn positions_mm(&self, rows: &[PositionRow], placement: &Placement) -> Vec<[f64; 3]> {
        let reading = &self.subject.channels[Channel::Positions as usize];
        let mut chains: Vec<(Vector3<f64>, Chain)> = Vec::new();
        let mut out = Vec::with_capacity(rows.len());
        for (row, stand) in rows.iter().zip(placement.stands(rows)) {
            let tool_m = stand.point_m(&row.point);
            if !self.subject.is_steady(Channel::Positions) {
                chains.clear(); // no chain serves another row
            }
            if !chains.iter().any(|(at_m, _)| *at_m == tool_m) {
                let structure = self.subject.structure_at(Channel::Positions, &row.moment());
                let structure = with_tool(&structure, tool_m);
                chains.push((tool_m, Chain::new(&structure, LinkModel::Full)));
            }
            let known = chains.iter().find(|(at_m, _)| *at_m == tool_m);
            let (_, chain) = known.expect("just made");
            let pose_rad: Vec<f64> = row.pose_deg.iter().map(|a| a.to_radians()).collect();
            let pose_rad = self.subject.turned_rad(&pose_rad);
            let payload = seen_from_tool(&self.subject.payload(&row.payload), &tool_m);
            let at = stand.rotation * chain.hanging_tip_m(&pose_rad, &payload) + stand.origin_m;
            out.push(std::array::from_fn(|c| reading.of(1e3 * at[c], c, row.row)));
        }
        out
    }

    /// Name of every joint, and the torque on it in the pose and under the loads of `row` \[N m\].
    pub fn torques_nm(&self, row: &StaticRow) -> Vec<(String, f64)> {
        let chain = self.chain_at(Channel::Static, &row.moment());
        let posed = self.posed(&chain, &row.pose_deg, &self.subject.payload(&row.payload), row.force_n);
        let torques = posed.statics().joint_torques_nm;
        torques.into_iter().map(|(joint, torque_nm)| (joint.to_string(), torque_nm)).collect()
    }

    /// The arm with the special set-up of a channel's tests, and with the properties that it has at the time or
    /// temperature `when`.
    fn chain_at(&self, channel: Channel, when: &Moment) -> Cow<'_, Chain> {
        if self.subject.is_steady(channel) {
            return Cow::Borrowed(self.special[channel as usize].as_ref().unwrap_or(&self.chain));
        }
        Cow::Owned(Chain::new(&self.subject.structure_at(channel, when), LinkModel::Full))
    }

    /// The arm as it was when the reference of a displacement was read.
    fn reference_at(&self, when: &Moment) -> Cow<'_, Chain> {
        match self.subject.setups[Channel::Static as usize].is_steady() {
            true => self.chain_at(Channel::Static, when),
            false => Cow::Owned(Chain::new(&self.subject.reference_at(when), LinkModel::Full)),
        }
    }

    /// The special set-up of the tests in the file of a channel with the mark `file`, with only those events that
    /// happened in this file.
    fn setup_of(&self, channel: Channel, file: usize) -> Setup {
        let mut setup = self.subject.setups[channel as usize].clone();
        setup.keep_events_of(file);
        setup
    }

    /// The actual payload in the row `row`, counted from 0, of tests with the set-up `setup`.
    fn payload_in(&self, setup: &Setup, row: usize, stated: &Payload) -> Payload {
        let slip_m = if stated.mass_kg == 0.0 { Vector3::zeros() } else { setup.slip_m(row) };
        let payload = self.subject.payload(stated);
        Payload { cg_m: payload.cg_m + slip_m, ..payload }
    }

    /// The part of a payload's weight that buoyancy leaves; 1 in air.
    fn buoyed_part(&self) -> f64 {
        let water = self.subject.structure.water;
        water.map_or(1.0, |water| 1.0 - water.density_kg_m3 / water.payload_density_kg_m3)
    }

    fn posed<'c>(
        &self,
        chain: &'c Chain,
        pose_deg: &[f64],
        payload: &Payload,
        force_n: Vector3<f64>,
    ) -> Posed<'c> {
        let pose_rad = self.subject.standing_rad(chain.pose_si(pose_deg));
        chain.pose_rad(&pose_rad, payload, force_n)
    }
}

/// The structure with its tip moved to the point `tool_m`, given in the last frame.
pub fn with_tool(structure: &Structure, tool_m: Vector3<f64>) -> Structure {
    let mut out = structure.clone();
    out.pieces.push(Piece::Link(LinkPiece {
        name: "point".into(),
        vector_m: tool_m,
        beam: None,
        point_mass_kg: 0.0,
        bodies: Vec::new(),
        harness_kg_per_m: 0.0,
        root_frame: FrameCompliance::default(),
    }));
    out
}

/// The payload with its centre of gravity counted from the point `tool_m` in the last frame. In `payload` it is
/// counted from the tip.
pub fn seen_from_tool(payload: &Payload, tool_m: &Vector3<f64>) -> Payload {
    Payload { cg_m: payload.cg_m - tool_m, ..*payload }
}

/// A joint in a pose.
struct PosedJoint {
    name: String,
    /// Torsion law.
    law: JointLaw,
    /// Kinematic twist.
    twist: Twist,
    torque_nm: f64,
}

/// The joints in a pose, from base to tip.
fn joints(posed: &Posed) -> Vec<PosedJoint> {
    let torques = posed.statics().joint_torques_nm;
    let mut twists = posed.tip_twists().into_iter();
    let laws = posed.elements().filter_map(|element| {
        // elements without strain coordinates have no twist
        let own: Vec<Twist> = twists.by_ref().take(element.twists.len()).collect();
        match element.compliance {
            Compliance::Joint(law) => Some((element.name.clone(), law, own[0])),
            Compliance::Linear(_) | Compliance::Slide { .. } | Compliance::Lift(_) => None,
        }
    });
    let joint = |((name, law, twist), torque_nm)| PosedJoint { name, law, twist, torque_nm };
    laws.zip(torques.into_iter().map(|(_, torque_nm)| torque_nm)).map(joint).collect()
}

/// State of each joint's friction play, as a torque, when the arm has come to rest in this pose \[N m\], from base to
/// tip.
fn rest(posed: &Posed) -> Vec<f64> {
    joints(posed).iter().map(|joint| joint.law.play_at_rest_nm(joint.torque_nm)).collect()
}

/// Displacement of the tip from its place in the weightless arm \[m\]. `play` is the state of each joint's friction
/// play. It is updated to the torques of this pose.
fn tip_m(posed: &Posed, play: &mut [f64]) -> Vector3<f64> {
    let joints = joints(posed);
    let statics = posed.statics();
    let mut tip = statics.tip_displacement_m;
    for (PosedJoint { law, twist, torque_nm, .. }, state) in joints.into_iter().zip(play) {
        let followed = law.play_angle_rad(torque_nm, state) - law.rising_angle_rad(torque_nm);
        tip += displacement_at(&(twist * followed), &posed.tip_m);
    }
    tip
}

/// Displacement of the tip from its place in the unloaded arm by further twists of the joints under the load \[m\].
fn load_twists_m(setup: &Setup, unloaded: &Posed, loaded: &Posed) -> Vector3<f64> {
    if setup.load_twists.is_empty() {
        return Vector3::zeros();
    }
    let (before, after) = (joints(unloaded), joints(loaded));
    let load_nm = |j: Option<usize>| {
        j.and_then(|j| Some(after.get(j)?.torque_nm - before[j].torque_nm)).unwrap_or_default()
    };
    let moved_m = |(j, joint): (usize, &PosedJoint)| -> Vector3<f64> {
        let torques_nm = [j.checked_sub(1), Some(j), Some(j + 1)].map(load_nm);
        let twists = setup.load_twists_of(&joint.name);
        let twist_rad: f64 = twists.iter().map(|twist| twist.angle_rad(torques_nm)).sum();
        displacement_at(&(joint.twist * twist_rad), &loaded.tip_m)
    };
    after.iter().enumerate().map(moved_m).sum()
}
