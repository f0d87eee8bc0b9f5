//! An arm in one load case as a finite-element model.

use nalgebra::{Matrix3, Matrix6, Rotation3, SVector, Unit, Vector3, Vector6};

use super::arm::{Arm, Joint, Link, Part};
use super::beam::{BeamLine, Matrix12, in_world_axes};
use super::joint_law::JointLaw;
use super::load_case::{LoadCase, Payload};
use super::nodes::{NodeMap, pair, stacked};
use super::{Links, Options};

/// A piece of the structure: stiffness and mass between two nodes, or the mass of a body at one (the second half zero).
pub struct Piece {
    pub name: String,
    pub columns: Vec<(usize, SVector<f64, 12>)>,
    pub stiffness: Matrix12,
    pub mass: Matrix12,
}

/// A rotational spring on one unknown.
pub struct Spring {
    pub name: String,
    pub unknown: usize,
    pub secant_nm_per_rad: f64,
    pub tangent_nm_per_rad: f64,
}

/// A force and a moment on a node, world axes.
struct Load {
    node: NodeMap,
    point_m: Vector3<f64>,
    force_n: Vector3<f64>,
    moment_nm: Vector3<f64>,
}

/// A joint in its place in the world.
pub struct Station {
    pub name: String,
    pub unknown: Option<usize>,
    law: JointLaw,
    axis: Vector3<f64>,
    /// Torque about the axis beside those of weight and load.
    own_nm: f64,
    point_m: Vector3<f64>,
    /// The loads from here on are outboard.
    first_load: usize,
}

/// A finite-element model of an arm, ready to be solved.
pub struct Model {
    pub unknowns: usize,
    pub pieces: Vec<Piece>,
    pub springs: Vec<Spring>,
    pub stations: Vec<Station>,
    pub tip: NodeMap,
    loads: Vec<Load>,
}

impl Model {
    /// The model in which only the elements that `is_compliant` names can deform.
    pub fn new(arm: &Arm, case: &LoadCase, options: &Options, is_compliant: &dyn Fn(&str) -> bool) -> Self {
        let joints = arm.chain.iter().filter(|part| matches!(part, Part::Joint(_))).count();
        assert_eq!(joints, case.pose_deg.len(), "a pose has one angle a joint");
        let mut walk = Walk::from_base(arm, options, is_compliant);
        let mut angles_deg = case.pose_deg.iter();
        for part in &arm.chain {
            match part {
                Part::Joint(joint) => walk.joint(joint, *angles_deg.next().expect("counted above")),
                Part::Link(link) => walk.link(link),
            }
        }
        walk.payload(&case.payload);
        walk.tip_force(case.tip_force_n);
        walk.finished()
    }

    /// The loads on the unknowns.
    pub fn generalized_load(&self) -> nalgebra::DVector<f64> {
        let mut generalized = nalgebra::DVector::zeros(self.unknowns);
        for load in &self.loads {
            let wrench = stacked(&load.force_n, &load.moment_nm);
            load.node
                .columns
                .iter()
                .for_each(|(unknown, column)| generalized[*unknown] += column.dot(&wrench));
        }
        for station in &self.stations {
            if let Some(unknown) = station.unknown {
                generalized[unknown] += station.own_nm;
            }
        }
        generalized
    }

    /// The torque about a joint's axis of everything outboard of it and on it, from equilibrium alone.
    pub fn equilibrium_torque_nm(&self, station: &Station) -> f64 {
        let moment = |load: &Load| (load.point_m - station.point_m).cross(&load.force_n) + load.moment_nm;
        let loads: Vector3<f64> = self.loads[station.first_load..].iter().map(moment).sum();
        station.axis.dot(&loads) + station.own_nm
    }

