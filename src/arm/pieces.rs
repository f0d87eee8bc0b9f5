//! Links that consist of several pieces: stepped or tapered links, and factors for holes and inserts.
//!
//! A link with `pieces` becomes as many links, one after the other. A taper is divided into [`SLICES_OF_TAPER`] links
//! of equal length, each with the section at its middle. For a taper whose height halves towards the end, the
//! deflection under an end load is then 0.3 % too large. This error falls with the square of the number of slices.

use super::body::{RigidBody, read_link_bodies};
use super::element_keys::read_name;
use super::keys::PIECE;
use super::link_file::{NamedMaterial, read_link, read_tube};
use super::load::vector;
use super::section::{LinkMaterial, Section};
use super::{Link, LinkBody};
use crate::catalog::Catalogs;
use crate::input::json::{Node, Object};
use nalgebra::Vector3;

/// Number of links into which a taper is divided.
const SLICES_OF_TAPER: usize = 12;

/// Number of elements of the arm that one item of the chain in the file becomes. A link with pieces becomes
/// several elements.
pub(crate) fn elements_of(item: &Node) -> usize {
    match item.value().get("pieces").and_then(|pieces| pieces.as_array()) {
        Some(pieces) => pieces.iter().map(|piece| slices(piece.get("end_section").is_some())).sum(),
        None => 1,
    }
}

fn slices(tapers: bool) -> usize {
    if tapers { SLICES_OF_TAPER } else { 1 }
}

/// Factors on the moduli and on the density of a tube, for holes and inserts.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Factors {
    stiffness: f64,
    mass: f64,
}

impl Factors {
    fn read(object: &Object) -> Option<Self> {
        let factor = |key| object.or(key, 1.0, Node::positive);
        let (stiffness, mass) = (factor("stiffness_factor"), factor("mass_factor"));
        Some(Self { stiffness: stiffness?, mass: mass? })
    }

    fn is_none(self) -> bool {
        self == Self { stiffness: 1.0, mass: 1.0 }
    }

    /// The tube with its moduli and its density multiplied by the factors. The factors are appended to the name of its
    /// material, so that they show wherever the material is printed.
    fn apply(self, body: LinkBody) -> LinkBody {
        match body {
            LinkBody::Tube { material_name, material, section } if !self.is_none() => LinkBody::Tube {
                material_name: format!("{material_name}{MARK}{}, mass x {})", self.stiffness, self.mass),
                material: LinkMaterial {
                    density_kg_m3: material.density_kg_m3 * self.mass,
                    // The stress at the edge of a hole or an insert is not known.
                    strength: None,
                    ..material.stiffened(self.stiffness)
                },
                section,
            },
            other => other,
        }
    }
}

/// Text between the name of a material and the factors on its moduli and its density.
const MARK: &str = " (stiffness x ";

/// The name of the material without the factors that were appended to it.
pub(crate) fn without_factors(material_name: &str) -> &str {
    material_name.split(MARK).next().unwrap_or(material_name)
}

/// A sentence for reports that names the links whose moduli and density have stated factors; `None` if there are none.
/// Each item of `tubes` is the name of the material and the name of the link.
pub(crate) fn factors_sentence<'a>(tubes: impl Iterator<Item = (&'a str, &'a str)>) -> Option<String> {
    let stated: Vec<&str> =
        tubes.filter(|(material, _)| material.contains(MARK)).map(|(_, link)| link).collect();
    (!stated.is_empty()).then(|| {
        format!(
            "Stiffness and mass of {} have stated factors, for holes or inserts. No model checks them, and stress at a hole is \
             higher than computed.",
            stated.join(", ")
        )
    })
}

/// Reads a link of the file. The result is one link, or one link for each slice of its pieces. Returns `None` after
/// recording a fault.
pub(crate) fn read_links(
    object: &Object,
    materials: &[NamedMaterial],
    catalogs: &Catalogs,
) -> Option<Vec<Link>> {
    if let Some(pieces) = object.optional("pieces") {
        return read_pieces(object, &pieces, materials, catalogs);
    }
    let (link, factors) = (read_link(object, materials, catalogs), Factors::read(object));
    let (link, factors) = (link?, factors?);
    let has_factor = object.has("stiffness_factor") || object.has("mass_factor");
    if has_factor && matches!(link.body, LinkBody::Offset { .. }) {
        return object.node().fault(
            "has a factor and no section",
            "stiffness_factor and mass_factor belong to a tube; state the mass of an offset as mass_kg",
        );
    }
    Some(vec![Link { body: factors.apply(link.body), ..link }])
}

/// One piece of a link: length \[m\], tube with the section at the start, and the section at the end if the piece
/// tapers.
struct LinkPart {
    length_m: f64,
    body: LinkBody,
    end_section: Option<Section>,
}

