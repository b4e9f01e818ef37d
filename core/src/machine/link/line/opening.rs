//! How the link comes to know its board: who it is, what it is set to, where it
//! believes to stand. One question at a time.

use core::time::Duration;

use super::super::{ANOTHER, BoardInfo, HostTime};
use super::answers::Answer;
use super::required::{Required, Setting};

/// A board that resets when its port is opened needs so long to greet.
const BANNER_WAIT: Duration = Duration::from_millis(2500);
/// The wire counts as quiet after this.
const QUIET: Duration = Duration::from_millis(200);
/// A board that says nothing at all by then is none.
const GIVE_UP: Duration = Duration::from_secs(5);
/// Time for the answer to one question.
const PATIENCE: Duration = Duration::from_secs(1);
/// Acts at once, wherever it stands.
const RESET: &str = "\x18";
const QUESTIONS: [&str; 4] = ["$I", "$$", "$#", "$G"];

/// Where the opening stands.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    Greeting,
    Quiet,
    Asking(usize),
    Differs,
    Writing(usize),
    Rereading,
    Known,
}

/// Name and version out of `4.0 FluidNC v4.0.4 (esp32-wifi) :`, the version that such a
/// board tells.
fn fluid_nc(version: &str) -> Option<&str> {
    let (_, name) = version.split_once(' ')?;
    let name = name.split('(').next()?.trim();
    name.starts_with("FluidNC").then_some(name)
}

/// What the opening wants done.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Outcome {
    /// Nothing for now.
    Waits,
    /// Send this line (without its end).
    Send(String),
    /// The settings are being read from now on.
    Configures(String),
    /// The board is what it should be.
    Done,
    /// The settings differ; written only when asked for.
    Differs(Vec<(Setting, Option<f64>)>),
    /// It goes no further: alarm and cause.
    Fails(u16, String),
}

/// The dialogue that opens a link.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Opening {
    step: Step,
    since: HostTime,
    opened: HostTime,
    heard: bool,
    last_heard: HostTime,
    version: String,
    firmware: Option<String>,
    axes: Option<String>,
    pub(super) board: BoardInfo,
    settings: Vec<(u16, f64)>,
    to_write: Vec<Setting>,
}

impl Opening {
    pub(super) fn new(now: HostTime) -> Self {
        Self {
            step: Step::Greeting,
            since: now,
            opened: now,
            heard: false,
            last_heard: now,
            version: String::new(),
            firmware: None,
            axes: None,
            board: BoardInfo::default(),
            settings: Vec::new(),
            to_write: Vec::new(),
        }
    }

    /// Once more, with a board whose port stays open.
    pub(super) fn again(now: HostTime) -> Self {
        Self {
            step: Step::Quiet,
            ..Self::new(now)
        }
    }

    /// A setting as the board last told it.
    pub(super) fn setting(&self, number: u16) -> f64 {
        let mut told = self.settings.iter().rev();
        told.find(|(told, _)| *told == number)
            .map_or(0.0, |(_, value)| *value)
    }

    pub(super) fn is_done(&self) -> bool {
        self.step == Step::Known
    }

    /// Whether banners are expected: the port was just opened.
    pub(super) fn expects_banner(&self) -> bool {
        matches!(self.step, Step::Greeting | Step::Quiet)
    }

    /// Bytes came, whatever they are.
    pub(super) fn hears(&mut self, now: HostTime) {
        self.heard = true;
        self.last_heard = now;
    }

    /// Time passes.
    pub(super) fn tick(&mut self, now: HostTime) -> Outcome {
        let waited = now.saturating_sub(self.since);
        match self.step {
            Step::Greeting if waited >= BANNER_WAIT => {
                self.go(Step::Quiet, now);
                // It was not reset with its port: what an earlier host has left in it,
                // perhaps half a line of motion, must never be carried out.
                Outcome::Send(RESET.into())
            }
            Step::Quiet
                if self.heard
                    && waited >= QUIET
                    && now.saturating_sub(self.last_heard) >= QUIET =>
            {
                self.go(Step::Asking(0), now);
                Outcome::Send(QUESTIONS[0].into())
            }
            Step::Quiet if now.saturating_sub(self.opened) >= GIVE_UP => {
                let cause = if self.heard {
                    "it never stops talking"
                } else {
                    "it says nothing"
                };
                Outcome::Fails(601, format!("no answer from the board: {cause}; {ANOTHER}"))
            }
            Step::Asking(0) if waited >= PATIENCE => Outcome::Fails(
                602,
                format!("what the board sends makes no sense; {ANOTHER}"),
            ),
            Step::Asking(_) | Step::Writing(_) | Step::Rereading if waited >= PATIENCE => {
                Outcome::Fails(601, "no answer from the board within 1 s".into())
            }
            _ => Outcome::Waits,
        }
    }

    fn go(&mut self, step: Step, now: HostTime) {
        self.step = step;
        self.since = now;
    }

