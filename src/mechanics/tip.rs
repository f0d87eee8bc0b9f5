//! The tip of an arm in many poses: how far weight displaces it, and nothing else.
//!
//! A [`Posed`](super::Posed) arm lists every element with its motions and its inertia, because modes need them. A campaign
//! of positions asks for the displacement of the tip alone, in up to a hundred thousand poses and for many changes of the
//! arm. [`Tip`] computes it with the same laws and without the lists: one walk to the tip and one back to the base.
//!
//! All loads are weights. So everything outboard of a place is known by two sums over its bodies: the weight `W`, and the
//! first moment `S` of the weight about the world's origin. At the point `p` it has the moment `(S - W p) × ĝ`, where `ĝ` is
//! the direction of gravity.
//!
//! The end of a beam moves by `F (f, m) + G ĝ`, where `f` and `m` are force and moment at its end, all in the frame of its
//! section. The matrices `F` and `G` sum up its strain coordinates; `G` has the weight along the beam.

use super::beam::PreparedBeam;
use super::deflections::deflect;
use super::hanging::Deflected;
use super::{across, angular, linear, stack, turn};
use crate::arm::LinkModel;
use crate::arm::base_lift::BaseLift;
use crate::arm::body::RigidBody;
use crate::arm::joint_law::JointLaw;
use crate::arm::joint_torque::JointTorque;
use crate::arm::linkage::linkages;
use crate::arm::load::Payload;
use crate::arm::structure::{JointAngle, JointPiece, LinkPiece, Piece, Structure};
use nalgebra::{Matrix3, Matrix6, Matrix6x3, Rotation3, Unit, Vector3, Vector6};

/// An arm prepared for the displacement of its tip by weight in many poses.
pub(crate) struct Tip {
    gravity_m_s2: f64,
    down: Vector3<f64>,
    /// Weight of a payload over mass times gravity: less than 1 in water.
    payload_part: f64,
    /// What a walk from the base to the tip meets.
    steps: Vec<Step>,
    linkages: Vec<Linked>,
}

/// A joint that turns another one.
struct Linked {
    /// Index of the step of the driving joint.
    driver: usize,
    /// Index of the step of the joint that it turns.
    passive: usize,
    /// Rotation of the passive joint per rotation of the driving joint.
    factor: f64,
}

/// What a walk from the base to the tip meets next. All vectors are in the frame that the walk has reached.
enum Step {
    /// A weight \[N\], and where it is from the place that the walk has reached \[m\].
    Weight(f64, Vector3<f64>),
    /// Rotational springs about axes through the place that the walk has reached.
    Springs(Box<Springs>),
    /// Feet of the base, which can lift off.
    Lift(BaseLift),
    Joint(Box<Hinge>),
    /// A rigid offset \[m\].
    Shift(Vector3<f64>),
    /// A link with an elastic element: its vector \[m\], and its end under load.
    Beam(Vector3<f64>, Box<BeamEnd>),
}

/// Rotational springs in series.
struct Springs {
    /// Unit vectors.
    axes: Vec<Vector3<f64>>,
    /// Rotation per moment \[rad/(N m)\].
    by_moment: Matrix3<f64>,
}

/// A joint with its torsion spring.
struct Hinge {
    axis: Unit<Vector3<f64>>,
    angle: JointAngle,
    law: JointLaw,
    torque: JointTorque,
}

impl Hinge {
    /// Torque on the joint that comes neither from weight nor from load \[N m\].
    fn own_nm(&self, pose_rad: &[f64]) -> f64 {
        if self.torque.is_none() { 0.0 } else { self.torque.at(self.angle.of(pose_rad)) }
    }

    /// Torsion under the torque `nm` \[rad\].
    fn torsion_rad(&self, pose_rad: &[f64], nm: f64) -> f64 {
        self.law.at_angle(self.angle.of(pose_rad)).rising_angle_rad(nm)
    }

