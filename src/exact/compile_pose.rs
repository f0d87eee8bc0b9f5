//! Compiles one case of a study into a [`Pose`].
//!
//! A serial chain is statically determinate. The generalized force on every strain coordinate (the torsion of a joint,
//! a polynomial coefficient of a link's deformation) is therefore linear in the weights of the pieces outboard. The
//! tip's displacement is the sum over the coordinates of force times compliance times a constant vector. If weights and
//! compliances are intervals, so are the forces and the displacement. This is true in every pose.

use super::bearing_rows::{BearingRows, Loads, Ramp};
use super::parts::{INERTIAS, inertia};
use super::pose::{
    COORDINATES, ENDS, InertiaRow, Pose, PosedBodies, PosedPiece, PosedTube, Pulls, Row, StressRow, TILT,
    TORSION, TubeForms,
};
use crate::arm::LinkModel;
use crate::arm::load::Water;
use crate::arm::springs::{EndLoad, Side};
use crate::arm::structure::LinkPiece;
use crate::mechanics::across;
use crate::mechanics::beam::{PreparedBeam, pull_on, section_frame};
use crate::mechanics::chain::wrench_of;
use crate::mechanics::{
    Twist, Wrench, angular, body_inertia, displacement_at, linear, rotation_twist, stack,
};
use crate::space::design_space::{DesignSpace, SpacePiece};
use crate::space::effects::{Carried, Carrier, Layer};
use crate::space::station::{Walk, bodies_at, payload_in, weight_wrench};
use nalgebra::{DMatrix, Matrix3, Matrix6, Rotation3, SMatrix, Vector3};

/// The data of a joint, in addition to its axis, that a compiled pose needs. For a prismatic joint (rail), metres take
/// the place of radians.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JointNeeds {
    /// Whether the output bearing of the joint tilts with at least one of the drives that may be chosen.
    pub tilts: bool,
    /// Whether the output bearing of some drive has a limit that must be checked.
    pub is_checked: bool,
    /// Acceleration of the joint in a ramp \[rad/s²\], or of a rail \[m/s²\].
    pub acceleration_rad_s2: f64,
    /// Ratio of the deceleration of the joint in its emergency stop to `acceleration_rad_s2`, at least 1.
    pub stop_factor: f64,
}

impl Pose {
    /// Compiles the case with this index. `joints` has the needs of the joint at each place of the chain, base to tip.
    pub(super) fn new(space: &DesignSpace, index: usize, joints: &[JointNeeds]) -> Self {
        let case = &space.cases[index];
        let water = case.water.or(space.surroundings().water);
        let walk = Walk::new(space, case);
        let (payload_wrench, payload_inertia) = payload_in(space, case, water, &walk);
        let springs = walk.spring_loads(space);
        let (mut pieces, mut needs, mut loads) = (Vec::new(), Vec::new(), Vec::new());
        for (place, layer) in space.layers() {
            let (at, joint) = (walk.place(place, &layer), joints[place]);
            let on = |side: Side| springs.iter().filter(move |load| load.on == side);
            let pulls: Vec<&EndLoad> = on(Side::Moving(place)).collect();
            let Some(posed) = posed(space, water, layer, (joint.tilts, &pulls), at) else { continue };
            // Loads of springs on a tube are stored with the tube.
            if let Layer::Springs(side) = layer
                && (side != Side::Moving(place) || !space.is_tube(place))
            {
                loads.push((pieces.len(), on(side).map(wrench_of).sum()));
            }
            if let Layer::Piece(SpacePiece::Joint(_) | SpacePiece::Prismatic(_)) = layer {
                needs.push((pieces.len(), joint));
            }
            pieces.push(posed);
            if let Layer::Piece(piece) = layer
                && harness_kg(space, piece).is_some()
            {
                pieces.push(PosedPiece::Body(Matrix6::zeros()));
            }
        }
        let mut pose = Self {
            judged: space.judged_cases.contains(&index),
            sizing: space.sizing_cases.contains(&index),
            contributions_align: false,
            water_kg_m3: water.map_or(0.0, |w| w.density_kg_m3),
            pieces,
            payload_inertia,
            rows: Vec::new(),
            stress: Vec::new(),
            inertia_about: Vec::new(),
            bearings: Vec::new(),
        };
        pose.compile(space, (payload_wrench, &loads), &walk.tip_m, &needs);
        pose.contributions_align = pose.contributions_align();
        pose
    }

