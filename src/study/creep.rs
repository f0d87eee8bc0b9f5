//! Remarks on links of materials that creep.

use crate::arm::pieces::{factors_sentence, without_factors};
use crate::arm::section::LinkMaterial;
use crate::arm::{Link, LinkBody};
use crate::catalog::Catalogs;
use crate::space::design_space::{DesignSpace, SpacePiece};

/// Remarks: one sentence for each material that creeps and that a link has or may have, and one for links whose
/// stiffness or mass the study multiplies by a factor.
pub(super) fn creep_remarks(space: &DesignSpace, catalogs: &Catalogs) -> Vec<String> {
    let mut links_of: Vec<(&str, LinkMaterial, Vec<&str>)> = Vec::new();
    let mut add = |name, material, link| match links_of.iter_mut().find(|(known, ..)| *known == name) {
        Some((_, _, links)) if links.contains(&link) => {}
        Some((_, _, links)) => links.push(link),
        None => links_of.push((name, material, vec![link])),
    };
    for piece in &space.pieces {
        match piece {
            SpacePiece::Joint(_) | SpacePiece::Prismatic(_) => {}
            SpacePiece::Link(link) => {
                if let LinkBody::Tube { material_name, material, .. } = &link.body {
                    add(material_name.as_str(), *material, link.name.as_str());
                }
            }
            SpacePiece::Choice(choice) => {
                let options = choice.options.iter();
                options.for_each(|option| add(&option.material_name, option.material, &choice.name));
            }
        }
    }
    let sentence = |(name, material, links): (&str, LinkMaterial, Vec<&str>)| {
        creep_sentence(catalogs, (name, &material), &links.join(", "))
    };
    let given = space.pieces.iter().filter_map(|piece| match piece {
        SpacePiece::Link(Link { name, body: LinkBody::Tube { material_name, .. }, .. }) => {
            Some((material_name.as_str(), name.as_str()))
        }
        _ => None,
    });
    let factors = factors_sentence(given);
    links_of.into_iter().filter_map(sentence).chain(factors).collect()
}

/// A sentence on the links named in `links`, whose material is `material`; `None` if the material does not creep. The
/// class of the material decides. If the material states none, the class of the catalog's material of the same name is
/// taken; without either, the result is `None`.
pub(crate) fn creep_sentence(
    catalogs: &Catalogs,
    (name, material): (&str, &LinkMaterial),
    links: &str,
) -> Option<String> {
    let name = without_factors(name);
    let row = catalogs.materials.iter().find(|row| row.name == name);
    let class = material.class.or(row.map(|row| row.class))?;
    // an arm file may state another modulus than the row of this name in the catalogs at hand
    let modulus_pa = material.youngs_modulus_pa;
    let is_of_row = row.is_some_and(|row| row.youngs_modulus_pa == modulus_pa);
    let whose = if is_of_row { "the catalog's modulus" } else { "the stated modulus" };
    class.caution().map(|caution| {
        format!(
            "{name} ({class}) in {links}: {caution}. Deflections, stresses and frequencies are those of a short load with \
             {whose} of {:.3} GPa; give a creep modulus for a load that stays.",
            modulus_pa / 1e9
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::json::Document;
    use crate::study::read::read_study;

    #[test]
    fn a_printed_link_is_said_to_creep_and_a_steel_one_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let rows = "name,class,e_pa,g_pa,density_kg_m3,poisson,source,confidence\n\
            PETG printed,polymer,2.0e9,0.73e9,1270,0.38,a test,third party\n";
        std::fs::write(folder.path().join("materials.csv"), rows).unwrap();
        let catalogs = Catalogs::load(Some(folder.path())).unwrap();
        let remarks = |material: &str| {
            let study = format!(
                r#"{{"name": "s", "chain": [
                {{"type": "joint", "name": "j", "axis": [0,1,0], "stiffness_nm_per_rad": 1e4}},
                {{"type": "link", "name": "arm", "vector_m": [0.3,0,0], "material": "{material}",
                  "section": {{"shape": "round_tube", "diameter_m": 0.04, "wall_m": 0.004}}}}],
                "poses": [{{"pose_deg": [0]}}]}}"#
            );
            let study = read_study(Document::parse("s.json", &study).unwrap(), &catalogs).unwrap();
            study.remarks.join(" ")
        };
        let printed = remarks("PETG printed");
        assert!(printed.contains("PETG printed (polymer) in arm: it creeps"), "{printed}");
        assert!(printed.contains("2.000 GPa"), "{printed}");
        assert!(!remarks("Structural steel S355").contains("creep"));
    }
}