    /// Sine and cosine of the angle of the joint. `sin_cos` has those of the pose.
    fn sin_cos(&self, pose_rad: &[f64], sin_cos: &[(f64, f64)]) -> (f64, f64) {
        match &self.angle {
            JointAngle::Driven(entry) => sin_cos[*entry],
            coupled @ JointAngle::Coupled(_) => libm::sincos(coupled.of(pose_rad)),
        }
    }
}

/// The end of a beam under load, in the frame of its section.
struct BeamEnd {
    /// Axes of the section (columns), in the frame that the walk has reached.
    frame: Matrix3<f64>,
    /// Displacement and rotation of the end per force and moment there.
    by_load: Matrix6<f64>,
    /// Displacement and rotation of the end by the weight of the beam and of what is on it, per direction of gravity.
    by_weight: Matrix6x3<f64>,
    weight_n: f64,
    /// First moment of the weight about the root \[N m\], in the frame that the walk has reached.
    moment_nm: Vector3<f64>,
}

impl BeamEnd {
    fn new(beam: &PreparedBeam) -> Self {
        let mut by_load = Matrix6::zeros();
        let mut by_weight = Matrix6x3::zeros();
        let works = &beam.area_fields * beam.weight_n_per_m + &beam.bodies.fields;
        for (k, compliance) in beam.compliances.iter().enumerate() {
            let end: Vector6<f64> = beam.end_fields.column(k).into_owned();
            let work: Vector3<f64> = works.column(k).into_owned();
            by_load += end * end.transpose() * *compliance;
            by_weight += end * work.transpose() * *compliance;
        }
        let tube_n = beam.weight_n_per_m * beam.length_m;
        let along = beam.frame.column(0) * (tube_n * beam.length_m / 2.0);
        Self {
            frame: beam.frame,
            by_load,
            by_weight,
            weight_n: tube_n + beam.bodies.weight_n,
            moment_nm: along + beam.frame * beam.bodies.moment_nm,
        }
    }
}

/// Weight and its first moment.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Weights {
    /// Sum of the weights \[N\].
    pub weight_n: f64,
    /// Sum of weight times position \[N m\].
    pub moment_nm: Vector3<f64>,
}

impl Weights {
    fn add(&mut self, weight_n: f64, at_m: &Vector3<f64>) {
        self.weight_n += weight_n;
        self.moment_nm += at_m * weight_n;
    }

    /// Adds other weights.
    pub(crate) fn join(&mut self, other: &Self) {
        self.weight_n += other.weight_n;
        self.moment_nm += other.moment_nm;
    }

    /// First moment of the weights about the point `at_m` \[N m\].
    pub(crate) fn about(&self, at_m: &Vector3<f64>) -> Vector3<f64> {
        self.moment_nm - at_m * self.weight_n
    }
}

/// A pose of an arm with its load.
pub(crate) struct Loaded<'a> {
    /// Angles of the driven joints \[rad\].
    pub pose_rad: &'a [f64],
    /// Sine and cosine of each of these angles.
    pub sin_cos: &'a [(f64, f64)],
    /// The payload. Its centre of gravity is counted from the tip.
    pub payload: &'a Payload,
    /// Number of steps of the trunk, and the weights of other arms that hang on it.
    pub trunk: (usize, Weights),
}

/// Position \[m\] and attitude of a frame in the world.
#[derive(Clone, Copy)]
struct Place {
    at_m: Vector3<f64>,
    rotation: Rotation3<f64>,
}

/// How an element moves what is outboard of it, in its own frame: displacement \[m\] and rotation \[rad\].
#[derive(Clone, Copy)]
pub(crate) struct Strain {
    shift_m: Vector3<f64>,
    turn_rad: Vector3<f64>,
}

const UNSTRAINED: Strain =
    Strain { shift_m: Vector3::new(0.0, 0.0, 0.0), turn_rad: Vector3::new(0.0, 0.0, 0.0) };

/// One rotation by which an elastic element can deflect: how the rotation moves the tip, and the torque about its axis.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct UnitRotation {
    /// Displacement of the tip per angle \[m/rad\].
    pub motion_m: Vector3<f64>,
    /// Torque about the axis, one entry for gravity along each axis of the world \[N m\].
    pub pull_nm: Vector3<f64>,
}

