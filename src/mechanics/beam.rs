//! Beams: a link that deforms, described by strain coordinates.
//!
//! Let `ξ = x/L` run from 0 to 1 along the link. Each strain (curvature in both planes, shear in both planes, twist
//! rate and axial strain) is a sum of Legendre polynomials `P_i(2ξ-1)`. The coefficients are the strain coordinates.
//! Slopes and displacements are the integrals of the strains from the clamped root. Legendre polynomials are
//! orthogonal, so the stiffness matrix is diagonal. Only the lowest polynomials move the end of the link: `P_0` and
//! `P_1` of curvature, and `P_0` of the other strains. The others are inner shapes: they deform the link while its end
//! stays in place.
//!
//! | strain | number of coordinates | compliance of the i-th | motion of the link at ξ per unit |
//! |---|---|---|---|
//! | curvature | 4 a plane | `(2i+1)/(E I L)` | deflection `L² ∬P_i`, slope `L ∫P_i` |
//! | shear | 3 a plane | `(2i+1)/(κ G A L)` | deflection `L ∫P_i` |
//! | twist | 3 | `(2i+1)/(G J L)` | rotation `L ∫P_i` |
//! | stretch | 3 | `(2i+1)/(E A L)` | displacement `L ∫P_i` |
//!
//! A sum of these shapes can represent the exact deflection under an end force, an end moment and a uniform load (Eqs
//! 1-4 of docs/model.md and their Timoshenko counterparts). Statics are therefore exact. Natural frequencies converge
//! from above. The inertia matrix does not depend on the stiffness, so frequencies rise with every stiffness and fall
//! with every mass. The exact search relies on this.

use super::{Wrench, body_inertia, force_wrench, stack};
use crate::arm::LinkModel;
use crate::arm::body::RigidBody;
use crate::arm::springs::EndLoad;
use crate::arm::structure::{Beam, LinkPiece, Structure};
use nalgebra::{DMatrix, Matrix3, Matrix3xX, Matrix6xX, SMatrix, Vector3};

/// Number of polynomials of curvature in each plane.
pub(crate) const CURVATURES: usize = 4;
/// Number of polynomials of shear in each plane, of twist and of stretch.
pub(crate) const OTHERS: usize = 3;
/// Points (0 to 1) and weights of Gauss-Legendre quadrature over the length of a link. With eight points it is exact
/// for polynomials up to degree 15; the integrands here have degree 10 at most.
const GAUSS: [(f64, f64); 8] = [
    (0.019_855_071_751_231_9, 0.050_614_268_145_188_1),
    (0.101_666_761_293_186_6, 0.111_190_517_226_687_2),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_6),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_6),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_2),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_1),
];

/// The kind of strain that one coordinate describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strain {
    /// Curvature that moves the link along the z axis of its section.
    CurvatureZ,
    /// Curvature that moves the link along the y axis of its section.
    CurvatureY,
    /// Shear that moves the link along the z axis of its section.
    ShearZ,
    /// Shear that moves the link along the y axis of its section.
    ShearY,
    /// Torsion about the axis of the link.
    Twist,
    /// Extension along the axis of the link.
    Stretch,
}

/// Mass and rotary inertia of a link per metre of its length.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct LineInertia {
    /// Mass per length for motion along the link \[kg/m\].
    pub along_kg_per_m: f64,
    /// Mass per length for motion at right angles to the link \[kg/m\]. It includes the added mass of water.
    pub across_kg_per_m: f64,
    /// Rotary inertia per length about the axis of the link \[kg m\].
    pub polar_kg_m: f64,
    /// Rotary inertia per length about the y axis of the section \[kg m\].
    pub rotary_y_kg_m: f64,
    /// Rotary inertia per length about the z axis of the section \[kg m\].
    pub rotary_z_kg_m: f64,
}

