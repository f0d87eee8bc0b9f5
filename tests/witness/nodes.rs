//! How a node's six displacements follow from the model's unknowns.

use nalgebra::{SVector, Vector3, Vector6};

/// Displacement of a node, `(u, rotation)` in world axes, as a sum of columns times unknowns.
///
/// This is the master-slave transformation, a row block at a time: a free node has six unit columns, a node fixed to
/// another repeats its columns, carried along a lever; a joint adds one column.
#[derive(Clone, Debug, Default)]
pub struct NodeMap {
    pub columns: Vec<(usize, Vector6<f64>)>,
}

impl NodeMap {
    /// A node that cannot move.
    pub fn clamped() -> Self {
        Self::default()
    }

    /// A node with the six unknowns from `first_unknown` on to itself.
    pub fn free(first_unknown: usize) -> Self {
        let unit = |i: usize| (first_unknown + i, Vector6::ith(i, 1.0));
        Self { columns: (0..6).map(unit).collect() }
    }

    /// The node at the other end of a rigid lever: u' = u + rotation x lever.
    pub fn carried(&self, lever_m: &Vector3<f64>) -> Self {
        let carry = |column: &Vector6<f64>| {
            let rotation: Vector3<f64> = column.fixed_rows::<3>(3).into_owned();
            let translation = column.fixed_rows::<3>(0) + rotation.cross(lever_m);
            stacked(&translation, &rotation)
        };
        Self { columns: self.columns.iter().map(|(unknown, column)| (*unknown, carry(column))).collect() }
    }

    /// The coincident node beyond a hinge whose angle is this unknown.
    pub fn hinged(&self, unknown: usize, axis: &Vector3<f64>) -> Self {
        let mut columns = self.columns.clone();
        columns.push((unknown, stacked(&Vector3::zeros(), axis)));
        Self { columns }
    }

    /// Displacement for given unknowns.
    pub fn displacement(&self, unknowns: &[f64]) -> Vector6<f64> {
        self.columns.iter().map(|(unknown, column)| column * unknowns[*unknown]).sum()
    }
}

/// Columns of the displacements of two nodes, one above the other.
pub fn pair(first: &NodeMap, second: &NodeMap) -> Vec<(usize, SVector<f64, 12>)> {
    let placed = |column: &Vector6<f64>, row: usize| {
        let mut both = SVector::<f64, 12>::zeros();
        both.fixed_rows_mut::<6>(row).copy_from(column);
        both
    };
    let upper = first.columns.iter().map(|(unknown, column)| (*unknown, placed(column, 0)));
    let lower = second.columns.iter().map(|(unknown, column)| (*unknown, placed(column, 6)));
    upper.chain(lower).collect()
}

/// Two triples one above the other.
pub fn stacked(upper: &Vector3<f64>, lower: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(upper.x, upper.y, upper.z, lower.x, lower.y, lower.z)
}
