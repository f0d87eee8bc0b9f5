//! The reader of the arm file.

use super::MOST_ELEMENTS;
use super::bearing::{Bearing, Stated, read_bearing};
use super::body::read_joint_bodies;
use super::effect::channel::Channel;
use super::effect::entry::Effect;
use super::effect::servo_compliance;
use super::element_keys::{read_axis, read_coupling, read_name};
use super::element_names::check_names;
use super::extras::read_extras;
use super::file_keys::{ARM, EFFECT, JOINT, LINK, MATERIAL};
use super::joint_law::{Curve, Windup};
use super::keys::WINDUP;
use super::link_file::{DEFAULT_POISSON, NamedMaterial};
use super::load::vector;
use super::pieces::{elements_of, read_links};
use super::prismatic::Prismatic;
use super::prismatic_keys::PRISMATIC;
use super::section::{LinkMaterial, Strength};
use super::springs::Spring;
use super::springs_file::{BodiesOf, Named, Values, hang, read_counterweights, read_springs};
use super::transmission::{Seen, Transmission, gear_is_at_motor, read_turns_with};
use super::transmissions::{Driven, place_all};
use super::{Arm, Element, GRAVITY_M_S2, Joint};
use crate::catalog::gear::{Gear, GearMass};
use crate::catalog::material::MaterialClass;
use crate::catalog::{Catalogs, PartError};
use crate::input::json::{Document, Faults, InputError, Node, Object};
use nalgebra::{Unit, Vector3};
use serde_json::Value;
use std::path::Path;

/// Reads an arm file. Gears, motors and materials that it names are looked up in `catalogs`.
///
/// # Errors
/// [`InputError::Unreadable`] if the file cannot be read, [`InputError::Faulty`] with all of its faults.
pub fn read_arm(path: &Path, catalogs: &Catalogs) -> Result<Arm, InputError> {
    Ok(read_arm_document(Document::read(path)?, catalogs)?)
}

/// Reads an arm from a parsed document. Gears, motors and materials that it names are looked up in `catalogs`.
///
/// # Errors
/// All faults of the document at once.
///
/// ```
/// use armwright::arm::read_arm_document;
/// use armwright::catalog::Catalogs;
/// use armwright::input::Document;
///
/// let catalogs = Catalogs::builtin();
/// let text = r#"{"name": "one joint", "chain": [
///     {"type": "joint", "name": "j2", "axis": [0, 1, 0], "gear": "HFUC-58-100", "motor": "F11-10"},
///     {"type": "link", "name": "arm", "vector_m": [0.8, 0, 0], "mass_kg": 3}]}"#;
/// let arm = read_arm_document(Document::parse("arm.json", text).expect("JSON"), &catalogs).expect("a sound arm");
/// assert_eq!(arm.driven_joint_names(), ["j2"]);
///
/// let faulty = text.replace("[0, 1, 0]", "[0, 0, 0]");
/// let faults = read_arm_document(Document::parse("arm.json", &faulty).expect("JSON"), &catalogs);
/// assert_eq!(faults.expect_err("the axis has no direction").0[0].field, "chain[0].axis");
/// ```
pub fn read_arm_document(document: Document, catalogs: &Catalogs) -> Result<Arm, Faults> {
    let arm = arm(&document.root(), catalogs);
    document.finish(arm)
}

/// Reads an arm from the object `node`, which may be a part of a larger document. Returns `None` after recording a
/// fault.
pub(crate) fn arm(node: &Node, catalogs: &Catalogs) -> Option<Arm> {
    let root = node.shaped(&ARM)?;
    let name = root.or("name", "arm".to_string(), |n| n.string().map(String::from));
    let gravity = read_gravity(&root);
    let materials = root.or("materials", Vec::new(), read_materials).unwrap_or_default();
    let chain = root.required("chain").and_then(|n| read_chain(&n, &materials, catalogs));
    let effects = root.or("effects", Vec::new(), read_effects);
    let (gravity_m_s2, down) = gravity?;
    let (mut chain, driven) = chain?;
    place_transmissions(&mut chain, &driven)?;
    let springs = read_balance(&root, &mut chain);
    let arm = Arm { name: name?, gravity_m_s2, down, chain, effects: effects?, springs: springs? };
    check_names(&arm, &root)?;
    check_effects(&arm, &root)?;
    Some(arm)
}