impl LineInertia {
    /// Mass and rotary inertia per length, one number for each component of motion in the section frame: displacement
    /// along x, y, z \[kg/m\], rotation about x, y, z \[kg m\].
    fn densities(&self) -> [f64; 6] {
        [
            self.along_kg_per_m,
            self.across_kg_per_m,
            self.across_kg_per_m,
            self.polar_kg_m,
            self.rotary_y_kg_m,
            self.rotary_z_kg_m,
        ]
    }
}

/// Weight of the rigid bodies that are mounted on a link, as loads in the section frame of the link. It does not depend
/// on the pose.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CarriedWeight {
    /// Work of the weight per unit of each strain coordinate (columns) if gravity acts along x, y or z (rows)
    /// \[N m per unit\].
    pub fields: Matrix3xX<f64>,
    /// Sum of the weights \[N\].
    pub weight_n: f64,
    /// Sum over the bodies of weight times position of the centre of gravity, measured from the root of the link \[N
    /// m\].
    pub moment_nm: Vector3<f64>,
}

impl Default for CarriedWeight {
    fn default() -> Self {
        Self { fields: Matrix3xX::zeros(0), weight_n: 0.0, moment_nm: Vector3::zeros() }
    }
}

/// A link prepared for any pose: its stiffness, mass and displacement fields, none of which depends on the pose.
#[derive(Debug, Clone)]
pub(crate) struct PreparedBeam {
    /// Length of the link \[m\].
    pub length_m: f64,
    /// Axes of the section (columns x, y, z), in the carried frame of the link: the frame that turns with the joints
    /// inboard of it.
    pub frame: Matrix3<f64>,
    /// Compliance of each strain coordinate: the coordinate per unit of its generalized force.
    pub compliances: Vec<f64>,
    /// Displacement (rows 0-2) and rotation (rows 3-5) of the end of the link per unit of each strain coordinate, in
    /// the section frame.
    pub end_fields: Matrix6xX<f64>,
    /// Displacement integrated over the length of the link, per unit of each strain coordinate, in the section frame
    /// \[m² per unit\].
    pub area_fields: Matrix3xX<f64>,
    /// Inertia matrix over translation of the root (0-2), rotation of the root (3-5) and strain coordinates (from 6),
    /// in the section frame.
    pub inertia: DMatrix<f64>,
    /// Weight minus buoyancy per length \[N/m\].
    pub weight_n_per_m: f64,
    /// Weight of the rigid bodies that are mounted on the link.
    pub bodies: CarriedWeight,
    coordinates: Vec<(Strain, usize)>,
    line: LineInertia,
}

impl PreparedBeam {
    /// Prepares the link of a structure for the link model `model`. Returns `None` if the link has no length, or if it
    /// is a rigid offset without a harness along it.
    pub(crate) fn new(link: &LinkPiece, structure: &Structure, model: LinkModel) -> Option<Self> {
        let length_m = link.vector_m.norm();
        if length_m == 0.0 || (link.beam.is_none() && link.harness_kg_per_m == 0.0) {
            return None;
        }
        let stiffness = link.beam.map_or_else(Vec::new, |beam| coordinates(&beam, length_m, model));
        let line = line_inertia(link, structure, model);
        let mut beam = Self {
            length_m,
            frame: section_frame(&link.vector_m),
            compliances: stiffness.iter().map(|(_, _, c)| *c).collect(),
            end_fields: Matrix6xX::zeros(0),
            area_fields: Matrix3xX::zeros(0),
            inertia: DMatrix::zeros(0, 0),
            weight_n_per_m: weight_n_per_m(link, structure),
            bodies: CarriedWeight::default(),
            coordinates: stiffness.iter().map(|(s, i, _)| (*s, *i)).collect(),
            line,
        };
        beam.end_fields = beam.fields(1.0).columns_range(6..).into_owned();
        beam.integrate();
        if link.beam.is_some() {
            link.bodies.iter().for_each(|body| beam.add_body(body, structure.gravity_m_s2));
        }
        Some(beam)
    }

