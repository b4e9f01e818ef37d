//! Executes an operator script to its end.

use gsk_core::machine::LatheFault;
use gsk_core::simulation::Simulation;
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::pages::{POWER_ON_TICKS, UdiskFile};
use gsk_panel::panel::SerialFile;
use gsk_panel::script::{
    Effect, Failure, Runner, Script, ScriptAction, ScriptLine, ScriptProgress,
};
use gsk_panel::why::CauseChain;

use crate::board::PulseBoard;
use crate::partner::{PartnerWait, ProgramPartner};

/// Maximum number of ticks per call of a script without a board.
const SLICE_TICKS: u64 = 100_000;

/// The services that a script needs from the program that runs it: files, output, a serial partner.
pub trait ScriptHost {
    /// The error of a failed operation of the host; converts to a message for the user.
    type Error: Into<Message>;

    /// Shows the rows of the LCD as text.
    fn show_screen(&mut self, screen: &str);

    /// Shows the chain of causes that explains a state of the machine.
    fn show_chain(&mut self, chain: &CauseChain);

    /// Draws a picture of the machine and stores it under a file name.
    ///
    /// # Errors
    /// The picture cannot be drawn, or the file not be stored.
    fn store_picture(
        &mut self,
        name: &str,
        picture: ScriptPicture,
        emulator: &Emulator,
    ) -> Result<(), Self::Error>;

    /// Reads a program file by its name. The result contains the name for the program.
    ///
    /// # Errors
    /// The file cannot be read.
    fn read_program(&mut self, name: &str) -> Result<SerialFile, Self::Error>;

    /// Reads the file that the script sends to the serial port.
    ///
    /// # Errors
    /// The file cannot be read.
    fn read_transfer_file(&mut self, name: &str) -> Result<SerialFile, Self::Error>;

    /// Shows the message why the control refuses a file at its serial port.
    fn show_refusal(&mut self, message: &Message);

    /// Opens a partner that sends the file `name` in DNC mode.
    ///
    /// # Errors
    /// The file cannot be read.
    fn open_partner(&mut self, name: &str) -> Result<Box<dyn ProgramPartner>, Self::Error>;
}

/// The area that a picture of a script shows: the LCD or the whole panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScriptPicture {
    /// The picture shows the LCD alone.
    Lcd,
    /// The picture shows the whole panel.
    Panel,
}

/// The reason for which a script ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScriptEnd {
    /// The script has run to its last line.
    Finished,
    /// A line failed: an expectation was not met, or an operation was not possible.
    Failed(Failure),
    /// The user requested the end of the script (Ctrl-C).
    Requested,
}

/// Observes control and lathe, tick by tick, while a script runs.
pub trait TickObserver {
    /// Called after each tick with the state of control and lathe.
    fn follow_tick(&mut self, simulation: &Simulation);
}

/// The part that the simulated lathe cuts while a script runs.
pub trait CutFollower {
    /// Cuts the part after each tick, and returns the faults that this causes in the lathe.
    fn follow_tick(&mut self, simulation: &Simulation) -> Vec<LatheFault>;
}

/// A script run on an emulator, with its board, partner and recording.
pub struct ScriptSession<'a, S> {
    emulator: &'a mut Emulator,
    host: &'a mut S,
    /// The board that moves the slides; `None` if they are simulated.
    board: Option<&'a mut dyn PulseBoard>,
    record: Option<&'a mut ScriptRecord>,
    observer: Option<&'a mut dyn TickObserver>,
    /// The part that the script cuts; `None` without one.
    part: Option<&'a mut dyn CutFollower>,
    /// The partner that sends programs in DNC operation; `None` until a line of the script
    /// opens one.
    partner: Option<Box<dyn ProgramPartner>>,
}

impl<'a, S: ScriptHost> ScriptSession<'a, S> {
    /// Prepares a script run on an emulator; `host` provides files and output.
    pub fn new(emulator: &'a mut Emulator, host: &'a mut S) -> Self {
        Self {
            emulator,
            host,
            board: None,
            record: None,
            observer: None,
            part: None,
            partner: None,
        }
    }

    /// Connects an opened board that moves the slides; `None` simulates them.
    #[must_use]
    pub fn with_board(self, board: Option<&'a mut dyn PulseBoard>) -> Self {
        Self { board, ..self }
    }

    /// Records the lines of the script in `record`, with the ticks at which they begin.
    #[must_use]
    pub fn with_record(self, record: Option<&'a mut ScriptRecord>) -> Self {
        Self { record, ..self }
    }

    /// Observes each tick with `observer`.
    #[must_use]
    pub fn with_observer(self, observer: Option<&'a mut dyn TickObserver>) -> Self {
        Self { observer, ..self }
    }

    /// Cuts `part` in each tick, and sets the faults that it causes.
    #[must_use]
    pub fn with_part(self, part: Option<&'a mut dyn CutFollower>) -> Self {
        Self { part, ..self }
    }

