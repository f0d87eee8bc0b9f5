//! Extras: masses of a joint other than gear and motor (housing, brake, encoders, flange, cables).
//!
//! The catalog row of a gear is a component set or a housed gear, and the row of a frameless motor is a rotor and a
//! stator. The remaining parts of a joint have no catalog row. [`Extras::usual`] estimates them from published
//! fractions of the mass of a joint: motor 30 to 40 %, reducer 25 to 35 %, housing 15 to 25 %, brake 5 to 15 %,
//! encoders 3 to 5 % (eyoubot, "Lightweight harmonic drive robot actuator"). The middle of each range is divided by 65
//! %, which is the sum of the middles for motor (35 %) and reducer (30 %). The estimated mass of the brake (0.10, 0.15
//! and 0.28 kg for the sizes 20, 25 and 32) agrees with the difference between Harmonic Drive's SHA actuators of these
//! sizes with and without a brake. The flange is a disc of aluminium. Flange and cables are representative masses
//! without a source.

use super::keys::EXTRAS;
use crate::catalog::gear::{Gear, GearKind, GearMass};
use crate::catalog::motor::{Motor, MotorKind};
use crate::input::json::{Node, Object};
use serde_json::{Value, json};

/// Masses at the position of a joint, inboard of its springs \[kg\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extras {
    /// Mass of the housing of the motor, or of gear and motor \[kg\].
    pub housing_kg: f64,
    /// Mass of the holding brake \[kg\].
    pub brake_kg: f64,
    /// Mass of the encoders \[kg\].
    pub encoder_kg: f64,
    /// Mass of the flange that carries the next link \[kg\].
    pub flange_kg: f64,
    /// Mass of cables and connectors within the joint \[kg\].
    pub cable_kg: f64,
}

/// Where the extras of a joint come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ExtrasSource {
    /// The masses are estimated from the gear and motor that are chosen ([`Extras::usual`]).
    Usual,
    /// The file states the masses.
    Stated(Extras),
}

/// Mass of the housing relative to the mass of the parts that it contains: 20 % divided by 65 %, both published
/// fractions of the mass of a joint.
const HOUSING_SHARE: f64 = 0.31;
/// Mass of the brake relative to the mass of motor and component set: 10 % divided by 65 %.
const BRAKE_SHARE: f64 = 0.15;
/// Mass of the encoders relative to the mass of motor and component set: 4 % divided by 65 %.
const ENCODER_SHARE: f64 = 0.06;
/// Smallest mass of the encoders \[kg\].
const LEAST_ENCODER_KG: f64 = 0.05;
/// Smallest mass of the housing of a frameless motor \[kg\]. Castings do not become thinner in proportion to the
/// parts in them.
const LEAST_HOUSING_KG: f64 = 0.35;
/// Mass of a flange divided by the cube of its diameter \[kg/m³\]: a disc of aluminium whose thickness is 0.08 of its
/// diameter.
const FLANGE_KG_PER_M3: f64 = 170.0;
/// Mass of cables and connectors of one joint \[kg\].
const CABLE_KG: f64 = 0.05;
/// Estimated outer diameter of a housed strain-wave gear per unit of its size \[m\], for gears without a diameter in
/// the catalog. There HFUC gears of size 20 have 0.093 m.
const DIAMETER_PER_SIZE_M: f64 = 0.0046;

/// Outer diameter of a gear \[m\]. If the catalog has none, as for every component set, the diameter of a strain-wave
/// gear is estimated from its size. For every other gear it is then 0, so that the mass of the flange is 0 too.
fn diameter_m(gear: &Gear, which: GearMass) -> f64 {
    let by_size = match gear.kind {
        GearKind::StrainWave => DIAMETER_PER_SIZE_M * f64::from(gear.size),
        _ => 0.0,
    };
    gear.envelope_as(which).outer_diameter_m.unwrap_or(by_size)
}

