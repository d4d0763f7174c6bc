//! Forward kinematics of many frames at once.
