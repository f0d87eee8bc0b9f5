//! A slow, separately written search: every design of a study, one after the other, judged by the finite-element
//! witness, and the front by comparing all pairs.
//!
//! Nothing here uses the library. The study is read from the same JSON, the catalogs from the same CSV files, and the
//! joints are sized from the definitions of Eqs 7-12 alone:
//!
//! | quantity | definition |
//! |---|---|
//! | static torque T | moment of gravity, payload and tip force about the axis, in each sizing pose |
//! | speed, acceleration | w = v / r, alpha = w / t_a; r the tip's largest distance from the axis, not below `min_lever_m` |
//! | linear torque L | inertia of everything outboard about the axis, exact, times alpha |
//! | peak, emergency stop | T + L; T + f L with f = stop deceleration over v / t_a, 2 unless stated |
//! | mean torque | cubic mean by time and speed over: ramp t_a (T + L, half speed), 3 t_a (T), ramp (T - L, half speed) |
//! | mean speed | 0.4 of the full one: 5 t_a of rest complete the cycle |
//! | life | L_ref (T_rated / T_mean)^3 (2000 rpm / n_mean), L_ref = 7000 h for HFUC and CSF, 10 000 h for CSG and SHG |
//! | motor | T / (N eta) held; (T + L) / (N eta) + J_in N alpha for the ramp; N w reached |
//!
//! A drive must hold the largest T of all sizing poses together with the largest L of all, though no one pose may have
//! both: the arm passes between its poses.

pub mod arm;
pub mod bearing;
pub mod catalog;
pub mod demand;
pub mod design;
pub mod drive;
pub mod fit;
pub mod front;
pub mod program;
pub mod stress;
pub mod study;
