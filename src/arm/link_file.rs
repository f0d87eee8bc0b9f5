//! Reads a link of an arm file or a study: its tube with section and material, or its rigid offset.

use super::body::read_link_bodies;
use super::element_keys::read_name;
use super::keys::{RECTANGULAR_BAR, RECTANGULAR_TUBE, ROUND_BAR, ROUND_TUBE};
use super::load::vector;
use super::section::{LinkMaterial, Section, Strength};
use super::section_file::{read_i_beam, read_stated_section};
use super::{Link, LinkBody};
use crate::catalog::Catalogs;
use crate::catalog::material::{Material, MaterialClass, isotropic_shear_modulus_pa};
use crate::input::json::{Node, Object};
use nalgebra::Vector3;

/// Poisson's ratio of a material that states none \[-\].
pub(super) const DEFAULT_POISSON: f64 = 0.3;

/// A material of the file with its name. The material is `None` if it is faulty; its faults are then already
/// recorded.
pub(crate) type NamedMaterial = (String, Option<LinkMaterial>);

/// Reads a link of one section, or a rigid offset. Returns `None` after recording a fault.
pub(super) fn read_link(object: &Object, materials: &[NamedMaterial], catalogs: &Catalogs) -> Option<Link> {
    let name = read_name(object);
    let vector_m = object.required("vector_m").and_then(|n| vector(&n));
    let body = match object.optional("section") {
        Some(section) => read_tube(object, object, &section, vector_m, materials, catalogs),
        None => {
            if let Some(material) = object.optional("material") {
                material.fault::<()>(
                    "stands without a section",
                    "give the tube's section, or leave the material away for a rigid link",
                );
            }
            object.or("mass_kg", 0.0, Node::non_negative).map(|mass_kg| LinkBody::Offset { mass_kg })
        }
    };
    let bodies = read_link_bodies(object);
    Some(Link { name: name?, vector_m: vector_m?, body: body?, bodies: bodies? })
}

/// Name under which the equivalent material of a section with stated stiffnesses is listed.
const STATED_MATERIAL: &str = "(stated stiffness)";

/// Reads a tube with its section, from the object `object`. The material is read from the object `of_material`. This is
/// `object` itself or, for a piece of a link that states no material, the object of the link. Returns `None` after
/// recording a fault.
pub(super) fn read_tube(
    object: &Object,
    of_material: &Object,
    section: &Node,
    vector_m: Option<Vector3<f64>>,
    materials: &[NamedMaterial],
    catalogs: &Catalogs,
) -> Option<LinkBody> {
    if let Some(mass) = object.optional("mass_kg") {
        mass.fault::<()>(
            "is given together with a section",
            "a tube's mass follows from section and density; remove it",
        );
    }
    if vector_m.is_some_and(|v| v.norm() < 1e-6) {
        object.node().fault::<()>("is a tube without length", "give a longer vector_m, or no section");
    }
    let section = read_section(section);
    if let Some(Section::Stated(stated)) = section {
        if let Some(material) = object.optional("material") {
            material.fault::<()>("stands beside a section of stated stiffness and mass", "remove it");
        }
        let (material_name, material) = (STATED_MATERIAL.to_string(), stated.material());
        return Some(LinkBody::Tube { material_name, material, section: Section::Stated(stated) });
    }
    let material = of_material.required("material").and_then(|n| {
        let name = n.string()?;
        find_material(&n, name, materials, catalogs).map(|m| (name.to_string(), m))
    });
    let (material_name, material) = material?;
    Some(LinkBody::Tube { material_name, material, section: section? })
}

fn find_material(
    node: &Node,
    name: &str,
    materials: &[NamedMaterial],
    catalogs: &Catalogs,
) -> Option<LinkMaterial> {
    if let Some((_, material)) = materials.iter().find(|(n, _)| n == name) {
        return *material;
    }
    let Some(row) = catalogs.materials.iter().find(|m| m.name == name) else {
        return node.fault(format!("material \"{name}\" is not known"), &known_materials(materials));
    };
    let Some(material) = material_of(row) else {
        let hint = format!("{}; or add the material to the file", shear_modulus_hint(row));
        return node.fault(format!("material \"{name}\" has no shear modulus"), &hint);
    };
    Some(material)
}

/// Where the materials are listed that a link may name, in words.
fn known_materials(materials: &[NamedMaterial]) -> String {
    let of_file: Vec<&str> = materials.iter().map(|(name, _)| name.as_str()).collect();
    let of_catalog = "`armwright catalog show materials` lists the catalog's";
    match of_file.is_empty() {
        true => of_catalog.to_string(),
        false => format!("the file's materials: {}; {of_catalog}", of_file.join(", ")),
    }
}

/// The elastic material of a row of the catalog; `None` if the row states no shear modulus.
pub(crate) fn material_of(row: &Material) -> Option<LinkMaterial> {
    elastic(row).map(|material| LinkMaterial { strength: strength_of(row), ..material })
}

/// The material of a row of the catalog without its strength; `None` if the row states no shear modulus.
fn elastic(row: &Material) -> Option<LinkMaterial> {
    Some(LinkMaterial {
        youngs_modulus_pa: row.youngs_modulus_pa,
        shear_modulus_pa: row.shear_modulus_pa?,
        density_kg_m3: row.density_kg_m3,
        poisson: row.poisson.unwrap_or(DEFAULT_POISSON),
        strength: None,
        class: Some(row.class),
    })
}

/// The strength of a row of the catalog. `None` if the row does not state it, or if the material is weak in shear and the
/// row does not state its strength in shear.
fn strength_of(row: &Material) -> Option<Strength> {
    let tensile_pa = row.strength_pa?;
    let along_pa = row.compressive_strength_pa.map_or(tensile_pa, |pa| pa.min(tensile_pa));
    (!lacks_shear_strength(row)).then_some(Strength { along_pa, shear_pa: row.shear_strength_pa })
}

