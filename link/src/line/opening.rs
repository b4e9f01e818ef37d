//! The opening dialogue with a line board: identifies it, reads its settings and compares
//! them. One query at a time.

use gsk_messages::{Message, say};
use gsk_units::alarm;

use core::time::Duration;

use super::super::{BoardInfo, HostTime, SettingDifference};
use super::family::FirmwareFamily;
use super::fluidnc_config::FluidNcConfig;
use super::reported::{Reported, Unsupported};
use super::required::{REPORT, RequiredSettings, SettingDeviation, figure};
use super::response::LineResponse;

/// Time within which a board sends its banner if opening the port has reset it.
const BANNER_WAIT: Duration = Duration::from_millis(2500);
/// Duration without a received byte after which the board counts as quiet.
const QUIET: Duration = Duration::from_millis(200);
/// Time from the start of the opening within which the board must become quiet.
const GIVE_UP: Duration = Duration::from_secs(5);
/// Least time that a board is given to become quiet after its banner.
const SETTLE_AFTER_BANNER: Duration = Duration::from_millis(2500);
/// Time limit for the start of a board that reports its start, for instance while it searches
/// a network.
const MAX_START_TIME: Duration = Duration::from_secs(20);
/// Greatest pause within the answer to a query.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(1);
/// Greatest duration of the answer to a query.
const MAX_ANSWER_TIME: Duration = Duration::from_secs(10);
/// Duration of one segment of motion in the board's pulse timer.
const TIMER_SEGMENT: Duration = Duration::from_millis(10);
/// Greatest number of timer segments of FluidNC.
const MAX_TIMER_SEGMENTS: u32 = 20;
/// Real-time command for a soft reset (Ctrl-X).
const RESET: &str = "\x18";
/// Assumed size of the receive buffer of FluidNC, bytes; FluidNC does not report the size.
const MIN_RECEIVE_BYTES: u16 = 128;

/// The step of the opening dialogue that is being executed.
#[derive(Clone, Debug, PartialEq)]
enum OpeningStep {
    Greeting,
    Quiet,
    Asking(usize),
    Differs,
    Writing(usize),
    Known,
}

/// The action that the opening dialogue requests from the link.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum OpeningAction {
    /// The link waits until the board has sent more.
    Waits,
    /// The link sends this line, given without its line end.
    Send(String),
    /// The link sends this line, the first query for the settings, given without its line end.
    Configures(String),
    /// The opening is complete: the link may send motion.
    Done,
    /// Report these settings, which differ from the required ones. The link writes them only on
    /// request.
    Differs(Vec<SettingDifference>),
    /// The opening has failed: the link raises the alarm with this number and cause.
    Fails(u16, Message),
}

/// The dialogue that opens a link, and the properties that the board has reported.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LineOpening {
    step: OpeningStep,
    since: HostTime,
    opened: HostTime,
    has_received: bool,
    greeted: bool,
    last_received: HostTime,
    reported: Reported,
    pub(super) family: FirmwareFamily,
    pub(super) board: BoardInfo,
    /// Whether a work offset in the board is not 0.
    pub(super) offset: bool,
    /// Greatest time from leaving the board's queue to execution: the pulse timer of the board
    /// takes segments of 10 ms in advance.
    pub(super) prepared: Duration,
    /// Whether the board can home a single axis separately.
    pub(super) alone: bool,
    to_write: Vec<SettingDeviation>,
    /// Whether the link has written the settings that differ; it then reads all settings again.
    written: bool,
    /// Whether the board was reset because it did not answer the first query.
    reset: bool,
}

impl LineOpening {
    pub(super) fn new(now: HostTime) -> Self {
        Self {
            step: OpeningStep::Greeting,
            since: now,
            opened: now,
            has_received: false,
            greeted: false,
            last_received: now,
            reported: Reported::default(),
            family: FirmwareFamily::default(),
            board: BoardInfo::default(),
            offset: false,
            prepared: Duration::ZERO,
            alone: false,
            to_write: Vec::new(),
            written: false,
            reset: false,
        }
    }

    /// Creates an opening that repeats the dialogue on an open port; it does not wait for a banner.
    pub(super) fn again(now: HostTime) -> Self {
        Self {
            step: OpeningStep::Quiet,
            ..Self::new(now)
        }
    }

    /// Returns the last reported value of a numbered setting, in Grbl's unit; 0 if the board did
    /// not report it.
    pub(super) fn setting(&self, number: u16) -> f64 {
        self.reported.setting(number).unwrap_or_default()
    }