    /// Displacement (rows 0-2) and rotation (rows 3-5) of the point at `xi` (0 to 1), in the section frame, per unit
    /// of root translation (columns 0-2), root rotation (columns 3-5) and each strain coordinate (columns from 6).
    pub(crate) fn fields(&self, xi: f64) -> Matrix6xX<f64> {
        let mut out = Matrix6xX::zeros(6 + self.coordinates.len());
        out.fill_with_identity();
        let x = xi * self.length_m;
        // A positive rotation of the root about y moves the point along -z. A positive rotation about z moves it along
        // +y.
        out[(2, 4)] = -x;
        out[(1, 5)] = x;
        for (column, &(strain, degree)) in self.coordinates.iter().enumerate() {
            let (slope, deflection) = shape(degree, xi, self.length_m);
            let mut field = out.column_mut(6 + column);
            match strain {
                Strain::CurvatureZ => (field[2], field[4]) = (deflection, -slope),
                Strain::CurvatureY => (field[1], field[5]) = (deflection, slope),
                Strain::ShearZ => field[2] = slope,
                Strain::ShearY => field[1] = slope,
                Strain::Twist => field[3] = slope,
                Strain::Stretch => field[0] = slope,
            }
        }
        out
    }

    /// Mass and rotary inertia per length of this link, one number for each component of motion in the section frame:
    /// displacement along x, y, z \[kg/m\], rotation about x, y, z \[kg m\].
    pub(crate) fn line_densities(&self) -> [f64; 6] {
        self.line.densities()
    }

    /// The Gauss points of the link (0 at its root, 1 at its end), each with its weight times the length of the link
    /// \[m\].
    pub(crate) fn quadrature(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        GAUSS.iter().map(|&(xi, weight)| (xi, weight * self.length_m))
    }

    /// Weight of the link and of the bodies on it, as a wrench about the world's origin. The root is at `root_m`
    /// \[m\], `frame` is the section frame in the world, and `down` is the unit vector of gravity.
    pub(crate) fn weight(&self, root_m: &Vector3<f64>, frame: &Matrix3<f64>, down: &Vector3<f64>) -> Wrench {
        let middle_m = root_m + frame.column(0) * (self.length_m / 2.0);
        let tube = force_wrench(&(*down * (self.weight_n_per_m * self.length_m)), &middle_m);
        let CarriedWeight { weight_n, moment_nm, .. } = &self.bodies;
        let moment_nm = (root_m * *weight_n + frame * moment_nm).cross(down);
        tube + stack(&(*down * *weight_n), &moment_nm)
    }

    /// Adds inertia and weight of a rigid body to the link. The body moves with the point of the axis that is nearest
    /// to its centre of gravity.
    fn add_body(&mut self, body: &RigidBody, gravity_m_s2: f64) {
        self.inertia += self.inertia_of(body);
        let weight_n = body.mass_kg * gravity_m_s2;
        self.bodies.fields += weight_n * self.centre_fields(body).columns_range(6..);
        self.bodies.weight_n += weight_n;
        self.bodies.moment_nm += weight_n * (self.frame.transpose() * body.cg_m);
    }

    /// Inertia matrix of a body on the link, over root translation, root rotation and strain coordinates, in the
    /// section frame.
    pub(crate) fn inertia_of(&self, body: &RigidBody) -> DMatrix<f64> {
        let turn = self.frame.transpose();
        let (fields, arm_m) = self.carrier(body);
        let about_point = body_inertia(body.mass_kg, &arm_m, &(turn * body.inertia_kgm2 * self.frame));
        let weighted = about_point * &fields;
        DMatrix::from_fn(fields.ncols(), fields.ncols(), |i, j| fields.column(i).dot(&weighted.column(j)))
    }

