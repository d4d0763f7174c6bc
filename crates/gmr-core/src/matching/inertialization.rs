//! inertialization (to be written).