    /// Returns the reported value of a FluidNC item; `None` if the board did not report it.
    fn item(&self, path: &str) -> Option<&str> {
        self.reported.items.value(path)
    }

    /// Adds a line of the board's answer to `$CD`; ignores other texts.
    pub(super) fn take_text(&mut self, line: &str) {
        if let OpeningStep::Asking(question) = self.step
            && self.family.queries().get(question) == Some(&"$CD")
        {
            self.reported.items.take(line);
        }
    }

    fn prepares(&self) -> Duration {
        let pieces = match self.family {
            FirmwareFamily::Grbl => 6,
            FirmwareFamily::GrblHal => 10,
            FirmwareFamily::FluidNc => {
                let text = self.item("stepping/segments");
                let text = text.and_then(|text| text.parse().ok());
                text.unwrap_or(MAX_TIMER_SEGMENTS).min(MAX_TIMER_SEGMENTS)
            }
        };
        TIMER_SEGMENT * pieces
    }

    fn returns_alone(&self) -> bool {
        let allowed = |path| self.item(path) == Some("true");
        match self.family {
            FirmwareFamily::Grbl => false,
            FirmwareFamily::GrblHal => self.setting(22) as u32 & 2 != 0,
            FirmwareFamily::FluidNc => {
                allowed("axes/x/homing/allow_single_axis")
                    && allowed("axes/z/homing/allow_single_axis")
            }
        }
    }

    pub(super) fn is_done(&self) -> bool {
        self.step == OpeningStep::Known
    }

    /// Whether a banner is expected: the board has not been queried yet.
    pub(super) fn expects_banner(&self) -> bool {
        matches!(self.step, OpeningStep::Greeting | OpeningStep::Quiet)
    }

    /// Records that bytes were received at time `now`.
    pub(super) fn bytes_received(&mut self, now: HostTime) {
        self.has_received = true;
        self.last_received = now;
    }

    /// Advances the time, checks the time limits and returns the action for the link.
    pub(super) fn tick(&mut self, now: HostTime) -> OpeningAction {
        let waited = now.saturating_sub(self.since);
        let silent = now.saturating_sub(self.last_received.max(self.since));
        let over = silent >= ANSWER_TIMEOUT || waited >= MAX_ANSWER_TIME;
        match self.step {
            OpeningStep::Greeting if waited >= BANNER_WAIT => {
                self.enter_step(OpeningStep::Quiet, now);
                // The port did not reset the board. It may hold half a line of motion from
                // an earlier host, which must never be executed.
                OpeningAction::Send(RESET.into())
            }
            OpeningStep::Quiet
                if self.has_received
                    && waited >= QUIET
                    && now.saturating_sub(self.last_received) >= QUIET =>
            {
                self.ask(0, now)
            }
            OpeningStep::Quiet
                if now.saturating_sub(self.opened) >= GIVE_UP && waited >= SETTLE_AFTER_BANNER =>
            {
                let cause = if self.has_received {
                    say::board_never_stops_talking()
                } else {
                    say::board_says_nothing()
                };
                OpeningAction::Fails(
                    alarm::BOARD_SILENT,
                    say::board_no_answer(cause, say::board_is_another()),
                )
            }
            OpeningStep::Asking(0) if over && self.last_received >= self.since => {
                OpeningAction::Fails(
                    alarm::BOARD_UNSUPPORTED,
                    say::board_makes_no_sense(say::board_is_another()),
                )
            }
            OpeningStep::Asking(0) if over && !self.reset => {
                // After a limit alarm Grbl accepts a reset only.
                self.reset = true;
                self.opened = now;
                self.has_received = false;
                self.enter_step(OpeningStep::Quiet, now);
                OpeningAction::Send(RESET.into())
            }
            OpeningStep::Writing(index) if over => {
                OpeningAction::Fails(alarm::BOARD_UNSUPPORTED, self.hangs(index))
            }
            OpeningStep::Asking(_) if over => {
                OpeningAction::Fails(alarm::BOARD_SILENT, say::board_silent())
            }
            _ => OpeningAction::Waits,
        }
    }

    /// Returns the message that the board did not acknowledge the setting with this index in
    /// `to_write`.
    fn hangs(&self, index: usize) -> Message {
        let line = self.to_write.get(index).and_then(|one| one.line.as_deref());
        let line = line.unwrap_or("$…");
        if self.family == FirmwareFamily::GrblHal {
            return say::board_hangs_as_grblhal(line);
        }
        say::board_hangs(line)
    }

