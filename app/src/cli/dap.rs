//! Options of `dap`.

use clap::Args;
use gsk_host::setup_args::SetupArgs;

/// Arguments of the command `dap`.
#[derive(Args, Debug)]
pub struct DapArgs {
    #[command(flatten)]
    pub setup: SetupArgs,
}
