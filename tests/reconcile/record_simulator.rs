//! A simulator of one driven joint against time, which uses nothing of the library. It has a motor, a spring with
//! friction play or a stiffening curve, a link under gravity, friction on the motor's side, a controller that follows a
//! reference, and encoders with noise, resolution and a delay.
//!
//! Without play, the equations are `J_m q_m'' = T - T_s - friction(q_m', T_s)`, `J_l q_l'' = T_s - m g l sin q_l` and
//! `T_s = k (q_m - q_l)`. They are integrated by the classical Runge-Kutta method of fourth order.

use super::generator::Dice;
use std::fmt::Write;

/// What the joint is. All numbers at the output.
#[derive(Debug, Clone)]
pub struct Joint {
    pub stiffness_nm_per_rad: f64,
    /// Stiffness below a torque, if the gear is softer there: the torque, and the stiffness.
    pub soft: Option<(f64, f64)>,
    /// Half width of friction play [rad].
    pub play_rad: f64,
    pub motor_inertia_kgm2: f64,
    pub link_inertia_kgm2: f64,
    /// m g l [N m]; 0 for a vertical axis.
    pub gravity_nm: f64,
    pub coulomb_nm: f64,
    pub viscous_nms_per_rad: f64,
    pub load_friction: f64,
    /// Transmission error once a turn of the output: amplitude of the sine [rad].
    pub error_rad: f64,
    /// Transmission error once a turn of the input [rad].
    pub input_error_rad: f64,
    pub ratio: f64,
    /// By how much the link's reading is late [s].
    pub shift_s: f64,
}

/// How it is moved and read.
#[derive(Debug, Clone)]
pub struct Test {
    pub rows: usize,
    pub step_s: f64,
    pub amplitude_rad: f64,
    pub noise_rad: f64,
    pub resolution_rad: f64,
    pub torque_noise_nm: f64,
    /// The motor stops after this part of the rows.
    pub moving_part: f64,
    /// Whether the motion goes from point to point with a trapezoid of the speed, instead of a sum of sines. The controller feeds
    /// the jumps of the acceleration forward.
    pub has_corners: bool,
}

impl Joint {
    /// A joint with random but sensible numbers and no peculiarities.
    pub fn random(dice: &mut Dice) -> Self {
        let k = 2e4 * 15f64.powf(dice.uniform());
        let link = k / (std::f64::consts::TAU * dice.between(5.0, 14.0)).powi(2);
        Self {
            stiffness_nm_per_rad: k,
            soft: None,
            play_rad: 0.0,
            motor_inertia_kgm2: link * dice.between(0.15, 0.8),
            link_inertia_kgm2: link,
            gravity_nm: k * dice.between(0.6e-3, 2.5e-3),
            coulomb_nm: k * dice.between(0.5e-4, 3e-4),
            viscous_nms_per_rad: k * dice.between(0.5e-4, 4e-4),
            load_friction: 0.0,
            error_rad: 0.0,
            input_error_rad: 0.0,
            ratio: 100.0,
            shift_s: dice.between(-4e-3, 4e-3),
        }
    }

    fn spring_nm(&self, twist_rad: f64) -> f64 {
        match self.soft {
            None => self.stiffness_nm_per_rad * twist_rad,
            Some((torque_nm, soft)) => {
                let edge = torque_nm / soft;
                let inside = twist_rad.clamp(-edge, edge);
                soft * inside + self.stiffness_nm_per_rad * (twist_rad - inside)
            }
        }
    }
}

/// Angle and speed of the reference: a sum of sines that begins and ends at rest.
fn reference(t: f64, end: f64, waves: &[(f64, f64, f64)], amplitude: f64) -> f64 {
    let ease = |x: f64| {
        if x <= 0.0 {
            0.0
        } else if x >= 1.0 {
            1.0
        } else {
            x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
        }
    };
    let window = ease(t / 0.8) * ease((end - t) / 0.8);
    let sum: f64 = waves.iter().map(|(size, w, phase)| size * (w * t + phase).sin()).sum();
    amplitude * window * sum
}

/// Angle, speed and acceleration of moves from point to point, each with a trapezoid of the speed.
fn corners(t: f64, amplitude: f64) -> [f64; 3] {
    const LASTS_S: f64 = 1.4;
    const RISES: f64 = 0.15;
    let move_ = (t / LASTS_S).floor();
    let end = |n: f64| if n < 0.0 { 0.0 } else { amplitude * (2.4 * n + 1.0).sin() };
    let (from, to, u) = (end(move_ - 1.0), end(move_), t / LASTS_S - move_);
    let peak = 1.0 / (1.0 - RISES);
    let rising = |u: f64| [0.5 * peak * u * u / RISES, peak * u / RISES, peak / RISES];
    let [x, w, a] = match u {
        u if u < RISES => rising(u),
        u if u > 1.0 - RISES => {
            let [x, w, a] = rising(1.0 - u);
            [1.0 - x, w, -a]
        }
        u => [peak * (u - 0.5 * RISES), peak, 0.0],
    };
    [from + (to - from) * x, (to - from) * w / LASTS_S, (to - from) * a / LASTS_S.powi(2)]
}

