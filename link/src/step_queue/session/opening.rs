//! The opening dialogue with a board with timed steps: reads its dictionary, configures it
//! and syncs its clock.

use crate::position::Positioned;
use gsk_messages::{Message, say};
use gsk_units::alarm;

use core::time::Duration;

use super::super::super::{BoardInfo, HostTime, LinkEvent, LinkState, Uncertainty};
use super::super::clock_sync::ClockSync;
use super::super::commands::Command;
use super::super::dictionary::{Dictionary, LONGEST_PACKED, WiredSignals};
use super::super::dictionary_cache::DictionaryCache;
use super::super::send_queue::{self, Mark};
use super::super::shutdown;
use super::super::wiring::Wiring;
use super::group::Group;
use super::periodic::Periodic;
use super::{ASK_AGAIN, QueryPurpose, StepLink};

/// Time limit for each answer of the board during the opening.
const SILENCE: Duration = Duration::from_secs(5);
/// Number of dictionary bytes that one query requests.
const PIECE: usize = 40;
/// Time during which the link sends nothing to a board that it has reset.
const RESTARTS: Duration = Duration::from_millis(200);
/// Greatest number of resets of the board during an opening.
const MOST_RESTARTS: u32 = 2;

/// The phase of the opening dialogue.
#[derive(Clone, Debug)]
pub(super) enum Phase {
    /// The link queries the sequence number that the board expects.
    Sync,
    /// The link reads the dictionary. `known` is the index of a cached dictionary whose end
    /// is compared.
    Identify {
        packed: Vec<u8>,
        known: Option<usize>,
        queried_at: HostTime,
    },
    /// The link queries the configuration. `restarts` counts resets; `config_sent` tells
    /// whether the configuration was sent; `reason` is why the board then shut down.
    Ask {
        queried_at: HostTime,
        restarts: u32,
        config_sent: bool,
        reason: Option<String>,
    },
    /// The board is resetting, by a command of the link.
    Restarting { since: HostTime, restarts: u32 },
    /// The link synchronizes with the board's clock.
    Learn { restarts: u32 },
    /// The opening is complete: the board accepts commands.
    Running,
    /// The board is shut down and accepts a reset only; `opened` tells whether the opening
    /// was complete.
    ShutDown { opened: bool },
}

/// The opening dialogue with its phase, and the properties that the board has reported.
#[derive(Clone, Debug)]
pub(super) struct StepQueueOpening {
    pub(super) phase: Phase,
    /// Start of the time limit for an answer: when the opening began, the board was reset or
    /// another part of the dictionary was queried, whichever is latest.
    opened: HostTime,
    pub(super) info: BoardInfo,
    pub(super) dictionary_cache: DictionaryCache,
}

impl StepQueueOpening {
    pub(super) fn new(now: HostTime) -> Self {
        Self {
            phase: Phase::Sync,
            opened: now,
            info: BoardInfo::default(),
            dictionary_cache: DictionaryCache::default(),
        }
    }

    /// Whether the opening is complete and the board accepts commands.
    pub(super) const fn is_running(&self) -> bool {
        matches!(self.phase, Phase::Running)
    }

    /// Whether the opening was completed; true also if the board has shut down since.
    pub(super) const fn is_opened(&self) -> bool {
        matches!(
            self.phase,
            Phase::Running | Phase::ShutDown { opened: true }
        )
    }

    /// Enters the phase for a board that is shut down.
    pub(super) fn shut_down(&mut self) {
        let opened = self.is_opened();
        self.phase = Phase::ShutDown { opened };
    }

    /// Whether the board reports that it is shut down.
    pub(super) const fn is_shut_down(&self) -> bool {
        matches!(self.phase, Phase::ShutDown { .. })
    }
}

impl StepLink {
    /// Starts the opening: discards the board's data and queries the sequence number that it
    /// expects.
    pub(super) fn begin(&mut self) {
        self.opening.phase = Phase::Sync;
        self.opening.opened = self.session.now;
        self.lose_position(Uncertainty::Reset);
        self.stopping = None;
        self.query.pending = None;
        self.group = Group::default();
        self.periodic = Periodic::default();
        self.forget_spindle();
        self.wiring = None;
        self.motion.forget_board();
        self.wire.begin();
        self.session.enter(LinkState::Opening);
    }

