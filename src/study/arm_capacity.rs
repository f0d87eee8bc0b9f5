//! The payloads that the arm of an arm file holds at rest, in each pose: with such a payload no joint exceeds its
//! torque or force limit, no output bearing or guide its load limits, and no link the strength of its material.
//!
//! An arm file says nothing of motion and duty, so only static loads are judged. The payload keeps the centre of
//! gravity that the case states. Torques and forces are affine in the mass of the payload: |a + b m| <= limit is an
//! interval of masses. An output bearing is limited by its permissible moment and by its static safety at rest, a guide
//! by the force and the moments that it holds, as far as the file states them, a link by the stress in it at rest, as
//! far as the strength of its material is known.

use super::capacity::{AtPose, Capacity, reach_m};
use super::import_ranges::beyond_ranges;
use super::load_limits::{LoadLimit, example, limits_of_parts, read_limits};
use super::overload::Overload;
use super::refusal::Refusal;
use super::window::{Limit, MOST_KG, Window, window_around};
use crate::arm::load::{LoadCase, read_load_cases};
use crate::arm::prismatic::GuideLimits;
use crate::arm::{Arm, Bearing, Element, LinkBody};
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::mechanics::chain::Chain;
use crate::mechanics::link_stress::LinkStresses;
use crate::mechanics::statics::{JointLoad, Statics};
use crate::sizing::bearing::BearingLimits;
use crate::space::bearing_loads::{at_centre, bearings_of};

/// The remark that says what is checked and what is not.
const AT_REST: &str = "Torques, forces, output bearings, guides and the stress in links are judged at rest, as far as their limits are known. The stress may reach the strength: no safety factor is applied. Motion and heat are not checked.";

/// The remark on an arm for which no cases are given.
const ONE_POSE: &str = "Only one pose was judged: every joint at zero, the payload at the tip. Give your poses with --cases FILE.";

/// Whether a document is an arm file. It then has a chain and, in contrast to a study file, no poses.
pub fn is_arm_file(document: &Document) -> bool {
    let root = document.root();
    let file = root.value();
    file["chain"].is_array() && file["poses"].is_null()
}

/// The payloads that an arm holds at rest, as `armwright capacity` finds them for an arm file. Without `cases`, every
/// joint stands at zero. `limits` states the largest torques and forces of the joints; without it they are those of the
/// gears and motors that the arm names.
///
/// # Errors
/// All faults of the cases or of the limits, or [`Refusal::Unknown`] if no limit of any joint or bearing is known.
pub fn capacity_of_arm(
    arm: &Arm,
    cases: Option<Document>,
    limits: Option<Document>,
    catalogs: &Catalogs,
) -> Result<Capacity, Refusal> {
    let has_cases = cases.is_some();
    let zero = r#"[{"name": "every joint at zero", "pose": {}}]"#;
    let cases = cases.map_or_else(|| Document::parse("zero", zero), Ok)?;
    let cases = read_load_cases(cases, &arm.driven_joints())?;
    // the file of limits may be the `import.json` of an imported robot, which states the ranges of its joints too
    let beyond = limits.as_ref().and_then(|file| beyond_ranges(file.root().value(), arm, &cases));
    let limits = match limits {
        Some(file) => read_limits(file, arm)?,
        None => limits_of_parts(arm, catalogs),
    };
    if limits.is_empty() && !has_rated_bearings(arm) && guides_of(arm).next().is_none() {
        return Err(Refusal::Unknown(format!(
            "nothing is known of the torques and forces that the joints of {} may bear: give --limits FILE with {}, or name gears and \
             motors of the catalogs in the arm file",
            arm.name,
            example(arm)
        )));
    }
    let mut found = arm_capacity(arm, &cases, &limits);
    found.remarks.push(AT_REST.into());
    found.remarks.extend(beyond);
    found.remarks.extend((!has_cases).then(|| ONE_POSE.into()));
    Ok(found)
}

