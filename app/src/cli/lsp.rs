//! Options of `lsp`.

use clap::Args;
use gsk_host::setup_args::SetupArgs;

/// Arguments of the command `lsp`.
#[derive(Args, Debug)]
pub struct LspArgs {
    /// Standard input and output, as some editors ask for: there is nothing else
    #[arg(long, hide = true)]
    pub stdio: bool,
    #[command(flatten)]
    pub setup: SetupArgs,
}
