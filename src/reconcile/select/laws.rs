//! Laws without a name: smooth, general functions that are not effects of the library. They reveal physics that the
//! library lacks.
//!
//! A law may be a twist of a joint as a function of its torque (odd or even), of its angle, or of the order of the
//! tests. It may be a compliance of a base, a bearing or a link in one direction only, or a mass or wall of a link that
//! differs from the drawing. It may also be an error of a reading as a function of the actual value, the direction, the
//! kind of load, or the time in a pose. A law consists of a few columns: changes of the readings, linearized about a
//! fit.

use super::waves::waves;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::stiffness_waves;
use crate::mechanics::beam::Strain;
use crate::reconcile::fit::descent::{Fit, change_to};
use crate::reconcile::forward::bench::ARCMIN_PER_RAD;
use crate::reconcile::forward::coefficients::Coefficients;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::DVector;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A law without a name: a way in which readings can differ from the model.
pub(crate) struct Law {
    /// Description of the law in words.
    pub what: String,
    /// Name of the effect of the library that is the same as this law; `None` if there is none.
    pub effect: Option<&'static str>,
    /// The law's columns: for each of its parameters, the change of each predicted reading per unit of the parameter,
    /// in the unit of the file.
    pub columns: Vec<Vec<f64>>,
}

/// Calls `each` for every law at every place, and returns the results. The columns of a law are linearized about
/// `fit`. Laws are built in groups, because the columns of all laws together would need much memory.
pub(crate) fn of_every_law<T: Send>(
    campaign: &Campaign,
    forward: &Forward,
    fit: &Fit,
    each: impl Fn(&Law) -> T + Sync,
) -> Vec<T> {
    let builder = Builder { campaign, forward, fit, torques_nm: forward.torques_nm(&fit.point.coefficients) };
    let mut out = Vec::new();
    let mut ask = |mut group: Vec<Law>| {
        // a law that changes no reading cannot be tested
        group.retain(|law| law.columns.iter().all(|c| c.iter().any(|x| *x != 0.0)));
        out.par_extend(group.par_iter().map(&each));
    };
    (0..forward.layout.joints.len()).for_each(|joint| ask(builder.joint_laws(joint)));
    ask(builder.compliance_laws());
    ask(builder.link_laws());
    ask(builder.reading_laws());
    out
}

/// Torque, angle and test of a joint at the time of a reading.
struct State {
    torque_nm: f64,
    angle_deg: f64,
    /// Fraction of the channel's rows that were taken before this reading.
    part: f64,
    channel: Channel,
    /// Whether this is the unloaded reference of a displacement, and not the displacement itself.
    is_reference: bool,
}

/// A function that gives two numbers for a state of the joint: an additional torque \[N m\], and its derivative with
/// respect to the joint's torque. The additional twist of the joint is its compliance times the additional torque. The
/// additional tangent compliance is the compliance times the derivative.
type Shape<'a> = &'a dyn Fn(&State) -> (f64, f64);

/// A function that builds a column of a channel's readings. Its argument is a function that gives the entry of a datum
/// from the index and the predicted reading of this datum.
type ColumnOf<'a> = &'a dyn Fn(&dyn Fn(usize, f64) -> f64) -> Vec<f64>;

struct Builder<'a> {
    campaign: &'a Campaign,
    forward: &'a Forward,
    fit: &'a Fit<'a>,
    torques_nm: Vec<Vec<f64>>,
}

