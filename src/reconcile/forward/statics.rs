//! Predicts static readings: the displacement of the tip from the reference state, which is the unloaded arm.
//!
//! The chain is statically determinate, so torques depend on masses and loads only. All linear compliances together
//! move the tip by `A w`, where `A` is a 3x6 matrix per pose and `w` the wrench of the load. A joint moves the tip by
//! `θ(T) - θ(T0)` times the displacement of the tip per unit of the joint's twist, where `T` and `T0` are the torques
//! with and without load. Friction play depends on the order of the rows.

use super::coefficients::{Coefficients, Layout, StaticChanges};
use super::datum::{Datum, Groups};
use super::dead_weight::{dead_forces, dead_torques};
use crate::arm::effect::channel::Channel;
use crate::arm::effect::subject::Subject;
use crate::arm::effect::warming::Moment;
use crate::arm::joint_law::JointLaw;
use crate::arm::load::Payload;
use crate::mechanics::{Twist, Wrench, displacement_at, force_wrench};
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::components::Component;
use nalgebra::{Matrix3x6, Rotation3, Vector3};

/// A strain coordinate, and how everything outboard of it and the tip move with it.
#[derive(Debug, Clone)]
pub struct Mover {
    /// Index of the strain coordinate.
    pub index: usize,
    /// Motion (kinematic twist) of everything outboard of the coordinate, per unit of the coordinate.
    pub twist: Twist,
    /// Displacement of the tip per unit of the coordinate.
    pub tip: Vector3<f64>,
}

/// Everything about a pose that does not depend on fitted parameters.
#[derive(Debug, Clone)]
pub struct PoseGeometry {
    /// Position of the tip, world frame \[m\].
    pub tip_m: Vector3<f64>,
    /// Rotation of the last frame relative to the world.
    pub rotation: Rotation3<f64>,
    /// The strain coordinates that move the tip, except those of the joints' torsion.
    pub linear: Vec<Mover>,
    /// The coordinates of the joints' torsion, base to tip.
    pub joints: Vec<Mover>,
    /// Angle of each joint in the pose, base to tip \[rad\].
    pub angles_rad: Vec<f64>,
    /// Torque on each joint by the weight of the template (the nominal arm, no payload) and by springs \[N m\].
    pub dead_nm: Vec<f64>,
    /// For each mass that a fit can change, the torques on the joints by one unit of this mass \[N m\].
    pub dead_per_mass_nm: Vec<Vec<f64>>,
    /// Generalized force of the template's weight on each strain coordinate \[N m for a rotation\].
    pub(crate) dead_forces: Vec<f64>,
    /// The two coordinates of the base's tilt, about world x and y.
    pub base: [Mover; 2],
    /// Moments of the template's weight about world x and y of the base \[N m\].
    dead_base_nm: [f64; 2],
    /// For each mass that a fit can change, the moments of one unit of it about world x and y of the base \[N m\].
    dead_base_per_mass_nm: Vec<[f64; 2]>,
}

/// One load in a pose: payload and tip force.
#[derive(Debug, Clone)]
struct Load {
    payload: Payload,
    force_n: Vector3<f64>,
    /// For each component x, y, z, the index of its datum; `None` if it was not measured.
    data: [Option<usize>; 3],
    when: Moment,
}

/// A pose with its loads in the order of the file.
#[derive(Debug, Clone)]
pub struct StaticPose {
    /// Geometry of the pose.
    pub geometry: PoseGeometry,
    loads: Vec<Load>,
}

