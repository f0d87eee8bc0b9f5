//! Readers and JSON Schemas know the same keys. If a reader requires a key, a type or a sign, the schema requires it
//! too. A schema accepts everything that the reader accepts. A default that a schema states is the value without the
//! key.

use crate::links::armwright;
use crate::words::files as files_below;
use armwright::arm::{Arm, DrivenJoint, LoadCase, read_arm_document, read_load_cases};
use armwright::catalog::{CatalogFile, Catalogs};
use armwright::input::{Document, Fault, Faults, InputError};
use armwright::reconcile::Campaign;
use armwright::study::{Study, read_study};
use boon::{Compiler, SchemaIndex, Schemas};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn project() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn json_of(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The schema of a kind of file as the program prints it, compiled by a library that knows the standard.
struct Schema {
    printed: Value,
    schemas: Schemas,
    root: SchemaIndex,
}

impl Schema {
    fn of(kind: &str) -> Self {
        let (code, said) = armwright(&project(), &["schema", kind]);
        assert_eq!(code, 0, "{said}");
        let printed: Value = serde_json::from_str(&said).expect("JSON");
        let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
        let address = format!("http://localhost/{kind}.json");
        compiler.add_resource(&address, printed.clone()).expect("a resource");
        // this checks the schema by the meta-schema that it names
        let root = compiler.compile(&address, &mut schemas).unwrap_or_else(|e| panic!("{kind}: {e}"));
        Self { printed, schemas, root }
    }

    fn complaint(&self, value: &Value) -> Option<String> {
        self.schemas.validate(value, self.root).err().map(|e| format!("{e:#}"))
    }

    fn takes(&self, value: &Value) -> bool {
        self.schemas.validate(value, self.root).is_ok()
    }

    /// The defaults of each key, by its name: several objects may have a key of one name.
    fn defaults(&self) -> Vec<(String, Value)> {
        let shapes = self.printed["$defs"].as_object().expect("definitions").values();
        let keys = shapes.flat_map(|shape| shape["properties"].as_object().expect("keys"));
        let with_default = keys.filter_map(|(name, key)| Some((name.clone(), key.get("default")?.clone())));
        let mut out: Vec<(String, Value)> = with_default.collect();
        out.sort_by_key(|pair| format!("{pair:?}"));
        out.dedup();
        out
    }
}

/// What a reader makes of a document.
#[derive(PartialEq, Debug)]
enum Read {
    Arm(Arm),
    Cases(Vec<LoadCase>),
    Study(Box<Study>),
    Campaign(String),
}

type Reader<'a> = Box<dyn Fn(&Value) -> Result<Read, Vec<Fault>> + 'a>;

fn document(value: &Value) -> Document {
    Document::parse("file", &value.to_string()).expect("JSON")
}

fn faults_of(faults: Faults) -> Vec<Fault> {
    faults.0
}

fn arm_reader(catalogs: &Catalogs) -> Reader<'_> {
    Box::new(|v| read_arm_document(document(v), catalogs).map(Read::Arm).map_err(faults_of))
}

fn study_reader(catalogs: &Catalogs) -> Reader<'_> {
    Box::new(|v| read_study(document(v), catalogs).map(|s| Read::Study(Box::new(s))).map_err(faults_of))
}

/// Whether a fault is about a key, its presence, its type or its sign, which are what a schema can know. Which parameters an
/// effect has depends on the effect, and stands on its page.
fn is_about_form(fault: &Fault) -> bool {
    let words = &fault.problem;
    if fault.field.contains("].parameters") && !words.starts_with("is ") {
        return false;
    }
    words == "unknown key"
        || words.starts_with("lacks \"")
        || words.starts_with("has no known \"shape\"")
        || words.starts_with("has no \"type\"")
        || words.starts_with("says nothing of its stiffness")
        || (words.starts_with('"') && words.ends_with("is not known"))
        || words.ends_with("must be greater than 0")
        || words.ends_with("must not be negative")
        || (words.starts_with("is ") && [", not a", "not an"].iter().any(|part| words.contains(part)))
        || fault.hint == "write true or false"
}

