//! Prismatic joints: a carriage on a rail, a column, a ram, a screw.
//!
//! The joint slides along its axis. Its *drive* (a screw or a rack with its supports) is a spring along the travel. Its
//! *guide* is three rotational springs: roll about the travel, pitch about the y axis and yaw about the z axis of a
//! section frame whose x axis is the travel. Forces across the travel do not deflect the guide. The deflection of a
//! pair of runner blocks (the bearings that run on the rail) under such forces is small. The tilt of the blocks causes
//! a much larger deflection at the end of an overhang.
//!
//! The position of the springs depends on what moves. The blocks of a `carriage` travel with it, so the overhang
//! outboard of them is the same at every travel. The blocks of a `ram` stay where the joint begins, so the overhang
//! grows with the travel.

use super::body::{JointBodies, read_prismatic_bodies};
use super::element_keys::{read_axis, read_name};
use super::prismatic_keys::GUIDE;
use crate::input::json::{Node, Object};
use nalgebra::{Unit, Vector3};
use serde_json::{Map, Value, json};

/// A prismatic joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Prismatic {
    /// Name, unique in the arm.
    pub name: String,
    /// Direction of the travel in the carried frame, which turns with the joints inboard.
    pub axis: Unit<Vector3<f64>>,
    /// Stiffness of the drive along the travel \[N/m\]; `None` means rigid.
    pub stiffness_n_per_m: Option<f64>,
    /// Rotational stiffnesses of the guide, and the loads that it holds.
    pub guide: Guide,
    /// Whether a carriage or a ram travels.
    pub moves: Moves,
    /// Mass that travels \[kg\]. It is a point mass at the point to which the joint has travelled, outboard of all
    /// springs.
    pub mass_kg: f64,
    /// Mass that stays where the joint begins \[kg\]. It is a point mass inboard of all springs.
    pub fixed_mass_kg: f64,
    /// Rigid bodies on the joint. Bodies that stay are measured from where the joint begins, bodies that travel from
    /// the point to which the joint has travelled.
    pub bodies: JointBodies,
    /// The screw or rack within `fixed_mass_kg`, for information only; `None` if the file names none.
    pub gear: Option<NamedPart>,
    /// The motor within `fixed_mass_kg`, for information only; `None` if the file names none.
    pub motor: Option<NamedPart>,
}

/// A part with its name and its mass.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedPart {
    /// Name of the part.
    pub name: String,
    /// Mass of the part \[kg\].
    pub mass_kg: f64,
}

impl NamedPart {
    /// Reads the name under `name_key` and the mass under `mass_key`. The inner `None` means that neither is stated,
    /// the outer `None` that a fault was recorded.
    fn read(object: &Object, name_key: &str, mass_key: &str) -> Option<Option<Self>> {
        if !object.has(name_key) && !object.has(mass_key) {
            return Some(None);
        }
        let name = object.required(name_key).and_then(|n| match n.string()? {
            "" => n.fault("is empty", "name the part, or leave the key away"),
            name => Some(name.to_string()),
        });
        let mass_kg = object.required(mass_key).and_then(|n| n.non_negative());
        Some(Some(Self { name: name?, mass_kg: mass_kg? }))
    }
}

/// Mass by which the parts of a drive together may exceed `fixed_mass_kg`, because masses in files are rounded \[kg\].
pub(crate) const ROUNDED_KG: f64 = 1e-8;

/// What travels in a prismatic joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Moves {
    /// A carriage on a rail: the springs of the guide travel.
    #[default]
    Carriage,
    /// A ram in fixed guides: the springs of the guide stay.
    Ram,
}

impl Moves {
    /// The word for this value in files.
    pub fn word(self) -> &'static str {
        match self {
            Moves::Carriage => "carriage",
            Moves::Ram => "ram",
        }
    }
}

/// The guide of a prismatic joint: its three rotational stiffnesses and the loads that it holds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Guide {
    /// Stiffness in roll, about the travel \[N m/rad\]; `None` means rigid.
    pub roll_nm_per_rad: Option<f64>,
    /// Stiffness in pitch, about the y axis of the section frame whose x axis is the travel \[N m/rad\]; `None` means
    /// rigid.
    pub pitch_nm_per_rad: Option<f64>,
    /// Stiffness in yaw, about the z axis of the same section frame \[N m/rad\]; `None` means rigid.
    pub yaw_nm_per_rad: Option<f64>,
    /// The largest loads, each acting alone.
    pub limits: GuideLimits,
}

