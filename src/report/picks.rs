//! The designs of a front that a reader looks for first: lightest, stiffest, highest mode, knee.

use super::caveats::Caveats;
use super::front_table::FrontTable;
use super::number::significant;
use super::tube::tube_size;
use std::cmp::Ordering;

/// One design of a front, with its objectives.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Design {
    /// Name of the design in its result.
    pub design_id: String,
    /// Tip deflection of the design \[mm\].
    pub tip_deflection_mm: f64,
    /// Mass of the design \[kg\].
    pub mass_kg: f64,
    /// Lowest mode of the design \[Hz\].
    pub lowest_mode_hz: f64,
    /// Cost of the links' material \[EUR\]; `None` if it is unknown.
    pub material_cost_eur: Option<f64>,
    /// Index of the design's row in its table, counted from 0.
    #[serde(skip)]
    pub row: usize,
}

/// One of the three objectives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// Tip deflection \[mm\]; smaller is better.
    Deflection,
    /// Mass \[kg\]; smaller is better.
    Mass,
    /// Lowest mode \[Hz\]; larger is better.
    Mode,
}

impl Objective {
    /// All three objectives.
    pub const ALL: [Self; 3] = [Self::Deflection, Self::Mass, Self::Mode];

    /// The value of this objective for a design.
    pub fn of(self, design: &Design) -> f64 {
        match self {
            Self::Deflection => design.tip_deflection_mm,
            Self::Mass => design.mass_kg,
            Self::Mode => design.lowest_mode_hz,
        }
    }

    /// The value of this objective for a design, negated for the lowest mode, so that smaller is always better.
    pub fn minimized(self, design: &Design) -> f64 {
        if self == Self::Mode { -self.of(design) } else { self.of(design) }
    }

    /// Unit of the objective.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Deflection => "mm",
            Self::Mass => "kg",
            Self::Mode => "Hz",
        }
    }

    /// A value with four significant digits and its unit.
    pub fn amount(self, value: f64) -> String {
        format!("{} {}", significant(value, 4), self.unit())
    }
}

/// The designs of a table. Rows whose objectives are not finite numbers are left out.
pub fn designs(front: &FrontTable) -> Vec<Design> {
    let [deflection, mass, mode] =
        ["tip_deflection_mm", "mass_kg", "lowest_mode_hz"].map(|c| front.numbers(c));
    let cost = front.numbers("material_cost_eur");
    let id = front.column("design_id");
    let finite = |values: &[Option<f64>], row: usize| values[row].filter(|v| v.is_finite());
    (0..front.rows.len())
        .filter_map(|row| {
            Some(Design {
                design_id: id.map_or_else(|| row.to_string(), |c| front.rows[row][c].clone()),
                tip_deflection_mm: finite(&deflection, row)?,
                mass_kg: finite(&mass, row)?,
                lowest_mode_hz: finite(&mode, row)?,
                material_cost_eur: finite(&cost, row),
                row,
            })
        })
        .collect()
}

/// The best design in one objective. Designs with equal values are ranked by the other objectives, then by cost
/// (unknown last), then by name. So the result does not depend on the order of the rows. `None` if there is no design.
pub fn best<'a>(objective: Objective, among: impl IntoIterator<Item = &'a Design>) -> Option<&'a Design> {
    among.into_iter().min_by(|a, b| better(objective, a, b))
}

fn better(objective: Objective, a: &Design, b: &Design) -> Ordering {
    let by = |o: Objective| o.minimized(a).total_cmp(&o.minimized(b));
    let cost = |d: &Design| d.material_cost_eur.unwrap_or(f64::INFINITY);
    let others = Objective::ALL.into_iter().map(by).fold(Ordering::Equal, Ordering::then);
    let name = |d: &Design| (d.design_id.len(), d.design_id.clone());
    by(objective).then(others).then(cost(a).total_cmp(&cost(b))).then_with(|| name(a).cmp(&name(b)))
}

/// The knee: the design nearest to the ideal point, which has the best value of every objective on the front. Distances
/// are measured in logarithms, and each objective is scaled by its range over the front. `None` if there is no design.
pub fn knee(designs: &[Design]) -> Option<&Design> {
    let scales = Objective::ALL.map(|o| Scale::of(o, designs));
    let distance = |d: &Design| scales.iter().map(|s| s.regret(d).powi(2)).sum::<f64>();
    designs
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)).then_with(|| better(Objective::Mass, a, b)))
}

