//! `transfer control`: a control without a window at the other end of the line.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::RecvTimeoutError;
use gsk_core::cnc::Request;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_messages::{Message, say};
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::keys::Key;

use web_time::Instant;

use super::super::{CommandError, FINE, output};
use crate::cli::{TextEnd, TransferControlArgs};
use crate::ending::Ending;
use crate::files::data_dir::DataDir;
use crate::files::{program_file, subprograms};
use crate::kernel::{Command, Console, Kernel, Notice, Outside, start};
use crate::loading::{self, LoadError};
use crate::pc::FilesError;
use crate::retained::{self, Keeper};
use crate::serial::{End, SerialLine};

/// Upper limit of the duration of the self-test, ms.
const SELF_TEST: u64 = 20_000;
/// Interval at which the end request is polled.
const LOOK: Duration = Duration::from_millis(100);

/// Simulates the control until Ctrl-C.
pub(super) fn control(args: &TransferControlArgs) -> Result<u8, CommandError> {
    args.setup.refuse_mill().map_err(LoadError::from)?;
    let mut setup = loading::fitted(Setup::at_the_panel(), args.setup.machine.as_ref());
    let data = match &args.setup.data_folder() {
        Some(folder) => Some(Arc::new(DataDir::open(folder)?)),
        None => None,
    };
    let restored = retained::bring_back(data.as_deref(), &mut setup);
    loading::apply(&mut setup, &args.setup)?;
    let out = args.out.as_deref().map(|file| load(file, &mut setup));
    let mut out = out.transpose()?;
    let mut emulator = Emulator::new(setup);
    if let Some(restored) = &restored {
        restored.restore_panel(&mut emulator);
    }
    emulator.run_until(&WaitCondition::SelfTestOver, SELF_TEST);
    if args.parameter_switch {
        for request in [
            Request::SetParameterSwitch(true),
            Request::CancelSwitchAlarm,
        ] {
            // The alarm of the switch is cancelled at once. A control without the right
            // leaves the switch off.
            let _ = emulator.simulation.cnc.request(request);
        }
    }
    emulator.panel.connect_port();
    let ending = Ending::heard()?;
    let line = SerialLine::open(End::of(&args.port), args.text.map(TextEnd::line_end));
    let line = line.map_err(CommandError::Gone)?;
    let keeper = match (data, &restored) {
        (Some(data), Some(restored)) => {
            Some(Keeper::start(data, restored, &emulator).map_err(CommandError::Gone)?)
        }
        _ => None,
    };
    let (mut kernel, console) = Kernel::new(emulator);
    kernel.take_serial_line(line);
    let outside = Outside {
        wake: Box::new(|| {}),
        keeper,
        partner: None,
        ending: ending.clone(),
    };
    let mut thread = start(kernel, &console, outside).map_err(CommandError::Gone)?;
    let mut named = None;
    while !ending.is_asked() && thread.is_alive() {
        let due =
            named.is_some_and(|at: Instant| at.elapsed() >= Duration::from_secs(args.out_after));
        if due && let Some(number) = out.take() {
            press_out(&console, number);
        }
        match console.notices.recv_timeout(LOOK) {
            Ok(Notice::Said(said)) => print(&said, &mut named),
            Ok(_) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    thread.stop();
    Ok(FINE)
}

/// Prints a message of the port. Before the first line prints the port's name alone, for
/// scripts.
fn print(said: &Message, named: &mut Option<Instant>) {
    if named.is_none()
        && let Some(port) = said.plain_value("port")
    {
        *named = Some(Instant::now());
        output::print(&format!("{port}\n"));
        output::say(&say::transfer_serves());
    }
    output::say(said);
}

/// Stores a program in the memory and returns its number.
fn load(path: &Path, setup: &mut Setup) -> Result<u16, CommandError> {
    let file = program_file::read(path)?;
    let own = Program::new(file.text).number();
    let number = own.or_else(|| subprograms::number_in_name(path));
    let number = number.ok_or_else(|| FilesError::NoName(path.to_owned()))?;
    loading::store_files(&mut setup.memory.programs, &[path.to_owned()])?.print(None);
    Ok(number)
}

/// Presses the keys EDIT, PROGRAM, O, the number and OUT.
fn press_out(console: &Console, number: u16) {
    console.send(Command::Tap(Key::Edit));
    console.send(Command::Tap(Key::Program));
    for character in format!("O{number}").chars() {
        console.send(Command::Type(character));
    }
    console.send(Command::Tap(Key::Output));
}