type Place = Vec<Step>;

#[derive(Clone, Debug)]
enum Step {
    Key(String),
    Index(usize),
}

/// All places of a document, the document itself first.
fn places(value: &Value, here: &Place, out: &mut Vec<Place>) {
    out.push(here.clone());
    let inside = |step: Step| here.iter().cloned().chain([step]).collect::<Place>();
    match value {
        Value::Object(map) => map.iter().for_each(|(k, v)| places(v, &inside(Step::Key(k.clone())), out)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, v)| places(v, &inside(Step::Index(i)), out))
        }
        _ => {}
    }
}

fn at<'a>(value: &'a mut Value, place: &[Step]) -> &'a mut Value {
    place.iter().fold(value, |value, step| match step {
        Step::Key(key) => &mut value[key.as_str()],
        Step::Index(i) => &mut value[*i],
    })
}

/// The document with something else at one place.
fn with(value: &Value, place: &[Step], new: Value) -> Value {
    let mut out = value.clone();
    *at(&mut out, place) = new;
    out
}

/// Every document that differs from this one in one place by a key that nobody knows, an absent key, or another value.
fn mutations(value: &Value) -> Vec<(String, Value)> {
    let others = [json!(null), json!(true), json!(-1), json!("zzzz"), json!([]), json!({}), json!([0.5])];
    let mut all = Vec::new();
    places(value, &Vec::new(), &mut all);
    let mut out = Vec::new();
    for place in all {
        let mut own = value.clone();
        let here = at(&mut own, &place).clone();
        if let Value::Object(map) = &here {
            let mut more = map.clone();
            more.insert("zzzz".into(), json!(1));
            out.push((format!("{place:?} and zzzz"), with(value, &place, Value::Object(more))));
            for key in map.keys() {
                let mut less = map.clone();
                less.shift_remove(key);
                out.push((format!("{place:?} without {key}"), with(value, &place, Value::Object(less))));
            }
        }
        // one number of a vector stands for all of them
        if !matches!(place.last(), Some(Step::Index(1..)) if here.is_number()) {
            let new = others.iter().filter(|new| **new != here);
            out.extend(new.map(|new| (format!("{place:?} = {new}"), with(value, &place, new.clone()))));
        }
    }
    out
}

/// Holds a reader and a schema together over all mutations of a document; the number of them.
fn hold_together(schema: &Schema, read: &Reader, base: &Value) -> usize {
    let mutations = mutations(base);
    let mut apart = Vec::new();
    for (what, value) in &mutations {
        match (read(value), schema.complaint(value)) {
            (Ok(_), Some(complaint)) => {
                apart.push(format!("{what}: the reader takes it and the schema does not: {complaint}"))
            }
            (Err(faults), None) => {
                let form: Vec<String> =
                    faults.iter().filter(|f| is_about_form(f)).map(Fault::to_string).collect();
                if !form.is_empty() {
                    apart.push(format!("{what}: the schema takes it and the reader says {form:?}"));
                }
            }
            _ => {}
        }
    }
    assert!(apart.is_empty(), "{} changes are judged differently:\n{}", apart.len(), apart.join("\n"));
    mutations.len()
}

