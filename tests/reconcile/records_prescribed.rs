//! Records against time of a joint with prescribed motion and load: which effects explain its twist, and which must
//! not.

use super::generator::Dice;
use super::records::{names, number, outcome};
use armwright::reconcile::verdict::joint_record::State;
use armwright::reconcile::{Outcome, Verdict};
use serde_json::json;

/// A joint whose link moves as prescribed: the torque of its spring is exact, and friction acts on the motor's side.
struct Prescribed {
    stiffness_nm_per_rad: f64,
    gravity_nm: f64,
    /// Rise of friction at low speed (Stribeck) [N m].
    stribeck_nm: f64,
    /// Transmission error of the output: sine and cosine once a turn, then twice a turn [rad].
    error_rad: [f64; 4],
    /// Whether the joint moves from point to point and rests in between; the friction of its last motion then stays.
    has_rests: bool,
    /// Sign of the torque in the record.
    sign: f64,
    shift_s: f64,
    /// Whether the spring has three segments, of 35, 60 and 90 kN m/rad, with breaks at 40 and 85 N m.
    has_segments: bool,
    /// Half width of a hysteresis of the spring, as a torque [N m] and as a twist [rad]; both 0 if there is none.
    play: [f64; 2],
}

impl Prescribed {
    const COULOMB_NM: f64 = 15.0;
    const VISCOUS_NMS_PER_RAD: f64 = 20.0;
    const ROTOR_KGM2: f64 = 1.5;
    const LINK_KGM2: f64 = 12.0;

    fn plain() -> Self {
        Self {
            stiffness_nm_per_rad: 60e3,
            gravity_nm: 110.0,
            stribeck_nm: 0.0,
            error_rad: [0.0; 4],
            has_rests: false,
            sign: 1.0,
            shift_s: 0.0,
            has_segments: false,
            play: [0.0; 2],
        }
    }

    fn twist_rad(&self, spring_nm: f64) -> f64 {
        if !self.has_segments {
            return spring_nm / self.stiffness_nm_per_rad;
        }
        let size = spring_nm.abs();
        let parts = [(0.0, 40.0, 35e3), (40.0, 85.0, 60e3), (85.0, f64::INFINITY, 90e3)];
        let twist: f64 = parts.map(|(from, to, k)| (size.min(to) - from).max(0.0) / k).iter().sum();
        twist * spring_nm.signum()
    }

