//! Torsion of rectangles, hollow and solid, and of I sections, after Saint-Venant.
//!
//! | symbol | formula | source |
//! |---|---|---|
//! | `J` thin tube | `2 t (b-t)² (h-t)² / ((b-t)+(h-t))` | Bredt, thin closed wall |
//! | `τ/M` thin tube | `1 / (2 t (b-t)(h-t))` | Bredt: the mean over the wall |
//! | `J` thick tube | `Bredt + c (2/3) t³ ((b-t)+(h-t))` | term of the open section; `c` gives the bar at full wall |
//! | `J` bar | `h b³ (1/3 - (64/π⁵)(b/h) Σ tanh(nπh/2b)/n⁵)`, n odd, b ≤ h | Saint-Venant's series |
//! | `J` I, web t ≤ flange T | `2 J_bar(b, T) + (h-2T) t³/3 + 2 t² T² (0.21 + 0.085 t/T)` | flanges, clear web and junctions |
//! | `J` I, web t > flange T | `J_bar(h, t) + 4 (c T³/3 - 0.105 T⁴ + 0.2 t T³)`, c = (b-t)/2 | web over the whole height, outstands |
//! | `τ J/M` bar | `b (1 - (8/π²) Σ 1/(n² cosh(nπh/2b)))`, n odd, b ≤ h | the same series, middle of the long side |
//!
//! Bredt's formula is used up to a wall of 0.15 of the smaller side. At this wall its `J` is 9.0 % too low for a square
//! tube, and less for any other. For thicker walls the added term is faded in while the wall grows by a thirtieth,
//! because a step of `J` would disturb derivatives with respect to the wall. From a wall of 0.155 on, `J` is within 7.0
//! % of the exact solution up to the solid bar (sides 1:1 to 1:4), and it never falls as the wall grows. Bredt's shear
//! stress is the mean over the wall; at the outside of a wall of 0.15 the stress is up to 29 % higher.
//!
//! The two numbers 0.21 and 0.085 of the junctions of an I section, and the 0.2 of its outstands, are fitted to
//! Prandtl's stress function on a grid, for sharp inner edges; both formulas agree at t = T within 2e-5. `J` is within
//! 1.3 % of the grid if the flanges stand out by at least their thickness and the clear web is at least as high as it
//! is thick. For flanges that stand out by half their thickness it is up to 5.5 % too large. The usual sum `(2 b T³ +
//! (h-T) t³)/3` counts the junctions twice and has no free ends: it is 4 % too large for 100 x 200 x 6 x 10 mm and 7 %
//! for 60 x 80 x 20 x 20 mm. A rolled section has more, by the fillets that are left out here.

use std::f64::consts::PI;

/// Ratio of wall to smaller side up to which the wall is taken as thin.
const THIN_WALL_RATIO: f64 = 0.15;
/// Ratio of wall to smaller side from which on the term of the open section is added in full.
const THICK_WALL_RATIO: f64 = 0.155;

/// Torsional properties of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Torsion {
    /// Torsion constant J \[m⁴\].
    pub constant_m4: f64,
    /// Largest shear stress divided by the torque \[1/m³\].
    pub shear_per_m3: f64,
}

/// Torsional properties of a rectangular tube, thick or thin, with outer sides b, h \[m\] and wall t \[m\].
pub(super) fn tube(b: f64, h: f64, t: f64) -> Torsion {
    let thin = Torsion { constant_m4: bredt(b, h, t), shear_per_m3: 1.0 / (2.0 * (b - t) * (h - t) * t) };
    let side = b.min(h);
    let share = ((t / side - THIN_WALL_RATIO) / (THICK_WALL_RATIO - THIN_WALL_RATIO)).min(1.0);
    if share <= 0.0 {
        return thin;
    }
    let closed = side / 2.0;
    let (bar, bar_shear_m) = (bar_constant(b, h), bar_shear_m(b, h));
    let scale = (bar - bredt(b, h, closed)) / open(b, h, closed);
    let constant_m4 = thin.constant_m4 + share * scale * open(b, h, t);
    // at the outside of the wall the shear stress is Bredt's stress plus the stress of the open section; the latter is
    // proportional to the wall thickness
    let bend = (bar_shear_m - bredt_shear_m(b, h, closed)) / closed;
    let shear_m = bredt_shear_m(b, h, t) + share * bend * t;
    Torsion { constant_m4, shear_per_m3: shear_m / constant_m4 }
}

