//! Modes: natural frequencies and shapes (Eqs 16-18 of docs/model.md). Motor shafts are locked. Damping and the
//! stiffness due to gravity are left out.
//!
//! The strain coordinates are the elastic degrees of freedom: torsions of joints and polynomials of the deformation of
//! links. Let `C` be their diagonal compliance matrix and `M` their mass matrix. The symmetric
//! matrix `A = C^½ M C^½` has the eigenvalues `1/ω²`. `M` may be singular, for example with a point mass on a roll
//! axis. One of these eigenvalues is then zero, and its mode is not returned.

use super::chain::{ElasticElement, Item, Posed};
use super::eigenpairs::Eigenpairs;
use super::statics::Statics;
use super::{Twist, displacement_at};
use nalgebra::{DMatrix, DVector, Matrix6, Matrix6xX, Vector3};
use std::f64::consts::TAU;

/// One natural mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// Natural frequency \[Hz\].
    pub frequency_hz: f64,
    /// `xz`, `xy` or `yz` if at least 99 % of the kinetic energy belongs to motion in this plane of the world, else
    /// `None`.
    pub plane: Option<&'static str>,
    /// Fraction of the strain energy in each element, with the element's name, base to tip. The sum of the
    /// fractions is 1.
    pub strain_energy: Vec<(String, f64)>,
    /// Displacement of the tip \[m\], with the mode scaled to a strain energy of ½ J.
    pub tip_shape_m: Vector3<f64>,
    /// Value of each strain coordinate, as one list for each element, base to tip, with the mode scaled to a strain
    /// energy of ½ J.
    pub coordinates: Vec<Vec<f64>>,
}

/// The modal solution of an arm in a pose: modes of the model, lowest first.
#[derive(Debug, Clone)]
pub struct Modes {
    /// `1/ω²` of each mode \[s²\], largest first. Modes without inertia are included, with the value zero.
    pub(crate) inverse_squares: Vec<f64>,
    /// Strain coordinates of each mode, one column for each mode, scaled to a strain energy of ½ J.
    pub(crate) shapes: DMatrix<f64>,
}

/// Relative threshold: a computed `1/ω²` that is smaller than this fraction of the largest one is taken as zero,
/// because it is then a zero with rounding errors.
const SINGULAR: f64 = 1e-13;
/// Fraction of the kinetic energy in one plane of the world above which a mode counts as planar.
const PLANAR: f64 = 0.99;