/// Adds the masses of motors and stages to the elements on which they sit, and writes into every joint which other
/// joints turn it. Returns `None` after recording a fault.
fn place_transmissions(chain: &mut [Element], driven: &[Driven]) -> Option<()> {
    let seen: Vec<Seen> = chain.iter().map(Element::seen).collect();
    for (joint, placed) in place_all(driven, &seen)? {
        if let (Element::Joint(joint), Some(terms)) = (&mut chain[joint], placed.turns_with) {
            joint.turns_with = terms;
        }
        placed.hung.iter().for_each(|hung| chain[hung.element].carrier().carry(hung));
    }
    Some(())
}

/// Reads the springs of an arm, and adds its counterweights to the bodies of the elements on which they sit. Returns
/// `None` after recording a fault.
fn read_balance(root: &Object, chain: &mut [Element]) -> Option<Vec<Spring>> {
    let named: Vec<Named> = chain.iter().map(|e| (e.name(), matches!(e, Element::Joint(_)))).collect();
    let springs = read_springs(root, &named, Values::One);
    let counterweights = read_counterweights(root, &named, Values::One);
    let bodies = chain.iter_mut().map(|element| match element {
        Element::Joint(joint) => BodiesOf::Joint(&mut joint.bodies),
        Element::Prismatic(joint) => BodiesOf::Joint(&mut joint.bodies),
        Element::Link(link) => BodiesOf::Link(&mut link.bodies),
    });
    hang(counterweights?, bodies.collect());
    springs
}

/// Reads the key `gravity_m_s2`: the acceleration along world -z, or a vector in the world; 0 means no gravity. Returns
/// the magnitude of the acceleration \[m/s²\] and its direction. Returns `None` after recording a fault.
pub(crate) fn read_gravity(object: &Object) -> Option<(f64, Vector3<f64>)> {
    let upright = -Vector3::z();
    object.or("gravity_m_s2", (GRAVITY_M_S2, upright), |n| match n.value() {
        Value::Array(_) => {
            let acceleration = vector(n)?;
            let direction = Unit::try_new(acceleration, 0.0).map_or(upright, Unit::into_inner);
            Some((acceleration.norm(), direction))
        }
        _ => n.non_negative().map(|m_s2| (m_s2, upright)),
    })
}

fn read_materials(node: &Node) -> Option<Vec<NamedMaterial>> {
    Some(node.entries()?.iter().map(|(name, n)| (name.to_string(), read_material(n))).collect())
}

fn read_material(node: &Node) -> Option<LinkMaterial> {
    let object = node.shaped(&MATERIAL)?;
    let positive = |key| object.required(key).and_then(|n| n.positive());
    let (youngs, shear, density) =
        (positive("youngs_modulus_pa"), positive("shear_modulus_pa"), positive("density_kg_m3"));
    let poisson = object.or("poisson", DEFAULT_POISSON, |n| match n.number()? {
        nu if (-1.0..=0.5).contains(&nu) => Some(nu),
        nu => n.fault(format!("= {nu} is not a Poisson's ratio"), "give a number from -1 to 0.5"),
    });
    let class = object.optional("class").map(|n| read_class(&n));
    let material = LinkMaterial {
        youngs_modulus_pa: youngs?,
        shear_modulus_pa: shear?,
        density_kg_m3: density?,
        poisson: poisson?,
        strength: None,
        class: class.map_or(Some(None), |read| read.map(Some))?,
    };
    read_strength(node, &object, &material).map(|strength| LinkMaterial { strength, ..material })
}

/// Reads the strength of a material, `Some(None)` if none is stated. Returns `None` after recording a fault.
fn read_strength(node: &Node, object: &Object, material: &LinkMaterial) -> Option<Option<Strength>> {
    let positive = |key| object.or(key, None, |n| n.positive().map(Some));
    match (positive("strength_pa")?, positive("shear_strength_pa")?) {
        (None, Some(_)) => node.fault(
            "has shear_strength_pa without strength_pa",
            "add strength_pa, the strength along the link in Pa: both stresses are judged together",
        ),
        (Some(_), None) if material.is_soft_in_shear() => node.fault(
            "has strength_pa without shear_strength_pa, and its shear modulus is less than half of E/2(1+nu)",
            "add shear_strength_pa, the strength in shear in Pa: of such a material it does not follow from strength_pa",
        ),
        (along_pa, shear_pa) => Some(along_pa.map(|along_pa| Strength { along_pa, shear_pa })),
    }
}