    /// A line came.
    pub(super) fn take(&mut self, answer: &Answer, required: &Required, now: HostTime) -> Outcome {
        match (answer, &self.step) {
            (Answer::Banner(_), Step::Greeting) => {
                self.go(Step::Quiet, now);
                Outcome::Send(String::new())
            }
            (_, Step::Greeting | Step::Quiet | Step::Known | Step::Differs) => Outcome::Waits,
            (Answer::Ok, Step::Asking(question)) => {
                let question = *question;
                self.answered(question, required, now)
            }
            (Answer::Ok, Step::Writing(index)) => {
                let next = index + 1;
                self.write(next, now)
            }
            (Answer::Ok, Step::Rereading) => self.compare(required, true, now),
            (Answer::Error(number), _) => self.refused(*number),
            (Answer::Version(version), _) => {
                version.clone_into(&mut self.version);
                Outcome::Waits
            }
            (Answer::Options(blocks, bytes), _) => {
                (self.board.blocks, self.board.receive_bytes) = (*blocks, *bytes);
                Outcome::Waits
            }
            (Answer::Axes(axes), _) => {
                self.axes = Some(axes.clone());
                Outcome::Waits
            }
            (Answer::Firmware(name), _) => {
                self.firmware = Some(name.clone());
                Outcome::Waits
            }
            (Answer::NewOptions(options), _) => {
                self.board.spindle_sync = options.split(',').any(|option| option == "SS");
                Outcome::Waits
            }
            (Answer::Setting(number, value), _) => {
                self.settings.push((*number, *value));
                Outcome::Waits
            }
            _ => Outcome::Waits,
        }
    }

    fn refused(&self, number: u16) -> Outcome {
        let text = match self.step {
            Step::Writing(index) => match self.to_write.get(index) {
                Some(setting) => format!("{} was refused with error:{number}", setting.line()),
                None => format!("a setting was refused with error:{number}"),
            },
            _ => format!("a question was refused with error:{number}"),
        };
        Outcome::Fails(
            if matches!(self.step, Step::Writing(_)) {
                603
            } else {
                602
            },
            text,
        )
    }

    fn answered(&mut self, question: usize, required: &Required, now: HostTime) -> Outcome {
        if question == 0
            && let Err(text) = self.identify()
        {
            return Outcome::Fails(602, text);
        }
        match QUESTIONS.get(question + 1) {
            Some(next) => {
                self.go(Step::Asking(question + 1), now);
                if question == 0 {
                    Outcome::Configures((*next).into())
                } else {
                    Outcome::Send((*next).into())
                }
            }
            None => self.compare(required, false, now),
        }
    }

    fn identify(&mut self) -> Result<(), String> {
        if let Some(name) = fluid_nc(&self.version) {
            self.board.firmware = name.to_owned();
            return Err(format!(
                "{name} is not supported yet: it tells its settings in a way of its own; Grbl 1.1 or grblHAL is needed"
            ));
        }
        if self.version.is_empty() {
            return Err(format!(
                "the board does not say who it is ([VER:…]), as Grbl older than 1.1f does not; {ANOTHER}"
            ));
        }
        let family = self.firmware.as_deref().unwrap_or("Grbl");
        self.board.firmware = format!("{family} {}", self.version);
        if !["Grbl", "grblHAL"].contains(&family) {
            return Err(format!("firmware {family} is not known"));
        }
        let version = self.version.strip_prefix("1.1").unwrap_or_default();
        if family == "Grbl" && !version.starts_with(|letter| letter >= 'f') {
            return Err(format!("Grbl {} is older than 1.1f", self.version));
        }
        if let Some(axes) = &self.axes
            && !(axes.contains('X') && axes.contains('Z'))
        {
            return Err(format!("the board has axes {axes}; X and Z are needed"));
        }
        if self.board.blocks < 4 || self.board.receive_bytes < 64 {
            return Err("the board does not say how much it can hold ([OPT:…])".into());
        }
        Ok(())
    }

    fn compare(&mut self, required: &Required, written: bool, now: HostTime) -> Outcome {
        let differences: Vec<_> = required
            .settings
            .iter()
            .map(|setting| setting.of(&self.board.firmware))
            .filter_map(|setting| {
                let board = self
                    .settings
                    .iter()
                    .rev()
                    .find(|(number, _)| *number == setting.number);
                match board {
                    Some((_, value)) if setting.is_met_by(*value) => None,
                    _ => Some((setting, board.map(|(_, value)| *value))),
                }
            })
            .collect();
        if differences.is_empty() {
            self.go(Step::Known, now);
            return Outcome::Done;
        }
        if written {
            let list: Vec<_> = differences
                .iter()
                .map(|(setting, _)| setting.line())
                .collect();
            return Outcome::Fails(603, format!("the board does not keep {}", list.join(", ")));
        }
        self.to_write = differences.iter().map(|(setting, _)| *setting).collect();
        self.go(Step::Differs, now);
        Outcome::Differs(differences)
    }

    /// Writes what differs: the operator has said so.
    pub(super) fn write_settings(&mut self, now: HostTime) -> Outcome {
        if self.step != Step::Differs {
            return Outcome::Waits;
        }
        self.write(0, now)
    }

    fn write(&mut self, index: usize, now: HostTime) -> Outcome {
        match self.to_write.get(index) {
            Some(setting) => {
                let line = setting.line();
                self.go(Step::Writing(index), now);
                Outcome::Send(line)
            }
            None => {
                self.settings.clear();
                self.go(Step::Rereading, now);
                Outcome::Send("$$".into())
            }
        }
    }
}