    /// Writes the rows of this pose: for each strain coordinate, its generalized force as a linear function of the
    /// weights outboard. The function goes inward from the tip and adds each piece to the wrench of everything
    /// outboard. `joints` has the needs of each joint, and `springs` the wrench of each spring. Both are given with the
    /// number of the piece at which they act.
    fn compile(
        &mut self,
        space: &DesignSpace,
        (payload, springs): (Wrench, &[(usize, Wrench)]),
        tip_m: &Vector3<f64>,
        joints: &[(usize, JointNeeds)],
    ) {
        let mut outboard = Outboard::new(payload, self.payload_inertia);
        for (piece, posed) in self.pieces.iter().enumerate() {
            outboard.fixed_inertia_of.push(outboard.fixed_inertia);
            let bearing = self.bearing(piece, joints, &outboard);
            self.bearings.push(bearing);
            match posed {
                PosedPiece::Joint { twist, at_m, across } => {
                    self.rows.extend(outboard.joint_rows(piece, twist, across.as_ref(), tip_m));
                    self.inertia_about.push(Some(outboard.inertia_row(twist)));
                    outboard.add_drive(at_m, space);
                }
                PosedPiece::Body(body) => {
                    self.inertia_about.push(None);
                    outboard.add_body(body, space);
                    let pulls = springs.iter().filter(|(at, _)| *at == piece);
                    outboard.fixed += pulls.map(|(_, load)| load).sum::<Wrench>();
                }
                PosedPiece::Tube(tube) => {
                    self.inertia_about.push(None);
                    // The search checks the stress only where the section is a choice.
                    if tube.chosen {
                        self.stress.push(outboard.stress(piece, tube, &tube.point_m(tube.length_m)));
                    }
                    self.rows.extend(outboard.tube_rows(piece, tube, &space.down, tip_m));
                    outboard.add_tube(tube, space);
                    if tube.chosen {
                        self.stress.push(outboard.stress(piece, tube, &tube.root_m));
                    }
                }
            }
        }
        self.leave_out_unstrained();
    }

    /// Removes the rows of coordinates that no load strains. In a planar arm these are the coordinates that deflect
    /// out of the vertical plane. Torsions of joints stay, because the demand on joints is needed in any case.
    fn leave_out_unstrained(&mut self) {
        let scale = self.rows.iter().map(Row::largest).fold(0.0, f64::max);
        let is_torsion: Vec<bool> = self.rows.iter().map(|row| self.is_torsion(row)).collect();
        let mut is_torsion = is_torsion.into_iter();
        self.rows.retain(|row| is_torsion.next() == Some(true) || row.largest() > 1e-13 * scale);
    }

