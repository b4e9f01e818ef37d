//! Runs a script on an emulator, a few ticks at a time.

use core::fmt;

use gsk_core::cnc::{ControlRequest, DncInput};
use gsk_messages::{Message, say};

use super::{Script, ScriptAction, ScriptLine};
use crate::emulator::{ConditionWatch, Emulator, EmulatorInput, PRESS_TICKS};
use crate::keys::Key;
use crate::pages::POWER_ON_TICKS;
use crate::panel::KeyEvent;
use crate::why::{self, BitLog, CauseChain};

/// Number of ticks after which the runner returns to the loop of [`run`].
const SLICE: u64 = 100_000;

/// Ticks (ms) a graduation, if `turn` has no time: two turns of 100 graduations a second.
const TICKS_PER_GRADUATION: u64 = 5;

/// An action that the caller of the runner has to execute.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The caller must print this text: the rows of the LCD.
    Show(String),
    /// The caller must print this chain of causes.
    Explain(CauseChain),
    /// Save a picture of the current state of the LCD or the panel.
    Shot {
        /// Path of the picture file to write.
        path: String,
        /// Whether the picture shows the whole panel instead of the LCD.
        panel: bool,
    },
    /// Read the file with this path and pass its text to [`Emulator::load_program`].
    Load(String),
    /// Read the file with this path and pass it to [`Emulator::receive`]. A refusal is for the
    /// partner, and does not fail the script.
    Receive(String),
    /// Read the file with this path and add it to the plugged U disk with
    /// [`Emulator::add_udisk_file`].
    Udisk(String),
    /// Act as the partner that sends the file with this path from its beginning whenever
    /// [`Cnc::dnc_request_count`](gsk_core::cnc::Cnc::dnc_request_count) increases. `None` disconnects the
    /// partner.
    Dnc(Option<String>),
    /// The partner can send ([`Cnc::dnc_free_characters`](gsk_core::cnc::Cnc::dnc_free_characters)): send data, the
    /// end, or abort.
    DncRoom,
}

/// How far a script has progressed when the runner returns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScriptProgress {
    /// The permitted ticks have elapsed, but the script has not ended.
    Running,
    /// The caller has to execute an effect before the script continues.
    Effect(Effect),
    /// A line failed, and the script has ended.
    Failed(Failure),
    /// All lines are complete, and the script has ended.
    Finished,
}

/// A line of a script that failed, with the state that was found instead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Number of the line in the script file, from 1.
    pub line: u32,
    /// Text of the failed line.
    pub text: String,
    /// The message about the actual state that was found.
    pub seen: Message,
}

impl Failure {
    /// Returns the message that a script line failed: its number, its text, the actual state.
    pub fn message(&self) -> Message {
        say::script_failed(self.line, &self.text, self.seen.clone())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message().fmt(f)
    }
}

impl core::error::Error for Failure {}

/// Runs the lines of a script on an emulator.
#[derive(Clone, Debug, PartialEq)]
pub struct Runner {
    script: Script,
    next: usize,
    /// The emulator's tick count at the start of the script, from which `@tick` counts.
    origin: u64,
    stage: Stage,
    /// Whether a partner is connected that sends programs in DNC mode.
    dnc: bool,
    /// Emulator tick of the partner's last [`Effect::DncRoom`]; `None` before the first.
    last_request: Option<u64>,
    /// When the bits of the PLC have changed; `None` if no line of the script asks why.
    log: Option<BitLog>,
}

/// The condition for which the current line waits.
#[derive(Clone, Debug, PartialEq)]
enum Stage {
    /// Waits for the end of the self-test picture, at most until this tick.
    SelfTest(Option<u64>),
    /// No action is in progress; the next line is due.
    Ready,
    /// Holds a key until this tick; after its release pauses for a number of ticks.
    Holding(Key, u64, u64),
    /// The line waits until this tick.
    Resting(u64),
    /// Types the next character at this tick: the remaining ones, last first, then a pause in
    /// ticks.
    Typing(u64, Vec<char>, u64),
    /// Turns the handwheel evenly from a tick on for a number of ticks. `done` counts the
    /// graduations turned.
    Turning {
        graduations: i32,
        from: u64,
        ticks: u64,
        done: i32,
    },
    /// Waits for a condition that must become true from the earliest to the latest tick.
    Waiting {
        watch: Box<ConditionWatch>,
        since: u64,
        earliest: u64,
        latest: u64,
    },
    /// The script has failed or finished.
    Over,
}

/// The next action of the runner: a tick of the emulator, another check, or return.
enum Next {
    Tick,
    Recheck,
    Return(ScriptProgress),
}

