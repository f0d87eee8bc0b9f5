//! The lowest natural frequency of the full model, without forming the mass matrix.
//!
//! The largest eigenvalue of `C^½ M C^½` is `1/ω₁²`. [`largest_eigenvalue`] finds it from products of this matrix with
//! vectors. A product with the mass matrix is two passes over the chain. In the outward pass, the rates of the strain
//! coordinates add up to the motion of every body and link. In the inward pass, the momenta of everything outboard add
//! up to the momentum of each coordinate. The time grows in proportion to the number of elements.

use super::chain::{ElasticElement, Item, Posed};
use super::krylov::largest_eigenvalue;
use super::linkage::LinkedCoordinates;
use super::statics::Statics;
use super::{Twist, Wrench};
use nalgebra::{DVector, Matrix6};
use std::f64::consts::TAU;

/// An arm in a pose as a product with its mass matrix.
struct MassProduct<'a> {
    stages: Vec<Stage<'a>>,
    /// The passive joints that linkages turn together with driving joints.
    linked: Vec<LinkedCoordinates>,
}

/// An elastic element, and the inertia of the bodies between it and the next element.
struct Stage<'a> {
    element: &'a ElasticElement,
    bodies: Matrix6<f64>,
}

impl Posed<'_> {
    /// The lowest natural frequency \[Hz\] of small vibrations about a static state. It is infinite if no compliant
    /// element moves a mass.
    pub fn lowest_frequency_hz(&self, statics: &Statics) -> f64 {
        let roots = statics.root_compliances();
        let mass = MassProduct::new(self);
        let inverse_square_s2 = largest_eigenvalue(roots.len(), |vector| {
            let rates = vector.component_mul(&roots);
            mass.momenta(&rates).component_mul(&roots)
        });
        1.0 / (inverse_square_s2.sqrt() * TAU)
    }
}

impl<'a> MassProduct<'a> {
    fn new(posed: &'a Posed) -> Self {
        let mut stages: Vec<Stage> = Vec::new();
        for item in &posed.items {
            match (item, stages.last_mut()) {
                (Item::Elastic(element), _) => stages.push(Stage { element, bodies: Matrix6::zeros() }),
                (Item::Body(body), Some(stage)) => stage.bodies += body.inertia(),
                // Bodies inboard of every element do not move.
                (Item::Body(_), None) | (Item::Load(_), _) => {}
            }
        }
        Self { stages, linked: posed.linked_coordinates() }
    }

    /// The mass matrix times `rates`: the momentum of each strain coordinate (elastic degree of freedom), base to tip,
    /// at these rates of the coordinates.
    fn momenta(&self, rates: &DVector<f64>) -> DVector<f64> {
        let rates = LinkedCoordinates::turned_along(&self.linked, rates);
        let mut momenta = DVector::zeros(rates.len());
        let wrenches = self.outward(&rates, &mut momenta);
        self.inward(&wrenches, &mut momenta);
        LinkedCoordinates::transferred(&self.linked, &momenta)
    }

    /// For each stage, the momentum of its link and the momentum of the bodies after it. The momentum that the link's
    /// own mass has in its strain coordinates is added to `momenta`.
    fn outward(&self, rates: &DVector<f64>, momenta: &mut DVector<f64>) -> Vec<[Wrench; 2]> {
        let mut motion = Twist::zeros();
        let mut start = 0;
        let passed = |stage: &Stage<'a>| {
            let count = stage.element.twists.len();
            let own_rates = rates.rows(start, count);
            let mut link = Wrench::zeros();
            if let Some(own) = &stage.element.own {
                link = own.rigid * motion + &own.coupling * own_rates;
                let mut of_link = momenta.rows_mut(start, count);
                of_link.gemv(1.0, &own.inner, &own_rates, 1.0);
                of_link.gemv_tr(1.0, &own.coupling, &motion, 1.0);
            }
            for (twist, rate) in stage.element.twists.iter().zip(own_rates.iter()) {
                motion += twist * *rate;
            }
            start += count;
            [link, stage.bodies * motion]
        };
        self.stages.iter().map(passed).collect()
    }

    /// Adds the momentum of everything outboard to `momenta`, the momentum of each strain coordinate. `wrenches` has
    /// two entries for each stage: the momentum of its link and the momentum of its bodies.
    fn inward(&self, wrenches: &[[Wrench; 2]], momenta: &mut DVector<f64>) {
        let mut outboard = Wrench::zeros();
        let mut end = momenta.len();
        for (stage, [link, bodies]) in self.stages.iter().zip(wrenches).rev() {
            outboard += bodies;
            let start = end - stage.element.twists.len();
            let of_element = momenta.rows_range_mut(start..end);
            for (momentum, twist) in of_element.into_iter().zip(&stage.element.twists) {
                *momentum += twist.dot(&outboard);
            }
            outboard += link;
            end = start;
        }
    }
}