    pub(super) fn open_further(&mut self) {
        if self.is_opened() || self.session.state == LinkState::Fault {
            return;
        }
        if self.session.since(self.opening.opened) >= SILENCE {
            self.not_opened();
            return;
        }
        let now = self.session.now;
        match &mut self.opening.phase {
            Phase::Sync if self.wire.send_queue.is_synced() => {
                self.session.enter(LinkState::Identify);
                self.opening.phase = Phase::Identify {
                    packed: Vec::new(),
                    known: None,
                    queried_at: self.session.now,
                };
                self.send_identify();
            }
            Phase::Identify { queried_at, .. }
                if now.saturating_sub(*queried_at) >= ASK_AGAIN
                    && self.wire.send_queue.is_empty() =>
            {
                // The query has arrived, but its answer was lost.
                *queried_at = now;
                self.send_identify();
            }
            Phase::Ask { queried_at, .. }
                if self.wire.send_queue.is_synced()
                    && self.wire.send_queue.is_empty()
                    && now.saturating_sub(*queried_at) >= ASK_AGAIN =>
            {
                *queried_at = now;
                self.wire.send_query(Command::GetConfig, &[], Mark::Config);
            }
            Phase::Restarting { since, restarts } if now.saturating_sub(*since) >= RESTARTS => {
                self.opening.phase = Phase::Ask {
                    queried_at: HostTime::ZERO,
                    restarts: *restarts,
                    config_sent: false,
                    reason: None,
                };
                self.clock = ClockSync::new(self.clock.rate);
                self.periodic = Periodic::default();
                self.wire.send_queue.begin();
            }
            Phase::Learn { .. } => self.learn(),
            _ => {}
        }
    }

    fn not_opened(&mut self) {
        let (is_synced, bytes) = (
            self.wire.send_queue.is_synced(),
            self.wire.traffic.received > 0,
        );
        if !is_synced && bytes && self.wire.send_queue.tries() > 1 {
            self.refuse(
                alarm::BOARD_UNSUPPORTED,
                say::board_makes_no_sense(say::board_is_another()),
            );
        } else {
            self.session.alarm(
                alarm::BOARD_SILENT,
                say::board_silent_at_opening(say::board_is_another()),
            );
            self.session.enter(LinkState::Lost);
        }
    }

    fn refuse(&mut self, number: u16, text: Message) {
        self.session.alarm(number, text);
        self.session.enter(LinkState::Fault);
    }

    /// Queries the next part of the dictionary. If a cached dictionary begins with the same
    /// bytes, queries the end of the dictionary instead, for comparison.
    fn send_identify(&mut self) {
        if let Phase::Identify { packed, known, .. } = &self.opening.phase {
            let end = known.and_then(|known| self.opening.dictionary_cache.end(known));
            let from = end.map_or(packed.len(), |(from, _)| from) as i64;
            self.wire.send(Command::Identify, &[from, PIECE as i64]);
        }
    }

    pub(super) fn identify_reply(&mut self, offset: u32, data: &[u8]) {
        let now = self.session.now;
        let Phase::Identify {
            packed,
            known,
            queried_at,
        } = &mut self.opening.phase
        else {
            return;
        };
        if let Some(index) = *known {
            let Some((from, end)) = self.opening.dictionary_cache.end(index) else {
                return;
            };
            if offset as usize != from {
                return;
            }
            if data == end {
                let whole = self
                    .opening
                    .dictionary_cache
                    .get(index)
                    .unwrap_or_default()
                    .to_vec();
                self.identified_as(&whole);
                return;
            }
            *known = self.opening.dictionary_cache.find(index + 1, packed);
        } else {
            if offset as usize != packed.len() {
                return;
            }
            packed.extend_from_slice(data);
            if data.is_empty() {
                let packed = core::mem::take(packed);
                self.opening.dictionary_cache.insert(packed.clone());
                self.identified_as(&packed);
                if self.wiring.is_some() {
                    let name = self.opening.info.firmware.clone();
                    self.session
                        .events
                        .push(LinkEvent::Learned { name, packed });
                }
                return;
            }
            if packed.len() > LONGEST_PACKED {
                self.refuse(alarm::BOARD_UNSUPPORTED, say::dictionary_endless());
                return;
            }
            if offset == 0 {
                *known = self.opening.dictionary_cache.find(0, packed);
            }
        }
        *queried_at = now;
        // Restart the time limit with each part of the dictionary.
        self.opening.opened = now;
        self.send_identify();
    }

