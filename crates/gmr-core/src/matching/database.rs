//! database (to be written).