/// Torsional properties of a solid bar of sides b, h \[m\].
pub(super) fn bar(b: f64, h: f64) -> Torsion {
    let constant_m4 = bar_constant(b, h);
    Torsion { constant_m4, shear_per_m3: bar_shear_m(b, h) / constant_m4 }
}

/// Torsion constant `J` \[m⁴\] of an I section with sharp edges, of the width b, the height h and the thicknesses of
/// web and flanges \[m\].
pub(super) fn i_constant(b: f64, h: f64, web: f64, flange: f64) -> f64 {
    let sum = if web <= flange {
        let junction = web.powi(2) * flange.powi(2) * (0.21 + 0.085 * web / flange);
        2.0 * (bar_constant(b, flange) + junction) + (h - 2.0 * flange) * web.powi(3) / 3.0
    } else {
        let free_end = 0.105 * flange.powi(4);
        let outstand = (b - web) / 2.0 * flange.powi(3) / 3.0 - free_end + 0.2 * web * flange.powi(3);
        bar_constant(h, web) + 4.0 * outstand
    };
    // an I section is not stiffer in torsion than the solid bar of the same outline
    sum.min(bar_constant(b, h))
}

/// Torsion constant `J` \[m⁴\] of a thin closed wall by Bredt's formula, with the outer sides b, h and the wall t
/// \[m\].
fn bredt(b: f64, h: f64, t: f64) -> f64 {
    let (bm, hm) = (b - t, h - t);
    2.0 * t * bm * bm * hm * hm / (bm + hm)
}

/// Largest shear stress in a thin closed wall, divided by the shear modulus and by the twist angle per length \[m\].
fn bredt_shear_m(b: f64, h: f64, t: f64) -> f64 {
    let (bm, hm) = (b - t, h - t);
    bm * hm / (bm + hm)
}

/// Torsion constant `J` \[m⁴\] of the wall of a tube that is cut open lengthwise, with the outer sides b, h and the
/// wall t \[m\].
fn open(b: f64, h: f64, t: f64) -> f64 {
    2.0 / 3.0 * t.powi(3) * ((b - t) + (h - t))
}

/// Sum of n⁻⁵ over the odd numbers n from 1 on, which is 31/32 ζ(5) with Riemann's zeta function ζ.
const ODD_FIFTH_POWERS: f64 = 1.004_523_762_795_139_5;
const ODD_ORDERS: [f64; 5] = [1.0, 3.0, 5.0, 7.0, 9.0];

/// Torsion constant `J` \[m⁴\] of a solid bar with the sides b, h \[m\]. In Saint-Venant's series each tanh is written
/// as `1 - (1 - tanh)`. The sum of n⁻⁵ is a known constant, and the sum of `(1 - tanh) n⁻⁵` converges after a few
/// terms.
fn bar_constant(b: f64, h: f64) -> f64 {
    let (b, h) = (b.min(h), b.max(h));
    let rest: f64 = ODD_ORDERS.iter().map(|n| 2.0 / (n.powi(5) * (libm::exp(n * PI * h / b) + 1.0))).sum();
    h * b.powi(3) * (1.0 / 3.0 - 64.0 / PI.powi(5) * b / h * (ODD_FIFTH_POWERS - rest))
}