    /// Displacement of the centre of gravity of a body on the link, per unit of root translation, root rotation and
    /// each strain coordinate, in the section frame.
    pub(crate) fn centre_fields(&self, body: &RigidBody) -> Matrix3xX<f64> {
        let (fields, arm_m) = self.carrier(body);
        let turned = arm_m.cross_matrix() * fields.fixed_rows::<3>(3);
        fields.fixed_rows::<3>(0) - turned
    }

    /// The point of the axis with which a body on the link moves. The result is the displacement fields at this point
    /// ([`Self::fields`]), and the vector from the point to the centre of gravity of the body \[m\], in the section
    /// frame.
    pub(crate) fn carrier(&self, body: &RigidBody) -> (Matrix6xX<f64>, Vector3<f64>) {
        let cg_m = self.frame.transpose() * body.cg_m;
        let xi = (cg_m.x / self.length_m).clamp(0.0, 1.0);
        (self.fields(xi), cg_m - Vector3::x() * (xi * self.length_m))
    }

    /// Computes the inertia matrix and the area fields of the link by quadrature over its length.
    fn integrate(&mut self) {
        let n = 6 + self.coordinates.len();
        let densities = self.line_densities();
        let mut inertia = DMatrix::zeros(n, n);
        let mut areas = Matrix3xX::zeros(n - 6);
        for (xi, weight) in self.quadrature() {
            let fields = self.fields(xi);
            areas += weight * fields.columns_range(6..).fixed_rows::<3>(0);
            let weighted =
                SMatrix::<f64, 6, 6>::from_diagonal(&(weight * nalgebra::Vector6::from(densities)));
            inertia += fields.transpose() * (weighted * &fields);
        }
        self.inertia = inertia;
        self.area_fields = areas;
        self.bodies.fields = Matrix3xX::zeros(n - 6);
    }
}

/// The point of the axis of a link at which a spring acts (0 at the root, 1 at the end), and the spring's force and
/// moment about this point in the section frame. The root of the link is at `root_m` \[m\], `frame` is the section
/// frame in the world, and `load` is the force of the spring in the world.
pub(crate) fn pull_on(
    length_m: f64,
    root_m: &Vector3<f64>,
    frame: &Matrix3<f64>,
    load: &EndLoad,
) -> (f64, Wrench) {
    let at_m = frame.tr_mul(&(load.at_m - root_m));
    let xi = (at_m.x / length_m).clamp(0.0, 1.0);
    let arm_m = at_m - Vector3::x() * (xi * length_m);
    let force_n = frame.tr_mul(&load.force_n);
    (xi, stack(&force_n, &(frame.tr_mul(&load.moment_nm) + arm_m.cross(&force_n))))
}

/// Slope `L ∫P_i` and deflection `L² ∬P_i` of a link at `xi` (0 to 1), if its curvature is the Legendre polynomial
/// `P_i` of this degree. Both are integrated from the root, where they are zero. The integrals follow from `(2i+1) ∫P_i
/// = P_(i+1) - P_(i-1)` over `s = 2ξ-1`, with dξ = ds/2.
fn shape(degree: usize, xi: f64, length_m: f64) -> (f64, f64) {
    let s = 2.0 * xi - 1.0;
    let integral = |i: usize| match i {
        0 => (1.0 + s) / 2.0,
        _ => (legendre(i + 1, s) - legendre(i - 1, s)) / (2.0 * (2 * i + 1) as f64),
    };
    let deflection = match degree {
        0 => xi * xi / 2.0,
        1 => (integral(2) - integral(0)) / 6.0,
        i => (integral(i + 1) - integral(i - 1)) / (2.0 * (2 * i + 1) as f64),
    };
    (length_m * integral(degree), length_m * length_m * deflection)
}

/// Legendre polynomial of this degree at `s` (-1 to 1), by the three-term recurrence.
fn legendre(degree: usize, s: f64) -> f64 {
    let (mut before, mut here) = (0.0, 1.0);
    for i in 0..degree {
        let next = ((2 * i + 1) as f64 * s * here - i as f64 * before) / (i + 1) as f64;
        (before, here) = (here, next);
    }
    here
}

