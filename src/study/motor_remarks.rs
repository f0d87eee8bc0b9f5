//! Remarks on motors that pass their checks and still cannot do what a reader may take for granted. They exclude no
//! design.

use super::picked::options_of_picks;
use super::table::{DrivenJoint, driven_joints, sizing_rows};
use crate::catalog::Catalogs;
use crate::report::front_table::FrontTable;
use crate::report::number::{fixed, significant};
use crate::sizing::motor_stop::MotorStop;
use crate::sizing::sheet::JointSizingRow;
use crate::space::problem::ArmProblem;

/// The motor of a joint that cannot make the emergency stop of its joint by itself.
struct TooWeak {
    joint: String,
    motor: String,
    stop: MotorStop,
}

impl TooWeak {
    /// The peak torque as a share of what the stop asks.
    fn share(&self) -> f64 {
        self.stop.peak_nm / self.stop.asked_nm
    }

    fn words(&self) -> String {
        let [asked, peak] = [self.stop.asked_nm, self.stop.peak_nm].map(|nm| significant(nm, 3));
        format!("{} ({}) {asked} N m, peak {peak}", self.joint, self.motor)
    }
}

/// The motors that cannot make the emergency stop of their joints in the design with the options `chosen`, one for each
/// level, tip first. A design that breaks a limit has none.
fn too_weak(problem: &ArmProblem, catalogs: &Catalogs, chosen: &[u32]) -> Vec<TooWeak> {
    let driven = driven_joints(problem, catalogs, chosen).unwrap_or_default();
    let of_joint = |joint: &DrivenJoint| {
        // a blank rating is named by another remark: the check of the motor's peak needs the same ratings
        let stop = MotorStop::of(&joint.drive, &joint.motion, &joint.demand).ok().flatten()?;
        let name = problem.space().pieces[joint.piece].name().to_string();
        let found = TooWeak { joint: name, motor: joint.drive.motor.id.clone(), stop };
        stop.is_too_much().then_some(found)
    };
    driven.iter().filter_map(of_joint).collect()
}

/// A sentence on the motors `all`. Of each joint it names the motor with the smallest share of what the stop asks.
/// `whose` are words that say which designs were examined. `None` if there are no such motors.
fn stop_sentence(all: Vec<TooWeak>, whose: &str) -> Option<String> {
    let mut worst: Vec<TooWeak> = Vec::new();
    for found in all {
        match worst.iter_mut().find(|known| known.joint == found.joint) {
            Some(known) if found.share() < known.share() => *known = found,
            Some(_) => {}
            None => worst.push(found),
        }
    }
    let named: Vec<String> = worst.iter().map(TooWeak::words).collect();
    (!named.is_empty()).then(|| {
        format!(
            "An emergency stop asks more than the peak torque of these motors {whose}, although the losses of the gears help: {}; \
             such a joint stops more slowly than asked or needs a brake (this excludes no design).",
            named.join("; ")
        )
    })
}

/// The remark on the motors that cannot make the emergency stop of their joints in one design, whose options are
/// `chosen`; `None` if there are none. `whose` are words that say which cases were examined.
pub(super) fn stop_remark_on(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    chosen: &[u32],
    whose: &str,
) -> Option<String> {
    stop_sentence(too_weak(problem, catalogs, chosen), whose)
}

/// The remark on the motors that cannot make the emergency stop of their joints in the picks of a front; `None` if there
/// are none.
pub(super) fn stop_remark(problem: &ArmProblem, catalogs: &Catalogs, front: &FrontTable) -> Option<String> {
    let picked = options_of_picks(problem, front);
    let all = picked.iter().flat_map(|chosen| too_weak(problem, catalogs, chosen));
    stop_sentence(all.collect(), "in the sizing cases of the picks")
}

/// The motor of a joint that overheats if its gear has the representative efficiency.
struct TooHot {
    joint: String,
    motor: String,
    efficiency: f64,
    margin: f64,
}

impl TooHot {
    /// `None` if the row states no such margin, or one of at least 1.
    fn of(row: &JointSizingRow) -> Option<Self> {
        let margin = row.motor_rms_margin_at_cycle_efficiency.filter(|margin| *margin < 1.0)?;
        let [joint, motor] = [&row.joint, &row.motor].map(String::clone);
        Some(Self { joint, motor, efficiency: row.cycle_efficiency?, margin })
    }

    fn words(&self) -> String {
        let [margin, efficiency] = [self.margin, self.efficiency].map(|x| fixed(x, 2));
        format!("{} ({}) margin {margin} at efficiency {efficiency}", self.joint, self.motor)
    }
}

/// A sentence on the motors `all`. Of each joint it names the motor with the smallest margin. `whose` are words that say
/// which designs were examined. `None` if there are no such motors.
fn heat_sentence(all: impl Iterator<Item = TooHot>, whose: &str) -> Option<String> {
    let mut worst: Vec<TooHot> = Vec::new();
    for found in all {
        match worst.iter_mut().find(|known| known.joint == found.joint) {
            Some(known) if found.margin < known.margin => *known = found,
            Some(_) => {}
            None => worst.push(found),
        }
    }
    let named: Vec<String> = worst.iter().map(TooHot::words).collect();
    (!named.is_empty()).then(|| {
        format!(
            "At the representative efficiency of the gear over the cycle these motors{whose} would overheat, which the checks at \
             the rated efficiency do not see: {}; a motor with more continuous torque, a smaller gear (more efficient at little \
             load) or longer rests would help.",
            named.join("; ")
        )
    })
}