/// Writes each default where its key is absent; the document must read as before wherever the schema allows the key.
fn hold_defaults(schema: &Schema, read: &Reader, base: &Value, tried: &mut BTreeSet<String>) {
    let before = read(base).unwrap_or_else(|faults| panic!("{faults:?}"));
    let mut all = Vec::new();
    places(base, &Vec::new(), &mut all);
    for place in all {
        // an object of names, such as a pose, has no keys of its own
        if matches!(place.last(), Some(Step::Key(key)) if ["parameters", "coupled", "turns_with", "pose", "source"].contains(&key.as_str()))
        {
            continue;
        }
        let mut own = base.clone();
        let Value::Object(map) = at(&mut own, &place).clone() else { continue };
        for (name, default) in schema.defaults().into_iter().filter(|(name, _)| !map.contains_key(name)) {
            let mut more = map.clone();
            more.insert(name.clone(), default.clone());
            let value = with(base, &place, Value::Object(more));
            // a key of this name in another kind of object may have another default
            if schema.takes(&value) && is_default_here(schema, &map, &name, &default) {
                let after = read(&value).unwrap_or_else(|f| panic!("{place:?}: {name} = {default}: {f:?}"));
                assert!(before == after, "{place:?}: {name} = {default} changes the document");
                tried.insert(name);
            }
        }
    }
}

/// Whether the kinds of object that know all keys of this one all have this default.
fn is_default_here(
    schema: &Schema,
    map: &serde_json::Map<String, Value>,
    name: &str,
    default: &Value,
) -> bool {
    let shapes = schema.printed["$defs"].as_object().expect("definitions").values();
    let keys = shapes.map(|shape| shape["properties"].as_object().expect("keys"));
    let mut fitting =
        keys.filter(|keys| keys.contains_key(name) && map.keys().all(|key| keys.contains_key(key)));
    fitting.all(|keys| keys[name].get("default") == Some(default))
}

/// An arm with every kind of object.
fn whole_arm() -> Value {
    json!({"name": "whole", "gravity_m_s2": [0, 0, -9.81],
        "materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850, "poisson": 0.29}},
        "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": 1e5, "mass_kg": 2,
                "bearing": {"tilt_stiffness_nm_per_rad": 2e5, "permissible_moment_nm": 300, "mass_kg": 1, "offset_m": 0.02,
                    "pitch_diameter_m": 0.1, "static_load_rating_n": 2e4, "dynamic_load_rating_n": 1e4},
                "extras": {"housing_kg": 0.4, "brake_kg": 0.1, "encoder_kg": 0.05, "flange_kg": 0.1, "cable_kg": 0.05},
                "bodies": [{"mass_kg": 1, "cg_m": [0, 0, 0.1], "inertia_kgm2": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]], "rotates": true}]},
            {"type": "joint", "name": "j2", "axis": [0, 1, 0], "windup": {"k1_nm_per_rad": 1e5, "k2_nm_per_rad": 2e5,
                "k3_nm_per_rad": 3e5, "t1_nm": 10, "t2_nm": 20}},
            {"type": "link", "name": "box", "vector_m": [0.4, 0, 0], "material": "steel",
                "section": {"shape": "rectangular_tube", "width_m": 0.1, "height_m": 0.1, "wall_m": 0.005},
                "bodies": [{"mass_kg": 1, "cg_m": [0.2, 0, 0], "inertia_kgm2": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]}]},
            {"type": "joint", "name": "j3", "axis": [0, 1, 0], "gear": "CSG-25-100", "motor": "ILM70x18", "gear_mass": "housed_unit"},
            {"type": "link", "name": "round", "vector_m": [0.3, 0, 0], "material": "Aluminium 6061-T6",
                "section": {"shape": "round_tube", "diameter_m": 0.1, "wall_m": 0.005}},
            {"type": "joint", "name": "j4", "axis": [0, 1, 0], "stiffness_nm_per_rad": null, "coupled": {"j2": -1}},
            {"type": "link", "name": "bar", "vector_m": [0.1, 0, 0], "material": "steel",
                "section": {"shape": "rectangular_bar", "width_m": 0.02, "height_m": 0.03}},
            {"type": "link", "name": "rod", "vector_m": [0.1, 0, 0], "material": "steel",
                "section": {"shape": "round_bar", "diameter_m": 0.03}},
            {"type": "link", "name": "beam", "vector_m": [0.1, 0, 0], "material": "steel",
                "section": {"shape": "i_beam", "width_m": 0.05, "height_m": 0.1, "web_m": 0.004, "flange_m": 0.006}},
            {"type": "link", "name": "stated", "vector_m": [0.1, 0, 0],
                "section": {"shape": "stated", "width_m": 0.05, "height_m": 0.1, "ei_y_nm2": 3e4, "ei_z_nm2": 2e4, "gj_nm2": 1e4,
                    "kg_per_m": 2.5, "ea_n": 1e7}},
            {"type": "link", "name": "hand", "vector_m": [0.1, 0, 0], "mass_kg": 0.5}],
        "effects": [{"effect": "bearing_tilt", "at": "j2", "parameters": {"stiffness_nm_per_rad": 1e5}, "source": {"by": "hand"}},
            {"effect": "servo_compliance", "at": "j3", "parameters": {"stiffness_nm_per_rad": 1e5, "channel": "static"}},
            {"effect": "payload_cg_error", "at": "payload", "parameters": {"offset_m": [0.01, 0, 0]}}],
        "provenance": {"by": "a test"}})
}