impl Joint {
    fn rates(&self, q: [f64; 4], bristle_rad: f64, motor_nm: f64) -> [f64; 4] {
        let spring = self.spring_nm(q[0] - q[2]) + self.stiffness_nm_per_rad * bristle_rad;
        let friction = (self.coulomb_nm + self.load_friction * spring.abs()) * (q[1] / 2e-4).tanh()
            + self.viscous_nms_per_rad * q[1];
        let link_damping = 0.01 * (self.stiffness_nm_per_rad * self.link_inertia_kgm2).sqrt();
        let relative = link_damping * (q[1] - q[3]);
        [
            q[1],
            (motor_nm - spring - friction - relative) / self.motor_inertia_kgm2,
            q[3],
            (spring + relative - self.gravity_nm * q[2].sin()) / self.link_inertia_kgm2,
        ]
    }
}

/// Writes `record.csv` of a joint `j1` that was moved.
pub fn record(joint: &Joint, test: &Test, dice: &mut Dice) -> String {
    let waves: Vec<(f64, f64, f64)> = (0..5)
        .map(|i| {
            let hz = [0.13, 0.31, 0.57, 0.93, 1.41][i] * dice.between(0.85, 1.15);
            let size = [1.0, 0.5, 0.25, 0.12, 0.06][i];
            (size, std::f64::consts::TAU * hz, dice.between(0.0, std::f64::consts::TAU))
        })
        .collect();
    let end = test.rows as f64 * test.step_s;
    let moving = end * test.moving_part;
    let substeps = 16;
    let h = test.step_s / substeps as f64;
    let (mut q, mut bristle_rad) = ([0.0; 4], 0.0);
    let gain = 4.0 * joint.stiffness_nm_per_rad;
    let damping = 2.0 * 0.7 * (gain * joint.motor_inertia_kgm2).sqrt();
    // rows of (motor, link, torque), finer than the record so that a delay need not be a whole row
    let mut fine: Vec<(f64, f64, f64)> = Vec::new();
    for i in 0..test.rows * substeps {
        let t = i as f64 * h;
        let target = reference(t, moving, &waves, test.amplitude_rad);
        let speed = (reference(t + 1e-5, moving, &waves, test.amplitude_rad) - target) / 1e-5;
        let (mut target, mut speed, mut acceleration) = (target, speed, 0.0);
        if test.has_corners {
            [target, speed, acceleration] = corners(t, test.amplitude_rad);
        }
        let whole_kgm2 = joint.motor_inertia_kgm2 + joint.link_inertia_kgm2;
        let feed = joint.gravity_nm * target.sin() + whole_kgm2 * acceleration;
        let motor_nm = feed + gain * (target - q[0]) + damping * (speed - q[1]);
        fine.push((q[0], q[2], motor_nm));
        let step =
            |q: [f64; 4], k: [f64; 4], by: f64| -> [f64; 4] { std::array::from_fn(|n| q[n] + by * k[n]) };
        let k1 = joint.rates(q, bristle_rad, motor_nm);
        let k2 = joint.rates(step(q, k1, 0.5 * h), bristle_rad, motor_nm);
        let k3 = joint.rates(step(q, k2, 0.5 * h), bristle_rad, motor_nm);
        let k4 = joint.rates(step(q, k3, h), bristle_rad, motor_nm);
        q = std::array::from_fn(|n| q[n] + h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]));
        // friction play: a bristle twenty times as stiff as the spring takes up the change of twist until it slips
        let before = fine[fine.len() - 1];
        let change = (q[0] - q[2]) - (before.0 - before.1);
        bristle_rad = (bristle_rad + 20.0 * change).clamp(-joint.play_rad, joint.play_rad);
    }
    sampled(joint, test, &fine, substeps, dice)
}

fn sampled(joint: &Joint, test: &Test, fine: &[(f64, f64, f64)], substeps: usize, dice: &mut Dice) -> String {
    let mut out = String::from("t_s,j1_motor_deg,j1_link_deg,j1_motor_torque_nm\n");
    let round = |x: f64| (x / test.resolution_rad).round() * test.resolution_rad;
    let back = joint.shift_s / test.step_s * substeps as f64;
    for row in 0..test.rows {
        let at = row * substeps;
        let place = (at as f64 - back).clamp(0.0, fine.len() as f64 - 2.0);
        let (low, part) = (place.floor() as usize, place.fract());
        let link = fine[low].1 * (1.0 - part) + fine[low + 1].1 * part;
        // the motor's angle, as its encoder over the ratio says, contains the errors of the gear
        let q = fine[at].0;
        let motor = q + joint.error_rad * q.sin() + joint.input_error_rad * (joint.ratio * q).sin();
        let _ = writeln!(
            out,
            "{:.6},{:.8},{:.8},{:.6}",
            row as f64 * test.step_s,
            round(motor + test.noise_rad * dice.normal()).to_degrees(),
            round(link + test.noise_rad * dice.normal()).to_degrees(),
            fine[at].2 + test.torque_noise_nm * dice.normal()
        );
    }
    out
}