/// Reads the class of a material. Returns `None` after recording a fault.
fn read_class(node: &Node) -> Option<MaterialClass> {
    let word = node.string()?;
    MaterialClass::from_word(word).or_else(|| {
        node.fault(
            format!("\"{word}\" is no class of materials"),
            &format!("choose one of: {}", MaterialClass::WORDS.join(", ")),
        )
    })
}

/// Reads the elements of the chain, and how the joints among them are driven. Returns `None` after recording a fault.
fn read_chain<'n>(
    node: &Node<'n>,
    materials: &[NamedMaterial],
    catalogs: &Catalogs,
) -> Option<(Vec<Element>, Vec<Driven<'n>>)> {
    let items = node.array()?;
    if items.is_empty() {
        return node.fault("is empty", "an arm has at least one joint or link");
    }
    let elements: usize = items.iter().map(elements_of).sum();
    if elements > MOST_ELEMENTS {
        let problem = format!("has {elements} joints and links, and the limit is {MOST_ELEMENTS}");
        return node.fault(problem, "join links that lie in line, or model a part of the arm");
    }
    let read: Vec<_> = items.iter().map(|n| read_element(n, materials, catalogs)).collect();
    let (mut chain, mut driven) = (Vec::new(), Vec::new());
    for (read, node) in read.into_iter().collect::<Option<Vec<_>>>()?.into_iter().zip(items) {
        if let [Element::Joint(joint)] = read.elements.as_slice() {
            let turns_with = joint.turns_with.clone();
            driven.push(Driven { node, joint: chain.len(), transmission: read.transmission, turns_with });
        }
        chain.extend(read.elements);
    }
    Some((chain, driven))
}

/// An item of the chain as it is read: a link may have several pieces, a joint a transmission.
struct Item {
    elements: Vec<Element>,
    transmission: Option<Transmission>,
}

impl From<Vec<Element>> for Item {
    fn from(elements: Vec<Element>) -> Self {
        Self { elements, transmission: None }
    }
}

/// Fault of an element whose type is missing or unknown: the problem, and the advice how to mend it.
pub(crate) const NO_TYPE: (&str, &str) = (
    "has no \"type\" of \"joint\", \"prismatic\" or \"link\"",
    "add \"type\": \"joint\" (it turns), \"prismatic\" (it slides) or \"link\"",
);

/// Reads a joint, or a link with its pieces. Returns `None` after recording a fault.
fn read_element(node: &Node, materials: &[NamedMaterial], catalogs: &Catalogs) -> Option<Item> {
    let kind = node.value().get("type").and_then(|v| v.as_str());
    match kind {
        Some("joint") => {
            let (joint, transmission) = read_joint(&node.shaped(&JOINT)?, catalogs)?;
            Some(Item { elements: vec![Element::Joint(joint)], transmission })
        }
        Some("prismatic") => {
            Prismatic::read(&node.shaped(&PRISMATIC)?).map(|joint| vec![Element::Prismatic(joint)].into())
        }
        Some("link") => {
            let links = read_links(&node.shaped(&LINK)?, materials, catalogs)?;
            Some(links.into_iter().map(Element::Link).collect::<Vec<_>>().into())
        }
        _ => node.fault(NO_TYPE.0, NO_TYPE.1),
    }
}

fn read_joint(object: &Object, catalogs: &Catalogs) -> Option<(Joint, Option<Transmission>)> {
    let name = read_name(object);
    let axis = object.required("axis").and_then(|n| read_axis(&n));
    let text = |key| object.or(key, None, |n| n.string().map(|s| Some(s.to_string())));
    let (gear, motor) = (text("gear"), text("motor"));
    let curve = read_curve(object, catalogs);
    let mass_kg = read_joint_mass(object, catalogs);
    let bearing = read_joint_bearing(object, catalogs);
    let extras = read_extras(object);
    let bodies = read_joint_bodies(object);
    let coupled = object.or("coupled", None, |n| read_coupling(n).map(Some));
    let turns_with = read_turns_with(object);
    let transmission = Transmission::read(object, catalogs, motor_side_kg(object, catalogs));
    let (curve, transmission) = (curve?, transmission?);
    let joint = Joint {
        name: name?,
        axis: axis?,
        curve: transmission.as_ref().map_or(curve, |transmission| transmission.curve(curve)),
        mass_kg: mass_kg?,
        bearing: bearing?,
        extras: extras?,
        bodies: bodies?,
        gear: gear?,
        motor: motor?,
        coupled: coupled?,
        stages: transmission.as_ref().map_or_else(Default::default, |t| t.stages().rigid()),
        turns_with: turns_with?,
    };
    Some((joint, transmission))
}

