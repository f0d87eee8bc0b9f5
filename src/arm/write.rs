//! Writing the arm file.

use super::bearing::Bearing;
use super::effect::entry::{Effect, word_of};
use super::extras::Extras;
use super::joint_law::Curve;
use super::section::{Section, Strength};
use super::{Arm, Element, Joint, Link, LinkBody};
use nalgebra::Vector3;
use serde_json::{Map, Value, json};

impl Arm {
    /// The arm as its file has it. Every part is written as numbers, with the name of the part for information.
    /// Reading the file again gives the same arm to the last digit.
    pub fn to_json(&self) -> Value {
        let mut value = json!({
            "name": self.name,
            "gravity_m_s2": self.gravity_json(),
            "materials": self.materials_json(),
            "chain": self.chain.iter().map(Element::to_json).collect::<Vec<_>>(),
            "effects": self.effects.iter().map(Effect::to_json).collect::<Vec<_>>(),
        });
        if !self.springs.is_empty() {
            let names: Vec<&str> = self.chain.iter().map(Element::name).collect();
            value["springs"] = self.springs.iter().map(|spring| spring.to_json(&names)).collect();
        }
        value
    }

    /// Gravity as a number if the arm stands upright, else as a vector in the world.
    fn gravity_json(&self) -> Value {
        match self.down == -Vector3::z() {
            true => json!(self.gravity_m_s2),
            false => json!((self.down * self.gravity_m_s2).as_slice()),
        }
    }

    fn materials_json(&self) -> Value {
        let mut map = Map::new();
        for link in self.links() {
            if let LinkBody::Tube { material_name, material, .. } = &link.body {
                let mut keys = json!({
                    "youngs_modulus_pa": material.youngs_modulus_pa,
                    "shear_modulus_pa": material.shear_modulus_pa,
                    "density_kg_m3": material.density_kg_m3,
                    "poisson": material.poisson,
                });
                if let Some(class) = material.class {
                    keys["class"] = json!(class.to_string());
                }
                if let Some(Strength { along_pa, shear_pa }) = material.strength {
                    keys["strength_pa"] = json!(along_pa);
                    if let Some(shear_pa) = shear_pa {
                        keys["shear_strength_pa"] = json!(shear_pa);
                    }
                }
                map.insert(material_name.clone(), keys);
            }
        }
        Value::Object(map)
    }
}

impl Element {
    fn to_json(&self) -> Value {
        match self {
            Element::Joint(joint) => joint.to_json(),
            Element::Prismatic(joint) => joint.to_json(),
            Element::Link(link) => link.to_json(),
        }
    }
}

impl Joint {
    fn to_json(&self) -> Value {
        let mut map = Map::new();
        map.insert("type".into(), json!("joint"));
        map.insert("name".into(), json!(self.name));
        map.insert("axis".into(), json!(self.axis.as_slice()));
        let (key, stiffness) = self.curve.to_json();
        map.insert(key.into(), stiffness);
        map.insert("mass_kg".into(), json!(self.mass_kg));
        for (key, part) in [("gear", &self.gear), ("motor", &self.motor)] {
            if let Some(part) = part {
                map.insert(key.into(), json!(part));
            }
        }
        // without the key `bearing`, a reader would take the bearing of the gear; so `null` is written explicitly
        if self.bearing.is_some() || self.gear.is_some() {
            map.insert("bearing".into(), self.bearing.map_or(Value::Null, Bearing::to_json));
        }
        if self.extras != Extras::default() {
            map.insert("extras".into(), self.extras.to_json());
        }
        if let Some(bodies) = self.bodies.to_json() {
            map.insert("bodies".into(), bodies);
        }
        let by_name = |terms: &[(String, f64)]| terms.iter().map(|(n, f)| (n.clone(), json!(f))).collect();
        if let Some(terms) = &self.coupled {
            map.insert("coupled".into(), Value::Object(by_name(terms)));
        }
        map.extend(self.stages.to_json().into_iter().map(|(key, value)| (key.to_string(), value)));
        if !self.turns_with.is_empty() {
            map.insert("turns_with".into(), Value::Object(by_name(&self.turns_with)));
        }
        Value::Object(map)
    }
}

