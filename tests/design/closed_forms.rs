//! The witness against closed forms, and the paper's Eqs 16-18 against their printed and corrected numbers.

use crate::witness::closed_forms::{self, StoutBeam};
use crate::witness::paper::PaperArm;
use crate::witness::{self, LoadCase, MassShape, Options, Payload};
use serde_json::{Value, json};

const E_PA: f64 = 2.1e11;
const G_PA: f64 = 8.1e10;
const DENSITY_KG_M3: f64 = 7850.0;

/// A box section and what the closed forms want of it.
struct Box {
    length_m: f64,
    outer_m: f64,
    wall_m: f64,
}

impl Box {
    const STOUT: Self = Self { length_m: 0.8, outer_m: 0.16, wall_m: 0.01 };
    const SLENDER: Self = Self { length_m: 2.0, outer_m: 0.01, wall_m: 0.001 };

    fn area_m2(&self) -> f64 {
        self.outer_m.powi(2) - (self.outer_m - 2.0 * self.wall_m).powi(2)
    }

    fn inertia_m4(&self) -> f64 {
        (self.outer_m.powi(4) - (self.outer_m - 2.0 * self.wall_m).powi(4)) / 12.0
    }

    fn bending_nm2(&self) -> f64 {
        E_PA * self.inertia_m4()
    }

    /// k G A with Cowper's k for a thin-walled box at a Poisson ratio of 0.3.
    fn shear_n(&self) -> f64 {
        20.0 * 1.3 / (48.0 + 39.0 * 0.3) * G_PA * self.area_m2()
    }

    /// Bredt for a square box: J = b^3 t over the wall's middle line.
    fn torsion_nm2(&self) -> f64 {
        G_PA * (self.outer_m - self.wall_m).powi(3) * self.wall_m
    }

    fn line_kg_per_m(&self) -> f64 {
        DENSITY_KG_M3 * self.area_m2()
    }

    fn rotary_kgm(&self) -> f64 {
        DENSITY_KG_M3 * self.inertia_m4()
    }

    /// The cantilever along x as an arm without joints.
    fn cantilever(&self, gravity_m_s2: f64) -> Value {
        let steel = json!({
            "youngs_modulus_pa": E_PA, "shear_modulus_pa": G_PA, "density_kg_m3": DENSITY_KG_M3
        });
        let section = json!({
            "shape": "rectangular_tube",
            "width_m": self.outer_m, "height_m": self.outer_m, "wall_m": self.wall_m
        });
        json!({
            "gravity_m_s2": gravity_m_s2,
            "materials": {"steel": steel},
            "chain": [{
                "type": "link", "name": "beam", "vector_m": [self.length_m, 0, 0],
                "material": "steel", "section": section
            }]
        })
    }
}

/// Rigid weightless levers along x, each after a joint about y, each with a mass at its end.
fn pendulum(stiffness_nm_per_rad: &[f64], mass_kg: &[f64], lever_m: &[f64]) -> Value {
    let mut chain = Vec::new();
    let mut inboard_kg = 0.0;
    for (i, stiffness) in stiffness_nm_per_rad.iter().enumerate() {
        chain.push(json!({
            "type": "joint", "name": format!("j{i}"), "axis": [0, 1, 0],
            "stiffness_nm_per_rad": stiffness, "mass_kg": inboard_kg
        }));
        chain.push(json!({"type": "link", "name": format!("lever{i}"), "vector_m": [lever_m[i], 0, 0]}));
        inboard_kg = mass_kg[i];
    }
    chain.push(json!({
        "type": "joint", "name": "end", "axis": [0, 1, 0], "stiffness_nm_per_rad": null, "mass_kg": inboard_kg
    }));
    json!({"gravity_m_s2": 9.81, "materials": {}, "chain": chain})
}

#[track_caller]
fn assert_close(found: f64, expected: f64, relative: f64) {
    let deviation = (found / expected - 1.0).abs();
    assert!(deviation <= relative, "{found} against {expected}: {deviation:.2e} beyond {relative:.0e}");
}

fn sag_m(arm: &Value, case: &LoadCase) -> f64 {
    -witness::analyze(arm, case, &Options::default().with_modes(0)).tip_displacement_m.z
}

