//! Rows of `materials.csv`, and the checks within one row.

use super::row::Row;
use crate::catalog::material::{Material, MaterialClass, isotropic_shear_modulus_pa};

/// The material that a row describes; `None` if its name, class, source or a required number is blank or not valid.
pub(crate) fn material(row: &Row) -> Option<Material> {
    check(row);
    Some(Material {
        name: row.filled("name")?.to_string(),
        class: MaterialClass::from_word(row.text("class"))?,
        youngs_modulus_pa: row.number("e_pa")?,
        shear_modulus_pa: row.number("g_pa"),
        density_kg_m3: row.number("density_kg_m3")?,
        poisson: row.number("poisson"),
        strength_pa: row.number("yield_or_strength_pa"),
        compressive_strength_pa: row.number("compressive_strength_pa"),
        shear_strength_pa: row.number("shear_strength_pa"),
        strength_kind: row.text("strength_kind").to_string(),
        cost_eur_per_kg: row.number("cost_eur_per_kg"),
        corrosion_note: row.text("corrosion_note").to_string(),
        unidirectional: unidirectional(row),
        provenance: row.provenance()?,
    })
}

/// Whether all fibres run along the link. The column says so; without it, the word `UD` in the name does.
fn unidirectional(row: &Row) -> bool {
    match row.filled("unidirectional") {
        Some(word) => word.eq_ignore_ascii_case("yes"),
        None => row.text("name").split(|c: char| !c.is_alphanumeric()).any(|word| word == "UD"),
    }
}

fn check(row: &Row) {
    let class = MaterialClass::from_word(row.text("class"));
    // ranges for metals and fibre composites are narrower than ranges for other classes
    let (moduli_pa, shear_moduli_pa, densities, expansions) = match class.and_then(MaterialClass::caution) {
        None => ([1e10, 1e12], [1e9, 2e11], [1000.0, 9000.0], [-6e-6, 3e-5]),
        Some(caution) => {
            row.warn(
                "class",
                format!("{}: {caution}", row.text("class")),
                "the moduli are taken as they stand",
            );
            ([1e8, 3e10], [1e7, 1e10], [100.0, 3000.0], [-6e-6, 3e-4])
        }
    };
    let ranges = [
        ("e_pa", [1e8, 2e12], moduli_pa, "write Pa (1 GPa = 1e9 Pa)"),
        ("g_pa", [1e7, 1e12], shear_moduli_pa, "write Pa (1 GPa = 1e9 Pa)"),
        ("density_kg_m3", [100.0, 25_000.0], densities, "write kg/m3 (1 g/cm3 = 1000 kg/m3)"),
        ("yield_or_strength_pa", [1e5, 2e10], [1e7, 6e9], "write Pa (1 MPa = 1e6 Pa)"),
        ("compressive_strength_pa", [1e5, 2e10], [1e7, 6e9], "write Pa (1 MPa = 1e6 Pa)"),
        ("shear_strength_pa", [1e5, 1e10], [3e6, 2e9], "write Pa (1 MPa = 1e6 Pa)"),
        ("cte_1_per_k", [-1e-4, 1e-3], expansions, "write 1/K (1 um/(m K) = 1e-6)"),
    ];
    let mut moduli_are_possible = true;
    for (column, possible, usual, hint) in ranges {
        let known = row.number(column);
        let is_possible = known.is_none_or(|x| row.within(column, x, possible, usual, hint));
        moduli_are_possible &= is_possible || !matches!(column, "e_pa" | "g_pa");
    }
    if poisson(row) && moduli_are_possible {
        shear_modulus(row);
    }
}

/// Checks Poisson's ratio: 0 < nu < 1/2 for an isotropic material, a wider range for a laminate. Returns whether nu
/// is possible.
fn poisson(row: &Row) -> bool {
    let (Some(class), Some(nu)) = (MaterialClass::from_word(row.text("class")), row.number("poisson")) else {
        return true;
    };
    if matches!(class, MaterialClass::Composite | MaterialClass::Wood | MaterialClass::Other) {
        return row.within("poisson", nu, [-1.0, 1.0], [0.0, 0.5], "a laminate may leave 0 to 0.5");
    }
    let is_possible = nu > 0.0 && nu < 0.5;
    if !is_possible {
        row.fault("poisson", format!("= {nu} is outside 0 to 0.5"), "a metal's lies near 0.3");
    }
    is_possible
}

/// Checks G = E/2(1+nu) for isotropic materials. A deviation is a fault for metals and a warning for others.
fn shear_modulus(row: &Row) {
    let class = MaterialClass::from_word(row.text("class"));
    let figures = (class, row.number("e_pa"), row.number("g_pa"), row.number("poisson"));
    if let (Some(class), Some(e_pa), Some(g_pa), Some(nu)) = figures
        && !unidirectional(row)
        && class != MaterialClass::Wood
    {
        let refuse = match class {
            MaterialClass::Metal => 0.06,
            MaterialClass::MetalMatrix => 0.25,
            // wood and printed polymers are orthotropic like a laminate, so their G does not follow from E and nu
            _ => f64::INFINITY,
        };
        row.agrees("g_pa", g_pa, isotropic_shear_modulus_pa(e_pa, nu), "G = E/2(1+nu)", 0.06, refuse);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::CatalogFile;
    use crate::catalog::read::log::Log;
    use crate::catalog::read::table::rows;

    #[test]
    fn the_compressive_strength_is_read_and_a_slip_of_unit_refused() {
        let log = Log::default();
        let text = "name,class,e_pa,density_kg_m3,yield_or_strength_pa,compressive_strength_pa,source,confidence\n\
            A,composite,8e10,1380,1.4e9,3.35e8,a test,verified\n\
            B,composite,8e10,1380,1.4e9,,a test,verified\n\
            C,composite,8e10,1380,1.4e9,335,a test,verified\n";
        let read = rows(CatalogFile::Materials, "materials.csv", text.as_bytes(), &log);
        let strengths: Vec<_> = read.iter().filter_map(material).map(|m| m.compressive_strength_pa).collect();
        assert_eq!(strengths[..2], [Some(3.35e8), None]);
        let faults: Vec<_> = log.faults.borrow().iter().map(|fault| fault.field.clone()).collect();
        assert_eq!(faults, ["compressive_strength_pa"]);
    }
}