impl Curve {
    /// The key (`stiffness_nm_per_rad` or `windup`) and the value with which files write the curve.
    pub fn to_json(&self) -> (&'static str, Value) {
        match self {
            Curve::Rigid => ("stiffness_nm_per_rad", Value::Null),
            Curve::Linear(k) => ("stiffness_nm_per_rad", json!(k)),
            Curve::Windup(w) | Curve::WindupK1(w) => (
                "windup",
                json!({
                    "k1_nm_per_rad": w.k1_nm_per_rad, "k2_nm_per_rad": w.k2_nm_per_rad,
                    "k3_nm_per_rad": w.k3_nm_per_rad, "t1_nm": w.t1_nm, "t2_nm": w.t2_nm,
                }),
            ),
        }
    }
}

impl Link {
    fn to_json(&self) -> Value {
        let vector_m = self.vector_m.as_slice();
        let mut value = match &self.body {
            LinkBody::Tube { section: section @ Section::Stated(_), .. } => json!({
                "type": "link", "name": self.name, "vector_m": vector_m, "section": section.to_json(),
            }),
            LinkBody::Tube { material_name, section, .. } => json!({
                "type": "link", "name": self.name, "vector_m": vector_m,
                "material": material_name, "section": section.to_json(),
            }),
            LinkBody::Offset { mass_kg } => json!({
                "type": "link", "name": self.name, "vector_m": vector_m, "mass_kg": mass_kg,
            }),
        };
        if !self.bodies.is_empty() {
            value["bodies"] = self.bodies.iter().map(|body| body.to_json()).collect();
        }
        value
    }
}

impl Section {
    /// The section as files write it: the word for its shape, and its sizes \[m\] or its stated stiffnesses and mass.
    pub fn to_json(&self) -> Value {
        match self {
            Section::RectangularTube { width_m, height_m, wall_m } => json!({
                "shape": self.shape(), "width_m": width_m, "height_m": height_m, "wall_m": wall_m,
            }),
            Section::RoundTube { diameter_m, wall_m } => json!({
                "shape": self.shape(), "diameter_m": diameter_m, "wall_m": wall_m,
            }),
            Section::RectangularBar { width_m, height_m } => json!({
                "shape": self.shape(), "width_m": width_m, "height_m": height_m,
            }),
            Section::RoundBar { diameter_m } => json!({"shape": self.shape(), "diameter_m": diameter_m}),
            Section::IBeam { width_m, height_m, web_m, flange_m } => json!({
                "shape": self.shape(), "width_m": width_m, "height_m": height_m, "web_m": web_m,
                "flange_m": flange_m,
            }),
            Section::Stated(s) => {
                let mut stated = json!({
                    "shape": self.shape(), "width_m": s.width_m, "height_m": s.height_m, "ei_y_nm2": s.ei_y_nm2,
                    "ei_z_nm2": s.ei_z_nm2, "gj_nm2": s.gj_nm2, "kg_per_m": s.kg_per_m,
                });
                if s.ea_n.is_finite() {
                    stated["ea_n"] = json!(s.ea_n);
                }
                stated
            }
        }
    }
}

impl Effect {
    /// The effect as files write it: name, place, parameters and source.
    pub fn to_json(&self) -> Value {
        let parameters: Map<String, Value> = self
            .parameters
            .iter()
            .map(|(name, numbers)| match numbers.as_slice() {
                [one] => match word_of(&self.effect, name, *one) {
                    Some(word) => (name.clone(), json!(word)),
                    None => (name.clone(), json!(one)),
                },
                many => (name.clone(), json!(many)),
            })
            .collect();
        let mut value = json!({"effect": self.effect, "at": self.at, "parameters": parameters});
        if let Some(source) = &self.source {
            value["source"] = source.clone();
        }
        value
    }
}
