//! Options of `run` that begin in the middle of a program.

use clap::Args;

/// The block at which `run` begins.
#[derive(Args, Debug)]
pub struct RunRestartArgs {
    /// Begin at this block: compute the state that a run from the head would have there, print what differs, go to the start point and continue. Written as for --break
    #[arg(long, value_name = "WHERE", conflicts_with_all = ["link", "dnc"])]
    pub restart: Option<String>,
    /// Begin at this pass of the cycle in the block of --restart
    #[arg(long, value_name = "N", requires = "restart", value_parser = clap::value_parser!(u64).range(1..))]
    pub restart_pass: Option<u64>,
}