    fn identified_as(&mut self, packed: &[u8]) {
        if let Err((number, text)) = self.understand(packed) {
            self.refuse(number, text);
        }
    }

    fn understand(&mut self, packed: &[u8]) -> Result<(), (u16, Message)> {
        let board = Dictionary::unpack(packed)
            .map_err(|error| (alarm::BOARD_UNSUPPORTED, error.message()))?;
        let io = &self.config.io;
        let has_encoder = !io.encoder.is_empty();
        let is_wired = |pin: &String| !pin.is_empty();
        let wired = WiredSignals {
            speed: is_wired(&io.spindle_pwm),
            index: is_wired(&io.index) && !has_encoder,
            encoder: has_encoder,
            axis_encoder: is_wired(&self.config.x.encoder.pin)
                || is_wired(&self.config.z.encoder.pin),
            wheel: is_wired(&io.wheel),
        };
        if let Some(missing) = board.missing(wired) {
            return Err((
                alarm::BOARD_UNSUPPORTED,
                say::board_command_unknown(missing),
            ));
        }
        let rate = board
            .constant("CLOCK_FREQ")
            .filter(|rate| *rate >= 1_000_000);
        let rate = rate.ok_or_else(|| (alarm::BOARD_UNSUPPORTED, say::board_clock_unknown()))?;
        let wiring = Wiring::new(&self.config, &board, rate.into())
            .map_err(|error| (alarm::BOARD_SETTINGS, error.message()))?;
        let window = board.constant("RECEIVE_WINDOW");
        self.opening.info.firmware = format!("{} {}", board.processor(), board.version);
        self.opening.info.receive_bytes = window
            .and_then(|bytes| bytes.try_into().ok())
            .unwrap_or(u16::MAX);
        self.wire.send_queue.set_window(window);
        self.clock = ClockSync::new(rate.into());
        self.motion
            .set_up(&self.config, board.processor(), rate.into());
        self.wire
            .send_queue
            .set_message_rate(self.motion.rates.messages);
        self.wire.dictionary = board;
        self.wiring = Some(wiring);
        self.session.enter(LinkState::Configure);
        self.opening.phase = Phase::Ask {
            queried_at: HostTime::ZERO,
            restarts: 0,
            config_sent: false,
            reason: None,
        };
        Ok(())
    }

    /// Takes the reported configuration of the board: whether it is configured, its CRC,
    /// whether it is shut down, and the size of its queue.
    pub(super) fn config_reply(&mut self, [configured, crc, shut_down, queue]: [u32; 4]) {
        if self.is_opened() {
            let ours = self.wiring.as_ref().map(|wiring| wiring.crc);
            if configured == 0 || ours != Some(crc) {
                self.board_restarted();
            }
            return;
        }
        let Phase::Ask {
            restarts,
            config_sent,
            ref reason,
            ..
        } = self.opening.phase
        else {
            return;
        };
        let Some(wiring) = &self.wiring else {
            return;
        };
        let ours = configured != 0 && crc == wiring.crc && shut_down == 0;
        if ours {
            self.opening.info.blocks = queue.try_into().unwrap_or(u16::MAX);
            self.motion.queue.set_slots(queue);
            self.opening.phase = Phase::Learn { restarts };
        } else if config_sent && reason.as_deref().is_some_and(shutdown::is_by_guard) {
            self.refuse(alarm::EMERGENCY_STOP, say::board_guard_at_opening());
        } else if config_sent {
            let text = self.not_taken(reason.as_deref());
            self.refuse(alarm::BOARD_SETTINGS, text);
        } else if configured == 0 && shut_down == 0 {
            let (messages, crc) = (wiring.messages.clone(), wiring.crc);
            for bytes in messages {
                self.wire
                    .send_queue
                    .push(send_queue::QueuedMessage::plain(bytes));
            }
            self.wire.send(Command::FinalizeConfig, &[crc.into()]);
            // The next query follows in the same stream.
            self.opening.phase = Phase::Ask {
                queried_at: self.session.now,
                restarts,
                config_sent: true,
                reason: None,
            };
        } else {
            self.restart_board(restarts + 1, shut_down != 0);
        }
    }