    /// The loads on the output bearing of the joint `piece`, as functions of the weights and inertias outboard.
    /// `joints` has the needs of each joint. `None` if the piece is not a joint, its bearing is not checked, or the
    /// case is not a sizing case.
    fn bearing(
        &self,
        piece: usize,
        joints: &[(usize, JointNeeds)],
        outboard: &Outboard,
    ) -> Option<BearingRows> {
        let is_checked = |(at, needs): &(usize, JointNeeds)| *at == piece && needs.is_checked;
        let PosedPiece::Joint { twist, at_m, .. } = &self.pieces[piece] else { return None };
        joints.iter().find(|joint| is_checked(joint)).filter(|_| self.sizing)?;
        let loads = Loads { fixed: outboard.fixed, per_n: &outboard.per_n };
        let ramps = joints.iter().filter_map(|(moving, needs)| {
            let PosedPiece::Joint { twist, .. } = &self.pieces[*moving] else { return None };
            // A joint outboard of the bearing accelerates only the parts that are outboard of that joint.
            let (fixed, inertia) = match outboard.fixed_inertia_of.get(*moving) {
                Some(fixed) => (*fixed, &outboard.inertia[..*moving]),
                None => (outboard.fixed_inertia, &outboard.inertia[..]),
            };
            let (acceleration, stop_factor) = (twist * needs.acceleration_rad_s2, needs.stop_factor);
            Some(Ramp { acceleration, fixed, inertia, stop_factor })
        });
        let axis = angular(twist);
        Some(BearingRows::new([at_m, &axis], &across(&axis), &loads, ramps))
    }
}

/// One layer of the chain at its place in the pose. `tilts` tells whether the bearing of a joint tilts; `pulls` are the
/// loads of springs on a tube; `at_m` and `rotation` are the place and the attitude of the layer. `None` for the tilt
/// springs of a gear's bearing, because these tilts are coordinates of the joint.
fn posed(
    space: &DesignSpace,
    water: Option<Water>,
    layer: Layer,
    (tilts, pulls): (bool, &[&EndLoad]),
    (at_m, rotation): &(Vector3<f64>, Rotation3<f64>),
) -> Option<PosedPiece> {
    let hinge = |axis: &Vector3<f64>, across: Option<[Vector3<f64>; 2]>| PosedPiece::Joint {
        twist: rotation_twist(axis, at_m),
        at_m: *at_m,
        across: across.map(|axes| axes.map(|axis| rotation_twist(&axis, at_m))),
    };
    let body = |mass_kg: f64, centre_m: &Vector3<f64>, inertia_kgm2: Matrix3<f64>| {
        PosedPiece::Body(body_inertia(mass_kg, centre_m, &inertia_kgm2))
    };
    Some(match layer {
        Layer::Tilt(tilt) => hinge(&tilt.axis(rotation), None),
        Layer::Guide(spring) => hinge(&spring.axis(rotation), None),
        Layer::Mass(mass_kg) | Layer::Travelling(mass_kg) | Layer::Extra(mass_kg) => {
            body(mass_kg, at_m, Matrix3::zeros())
        }
        Layer::Bearing(_) | Layer::Motor(_) => return None,
        Layer::Springs(_) | Layer::Bodies(Carried { by: Carrier::Tube, .. }) => {
            PosedPiece::Body(Matrix6::zeros())
        }
        Layer::Bodies(Carried { bodies, .. }) => {
            PosedPiece::Body(bodies_at(bodies, space, &(*at_m, *rotation)).0)
        }
        Layer::Piece(SpacePiece::Joint(joint)) => {
            let axis = rotation * joint.axis;
            hinge(&axis, tilts.then(|| across(&axis)))
        }
        Layer::Piece(SpacePiece::Prismatic(slide)) => PosedPiece::Joint {
            twist: stack(&(rotation * slide.joint.axis.into_inner()), &Vector3::zeros()),
            at_m: *at_m,
            across: None,
        },
        Layer::Piece(SpacePiece::Choice(choice)) => {
            let link = space.link_piece(&choice.first_link());
            posed_tube(space, water, (&link, pulls), (at_m, rotation.matrix()), true)
        }
        Layer::Piece(SpacePiece::Link(link)) => {
            let link = space.link_piece(link);
            if link.beam.is_some() && link.vector_m.norm() > 0.0 {
                return Some(posed_tube(space, water, (&link, pulls), (at_m, rotation.matrix()), false));
            }
            // A harness along a rigid offset is a slender rod.
            let vector_m = rotation * link.vector_m;
            let along_kg = link.harness_kg_per_m * vector_m.norm();
            let rod = Matrix3::identity() * vector_m.norm_squared() - vector_m * vector_m.transpose();
            body(link.point_mass_kg + along_kg, &(at_m + vector_m / 2.0), rod * (along_kg / 12.0))
        }
    })
}

