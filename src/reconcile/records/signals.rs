//! Signals of one joint (angles, speeds, accelerations, torque) from all records: smoothed, differentiated, and divided
//! into blocks of time.

use super::blocks::Blocks;
use super::known::{at_jumps, rests, turning};
use super::smooth::{averaged, half_width, noise, slope, slope_noise, smooth};
use super::wave::Wave;
use crate::reconcile::readings::record::{JointSignals, Record, usual_step_s};

/// The sign of the speed changes smoothly below this fraction of the largest speed, because real friction does not jump
/// at zero speed either.
const SLOW_PART: f64 = 0.002;
/// Largest credible ratio of the root mean square accelerations on the two sides of a gear. If the ratio is larger, the
/// larger acceleration is taken for an error of the gear or its sensor and not for a motion of the joint.
const RESTLESS: f64 = 1.2;
/// Smallest number of blocks of time into which one record is divided, so that the result for a record does not depend
/// on one block.
const FEWEST_BLOCKS: usize = 4;

/// One row of one record for one joint, with smoothed values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    /// Index of the record among those that have the joint.
    pub record: usize,
    /// Index of the row in the record.
    pub row: usize,
    /// Index of the block of time to which the row belongs, counted over all records.
    pub block: usize,
    /// Angle of the motor at the output \[rad\].
    pub angle_rad: f64,
    /// `sin x`, `cos x - 1`, `sin 2x` and `cos 2x - 1` of the motor's own angle `x`, averaged over the window. The
    /// angle `x` is the angle at the output times the gear ratio. All zero if the ratio is not stated.
    pub input_waves: [f64; 4],
    /// Speed of the motor at the output \[rad/s\].
    pub speed_rad_s: f64,
    /// Acceleration of the motor at the output \[rad/s²\].
    pub acceleration_rad_s2: f64,
    /// Smoothed sign of the motor's speed, from -1 to 1. It passes through zero where the joint reverses or rests.
    pub sense: f64,
    /// Whether the joint rests, so that the friction is unknown. The row still counts for the state of a hysteresis.
    pub rests: bool,
    /// Whether the joint reverses, so that the friction is unknown.
    pub turns: bool,
    /// Whether the torque jumps between two rows of the averaging window, so that its average is not known.
    pub jumps: bool,
    /// Torque of the load that the gear carries \[N m\]; 0 until [`JointRows::take_load`].
    pub load_nm: f64,
    /// [`Sample::sense`] times the magnitude of `load_nm` \[N m\]; 0 until [`JointRows::take_load`].
    pub load_sense_nm: f64,
    /// Torque of the motor at the output \[N m\]; 0 if it is not recorded.
    pub torque_nm: f64,
    /// Rate of change of the motor's torque at the output \[N m/s\]; 0 if the torque is not recorded.
    pub torque_rate_nm_s: f64,
}

impl Sample {
    /// Whether torque and friction are known at this row. Other rows enter no fit of the twist.
    pub(crate) fn is_known(&self) -> bool {
        !self.rests && !self.turns && !self.jumps
    }
}

/// Signals of one joint in one record, row by row. Angles and speed are averaged over a window; NaN near ends and gaps.
struct Signals {
    t_s: Vec<f64>,
    motor_rad: Vec<f64>,
    link_rad: Vec<f64>,
    link_speed_rad_s: Vec<f64>,
    link_acceleration_rad_s2: Vec<f64>,
    step_s: f64,
    /// Half width of the window over which all signals are averaged \[rows\].
    half: usize,
    /// Standard deviation of the noise of the twist from row to row, before averaging \[rad\].
    noise_rad: f64,
    /// Standard deviation of the noise of the torque from row to row, before averaging \[N m\].
    torque_noise_nm: f64,
    /// Standard deviation of the noise after averaging, as a fraction of that before.
    gain: f64,
}

