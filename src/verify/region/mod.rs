//! Region by region: proves that a front of a huge space lacks no design.
//!
//! A design that no row beats lies below some *local upper bound* of the front ([`upper_bounds`]): it is no heavier than the
//! bound, deflects no more and is no slower. So the verifier goes from bound to bound.
//!
//! A box takes every part at its lightest and at its stiffest at once, though a part is one or the other. Weighted sums over the
//! parts take mass, deflection and modes together ([`rows`]), and are much sharper. If the least sum of any member is more than
//! the upper bound allows, there is no member below it. If it is only close to that, options that cost more than what is left are
//! excluded ([`weights`], by reduced costs).
//!
//! The upper bounds are the leaves of a tree; the bound of a node covers those below it. At every node, from the root on, options
//! are excluded as long as that pays ([`search`]). If no option is left, or no member can be below the bound, that part
//! of the tree is done. Else its two halves are searched with the options left. Below a single bound the search branches: it
//! splits the options of a level, or a torque, in two ([`branch`]). Few designs are searched box by box.

pub(super) mod branch;
pub(super) mod matrix_game;
pub(super) mod parts_table;
pub(super) mod price;
pub(super) mod rows;
pub(super) mod search;
pub(super) mod subproblem;
pub(super) mod upper_bounds;
pub(super) mod weights;
