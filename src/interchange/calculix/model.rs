//! A finite-element model of an arm in a load case: bricks, rigid regions, hinges, point masses and loads.
//!
//! Everything that moves as one rigid body is a *region*. The end faces of a link are rigid: the root face belongs to
//! the region before the link, and the end face begins a new region. The motion of a new region is described by a
//! reference node (displacement) and a rotation node. A hinge has a node of its own, and displacement 1 of this node is
//! the angle of the hinge. The displacement of a point `p` of a region is expressed by an `*EQUATION`: `u(p) = u_ref +
//! θ × (p - p_ref) + Σ q_k t_k(p)`. Here `u_ref` and `θ` are the displacements of the reference node and of the
//! rotation node, `q_k` is the angle of hinge `k`, and `t_k(p)` is the displacement of `p` per unit of this angle. So
//! neither rigid bodies of CalculiX nor constraints that depend on other constraints are needed. The tilts of bearings
//! and frames are hinges too, and a passive joint is a hinge that follows others,
//! which may be inboard or outboard of it.

use super::mesh::{Mesh, has_shape, mesh};
use crate::arm::RigidBody;
use crate::arm::structure::Beam;
use crate::interchange::snapshot::{Snapshot, Working};
use crate::interchange::tree::mass_properties;
use crate::mechanics::beam::section_frame;
use crate::mechanics::chain::{Body, Compliance, ElasticElement, Item, OwnMass};
use crate::mechanics::{Twist, angular, displacement_at};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use std::collections::BTreeMap;

/// Coefficients of an equation below this value are dropped as rounding errors.
const ROUNDING: f64 = 1e-12;
/// Largest distance from the centre of gravity at which point masses stand for a body with inertia and without mass
/// \[m\]. Farther points would need less mass. But the springs between point masses and the ground would then act on
/// longer levers and hold the body.
const FAR_M: f64 = 10.0;

/// A term of an equation, or a load: index of the node, direction (0 to 2), coefficient.
pub(crate) type Term = (usize, usize, f64);

/// The mesh of a link, with its material.
pub(crate) struct Solid {
    /// Name of the link.
    pub name: String,
    /// Section and material of the tube.
    pub beam: Beam,
    /// Axes of the section (columns), in the world.
    pub frame: Matrix3<f64>,
    /// Density of the bricks \[kg/m³\]. It is chosen such that they weigh as much as tube and harness.
    pub density_kg_m3: f64,
    /// Indices of the 20 nodes of each brick, in the whole model.
    pub bricks: Vec<[usize; 20]>,
}

/// A hinge: its node, and the spring that acts on displacement 1 of this node.
pub(crate) struct HingeNode {
    /// Name of the hinge.
    pub name: String,
    /// Index of the node.
    pub node: usize,
    /// Load and stiffness of the spring in the case.
    pub working: Working,
}

/// A finite-element model.
#[derive(Default)]
pub(crate) struct Model {
    /// Positions of all nodes \[m\].
    pub nodes_m: Vec<Vector3<f64>>,
    /// Links that are meshed with bricks.
    pub solids: Vec<Solid>,
    /// Hinges of joints, bearings and frames.
    pub hinges: Vec<HingeNode>,
    /// Linear equations between degrees of freedom. The degree of freedom of the first term is the dependent one.
    pub equations: Vec<Vec<Term>>,
    /// Degrees of freedom that are fixed: index of the node, and direction (0 to 2).
    pub held: Vec<(usize, usize)>,
    /// Point masses: index of the node, and mass \[kg\].
    pub masses: Vec<(usize, f64)>,
    /// Loads: index of the node, direction (0 to 2), and force \[N\], or moment \[N m\] on the node of a hinge.
    pub loads: Vec<Term>,
    /// Index of the node at the tip.
    pub tip: usize,
    /// Number of natural frequencies to compute.
    pub modes: usize,
    /// Names of elements with an inertia tensor that no solid can have, so that no point masses can represent this
    /// tensor.
    pub impossible: Vec<String>,
}

