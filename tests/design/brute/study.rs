//! A study, read from its JSON into lists to loop over.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use serde_json::{Value, json};

use super::arm::{Body, Link, LinkOption};
use super::bearing::Source;
use super::catalog::{Catalog, Row};
use super::drive::{Drive, candidates};
use super::fit;
use crate::witness::LoadCase;

/// A piece of the chain with what is open about it.
pub enum Piece {
    Joint {
        name: String,
        axis: Vector3<f64>,
        max_speed_rad_s: Option<f64>,
        drive: DriveChoice,
        bearing: Source,
        /// Mass beyond gear, motor and bearing.
        extras_kg: f64,
        /// What is asked of the sizes of the parts.
        fit: Value,
    },
    Fixed(Box<Link>),
    Choice {
        name: String,
        vector_m: Vector3<f64>,
        options: Vec<LinkOption>,
    },
}

/// How a joint gets its drive.
pub enum DriveChoice {
    FirstFit,
    AllFits,
    Given(Value),
}

/// What is asked of the tip.
pub struct Motion {
    pub tip_speed_m_s: f64,
    pub ramp_time_s: f64,
    /// Deceleration of the tip in a stop, if the study states it.
    pub stop_m_s2: Option<f64>,
    pub min_lever_m: f64,
    pub life_h: f64,
}

/// One pose of the study: the load case, and whether drives are sized in it.
pub struct Pose {
    pub case: LoadCase,
    pub sizes: bool,
}

/// Everything a study asks.
pub struct Study {
    pub gravity_m_s2: f64,
    pub pieces: Vec<Piece>,
    pub poses: Vec<Pose>,
    pub motion: Motion,
    /// Drives that may be chosen, lightest first.
    pub drives: Vec<Drive>,
    pub constraints: Value,
    /// As an arm file has them.
    pub effects: Value,
}

impl Study {
    pub fn from_json(study: &Value, catalog: &Catalog) -> Self {
        let pieces: Vec<Piece> =
            list(&study["chain"]).map(|piece| read_piece(piece, study, catalog)).collect();
        Self {
            gravity_m_s2: study["gravity_m_s2"].as_f64().unwrap_or(9.81),
            pieces,
            poses: list(&study["poses"]).map(|pose| read_pose(study, pose)).collect(),
            motion: read_motion(&study["motion"]),
            drives: candidates(&study["drives"], catalog),
            constraints: study["constraints"].clone(),
            effects: study["effects"].clone(),
        }
    }

    /// Where every piece of the chain begins and how it is turned, and where the tip is.
    pub fn posed(&self, case: &LoadCase) -> Posed {
        let (mut at_m, mut frame) = (Vector3::zeros(), Rotation3::identity());
        let mut angles_deg = case.pose_deg.iter();
        let mut places = Vec::new();
        for piece in &self.pieces {
            let start_m = at_m;
            match piece {
                Piece::Joint { axis, .. } => {
                    let angle_deg = angles_deg.next().expect("an angle a joint");
                    frame *= Rotation3::from_axis_angle(&Unit::new_normalize(*axis), angle_deg.to_radians());
                }
                Piece::Fixed(link) => at_m += frame * link.vector_m,
                Piece::Choice { vector_m, .. } => at_m += frame * vector_m,
            }
            places.push(Place { start_m, frame });
        }
        Posed { places, tip_m: at_m }
    }