/// The output bearing of a joint: the bearing that the file states, else the bearing of the named gear if the catalogs
/// know this gear and it sits at the joint. The inner `None` means that the joint has no bearing, the outer `None` that
/// a fault was recorded.
pub(crate) fn read_joint_bearing(object: &Object, catalogs: &Catalogs) -> Option<Option<Bearing>> {
    if let Stated::Bearing(bearing) = read_bearing(object, catalogs)? {
        return Some(bearing);
    }
    let which = read_gear_mass(object)?;
    // a name next to explicit numbers need not be in a catalog, and the bearing of a gear that sits elsewhere is not
    // the bearing of the joint
    let gear = object
        .optional("gear")
        .filter(|_| !gear_is_at_motor(object))
        .and_then(|n| catalogs.gear(n.value().as_str()?).ok());
    Some(gear.and_then(|gear| Bearing::of_gear(gear, which)))
}

/// The torsion curve of a joint: the numbers that the file states, else the curve of the named gear in the catalog.
/// Returns `None` after recording a fault.
pub(crate) fn read_curve(object: &Object, catalogs: &Catalogs) -> Option<Curve> {
    match (object.optional("stiffness_nm_per_rad"), object.optional("windup"), object.optional("gear")) {
        (Some(stiffness), Some(_), _) => {
            stiffness.fault("and \"windup\" are both given", "keep the one that holds")
        }
        (Some(stiffness), None, _) if stiffness.is_null() => Some(Curve::Rigid),
        (Some(stiffness), None, _) => stiffness.positive().map(Curve::Linear),
        (None, Some(windup), _) => read_windup(&windup).map(Curve::Windup),
        (None, None, Some(gear)) => gear_windup(find_gear(&gear, catalogs)?, &gear).map(Curve::Windup),
        // a linkage turns a passive joint, which usually has no drive that could twist
        (None, None, None) if object.has("coupled") => Some(Curve::Rigid),
        (None, None, None) => object.node().fault(
            "says nothing of its stiffness",
            "add \"stiffness_nm_per_rad\" (null = rigid), \"windup\" or \"gear\"",
        ),
    }
}

fn read_windup(node: &Node) -> Option<Windup> {
    let object = node.shaped(&WINDUP)?;
    let positive = |key| object.required(key).and_then(|n| n.positive());
    let [k1, k2, k3, t1, t2] =
        ["k1_nm_per_rad", "k2_nm_per_rad", "k3_nm_per_rad", "t1_nm", "t2_nm"].map(positive);
    let windup =
        Windup { k1_nm_per_rad: k1?, k2_nm_per_rad: k2?, k3_nm_per_rad: k3?, t1_nm: t1?, t2_nm: t2? };
    if windup.t1_nm > windup.t2_nm {
        return node.fault(
            format!("t1_nm = {} is beyond t2_nm = {}", windup.t1_nm, windup.t2_nm),
            "the first segment ends before the second",
        );
    }
    Some(windup)
}

fn find_gear<'c>(node: &Node, catalogs: &'c Catalogs) -> Option<&'c Gear> {
    const LISTS: &str = "`armwright catalog show gears` lists them";
    let told = |e: PartError| {
        let said = e.to_string();
        let hint = if said.contains(LISTS) { "" } else { LISTS };
        node.fault::<()>(said, hint)
    };
    catalogs.gear(node.string()?).map_err(told).ok()
}

/// The torsion curve of a gear in the catalog; `None` if a slope or a break point is blank.
pub(crate) fn windup_of(gear: &Gear) -> Option<Windup> {
    if let Some(stiffness_nm_per_rad) = gear.single_slope_nm_per_rad() {
        return Some(Windup::straight(stiffness_nm_per_rad));
    }
    Some(Windup {
        k1_nm_per_rad: gear.k1_nm_per_rad?,
        k2_nm_per_rad: gear.k2_nm_per_rad?,
        k3_nm_per_rad: gear.k3_nm_per_rad?,
        t1_nm: gear.t1_nm?,
        t2_nm: gear.t2_nm?,
    })
}

fn gear_windup(gear: &Gear, node: &Node) -> Option<Windup> {
    windup_of(gear).or_else(|| {
        node.fault(
            format!(
                "gear \"{}\" has no complete torsion curve: no {}",
                gear.id,
                gear.missing_of_torsion().join(", ")
            ),
            "give \"windup\" or \"stiffness_nm_per_rad\"",
        )
    })
}