/// A link counts as being along the z axis if the cosine of the angle between them is above this number.
pub(crate) const ALONG_COSINE: f64 = 0.99;

/// The section frame (columns x, y, z) of a link along `vector_m`, in the frame in which this vector is given. The x
/// axis is along the link. The z axis is as near as possible to the z axis of the given frame.
pub(crate) fn section_frame(vector_m: &Vector3<f64>) -> Matrix3<f64> {
    let x = vector_m.normalize();
    // The z axis of the given frame cannot be used for a link along z (or nearly so). The x axis takes its place.
    let up = if x.z.abs() > ALONG_COSINE { Vector3::x() } else { Vector3::z() };
    let z = (up - x * x.dot(&up)).normalize();
    Matrix3::from_columns(&[x, z.cross(&x), z])
}

/// Compliance of each strain coordinate of a link: the squared coordinate divided by twice the strain energy. The order
/// is the order of [`PreparedBeam::compliances`]. Empty for a rigid link.
pub(crate) fn compliances(link: &LinkPiece, model: LinkModel) -> Vec<f64> {
    let length_m = link.vector_m.norm();
    let coordinates = link.beam.map_or_else(Vec::new, |beam| coordinates(&beam, length_m, model));
    coordinates.into_iter().map(|(_, _, compliance)| compliance).collect()
}

/// Kind of strain and degree of the polynomial of each strain coordinate, in the order of
/// [`PreparedBeam::compliances`].
pub(crate) fn strains(link: &LinkPiece, model: LinkModel) -> Vec<(Strain, usize)> {
    let coordinates = link.beam.map_or_else(Vec::new, |beam| coordinates(&beam, 1.0, model));
    coordinates.into_iter().map(|(strain, degree, _)| (strain, degree)).collect()
}

/// Mass and rotary inertia per length of a link, one number for each component of displacement and rotation, as in
/// [`PreparedBeam::line_densities`].
pub(crate) fn line_densities(link: &LinkPiece, structure: &Structure, model: LinkModel) -> [f64; 6] {
    line_inertia(link, structure, model).densities()
}

/// Stiffnesses of a tube per unit of strain: `E I` about y and about z \[N m²\], `κ G A` \[N\], `G J` \[N m²\] and
/// `E A` \[N\].
pub(crate) fn line_stiffnesses(beam: &Beam) -> [f64; 5] {
    let material = &beam.material;
    let section = beam.section.properties(material.poisson);
    let (e, g) = (material.youngs_modulus_pa, material.shear_modulus_pa);
    [
        e * section.second_moment_y_m4,
        e * section.second_moment_z_m4,
        section.shear_factor * g * section.area_m2,
        g * section.torsion_constant_m4,
        e * section.area_m2,
    ]
}

/// The strain coordinates that a tube has in the link model `model`: kind of strain, degree of the polynomial, and
/// compliance.
fn coordinates(beam: &Beam, length_m: f64, model: LinkModel) -> Vec<(Strain, usize, f64)> {
    let [bending_y, bending_z, shear, torsion, stretch] = line_stiffnesses(beam);
    let bending = [(Strain::CurvatureZ, CURVATURES, bending_y), (Strain::CurvatureY, CURVATURES, bending_z)];
    let rest = [
        (Strain::ShearZ, OTHERS, shear),
        (Strain::ShearY, OTHERS, shear),
        (Strain::Twist, OTHERS, torsion),
        (Strain::Stretch, OTHERS, stretch),
    ];
    let strains = match model {
        LinkModel::Rigid => vec![],
        LinkModel::Bending => bending.to_vec(),
        LinkModel::Full => [bending.as_slice(), rest.as_slice()].concat(),
    };
    strains
        .into_iter()
        .flat_map(|(strain, count, stiffness)| {
            (0..count)
                .map(move |i| (strain, i, beam.flexibility * (2 * i + 1) as f64 / (stiffness * length_m)))
        })
        .collect()
}