/// A meshed link, while bodies are attached to it.
struct Meshed<'m> {
    mesh: &'m Mesh,
    /// Index of the link's first node in the model.
    first: usize,
    own: &'m OwnMass,
    length_m: f64,
    /// The region to which the root face of the link belongs.
    root: Region,
}

/// A part of the arm that moves as one rigid body.
#[derive(Clone)]
struct Region {
    /// Reference node, rotation node and the position of the reference node \[m\]. `None` for the ground.
    frame: Option<(usize, usize, Vector3<f64>)>,
    /// Hinges between the reference node and the region. Each has the index of its node, and the motion of the region
    /// per unit of its angle.
    hinges: Vec<(usize, Twist)>,
}

/// The finite-element model of an arm in a case. Links without compliance, and links whose section cannot be meshed,
/// are rigid bodies.
pub(crate) fn model(snapshot: &Snapshot) -> Model {
    let posed = snapshot.posed();
    let mut builder = Builder {
        snapshot,
        model: Model::default(),
        region: Region { frame: None, hinges: Vec::new() },
        joints: BTreeMap::new(),
        down: snapshot.structure.down,
    };
    builder.joint_nodes();
    let mut workings = snapshot.working_points().into_iter();
    for item in &posed.items {
        match item {
            Item::Body(body) => builder.body(body),
            // balance springs were removed before, see `Remainder`
            Item::Load(_) => {}
            Item::Elastic(element) => {
                let workings = workings.next().unwrap_or_default();
                match &element.own {
                    Some(own) => builder.link(element, own),
                    None => builder.springs(element, &workings),
                }
            }
        }
    }
    let tip = builder.tied(posed.tip_m);
    builder.model.tip = tip;
    builder.tip_load(tip, &posed.tip_force_n, &posed.tip_moment_nm);
    builder.model.modes = match builder.model.hinges.is_empty() && builder.model.solids.is_empty() {
        true => 0,
        false => snapshot.frequencies_hz().len(),
    };
    builder.model
}

struct Builder<'s> {
    snapshot: &'s Snapshot,
    model: Model,
    region: Region,
    /// Index of the node of the hinge of every compliant revolute joint, by name of the joint.
    joints: BTreeMap<String, usize>,
    down: Vector3<f64>,
}