/// Mass of the parts that sit at a joint \[kg\]: the key `mass_kg` if it is given, else gear plus motor from the
/// catalog, else zero. A motor that sits elsewhere is left out, and so is a gear that sits at this motor. Returns
/// `None` after recording a fault.
pub(crate) fn read_joint_mass(object: &Object, catalogs: &Catalogs) -> Option<f64> {
    let which = read_gear_mass(object)?;
    if let Some(mass) = object.optional("mass_kg") {
        return mass.non_negative();
    }
    let is_elsewhere = object.has("motor_at");
    let gear = match object.optional("gear").filter(|_| !(is_elsewhere && gear_is_at_motor(object))) {
        Some(node) => part_mass(&node, find_gear(&node, catalogs)?.mass_kg(which))?,
        None => 0.0,
    };
    let motor = match object.optional("motor").filter(|_| !is_elsewhere) {
        Some(node) => part_mass(&node, find_motor_mass(&node, catalogs)?)?,
        None => 0.0,
    };
    Some(gear + motor)
}

/// Mass of the parts that sit at a motor away from its joint \[kg\]. It is the value of the key `motor_mass_kg`.
/// Without this key it is the catalog's mass of the motor, plus the mass of the gear if the gear sits at the motor. It
/// is zero if the motor sits at its joint. Returns `None` after recording a fault.
pub(crate) fn motor_side_kg(object: &Object, catalogs: &Catalogs) -> Option<f64> {
    if !object.has("motor_at") {
        return Some(0.0);
    }
    if let Some(mass) = object.optional("motor_mass_kg") {
        return mass.non_negative();
    }
    let which = read_gear_mass(object)?;
    let gear = match object.optional("gear").filter(|_| gear_is_at_motor(object)) {
        Some(node) => part_mass(&node, find_gear(&node, catalogs)?.mass_kg(which))?,
        None => 0.0,
    };
    let motor = match object.optional("motor") {
        Some(node) => part_mass(&node, find_motor_mass(&node, catalogs)?)?,
        None => 0.0,
    };
    Some(gear + motor)
}

/// Reads which mass of a joint's gear counts: component set, or housed unit, which is the default. Returns `None` after
/// recording a fault.
pub(crate) fn read_gear_mass(object: &Object) -> Option<GearMass> {
    object.or("gear_mass", GearMass::HousedUnit, |n| match n.string()? {
        "component_set" => Some(GearMass::ComponentSet),
        "housed_unit" => Some(GearMass::HousedUnit),
        other => n.fault(format!("\"{other}\" is not known"), "choose one of: component_set, housed_unit"),
    })
}

fn find_motor_mass(node: &Node, catalogs: &Catalogs) -> Option<Option<f64>> {
    let hint = "`armwright catalog show motors` lists them; or give \"mass_kg\"";
    catalogs.motor(node.string()?).map(|m| m.mass_kg).map_err(|e| node.fault::<()>(e.to_string(), hint)).ok()
}

fn part_mass(node: &Node, mass_kg: Option<f64>) -> Option<f64> {
    mass_kg.or_else(|| node.fault("has no mass in the catalog", "give the joint's \"mass_kg\""))
}

/// Reads a list of effects. Whether each effect fits its arm is checked later. Returns `None` after recording a fault.
pub(crate) fn read_effects(node: &Node) -> Option<Vec<Effect>> {
    let read: Vec<_> = node.array()?.iter().map(read_effect).collect();
    read.into_iter().collect()
}

fn read_effect(node: &Node) -> Option<Effect> {
    let object = node.shaped(&EFFECT)?;
    let text = |key| object.required(key).and_then(|n| n.string().map(String::from));
    let (effect, at) = (text("effect"), text("at"));
    let parameters = object.required("parameters").and_then(|n| read_parameters(&n));
    let source = object.optional("source").map(|n| n.value().clone());
    Some(Effect { effect: effect?, at: at?, parameters: parameters?, source })
}

fn read_parameters(node: &Node) -> Option<Vec<(String, Vec<f64>)>> {
    let read: Vec<_> = node
        .entries()?
        .iter()
        .map(|(name, n)| {
            let numbers = match n.value() {
                _ if *name == servo_compliance::CHANNEL => vec![read_channel(n)?],
                Value::Array(_) => n.array()?.iter().map(Node::number).collect::<Option<Vec<_>>>()?,
                _ => vec![n.number()?],
            };
            Some((name.to_string(), numbers))
        })
        .collect();
    read.into_iter().collect()
}