/// The loads in a pose, and the deflections of an arm with given coefficients under them. A fit keeps this state. A
/// change of few coefficients, as for a derivative, then needs only a part of the computation.
#[derive(Debug, Clone, Default)]
pub struct StaticState {
    /// Displacement of the tip per unit of the load's wrench, by all linear compliances together. If the moduli of
    /// the links change between loads, the links are not included.
    compliance: Matrix3x6<f64>,
    /// Displacement of the tip per unit of the load's wrench, by the links alone; used only if their moduli change.
    bending: Matrix3x6<f64>,
    /// Factor on the compliance of the links under each load; empty if their moduli do not change.
    softness: Vec<f64>,
    /// Tilt of a base whose feet lift off under each load, relative to the unloaded arm \[rad\]; empty if the feet do
    /// not lift off.
    lifted_rad: Vec<[f64; 2]>,
    /// Torque on each joint by weight and springs without load \[N m\].
    dead_nm: Vec<f64>,
    /// Memory in which the torques `dead_nm` are computed for other masses \[N m\].
    moved_dead_nm: Vec<f64>,
    /// Wrench of each load, about the world's origin.
    wrenches: Vec<Wrench>,
    /// Torque on each joint by each load, in addition to `dead_nm` \[N m\]: all loads of the first joint, then those
    /// of the second.
    loaded_nm: Vec<f64>,
    /// Twist (torsion angle) of each joint under each load, relative to the unloaded arm \[rad\], in the order of
    /// `loaded_nm`.
    twists_rad: Vec<f64>,
}

impl StaticState {
    /// Copies the state `other` into the memory of this state, so that no memory is allocated.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.compliance = other.compliance;
        self.bending = other.bending;
        self.softness.clone_from(&other.softness);
        self.lifted_rad.clone_from(&other.lifted_rad);
        self.dead_nm.clone_from(&other.dead_nm);
        self.wrenches.clone_from(&other.wrenches);
        self.loaded_nm.clone_from(&other.loaded_nm);
        self.twists_rad.clone_from(&other.twists_rad);
    }
}

/// Prepares the poses of a campaign's static rows, each with its loads, and appends their readings to `data`. Rows of
/// one pose that follow one another share their history of friction.
pub(crate) fn prepare(
    campaign: &Campaign,
    layout: &Layout,
    nominal: &Subject,
    groups: &mut Groups,
    data: &mut Vec<Datum>,
) -> Vec<StaticPose> {
    let mut poses: Vec<StaticPose> = Vec::new();
    let mut last: Option<&[f64]> = None;
    for (index, row) in campaign.statics.iter().enumerate() {
        let group = groups.of(&row.pose_deg);
        // loads in one pose share a history of friction; it starts again when the pose changes
        if last != Some(&row.pose_deg) {
            let geometry = PoseGeometry::new(layout, nominal, &row.pose_deg);
            poses.push(StaticPose { geometry, loads: Vec::new() });
            last = Some(&row.pose_deg);
        }
        let mut load =
            Load { payload: row.payload, force_n: row.force_n, data: [None; 3], when: row.moment() };
        for (component, read) in row.measured.iter().enumerate() {
            let Some(Component { value_mm: value, sigma_mm: sigma }) = *read else { continue };
            load.data[component] = Some(data.len());
            data.push(Datum {
                channel: Channel::Static,
                row: row.row,
                index,
                component,
                group,
                value,
                sigma,
            });
        }
        poses.last_mut().expect("pushed above").loads.push(load);
    }
    poses
}

/// What loads the arm in a static reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LoadedBy {
    /// Whether there is a payload.
    pub payload: bool,
    /// Whether a force acts on the tip.
    pub force: bool,
}

impl StaticPose {
    /// The index of each reading of the pose in the campaign's data, with what loads the arm in it.
    pub(crate) fn loaded_by(&self) -> impl Iterator<Item = (usize, LoadedBy)> + '_ {
        self.loads.iter().flat_map(|load| {
            let by =
                LoadedBy { payload: load.payload.mass_kg > 0.0, force: load.force_n != Vector3::zeros() };
            load.data.iter().flatten().map(move |datum| (*datum, by))
        })
    }
}

impl PoseGeometry {
    /// Generalized force on a strain coordinate by the dead weight and by the load `wrench` \[N m for a rotation\].
    pub(crate) fn force_on(&self, index: usize, wrench: &Wrench) -> f64 {
        let mover = self.linear.iter().find(|mover| mover.index == index);
        self.dead_forces[index] + mover.map_or(0.0, |mover| mover.twist.dot(wrench))
    }

