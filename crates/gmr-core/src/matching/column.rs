//! Numbers of a database, one entry a row: in memory of their own, or in that of a mapped file.

use std::ops::Deref;

#[cfg(feature = "file")]
use std::sync::Arc;

use super::aligned::{Aligned, Number};

/// A column, not to be changed.
#[derive(Debug, Clone)]
pub(super) struct Column<T: Number>(Source<T>);

#[derive(Debug, Clone)]
enum Source<T: Number> {
    Owned(Vec<T>),
    Aligned(Aligned<T>),
    /// The values lie in the map, which they keep alive; they are never handed out for longer than the column lives.
    #[cfg(feature = "file")]
    Mapped {
        values: &'static [T],
        _map: Arc<memmap2::Mmap>,
    },
}

impl<T: Number> Deref for Column<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        match &self.0 {
            Source::Owned(values) => values,
            Source::Aligned(values) => values.as_slice(),
            #[cfg(feature = "file")]
            Source::Mapped { values, .. } => values,
        }
    }
}

impl<T: Number> From<Vec<T>> for Column<T> {
    fn from(values: Vec<T>) -> Self {
        Self(Source::Owned(values))
    }
}

impl<T: Number> From<Aligned<T>> for Column<T> {
    fn from(values: Aligned<T>) -> Self {
        Self(Source::Aligned(values))
    }
}

#[cfg(feature = "file")]
impl<T: Number> Column<T> {
    /// What `see` makes of the map: some part of it.
    pub(super) fn mapped<E>(
        map: &Arc<memmap2::Mmap>,
        see: impl for<'a> FnOnce(&'a [u8]) -> Result<&'a [T], E>,
    ) -> Result<Self, E> {
        let values = see(map)?;
        // SAFETY: `see` knows nothing of the map's lifetime, so what it returns lies in the map or is static. The map
        // is not written to and does not move while the Arc beside the values keeps it.
        let values = unsafe { std::slice::from_raw_parts(values.as_ptr(), values.len()) };
        Ok(Self(Source::Mapped { values, _map: Arc::clone(map) }))
    }
}
