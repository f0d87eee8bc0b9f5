//! The catalogs' CSV files as the paper's tests need them.

use armwright::catalog::{Catalogs, Confidence, Gear, Material, MaterialClass, Motor, MotorKind, Provenance};
use std::collections::HashMap;

type Row = HashMap<String, String>;

fn rows(file: &str) -> Vec<Row> {
    let path = format!("{}/catalogs/{file}", env!("CARGO_MANIFEST_DIR"));
    csv::Reader::from_path(path).expect("catalog").deserialize().map(|row| row.expect("row")).collect()
}

fn number(row: &Row, key: &str) -> Option<f64> {
    let text = row.get(key).unwrap_or_else(|| panic!("column {key}"));
    if text.is_empty() { None } else { Some(text.parse().expect("number")) }
}

fn provenance() -> Provenance {
    Provenance {
        source: String::new(),
        confidence: Confidence::Verified,
        unverified_fields: Vec::new(),
        file: String::new(),
        line: 0,
    }
}

fn gear(row: &Row) -> Gear {
    let n = |key| number(row, key);
    let (size, ratio) = (n("size").unwrap() as u32, n("ratio").unwrap() as u32);
    Gear {
        id: format!("{}-{size}-{ratio}", row["series"]),
        series: row["series"].clone(),
        size,
        ratio,
        rated_torque_nm: None,
        repeated_peak_torque_nm: None,
        average_torque_limit_nm: None,
        momentary_peak_torque_nm: None,
        max_input_speed_rpm: None,
        average_input_speed_limit_rpm: None,
        inertia_input_kgm2: n("inertia_input_kgm2"),
        mass_component_set_kg: n("mass_component_set_kg"),
        mass_housed_unit_kg: n("mass_housed_unit_kg"),
        t1_nm: n("t1_nm"),
        t2_nm: n("t2_nm"),
        k1_nm_per_rad: n("k1_nm_per_rad"),
        k2_nm_per_rad: n("k2_nm_per_rad"),
        k3_nm_per_rad: n("k3_nm_per_rad"),
        hysteresis_loss_arcmin: None,
        transmission_accuracy_arcmin: None,
        tilting_stiffness_nm_per_rad: None,
        permissible_tilting_moment_nm: None,
        efficiency: None,
        provenance: provenance(),
    }
}

fn motor(row: &Row) -> Motor {
    Motor {
        id: row["model"].clone(),
        kind: MotorKind::AcServo,
        vendor: String::new(),
        rated_torque_nm: None,
        peak_torque_nm: None,
        rated_speed_rpm: None,
        max_speed_rpm: None,
        rotor_inertia_kgm2: number(row, "rotor_inertia_kgm2"),
        mass_kg: None,
        rated_power_w: None,
        provenance: provenance(),
    }
}

fn material(row: &Row) -> Material {
    Material {
        name: row["name"].clone(),
        class: MaterialClass::Metal,
        youngs_modulus_pa: number(row, "e_pa").unwrap(),
        shear_modulus_pa: number(row, "g_pa"),
        density_kg_m3: number(row, "density_kg_m3").unwrap(),
        poisson: number(row, "poisson"),
        strength_pa: None,
        strength_kind: String::new(),
        cost_eur_per_kg: None,
        corrosion_note: String::new(),
        unidirectional: row["name"].ends_with("UD"),
        provenance: provenance(),
    }
}

/// The supplied catalogs.
pub fn catalogs() -> Catalogs {
    Catalogs {
        gears: rows("gears.csv").iter().map(gear).collect(),
        motors: rows("motors.csv").iter().map(motor).collect(),
        materials: rows("materials.csv").iter().map(material).collect(),
        profiles: Vec::new(),
    }
}
