//! The angles of the driven joints in the pose of a sample (a measured position).
//!
//! A fit walks through all samples many times. The poses of all samples lie one after the other in one table, because the
//! processor then fetches a pose before it is asked for. Waiting for scattered poses took longer than placing the points.

use std::sync::Arc;

/// The angle of a driven joint, with its sine and cosine. These are computed once, because the geometry changes during a
/// fit and the poses do not.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turn {
    /// Angle \[rad\].
    pub rad: f64,
    pub sin: f64,
    pub cos: f64,
}

/// The angles of the driven joints in a pose: a part of a table.
#[derive(Debug, Clone)]
pub(crate) struct Pose {
    table: Arc<[Turn]>,
    first: usize,
    count: usize,
}

impl Pose {
    /// A pose with a table of its own.
    pub(crate) fn new(angles_rad: &[f64]) -> Self {
        Self { table: angles_rad.iter().map(turn).collect(), first: 0, count: angles_rad.len() }
    }

    /// Poses with a table that they share.
    pub(crate) fn all(poses_rad: &[Vec<f64>]) -> Vec<Self> {
        let table: Arc<[Turn]> = poses_rad.iter().flatten().map(turn).collect();
        let mut first = 0;
        let part = |count: usize| {
            let own = Self { table: Arc::clone(&table), first, count };
            first += count;
            own
        };
        poses_rad.iter().map(Vec::len).map(part).collect()
    }

    /// The driven joints.
    pub(crate) fn turns(&self) -> &[Turn] {
        &self.table[self.first..self.first + self.count]
    }

    /// The angles of the driven joints \[rad\].
    pub(crate) fn angles_rad(&self) -> Vec<f64> {
        self.turns().iter().map(|turn| turn.rad).collect()
    }
}

fn turn(rad: &f64) -> Turn {
    let (sin, cos) = libm::sincos(*rad);
    Turn { rad: *rad, sin, cos }
}