    /// Angle and acceleration of the link as functions of time.
    fn motion(&self, end_s: f64, dice: &mut Dice) -> Box<dyn Fn(f64) -> [f64; 2]> {
        if !self.has_rests {
            let waves: Vec<[f64; 3]> = [(0.31, 0.9), (0.73, 0.36), (1.7, 0.144), (3.3, 0.036)]
                .map(|(w, size)| [size, w * dice.between(0.85, 1.15), dice.between(0.0, 6.0)])
                .to_vec();
            return Box::new(move |t| {
                waves.iter().fold([0.0; 2], |[q, a], [size, w, phase]| {
                    let sin = size * (w * t + phase).sin();
                    [q + sin, a - w * w * sin]
                })
            });
        }
        let mut moves = Vec::new();
        let (mut start, mut at) = (-1.0, 0.3);
        while start < end_s + 1.0 {
            let (lasts, to) = (dice.between(0.5, 1.2), dice.between(-1.2, 1.2));
            moves.push([start, lasts, at, to]);
            (start, at) = (start + lasts + 0.4, to);
        }
        Box::new(move |t| {
            let [start, lasts, from, to] = *moves.iter().rev().find(|m| m[0] <= t).unwrap_or(&moves[0]);
            let u = ((t - start) / lasts).clamp(0.0, 1.0);
            [
                from + (to - from) * u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u),
                (to - from) * (60.0 * u - 180.0 * u * u + 120.0 * u.powi(3)) / lasts.powi(2),
            ]
        })
    }

    fn record(&self, dice: &mut Dice) -> String {
        const STEP_S: f64 = 2e-3;
        const ROWS: usize = 12_000;
        let motion = self.motion(ROWS as f64 * STEP_S, dice);
        // twist by the hysteresis from a row before the first to one after the last: the state of the spring's torque is dragged
        let [width_nm, width_rad] = self.play;
        let mut state = f64::NAN;
        let lags: Vec<f64> = (0..ROWS + 2)
            .map(|i| {
                let [q, a] = motion((i as f64 - 1.0) * STEP_S);
                let spring_nm = Self::LINK_KGM2 * a + self.gravity_nm * q.cos();
                let start = if state.is_nan() { spring_nm } else { state };
                state = start.clamp(spring_nm - width_nm, spring_nm + width_nm);
                if width_nm > 0.0 { (state - spring_nm) * width_rad / width_nm } else { 0.0 }
            })
            .collect();
        let motor = |t: f64| {
            let [q, a] = motion(t);
            let lag_rad = lags[(t / STEP_S).round() as usize + 1];
            let spring_nm = Self::LINK_KGM2 * a + self.gravity_nm * q.cos();
            let waves = [q.sin(), q.cos(), (2.0 * q).sin(), (2.0 * q).cos()];
            let error: f64 = waves.iter().zip(self.error_rad).map(|(w, e)| w * e).sum();
            (q + self.twist_rad(spring_nm) + lag_rad + error, spring_nm)
        };
        let mut out = String::from("t_s,j1_motor_deg,j1_link_deg,j1_motor_torque_nm\n");
        let mut sense = 0.0;
        for row in 0..ROWS {
            let t = row as f64 * STEP_S;
            let [before, (angle, spring_nm), after] = [t - STEP_S, t, t + STEP_S].map(&motor);
            let speed = (after.0 - before.0) / (2.0 * STEP_S);
            let acceleration = (after.0 - 2.0 * angle + before.0) / STEP_S.powi(2);
            if speed.abs() > 1e-5 {
                sense = speed.signum();
            }
            let dry_nm = Self::COULOMB_NM + self.stribeck_nm * (-(speed / 0.05).powi(2)).exp();
            let friction_nm = dry_nm * sense + Self::VISCOUS_NMS_PER_RAD * speed;
            let torque_nm = spring_nm + Self::ROTOR_KGM2 * acceleration + friction_nm;
            let link = motion(t - self.shift_s)[0];
            out += &format!(
                "{t:.6},{:.8},{:.8},{:.6}\n",
                (angle + 2e-6 * dice.normal()).to_degrees(),
                (link + 2e-6 * dice.normal()).to_degrees(),
                self.sign * torque_nm + 0.5 * dice.normal()
            );
        }
        out
    }

    /// The outcome of a campaign with one record of this joint, whose nominal stiffness is 60 000 N m/rad.
    fn outcome(&self, states_rotor: bool, dice: &mut Dice) -> Outcome {
        let folder = tempfile::tempdir().expect("a folder");
        let arm = json!({"name": "one-joint", "effects": [], "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 60e3, "mass_kg": 1.0},
            {"type": "link", "name": "l1", "vector_m": [1.0, 0, 0], "mass_kg": 1.0}]});
        let mut statement = json!({"name": "one-joint", "tolerance": {"joint_stiffness": 0.1}});
        if states_rotor {
            statement["rotor_inertia_kgm2"] = json!(Self::ROTOR_KGM2);
        }
        std::fs::write(folder.path().join("arm.json"), arm.to_string()).expect("written");
        std::fs::write(folder.path().join("campaign.json"), statement.to_string()).expect("written");
        std::fs::write(folder.path().join("record.csv"), self.record(dice)).expect("written");
        let outcome = outcome(folder.path());
        println!("{}", outcome.to_text());
        outcome
    }
}

#[test]
fn gravity_times_compliance_is_no_transmission_error() {
    for seed in 0..3 {
        let joint = Prescribed { stribeck_nm: 5.0, ..Prescribed::plain() };
        let outcome = joint.outcome(false, &mut Dice(500 + seed));
        assert!(names(&outcome).is_empty(), "{seed}: {:?}", names(&outcome));
        let (stiffness, ..) = number(&outcome.records[0], "compliance").expect("a compliance");
        // friction that rises at low speed is not in the model: three parts in a hundred of the torque
        assert!((stiffness / 60e3 - 1.0).abs() < 0.03, "{seed}: {stiffness}");
    }
}

#[test]
fn a_transmission_error_beside_gravity_is_named_with_a_compliance_near_the_truth_or_left_open() {
    let mut named = 0;
    for seed in 0..3 {
        let joint = Prescribed { error_rad: [3e-4, 0.0, 1e-4, -2e-4], ..Prescribed::plain() };
        let outcome = joint.outcome(false, &mut Dice(520 + seed));
        assert!(!names(&outcome).contains(&"lost_motion"), "{seed}");
        if !names(&outcome).contains(&"transmission_error") {
            let is_open = matches!(outcome.verdict, Verdict::InsufficientData | Verdict::Unexplained);
            assert!(is_open, "{seed}: {:?}", outcome.verdict);
            continue;
        }
        named += 1;
        let stated = outcome.records[0].of("compliance").expect("stated");
        let Some((_, list)) = stated.parameters.first() else { continue };
        // the truth is 60e3; noise of the torque biases the compliance, and its interval does not hold all of this
        assert!((45e3..80e3).contains(&list[0].value), "{seed}: {:?}", list[0]);
    }
    assert!(named >= 2, "{named} of 3");
}

