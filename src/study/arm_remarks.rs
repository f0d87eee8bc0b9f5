//! What a reader should know of the analysis of an arm besides its numbers.

use super::creep::creep_sentence;
use super::warping;
use crate::arm::effect::entry::Effect;
use crate::arm::pieces::factors_sentence;
use crate::arm::section::LinkMaterial;
use crate::arm::{Arm, Element, Link, LinkBody};
use crate::catalog::Catalogs;

/// The remark on what an analysis leaves out of every number of an arm with gears.
const LEFT_OUT: &str = "Left out of every number, unless the file states it: the compliance of the connections between links and \
    joints, and the cables along the links. Also temperature, and whether the parts fit into each other.";

/// Remarks on the analysis of an arm, in sentences: on links of materials that creep, on links with stated factors, on
/// I sections, and on what is left out of every number.
pub fn arm_remarks(arm: &Arm, catalogs: &Catalogs) -> Vec<String> {
    let has_gear = |element: &Element| matches!(element, Element::Joint(joint) if joint.gear.is_some());
    let left_out = arm.chain.iter().any(has_gear).then(|| LEFT_OUT.to_string());
    creep_sentences(arm, catalogs).into_iter().chain(warping::of_arm(arm)).chain(left_out).collect()
}

/// The names of the effects that an analysis ignores because they describe a test and not the arm, in words; `None` if
/// there are none.
pub fn ignored_words(arm: &Arm) -> Option<String> {
    let effects: Vec<String> = arm.ignored_effects().into_iter().map(Effect::label).collect();
    (!effects.is_empty())
        .then(|| format!("ignored, because they describe a test and not the arm: {}", effects.join(", ")))
}

fn creep_sentences(arm: &Arm, catalogs: &Catalogs) -> Vec<String> {
    let tubes = arm.chain.iter().filter_map(|element| match element {
        Element::Link(Link { name, body: LinkBody::Tube { material_name, material, .. }, .. }) => {
            Some(((material_name.as_str(), material), name.as_str()))
        }
        _ => None,
    });
    let tubes: Vec<((&str, &LinkMaterial), &str)> = tubes.collect();
    let creep = tubes.iter().filter_map(|(material, link)| creep_sentence(catalogs, *material, link));
    creep.chain(factors_sentence(tubes.iter().map(|((material, _), link)| (*material, *link)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::input::json::Document;

    /// The remarks on an arm with one link, and the arm as JSON text. `materials` is the list of materials in its file,
    /// as JSON; `name` is the material of the link. The file is read with the catalogs `catalogs`.
    fn remarks(materials: &str, name: &str, catalogs: &Catalogs) -> (String, String) {
        let text = format!(
            r#"{{"name": "a", "materials": {materials}, "chain": [
            {{"type": "joint", "name": "j", "axis": [0,1,0], "stiffness_nm_per_rad": 1e4}},
            {{"type": "link", "name": "l", "vector_m": [0.3,0,0], "material": "{name}",
              "section": {{"shape": "i_beam", "width_m": 0.05, "height_m": 0.1, "web_m": 0.004, "flange_m": 0.006}}}}]}}"#
        );
        read(&text, catalogs)
    }

    fn read(text: &str, catalogs: &Catalogs) -> (String, String) {
        let arm = read_arm_document(Document::parse("a.json", text).expect("JSON"), catalogs).expect("sound");
        (arm_remarks(&arm, catalogs).join(" "), arm.to_json().to_string())
    }

    #[test]
    fn an_arm_that_was_written_keeps_the_class_of_its_materials() {
        let folder = tempfile::tempdir().unwrap();
        let rows = "name,class,e_pa,g_pa,density_kg_m3,source,confidence\n\
            Birch,wood,8.5e9,0.62e9,680,a test,third party\n";
        std::fs::write(folder.path().join("materials.csv"), rows).unwrap();
        let own = Catalogs::load(Some(folder.path())).unwrap();
        let (said, written) = remarks("{}", "Birch", &own);
        assert!(said.contains("Birch (wood) in l: it creeps"), "{said}");
        let (again, written_again) = read(&written, &Catalogs::builtin());
        assert!(again.contains("Birch (wood) in l: it creeps"), "{again}");
        assert!(again.contains("the stated modulus of 8.500 GPa"), "{again}");
        assert_eq!(written, written_again);
    }

    #[test]
    fn an_arm_file_without_classes_is_read_as_before() {
        let numbers = r#"{"X": {"youngs_modulus_pa": 2e9, "shear_modulus_pa": 7e8, "density_kg_m3": 1200}}"#;
        let (said, written) = remarks(numbers, "X", &Catalogs::builtin());
        assert!(!said.contains("creeps") && !written.contains("class"), "{said} {written}");
    }

    #[test]
    fn an_i_section_is_said_to_be_taken_as_free_to_warp() {
        let (said, _) = remarks("{}", "Structural steel S355", &Catalogs::builtin());
        assert!(
            said.contains("l is an I section, 0.300 m long, whose ends are taken as free to warp"),
            "{said}"
        );
    }
}
