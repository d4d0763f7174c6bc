//! trial (to be written).
