//! Input decks for CalculiX: a static step with secant stiffnesses, and a frequency step with tangent stiffnesses.

use super::model::{Model, Solid};
use crate::arm::structure::Beam;
use nalgebra::Vector3;
use std::fmt::Write;

/// Stiffness of the springs that connect point masses to the ground \[N/m\]. CalculiX drops the coupling inertia
/// between degrees of freedom that no stiffness connects. These springs connect the degrees of freedom, and are too
/// soft to change anything else.
const GROUNDING_N_PER_M: f64 = 1e-3;
/// Range of Poisson's ratio E / (2 G) - 1 within which E and G can belong to an isotropic material.
const ISOTROPIC: std::ops::Range<f64> = -0.9..0.49;
/// Number of equations that a model must have for each frequency that CalculiX computes. With fewer, its eigenvalue
/// solver (ARPACK) fails. The number was found by trials with `ccx` 2.20.
const EQUATIONS_PER_MODE: usize = 5;
/// Stiffness of the spring of a node that only adds an equation to the model (see `fillers`) \[N/m\]. With its mass of
/// 1 kg the node vibrates at 160 kHz, far above the frequencies of an arm.
const FILLER_N_PER_M: f64 = 1e12;

/// The analysis that a deck describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// A static analysis for deflections, with secant stiffnesses.
    Static,
    /// A modal analysis for natural frequencies, with tangent stiffnesses.
    Frequency,
}

/// The text of the input deck for the analysis `step` of a model.
pub(crate) fn deck(model: &Model, step: Step, heading: &str, gravity_m_s2: &Vector3<f64>) -> String {
    let mut out = format!("*HEADING\n{}\n", heading.replace('\n', " "));
    let mut element = 0;
    nodes(&mut out, model);
    for (k, solid) in model.solids.iter().enumerate() {
        bricks(&mut out, solid, k, &mut element);
    }
    masses(&mut out, model, &mut element);
    springs(&mut out, model, step, &mut element);
    constraints(&mut out, model);
    match step {
        Step::Static => static_step(&mut out, model, gravity_m_s2),
        Step::Frequency => {
            fillers(&mut out, model, &mut element);
            let _ = writeln!(out, "*STEP\n*FREQUENCY\n{}\n*END STEP", model.modes);
        }
    }
    out
}

fn nodes(out: &mut String, model: &Model) {
    out.push_str("*NODE, NSET=ALL\n");
    for (i, place) in model.nodes_m.iter().enumerate() {
        let _ = writeln!(out, "{}, {:.12e}, {:.12e}, {:.12e}", i + 1, place.x, place.y, place.z);
    }
    let _ = writeln!(out, "*NSET, NSET=TIP\n{}", model.tip + 1);
}

fn bricks(out: &mut String, solid: &Solid, k: usize, element: &mut usize) {
    let _ = writeln!(out, "** link {}\n*ELEMENT, TYPE=C3D20R, ELSET=LINK{k}", solid.name.replace('\n', " "));
    for brick in &solid.bricks {
        *element += 1;
        let numbers: Vec<String> = brick.iter().map(|n| (n + 1).to_string()).collect();
        let _ = writeln!(out, "{element}, {},\n{}", numbers[..10].join(", "), numbers[10..].join(", "));
    }
    let (constants, oriented) = elastic(&solid.beam);
    let _ = writeln!(out, "*MATERIAL, NAME=M{k}\n{constants}\n*DENSITY\n{:.12e}", solid.density_kg_m3);
    let orientation = if oriented {
        let (a, b) = (solid.frame.column(0), solid.frame.column(1));
        let _ = writeln!(
            out,
            "*ORIENTATION, NAME=O{k}, SYSTEM=RECTANGULAR\n{:.12e}, {:.12e}, {:.12e}, {:.12e}, {:.12e}, {:.12e}",
            a.x, a.y, a.z, b.x, b.y, b.z
        );
        format!(", ORIENTATION=O{k}")
    } else {
        String::new()
    };
    let _ = writeln!(out, "*SOLID SECTION, ELSET=LINK{k}, MATERIAL=M{k}{orientation}");
}

/// The elastic constants of a link as lines of the deck, and whether they are orthotropic. If no isotropic material has
/// the E and G of the link, they belong to a layup. They are then written as engineering constants in the axes of the
/// section.
fn elastic(beam: &Beam) -> (String, bool) {
    let (e_pa, g_pa) = (
        beam.material.youngs_modulus_pa / beam.flexibility,
        beam.material.shear_modulus_pa / beam.flexibility,
    );
    let poisson = e_pa / (2.0 * g_pa) - 1.0;
    if ISOTROPIC.contains(&poisson) {
        return (format!("*ELASTIC\n{e_pa:.12e}, {poisson:.12e}"), false);
    }
    let nu = beam.material.poisson;
    let text = format!(
        "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n{e_pa:.12e}, {e_pa:.12e}, {e_pa:.12e}, {nu:.12e}, {nu:.12e}, {nu:.12e}, {g_pa:.12e}, {g_pa:.12e}\n{g_pa:.12e}"
    );
    (text, true)
}