/// An arm with a motor that sits elsewhere.
fn belt_arm() -> Value {
    json!({"name": "belt", "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": 1e5},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5},
        {"type": "link", "name": "a", "vector_m": [0.4, 0, 0], "mass_kg": 1},
        {"type": "joint", "name": "j3", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4, "motor_at": "j1",
            "motor_point_m": [0, 0.1, 0], "motor_mass_kg": 2, "gear_at": "joint", "gear_ratio": 50,
            "transmission": [{"ratio": 2, "efficiency": 0.95, "stiffness_nm_per_rad": 300, "inertia_kgm2": 1e-5, "mass_kg": 0.5},
                {"ratio": 1}]},
        {"type": "link", "name": "b", "vector_m": [0.3, 0, 0], "mass_kg": 1},
        {"type": "joint", "name": "j4", "axis": [1, 0, 0], "stiffness_nm_per_rad": 1e4, "turns_with": {"j3": 0.5}}]})
}

/// A study with a rail that is sized and a belt before a gear.
fn rail_study() -> Value {
    json!({"name": "rail", "chain": [
        {"type": "prismatic", "name": "lift", "axis": [0, 0, 1], "mass_kg": 9, "drive": "first_fit", "max_speed_m_s": 0.2, "brake": true,
            "drives": {"motors": ["electric"]},
            "screws": [{"name": "s", "lead_mm": 10, "root_diameter_mm": 17, "length_mm": 900, "ends": "fixed_fixed",
                "dynamic_load_rating_n": 9000, "max_force_n": 12000, "max_speed_rpm": 3000, "efficiency": 0.85,
                "nut_stiffness_n_per_m": 2e8, "inertia_kgm2": 1e-5, "mass_kg": 1}, {"name": "t", "lead_mm": 5,
                "root_diameter_mm": 12, "length_mm": 900}],
            "racks": [{"name": "r", "pinion_radius_mm": 20, "ratio": 10, "efficiency": 0.9, "max_force_n": 3000,
                "max_speed_rpm": 4000, "stiffness_n_per_m": 2e7, "inertia_kgm2": 1e-5, "mass_kg": 2}]},
        {"type": "joint", "name": "j1", "axis": [0, 1, 0], "drive": "first_fit", "drives": {"ratios": [100]},
            "motor_at": "lift", "motor_point_m": [0, 0, 0], "turns_with": {},
            "transmission": [{"ratio": 2, "efficiency": 0.95, "stiffness_nm_per_rad": 300}]},
        {"type": "link", "name": "a", "vector_m": [0.4, 0, 0], "mass_kg": 1}],
        "payload": {"mass_kg": 1}, "poses": [{"pose": {"lift_mm": 100}}]})
}

