//! A Timoshenko beam element: stiffness, consistent mass, consistent load.
//!
//! Local unknowns: u, v, w, rx, ry, rz of the first node, then of the second; x along the beam. The shear parameter of a
//! plane is `phi = 12 EI / (k G A l^2)`. Przemieniecki (1968), chapters 5 and 11, the bending part of the
//! mass split into what the line mass and what the rotary inertia contribute, because added mass of water has no
//! rotary part.

use nalgebra::{Matrix3, Matrix4, SMatrix, Vector3};

use super::MassShape;
use super::arm::{LineLoad, Tube};
use super::nodes::stacked;

/// A matrix between the twelve displacements of two nodes.
pub type Matrix12 = SMatrix<f64, 12, 12>;

/// Properties of a beam per length.
#[derive(Clone, Copy, Debug, Default)]
pub struct BeamLine {
    pub axial_stiffness_n: f64,
    pub bending_y_nm2: f64,
    pub bending_z_nm2: f64,
    pub torsion_nm2: f64,
    pub shear_n: f64,
    pub axial_mass_kg_per_m: f64,
    pub transverse_mass_kg_per_m: f64,
    /// Density times inertia_y: rotary inertia about y.
    pub rotary_y_kgm: f64,
    pub rotary_z_kgm: f64,
    /// What weighs, per length.
    pub weighing_kg_per_m: f64,
}

impl BeamLine {
    pub fn new(tube: Option<&Tube>, line: &LineLoad) -> Self {
        let mut beam = tube.map(Self::of_tube).unwrap_or_default();
        beam.axial_mass_kg_per_m += line.mass_kg_per_m;
        beam.transverse_mass_kg_per_m += line.mass_kg_per_m + line.added_mass_kg_per_m;
        beam.weighing_kg_per_m += line.mass_kg_per_m - line.displaced_kg_per_m;
        beam
    }

    fn of_tube(tube: &Tube) -> Self {
        let section = &tube.section;
        let mass_kg_per_m = tube.density_kg_m3 * section.area_m2;
        Self {
            axial_stiffness_n: tube.youngs_modulus_pa * section.area_m2,
            bending_y_nm2: tube.youngs_modulus_pa * section.inertia_y_m4,
            bending_z_nm2: tube.youngs_modulus_pa * section.inertia_z_m4,
            torsion_nm2: tube.shear_modulus_pa * section.torsion_m4,
            shear_n: section.shear_factor * tube.shear_modulus_pa * section.area_m2,
            axial_mass_kg_per_m: mass_kg_per_m,
            transverse_mass_kg_per_m: mass_kg_per_m,
            rotary_y_kgm: tube.density_kg_m3 * section.inertia_y_m4,
            rotary_z_kgm: tube.density_kg_m3 * section.inertia_z_m4,
            weighing_kg_per_m: mass_kg_per_m,
        }
    }

    /// Rotary inertia about x, per length.
    pub fn polar_kgm(&self) -> f64 {
        self.rotary_y_kgm + self.rotary_z_kgm
    }

    /// Element stiffness in local axes.
    pub fn stiffness(&self, length_m: f64) -> Matrix12 {
        let bar = Matrix2Bar { diagonal: 1.0, off_diagonal: -1.0 };
        let mut k = Matrix12::zeros();
        bar.add_to(&mut k, 0, self.axial_stiffness_n / length_m);
        bar.add_to(&mut k, 3, self.torsion_nm2 / length_m);
        XY.add_to(&mut k, &self.bending_stiffness(self.bending_z_nm2, length_m));
        XZ.add_to(&mut k, &self.bending_stiffness(self.bending_y_nm2, length_m));
        k
    }

    /// Consistent element mass in local axes.
    pub fn mass(&self, length_m: f64, shape: MassShape) -> Matrix12 {
        let bar = Matrix2Bar { diagonal: 1.0 / 3.0, off_diagonal: 1.0 / 6.0 };
        let mut m = Matrix12::zeros();
        bar.add_to(&mut m, 0, self.axial_mass_kg_per_m * length_m);
        bar.add_to(&mut m, 3, self.polar_kgm() * length_m);
        XY.add_to(
            &mut m,
            &self.bending_mass(
                self.shape_parameter(shape, self.bending_z_nm2, length_m),
                self.rotary_z_kgm,
                length_m,
            ),
        );
        XZ.add_to(
            &mut m,
            &self.bending_mass(
                self.shape_parameter(shape, self.bending_y_nm2, length_m),
                self.rotary_y_kgm,
                length_m,
            ),
        );
        m
    }

    /// Mass matrix of a rigid length about its middle, in local axes.
    pub fn rigid_mass(&self, length_m: f64) -> nalgebra::Matrix6<f64> {
        let (axial_kg, transverse_kg) =
            (self.axial_mass_kg_per_m * length_m, self.transverse_mass_kg_per_m * length_m);
        let slender_kgm2 = transverse_kg * length_m.powi(2) / 12.0;
        let translation = Vector3::new(axial_kg, transverse_kg, transverse_kg);
        let rotation = Vector3::new(
            self.polar_kgm() * length_m,
            slender_kgm2 + self.rotary_y_kgm * length_m,
            slender_kgm2 + self.rotary_z_kgm * length_m,
        );
        nalgebra::Matrix6::from_diagonal(&stacked(&translation, &rotation))
    }

