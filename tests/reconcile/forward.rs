//! Compares the prepared model that fits use with the full mechanics, for every effect at every place.

use armwright::arm::effect::Subject;
use armwright::arm::{Bearing, Curve, Effect, Element, JointModel, Windup};
use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::fit::descent::{evaluate, jacobian};
use armwright::reconcile::fit::weights::Weights;
use armwright::reconcile::forward::Forward;
use armwright::reconcile::model::calibration::Nuisance;
use armwright::reconcile::model::candidates::candidates;
use armwright::reconcile::model::direct::Direct;
use armwright::reconcile::model::parameters::Model;
use nalgebra::Vector3;
use std::path::Path;

fn campaign() -> Campaign {
    let folder = format!("{}/tests/data/campaigns/plain-0251e", env!("CARGO_MANIFEST_DIR"));
    let mut campaign = Campaign::read(Path::new(&folder), &Catalogs::default()).expect("sound campaign");
    campaign.statics.truncate(20);
    campaign.modal.truncate(16);
    campaign
}

/// The same campaign of an arm with output bearings, whose stiffness is calibrated.
fn campaign_with_bearings() -> Campaign {
    let mut campaign = campaign();
    for (i, element) in campaign.arm.chain.iter_mut().enumerate() {
        if let Element::Joint(joint) = element {
            let tilt_stiffness_nm_per_rad = Some(1e5 * (2 + i) as f64);
            joint.bearing = Some(Bearing { tilt_stiffness_nm_per_rad, mass_kg: 0.5, ..Bearing::default() });
        }
    }
    campaign.statement.tolerance.bearing_stiffness = 0.3;
    campaign
}

#[test]
fn the_prepared_model_is_mechanics_for_every_effect_at_every_place() {
    is_mechanics(campaign());
}

#[test]
fn the_prepared_model_of_an_arm_with_bearings_is_mechanics_for_every_effect_at_every_place() {
    is_mechanics(campaign_with_bearings());
}

/// A law without a name.
fn law(at: &str, parameters: &[(&str, &[f64])]) -> Effect {
    let parameters = parameters.iter().map(|(name, numbers)| (name.to_string(), numbers.to_vec())).collect();
    Effect { effect: "empirical".into(), at: at.into(), parameters, source: None }
}

/// A joint that softens while it is tested, a base that turns once, one that tilts more about one axis, a payload that slips,
/// joints that twist under the torques of their neighbours, an instrument that moves, loads that act otherwise than stated.
fn laws() -> [Effect; 10] {
    let softening: [(&str, &[f64]); 5] = [
        ("static_softening", &[0.3]),
        ("static_softening_rows", &[7.0]),
        ("modal_softening", &[-0.2]),
        ("modal_softening_rows", &[5.0]),
        ("static_softening_reference", &[0.3]),
    ];
    let turn: [(&str, &[f64]); 2] =
        [("base_turn_rad", &[1e-4, -2e-4, 3e-4]), ("base_turn_from_row", &[11.0])];
    let tilt = |at: &str| law(at, &[("tilt_rad_per_nm", &[1e-6, 4e-6])]);
    let slip: [(&str, &[f64]); 3] = [
        ("slip_m", &[0.004, -0.003, 0.006]),
        ("static_slip_from_row", &[7.0]),
        ("modal_slip_from_row", &[9.0]),
    ];
    let twist = |at: &str| {
        let play: (&str, &[f64]) = ("load_play_nm", &[3.0]);
        law(at, &[("neighbour_twist_rad_per_nm", &[2e-6, -3e-6]), ("load_play_rad", &[1e-4]), play])
    };
    let shift: [(&str, &[f64]); 3] =
        [("shift_mm", &[0.1, -0.2, 0.3]), ("base_turn_from_row", &[4.0]), ("base_turn_file", &[0.0])];
    let loads: [(&str, &[f64]); 5] = [
        ("force_part", &[0.1]),
        ("payload_pull", &[0.02, -0.03]),
        ("sway_mm_per_n", &[1e-3, 2e-3, -3e-3]),
        ("grip_n", &[2.0, -3.0, 4.0]),
        ("remaining_part", &[0.1]),
    ];
    let moving: [(&str, &[f64]); 3] = [
        ("base_turn_rad", &[1e-4, -2e-4, 3e-4]),
        ("shift_mm", &[0.1, 0.0, -0.1]),
        ("base_turn_rows", &[5.0]),
    ];
    [
        law("j2", &softening),
        law("static", &turn),
        tilt("base"),
        tilt("j3"),
        law("payload", &slip),
        twist("j1"),
        twist("j3"),
        law("static", &shift),
        law("static", &loads),
        law("static", &moving),
    ]
}

#[test]
fn the_prepared_model_of_laws_without_a_name_is_mechanics() {
    let campaign = campaign();
    let forward = Forward::new(&campaign);
    for law in laws() {
        let mut subject = forward.nominal.clone();
        subject.apply(&law);
        let fast = forward.predict(&forward.coefficients(&subject));
        agrees(&campaign, &forward, &fast, &subject, &law.label());
    }
}

#[test]
fn a_joint_softens_from_the_second_row_on_and_a_base_turns_from_its_row_on() {
    let campaign = campaign();
    let displacements = |laws: &[Effect]| {
        let mut subject = campaign.arm.subject(JointModel::ThreeSegment);
        laws.iter().for_each(|law| subject.apply(law));
        Direct::new(&subject).statics_mm(&campaign.statics).into_iter().map(Vector3::from).collect::<Vec<_>>()
    };
    let [soft, turned, ..] = laws();
    let (plain, soft, turned) = (displacements(&[]), displacements(&[soft]), displacements(&[turned]));
    assert!((plain[0] - soft[0]).norm() < 1e-12, "the first row is of the joint as it was");
    assert!((plain[2] - soft[2]).norm() > 0.01 * plain[2].norm());
    assert_eq!(plain[9], turned[9]);
    // a rotation moves a point by no more than its size times the distance, and across its axis
    let (moved_mm, turn_rad) = (turned[10] - plain[10], Vector3::new(1e-4, -2e-4, 3e-4));
    let lever_m = moved_mm.norm() / 1e3 / turn_rad.norm();
    assert!((0.05..3.0).contains(&lever_m) && moved_mm.dot(&turn_rad).abs() < 1e-12, "{lever_m}");
}

