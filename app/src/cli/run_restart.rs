//! Options of `run` that begin in the middle of a program.

use clap::Args;

/// The block at which `run` begins.
#[derive(Args, Debug)]
pub struct RunRestartArgs {
    /// Begin at this block: compute the state that a run from the head would have there, print what differs, go to the start point and continue. Written as for --break
    #[arg(long, value_name = "WHERE", conflicts_with = "dnc")]
    pub restart: Option<String>,
    /// Begin at this pass of the cycle in the block of --restart
    #[arg(long, value_name = "N", requires = "restart", value_parser = clap::value_parser!(u64).range(1..))]
    pub restart_pass: Option<u64>,
    /// Put these words in place of those of the program at the block of --restart, separated by
    /// commas: S, F, T (tool number), M03 to M05, M08 and M09
    #[arg(
        long,
        value_name = "WORDS",
        requires = "restart",
        value_delimiter = ','
    )]
    pub restart_words: Vec<String>,
    /// Confirm the list of differences of --restart on a real machine, with the code that the run
    /// prints below it [default: a question at the terminal for each difference]
    #[arg(long, value_name = "CODE", requires = "restart", requires = "link")]
    pub confirm: Option<String>,
}
