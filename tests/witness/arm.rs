//! The arm file, read into plain numbers.

use nalgebra::Vector3;
use serde_json::Value;

use super::joint_law::{JointLaw, ThreeSegment};
use super::section::Section;

/// An arm: what gravity pulls at, from base to tip.
pub struct Arm {
    pub gravity_m_s2: f64,
    /// Stiffness of the base about world x and y; none is rigid.
    pub base_nm_per_rad: Option<f64>,
    /// Feet that lift off about world x and y: stiffness beyond a moment, and that moment.
    pub base_lift: Option<(f64, f64)>,
    pub chain: Vec<Part>,
}

/// One entry of the chain.
pub enum Part {
    Joint(Joint),
    Link(Link),
}

/// A joint: a point mass on its axis, then a rotation about it.
pub struct Joint {
    pub name: String,
    /// Unit axis in the frame carried by the joints before.
    pub axis: Vector3<f64>,
    pub law: JointLaw,
    /// Stiffness of the output bearing about both axes across the joint's; none is rigid.
    pub tilt_nm_per_rad: Option<f64>,
    /// Stiffness of the housing about one axis across the joint's that stands still in the housing; none is rigid.
    pub lean_nm_per_rad: Option<f64>,
    pub mass_kg: f64,
    /// A torque on the joint beside weight and load: constant, with the sine and with the cosine of its angle.
    pub torque_nm: [f64; 3],
}

/// A link: a straight tube, or a rigid offset with a point mass at mid-length.
pub struct Link {
    pub name: String,
    pub vector_m: Vector3<f64>,
    pub tube: Option<Tube>,
    pub line: LineLoad,
    pub middle_mass_kg: f64,
}

/// What a link is made of.
pub struct Tube {
    pub section: Section,
    pub youngs_modulus_pa: f64,
    pub shear_modulus_pa: f64,
    pub density_kg_m3: f64,
}

/// What is spread along a link's axis in addition to the tube itself.
#[derive(Default)]
pub struct LineLoad {
    /// Mass that moves and weighs, on the axis.
    pub mass_kg_per_m: f64,
    /// Mass that resists motion across the link only, and weighs nothing.
    pub added_mass_kg_per_m: f64,
    /// Mass of the displaced fluid, whose weight pushes up.
    pub displaced_kg_per_m: f64,
}

impl Arm {
    pub fn from_json(file: &Value) -> Self {
        let parts = file["chain"].as_array().expect("an arm has a chain");
        let chain = parts.iter().map(|part| Part::from_json(part, &file["materials"])).collect();
        Self {
            gravity_m_s2: file["gravity_m_s2"].as_f64().unwrap_or(9.81),
            base_nm_per_rad: None,
            base_lift: None,
            chain,
        }
    }

    /// The joint of this name.
    pub fn joint_mut(&mut self, name: &str) -> &mut Joint {
        let joints = self.chain.iter_mut().filter_map(|part| match part {
            Part::Joint(joint) => Some(joint),
            Part::Link(_) => None,
        });
        joints.into_iter().find(|joint| joint.name == name).unwrap_or_else(|| panic!("no joint {name}"))
    }

    /// The link of this name.
    pub fn link_mut(&mut self, name: &str) -> &mut Link {
        self.links_mut().find(|link| link.name == name).unwrap_or_else(|| panic!("no link {name}"))
    }

    /// All links, base to tip.
    pub fn links_mut(&mut self) -> impl Iterator<Item = &mut Link> {
        self.chain.iter_mut().filter_map(|part| match part {
            Part::Link(link) => Some(link),
            Part::Joint(_) => None,
        })
    }
}

impl Part {
    fn from_json(part: &Value, materials: &Value) -> Self {
        match part["type"].as_str() {
            Some("joint") => Self::Joint(Joint::from_json(part)),
            Some("link") => Self::Link(Link::from_json(part, materials)),
            other => panic!("a part of the chain is a joint or a link, not {other:?}"),
        }
    }
}

impl Joint {
    fn from_json(joint: &Value) -> Self {
        let law = if joint["windup"].is_object() {
            JointLaw::three_segment(ThreeSegment::from_json(&joint["windup"]))
        } else if let Some(stiffness_nm_per_rad) = joint["stiffness_nm_per_rad"].as_f64() {
            JointLaw::linear(stiffness_nm_per_rad)
        } else {
            assert!(joint["gear"].is_null(), "the witness reads numbers, not catalogs: {joint}");
            JointLaw::rigid()
        };
        Self {
            name: name_of(joint),
            axis: vector(&joint["axis"]).normalize(),
            law,
            tilt_nm_per_rad: joint["bearing"]["tilt_stiffness_nm_per_rad"].as_f64(),
            lean_nm_per_rad: joint["lean_nm_per_rad"].as_f64(),
            mass_kg: joint_mass_kg(joint),
            torque_nm: [0.0; 3],
        }
    }
}

impl Link {
    fn from_json(link: &Value, materials: &Value) -> Self {
        let has_section = link["section"].is_object();
        let tube = has_section.then(|| {
            let material_name = link["material"].as_str().expect("a link with a section has a material");
            Tube::from_json(&link["section"], &materials[material_name])
        });
        let mass_kg = link["mass_kg"].as_f64().unwrap_or(0.0);
        Self {
            name: name_of(link),
            vector_m: vector(&link["vector_m"]),
            tube,
            line: LineLoad::default(),
            middle_mass_kg: if has_section { 0.0 } else { mass_kg },
        }
    }
}

impl Tube {
    fn from_json(section: &Value, material: &Value) -> Self {
        let poisson = material["poisson"].as_f64().unwrap_or(0.3);
        Self {
            section: Section::from_json(section, poisson),
            youngs_modulus_pa: number(material, "youngs_modulus_pa"),
            shear_modulus_pa: number(material, "shear_modulus_pa"),
            density_kg_m3: number(material, "density_kg_m3"),
        }
    }
}

/// Drive, bearing and extras of a joint.
fn joint_mass_kg(joint: &Value) -> f64 {
    let extras = joint["extras"].as_object();
    let extras_kg: f64 = extras.map_or(0.0, |extras| extras.values().filter_map(Value::as_f64).sum());
    let of = |part: &Value| part["mass_kg"].as_f64().unwrap_or(0.0);
    of(joint) + of(&joint["bearing"]) + extras_kg
}

fn name_of(part: &Value) -> String {
    part["name"].as_str().expect("a part of the chain has a name").to_owned()
}

/// A number that must be there.
pub fn number(object: &Value, key: &str) -> f64 {
    object[key].as_f64().unwrap_or_else(|| panic!("no number `{key}` in {object}"))
}

/// Three numbers that must be there.
pub fn vector(value: &Value) -> Vector3<f64> {
    let component = |i: usize| value[i].as_f64().unwrap_or_else(|| panic!("not three numbers: {value}"));
    Vector3::new(component(0), component(1), component(2))
}