impl Builder<'_> {
    fn joint_laws(&self, joint: usize) -> Vec<Law> {
        let law = &self.fit.point.coefficients.laws[joint];
        let compliance = law.tangent_compliance_rad_per_nm(0.0);
        let statics = self.torques_nm.iter().map(|t| t[joint].abs());
        let largest_nm = statics.chain(self.forward.bench_torques_nm(joint)).fold(0.0, f64::max);
        if compliance == 0.0 || largest_nm == 0.0 {
            return Vec::new();
        }
        let name = &self.forward.layout.joints[joint].name;
        let column = |shape: Shape| self.joint_column(joint, compliance, shape);
        let part = |s: &State| s.torque_nm / largest_nm;
        let odd = [
            column(&|s| (s.torque_nm * part(s).abs(), 2.0 * part(s).abs())),
            column(&|s| (s.torque_nm * part(s).powi(2), 3.0 * part(s).powi(2))),
        ];
        let even = [
            column(&|s| (s.torque_nm.abs(), s.torque_nm.signum())),
            column(&|s| (s.torque_nm * part(s), 2.0 * part(s))),
        ];
        // on the bench the angle of the joint is not known
        let wave = |k: usize| {
            column(&|s| {
                let factor = if s.channel == Channel::Windup { 0.0 } else { waves(s.angle_deg)[k] };
                (s.torque_nm * factor, factor)
            })
        };
        let order = |channel: Channel, power: i32| {
            column(&|s| {
                let factor = if s.channel == channel { s.part.powi(power) } else { 0.0 };
                (s.torque_nm * factor, factor)
            })
        };
        let mut out =
            one_or_both(&format!("a stiffness of {name} that changes with the size of its torque"), odd);
        out.extend(one_or_both(
            &format!("a stiffness of {name} that differs between the senses of its torque"),
            even,
        ));
        if self.campaign.arm.driven_joint_names().contains(&name.as_str()) {
            let what = format!("a stiffness of {name} that changes with its angle");
            let effect = Some(stiffness_waves::KIND.name);
            out.push(Law { what: what.clone(), effect, columns: vec![wave(0), wave(1)] });
            out.push(Law { what, effect, columns: vec![wave(2), wave(3)] });
        }
        for channel in [Channel::Static, Channel::Modal] {
            let what =
                format!("a stiffness of {name} that changes with the order of the {} tests", channel.word());
            out.extend(one_or_both(&what, [order(channel, 1), order(channel, 2)]));
            // a servo may hold a joint less stiffly than a brake; if there is one kind of readings only, this cannot
            // be told from the joint's stiffness
            if self.kinds_of_readings() > 1 {
                let what = format!("a stiffness of {name} that is another in the {} tests", channel.word());
                out.push(Law { what, effect: None, columns: vec![order(channel, 0)] });
            }
        }
        out.extend(self.warming_laws(joint, &column));
        out
    }

    /// Laws of a joint that warms up or works loose in the course of the tests, with references that were read before
    /// all of them: in the static tests, and in static and modal tests together. `column` builds a column of the joint.
    fn warming_laws(&self, joint: usize, column: &dyn Fn(Shape) -> Vec<f64>) -> Vec<Law> {
        let name = &self.forward.layout.joints[joint].name;
        let is_empty = |channel| self.forward.range(channel).is_empty();
        let of = |channels: &'static [Channel], tests: &str| {
            let order = |power: i32| {
                column(&|s| {
                    let changes = channels.contains(&s.channel) && !s.is_reference;
                    let factor = if changes { s.part.powi(power) } else { 0.0 };
                    (s.torque_nm * factor, factor)
                })
            };
            let what = format!(
                "a stiffness of {name} that changes with the order of the {tests} tests, from references read before them"
            );
            one_or_both(&what, [order(1), order(2)])
        };
        match (is_empty(Channel::Static), is_empty(Channel::Modal)) {
            (true, _) => Vec::new(),
            (false, true) => of(&[Channel::Static], "static"),
            (false, false) => {
                let mut out = of(&[Channel::Static], "static");
                out.extend(of(&[Channel::Static, Channel::Modal], "static and modal"));
                out
            }
        }
    }

    /// Number of channels for which the campaign has readings.
    fn kinds_of_readings(&self) -> usize {
        let channels = [Channel::Static, Channel::Modal, Channel::Windup];
        channels.into_iter().filter(|channel| !self.forward.range(*channel).is_empty()).count()
    }

    /// The change of every reading, in its unit, by an additional twist of the joint with index `joint`. This twist
    /// is `compliance` \[rad/(N m)\] times `shape`, which depends on the torque, angle and row.
    fn joint_column(&self, joint: usize, compliance: f64, shape: Shape) -> Vec<f64> {
        let forward = self.forward;
        let driven = self.campaign.arm.driven_joint_names();
        let own = driven.iter().position(|n| *n == forward.layout.joints[joint].name);
        let angle_deg = |pose: &[f64]| own.map_or(0.0, |j| pose[j]);
        let mut truth = vec![0.0; forward.data.len()];
        let mut row = 0;
        for pose in &forward.statics {
            let torques = pose.torques_nm(&forward.layout, &self.fit.point.coefficients);
            let loads = torques.len() - 1;
            for load in 0..loads {
                let state = |load: usize| State {
                    torque_nm: torques[load][joint],
                    angle_deg: angle_deg(&self.campaign.statics[row].pose_deg),
                    part: row as f64 / self.campaign.statics.len() as f64,
                    channel: Channel::Static,
                    is_reference: load == 0,
                };
                let twist = shape(&state(load + 1)).0 - shape(&state(0)).0;
                for (c, datum) in pose.measured(load) {
                    truth[datum] = 1e3 * pose.geometry.joints[joint].tip[c] * compliance * twist;
                }
                row += 1;
            }
        }
        let slot = &forward.layout.joints[joint];
        self.add_modal(&mut truth, |datum, y| {
            let row = datum - forward.starts[1];
            let state = State {
                torque_nm: self.torques_nm[datum][joint],
                angle_deg: angle_deg(&self.campaign.modal[row].pose_deg),
                part: row as f64 / self.campaign.modal.len() as f64,
                channel: Channel::Modal,
                is_reference: false,
            };
            y[slot.twist].powi(2) * compliance * shape(&state).1
        });
        for (row, datum) in self.campaign.windup.iter().zip(forward.range(Channel::Windup)) {
            if row.joint == slot.name {
                let state = State {
                    torque_nm: row.torque_nm,
                    angle_deg: 0.0,
                    part: 0.0,
                    channel: Channel::Windup,
                    is_reference: false,
                };
                truth[datum] = ARCMIN_PER_RAD * compliance * shape(&state).0;
            }
        }
        self.read(&truth)
    }

    /// Laws of a base, bearings and links that are more compliant than modelled, each in one direction only or in a
    /// part of the link only.
    fn compliance_laws(&self) -> Vec<Law> {
        let layout = &self.forward.layout;
        let own = &self.fit.point.coefficients;
        let joints: Vec<f64> = own.laws.iter().map(|law| law.tangent_compliance_rad_per_nm(0.0)).collect();
        let Some(common) = joints.iter().copied().find(|c| *c > 0.0) else { return Vec::new() };
        let law = |what: String, further: &[(usize, f64)]| Law {
            what,
            effect: None,
            columns: vec![self.compliance_column(further)],
        };
        let tilts = |what: String, first: usize, compliance: f64| {
            [first, first + 1].map(|i| law(what.clone(), &[(i, compliance)]))
        };
        let mut out = Vec::from(tilts("a base that tilts about one axis only".into(), 0, common));
        for (joint, compliance) in layout.joints.iter().zip(&joints) {
            let what = format!("a bearing of {} that tilts about one axis only", joint.name);
            let compliance = if *compliance > 0.0 { *compliance } else { common };
            out.extend(tilts(what, joint.twist - 2, compliance));
        }
        for link in &layout.links {
            let strained = |what: String, wanted: &dyn Fn(Strain, usize) -> bool| {
                let strains = link.strains.iter().enumerate().filter(|(_, (s, degree))| wanted(*s, *degree));
                let further = strains.map(|(i, _)| (link.first + i, own.linear[link.first + i]));
                law(what, &further.collect::<Vec<_>>())
            };
            out.push(strained(format!("a torsion of {} beyond its own", link.name), &|s, _| {
                s == Strain::Twist
            }));
            for plane in [Strain::CurvatureZ, Strain::CurvatureY] {
                let name = &link.name;
                out.push(strained(format!("a bending of {name} in one plane only"), &|s, _| s == plane));
                let at_one_end = |s, degree| s == plane && degree == 1;
                out.push(strained(format!("a bending of {name} in a part of it"), &at_one_end));
            }
        }
        out
    }

    /// Laws of links that are lighter or heavier than drawn, and of tubes whose wall is thinner or thicker. A thinner
    /// wall lowers mass and stiffness in proportion.
    fn link_laws(&self) -> Vec<Law> {
        let links = self.forward.nominal.structure.links().enumerate();
        let laws = links.filter(|(_, link)| link.tube_kg_per_m() > 0.0).flat_map(|(l, link)| {
            let lighter =
                move |c: &mut Coefficients, part: f64| self.lighten(c, l, part * link.tube_kg_per_m());
            let thinner = move |c: &mut Coefficients, part: f64| {
                lighter(c, part);
                let slot = &self.forward.layout.links[l];
                let own = slot.first..slot.first + slot.strains.len();
                c.linear[own].iter_mut().for_each(|compliance| *compliance *= 1.0 + part);
            };
            let law = |what: &str, changed: &dyn Fn(&mut Coefficients, f64)| Law {
                what: format!("a {what} of {} other than drawn", link.name),
                effect: None,
                columns: vec![self.changed_column(changed)],
            };
            [law("mass", &lighter), law("wall", &thinner)]
        });
        laws.collect()
    }

    /// Removes `kg_per_m` from the mass per length of the link with index `link` \[kg/m\], in mass and weight.
    fn lighten(&self, coefficients: &mut Coefficients, link: usize, kg_per_m: f64) {
        let index = self.forward.layout.joints.len() + link;
        coefficients.masses[index] -= kg_per_m;
        coefficients.weights[index] -= kg_per_m;
    }

    /// The derivative of every reading with respect to the size of a change of the coefficients, at size zero.
    /// `changed` makes the change of a given size in the coefficients.
    fn changed_column(&self, changed: &dyn Fn(&mut Coefficients, f64)) -> Vec<f64> {
        const PART: f64 = 1e-4;
        let mut moved = self.fit.point.coefficients.clone();
        changed(&mut moved, PART);
        change_to(self.forward, &self.fit.point, moved).into_iter().map(|d| d / PART).collect()
    }

    /// The change of every reading, in its unit, by additional compliances. Each entry of `further` is a pair: index of
    /// the strain coordinate, and its additional compliance.
    fn compliance_column(&self, further: &[(usize, f64)]) -> Vec<f64> {
        let forward = self.forward;
        let mut truth = vec![0.0; forward.data.len()];
        for pose in &forward.statics {
            pose.add_compliant(&forward.layout, &self.fit.point.coefficients, further, &mut truth);
        }
        self.add_modal(&mut truth, |_, y| further.iter().map(|(i, c)| y[*i].powi(2) * c).sum());
        self.read(&truth)
    }

    /// Sets the entries of `truth` that belong to frequencies: the first-order change of each frequency \[Hz\] when
    /// the compliance matrix changes by `dC`. `energy` receives the index of a datum and the inertia forces `y` of its
    /// mode, and returns `yᵀ dC y`.
    fn add_modal(&self, truth: &mut [f64], energy: impl Fn(usize, &DVector<f64>) -> f64) {
        for (test, solved) in self.forward.modal.iter().zip(&self.fit.point.solved) {
            for &(datum, mode) in &test.modes {
                let Some(s) = solved.get(mode) else { continue };
                let d_mu = energy(datum, &s.y) / s.mu;
                truth[datum] = -0.5 * d_mu / s.mu / (TAU * s.mu.sqrt());
            }
        }
    }

    /// Converts changes of actual values into changes of the readings that the measuring channels show. `truth` has
    /// one entry per datum, in its unit.
    fn read(&self, truth: &[f64]) -> Vec<f64> {
        let channels = &self.fit.point.coefficients.channels;
        truth.iter().zip(&self.forward.data).map(|(t, d)| t * channels[d.channel as usize].factor).collect()
    }

    fn reading_laws(&self) -> Vec<Law> {
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
            out.extend(one_or_both(
                &format!("{} readings that are not straight in the true value", channel.word()),
                bent,
            ));
            if channel == Channel::Static {
                out.extend(self.direction_laws(&column));
                out.extend(self.load_laws(&column));
            }
        }
        out
    }

    /// Laws of static readings that follow the load in a way that the model lacks: loads other than stated, a support
    /// that deflects in the direction of the load, and readings that grow while the arm stays in one pose. `column`
    /// builds a column.
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
        let along = |vertical: bool| {
            column(&|i, _| {
                let component = self.forward.data[i].component;
                if (component == 2) == vertical {
                    largest_mm * load_n(row(i))[component] / largest_n
                } else {
                    0.0
                }
            })
        };
        let kept = rows_in_pose(rows.iter().map(|r| r.pose_deg.as_slice()));
        let longest = kept.iter().copied().max().unwrap_or(0).max(1) as f64;
        let is_carrying = |r: usize| rows[r].payload.mass_kg > 0.0;
        let gain = |carrying: bool| column(&|i, d| if is_carrying(row(i)) == carrying { d } else { 0.0 });
        let law = |what: &str, columns| Law { what: what.into(), effect: None, columns };
        let mut out = vec![
            law("static readings under payloads with a gain of their own", vec![gain(true)]),
            law("payloads that weigh a factor of what is stated", vec![self.heavier_payloads(gain(true))]),
            law("static readings under tip forces alone with a gain of their own", vec![gain(false)]),
            law(
                "static readings that grow while a pose is kept",
                vec![column(&|i, d| d * kept[row(i)] as f64 / longest)],
            ),
        ];
        out.extend(one_or_both(
            "static readings that follow the load wherever the tip is",
            [along(false), along(true)],
        ));
        out
    }

    /// Adds to `column`, a column of the static readings under payloads, the change of the frequencies if all
    /// payloads are heavier in the same proportion.
    fn heavier_payloads(&self, mut column: Vec<f64>) -> Vec<f64> {
        const PART: f64 = 1e-4;
        let forward = self.forward;
        let from = &self.fit.point.coefficients;
        let mut truth = vec![0.0; forward.data.len()];
        for (test, solved) in forward.modal.iter().zip(&self.fit.point.solved) {
            let Some((datum, _)) = test.modes.first() else { continue };
            let payload_kg = self.campaign.modal[datum - forward.starts[1]].payload.mass_kg;
            let mut to = from.clone();
            to.payload_delta_kg += PART * payload_kg;
            test.change(&forward.layout, solved, from, &to, &mut truth);
        }
        let modal = self.read(&truth);
        column.iter_mut().zip(modal).for_each(|(own, change)| *own += change / PART);
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
        let law = |what: &str, columns: Vec<Vec<f64>>| Law { what: what.into(), effect: None, columns };
        let mut out = vec![law(
            "static readings with a gain of their own in each direction",
            (0..3).map(gain).collect(),
        )];
        if !turns.is_empty() {
            out.push(law("static readings in a frame that is turned", turns));
        }
        out
    }
}