    /// Computes the geometry of a pose with the mechanics of the full model.
    pub fn new(layout: &Layout, nominal: &Subject, pose_deg: &[f64]) -> Self {
        let pose_rad = nominal.standing_rad(layout.template.pose_si(pose_deg));
        let empty = Payload::default();
        let posed = layout.template.pose_rad(&pose_rad, &empty, Vector3::zeros());
        let twists = posed.tip_twists();
        let mover = |index: usize| Mover {
            index,
            twist: twists[index],
            tip: displacement_at(&twists[index], &posed.tip_m),
        };
        let is_joint = |i: usize| layout.joints.iter().any(|j| j.twist == i);
        let (dead_nm, dead_base_nm) = dead_torques(&posed);
        // torques are linear in the masses, so one unit of each is enough
        let (dead_per_mass_nm, dead_base_per_mass_nm) = layout
            .with_mass
            .iter()
            .map(|chain| {
                let (with, base) = dead_torques(&chain.pose_rad(&pose_rad, &empty, Vector3::zeros()));
                let joints: Vec<f64> = with.iter().zip(&dead_nm).map(|(a, b)| a - b).collect();
                (joints, [0, 1].map(|i| base[i] - dead_base_nm[i]))
            })
            .unzip();
        Self {
            tip_m: posed.tip_m,
            rotation: posed.tip_rotation,
            linear: (0..layout.n)
                .filter(|&i| !is_joint(i) && twists[i] != Twist::zeros())
                .map(mover)
                .collect(),
            joints: layout.joints.iter().map(|j| mover(j.twist)).collect(),
            angles_rad: nominal.structure.joints().map(|joint| joint.angle.of(&pose_rad)).collect(),
            dead_nm,
            dead_per_mass_nm,
            dead_forces: dead_forces(&posed),
            base: [0, 1].map(mover),
            dead_base_nm,
            dead_base_per_mass_nm,
        }
    }

    /// Moments on the base about world x and y by all weight except the payload, in a test of the channel `channel`
    /// \[N m\].
    pub fn dead_base_nm(&self, coefficients: &Coefficients, layout: &Layout, channel: Channel) -> [f64; 2] {
        let masses = self.dead_base_per_mass_nm.iter().zip(&coefficients.weights);
        let test =
            coefficients.tests[channel as usize].weight(&self.tip_m, &self.rotation, layout.gravity_m_s2);
        [0, 1].map(|i| {
            let further: f64 = masses.clone().map(|(per_mass, weight)| per_mass[i] * weight).sum();
            self.dead_base_nm[i] + further + self.base[i].twist.dot(&test)
        })
    }

    /// Displacement of the tip per unit of the load's wrench, due to the linear compliances of the strain coordinates
    /// whose index satisfies `is_chosen`.
    fn compliance(&self, coefficients: &Coefficients, is_chosen: impl Fn(usize) -> bool) -> Matrix3x6<f64> {
        let mut out = Matrix3x6::zeros();
        for mover in self.linear.iter().filter(|mover| is_chosen(mover.index)) {
            let compliance = coefficients.linear[mover.index];
            if compliance != 0.0 {
                out += mover.tip * (compliance * mover.twist.transpose());
            }
        }
        out
    }

    /// Torque on each joint by all weight except the payload, and by springs, in a test of the channel `channel` \[N
    /// m\].
    pub fn dead_torques_nm(
        &self,
        coefficients: &Coefficients,
        layout: &Layout,
        channel: Channel,
    ) -> Vec<f64> {
        let mut torques_nm = Vec::new();
        self.add_up_dead_torques(coefficients, layout, channel, &mut torques_nm);
        torques_nm
    }

