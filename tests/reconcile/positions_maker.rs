//! Makes campaigns of absolute positions by small rotations of rigid bodies, independently of the library. The true arm
//! has offset zeros, stands at an angle, and deflects in its joints under gravity. The readings have noise.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use serde_json::{Value, json};

/// A true arm of three joints, and how it is measured.
pub struct Made {
    /// Noise of each coordinate \[mm\].
    pub sigma_mm: f64,
    poses: usize,
    /// First state of the generator of poses and noise.
    seed: u64,
}

/// The truth of one position, before noise.
pub struct Truth {
    position_m: Vector3<f64>,
}

const AXES: [[f64; 3]; 3] = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
const LINKS_M: [[f64; 3]; 3] = [[0.0, 0.0, 0.4], [0.7, 0.0, 0.0], [0.5, 0.0, 0.0]];
const MASSES_KG: [f64; 3] = [20.0, 15.0, 10.0];
const ZEROS_RAD: [f64; 3] = [0.01, -0.006, 0.008];
const STIFFNESS_NM_PER_RAD: [f64; 3] = [f64::INFINITY, 4e4, 3e4];
const TOOL_M: [f64; 3] = [0.05, 0.02, -0.03];
const GRAVITY_M_S2: f64 = 9.81;

/// The arm of the tests.
pub fn standard() -> Made {
    Made { sigma_mm: 0.05, poses: 120, seed: 20_240_607 }
}

/// The same arm in so many poses.
pub fn in_poses(poses: usize) -> Made {
    Made { poses, ..standard() }
}

/// The same arm in other poses and with other noise.
pub fn with_noise(seed: u64) -> Made {
    Made { seed, ..standard() }
}

/// What may be untrue of an arm in a row.
#[derive(Clone, Copy, Default)]
struct Truths {
    sag: bool,
    lean_rad: f64,
    wobble_rad: f64,
    /// The third joint turns by this part further than its sensor reads.
    scale: f64,
    pulled_m: f64,
    moved_m: f64,
    /// The third joint turns by this much further, in the sense in which it is turned.
    play_rad: f64,
    /// The third joint lags by this much in the sense of its torque.
    lost_rad: f64,
    /// Rotation of the base per moment about its axes \[rad/(N m)\].
    base_rad_per_nm: Matrix3<f64>,
    /// The base tilts beyond its preload.
    lifts: bool,
    /// The torsion of the second joint grows ever less with its torque.
    bends: bool,
    /// All points have moved by so much, in the frame of the arm.
    drifted_m: f64,
}

/// Tilt of a base that lifts off, per moment beyond its preload \[rad/(N m)\], and the preload \[N m\].
pub const LIFT_RAD_PER_NM: f64 = 3e-5;
pub const PRELOAD_NM: f64 = 90.0;
/// The compliance of the third joint varies once a turn by this part of itself, with this phase \[rad\].
pub const WAVE: f64 = 0.4;
pub const WAVE_PHASE_RAD: f64 = 0.7;
/// Compliance of the second joint without torque \[rad/(N m)\], and the torque at which it has turned half as far as that
/// would let it \[N m\].
const BENT: (f64, f64) = (1.2e-4, 40.0);
/// Drift of the instrument \[mm\] per row, along the arm's x and y.
pub const DRIFT_MM_PER_ROW: f64 = 0.006;

/// A base that is stiffer one way than the other and turns about the vertical when it is tilted: xx, yy, zz;
/// xy, xz, yz \[rad/(N m)\].
pub const LOPSIDED_RAD_PER_NM: [[f64; 3]; 2] = [[8e-6, 3e-6, 4e-6], [1e-6, 3e-6, -2e-6]];
/// The third joint's error twice a turn \[rad\].
pub const UNEVEN_RAD: f64 = 2e-3;
/// Half width of the third joint's lost motion, and the torque at which three quarters of it are used up \[N m\].
pub const LOST_RAD: f64 = 1.5e-3;
const LOST_NM: f64 = 2.0;
/// A base that tilts alike about x and y \[rad/(N m)\].
pub const EVEN_RAD_PER_NM: f64 = 6e-6;

