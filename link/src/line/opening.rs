//! How the link comes to know its board: who it is, what it is set to, where it
//! believes to stand. One question at a time.

use gsk_messages::{Message, say};
use gsk_units::alarm;

use core::time::Duration;

use super::super::{BoardInfo, Difference, HostTime};
use super::family::Family;
use super::fluidnc_config::FluidNcConfig;
use super::reported::{Reported, Unsupported};
use super::required::{Deviation, REPORT, Required, figure};
use super::response::Response;

/// A board that resets when its port is opened needs so long to greet.
const BANNER_WAIT: Duration = Duration::from_millis(2500);
/// The wire counts as quiet after this.
const QUIET: Duration = Duration::from_millis(200);
/// A board that says nothing at all by then is none, nor one that has greeted and does
/// not fall silent.
const GIVE_UP: Duration = Duration::from_secs(5);
const GREETED: Duration = Duration::from_millis(2500);
/// A board that tells of its start may take so long, as when it looks for a network.
const START: Duration = Duration::from_secs(20);
/// A pause in the answer to one question, and the longest answer.
const PATIENCE: Duration = Duration::from_secs(1);
const LONGEST_ANSWER: Duration = Duration::from_secs(10);
/// A piece of motion in a pulse timer.
const PIECE: Duration = Duration::from_millis(10);
/// FluidNC takes no more of them.
const MOST_PIECES: u32 = 20;
/// Acts at once, wherever it stands.
const RESET: &str = "\x18";
/// FluidNC does not report how much it receives; no board of the family takes less.
const LEAST_RECEIVED: u16 = 128;

/// Where the opening stands.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    Greeting,
    Quiet,
    Asking(usize),
    Differs,
    Writing(usize),
    Known,
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
    Differs(Vec<Difference>),
    /// It goes no further: alarm and cause.
    Fails(u16, Message),
}

/// The dialogue that opens a link.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Opening {
    step: Step,
    since: HostTime,
    opened: HostTime,
    heard: bool,
    greeted: bool,
    last_heard: HostTime,
    reported: Reported,
    pub(super) family: Family,
    pub(super) board: BoardInfo,
    /// The board has work offsets of its own.
    pub(super) offset: bool,
    /// What leaves the queue of the board is made so much later: its pulse timer is handed
    /// pieces of 10 ms in advance.
    pub(super) prepared: Duration,
    /// It makes the reference return of one axis alone.
    pub(super) alone: bool,
    to_write: Vec<Deviation>,
    /// What differed was written; it is asked once more.
    written: bool,
    /// It was silent when it was asked who it is, and was reset for that.
    reset: bool,
}

impl Opening {
    pub(super) fn new(now: HostTime) -> Self {
        Self {
            step: Step::Greeting,
            since: now,
            opened: now,
            heard: false,
            greeted: false,
            last_heard: now,
            reported: Reported::default(),
            family: Family::default(),
            board: BoardInfo::default(),
            offset: false,
            prepared: Duration::ZERO,
            alone: false,
            to_write: Vec::new(),
            written: false,
            reset: false,
        }
    }

    /// Once more, with a board whose port stays open.
    pub(super) fn again(now: HostTime) -> Self {
        Self {
            step: Step::Quiet,
            ..Self::new(now)
        }
    }

    /// A setting as the board last reported it.
    pub(super) fn setting(&self, number: u16) -> f64 {
        self.reported.setting(number).unwrap_or_default()
    }

    /// An item as a board with names last reported it.
    fn item(&self, path: &str) -> Option<&str> {
        self.reported.items.value(path)
    }

    /// A line that is no answer of its own: part of a text that was asked for.
    pub(super) fn take_text(&mut self, line: &str) {
        if let Step::Asking(question) = self.step
            && self.family.questions().get(question) == Some(&"$CD")
        {
            self.reported.items.take(line);
        }
    }

    fn prepares(&self) -> Duration {
        let pieces = match self.family {
            Family::Grbl => 6,
            Family::GrblHal => 10,
            Family::FluidNc => {
                let told = self.item("stepping/segments");
                let told = told.and_then(|told| told.parse().ok());
                told.unwrap_or(MOST_PIECES).min(MOST_PIECES)
            }
        };
        PIECE * pieces
    }

    fn returns_alone(&self) -> bool {
        let allowed = |path| self.item(path) == Some("true");
        match self.family {
            Family::Grbl => false,
            Family::GrblHal => self.setting(22) as u32 & 2 != 0,
            Family::FluidNc => {
                allowed("axes/x/homing/allow_single_axis")
                    && allowed("axes/z/homing/allow_single_axis")
            }
        }
    }

    pub(super) fn is_done(&self) -> bool {
        self.step == Step::Known
    }

    /// Whether banners are expected: the port was just opened.
    pub(super) fn expects_banner(&self) -> bool {
        matches!(self.step, Step::Greeting | Step::Quiet)
    }

    /// Bytes came, whatever they are.
    pub(super) fn bytes_received(&mut self, now: HostTime) {
        self.heard = true;
        self.last_heard = now;
    }