/// A study with every kind of object.
fn whole_study() -> Value {
    json!({"name": "whole", "question": "?", "notes": "!", "gravity_m_s2": 9.81,
        "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 0, 1], "drive": "first_fit", "drives": {"gear_series": ["CSG"], "ratios": [100],
                "gear_kinds": ["strain_wave"], "gear_mass": "housed_unit", "motors": ["electric"]},
                "max_speed_rad_s": 1.5, "range_deg": [-90, 90], "brake": true, "extras": "none",
                "duty": [{"torque_nm": -1, "time_s": 1, "speed_rpm": 1}], "fit": {"gear_to_link_max": 2.5, "motor": "behind",
                    "cable_bore_min_mm": 1, "drive_length_max_mm": 900}},
            {"type": "joint", "name": "j2", "axis": [0, 1, 0], "gear": "CSG-25-100", "motor": "ILM70x18", "gear_mass": "housed_unit",
                "mass_kg": 3, "extras": {"brake_kg": 0.1}, "bearing": null},
            {"type": "link", "name": "a", "vector_m": [0.4, 0, 0], "choose": {
                "materials": ["Aluminium 6061-T6", "Structural steel S355"],
                "sections": [
                    {"shape": "rectangular_tube", "width_mm": {"from": 60, "to": 80, "step": 20}, "height_mm": [60, 80], "wall_mm": 2},
                    {"shape": "round_tube", "diameter_mm": 60, "wall_mm": [2, 3]},
                    {"shape": "rectangular_bar", "width_mm": 30}, {"shape": "round_bar", "diameter_mm": 40},
                    {"profiles": {"family": "steel", "shapes": ["square"], "max_outer_mm": 40}}]},
                "bodies": [{"mass_kg": 0.1}]},
            {"type": "joint", "name": "j3", "axis": [0, 1, 0], "windup": {"k1_nm_per_rad": 1e4, "k2_nm_per_rad": 2e4,
                "k3_nm_per_rad": 3e4, "t1_nm": 1, "t2_nm": 2}},
            {"type": "link", "name": "b", "vector_m": [0.2, 0, 0], "material": "Aluminium 6061-T6",
                "section": {"shape": "rectangular_tube", "width_m": 0.08, "height_m": 0.08, "wall_m": 0.005}},
            {"type": "link", "name": "c", "vector_m": [0.1, 0, 0], "mass_kg": 0.1}],
        "payload": {"mass_kg": 1, "cg_m": [0, 0, 0.05], "inertia_about_cg_kgm2": [0.01, 0.01, 0.01]},
        "tip_force_n": [0, 0, -1], "tip_moment_nm": [0, 1, 0],
        "poses": [{"name": "p", "pose_deg": [0, 0, 0], "payload": {"mass_kg": 2}, "tip_force_n": [0, 0, 0],
            "tip_moment_nm": [0, 0, 0], "sizing": true, "judged": true}, {"pose_deg": [0, 30, 0]}],
        "environments": [{"name": "air"}, {"name": "sea", "water": {"density_kg_m3": 1025, "added_mass_coefficient": 1,
            "payload_density_kg_m3": 2700}}],
        "motion": {"tip_speed_m_s": 0.8, "ramp_time_s": 0.3, "emergency_deceleration_m_s2": 6, "min_lever_m": 0.3, "life_h": 5000,
            "emergency_stops": 100, "check_motor_heat": true, "cycle": [{"phase": "accelerate", "time_s": 1},
                {"phase": "fraction", "time_s": 1, "of_static_torque": 0.5, "of_speed": 0.5}, {"phase": "decelerate", "time_s": 1}]},
        "drives": {"gears": ["CSG-25-100"], "motor_models": ["ILM70x18"], "actuators": []}, "extras": "usual", "fit": null,
        "harness_kg_per_m": 0.3, "connection_share": 0.2,
        "constraints": {"tip_deflection_max_mm": 9, "mass_max_kg": 90, "lowest_mode_min_hz": 1, "servo_bandwidth_hz": 1,
            "servo_ratio": 2, "stress_safety_factor_min": 1.5, "wall_slenderness_max": 90, "material_cost_max_eur": 900},
        "models": {"links": "full", "joints": "three_segment"}, "gap_percent": 1,
        "effects": [{"effect": "bearing_tilt", "at": "j1", "parameters": {"stiffness_nm_per_rad": 1e5}, "source": "a test"}]})
}

