//! The reduced studies whose fronts `brute_force` compares, and the pieces they are made of.

use serde_json::{Value, json};

/// The chain of a six-axis arm with open links and drives.
pub fn six_axes(upper_arm: Value, forearm: Value) -> Value {
    json!([
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "drive": "first_fit"},
        {"type": "link", "name": "shoulder", "vector_m": [0, 0, 0.3]},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "drive": "first_fit"},
        {"type": "link", "name": "upper_arm", "vector_m": [0.8, 0, 0], "choose": upper_arm},
        {"type": "joint", "name": "j3", "axis": [0, 1, 0], "drive": "first_fit"},
        {"type": "link", "name": "forearm", "vector_m": [0.5, 0, 0], "choose": forearm},
        {"type": "joint", "name": "j4", "axis": [1, 0, 0], "drive": "first_fit"},
        {"type": "joint", "name": "j5", "axis": [0, 1, 0], "drive": "first_fit"},
        {"type": "joint", "name": "j6", "axis": [1, 0, 0], "drive": "first_fit"},
        {"type": "link", "name": "flange", "vector_m": [0.05, 0, 0]}
    ])
}

pub fn boxes(materials: &[&str], widths: Value, heights: Value, walls: Value) -> Value {
    json!({"materials": materials, "sections": [
        {"shape": "rectangular_tube", "width_mm": widths, "height_mm": heights, "wall_mm": walls}]})
}

pub const STEEL: &str = "Structural steel S355";
pub const ALUMINIUM: &str = "Aluminium 6061-T6";
const KEVLAR: &str = "Kevlar 49/epoxy UD";
pub const CFRP: &str = "CFRP T300/5208 (standard modulus) quasi-isotropic";

/// The built-in `compare-materials` with fewer materials and sections, and no limits.
pub fn compare_materials() -> Value {
    let materials = [STEEL, ALUMINIUM, CFRP];
    json!({
        "name": "brute-compare", "extras": "none",
        "chain": six_axes(
            boxes(&materials, json!([80, 140]), json!({"from": 100, "to": 180, "step": 80}), json!([3, 6])),
            boxes(&materials, json!([60, 100]), json!([60, 120]), json!([2, 5])),
        ),
        "payload": {"mass_kg": 5, "cg_m": [0, 0, 0.05]},
        "poses": [{"name": "stretched", "pose_deg": [0, 0, 0, 0, 0, 0]},
            {"name": "elbow bent", "pose_deg": [0, -45, 90, 0, 45, 0]}],
        "motion": {"tip_speed_m_s": 1.0, "ramp_time_s": 0.2},
        "drives": {"motors": ["electric"], "gear_mass": "housed_unit"}
    })
}

/// Few drives, all of which that hold may be chosen for joint 2.
pub fn free_second_drive() -> Value {
    let mut study = compare_materials();
    study["name"] = json!("brute-all-fits");
    study["chain"] = six_axes(
        boxes(&[STEEL, CFRP], json!(120), json!([120, 160]), json!(4)),
        boxes(&[STEEL, CFRP], json!(80), json!(100), json!(3)),
    );
    study["chain"][2]["drive"] = json!("all_fits");
    study["drives"] = json!({
        "gear_series": ["CSG", "HFUC"], "ratios": [100, 160], "gear_mass": "housed_unit",
        "motor_models": ["251601 (EC 45 flat 50 W)", "397172 (EC 45 flat 70 W)", "MF0060008 48V", "ILM70x18", "HG-KR43",
            "HG-KR73"],
    });
    study
}

/// Limits on all that can be limited, each of which excludes something. Bearings are rigid.
pub fn limited() -> Value {
    let mut study = compare_materials();
    study["name"] = json!("brute-limits");
    study["chain"] = six_axes(
        boxes(&[STEEL, ALUMINIUM], json!([60, 120]), json!([60, 120, 160]), json!([2, 4])),
        boxes(&[STEEL, ALUMINIUM], json!([40, 90]), json!([60, 120]), json!([2, 4])),
    );
    for joint in [0, 2, 4, 6, 7, 8] {
        study["chain"][joint]["bearing"] = Value::Null;
    }
    study["constraints"] = json!({"tip_deflection_max_mm": 4.5, "lowest_mode_min_hz": 4.6, "mass_max_kg": 20,
        "stress_safety_factor_min": 40, "wall_slenderness_max": 50});
    study
}