/// The payloads that an arm holds at rest, in each of its cases and in all of them, with which no joint exceeds its
/// limit in `limits`, no output bearing and no guide exceeds its ratings, and no link the strength of its material.
fn arm_capacity(arm: &Arm, cases: &[LoadCase], limits: &[LoadLimit]) -> Capacity {
    let table: Vec<AtPose> = cases
        .iter()
        .map(|case| {
            let structure = arm.structure_in(case);
            let tip_m = Chain::new(&structure, case.links).pose(case).tip_m;
            AtPose {
                pose: case.name.clone(),
                reach_m: reach_m(&tip_m, &arm.down),
                window: held_payloads(arm, case, limits),
            }
        })
        .collect();
    let all = table.iter().fold(Window::unlimited(), |all, at| all.and(at.window.clone()));
    let unjudged: Vec<&str> = arm
        .driven_joint_names()
        .into_iter()
        .filter(|name| limits.iter().all(|limit| limit.joint != *name))
        .collect();
    let remark = (!unjudged.is_empty()).then(|| {
        format!(
            "No largest torque or force is known of these joints, whose drives are not judged: {}.",
            unjudged.join(", ")
        )
    });
    Capacity::new(all, table, remark.into_iter().chain(of_unknown_strength(arm)).collect())
}

/// The remark that names the tubes and bars whose material has no known strength; `None` if there are none.
fn of_unknown_strength(arm: &Arm) -> Option<String> {
    let unknown = arm
        .links()
        .filter(|link| matches!(&link.body, LinkBody::Tube { material, .. } if material.strength.is_none()));
    let names: Vec<&str> = unknown.map(|link| link.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "No strength is known of the material of these links, whose stress is not judged: {}. Give it with \
             \"strength_pa\" in \"materials\".",
            names.join(", ")
        )
    })
}

/// The payloads that an arm holds at rest in one case, limited by its joints, output bearings, guides and links.
fn held_payloads(arm: &Arm, case: &LoadCase, limits: &[LoadLimit]) -> Window {
    let chain = Chain::new(&arm.structure_in(case), case.links);
    let loads = |payload_kg: f64| {
        let mut loaded = case.clone();
        loaded.payload.mass_kg = payload_kg;
        let statics = chain.pose(&loaded).statics();
        [statics.joint_torques_nm, statics.joint_forces_n].concat()
    };
    let (empty, one_kg) = (loads(0.0), loads(1.0));
    let of_joints = limits.iter().fold(Window::unlimited(), |all, limit| {
        let Some(index) = empty.iter().position(|(name, _)| *name == limit.joint) else { return all };
        all.and(affine_window(empty[index].1, one_kg[index].1 - empty[index].1, limit))
    });
    if !of_joints.holds() {
        return of_joints;
    }
    let of_parts = held_by_parts(arm, case, of_joints.least.payload_kg, of_joints.most.payload_kg);
    of_joints.and(of_parts)
}

/// The payloads m \[kg\] with |`empty` + `per_kg` m| <= the limit of a joint. `empty` is the load on the joint without
/// a payload \[N m, or N of a prismatic joint\], `per_kg` its change per kilogram. An end of the interval beyond
/// [`MOST_KG`] is stated as no limit.
fn affine_window(empty: f64, per_kg: f64, limit: &LoadLimit) -> Window {
    let fails = Overload { piece: limit.joint.clone(), check: limit.check.into() };
    let within = empty.abs() <= limit.most;
    let far_kg = (limit.most.copysign(per_kg) - empty) / per_kg;
    let near_kg = (-limit.most.copysign(per_kg) - empty) / per_kg;
    let mut window = Window::unlimited();
    if !within {
        let is_reached = per_kg != 0.0 && near_kg > 0.0 && near_kg <= MOST_KG;
        if !is_reached {
            return Window::empty(fails);
        }
        window.least = Limit::new(near_kg, fails.clone());
    }
    if per_kg != 0.0 && far_kg <= MOST_KG {
        window.most = Limit::new(far_kg, fails);
    }
    window
}

