//! What can be wrong with a saved database, in sentences.

use std::path::PathBuf;
use std::{fmt, io};

use safetensors::SafeTensorError;

use super::super::index::IndexError;
use super::VERSION;

/// Why a database cannot be saved or opened.
#[derive(Debug)]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub fault: Fault,
}

/// What is wrong with a file.
#[derive(Debug)]
pub enum Fault {
    /// The system refuses.
    Io(io::Error),
    /// It is no safetensors container.
    Container(SafeTensorError),
    /// It is one, but not of a motion database.
    Content(String),
    /// It is a motion database as another gmr keeps it.
    Version {
        /// The version that it is of.
        found: u32,
    },
    /// The index that is to be saved cannot be made.
    Index(IndexError),
}

pub(super) fn content(what: impl ToString) -> Fault {
    Fault::Content(what.to_string())
}

impl From<IndexError> for Fault {
    fn from(error: IndexError) -> Self {
        Self::Index(error)
    }
}

impl From<serde_json::Error> for Fault {
    fn from(error: serde_json::Error) -> Self {
        content(format!("its description is not as it should be: {error}"))
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.fault)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::Container(error) => {
                let error = shortened(&error.to_string());
                write!(f, "{error}; a saved motion database begins with the header of a safetensors file")
            }
            Self::Content(what) => write!(f, "{}; save the database again", shortened(what)),
            Self::Version { found } => write!(
                f,
                "it is of version {found}, where this gmr reads version {VERSION}; build the database of its clips \
                 again and save that"
            ),
            Self::Index(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for FileError {}

/// Characters of a reason at most.
const MOST: usize = 600;

/// Without its middle where it is long: a reason may quote all that a broken header holds.
fn shortened(reason: &str) -> String {
    let count = reason.chars().count();
    if count <= MOST {
        return reason.to_owned();
    }
    let begin = reason.chars().take(MOST / 2);
    begin.chain(" ... ".chars()).chain(reason.chars().skip(count - MOST / 2)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_reason_keeps_its_ends() {
        let reason = format!("a\u{e4}{}z", "x".repeat(5000));
        let told = content(&reason).to_string();
        assert!(told.starts_with("a\u{e4}x") && told.contains("xz; save"), "{told}");
        assert!(told.chars().count() < MOST + 50);
        assert_eq!(shortened("short"), "short");
    }
}
