//! How a study's result changes under another model of the same arm. Each design of both fronts is evaluated by
//! both models, and the picks that differ are listed.
//!
//! A design is identified by its `design_id`, that is, by what the search chose. Drives that the study sizes
//! are sized again under the other model.

use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::report::picks::{PICKS, choices, designs, picks};
use crate::report::table::{Column, Table};
use serde::Serialize;

/// The objectives of a design under one of the two models of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Values {
    /// Tip deflection \[mm\].
    pub tip_deflection_mm: f64,
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Lowest mode \[Hz\].
    pub lowest_mode_hz: f64,
}

/// One of the two models of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Model {
    /// The arm as its file describes it, without corrections.
    Nominal,
    /// The arm with the corrections of a measured arm.
    Corrected,
}

/// A design of either front, evaluated by both models.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Changed {
    /// Name of the design.
    pub design_id: String,
    /// Whether the design is on the front of the nominal model, and whether it is on the front of the corrected model.
    pub on_front: [bool; 2],
    /// Objectives of the design under the nominal and the corrected model. `None` if no catalog drive is strong
    /// enough or the design breaks a limit.
    pub values: [Option<Values>; 2],
    /// What the design is picked for (lightest, stiffest, highest mode, knee) under the nominal and the corrected
    /// model.
    pub picks: [Vec<&'static str>; 2],
    /// Parts of the design in words.
    pub choices: String,
}

/// A pick, such as the lightest design, under both models.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct PickChange {
    /// Name of the pick: `lightest`, `stiffest`, `highest mode` or `knee`.
    pub pick: &'static str,
    /// Whether the corrected model picks another design.
    pub changes: bool,
    /// Name of the design that the nominal model picks.
    pub nominal_design_id: String,
    /// Objectives of the design that the nominal model picks, under the nominal model; `None` if it is not feasible
    /// under this model.
    pub nominal: Option<Values>,
    /// Objectives of the design that the nominal model picks, under the corrected model; `None` if it is no longer
    /// feasible.
    pub nominal_under_corrected: Option<Values>,
    /// Name of the design that the corrected model picks.
    pub corrected_design_id: String,
    /// Objectives of the design that the corrected model picks, under the corrected model; `None` if it is not feasible
    /// under this model.
    pub corrected: Option<Values>,
}

/// All designs of the nominal and of the corrected front of a study, each with its objectives under both models.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Changes {
    /// Every design of either front. The designs of the nominal front come first.
    pub designs: Vec<Changed>,
}

impl Changes {
    /// Compares the nominal and the corrected front of one study (`fronts`, in this order). `judge` computes the
    /// objectives of a design, given by its `design_id`, under a model.
    pub(crate) fn new(fronts: [&FrontTable; 2], judge: impl Fn(Model, &str) -> Option<Values>) -> Self {
        let mut out = Self { designs: Vec::new() };
        for (side, front) in fronts.into_iter().enumerate() {
            let all = designs(front);
            let picked = picks(&all);
            for design in &all {
                let at = out.entry(&design.design_id, || choices(front, design.row).join("; "), &judge);
                at.on_front[side] = true;
                let own = picked.iter().find(|p| p.design.row == design.row);
                at.picks[side] = own.map_or(Vec::new(), |p| p.names.clone());
            }
        }
        out
    }

    fn entry(
        &mut self,
        id: &str,
        choices: impl FnOnce() -> String,
        judge: &impl Fn(Model, &str) -> Option<Values>,
    ) -> &mut Changed {
        let known = self.designs.iter().position(|d| d.design_id == id);
        let index = known.unwrap_or_else(|| {
            self.designs.push(Changed {
                design_id: id.to_string(),
                on_front: [false; 2],
                values: [Model::Nominal, Model::Corrected].map(|model| judge(model, id)),
                picks: [Vec::new(), Vec::new()],
                choices: choices(),
            });
            self.designs.len() - 1
        });
        &mut self.designs[index]
    }

    /// Numbers of designs: on both fronts, only on the nominal front, only on the corrected front.
    pub(crate) fn counts(&self) -> [usize; 3] {
        [[true, true], [true, false], [false, true]]
            .map(|on| self.designs.iter().filter(|d| d.on_front == on).count())
    }

    /// For each pick (lightest, and so on), the designs that the two models pick. Empty if a front is empty.
    pub(crate) fn picks(&self) -> Vec<PickChange> {
        let of = |side: usize, pick: &str| self.designs.iter().find(|d| d.picks[side].contains(&pick));
        PICKS
            .into_iter()
            .filter_map(|pick| {
                let (nominal, corrected) = (of(0, pick)?, of(1, pick)?);
                Some(PickChange {
                    pick,
                    changes: nominal.design_id != corrected.design_id,
                    nominal_design_id: nominal.design_id.clone(),
                    nominal: nominal.values[0],
                    nominal_under_corrected: nominal.values[1],
                    corrected_design_id: corrected.design_id.clone(),
                    corrected: corrected.values[1],
                })
            })
            .collect()
    }