    /// Names of what can deform, each once, in the order of the chain.
    pub fn compliant_elements(&self) -> Vec<String> {
        let beams = self.pieces.iter().filter(|piece| piece.stiffness != Matrix12::zeros());
        // Unknowns are numbered outwards, so a beam stands where its outboard node does.
        let place = |beam: &Piece| beam.columns.iter().map(|(unknown, _)| *unknown).max().unwrap_or(0);
        let mut named: Vec<(usize, &String)> = beams.map(|beam| (place(beam), &beam.name)).collect();
        named.extend(self.springs.iter().map(|spring| (spring.unknown, &spring.name)));
        named.sort();
        let mut names: Vec<String> = Vec::new();
        for (_, name) in named {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        names
    }
}

/// The way from base to tip: where we are, and what has been built so far.
struct Walk<'a> {
    gravity_m_s2: f64,
    options: &'a Options,
    is_compliant: &'a dyn Fn(&str) -> bool,
    frame: Rotation3<f64>,
    point_m: Vector3<f64>,
    node: NodeMap,
    lifts: Vec<Lift>,
    model: Model,
}

/// Feet that lift off about one axis through the origin.
struct Lift {
    unknown: usize,
    axis: Vector3<f64>,
    stiffness_nm_per_rad: f64,
    preload_nm: f64,
}

/// How much stiffer feet on the ground are than feet that have lifted off.
const STANDING: f64 = 1e6;

impl Lift {
    /// The spring about this axis under all loads: secant and tangent stiffness.
    fn spring(&self, loads: &[Load]) -> Spring {
        let moments = loads.iter().map(|load| load.point_m.cross(&load.force_n) + load.moment_nm);
        let moment_nm = self.axis.dot(&moments.sum::<Vector3<f64>>()).abs();
        let beyond_nm = moment_nm - self.preload_nm;
        let (secant, tangent) = match beyond_nm > 0.0 {
            true => (moment_nm / beyond_nm, 1.0),
            false => (STANDING, STANDING),
        };
        Spring {
            name: "base_lift".into(),
            unknown: self.unknown,
            secant_nm_per_rad: secant * self.stiffness_nm_per_rad,
            tangent_nm_per_rad: tangent * self.stiffness_nm_per_rad,
        }
    }
}

impl<'a> Walk<'a> {
    fn from_base(arm: &Arm, options: &'a Options, is_compliant: &'a dyn Fn(&str) -> bool) -> Self {
        let model = Model {
            unknowns: 0,
            pieces: Vec::new(),
            springs: Vec::new(),
            stations: Vec::new(),
            tip: NodeMap::clamped(),
            loads: Vec::new(),
        };
        let mut walk = Self {
            gravity_m_s2: arm.gravity_m_s2,
            options,
            is_compliant,
            frame: Rotation3::identity(),
            point_m: Vector3::zeros(),
            node: NodeMap::clamped(),
            lifts: Vec::new(),
            model,
        };
        if let Some(stiffness_nm_per_rad) = arm.base_nm_per_rad {
            walk.tilt("base_compliance", [Vector3::x(), Vector3::y()], stiffness_nm_per_rad);
        }
        if let Some((stiffness_nm_per_rad, preload_nm)) = arm.base_lift {
            for axis in [Vector3::x(), Vector3::y()] {
                let unknown = walk.hinge(&axis);
                walk.lifts.push(Lift { unknown, axis, stiffness_nm_per_rad, preload_nm });
            }
        }
        walk
    }

    fn joint(&mut self, joint: &Joint, angle_deg: f64) {
        self.body(&joint.name, self.node.clone(), point_mass(joint.mass_kg));
        self.weight(self.node.clone(), self.point_m, joint.mass_kg);
        let axis = self.frame * joint.axis;
        let [constant, sine, cosine] = joint.torque_nm;
        let has_spring = !joint.law.is_rigid() && (self.is_compliant)(&joint.name);
        let unknown = has_spring.then(|| self.hinge(&axis));
        self.model.stations.push(Station {
            name: joint.name.clone(),
            unknown,
            law: joint.law.clone(),
            axis,
            own_nm: constant + sine * angle_deg.to_radians().sin() + cosine * angle_deg.to_radians().cos(),
            point_m: self.point_m,
            first_load: self.model.loads.len(),
        });
        if let Some(stiffness_nm_per_rad) = joint.tilt_nm_per_rad {
            let name = format!("bearing_tilt:{}", joint.name);
            self.tilt(&name, axes_across(&axis), stiffness_nm_per_rad);
        }
        if let Some(stiffness_nm_per_rad) = joint.lean_nm_per_rad {
            let [across, _] = axes_across(&joint.axis);
            self.tilt(&format!("lean:{}", joint.name), [self.frame * across], stiffness_nm_per_rad);
        }
        self.frame *= Rotation3::from_axis_angle(&Unit::new_normalize(joint.axis), angle_deg.to_radians());
    }

