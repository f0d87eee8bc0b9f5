//! A bill of materials: every part of an arm with its mass. The masses add up to the mass of the arm.
//!
//! An arm file states one mass for gear and motor together. If the catalogs know both parts and their masses add up to
//! this mass, the bill has a row for each part. A motor that sits elsewhere than its joint is a body of another
//! element, which is recognized by its mass (`bill_motors`).

use super::bill_motors::{Elsewhere, motors_elsewhere};
use super::bill_rows::{ROUNDING, Row, bodies_of, bought, stated, which_mass};
use super::csv_text::csv_text;
use crate::arm::pieces::without_factors;
use crate::arm::prismatic::ROUNDED_KG;
use crate::arm::section::{Section, millimetres};
use crate::arm::{Arm, Element, Extras, Joint, Link, LinkBody, Prismatic};
use crate::catalog::Catalogs;
use crate::catalog::gear::GearKind;

/// The bill of materials of an arm. Equal parts are collected in one row.
pub(crate) fn bill(arm: &Arm, catalogs: &Catalogs) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    let elsewhere = motors_elsewhere(arm, catalogs);
    for (index, element) in arm.chain.iter().enumerate() {
        let mut parts = match element {
            Element::Joint(joint) => joint_parts(joint, catalogs, &elsewhere),
            Element::Prismatic(joint) => prismatic_parts(joint, catalogs),
            Element::Link(link) => link_parts(link, catalogs),
        };
        parts.extend(bodies_of(element).iter().enumerate().flat_map(|(i, body)| {
            let motor = elsewhere.iter().find(|motor| motor.body == (index, i));
            match motor {
                Some(motor) => motor.rows.clone(),
                None => {
                    let at = element.name();
                    vec![stated(at, format!("body {} of {at}", i + 1), "body", body.mass_kg)]
                }
            }
        }));
        for part in parts {
            let same = |row: &&mut Row| {
                let each_kg = row.mass_kg / row.count as f64;
                row.part == part.part
                    && row.kind == part.kind
                    && row.length_m == part.length_m
                    && (each_kg - part.mass_kg).abs() <= ROUNDING * each_kg
            };
            match rows.iter_mut().find(same) {
                Some(row) => {
                    row.count += 1;
                    row.mass_kg += part.mass_kg;
                    row.cost_eur = row.cost_eur.zip(part.cost_eur).map(|(a, b)| a + b);
                    row.used_at.extend(part.used_at);
                }
                None => rows.push(part),
            }
        }
    }
    rows
}

/// The bill of materials as CSV, the content of `bom.csv`.
pub(crate) fn bill_csv(rows: &[Row]) -> Vec<u8> {
    let header = [
        "item",
        "count",
        "part",
        "kind",
        "mass_kg",
        "length_m",
        "source",
        "confidence",
        "cost_eur",
        "used_at",
    ];
    let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x}"));
    let cells = rows.iter().enumerate().map(|(i, row)| {
        vec![
            (i + 1).to_string(),
            row.count.to_string(),
            row.part.clone(),
            row.kind.to_string(),
            format!("{}", row.mass_kg),
            number(row.length_m),
            row.source.clone(),
            row.confidence.clone(),
            number(row.cost_eur),
            row.used_at.join(" "),
        ]
    });
    csv_text(&header, cells)
}

fn joint_parts(joint: &Joint, catalogs: &Catalogs, elsewhere: &[Elsewhere]) -> Vec<Row> {
    let at = joint.name.as_str();
    let away = elsewhere.iter().find(|motor| motor.joint == joint.name);
    let mut out = match away {
        Some(away) => away.gear_row.iter().cloned().collect(),
        None => drive_parts(joint, catalogs),
    };
    if let Some(bearing) = joint.bearing.filter(|bearing| bearing.mass_kg > 0.0) {
        out.push(stated(at, format!("output bearing of {at}"), "bearing", bearing.mass_kg));
    }
    let Extras { housing_kg, brake_kg, encoder_kg, flange_kg, cable_kg } = joint.extras;
    let extras = [
        ("housing", housing_kg),
        ("brake", brake_kg),
        ("encoder", encoder_kg),
        ("flange", flange_kg),
        ("cable", cable_kg),
    ];
    let extras = extras.into_iter().filter(|(_, mass_kg)| *mass_kg > 0.0);
    out.extend(extras.map(|(kind, mass_kg)| stated(at, format!("{kind} of {at}"), kind, mass_kg)));
    out
}