impl Tip {
    /// Prepares a structure with the link model `links`. Springs between its parts and joints that slide are left out: their
    /// loads are more than weights.
    pub(crate) fn new(structure: &Structure, links: LinkModel) -> Self {
        let mut steps = Steps { gravity_m_s2: structure.gravity_m_s2, list: Vec::new(), hinges: Vec::new() };
        let tilt = structure.base_tilt_rad_per_nm;
        steps.springs([Vector3::x(), Vector3::y()].map(|axis| (axis, tilt)));
        steps.list.extend(structure.base_lift.map(Step::Lift));
        steps.springs(structure.base_frame.springs());
        for piece in &structure.pieces {
            match piece {
                Piece::Joint(joint) => steps.joint(joint),
                Piece::Link(link) => steps.link(link, PreparedBeam::new(link, structure, links)),
                Piece::Prismatic(_) => {}
            }
        }
        let step = |name: &str| steps.hinges.iter().find(|(own, _)| own == name).map(|(_, step)| *step);
        let linked = linkages(structure).into_iter().filter_map(|l| {
            Some(Linked { driver: step(&l.driver)?, passive: step(&l.passive)?, factor: l.factor })
        });
        let water = structure.water.map_or(0.0, |w| w.density_kg_m3 / w.payload_density_kg_m3);
        Self {
            gravity_m_s2: structure.gravity_m_s2,
            down: structure.down,
            payload_part: 1.0 - water,
            linkages: linked.collect(),
            steps: steps.list,
        }
    }

    /// Number of steps from the base to the tip.
    pub(crate) fn steps(&self) -> usize {
        self.steps.len()
    }

