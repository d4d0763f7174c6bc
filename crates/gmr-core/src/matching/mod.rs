//! Motion matching: simulation root, features, exact nearest-neighbour index, trials, and
//! [`character::Character`], which a game steps.

mod aligned;
mod body;
pub mod builder;
pub mod carriers;
pub mod character;
mod column;
pub mod controller;
pub mod database;
pub mod database_error;
pub mod features;
#[cfg(all(feature = "file", target_endian = "little"))]
pub mod file;
pub mod ground;
pub mod index;
pub mod inertialization;
mod left;
pub mod matcher;
pub mod normalization;
pub mod path;
pub mod playback;
mod pose;
pub mod request;
pub mod root;
pub mod settings;
pub mod start;
mod subset;
pub mod trial;
