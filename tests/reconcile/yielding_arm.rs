//! Makes positions of a six-axis arm. Every joint is compliant about its axis and some bearings tilt, most of them too
//! little to be named. The arm is computed in its deflected pose by rotations of rigid bodies, independently of the
//! library.

use crate::generator::Dice;
use nalgebra::{Rotation3, Unit, Vector3};
use serde_json::{Value, json};
use std::path::Path;

const AXES: [[f64; 3]; 6] =
    [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
const LINKS_M: [[f64; 3]; 6] =
    [[0.15, 0.0, 0.4], [0.7, 0.0, 0.0], [0.3, 0.0, 0.1], [0.4, 0.0, 0.0], [0.1, 0.0, 0.0], [0.05, 0.0, 0.0]];
const JOINTS_KG: [f64; 6] = [0.0, 25.0, 18.0, 8.0, 6.0, 4.0];
const LINKS_KG: [f64; 6] = [20.0, 15.0, 10.0, 6.0, 3.0, 2.0];
const RANGES_DEG: [f64; 6] = [150.0, 60.0, 80.0, 150.0, 100.0, 150.0];
const TOOL_M: [f64; 3] = [0.05, 0.02, -0.03];
const PAYLOAD_CG_M: [f64; 3] = [0.1, 0.0, 0.0];
const GRAVITY_M_S2: f64 = 9.81;
const SIGMA_MM: f64 = 0.05;
const POSES: usize = 120;
/// Number of times that the joints' turning is computed anew. Each time the error falls to a thirtieth or less.
const HANGING: usize = 6;

/// The true compliances \[rad/(N m)\].
pub struct Truth {
    about_axis: [f64; 6],
    /// Of the bearings of the first three joints; the first is the base's too.
    tilt: [f64; 3],
}

impl Truth {
    fn drawn(dice: &mut Dice) -> Self {
        let mut about = |typical: f64| typical * (0.8 * dice.normal()).exp();
        let about_axis = [0; 6].map(|_| about(3e-6));
        let tilt = [0; 3].map(|_| about(1.5e-6));
        // some bearings are as good as rigid
        Self { about_axis, tilt: tilt.map(|c| if dice.uniform() < 0.6 { c } else { 0.0 }) }
    }

    /// The true compliance of an effect at a place; `None` if the arm has no such effect.
    pub fn of(&self, effect: &str, at: &str) -> Option<f64> {
        let joint = match at {
            "base" => 0,
            _ => at.strip_prefix('j')?.parse::<usize>().ok()?.checked_sub(1)?,
        };
        match effect {
            "joint_compliance" => Some(self.about_axis[joint]),
            "bearing_tilt" | "base_compliance" => Some(self.tilt.get(joint).copied().unwrap_or(0.0)),
            _ => None,
        }
    }
}

/// Standard deviations by which an arm is off its drawing.
pub struct Off {
    links_m: f64,
    axes: f64,
    zeros_rad: f64,
}

/// An arm that was built with care.
pub const USUAL: Off = Off { links_m: 1e-3, axes: 1e-3, zeros_rad: 5e-3 };
/// An arm that is as far off as the calibration thinks possible (docs/positions.md, `positions.geometry`).
pub const FAR: Off = Off { links_m: 1e-2, axes: 1e-2, zeros_rad: 3e-2 };

/// The arm as it was built: axes, links and zeros a little off.
struct Built {
    axes: [Vector3<f64>; 6],
    links_m: [Vector3<f64>; 6],
    zeros_rad: [f64; 6],
    truth: Truth,
}

impl Built {
    fn drawn(dice: &mut Dice, truth: Truth, scatter: &Off) -> Self {
        let mut off = |nominal: [f64; 3], by: f64| Vector3::from(nominal.map(|x| x + by * dice.normal()));
        let axes = AXES.map(|axis| off(axis, scatter.axes).normalize());
        let links_m = LINKS_M.map(|link| off(link, scatter.links_m));
        let mut zeros_rad = [0; 6].map(|_| scatter.zeros_rad * dice.normal());
        zeros_rad[0] = 0.0;
        Self { axes, links_m, zeros_rad, truth }
    }

    /// Where the point of the tool is as the arm hangs: each joint has turned by what the weights do with the levers that
    /// they then have \[m\].
    fn point_m(&self, pose_rad: &[f64; 6], payload_kg: f64) -> Vector3<f64> {
        let mut turned_rad = [Vector3::zeros(); 6];
        for _ in 0..HANGING {
            turned_rad = self.hung(pose_rad, payload_kg, &turned_rad).turned_rad;
        }
        self.hung(pose_rad, payload_kg, &turned_rad).point_m
    }

    /// The arm with joints that the weights have turned by `turned_rad`, and by how much the weights then turn them.
    fn hung(&self, pose_rad: &[f64; 6], payload_kg: f64, turned_rad: &[Vector3<f64>; 6]) -> Hung {
        let (mut turn, mut at_m) = (Rotation3::identity(), Vector3::zeros());
        let (mut joints, mut bodies) = (Vec::new(), Vec::new());
        for j in 0..6 {
            bodies.push((JOINTS_KG[j], at_m));
            joints.push((at_m, turn * self.axes[j], bodies.len()));
            let axis = Unit::new_normalize(self.axes[j]);
            let own = Rotation3::from_axis_angle(&axis, pose_rad[j] + self.zeros_rad[j]);
            turn = Rotation3::new(turned_rad[j]) * turn * own;
            let link_m = turn * self.links_m[j];
            bodies.push((LINKS_KG[j], at_m + link_m / 2.0));
            at_m += link_m;
        }
        bodies.push((payload_kg, at_m + turn * Vector3::from(PAYLOAD_CG_M)));
        let weight = |kg: f64| Vector3::new(0.0, 0.0, -GRAVITY_M_S2 * kg);
        let turned_rad = std::array::from_fn(|j| {
            let (joint_m, axis, inboard) = joints[j];
            let moments = bodies[inboard..].iter().map(|(kg, at_m)| (at_m - joint_m).cross(&weight(*kg)));
            let moment_nm: Vector3<f64> = moments.sum();
            let about_nm = axis * axis.dot(&moment_nm);
            let tilt = self.truth.tilt.get(j).copied().unwrap_or(0.0);
            about_nm * self.truth.about_axis[j] + (moment_nm - about_nm) * tilt
        });
        Hung { turned_rad, point_m: at_m + turn * Vector3::from(TOOL_M) }
    }
}

/// An arm in a pose, with joints that have turned a little.
struct Hung {
    /// By how much the weights turn each joint \[rad\].
    turned_rad: [Vector3<f64>; 6],
    /// Where the point of the tool is \[m\].
    point_m: Vector3<f64>,
}

/// Writes a campaign of positions, of whose arm the drawing has rigid joints. The arm is `off` its drawing.
pub fn make(folder: &Path, seed: u64, off: &Off) -> Truth {
    let dice = &mut Dice(seed);
    let truth = Truth::drawn(dice);
    let built = Built::drawn(dice, truth, off);
    let names: Vec<String> = (1..=6).map(|j| format!("q_j{j}_deg")).collect();
    let mut text = format!(
        "test,{},payload_kg,payload_cg_x_m,payload_cg_y_m,payload_cg_z_m,x_mm,y_mm,z_mm,sigma_mm\n",
        names.join(",")
    );
    let askew = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.7);
    for test in 1..=POSES {
        let pose_deg = RANGES_DEG.map(|range| dice.rounded(-range, range, 3));
        let payload_kg = [0.0, 10.0][test % 2];
        let at_m = built.point_m(&pose_deg.map(f64::to_radians), payload_kg);
        let seen_m = askew * at_m + Vector3::new(2.0, -1.0, 0.4);
        let read = [0, 1, 2].map(|c| format!("{:.4}", 1e3 * seen_m[c] + SIGMA_MM * dice.normal()));
        let pose = pose_deg.map(|a| a.to_string()).join(",");
        text.push_str(&format!("{test},{pose},{payload_kg},0.1,0,0,{},{SIGMA_MM}\n", read.join(",")));
    }
    std::fs::create_dir_all(folder).expect("folder");
    let save = |file: &str, text: String| std::fs::write(folder.join(file), text).expect("written");
    save("positions.csv", text);
    save("arm.json", json!({"name": "yielding", "chain": drawing()}).to_string());
    let free = json!({"file": "positions.csv", "base_placement": true, "tool_offset": true, "joint_offsets": true,
        "geometry": true});
    save("campaign.json", json!({"name": "yielding", "arm": "arm.json", "positions": free}).to_string());
    built.truth
}

fn drawing() -> Vec<Value> {
    let pieces = (0..6).flat_map(|j| {
        let (joint, link) = (format!("j{}", j + 1), format!("l{}", j + 1));
        [
            json!({"type": "joint", "name": joint, "axis": AXES[j], "stiffness_nm_per_rad": null,
                "mass_kg": JOINTS_KG[j]}),
            json!({"type": "link", "name": link, "vector_m": LINKS_M[j], "mass_kg": LINKS_KG[j]}),
        ]
    });
    pieces.collect()
}