    /// Replaces the content of `torques_nm` by the result of `dead_torques_nm`. No memory is allocated if it is large
    /// enough.
    fn add_up_dead_torques(
        &self,
        coefficients: &Coefficients,
        layout: &Layout,
        channel: Channel,
        torques_nm: &mut Vec<f64>,
    ) {
        torques_nm.clone_from(&self.dead_nm);
        for (per_mass, weight) in self.dead_per_mass_nm.iter().zip(&coefficients.weights) {
            if *weight != 0.0 {
                torques_nm.iter_mut().zip(per_mass).for_each(|(t, p)| *t += weight * p);
            }
        }
        for ((torque_nm, further), angle_rad) in
            torques_nm.iter_mut().zip(&coefficients.torques).zip(&self.angles_rad)
        {
            if !further.is_none() {
                *torque_nm += further.at(*angle_rad);
            }
        }
        let test = &coefficients.tests[channel as usize];
        if test.mass_kg != 0.0 {
            let weight = test.weight(&self.tip_m, &self.rotation, layout.gravity_m_s2);
            torques_nm.iter_mut().zip(&self.joints).for_each(|(t, m)| *t += m.twist.dot(&weight));
        }
    }

    /// Weight of the payload, corrected by the coefficients, and tip force, together as a wrench about the world's
    /// origin. They are those of the row `row`, counted from 0, in the file of `channel`.
    pub(crate) fn wrench(
        &self,
        payload: &Payload,
        force_n: &Vector3<f64>,
        gravity_m_s2: f64,
        coefficients: &Coefficients,
        (channel, row): (Channel, usize),
    ) -> Wrench {
        let loading = &coefficients.tests[channel as usize].loading;
        if payload.mass_kg == 0.0 {
            return force_wrench(&loading.force_n(force_n, 0.0, &self.rotation), &self.tip_m);
        }
        let mass_kg = payload.mass_kg + coefficients.payload_delta_kg;
        let pulled_n = loading.force_n(force_n, mass_kg * gravity_m_s2, &self.rotation);
        let offset_m = coefficients.payload_offset_in(channel, row);
        let cg_m = self.tip_m + self.rotation * (payload.cg_m + offset_m);
        let weight_n = mass_kg * gravity_m_s2 * coefficients.payload_weight;
        force_wrench(&pulled_n, &self.tip_m) + force_wrench(&Vector3::new(0.0, 0.0, -weight_n), &cg_m)
    }
}

/// Computes the twists (torsion angles) of a joint under successive loads, relative to the twist of the unloaded arm
/// \[rad\]. `dead_nm` is the torque without load, and `loaded_nm` gives the additional torque of each load. The
/// unloaded arm is the reference. It is taken to come to rest before each pose, so the friction play starts from rest.
fn follow(law: &JointLaw, dead_nm: f64, loaded_nm: &[f64], twists_rad: &mut [f64]) {
    follow_from(law, law, dead_nm, loaded_nm, twists_rad);
}

/// Computes the twists (torsion angles) of a joint under successive loads like `follow`. The joint had the law
/// `reference` when the reference of the unloaded arm was read, and has the law `law` under the loads.
fn follow_from(
    reference: &JointLaw,
    law: &JointLaw,
    dead_nm: f64,
    loaded_nm: &[f64],
    twists_rad: &mut [f64],
) {
    let mut play_nm = reference.play_at_rest_nm(dead_nm);
    let reference_rad = reference.play_angle_rad(dead_nm, &mut play_nm);
    for (twist_rad, loaded_nm) in twists_rad.iter_mut().zip(loaded_nm) {
        *twist_rad = law.play_angle_rad(dead_nm + loaded_nm, &mut play_nm) - reference_rad;
    }
}

/// The laws of a joint that belong to one load.
struct LawsOfLoad {
    /// The law when the reference of the reading was read.
    reference: JointLaw,
    /// The law under the load.
    loaded: JointLaw,
}

/// Computes the twists (torsion angles) of a joint under successive loads like `follow`, for a joint whose law differs
/// from load to load. `laws` gives the two laws of each load. The twist under a load is computed with these two laws
/// for the whole sequence of loads, from rest to this load.
fn follow_changing(
    laws: impl Iterator<Item = LawsOfLoad>,
    dead_nm: f64,
    loaded_nm: &[f64],
    twists_rad: &mut [f64],
) {
    let mut own_rad = vec![0.0; loaded_nm.len()];
    for (load, LawsOfLoad { reference, loaded }) in laws.enumerate() {
        follow_from(&reference, &loaded, dead_nm, &loaded_nm[..=load], &mut own_rad[..=load]);
        twists_rad[load] = own_rad[load];
    }
}

