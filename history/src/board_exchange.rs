//! The exchange with a pulse board as steps of a recording: what the board has sent at which
//! time, and what it was sent. The link computes the rest again, without the board.

use core::time::Duration;

use gsk_core::linked::LinkedControl;
use gsk_link::LinkConfig;
use gsk_messages::Message;
use serde::{Deserialize, Serialize};

use crate::moment::MachineMoment;

/// Greatest number of ticks in one step.
const MAX_STEP_TICKS: u32 = 1000;

/// Bytes of the exchange. In a recording each of them is one character (Latin-1).
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub struct ExchangedBytes(pub Vec<u8>);

impl From<String> for ExchangedBytes {
    fn from(text: String) -> Self {
        Self(text.chars().map(|letter| letter as u8).collect())
    }
}

impl From<ExchangedBytes> for String {
    fn from(bytes: ExchangedBytes) -> Self {
        bytes.0.into_iter().map(char::from).collect()
    }
}

/// A step of the exchange with a board. The names in a recording of those that are frequent are
/// short.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum BoardStep {
    /// The link to the board was opened. From here on the steps make the ticks.
    Opened {
        /// Port and wiring of the board.
        config: Box<LinkConfig>,
        /// Data dictionaries that boards sent in earlier sessions.
        dictionaries: Vec<ExchangedBytes>,
    },
    /// The port has failed for this reason.
    PortFailed(Message),
    /// The guard process has stopped the board, which has answered these bytes.
    GuardStopped(ExchangedBytes),
    /// The program did not run for this time, ns.
    HostGap(u64),
    /// The port was read: time since it was read before, ns, and the bytes of the board.
    #[serde(rename = "r")]
    Read(u64, ExchangedBytes),
    /// The machine made this number of ticks. True: another one was requested, and the board
    /// did not permit it.
    #[serde(rename = "t")]
    Ticked(u32, bool),
    /// The port has taken these bytes for the board.
    #[serde(rename = "w")]
    Written(ExchangedBytes),
    /// The differing settings were written to the board.
    SettingsWritten,
    /// The count of the board was queried.
    CountChecked,
    /// The link to the board was closed.
    Closed,
}

/// A step with the tick of the machine at its beginning.
#[derive(Clone, Debug, PartialEq)]
pub struct StampedStep {
    /// Ticks of the emulator when the step began.
    pub tick: u64,
    /// The step of the exchange.
    pub step: BoardStep,
}

/// What a replay has found about the exchange with a board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExchangeSummary {
    /// Number of bytes that the board has sent.
    pub received_bytes: u64,
    /// Number of bytes that the board was sent.
    pub sent_bytes: u64,
    /// The first tick at which the link has sent other bytes than recorded, or paced the machine
    /// in another way; `None` if there is none.
    pub first_difference: Option<u64>,
}

impl ExchangeSummary {
    fn note_difference(&mut self, tick: u64) {
        self.first_difference.get_or_insert(tick);
    }
}

/// The link to a board in a replay.
#[derive(Debug)]
pub(crate) struct ReplayedBoard {
    linked: LinkedControl,
    now: Duration,
}

impl ReplayedBoard {
    /// Opens the link as recorded; `None` if the configuration is not one.
    pub(crate) fn open(
        config: LinkConfig,
        dictionaries: Vec<ExchangedBytes>,
        moment: &mut MachineMoment,
    ) -> Option<Self> {
        config.check().ok()?;
        let simulation = moment.emulator.board_simulation();
        let mut linked = LinkedControl::open(config, simulation, Duration::ZERO);
        linked.add_dictionaries(dictionaries.into_iter().map(|it| it.0).collect());
        Some(Self {
            linked,
            now: Duration::ZERO,
        })
    }

    /// Closes the link as the kernel does.
    pub(crate) fn close(mut self, moment: &mut MachineMoment) {
        self.linked.check_count_before_close();
        self.linked.close(moment.emulator.board_simulation());
    }