/// The largest loads that a guide holds, each acting alone. They are the ratings of the maker divided by the safety
/// factor for which the maker asks. `None` means unknown.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GuideLimits {
    /// Force across the travel, along the y or the z axis of the guide \[N\]; `None` means unknown.
    pub force_n: Option<f64>,
    /// Moments in the order roll, pitch, yaw \[N m\]; `None` means unknown.
    pub moment_nm: [Option<f64>; 3],
}

const LIMIT_KEYS: [&str; 4] = ["max_force_n", "max_roll_nm", "max_pitch_nm", "max_yaw_nm"];

impl GuideLimits {
    /// The fraction of the guide's load capacity that a load uses; at 1 the guide is fully loaded. `force_n` and
    /// `moment_nm` are along and about the axes of the guide, the travel first. The fractions of all forces and moments
    /// add up (PBC Linear, Redi-Rail catalog, "multiple-load force calculation"). Loads without a limit are left out;
    /// `None` if there is no limit.
    pub fn part_used(&self, force_n: &Vector3<f64>, moment_nm: &Vector3<f64>) -> Option<f64> {
        let forces = [force_n.y, force_n.z].map(|force_n| (force_n, self.force_n));
        let moments = moment_nm.iter().copied().zip(self.moment_nm);
        let parts = forces.into_iter().chain(moments).filter_map(|(load, most)| Some(load.abs() / most?));
        parts.reduce(|sum, part| sum + part)
    }

    /// Whether any limit is known.
    pub(crate) fn is_stated(&self) -> bool {
        self.unknown().len() < LIMIT_KEYS.len()
    }

    /// The keys of the kinds of load for which no limit is known.
    pub(crate) fn unknown(&self) -> Vec<&'static str> {
        let known = [self.force_n, self.moment_nm[0], self.moment_nm[1], self.moment_nm[2]];
        LIMIT_KEYS.into_iter().zip(known).filter(|(_, most)| most.is_none()).map(|(key, _)| key).collect()
    }

    fn read(object: &Object) -> Option<Self> {
        let [force_n, roll, pitch, yaw] =
            LIMIT_KEYS.map(|key| object.or(key, None, |node| node.positive().map(Some)));
        Some(Self { force_n: force_n?, moment_nm: [roll?, pitch?, yaw?] })
    }

    /// The limits that are known, each with its key.
    fn entries(&self) -> impl Iterator<Item = (String, Value)> + use<> {
        let [roll, pitch, yaw] = self.moment_nm;
        let all = LIMIT_KEYS.into_iter().zip([self.force_n, roll, pitch, yaw]);
        all.filter_map(|(key, most)| Some((key.to_string(), json!(most?))))
    }
}

const GUIDE_KEYS: [&str; 3] = ["roll_nm_per_rad", "pitch_nm_per_rad", "yaw_nm_per_rad"];

impl Guide {
    /// The stiffnesses in the order roll, pitch, yaw \[N m/rad\]; `None` means rigid.
    pub fn stiffnesses(&self) -> [Option<f64>; 3] {
        [self.roll_nm_per_rad, self.pitch_nm_per_rad, self.yaw_nm_per_rad]
    }

    /// The compliances in the order roll, pitch, yaw \[rad/(N m)\]; 0 where the guide is rigid.
    pub fn rad_per_nm(&self) -> Vector3<f64> {
        Vector3::from(self.stiffnesses().map(|k| k.map_or(0.0, |k| 1.0 / k)))
    }

    /// This guide with all three stiffnesses multiplied by `factor`.
    #[must_use]
    pub fn stiffened(self, factor: f64) -> Self {
        let [roll_nm_per_rad, pitch_nm_per_rad, yaw_nm_per_rad] =
            self.stiffnesses().map(|k| k.map(|k| k * factor));
        Self { roll_nm_per_rad, pitch_nm_per_rad, yaw_nm_per_rad, ..self }
    }