/// The number that stands for a measuring channel in the list of parameters, read from the word for the channel.
/// Returns `None` after recording a fault.
fn read_channel(node: &Node) -> Option<f64> {
    let word = node.string()?;
    match Channel::from_word(word) {
        Some(channel) => Some(channel as usize as f64),
        None => {
            let words = Channel::ALL.map(Channel::word).join(", ");
            node.fault(format!("\"{word}\" is no channel"), &format!("choose one of: {words}"))
        }
    }
}

/// Checks the place and the parameters of every effect of the arm. Returns `None` after recording a fault.
fn check_effects(arm: &Arm, root: &Object) -> Option<()> {
    let Some(node) = root.optional("effects") else { return Some(()) };
    let joints = super::JointModel::default();
    let structure = arm.nominal_structure(joints);
    let mut sound = true;
    for (effect, node) in arm.effects.iter().zip(node.array()?) {
        for fault in effect.faults(&structure) {
            sound = false;
            node.fault_below::<()>(&fault.field, fault.problem, &fault.hint);
        }
    }
    sound.then_some(())?;
    let (before_kg, after_kg) = (structure.mass_kg(), arm.structure(joints).mass_kg());
    if after_kg < before_kg.min(0.0) {
        let problem =
            format!("the arm, which weighs {before_kg:.3} kg, weighs {after_kg:.3} kg with its effects");
        return node.fault(problem, "take away less than the mass of the arm");
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const ARM: &str = r#"{"name": "two", "materials": {"steel": {"youngs_modulus_pa": 2.1e11,
        "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}},
      "chain": [
       {"type": "joint", "name": "j2", "axis": [0,2,0], "stiffness_nm_per_rad": 607e3, "mass_kg": 12.2},
       {"type": "link", "name": "upper", "vector_m": [0.8,0,0], "material": "steel",
        "section": {"shape": "rectangular_tube", "width_m": 0.16, "height_m": 0.16, "wall_m": 0.01}}]}"#;

    fn read(text: &str) -> Result<Arm, Faults> {
        read_arm_document(Document::parse("arm.json", text)?, &Catalogs::default())
    }

    #[test]
    fn effects_take_away_less_than_the_arm_weighs() {
        let with = |delta_kg: f64| {
            let effect = json!({"effect": "extra_mass", "at": "j2", "parameters": {"delta_kg": delta_kg}});
            let mut arm: serde_json::Value = serde_json::from_str(ARM).expect("JSON");
            arm["effects"] = json!([effect]);
            read(&arm.to_string())
        };
        let arm_kg = with(0.0).expect("a sound arm").structure(crate::arm::JointModel::default()).mass_kg();
        with(-0.9 * arm_kg).expect("a tenth of the arm is left");
        let faults = with(-1.1 * arm_kg).expect_err("an arm of negative mass").0;
        assert_eq!((faults.len(), faults[0].field.as_str()), (1, "effects"));
        assert!(
            faults[0].to_string().contains(&format!("{:.3} kg with its effects", -0.1 * arm_kg)),
            "{}",
            faults[0]
        );
    }

    #[test]
    fn an_arm_is_read_with_its_axis_normalised() {
        let arm = read(ARM).expect("sound");
        let joint = arm.joints().next().expect("one joint");
        assert_eq!(joint.axis.into_inner(), Vector3::new(0.0, 1.0, 0.0));
        assert!((arm.mass_kg() - (12.2 + 7850.0 * 0.006 * 0.8)).abs() < 1e-12);
    }

    #[test]
    fn every_fault_of_a_file_is_reported_with_its_line() {
        let text = ARM
            .replace("\"wall_m\": 0.01", "\"wall_m\": -0.01")
            .replace("607e3", "-1")
            .replace("\"material\": \"steel\"", "\"material\": \"steal\"")
            .replace("\"axis\": [0,2,0]", "\"axis\": [0,0,0]");
        let faults = read(&text).expect_err("four faults").0;
        let lines: Vec<_> = faults.iter().map(|f| (f.line.expect("line"), f.field.as_str())).collect();
        assert_eq!(
            lines,
            [
                (4, "chain[0].axis"),
                (4, "chain[0].stiffness_nm_per_rad"),
                (6, "chain[1].section.wall_m"),
                (5, "chain[1].material")
            ]
        );
    }
}