/// A tube in the pose. `root_m` and `rotation` are the place and attitude of its root, `pulls` are the loads of springs
/// on it, and `chosen` tells whether its section is a choice.
fn posed_tube(
    space: &DesignSpace,
    water: Option<Water>,
    (link, pulls): (&LinkPiece, &[&EndLoad]),
    (root_m, rotation): (&Vector3<f64>, &Matrix3<f64>),
    chosen: bool,
) -> PosedPiece {
    let structure = space.structure_of(Vec::new());
    let frame = rotation * section_frame(&link.vector_m);
    // The displacement fields of the coordinates depend on the length alone, so the first option stands for all.
    let Some(beam) = PreparedBeam::new(link, &structure, LinkModel::Full) else {
        return PosedPiece::Body(Matrix6::zeros());
    };
    let end_m = root_m + frame * Vector3::x() * beam.length_m;
    let ends = ENDS.map(|coordinate| {
        let local = beam.end_fields.column(coordinate);
        let rotation = frame * local.fixed_rows::<3>(3);
        stack(&(frame * local.fixed_rows::<3>(0) + end_m.cross(&rotation)), &rotation)
    });
    PosedPiece::Tube(Box::new(PosedTube {
        length_m: beam.length_m,
        root_m: *root_m,
        frame,
        ends,
        forms: TubeForms::new(&beam),
        added_kg_m3: water.map_or(0.0, |w| w.added_mass_coefficient * w.density_kg_m3),
        chosen,
        bodies: PosedBodies::new(space, link, &beam, (root_m, rotation)).map(Box::new),
        pulls: Pulls::new(&beam, (root_m, &frame), pulls),
    }))
}

impl PosedBodies {
    /// The given bodies on a tube, whose root is at `root_m` with attitude `rotation`; `None` if there are none.
    fn new(
        space: &DesignSpace,
        link: &LinkPiece,
        beam: &PreparedBeam,
        (root_m, rotation): (&Vector3<f64>, &Matrix3<f64>),
    ) -> Option<Self> {
        if link.bodies.is_empty() {
            return None;
        }
        let place = (*root_m, Rotation3::from_matrix_unchecked(*rotation));
        let (rigid, weight) = bodies_at(&link.bodies, space, &place);
        let down = (rotation * beam.frame).tr_mul(&space.down);
        let mut out = Self {
            inertia: DMatrix::zeros(6 + COORDINATES, 6 + COORDINATES),
            rigid,
            weight,
            end_forces: [0.0; 8],
        };
        for body in &link.bodies {
            out.inertia += beam.inertia_of(body);
            let centre = beam.centre_fields(body);
            for (force, coordinate) in out.end_forces.iter_mut().zip(ENDS) {
                *force += body.mass_kg * space.gravity_m_s2 * centre.column(6 + coordinate).dot(&down);
            }
        }
        Some(out)
    }
}

impl Pulls {
    /// The loads of springs on a tube with the root `root_m` and the section frame `frame`.
    fn new(beam: &PreparedBeam, (root_m, frame): (&Vector3<f64>, &Matrix3<f64>), loads: &[&EndLoad]) -> Self {
        let mut out = Self::default();
        for load in loads {
            out.wrench += wrench_of(load);
            let (xi, local) = pull_on(beam.length_m, root_m, frame, load);
            let fields = beam.fields(xi);
            for (force, coordinate) in out.end_forces.iter_mut().zip(ENDS) {
                *force += fields.column(6 + coordinate).dot(&local);
            }
        }
        out
    }
}