impl Posed<'_> {
    /// The `count` lowest modes of small vibrations about a static state, lowest first. There are fewer if fewer
    /// modes have inertia.
    ///
    /// The static torques decide at which slope of their torsion curves the joints vibrate. [`Chain`](super::Chain)
    /// has an example.
    pub fn modes(&self, statics: &Statics, count: usize) -> Vec<Mode> {
        let modes = self.lowest_modes(statics, count);
        // The lowest frequency comes from the function that computes it alone, so that its last digits are the same as
        // in a front. No other mode may then have a lower frequency.
        let lowest_hz = self.lowest_frequency_hz(statics);
        let frequency = |k: usize, hz: f64| if k == 0 { lowest_hz } else { hz.max(lowest_hz) };
        modes
            .finite()
            .map(|(k, hz)| self.describe(statics, &modes.shapes.column(k).into_owned(), frequency(k, hz)))
            .collect()
    }

    /// All modes of small vibrations about a static state, from the eigenvalue problem in flexibility form
    /// `C^½ M C^½ ψ = ψ/ω²`.
    pub fn solve_modes(&self, statics: &Statics) -> Modes {
        self.lowest_modes(statics, usize::MAX)
    }

    /// The `count` lowest modes, or all if there are fewer.
    fn lowest_modes(&self, statics: &Statics, count: usize) -> Modes {
        let (a, roots) = self.flexibility_form(statics);
        let Eigenpairs { values, vectors } = Eigenpairs::largest(a, count);
        let mut shapes = DMatrix::zeros(roots.len(), vectors.len());
        for (k, vector) in vectors.iter().enumerate() {
            shapes.set_column(k, &vector.component_mul(&roots));
        }
        Modes { inverse_squares: values.iter().map(|value| value.max(0.0)).collect(), shapes }
    }

    /// The matrix `C^½ M C^½`, and the diagonal of `C^½`. `C` has the tangent compliances of the static state, `M` is
    /// the mass matrix.
    fn flexibility_form(&self, statics: &Statics) -> (DMatrix<f64>, DVector<f64>) {
        let roots = statics.root_compliances();
        let mut a = self.mass_matrix();
        for (mut column, root) in a.column_iter_mut().zip(roots.iter()) {
            column.component_mul_assign(&roots);
            column *= *root;
        }
        (a, roots)
    }

    /// The elastic elements, base to tip.
    pub fn elements(&self) -> impl Iterator<Item = &ElasticElement> {
        self.items.iter().filter_map(|item| match item {
            Item::Elastic(element) => Some(element),
            Item::Body(_) | Item::Load(_) => None,
        })
    }

    /// Mass matrix over all strain coordinates, base to tip. An entry for two elements is computed from the inertia of
    /// everything outboard of the outer element and the twists (motions per unit) of both.
    pub fn mass_matrix(&self) -> DMatrix<f64> {
        let twists: Vec<Twist> = self.elements().flat_map(|e| e.twists.iter().copied()).collect();
        let mut mass = DMatrix::zeros(twists.len(), twists.len());
        let mut outboard = Matrix6::zeros();
        let mut end = twists.len();
        for item in self.items.iter().rev() {
            match item {
                Item::Body(body) => outboard += body.inertia(),
                Item::Load(_) => {}
                Item::Elastic(element) => {
                    let start = end - element.twists.len();
                    add_element(&mut mass, element, &outboard, start, &twists);
                    end = start;
                    if let Some(own) = &element.own {
                        outboard += own.rigid;
                    }
                }
            }
        }
        self.with_linkages(mass)
    }

    /// The mode of this frequency in the form for output. `shape` has its strain coordinates.
    fn describe(&self, statics: &Statics, shape: &DVector<f64>, frequency_hz: f64) -> Mode {
        Mode {
            frequency_hz,
            plane: self.plane(shape),
            strain_energy: self.strain_energy(statics, shape),
            tip_shape_m: self.tip_motion(shape),
            coordinates: self.by_element(shape),
        }
    }

    /// The strain coordinates `shape` of all elements, divided into one list for each element, base to tip.
    fn by_element(&self, shape: &DVector<f64>) -> Vec<Vec<f64>> {
        let mut rest = shape.iter().copied();
        self.elements().map(|e| rest.by_ref().take(e.twists.len()).collect()).collect()
    }

    /// Displacement of the tip when the strain coordinates have the values of `shape` \[m\].
    pub(crate) fn tip_motion(&self, shape: &DVector<f64>) -> Vector3<f64> {
        let motion: Twist = self.tip_twists().iter().zip(shape.iter()).map(|(t, q)| t * *q).sum();
        displacement_at(&motion, &self.tip_m)
    }

    /// Fraction of the strain energy of a mode in each element, base to tip. `shape` has the strain coordinates q of
    /// the mode. The energy of an element is proportional to the sum of `q²/c` over its coordinates with their
    /// compliances c.
    fn strain_energy(&self, statics: &Statics, shape: &DVector<f64>) -> Vec<(String, f64)> {
        let mut coordinate = shape.iter();
        let mut parts: Vec<(String, f64)> = self
            .elements()
            .zip(&statics.tangent_compliances)
            .map(|(element, compliances)| {
                let energy = compliances
                    .iter()
                    .zip(coordinate.by_ref())
                    .filter(|(c, _)| **c > 0.0)
                    .map(|(c, q)| q * q / c)
                    .sum();
                (element.name.clone(), energy)
            })
            .collect();
        let total: f64 = parts.iter().map(|(_, e)| e).sum();
        parts.iter_mut().for_each(|(_, e)| *e /= total);
        parts
    }

    /// The plane of the world in which a mode moves, given its strain coordinates `shape`. `None` if less than 99 % of
    /// its kinetic energy is in one plane.
    fn plane(&self, shape: &DVector<f64>) -> Option<&'static str> {
        const PLANES: [(&str, usize); 3] = [("xz", 1), ("xy", 2), ("yz", 0)];
        let mut energy = PlaneEnergy::default();
        let mut motion = Twist::zeros();
        let shape = self.with_passive(shape);
        let mut coordinate = shape.iter();
        for item in &self.items {
            match item {
                Item::Body(body) => energy.add_body(body, &motion),
                Item::Load(_) => {}
                Item::Elastic(element) => {
                    let rates: Vec<f64> = coordinate.by_ref().take(element.twists.len()).copied().collect();
                    if let Some(own) = &element.own {
                        energy.add_link(self, own, &motion, &rates);
                    }
                    motion += element.twists.iter().zip(&rates).map(|(t, q)| t * *q).sum::<Twist>();
                }
            }
        }
        // A motion along one axis lies in two planes. The plane with more energy of rotation is taken, or the first
        // plane if both have the same.
        let fractions = PLANES.map(|(name, normal)| (name, energy.fraction(normal)));
        let most = fractions.iter().map(|(_, f)| *f).fold(0.0, f64::max);
        fractions.iter().find(|(_, f)| *f >= PLANAR && *f >= most - 1e-9).map(|(name, _)| *name)
    }
}

impl Modes {
    /// Index and frequency \[Hz\] of each mode that has inertia, lowest first.
    pub fn finite(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let floor = SINGULAR * self.inverse_squares.first().copied().unwrap_or(0.0);
        self.inverse_squares
            .iter()
            .enumerate()
            .take_while(move |(_, mu)| **mu > floor)
            .map(|(k, mu)| (k, 1.0 / (mu.sqrt() * TAU)))
    }
}