fn masses(out: &mut String, model: &Model, element: &mut usize) {
    for (node, kg) in &model.masses {
        *element += 1;
        let _ = writeln!(
            out,
            "*ELEMENT, TYPE=MASS, ELSET=MASS{element}\n{element}, {}\n*MASS, ELSET=MASS{element}\n{kg:.12e}",
            node + 1
        );
    }
    for (node, _) in &model.masses {
        for d in 1..=3 {
            spring(out, element, *node, d, GROUNDING_N_PER_M);
        }
    }
}

fn springs(out: &mut String, model: &Model, step: Step, element: &mut usize) {
    for hinge in &model.hinges {
        let stiffness = match step {
            Step::Static => hinge.working.secant_nm_per_rad(),
            Step::Frequency => hinge.working.tangent_nm_per_rad(),
        };
        let _ = writeln!(out, "** hinge {}: displacement 1 is its angle", hinge.name.replace('\n', " "));
        spring(out, element, hinge.node, 1, stiffness);
    }
}

/// Writes a spring of the given stiffness \[N/m, or N m/rad at a hinge\] between a degree of freedom of a node and the
/// ground. `element` is the number of the last element of the deck. It is raised by one.
fn spring(out: &mut String, element: &mut usize, node: usize, direction: usize, stiffness: f64) {
    *element += 1;
    let _ = writeln!(
        out,
        "*ELEMENT, TYPE=SPRING1, ELSET=SPRING{element}\n{element}, {}\n*SPRING, ELSET=SPRING{element}\n{direction}\n{stiffness:.12e}",
        node + 1
    );
}

fn constraints(out: &mut String, model: &Model) {
    for terms in &model.equations {
        let _ = writeln!(out, "*EQUATION\n{}", terms.len());
        for line in terms.chunks(4) {
            let line: Vec<String> =
                line.iter().map(|(n, d, c)| format!("{}, {}, {c:.12e}", n + 1, d + 1)).collect();
            let _ = writeln!(out, "{}", line.join(", "));
        }
    }
    if !model.held.is_empty() {
        out.push_str("*BOUNDARY\n");
    }
    for (node, d) in &model.held {
        let _ = writeln!(out, "{}, {}, {}", node + 1, d + 1, d + 1);
    }
}

/// Writes nodes that are not part of the arm, as many as the model lacks equations for the eigenvalue solver (see
/// `EQUATIONS_PER_MODE`). Only a model without solids can lack equations, because it has a single equation for each
/// hinge. `element` is the number of the last element of the deck.
fn fillers(out: &mut String, model: &Model, element: &mut usize) {
    let missing = match model.solids.is_empty() {
        false => 0,
        true => (EQUATIONS_PER_MODE * model.modes).saturating_sub(model.hinges.len()),
    };
    if missing > 0 {
        let _ = writeln!(
            out,
            "** not of the arm: {missing} nodes at 160 kHz, because the solver needs {EQUATIONS_PER_MODE} equations per frequency"
        );
    }
    for node in (model.nodes_m.len()..).take(missing) {
        *element += 1;
        let _ = writeln!(
            out,
            "*NODE, NSET=ALL\n{}, 0, 0, 0\n*ELEMENT, TYPE=MASS, ELSET=MASS{element}\n{element}, {}\n*MASS, ELSET=MASS{element}\n1",
            node + 1,
            node + 1
        );
        spring(out, element, node, 1, FILLER_N_PER_M);
        let _ = writeln!(out, "*BOUNDARY\n{}, 2, 3", node + 1);
    }
}

fn static_step(out: &mut String, model: &Model, gravity_m_s2: &Vector3<f64>) {
    out.push_str("*STEP\n*STATIC\n");
    let size = gravity_m_s2.norm();
    if !model.solids.is_empty() && size > 0.0 {
        let down = gravity_m_s2 / size;
        out.push_str("*DLOAD\n");
        for k in 0..model.solids.len() {
            let _ = writeln!(
                out,
                "LINK{k}, GRAV, {size:.12e}, {:.12e}, {:.12e}, {:.12e}",
                down.x, down.y, down.z
            );
        }
    }
    if !model.loads.is_empty() {
        out.push_str("*CLOAD\n");
    }
    for (node, d, load) in &model.loads {
        let _ = writeln!(out, "{}, {}, {load:.12e}", node + 1, d + 1);
    }
    out.push_str("*NODE PRINT, NSET=TIP\nU\n*END STEP\n");
}