#[test]
fn a_tip_force_bends_and_shears_a_cantilever() {
    let beam = Box::STOUT;
    let case = LoadCase::unloaded(&[]).with_tip_force([0.0, 0.0, -500.0]);
    let bending_m = closed_forms::tip_deflection_of_force_m(500.0, beam.length_m, beam.bending_nm2());
    let shear_m = closed_forms::shear_deflection_of_force_m(500.0, beam.length_m, beam.shear_n());
    assert_close(sag_m(&beam.cantilever(0.0), &case), bending_m + shear_m, 1e-9);
}

#[test]
fn its_own_weight_bends_and_shears_a_cantilever() {
    let beam = Box::STOUT;
    let weight_n_per_m = 9.81 * beam.line_kg_per_m();
    let bending_m =
        closed_forms::tip_deflection_of_line_load_m(weight_n_per_m, beam.length_m, beam.bending_nm2());
    let shear_m =
        closed_forms::shear_deflection_of_line_load_m(weight_n_per_m, beam.length_m, beam.shear_n());
    assert_close(sag_m(&beam.cantilever(9.81), &LoadCase::unloaded(&[])), bending_m + shear_m, 1e-9);
}

#[test]
fn a_payload_beyond_the_tip_adds_its_moment() {
    let beam = Box::STOUT;
    let (mass_kg, lever_m) = (5.0, 0.3);
    let payload =
        |lever_m: f64| LoadCase::unloaded(&[]).with_payload(Payload::point(mass_kg, [lever_m, 0.0, 0.0]));
    let arm = beam.cantilever(9.81);
    let of_moment_m = sag_m(&arm, &payload(lever_m)) - sag_m(&arm, &payload(0.0));
    let moment_nm = mass_kg * 9.81 * lever_m;
    let expected_m = closed_forms::tip_deflection_of_moment_m(moment_nm, beam.length_m, beam.bending_nm2());
    assert_close(of_moment_m, expected_m, 1e-7);
}

#[test]
fn a_slender_cantilever_has_the_textbook_frequencies() {
    let beam = Box::SLENDER;
    let answer = witness::analyze(&beam.cantilever(0.0), &LoadCase::unloaded(&[]), &Options::default());
    let expected_hz =
        closed_forms::cantilever_frequencies_hz(beam.length_m, beam.bending_nm2(), beam.line_kg_per_m());
    // Each mode comes twice, once in each plane; shear and rotary inertia cost the third 0.09 %.
    for (pair, expected_hz) in answer.frequencies_hz().chunks(2).zip(expected_hz) {
        assert_close(pair[0], expected_hz, 1e-3);
        assert_close(pair[1], pair[0], 1e-9);
    }
}

/// Bending frequencies of the stout cantilever, each twice, with very many elements.
fn stout_bending_hz(mass_shape: MassShape) -> Vec<f64> {
    let options = Options { elements_per_link: 64, mass_shape, ..Options::default().with_modes(12) };
    let answer = witness::analyze(&Box::STOUT.cantilever(0.0), &LoadCase::unloaded(&[]), &options);
    // A mode that bends within xy or xz moves across x as well, which stretching and twisting do not.
    let bends = |share: [f64; 3]| share[0] + share[1] > 0.5 && share[2] > 0.5;
    answer.modes.iter().filter(|mode| bends(mode.plane_share)).map(|mode| mode.frequency_hz).collect()
}

fn exact_stout_bending_hz() -> Vec<f64> {
    let beam = Box::STOUT;
    let exact = StoutBeam {
        length_m: beam.length_m,
        bending_nm2: beam.bending_nm2(),
        shear_n: beam.shear_n(),
        line_kg_per_m: beam.line_kg_per_m(),
        rotary_kgm: beam.rotary_kgm(),
    };
    exact.cantilever_frequencies_hz(3)
}

#[test]
fn a_stout_cantilever_has_the_exact_timoshenko_frequencies() {
    for (pair, exact_hz) in stout_bending_hz(MassShape::Timoshenko).chunks(2).zip(exact_stout_bending_hz()) {
        println!("{pair:?} against {exact_hz} Hz");
        assert_close(pair[0], exact_hz, 5e-4);
        assert_close(pair[1], exact_hz, 5e-4);
    }
}

#[test]
fn euler_bernoulli_mass_shapes_overrate_rotary_inertia_however_fine_the_mesh() {
    let third_hz = stout_bending_hz(MassShape::EulerBernoulli)[4];
    println!("{third_hz} against {} Hz", exact_stout_bending_hz()[2]);
    assert!(third_hz < 0.99 * exact_stout_bending_hz()[2], "{third_hz}");
}