impl Extras {
    /// The usual extras of a joint with this gear and motor. An actuator contains all of them except its cables.
    ///
    /// ```
    /// use armwright::arm::Extras;
    /// use armwright::catalog::{Catalogs, GearMass};
    ///
    /// let catalogs = Catalogs::builtin();
    /// let (gear, motor) = (catalogs.gear("CSG-20-100").unwrap(), catalogs.motor("ILM70x18").unwrap());
    /// let extras = Extras::usual(gear, motor, GearMass::HousedUnit);
    /// assert!(extras.brake_kg > 0.05 && extras.brake_kg < 0.2);
    /// assert!(extras.total_kg() > 0.5 && extras.total_kg() < 1.2, "{extras:?}");
    /// ```
    pub fn usual(gear: &Gear, motor: &Motor, which: GearMass) -> Self {
        if gear.kind == GearKind::Actuator {
            return Self { cable_kg: CABLE_KG, ..Self::default() };
        }
        let motor_kg = motor.mass_kg.unwrap_or_default();
        let set_kg = gear.mass_component_set_kg.or(gear.mass_housed_unit_kg).unwrap_or_default();
        let frameless = matches!(motor.kind, MotorKind::FramelessServo | MotorKind::FramelessTorque);
        let motor_housing_kg = if frameless { (HOUSING_SHARE * motor_kg).max(LEAST_HOUSING_KG) } else { 0.0 };
        let gear_housing_kg = match which {
            GearMass::ComponentSet => HOUSING_SHARE * set_kg,
            GearMass::HousedUnit => 0.0,
        };
        let flange_kg = FLANGE_KG_PER_M3 * diameter_m(gear, which).powi(3);
        Self {
            housing_kg: motor_housing_kg + gear_housing_kg,
            brake_kg: BRAKE_SHARE * (set_kg + motor_kg),
            // the mass of a motor with a housing includes an encoder, so only the smallest mass is added here
            encoder_kg: match frameless {
                true => (ENCODER_SHARE * (set_kg + motor_kg)).max(LEAST_ENCODER_KG),
                false => LEAST_ENCODER_KG,
            },
            flange_kg,
            cable_kg: CABLE_KG,
        }
        .rounded()
    }

    /// These masses rounded to the gram, so that calculations use exactly the masses that are printed.
    fn rounded(self) -> Self {
        let gram = |kg: f64| (kg * 1e3).round() / 1e3;
        Self {
            housing_kg: gram(self.housing_kg),
            brake_kg: gram(self.brake_kg),
            encoder_kg: gram(self.encoder_kg),
            flange_kg: gram(self.flange_kg),
            cable_kg: gram(self.cable_kg),
        }
    }

    /// Sum of all masses \[kg\].
    pub fn total_kg(&self) -> f64 {
        self.housing_kg + self.brake_kg + self.encoder_kg + self.flange_kg + self.cable_kg
    }

    fn read(node: &Node) -> Option<Self> {
        let object = node.shaped(&EXTRAS)?;
        let [housing_kg, brake_kg, encoder_kg, flange_kg, cable_kg] =
            ["housing_kg", "brake_kg", "encoder_kg", "flange_kg", "cable_kg"]
                .map(|key| object.or(key, 0.0, Node::non_negative));
        Some(Self {
            housing_kg: housing_kg?,
            brake_kg: brake_kg?,
            encoder_kg: encoder_kg?,
            flange_kg: flange_kg?,
            cable_kg: cable_kg?,
        })
    }

    /// The masses as an arm file writes them, one key for each mass.
    pub(crate) fn to_json(self) -> Value {
        json!({
            "housing_kg": self.housing_kg,
            "brake_kg": self.brake_kg,
            "encoder_kg": self.encoder_kg,
            "flange_kg": self.flange_kg,
            "cable_kg": self.cable_kg,
        })
    }
}

impl ExtrasSource {
    /// No extras.
    pub const NONE: Self = Self::Stated(Extras {
        housing_kg: 0.0,
        brake_kg: 0.0,
        encoder_kg: 0.0,
        flange_kg: 0.0,
        cable_kg: 0.0,
    });

    /// The extras of a joint with this gear and motor: estimated from both, or as the file states them. `which` says
    /// which mass of the gear counts, component set or housed unit.
    pub fn with_parts(&self, gear: &Gear, motor: &Motor, which: GearMass) -> Extras {
        match self {
            ExtrasSource::Usual => Extras::usual(gear, motor, which),
            ExtrasSource::Stated(extras) => *extras,
        }
    }

    /// The extras that the file states. All masses are zero if the file leaves them to be estimated from gear and
    /// motor.
    pub fn stated(&self) -> Extras {
        match self {
            ExtrasSource::Usual => Extras::default(),
            ExtrasSource::Stated(extras) => *extras,
        }
    }
}

/// Reads the key `extras` of a joint in an arm file; all masses are zero without the key. Returns `None` after
/// recording a fault.
pub(crate) fn read_extras(object: &Object) -> Option<Extras> {
    object.or("extras", Extras::default(), Extras::read)
}

/// Reads the key `extras` of a study or of one of its joints: `"usual"`, `"none"`, or masses. `usually` is the result
/// if the key is missing. Returns `None` after recording a fault.
pub(crate) fn read_extras_source(object: &Object, usually: ExtrasSource) -> Option<ExtrasSource> {
    object.or("extras", usually, |n| match n.value() {
        Value::String(word) if word == "usual" => Some(ExtrasSource::Usual),
        Value::String(word) if word == "none" => Some(ExtrasSource::NONE),
        Value::Object(_) => Extras::read(n).map(ExtrasSource::Stated),
        _ => n.fault(
            "is neither \"usual\" nor \"none\" nor a list of masses",
            "write \"usual\" for masses that follow from the parts, \"none\", or {\"housing_kg\": 0.4, \"brake_kg\": 0.1, ...}",
        ),
    })
}