    fn link(&mut self, link: &Link) {
        let span_m = self.frame * link.vector_m;
        if span_m.norm() > 0.0 {
            let beam = BeamLine::new(link.tube.as_ref(), &link.line);
            let axes = section_axes(&span_m, &self.frame);
            let is_flexible = link.tube.is_some()
                && self.options.links == Links::Flexible
                && (self.is_compliant)(&link.name);
            if is_flexible {
                self.flexible_link(&link.name, &beam, &span_m, &axes);
            } else {
                self.rigid_link(link, &beam, &span_m, &axes);
            }
        } else if link.middle_mass_kg > 0.0 {
            self.body(&link.name, self.node.clone(), point_mass(link.middle_mass_kg));
            self.weight(self.node.clone(), self.point_m, link.middle_mass_kg);
        }
        self.point_m += span_m;
    }

    fn flexible_link(&mut self, name: &str, beam: &BeamLine, span_m: &Vector3<f64>, axes: &Matrix3<f64>) {
        let step_m = span_m / self.options.elements_per_link as f64;
        let length_m = step_m.norm();
        let stiffness = in_world_axes(&beam.stiffness(length_m), axes);
        let mass = in_world_axes(&beam.mass(length_m, self.options.mass_shape), axes);
        for element in 0..self.options.elements_per_link {
            let from_m = self.point_m + step_m * element as f64;
            let outboard = NodeMap::free(self.model.unknowns);
            self.model.unknowns += 6;
            self.element_weight(beam, &outboard, &from_m, &step_m);
            let columns = pair(&self.node, &outboard);
            self.model.pieces.push(Piece { name: name.to_owned(), columns, stiffness, mass });
            self.node = outboard;
        }
    }

    /// Weight of a uniform element on its two nodes: q l / 2 each, and the fixed-end moments q l^2 / 12.
    fn element_weight(
        &mut self,
        beam: &BeamLine,
        outboard: &NodeMap,
        from_m: &Vector3<f64>,
        step_m: &Vector3<f64>,
    ) {
        let force_n = self.weight_n(beam.weighing_kg_per_m * step_m.norm()) / 2.0;
        let moment_nm = step_m.cross(&force_n) / 6.0;
        let inboard = self.node.clone();
        self.model.loads.push(Load { node: inboard, point_m: *from_m, force_n, moment_nm });
        let node = outboard.clone();
        self.model.loads.push(Load { node, point_m: from_m + step_m, force_n, moment_nm: -moment_nm });
    }

    fn rigid_link(&mut self, link: &Link, beam: &BeamLine, span_m: &Vector3<f64>, axes: &Matrix3<f64>) {
        let length_m = span_m.norm();
        let middle = self.node.carried(&(span_m / 2.0));
        let middle_m = self.point_m + span_m / 2.0;
        let mass = turned(&beam.rigid_mass(length_m), axes) + point_mass(link.middle_mass_kg);
        self.body(&link.name, middle.clone(), mass);
        self.weight(middle, middle_m, beam.weighing_kg_per_m * length_m + link.middle_mass_kg);
        self.node = self.node.carried(span_m);
    }

    fn payload(&mut self, payload: &Payload) {
        let lever_m = self.frame * payload.cg_m;
        let centre = self.node.carried(&lever_m);
        let inertia = stacked(&Vector3::zeros(), &payload.inertia_about_cg_kgm2);
        let turned_inertia = turned(&Matrix6::from_diagonal(&inertia), self.frame.matrix());
        self.body("payload", centre.clone(), point_mass(payload.mass_kg) + turned_inertia);
        self.weight(centre, self.point_m + lever_m, payload.mass_kg * payload.weight_factor);
    }