/// Checks predictions of the prepared model against mechanics, of which frequencies may be off by a part of their noise.
fn agrees(campaign: &Campaign, forward: &Forward, fast: &[f64], subject: &Subject, what: &str) {
    let exact = Direct::new(subject);
    let mut slow: Vec<f64> = exact.statics_mm(&campaign.statics).into_iter().flatten().collect();
    slow.extend(exact.frequencies_hz(&campaign.modal).into_iter().map(|f| f.expect("mode")));
    slow.extend(exact.windups_arcmin(&campaign.windup));
    for (i, (fast, slow)) in fast.iter().zip(&slow).enumerate() {
        let datum = &forward.data[i];
        let allowed = match i >= forward.starts[1] && i < forward.starts[2] {
            true => 0.2 * datum.sigma,
            false => 1e-9 * slow.abs() + 1e-10,
        };
        assert!((fast - slow).abs() < allowed, "{what} {datum:?} {i}: {fast} {slow}");
    }
}

fn is_mechanics(campaign: Campaign) {
    let forward = Forward::new(&campaign);
    let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
    let baseline = Model::baseline(&nuisance);
    let mut u: Vec<f64> = (0..baseline.len()).map(|i| ((i * 7) % 5) as f64 * 0.4 - 0.8).collect();
    let calibrated = u.len();
    for candidate in candidates(&forward) {
        for start in &candidate.starts {
            let model = baseline.with(&candidate);
            u.truncate(calibrated);
            u.extend(start);
            let coefficients = model.coefficients(&forward, &u);
            let fast = forward.predict(&coefficients);
            let subject = model.subject(&forward, &u);
            agrees(&campaign, &forward, &fast, &subject, &candidate.label());
        }
    }
}

/// The same campaign of an arm whose joints have torsion curves, at temperatures that were measured.
fn campaign_with_curves() -> Campaign {
    let mut campaign = campaign();
    for element in &mut campaign.arm.chain {
        if let Element::Joint(joint) = element
            && let Curve::Linear(k) = joint.curve
        {
            joint.curve = Curve::Windup(Windup {
                k1_nm_per_rad: 0.6 * k,
                k2_nm_per_rad: k,
                k3_nm_per_rad: 1.2 * k,
                t1_nm: 2e-4 * k,
                t2_nm: 6e-4 * k,
            });
        }
    }
    let warm = |row: usize| Some(18.0 + 0.7 * row as f64);
    campaign.statics.iter_mut().for_each(|row| row.temperature_c = warm(row.row));
    campaign.modal.iter_mut().for_each(|row| row.temperature_c = warm(row.row / 4));
    campaign
}

#[test]
fn the_prepared_model_of_an_arm_with_curves_is_mechanics_for_every_effect_at_every_place() {
    let labels: Vec<String> =
        candidates(&Forward::new(&campaign_with_curves())).iter().map(|c| c.label()).collect();
    for name in ["joint_torque@j2", "thermal_modulus@arm", "stiffness_waves@j5", "base_lift@base"] {
        assert!(labels.iter().any(|label| label == name), "{name} is not looked for");
    }
    is_mechanics(campaign_with_curves());
}

#[test]
fn sensitivities_are_differences_of_predictions() {
    are_differences(campaign());
}

#[test]
fn sensitivities_of_an_arm_with_bearings_are_differences_of_predictions() {
    are_differences(campaign_with_bearings());
}

fn are_differences(campaign: Campaign) {
    let forward = Forward::new(&campaign);
    let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
    let weights =
        Weights { inverse: forward.data.iter().map(|d| 1.0 / d.sigma).collect(), smooth_only: false };
    let all = candidates(&forward);
    for name in [
        "bearing_tilt@j3",
        "payload_mass_error@payload",
        "harness_mass@forearm",
        "immersion@arm",
        "modulus_error@forearm",
        "payload_cg_error@payload",
        "lost_motion@j3",
        "sensor_gain@modal",
        "test_mass@modal",
        "servo_compliance@j3 (modal)",
        "servo_compliance@j3 (static)",
        "thermal_modulus@arm",
        "stiffness_waves@j3",
    ] {
        let candidate = all.iter().find(|c| c.label() == name).expect("candidate");
        let model = Model::baseline(&nuisance).with(candidate);
        let mut u = vec![0.3; model.calibrated()];
        u.extend(&candidate.starts[0]);
        let here = evaluate(&forward, &model, &u, &weights);
        let slopes = jacobian(&forward, &model, &here);
        for p in 0..model.len() {
            let at = |step: f64| {
                let mut u = u.clone();
                u[p] += step;
                evaluate(&forward, &model, &u, &weights).predicted
            };
            let (ahead, behind) = (at(1e-3), at(-1e-3));
            for i in 0..forward.data.len() {
                let difference = (ahead[i] - behind[i]) / 2e-3;
                let sigma = forward.data[i].sigma;
                assert!(
                    (slopes[(i, p)] - difference).abs() < 0.02 * (sigma + difference.abs()),
                    "{name} {p} {i}: {} {difference}",
                    slopes[(i, p)]
                );
            }
        }
    }
}
