//! Blocks of text numbers to `f64` rows and back, bit-exact.