/// Mass and rotary inertia per length of a link, including its harness and the added mass of the water around it. In
/// the link model `bending`, the rotary inertia about axes at right angles to the link is zero.
fn line_inertia(link: &LinkPiece, structure: &Structure, model: LinkModel) -> LineInertia {
    let Some(beam) = link.beam else {
        return LineInertia {
            along_kg_per_m: link.harness_kg_per_m,
            across_kg_per_m: link.harness_kg_per_m,
            ..LineInertia::default()
        };
    };
    let tube = tube_inertia(&beam, model);
    let along = tube.along_kg_per_m + link.harness_kg_per_m;
    let section = beam.section.properties(beam.material.poisson);
    let added =
        structure.water.map_or(0.0, |w| w.added_mass_coefficient * w.density_kg_m3 * section.outer_area_m2);
    LineInertia { along_kg_per_m: along, across_kg_per_m: along + added, ..tube }
}

/// Mass and rotary inertia per length of a tube alone: without harness and without added mass of water.
pub(crate) fn tube_inertia(beam: &Beam, model: LinkModel) -> LineInertia {
    let section = beam.section.properties(beam.material.poisson);
    let density = beam.material.density_kg_m3;
    let mass = density * section.area_m2;
    // Euler-Bernoulli theory neglects the rotary inertia about axes at right angles to the beam. The rotary inertia
    // about the axis of the beam stays.
    let across = if model == LinkModel::Bending { 0.0 } else { density };
    LineInertia {
        along_kg_per_m: mass,
        across_kg_per_m: mass,
        polar_kg_m: density * (section.second_moment_y_m4 + section.second_moment_z_m4),
        rotary_y_kg_m: across * section.second_moment_y_m4,
        rotary_z_kg_m: across * section.second_moment_z_m4,
    }
}

/// Weight of tube and harness minus the buoyancy of the sealed tube, per length \[N/m\].
fn weight_n_per_m(link: &LinkPiece, structure: &Structure) -> f64 {
    let water = structure.water.map_or(0.0, |w| w.density_kg_m3);
    let displaced =
        link.beam.map_or(0.0, |beam| water * beam.section.properties(beam.material.poisson).outer_area_m2);
    structure.gravity_m_s2 * (link.tube_kg_per_m() + link.harness_kg_per_m - displaced)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_lowest_shapes_move_the_end() {
        assert_eq!(shape(0, 1.0, 2.0), (2.0, 2.0));
        assert_eq!(shape(1, 1.0, 1.0), (0.0, -1.0 / 6.0));
        assert_eq!(shape(2, 1.0, 1.0), (0.0, 0.0));
        assert_eq!(shape(3, 1.0, 1.0), (0.0, 0.0));
    }

    #[test]
    fn shapes_are_integrals_of_legendre_polynomials() {
        let step = 1e-4;
        for degree in 0..CURVATURES {
            for xi in [0.1, 0.35, 0.8] {
                let (slope, _) = shape(degree, xi, 1.0);
                let (_, ahead) = shape(degree, xi + step, 1.0);
                let (_, behind) = shape(degree, xi - step, 1.0);
                let (_, here) = shape(degree, xi, 1.0);
                assert!(((ahead - behind) / (2.0 * step) - slope).abs() < 1e-7, "slope {degree}");
                let curvature = (ahead - 2.0 * here + behind) / (step * step);
                assert!((curvature - legendre(degree, 2.0 * xi - 1.0)).abs() < 1e-5, "curvature {degree}");
            }
        }
    }

    #[test]
    fn a_vertical_link_takes_its_section_frame_from_the_carried_x_axis() {
        let frame = section_frame(&Vector3::new(0.0, 0.0, 0.5));
        assert_eq!(frame.column(2).into_owned(), Vector3::x());
        assert_eq!(frame.column(1).into_owned(), Vector3::x().cross(&Vector3::z()));
    }
}