impl TubeForms {
    /// Prepares the inertia matrices of the tube by integrating the products of its displacement fields along its
    /// length.
    fn new(beam: &PreparedBeam) -> Self {
        let n = 6 + COORDINATES;
        let mut forms = vec![DMatrix::<f64>::zeros(n, n); 6];
        for (xi, weight) in beam.quadrature() {
            let fields = beam.fields(xi);
            for (component, form) in forms.iter_mut().enumerate() {
                let row = fields.row(component);
                *form += row.transpose() * row * weight;
            }
        }
        let z = [2, 4, 6, 7, 8, 9, 14, 15, 16];
        let y = [1, 5, 10, 11, 12, 13, 17, 18, 19];
        let nine = |form: &DMatrix<f64>, at: [usize; 9]| SMatrix::from_fn(|i, j| form[(at[i], at[j])]);
        let four = |form: &DMatrix<f64>, at: [usize; 4]| SMatrix::from_fn(|i, j| form[(at[i], at[j])]);
        Self {
            across_z: nine(&forms[2], z),
            across_y: nine(&forms[1], y),
            rotary_y: nine(&forms[4], z),
            rotary_z: nine(&forms[5], y),
            polar: four(&forms[3], [3, 20, 21, 22]),
            along: four(&forms[0], [0, 23, 24, 25]),
        }
    }
}

impl PosedTube {
    /// The point of the tube's axis at the distance `from_root_m` from its root.
    fn point_m(&self, from_root_m: f64) -> Vector3<f64> {
        self.root_m + self.frame * Vector3::x() * from_root_m
    }

    /// Inertia matrices of the tube as a rigid body, about the world's origin, each per unit of one line inertia
    /// (inertia per metre).
    fn rigid_forms(&self) -> [Matrix6<f64>; INERTIAS] {
        let to_local = crate::mechanics::condensed::world_to_local(&self.root_m, &self.frame);
        let f = &self.forms;
        let planes =
            |z: Option<&SMatrix<f64, 9, 9>>, y: Option<&SMatrix<f64, 9, 9>>, along: f64, polar: f64| {
                let mut local = Matrix6::zeros();
                for (form, at) in [(z, [2, 4]), (y, [1, 5])] {
                    let Some(form) = form else { continue };
                    for i in 0..2 {
                        for j in 0..2 {
                            local[(at[i], at[j])] += form[(i, j)];
                        }
                    }
                }
                local[(0, 0)] += along;
                local[(3, 3)] += polar;
                to_local.transpose() * local * to_local
            };
        let across = planes(Some(&f.across_z), Some(&f.across_y), 0.0, 0.0);
        let mut forms = [Matrix6::zeros(); INERTIAS];
        forms[inertia::MASS] = across + planes(None, None, f.along[(0, 0)], 0.0);
        forms[inertia::OUTER_AREA] = across * self.added_kg_m3;
        forms[inertia::POLAR] = planes(None, None, 0.0, f.polar[(0, 0)]);
        forms[inertia::ROTARY_Y] = planes(Some(&f.rotary_y), None, 0.0, 0.0);
        forms[inertia::ROTARY_Z] = planes(None, Some(&f.rotary_z), 0.0, 0.0);
        forms
    }
}

/// Generalized force on each of the eight coordinates that move the tube's end ([`ENDS`]), per newton of the tube's own
/// weight. The weight is distributed evenly along the tube.
fn areas_per_n(tube: &PosedTube, down: &Vector3<f64>) -> [f64; 8] {
    let down = tube.frame.tr_mul(down);
    let f = &tube.forms;
    // `∫ field · (force per length)` is the translation row of the inertia form divided by the length.
    let per = |form: &SMatrix<f64, 9, 9>, place: usize| form[(0, place)] / tube.length_m;
    ENDS.map(|coordinate| match coordinate {
        0 | 1 => down.z * per(&f.across_z, 2 + coordinate),
        4 | 5 => down.y * per(&f.across_y, 2 + coordinate - 4),
        8 => down.z * per(&f.across_z, 6),
        11 => down.y * per(&f.across_y, 6),
        17 => down.x * f.along[(0, 1)] / tube.length_m,
        _ => 0.0,
    })
}

