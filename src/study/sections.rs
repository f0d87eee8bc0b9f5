//! The options of an open link: each of its materials combined with each of its sections.

use super::choose_keys::{
    GRID, PROFILE_FILTER, PROFILES, RECTANGULAR_BARS, RECTANGULAR_TUBES, ROUND_BARS, ROUND_TUBES,
};
use crate::arm::link_file::{lacks_shear_strength, material_of, shear_modulus_hint};
use crate::arm::section::Section;
use crate::arm::{Link, LinkBody};
use crate::catalog::Catalogs;
use crate::catalog::lookup::hint_for_unknown;
use crate::catalog::material::Material;
use crate::catalog::profile::{Profile, ProfileShape};
use crate::input::json::{Node, Object};
use crate::space::constraint::Constraints;
use crate::space::design_space::{DesignSpace, LinkOption, SpacePiece};
use std::collections::{BTreeSet, HashSet};

/// Largest number of points of a grid. More are a sign of a mistake in the step.
const MOST_POINTS: usize = 100_000;
/// Largest number of sections that one family of a study file may have, before walls that do not fit are left out.
const MOST_SECTIONS: usize = 1_000_000;
/// Largest number of options (pairs of material and section) of all links together. So many options take about a
/// gigabyte of memory.
pub(super) const MOST_OPTIONS: usize = 3_000_000;

/// The sections from which an open link is chosen, each with its profile name if it is a catalog profile.
pub(super) struct Sections {
    sections: Vec<(Section, Option<ProfileName>)>,
}

/// Messages on options of links, collected while a study is read.
#[derive(Default)]
pub(super) struct Aside {
    /// Messages on options that were left out because a rating that a check needs is blank.
    pub not_checked: Vec<String>,
    /// Remarks on the options, as sentences for the reader of the result.
    pub remarks: Vec<String>,
    /// Number of options of all links read so far.
    pub options: usize,
}

/// The designation of a catalog profile, and the family of materials in which it is sold.
#[derive(Clone, PartialEq, Eq, Hash)]
struct ProfileName {
    designation: String,
    family: String,
}

/// Reads a list of names of materials. A name must not occur twice. Returns `None` after recording a fault.
pub(super) fn read_materials<'c>(node: &Node, catalogs: &'c Catalogs) -> Option<Vec<&'c Material>> {
    let items = node.array()?;
    if items.is_empty() {
        return node.fault("is empty", "name at least one material");
    }
    let names: Vec<&str> = catalogs.materials.iter().map(|m| m.name.as_str()).collect();
    let repeated =
        items.iter().enumerate().filter(|(i, n)| items[..*i].iter().any(|o| o.value() == n.value()));
    for (_, item) in repeated {
        item.fault::<()>(format!("{} is listed twice", item.value()), "list every material once");
    }
    let read: Vec<Option<&Material>> = items
        .iter()
        .map(|n| {
            let name = n.string()?;
            let Some(material) = catalogs.materials.iter().find(|m| m.name == name) else {
                return n.fault(
                    format!("material \"{name}\" is not in the catalog"),
                    &hint_for_unknown(name, &names, "materials"),
                );
            };
            match material.shear_modulus_pa {
                Some(_) => Some(material),
                None => n.fault(
                    format!("material \"{name}\" has no shear modulus"),
                    &shear_modulus_hint(material),
                ),
            }
        })
        .collect();
    read.into_iter().collect()
}

impl Sections {
    pub(super) fn len(&self) -> usize {
        self.sections.len()
    }
}

/// Reads a list of section families. Returns `None` after recording a fault.
pub(super) fn read_sections(node: &Node, catalogs: &Catalogs) -> Option<Sections> {
    let read: Vec<_> = node.array()?.iter().map(|n| read_family(n, catalogs)).collect();
    let mut sections = read.into_iter().collect::<Option<Vec<_>>>()?.concat();
    // a tube that occurs in several grids is one option
    let mut seen = HashSet::new();
    sections.retain(|section| seen.insert(identity(section)));
    Some(Sections { sections })
}

/// The values that identify a section, by which duplicates are found: shape, sizes, profile.
fn identity((section, profile): &Named) -> (&'static str, [u64; 3], Option<ProfileName>) {
    let (width_m, height_m) = section.outer_m();
    (section.shape(), [width_m, height_m, section.wall_m()].map(f64::to_bits), profile.clone())
}

type Named = (Section, Option<ProfileName>);