fn read_pieces(
    object: &Object,
    pieces: &Node,
    materials: &[NamedMaterial],
    catalogs: &Catalogs,
) -> Option<Vec<Link>> {
    for key in ["section", "mass_kg", "stiffness_factor", "mass_factor"] {
        if let Some(stray) = object.optional(key) {
            stray.fault::<()>("stands beside \"pieces\"", "write it into the pieces");
        }
    }
    let name = read_name(object);
    let vector_m = object.required("vector_m").and_then(|n| vector(&n));
    let bodies = read_link_bodies(object);
    let read: Vec<_> =
        pieces.array()?.iter().map(|piece| read_part(piece, object, materials, catalogs)).collect();
    let parts = read.into_iter().collect::<Option<Vec<_>>>()?;
    let (name, vector_m, bodies) = (name?, vector_m?, bodies?);
    let sum_m: f64 = parts.iter().map(|part| part.length_m).sum();
    if (sum_m - vector_m.norm()).abs() > 1e-6 {
        return pieces.fault(
            format!("are {sum_m} m long together, and vector_m is {} m", vector_m.norm()),
            "the pieces fill the link from root to end",
        );
    }
    let links = parts.iter().flat_map(LinkPart::slices).collect();
    Some(one_behind_the_other(&name, &vector_m.normalize(), links, &bodies))
}

fn read_part(
    node: &Node,
    link: &Object,
    materials: &[NamedMaterial],
    catalogs: &Catalogs,
) -> Option<LinkPart> {
    let object = node.shaped(&PIECE)?;
    let length = object.required("length_m").and_then(|n| n.positive());
    let factors = Factors::read(&object);
    // the material of the link is used for all pieces that do not state their own
    let of_material = if object.has("material") { &object } else { link };
    let tube = |section: &Node| read_tube(&object, of_material, section, None, materials, catalogs);
    let body = object.required("section").and_then(|n| tube(&n));
    let end = match object.optional("end_section") {
        Some(section) => tube(&section).map(Some),
        None => Some(None),
    };
    let (length_m, factors, body, end) = (length?, factors?, body?, end?);
    let end_section = match (&body, end) {
        (LinkBody::Tube { section, .. }, Some(LinkBody::Tube { section: end, .. })) => {
            if between(section, &end, 0.5).is_none() {
                return object.node().fault(
                    format!("tapers from {} to {}", section.shape(), end.shape()),
                    "a taper has one shape, a tube or a bar, at both ends",
                );
            }
            Some(end)
        }
        _ => None,
    };
    Some(LinkPart { length_m, body: factors.apply(body), end_section })
}

impl LinkPart {
    /// Length \[m\] and tube of each slice into which this piece of a link is divided, from its root to its end.
    fn slices(&self) -> Vec<(f64, LinkBody)> {
        let count = slices(self.end_section.is_some());
        let middle = |slice: usize| (slice as f64 + 0.5) / count as f64;
        let tube = |slice: usize| match (&self.body, &self.end_section) {
            (LinkBody::Tube { material_name, material, section }, Some(end)) => LinkBody::Tube {
                material_name: material_name.clone(),
                material: *material,
                section: between(section, end, middle(slice)).unwrap_or(*section),
            },
            (body, _) => body.clone(),
        };
        (0..count).map(|slice| (self.length_m / count as f64, tube(slice))).collect()
    }
}

/// The section at the fraction `part` of the way (0 to 1) from the section `from` to the section `to`. `None` if their
/// shapes differ, or if sections of this shape cannot taper.
fn between(from: &Section, to: &Section, part: f64) -> Option<Section> {
    let mix = |a: f64, b: f64| a + (b - a) * part;
    match (*from, *to) {
        (
            Section::RectangularTube { width_m: w0, height_m: h0, wall_m: t0 },
            Section::RectangularTube { width_m: w1, height_m: h1, wall_m: t1 },
        ) => Some(Section::RectangularTube {
            width_m: mix(w0, w1),
            height_m: mix(h0, h1),
            wall_m: mix(t0, t1),
        }),
        (
            Section::RoundTube { diameter_m: d0, wall_m: t0 },
            Section::RoundTube { diameter_m: d1, wall_m: t1 },
        ) => Some(Section::RoundTube { diameter_m: mix(d0, d1), wall_m: mix(t0, t1) }),
        (
            Section::RectangularBar { width_m: w0, height_m: h0 },
            Section::RectangularBar { width_m: w1, height_m: h1 },
        ) => Some(Section::RectangularBar { width_m: mix(w0, w1), height_m: mix(h0, h1) }),
        (Section::RoundBar { diameter_m: d0 }, Section::RoundBar { diameter_m: d1 }) => {
            Some(Section::RoundBar { diameter_m: mix(d0, d1) })
        }
        _ => None,
    }
}

/// The links that the slices of a link become, one after the other. `along` is the direction of the link, and each
/// slice has a length \[m\] and a tube. Each body goes to the slice that is nearest to its centre of gravity.
fn one_behind_the_other(
    name: &str,
    along: &Vector3<f64>,
    slices: Vec<(f64, LinkBody)>,
    bodies: &[RigidBody],
) -> Vec<Link> {
    let starts_m: Vec<f64> = slices
        .iter()
        .scan(0.0, |start_m, (length_m, _)| {
            let at_m = *start_m;
            *start_m += length_m;
            Some(at_m)
        })
        .collect();
    let mut links: Vec<Link> = slices
        .into_iter()
        .enumerate()
        .map(|(i, (length_m, body))| Link {
            name: format!("{name}.{}", i + 1),
            vector_m: along * length_m,
            body,
            bodies: Vec::new(),
        })
        .collect();
    for body in bodies {
        let at_m = body.cg_m.dot(along);
        let slice = starts_m.iter().rposition(|start_m| *start_m <= at_m).unwrap_or(0);
        let cg_m = body.cg_m - along * starts_m[slice];
        links[slice].bodies.push(RigidBody { cg_m, ..*body });
    }
    links
}
