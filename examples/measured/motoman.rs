//! Campaign of a Motoman MA1400 on a turntable (CTU Prague): a laser tracker measured the position of a reflector in
//! 352 poses.
//!
//! Data and kinematics: github.com/ctu-vras/multirobot-calibration, `updated_leica_dataset` (Rozlivek et al., Humanoids
//! 2021; Stepanova et al., RCIM 73 (2022) 102250). The masses of the links are guesses, so that only ratios of
//! stiffness to mass are identified.

use super::frames::Walk;
use super::{read_numbers, write};
use serde_json::json;
use std::io;
use std::path::Path;

/// Standard Denavit-Hartenberg parameters of each joint: a \[m\], d \[m\], alpha \[deg\], theta \[deg\], name of the
/// joint, mass of the body that it moves \[kg\].
const ROWS: [(f64, f64, f64, f64, &str, f64); 7] = [
    (0.0, -0.263, 15.0, -90.0, "E", 60.0),
    (0.15, 1.4159, -90.0, 0.0, "S", 45.0),
    (0.614, 0.0, 180.0, -90.0, "L", 25.0),
    (0.2, 0.0, -90.0, 0.0, "U", 25.0),
    (0.0, -0.64, 90.0, 0.0, "R", 20.0),
    (0.03, 0.0, 90.0, -90.0, "B", 5.0),
    (0.0, 0.2, 0.0, 0.0, "T", 3.0),
];
/// Standard Denavit-Hartenberg parameters and mass of the tool: a \[m\], d \[m\], theta \[rad\], mass \[kg\].
const TOOL: (f64, f64, f64, f64) = (0.045, 0.245, -0.38, 2.0);
/// Standard deviation of the laser tracker \[mm\].
const SIGMA_MM: f64 = 0.008;

/// The arm at zero angles: for each row the joint, a rotation by theta about z, a shift by d along z, a shift by a
/// along x, and a rotation by alpha about x.
fn arm() -> serde_json::Value {
    let mut walk = Walk::new();
    for (a, d, alpha, theta, name, mass_kg) in ROWS {
        walk.joint(name, None);
        walk.turn_z(theta);
        walk.shift(0.0, 0.0, d);
        walk.shift(a, 0.0, 0.0);
        walk.turn_x(alpha);
        walk.link(&format!("after_{name}"), mass_kg);
    }
    let (a, d, theta, mass_kg) = TOOL;
    walk.turn_z(theta.to_degrees());
    walk.shift(a, 0.0, d);
    walk.link("tool", mass_kg);
    json!({"name": "motoman-ma1400", "chain": walk.chain})
}

/// Writes the campaign folder. `data` is the file `poses_fit_352.csv` with the columns: pose, seven angles \[rad\], x,
/// y, z of the reflector \[m\].
///
/// # Errors
/// An error if the data cannot be read or the folder cannot be written.
pub fn campaign(data: &Path, folder: &Path) -> io::Result<()> {
    let joints = ROWS.map(|row| format!("q_{}_deg", row.4)).join(",");
    let mut positions = format!("test,{joints},point,x_mm,y_mm,z_mm,sigma_mm\n");
    for row in read_numbers(data)? {
        let angles: Vec<String> = row[1..8].iter().map(|q| q.to_degrees().to_string()).collect();
        let at: Vec<String> = row[8..11].iter().map(|x| (1e3 * x).to_string()).collect();
        positions.push_str(&format!(
            "{},{},reflector,{},{SIGMA_MM}\n",
            row[0],
            angles.join(","),
            at.join(",")
        ));
    }
    let free = json!({
        "base_placement": true, "tool_offset": true, "joint_offsets": true, "geometry": true,
    });
    let statement = json!({"name": "motoman-ma1400", "positions": free});
    write(
        folder,
        &[
            ("positions.csv", positions),
            ("arm.json", arm().to_string()),
            ("campaign.json", statement.to_string()),
        ],
    )
}
