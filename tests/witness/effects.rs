//! Physics that a built arm may have and its arm file lacks.

use nalgebra::Vector3;
use serde_json::Value;
use std::collections::BTreeMap;

use super::arm::{Arm, Link, number, vector};
use super::joint_law::{JointLaw, Term, ThreeSegment};
use super::load_case::LoadCase;

/// A joint's backlash-like softness about zero torque: h tanh(T / T_c).
#[derive(Clone, Copy, Debug)]
pub struct LostMotion {
    pub half_width_rad: f64,
    pub torque_nm: f64,
}

/// The arm under water: links are sealed tubes, joints are indifferent.
#[derive(Clone, Copy, Debug)]
pub struct Immersion {
    pub water_density_kg_m3: f64,
    pub added_mass_coefficient: f64,
    /// None: the payload is not buoyant.
    pub payload_density_kg_m3: Option<f64>,
}

/// Extra effects, each by the name of its place; the default is none at all.
#[derive(Clone, Debug, Default)]
pub struct Effects {
    /// Joint: stiffness in series with the joint's own.
    pub connection_compliance_nm_per_rad: BTreeMap<String, f64>,
    /// Joint: the curve that replaces the joint's number.
    pub soft_windup: BTreeMap<String, ThreeSegment>,
    /// Joint: extra angle about zero torque.
    pub lost_motion: BTreeMap<String, LostMotion>,
    /// Joint: stiffness about each of the two axes across the joint's.
    pub bearing_tilt_nm_per_rad: BTreeMap<String, f64>,
    /// Joint: a spring where the arm file has none.
    pub joint_compliance_nm_per_rad: BTreeMap<String, f64>,
    /// Stiffness about world x and about world y at the origin.
    pub base_compliance_nm_per_rad: Option<f64>,
    /// True payload mass minus the stated one.
    pub payload_mass_error_kg: f64,
    /// True payload centre minus the stated one, last frame.
    pub payload_cg_error_m: Vector3<f64>,
    /// Joint: point mass beyond the stated one.
    pub extra_mass_kg: BTreeMap<String, f64>,
    /// Link: line mass along the axis, without stiffness.
    pub harness_kg_per_m: BTreeMap<String, f64>,
    /// Link: factor on Young's modulus; the shear modulus stays.
    pub modulus_factor: BTreeMap<String, f64>,
    pub immersion: Option<Immersion>,
    /// Feet that lift off: stiffness beyond a moment about world x or y, and that moment.
    pub base_lift: Option<(f64, f64)>,
    /// Joint: a torque beside weight and load, constant, with the sine and with the cosine of the joint's angle.
    pub joint_torque_nm: BTreeMap<String, [f64; 3]>,
}

impl Effects {
    /// The `effects` array of an arm file.
    pub fn from_json(effects: &Value) -> Self {
        let mut all = Self::default();
        effects.as_array().into_iter().flatten().for_each(|effect| all.insert(effect));
        all
    }

    fn insert(&mut self, effect: &Value) {
        let name = effect["effect"].as_str().expect("an effect has a name");
        let at = effect["at"].as_str().expect("an effect has a place").to_owned();
        let parameters = &effect["parameters"];
        let parameter = |key: &str| number(parameters, key);
        match name {
            "connection_compliance" => {
                self.connection_compliance_nm_per_rad.insert(at, parameter("stiffness_nm_per_rad"));
            }
            "soft_windup" => {
                self.soft_windup.insert(at, ThreeSegment::from_json(parameters));
            }
            "lost_motion" => {
                self.lost_motion.insert(at, LostMotion::from_json(parameters));
            }
            "bearing_tilt" => {
                self.bearing_tilt_nm_per_rad.insert(at, parameter("stiffness_nm_per_rad"));
            }
            "joint_compliance" => {
                self.joint_compliance_nm_per_rad.insert(at, parameter("stiffness_nm_per_rad"));
            }
            "base_compliance" => self.base_compliance_nm_per_rad = Some(parameter("stiffness_nm_per_rad")),
            "payload_mass_error" => self.payload_mass_error_kg = parameter("delta_kg"),
            "payload_cg_error" => self.payload_cg_error_m = vector(&parameters["offset_m"]),
            "extra_mass" => {
                self.extra_mass_kg.insert(at, parameter("delta_kg"));
            }
            "harness_mass" => {
                self.harness_kg_per_m.insert(at, parameter("kg_per_m"));
            }
            "modulus_error" => {
                self.modulus_factor.insert(at, parameter("factor"));
            }
            "joint_torque" => {
                let part = |key: &str| parameters[key].as_f64().unwrap_or(0.0);
                self.joint_torque_nm.insert(at, ["offset_nm", "sin_nm", "cos_nm"].map(part));
            }
            "base_lift" => {
                self.base_lift = Some((parameter("stiffness_nm_per_rad"), parameter("preload_nm")));
            }
            "immersion" => self.immersion = Some(Immersion::from_json(parameters)),
            other => panic!("the witness does not know the effect {other}"),
        }
    }
}

