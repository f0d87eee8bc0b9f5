//! The request for an export, and its answer: the files, and what they leave out.

use super::export::{Asked, Format, export};
use super::left_out::LeftOut;
use crate::arm::Arm;
use crate::arm::load::LoadCase;
use crate::catalog::Catalogs;
use crate::mechanics::chain::Chain;

/// Largest number of pieces of a flexible link.
pub(crate) const MOST_PIECES: u16 = 200;

/// An arm to be written for another program.
#[derive(Debug, Clone, Copy)]
pub struct ExportRequest<'a> {
    /// The arm.
    pub arm: &'a Arm,
    /// The load cases of the arm. An export as an arm file has all of them.
    pub cases: &'a [LoadCase],
    /// Name of the case that fixes the pose and, by its loads, the stiffness of joints with a torsion curve. `None`:
    /// the case with the largest tip deflection.
    pub case: Option<&'a str>,
    /// The file format.
    pub format: Format,
    /// Number of pieces into which MJCF divides each flexible link; `None` for rigid links.
    pub pieces_per_link: Option<u16>,
    /// Whether joints in MJCF have the backlash of their gears.
    pub backlash: bool,
}

/// The files of an export.
#[derive(Debug)]
pub struct Exported {
    /// Name of the case in which the arm was exported.
    pub case: String,
    /// Name and content of each file. The last one is `export.json`, which says what the others leave out and which
    /// results the other program should find.
    pub files: Vec<(String, Vec<u8>)>,
    /// Properties of the arm that the files do not represent.
    pub(crate) left_out: Vec<LeftOut>,
    /// Remarks for the reader of the files.
    pub(crate) notes: Vec<String>,
}

impl ExportRequest<'_> {
    /// Writes the arm in the format that is asked for. The files are returned, not written to disk.
    ///
    /// # Errors
    /// The options do not go together, the format cannot represent the arm, or no case has the name that is asked for.
    /// The message says what to do.
    ///
    /// ```
    /// use armwright::arm::{read_arm_document, read_load_cases};
    /// use armwright::catalog::Catalogs;
    /// use armwright::input::Document;
    /// use armwright::interchange::{ExportRequest, Format};
    ///
    /// let catalogs = Catalogs::default();
    /// let arm = r#"{"name": "lever", "chain": [
    ///     {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
    ///     {"type": "link", "name": "l1", "vector_m": [1, 0, 0], "mass_kg": 2}]}"#;
    /// let arm = read_arm_document(Document::parse("arm", arm).expect("JSON"), &catalogs).expect("a sound arm");
    /// let cases = Document::parse("cases", r#"[{"name": "out", "pose_deg": [0]}]"#).expect("JSON");
    /// let cases = read_load_cases(cases, &arm.driven_joints()).expect("sound cases");
    /// let request = ExportRequest {
    ///     arm: &arm, cases: &cases, case: None, format: Format::Mjcf, pieces_per_link: None, backlash: false,
    /// };
    /// let exported = request.answer(&catalogs).expect("files");
    /// assert_eq!(exported.case, "out");
    /// assert!(exported.files.iter().any(|(name, _)| name == "export.json"));
    /// ```
    pub fn answer(&self, catalogs: &Catalogs) -> Result<Exported, String> {
        self.suits_the_format()?;
        let asked = Asked {
            arm: self.arm,
            case: self.chosen_case()?,
            cases: self.cases,
            format: self.format,
            pieces: self.pieces_per_link.map_or(0, usize::from),
            backlash: self.backlash,
        };
        let exported = export(&asked, catalogs);
        let about = format!("{:#}", exported.to_json(&asked)).into_bytes();
        let mut files = exported.files;
        files.push(("export.json".into(), about));
        let (left_out, notes) = (exported.left_out, exported.notes);
        Ok(Exported { case: asked.case.name.clone(), files, left_out, notes })
    }

    /// Refuses options of another format, and a prismatic joint for CalculiX.
    fn suits_the_format(&self) -> Result<(), String> {
        if self.format != Format::Mjcf && (self.pieces_per_link.is_some() || self.backlash) {
            return Err("flexible links and backlash are for mjcf".into());
        }
        if self.pieces_per_link.is_some_and(|pieces| !(1..=MOST_PIECES).contains(&pieces)) {
            return Err(format!("a link is cut into 1 to {MOST_PIECES} pieces"));
        }
        match (self.arm.prismatics().next(), self.format) {
            (Some(joint), Format::Calculix) => Err(format!(
                "{} is a prismatic joint: the decks of CalculiX join links by hinges between two points, and have nothing that \
                 slides; mjcf with flexible links has its springs",
                joint.name
            )),
            _ => Ok(()),
        }
    }

    fn chosen_case(&self) -> Result<&LoadCase, String> {
        if let Some(name) = self.case {
            let names: Vec<&str> = self.cases.iter().map(|case| case.name.as_str()).collect();
            let unknown = || format!("no case is called \"{name}\"; the cases are: {}", names.join(", "));
            return self.cases.iter().find(|case| case.name == name).ok_or_else(unknown);
        }
        let deflection_m = |case: &LoadCase| {
            let chain = Chain::new(&self.arm.structure_in(case), case.links);
            chain.pose(case).statics().tip_displacement_m.norm()
        };
        // of cases with equal deflections, the first one is taken
        let worst = self.cases.iter().rev().max_by(|a, b| deflection_m(a).total_cmp(&deflection_m(b)));
        worst.ok_or_else(|| "there is no case".into())
    }
}
