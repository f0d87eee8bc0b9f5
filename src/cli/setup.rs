//! The settings that all verbs share: the catalogs, and the log for messages.

use super::log::Log;
use crate::catalog::Catalogs;
use std::path::Path;

/// The settings that all verbs share.
#[derive(Clone, Copy)]
pub(crate) struct Setup<'a> {
    /// The built-in catalogs with the user's rows.
    pub catalogs: &'a Catalogs,
    /// Folder with the user's catalog rows; `None` if there is none.
    pub overlay: Option<&'a Path>,
    /// Log for messages and progress.
    pub log: Log,
}