    /// The arm in a pose under load, moved out of the pose by the deflections `by` of all steps; by none if `by` is empty.
    pub(crate) fn hung<'a>(&'a self, load: &'a Loaded<'a>, by: &[Strain]) -> Hung<'a> {
        let (places, tip) = self.walk(load, by);
        Hung { arm: self, load, places, tip }
    }

    /// Displacement of the tip by linear statics, in the world \[m\].
    pub(crate) fn displacement_m(&self, load: &Loaded) -> Vector3<f64> {
        self.hung(load, &[]).statics_of_tip().0
    }

    /// The weights from the step `from` on, without payload and beams.
    pub(crate) fn weights_from(&self, from: usize, load: &Loaded) -> Weights {
        let (places, _) = self.walk(load, &[]);
        let mut out = Weights::default();
        for (step, place) in self.steps.iter().zip(&places).skip(from).rev() {
            if let Step::Weight(weight_n, from_m) = step {
                out.add(*weight_n, &(place.at_m + place.rotation * from_m));
            }
        }
        out
    }

    /// The axes about which the elastic elements can turn, from the tip to the base, and for each element the index of its
    /// first axis. Beams have no axis, and their weight is left out.
    pub(crate) fn rotations(&self, load: &Loaded) -> (Vec<usize>, Vec<UnitRotation>) {
        let (places, tip) = self.walk(load, &[]);
        let mut outboard = self.payload(load, &tip);
        let (mut elements, mut rotations) = (Vec::new(), Vec::new());
        for (k, (step, place)) in self.steps.iter().zip(&places).enumerate().rev() {
            if k + 1 == load.trunk.0 {
                outboard.join(&load.trunk.1);
            }
            let rotation = |axis: &Vector3<f64>| {
                let axis = place.rotation * axis;
                UnitRotation {
                    motion_m: axis.cross(&(tip.at_m - place.at_m)),
                    pull_nm: axis.cross(&outboard.about(&place.at_m)),
                }
            };
            match step {
                Step::Weight(weight_n, from_m) => {
                    outboard.add(*weight_n, &(place.at_m + place.rotation * from_m));
                    continue;
                }
                Step::Shift(_) => continue,
                _ => elements.push(rotations.len()),
            }
            match step {
                Step::Springs(springs) => rotations.extend(springs.axes.iter().map(rotation)),
                Step::Joint(hinge) => rotations.push(rotation(&hinge.axis)),
                _ => {}
            }
        }
        (elements, rotations)
    }

    /// Walks from the base to the tip, with the deflections `by` of the steps: the place at which each step begins, and the
    /// tip.
    fn walk(&self, load: &Loaded, by: &[Strain]) -> (Vec<Place>, Place) {
        let mut here = Place { at_m: Vector3::zeros(), rotation: Rotation3::identity() };
        let mut places = Vec::with_capacity(self.steps.len());
        for (k, step) in self.steps.iter().enumerate() {
            places.push(here);
            if let Step::Shift(vector_m) | Step::Beam(vector_m, _) = step {
                here.at_m += here.rotation * vector_m;
            }
            if let Some(strain) = by.get(k) {
                let Strain { shift_m, turn_rad } = step.in_world(&here.rotation, strain);
                deflect(&shift_m, &turn_rad, &mut here.at_m, &mut here.rotation);
            }
            if let Step::Joint(hinge) = step {
                here.rotation *= turn(&hinge.axis, hinge.sin_cos(load.pose_rad, load.sin_cos));
            }
        }
        (places, here)
    }

    fn payload(&self, load: &Loaded, tip: &Place) -> Weights {
        let mut out = Weights::default();
        let weight_n = load.payload.mass_kg * self.gravity_m_s2 * self.payload_part;
        out.add(weight_n, &(tip.at_m + tip.rotation * load.payload.cg_m));
        out
    }

    /// The deflection of each step by linear statics, in the pose with these `places`. One walk from the tip to the base adds
    /// up what is outboard.
    fn strains(&self, load: &Loaded, places: &[Place], tip: &Place) -> Vec<Strain> {
        let mut outboard = self.payload(load, tip);
        let mut out = vec![UNSTRAINED; self.steps.len()];
        // torques on the joints of a linkage, which turn each other
        let mut torques_nm = vec![0.0; if self.linkages.is_empty() { 0 } else { self.steps.len() }];
        for (k, (step, place)) in self.steps.iter().zip(places).enumerate().rev() {
            if k + 1 == load.trunk.0 {
                outboard.join(&load.trunk.1);
            }
            let moment_nm = |at_m: &Vector3<f64>| outboard.about(at_m).cross(&self.down);
            match step {
                Step::Weight(weight_n, from_m) => {
                    outboard.add(*weight_n, &(place.at_m + place.rotation * from_m));
                }
                Step::Shift(_) => {}
                Step::Springs(springs) => {
                    let nm = place.rotation.inverse_transform_vector(&moment_nm(&place.at_m));
                    out[k].turn_rad = springs.by_moment * nm;
                }
                Step::Lift(lift) => {
                    let nm = moment_nm(&place.at_m);
                    out[k].turn_rad = Vector3::new(lift.angle_rad(nm.x), lift.angle_rad(nm.y), 0.0);
                }
                Step::Joint(hinge) => {
                    let axis = place.rotation * hinge.axis.into_inner();
                    let nm = axis.dot(&moment_nm(&place.at_m)) + hinge.own_nm(load.pose_rad);
                    out[k].turn_rad = hinge.axis.into_inner() * hinge.torsion_rad(load.pose_rad, nm);
                    if let Some(own) = torques_nm.get_mut(k) {
                        *own = nm;
                    }
                }
                Step::Beam(vector_m, end) => {
                    let end_m = place.at_m + place.rotation * vector_m;
                    let to_section = (place.rotation * end.frame).transpose();
                    let down = to_section * self.down;
                    let force_n = down * outboard.weight_n;
                    let by_load = end.by_load * stack(&force_n, &(to_section * moment_nm(&end_m)));
                    let all = by_load + end.by_weight * down;
                    out[k] = Strain { shift_m: linear(&all), turn_rad: angular(&all) };
                    outboard.weight_n += end.weight_n;
                    outboard.moment_nm += place.at_m * end.weight_n + place.rotation * end.moment_nm;
                }
            }
        }
        self.turn_linked(load, &torques_nm, &mut out);
        out
    }

    /// Adds to the deflections `strains` what joints that turn other joints do. A driving joint also holds the torque on the
    /// joint that it turns, and turns it as it deflects. `torques_nm` are the torques on all joints without this.
    fn turn_linked(&self, load: &Loaded, torques_nm: &[f64], strains: &mut [Strain]) {
        for linked in &self.linkages {
            let Step::Joint(driver) = &self.steps[linked.driver] else { continue };
            let own = self.linkages.iter().filter(|other| other.driver == linked.driver);
            let held_nm: f64 = own.map(|other| other.factor * torques_nm[other.passive]).sum();
            let torsion_rad = driver.torsion_rad(load.pose_rad, torques_nm[linked.driver] + held_nm);
            strains[linked.driver].turn_rad = driver.axis.into_inner() * torsion_rad;
        }
        // all driving joints have turned; a passive joint may drive others, so what it is turned by comes last
        let turned: Vec<f64> = self.linkages.iter().map(|l| self.torsion_of(l.driver, strains)).collect();
        for (linked, driver_rad) in self.linkages.iter().zip(turned) {
            if let Step::Joint(passive) = &self.steps[linked.passive] {
                strains[linked.passive].turn_rad += passive.axis.into_inner() * (linked.factor * driver_rad);
            }
        }
    }

    /// Torsion of the joint with the index `step` by its deflection in `strains` \[rad\].
    fn torsion_of(&self, step: usize, strains: &[Strain]) -> f64 {
        match &self.steps[step] {
            Step::Joint(hinge) => hinge.axis.dot(&strains[step].turn_rad),
            _ => 0.0,
        }
    }

    /// How far the deflections `strains` of all steps move the tip, linearly \[m\].
    fn moved_m(&self, places: &[Place], tip: &Place, strains: &[Strain]) -> Vector3<f64> {
        let mut out = Vector3::zeros();
        for ((step, place), strain) in self.steps.iter().zip(places).zip(strains) {
            let end_m = match step {
                Step::Weight(..) | Step::Shift(_) => continue,
                Step::Springs(_) | Step::Joint(_) | Step::Lift(_) => place.at_m,
                Step::Beam(vector_m, _) => place.at_m + place.rotation * vector_m,
            };
            let Strain { shift_m, turn_rad } = step.in_world(&place.rotation, strain);
            out += shift_m + turn_rad.cross(&(tip.at_m - end_m));
        }
        out
    }
}

