//! Options of `load`.

use clap::{Args, Subcommand};
use gsk_host::setup_args;

/// Commands about cutting force and cutting values.
#[derive(Debug, Subcommand)]
pub enum LoadCommand {
    /// Print the table of materials: kc1.1, mc, and the source of both
    Materials,
    /// Print speed, feed and depth to start with, and the load of their mean values
    Values(LoadValuesArgs),
}

/// Arguments of the command `load values`.
#[derive(Args, Debug)]
pub struct LoadValuesArgs {
    /// The material, as `load materials` lists it
    #[arg(value_name = "MATERIAL")]
    pub material: String,
    /// Diameter of the part for the spindle speed, mm
    #[arg(long, value_name = "MM", value_parser = setup_args::parse_number)]
    pub diameter: Option<f64>,
    /// Nose radius of the insert, mm: the feed of turning is at most two thirds of it
    #[arg(long, value_name = "MM", default_value = "0.8", value_parser = setup_args::parse_number)]
    pub nose: f64,
}
