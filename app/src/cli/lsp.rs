//! Options of `lsp`.

use clap::Args;
use gsk_messages::Language;

use super::language;
use crate::setup_args::SetupArgs;

/// `lsp`.
#[derive(Args, Debug)]
pub struct LspArgs {
    /// Options of control and lathe.
    #[command(flatten)]
    pub setup: SetupArgs,
    /// Language of alarms and explanations [default: as the editor says, else English]
    #[arg(long, value_parser = language(), value_name = "LANG")]
    pub lang: Option<Language>,
    /// Standard input and output, as some editors ask for: there is nothing else
    #[arg(long, hide = true)]
    pub stdio: bool,
}