fn bench_study() -> Value {
    json_of(&project().join("examples/bench-arm.json"))
}

fn whole_cases() -> Value {
    json!([{"name": "bent", "pose_deg": [-30, 60], "payload": {"mass_kg": 5, "cg_m": [0.05, 0, 0],
        "inertia_about_cg_kgm2": [0.01, 0.02, 0.02]}, "tip_force_n": [0, 0, -10], "tip_moment_nm": [0, 0, 1], "links": "full",
        "joints": "three_segment", "water": {"density_kg_m3": 1025, "added_mass_coefficient": 1, "payload_density_kg_m3": 7850}},
        {"pose_deg": [0, 0], "payload": {"mass_kg": 1}, "water": {"density_kg_m3": 1025}}])
}

#[test]
fn arm_and_cases_readers_and_their_schemas_judge_every_change_of_a_file_equally() {
    let catalogs = Catalogs::builtin();
    let (schema, read) = (Schema::of("arm"), arm_reader(&catalogs));
    let mut count = hold_together(&schema, &read, &whole_arm());
    let mut tried = BTreeSet::new();
    hold_defaults(&schema, &read, &whole_arm(), &mut tried);
    count += hold_together(&schema, &read, &belt_arm());
    hold_defaults(&schema, &read, &belt_arm(), &mut tried);
    let plain = json!({"chain": [{"type": "joint", "name": "a", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "bearing": {}},
        {"type": "link", "name": "b", "vector_m": [1, 0, 0], "bodies": [{"mass_kg": 1}]}]});
    hold_defaults(&schema, &read, &plain, &mut tried);
    assert!(tried.len() >= 12, "{tried:?}");
    let cases: Reader = Box::new(|v| {
        read_load_cases(document(v), &["a", "b"].map(DrivenJoint::turning))
            .map(Read::Cases)
            .map_err(faults_of)
    });
    let schema = Schema::of("cases");
    count += hold_together(&schema, &cases, &whole_cases());
    hold_defaults(&schema, &cases, &whole_cases(), &mut tried);
    assert!(count > 1000, "{count} changes");
}

#[test]
fn the_study_reader_and_its_schema_judge_every_change_of_a_file_equally() {
    let catalogs = Catalogs::builtin();
    let (schema, read) = (Schema::of("study"), study_reader(&catalogs));
    for base in [whole_study(), bench_study(), rail_study()] {
        assert!(schema.takes(&base), "{:?}", schema.complaint(&base));
        read(&base).unwrap_or_else(|faults| panic!("{faults:?}"));
    }
    let count = hold_together(&schema, &read, &whole_study()) + hold_together(&schema, &read, &rail_study());
    let mut tried = BTreeSet::new();
    for base in [whole_study(), bench_study(), rail_study()] {
        hold_defaults(&schema, &read, &base, &mut tried);
    }
    assert!(count > 1000 && tried.len() >= 12, "{count} changes, {tried:?}");
}

/// A campaign whose `campaign.json` is to be changed.
fn campaign_folder() -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a folder");
    let from = project().join("examples/measured-arm");
    for name in ["arm.json", "static.csv", "modal.csv", "windup.csv"] {
        let text = fs::read_to_string(from.join(name)).expect(name);
        let head: Vec<&str> = text.lines().take(if name == "arm.json" { usize::MAX } else { 4 }).collect();
        fs::write(here.path().join(name), head.join("\n")).expect("written");
    }
    here
}