/// The wrench and the inertia of everything outboard of the present piece, as linear functions of the weights and
/// inertias of the parts.
struct Outboard {
    /// Wrench of payload, tip force, springs and the bodies that the study gives, added up so far.
    fixed: Wrench,
    /// Wrench of each piece per newton of its weight, tip first.
    per_n: Vec<Wrench>,
    /// Inertia of the payload and of the bodies that the study gives, added up so far, about the world's origin.
    fixed_inertia: Matrix6<f64>,
    /// For each piece, tip first, the value of `fixed_inertia` before this piece was added: the inertia of payload and
    /// given bodies outboard of the piece.
    fixed_inertia_of: Vec<Matrix6<f64>>,
    /// Inertia of each piece about the world's origin per unit of each line inertia, tip first.
    inertia: Vec<[Matrix6<f64>; INERTIAS]>,
}

impl Outboard {
    fn new(payload: Wrench, payload_inertia: Matrix6<f64>) -> Self {
        Self {
            fixed: payload,
            per_n: Vec::new(),
            fixed_inertia: payload_inertia,
            fixed_inertia_of: Vec::new(),
            inertia: Vec::new(),
        }
    }

    /// Adds the weight and the inertia of a body whose mass the study gives. `body` is the inertia matrix of this body
    /// about the world's origin.
    fn add_body(&mut self, body: &Matrix6<f64>, space: &DesignSpace) {
        self.fixed_inertia += body;
        let mass_kg = body[(0, 0)];
        if mass_kg > 0.0 {
            let moment = Vector3::new(body[(5, 1)], body[(3, 2)], body[(4, 0)]) / mass_kg;
            self.fixed += weight_wrench(mass_kg * space.gravity_m_s2, &space.down, &moment);
        }
        self.push(Wrench::zeros(), [Matrix6::zeros(); INERTIAS]);
    }

    /// Adds the weight and the inertia of the drive of a joint at the point `at_m`: a point mass.
    fn add_drive(&mut self, at_m: &Vector3<f64>, space: &DesignSpace) {
        let mut forms = [Matrix6::zeros(); INERTIAS];
        forms[inertia::MASS] = body_inertia(1.0, at_m, &Matrix3::zeros());
        self.push(weight_wrench(1.0, &space.down, at_m), forms);
    }

    /// Adds the weight and the inertia of a tube, of the bodies on it, and the loads of springs on it.
    fn add_tube(&mut self, tube: &PosedTube, space: &DesignSpace) {
        let middle_m = tube.point_m(tube.length_m / 2.0);
        self.push(weight_wrench(1.0, &space.down, &middle_m), tube.rigid_forms());
        self.fixed += tube.pulls.wrench;
        if let Some(bodies) = &tube.bodies {
            self.fixed += bodies.weight;
            self.fixed_inertia += bodies.rigid;
        }
    }

    fn push(&mut self, per_n: Wrench, inertia: [Matrix6<f64>; INERTIAS]) {
        self.per_n.push(per_n);
        self.inertia.push(inertia);
    }

    /// The rows of the joint `piece`: first the rows of the tilts of its bearing about the axes `across`, if it tilts,
    /// then the row of its torsion. `twist` is the motion of everything outboard per radian of torsion.
    fn joint_rows(
        &self,
        piece: usize,
        twist: &Twist,
        across: Option<&[Twist; 2]>,
        tip_m: &Vector3<f64>,
    ) -> impl Iterator<Item = Row> {
        let tilts = across.into_iter().flatten().enumerate();
        let tilts = tilts.map(move |(at, tilt)| self.row(piece, TILT + at, tilt, 0.0, tip_m));
        tilts.chain(std::iter::once(self.row(piece, TORSION, twist, 0.0, tip_m)))
    }