/// Whether the strength in shear of a row of the catalog is unknown: the row does not state it, and it does not follow
/// from the strength along the link. It does not in wood, in layers whose fibres all run along the link, and in other
/// materials whose shear modulus is less than half of `E/2(1+ν)`.
pub(crate) fn lacks_shear_strength(row: &Material) -> bool {
    let is_soft = elastic(row).is_some_and(|material| material.is_soft_in_shear());
    row.shear_strength_pa.is_none() && (row.unidirectional || row.class == MaterialClass::Wood || is_soft)
}

/// Advice on a row of the catalog that states no shear modulus. The program does not compute the missing value for the
/// user, because it enters every number, and because the relation to Young's modulus holds for isotropic materials
/// only.
pub(crate) fn shear_modulus_hint(row: &Material) -> String {
    let from = match (&row.provenance.file, row.provenance.line) {
        (file, line) if !row.provenance.is_built_in() => format!(" ({file}:{line})"),
        _ => String::new(),
    };
    let isotropic_pa = row.poisson.map(|nu| isotropic_shear_modulus_pa(row.youngs_modulus_pa, nu));
    let number = match (row.class, isotropic_pa) {
        (MaterialClass::Metal | MaterialClass::MetalMatrix, Some(g_pa)) => {
            format!(": for this isotropic material G = E/2(1+nu) = {g_pa:.3e} Pa")
        }
        (MaterialClass::Polymer, Some(g_pa)) => {
            format!(
                ": G = E/2(1+nu) = {g_pa:.3e} Pa if the part is isotropic, as a moulded one is; of a printed one it is \
                 measured"
            )
        }
        (MaterialClass::Metal | MaterialClass::MetalMatrix | MaterialClass::Polymer, None) => {
            ", or the column poisson, from which G = E/2(1+nu) follows for an isotropic material".into()
        }
        (class, _) => {
            format!(
                " as it is measured: of a material of class {class} it does not follow from e_pa and poisson"
            )
        }
    };
    format!("fill the column g_pa of its row{from}{number}")
}

/// Reads a cross-section from its object in the file. Returns `None` after recording a fault.
pub(crate) fn read_section(node: &Node) -> Option<Section> {
    let shape = node.value().get("shape").and_then(|v| v.as_str());
    let section = match shape {
        Some("rectangular_tube") => {
            let object = node.shaped(&RECTANGULAR_TUBE)?;
            let [width, height, wall] =
                ["width_m", "height_m", "wall_m"].map(|k| object.required(k).and_then(|n| n.positive()));
            Section::RectangularTube { width_m: width?, height_m: height?, wall_m: wall? }
        }
        Some("round_tube") => {
            let object = node.shaped(&ROUND_TUBE)?;
            let [diameter, wall] =
                ["diameter_m", "wall_m"].map(|k| object.required(k).and_then(|n| n.positive()));
            Section::RoundTube { diameter_m: diameter?, wall_m: wall? }
        }
        Some("rectangular_bar") => {
            let object = node.shaped(&RECTANGULAR_BAR)?;
            let [width, height] =
                ["width_m", "height_m"].map(|k| object.required(k).and_then(|n| n.positive()));
            Section::RectangularBar { width_m: width?, height_m: height? }
        }
        Some("round_bar") => {
            let object = node.shaped(&ROUND_BAR)?;
            Section::RoundBar { diameter_m: object.required("diameter_m").and_then(|n| n.positive())? }
        }
        Some("i_beam") => read_i_beam(node)?,
        Some("stated") => read_stated_section(node).map(Section::Stated)?,
        _ => {
            return node.fault(
                "has no known \"shape\"",
                "choose one of: rectangular_tube, round_tube, rectangular_bar, round_bar, i_beam, stated",
            );
        }
    };
    let (width, height) = section.outer_m();
    let wall = section.wall_m();
    if 2.0 * wall > width.min(height) {
        return node.fault(
            format!("wall_m = {wall} leaves no hollow in {width} x {height} m"),
            "the wall is at most half of the smaller outer dimension, which is a solid bar",
        );
    }
    Some(section.closed())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blank_shear_modulus_is_named_with_its_column_and_with_the_number_of_an_isotropic_material() {
        let folder = tempfile::tempdir().unwrap();
        let rows = "name,class,e_pa,density_kg_m3,poisson,source,confidence\n\
            A,metal,7e10,2700,0.33,a test,verified\n\
            B,polymer,2e9,1200,0.38,a test,verified\n\
            C,wood,1e10,600,0.3,a test,verified\n\
            D,metal,7e10,2700,,a test,verified\n";
        std::fs::write(folder.path().join("materials.csv"), rows).unwrap();
        let catalogs = Catalogs::load(Some(folder.path())).unwrap();
        let hint = |name: &str| {
            let row = catalogs.materials.iter().find(|row| row.name == name).unwrap();
            assert!(material_of(row).is_none());
            shear_modulus_hint(row)
        };
        // the hints have E / (2 (1 + ν)): 7e10 / 2.66 and 2e9 / 2.76
        assert!(
            hint("A").contains("the column g_pa of its row") && hint("A").contains("= 2.632e10 Pa"),
            "{}",
            hint("A")
        );
        assert!(hint("A").contains("materials.csv:2"), "{}", hint("A"));
        assert!(hint("B").contains("= 7.246e8 Pa if the part is isotropic"), "{}", hint("B"));
        assert!(hint("C").contains("does not follow from e_pa and poisson"), "{}", hint("C"));
        assert!(hint("D").contains("or the column poisson"), "{}", hint("D"));
    }
}
