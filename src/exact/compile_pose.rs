//! Compiles one case of a study into a [`Pose`].
//!
//! A serial chain is statically determinate. The generalized force on every strain coordinate (the twist of a
//! joint, a polynomial coefficient of a link's deformation) is therefore linear in the weights of the pieces
//! outboard. The tip's displacement is the sum, over the coordinates, of force times compliance times a
//! constant vector. With weights and compliances as intervals both become intervals. This holds in every
//! pose.

use super::parts::{INERTIAS, inertia};
use super::pose::{COORDINATES, ENDS, InertiaRow, Pose, PosedPiece, PosedTube, Row, StressRow, TubeForms};
use crate::arm::LinkModel;
use crate::arm::load::Water;
use crate::arm::structure::{LinkPiece, Structure};
use crate::mechanics::beam::{PreparedBeam, section_frame};
use crate::mechanics::{Twist, Wrench, angular, body_inertia, displacement_at, linear, rotation_twist};
use crate::space::design_space::{DesignSpace, SpacePiece};
use crate::space::effects::Layer;
use crate::space::station::{Walk, payload_in, weight_wrench};
use nalgebra::{DMatrix, Matrix3, Matrix6, Rotation3, SMatrix, Vector3};

impl Pose {
    /// Compiles the case with this index.
    pub(super) fn new(space: &DesignSpace, index: usize) -> Self {
        let case = &space.cases[index];
        let water = case.water.or(space.surroundings().water);
        let walk = Walk::new(space, case);
        let (payload_wrench, payload_inertia) = payload_in(space, case, water, &walk);
        let mut pieces = Vec::new();
        for (place, layer) in space.layers() {
            let at = &walk.places[place];
            pieces.push(posed(space, water, layer, at));
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
        };
        pose.compile(space, payload_wrench, &walk.tip_m);
        pose.contributions_align = pose.contributions_align();
        pose
    }

    /// Compiles the pieces from the tip inward. The wrench of everything outboard is kept as a linear function of the
    /// weights.
    fn compile(&mut self, space: &DesignSpace, payload: Wrench, tip_m: &Vector3<f64>) {
        let mut outboard = Outboard { fixed: payload, per_n: Vec::new(), inertia: Vec::new() };
        let mut fixed_inertia = self.payload_inertia;
        for (piece, posed) in self.pieces.iter().enumerate() {
            match posed {
                PosedPiece::Joint { twist, at_m } => {
                    self.rows.push(outboard.row(piece, 0, twist, 0.0, tip_m));
                    self.inertia_about.push(Some(outboard.inertia_row(&fixed_inertia, twist)));
                    let mut forms = [Matrix6::zeros(); INERTIAS];
                    forms[inertia::MASS] = body_inertia(1.0, at_m, &Matrix3::zeros());
                    outboard.push(weight_wrench(1.0, at_m), forms);
                }
                PosedPiece::Body(body) => {
                    fixed_inertia += body;
                    let mass_kg = body[(0, 0)];
                    if mass_kg > 0.0 {
                        let moment = Vector3::new(body[(5, 1)], body[(3, 2)], body[(4, 0)]) / mass_kg;
                        outboard.fixed += weight_wrench(mass_kg * space.gravity_m_s2, &moment);
                    }
                    self.inertia_about.push(None);
                    outboard.push(Wrench::zeros(), [Matrix6::zeros(); INERTIAS]);
                }
                PosedPiece::Tube(tube) => {
                    self.inertia_about.push(None);
                    let end_m = tube.root_m + tube.frame * Vector3::x() * tube.length_m;
                    // The bound checks stress only where the section is a choice.
                    if tube.chosen {
                        self.stress.push(outboard.stress(piece, tube, &end_m));
                    }
                    let areas = areas_per_n(tube);
                    for (end, coordinate) in ENDS.into_iter().enumerate() {
                        // A tube's own weight strains its coordinates too, though it is not outboard of the
                        // tube.
                        let own = areas[end];
                        self.rows.push(outboard.row(piece, coordinate, &tube.ends[end], own, tip_m));
                    }
                    let middle_m = tube.root_m + tube.frame * Vector3::x() * (tube.length_m / 2.0);
                    outboard.push(weight_wrench(1.0, &middle_m), tube.rigid_forms());
                    if tube.chosen {
                        self.stress.push(outboard.stress(piece, tube, &tube.root_m));
                    }
                }
            }
        }
        let scale = self.rows.iter().map(Row::largest).fold(0.0, f64::max);
        // Coordinates that nothing strains, such as those across a vertical plane, are left out. Joints stay,
        // because their demand is needed in any case.
        let strained = |row: &Row| matches!(self.pieces[row.piece], PosedPiece::Joint { .. });
        self.rows.retain(|row| strained(row) || row.largest() > 1e-13 * scale);
    }
}

