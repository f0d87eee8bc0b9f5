//! Region by region: proves that the front of a very large space lacks no design.
//!
//! A design that no design of the front dominates lies below some *local upper bound* of the front ([`upper_bounds`]).
//! *Below* means that its mass and its deflection are at most the values of the bound, and its lowest mode is at least
//! the value of the bound. So the verifier examines these bounds one after the other.
//!
//! The ideal point of a box takes each part at its lightest and at its stiffest at once, although no part is both.
//! Weighted sums over the parts combine mass, deflection and modes ([`rows`]) and are much sharper. If the least sum of
//! any member is more than the upper bound allows, no member is below the bound. Otherwise options that raise the least
//! sum by more than the difference are excluded ([`weights`]). This increase of the sum is the *reduced cost* of the
//! option.
//!
//! The upper bounds are the leaves of a tree; the bound of a node covers all bounds below it. At every node, from the
//! root on, options are excluded as long as each step excludes enough of them ([`search`]). If no option is left, or if
//! no member can be below the bound, this branch of the tree is done. Otherwise its two halves are searched with the
//! remaining options. Below a single bound the search branches: it divides the options of a level, or a torque, in two
//! ([`branch`]). When few designs are left, they are searched box by box.

pub(super) mod branch;
pub(super) mod matrix_game;
pub(super) mod parts_table;
pub(super) mod price;
pub(super) mod rows;
pub(super) mod search;
pub(super) mod subproblem;
pub(super) mod upper_bounds;
pub(super) mod weights;