#[test]
fn the_campaign_reader_and_its_schema_judge_every_change_of_a_file_equally() {
    let (catalogs, here, schema) = (Catalogs::builtin(), campaign_folder(), Schema::of("campaign"));
    let read: Reader = Box::new(|v| {
        fs::write(here.path().join("campaign.json"), v.to_string()).expect("written");
        match Campaign::read(here.path(), &catalogs) {
            Ok(campaign) => Ok(Read::Campaign(format!("{:?}", campaign.statement))),
            Err(InputError::Faulty(faults)) => Err(faults.0),
            Err(InputError::Unreadable { .. }) => Err(Vec::new()),
        }
    });
    let sound = json!({"name": "whole", "arm": "arm.json", "conventions": {"payload_density_kg_m3": 7850, "force": "at the tip"},
        "tolerance": {"joint_stiffness": 0.1, "modulus": 0.03, "joint_mass": 0.02, "bearing_stiffness": 0, "note": "n"},
        "static": {"file": "static.csv", "note": "n"}, "files": {"modal": "modal.csv", "windup": {"file": "windup.csv"}},
        "columns": {"static": {"dz_mm": "dz_mm"}}, "links": "full", "effects": ["bearing_tilt"], "ratio": {"a": 100},
        "torque_at": "shaft", "description": "d", "machine": "m", "date": "x", "provenance": "p", "note": "n"});
    assert!(
        read(&sound).is_ok() && schema.takes(&sound),
        "{:?} {:?}",
        read(&sound),
        schema.complaint(&sound)
    );
    let mut count = hold_together(&schema, &read, &sound);
    // its positions and records are not there, which is no matter of keys
    let further = json!({"other_arms": [], "positions": {"base_placement": true, "tool_offset": true, "joint_offsets": true,
        "geometry": false, "gravity_direction": false, "mounts": [], "sessions": [{"from_row": 3, "moved": "base"}],
        "file": "positions.csv", "note": "n"}, "records": [{"file": "r.csv", "columns": {"t_s": "Time"}, "ratio": 100,
        "torque_constant_nm_per_a": 0.1, "rotor_inertia_kgm2": 1e-5, "torque_at": "shaft"}],
        "files": {"static": {"file": "m.xlsx", "sheet": "S1", "header_row": 2}}});
    assert!(schema.takes(&further), "{:?}", schema.complaint(&further));
    count += hold_together(&schema, &read, &further);
    let mut tried = BTreeSet::new();
    hold_defaults(&schema, &read, &json!({"name": "plain", "tolerance": {}, "conventions": {}}), &mut tried);
    assert!(count > 400 && tried.len() >= 8, "{count} changes, {tried:?}");
}

/// Every JSON file below a folder that its kind of file has.
fn shipped(kind: &str) -> Vec<PathBuf> {
    let mut out = Vec::new();
    for folder in ["studies", "examples", "tests/data"] {
        files_below(&project().join(folder), "json", &mut out);
    }
    let fits = |path: &PathBuf| {
        let (name, value) = (path.file_name().expect("a name").to_string_lossy().into_owned(), json_of(path));
        match kind {
            "campaign" => name == "campaign.json",
            "study" => value.get("chain").is_some() && value.get("poses").is_some(),
            "arm" => value.get("chain").is_some() && value.get("poses").is_none(),
            _ => value[0].get("pose_deg").is_some(),
        }
    };
    out.retain(fits);
    out
}

#[test]
fn every_shipped_file_fits_its_schema() {
    let at_least = [("campaign", 30), ("study", 10), ("arm", 30)];
    for (kind, least) in at_least {
        let (schema, files) = (Schema::of(kind), shipped(kind));
        assert!(files.len() >= least, "{} {kind} files", files.len());
        for path in files {
            let complaint = schema.complaint(&json_of(&path));
            assert!(complaint.is_none(), "{}: {}", path.display(), complaint.unwrap_or_default());
        }
    }
}