/// One layer of the chain at its place in the pose.
fn posed(
    space: &DesignSpace,
    water: Option<Water>,
    layer: Layer,
    (at_m, rotation): &(Vector3<f64>, Rotation3<f64>),
) -> PosedPiece {
    let hinge = |axis: &Vector3<f64>| PosedPiece::Joint { twist: rotation_twist(axis, at_m), at_m: *at_m };
    let body = |mass_kg: f64, centre_m: &Vector3<f64>, inertia_kgm2: Matrix3<f64>| {
        PosedPiece::Body(body_inertia(mass_kg, centre_m, &inertia_kgm2))
    };
    match layer {
        Layer::Tilt(tilt) => hinge(&tilt.axis(rotation)),
        Layer::Mass(mass_kg) | Layer::Extra(mass_kg) => body(mass_kg, at_m, Matrix3::zeros()),
        Layer::Bearing(_) => body(0.0, at_m, Matrix3::zeros()),
        Layer::Piece(SpacePiece::Joint(joint)) => hinge(&(rotation * joint.axis)),
        Layer::Piece(SpacePiece::Choice(choice)) => {
            posed_tube(space, water, &space.link_piece(&choice.first_link()), at_m, rotation.matrix(), true)
        }
        Layer::Piece(SpacePiece::Link(link)) => {
            let link = space.link_piece(link);
            if link.beam.is_some() && link.vector_m.norm() > 0.0 {
                return posed_tube(space, water, &link, at_m, rotation.matrix(), false);
            }
            // A harness along a rigid offset is a slender rod.
            let vector_m = rotation * link.vector_m;
            let along_kg = link.harness_kg_per_m * vector_m.norm();
            let rod = Matrix3::identity() * vector_m.norm_squared() - vector_m * vector_m.transpose();
            body(link.point_mass_kg + along_kg, &(at_m + vector_m / 2.0), rod * (along_kg / 12.0))
        }
    }
}

/// A tube whose root is at a place of the pose.
fn posed_tube(
    space: &DesignSpace,
    water: Option<Water>,
    link: &LinkPiece,
    root_m: &Vector3<f64>,
    rotation: &Matrix3<f64>,
    chosen: bool,
) -> PosedPiece {
    let structure = Structure::nominal(space.gravity_m_s2, Vec::new());
    let frame = rotation * section_frame(&link.vector_m);
    // The fields of the coordinates depend on the length alone, so the first option stands for all.
    let Some(beam) = PreparedBeam::new(link, &structure, LinkModel::Full) else {
        return PosedPiece::Body(Matrix6::zeros());
    };
    let end_m = root_m + frame * Vector3::x() * beam.length_m;
    let ends = ENDS.map(|coordinate| {
        let local = beam.end_fields.column(coordinate);
        let rotation = frame * local.fixed_rows::<3>(3);
        crate::mechanics::stack(&(frame * local.fixed_rows::<3>(0) + end_m.cross(&rotation)), &rotation)
    });
    PosedPiece::Tube(Box::new(PosedTube {
        length_m: beam.length_m,
        root_m: *root_m,
        frame,
        ends,
        forms: TubeForms::new(&beam),
        added_kg_m3: water.map_or(0.0, |w| w.added_mass_coefficient * w.density_kg_m3),
        chosen,
    }))
}

impl TubeForms {
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
    /// Rigid-body inertia about the world's origin per unit of each line inertia.
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

/// Force on each of the coordinates [`ENDS`] per newton of the tube's own weight, which is distributed along the
/// tube.
fn areas_per_n(tube: &PosedTube) -> [f64; 8] {
    let down = tube.frame.tr_mul(&-Vector3::z());
    let f = &tube.forms;
    // ∫ field · (force per length) is the translation row of the inertia form divided by the length.
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

/// The wrench and the inertia of everything outboard, as linear functions of the parts.
struct Outboard {
    fixed: Wrench,
    per_n: Vec<Wrench>,
    inertia: Vec<[Matrix6<f64>; INERTIAS]>,
}

impl Outboard {
    fn push(&mut self, per_n: Wrench, inertia: [Matrix6<f64>; INERTIAS]) {
        self.per_n.push(per_n);
        self.inertia.push(inertia);
    }

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

    /// The inertia of everything outboard about a joint's axis.
    fn inertia_row(&self, fixed: &Matrix6<f64>, twist: &Twist) -> InertiaRow {
        let about = |m: &Matrix6<f64>| twist.dot(&(m * twist)).max(0.0);
        InertiaRow {
            fixed: about(fixed),
            per_line: self.inertia.iter().map(|forms| std::array::from_fn(|k| about(&forms[k]))).collect(),
        }
    }

    /// The loads on the section of a tube at a point.
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
    fn largest(&self) -> f64 {
        self.per_n.iter().fold(self.fixed.abs(), |most, c| most.max(c.abs()))
    }
}

/// Mass of the harness along a tube \[kg\]. `None` without a harness.
pub(super) fn harness_kg(space: &DesignSpace, piece: &SpacePiece) -> Option<f64> {
    let link = match piece {
        SpacePiece::Joint(_) => return None,
        SpacePiece::Link(link) => space.link_piece(link),
        SpacePiece::Choice(choice) => space.link_piece(&choice.first_link()),
    };
    let mass_kg = link.harness_kg_per_m * link.vector_m.norm();
    (link.beam.is_some() && mass_kg > 0.0).then_some(mass_kg)
}