impl Step {
    /// The deflection `strain` of this step in the world. `rotation` is the attitude at which the step begins.
    fn in_world(&self, rotation: &Rotation3<f64>, strain: &Strain) -> Strain {
        let turned = |frame: &Matrix3<f64>| Strain {
            shift_m: frame * strain.shift_m,
            turn_rad: frame * strain.turn_rad,
        };
        match self {
            // the feet of a base stand in the world
            Step::Lift(_) => *strain,
            Step::Beam(_, end) => turned(&(rotation.matrix() * end.frame)),
            Step::Weight(..) | Step::Springs(_) | Step::Joint(_) | Step::Shift(_) => {
                turned(rotation.matrix())
            }
        }
    }
}

/// An arm in a pose under load, perhaps moved out of the pose by deflections.
pub(crate) struct Hung<'a> {
    arm: &'a Tip,
    load: &'a Loaded<'a>,
    /// The place at which each step begins.
    places: Vec<Place>,
    tip: Place,
}

impl Deflected for Hung<'_> {
    type Deflections = Vec<Strain>;

    fn tip_m(&self) -> Vector3<f64> {
        self.tip.at_m
    }

    fn statics_of_tip(&self) -> (Vector3<f64>, Vec<Strain>) {
        let strains = self.arm.strains(self.load, &self.places, &self.tip);
        (self.arm.moved_m(&self.places, &self.tip, &strains), strains)
    }
}

/// The steps of an arm, base to tip, as they are collected.
struct Steps {
    gravity_m_s2: f64,
    list: Vec<Step>,
    /// Names of the joints, each with the index of its step.
    hinges: Vec<(String, usize)>,
}