/// Rows of one joint from all records that have the angles on both sides of its gear.
pub(crate) struct JointRows {
    /// Name of the joint.
    pub joint: String,
    /// Turns of the motor for one turn of the output; `None` if not stated.
    pub ratio: Option<f64>,
    /// Inertia of the rotor, referred to the output \[kg m²\]; `None` if not stated.
    pub rotor_inertia_kgm2: Option<f64>,
    /// Whether all records contain the torque of the motor.
    pub has_torque: bool,
    /// Rows at which speed, torque and the smoothed angle of the link are known.
    pub samples: Vec<Sample>,
    /// Number of blocks of time in all records together.
    pub blocks: usize,
    /// Usual time between two rows of the first record \[s\].
    pub step_s: f64,
    /// Root mean square accelerations of motor (first) and link (second) over the rows at which the joint does not rest
    /// \[rad/s²\].
    accelerations_rad_s2: [f64; 2],
    records: Vec<Signals>,
}

/// Twist of a joint at one row, if the link's signal is late by an assumed time (delay), and the speed of the link.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Twist {
    /// Angle of the motor at the output minus angle of the link \[rad\].
    pub twist_rad: f64,
    /// Speed of the link \[rad/s\]; it is minus the derivative of the twist with respect to the delay.
    pub link_speed_rad_s: f64,
}

impl JointRows {
    /// Gathers the rows of a joint from all records that have the angles on both sides of its gear. The rows are
    /// divided into about `blocks` blocks of time. The transmission error `wave`, which repeats with the turns of the
    /// motor, is removed before signals are differentiated. `None` if no record has both angles.
    pub(crate) fn gather(records: &[Record], joint: &str, blocks: usize, wave: &Wave) -> Option<Self> {
        let whole = |j: &&JointSignals| j.joint == joint && !j.link_rad.is_empty();
        let own: Vec<(&Record, &JointSignals)> =
            records.iter().filter_map(|r| Some((r, r.joints.iter().find(whole)?))).collect();
        let first = own.first()?.1;
        let has_torque = own.iter().all(|(_, j)| !j.torque_nm.is_empty());
        let total: usize = own.iter().map(|(r, _)| r.t_s.len()).sum();
        let mut out = Self {
            joint: joint.into(),
            ratio: first.ratio,
            rotor_inertia_kgm2: first.rotor_inertia_kgm2,
            has_torque,
            samples: Vec::new(),
            blocks: 0,
            step_s: usual_step_s(&own[0].0.t_s),
            accelerations_rad_s2: [0.0; 2],
            records: Vec::new(),
        };
        for (record, signals) in own {
            let share = (blocks * record.t_s.len()) as f64 / total as f64;
            out.push(&record.t_s, signals, (share.round() as usize).max(FEWEST_BLOCKS), wave);
        }
        out.accelerations_rad_s2 = out.rms_accelerations();
        Some(out)
    }

    /// Root mean square accelerations of motor and link over the rows at which the joint does not rest \[rad/s²\].
    fn rms_accelerations(&self) -> [f64; 2] {
        let of_link = |s: &Sample| self.records[s.record].link_acceleration_rad_s2[s.row];
        let mean = |of: &dyn Fn(&Sample) -> f64| {
            let moving = self.samples.iter().filter(|s| !s.rests);
            let (sum, count) = moving.fold((0.0, 0usize), |(sum, n), s| (sum + of(s).powi(2), n + 1));
            (sum / count.max(1) as f64).sqrt()
        };
        [mean(&|s| s.acceleration_rad_s2), mean(&of_link)]
    }

    /// Accelerations of motor and link at the row `sample` \[rad/s²\], if the link's signal is late by `shift_s` \[s\].
    /// If one side of the gear has a much larger root mean square acceleration than the other, a transmission error
    /// within a turn of the motor is the cause. The acceleration of the other side is then used for both. `None` beyond
    /// the ends of the record and at gaps.
    pub(crate) fn accelerations(&self, sample: &Sample, shift_s: f64) -> Option<[f64; 2]> {
        let both = [sample.acceleration_rad_s2, self.link(sample, shift_s)?[1]];
        let [motor, link] = self.accelerations_rad_s2;
        Some(match () {
            () if motor > RESTLESS * link => [both[1]; 2],
            () if link > RESTLESS * motor => [both[0]; 2],
            () => both,
        })
    }