impl StaticPose {
    /// The loads and deflections in this pose of an arm with these coefficients.
    pub(crate) fn state(&self, layout: &Layout, coefficients: &Coefficients) -> StaticState {
        let mut out = StaticState::default();
        self.update(layout, coefficients, &StaticChanges::all(coefficients.laws.len()), &mut out);
        out
    }

    /// Changes `state` from other coefficients to `coefficients`. `changes` says which numbers differ; only values that
    /// depend on these are computed again.
    pub(crate) fn update(
        &self,
        layout: &Layout,
        coefficients: &Coefficients,
        changes: &StaticChanges,
        state: &mut StaticState,
    ) {
        if changes.linear {
            self.update_compliance(layout, coefficients, state);
        }
        let joints = self.geometry.joints.len();
        if changes.payload {
            self.update_loads(layout, coefficients, state);
        }
        if changes.weights {
            let moved_dead_nm = &mut state.moved_dead_nm;
            self.geometry.add_up_dead_torques(coefficients, layout, Channel::Static, moved_dead_nm);
            state.dead_nm.resize(joints, f64::NAN);
        }
        if changes.lift || changes.weights || changes.payload {
            self.lift(layout, coefficients, state);
        }
        state.twists_rad.resize(joints * self.loads.len(), 0.0);
        for j in 0..joints {
            // a mass changes the torque only on joints inboard of the mass
            let is_loaded_otherwise = changes.weights && state.moved_dead_nm[j] != state.dead_nm[j];
            if is_loaded_otherwise {
                state.dead_nm[j] = state.moved_dead_nm[j];
            }
            if is_loaded_otherwise || changes.payload || changes.laws[j] {
                self.update_twists(j, coefficients, state);
            }
        }
    }

    /// Computes how the linear compliances together move the tip, and stores it in `state`. If the moduli of the links
    /// change between loads, the compliance of the links is stored separately.
    fn update_compliance(&self, layout: &Layout, coefficients: &Coefficients, state: &mut StaticState) {
        let geometry = &self.geometry;
        let warming = &coefficients.warming;
        state.softness.clear();
        if warming.is_none() {
            state.compliance = geometry.compliance(coefficients, |_| true);
        } else {
            state.compliance = geometry.compliance(coefficients, |i| !layout.is_of_link(i));
            state.bending = geometry.compliance(coefficients, |i| layout.is_of_link(i));
            state.softness.extend(self.loads.iter().map(|load| 1.0 / warming.factor(&load.when)));
        }
    }

    /// Weight of the payload and tip force of a load together, as a wrench about the world's origin.
    fn wrench(&self, load: &Load, layout: &Layout, coefficients: &Coefficients) -> Wrench {
        let at = (Channel::Static, load.when.row);
        self.geometry.wrench(&load.payload, &load.force_n, layout.gravity_m_s2, coefficients, at)
    }

    /// Computes the wrench of each load and its torque on each joint, and stores them in `state`.
    fn update_loads(&self, layout: &Layout, coefficients: &Coefficients, state: &mut StaticState) {
        let geometry = &self.geometry;
        state.wrenches.clear();
        state.wrenches.extend(self.loads.iter().map(|load| self.wrench(load, layout, coefficients)));
        state.loaded_nm.clear();
        let torques_nm = geometry.joints.iter().flat_map(|m| state.wrenches.iter().map(|w| m.twist.dot(w)));
        state.loaded_nm.extend(torques_nm);
    }