#[test]
fn a_tip_mass_lowers_a_slender_cantilever_as_the_characteristic_equation_says() {
    let beam = Box::SLENDER;
    for tip_kg in [0.1, 1.0, 10.0] {
        let case = LoadCase::unloaded(&[]).with_payload(Payload::point(tip_kg, [0.0; 3]));
        let answer = witness::analyze(&beam.cantilever(0.0), &case, &Options::default().with_modes(1));
        let expected_hz = closed_forms::tip_mass_frequency_hz(
            tip_kg,
            beam.length_m,
            beam.bending_nm2(),
            beam.line_kg_per_m(),
        );
        assert_close(answer.modes[0].frequency_hz, expected_hz, 3e-4);
    }
}

#[test]
fn a_fixed_rod_twists_at_the_textbook_frequencies() {
    let beam = Box::STOUT;
    let options = Options { elements_per_link: 48, ..Options::default().with_modes(16) };
    let answer = witness::analyze(&beam.cantilever(0.0), &LoadCase::unloaded(&[]), &options);
    let twisting = answer.modes.iter().filter(|mode| mode.plane_share[0] + mode.plane_share[1] < 1e-6);
    let twisting_hz: Vec<f64> = twisting.map(|mode| mode.frequency_hz).collect();
    assert!(twisting_hz.len() >= 2, "{:?}", answer.frequencies_hz());
    for (i, found_hz) in twisting_hz.iter().enumerate() {
        let polar_kgm = 2.0 * beam.rotary_kgm();
        let expected_hz =
            closed_forms::torsion_frequency_hz(i + 1, beam.length_m, beam.torsion_nm2(), polar_kgm);
        assert_close(*found_hz, expected_hz, 2e-3);
    }
}

#[test]
fn a_mass_on_a_spring_hinge_swings_and_sags_as_it_should() {
    let arm = pendulum(&[1e4], &[5.0], &[0.7]);
    let answer = witness::analyze(&arm, &LoadCase::unloaded(&[0.0, 0.0]), &Options::default());
    assert_eq!(answer.modes.len(), 1, "one spring, one mode");
    assert_close(answer.modes[0].frequency_hz, closed_forms::pendulum_frequency_hz(1e4, 5.0, 0.7), 1e-12);
    let torque_nm = 5.0 * 9.81 * 0.7;
    assert_close(answer.torque_nm("j0"), torque_nm, 1e-12);
    assert_close(-answer.tip_displacement_m.z, torque_nm / 1e4 * 0.7, 1e-12);
}

#[test]
fn two_masses_on_two_spring_hinges_swing_as_the_quadratic_says() {
    let (stiffness, mass, lever) = ([607e3, 405e3], [8.2, 13.78], [0.8, 0.5]);
    let arm = pendulum(&stiffness, &mass, &lever);
    let answer = witness::analyze(&arm, &LoadCase::unloaded(&[0.0; 3]), &Options::default());
    let expected_hz = closed_forms::double_pendulum_frequencies_hz(stiffness, mass, lever);
    assert_eq!(answer.modes.len(), 2);
    assert_close(answer.modes[0].frequency_hz, expected_hz[0], 1e-12);
    assert_close(answer.modes[1].frequency_hz, expected_hz[1], 1e-12);
}

#[test]
fn eq_16_with_table_1_gives_the_literal_frequencies() {
    let found_hz = PaperArm::table_1().frequencies_hz();
    for (found_hz, expected_hz) in found_hz.into_iter().zip([15.689, 84.892, 560.62]) {
        assert_close(found_hz, expected_hz, 4e-5);
    }
}

#[test]
fn four_times_the_stiffness_raises_the_lowest_mode_less_than_eq_18_says() {
    let arm = PaperArm::table_1();
    let raised_pct =
        |arm: PaperArm| 100.0 * (arm.frequencies_hz()[0] / PaperArm::table_1().frequencies_hz()[0] - 1.0);
    let all = arm.stiffened(0, 4.0).stiffened(1, 4.0).stiffened(2, 4.0);
    assert!((raised_pct(arm.stiffened(0, 4.0)) - 75.2).abs() < 0.05, "joint 2 alone");
    assert!((raised_pct(arm.stiffened(1, 4.0)) - 3.6).abs() < 0.05, "joint 3 alone");
    assert!((raised_pct(all) - 100.0).abs() < 1e-6, "all joints");
}