/// Folded and twisted poses, a force at the tip, a hand that is not a point, a joint that is given, a joint with a speed
/// of its own, joints' axes and links that are not along the world's axes, and a pose in which drives are not sized.
pub fn spatial() -> Value {
    let mut chain = six_axes(
        boxes(&[STEEL, ALUMINIUM], json!([80, 140]), json!([100, 160]), json!([4])),
        boxes(&[STEEL, ALUMINIUM], json!([60, 100]), json!([60, 120]), json!([2, 5])),
    );
    // a gear's bearing as a part of its own, numbers, and rigid ones without mass
    chain[0]["bearing"] = json!("HFUC-45-100");
    for joint in [6, 8] {
        chain[joint]["bearing"] = Value::Null;
    }
    let stated = json!({"tilt_stiffness_nm_per_rad": 8e4, "permissible_moment_nm": 450, "mass_kg": 0.7, "offset_m": 0.04,
        "pitch_diameter_m": 0.06, "static_load_rating_n": 30000, "dynamic_load_rating_n": 19000});
    for joint in [2, 7] {
        chain[joint]["bearing"] = stated.clone();
    }
    chain[1]["mass_kg"] = json!(3.5);
    chain[4] = json!({"type": "joint", "name": "j3", "axis": [0, 1, 0.1], "mass_kg": 4.5,
        "bearing": {"tilt_stiffness_nm_per_rad": 2.5e5, "mass_kg": 0.4},
        "windup": {"k1_nm_per_rad": 1.3e5, "k2_nm_per_rad": 1.9e5, "k3_nm_per_rad": 2.2e5, "t1_nm": 40, "t2_nm": 110}});
    chain[5]["vector_m"] = json!([0.45, 0.1, 0.15]);
    chain[8]["max_speed_rad_s"] = json!(6.0);
    json!({
        "name": "brute-spatial", "extras": {"housing_kg": 0.3, "flange_kg": 0.12},
        "gravity_m_s2": 9.80665,
        "chain": chain,
        "payload": {"mass_kg": 4, "cg_m": [0.03, 0.02, 0.05], "inertia_about_cg_kgm2": [0.02, 0.03, 0.04]},
        "poses": [
            {"name": "folded", "pose_deg": [20, -70, 140, 10, 35, 0]},
            {"name": "twisted", "pose_deg": [75, -20, 40, 65, -50, 30], "tip_force_n": [20, -30, -10]},
            {"name": "passing", "pose_deg": [0, 10, -10, 90, 20, 0], "sizing": false,
                "payload": {"mass_kg": 8, "cg_m": [0, 0, 0.1]}}
        ],
        "motion": {"tip_speed_m_s": 0.8, "ramp_time_s": 0.25, "emergency_deceleration_m_s2": 8, "min_lever_m": 0.35,
            "life_h": 15000},
        "drives": {"motors": ["electric"], "gear_mass": "component_set"}
    })
}

/// Round tubes by the grid and whatever can be bought off the shelf.
pub fn sold() -> Value {
    let mut study = compare_materials();
    study["name"] = json!("brute-profiles");
    study["chain"] = six_axes(
        json!({"materials": [STEEL, "Aluminium 6082-T6"], "sections": [
            {"shape": "round_tube", "diameter_mm": [90, 130], "wall_mm": [3, 6]},
            {"profiles": {"family": "steel", "shapes": ["square"], "max_outer_mm": 90}},
            {"profiles": {"family": "aluminium", "max_outer_mm": 70}}]}),
        json!({"materials": [STEEL, "Aluminium 6082-T6"], "sections": [
            {"shape": "round_tube", "diameter_mm": {"from": 50, "to": 90, "step": 40}, "wall_mm": 2.5},
            {"shape": "rectangular_tube", "width_mm": 70, "height_mm": "=width", "wall_mm": 3}]}),
    );
    study
}

/// Thick walls, bars and a fibre that is weak in compression, with the wrist out of line so that links are twisted. The
/// least safety is one that Kevlar has in tension and not in compression.
pub fn stout() -> Value {
    let mut study = spatial();
    study["name"] = json!("brute-stout");
    let thick = json!({"shape": "rectangular_tube", "width_mm": [40, 70], "height_mm": [40, 60],
        "wall_mm": [6.1, 8, 15]});
    let flat = json!({"shape": "rectangular_bar", "width_mm": [20, 30], "height_mm": [20, 35]});
    let round = |sizes: Value| json!({"shape": "round_bar", "diameter_mm": sizes});
    let materials = [ALUMINIUM, KEVLAR];
    study["chain"][3]["choose"] = json!({"materials": materials, "sections": [thick, round(json!(35))]});
    study["chain"][5]["choose"] = json!({"materials": materials, "sections": [flat, round(json!([20, 30]))]});
    study["constraints"] = json!({"stress_safety_factor_min": 7, "wall_slenderness_max": 7.5});
    study
}

/// Effects of every kind that the finite elements know, at sized and at given joints, on open links and on an offset;
/// the arm in folded and twisted poses.
pub fn with_effects() -> Value {
    let mut study = spatial();
    study["name"] = json!("brute-effects");
    let spring = |c: f64| json!({"stiffness_nm_per_rad": c});
    study["effects"] = json!([
        {"effect": "connection_compliance", "at": "j2", "parameters": spring(6e5)},
        {"effect": "lost_motion", "at": "j5", "parameters": {"half_width_rad": 2e-4, "torque_nm": 8.0}},
        {"effect": "bearing_tilt", "at": "j3", "parameters": spring(1.5e5)},
        {"effect": "base_compliance", "at": "base", "parameters": spring(4e5)},
        {"effect": "extra_mass", "at": "j4", "parameters": {"delta_kg": 2.5}},
        {"effect": "harness_mass", "at": "upper_arm", "parameters": {"kg_per_m": 2.0}},
        {"effect": "harness_mass", "at": "shoulder", "parameters": {"kg_per_m": 1.5}},
        {"effect": "modulus_error", "at": "forearm", "parameters": {"factor": 0.8}},
        {"effect": "soft_windup", "at": "j3", "parameters": {"k1_nm_per_rad": 0.8e5, "k2_nm_per_rad": 1.6e5,
            "k3_nm_per_rad": 2.3e5, "t1_nm": 30, "t2_nm": 120}},
        {"effect": "joint_compliance", "at": "j1", "parameters": spring(9e5)}
    ]);
    // a spring in place of a joint's own is for rigid joints
    study["chain"][0] = json!({"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": null, "mass_kg": 14});
    study
}

/// The plane case of the named study, where motions within the plane and across it are solved apart.
pub fn flat_with_effects() -> Value {
    let mut study = compare_materials();
    study["name"] = json!("brute-flat-effects");
    study["effects"] = json!([
        {"effect": "bearing_tilt", "at": "j2", "parameters": {"stiffness_nm_per_rad": 1.2e5}},
        {"effect": "harness_mass", "at": "forearm", "parameters": {"kg_per_m": 3.0}}
    ]);
    study
}