    /// What effects add to the weight of a piece: a mass at a joint, a harness along a link.
    pub fn added(&self, piece: &Piece, place: &Place) -> Option<Body> {
        let (name, vector_m) = match piece {
            Piece::Joint { name, .. } => (name, Vector3::zeros()),
            Piece::Fixed(link) => (&link.name, link.vector_m),
            Piece::Choice { name, vector_m, .. } => (name, *vector_m),
        };
        let here = self.effects.as_array()?.iter().filter(|effect| effect["at"] == *name);
        let figure = |effect: &Value, key: &str| effect["parameters"][key].as_f64().unwrap_or(0.0);
        let length_m = vector_m.norm();
        let mass_kg: f64 = here.map(|e| figure(e, "delta_kg") + figure(e, "kg_per_m") * length_m).sum();
        let span_m = place.frame * vector_m;
        let across = Matrix3::identity() * span_m.norm_squared() - span_m * span_m.transpose();
        let centre_m = place.start_m + 0.5 * span_m;
        (mass_kg != 0.0).then_some(Body { mass_kg, centre_m, inertia_kgm2: across * (mass_kg / 12.0) })
    }

    /// A limit of the study, if it sets one.
    pub fn limit(&self, key: &str) -> Option<f64> {
        self.constraints[key].as_f64()
    }
}

/// Where a piece begins, and the frame of what it carries.
pub struct Place {
    pub start_m: Vector3<f64>,
    pub frame: Rotation3<f64>,
}

/// The chain in one pose.
pub struct Posed {
    pub places: Vec<Place>,
    pub tip_m: Vector3<f64>,
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().unwrap_or_else(|| panic!("not a list: {value}")).iter()
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_iterator(list(value).map(|x| x.as_f64().expect("a number")))
}

fn read_piece(piece: &Value, study: &Value, catalog: &Catalog) -> Piece {
    let name = piece["name"].as_str().expect("a name").to_owned();
    if piece["type"] == "joint" {
        let drive = match piece["drive"].as_str() {
            Some("first_fit") => DriveChoice::FirstFit,
            Some("all_fits") => DriveChoice::AllFits,
            _ => DriveChoice::Given(piece.clone()),
        };
        let max_speed_rad_s = piece["max_speed_rad_s"].as_f64();
        let extras = if piece["extras"].is_null() { &study["extras"] } else { &piece["extras"] };
        return Piece::Joint {
            name,
            axis: vector(&piece["axis"]).normalize(),
            max_speed_rad_s,
            extras_kg: if piece["drive"].is_string() { extras_kg(extras) } else { 0.0 },
            drive,
            bearing: Source::read(piece, catalog),
            fit: fit::asked(piece, &study["fit"]),
        };
    }
    let vector_m = vector(&piece["vector_m"]);
    if piece["choose"].is_null() {
        let mass_kg = piece["mass_kg"].as_f64().unwrap_or(0.0);
        return Piece::Fixed(Box::new(Link { name, vector_m, mass_kg, option: None }));
    }
    Piece::Choice { name, vector_m, options: read_options(&piece["choose"], catalog) }
}

/// Masses that a study states, or none; the usual ones follow from formulas that are not repeated here.
fn extras_kg(extras: &Value) -> f64 {
    match extras.as_object() {
        Some(masses) => masses.values().map(|kg| kg.as_f64().expect("a mass")).sum(),
        None => {
            assert_eq!(extras, "none", "the brute force knows no usual extras");
            0.0
        }
    }
}

fn read_options(choose: &Value, catalog: &Catalog) -> Vec<LinkOption> {
    let mut options = Vec::new();
    for material in list(&choose["materials"]).map(|m| catalog.material(m.as_str().expect("a name"))) {
        for family in list(&choose["sections"]) {
            let sections = match family["profiles"].is_null() {
                true => grid_sections(family),
                false => profile_sections(&family["profiles"], material, catalog),
            };
            options.extend(sections.into_iter().map(|(s, profile)| LinkOption::new(material, s, profile)));
        }
    }
    options
}

