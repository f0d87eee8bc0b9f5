//! A lower bound on the mass of every design that deflects no more and vibrates no lower than is asked.
//!
//! Each piece of the arm is allowed to be a mixture of its catalog options (weights that sum to one). In the
//! weights, mass is linear; tip deflection has linear lower bounds (`statics`: loads at their least, plus
//! McCormick's envelope of load times compliance); what a drive must hold is linear; and a required lowest
//! mode is `K - ω² M ⪰ 0` with `K` and `M` linear, of which each trial shape `x` gives one linear
//! inequality (`shapes`). The lightest mixture is a linear program; it is solved by Clarabel
//! (`program`), and the bound that is returned is the Lagrangian one at the solver's multipliers, which is
//! valid for any multipliers, so that nothing rests on the solver's tolerance. Options that cannot belong
//! to a design as good and as light as the one at hand are dropped, which narrows the loads and tightens
//! the bound, until nothing changes. Every step is proved in `docs/relaxation.md`.

pub(crate) mod drives;
pub(crate) mod parts;
pub(crate) mod program;
pub(crate) mod relaxation;
pub(crate) mod row;
pub(crate) mod shapes;
pub(crate) mod slopes;
pub(crate) mod statics;

pub use relaxation::{MassBound, Relaxation};