    /// Returns the text of alarm 603 for a refused configuration, with the board's reason; without
    /// it if `reason` is `None`.
    fn not_taken(&self, reason: Option<&str>) -> Message {
        match reason {
            None => say::board_configuration_refused(),
            // Only one output uses PWM: name its pin.
            Some(reason) if reason.contains("PWM") => {
                let pin = &self.config.io.spindle_pwm;
                let reason = format!("{reason} (link.io.spindle_pwm: {pin})");
                say::board_configuration_refused_for(say::as_written(reason))
            }
            Some(reason) => say::board_configuration_refused_for(say::as_written(reason)),
        }
    }

    /// Handles a shutdown during the opening. A board that shuts down because of an earlier host is
    /// reset. A board that shuts down because of the configuration is queried once more. `text` is
    /// the number of the shutdown reason. Returns false if the shutdown is not part of the opening.
    pub(super) fn shut_down_early(&mut self, text: u32) -> bool {
        let restarts = match &mut self.opening.phase {
            Phase::Learn { restarts } => *restarts,
            Phase::Running
                if !self.session.knows_position()
                    && self.session.now < self.periodic.inherited_until =>
            {
                0
            }
            Phase::Ask {
                config_sent: true,
                reason,
                ..
            } => {
                reason.get_or_insert_with(|| self.wire.dictionary.text(text));
                return true;
            }
            _ => return !self.is_opened(),
        };
        self.motion.forget_board();
        self.query.pending = None;
        self.session.enter(LinkState::Configure);
        self.restart_board(restarts + 1, true);
        true
    }

    /// Resets a board that has another configuration or is shut down (`shut_down`). `restarts`
    /// is the number of this restart; above [`MOST_RESTARTS`] the link refuses the board.
    fn restart_board(&mut self, restarts: u32, shut_down: bool) {
        if restarts > MOST_RESTARTS {
            self.refuse(alarm::BOARD_SETTINGS, say::board_configuration_stays());
        } else if self.wire.dictionary.has(Command::Reset) {
            self.wire.send(Command::Reset, &[]);
            self.send();
            self.opening.opened = self.session.now;
            let since = self.session.now;
            self.opening.phase = Phase::Restarting { since, restarts };
        } else {
            if !shut_down {
                self.wire.send(Command::EmergencyStop, &[]);
            }
            self.wire.send(Command::ConfigReset, &[]);
            self.opening.phase = Phase::Ask {
                queried_at: self.session.now,
                restarts,
                config_sent: false,
                reason: None,
            };
        }
    }

    /// Syncs the board clock; once it is synced, completes the opening: queries the position of the
    /// axes and starts the counter of the one-turn signal.
    fn learn(&mut self) {
        self.query_clock();
        if !self.clock.is_ready() {
            return;
        }
        self.opening.phase = Phase::Running;
        self.take_over_outputs();
        self.forget_spindle();
        self.query_encoder();
        self.query_wheel();
        let index = self.wiring.as_ref().and_then(|wiring| wiring.index);
        if let Some(oid) = index {
            let at = self.soon();
            let ticks = |micros| self.clock.ticks(Duration::from_micros(micros)) as i64;
            let arguments = [oid, i64::from(at as u32), ticks(100), ticks(20_000)];
            self.wire.send(Command::QueryCounter, &arguments);
        }
        self.query_position(QueryPurpose::Opening);
    }
}
