//! The speed of a joint at the ends of the phases of a duty that the study states in numbers.
//!
//! A study states the mean speed of every phase. In a phase, the joint turns at constant speed or its speed changes
//! evenly. The speeds at the ends of the phases are found in one of two ways:
//!
//! - *One course without a jump.* The speed is followed once through the cycle. It starts with a phase at rest or, if
//!   there is none, with the fastest phase. The speed must not become negative, and not exceed the speed of the fastest
//!   phase. It must not fall in a phase that follows directly after a phase in which it rises. At the end of the cycle
//!   it must be back at its first value.
//! - *Phase by phase*, if there is no such course. A phase is a ramp if its mean speed is the mean of the speeds of its
//!   two neighbours. A neighbour is itself a ramp to or from rest if its speed is half the speed of the phase beyond
//!   it. On the side of such a neighbour, the phase may begin or end at rest. Every other phase has constant speed.

use super::question::AskedDutyPhase;

/// Two speeds count as the same if they differ by at most this fraction of the larger one, because printed speeds have
/// few digits.
const ROUNDED: f64 = 0.05;

/// The course of the speed in one phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Course {
    /// Speed at the beginning of the phase \[rpm\].
    pub from_rpm: f64,
    /// Speed at the end of the phase \[rpm\].
    pub to_rpm: f64,
    time_s: f64,
}

impl Course {
    /// Change of the speed in a second \[rpm/s\]; 0 in a phase without duration.
    pub(super) fn rpm_per_s(&self) -> f64 {
        if self.time_s > 0.0 { (self.to_rpm - self.from_rpm) / self.time_s } else { 0.0 }
    }

    /// Change of the speed if the phase takes no time \[rpm\], else 0.
    pub(super) fn change_at_once_rpm(&self) -> f64 {
        if self.time_s > 0.0 { 0.0 } else { (self.to_rpm - self.from_rpm).abs() }
    }

    fn mean_rpm(&self) -> f64 {
        0.5 * (self.from_rpm + self.to_rpm)
    }
}

/// Whether two printed speeds may be the same.
pub(super) fn is_same_speed(a_rpm: f64, b_rpm: f64) -> bool {
    (a_rpm - b_rpm).abs() <= ROUNDED * a_rpm.max(b_rpm)
}

/// The course of the speed in every phase of a duty: one course without a jump if there is one, otherwise phase by
/// phase.
pub(super) fn courses(duty: &[AskedDutyPhase]) -> Vec<Course> {
    unbroken(duty).unwrap_or_else(|| (0..duty.len()).map(|place| by_neighbours(duty, place)).collect())
}

/// The course without a jump, one entry for each phase; `None` if there is none.
fn unbroken(duty: &[AskedDutyPhase]) -> Option<Vec<Course>> {
    let slowest_first = |a: &&usize, b: &&usize| duty[**a].speed_rpm.total_cmp(&duty[**b].speed_rpm);
    let places: Vec<usize> = (0..duty.len()).collect();
    let fastest_rpm = duty[*places.iter().max_by(slowest_first)?].speed_rpm;
    let at = |rpm: f64| places.iter().position(|place| duty[*place].speed_rpm == rpm);
    let begin = at(0.0).or_else(|| at(fastest_rpm))?;
    let mut courses = Vec::new();
    let mut from_rpm = duty[begin].speed_rpm;
    for step in 0..duty.len() {
        let [phase, next] = [step, step + 1].map(|step| duty[(begin + step) % duty.len()]);
        let ends_rpm = [from_rpm, next.speed_rpm, 0.0, 2.0 * phase.speed_rpm - from_rpm];
        let course = |to_rpm: f64| Course { from_rpm, to_rpm, time_s: phase.time_s };
        let fits = |course: &Course| is_same_speed(course.mean_rpm(), phase.speed_rpm);
        let found = ends_rpm.map(course).into_iter().find(fits)?;
        let is_stated = found.to_rpm <= fastest_rpm || is_same_speed(found.to_rpm, fastest_rpm);
        let rose = courses.last().is_some_and(|last: &Course| last.to_rpm > last.from_rpm);
        if found.to_rpm < 0.0 || !is_stated || rose && found.to_rpm < found.from_rpm {
            return None;
        }
        from_rpm = found.to_rpm;
        courses.push(found);
    }
    courses.rotate_right(begin);
    is_same_speed(from_rpm, duty[begin].speed_rpm).then_some(courses)
}

/// The course of the speed in the phase at `place`, derived from the speeds of the neighbouring phases alone.
fn by_neighbours(duty: &[AskedDutyPhase], place: usize) -> Course {
    let rpm = |offset: usize| duty[(place + offset) % duty.len()].speed_rpm;
    let back = |steps: usize| rpm(duty.len() * steps - steps);
    let own = duty[place];
    let mut between = vec![(back(1), rpm(1))];
    if is_same_speed(2.0 * back(1), back(2)) {
        between.push((0.0, rpm(1)));
    }
    if is_same_speed(2.0 * rpm(1), rpm(2)) {
        between.push((back(1), 0.0));
    }
    let ramps = between.into_iter().filter(|(from, to)| !is_same_speed(*from, *to));
    let mut courses = ramps.map(|(from_rpm, to_rpm)| Course { from_rpm, to_rpm, time_s: own.time_s });
    let steady = Course { from_rpm: own.speed_rpm, to_rpm: own.speed_rpm, time_s: own.time_s };
    courses.find(|course| is_same_speed(course.mean_rpm(), own.speed_rpm)).unwrap_or(steady)
}
