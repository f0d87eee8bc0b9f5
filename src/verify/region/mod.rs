//! Region by region: a front of a huge space is proved whole below one upper bound of what it leaves open after the other.
//!
//! Boxes take every part at its lightest and at its stiffest at once. A part is one or the other, and sums over the parts
//! that score mass, deflection and modes against each other know it ([`rows`]). Below a upper bound few options are of
//! any use: a weighting whose least over all members is close to what the upper bound allows excludes every option that costs
//! more than what is left ([`score`], reduced costs).
//!
//! The upper bounds ([`upper bounds`]) are the leaves of a tree, and a node's upper bound bounds those below. From the root on, at every
//! node, the options are narrowed as long as that pays. If none is left, or if a weighting refutes that any member is below
//! the upper bound, that part of the tree is done; else its two halves are looked at with the options left. Below a single
//! upper bound the options of a level, or a torque, are branched in two ([`part`]). What has few designs left is searched box by box.

pub(super) mod branch;
pub(super) mod matrix_game;
pub(super) mod parts_table;
pub(super) mod price;
pub(super) mod rows;
pub(super) mod search;
pub(super) mod subproblem;
pub(super) mod upper_bounds;
pub(super) mod weights;