    /// The rows of the tube `piece`: one for each of the eight coordinates that move its end ([`ENDS`]).
    fn tube_rows(
        &self,
        piece: usize,
        tube: &PosedTube,
        down: &Vector3<f64>,
        tip_m: &Vector3<f64>,
    ) -> impl Iterator<Item = Row> {
        let areas = areas_per_n(tube, down);
        let bodies = tube.bodies.as_ref().map_or([0.0; 8], |bodies| bodies.end_forces);
        ENDS.into_iter().enumerate().map(move |(end, coordinate)| {
            // The weight of a tube strains the tube itself too, although it is not outboard of the tube.
            let own = areas[end];
            let mut row = self.row(piece, coordinate, &tube.ends[end], own, tip_m);
            row.fixed += bodies[end] + tube.pulls.end_forces[end];
            row
        })
    }

    /// The row of a strain coordinate: the generalized force on the coordinate, and the tip displacement that it
    /// causes. `twist` is the motion of everything outboard per unit of the coordinate. `own_per_n` is the force on the
    /// coordinate per newton of the weight of the piece to which it belongs.
    fn row(
        &self,
        piece: usize,
        coordinate: usize,
        twist: &Twist,
        own_per_n: f64,
        tip_m: &Vector3<f64>,
    ) -> Row {
        let mut per_n: Vec<f64> = self.per_n.iter().map(|w| twist.dot(w)).collect();
        per_n.push(own_per_n);
        let tip_m = displacement_at(twist, tip_m);
        Row { piece, coordinate, fixed: twist.dot(&self.fixed), per_n, tip_m, tip_m_per_unit: tip_m.norm() }
    }

    /// The inertia of everything outboard about a joint's axis \[kg m²\], as a linear function of the line inertias.
    /// `twist` is the motion per radian of the joint.
    fn inertia_row(&self, twist: &Twist) -> InertiaRow {
        let about = |m: &Matrix6<f64>| twist.dot(&(m * twist)).max(0.0);
        InertiaRow {
            fixed: about(&self.fixed_inertia),
            per_line: self.inertia.iter().map(|forms| std::array::from_fn(|k| about(&forms[k]))).collect(),
        }
    }

    /// The loads on the section of a tube at the point `at_m`, as linear functions of the weights: axial force \[N\],
    /// moments about y and z, and torsion \[N m\].
    fn stress(&self, piece: usize, tube: &PosedTube, at_m: &Vector3<f64>) -> StressRow {
        let local = |wrench: &Wrench| {
            let force = tube.frame.tr_mul(&linear(wrench));
            let moment = tube.frame.tr_mul(&(angular(wrench) - at_m.cross(&linear(wrench))));
            [force.x, moment.y, moment.z, moment.x]
        };
        let fixed = local(&self.fixed);
        let per_n: Vec<[f64; 4]> = self.per_n.iter().map(local).collect();
        StressRow { piece, loads: std::array::from_fn(|k| (fixed[k], per_n.iter().map(|w| w[k]).collect())) }
    }
}

impl Row {
    /// Largest magnitude among the constant part of this row's force and its coefficients per newton.
    fn largest(&self) -> f64 {
        self.per_n.iter().fold(self.fixed.abs(), |most, c| most.max(c.abs()))
    }
}

/// Mass of the harness along a tube \[kg\]. `None` without a harness.
pub(super) fn harness_kg(space: &DesignSpace, piece: &SpacePiece) -> Option<f64> {
    let link = match piece {
        SpacePiece::Joint(_) | SpacePiece::Prismatic(_) => return None,
        SpacePiece::Link(link) => space.link_piece(link),
        SpacePiece::Choice(choice) => space.link_piece(&choice.first_link()),
    };
    let mass_kg = link.harness_kg_per_m * link.vector_m.norm();
    (link.beam.is_some() && mass_kg > 0.0).then_some(mass_kg)
}