    /// Computes the twists (torsion angles) of joint `j` under the loads from the torques in `state`, and stores the
    /// twists in `state`.
    fn update_twists(&self, j: usize, coefficients: &Coefficients, state: &mut StaticState) {
        let count = self.loads.len();
        let angle_rad = self.geometry.angles_rad[j];
        let own = j * count..(j + 1) * count;
        let law = |row| coefficients.law_at(j, Channel::Static, angle_rad, row);
        let (dead_nm, loaded_nm) = (state.dead_nm[j], &state.loaded_nm[own.clone()]);
        let twists_rad = &mut state.twists_rad[own];
        match coefficients.tests[Channel::Static as usize].softening_of(j) {
            None => follow(&law(0), dead_nm, loaded_nm, twists_rad),
            Some(softening) => {
                let unchanged = coefficients.law(j, Channel::Static).at_angle(angle_rad);
                let rows = self.loads.iter().map(|load| load.when.row);
                let laws = rows.map(|row| LawsOfLoad {
                    reference: unchanged.softer(softening.reference_factor(row)),
                    loaded: law(row),
                });
                follow_changing(laws, dead_nm, loaded_nm, twists_rad);
            }
        }
        for further in coefficients.tests[Channel::Static as usize].load_twists_of(j) {
            let torque_nm = |joint: Option<usize>, load: usize| {
                joint.and_then(|joint| state.loaded_nm.get(joint * count + load)).copied().unwrap_or(0.0)
            };
            for (load, twist_rad) in twists_rad.iter_mut().enumerate() {
                let near = [j.checked_sub(1), Some(j), Some(j + 1)];
                *twist_rad += further.angle_rad(near.map(|joint| torque_nm(joint, load)));
            }
        }
    }

    /// Displacement of the tip from the unloaded arm under the load with index `load` \[mm\].
    pub(crate) fn displacement_mm(&self, state: &StaticState, load: usize) -> Vector3<f64> {
        let wrench = state.wrenches[load];
        let mut tip = state.compliance * wrench;
        if let Some(softness) = state.softness.get(load) {
            tip += state.bending * wrench * *softness;
        }
        if let Some(lifted_rad) = state.lifted_rad.get(load) {
            self.geometry.base.iter().zip(lifted_rad).for_each(|(m, angle)| tip += m.tip * *angle);
        }
        for (j, mover) in self.geometry.joints.iter().enumerate() {
            tip += mover.tip * state.twists_rad[j * self.loads.len() + load];
        }
        1e3 * tip
    }

    /// Number of loads in the pose.
    pub(crate) fn count(&self) -> usize {
        self.loads.len()
    }

    /// The measured components of the tip displacement under the load with index `load`. Each is a pair: number of
    /// the component (0 to 2), and index of its datum.
    pub(crate) fn measured(&self, load: usize) -> impl Iterator<Item = (usize, usize)> {
        self.loads[load]
            .data
            .into_iter()
            .enumerate()
            .filter_map(|(component, datum)| Some((component, datum?)))
    }

    /// Computes the tilts of a base whose feet lift off, under each load of the pose, and stores them in `state`.
    fn lift(&self, layout: &Layout, coefficients: &Coefficients, state: &mut StaticState) {
        state.lifted_rad.clear();
        let Some(lift) = coefficients.lift else { return };
        let dead_nm = self.geometry.dead_base_nm(coefficients, layout, Channel::Static);
        let base = &self.geometry.base;
        let lifted = |wrench: &Wrench| {
            [0, 1]
                .map(|i| lift.angle_rad(dead_nm[i] + base[i].twist.dot(wrench)) - lift.angle_rad(dead_nm[i]))
        };
        state.lifted_rad.extend(state.wrenches.iter().map(lifted));
    }