impl LostMotion {
    fn from_json(parameters: &Value) -> Self {
        Self {
            half_width_rad: number(parameters, "half_width_rad"),
            torque_nm: number(parameters, "torque_nm"),
        }
    }
}

impl Immersion {
    fn from_json(parameters: &Value) -> Self {
        Self {
            water_density_kg_m3: number(parameters, "water_density_kg_m3"),
            added_mass_coefficient: number(parameters, "added_mass_coefficient"),
            payload_density_kg_m3: parameters["payload_density_kg_m3"].as_f64(),
        }
    }
}

/// The arm with the effects that belong to it. A name that is not in the arm is a panic.
pub fn applied_to_arm(mut arm: Arm, effects: &Effects) -> Arm {
    apply_to_joints(&mut arm, effects);
    arm.base_nm_per_rad = effects.base_compliance_nm_per_rad;
    arm.base_lift = effects.base_lift;
    for (name, kg_per_m) in &effects.harness_kg_per_m {
        arm.link_mut(name).line.mass_kg_per_m += kg_per_m;
    }
    for (name, factor) in &effects.modulus_factor {
        let tube = arm.link_mut(name).tube.as_mut();
        tube.unwrap_or_else(|| panic!("{name} has no modulus")).youngs_modulus_pa *= factor;
    }
    if let Some(immersion) = effects.immersion {
        arm.links_mut().for_each(|link| immerse(link, &immersion));
    }
    arm
}

fn apply_to_joints(arm: &mut Arm, effects: &Effects) {
    // Whatever replaces a joint's number comes before whatever is in series with it.
    for (name, curve) in &effects.soft_windup {
        arm.joint_mut(name).law = JointLaw::three_segment(*curve);
    }
    for (name, stiffness_nm_per_rad) in &effects.joint_compliance_nm_per_rad {
        arm.joint_mut(name).law = JointLaw::linear(*stiffness_nm_per_rad);
    }
    for (name, stiffness_nm_per_rad) in &effects.connection_compliance_nm_per_rad {
        let connection = Term::Linear { stiffness_nm_per_rad: *stiffness_nm_per_rad };
        arm.joint_mut(name).law.terms.push(connection);
    }
    for (name, &LostMotion { half_width_rad, torque_nm }) in &effects.lost_motion {
        arm.joint_mut(name).law.terms.push(Term::LostMotion { half_width_rad, torque_nm });
    }
    for (name, stiffness_nm_per_rad) in &effects.bearing_tilt_nm_per_rad {
        // in series with the joint's own bearing
        let own = arm.joint_mut(name).tilt_nm_per_rad.map_or(0.0, |own| 1.0 / own);
        arm.joint_mut(name).tilt_nm_per_rad = Some(1.0 / (own + 1.0 / stiffness_nm_per_rad));
    }
    for (name, torque_nm) in &effects.joint_torque_nm {
        arm.joint_mut(name).torque_nm = *torque_nm;
    }
    for (name, delta_kg) in &effects.extra_mass_kg {
        arm.joint_mut(name).mass_kg += delta_kg;
    }
}

fn immerse(link: &mut Link, immersion: &Immersion) {
    if let Some(tube) = &link.tube {
        link.line.displaced_kg_per_m = immersion.water_density_kg_m3 * tube.section.outer_area_m2;
        link.line.added_mass_kg_per_m = immersion.added_mass_coefficient * link.line.displaced_kg_per_m;
    }
}

/// The load case with the effects that belong to the payload.
pub fn applied_to_case(case: &LoadCase, effects: &Effects) -> LoadCase {
    let mut case = case.clone();
    // An empty hand states no payload, so there is nothing to be wrong about.
    if case.payload.mass_kg > 0.0 {
        case.payload.mass_kg += effects.payload_mass_error_kg;
        case.payload.cg_m += effects.payload_cg_error_m;
    }
    let buoyant = effects.immersion.and_then(|i| Some(i.water_density_kg_m3 / i.payload_density_kg_m3?));
    case.payload.weight_factor -= buoyant.unwrap_or(0.0);
    case
}
