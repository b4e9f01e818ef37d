//! Options of `dialect`.

use std::path::PathBuf;

use clap::Args;
use gsk_core::model::ModelId;

/// `dialect`.
#[derive(Args, Debug)]
pub struct DialectArgs {
    /// The program
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The model that it was written for
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::model_parser())]
    pub from: ModelId,
    /// The model that is to read it
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::model_parser())]
    pub to: ModelId,
    /// Write the program for the other model into this file
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}