fn read_family(node: &Node, catalogs: &Catalogs) -> Option<Vec<Named>> {
    if node.value().get("profiles").is_some() {
        return read_profiles(node, catalogs);
    }
    match node.value().get("shape").and_then(|v| v.as_str()) {
        Some("rectangular_tube") => read_rectangular(node),
        Some("round_tube") => read_round(node),
        Some("rectangular_bar") => read_rectangular_bar(node),
        Some("round_bar") => read_round_bar(node),
        _ => node.fault(
            "has no known \"shape\"",
            "choose rectangular_tube, round_tube, rectangular_bar or round_bar, or give \"profiles\"",
        ),
    }
}

fn read_rectangular(node: &Node) -> Option<Vec<Named>> {
    let object = node.shaped(&RECTANGULAR_TUBES)?;
    let outlines = read_outlines(&object);
    let walls = object.required("wall_mm").and_then(|n| read_grid(&n));
    let (outlines, walls) = (outlines?, walls?);
    refuse_too_many(node, [outlines.len(), walls.len()])?;
    let mut out = Vec::new();
    for (width, height) in outlines {
        for &wall in walls.iter().filter(|&&t| 2.0 * t < width.min(height)) {
            let section =
                Section::RectangularTube { width_m: width / 1e3, height_m: height / 1e3, wall_m: wall / 1e3 };
            out.push((section, None));
        }
    }
    Some(out)
}

fn read_rectangular_bar(node: &Node) -> Option<Vec<Named>> {
    let outlines = read_outlines(&node.shaped(&RECTANGULAR_BARS)?)?;
    let bar = |(w, h)| (Section::RectangularBar { width_m: w / 1e3, height_m: h / 1e3 }, None);
    Some(outlines.into_iter().map(bar).collect())
}

/// Reads `width_mm` and `height_mm` as outer sizes \[mm\]. The result has every pair of a width and a height, or
/// squares if no height is given. Returns `None` after recording a fault.
fn read_outlines(object: &Object) -> Option<Vec<(f64, f64)>> {
    let widths = object.required("width_mm").and_then(|n| read_grid(&n));
    if object.optional("height_mm").is_none_or(|n| n.value().as_str() == Some("=width")) {
        return Some(widths?.into_iter().map(|width| (width, width)).collect());
    }
    let heights = object.required("height_mm").and_then(|n| read_grid(&n));
    let (widths, heights) = (widths?, heights?);
    refuse_too_many(object.node(), [widths.len(), heights.len()])?;
    Some(widths.iter().flat_map(|&w| heights.iter().map(move |&h| (w, h))).collect())
}

fn read_round_bar(node: &Node) -> Option<Vec<Named>> {
    let object = node.shaped(&ROUND_BARS)?;
    let diameters = object.required("diameter_mm").and_then(|n| read_grid(&n))?;
    Some(diameters.into_iter().map(|d| (Section::RoundBar { diameter_m: d / 1e3 }, None)).collect())
}

fn read_round(node: &Node) -> Option<Vec<Named>> {
    let object = node.shaped(&ROUND_TUBES)?;
    let diameters = object.required("diameter_mm").and_then(|n| read_grid(&n));
    let walls = object.required("wall_mm").and_then(|n| read_grid(&n));
    let (diameters, walls) = (diameters?, walls?);
    refuse_too_many(node, [diameters.len(), walls.len()])?;
    let mut out = Vec::new();
    for &diameter in &diameters {
        for &wall in walls.iter().filter(|&&t| 2.0 * t < diameter) {
            out.push((Section::RoundTube { diameter_m: diameter / 1e3, wall_m: wall / 1e3 }, None));
        }
    }
    Some(out)
}

fn read_profiles(node: &Node, catalogs: &Catalogs) -> Option<Vec<Named>> {
    let object = node.shaped(&PROFILES)?.required("profiles")?;
    let object = object.shaped(&PROFILE_FILTER)?;
    let families: BTreeSet<&str> = catalogs.profiles.iter().map(|p| p.material_family.as_str()).collect();
    let family = object.required("family").and_then(|n| match n.string()? {
        family if families.contains(family) => Some(family),
        family => n.fault(
            format!("\"{family}\" has no profiles"),
            &format!("choose one of: {}", families.iter().copied().collect::<Vec<_>>().join(", ")),
        ),
    });
    let shapes = object.or("shapes", None, |n| read_shapes(n).map(Some));
    let largest_mm = object.or("max_outer_mm", f64::INFINITY, Node::positive);
    let (family, shapes, largest_m) = (family?, shapes?, largest_mm? / 1e3);
    let wanted = |p: &&Profile| {
        p.material_family == family
            && shapes.as_ref().is_none_or(|s: &Vec<ProfileShape>| s.contains(&p.shape))
            && p.width_m.max(p.height_m) <= largest_m
    };
    Some(catalogs.profiles.iter().filter(wanted).map(profile_section).collect())
}

