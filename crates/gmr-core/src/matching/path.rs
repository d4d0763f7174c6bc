//! path (to be written).
