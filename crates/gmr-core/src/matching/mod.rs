//! Motion matching: simulation root, features, exact nearest-neighbour index, controller and trials.

pub mod builder;
pub mod carriers;
pub mod controller;
pub mod database;
pub mod features;
pub mod ground;
pub mod index;
pub mod inertialization;
pub mod normalization;
pub mod path;
pub mod playback;
mod pose;
pub mod request;
pub mod root;
pub mod start;
mod subset;
pub mod trial;
