//! Which rows of a database are left where some are gone.

use std::sync::OnceLock;

use super::column::Column;

/// Which rows of a database are left (N), and which of them may be jumped to (N).
#[derive(Debug, Clone)]
pub(super) struct Left {
    /// 0 where a row is gone.
    rows: Column<u8>,
    /// Made when it is asked for.
    candidates: OnceLock<Vec<bool>>,
}

impl Left {
    /// Those that are not 0.
    pub(super) fn new(rows: impl Into<Column<u8>>) -> Self {
        Self { rows: rows.into(), candidates: OnceLock::new() }
    }

    pub(super) fn has(&self, row: u32) -> bool {
        self.rows[row as usize] != 0
    }

    /// As a file keeps them.
    #[cfg(feature = "file")]
    pub(super) fn rows(&self) -> &[u8] {
        &self.rows
    }

    /// Those that may be jumped to, found by `among` when they are first asked for.
    pub(super) fn candidates(&self, among: impl FnOnce(&[u8]) -> Vec<bool>) -> &[bool] {
        self.candidates.get_or_init(|| among(&self.rows))
    }
}