impl Steps {
    /// Adds a point mass \[kg\] at `at_m` \[m\], unless it is zero.
    fn mass(&mut self, mass_kg: f64, at_m: Vector3<f64>) {
        if mass_kg != 0.0 {
            self.list.push(Step::Weight(mass_kg * self.gravity_m_s2, at_m));
        }
    }

    fn bodies(&mut self, bodies: &[RigidBody]) {
        bodies.iter().for_each(|body| self.mass(body.mass_kg, body.cg_m));
    }

    /// Adds springs, each given by its axis and its compliance \[rad/(N m)\]. Those without compliance are left out.
    fn springs(&mut self, springs: impl IntoIterator<Item = (Vector3<f64>, f64)>) {
        let own: Vec<(Vector3<f64>, f64)> = springs.into_iter().filter(|(_, c)| *c > 0.0).collect();
        if !own.is_empty() {
            let by_moment = own.iter().map(|(axis, c)| axis * axis.transpose() * *c).sum();
            let axes = own.into_iter().map(|(axis, _)| axis).collect();
            self.list.push(Step::Springs(Box::new(Springs { axes, by_moment })));
        }
    }

    fn joint(&mut self, joint: &JointPiece) {
        self.mass(joint.mass_kg, Vector3::zeros());
        self.bodies(&joint.bodies.fixed);
        let leans = joint.lean_rad_per_nm.map(|lean| joint.tilt_rad_per_nm + lean);
        self.springs(across(&joint.axis).into_iter().zip(leans));
        self.hinges.push((joint.name.clone(), self.list.len()));
        let (angle, law, torque) = (joint.angle.clone(), joint.law, joint.torque);
        self.list.push(Step::Joint(Box::new(Hinge { axis: joint.axis, angle, law, torque })));
        self.bodies(&joint.bodies.rotating);
    }

