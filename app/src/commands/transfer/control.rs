//! `transfer control`: a control without a window at the other end of the line.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::RecvTimeoutError;
use gsk_core::cnc::ControlRequest;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_messages::{Message, say};
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::keys::Key;
use gsk_panel::panel::SerialCable;

use gsk_host::files::data_dir::DataDir;
use gsk_host::files::{program_file, subprograms};
use gsk_host::kernel::{Command, Console, Kernel, KernelEnvironment, Notice, start};
use gsk_host::loading::{self, LoadError};
use gsk_host::pc::FilesError;
use gsk_host::retained::{self, Keeper};
use gsk_host::serial::{SerialEnd, SerialLine};
use gsk_host::termination::TerminationFlag;
use web_time::Instant;

use super::super::{CommandError, EXIT_OK, output};
use crate::cli::{TextEnd, TransferControlArgs};

/// Limit of the machine time that the self-test may take after power-on, ms.
const MAX_SELF_TEST_MS: u64 = 20_000;
/// Time between two checks for a termination signal.
const POLL_INTERVAL: Duration = Duration::from_millis(100);

/// Simulates a control at its serial port until Ctrl-C. Returns the exit code.
pub(super) fn run_control(args: &TransferControlArgs) -> Result<u8, CommandError> {
    args.setup.refuse_mill().map_err(LoadError::from)?;
    let mut setup =
        loading::with_training_lathe(Setup::for_operator_script(), args.setup.machine.as_ref());
    let data = match &args.setup.data_folder() {
        Some(folder) => Some(Arc::new(DataDir::open(folder)?)),
        None => None,
    };
    let restored = retained::load_and_report(data.as_deref(), &mut setup);
    loading::apply_options(&mut setup, &args.setup)?;
    let pending_number = args
        .out
        .as_deref()
        .map(|file| load_program(file, &mut setup));
    let mut pending_number = pending_number.transpose()?;
    let mut emulator = Emulator::new(setup);
    if let Some(restored) = &restored {
        restored.restore_panel(&mut emulator);
    }
    emulator.run_until(&WaitCondition::SelfTestOver, MAX_SELF_TEST_MS);
    if args.parameter_switch {
        for request in [
            ControlRequest::SetParameterSwitch(true),
            ControlRequest::CancelSwitchAlarm,
        ] {
            // The alarm of the switch is cancelled at once. A control without the right
            // leaves the switch off.
            let _ = emulator.request(request);
        }
        // A ladder is received in edit mode only.
        emulator.press(Key::Edit);
    }
    emulator.connect_cable(SerialCable::Line);
    let ending = TerminationFlag::install_signal_handlers()?;
    let line = SerialLine::open(
        SerialEnd::from_name(&args.port),
        args.text.map(TextEnd::to_line_end),
    );
    let line = line.map_err(CommandError::gone)?;
    let keeper = match (data, &restored) {
        (Some(data), Some(restored)) => {
            Some(Keeper::start(data, restored, &emulator).map_err(CommandError::gone)?)
        }
        _ => None,
    };
    let (mut kernel, console) = Kernel::new(emulator);
    kernel.connect_serial_line(line);
    let outside = KernelEnvironment {
        wake: Box::new(|| {}),
        keeper,
        partner_folder: None,
        udisk_folder: None,
        termination: ending.clone(),
    };
    let mut thread = start(kernel, &console, outside).map_err(CommandError::gone)?;
    let mut port_printed_at = None;
    while !ending.is_requested() && thread.is_alive() {
        let is_due = port_printed_at
            .is_some_and(|at: Instant| at.elapsed() >= Duration::from_secs(args.out_after));
        if is_due && let Some(number) = pending_number.take() {
            press_out(&console, number);
        }
        match console.notices.recv_timeout(POLL_INTERVAL) {
            Ok(Notice::Message(message)) => print_message(&message, &mut port_printed_at),
            Ok(_) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    thread.stop();
    Ok(EXIT_OK)
}

/// Prints a message of the control. Before the first message about the port, prints the name
/// of the port alone on a line, for scripts.
fn print_message(message: &Message, port_printed_at: &mut Option<Instant>) {
    if port_printed_at.is_none()
        && let Some(port) = message.plain_value("port")
    {
        *port_printed_at = Some(Instant::now());
        output::print(&format!("{port}\n"));
        output::print_message(&say::transfer_serves());
    }
    output::print_message(message);
}

/// Stores the program of a file in the control's memory and returns its number. Returns an error if
/// the file cannot be read or the memory refuses it.
fn load_program(path: &Path, setup: &mut Setup) -> Result<u16, CommandError> {
    let file = program_file::read(path)?;
    let program_number = Program::new(file.text).number();
    let number = program_number.or_else(|| subprograms::parse_number_in_name(path));
    let number = number.ok_or_else(|| FilesError::NoName(path.to_owned()))?;
    loading::store_files(&mut setup.memory.programs, &[path.to_owned()])?.print(None);
    Ok(number)
}

/// Presses the keys that punch out a program: EDIT, PROGRAM, O, the number and OUT.
fn press_out(console: &Console, number: u16) {
    console.send(Command::Tap(Key::Edit));
    console.send(Command::Tap(Key::Program));
    for character in format!("O{number}").chars() {
        console.send(Command::Type(character));
    }
    console.send(Command::Tap(Key::Output));
}