impl Builder<'_> {
    fn node(&mut self, at_m: Vector3<f64>) -> usize {
        self.model.nodes_m.push(at_m);
        self.model.nodes_m.len() - 1
    }

    /// Adds the node of the hinge of every compliant revolute joint. They are added before anything else, because a
    /// passive joint may be inboard of the joint that drives it.
    fn joint_nodes(&mut self) {
        let (posed, workings) = (self.snapshot.posed(), self.snapshot.working_points());
        for (element, workings) in posed.elements().zip(&workings) {
            let is_joint = matches!(element.compliance, Compliance::Joint(_));
            if is_joint && workings.first().is_some_and(|working| !working.is_rigid()) {
                let node = self.node(element.at_m);
                self.joints.insert(element.name.clone(), node);
            }
        }
    }

    /// Adds a hinge for each compliant coordinate of an element. `workings` are the states of its springs at the load
    /// of the case. A passive joint also follows the hinges of its driving joints.
    fn springs(&mut self, element: &ElasticElement, workings: &[Working]) {
        let is_joint = matches!(element.compliance, Compliance::Joint(_));
        for (i, (twist, working)) in element.twists.iter().zip(workings).enumerate() {
            if working.is_rigid() {
                continue;
            }
            // the element of a base may have the name of a joint
            let own = self.joints.get(&element.name).filter(|_| is_joint).copied();
            let node = own.unwrap_or_else(|| self.node(element.at_m));
            self.model.held.extend([(node, 1), (node, 2)]);
            if element.torque_nm != 0.0 {
                self.model.loads.push((node, 0, element.torque_nm));
            }
            let name = if element.twists.len() == 1 {
                element.name.clone()
            } else {
                format!("{}_{}", element.name, i + 1)
            };
            self.model.hinges.push(HingeNode { name, node, working: *working });
            self.region.hinges.push((node, *twist));
        }
        if is_joint {
            self.follow(element);
        }
    }

    /// Makes the passive joint `passive` rotate with the hinges of its driving joints, by the factors of their
    /// linkages.
    fn follow(&mut self, passive: &ElasticElement) {
        let posed = self.snapshot.posed();
        let linkages = posed.chain.linkages().iter().filter(|linkage| linkage.passive == passive.name);
        for linkage in linkages {
            if let Some(driver) = self.joints.get(&linkage.driver).copied() {
                self.region.hinges.push((driver, passive.twists[0] * linkage.factor));
                if passive.torque_nm != 0.0 {
                    self.model.loads.push((driver, 0, passive.torque_nm * linkage.factor));
                }
            }
        }
    }

    /// Adds a body as point masses that move with the rigid region that is being built.
    fn body(&mut self, body: &Body) {
        self.rigid(body.mass_kg, &body.cg_m, &body.inertia_kgm2, "body");
    }

    /// Adds a rigid body, given by mass, centre of gravity and inertia, as point masses that move with the rigid region
    /// that is being built. `name` is for the list of bodies that no point masses can represent.
    fn rigid(&mut self, mass_kg: f64, cg_m: &Vector3<f64>, inertia_kgm2: &Matrix3<f64>, name: &str) {
        for (at_m, kg) in self.points(mass_kg, cg_m, inertia_kgm2, name) {
            let node = self.tied(at_m);
            self.point_mass(node, kg, mass_kg > 0.0);
        }
    }

    /// Adds a point mass. `has_weight` is false for the points of a body that has inertia and no mass, because such a
    /// body has no weight.
    fn point_mass(&mut self, node: usize, mass_kg: f64, has_weight: bool) {
        self.model.masses.push((node, mass_kg));
        if !has_weight {
            return;
        }
        let weight_n = self.down * (mass_kg * self.snapshot.structure.gravity_m_s2);
        let loads = (0..3).filter(|d| weight_n[*d] != 0.0).map(|d| (node, d, weight_n[d]));
        self.model.loads.extend(loads);
    }

    /// Point masses that together have the mass, centre of gravity and inertia of a body: one point, or two on each
    /// principal axis. If the body has inertia and no mass, the points are far away (see `FAR_M`), so that a small mass
    /// gives the inertia.
    fn points(
        &mut self,
        mass_kg: f64,
        cg_m: &Vector3<f64>,
        inertia_kgm2: &Matrix3<f64>,
        name: &str,
    ) -> Vec<(Vector3<f64>, f64)> {
        if inertia_kgm2.amax() == 0.0 {
            return if mass_kg == 0.0 { Vec::new() } else { vec![(*cg_m, mass_kg)] };
        }
        let mass_kg = match mass_kg == 0.0 {
            true => 1.5 * inertia_kgm2.trace() / FAR_M.powi(2),
            false => mass_kg,
        };
        let eigen = SymmetricEigen::new(*inertia_kgm2);
        let sum: f64 = eigen.eigenvalues.sum();
        if (0..3).any(|i| sum - 2.0 * eigen.eigenvalues[i] < -ROUNDING.sqrt() * sum) {
            self.model.impossible.push(name.into());
        }
        let mut out = Vec::new();
        for i in 0..3 {
            // ∫x² dm along a principal axis is half the sum of the three moments minus the moment about this axis
            let second = (sum / 2.0 - eigen.eigenvalues[i]).max(0.0);
            let arm_m = eigen.eigenvectors.column(i) * (3.0 * second / mass_kg).sqrt();
            out.extend([(cg_m + arm_m, mass_kg / 6.0), (cg_m - arm_m, mass_kg / 6.0)]);
        }
        out
    }

    /// Adds a link as a mesh of bricks, or as a rigid body if it cannot deform or cannot be meshed. `own` has the mass
    /// and the place of the link.
    fn link(&mut self, element: &ElasticElement, own: &OwnMass) {
        let link = self.snapshot.link(own.piece).cloned();
        let flexible = link.as_ref().and_then(|link| {
            let beam = link.beam.filter(|beam| beam.flexibility > 0.0 && has_shape(&beam.section))?;
            let mesh = mesh(&beam.section, &own.root_m, &own.frame, link.vector_m.norm())?;
            (!element.twists.is_empty()).then_some((beam, mesh))
        });
        let (Some(link), Some((beam, mesh))) = (link, flexible) else {
            let RigidBody { mass_kg, cg_m, inertia_kgm2 } = mass_properties(&own.rigid);
            return self.rigid(mass_kg, &cg_m, &inertia_kgm2, &element.name);
        };
        let first = self.model.nodes_m.len();
        self.model.nodes_m.extend(&mesh.nodes_m);
        let numbered = |nodes: &[usize]| nodes.iter().map(|n| first + n).collect::<Vec<_>>();
        for node in numbered(&mesh.stations[0]) {
            self.tie(node);
        }
        let root = std::mem::replace(&mut self.region, Region { frame: None, hinges: Vec::new() });
        let end_m = own.root_m + own.frame.column(0) * link.vector_m.norm();
        let (reference, rotation) = (self.node(end_m), self.node(end_m));
        self.region.frame = Some((reference, rotation, end_m));
        if let Some(face) = mesh.stations.last() {
            numbered(face).into_iter().for_each(|node| self.tie(node));
        }
        let tube_kg_per_m = link.tube_kg_per_m();
        self.model.solids.push(Solid {
            name: link.name.clone(),
            beam,
            frame: own.frame,
            density_kg_m3: beam.material.density_kg_m3 * (1.0 + link.harness_kg_per_m / tube_kg_per_m),
            bricks: mesh.bricks.iter().map(|brick| brick.map(|n| first + n)).collect(),
        });
        let meshed = Meshed { mesh: &mesh, first, own, length_m: link.vector_m.norm(), root };
        // rotation from the carried frame at the root of the link to the world, by way of the section frame
        let turn = own.frame * section_frame(&link.vector_m).transpose();
        for body in &link.bodies {
            let in_world = RigidBody {
                mass_kg: body.mass_kg,
                cg_m: own.root_m + turn * body.cg_m,
                inertia_kgm2: turn * body.inertia_kgm2 * turn.transpose(),
            };
            self.body_on_link(&meshed, &in_world, &link.name);
        }
    }

    /// Adds a body, given in world axes, to a meshed link. The body moves with the cross-section nearest to its centre
    /// of gravity.
    fn body_on_link(&mut self, link: &Meshed, body: &RigidBody, name: &str) {
        let last = link.mesh.stations.len() - 1;
        let xi = link.own.frame.column(0).dot(&(body.cg_m - link.own.root_m)) / link.length_m;
        let station = (xi.clamp(0.0, 1.0) * last as f64).round() as usize;
        for (point_m, kg) in self.points(body.mass_kg, &body.cg_m, &body.inertia_kgm2, name) {
            let node = self.node(point_m);
            match station {
                0 => {
                    let end = std::mem::replace(&mut self.region, link.root.clone());
                    self.tie(node);
                    self.region = end;
                }
                s if s == last => self.tie(node),
                s => self.average(node, link.first, &link.mesh.stations[s]),
            }
            self.point_mass(node, kg, body.mass_kg > 0.0);
        }
    }

    /// Makes a node move with a cross-section of a mesh: with the mean displacement of the nodes of the cross-section,
    /// and with the rotation that fits their displacements best (least squares). `station` has the nodes of the
    /// cross-section, counted from the node `first`.
    fn average(&mut self, node: usize, first: usize, station: &[usize]) {
        let places: Vec<(usize, Vector3<f64>)> =
            station.iter().map(|n| (first + n, self.model.nodes_m[first + n])).collect();
        let count = places.len() as f64;
        let centre_m: Vector3<f64> = places.iter().map(|(_, p)| p).sum::<Vector3<f64>>() / count;
        let spread: Matrix3<f64> = places
            .iter()
            .map(|(_, p)| {
                let r = p - centre_m;
                Matrix3::identity() * r.norm_squared() - r * r.transpose()
            })
            .sum();
        let Some(inverse) = spread.try_inverse() else { return self.tie(node) };
        let arm_m = self.model.nodes_m[node] - centre_m;
        for d in 0..3 {
            let mut terms = vec![(node, d, -1.0)];
            for (n, p) in &places {
                // The rotation that fits best is θ = S⁻¹ Σ r × u, with the positions r of the nodes from their centre
                // and their displacements u. It moves the node, which is at a from the centre, by θ × a.
                let moved = Matrix3::identity() / count
                    - arm_m.cross_matrix() * inverse * (p - centre_m).cross_matrix();
                terms.extend((0..3).map(|e| (*n, e, moved[(d, e)])));
            }
            self.equation(terms);
        }
    }

    /// Adds a node at `at_m` \[m\] that moves with the rigid region that is being built, and returns its index.
    fn tied(&mut self, at_m: Vector3<f64>) -> usize {
        let node = self.node(at_m);
        self.tie(node);
        node
    }

    /// Makes a node move with the rigid region that is being built.
    fn tie(&mut self, node: usize) {
        let at_m = self.model.nodes_m[node];
        for d in 0..3 {
            let mut terms = vec![(node, d, -1.0)];
            if let Some((reference, rotation, frame_m)) = self.region.frame {
                terms.push((reference, d, 1.0));
                let turned = (at_m - frame_m).cross_matrix().transpose();
                terms.extend((0..3).map(|e| (rotation, e, turned[(d, e)])));
            }
            let hinges = self.region.hinges.iter();
            terms.extend(hinges.map(|(hinge, twist)| (*hinge, 0, displacement_at(twist, &at_m)[d])));
            self.equation(terms);
        }
    }

    /// Adds a linear equation between degrees of freedom. Terms with the same degree of freedom are added up. If only
    /// the dependent term (the first one) remains, its degree of freedom is fixed.
    fn equation(&mut self, terms: Vec<Term>) {
        let mut joined: Vec<Term> = Vec::new();
        for (node, d, coefficient) in terms {
            match joined.iter_mut().find(|(n, e, _)| (*n, *e) == (node, d)) {
                Some((_, _, sum)) => *sum += coefficient,
                None => joined.push((node, d, coefficient)),
            }
        }
        joined.retain(|(_, _, coefficient)| coefficient.abs() > ROUNDING);
        match joined.as_slice() {
            [(node, d, _)] => self.model.held.push((*node, *d)),
            _ => self.model.equations.push(joined),
        }
    }

    /// Adds the force and the moment at the tip as loads.
    fn tip_load(&mut self, tip: usize, force_n: &Vector3<f64>, moment_nm: &Vector3<f64>) {
        let forces = (0..3).filter(|d| force_n[*d] != 0.0).map(|d| (tip, d, force_n[d]));
        self.model.loads.extend(forces);
        if *moment_nm == Vector3::zeros() {
            return;
        }
        if let Some((_, rotation, _)) = self.region.frame {
            self.model.loads.extend((0..3).map(|d| (rotation, d, moment_nm[d])));
        }
        let work = |twist: &Twist| angular(twist).dot(moment_nm);
        let on_hinges: Vec<Term> =
            self.region.hinges.iter().map(|(node, twist)| (*node, 0, work(twist))).collect();
        self.model.loads.extend(on_hinges);
    }
}
