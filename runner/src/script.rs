//! An operator script carried out to its end.

use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::pages::POWER_ON_TICKS;
use gsk_panel::panel::SerialFile;
use gsk_panel::script::{
    Effect, Failure, Runner, Script, ScriptAction, ScriptLine, ScriptProgress,
};

use crate::board::PulseBoard;
use crate::partner::{Partner, Patience};
use crate::picture::{self, PictureError};

/// Ticks between two looks at a script.
const SLICE: u64 = 100_000;

/// What a script needs of whoever runs it.
pub trait Surroundings {
    /// Why something cannot be done.
    type Error: Into<Message>;

    /// The rows of the LCD are asked for.
    fn show(&mut self, screen: &str);

    /// A picture is to be stored under a name; `bytes` makes the file.
    ///
    /// # Errors
    /// It cannot be stored.
    fn shot(
        &mut self,
        name: &str,
        bytes: &dyn Fn() -> Result<Vec<u8>, PictureError>,
    ) -> Result<(), Self::Error>;

    /// A program file, with the name that it is known by.
    ///
    /// # Errors
    /// It cannot be read.
    fn program(&mut self, name: &str) -> Result<SerialFile, Self::Error>;

    /// A file for the serial port.
    ///
    /// # Errors
    /// It cannot be read.
    fn transfer(&mut self, name: &str) -> Result<SerialFile, Self::Error>;

    /// The control does not take a file at its serial port: why, for the partner.
    fn told(&mut self, said: &Message);

    /// A partner that sends this file in DNC mode.
    ///
    /// # Errors
    /// It cannot be read.
    fn partner(&mut self, name: &str) -> Result<Box<dyn Partner>, Self::Error>;
}

/// How a script ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScriptEnd {
    /// Its last line is done.
    Finished,
    /// A line did not come out as written.
    Failed(Failure),
    /// The end was asked for.
    Asked,
}

/// A script on an emulator.
pub struct Session<'a, S> {
    emulator: &'a mut Emulator,
    surroundings: &'a mut S,
    /// Moves the slides.
    board: Option<&'a mut dyn PulseBoard>,
    record: Option<&'a mut Record>,
    /// Sends programs in DNC operation.
    partner: Option<Box<dyn Partner>>,
}

impl<'a, S: Surroundings> Session<'a, S> {
    /// Before the first line of a script.
    pub fn new(emulator: &'a mut Emulator, surroundings: &'a mut S) -> Self {
        Self {
            emulator,
            surroundings,
            board: None,
            record: None,
            partner: None,
        }
    }

    /// A board that is known moves the slides.
    #[must_use]
    pub fn at_board(self, board: Option<&'a mut dyn PulseBoard>) -> Self {
        Self { board, ..self }
    }

    /// What the script did is taken down.
    #[must_use]
    pub fn recorded(self, record: Option<&'a mut Record>) -> Self {
        Self { record, ..self }
    }

    /// Runs the script.
    pub fn run(mut self, script: Script) -> ScriptEnd {
        let mut runner = Runner::new(script);
        let slice = if self.record.is_some() { 1 } else { SLICE };
        loop {
            let tick = self.emulator.ticks();
            let Some(progress) = self.advance(&mut runner, slice) else {
                return ScriptEnd::Asked;
            };
            if let (Some(record), Some(line)) = (&mut self.record, runner.line()) {
                record.reached(line.number, tick);
            }
            match progress {
                ScriptProgress::Running => {}
                ScriptProgress::Effect(effect) => {
                    if let Err(seen) = self.carry_out(effect) {
                        return ScriptEnd::Failed(runner.failure(seen));
                    }
                }
                ScriptProgress::Failed(failure) => return ScriptEnd::Failed(failure),
                ScriptProgress::Finished => return ScriptEnd::Finished,
            }
        }
    }

    /// Goes on with the script: at the board's pace, tick by tick, if there is one.
    fn advance(&mut self, runner: &mut Runner, slice: u64) -> Option<ScriptProgress> {
        let Some(board) = &mut self.board else {
            return Some(runner.advance(self.emulator, slice));
        };
        if !board.wait(&mut self.emulator.simulation) {
            return None;
        }
        let tick = self.emulator.ticks();
        let progress = runner.advance(self.emulator, 1);
        if self.emulator.ticks() != tick {
            board.after(&mut self.emulator.simulation);
        }
        Some(progress)
    }

    /// Does what a line asks for; why, if that cannot be.
    fn carry_out(&mut self, effect: Effect) -> Result<(), Message> {
        match effect {
            Effect::Show(text) => self.surroundings.show(&text),
            Effect::Shot { path, panel } => {
                let emulator = &*self.emulator;
                let bytes = || match panel {
                    true => picture::of_panel(emulator),
                    false => picture::of_lcd(&emulator.screen(), emulator.panel.view().brightness),
                };
                let stored = self.surroundings.shot(&path, &bytes);
                stored.map_err(Into::into)?;
            }
            Effect::Load(name) => {
                let file = self.surroundings.program(&name).map_err(Into::into)?;
                let loaded = self.emulator.load_program(&file.name, &file.text);
                loaded.map_err(say::as_written)?;
            }
            Effect::Receive(name) => {
                let file = self.surroundings.transfer(&name).map_err(Into::into)?;
                if let Err(refused) = self.emulator.receive(file) {
                    self.surroundings.told(&refused.message());
                }
            }
            Effect::Dnc(None) => self.partner = None,
            Effect::Dnc(Some(name)) => {
                let partner = self.surroundings.partner(&name).map_err(Into::into)?;
                self.partner = Some(partner);
            }
            Effect::DncRoom => {
                if let Some(partner) = &mut self.partner {
                    partner.feed(&mut self.emulator.simulation.cnc, Patience::Waits);
                }
            }
        }
        Ok(())
    }
}

/// What a script did, line by line with the tick at which each began.
#[derive(Clone, Debug)]
pub struct Record {
    lines: Vec<ScriptLine>,
    written: usize,
    text: String,
}

impl Record {
    /// Of a script that has not begun.
    pub fn new(script: &Script) -> Self {
        Self {
            lines: script.lines.clone(),
            written: 0,
            text: String::new(),
        }
    }

    /// The recording as a script.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The script has come to a line; it and those before it began at this tick.
    fn reached(&mut self, number: u32, tick: u64) {
        let tick = tick.saturating_sub(POWER_ON_TICKS);
        while let Some(line) = self.lines.get(self.written)
            && line.number <= number
        {
            self.written += 1;
            let acts = !matches!(
                line.action,
                ScriptAction::Wait(_)
                    | ScriptAction::WaitFor(..)
                    | ScriptAction::Expect(_)
                    | ScriptAction::Show
                    | ScriptAction::Shot { .. }
            );
            if acts {
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