    /// Time passes.
    pub(super) fn tick(&mut self, now: HostTime) -> Outcome {
        let waited = now.saturating_sub(self.since);
        let silent = now.saturating_sub(self.last_heard.max(self.since));
        let over = silent >= PATIENCE || waited >= LONGEST_ANSWER;
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
                self.ask(0, now)
            }
            Step::Quiet if now.saturating_sub(self.opened) >= GIVE_UP && waited >= GREETED => {
                let cause = if self.heard {
                    say::board_never_stops_talking()
                } else {
                    say::board_says_nothing()
                };
                Outcome::Fails(
                    alarm::BOARD_SILENT,
                    say::board_no_answer(cause, say::board_is_another()),
                )
            }
            Step::Asking(0) if over && self.last_heard >= self.since => Outcome::Fails(
                alarm::BOARD_UNSUPPORTED,
                say::board_makes_no_sense(say::board_is_another()),
            ),
            Step::Asking(0) if over && !self.reset => {
                // Behind a limit switch Grbl hears nothing but a reset.
                self.reset = true;
                self.opened = now;
                self.heard = false;
                self.go(Step::Quiet, now);
                Outcome::Send(RESET.into())
            }
            Step::Writing(index) if over => {
                Outcome::Fails(alarm::BOARD_UNSUPPORTED, self.hangs(index))
            }
            Step::Asking(_) if over => Outcome::Fails(alarm::BOARD_SILENT, say::board_silent()),
            _ => Outcome::Waits,
        }
    }

    /// A setting that was written and never answered.
    fn hangs(&self, index: usize) -> Message {
        let line = self.to_write.get(index).and_then(|one| one.line.as_deref());
        let line = line.unwrap_or("$…");
        if self.family == Family::GrblHal {
            return say::board_hangs_as_grblhal(line);
        }
        say::board_hangs(line)
    }

    fn go(&mut self, step: Step, now: HostTime) {
        self.step = step;
        self.since = now;
    }

    fn ask(&mut self, question: usize, now: HostTime) -> Outcome {
        let Some(line) = self.family.questions().get(question) else {
            return Outcome::Waits;
        };
        self.go(Step::Asking(question), now);
        match question {
            1 => Outcome::Configures((*line).into()),
            _ => Outcome::Send((*line).into()),
        }
    }

    /// A line came.
    pub(super) fn take(
        &mut self,
        answer: &Response,
        required: &Required,
        now: HostTime,
    ) -> Outcome {
        match (answer, &self.step) {
            (Response::Banner(_), Step::Greeting) => {
                self.greeted = true;
                self.go(Step::Quiet, now);
                Outcome::Send(String::new())
            }
            (Response::Banner(_), Step::Quiet) => {
                self.greeted = true;
                Outcome::Waits
            }
            (Response::Starts, Step::Quiet) if !self.greeted => {
                self.opened = now;
                self.go(Step::Greeting, now);
                Outcome::Waits
            }
            (Response::Starts | Response::Message(_), Step::Greeting) => {
                // It is starting, and will greet when it is there.
                if now.saturating_sub(self.opened) < START {
                    self.since = now;
                }
                Outcome::Waits
            }
            (_, Step::Greeting | Step::Quiet | Step::Known | Step::Differs) => Outcome::Waits,
            (Response::Ok, Step::Asking(question)) => {
                let question = *question;
                self.answered(question, required, now)
            }
            (Response::Ok, Step::Writing(index)) => {
                let next = index + 1;
                self.write(next, now)
            }
            (Response::Error(number), _) => self.refused(*number),
            (Response::Version(version), _) => {
                version.clone_into(&mut self.reported.version);
                Outcome::Waits
            }
            (Response::Options(blocks, bytes), _) => {
                (self.board.blocks, self.board.receive_bytes) = (*blocks, *bytes);
                Outcome::Waits
            }
            (Response::Axes(axes), _) => {
                self.reported.axes = Some(axes.clone());
                Outcome::Waits
            }
            (Response::Firmware(name), _) => {
                self.reported.firmware = Some(name.clone());
                Outcome::Waits
            }
            (Response::NewOptions(options), _) => {
                self.board.spindle_sync = options.split(',').any(|option| option == "SS");
                Outcome::Waits
            }
            (Response::Offset(set), _) => {
                self.offset |= *set;
                Outcome::Waits
            }
            (Response::Setting(number, value), _) => {
                self.reported.settings.push((*number, *value));
                Outcome::Waits
            }
            _ => Outcome::Waits,
        }
    }

    fn refused(&self, number: u16) -> Outcome {
        let Step::Writing(index) = self.step else {
            return Outcome::Fails(
                alarm::BOARD_UNSUPPORTED,
                say::board_refuses_question(number),
            );
        };
        let line = self.to_write.get(index).and_then(|one| one.line.as_ref());
        let text = match line {
            Some(line) => say::board_refuses_line(line, number),
            None => say::board_refuses_setting(number),
        };
        Outcome::Fails(alarm::BOARD_SETTINGS, text)
    }

    fn answered(&mut self, question: usize, required: &Required, now: HostTime) -> Outcome {
        if question == 0
            && let Err(error) = self.identify()
        {
            return Outcome::Fails(alarm::BOARD_UNSUPPORTED, error.message());
        }
        if question + 1 < self.family.questions().len() {
            return self.ask(question + 1, now);
        }
        if let Err(error) = self.measure() {
            return Outcome::Fails(alarm::BOARD_UNSUPPORTED, error.message());
        }
        self.prepared = self.prepares();
        self.alone = self.returns_alone();
        self.compare(required, now)
    }

    fn identify(&mut self) -> Result<(), Unsupported> {
        if let Some(name) = self.reported.fluidnc() {
            self.family = Family::FluidNc;
            self.board.firmware = name.to_owned();
            self.board.forgets = true;
            return Ok(());
        }
        if self.reported.version.is_empty() {
            return Err(Unsupported::NoVersion);
        }
        let family = self.reported.firmware.as_deref().unwrap_or("Grbl");
        self.board.firmware = format!("{family} {}", self.reported.version);
        self.family = match family {
            "Grbl" => Family::Grbl,
            "grblHAL" => Family::GrblHal,
            _ => return Err(Unsupported::Firmware(family.to_owned())),
        };
        let version = self
            .reported
            .version
            .strip_prefix("1.1")
            .unwrap_or_default();
        if self.family == Family::Grbl && !version.starts_with(|letter| letter >= 'f') {
            return Err(Unsupported::Old(self.reported.version.clone()));
        }
        if let Some(axes) = &self.reported.axes
            && !(axes.contains('X') && axes.contains('Z'))
        {
            return Err(Unsupported::Axes(axes.clone()));
        }
        Ok(())
    }

    /// How much the board holds.
    fn measure(&mut self) -> Result<(), Unsupported> {
        let source = if self.family == Family::FluidNc {
            let places = self
                .item("planner_blocks")
                .and_then(|told| told.parse().ok());
            self.board.blocks = places.map_or(0, |places: u16| places.saturating_sub(1));
            self.board.receive_bytes = LEAST_RECEIVED;
            "planner_blocks"
        } else {
            "[OPT:…]"
        };
        if self.board.blocks < 4 || self.board.receive_bytes < 64 {
            return Err(Unsupported::NoSizes(source));
        }
        Ok(())
    }

    fn compare(&mut self, required: &Required, now: HostTime) -> Outcome {
        let deviations = self.deviations(required);
        if deviations.is_empty() {
            self.go(Step::Known, now);
            return Outcome::Done;
        }
        if self.written {
            let lines = deviations.iter().filter_map(|one| one.line.clone());
            let list = lines.collect::<Vec<_>>().join(", ");
            return Outcome::Fails(alarm::BOARD_SETTINGS, say::board_settings_not_kept(list));
        }
        let differences = deviations.iter().map(|one| one.difference.clone());
        let differences = differences.collect();
        self.to_write = deviations;
        self.go(Step::Differs, now);
        Outcome::Differs(differences)
    }

    fn deviations(&self, required: &Required) -> Vec<Deviation> {
        let settings = required.settings.iter().map(|one| one.of(self.family));
        let numbered = settings.filter_map(|setting| {
            let board = self.reported.setting(setting.number);
            if board.is_some_and(|value| setting.is_met_by(value)) {
                return None;
            }
            Some(Deviation {
                difference: Difference {
                    number: setting.number,
                    name: format!("${}", setting.number),
                    board: board.map(|value| value.to_string()),
                    wanted: figure(setting.value),
                },
                line: Some(setting.line()),
            })
        });
        if self.family != Family::FluidNc {
            return numbered.collect();
        }
        let named = self.reported.items.deviations(&required.settings);
        // What a report tells has a number everywhere.
        let reports = numbered.filter(|one| one.difference.number == REPORT);
        reports.chain(named).collect()
    }

    /// Writes what differs: the operator has said so.
    pub(super) fn write_settings(&mut self, now: HostTime) -> Outcome {
        if self.step != Step::Differs {
            return Outcome::Waits;
        }
        let mine = self.to_write.iter().filter(|one| one.line.is_none());
        let list: Vec<_> = mine
            .map(|one| format!("{}: {}", one.difference.name, one.difference.wanted))
            .collect();
        if !list.is_empty() {
            let list = list.join(", ");
            return Outcome::Fails(alarm::BOARD_SETTINGS, say::board_settings_of_file(list));
        }
        self.write(0, now)
    }

    fn write(&mut self, index: usize, now: HostTime) -> Outcome {
        match self.to_write.get(index).and_then(|one| one.line.clone()) {
            Some(line) => {
                self.go(Step::Writing(index), now);
                Outcome::Send(line)
            }
            None => {
                self.reported.settings.clear();
                self.reported.items = FluidNcConfig::default();
                self.written = true;
                self.ask(1, now)
            }
        }
    }
}
