//! Studies that the benchmarks and the example `speed` share.

use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::study::{Study, read_study};
use serde_json::json;

/// A study of an arm with three given joints and two rigid links, in the stretched pose. Each joint has a single
/// stiffness. Each link has at least `options` options (material and section). The modes of an arm are an eigenvalue
/// problem with a 3 x 3 matrix.
pub fn simple(options: u32, catalogs: &Catalogs) -> Study {
    // The sections are square tubes of two materials. The numbers of sides and wall thicknesses are chosen so that
    // there are at least `options` combinations.
    let sides = (f64::from(options) / 2.0).sqrt().ceil() as u32;
    let walls = options.div_ceil(2 * sides);
    let grid = |from: f64, to: f64, n: u32| -> Vec<f64> {
        (0..n).map(|i| from + (to - from) * f64::from(i) / f64::from(n.max(2) - 1)).collect()
    };
    let choose = json!({
        "materials": ["Structural steel S355", "Aluminium 6061-T6"],
        "sections": [{"shape": "rectangular_tube", "width_mm": grid(60.0, 200.0, sides), "height_mm": "=width",
            "wall_mm": grid(2.0, 10.0, walls)}]});
    let joint = |name: &str, axis: [u8; 3], stiffness: f64, mass_kg: f64| json!({"type": "joint", "name": name, "axis": axis, "stiffness_nm_per_rad": stiffness, "mass_kg": mass_kg});
    let text = json!({
        "name": "simple", "question": "speed",
        "chain": [
            joint("j1", [0, 0, 1], 6.1e5, 20.0),
            {"type": "link", "name": "shoulder", "vector_m": [0, 0, 0.3]},
            joint("j2", [0, 1, 0], 6.1e5, 12.2),
            {"type": "link", "name": "upper_arm", "vector_m": [0.8, 0, 0], "choose": choose},
            joint("j3", [0, 1, 0], 2.3e5, 9.2),
            {"type": "link", "name": "forearm", "vector_m": [0.5, 0, 0], "choose": choose},
        ],
        "payload": {"mass_kg": 5},
        "poses": [{"name": "stretched", "pose_deg": [0, 0, 0]}],
        "models": {"links": "rigid", "joints": "k2"},
    });
    let document = Document::parse("simple", &text.to_string()).expect("the text above is JSON");
    read_study(document, catalogs).expect("the study above is whole")
}