    fn enter_step(&mut self, step: OpeningStep, now: HostTime) {
        self.step = step;
        self.since = now;
    }

    fn ask(&mut self, question: usize, now: HostTime) -> OpeningAction {
        let Some(line) = self.family.queries().get(question) else {
            return OpeningAction::Waits;
        };
        self.enter_step(OpeningStep::Asking(question), now);
        match question {
            1 => OpeningAction::Configures((*line).into()),
            _ => OpeningAction::Send((*line).into()),
        }
    }

    /// Handles a line that the board has sent and returns the action for the link.
    pub(super) fn take(
        &mut self,
        answer: &LineResponse,
        required: &RequiredSettings,
        now: HostTime,
    ) -> OpeningAction {
        match (answer, &self.step) {
            (LineResponse::Banner(_), OpeningStep::Greeting) => {
                self.greeted = true;
                self.enter_step(OpeningStep::Quiet, now);
                OpeningAction::Send(String::new())
            }
            (LineResponse::Banner(_), OpeningStep::Quiet) => {
                self.greeted = true;
                OpeningAction::Waits
            }
            (LineResponse::Starts, OpeningStep::Quiet) if !self.greeted => {
                self.opened = now;
                self.enter_step(OpeningStep::Greeting, now);
                OpeningAction::Waits
            }
            (LineResponse::Starts | LineResponse::Message(_), OpeningStep::Greeting) => {
                // The board is starting; its banner follows.
                if now.saturating_sub(self.opened) < MAX_START_TIME {
                    self.since = now;
                }
                OpeningAction::Waits
            }
            (
                _,
                OpeningStep::Greeting
                | OpeningStep::Quiet
                | OpeningStep::Known
                | OpeningStep::Differs,
            ) => OpeningAction::Waits,
            (LineResponse::Ok, OpeningStep::Asking(question)) => {
                let question = *question;
                self.answered(question, required, now)
            }
            (LineResponse::Ok, OpeningStep::Writing(index)) => {
                let next = index + 1;
                self.write(next, now)
            }
            (LineResponse::Error(number), _) => self.refused(*number),
            (LineResponse::Version(version), _) => {
                version.clone_into(&mut self.reported.version);
                OpeningAction::Waits
            }
            (LineResponse::Options(blocks, bytes), _) => {
                (self.board.blocks, self.board.receive_bytes) = (*blocks, *bytes);
                OpeningAction::Waits
            }
            (LineResponse::Axes(axes), _) => {
                self.reported.axes = Some(axes.clone());
                OpeningAction::Waits
            }
            (LineResponse::Firmware(name), _) => {
                self.reported.firmware = Some(name.clone());
                OpeningAction::Waits
            }
            (LineResponse::NewOptions(options), _) => {
                self.board.spindle_sync = options.split(',').any(|option| option == "SS");
                OpeningAction::Waits
            }
            (LineResponse::Offset(set), _) => {
                self.offset |= *set;
                OpeningAction::Waits
            }
            (LineResponse::Setting(number, value), _) => {
                self.reported.settings.push((*number, *value));
                OpeningAction::Waits
            }
            _ => OpeningAction::Waits,
        }
    }

    fn refused(&self, number: u16) -> OpeningAction {
        let OpeningStep::Writing(index) = self.step else {
            return OpeningAction::Fails(
                alarm::BOARD_UNSUPPORTED,
                say::board_refuses_question(number),
            );
        };
        let line = self.to_write.get(index).and_then(|one| one.line.as_ref());
        let text = match line {
            Some(line) => say::board_refuses_line(line, number),
            None => say::board_refuses_setting(number),
        };
        OpeningAction::Fails(alarm::BOARD_SETTINGS, text)
    }

    fn answered(
        &mut self,
        question: usize,
        required: &RequiredSettings,
        now: HostTime,
    ) -> OpeningAction {
        if question == 0
            && let Err(error) = self.identify()
        {
            return OpeningAction::Fails(alarm::BOARD_UNSUPPORTED, error.message());
        }
        if question + 1 < self.family.queries().len() {
            return self.ask(question + 1, now);
        }
        if let Err(error) = self.measure() {
            return OpeningAction::Fails(alarm::BOARD_UNSUPPORTED, error.message());
        }
        self.prepared = self.prepares();
        self.alone = self.returns_alone();
        self.compare(required, now)
    }