#[test]
fn every_catalog_has_a_table_schema_that_its_own_rows_fit() {
    for file in CatalogFile::ALL {
        let kind = file.file_name().trim_end_matches(".csv");
        let (code, said) = armwright(&project(), &["schema", kind]);
        assert_eq!(code, 0, "{said}");
        let schema: Value = serde_json::from_str(&said).expect("JSON");
        let mut reader =
            csv::Reader::from_path(project().join("catalogs").join(file.file_name())).expect("a catalog");
        let header = reader.headers().expect("a header").clone();
        for row in reader.records() {
            let row = row.expect("a row");
            for field in schema["fields"].as_array().expect("fields") {
                let place = header.iter().position(|name| field["name"] == name);
                let cell = place.map_or("", |place| &row[place]);
                assert!(fits(field, cell), "{kind}: {} = \"{cell}\" in {row:?}", field["name"]);
            }
        }
    }
}

/// Whether a cell fits a field of a Table Schema; patterns are left to the reader.
fn fits(field: &Value, cell: &str) -> bool {
    let limits = &field["constraints"];
    if cell.is_empty() {
        return limits["required"] != true;
    }
    if field["type"] == "string" {
        return true;
    }
    let Ok(number) = cell.parse::<f64>() else { return false };
    let holds =
        |key: &str, ok: fn(f64, f64) -> bool| limits[key].as_f64().is_none_or(|limit| ok(number, limit));
    holds("minimum", |x, limit| x >= limit)
        && holds("exclusiveMinimum", |x, limit| x > limit)
        && holds("maximum", |x, limit| x <= limit)
        && (field["type"] == "number" || number.fract() == 0.0)
}

#[test]
fn the_page_of_all_keys_is_what_the_program_prints() {
    let (code, said) = armwright(&project(), &["schema", "--markdown"]);
    assert_eq!(code, 0);
    let page = fs::read_to_string(project().join("docs/keys.md")).expect("docs/keys.md");
    assert!(page == said, "write it anew: armwright schema --markdown > docs/keys.md");
}

#[test]
fn an_unknown_kind_is_refused_with_the_kinds_there_are() {
    let (code, said) = armwright(&project(), &["schema", "arms"]);
    assert!(
        code == 2 && said.contains("kinds: arm, cases, study, campaign, ") && said.contains(", effects"),
        "{said}"
    );
}

/// The cells of the rows of a page's tables whose first cell names keys.
fn rows_of_keys(page: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(project().join(page)).expect(page);
    let rows = text.lines().filter(|line| line.starts_with("| `"));
    rows.map(|row| row.trim_matches('|').split(" | ").map(|cell| cell.trim().to_string()).collect()).collect()
}

#[test]
fn the_format_pages_give_each_key_the_unit_and_the_number_that_the_tables_do() {
    let all = rows_of_keys("docs/keys.md");
    let mut compared = 0;
    for page in ["docs/arm-format.md", "docs/study-format.md"] {
        for row in rows_of_keys(page).into_iter().filter(|row| row.len() > 2) {
            for key in row[0].split('`').skip(1).step_by(2) {
                let of_key = all.iter().filter(|known| known[0].trim_matches('`') == key);
                let known: Vec<&Vec<String>> = of_key.collect();
                // a row of several keys has no unit of its own; one without a default has three cells
                let has_unit = !known.is_empty() && row[1] != "-" && !row[1].starts_with('`');
                assert!(!has_unit || known.iter().any(|k| k[2] == row[1]), "{page}: {key} [{}]", row[1]);
                let default = row[2].trim_matches('`');
                let is_number = row.len() > 3 && !known.is_empty() && default.parse::<f64>().is_ok();
                let agrees = |k: &&Vec<String>| k[3].trim_matches('`').parse() == default.parse::<f64>();
                assert!(!is_number || known.iter().any(agrees), "{page}: {key} = {default} by default");
                compared += usize::from(has_unit) + usize::from(is_number);
            }
        }
    }
    assert!(compared > 60, "only {compared} units and numbers were compared");
}
