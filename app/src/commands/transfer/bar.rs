//! Progress bars and port selection of `transfer`.

use std::io::{self, IsTerminal};

use gsk_host::pc::{TransferObserver, TransferSession, TransferSettings, load_window_settings};
use gsk_messages::say;
use gsk_transfer::{FileName, TransferProgress};
use indicatif::{ProgressBar, ProgressStyle};
use web_time::Duration;

use super::{CommandError, output};
use crate::cli::TransferPortArgs;

/// A progress bar for a file transfer on a terminal; holds `None` if standard error is no
/// terminal.
#[derive(Default)]
struct TransferBar(Option<ProgressBar>);

impl TransferObserver for TransferBar {
    fn on_begin(&mut self, name: &FileName, size: usize) {
        self.0 = create_bar(name, size);
    }

    fn on_progress(&mut self, progress: TransferProgress, retries: u64) {
        if let Some(bar) = &self.0 {
            bar.set_length(progress.total as u64);
            bar.set_position(progress.done as u64);
            bar.set_prefix(retries.to_string());
        }
    }

    fn on_end(&mut self) {
        if let Some(bar) = self.0.take() {
            bar.finish_and_clear();
        }
    }
}

fn create_bar(name: &FileName, size: usize) -> Option<ProgressBar> {
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

/// Returns the port and its speed in bits per second: from the options, else from the window's
/// settings. Returns an error if neither names a port.
pub(in crate::commands) fn select_port(
    args: &TransferPortArgs,
) -> Result<(String, u32), CommandError> {
    let settings = match &args.port {
        Some(port) => TransferSettings {
            port: port.clone(),
            ..TransferSettings::default()
        },
        None => load_window_settings().ok_or_else(say::transfer_no_port)?,
    };
    Ok((settings.port, args.baud.unwrap_or(settings.baud)))
}

/// Opens the port without connecting to the control. Returns an error if it cannot be opened.
pub(super) fn open_port(args: &TransferPortArgs) -> Result<TransferSession, CommandError> {
    let (port, baud) = select_port(args)?;
    Ok(TransferSession::open(
        &port,
        baud,
        Box::new(TransferBar::default()),
    )?)
}

pub(super) fn connect_to_control(args: &TransferPortArgs) -> Result<TransferSession, CommandError> {
    let mut talk = open_port(args)?;
    talk.connect()?;
    Ok(talk)
}

/// Prints the amount transferred, the rate and the number of retries (传输速率, 重试次数).
pub(super) fn print_rate(talk: &TransferSession) {
    output::print_message(&talk.totals().message());
}