/// The remark on the motors of one design that overheat at the representative efficiency of their gears, from its sizing
/// rows; `None` if there are none.
pub(super) fn heat_remark_on(rows: &[JointSizingRow]) -> Option<String> {
    heat_sentence(rows.iter().filter_map(TooHot::of), "")
}

/// The remark on the motors of the picks of a front that overheat at the representative efficiency of their gears; `None`
/// if there are none.
pub(super) fn heat_remark(problem: &ArmProblem, catalogs: &Catalogs, front: &FrontTable) -> Option<String> {
    let picked = options_of_picks(problem, front);
    let rows = picked.iter().filter_map(|chosen| sizing_rows(problem, catalogs, chosen).ok()).flatten();
    heat_sentence(rows.filter_map(|row| TooHot::of(&row)), " of the picks")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::json::Document;
    use crate::study::chosen::sizing_of;
    use crate::study::read::read_study;
    use serde_json::json;

    /// The remarks of `size` on one joint with a vertical axis, which swings 3.6 kg at 0.9 m.
    fn remarks(has_brake: bool) -> Vec<String> {
        let drives = json!({"gears": ["CSG-25-100"], "motor_models": ["251601 (EC 45 flat 50 W)"]});
        let study = json!({"name": "swing", "payload": {"mass_kg": 3.6}, "poses": [{"pose_deg": [0]}],
            "motion": {"tip_speed_m_s": 1.0, "ramp_time_s": 0.25},
            "chain": [
                {"type": "joint", "name": "swing", "axis": [0, 0, 1], "drive": "first_fit", "drives": drives, "brake": has_brake},
                {"type": "link", "name": "arm", "vector_m": [0.9, 0, 0], "mass_kg": 0}]});
        let catalogs = Catalogs::builtin();
        let study = read_study(Document::parse("s.json", &study.to_string()).unwrap(), &catalogs).unwrap();
        sizing_of(&study, None, &catalogs).unwrap().remarks
    }

    /// T_lin is 3.6 x 0.9² x 4 / 0.9 = 12.96 N m. With η = 0.78 and 0.0244 N m for the rotor, the stop asks 2 x 12.96 x
    /// 0.78 / 100 + 2 x 0.0244 = 0.251 N m of a motor with a peak torque of 0.234 N m.
    #[test]
    fn a_motor_that_cannot_make_the_stop_is_named_unless_there_is_a_brake() {
        let words = "An emergency stop asks more than the peak torque of these motors in the sizing cases, although the losses \
                     of the gears help: swing (251601 (EC 45 flat 50 W)) 0.251 N m, peak 0.234; such a joint stops more \
                     slowly than asked or needs a brake (this excludes no design).";
        let of_stop = |has_brake| -> Vec<String> {
            remarks(has_brake).into_iter().filter(|said| said.contains("emergency stop")).collect()
        };
        assert_eq!(of_stop(false), [words]);
        assert_eq!(of_stop(true), [""; 0]);
    }

    #[test]
    fn each_joint_is_named_once_with_its_weakest_motor() {
        let weak = |joint: &str, asked_nm, peak_nm| TooWeak {
            joint: joint.into(),
            motor: "M".into(),
            stop: MotorStop { asked_nm, peak_nm },
        };
        let said = stop_sentence(vec![weak("a", 2.0, 1.9), weak("b", 3.0, 2.0), weak("a", 2.0, 1.5)], "here");
        let said = said.expect("two joints");
        assert!(said.contains("motors here, "), "{said}");
        assert!(said.contains("help: a (M) 2.00 N m, peak 1.50; b (M) 3.00 N m, peak 2.00; such"), "{said}");
        assert_eq!(stop_sentence(Vec::new(), "here"), None);
    }

    /// The motor's margin is 1.08 at the rated efficiency 0.78. The gear has 0.3655 at a mean torque of 8.2 N m and 424 rpm.
    /// Speeding up then asks 12.96 / 36.55 + 0.0244 = 0.379 N m, slowing down -0.0244 - 12.96 x 0.3655 / 100 = -0.0718 N m,
    /// each for a tenth of the cycle: the root mean square is 0.122 N m, and 0.0781 / 0.122 = 0.64.
    #[test]
    fn a_motor_that_overheats_at_the_representative_efficiency_is_named() {
        let said: Vec<String> = remarks(false).into_iter().filter(|said| said.contains("overheat")).collect();
        let words = "At the representative efficiency of the gear over the cycle these motors would overheat, which the checks \
                     at the rated efficiency do not see: swing (251601 (EC 45 flat 50 W)) margin 0.64 at efficiency 0.37;";
        assert!(said.len() == 1 && said[0].starts_with(words), "{said:?}");
        let hot = |margin| TooHot { joint: "a".into(), motor: "M".into(), efficiency: 0.5, margin };
        let said = heat_sentence([0.9, 0.8, 0.95].map(hot).into_iter(), " of the picks").expect("one joint");
        assert!(
            said.contains("motors of the picks would") && said.contains("see: a (M) margin 0.80 at"),
            "{said}"
        );
        assert_eq!(heat_sentence(std::iter::empty(), ""), None);
    }
}