    fn identify(&mut self) -> Result<(), Unsupported> {
        if let Some(name) = self.reported.fluidnc() {
            self.family = FirmwareFamily::FluidNc;
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
            "Grbl" => FirmwareFamily::Grbl,
            "grblHAL" => FirmwareFamily::GrblHal,
            _ => return Err(Unsupported::Firmware(family.to_owned())),
        };
        let version = self
            .reported
            .version
            .strip_prefix("1.1")
            .unwrap_or_default();
        if self.family == FirmwareFamily::Grbl && !version.starts_with(|letter| letter >= 'f') {
            return Err(Unsupported::Old(self.reported.version.clone()));
        }
        if let Some(axes) = &self.reported.axes
            && !(axes.contains('X') && axes.contains('Z'))
        {
            return Err(Unsupported::Axes(axes.clone()));
        }
        Ok(())
    }

    /// Stores the reported sizes of motion queue and receive buffer; returns an error if they are
    /// missing or too small.
    fn measure(&mut self) -> Result<(), Unsupported> {
        let source = if self.family == FirmwareFamily::FluidNc {
            let blocks = self
                .item("planner_blocks")
                .and_then(|text| text.parse().ok());
            self.board.blocks = blocks.map_or(0, |blocks: u16| blocks.saturating_sub(1));
            self.board.receive_bytes = MIN_RECEIVE_BYTES;
            "planner_blocks"
        } else {
            "[OPT:…]"
        };
        if self.board.blocks < 4 || self.board.receive_bytes < 64 {
            return Err(Unsupported::NoSizes(source));
        }
        Ok(())
    }

    fn compare(&mut self, required: &RequiredSettings, now: HostTime) -> OpeningAction {
        let deviations = self.deviations(required);
        if deviations.is_empty() {
            self.enter_step(OpeningStep::Known, now);
            return OpeningAction::Done;
        }
        if self.written {
            let lines = deviations.iter().filter_map(|one| one.line.clone());
            let list = lines.collect::<Vec<_>>().join(", ");
            return OpeningAction::Fails(alarm::BOARD_SETTINGS, say::board_settings_not_kept(list));
        }
        let differences = deviations.iter().map(|one| one.difference.clone());
        let differences = differences.collect();
        self.to_write = deviations;
        self.enter_step(OpeningStep::Differs, now);
        OpeningAction::Differs(differences)
    }

    fn deviations(&self, required: &RequiredSettings) -> Vec<SettingDeviation> {
        let settings = required
            .settings
            .iter()
            .map(|one| one.adapted_to(self.family));
        let numbered = settings.filter_map(|setting| {
            let board = self.reported.setting(setting.number);
            if board.is_some_and(|value| setting.is_met_by(value)) {
                return None;
            }
            Some(SettingDeviation {
                difference: SettingDifference {
                    number: setting.number,
                    name: format!("${}", setting.number),
                    board: board.map(|value| value.to_string()),
                    wanted: figure(setting.value),
                },
                line: Some(setting.line()),
            })
        });
        if self.family != FirmwareFamily::FluidNc {
            return numbered.collect();
        }
        let named = self.reported.items.deviations(&required.settings);
        // The report setting has a number in all firmwares.
        let reports = numbered.filter(|one| one.difference.number == REPORT);
        reports.chain(named).collect()
    }

    /// Starts to write the settings that differ, after the operator has confirmed the writing.
    /// Returns the action for the link; a setting that only the configuration file of the board can
    /// change makes the opening fail.
    pub(super) fn write_settings(&mut self, now: HostTime) -> OpeningAction {
        if self.step != OpeningStep::Differs {
            return OpeningAction::Waits;
        }
        let mine = self.to_write.iter().filter(|one| one.line.is_none());
        let list: Vec<_> = mine
            .map(|one| format!("{}: {}", one.difference.name, one.difference.wanted))
            .collect();
        if !list.is_empty() {
            let list = list.join(", ");
            return OpeningAction::Fails(alarm::BOARD_SETTINGS, say::board_settings_of_file(list));
        }
        self.write(0, now)
    }

    fn write(&mut self, index: usize, now: HostTime) -> OpeningAction {
        match self.to_write.get(index).and_then(|one| one.line.clone()) {
            Some(line) => {
                self.enter_step(OpeningStep::Writing(index), now);
                OpeningAction::Send(line)
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