    fn link(&mut self, link: &LinkPiece, beam: Option<PreparedBeam>) {
        self.springs(link.root_frame.springs());
        self.mass(link.point_mass_kg, link.vector_m / 2.0);
        // bodies on a tube are a part of its beam
        if link.beam.is_none() {
            self.bodies(&link.bodies);
        }
        self.list.push(match beam {
            Some(beam) => Step::Beam(link.vector_m, Box::new(BeamEnd::new(&beam))),
            None => Step::Shift(link.vector_m),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::arm::{Arm, JointModel};
    use crate::catalog::Catalogs;
    use crate::input::Document;
    use crate::mechanics::chain::{Chain, Item};
    use crate::mechanics::hanging::beyond_linear_m;

    /// A soft arm with everything that deflects.
    const SOFT: &str = r#"{"name": "soft", "gravity_m_s2": 9.81,
        "materials": {"light": {"youngs_modulus_pa": 3e9, "shear_modulus_pa": 1e9, "density_kg_m3": 1600}},
        "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": 2e4, "mass_kg": 3},
        {"type": "link", "name": "column", "vector_m": [0.1, 0, 0.4], "mass_kg": 2},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 3e4, "mass_kg": 2,
         "bodies": [{"mass_kg": 1.5, "cg_m": [0, 0.1, 0], "rotates": true}, {"mass_kg": 0.5, "cg_m": [0.05, 0, 0]}]},
        {"type": "link", "name": "upper", "vector_m": [0.5, 0.1, 0], "material": "light",
         "section": {"shape": "round_tube", "diameter_m": 0.08, "wall_m": 0.003},
         "bodies": [{"mass_kg": 1.2, "cg_m": [0.2, 0.05, 0.02]}]},
        {"type": "joint", "name": "j3", "axis": [0, 1, 0], "stiffness_nm_per_rad": 2e4, "coupled": {"j2": -0.7}},
        {"type": "link", "name": "fore", "vector_m": [0.4, 0, 0.1], "material": "light",
         "section": {"shape": "round_tube", "diameter_m": 0.06, "wall_m": 0.003}},
        {"type": "joint", "name": "j4", "axis": [1, 0, 0], "stiffness_nm_per_rad": 1e4, "mass_kg": 1},
        {"type": "link", "name": "hand", "vector_m": [0.1, 0, 0.05], "mass_kg": 0.4}],
        "effects": [
        {"effect": "base_compliance", "at": "base", "parameters": {"stiffness_nm_per_rad": 4e4}},
        {"effect": "base_lift", "at": "base", "parameters": {"stiffness_nm_per_rad": 5e4, "preload_nm": 10}},
        {"effect": "bearing_tilt", "at": "j2", "parameters": {"stiffness_nm_per_rad": 3e4}},
        {"effect": "frame_compliance", "at": "upper", "parameters": {"diagonal_rad_per_nm": [1e-5, 2e-5, 3e-5],
         "coupling_rad_per_nm": [4e-6, -2e-6, 1e-6]}},
        {"effect": "lost_motion", "at": "j2", "parameters": {"half_width_rad": 5e-4, "torque_nm": 8}},
        {"effect": "stiffness_waves", "at": "j4", "parameters": {"once": 0.3, "twice": 0.1, "phases_rad": [0.3, -0.2]}},
        {"effect": "joint_torque", "at": "j2", "parameters": {"offset_nm": 3, "sin_nm": -5, "cos_nm": 4}},
        {"effect": "harness_mass", "at": "fore", "parameters": {"kg_per_m": 0.8}}]}"#;

    fn arm(text: &str) -> Arm {
        let document = Document::parse("arm.json", text).expect("JSON");
        read_arm_document(document, &Catalogs::default()).expect("a sound arm")
    }

    /// The tip moves as that of the posed arm with its lists of elements, linearly and as the arm hangs, with weights on its
    /// trunk too.
    #[test]
    fn the_tip_moves_as_that_of_the_posed_arm() {
        let measured = include_str!("../../examples/measured-arm/arm.json");
        for (text, pose_rad) in [
            (SOFT, vec![0.4, 0.3, -0.5]),
            (SOFT, vec![-1.0, -0.8, 2.0]),
            (measured, vec![0.3, -0.4, 0.9, 0.2, -0.7, 1.1]),
        ] {
            let structure = arm(text).structure(JointModel::ThreeSegment);
            let chain = Chain::new(&structure, LinkModel::Full);
            let tip = Tip::new(&structure, LinkModel::Full);
            let payload = Payload { mass_kg: 4.0, cg_m: Vector3::new(0.05, 0.02, 0.1), ..Payload::default() };
            let sin_cos: Vec<(f64, f64)> = pose_rad.iter().map(|angle| libm::sincos(*angle)).collect();
            let neighbours = Weights { weight_n: 60.0, moment_nm: Vector3::new(12.0, -9.0, 40.0) };
            // the whole of the base belongs to the trunk, and the first joint
            let first_shift = tip.steps.iter().position(|step| matches!(step, Step::Shift(_)));
            let trunk = (first_shift.expect("a column") + 1, neighbours);
            let load = Loaded { pose_rad: &pose_rad, sin_cos: &sin_cos, payload: &payload, trunk };
            let shifts = tip.steps[..trunk.0].iter().filter(|step| matches!(step, Step::Shift(_)));
            let items = trunk.0 - shifts.count();
            let mut posed = chain.pose_rad(&pose_rad, &payload, Vector3::zeros());
            let down = structure.down;
            let wrench = stack(&(down * 60.0), &neighbours.moment_nm.cross(&down));
            posed.items.insert(items, Item::Load(wrench));
            let expected_m = posed.displaced().0;
            let found_m = tip.displacement_m(&load);
            assert!(expected_m.norm() > 1e-4, "{expected_m}");
            assert!((found_m - expected_m).norm() < 1e-12 * expected_m.norm(), "{found_m} {expected_m}");
            let expected_m = beyond_linear_m(|by| {
                let mut posed = chain.pose_with(&pose_rad, &payload, Vector3::zeros(), by);
                posed.items.insert(items, Item::Load(wrench));
                posed
            });
            let found_m = beyond_linear_m(|by: Vec<Strain>| tip.hung(&load, &by));
            assert!(expected_m.norm() > 1e-7, "{expected_m}");
            assert!((found_m - expected_m).norm() < 1e-9 * expected_m.norm(), "{found_m} {expected_m}");
        }
    }
}
