//! A chosen arm: its pieces as bodies that weigh and turn, and as an arm file.

use nalgebra::{Matrix3, Rotation3, Vector3};
use serde_json::{Value, json};
use std::f64::consts::PI;

use super::catalog::Row;
use super::study::Place;

/// A material and a section for an open link.
#[derive(Clone, Debug)]
pub struct LinkOption {
    pub material: String,
    pub figures: Value,
    pub section: Value,
    pub profile: String,
    pub strength_pa: Option<f64>,
    /// Only where the catalog states it.
    pub shear_strength_pa: Option<f64>,
    pub cost_eur_per_kg: Option<f64>,
    pub density_kg_m3: f64,
    pub tube: Tube,
}

/// Area integrals of a hollow section; y along the width, z along the height.
#[derive(Clone, Copy, Debug)]
pub struct Tube {
    pub area_m2: f64,
    /// Integral of z^2.
    pub over_z2_m4: f64,
    /// Integral of y^2.
    pub over_y2_m4: f64,
    pub width_m: f64,
    pub height_m: f64,
    pub wall_m: f64,
    pub is_round: bool,
}

impl Tube {
    /// Of a section as an arm file has it. A bar is a tube whose walls meet.
    pub fn from_json(section: &Value) -> Self {
        let number = |key: &str| section[key].as_f64().expect("a number");
        let shape = section["shape"].as_str().expect("a shape");
        let wall_m = match shape {
            "rectangular_bar" => 0.5 * number("width_m").min(number("height_m")),
            "round_bar" => 0.5 * number("diameter_m"),
            _ => number("wall_m"),
        };
        if shape.starts_with("round") {
            let outer_m = number("diameter_m");
            let inner_m = outer_m - 2.0 * wall_m;
            let over_z2_m4 = PI / 64.0 * (outer_m.powi(4) - inner_m.powi(4));
            let area_m2 = PI / 4.0 * (outer_m * outer_m - inner_m * inner_m);
            let (width_m, height_m) = (outer_m, outer_m);
            return Self {
                area_m2,
                over_z2_m4,
                over_y2_m4: over_z2_m4,
                width_m,
                height_m,
                wall_m,
                is_round: true,
            };
        }
        let (b, h) = (number("width_m"), number("height_m"));
        let (bi, hi) = (b - 2.0 * wall_m, h - 2.0 * wall_m);
        Self {
            area_m2: b * h - bi * hi,
            over_z2_m4: (b * h.powi(3) - bi * hi.powi(3)) / 12.0,
            over_y2_m4: (h * b.powi(3) - hi * bi.powi(3)) / 12.0,
            width_m: b,
            height_m: h,
            wall_m,
            is_round: false,
        }
    }
}

impl LinkOption {
    pub fn new(material: &Row, section: Value, profile: String) -> Self {
        let figure = |column: &str| material.number(column).expect("a link's material has this figure");
        let figures = json!({
            "youngs_modulus_pa": figure("e_pa"),
            "shear_modulus_pa": figure("g_pa"),
            "density_kg_m3": figure("density_kg_m3"),
            "poisson": material.number("poisson").unwrap_or(0.3),
        });
        Self {
            material: material.id.clone(),
            figures,
            tube: Tube::from_json(&section),
            section,
            profile,
            strength_pa: ["yield_or_strength_pa", "compressive_strength_pa"]
                .iter()
                .filter_map(|column| material.number(column))
                .reduce(f64::min),
            shear_strength_pa: material.number("shear_strength_pa"),
            cost_eur_per_kg: material.number("cost_eur_per_kg"),
            density_kg_m3: figure("density_kg_m3"),
        }
    }
}

/// A link that is decided: a tube, or a rigid offset with a point mass at mid-length.
#[derive(Clone, Debug)]
pub struct Link {
    pub name: String,
    pub vector_m: Vector3<f64>,
    pub mass_kg: f64,
    pub option: Option<LinkOption>,
}

/// A joint that is decided.
#[derive(Clone, Debug)]
pub struct Joint {
    pub name: String,
    pub mass_kg: f64,
    pub gear: String,
    pub motor: String,
    /// Its entry in the chain of an arm file.
    pub entry: Value,
}