#[test]
fn friction_that_stays_while_the_joint_rests_is_no_hysteresis() {
    let joint = Prescribed { has_rests: true, shift_s: 2e-3, ..Prescribed::plain() };
    for seed in 0..2 {
        let outcome = joint.outcome(false, &mut Dice(540 + seed));
        assert_eq!(names(&outcome), ["time_shift"], "{seed}");
        for (what, truth) in [("compliance", 60e3), ("coulomb_friction", 15.0), ("time_shift", 2e-3)] {
            let (value, low, high) = number(&outcome.records[0], what).expect(what);
            assert!(low <= truth && truth <= high, "{seed}: {what} {value} ({low} to {high})");
        }
    }
}

#[test]
fn viscous_friction_is_no_time_shift_where_it_is_refused_or_the_compliance_is_not_identified() {
    let reversed = Prescribed { sign: -1.0, ..Prescribed::plain() };
    let outcome = reversed.outcome(false, &mut Dice(560));
    assert!(!names(&outcome).contains(&"time_shift"), "{:?}", names(&outcome));
    let vertical = Prescribed { gravity_nm: 0.0, ..Prescribed::plain() };
    let outcome = vertical.outcome(true, &mut Dice(561));
    assert!(!names(&outcome).contains(&"time_shift"), "{:?}", names(&outcome));
}

#[test]
fn a_torsion_curve_does_not_hide_behind_a_time_shift() {
    let mut said = 0;
    for seed in 0..3 {
        let joint = Prescribed {
            has_segments: true,
            gravity_nm: 140.0,
            has_rests: true,
            shift_s: 2e-3,
            ..Prescribed::plain()
        };
        let outcome = joint.outcome(false, &mut Dice(580 + seed));
        let is_found = names(&outcome).contains(&"soft_windup");
        said += u64::from(is_found || outcome.verdict != Verdict::Explained);
    }
    // a curve that bends little against the shift stays hidden
    assert!(said >= 2, "{said} of 3");
}

#[test]
fn a_slow_vertical_axis_hides_its_compliance() {
    // the link's acceleration differs from the motor's by (0.6 Hz / 11 Hz)^2 of it, less than the noise of the torque
    let slow = Prescribed { gravity_nm: 0.0, ..Prescribed::plain() };
    let blind = slow.outcome(false, &mut Dice(720));
    let stated = blind.records[0].of("compliance").expect("stated");
    assert_eq!(stated.state, State::NotIdentified, "{}", stated.words);
    assert!(!names(&blind).contains(&"joint_compliance"));
}

#[test]
fn a_hysteresis_remembers_the_torque_while_the_joint_rests() {
    // moves from point to point: the torque has its extremes where the joint reverses or rests
    for (seed, half_width_rad) in [(600, 1e-4), (601, 2.4e-4), (602, 4e-4)] {
        let joint = Prescribed { has_rests: true, play: [18.0, half_width_rad], ..Prescribed::plain() };
        let outcome = joint.outcome(false, &mut Dice(seed));
        assert_eq!(names(&outcome), ["hysteresis"], "{seed}");
        let (width, low, high) = number(&outcome.records[0], "hysteresis").expect("a width");
        assert!(low <= half_width_rad && half_width_rad <= high, "{width} ({low} to {high})");
    }
}

#[test]
fn the_intervals_of_segments_that_the_known_rows_hardly_reach_hold() {
    // the largest torque outside of reversals is below the second break of 85 N m
    let joint = Prescribed { has_segments: true, has_rests: true, gravity_nm: 62.0, ..Prescribed::plain() };
    let outcome = joint.outcome(false, &mut Dice(610));
    let stated = outcome.records[0].found("torsion_curve").expect("a curve");
    for (name, truth) in
        [("k1_nm_per_rad", 35e3), ("k2_nm_per_rad", 60e3), ("k3_nm_per_rad", 90e3), ("t2_nm", 85.0)]
    {
        let list = &stated.parameters.iter().find(|(n, _)| n == name).expect(name).1;
        let (low, high) = (list[0].low.unwrap_or(0.0), list[0].high.unwrap_or(f64::INFINITY));
        assert!(low <= truth && truth <= high, "{name} {truth}: {:?}", list[0]);
    }
}