fn read_shapes(node: &Node) -> Option<Vec<ProfileShape>> {
    let read: Vec<_> = node
        .array()?
        .iter()
        .map(|n| match n.string()? {
            "square" => Some(ProfileShape::Square),
            "rectangular" => Some(ProfileShape::Rectangular),
            "round" => Some(ProfileShape::Round),
            other => n.fault(format!("\"{other}\" is not known"), "choose among: square, rectangular, round"),
        })
        .collect();
    read.into_iter().collect()
}

fn profile_section(profile: &Profile) -> Named {
    let section = match profile.shape {
        ProfileShape::Round => Section::RoundTube { diameter_m: profile.width_m, wall_m: profile.wall_m },
        _ => Section::RectangularTube {
            width_m: profile.width_m,
            height_m: profile.height_m,
            wall_m: profile.wall_m,
        },
    };
    let name =
        ProfileName { designation: profile.designation.clone(), family: profile.material_family.clone() };
    (section, Some(name))
}

/// Reports a fault if two grids together give more sections than a family may have. Returns `None` after recording a
/// fault.
fn refuse_too_many(node: &Node, [a, b]: [usize; 2]) -> Option<()> {
    match a.saturating_mul(b) {
        0..=MOST_SECTIONS => Some(()),
        sections => node.fault(
            format!("has {sections} sections before walls that do not fit are left out"),
            &format!("the limit is {MOST_SECTIONS}; thin a grid"),
        ),
    }
}

/// Reads a grid: a number, a list of numbers, or `{"from", "to", "step"}`. All numbers must be greater than zero.
/// Returns `None` after recording a fault.
fn read_grid(node: &Node) -> Option<Vec<f64>> {
    if node.value().is_number() {
        return Some(vec![node.positive()?]);
    }
    if node.value().is_array() {
        let read: Vec<_> = node.array()?.iter().map(Node::positive).collect();
        return read.into_iter().collect();
    }
    let object = node.shaped(&GRID)?;
    let [from, to, step] = ["from", "to", "step"].map(|k| object.required(k).and_then(|n| n.positive()));
    let (from, to, step) = (from?, to?, step?);
    let points = ((to - from) / step + 1e-9).floor();
    if points < 0.0 || points > MOST_POINTS as f64 {
        return node.fault(
            format!("from {from} to {to} by {step} is not a grid"),
            "\"from\" is not above \"to\", and there are at most 100000 steps",
        );
    }
    Some((0..=points as usize).map(|i| from + i as f64 * step).collect())
}

/// Whether profiles of the family `family` are sold in `material`: the name of the family occurs in the name of the
/// material.
fn sold_in(family: &str, material: &Material) -> bool {
    let name = material.name.to_lowercase();
    match family {
        "steel" => name.starts_with("structural steel"),
        other => name.contains(&other.to_lowercase()),
    }
}

/// The materials in which profiles of the family `family` are sold, in words.
fn sold_in_words(family: &str) -> &str {
    match family {
        "steel" => "structural steel",
        "stainless" => "stainless steel",
        other => other,
    }
}

/// A remark on the materials that `link` offers and of which it has no section: all its sections are profiles, and none
/// of them is sold in these materials. `None` if every material has a section.
fn without_section(materials: &[&Material], sections: &Sections, link: &str) -> Option<String> {
    // a section that is no catalog profile can be made of any material
    let families: Option<BTreeSet<&str>> =
        sections.sections.iter().map(|(_, profile)| Some(profile.as_ref()?.family.as_str())).collect();
    let families = families.filter(|families| !families.is_empty())?;
    let has_none = |m: &&&Material| !families.iter().any(|family| sold_in(family, m));
    let without: Vec<&str> = materials.iter().filter(has_none).map(|m| m.name.as_str()).collect();
    let have = if without.len() == 1 { "has" } else { "have" };
    let sold: Vec<&str> = families.iter().map(|family| sold_in_words(family)).collect();
    (!without.is_empty()).then(|| {
        format!(
            "Link {link}: {} {have} no section to choose from: the {} profiles of the catalog are sold in {} only.",
            without.join(", "),
            families.iter().copied().collect::<Vec<_>>().join(" and "),
            sold.join(" and ")
        )
    })
}