impl Made {
    /// Nothing yields.
    pub fn rigid(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.truth(pose_rad, Truths::default())
    }

    /// Joints yield about their axes.
    pub fn sagging(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.truth(pose_rad, Truths { sag: true, ..Truths::default() })
    }

    /// Joints yield by finite angles, until springs and weights are in equilibrium in the pose in which the arm hangs.
    pub fn hanging(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.at_rest(pose_rad, [1.0; 3])
    }

    /// Each joint is `softer` by a factor, and springs and weights are in equilibrium.
    fn at_rest(&self, pose_rad: &[f64; 3], softer: [f64; 3]) -> Truth {
        let mut yielded_rad = [0.0; 3];
        let mut tip = Vector3::zeros();
        for _ in 0..60 {
            let (mut joints, mut bodies) = (Vec::new(), Vec::new());
            let (mut at, mut rotation) = (Vector3::zeros(), Rotation3::identity());
            for j in 0..3 {
                let axis = Unit::new_normalize(Vector3::from(AXES[j]));
                joints.push((rotation * axis.into_inner(), at));
                rotation *= Rotation3::from_axis_angle(&axis, pose_rad[j] + ZEROS_RAD[j] + yielded_rad[j]);
                let link = rotation * Vector3::from(LINKS_M[j]);
                bodies.push((MASSES_KG[j], at + link / 2.0));
                at += link;
            }
            tip = at + rotation * Vector3::from(TOOL_M);
            for (j, (axis, pivot)) in joints.into_iter().enumerate() {
                let weights = bodies[j..].iter();
                let torque_nm: f64 = weights
                    .map(|(m, cg)| axis.dot(&(cg - pivot).cross(&(-Vector3::z() * GRAVITY_M_S2 * *m))))
                    .sum();
                yielded_rad[j] = softer[j] * torque_nm / STIFFNESS_NM_PER_RAD[j];
            }
        }
        Truth { position_m: askew() * tip + Vector3::new(1.0, -2.0, 0.5) }
    }

    /// Joints yield, and the base leans.
    pub fn leaning(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.truth(pose_rad, Truths { sag: true, lean_rad: 0.12, ..Truths::default() })
    }

    /// Joints yield, and the third turns unevenly, twice a turn.
    pub fn wobbling(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.truth(pose_rad, Truths { sag: true, wobble_rad: UNEVEN_RAD, ..Truths::default() })
    }

    /// Joints yield, and the sensor of the third has a wrong scale.
    pub fn misreading(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.truth(pose_rad, Truths { sag: true, scale: 1.5e-3, ..Truths::default() })
    }

    /// Joints yield, and something pulls the point sideways as the third turns, twice a turn.
    pub fn pulled(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.truth(pose_rad, Truths { sag: true, pulled_m: 1.5e-3, ..Truths::default() })
    }

    /// Joints yield, and the base does, differently about each axis.
    pub fn lopsided(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        let [[xx, yy, zz], [xy, xz, yz]] = LOPSIDED_RAD_PER_NM;
        let base_rad_per_nm = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        self.truth(pose_rad, Truths { sag: true, base_rad_per_nm, ..Truths::default() })
    }

    /// The base tilts alike about x and y.
    pub fn tilting(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        let base_rad_per_nm = Matrix3::from_diagonal(&Vector3::new(EVEN_RAD_PER_NM, EVEN_RAD_PER_NM, 0.0));
        self.truth(pose_rad, Truths { base_rad_per_nm, ..Truths::default() })
    }

    /// Joints yield, and the third has play: it rests on one side or the other.
    pub fn loose(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.truth(pose_rad, Truths { sag: true, play_rad: 3e-3, ..Truths::default() })
    }

    /// Joints yield, and the third lags in the sense of its torque.
    pub fn lagging(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.truth(pose_rad, Truths { sag: true, lost_rad: LOST_RAD, ..Truths::default() })
    }

    /// Joints yield, and the point sat elsewhere in the first seven rows.
    pub fn put_back_soon(&self, pose_rad: &[f64; 3], row: usize) -> Truth {
        self.truth(
            pose_rad,
            Truths { sag: true, moved_m: if row < 7 { 3.2e-3 } else { 0.0 }, ..Truths::default() },
        )
    }

