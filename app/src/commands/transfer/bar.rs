//! Progress bars and port selection of `transfer`.

use std::io::{self, IsTerminal};

use gsk_transfer::{FileName, TransferProgress};
use indicatif::{ProgressBar, ProgressStyle};
use web_time::Duration;

use super::{CommandError, output};
use crate::cli::TransferPortArgs;
use crate::pc::{Remembered, Talk, Watch, of_window};

/// A progress bar on a terminal; `None` elsewhere.
#[derive(Default)]
struct Bar(Option<ProgressBar>);

impl Watch for Bar {
    fn begins(&mut self, name: &FileName, size: usize) {
        self.0 = bar(name, size);
    }

    fn moves(&mut self, progress: TransferProgress, retries: u64) {
        if let Some(bar) = &self.0 {
            bar.set_length(progress.total as u64);
            bar.set_position(progress.done as u64);
            bar.set_prefix(retries.to_string());
        }
    }

    fn ends(&mut self) {
        if let Some(bar) = self.0.take() {
            bar.finish_and_clear();
        }
    }
}

fn bar(name: &FileName, size: usize) -> Option<ProgressBar> {
    if !io::stderr().is_terminal() {
        return None;
    }
    let bar = ProgressBar::new(size as u64).with_message(name.to_string());
    let style = "{msg:12} {bar:30} {bytes}/{total_bytes}  {bytes_per_sec}  ×{prefix}";
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    Some(bar)
}

/// The port and its speed in bits per second: from the command line, else from the window's
/// settings.
pub(super) fn port(args: &TransferPortArgs) -> Result<(String, u32), CommandError> {
    let last = match &args.port {
        Some(port) => Remembered {
            port: port.clone(),
            ..Remembered::default()
        },
        None => of_window().ok_or(CommandError::NoTransferPort)?,
    };
    Ok((last.port, args.baud.unwrap_or(last.baud)))
}

/// Opens the port without a query to the control.
pub(super) fn open(args: &TransferPortArgs) -> Result<Talk, CommandError> {
    let (port, baud) = port(args)?;
    Ok(Talk::open(&port, baud, Box::new(Bar::default()))?)
}

pub(super) fn connect(args: &TransferPortArgs) -> Result<Talk, CommandError> {
    let mut talk = open(args)?;
    talk.connect()?;
    Ok(talk)
}

/// Says what has gone and how fast (传输速率, 重试次数).
pub(super) fn say_rate(talk: &Talk) {
    output::say(&talk.traffic().message());
}
