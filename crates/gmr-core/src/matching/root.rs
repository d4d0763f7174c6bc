//! root (to be written).