/// The scale of an objective over a front: its best value and its range.
struct Scale {
    objective: Objective,
    logarithmic: bool,
    ideal: f64,
    range: f64,
}

impl Scale {
    fn of(objective: Objective, designs: &[Design]) -> Self {
        let logarithmic = designs.iter().all(|d| objective.of(d) > 0.0);
        let mut scale = Self { objective, logarithmic, ideal: 0.0, range: 0.0 };
        let values: Vec<f64> = designs.iter().map(|d| scale.value(d)).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (scale.ideal, scale.range) = (least, most - least);
        scale
    }

    /// The value of the objective for a design, with the sign chosen so that smaller is better. It is the logarithm if
    /// all values of the front are positive.
    fn value(&self, design: &Design) -> f64 {
        let value = self.objective.of(design);
        let value = if self.logarithmic { libm::log(value) } else { value };
        if self.objective == Objective::Mode { -value } else { value }
    }

    /// How far a design is from the best value of the objective, relative to the range over the front: 0 for the best
    /// design, 1 for the worst.
    fn regret(&self, design: &Design) -> f64 {
        if self.range > 0.0 { (self.value(design) - self.ideal) / self.range } else { 0.0 }
    }
}

/// A picked design.
#[derive(Debug, Clone, PartialEq)]
pub struct Pick {
    /// What the design is picked for: one or more of `lightest`, `stiffest`, `highest mode`, `knee`.
    pub names: Vec<&'static str>,
    /// The design that is picked.
    pub design: Design,
}

/// The tightest check of a design: of all checks of its drives, the check that is nearest to its limit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TightestCheck {
    /// Name of the joint.
    pub joint: String,
    /// The check in words, such as `gear mean`.
    pub check: String,
    /// Allowed value divided by needed value, as a factor on torque.
    pub margin: f64,
}

/// The tightest check of the design in a row of a front, by the columns `<joint>_margin` and `<joint>_binds`. `None` if
/// no drive was checked.
pub(crate) fn tightest_check(front: &FrontTable, row: usize) -> Option<TightestCheck> {
    let cells = &front.rows[row];
    let of_column = |(column, name): (usize, &String)| {
        let joint = name.strip_suffix("_binds")?;
        let margin: f64 = cells[front.column(&format!("{joint}_margin"))?].parse().ok()?;
        Some(TightestCheck { joint: joint.to_string(), check: cells[column].clone(), margin })
    };
    front.columns.iter().enumerate().filter_map(of_column).min_by(|a, b| a.margin.total_cmp(&b.margin))
}

/// For each pick, its row in the table and its names in one text.
pub(crate) fn rows_and_names(picks: &[Pick]) -> Vec<(usize, String)> {
    picks.iter().map(|pick| (pick.design.row, pick.names.join(", "))).collect()
}

/// The picks that are best in one objective: their names, and the objective.
pub(crate) const BEST: [(&str, Objective); 3] =
    [("lightest", Objective::Mass), ("stiffest", Objective::Deflection), ("highest mode", Objective::Mode)];

/// Name of the pick that is nearest to the best of all objectives.
pub(crate) const KNEE: &str = "knee";

/// The names of all picks, in the order in which they are listed.
pub const PICKS: [&str; 4] = [BEST[0].0, BEST[1].0, BEST[2].0, KNEE];

/// The picks of a front: lightest, stiffest, highest mode and knee. A design that is picked twice is listed once,
/// with both names.
pub fn picks(designs: &[Design]) -> Vec<Pick> {
    let best = BEST.map(|(name, objective)| (name, best(objective, designs)));
    let named = best.into_iter().chain([(KNEE, knee(designs))]);
    let mut out: Vec<Pick> = Vec::new();
    for (name, design) in named.filter_map(|(n, d)| Some((n, d?))) {
        match out.iter_mut().find(|p| p.design.row == design.row) {
            Some(pick) => pick.names.push(name),
            None => out.push(Pick { names: vec![name], design: design.clone() }),
        }
    }
    out
}

/// The choices of a row in words, for each link and joint in the order of the columns: `upper_arm 120 x 100 x 3 mm
/// Aluminium 6061-T6`.
pub fn choices(front: &FrontTable, row: usize) -> Vec<String> {
    marked_choices(front, row, &Caveats::default())
}

