//! The files of a new campaign: `campaign.json` with a note on each block, tables with column names and no rows, and
//! `STARTER.md`, which explains what to measure and what each column means.

use super::positions::outcome::FEWEST_POSITIONS;
use super::readings::source::{DEFAULT_FILES, columns_for};
use super::select::few_rows::FEWEST_ROWS;
use super::verdict::too_little::FEWEST_POSES;
use crate::arm::Arm;
use crate::arm::effect::channel::Channel;
use crate::arm::pose::DrivenJoint;
use serde_json::{Value, json};

/// Name of the file that explains what to measure.
pub(crate) const PAGE: &str = "STARTER.md";

/// Names and contents of the files of a new campaign for `arm`; `name` is the name of the campaign. The arm file is not
/// among them.
pub(crate) fn files(arm: &Arm, name: &str) -> Vec<(String, String)> {
    let joints = arm.driven_joints();
    let table = |channel: Channel| {
        (
            DEFAULT_FILES[channel as usize].to_string(),
            format!("{}\n", columns_for(channel, &joints).join(",")),
        )
    };
    let mut campaign = campaign_json(name);
    if arm.beyond_positions().is_some()
        && let Some(blocks) = campaign.as_object_mut()
    {
        blocks.remove(Channel::Positions.word());
    }
    let mut out = vec![("campaign.json".to_string(), format!("{campaign:#}\n"))];
    out.extend(channels(arm).map(table));
    out.push((PAGE.to_string(), page(arm, name, &joints)));
    out
}

/// The channels that a campaign of the arm can have: all of them, or all but absolute positions if the arm has
/// something that the model of positions lacks.
fn channels(arm: &Arm) -> impl Iterator<Item = Channel> {
    let has_positions = arm.beyond_positions().is_none();
    Channel::ALL.into_iter().filter(move |channel| has_positions || *channel != Channel::Positions)
}

fn campaign_json(name: &str) -> Value {
    json!({
        "name": name,
        "note": "Fill the tables you have readings for. Delete the block and the file of each kind that you do not measure. \
                 Notes may be deleted.",
        "arm": "arm.json",
        "tolerance": {
            "note": "95 % of good parts lie within these fractions of their nominal value. A deviation within them is \
                     calibrated; one beyond them is looked for as an effect. 0.1 is 10 %.",
            "joint_stiffness": 0.1,
            "joint_mass": 0.02,
            "modulus": 0.03,
            "bearing_stiffness": 0.0
        },
        "conventions": {
            "note": "Density of the payloads in kg/m3; it counts only where the arm is under water.",
            "payload_density_kg_m3": 7850
        },
        "static": {
            "note": "Displacement of the tip, in the world's directions, from where it stands in the same pose without \
                     payload and tip force. A direction that the instrument does not read stays blank.",
            "file": "static.csv"
        },
        "modal": {
            "note": "Natural frequencies with the motors held, numbered by rising frequency.",
            "file": "modal.csv"
        },
        "windup": {
            "note": "Twist of one joint on a bench, as a function of the torque on it, from unloaded.",
            "file": "windup.csv"
        },
        "positions": {
            "note": "Places of a point on the tool, in the frame of the instrument. true is what nobody measured: where the \
                     base stands, where the point sits on the tool, the zeros of the joints, the lengths and axes of the \
                     arm. Set geometry to true where there are 60 poses or more.",
            "file": "positions.csv",
            "base_placement": true,
            "tool_offset": true,
            "joint_offsets": true,
            "geometry": false
        }
    })
}

/// Texts on one channel for `STARTER.md`: a title, what to measure, and how many readings are needed.
struct Kind {
    channel: Channel,
    title: &'static str,
    what: &'static str,
    how_many: String,
}

fn kinds(joints: usize) -> [Kind; 4] {
    [
        Kind {
            channel: Channel::Static,
            title: "Displacements under load",
            what: "Hold a pose, zero the instrument on the unloaded arm, mount a payload or pull at the tip, and read how far \
                   the tip has moved. A dial gauge reads one direction: leave the others blank. Keep the rows in the order \
                   in which they were taken, because friction remembers it.",
            how_many: format!(
                "At least {FEWEST_ROWS} rows, {FEWEST_POSES} poses and two loads. {} poses with four loads each are a good \
                 campaign, in which every joint is bent in some pose and stretched in another.",
                (2 * joints).max(10)
            ),
        },
        Kind {
            channel: Channel::Modal,
            title: "Natural frequencies",
            what: "Strike the held arm and read the lowest peaks of an accelerometer's spectrum, one row for each. If a peak \
                   is missed, leave its row out.",
            how_many: "Six poses or more, each without and with a payload, three modes or more each.".into(),
        },
        Kind {
            channel: Channel::Windup,
            title: "Twist on a bench",
            what: "Turn the torque on one joint from zero up, down to its negative and back to zero, and read the twist. These \
                   are the only readings of one joint by itself.",
            how_many: "A closed cycle of 16 rows for each joint that you can reach.".into(),
        },
        Kind {
            channel: Channel::Positions,
            title: "Absolute positions",
            what: "Measure where a point on the tool is, with a laser tracker, a total station or cameras, in many poses. A \
                   coordinate that the instrument does not read stays blank.",
            how_many: format!(
                "At least {FEWEST_POSITIONS} positions, better 60 or more, in which every joint turns through most of its range."
            ),
        },
    ]
}

