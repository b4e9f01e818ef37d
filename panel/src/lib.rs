//! The operator panel: keys, faceplate, LCD pages, rasteriser.

pub mod bitmap;
pub mod emulator;
pub mod english;
pub mod faceplate;
pub mod glyphs;
pub mod keys;
pub mod pages;
pub mod panel;
pub mod raster;
pub mod screen;
pub mod script;
pub mod trace;