    fn read(node: &Node) -> Option<Self> {
        let object = node.shaped(&GUIDE)?;
        let [roll, pitch, yaw] = GUIDE_KEYS.map(|key| object.or(key, None, positive_or_rigid));
        let limits = GuideLimits::read(&object);
        Some(Self { roll_nm_per_rad: roll?, pitch_nm_per_rad: pitch?, yaw_nm_per_rad: yaw?, limits: limits? })
    }

    fn to_json(self) -> Value {
        let stiffnesses = GUIDE_KEYS.iter().zip(self.stiffnesses());
        let stiffnesses = stiffnesses.map(|(key, k)| (key.to_string(), json!(k)));
        Value::Object(stiffnesses.chain(self.limits.entries()).collect::<Map<_, _>>())
    }
}

/// The elastic properties of a prismatic joint.
pub(crate) struct Elastic {
    /// Stiffness along the travel \[N/m\]; `None` if it is rigid or not known yet.
    pub stiffness_n_per_m: Option<f64>,
    pub guide: Guide,
    /// Whether carriage or ram travels.
    pub moves: Moves,
}

/// Reads a stiffness. The inner `None` (`null` in the file) means rigid, the outer `None` that a fault was recorded.
fn positive_or_rigid(node: &Node) -> Option<Option<f64>> {
    if node.is_null() { Some(None) } else { node.positive().map(Some) }
}

impl Prismatic {
    /// Total mass of the joint with its bodies \[kg\].
    pub fn total_mass_kg(&self) -> f64 {
        self.mass_kg + self.fixed_mass_kg + self.bodies.mass_kg()
    }

    /// Reads a prismatic joint with its drive; the caller has checked the keys. Returns `None` after recording a fault.
    pub(crate) fn read(object: &Object) -> Option<Self> {
        let springs = Self::read_springs(object);
        Self::read_with(object, springs)
    }

    /// Reads a prismatic joint whose drive is not known yet; the caller has checked the keys. Returns `None` after
    /// recording a fault.
    pub(crate) fn read_undriven(object: &Object) -> Option<Self> {
        let (guide, moves) = (
            object.or("guide", Guide::default(), Guide::read),
            object.or("moves", Moves::default(), read_moves),
        );
        let springs =
            guide.zip(moves).map(|(guide, moves)| Elastic { stiffness_n_per_m: None, guide, moves });
        Self::read_with(object, springs)
    }

    fn read_with(object: &Object, springs: Option<Elastic>) -> Option<Self> {
        let name = read_name(object);
        let axis = object.required("axis").and_then(|n| read_axis(&n));
        let mass_kg = object.or("mass_kg", 0.0, Node::non_negative);
        let fixed_mass_kg = object.or("fixed_mass_kg", 0.0, Node::non_negative);
        let bodies = read_prismatic_bodies(object);
        let gear = NamedPart::read(object, "gear", "gear_mass_kg");
        let motor = NamedPart::read(object, "motor", "motor_mass_kg");
        let Elastic { stiffness_n_per_m, guide, moves } = springs?;
        let (gear, motor, fixed_mass_kg) = (gear?, motor?, fixed_mass_kg?);
        let parts_kg: f64 = gear.iter().chain(&motor).map(|part| part.mass_kg).sum();
        if parts_kg > fixed_mass_kg + ROUNDED_KG {
            return object.node().fault(
                format!("has a fixed_mass_kg of {fixed_mass_kg}, less than the {parts_kg} kg of its gear and motor"),
                "state in fixed_mass_kg everything that stays, screw or rack and motor with it",
            );
        }
        Some(Self {
            name: name?,
            axis: axis?,
            stiffness_n_per_m,
            guide,
            moves,
            mass_kg: mass_kg?,
            fixed_mass_kg,
            bodies: bodies?,
            gear,
            motor,
        })
    }

    /// Reads the elastic properties of a prismatic joint. Returns `None` after recording a fault.
    pub(crate) fn read_springs(object: &Object) -> Option<Elastic> {
        let stiffness = match object.optional("stiffness_n_per_m") {
            Some(node) => positive_or_rigid(&node),
            None => object.node().fault(
                "says nothing of its stiffness",
                "add \"stiffness_n_per_m\", the force per way along the travel (null = rigid)",
            ),
        };
        let guide = object.or("guide", Guide::default(), Guide::read);
        let moves = object.or("moves", Moves::default(), read_moves);
        Some(Elastic { stiffness_n_per_m: stiffness?, guide: guide?, moves: moves? })
    }