/// The choices of a row in words, as [`choices`] gives them, with the caveats of their parts in brackets:
/// `CFRP (representative)`, `F11-10 (from memory)`.
pub fn marked_choices(front: &FrontTable, row: usize, caveats: &Caveats) -> Vec<String> {
    let cell = |name: &str| front.column(name).map(|c| front.rows[row][c].as_str()).filter(|c| !c.is_empty());
    let piece = |column: &String| {
        if let Some(link) = column.strip_suffix("_material") {
            let shape = cell(&format!("{link}_shape")).unwrap_or_default();
            let sizes = ["width_mm", "height_mm", "wall_mm"].map(|s| cell(&format!("{link}_{s}")));
            let known: Vec<&str> = sizes.into_iter().flatten().collect();
            let size = match sizes {
                [Some(width), Some(height), Some(wall)] => {
                    format!(" {}", tube_size(shape, [width, height, wall]))
                }
                [None, None, None] => String::new(),
                // a table that another program wrote may lack some of the columns
                _ => format!(" {} mm", known.join(" x ")),
            };
            let profile = cell(&format!("{link}_profile")).and_then(|profile| caveats.of_part(profile));
            let of_profile = profile.map_or(String::new(), |caveat| format!(" (profile {caveat})"));
            return cell(column)
                .map(|material| format!("{link}{size} {}{of_profile}", caveats.marked(material)));
        }
        let joint = column.strip_suffix("_gear")?;
        let parts = [cell(column), cell(&format!("{joint}_motor"))];
        let parts: Vec<String> = parts.into_iter().flatten().map(|part| caveats.marked(part)).collect();
        (!parts.is_empty()).then(|| format!("{joint} {}", parts.join(" + ")))
    };
    front.columns.iter().filter_map(piece).collect()
}

/// The distinct link materials of a row, in the order of the links.
pub fn materials(front: &FrontTable, row: usize) -> Vec<&str> {
    let mut out: Vec<&str> = Vec::new();
    for (index, _) in front.columns.iter().enumerate().filter(|(_, c)| c.ends_with("_material")) {
        let name = front.rows[row][index].as_str();
        if !name.is_empty() && !out.contains(&name) {
            out.push(name);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn design(id: &str, deflection: f64, mass: f64, mode: f64) -> Design {
        Design {
            design_id: id.into(),
            tip_deflection_mm: deflection,
            mass_kg: mass,
            lowest_mode_hz: mode,
            material_cost_eur: None,
            row: id.bytes().map(usize::from).sum(),
        }
    }

    #[test]
    fn the_knee_is_nearest_to_the_ideal_in_logarithms() {
        // logarithms base 10: deflection 0 to 2, mass 0 to 2. Design b is at (0.5, 0.5), a and c are far from the
        // ideal point.
        let front =
            [design("a", 1.0, 100.0, 9.0), design("b", 3.162, 3.162, 9.0), design("c", 100.0, 1.0, 9.0)];
        assert_eq!(knee(&front).map(|d| d.design_id.as_str()), Some("b"));
    }

    #[test]
    fn a_deflection_of_zero_does_not_spoil_the_knee() {
        let front = [design("a", 0.0, 10.0, 9.0), design("b", 0.1, 1.0, 9.0), design("c", 1.0, 0.9, 9.0)];
        assert_eq!(knee(&front).map(|d| d.design_id.as_str()), Some("b"));
        assert_eq!(knee(&[]), None);
    }

    #[test]
    fn equals_are_told_apart_by_the_other_objectives_and_cost() {
        let cheap = Design { material_cost_eur: Some(5.0), ..design("z", 1.0, 2.0, 3.0) };
        let front = [design("a", 1.0, 2.0, 3.0), cheap.clone(), design("b", 2.0, 2.0, 9.0)];
        assert_eq!(best(Objective::Mass, &front), Some(&cheap));
    }

    #[test]
    fn a_design_picked_twice_is_listed_once() {
        let front = [design("a", 1.0, 9.0, 30.0), design("b", 5.0, 2.0, 3.0)];
        let names: Vec<_> = picks(&front).into_iter().map(|p| (p.design.design_id, p.names)).collect();
        assert_eq!(names[0].0, "b");
        assert!(names[1].1.starts_with(&["stiffest", "highest mode"]));
    }
}