    /// Displacement of the tip under the load with index `load` along the axes of the instrument \[mm\]. It contains
    /// turns of the base and motions of the instrument in the course of the tests.
    pub(crate) fn seen_mm(
        &self,
        state: &StaticState,
        coefficients: &Coefficients,
        load: usize,
    ) -> Vector3<f64> {
        let test = &coefficients.tests[Channel::Static as usize];
        let load_n = state.wrenches[load].fixed_rows::<3>(0).into_owned();
        let mut moved_mm = self.displacement_mm(state, load) + 1e3 * test.loading.sway_m(&load_n);
        if let Some(before) = load.checked_sub(1).filter(|_| test.loading.remaining != 0.0) {
            moved_mm += test.loading.remaining * self.displacement_mm(state, before);
        }
        for turned in &test.turned {
            moved_mm += 1e3 * turned.moved_m(&self.geometry.tip_m, self.loads[load].when.row);
        }
        coefficients.channels[Channel::Static as usize].along_own_axes(&moved_mm)
    }

    /// Writes the measured components of [`seen_mm`](Self::seen_mm) under each load to their data in `out` \[mm\].
    pub(crate) fn write(&self, state: &StaticState, coefficients: &Coefficients, out: &mut [f64]) {
        for load in 0..self.loads.len() {
            let seen_mm = self.seen_mm(state, coefficients, load);
            self.measured(load).for_each(|(component, datum)| out[datum] = seen_mm[component]);
        }
    }

    /// Adds to `out` the displacement of the tip under each load that is due to additional compliances \[mm\]. Each
    /// entry of `further` is the index of a strain coordinate and the compliance that is added to that of the
    /// coefficients.
    pub fn add_compliant(
        &self,
        layout: &Layout,
        coefficients: &Coefficients,
        further: &[(usize, f64)],
        out: &mut [f64],
    ) {
        let geometry = &self.geometry;
        let compliance = |index: usize| further.iter().find(|(i, _)| *i == index).map(|(_, c)| *c);
        let compliance_of: Matrix3x6<f64> = geometry
            .linear
            .iter()
            .filter_map(|m| Some(m.tip * (compliance(m.index)? * m.twist.transpose())))
            .sum();
        for (k, load) in self.loads.iter().enumerate() {
            let wrench = self.wrench(load, layout, coefficients);
            let moved = 1e3 * compliance_of * wrench;
            self.measured(k).for_each(|(component, datum)| out[datum] += moved[component]);
        }
    }

    /// Weight of the payload and tip force together, under each load of the pose, as a wrench about the world's origin.
    pub(crate) fn wrenches(&self, layout: &Layout, coefficients: &Coefficients) -> Vec<Wrench> {
        self.loads.iter().map(|load| self.wrench(load, layout, coefficients)).collect()
    }

    /// Largest moment on the base of an arm with these coefficients, about world x or y, without load and under all
    /// loads of the pose \[N m\].
    pub fn largest_base_nm(&self, layout: &Layout, coefficients: &Coefficients) -> f64 {
        let dead = self.geometry.dead_base_nm(coefficients, layout, Channel::Static);
        let loads = self.loads.iter().map(|load| self.wrench(load, layout, coefficients));
        let base = &self.geometry.base;
        let loaded = loads.map(|w| [0, 1].map(|i| (dead[i] + base[i].twist.dot(&w)).abs()));
        loaded.flatten().chain(dead.map(f64::abs)).fold(0.0, f64::max)
    }

    /// Largest force of a load of the pose along world x, y or z, weight of the payload included \[N\].
    pub(crate) fn largest_force_n(&self, layout: &Layout, coefficients: &Coefficients) -> f64 {
        let loads = self.loads.iter().map(|load| self.wrench(load, layout, coefficients));
        loads.map(|wrench| wrench.fixed_rows::<3>(0).amax()).fold(0.0, f64::max)
    }

    /// Torque on each joint of an arm with these coefficients \[N m\]: the first list without load, then one list for
    /// each load.
    pub fn torques_nm(&self, layout: &Layout, coefficients: &Coefficients) -> Vec<Vec<f64>> {
        let dead = self.geometry.dead_torques_nm(coefficients, layout, Channel::Static);
        let mut out = vec![dead.clone()];
        for load in &self.loads {
            let wrench = self.wrench(load, layout, coefficients);
            let joints = self.geometry.joints.iter().zip(&dead);
            out.push(joints.map(|(m, t)| t + m.twist.dot(&wrench)).collect());
        }
        out
    }
}
