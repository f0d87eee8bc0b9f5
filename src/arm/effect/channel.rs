//! Measuring channels: the kinds of reading that a campaign has, and how an instrument turns an actual value into a
//! reading.

use nalgebra::{Matrix3, Vector3};

/// A measuring channel: one kind of reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Channel {
    /// Displacement of the tip under load \[mm\].
    Static,
    /// Natural frequencies of the arm \[Hz\].
    Modal,
    /// Torsion of one joint under torque on a bench \[arcmin\].
    Windup,
    /// Absolute positions of points on the tool \[mm\].
    Positions,
}

impl Channel {
    /// Every channel.
    pub const ALL: [Channel; 4] = [Channel::Static, Channel::Modal, Channel::Windup, Channel::Positions];

    /// The word for the channel in files.
    pub fn word(self) -> &'static str {
        match self {
            Channel::Static => "static",
            Channel::Modal => "modal",
            Channel::Windup => "windup",
            Channel::Positions => "positions",
        }
    }

    /// The channel that a word in a file names; `None` if there is no such channel.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.word() == word)
    }

    /// Number of components of one reading of the channel.
    pub fn components(self) -> usize {
        match self {
            Channel::Static | Channel::Positions => 3,
            Channel::Modal | Channel::Windup => 1,
        }
    }
}

/// How a channel turns an actual value into a reading: `bent(factor x gain x value) + bias + drift x (row - 1)`, in the
/// unit of the channel's file. Rows are counted from 1. In a displacement the value is the component of `d + mix d`,
/// where d is the actual displacement. The nonlinearity is `bent(d) = d + bend[0] d |d| / s + bend[1] d³ / s²`, where s
/// is `bend_scale`.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Factor on the actual value of every component.
    pub factor: f64,
    /// Constant that is added to each component, in the unit of the channel's file. Channels with one component use the
    /// first number only.
    pub bias: [f64; 3],
    /// Change of the added constant from each row of the file to the next, in the unit of the channel's file.
    pub drift_per_row: [f64; 3],
    /// Numbers of the rows that are gross errors, counted from 1.
    pub outlier_rows: Vec<usize>,
    /// Further factor on the actual value of each component. Channels with one component use the first number only.
    pub gain: [f64; 3],
    /// Crosstalk between the directions, if the axes of the instrument are turned or not square. Row x has the
    /// fractions of the actual y and z displacement that the reading in x shows as well. Zero on the diagonal, and for
    /// channels with one component.
    pub mix: Matrix3<f64>,
    /// Coefficients of the nonlinearity. At a reading of `bend_scale`, each is the deviation from a straight line as a
    /// fraction of this reading.
    pub bend: [f64; 2],
    /// The reading at which `bend` is the relative deviation from a straight line, in the unit of the channel's file.
    pub bend_scale: f64,
}

impl Default for Reading {
    fn default() -> Self {
        Self {
            factor: 1.0,
            bias: [0.0; 3],
            drift_per_row: [0.0; 3],
            outlier_rows: Vec::new(),
            gain: [1.0; 3],
            mix: Matrix3::zeros(),
            bend: [0.0; 2],
            bend_scale: 1.0,
        }
    }
}

impl Reading {
    /// The displacement along the axes of the instrument. [`Reading::of`] then reads each of its components. `actual`
    /// is the actual displacement along the axes that the campaign states; the result is in the same unit.
    pub fn along_own_axes(&self, actual: &Vector3<f64>) -> Vector3<f64> {
        actual + self.mix * actual
    }

    /// The reading that the instrument shows for the value `truth` along its own axis. `component` (0 to 2) is the
    /// direction of a displacement, `row` is the row of the file, counted from 0.
    pub fn of(&self, truth: f64, component: usize, row: usize) -> f64 {
        let straight = self.factor * self.gain[component] * truth;
        let part = straight / self.bend_scale;
        let bent = straight * (self.bend[0] * part.abs() + self.bend[1] * part * part);
        straight + bent + self.bias[component] + self.drift_per_row[component] * row as f64
    }
}