    fn tip_force(&mut self, force_n: Vector3<f64>) {
        let (node, point_m) = (self.node.clone(), self.point_m);
        self.model.loads.push(Load { node, point_m, force_n, moment_nm: Vector3::zeros() });
    }

    /// Turn the linear or non-linear laws into springs, now that all loads are known.
    fn finished(self) -> Model {
        let Self { mut model, node, lifts, .. } = self;
        model.tip = node;
        let lifted: Vec<Spring> = lifts.iter().map(|lift| lift.spring(&model.loads)).collect();
        model.springs.extend(lifted);
        let spring = |station: &Station| {
            let torque_nm = model.equilibrium_torque_nm(station);
            Some(Spring {
                name: station.name.clone(),
                unknown: station.unknown?,
                secant_nm_per_rad: station.law.secant_nm_per_rad(torque_nm),
                tangent_nm_per_rad: station.law.tangent_nm_per_rad(torque_nm),
            })
        };
        let springs: Vec<Spring> = model.stations.iter().filter_map(spring).collect();
        model.springs.extend(springs);
        model
    }

    /// A new unknown angle about an axis, between here and everything outboard.
    fn hinge(&mut self, axis: &Vector3<f64>) -> usize {
        let unknown = self.model.unknowns;
        self.node = self.node.hinged(unknown, axis);
        self.model.unknowns += 1;
        unknown
    }

    fn tilt<const N: usize>(&mut self, name: &str, axes: [Vector3<f64>; N], stiffness_nm_per_rad: f64) {
        if !(self.is_compliant)(name) {
            return;
        }
        for axis in axes {
            let unknown = self.hinge(&axis);
            self.model.springs.push(Spring {
                name: name.to_owned(),
                unknown,
                secant_nm_per_rad: stiffness_nm_per_rad,
                tangent_nm_per_rad: stiffness_nm_per_rad,
            });
        }
    }

    fn body(&mut self, name: &str, node: NodeMap, body_mass: Matrix6<f64>) {
        let mut mass = Matrix12::zeros();
        mass.fixed_view_mut::<6, 6>(0, 0).copy_from(&body_mass);
        let columns = pair(&node, &NodeMap::clamped());
        self.model.pieces.push(Piece { name: name.to_owned(), columns, stiffness: Matrix12::zeros(), mass });
    }

    fn weight(&mut self, node: NodeMap, point_m: Vector3<f64>, weighing_kg: f64) {
        let force_n = self.weight_n(weighing_kg);
        self.model.loads.push(Load { node, point_m, force_n, moment_nm: Vector3::zeros() });
    }

    fn weight_n(&self, weighing_kg: f64) -> Vector3<f64> {
        Vector3::new(0.0, 0.0, -weighing_kg * self.gravity_m_s2)
    }
}

fn point_mass(mass_kg: f64) -> Matrix6<f64> {
    Matrix6::from_diagonal(&Vector6::new(mass_kg, mass_kg, mass_kg, 0.0, 0.0, 0.0))
}

/// A body's mass matrix in world axes; the columns of `axes` are the body's.
fn turned(body_mass: &Matrix6<f64>, axes: &Matrix3<f64>) -> Matrix6<f64> {
    let mut turn = Matrix6::zeros();
    turn.fixed_view_mut::<3, 3>(0, 0).copy_from(axes);
    turn.fixed_view_mut::<3, 3>(3, 3).copy_from(axes);
    turn * body_mass * turn.transpose()
}

/// x along the link, z the carried z axis made perpendicular to it (the carried x axis when they nearly coincide), y = z x x.
fn section_axes(span_m: &Vector3<f64>, frame: &Rotation3<f64>) -> Matrix3<f64> {
    let x = span_m.normalize();
    let carried_z = frame * Vector3::z();
    let guide = if carried_z.dot(&x).abs() > 0.99 { frame * Vector3::x() } else { carried_z };
    let z = (guide - x * guide.dot(&x)).normalize();
    Matrix3::from_columns(&[x, z.cross(&x), z])
}

/// Any two axes across this one.
fn axes_across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let helper = if axis.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let first = axis.cross(&helper).normalize();
    [first, axis.cross(&first)]
}