    fn shear_parameter(&self, bending_nm2: f64, length_m: f64) -> f64 {
        12.0 * bending_nm2 / (self.shear_n * length_m.powi(2))
    }

    fn bending_stiffness(&self, bending_nm2: f64, length_m: f64) -> Matrix4<f64> {
        let phi = self.shear_parameter(bending_nm2, length_m);
        let l = length_m;
        let (near, far) = ((4.0 + phi) * l * l, (2.0 - phi) * l * l);
        #[rustfmt::skip]
        let shape = Matrix4::new(
            12.0,     6.0 * l, -12.0,     6.0 * l,
            6.0 * l,  near,    -6.0 * l,  far,
            -12.0,   -6.0 * l,  12.0,    -6.0 * l,
            6.0 * l,  far,     -6.0 * l,  near,
        );
        shape * (bending_nm2 / ((1.0 + phi) * l.powi(3)))
    }

    fn shape_parameter(&self, shape: MassShape, bending_nm2: f64, length_m: f64) -> f64 {
        match shape {
            MassShape::Timoshenko => self.shear_parameter(bending_nm2, length_m),
            MassShape::EulerBernoulli => 0.0,
        }
    }

    fn bending_mass(&self, phi: f64, rotary_kgm: f64, length_m: f64) -> Matrix4<f64> {
        let line_kg = self.transverse_mass_kg_per_m * length_m / (1.0 + phi).powi(2);
        let rotary_kg = rotary_kgm / length_m / (1.0 + phi).powi(2);
        line_mass_shape(phi, length_m) * line_kg + rotary_mass_shape(phi, length_m) * rotary_kg
    }
}

fn line_mass_shape(phi: f64, l: f64) -> Matrix4<f64> {
    let p2 = phi * phi;
    let a = 13.0 / 35.0 + 7.0 * phi / 10.0 + p2 / 3.0;
    let b = (11.0 / 210.0 + 11.0 * phi / 120.0 + p2 / 24.0) * l;
    let c = 9.0 / 70.0 + 3.0 * phi / 10.0 + p2 / 6.0;
    let d = (13.0 / 420.0 + 3.0 * phi / 40.0 + p2 / 24.0) * l;
    let e = (1.0 / 105.0 + phi / 60.0 + p2 / 120.0) * l * l;
    let f = (1.0 / 140.0 + phi / 60.0 + p2 / 120.0) * l * l;
    #[rustfmt::skip]
    let shape = Matrix4::new(
         a,  b,  c, -d,
         b,  e,  d, -f,
         c,  d,  a, -b,
        -d, -f, -b,  e,
    );
    shape
}

fn rotary_mass_shape(phi: f64, l: f64) -> Matrix4<f64> {
    let p2 = phi * phi;
    let a = 6.0 / 5.0;
    let b = (1.0 / 10.0 - phi / 2.0) * l;
    let e = (2.0 / 15.0 + phi / 6.0 + p2 / 3.0) * l * l;
    let f = (1.0 / 30.0 + phi / 6.0 - p2 / 6.0) * l * l;
    #[rustfmt::skip]
    let shape = Matrix4::new(
         a,  b, -a,  b,
         b,  e, -b, -f,
        -a, -b,  a, -b,
         b, -f, -b,  e,
    );
    shape
}

/// A two-node bar, the same for stretching and for twisting.
struct Matrix2Bar {
    diagonal: f64,
    off_diagonal: f64,
}

impl Matrix2Bar {
    fn add_to(&self, matrix: &mut Matrix12, first: usize, scale: f64) {
        let second = first + 6;
        matrix[(first, first)] += scale * self.diagonal;
        matrix[(second, second)] += scale * self.diagonal;
        matrix[(first, second)] += scale * self.off_diagonal;
        matrix[(second, first)] += scale * self.off_diagonal;
    }
}

/// Where a plane's deflections and slopes stand among the twelve, and the sign of the slope's rotation.
struct Plane {
    rows: [usize; 4],
    signs: [f64; 4],
}

/// dv/dx = rz.
const XY: Plane = Plane { rows: [1, 5, 7, 11], signs: [1.0; 4] };
/// dw/dx = -ry.
const XZ: Plane = Plane { rows: [2, 4, 8, 10], signs: [1.0, -1.0, 1.0, -1.0] };

impl Plane {
    fn add_to(&self, matrix: &mut Matrix12, block: &Matrix4<f64>) {
        for i in 0..4 {
            for j in 0..4 {
                matrix[(self.rows[i], self.rows[j])] += self.signs[i] * self.signs[j] * block[(i, j)];
            }
        }
    }
}

/// A local matrix in world axes; the columns of `axes` are the local axes.
pub fn in_world_axes(local: &Matrix12, axes: &Matrix3<f64>) -> Matrix12 {
    let mut turn = Matrix12::zeros();
    for block in 0..4 {
        turn.fixed_view_mut::<3, 3>(3 * block, 3 * block).copy_from(axes);
    }
    turn * local * turn.transpose()
}