    /// Runs the script to its end, and returns how it ended.
    pub fn run(mut self, script: Script) -> ScriptEnd {
        let mut runner = Runner::new(script);
        let needs_ticks = self.record.is_some() || self.observer.is_some() || self.part.is_some();
        let slice = if needs_ticks { 1 } else { SLICE_TICKS };
        loop {
            let tick = self.emulator.ticks();
            let Some(progress) = self.advance(&mut runner, slice) else {
                return ScriptEnd::Requested;
            };
            if let Some(part) = &mut self.part
                && self.emulator.ticks() != tick
            {
                for fault in part.follow_tick(self.emulator.simulation()) {
                    self.emulator.set_fault(fault, true);
                }
            }
            if let Some(observer) = &mut self.observer
                && self.emulator.ticks() != tick
            {
                observer.follow_tick(self.emulator.simulation());
            }
            if let (Some(record), Some(line)) = (&mut self.record, runner.line()) {
                record.note_line(line.number, tick);
            }
            match progress {
                ScriptProgress::Running => {}
                ScriptProgress::Effect(effect) => {
                    if let Err(reason) = self.execute_effect(effect) {
                        return ScriptEnd::Failed(runner.failure(reason));
                    }
                }
                ScriptProgress::Failed(failure) => return ScriptEnd::Failed(failure),
                ScriptProgress::Finished => return ScriptEnd::Finished,
            }
        }
    }

    /// Continues the script: by `slice` ticks without a board, tick by tick at the pace of the
    /// board. `None` if the end was requested.
    fn advance(&mut self, runner: &mut Runner, slice: u64) -> Option<ScriptProgress> {
        let Some(board) = &mut self.board else {
            return Some(runner.advance(self.emulator, slice));
        };
        if !board.wait_for_tick(self.emulator.board_simulation()) {
            return None;
        }
        let tick = self.emulator.ticks();
        let progress = runner.advance(self.emulator, 1);
        if self.emulator.ticks() != tick {
            board.finish_tick(self.emulator.board_simulation());
        }
        Some(progress)
    }

    /// Executes the effect of a script line outside the control. Returns the reason if it
    /// fails.
    fn execute_effect(&mut self, effect: Effect) -> Result<(), Message> {
        match effect {
            Effect::Show(text) => self.host.show_screen(&text),
            Effect::Explain(chain) => self.host.show_chain(&chain),
            Effect::Shot { path, panel } => {
                let picture = match panel {
                    true => ScriptPicture::Panel,
                    false => ScriptPicture::Lcd,
                };
                let stored = self.host.store_picture(&path, picture, self.emulator);
                stored.map_err(Into::into)?;
            }
            Effect::Load(name) => {
                let file = self.host.read_program(&name).map_err(Into::into)?;
                let loaded = self.emulator.load_program(&file.name, &file.text);
                loaded.map_err(say::as_written)?;
            }
            Effect::Receive(name) => {
                let file = self.host.read_transfer_file(&name).map_err(Into::into)?;
                if let Err(refused) = self.emulator.receive(file) {
                    self.host.show_refusal(&refused.message());
                }
            }
            Effect::Udisk(name) => {
                let SerialFile { name, text } =
                    self.host.read_program(&name).map_err(Into::into)?;
                self.emulator.add_udisk_file(UdiskFile { name, text });
            }
            Effect::Dnc(None) => self.partner = None,
            Effect::Dnc(Some(name)) => {
                let partner = self.host.open_partner(&name).map_err(Into::into)?;
                self.partner = Some(partner);
            }
            Effect::DncRoom => {
                if let Some(partner) = &mut self.partner {
                    partner.send_text(self.emulator, PartnerWait::Allowed);
                }
            }
        }
        Ok(())
    }
}

/// A recording of a script, line by line with the tick at which each began.
#[derive(Clone, Debug)]
pub struct ScriptRecord {
    lines: Vec<ScriptLine>,
    written_lines: usize,
    text: String,
}

impl ScriptRecord {
    /// Creates an empty recording of a script.
    pub fn new(script: &Script) -> Self {
        Self {
            lines: script.lines.clone(),
            written_lines: 0,
            text: String::new(),
        }
    }

    /// Returns the recording as an operator script with `@tick` times.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Records that the script has reached line `number` at `tick`: this line, and those
    /// before it that are not recorded yet, began at this tick.
    fn note_line(&mut self, number: u32, tick: u64) {
        let tick = tick.saturating_sub(POWER_ON_TICKS);
        while let Some(line) = self.lines.get(self.written_lines)
            && line.number <= number
        {
            self.written_lines += 1;
            let is_action = !matches!(
                line.action,
                ScriptAction::Wait(_)
                    | ScriptAction::WaitFor(..)
                    | ScriptAction::Expect(_)
                    | ScriptAction::Show
                    | ScriptAction::Shot { .. }
            );
            if is_action {
                let text = match line.at {
                    Some(_) => line
                        .text
                        .split_once(char::is_whitespace)
                        .map_or("", |(_, rest)| rest),
                    None => &line.text,
                };
                self.text.push_str(&format!("@{tick} {}\n", text.trim()));
            }
        }
    }
}
