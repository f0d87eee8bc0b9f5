//! `armwright analyze`: statics, modes and response of an arm file.

use super::failure::Failure;
use super::pose_flags::PoseArgs;
use super::values::{choice, non_negative, numbers};
use super::wrong_kind::refuse_other_kind;
use crate::arm::file::read_arm;
use crate::arm::load::{LoadCase, Payload, read_load_cases};
use crate::arm::{Arm, JointModel, LinkModel};
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::report::analysis::{Analysis, Harmonic};
use crate::report::words::{TERMINAL, wrap};
use crate::study::arm_remarks::{arm_remarks, ignored_words};
use clap::Args;
use nalgebra::Vector3;
use serde_json::Value;
use std::path::PathBuf;

/// Prints the joint torques, the tip displacement with every element's share of it, the natural frequencies,
/// and where the strain energy of each mode sits.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright analyze arm.json --pose-deg 0,-30,60 --payload-kg 5 --payload-cg-m 0.05,0,0\n\
                        With a rail: armwright analyze gantry.json --pose rail_mm=250,j2_deg=30\n\
                        Response: armwright analyze arm.json --response-n 0,0,1 --response-hz 1,100,200 --damping 0.02"
)]
pub(crate) struct AnalyzeArgs {
    /// Arm file (JSON)
    arm: PathBuf,
    #[command(flatten)]
    pose: PoseArgs,
    /// Payload mass [kg]
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true, value_parser = non_negative)]
    payload_kg: f64,
    /// Payload centre of gravity from the tip, last frame [m]
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true, value_parser = numbers::<3>)]
    payload_cg_m: [f64; 3],
    /// Payload moments of inertia about its centre [kg m2]
    #[arg(long, value_name = "IXX,IYY,IZZ", default_value = "0,0,0", allow_hyphen_values = true, value_parser = moments)]
    payload_inertia_kgm2: [f64; 3],
    /// Force at the tip, world axes [N]
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true, value_parser = numbers::<3>)]
    force_n: [f64; 3],
    /// Moment at the tip, world axes [N m]
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true, value_parser = numbers::<3>)]
    moment_nm: [f64; 3],
    /// Link model: rigid, bending (Eqs 1-6) or full
    #[arg(long, default_value = "full", value_parser = choice::<LinkModel>(), hide_possible_values = true)]
    links: LinkModel,
    /// Joint model: k2 (the paper's single number), three_segment, or three_segment_k1 (modes with the
    /// gears' first slope)
    #[arg(long, default_value = "three_segment", value_parser = choice::<JointModel>(), hide_possible_values = true)]
    joints: JointModel,
    /// How many modes to print
    #[arg(long, default_value_t = 6)]
    modes: usize,
    /// Take pose, payload and models from a cases file instead of these options
    #[arg(long, value_name = "FILE", conflicts_with_all = ["pose_deg", "pose", "payload_kg", "payload_cg_m", "payload_inertia_kgm2", "force_n", "moment_nm", "links", "joints"])]
    cases: Option<PathBuf>,
    /// Amplitude of a harmonic force at the tip, world axes [N]: prints the tip's response (Eq 16)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = numbers::<3>)]
    response_n: Option<[f64; 3]>,
    /// Damping ratio of every mode
    #[arg(long, requires = "response_n", default_value_t = 0.02, allow_hyphen_values = true, value_parser = non_negative)]
    damping: f64,
    /// Frequencies of the response: from, to [Hz] and number of points
    #[arg(long, requires = "response_n", value_name = "FROM,TO,POINTS", default_value = "1,100,100", allow_hyphen_values = true, value_parser = frequencies)]
    response_hz: Frequencies,
    /// Print JSON, every number to the last digit
    #[arg(long)]
    json: bool,
}

/// Three moments of inertia, none negative.
fn moments(text: &str) -> Result<[f64; 3], String> {
    let moments = numbers::<3>(text)?;
    match moments.iter().all(|&i| i >= 0.0) {
        true => Ok(moments),
        false => Err("a moment of inertia is not negative".into()),
    }
}

/// Frequencies at which the response is computed \[Hz\].
#[derive(Debug, Clone)]
struct Frequencies(Vec<f64>);

fn frequencies(text: &str) -> Result<Frequencies, String> {
    let [from, to, points] = numbers::<3>(text)?;
    if from < 0.0 || to <= from {
        return Err("give two frequencies, the second above the first and none negative".into());
    }
    if points.fract() != 0.0 || !(2.0..=100_000.0).contains(&points) {
        return Err(format!("{points} points: give a whole number from 2 to 100000"));
    }
    let last = points - 1.0;
    Ok(Frequencies((0..points as usize).map(|i| from + (to - from) * i as f64 / last).collect()))
}

impl AnalyzeArgs {
    /// The harmonic force whose response is to be computed; `None` if the user asks for no response.
    fn harmonic(&self) -> Option<Harmonic> {
        let force_n = Vector3::from(self.response_n?);
        Some(Harmonic { force_n, damping: self.damping, frequencies_hz: self.response_hz.0.clone() })
    }
}

/// Runs `armwright analyze` and returns the text to print.
pub(super) fn run(args: &AnalyzeArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    refuse_other_kind(&args.arm, "arm")?;
    let arm = read_arm(&args.arm, catalogs)?;
    let cases = match &args.cases {
        Some(path) => {
            refuse_other_kind(path, "cases")?;
            read_load_cases(Document::read(path)?, &arm.driven_joints())?
        }
        None => vec![case_of_flags(args, &arm)?],
    };
    let harmonic = args.harmonic();
    let solve = |case| Analysis::of(&arm, case, args.modes, harmonic.as_ref());
    let solved: Vec<Analysis> = cases.into_iter().map(solve).collect();
    Ok(match (args.json, &args.cases) {
        (true, None) => pretty(&solved[0].to_json(&arm)),
        (true, Some(_)) => pretty(&Value::Array(solved.iter().map(|s| s.to_json(&arm)).collect())),
        (false, _) => {
            let text = solved.iter().map(|s| s.to_text(&arm)).collect::<Vec<_>>().join("\n");
            let ignored = ignored_words(&arm).map_or(String::new(), |words| format!("  {words}\n"));
            let remarks: String =
                arm_remarks(&arm, catalogs).iter().map(|words| wrap(words, TERMINAL, "")).collect();
            text + &ignored + &remarks
        }
    })
}

fn pretty(value: &Value) -> String {
    serde_json::to_string_pretty(value).expect("a value of numbers and strings serializes")
}

fn case_of_flags(args: &AnalyzeArgs, arm: &Arm) -> Result<LoadCase, Failure> {
    Ok(LoadCase {
        name: "case".into(),
        pose_deg: args.pose.entries(&arm.driven_joints())?,
        payload: Payload {
            mass_kg: args.payload_kg,
            cg_m: args.payload_cg_m.into(),
            inertia_about_cg_kgm2: args.payload_inertia_kgm2.into(),
        },
        tip_force_n: args.force_n.into(),
        tip_moment_nm: args.moment_nm.into(),
        links: args.links,
        joints: args.joints,
        water: None,
    })
}