/// The rows of a prismatic joint: the mass that travels, and the mass that stays. A motor and a screw or rack are part
/// of the mass that stays. Each of them has a row of its own, and the mass that remains has another.
fn prismatic_parts(joint: &Prismatic, catalogs: &Catalogs) -> Vec<Row> {
    let at = joint.name.as_str();
    let mut out = Vec::new();
    if joint.mass_kg > 0.0 {
        out.push(stated(at, format!("what travels of {at}"), "prismatic", joint.mass_kg));
    }
    let mut stays_kg = joint.fixed_mass_kg;
    if let Some(motor) = &joint.motor {
        stays_kg -= motor.mass_kg;
        out.push(match catalogs.motor(&motor.name) {
            Ok(known) => bought(at, &motor.name, "motor", motor.mass_kg, &known.provenance),
            Err(_) => stated(at, motor.name.clone(), "motor", motor.mass_kg),
        });
    }
    if let Some(gear) = &joint.gear {
        // if nothing but rounding remains after the screw or rack, its row takes the remainder too, so that the rows
        // add up to the mass of the arm
        let is_all = stays_kg - gear.mass_kg <= ROUNDED_KG;
        let gear_kg = if is_all { stays_kg } else { gear.mass_kg };
        stays_kg -= gear_kg;
        out.push(stated(at, gear.name.clone(), "screw or rack", gear_kg));
    }
    // after the mass of a motor was subtracted, a remainder this small is a rounding error, and it gets no row
    let least_kg = if joint.motor.is_some() { ROUNDED_KG } else { 0.0 };
    if stays_kg > least_kg {
        out.push(stated(at, format!("what stays of {at}"), "prismatic", stays_kg));
    }
    out
}

/// The rows of gear and motor of a joint. They are two rows if the catalogs know both masses and these add up to the
/// mass in the arm file; else one.
fn drive_parts(joint: &Joint, catalogs: &Catalogs) -> Vec<Row> {
    let at = joint.name.as_str();
    let gear = joint.gear.as_ref().and_then(|name| catalogs.gear(name).ok());
    let motor = joint.motor.as_ref().and_then(|name| catalogs.motor(name).ok());
    match (gear, motor) {
        (Some(gear), Some(motor)) if gear.kind == GearKind::Actuator => {
            return vec![bought(at, &motor.id, "actuator", joint.mass_kg, &gear.provenance)];
        }
        (Some(gear), Some(motor)) => {
            let rest_kg = motor.mass_kg.map(|kg| joint.mass_kg - kg);
            if let (Some(motor_kg), Some(which)) =
                (motor.mass_kg, rest_kg.and_then(|kg| which_mass(gear, kg)))
            {
                let part = format!("{} ({which})", gear.id);
                return vec![
                    bought(at, &part, "gear", joint.mass_kg - motor_kg, &gear.provenance),
                    bought(at, &motor.id, "motor", motor_kg, &motor.provenance),
                ];
            }
        }
        (Some(gear), None) if joint.motor.is_none() => {
            if let Some(which) = which_mass(gear, joint.mass_kg) {
                return vec![bought(
                    at,
                    &format!("{} ({which})", gear.id),
                    "gear",
                    joint.mass_kg,
                    &gear.provenance,
                )];
            }
        }
        _ => {}
    }
    let names: Vec<&str> = [&joint.gear, &joint.motor].into_iter().flatten().map(String::as_str).collect();
    match (names.is_empty(), joint.mass_kg > 0.0) {
        (true, false) => Vec::new(),
        (true, true) => vec![stated(at, format!("drive of {at}"), "drive", joint.mass_kg)],
        (false, _) => vec![stated(at, names.join(" + "), "drive", joint.mass_kg)],
    }
}

fn link_parts(link: &Link, catalogs: &Catalogs) -> Vec<Row> {
    let at = link.name.as_str();
    let mut out = Vec::new();
    match &link.body {
        LinkBody::Tube { material_name, material, section } => {
            let length_m = link.vector_m.norm();
            let kg = material.density_kg_m3 * section.properties(material.poisson).area_m2 * length_m;
            let row = catalogs.materials.iter().find(|row| row.name == without_factors(material_name));
            let part = format!("{} {}", section_words(section), material_name);
            let mut part = match row {
                Some(row) => bought(at, &part, "link", kg, &row.provenance),
                None => stated(at, part, "link", kg),
            };
            part.length_m = Some(length_m);
            part.cost_eur = row.and_then(|row| row.cost_eur_per_kg).map(|eur| eur * kg);
            out.push(part);
        }
        LinkBody::Offset { mass_kg } if *mass_kg > 0.0 => {
            let length_m = Some(link.vector_m.norm());
            out.push(Row { length_m, ..stated(at, format!("offset {at}"), "offset", *mass_kg) });
        }
        LinkBody::Offset { .. } => {}
    }
    out
}

/// A section in words, with sizes in millimetres.
pub(crate) fn section_words(section: &Section) -> String {
    let mm = |m: f64| format!("{}", millimetres(m));
    match *section {
        Section::RectangularTube { width_m, height_m, wall_m } => {
            format!("tube {} x {} x {} mm", mm(width_m), mm(height_m), mm(wall_m))
        }
        Section::RoundTube { diameter_m, wall_m } => {
            format!("round tube {} x {} mm", mm(diameter_m), mm(wall_m))
        }
        Section::RectangularBar { width_m, height_m } => format!("bar {} x {} mm", mm(width_m), mm(height_m)),
        Section::RoundBar { diameter_m } => format!("round bar {} mm", mm(diameter_m)),
        Section::IBeam { width_m, height_m, web_m, flange_m } => {
            format!(
                "I {} x {} mm, web {} mm, flange {} mm",
                mm(width_m),
                mm(height_m),
                mm(web_m),
                mm(flange_m)
            )
        }
        Section::Stated(stated) => format!("section of stated stiffness, {} kg/m", stated.kg_per_m),
    }
}