/// A remark on the links that the material cost leaves out: those whose tube the study gives. `None` if there are none.
pub(super) fn cost_remark(space: &DesignSpace) -> Option<String> {
    let chooses = space.pieces.iter().any(|piece| matches!(piece, SpacePiece::Choice(_)));
    let given_tube = |piece: &SpacePiece| match piece {
        SpacePiece::Link(Link { name, body: LinkBody::Tube { .. }, .. }) => Some(name.clone()),
        _ => None,
    };
    let given: Vec<String> = space.pieces.iter().filter_map(given_tube).collect();
    let none = if chooses { "" } else { ", and no tube is chosen" };
    (!given.is_empty()).then(|| {
        format!(
            "Material cost is that of the tubes that are chosen: the given tube of {} is not in it{none}.",
            given.join(", ")
        )
    })
}

/// Each material combined with each section. Materials that lack a rating that a constraint needs are left out, and a
/// message on each is added to `aside`.
pub(super) fn options(
    materials: &[&Material],
    sections: &Sections,
    constraints: &Constraints,
    link: &str,
    aside: &mut Aside,
) -> Vec<LinkOption> {
    aside.remarks.extend(without_section(materials, sections, link));
    let mut out = Vec::new();
    for material in materials {
        let Some(elastic) = material_of(material) else { continue };
        if let Some(missing) = missing_rating(material, constraints) {
            aside.not_checked.push(format!("link {link}: {} has no {missing} in the catalog", material.name));
            continue;
        }
        for (section, profile) in &sections.sections {
            if profile.as_ref().is_some_and(|p| !sold_in(&p.family, material)) {
                continue;
            }
            out.push(LinkOption {
                material_index: 0,
                material_name: material.name.clone(),
                material: elastic,
                section: *section,
                profile: profile.as_ref().map(|p| p.designation.clone()),
                cost_eur_per_kg: material.cost_eur_per_kg,
            });
        }
    }
    out
}

fn missing_rating(material: &Material, constraints: &Constraints) -> Option<&'static str> {
    if constraints.stress_safety_factor_min.is_some() {
        if material.strength_pa.is_none() {
            return Some("strength");
        }
        if lacks_shear_strength(material) {
            return Some("shear strength (shear_strength_pa)");
        }
    }
    if constraints.material_cost_max_eur.is_some() && material.cost_eur_per_kg.is_none() {
        return Some("cost");
    }
    None
}

#[cfg(test)]
mod tests {
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::study::read::read_study;
    use serde_json::{Value, json};

    #[test]
    fn the_material_cost_says_which_given_tubes_it_leaves_out() {
        let section = json!({"shape": "round_tube", "diameter_m": 0.1, "wall_m": 0.004});
        let given = json!({"type": "link", "name": "column", "vector_m": [0, 0, 0.3], "material": "Aluminium 6061-T6",
            "section": section});
        let tubes = json!([{"shape": "round_tube", "diameter_mm": 80, "wall_mm": 3}]);
        let open = json!({"type": "link", "name": "boom", "vector_m": [0.5, 0, 0],
            "choose": {"materials": ["Aluminium 6061-T6"], "sections": tubes}});
        let offset = json!({"type": "link", "name": "flange", "vector_m": [0.1, 0, 0]});
        let remarks = |links: &[&Value]| {
            let joint = json!({"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4});
            let chain: Vec<&Value> = std::iter::once(&joint).chain(links.iter().copied()).collect();
            let study = json!({"name": "s", "chain": chain, "poses": [{"pose_deg": [0]}]});
            let document = Document::parse("s.json", &study.to_string()).unwrap();
            read_study(document, &Catalogs::builtin()).unwrap().remarks.join(" ")
        };
        let said = remarks(&[&given, &open, &offset]);
        assert!(said.contains("the given tube of column is not in it"), "{said}");
        assert!(!remarks(&[&open, &offset]).contains("Material cost"), "an offset costs nothing");
        let said = remarks(&[&given]);
        assert!(said.contains("the given tube of column is not in it, and no tube is chosen"), "{said}");
    }
}
