//! An independent witness: a 3-D finite-element model of an arm, written from textbooks and from the arm-file
//! contract alone.
//!
//! Nothing here uses the library. The unknowns are the absolute displacements of the nodes (three translations, three
//! rotations each, world axes) plus one angle a spring; a joint is a pair of coincident nodes whose other five relative
//! motions are eliminated exactly, a rigid link carries its inboard node's motion to its outboard node. So the
//! formulation shares no step with a compliance-element method, and agreement means something.
//!
//! ```text
//! let answer = witness::analyze(&arm_json, &load_case, &witness::Options::default());
//! answer.tip_displacement_m; answer.joint_torque_nm; answer.modes[0].frequency_hz;
//! ```
//!
//! Sources: J. S. Przemieniecki, Theory of Matrix Structural Analysis (1968), chapters 5 and 11 (Timoshenko
//! stiffness and consistent mass); G. R. Cowper, J. Appl. Mech. 33 (1966) 335 (shear factors); K.-J. Bathe, Finite
//! Element Procedures (1996), section 11.6 (subspace iteration).

// Test targets and examples compile this module for themselves, and none uses all of it.
#![allow(dead_code, unused_imports)]

mod arm;
mod beam;
pub mod closed_forms;
mod effects;
mod joint_law;
mod load_case;
mod model;
mod nodes;
pub mod paper;
mod section;
mod solve;

pub use effects::{Effects, Immersion, LostMotion};
pub use joint_law::ThreeSegment;
pub use load_case::{LoadCase, Payload};
pub use section::rectangle_in_torsion;
pub use solve::{Answer, Mode};

use nalgebra::Vector3;
use serde_json::Value;

/// Whether the links bend or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Links {
    /// Timoshenko beams: bending, shear, torsion, axial, rotary inertia.
    Flexible,
    /// Rigid bodies with the tubes' full mass and inertia.
    Rigid,
}

/// The shapes that spread an element's mass over its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MassShape {
    /// The same shapes as the stiffness: rotary inertia goes with the section's rotation, as it should.
    Timoshenko,
    /// Cubic shapes whose slope is taken for the section's rotation; in short stout links the rotary inertia comes out too
    /// large, however fine the mesh. Only to see what another program did.
    EulerBernoulli,
}

/// How an arm is to be modelled.
#[derive(Clone, Debug)]
pub struct Options {
    /// Whether the links bend.
    pub links: Links,
    /// Beam elements in each link with a section.
    pub elements_per_link: usize,
    /// How the elements' mass is spread.
    pub mass_shape: MassShape,
    /// The most modes to return; fewer when the model has fewer finite ones.
    pub modes: usize,
    /// Physics beyond the arm file's chain.
    pub effects: Effects,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            links: Links::Flexible,
            elements_per_link: 16,
            mass_shape: MassShape::Timoshenko,
            modes: 6,
            effects: Effects::default(),
        }
    }
}

impl Options {
    /// The default options with rigid links.
    pub fn rigid_links() -> Self {
        Self { links: Links::Rigid, ..Self::default() }
    }

    /// The same options asking for another number of modes.
    pub fn with_modes(self, modes: usize) -> Self {
        Self { modes, ..self }
    }

    /// The same options with these effects.
    pub fn with_effects(self, effects: Effects) -> Self {
        Self { effects, ..self }
    }
}

/// Statics and modes of the arm in one load case.
///
/// # Panics
/// On an arm file it cannot read, with what is wrong: a witness has no error handling, its test just fails.
pub fn analyze(arm_file: &Value, case: &LoadCase, options: &Options) -> Answer {
    let arm = effects::applied_to_arm(arm::Arm::from_json(arm_file), &options.effects);
    let case = effects::applied_to_case(case, &options.effects);
    solve::answer(&model::Model::new(&arm, &case, options, &|_| true), options.modes)
}

/// What each compliant element alone would move the tip by, all the others being rigid.
///
/// A serial arm is statically determinate, so these sum to the tip displacement. Bearing tilts are listed as
/// `bearing_tilt:<joint>` and the base as `base_compliance`.
pub fn shares(arm_file: &Value, case: &LoadCase, options: &Options) -> Vec<(String, Vector3<f64>)> {
    let arm = effects::applied_to_arm(arm::Arm::from_json(arm_file), &options.effects);
    let case = effects::applied_to_case(case, &options.effects);
    let whole = model::Model::new(&arm, &case, options, &|_| true);
    let share = |name: &String| {
        let alone = model::Model::new(&arm, &case, options, &|other| other == name);
        (name.clone(), solve::answer(&alone, 0).tip_displacement_m)
    };
    whole.compliant_elements().iter().map(share).collect()
}