    /// The elastic properties of the joint as JSON, as [`read_springs`](Self::read_springs) reads them.
    pub(crate) fn springs_to_json(&self) -> Value {
        json!({
            "stiffness_n_per_m": self.stiffness_n_per_m,
            "guide": self.guide.to_json(),
            "moves": self.moves.word(),
        })
    }

    /// The joint as files write it.
    pub(crate) fn to_json(&self) -> Value {
        let mut value = json!({
            "type": "prismatic",
            "name": self.name,
            "axis": self.axis.as_slice(),
            "stiffness_n_per_m": self.stiffness_n_per_m,
            "guide": self.guide.to_json(),
            "moves": self.moves.word(),
            "mass_kg": self.mass_kg,
            "fixed_mass_kg": self.fixed_mass_kg,
        });
        if let Some(bodies) = self.bodies.to_json_that("travels") {
            value["bodies"] = bodies;
        }
        for (key, mass_key, part) in
            [("gear", "gear_mass_kg", &self.gear), ("motor", "motor_mass_kg", &self.motor)]
        {
            if let Some(part) = part {
                value[key] = json!(part.name);
                value[mass_key] = json!(part.mass_kg);
            }
        }
        value
    }

    /// The joint as the mechanics needs it, without any effect. `entry` is the index of the joint's travel in a pose.
    pub(crate) fn piece(&self, entry: usize) -> PrismaticPiece {
        PrismaticPiece {
            name: self.name.clone(),
            axis: self.axis,
            m_per_n: self.stiffness_n_per_m.map_or(0.0, |k| 1.0 / k),
            guide_rad_per_nm: self.guide.rad_per_nm(),
            moves: self.moves,
            mass_kg: self.mass_kg,
            fixed_mass_kg: self.fixed_mass_kg,
            bodies: self.bodies.clone(),
            entry,
        }
    }
}

fn read_moves(node: &Node) -> Option<Moves> {
    match node.string()? {
        "carriage" => Some(Moves::Carriage),
        "ram" => Some(Moves::Ram),
        other => node.fault(
            format!("\"{other}\" is not known"),
            "choose carriage (the guide travels) or ram (the guide stays, and the ram reaches out of it)",
        ),
    }
}

/// A prismatic joint as the mechanics needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct PrismaticPiece {
    /// Name of the joint.
    pub name: String,
    /// Direction of the travel in the carried frame.
    pub axis: Unit<Vector3<f64>>,
    /// Compliance of the drive along the travel \[m/N\]; 0 means rigid.
    pub m_per_n: f64,
    /// Compliances of the guide in the order roll, pitch, yaw \[rad/(N m)\]; 0 means rigid.
    pub guide_rad_per_nm: Vector3<f64>,
    /// Whether a carriage or a ram travels. It decides where the springs of the guide are.
    pub moves: Moves,
    /// Mass that travels with the joint \[kg\].
    pub mass_kg: f64,
    /// Mass that stays where the joint begins \[kg\].
    pub fixed_mass_kg: f64,
    /// Rigid bodies on the joint. Some stay, others travel.
    pub bodies: JointBodies,
    /// Index of the joint's travel in a pose.
    pub entry: usize,
}

impl PrismaticPiece {
    /// Total mass of the joint with its bodies \[kg\].
    pub fn total_mass_kg(&self) -> f64 {
        self.mass_kg + self.fixed_mass_kg + self.bodies.mass_kg()
    }

