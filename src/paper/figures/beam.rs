//! The cantilever of the figures: one cross-section of one material, and its deflection.

use crate::arm::load::Payload;
use crate::arm::section::{LinkMaterial, Section};
use crate::arm::{Arm, Element, JointModel, Link, LinkBody, LinkModel};
use crate::catalog::material::Material;
use crate::mechanics::chain::Chain;
use crate::paper::arm::GRAVITY_M_S2;
use crate::paper::equations::deflection_eq_4_m;
use crate::report::number::shortest;
use crate::report::table::{Column, Table};
use nalgebra::Vector3;

/// Length of the cantilever \[m\].
pub const LENGTH_M: f64 = 0.8;
/// Force at the end of the cantilever \[N\].
pub const FORCE_N: f64 = 500.0;
/// Wall thickness in figures in which it does not vary \[m\].
pub const WALL_M: f64 = 0.010;
/// Smallest and largest outer size, in steps of 1 cm \[m\].
pub const SIZES_M: (f64, f64) = (0.07, 0.16);

/// One cross-section of one material, with weight and deflection of the cantilever.
#[derive(Debug, Clone, PartialEq)]
pub struct BeamPoint {
    /// Name of the material.
    pub material: String,
    /// Outer width and height \[m\].
    pub size_m: f64,
    /// Wall thickness \[m\].
    pub wall_m: f64,
    /// Weight per length \[N/m\] (Eq 6).
    pub weight_n_per_m: f64,
    /// Deflection of the end by bending (Eq 4) \[m\].
    pub deflection_m: f64,
    /// Deflection of the end with bending and shear \[m\]; `None` if the shear modulus is unknown.
    pub full_deflection_m: Option<f64>,
}

impl BeamPoint {
    /// A cantilever with a square tube of a material.
    pub fn new(material: &Material, size_m: f64, wall_m: f64) -> Self {
        let section = Section::RectangularTube { width_m: size_m, height_m: size_m, wall_m };
        let properties = section.properties(material.poisson.unwrap_or(0.3));
        let weight_n_per_m = properties.area_m2 * material.density_kg_m3 * GRAVITY_M_S2;
        let rigidity = material.youngs_modulus_pa * properties.second_moment_y_m4;
        Self {
            material: material.name.clone(),
            size_m,
            wall_m,
            weight_n_per_m,
            deflection_m: deflection_eq_4_m(rigidity, LENGTH_M, FORCE_N, weight_n_per_m, 0.0),
            full_deflection_m: library_deflection_m(material, section, LinkModel::Full),
        }
    }

    /// Force divided by deflection at the end of the cantilever \[N/m\].
    pub fn stiffness_n_per_m(&self) -> f64 {
        FORCE_N / self.deflection_m
    }

    /// Stiffness divided by weight per length \[-\].
    pub fn stiffness_per_weight(&self) -> f64 {
        self.stiffness_n_per_m() / self.weight_n_per_m
    }

    /// Coordinates in the figures: weight per length \[N/m\], deflection \[mm\].
    pub fn in_figure(&self) -> (f64, f64) {
        (self.weight_n_per_m, 1e3 * self.deflection_m)
    }
}

/// Deflection of the end of the cantilever by the general mechanics \[m\]; `None` without a shear modulus.
pub fn library_deflection_m(material: &Material, section: Section, links: LinkModel) -> Option<f64> {
    let link = LinkMaterial {
        youngs_modulus_pa: material.youngs_modulus_pa,
        shear_modulus_pa: material.shear_modulus_pa?,
        density_kg_m3: material.density_kg_m3,
        poisson: material.poisson.unwrap_or(0.3),
        strength: None,
        class: Some(material.class),
    };
    let body = LinkBody::Tube { material_name: material.name.clone(), material: link, section };
    let beam = Element::Link(Link {
        name: "beam".into(),
        vector_m: Vector3::x() * LENGTH_M,
        body,
        bodies: Vec::new(),
    });
    let arm = Arm {
        name: "cantilever".into(),
        gravity_m_s2: GRAVITY_M_S2,
        down: -Vector3::z(),
        chain: vec![beam],
        effects: Vec::new(),
        springs: Vec::new(),
    };
    let chain = Chain::new(&arm.structure(JointModel::K2), links);
    let posed = chain.pose_rad(&[], &Payload::default(), -Vector3::z() * FORCE_N);
    Some(-posed.statics().tip_displacement_m.z)
}

/// The sections of a figure: square tubes of 7 to 16 cm with the same wall thickness.
pub(crate) fn sizes(material: &Material) -> Vec<BeamPoint> {
    (7..=16).map(|cm| BeamPoint::new(material, f64::from(cm) / 100.0, WALL_M)).collect()
}

/// The points of several materials as CSV.
pub(crate) fn points_csv(points: &[BeamPoint]) -> String {
    let names = [
        "material",
        "outer_mm",
        "wall_mm",
        "weight_n_per_m",
        "deflection_mm",
        "deflection_with_shear_mm",
        "stiffness_n_per_m",
        "stiffness_per_weight",
    ];
    let mut table = Table::new(names.map(Column::left).to_vec());
    for point in points {
        table.row([
            point.material.clone(),
            shortest(millimetres(point.size_m)),
            shortest(millimetres(point.wall_m)),
            shortest(point.weight_n_per_m),
            shortest(1e3 * point.deflection_m),
            point.full_deflection_m.map_or_else(String::new, |d| shortest(1e3 * d)),
            shortest(point.stiffness_n_per_m()),
            shortest(point.stiffness_per_weight()),
        ]);
    }
    table.to_csv()
}

/// A length in millimetres. It is rounded to the nanometre, to remove rounding errors of the conversion.
fn millimetres(metres: f64) -> f64 {
    (metres * 1e9).round() / 1e6
}
