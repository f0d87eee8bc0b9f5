//! Laws of readings: an instrument that is not linear, that has an offset, that has a gain of its own for one direction
//! or one kind of load, or whose frame is rotated. Further laws here are payloads heavier than stated, and a support that
//! deflects in the direction of the load.

use super::{Builder, Law, one_or_both, placed};
use crate::arm::effect::channel::Channel;
use std::ops::Range;

/// A function that builds a column for a channel. Its argument is a function that computes the entry of one datum from
/// the index of the datum and its predicted reading.
type ColumnOf<'a> = &'a dyn Fn(&dyn Fn(usize, f64) -> f64) -> Vec<f64>;

impl Builder<'_> {
    /// Laws of every channel that has readings.
    pub(super) fn reading_laws(&self) -> Vec<Law> {
        let mut out = Vec::new();
        for channel in [Channel::Static, Channel::Modal, Channel::Windup] {
            let range = self.forward.range(channel);
            let reading = |i: usize| self.fit.point.predicted[i];
            let largest = range.clone().map(|i| reading(i).abs()).fold(0.0, f64::max);
            if largest == 0.0 {
                continue;
            }
            let column = |of: &dyn Fn(usize, f64) -> f64| -> Vec<f64> {
                let inside = |i: usize| if range.contains(&i) { of(i, reading(i)) } else { 0.0 };
                (0..self.forward.data.len()).map(inside).collect()
            };
            let bent = [column(&|_, d| d * d.abs() / largest), column(&|_, d| d * (d / largest).powi(2))];
            let what = format!("{} readings that are not straight in the true value", channel.word());
            let mut own = one_or_both(&what, bent);
            if channel == Channel::Modal {
                let what = "modal readings that are all off by the same frequency";
                own.push(Law::new(what, vec![column(&|_, _| largest)]));
            }
            if channel == Channel::Static {
                own.extend(self.direction_laws(&column));
                own.extend(self.load_laws(&column));
            }
            out.extend(placed(channel.word(), own));
        }
        out
    }

    /// Laws of static readings that depend on the load in a way that the model lacks: loads other than stated, a
    /// support that deflects in the direction of the load.
    /// `column` builds a column.
    fn load_laws(&self, column: ColumnOf) -> Vec<Law> {
        let rows = &self.campaign.statics;
        let gravity = self.forward.layout.gravity_m_s2;
        let load_n = |r: usize| {
            let mut load = rows[r].force_n;
            load.z -= rows[r].payload.mass_kg * gravity;
            load
        };
        let largest_n = (0..rows.len()).map(|r| load_n(r).amax()).fold(1e-9, f64::max);
        let readings = rows.iter().flat_map(|r| r.measured).flatten();
        let largest_mm = readings.fold(0.0f64, |m, d| m.max(d.value_mm.abs()));
        let row = |i: usize| self.forward.data[i].index;
        let along = |components: Range<usize>| {
            column(&|i, _| {
                let component = self.forward.data[i].component;
                if components.contains(&component) {
                    largest_mm * load_n(row(i))[component] / largest_n
                } else {
                    0.0
                }
            })
        };
        let is_carrying = |r: usize| rows[r].payload.mass_kg > 0.0;
        let gain_where = |holds: &dyn Fn(usize) -> bool| column(&|i, d| if holds(row(i)) { d } else { 0.0 });
        let gain_of_payloads = || gain_where(&is_carrying);
        let mut out = vec![
            Law::new("static readings under payloads with a gain of their own", vec![gain_of_payloads()]),
            Law::new(
                "payloads that weigh a factor of what is stated",
                vec![self.heavier_payloads(gain_of_payloads())],
            ),
            Law::new(
                "static readings under tip forces alone with a gain of their own",
                vec![gain_where(&|r| !is_carrying(r))],
            ),
        ];
        out.extend(one_or_both(
            "static readings that follow the load wherever the tip is",
            [along(0..2), along(2..3)],
        ));
        out
    }

    /// Adds to `column`, a column of the static readings under payloads, the change of the frequencies if all
    /// payloads are heavier in the same proportion.
    fn heavier_payloads(&self, mut column: Vec<f64>) -> Vec<f64> {
        const DERIVATIVE_STEP: f64 = 1e-4;
        let forward = self.forward;
        let from = &self.fit.point.coefficients;
        let mut truth = vec![0.0; forward.data.len()];
        for (test, solved) in forward.modal.iter().zip(&self.fit.point.solved) {
            let Some((datum, _)) = test.modes.first() else { continue };
            let payload_kg = self.campaign.modal[datum - forward.starts[1]].payload.mass_kg;
            let mut to = from.clone();
            to.payload_delta_kg += DERIVATIVE_STEP * payload_kg;
            test.change(&forward.layout, solved, from, &to, &mut truth);
        }
        let modal = self.read(&truth);
        column.iter_mut().zip(modal).for_each(|(own, change)| *own += change / DERIVATIVE_STEP);
        column
    }

    /// Laws of an instrument of displacements: a gain of its own for each direction (x, y, z), and a frame that is
    /// rotated. `column` builds a column.
    fn direction_laws(&self, column: ColumnOf) -> Vec<Law> {
        let data = &self.forward.data;
        let gain = |c: usize| column(&|i, d| if data[i].component == c { d } else { 0.0 });
        // a rotation mixes in components that were not measured, so the predicted displacements are needed in full
        let readings = self.forward.displacements_mm(&self.fit.point.coefficients);
        let turned = |axis: usize| {
            column(&|i, _| {
                let c = data[i].component;
                let d = |k: usize| readings[data[i].index][k];
                match (3 + c - axis) % 3 {
                    1 => -d((axis + 2) % 3),
                    2 => d((axis + 1) % 3),
                    _ => 0.0,
                }
            })
        };
        let mut turns: Vec<Vec<f64>> = (0..3).map(turned).collect();
        let range = self.forward.range(Channel::Static);
        // a gauge in one direction reacts to at most two of the three rotations
        if !(0..3).all(|c| data[range.clone()].iter().any(|d| d.component == c)) {
            turns.retain(|column| column.iter().any(|x| *x != 0.0));
        }
        let mut out = vec![Law::new(
            "static readings with a gain of their own in each direction",
            (0..3).map(gain).collect(),
        )];
        if !turns.is_empty() {
            out.push(Law::new("static readings in a frame that is turned", turns));
        }
        out
    }
}
