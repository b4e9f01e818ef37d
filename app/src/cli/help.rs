//! Options of `help`.

use clap::Args;
use gsk_core::model::ModelId;

/// Arguments of the command `help`.
#[derive(Args, Debug)]
pub struct HelpArgs {
    /// A command or a symbol: `alarm 31`, `022`, `004.3`, `G71`, `key CS`, `page oft`, `X0.5`, or
    /// words to search for
    #[arg(value_name = "TOPIC")]
    pub topic: Vec<String>,
    /// List the topics
    #[arg(long, conflicts_with = "topic")]
    pub list: bool,
    /// Print all topics as one HTML page
    #[arg(long, conflicts_with_all = ["topic", "list"])]
    pub document: bool,
    /// The control model [default: gsk980td]
    #[arg(long, value_name = "MODEL", value_parser = gsk_host::setup_args::model_parser())]
    pub model: Option<ModelId>,
}