    /// Plays a step that makes no tick; `moment` is the machine at it.
    pub(crate) fn play(
        &mut self,
        step: &BoardStep,
        moment: &MachineMoment,
        summary: &mut ExchangeSummary,
    ) {
        let linked = &mut self.linked;
        match step {
            BoardStep::PortFailed(cause) => linked.handle_port_failure(cause.clone()),
            BoardStep::GuardStopped(answered) => linked.handle_guard_stop(&answered.0),
            BoardStep::HostGap(gap_ns) => linked.handle_host_gap(Duration::from_nanos(*gap_ns)),
            BoardStep::Read(elapsed_ns, bytes) => {
                summary.received_bytes += bytes.0.len() as u64;
                self.now = self.now.saturating_add(Duration::from_nanos(*elapsed_ns));
                linked.pump(&bytes.0, self.now);
            }
            BoardStep::Written(bytes) => {
                summary.sent_bytes += bytes.0.len() as u64;
                if !linked.tx().starts_with(&bytes.0) {
                    summary.note_difference(moment.ticks());
                }
                let count = bytes.0.len().min(linked.tx().len());
                linked.mark_written(count);
                linked.take_notes();
            }
            BoardStep::SettingsWritten => linked.write_settings(),
            BoardStep::CountChecked => linked.check_count(),
            BoardStep::Opened { .. } | BoardStep::Ticked(..) | BoardStep::Closed => {}
        }
    }

    /// Prepares the next tick as the kernel does: the link permits it and passes its inputs.
    pub(crate) fn before_tick(
        &mut self,
        moment: &mut MachineMoment,
        summary: &mut ExchangeSummary,
    ) {
        if !self.linked.can_tick() {
            summary.note_difference(moment.ticks());
        }
        self.linked.before_tick(moment.emulator.board_simulation());
    }

    /// Passes the motion of the tick to the link.
    pub(crate) fn after_tick(&mut self, moment: &mut MachineMoment) {
        self.linked.after_tick(moment.emulator.board_simulation());
    }

    /// Requests a tick that the board did not permit.
    pub(crate) fn refuse_tick(&mut self, moment: &MachineMoment, summary: &mut ExchangeSummary) {
        if self.linked.can_tick() {
            summary.note_difference(moment.ticks());
        }
    }
}

/// Collects the steps of an exchange while it takes place.
#[derive(Debug, Default)]
pub struct ExchangeLog {
    is_on: bool,
    /// Ticks of the machine, as far as the log has followed them.
    tick: u64,
    steps: Vec<StampedStep>,
    last_read: Duration,
}

impl ExchangeLog {
    /// Starts to collect with the opening of the link at a tick of the machine.
    pub fn open(tick: u64, config: LinkConfig, dictionaries: Vec<Vec<u8>>) -> Self {
        let dictionaries = dictionaries.into_iter().map(ExchangedBytes).collect();
        let mut log = Self {
            is_on: true,
            tick,
            ..Self::default()
        };
        log.add(BoardStep::Opened {
            config: Box::new(config),
            dictionaries,
        });
        log
    }

    /// Adds a step that makes no tick.
    pub fn add(&mut self, step: BoardStep) {
        if self.is_on {
            let tick = self.tick;
            self.steps.push(StampedStep { tick, step });
        }
    }

    /// Adds a read of the port at the host time `now`.
    pub fn add_read(&mut self, now: Duration, bytes: &[u8]) {
        let elapsed = now.saturating_sub(self.last_read);
        self.last_read = now;
        let bytes = ExchangedBytes(bytes.to_vec());
        self.add(BoardStep::Read(elapsed.as_nanos() as u64, bytes));
    }

    /// Adds the bytes that the port has taken.
    pub fn add_written(&mut self, bytes: &[u8]) {
        if !bytes.is_empty() {
            self.add(BoardStep::Written(ExchangedBytes(bytes.to_vec())));
        }
    }

    /// Adds a request for a tick, and whether the board permits it.
    pub fn add_tick_request(&mut self, is_permitted: bool) {
        if !self.is_on {
            return;
        }
        let last = self.steps.last_mut().map(|last| &mut last.step);
        match last {
            Some(BoardStep::Ticked(count, is_refused @ false)) if *count < MAX_STEP_TICKS => {
                *count += u32::from(is_permitted);
                *is_refused = !is_permitted;
            }
            _ => self.add(BoardStep::Ticked(u32::from(is_permitted), !is_permitted)),
        }
        self.tick += u64::from(is_permitted);
    }

    /// Returns and removes the steps so far.
    pub fn take_steps(&mut self) -> Vec<StampedStep> {
        core::mem::take(&mut self.steps)
    }
}