/// Fills in the rows and columns of the mass matrix that belong to an element. `outboard` is the inertia of everything
/// outboard of it, `start` the index of its first coordinate, and `twists` are the motions per unit of the coordinates
/// inboard of it.
fn add_element(
    mass: &mut DMatrix<f64>,
    element: &ElasticElement,
    outboard: &Matrix6<f64>,
    start: usize,
    twists: &[Twist],
) {
    let n = element.twists.len();
    let mut momentum = Matrix6xX::zeros(n);
    for (mut column, twist) in momentum.column_iter_mut().zip(&element.twists) {
        column.copy_from(&(outboard * twist));
    }
    for (j, i) in (0..n).flat_map(|j| (0..=j).map(move |i| (j, i))) {
        let inner = element.own.as_ref().map_or(0.0, |own| own.inner[(i, j)]);
        let entry = element.twists[i].dot(&momentum.column(j)) + inner;
        mass[(start + i, start + j)] = entry;
        mass[(start + j, start + i)] = entry;
    }
    // The own mass of a link also moves with the elements inboard of it. Between the link's own coordinates, its
    // inertia is in `inner`.
    if let Some(own) = &element.own {
        momentum += &own.coupling;
    }
    for (j, i) in (0..n).flat_map(|j| (0..start).map(move |i| (j, i))) {
        let entry = twists[i].dot(&momentum.column(j));
        mass[(i, start + j)] = entry;
        mass[(start + j, i)] = entry;
    }
}

/// Twice the kinetic energy of a vibration at unit angular frequency: in total, and of the motion in the plane normal
/// to each world axis.
#[derive(Default)]
struct PlaneEnergy {
    total: f64,
    within: [f64; 3],
}

/// The two parts of the motion of a section.
#[derive(Clone, Copy)]
enum Part {
    Translation,
    Rotation,
}

impl PlaneEnergy {
    /// Adds twice the kinetic energy of a rigid body that makes the motion `motion`.
    fn add_body(&mut self, body: &super::chain::Body, motion: &Twist) {
        let velocity = displacement_at(motion, &body.cg_m);
        let spin = super::angular(motion);
        let spin_momentum = body.inertia_kgm2 * spin;
        self.total += body.mass_kg * velocity.norm_squared() + spin.dot(&spin_momentum);
        for (normal, within) in self.within.iter_mut().enumerate() {
            let across = velocity[normal];
            *within += body.mass_kg * (velocity.norm_squared() - across * across)
                + body.inertia_kgm2[(normal, normal)] * spin[normal] * spin[normal];
        }
    }

    /// Adds twice the kinetic energy of a link, integrated over its Gauss points. `motion` is the motion of the link as
    /// a rigid body, `rates` are the rates of its strain coordinates.
    fn add_link(&mut self, posed: &Posed, own: &super::chain::OwnMass, motion: &Twist, rates: &[f64]) {
        let Some(beam) = posed.chain.beam(own.piece) else { return };
        let turn = own.frame.transpose();
        let root = turn * displacement_at(motion, &own.root_m);
        let spin = turn * super::angular(motion);
        let mut local = DVector::zeros(6 + rates.len());
        local.fixed_rows_mut::<3>(0).copy_from(&root);
        local.fixed_rows_mut::<3>(3).copy_from(&spin);
        local.rows_mut(6, rates.len()).copy_from_slice(rates);
        let [along, across, _, polar, rotary_y, rotary_z] = beam.line_densities();
        for (xi, weight) in beam.quadrature() {
            let rate = beam.fields(xi) * &local;
            let velocity = rate.fixed_rows::<3>(0).into_owned();
            let spin = rate.fixed_rows::<3>(3).into_owned();
            self.add_line(
                &own.frame,
                &velocity,
                &Vector3::new(along, across, across),
                weight,
                Part::Translation,
            );
            self.add_line(
                &own.frame,
                &spin,
                &Vector3::new(polar, rotary_y, rotary_z),
                weight,
                Part::Rotation,
            );
        }
    }

    /// Adds twice the kinetic energy at one Gauss point of a link: the energy of its translation or of its rotation.
    /// `rate` is the velocity in the section frame `frame`, `density` the mass or inertia per
    /// length. A rotation counts as motion in a plane if it is about the normal of the plane.
    fn add_line(
        &mut self,
        frame: &nalgebra::Matrix3<f64>,
        rate: &Vector3<f64>,
        density: &Vector3<f64>,
        weight: f64,
        part: Part,
    ) {
        let energy = |r: &Vector3<f64>| weight * density.component_mul(r).dot(r);
        self.total += energy(rate);
        for (normal, within) in self.within.iter_mut().enumerate() {
            let n = frame.row(normal).transpose();
            let about = n * n.dot(rate);
            *within += match part {
                Part::Translation => energy(&(rate - about)),
                Part::Rotation => energy(&about),
            };
        }
    }

    /// Fraction of the kinetic energy that belongs to motion in the plane with this normal (0, 1, 2 for x, y, z).
    fn fraction(&self, normal: usize) -> f64 {
        self.within[normal] / self.total
    }
}