impl Runner {
    /// Creates a runner that starts with the first line of the script after the self-test.
    pub fn new(script: Script) -> Self {
        let explains = script.lines.iter().any(|line| match &line.action {
            ScriptAction::Why(_) => true,
            ScriptAction::Expect(expect) => expect.needs_log(),
            _ => false,
        });
        Self {
            log: explains.then(BitLog::default),
            script,
            next: 0,
            origin: 0,
            stage: Stage::SelfTest(None),
            dnc: false,
            last_request: None,
        }
    }

    /// Returns the current or last line, for messages about its effects; `None` in an empty
    /// script.
    pub fn line(&self) -> Option<&ScriptLine> {
        self.script.lines.get(self.next.saturating_sub(1))
    }

    /// Creates a failure of the current line with the state that was found.
    pub fn failure(&self, seen: impl Into<Message>) -> Failure {
        let (line, text) = self
            .line()
            .map(|line| (line.number, line.text.clone()))
            .unwrap_or_default();
        Failure {
            line,
            text,
            seen: seen.into(),
        }
    }

    /// Runs the script for at most `ticks` ticks of the emulator. Returns earlier with an
    /// effect or at the end.
    pub fn advance(&mut self, emulator: &mut Emulator, ticks: u64) -> ScriptProgress {
        let mut left = ticks;
        loop {
            match self.step(emulator) {
                Next::Tick if left == 0 => return ScriptProgress::Running,
                Next::Tick => {
                    emulator.tick();
                    left -= 1;
                    let now = emulator.ticks();
                    if let Some(log) = &mut self.log {
                        log.follow_tick(emulator.cnc(), now);
                    }
                }
                Next::Recheck => {}
                Next::Return(progress) => {
                    if matches!(
                        progress,
                        ScriptProgress::Failed(_) | ScriptProgress::Finished
                    ) {
                        self.stage = Stage::Over;
                    }
                    return progress;
                }
            }
        }
    }

    fn step(&mut self, emulator: &mut Emulator) -> Next {
        let now = emulator.ticks();
        let can_send = self.dnc && emulator.cnc().dnc_free_characters() > 0;
        if can_send && self.last_request.replace(now) != Some(now) {
            return Next::Return(ScriptProgress::Effect(Effect::DncRoom));
        }
        match &mut self.stage {
            Stage::SelfTest(until) => {
                let until = *until.get_or_insert(now + POWER_ON_TICKS);
                if emulator.panel().in_self_test() && now < until {
                    return Next::Tick;
                }
                self.origin = now;
            }
            Stage::Ready => return self.start_line(emulator, now),
            Stage::Holding(key, until, rest) => {
                if now < *until {
                    return Next::Tick;
                }
                emulator.key_up(*key);
                self.stage = Stage::Resting(now + *rest);
                return Next::Recheck;
            }
            Stage::Resting(until) => {
                if now < *until {
                    return Next::Tick;
                }
            }
            Stage::Typing(at, characters, rest) => {
                if now < *at {
                    return Next::Tick;
                }
                if let Some(character) = characters.pop() {
                    emulator.key(KeyEvent::Type(character));
                    let last = characters.is_empty();
                    *at = now + if last { *rest } else { PRESS_TICKS };
                    return Next::Recheck;
                }
            }
            Stage::Turning {
                graduations,
                from,
                ticks,
                done,
            } => {
                let elapsed = (now - *from).min(*ticks);
                let due = i128::from(*graduations) * i128::from(elapsed) / i128::from(*ticks);
                let more = due as i32 - *done;
                if more != 0 {
                    *done += more;
                    emulator.turn(more);
                }
                if elapsed < *ticks {
                    return Next::Tick;
                }
                self.stage = Stage::Resting(now + PRESS_TICKS);
                return Next::Recheck;
            }
            Stage::Waiting {
                watch,
                since,
                earliest,
                latest,
            } => {
                let reached = watch.reached(emulator);
                if reached && now < *earliest {
                    let seen = say::script_too_early(now - *since);
                    return Next::Return(ScriptProgress::Failed(self.failure(seen)));
                }
                if !reached {
                    if now < *latest {
                        return Next::Tick;
                    }
                    let seen = say::script_too_late(emulator.screen());
                    return Next::Return(ScriptProgress::Failed(self.failure(seen)));
                }
            }
            Stage::Over => return Next::Return(ScriptProgress::Finished),
        }
        self.stage = Stage::Ready;
        Next::Recheck
    }

    /// Starts the next line of the script, if its tick has come.
    fn start_line(&mut self, emulator: &mut Emulator, now: u64) -> Next {
        let Some(line) = self.script.lines.get(self.next) else {
            return Next::Return(ScriptProgress::Finished);
        };
        let timed = line.at.map(|at| at + self.origin);
        if timed.is_some_and(|at| now < at) {
            return Next::Tick;
        }
        let action = line.action.clone();
        self.next += 1;
        if timed.is_some_and(|at| now > at) {
            let seen = say::script_tick_over(now - self.origin);
            return Next::Return(ScriptProgress::Failed(self.failure(seen)));
        }
        self.start_action(action, timed.is_some(), emulator, now)
    }