/// The content of `STARTER.md`.
fn page(arm: &Arm, name: &str, joints: &[DrivenJoint]) -> String {
    let kinds_of_readings = if arm.beyond_positions().is_none() { "four" } else { "three" };
    let mut out = format!(
        "# Campaign {name}: readings of {}\n\nFill the tables, then run:\n\n```sh\narmwright reconcile .\n```\n\nAny one of the \
         {kinds_of_readings} kinds of readings suffices; several together say more. Delete the block in `campaign.json` and the file of each \
         kind that you do not measure. Separate columns by commas and write decimals with a point. A spreadsheet is read too: \
         `\"files\": {{\"static\": {{\"file\": \"m.xlsx\", \"sheet\": \"S1\"}}}}`; and columns may have names of their own: \
         `\"columns\": {{\"static\": {{\"dz_mm\": \"Gauge 1\"}}}}`.\n\nTo see what the nominal arm would show in the poses \
         that you plan, fill in all columns but the readings:\n\n```sh\narmwright predict arm.json static.csv --campaign \
         campaign.json\n```\n",
        arm.name
    );
    if let Some(what) = arm.beyond_positions() {
        out.push_str(&format!(
            "\nAbsolute positions are left out: the arm has {what}, which the model of positions does not know.\n"
        ));
    }
    let known: Vec<Channel> = channels(arm).collect();
    for kind in kinds(joints.len()).into_iter().filter(|kind| known.contains(&kind.channel)) {
        let file = DEFAULT_FILES[kind.channel as usize];
        out.push_str(&format!(
            "\n## {}: `{file}`\n\n{}\n\n{}\n\n| column | unit | what it is |\n|---|---|---|\n",
            kind.title, kind.what, kind.how_many
        ));
        for column in columns_for(kind.channel, joints) {
            let (unit, what) = meaning(kind.channel, &column);
            out.push_str(&format!("| `{column}` | {unit} | {what} |\n"));
        }
    }
    out
}

/// Unit and meaning of the column with the name `column` in the file of the channel.
fn meaning(channel: Channel, column: &str) -> (&'static str, &'static str) {
    match column {
        "test" => ("-", "your label of the row; may be blank"),
        "payload_kg" => ("kg", "mass mounted at the tip; 0 for none"),
        "payload_cg_x_m" => ("m", "its centre of gravity from the tip, in the last frame; blank is 0"),
        "payload_cg_y_m" | "payload_cg_z_m" => ("m", "the same along y, z"),
        "force_x_n" => ("N", "force at the tip, in the world's directions; blank is 0"),
        "force_y_n" | "force_z_n" => ("N", "the same along y, z"),
        "branch" => ("-", "loading or unloading; may be blank"),
        "dx_mm" => ("mm", "displacement along the world's x; blank if it was not measured"),
        "dy_mm" | "dz_mm" => ("mm", "the same along y, z (up)"),
        "sigma_mm" if channel == Channel::Static => (
            "mm",
            "standard deviation of each component: how far repeated readings scatter, for a gauge about a third of a division \
             to one. A component that differs may have a column of its own, such as `sigma_dz_mm`",
        ),
        "sigma_mm" => (
            "mm",
            "standard deviation of each coordinate: how far repeated readings scatter. One that differs may have a column of \
             its own, such as `sigma_z_mm`",
        ),
        "mode" => ("-", "number of the mode, from 1 by rising frequency"),
        "frequency_hz" => ("Hz", "its frequency"),
        "sigma_hz" => ("Hz", "its standard deviation"),
        "joint" => ("-", "name of the joint on the bench"),
        "torque_nm" => ("N m", "torque on it"),
        "windup_arcmin" => ("arcmin", "its twist"),
        "sigma_arcmin" => ("arcmin", "standard deviation of the twist"),
        "point" => ("-", "name of the point on the tool; `tip` if there is one only"),
        "x_mm" => ("mm", "its place along the instrument's x; blank if it was not measured"),
        "y_mm" | "z_mm" => ("mm", "the same along y, z"),
        travel if travel.starts_with("q_") && travel.ends_with("_mm") => {
            ("mm", "travel of the prismatic joint along its axis in `arm.json`")
        }
        angle if angle.starts_with("q_") => {
            ("deg", "angle of the joint, right-handed about its axis in `arm.json`")
        }
        other => unreachable!("{other} of {}", channel.word()),
    }
}