fn grid_sections(family: &Value) -> Vec<(Value, String)> {
    let mut sections = Vec::new();
    // a bar has no wall; the number is not read
    let walls = if family["wall_mm"].is_null() { vec![0.0] } else { grid(&family["wall_mm"]) };
    for wall_mm in walls {
        let shape = family["shape"].as_str().expect("a shape");
        if shape.starts_with("round") {
            for diameter_mm in grid(&family["diameter_mm"]) {
                sections
                    .push(json!({"shape": shape, "diameter_m": diameter_mm / 1e3, "wall_m": wall_mm / 1e3}));
            }
            continue;
        }
        for width_mm in grid(&family["width_mm"]) {
            let is_square = family["height_mm"].is_null() || family["height_mm"] == "=width";
            let heights = if is_square { vec![width_mm] } else { grid(&family["height_mm"]) };
            sections.extend(
                heights
                    .into_iter()
                    .map(|height_mm| rectangular(shape, width_mm / 1e3, height_mm / 1e3, wall_mm / 1e3)),
            );
        }
    }
    sections.into_iter().map(|section| (section, String::new())).collect()
}

fn rectangular(shape: &str, width_m: f64, height_m: f64, wall_m: f64) -> Value {
    json!({"shape": shape, "width_m": width_m, "height_m": height_m, "wall_m": wall_m})
}

/// A number, a list, or from-to-step.
fn grid(value: &Value) -> Vec<f64> {
    if let Some(number) = value.as_f64() {
        return vec![number];
    }
    if value.is_array() {
        return list(value).map(|x| x.as_f64().expect("a number")).collect();
    }
    let [from, to, step] = ["from", "to", "step"].map(|key| value[key].as_f64().expect("a number"));
    let mut points = vec![from];
    while points[points.len() - 1] + step <= to + 1e-9 * step {
        points.push(points[points.len() - 1] + step);
    }
    points
}

/// Steel profiles are structural steel, aluminium profiles any aluminium.
fn profile_sections(wanted: &Value, material: &Row, catalog: &Catalog) -> Vec<(Value, String)> {
    let family = wanted["family"].as_str().expect("a family");
    let name = material.id.to_lowercase();
    let is_sold = match family {
        "steel" => name.starts_with("structural steel"),
        _ => name.contains(family),
    };
    let largest_m = wanted["max_outer_mm"].as_f64().unwrap_or(f64::INFINITY) / 1e3;
    let shapes = &wanted["shapes"];
    let figure = |row: &Row, column: &str| row.number(column).expect("profiles are complete");
    let is_wanted = |row: &&Row| {
        is_sold
            && row.text("material_family") == family
            && (shapes.is_null() || list(shapes).any(|s| s == row.text("shape")))
            && figure(row, "outer_b_m").max(figure(row, "outer_h_m")) <= largest_m
    };
    let section = |row: &Row| {
        let [width_m, height_m, wall_m] = ["outer_b_m", "outer_h_m", "wall_t_m"].map(|c| figure(row, c));
        match row.text("shape") {
            "round" => json!({"shape": "round_tube", "diameter_m": width_m, "wall_m": wall_m}),
            _ => rectangular("rectangular_tube", width_m, height_m, wall_m),
        }
    };
    catalog.profiles.iter().filter(is_wanted).map(|row| (section(row), row.id.clone())).collect()
}

fn read_pose(study: &Value, pose: &Value) -> Pose {
    let own_or_study = |key: &str| if pose[key].is_null() { &study[key] } else { &pose[key] };
    let case = json!({
        "pose_deg": pose["pose_deg"],
        "payload": own_or_study("payload"),
        "tip_force_n": own_or_study("tip_force_n"),
    });
    Pose { case: LoadCase::from_json(&case), sizes: pose["sizing"].as_bool().unwrap_or(true) }
}

fn read_motion(motion: &Value) -> Motion {
    let or = |key: &str, default: f64| motion[key].as_f64().unwrap_or(default);
    let (tip_speed_m_s, ramp_time_s) = (or("tip_speed_m_s", 1.0), or("ramp_time_s", 0.2));
    Motion {
        tip_speed_m_s,
        ramp_time_s,
        stop_m_s2: motion["emergency_deceleration_m_s2"].as_f64(),
        min_lever_m: or("min_lever_m", 0.3),
        life_h: or("life_h", 10_000.0),
    }
}