    /// Starts the action of a line. `is_timed`: the line names its tick.
    fn start_action(
        &mut self,
        action: ScriptAction,
        is_timed: bool,
        emulator: &mut Emulator,
        now: u64,
    ) -> Next {
        let rest = if is_timed { 0 } else { PRESS_TICKS };
        match action {
            ScriptAction::Press(key) => {
                emulator.key_down(key);
                self.stage = Stage::Holding(key, now + PRESS_TICKS, rest);
            }
            ScriptAction::Hold(key, ticks) => {
                emulator.key_down(key);
                self.stage = Stage::Holding(key, now + ticks, 0);
            }
            ScriptAction::Down(key) => {
                emulator.key_down(key);
            }
            ScriptAction::Up(key) => emulator.key_up(key),
            ScriptAction::Type(text) => {
                let characters = text.chars().rev().collect();
                self.stage = Stage::Typing(now, characters, rest);
            }
            ScriptAction::Load(path) => {
                return Next::Return(ScriptProgress::Effect(Effect::Load(path)));
            }
            ScriptAction::Receive(path) => {
                return Next::Return(ScriptProgress::Effect(Effect::Receive(path)));
            }
            ScriptAction::Udisk(None) => emulator.plug_udisk(None),
            ScriptAction::Udisk(Some(path)) => {
                return Next::Return(ScriptProgress::Effect(Effect::Udisk(path)));
            }
            ScriptAction::Dnc(path) => {
                self.dnc = path.is_some();
                emulator.apply(EmulatorInput::Dnc(DncInput::Connected(self.dnc)));
                return Next::Return(ScriptProgress::Effect(Effect::Dnc(path)));
            }
            ScriptAction::Power(true) => emulator.power_on(),
            ScriptAction::Power(false) => emulator.power_off(),
            ScriptAction::Fault(fault, on) => emulator.set_fault(fault, on),
            ScriptAction::Turn(graduations, None) if is_timed => emulator.turn(graduations),
            ScriptAction::Turn(graduations, time) => {
                let own = u64::from(graduations.unsigned_abs()) * TICKS_PER_GRADUATION;
                self.stage = Stage::Turning {
                    graduations,
                    from: now,
                    ticks: time.unwrap_or(own).max(1),
                    done: 0,
                };
            }
            ScriptAction::Wait(ticks) => self.stage = Stage::Resting(now + ticks),
            ScriptAction::WaitFor(condition, earliest, latest) => {
                self.stage = Stage::Waiting {
                    watch: Box::new(ConditionWatch::new(condition, emulator)),
                    since: now,
                    earliest: now + earliest,
                    latest: now + latest,
                };
            }
            ScriptAction::Set(address, state) => {
                emulator.force_input(address, Some(state));
            }
            ScriptAction::Free(address) => emulator.force_input(address, None),
            ScriptAction::Force(bit, value) => {
                let request = ControlRequest::ForceBit(bit, value);
                if let Err(alarm) = emulator.request(request) {
                    return Next::Return(ScriptProgress::Failed(self.failure(alarm.reason())));
                }
            }
            ScriptAction::Expect(expect) => {
                let checked = match &self.log {
                    Some(log) => expect.check_with_log(emulator, log),
                    None => expect.check(emulator),
                };
                if let Err(seen) = checked {
                    return Next::Return(ScriptProgress::Failed(self.failure(seen.message())));
                }
            }
            ScriptAction::Show => {
                let text = emulator.screen().text();
                return Next::Return(ScriptProgress::Effect(Effect::Show(text)));
            }
            ScriptAction::Why(subject) => {
                let chain = self
                    .log
                    .as_ref()
                    .map(|log| why::explain(emulator, subject, log));
                return Next::Return(ScriptProgress::Effect(Effect::Explain(
                    chain.unwrap_or_default(),
                )));
            }
            ScriptAction::Shot { path, panel } => {
                return Next::Return(ScriptProgress::Effect(Effect::Shot { path, panel }));
            }
        }
        Next::Recheck
    }
}

/// Runs a script to its end. `carry_out` executes the effects on files.
///
/// # Errors
///
/// Returns the line that failed, or whose effect `carry_out` could not execute.
pub fn run<E: fmt::Display>(
    script: Script,
    emulator: &mut Emulator,
    carry_out: &mut dyn FnMut(Effect, &mut Emulator) -> Result<(), E>,
) -> Result<(), Failure> {
    let mut runner = Runner::new(script);
    loop {
        match runner.advance(emulator, SLICE) {
            ScriptProgress::Running => {}
            ScriptProgress::Effect(effect) => {
                carry_out(effect, emulator)
                    .map_err(|seen| runner.failure(say::as_written(seen)))?;
            }
            ScriptProgress::Failed(failure) => return Err(failure),
            ScriptProgress::Finished => return Ok(()),
        }
    }
}
