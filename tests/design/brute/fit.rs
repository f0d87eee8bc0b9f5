//! Whether parts fit, from the drawing of gear, motor and link.
//!
//! | asked | definition |
//! |---|---|
//! | gear and link | seen along the joint's axis the link is that wide: the spread of its corners, or its diameter; the smaller side if the joint rolls the link |
//! | motor and link | a cylinder goes into the tube if it is no wider than the tube's clear width and clear height, and if it is no longer than the tubes |
//! | cables | a rod of that diameter goes through what is on the axis |
//! | room | what is on the axis is no longer |
//!
//! A size that no catalog gives stands for a part that fits.

use super::arm::{Chosen, Link, Tube, section_axes};
use super::catalog::Row;
use nalgebra::Vector3;
use serde_json::{Value, json};

/// Outer diameter, length and bore of gear and motor \[mm\].
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    gear: [Option<f64>; 3],
    motor: [Option<f64>; 3],
    /// Whether the motor's size is the side of a square flange.
    is_square: bool,
}

const DIAMETER: usize = 0;
const LENGTH: usize = 1;
const BORE: usize = 2;

impl Sizes {
    pub fn of(gear: &Row, motor: &Row) -> Self {
        let of =
            |row: &Row| ["outer_diameter_mm", "length_mm", "hollow_bore_mm"].map(|column| row.number(column));
        let is_square = ["AC servo", "stepper"].contains(&motor.text("type"));
        Self { gear: of(gear), motor: of(motor), is_square }
    }

    /// Whether the parts fit into a joint about an axis, with the arm outboard of it, nearest first.
    pub fn fit(&self, asked: &Value, axis: &Vector3<f64>, outboard: &[Chosen]) -> bool {
        let place = asked["motor"].as_str().unwrap_or("behind");
        let mut on_axis = vec![self.gear];
        if place == "behind" {
            on_axis.push(self.motor);
        }
        let at_least =
            |size: Option<f64>, key: &str| !asked[key].as_f64().is_some_and(|x| size.is_some_and(|s| s < x));
        let at_most =
            |size: Option<f64>, most: Option<f64>| !most.is_some_and(|x| size.is_some_and(|s| s > x + 1e-6));
        let length_mm =
            on_axis.iter().map(|part| part[LENGTH]).try_fold(0.0, |sum, length| Some(sum + length?));
        let link = first_link(outboard).map(|link| (link, &link.option.as_ref().expect("a section").tube));
        let width_mm = link.map(|(link, tube)| 1e3 * width_m(axis, &link.vector_m, tube));
        let clear_mm = link.map(|(_, tube)| {
            let hollow_mm = 1e3 * (tube.width_m.min(tube.height_m) - 2.0 * tube.wall_m);
            // the corners of a square flange touch the hollow of a round tube
            if self.is_square && tube.is_round { hollow_mm / 2f64.sqrt() } else { hollow_mm }
        });
        let link_mm = link.is_some().then(|| 1e3 * tubes_m(outboard));
        on_axis.iter().all(|part| at_least(part[BORE], "cable_bore_min_mm"))
            && at_most(length_mm, asked["drive_length_max_mm"].as_f64())
            && at_most(
                self.gear[DIAMETER],
                asked["gear_to_link_max"].as_f64().zip(width_mm).map(|(f, w)| f * w),
            )
            && (place != "in_link"
                || at_most(self.motor[DIAMETER], clear_mm) && at_most(self.motor[LENGTH], link_mm))
    }
}

/// What a study asks at a joint: its own wishes over those of the study.
pub fn asked(joint: &Value, study: &Value) -> Value {
    if joint.get("fit").is_some_and(Value::is_null) {
        return json!({});
    }
    let mut asked = study.as_object().cloned().unwrap_or_default();
    asked.extend(joint["fit"].as_object().cloned().unwrap_or_default());
    Value::Object(asked)
}

/// How far a straight rod reaches that lies in the first tube and those that follow it without a break \[m\].
fn tubes_m(outboard: &[Chosen]) -> f64 {
    let tube = |piece: &Chosen| match piece {
        Chosen::Link(link) if link.option.is_some() => Some(link.vector_m),
        _ => None,
    };
    let mut tubes = outboard.iter().map(tube).skip_while(Option::is_none).map_while(|vector_m| vector_m);
    let Some(first) = tubes.next() else { return 0.0 };
    let is_straight = |next: &Vector3<f64>| next.angle(&first) < 0.1;
    first.norm() + tubes.take_while(is_straight).map(|vector_m| vector_m.norm()).sum::<f64>()
}

/// The first link with a section before the next joint.
fn first_link(outboard: &[Chosen]) -> Option<&Link> {
    let links = outboard.iter().map_while(|piece| match piece {
        Chosen::Link(link) => Some(link),
        Chosen::Joint(_) => None,
    });
    links.into_iter().find(|link| link.option.is_some())
}

fn width_m(axis: &Vector3<f64>, vector_m: &Vector3<f64>, tube: &Tube) -> f64 {
    let axes = section_axes(vector_m);
    let side = axes.column(0).cross(axis);
    if side.norm() < 0.14 {
        return tube.width_m.min(tube.height_m);
    }
    let side = side.normalize();
    if tube.is_round {
        return tube.width_m;
    }
    let corner = |y: f64, z: f64| {
        (axes.column(1) * (y * tube.width_m) + axes.column(2) * (z * tube.height_m)).dot(&side)
    };
    let corners = [corner(0.5, 0.5), corner(0.5, -0.5), corner(-0.5, 0.5), corner(-0.5, -0.5)];
    2.0 * corners.into_iter().fold(0.0, f64::max)
}
