//! Reads a folder of results: either it has one complete result, or a reason is given why it has none.

use super::failure::Failure;
use super::manifest::{CHOICES, RUN, has_manifest, hash, is_as_written, listed};
use super::result_folder::complete;
use super::version::refuse_earlier;
use crate::report::front_table::FrontTable;
use crate::space::design::{ID_PREFIX, number_of, number_of_earlier};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How many times a folder is read again if its files do not fit together, and the time between two attempts. The
/// reason may be that another process is just replacing the result.
const RETRIES: (u32, Duration) = (3, Duration::from_millis(200));

/// The result of a study, as it is in a folder.
pub(super) struct Results {
    folder: PathBuf,
    /// Contents of `run.json`.
    pub run: Value,
    /// The files of the result with their hashes; `None` for results of early versions, which listed no files.
    files: Option<BTreeMap<String, String>>,
}

/// A file of a result as text.
pub(super) struct TextFile {
    /// Path of the file, for messages.
    pub path: String,
    pub text: String,
}

impl Results {
    /// Opens the result in a folder. A file may be missing, for instance in a partial copy. That is an error only
    /// when the file is read.
    ///
    /// # Errors
    /// There is no `run.json`; an earlier version made the result; a file is not the one that `run.json` lists; or
    /// another process is writing the folder at the moment.
    pub(super) fn open(folder: &Path) -> Result<Self, Failure> {
        let (mut again, wait) = RETRIES;
        loop {
            complete(folder)?;
            let results = Self::read_run(folder)?;
            let strange = results.strange_files();
            if strange.is_empty() {
                return Ok(results);
            }
            if again == 0 {
                return Err(mixture(folder, &strange));
            }
            again -= 1;
            std::thread::sleep(wait);
        }
    }

    /// The result to which a file belongs; `None` if there is no `run.json` in its folder.
    ///
    /// # Errors
    /// The same errors as of [`Results::open`].
    pub(super) fn around(file: &Path) -> Result<Option<Self>, Failure> {
        let folder = crate::report::whole_file::folder_of(file);
        folder.join(RUN).is_file().then(|| Self::open(&folder)).transpose()
    }

    fn read_run(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(RUN);
        if !has_manifest(folder, RUN) {
            return Err(Failure::File(no_result(folder)));
        }
        let text = fs_err::read_to_string(&path).map_err(|e| Failure::File(e.to_string()))?;
        let run: Value = serde_json::from_str(&text)
            .map_err(|e| Failure::File(format!("{} is not JSON: {e}", path.display())))?;
        refuse_earlier(&path, &run)?;
        Ok(Self { folder: folder.to_path_buf(), files: listed(&run), run })
    }

    /// Names of the files that exist but are not those that were written, by what `run.json` says.
    fn strange_files(&self) -> Vec<&str> {
        if !is_as_written(&self.run) {
            return vec![RUN];
        }
        let files = self.files.iter().flatten();
        let differs = |name: &str, listed: &str| match std::fs::read(self.folder.join(name)) {
            Ok(bytes) => hash(&bytes) != listed,
            Err(_) => false,
        };
        files.filter(|(name, listed)| differs(name, listed)).map(|(name, _)| name.as_str()).collect()
    }

    /// The contents of a file of the result.
    ///
    /// # Errors
    /// The file cannot be read, or was replaced after the folder was opened.
    pub(super) fn read(&self, name: &str) -> Result<Vec<u8>, Failure> {
        let path = self.folder.join(name);
        let bytes = fs_err::read(&path).map_err(|e| Failure::File(e.to_string()))?;
        match self.files.as_ref().map(|files| files.get(name)) {
            Some(Some(listed)) if *listed != hash(&bytes) => Err(mixture(&self.folder, &[name])),
            Some(None) => Err(Failure::Check(format!(
                "{} is no file of this result: {} does not list it",
                path.display(),
                self.folder.join(RUN).display()
            ))),
            _ => Ok(bytes),
        }
    }

    /// Whether a file of this name belongs to the result. It is true of every name if the result is of an early
    /// version, which listed no files.
    pub(super) fn has(&self, name: &str) -> bool {
        self.files.as_ref().is_none_or(|files| files.contains_key(name))
    }

    /// Whether a file of this name belongs to the result and exists.
    pub(super) fn is_there(&self, name: &str) -> bool {
        self.has(name) && self.folder.join(name).exists()
    }

    /// A file of the result as text.
    ///
    /// # Errors
    /// The same errors as of [`Results::read`], or the file is not UTF-8.
    pub(super) fn text(&self, name: &str) -> Result<TextFile, Failure> {
        let path = self.folder.join(name).display().to_string();
        match String::from_utf8(self.read(name)?) {
            Ok(text) => Ok(TextFile { path, text }),
            Err(e) => Err(Failure::File(format!("{path}: {e}"))),
        }
    }

    /// A front of the result, from the file of this name.
    ///
    /// # Errors
    /// The same errors as of [`Results::read`], or the file is not a front.
    pub(super) fn front(&self, name: &str) -> Result<FrontTable, Failure> {
        let file = self.folder.join(name);
        FrontTable::parse(&file, &self.read(name)?).map_err(|e| Failure::File(e.to_string()))
    }

    /// The contents of the table `name`, whose first column has names of designs. If the result is of an early version,
    /// the names are replaced by those that this version uses.
    ///
    /// # Errors
    /// The same errors as of [`Results::read`].
    pub(super) fn with_todays_ids(&self, name: &str) -> Result<Vec<u8>, Failure> {
        let bytes = self.read(name)?;
        let is_line_end = |at: usize| bytes[at] == b'\n' && at + 1 < bytes.len();
        if !self.has_earlier_ids() {
            return Ok(bytes);
        }
        let mut out = Vec::with_capacity(bytes.len());
        for (at, byte) in bytes.iter().enumerate() {
            out.push(*byte);
            if is_line_end(at) {
                out.push(ID_PREFIX as u8);
            }
        }
        Ok(out)
    }

    /// Number of the design with this name; `None` if the name is not that of a design.
    pub(super) fn number_of(&self, id: &str) -> Option<u128> {
        if self.has_earlier_ids() { number_of_earlier(id) } else { number_of(id) }
    }

    /// Whether the names of designs lack the `x` at their beginning that this version writes. The names lack it in
    /// results of early versions, which listed no files.
    fn has_earlier_ids(&self) -> bool {
        self.files.is_none()
    }
}

/// Why a folder without `run.json`, or with an empty one, is no result, and what to give instead.
fn no_result(folder: &Path) -> String {
    let shown = folder.display();
    if folder.join(CHOICES).is_file() {
        return format!(
            "{shown} has a result for each choice of springs and counterweights; give the folder of one, or of several to \
             compare, as {shown}/choice-*"
        );
    }
    let what = match (folder.join(RUN).exists(), folder.is_dir()) {
        (true, _) => "has an empty run.json, so it is no result",
        (false, true) => "has no run.json, so it is no result",
        (false, false) => "is no folder",
    };
    format!("{shown} {what}; give a result folder of `armwright run`")
}

fn mixture(folder: &Path, names: &[&str]) -> Failure {
    if names == [RUN] {
        return Failure::Check(format!(
            "{} is not what was written: it was edited; run the study again, or restore the file",
            folder.join(RUN).display()
        ));
    }
    Failure::Check(format!(
        "{} is not one result: {} {} not what its {RUN} lists, so that files of different runs may be mixed or a file was \
         edited; run the study again, or restore the folder",
        folder.display(),
        names.join(", "),
        if names.len() == 1 { "is" } else { "are" }
    ))
}