    /// At which rows friction or torque is not known, as three lists: whether the joint rests, whether it reverses, and
    /// whether the torque jumps. All `false` in records without torque. `sense` is the smoothed sign of the speed, and
    /// `half` the half width of the averaging window \[rows\].
    fn unknown_rows(&self, sense: &[f64], torque_nm: &[f64], half: usize) -> [Vec<bool>; 3] {
        if !self.has_torque {
            return std::array::from_fn(|_| vec![false; sense.len()]);
        }
        let rests = rests(sense, half);
        let turns = turning(sense, &rests);
        [rests, turns, at_jumps(torque_nm, half)]
    }

    /// Smooths the signals of one record, divides the rows into `blocks` blocks of time and adds them to `self`. The
    /// blocks have equal numbers of rows in which the joint does not rest.
    fn push(&mut self, t_s: &[f64], signals: &JointSignals, blocks: usize, wave: &Wave) {
        // a transmission error within a turn of the motor is in the signal of one side only; if it stayed there, the
        // window for that side would come out too narrow
        let [calm_motor_rad, calm_link_rad] = wave.taken_from(signals);
        let half = half_width(t_s, &calm_motor_rad).max(half_width(t_s, &calm_link_rad));
        let motor = smooth(t_s, &calm_motor_rad, half);
        let link_acceleration_rad_s2 = smooth(t_s, &calm_link_rad, half).curvature;
        let sign = senses(&motor.slope, slope_noise(t_s, &calm_motor_rad, half));
        let none = vec![0.0; t_s.len()];
        let torque_nm = if self.has_torque { &signals.torque_nm } else { &none };
        let ([motor_rad, link_rad, calm_motor_rad, calm_link_rad, torque, sense], gain) = averaged(
            t_s,
            half,
            [&signals.motor_rad, &signals.link_rad, &calm_motor_rad, &calm_link_rad, torque_nm, &sign],
        );
        let input_waves = input_waves(t_s, signals, half);
        let (speed_rad_s, torque_rate_nm_s) = (slope(t_s, &calm_motor_rad), slope(t_s, &torque));
        let of_link = Signals {
            t_s: t_s.to_vec(),
            motor_rad,
            link_rad,
            link_speed_rad_s: slope(t_s, &calm_link_rad),
            link_acceleration_rad_s2,
            step_s: usual_step_s(t_s),
            half,
            noise_rad: twist_noise_rad(t_s, signals),
            torque_noise_nm: noise(t_s, torque_nm),
            gain,
        };
        let record = self.records.len();
        let [rests, turns, jumps] = self.unknown_rows(&sense, torque_nm, half);
        let moving_rows = rests.iter().filter(|rests| !**rests).count();
        let mut moved = 0;
        for row in 0..t_s.len() {
            moved += usize::from(!rests[row]);
            let sample = Sample {
                record,
                row,
                block: self.blocks + moved.saturating_sub(1) * blocks / moving_rows,
                angle_rad: signals.motor_rad[row],
                input_waves: std::array::from_fn(|k| input_waves[k][row]),
                speed_rad_s: speed_rad_s[row],
                acceleration_rad_s2: motor.curvature[row],
                sense: sense[row],
                rests: rests[row],
                turns: turns[row],
                jumps: jumps[row],
                load_nm: 0.0,
                load_sense_nm: 0.0,
                torque_nm: torque[row],
                torque_rate_nm_s: torque_rate_nm_s[row],
            };
            // a slope needs the averages of the rows before and after, so it is missing at one more row at each end
            if !(sample.speed_rad_s.is_nan() || of_link.link_speed_rad_s[row].is_nan()) {
                self.samples.push(sample);
            }
        }
        self.blocks += blocks;
        self.records.push(of_link);
    }