    /// Joints yield, and the point sat 3 mm away before row 41.
    pub fn put_back(&self, pose_rad: &[f64; 3], row: usize) -> Truth {
        self.truth(
            pose_rad,
            Truths { sag: true, moved_m: if row < 40 { 3.2e-3 } else { 0.0 }, ..Truths::default() },
        )
    }

    /// The base lifts off beyond a preload.
    pub fn lifting(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.truth(pose_rad, Truths { lifts: true, ..Truths::default() })
    }

    /// Joints yield, and the stiffness of the third varies once a turn.
    pub fn varying(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.at_rest(pose_rad, [1.0, 1.0, 1.0 + WAVE * (pose_rad[2] + WAVE_PHASE_RAD).sin()])
    }

    /// The second joint yields, and the more the torque is, the less.
    pub fn bent(&self, pose_rad: &[f64; 3], _row: usize) -> Truth {
        self.truth(pose_rad, Truths { bends: true, ..Truths::default() })
    }

    /// The instrument drifts.
    pub fn drifting(&self, pose_rad: &[f64; 3], row: usize) -> Truth {
        let drifted_m = 1e-3 * DRIFT_MM_PER_ROW * row as f64;
        self.truth(pose_rad, Truths { drifted_m, ..Truths::default() })
    }

    /// The stiffness that the truth has somewhere.
    pub fn stiffness_nm_per_rad(&self, at: &str, effect: &str) -> Option<f64> {
        let joint = ["q1", "q2", "q3"].iter().position(|n| *n == at)?;
        (effect == "joint_compliance").then_some(STIFFNESS_NM_PER_RAD[joint])
    }

    fn truth(&self, pose_rad: &[f64; 3], truths: Truths) -> Truth {
        let mut places = Vec::new();
        let mut bodies = Vec::new();
        let (mut at, mut rotation) = (Vector3::zeros(), Rotation3::identity());
        for (j, axis) in AXES.into_iter().enumerate() {
            let axis = Unit::new_normalize(Vector3::from(axis));
            places.push((rotation * axis.into_inner(), at));
            let wobble = if j == 2 { truths.wobble_rad * (2.0 * pose_rad[2]).sin() } else { 0.0 };
            let play = if j == 2 { truths.play_rad.copysign(pose_rad[2]) } else { 0.0 };
            let scaled = if j == 2 { truths.scale * pose_rad[2] } else { 0.0 };
            rotation *=
                Rotation3::from_axis_angle(&axis, pose_rad[j] + ZEROS_RAD[j] + wobble + play + scaled);
            let link = rotation * Vector3::from(LINKS_M[j]);
            bodies.push((MASSES_KG[j], at + link / 2.0));
            at += link;
        }
        let tool = Vector3::from(TOOL_M) + Vector3::y() * truths.moved_m;
        let pulled = Vector3::y() * truths.pulled_m * (2.0 * pose_rad[2]).sin();
        let point = at + rotation * tool + pulled;
        let down = Vector3::new(truths.lean_rad.sin(), 0.0, -truths.lean_rad.cos()) * GRAVITY_M_S2;
        let mut sag = Vector3::zeros();
        for (j, (axis, pivot)) in places.iter().enumerate().filter(|_| truths.sag) {
            let outboard = bodies[j..].iter();
            let torque: f64 = outboard.map(|(m, cg)| axis.dot(&(cg - pivot).cross(&(down * *m)))).sum();
            let lost_rad = if j == 2 { truths.lost_rad * (torque / LOST_NM).tanh() } else { 0.0 };
            sag += axis.cross(&(point - pivot)) * (torque / STIFFNESS_NM_PER_RAD[j] + lost_rad);
        }
        if truths.bends {
            let (axis, pivot) = places[1];
            let outboard = bodies[1..].iter();
            let torque: f64 = outboard.map(|(m, cg)| axis.dot(&(cg - pivot).cross(&(down * *m)))).sum();
            sag += axis.cross(&(point - pivot)) * (BENT.0 * torque / (1.0 + torque.abs() / BENT.1));
        }
        let moment: Vector3<f64> = bodies.iter().map(|(m, cg)| cg.cross(&(down * *m))).sum();
        sag += (truths.base_rad_per_nm * moment).cross(&point);
        if truths.lifts {
            let beyond = |nm: f64| (nm.abs() - PRELOAD_NM).max(0.0).copysign(nm);
            sag += (Vector3::new(beyond(moment.x), beyond(moment.y), 0.0) * LIFT_RAD_PER_NM).cross(&point);
        }
        sag += Vector3::new(truths.drifted_m, truths.drifted_m, 0.0);
        Truth { position_m: askew() * (point + sag) + Vector3::new(1.0, -2.0, 0.5) }
    }