/// Largest shear stress of a solid bar of sides b, h \[m\], divided by the shear modulus and by the twist angle per
/// length \[m\].
fn bar_shear_m(b: f64, h: f64) -> f64 {
    let (b, h) = (b.min(h), b.max(h));
    let series: f64 = ODD_ORDERS.iter().map(|n| 1.0 / (n * n * libm::cosh(n * PI * h / (2.0 * b)))).sum();
    b * (1.0 - 8.0 / PI.powi(2) * series)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    #[test]
    fn a_thin_wall_twists_by_bredt_to_the_last_bit() {
        for (b, h, t) in [(0.16, 0.16, 0.01), (0.04, 0.1, 0.002), (0.1, 0.04, 0.0059)] {
            let (bm, hm): (f64, f64) = (b - t, h - t);
            let thin = tube(b, h, t);
            assert_eq!(thin.constant_m4, 2.0 * t * bm * bm * hm * hm / (bm + hm));
            assert_eq!(thin.shear_per_m3, 1.0 / (2.0 * bm * hm * t));
        }
    }

    /// Timoshenko and Goodier, Theory of Elasticity, table of k1 and k2: J = k1 h b³, largest shear stress M/(k2 h b²).
    #[test]
    fn a_solid_bar_has_the_coefficients_of_the_textbook() {
        let table = [(1.0, 0.1406, 0.208), (1.5, 0.196, 0.231), (2.0, 0.229, 0.246), (4.0, 0.281, 0.282)];
        for (h, k1, k2) in table {
            let solid = bar(h, 1.0);
            assert!((solid.constant_m4 / (k1 * h) - 1.0).abs() < 3e-3, "{h}: {solid:?}");
            assert!((solid.shear_per_m3 * k2 * h - 1.0).abs() < 3e-3, "{h}: {solid:?}");
        }
    }

    #[test]
    fn the_torsion_constant_rises_with_the_wall_without_a_step_until_the_tube_is_a_bar() {
        for h in [1.0, 1.1, 1.5, 2.0, 4.0, 10.0] {
            let steps = 20_000;
            let constants: Vec<f64> = (1..=steps)
                .map(|i| tube(h, 1.0, 0.5 * f64::from(i) / f64::from(steps)).constant_m4)
                .collect();
            for (i, pair) in constants.windows(2).enumerate() {
                let growth = pair[1] / pair[0] - 1.0;
                assert!(growth > 0.0, "{h}: falls after step {i}");
                // in the first steps the wall doubles from step to step, so J grows faster there
                assert!(i < 1000 || growth < 1.1e-3, "{h}: jumps by {growth} after step {i}");
            }
            assert!((constants[steps as usize - 1] / bar(h, 1.0).constant_m4 - 1.0).abs() < 1e-12, "{h}");
        }
    }

    /// Compares with Prandtl's stress function by finite differences: within 8 % for thick walls, and within the
    /// known error of Bredt's formula for thin walls.
    #[test]
    fn thick_walls_are_within_8_percent_of_saint_venant() {
        for aspect in [1, 2, 4] {
            for (cells, tolerance) in [(3, 0.095), (4, 0.08), (5, 0.08), (6, 0.08), (8, 0.08), (10, 0.02)] {
                // twenty cells over the smaller side: walls of 0.15, 0.2, 0.25, 0.3, 0.4 and 0.5
                let exact = saint_venant(20, 20 * aspect, cells);
                let ours = tube(1.0, aspect as f64, cells as f64 / 20.0).constant_m4;
                assert!(
                    (ours / exact - 1.0).abs() < tolerance,
                    "1:{aspect}, {cells}: {ours} against {exact}"
                );
            }
        }
    }

    /// `J` of a tube whose smaller side is 1. It is computed on a grid of `b` x `h` cells with a wall of `t` cells
    /// and on a grid twice as fine, and extrapolated. The stress function is constant over the hollow, which is
    /// therefore one unknown.
    fn saint_venant(b: usize, h: usize, t: usize) -> f64 {
        let [coarse, fine] =
            [1, 2].map(|n| stress_function_volume(n * b, n * h, n * t) / (n * b).pow(4) as f64);
        // the re-entrant edges of the hollow limit the order of convergence to 4/3
        fine + (fine - coarse) / (libm::pow(2f64, 4.0 / 3.0) - 1.0)
    }

    /// Twice the volume under the stress function of a section, whose sides and wall are given as numbers of unit
    /// cells. By symmetry only a quarter of the section is solved.
    fn stress_function_volume(b: usize, h: usize, t: usize) -> f64 {
        let (half_b, half_h) = (b / 2, h / 2);
        let (hole_b, hole_h) = (half_b - t, half_h - t);
        // all nodes of the hollow share the first unknown; the stress function is zero at the nodes of the outline
        let unknown = |i: usize, j: usize| match (i == half_b || j == half_h, i <= hole_b && j <= hole_h) {
            (true, _) => None,
            (_, true) if hole_b > 0 => Some(0),
            _ => Some(1 + i * half_h + j),
        };
        let width = |k: usize| if k == 0 { 0.5 } else { 1.0 };
        let mut edges = Vec::new();
        let mut load = DVector::zeros(1 + half_b * half_h);
        for (i, j) in (0..half_b).flat_map(|i| (0..half_h).map(move |j| (i, j))) {
            let Some(here) = unknown(i, j) else { continue };
            load[here] += 2.0 * width(i) * width(j);
            edges.push((here, unknown(i + 1, j), width(j)));
            edges.push((here, unknown(i, j + 1), width(i)));
        }
        4.0 * load.dot(&conjugate_gradients(&edges, &load))
    }

    /// Compares with Prandtl's stress function by finite differences. The sides are given in cells of the coarse grid.
    #[test]
    fn an_i_section_is_within_2_percent_of_saint_venant() {
        let of = |[b, h, web, flange]: [usize; 4]| {
            let [coarse, fine] = [1, 2]
                .map(|n| i_stress_function_volume([b * n, h * n, web * n, flange * n]) / (n as f64).powi(4));
            // the re-entrant edges limit the order of convergence to 4/3
            let exact = fine + (fine - coarse) / (libm::pow(2f64, 4.0 / 3.0) - 1.0);
            let [b, h, web, flange] = [b, h, web, flange].map(|cells| cells as f64);
            let double = (2.0 * b * flange.powi(3) + (h - flange) * web.powi(3)) / 3.0;
            [i_constant(b, h, web, flange) / exact - 1.0, double / exact - 1.0]
        };
        // sides in cells: sections of 100 x 200 x 6 x 10 mm and 60 x 80 x 20 x 20 mm, a thick web, a thin web, the
        // shortest outstands and webs
        let sections = [
            [100, 200, 6, 10],
            [36, 48, 12, 12],
            [68, 96, 20, 8],
            [100, 100, 10, 20],
            [34, 34, 14, 10],
            [36, 36, 20, 8],
            [48, 48, 8, 20],
        ];
        for section in sections {
            let [ours, double] = of(section);
            assert!(ours.abs() < 0.02, "{section:?}: {ours}");
            assert!(double > ours && double > 0.02, "{section:?}: {double}");
        }
        let narrow = of([40, 60, 20, 20])[0];
        assert!((0.0..0.055).contains(&narrow), "outstands of half the thickness: {narrow}");
        assert_eq!(i_constant(3.0, 5.0, 3.0, 1.0), bar(3.0, 5.0).constant_m4, "a web as wide as the flanges");
        let at_equal = [0.999_999, 1.000_001].map(|web| i_constant(6.0, 8.0, web, 1.0));
        assert!((at_equal[1] / at_equal[0] - 1.0).abs() < 1e-4, "{at_equal:?}");
    }

    /// Twice the volume under the stress function of an I section whose width, height, web and flange are given in unit
    /// cells. By symmetry only a quarter is solved.
    fn i_stress_function_volume([b, h, web, flange]: [usize; 4]) -> f64 {
        let (half_b, half_h) = (b / 2, h / 2);
        let unknown = |i: usize, j: usize| {
            let is_inside = i < half_b && j < half_h && (i < web / 2 || j > half_h - flange);
            is_inside.then_some(i * half_h + j)
        };
        let width = |k: usize| if k == 0 { 0.5 } else { 1.0 };
        let mut edges = Vec::new();
        let mut load = DVector::zeros(half_b * half_h);
        for (i, j) in (0..half_b).flat_map(|i| (0..half_h).map(move |j| (i, j))) {
            let Some(here) = unknown(i, j) else { continue };
            load[here] += 2.0 * width(i) * width(j);
            edges.push((here, unknown(i + 1, j), width(j)));
            edges.push((here, unknown(i, j + 1), width(i)));
            // a node of the outline is not visited by this loop, because it has no unknown; so its inner neighbour adds
            // the edge between the two
            let outline = [(i.checked_sub(1), Some(j), width(j)), (Some(i), j.checked_sub(1), width(i))];
            for (i, j, stiffness) in outline {
                if i.zip(j).is_some_and(|(i, j)| unknown(i, j).is_none()) {
                    edges.push((here, None, stiffness));
                }
            }
        }
        4.0 * load.dot(&conjugate_gradients(&edges, &load))
    }

    /// The displacements of the nodes of a network of springs under the forces `load` on them, by the method of
    /// conjugate gradients. Each item of `edges` has the two nodes that a spring connects and its stiffness. A spring
    /// without a second node is fixed to the ground.
    fn conjugate_gradients(edges: &[(usize, Option<usize>, f64)], load: &DVector<f64>) -> DVector<f64> {
        let times = |x: &DVector<f64>| {
            let mut out = DVector::zeros(x.len());
            for &(from, to, stiffness) in edges {
                let force = stiffness * (x[from] - to.map_or(0.0, |to| x[to]));
                out[from] += force;
                if let Some(to) = to {
                    out[to] -= force;
                }
            }
            out
        };
        let mut x = DVector::zeros(load.len());
        let (mut rest, mut along) = (load.clone(), load.clone());
        while rest.norm() > 1e-9 * load.norm() {
            let force = times(&along);
            let (before, step) = (rest.norm_squared(), rest.norm_squared() / along.dot(&force));
            x.axpy(step, &along, 1.0);
            rest.axpy(-step, &force, 1.0);
            along = &rest + along * (rest.norm_squared() / before);
        }
        x
    }
}