    /// The numbers of designs and the picks under both models, as text for a terminal.
    pub(crate) fn to_text(&self) -> String {
        let [stay, leave, enter] = self.counts();
        let mut table = Table::new(vec![
            Column::left("pick"),
            Column::left("design"),
            Column::left("model"),
            Column::unit("tip", "mm"),
            Column::unit("mass", "kg"),
            Column::unit("lowest mode", "Hz"),
        ]);
        let cells = |pick: &str, id: &str, model: &str, values: Option<Values>| {
            let numbers = values.map_or([const { String::new() }; 3], |v| {
                [v.tip_deflection_mm, v.mass_kg, v.lowest_mode_hz].map(|x| significant(x, 4))
            });
            let model = if values.is_some() { model.to_string() } else { "no longer holds".to_string() };
            [pick.to_string(), id.to_string(), model].into_iter().chain(numbers)
        };
        for p in self.picks() {
            table.row(cells(p.pick, &p.nominal_design_id, "nominal", p.nominal));
            table.row(cells("", &p.nominal_design_id, "corrected", p.nominal_under_corrected));
            if p.changes {
                table.row(cells("", &p.corrected_design_id, "corrected, new pick", p.corrected));
            }
        }
        format!("front: {stay} designs stay, {leave} leave, {enter} enter\n\n{}", table.to_text())
    }

    /// All designs as CSV, one line per design.
    pub(crate) fn to_csv(&self) -> String {
        let names = ["design_id", "front", "nominal_pick", "corrected_pick"];
        let figures = ["tip_deflection_mm", "mass_kg", "lowest_mode_hz"];
        let both = figures.iter().flat_map(|f| [format!("{f}_nominal"), format!("{f}_corrected")]);
        let header = names.iter().map(ToString::to_string).chain(both).chain(["choices".to_string()]);
        let mut table = Table::new(header.map(|h| Column::left(&h)).collect());
        for d in &self.designs {
            let front = match d.on_front {
                [true, true] => "stays",
                [true, false] => "leaves",
                _ => "enters",
            };
            let of = |value: fn(&Values) -> f64| {
                d.values.map(|v| v.map_or(String::new(), |v| crate::report::number::shortest(value(&v))))
            };
            let numbers = [of(|v| v.tip_deflection_mm), of(|v| v.mass_kg), of(|v| v.lowest_mode_hz)].concat();
            let [before, after] = [0, 1].map(|side| d.picks[side].join(", "));
            let names = [d.design_id.clone(), front.to_string(), before, after];
            table.row(names.into_iter().chain(numbers).chain([d.choices.clone()]));
        }
        table.to_csv()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn front(rows: &[(&str, f64, f64, f64)]) -> FrontTable {
        let columns = ["design_id", "tip_deflection_mm", "mass_kg", "lowest_mode_hz"].map(String::from);
        let cells = |r: &(&str, f64, f64, f64)| {
            vec![r.0.to_string(), r.1.to_string(), r.2.to_string(), r.3.to_string()]
        };
        FrontTable { columns: columns.to_vec(), rows: rows.iter().map(cells).collect() }
    }

    #[test]
    fn a_pick_that_another_design_takes_is_shown_under_both_models() {
        let nominal = front(&[("a", 1.0, 10.0, 20.0), ("b", 2.0, 5.0, 10.0)]);
        let corrected = front(&[("c", 1.5, 10.0, 15.0), ("b", 2.5, 5.0, 9.0)]);
        let judge = |model: Model, id: &str| {
            let table = if model == Model::Nominal { &nominal } else { &corrected };
            let found = designs(table).into_iter().find(|d| d.design_id == id)?;
            Some(Values {
                tip_deflection_mm: found.tip_deflection_mm,
                mass_kg: found.mass_kg,
                lowest_mode_hz: found.lowest_mode_hz,
            })
        };
        let changes = Changes::new([&nominal, &corrected], judge);
        assert_eq!(changes.counts(), [1, 1, 1]);
        let picks = changes.picks();
        let stiffest = picks.iter().find(|p| p.pick == "stiffest").expect("a pick");
        assert!(stiffest.changes && stiffest.nominal_under_corrected.is_none());
        assert_eq!([&stiffest.nominal_design_id, &stiffest.corrected_design_id], ["a", "c"]);
        let lightest = picks.iter().find(|p| p.pick == "lightest").expect("a pick");
        assert!(!lightest.changes);
        assert_eq!(lightest.nominal_under_corrected.map(|v| v.tip_deflection_mm), Some(2.5));
        assert!(changes.to_csv().contains("\na,leaves,"), "{}", changes.to_csv());
    }
}