/// A piece of a chosen arm.
#[derive(Clone, Debug)]
pub enum Chosen {
    Joint(Joint),
    Link(Link),
}

/// Something that weighs and turns, in the world.
pub struct Body {
    pub mass_kg: f64,
    pub centre_m: Vector3<f64>,
    /// About its centre.
    pub inertia_kgm2: Matrix3<f64>,
}

impl Chosen {
    pub fn mass_kg(&self) -> f64 {
        match self {
            Self::Joint(joint) => joint.mass_kg,
            Self::Link(link) => link.mass_kg,
        }
    }

    /// The piece in its place.
    pub fn body(&self, place: &Place) -> Body {
        match self {
            Self::Joint(joint) => {
                Body { mass_kg: joint.mass_kg, centre_m: place.start_m, inertia_kgm2: Matrix3::zeros() }
            }
            Self::Link(link) => Body {
                mass_kg: link.mass_kg,
                centre_m: place.start_m + place.frame * (0.5 * link.vector_m),
                inertia_kgm2: turned(&place.frame, &link.inertia_kgm2()),
            },
        }
    }

    fn entry(&self) -> Value {
        match self {
            Self::Joint(joint) => joint.entry.clone(),
            Self::Link(link) => link.entry(),
        }
    }
}

/// An inertia given in a frame, in world axes.
pub fn turned(frame: &Rotation3<f64>, inertia_kgm2: &Matrix3<f64>) -> Matrix3<f64> {
    frame.matrix() * inertia_kgm2 * frame.matrix().transpose()
}

/// Section axes as columns: x along the link, z the carried z made perpendicular, y = z cross x.
pub fn section_axes(along: &Vector3<f64>) -> Matrix3<f64> {
    let x = along.normalize();
    let up = if x.z.abs() > 0.99 { Vector3::x() } else { Vector3::z() };
    let z = (up - x * x.dot(&up)).normalize();
    Matrix3::from_columns(&[x, z.cross(&x), z])
}

impl Link {
    pub fn of(name: &str, vector_m: Vector3<f64>, option: &LinkOption) -> Self {
        let mass_kg = option.density_kg_m3 * option.tube.area_m2 * vector_m.norm();
        Self { name: name.to_owned(), vector_m, mass_kg, option: Some(option.clone()) }
    }

    /// About the middle, in the carried frame.
    fn inertia_kgm2(&self) -> Matrix3<f64> {
        let Some(option) = &self.option else { return Matrix3::zeros() };
        let length_m = self.vector_m.norm();
        let line_kg_m = option.density_kg_m3 * length_m;
        let (iz2, iy2) = (line_kg_m * option.tube.over_z2_m4, line_kg_m * option.tube.over_y2_m4);
        let rod = self.mass_kg * length_m * length_m / 12.0;
        let axes = section_axes(&self.vector_m);
        axes * Matrix3::from_diagonal(&Vector3::new(iy2 + iz2, rod + iz2, rod + iy2)) * axes.transpose()
    }

    fn entry(&self) -> Value {
        let v = self.vector_m;
        let mut entry = json!({"type": "link", "name": self.name, "vector_m": [v.x, v.y, v.z]});
        match &self.option {
            Some(option) => {
                entry["material"] = json!(option.material);
                entry["section"] = option.section.clone();
            }
            None => entry["mass_kg"] = json!(self.mass_kg),
        }
        entry
    }
}

/// The arm file of a whole chain, base to tip.
pub fn arm_file(gravity_m_s2: f64, chain: &[Chosen]) -> Value {
    let mut materials = json!({});
    for piece in chain {
        if let Chosen::Link(Link { option: Some(option), .. }) = piece {
            materials[&option.material] = option.figures.clone();
        }
    }
    let entries: Vec<Value> = chain.iter().map(Chosen::entry).collect();
    json!({"name": "brute", "gravity_m_s2": gravity_m_s2, "materials": materials, "chain": entries, "effects": []})
}