    /// Half width of the window over which the signals of the record with the index `record` are averaged \[rows\].
    pub(crate) fn half(&self, record: usize) -> usize {
        self.records[record].half
    }

    /// Stores `load_nm`, the torque of the load that the gear carries \[N m\], one value for each sample. Two things
    /// need it: friction that grows with the load, and the torque of the spring at rows where friction is not known.
    pub(crate) fn take_load(&mut self, load_nm: &[f64]) {
        for (sample, load_nm) in self.samples.iter_mut().zip(load_nm) {
            sample.load_nm = *load_nm;
            sample.load_sense_nm = sample.sense * load_nm.abs();
        }
    }

    /// Root mean square of the motor's speed at the output over the known rows \[rad/s\].
    pub(crate) fn rms_speed_rad_s(&self) -> f64 {
        let known = self.samples.iter().filter(|s| s.is_known());
        let sum: f64 = known.map(|s| s.speed_rad_s.powi(2)).sum();
        (sum / self.known_rows().max(1) as f64).sqrt()
    }

    /// Number of rows at which torque and friction are known.
    pub(crate) fn known_rows(&self) -> usize {
        self.samples.iter().filter(|s| s.is_known()).count()
    }

    /// Number of records.
    pub(crate) fn record_count(&self) -> usize {
        self.records.len()
    }

    /// Twist at the row `sample` if the link's signal is late by `shift_s` \[s\]. The link's angle is then read later
    /// by this delay, from a second-order Taylor series about the row nearest to the later time. `None` beyond the ends
    /// of the record and across gaps.
    pub(crate) fn twist(&self, sample: &Sample, shift_s: f64) -> Option<Twist> {
        let signals = &self.records[sample.record];
        let steps = (shift_s / signals.step_s).round() as isize;
        let row = sample.row.checked_add_signed(steps).filter(|r| *r < signals.t_s.len())?;
        let rest_s = signals.t_s[sample.row] + shift_s - signals.t_s[row];
        let (slope, curvature) = (signals.link_speed_rad_s[row], signals.link_acceleration_rad_s2[row]);
        // if the later time is in a gap of the record, no row is near to it
        if slope.is_nan() || rest_s.abs() > 1.5 * signals.step_s {
            return None;
        }
        let link_rad = signals.link_rad[row] + rest_s * slope + 0.5 * rest_s.powi(2) * curvature;
        let twist_rad = signals.motor_rad[sample.row] - link_rad;
        Some(Twist { twist_rad, link_speed_rad_s: slope + rest_s * curvature })
    }

    /// Angle \[rad\] and acceleration \[rad/s²\] of the link at the row `sample` if the link's signal is late by
    /// `shift_s` \[s\]. Both are interpolated between rows, because an error of the time by half a row would be taken
    /// for viscous friction. `None` beyond the ends of the record and at gaps.
    pub(crate) fn link(&self, sample: &Sample, shift_s: f64) -> Option<[f64; 2]> {
        let signals = &self.records[sample.record];
        let place = sample.row as f64 + shift_s / signals.step_s;
        let (row, part) = (place.floor(), place - place.floor());
        if row < 0.0 || row as usize + 1 >= signals.t_s.len() {
            return None;
        }
        let between = |x: &[f64]| x[row as usize] * (1.0 - part) + x[row as usize + 1] * part;
        let out = [between(&signals.link_rad), between(&signals.link_acceleration_rad_s2)];
        (!out[0].is_nan()).then_some(out)
    }

    /// Standard deviation of the noise of the twist from row to row, before averaging, as a root mean square over the
    /// records \[rad\].
    pub(crate) fn noise_rad(&self) -> f64 {
        let squares: f64 = self.records.iter().map(|r| r.noise_rad.powi(2)).sum();
        (squares / self.records.len() as f64).sqrt()
    }