    /// Whether the guide is rigid about all three axes.
    pub fn guide_is_rigid(&self) -> bool {
        self.guide_rad_per_nm == Vector3::zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::GuideLimits;
    use crate::arm::file::read_arm_document;
    use crate::arm::{Arm, Element};
    use crate::catalog::Catalogs;
    use crate::input::json::{Document, Faults};

    const GANTRY: &str = r#"{"chain": [
        {"type": "prismatic", "name": "rail", "axis": [2, 0, 0], "stiffness_n_per_m": 5e7, "mass_kg": 12,
         "fixed_mass_kg": 3, "guide": {"roll_nm_per_rad": 1e5, "pitch_nm_per_rad": null, "max_force_n": 2000, "max_yaw_nm": 50},
         "bodies": [{"mass_kg": 1, "travels": true}, {"mass_kg": 2}]},
        {"type": "prismatic", "name": "z", "axis": [0, 0, 1], "stiffness_n_per_m": null, "moves": "ram"},
        {"type": "joint", "name": "j", "axis": [0, 0, 1], "stiffness_nm_per_rad": 1e4, "coupled": COUPLED}]}"#;

    fn read(text: &str) -> Result<Arm, Faults> {
        let text = text.replace(", \"coupled\": COUPLED", "");
        read_arm_document(Document::parse("arm.json", &text)?, &Catalogs::default())
    }

    #[test]
    fn a_prismatic_joint_reads_back_as_it_was_written() {
        let arm = read(GANTRY).expect("sound");
        let again = arm.to_json().to_string();
        let written =
            read_arm_document(Document::parse("b.json", &again).expect("JSON"), &Catalogs::default());
        assert_eq!(written.expect("sound"), arm);
        assert_eq!(arm.mass_kg(), 18.0);
        let Element::Prismatic(rail) = &arm.chain[0] else { panic!("a prismatic joint") };
        assert_eq!((rail.guide.roll_nm_per_rad, rail.guide.pitch_nm_per_rad), (Some(1e5), None));
        let limits = rail.guide.limits;
        assert_eq!((limits.force_n, limits.moment_nm), (Some(2000.0), [None, None, Some(50.0)]));
        assert_eq!(limits.unknown(), ["max_roll_nm", "max_pitch_nm"]);
        // (100 + 300) / 2000 of the forces across the travel and 10 / 50 of the yaw moment; roll and pitch have no
        // limit, and the force along the travel does not count, because the drive holds it
        let used = limits.part_used(&[900.0, -100.0, 300.0].into(), &[70.0, 80.0, -10.0].into());
        assert!((used.expect("a limit") - 0.4).abs() < 1e-12);
        assert_eq!(GuideLimits::default().part_used(&[1.0; 3].into(), &[1.0; 3].into()), None);
        let driven: Vec<String> = arm.driven_joints().iter().map(|joint| joint.key()).collect();
        assert_eq!(driven, ["rail_mm", "z_mm", "j_deg"]);
    }

    #[test]
    fn the_parts_of_a_drive_keep_their_names_within_the_mass_that_stays() {
        let named = r#""fixed_mass_kg": 3, "gear": "16 x 5", "gear_mass_kg": 1.25, "motor": "M", "motor_mass_kg": 0.75"#;
        let text = GANTRY.replace("\"fixed_mass_kg\": 3", named);
        let arm = read(&text).expect("sound");
        assert_eq!(arm.mass_kg(), 18.0);
        let written = arm.to_json();
        assert_eq!(
            (&written["chain"][0]["gear"], &written["chain"][0]["motor_mass_kg"]),
            (&"16 x 5".into(), &0.75.into())
        );
        let again = Document::parse("b.json", &written.to_string()).expect("JSON");
        assert_eq!(read_arm_document(again, &Catalogs::default()).expect("sound"), arm);
        let heavy = read(&text.replace("0.75", "1.76")).expect_err("too heavy").to_string();
        assert!(heavy.contains("less than the 3.01 kg of its gear and motor"), "{heavy}");
    }

    #[test]
    fn every_fault_of_a_prismatic_joint_says_what_to_write() {
        let text = GANTRY
            .replace("\"moves\": \"ram\"", "\"moves\": \"piston\"")
            .replace("5e7", "-1")
            .replace("\"stiffness_n_per_m\": null, ", "");
        let faults = read(&text).expect_err("three faults").to_string();
        for says in ["-1", "choose carriage", "add \"stiffness_n_per_m\""] {
            assert!(faults.contains(says), "{says}: {faults}");
        }
        let coupled = GANTRY.replace("COUPLED", "{\"rail\": 1}");
        let faults =
            read_arm_document(Document::parse("a.json", &coupled).expect("JSON"), &Catalogs::default());
        let faults = faults.expect_err("coupled to a slide").to_string();
        assert!(faults.contains("\"rail\", which is no driven joint that turns"), "{faults}");
    }
}
