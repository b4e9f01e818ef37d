//! The operator panel: keys, faceplate, LCD pages, rasteriser.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod alarm_log;
pub mod bitmap;
pub mod emulator;
pub mod face;
pub mod faceplate;
pub mod fonts;
pub mod glyphs;
pub mod keys;
pub mod lcd;
pub mod pages;
pub mod panel;
pub mod raster;
pub mod refusal;
pub mod screen;
pub mod script;
pub mod signals;
pub mod trace;
pub mod why;