    /// Standard deviation of the noise of the averaged twist, as a root mean square over the records \[rad\].
    pub(crate) fn averaged_noise_rad(&self) -> f64 {
        let squares: f64 = self.records.iter().map(|r| (r.gain * r.noise_rad).powi(2)).sum();
        (squares / self.records.len() as f64).sqrt()
    }

    /// Standard deviation of the noise of the averaged torque, as a root mean square over the records \[N m\].
    pub(crate) fn averaged_torque_noise_nm(&self) -> f64 {
        let squares: f64 = self.records.iter().map(|r| (r.gain * r.torque_noise_nm).powi(2)).sum();
        (squares / self.records.len() as f64).sqrt()
    }

    /// Smallest and largest angle of the motor at the output \[rad\].
    pub(crate) fn range_rad(&self) -> (f64, f64) {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        self.samples.iter().fold(ends, |(low, high), s| (low.min(s.angle_rad), high.max(s.angle_rad)))
    }

    /// Sums of the products of every two of `width` columns over all rows, one matrix per block. `fill` writes the
    /// columns of the sample with the given index and returns whether the row is used.
    pub(crate) fn sums(&self, width: usize, fill: impl Fn(usize, &Sample, &mut [f64]) -> bool) -> Blocks {
        let block_of = |i: usize| self.samples[i].block;
        Blocks::new(self.samples.len(), width, block_of, |i, row| fill(i, &self.samples[i], row))
    }
}

/// Standard deviation of the noise of the twist \[rad\]. It is computed from the difference of the two angles, because
/// an error of the recorded times changes both angles equally and cancels in the difference.
fn twist_noise_rad(t_s: &[f64], signals: &JointSignals) -> f64 {
    let angles = signals.motor_rad.iter().zip(&signals.link_rad);
    noise(t_s, &angles.map(|(motor, link)| motor - link).collect::<Vec<_>>())
}

/// Sign of the speed at each row, from -1 to 1; zero where the speed is not known. It changes smoothly between opposite
/// speeds of about [`SLOW_PART`] of the largest speed, or of twice the noise of the speed `noise_rad_s`, if that is
/// more.
fn senses(speed_rad_s: &[f64], noise_rad_s: f64) -> Vec<f64> {
    let fastest = speed_rad_s.iter().filter(|w| !w.is_nan()).fold(0.0f64, |m, w| m.max(w.abs()));
    let slow = (SLOW_PART * fastest).max(2.0 * noise_rad_s).max(f64::MIN_POSITIVE);
    speed_rad_s.iter().map(|w| if w.is_nan() { 0.0 } else { libm::tanh(w / slow) }).collect()
}

/// `sin x`, `cos x - 1`, `sin 2x` and `cos 2x - 1` of the motor's own angle `x`, one list each with one value per row.
/// They are averaged over the window like the other signals, because they vary fast. Zero if the gear ratio is not
/// stated.
fn input_waves(t_s: &[f64], signals: &JointSignals, half: usize) -> [Vec<f64>; 4] {
    let Some(ratio) = signals.ratio else { return std::array::from_fn(|_| vec![0.0; t_s.len()]) };
    let mut waves: [Vec<f64>; 4] = std::array::from_fn(|_| Vec::with_capacity(t_s.len()));
    for angle_rad in &signals.motor_rad {
        for (column, value) in waves.iter_mut().zip(waves_of(ratio * angle_rad)) {
            column.push(value);
        }
    }
    averaged(t_s, half, waves.each_ref().map(Vec::as_slice)).0
}

/// `sin x`, `cos x - 1`, `sin 2x` and `cos 2x - 1` of the angle `x` \[rad\]. All are zero at `x = 0`, so that they do
/// not compete with the offset of a record.
pub(crate) fn waves_of(angle_rad: f64) -> [f64; 4] {
    let (sin, cos) = libm::sincos(angle_rad);
    [sin, cos - 1.0, 2.0 * sin * cos, cos * cos - sin * sin - 1.0]
}