/// For each row, how many rows with the same pose stand directly before it.
fn rows_in_pose<'a>(poses: impl Iterator<Item = &'a [f64]>) -> Vec<usize> {
    let mut last: Option<(&[f64], usize)> = None;
    poses
        .map(|pose| {
            let count = last.filter(|(before, _)| *before == pose).map_or(0, |(_, count)| count + 1);
            last = Some((pose, count));
            count
        })
        .collect()
}

/// Three laws with the description `what`: one with the first column, one with the second, and one with both.
fn one_or_both(what: &str, columns: [Vec<f64>; 2]) -> Vec<Law> {
    let [a, b] = columns;
    let law = |columns| Law { what: what.to_string(), effect: None, columns };
    vec![law(vec![a.clone()]), law(vec![b.clone()]), law(vec![a, b])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::reconcile::fit::descent::{Effort, fit};
    use crate::reconcile::fit::noise::Noise;
    use crate::reconcile::model::calibration::{Calibration, Nuisance};
    use crate::reconcile::model::parameters::Model;
    use std::path::Path;

    /// Calls `check` with a builder of laws for a test campaign, linearized about the nominal arm, and with the
    /// calibrated parameters.
    fn about_the_bare_model(check: impl FnOnce(&Builder, &Nuisance)) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        let forward = Forward::new(&campaign);
        let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
        let baseline = Model::baseline(&nuisance);
        let weights = Noise::default().weights(&forward);
        let effort = Effort { steps: 0, tolerance: 0.0 };
        let fit = fit(&forward, &baseline, &vec![0.0; baseline.len()], &weights, effort);
        let torques_nm = forward.torques_nm(&fit.point.coefficients);
        check(&Builder { campaign: &campaign, forward: &forward, fit: &fit, torques_nm }, &nuisance);
    }

    #[test]
    fn a_link_that_yields_more_in_every_way_has_a_lower_modulus() {
        about_the_bare_model(|builder, nuisance| {
            let (forward, fit) = (builder.forward, builder.fit);
            let linear = &fit.point.coefficients.linear;
            let of_links = forward.layout.links.iter().flat_map(|l| l.first..l.first + l.strains.len());
            let column = builder.compliance_column(&of_links.map(|i| (i, linear[i])).collect::<Vec<_>>());
            let is_modulus = |c: &Calibration| matches!(c, Calibration::Modulus(..));
            let p = nuisance.numbers.iter().position(|(c, _)| is_modulus(c)).expect("calibrated");
            let largest = fit.jacobian.column(p).amax() / nuisance.numbers[p].1;
            for (i, own) in column.iter().enumerate() {
                let softer = -fit.jacobian[(i, p)] / nuisance.numbers[p].1;
                assert!((own - softer).abs() <= 1e-3 * largest, "datum {i}: {own} and {softer}");
            }
        });
    }

    #[test]
    fn a_further_twist_in_proportion_to_the_torque_is_a_softer_joint() {
        about_the_bare_model(|builder, nuisance| {
            let (forward, fit) = (builder.forward, builder.fit);
            let mut moving = 0;
            for (joint, slot) in forward.layout.joints.iter().enumerate() {
                let law = &fit.point.coefficients.laws[joint];
                let compliance = law.tangent_compliance_rad_per_nm(0.0);
                let column = builder.joint_column(joint, compliance, &|s| (s.torque_nm, 1.0));
                let is_own = |c: &Calibration| *c == Calibration::Stiffness(slot.name.clone());
                let p = nuisance.numbers.iter().position(|(c, _)| is_own(c)).expect("calibrated");
                let largest = fit.jacobian.column(p).amax();
                if largest < 1e-9 {
                    continue; // the axis goes through the tip and the payload, so nothing changes
                }
                moving += 1;
                for (i, own) in column.iter().enumerate() {
                    let softer = -fit.jacobian[(i, p)] / nuisance.numbers[p].1;
                    let scale = largest / nuisance.numbers[p].1;
                    assert!(
                        (own - softer).abs() <= 1e-3 * scale,
                        "{} datum {i}: {own} and {softer}",
                        slot.name
                    );
                }
            }
            assert!(moving >= 5, "only {moving} joints move a reading");
        });
    }
}