/// Ratio of the load on a bearing at rest to the load that is allowed, for each of the two checks at rest, with the
/// name of the check. `load` is the load on the joint of the bearing.
fn uses(bearing: &Bearing, load: &JointLoad) -> [(f64, &'static str); 2] {
    let (limits, load) = (limits_at_rest(bearing), at_centre(load, bearing));
    [
        (limits.moment_nm(&load) / limits.running_moment_nm, "bearing moment"),
        (limits.static_load_n(&load) / limits.at_rest_n, "bearing static safety"),
    ]
}

/// The limits of a bearing at rest. Speed and life are set to 0, because they limit only the load on a bearing that
/// turns, and an arm file says nothing of motion.
fn limits_at_rest(bearing: &Bearing) -> BearingLimits {
    BearingLimits::of(Some(bearing), 0.0, 0.0)
}

/// Whether any output bearing of an arm has a rating that limits its load at rest.
fn has_rated_bearings(arm: &Arm) -> bool {
    bearings_of(arm).any(|(_, bearing)| {
        let limits = limits_at_rest(&bearing);
        limits.running_moment_nm.min(limits.at_rest_n).is_finite()
    })
}

/// The guides of an arm of which the file states what they hold, by the names of their prismatic joints.
fn guides_of(arm: &Arm) -> impl Iterator<Item = (&str, &GuideLimits)> {
    arm.chain.iter().filter_map(|element| match element {
        Element::Prismatic(rail) if rail.guide.limits.is_stated() => {
            Some((rail.name.as_str(), &rail.guide.limits))
        }
        _ => None,
    })
}

/// The largest part of what an output bearing or a guide of `arm` holds that the loads of `statics` use up, with the
/// name of its joint and of the check; 1 if all of it is used. `None` if no bearing and no guide is rated.
fn most_used<'a>(arm: &'a Arm, statics: &Statics) -> Option<(f64, &'a str, &'static str)> {
    let loads = statics.joint_torques_nm.iter().zip(&statics.bearing_loads);
    let of_bearings = bearings_of(arm).flat_map(|(joint, bearing)| {
        let load = loads.clone().find(|((name, _), _)| name == joint).map(|(_, load)| uses(&bearing, load));
        load.into_iter().flatten().map(move |(part, check)| (part, joint, check))
    });
    let of_guides = guides_of(arm).filter_map(|(joint, limits)| {
        let load = statics.guide_loads.iter().find(|load| load.name == joint)?;
        Some((limits.part_used(&load.force_n, &load.moment_nm)?, joint, "guide at rest"))
    });
    of_bearings.chain(of_guides).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// The payloads from `least_kg` to `most_kg` with which all output bearings, guides and links hold at rest in a case. The
/// loads on bearings are norms of forces and moments, those on guides sums of magnitudes, and stresses norms of such
/// sums, of numbers that are affine in the payload's mass. So the loads are convex functions of this mass, and their
/// smallest values are found by narrowing an interval.
fn held_by_parts(arm: &Arm, case: &LoadCase, least_kg: f64, most_kg: f64) -> Window {
    let chain = Chain::new(&arm.structure_in(case), case.links);
    let links = LinkStresses::new(arm, case);
    let worst = |payload_kg: f64| {
        let mut loaded = case.clone();
        loaded.payload.mass_kg = payload_kg;
        let of_links =
            links.in_case(&loaded).into_iter().map(|(link, part)| (part, link.to_string(), "link stress"));
        let of_supports = most_used(arm, &chain.pose(&loaded).statics());
        let of_supports = of_supports.map(|(part, joint, check)| (part, joint.to_string(), check));
        of_links.chain(of_supports).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let overload = |payload_kg: f64| {
        let failing = worst(payload_kg).filter(|(part, ..)| *part > 1.0);
        failing.map(|(_, piece, check)| Overload { piece, check: check.into() })
    };
    let use_of = |payload_kg: f64| worst(payload_kg).map_or(0.0, |(part, ..)| part);
    let held_kg = least_loading(least_kg, most_kg, &use_of);
    match overload(held_kg) {
        None => window_around(held_kg, &overload),
        Some(_) => Window::empty(overload(least_kg).unwrap_or_default()),
    }
}

/// A payload \[kg\] from `least_kg` to `most_kg` at which the convex function `use_of` is at most 1. If there is no
/// such payload, the one at which the function is smallest.
fn least_loading(least_kg: f64, most_kg: f64, use_of: &dyn Fn(f64) -> f64) -> f64 {
    let most_kg = most_kg.min(MOST_KG);
    let (mut low_kg, mut high_kg) = (least_kg, (2.0 * least_kg).max(1.0).min(most_kg));
    while high_kg < most_kg && use_of((2.0 * high_kg).min(most_kg)) < use_of(high_kg) {
        high_kg = (2.0 * high_kg).min(most_kg);
    }
    high_kg = (2.0 * high_kg).min(most_kg);
    // each step leaves two thirds of the interval, so after 150 steps 4e-27 of it is left
    for _ in 0..150 {
        if use_of(low_kg) <= 1.0 {
            break;
        }
        let third_kg = (high_kg - low_kg) / 3.0;
        match use_of(low_kg + third_kg) < use_of(high_kg - third_kg) {
            true => high_kg -= third_kg,
            false => low_kg += third_kg,
        }
    }
    low_kg
}

#[cfg(test)]
mod tests {
    use super::super::load_limits::read_limits;
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::arm::load::read_load_cases;
    use crate::catalog::Catalogs;
    use crate::input::json::Document;

    /// The payloads that an arm holds in these cases, with these limits of its joints. `chain` is the chain of the arm
    /// file, with further keys if need be.
    fn found(chain: &str, cases: &str, limits: &str) -> Capacity {
        let text = format!("{{\"chain\": {chain}}}");
        let arm = read_arm_document(Document::parse("a", &text).expect("JSON"), &Catalogs::default())
            .expect("an arm");
        let cases = Document::parse("c", cases).expect("JSON");
        let cases = read_load_cases(cases, &arm.driven_joints()).expect("cases");
        let limits = read_limits(Document::parse("l", limits).expect("JSON"), &arm).expect("limits");
        arm_capacity(&arm, &cases, &limits)
    }

    #[test]
    fn a_lever_holds_what_its_torque_allows() {
        // the link weighs 2 kg at the middle of 1 m and the payload m is at its end; the limit of 50 N m gives m =
        // (50/9.81 - 1)/1; folded up, nothing limits m
        let found = found(
            r#"[{"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": null},
            {"type": "link", "name": "l", "vector_m": [1, 0, 0], "mass_kg": 2}]"#,
            r#"[{"name": "out", "pose_deg": [0]}, {"name": "half", "pose_deg": [-60]}]"#,
            r#"{"joints": [{"name": "j", "max_torque_nm": 50}]}"#,
        );
        let out_kg = 50.0 / 9.81 - 1.0;
        assert!((found.window.most.payload_kg - out_kg).abs() < 1e-9 && found.pose == "out", "{found:?}");
        let half_kg = found.table[0].window.most.payload_kg;
        assert!((half_kg - (100.0 / 9.81 - 1.0)).abs() < 1e-9, "{found:?}");
        let most = &found.window.most;
        assert_eq!((most.piece.as_str(), most.check.as_str()), ("j", "torque limit"));
        assert!(
            found.window.least.payload_kg == 0.0 && found.least_pose.is_empty() && found.remarks.is_empty()
        );
    }

    #[test]
    fn an_arm_that_is_balanced_for_its_payload_has_a_smallest_payload() {
        // 2 kg at 0.5 m and the payload m at 1 m, against 20 kg at 0.5 m behind the joint: |9.81 (9 - m)| <= 50
        let chain = r#"[{"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": null},
            {"type": "link", "name": "l", "vector_m": [1, 0, 0], "mass_kg": 2}],
            "counterweights": [{"at": "l", "point_m": [-0.5, 0, 0], "mass_kg": 20}]"#;
        let limits = r#"{"joints": [{"name": "j", "max_torque_nm": 50}]}"#;
        let out = found(chain, r#"[{"name": "out", "pose_deg": [0]}]"#, limits);
        let Window { least, most } = &out.window;
        assert!((least.payload_kg - (9.0 - 50.0 / 9.81)).abs() < 1e-9 && out.least_pose == "out", "{out:?}");
        assert!((most.payload_kg - (9.0 + 50.0 / 9.81)).abs() < 1e-9, "{out:?}");
        // the pose "pushed" has a force of 150 N at the tip, which shifts its window by 150 N / g; no payload is held
        // in both poses
        let both = r#"[{"name": "out", "pose_deg": [0]}, {"name": "pushed", "pose_deg": [0], "tip_force_n": [0, 0, 150]}]"#;
        let both = found(chain, both, limits);
        assert!(!both.window.holds() && both.pose == "out" && both.least_pose == "pushed", "{both:?}");
        assert_eq!(both.to_json()["payload_kg"], 0.0);
        let pushed_kg = both.table.iter().map(|at| at.window.least.payload_kg).fold(0.0, f64::max);
        assert!((pushed_kg - (9.0 + (150.0 - 50.0) / 9.81)).abs() < 1e-9, "{both:?}");
    }

    #[test]
    fn a_slide_is_limited_by_its_force_and_joints_without_a_limit_are_named() {
        // 3 kg and the payload hang on a vertical slide with a limit of 200 N
        let found = found(
            r#"[{"type": "prismatic", "name": "z", "axis": [0, 0, 1], "stiffness_n_per_m": null, "mass_kg": 3},
            {"type": "joint", "name": "wrist", "axis": [0, 1, 0], "stiffness_nm_per_rad": null}]"#,
            r#"[{"name": "low", "pose": {"z_mm": 0, "wrist_deg": 0}}]"#,
            r#"{"joints": [{"name": "z", "max_force_n": 200}]}"#,
        );
        let most = &found.window.most;
        assert!((most.payload_kg - (200.0 / 9.81 - 3.0)).abs() < 1e-9, "{found:?}");
        assert_eq!((most.piece.as_str(), most.check.as_str()), ("z", "force limit"));
        assert!(found.remarks.len() == 1 && found.remarks[0].ends_with("not judged: wrist."), "{found:?}");
    }

    #[test]
    fn a_bearing_that_a_counterweight_tilts_needs_a_payload() {
        // a vertical joint with the same link and counterweight: the moment across its axis is 9.81 |9 - m|, and 40 N m
        // are permitted
        let found = found(
            r#"[{"type": "joint", "name": "waist", "axis": [0, 0, 1], "stiffness_nm_per_rad": null,
              "bearing": {"tilt_stiffness_nm_per_rad": null, "permissible_moment_nm": 40}},
            {"type": "link", "name": "l", "vector_m": [1, 0, 0], "mass_kg": 2}],
            "counterweights": [{"at": "l", "point_m": [-0.5, 0, 0], "mass_kg": 20}]"#,
            r#"[{"name": "out", "pose_deg": [0]}]"#,
            r#"{"joints": []}"#,
        );
        let Window { least, most } = &found.window;
        assert!((least.payload_kg - (9.0 - 40.0 / 9.81)).abs() < 1e-9, "{found:?}");
        assert!((most.payload_kg - (9.0 + 40.0 / 9.81)).abs() < 1e-9, "{found:?}");
        assert_eq!(least.check, "bearing moment");
    }

    /// A solid bar of 20 mm holds the moment W σ with W = a³/6 at its root, and σ = 50 MPa here. Its own weight and the
    /// bodies on it take a part of it: 1 kg at 0.3 m, with an offset, and a spring that lifts the bar at 0.25 m.
    #[test]
    fn the_stress_in_a_bar_ends_what_it_holds() {
        let chain = |more: &str| {
            format!(
                r#"[{{"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": null}},
                {{"type": "link", "name": "bar", "vector_m": [0.5, 0, 0], "material": "soft",
                  "section": {{"shape": "rectangular_bar", "width_m": 0.02, "height_m": 0.02}}{more}}}],
                "materials": {{"soft": {{"youngs_modulus_pa": 7e10, "shear_modulus_pa": 2.7e10, "density_kg_m3": 2500,
                  "strength_pa": 5e7}}}}"#
            )
        };
        let cases = r#"[{"name": "out", "pose_deg": [0]}, {"name": "half", "pose_deg": [-60]}]"#;
        let found_with = |more: &str, springs: &str| {
            found(&format!("{}{springs}", chain(more)), cases, r#"{"joints": []}"#)
        };
        let (held_nm, bar_kg) = (0.02f64.powi(3) / 6.0 * 5e7, 0.5 * 4e-4 * 2500.0);
        let plain = found_with("", "");
        let most = &plain.window.most;
        assert!((most.payload_kg - (held_nm / 9.81 - bar_kg * 0.25) / 0.5).abs() < 1e-9, "{plain:?}");
        assert_eq!((most.piece.as_str(), most.check.as_str()), ("bar", "link stress"));
        // a link at 60 degrees has half the lever, and its weight pushes or pulls along it
        let half_kg = plain.table[0].window.most.payload_kg;
        let weight_n = |kg: f64| 9.81 * (kg + bar_kg);
        let bent_nm = 9.81 * (half_kg * 0.25 + bar_kg * 0.125);
        let along_pa = weight_n(half_kg) * 0.75f64.sqrt() / 4e-4;
        assert!((bent_nm / (0.02f64.powi(3) / 6.0) + along_pa - 5e7).abs() < 1.0, "{plain:?}");
        // a body of 1 kg, 40 mm to the side: it bends the bar and twists it
        let body = found_with(r#", "bodies": [{"mass_kg": 1, "cg_m": [0.3, 0.04, 0]}]"#, "");
        let body_kg = body.window.most.payload_kg;
        let normal_pa = 9.81 * (0.5 * body_kg + 0.25 * bar_kg + 0.3) / (0.02f64.powi(3) / 6.0);
        // shear of a square bar under torsion: T / (0.208 a³) [Roark]
        let shear_pa = 9.81 * 0.04 / (0.2082 * 0.02f64.powi(3));
        let equivalent_pa = (normal_pa * normal_pa + 3.0 * shear_pa * shear_pa).sqrt();
        assert!((equivalent_pa / 5e7 - 1.0).abs() < 1e-4, "{body:?}");
        // a spring that lifts with 300 N at the middle unloads the root, so that the stress at its point limits the payload
        let spring = r#", "springs": [{"name": "s", "from": {"at": "world", "point_m": [0.25, 0, 1000]},
            "to": {"at": "bar", "point_m": [0.25, 0, 0]}, "force_n": 300, "stiffness_n_per_m": 0, "free_length_m": 1}]"#;
        let lifted = found_with("", spring);
        let lifted_kg = lifted.table[1].window.most.payload_kg;
        let spring_kg = (held_nm / 9.81 - 0.5 * bar_kg * 0.125) / 0.25;
        assert!((lifted_kg - spring_kg).abs() < 1e-6, "{lifted:?}");
        // without a payload the spring bends the root too far upward
        let least_kg = ((300.0 * 0.25 - held_nm) / 9.81 - bar_kg * 0.25) / 0.5;
        assert!((lifted.table[1].window.least.payload_kg - least_kg).abs() < 1e-6, "{lifted:?}");
    }

    #[test]
    fn a_guide_ends_what_a_column_holds() {
        // the overhang of 0.7 m tilts the carriage by 9.81 (0.7 m + 4 * 0.35) about the pitch axis, and 40 N m are held
        let found = found(
            r#"[{"type": "prismatic", "name": "z", "axis": [0, 0, 1], "stiffness_n_per_m": null,
              "guide": {"max_roll_nm": 40, "max_pitch_nm": 40, "max_yaw_nm": 40}},
            {"type": "link", "name": "boom", "vector_m": [0.7, 0, 0], "mass_kg": 4}]"#,
            r#"[{"name": "low", "pose": {"z_mm": 0}}]"#,
            r#"{"joints": [{"name": "z", "max_force_n": 2000}]}"#,
        );
        let most = &found.window.most;
        assert!((most.payload_kg - (40.0 / 9.81 - 4.0 * 0.35) / 0.7).abs() < 1e-9, "{found:?}");
        assert_eq!((most.piece.as_str(), most.check.as_str()), ("z", "guide at rest"));
    }
}