    /// A campaign folder of a truth whose rows were taken configuration by configuration: first all in which the third joint
    /// is turned backwards.
    pub fn write_by_configuration(
        &self,
        truth: &dyn Fn(&Self, &[f64; 3], usize) -> Truth,
    ) -> tempfile::TempDir {
        let folder = self.write(truth);
        let file = folder.path().join("positions.csv");
        let text = std::fs::read_to_string(&file).expect("text");
        let (head, rows) = text.split_once('\n').expect("rows");
        let third_deg =
            |row: &&str| row.split(',').nth(3).expect("a third angle").parse::<f64>().expect("a number");
        let (forwards, backwards): (Vec<&str>, Vec<&str>) =
            rows.lines().partition(|row| third_deg(row) > 0.0);
        let numbered = backwards.iter().chain(&forwards).enumerate();
        let rows: String =
            numbered.map(|(i, row)| format!("{i},{}\n", row.split_once(',').expect("cells").1)).collect();
        std::fs::write(&file, format!("{head}\n{rows}")).expect("written");
        folder
    }

    /// A campaign folder of a truth.
    pub fn write(&self, truth: &dyn Fn(&Self, &[f64; 3], usize) -> Truth) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("temporary folder");
        let mut noise = Noise(self.seed);
        let mut rows = String::from("test,q_q1_deg,q_q2_deg,q_q3_deg,x_mm,y_mm,z_mm,sigma_mm\n");
        for row in 0..self.poses {
            let pose_deg = [170.0, 80.0, 140.0].map(|reach| (reach * (2.0 * noise.part() - 1.0)).round());
            let at_mm = truth(self, &pose_deg.map(f64::to_radians), row).position_m * 1e3;
            let read: Vec<String> =
                at_mm.iter().map(|x| format!("{:.4}", x + self.sigma_mm * noise.normal())).collect();
            let [a, b, c] = pose_deg;
            rows.push_str(&format!("{row},{a},{b},{c},{},{}\n", read.join(","), self.sigma_mm));
        }
        let statement = json!({"name": "made", "positions": {
            "base_placement": true, "tool_offset": true, "joint_offsets": true, "geometry": true,
        }});
        let write =
            |name: &str, text: String| std::fs::write(folder.path().join(name), text).expect("written");
        write("positions.csv", rows);
        write("arm.json", arm().to_string());
        write("campaign.json", statement.to_string());
        folder
    }
}

/// How the arm stands in the frame of the instrument.
fn askew() -> Rotation3<f64> {
    Rotation3::from_euler_angles(0.3, -0.2, 2.1)
}

fn arm() -> Value {
    let pieces = (0..3).flat_map(|j| {
        let (joint, link) = (format!("q{}", j + 1), format!("link{}", j + 1));
        [
            json!({"type": "joint", "name": joint, "axis": AXES[j], "stiffness_nm_per_rad": null}),
            json!({"type": "link", "name": link, "vector_m": LINKS_M[j], "mass_kg": MASSES_KG[j]}),
        ]
    });
    json!({"name": "made", "chain": pieces.collect::<Vec<_>>()})
}

/// A small generator of pseudo-random numbers (splitmix64).
pub struct Noise(pub u64);

impl Noise {
    /// From 0 to 1.
    pub fn part(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Of standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.part()).sum::<f64>() - 6.0
    }
}
