//! How the board becomes known: who it is, what it understands, how it is set up.

use core::time::Duration;

use super::super::super::{ANOTHER, Doubt, Event, HostTime, LinkState};
use super::super::clock::Clock;
use super::super::commands::Command;
use super::super::delivery::Mark;
use super::super::dictionary::{Dictionary, LONGEST_PACKED};
use super::super::wiring::Wiring;
use super::stops::Group;
use super::upkeep::Upkeep;
use super::{ASK_AGAIN, Purpose, StepLink};

/// By then the board must be known.
const SILENCE: Duration = Duration::from_secs(5);
/// The dictionary is read in pieces of so many bytes.
const PIECE: usize = 40;
/// A reset takes effect within this.
const RESTARTS: Duration = Duration::from_millis(200);
/// So often a board is reset to be set up.
const MOST_RESTARTS: u32 = 2;

/// How far the dialogue has come.
#[derive(Clone, Debug)]
pub(super) enum Phase {
    /// Which block does the board expect?
    Sync,
    /// Its dictionary so far, or the known one whose end is compared.
    Identify {
        packed: Vec<u8>,
        known: Option<usize>,
        asked: HostTime,
    },
    /// It is asked how it is set up; how often it was reset, and whether it has
    /// been told.
    Ask {
        asked: HostTime,
        restarts: u32,
        told: bool,
    },
    /// It resets itself.
    Restarting { since: HostTime, restarts: u32 },
    /// Its clock and its counts are learned; how often it was reset.
    Learn { restarts: u32 },
    /// All is known.
    Running,
}

impl StepLink {
    /// From the first byte.
    pub(super) fn begin(&mut self) {
        self.phase = Phase::Sync;
        self.opened = self.now;
        self.down = false;
        self.lose_position(Doubt::Reset);
        self.stopping = None;
        self.reading = None;
        self.group = Group::default();
        self.upkeep = Upkeep::default();
        self.forget_spindle();
        self.dictionary = Dictionary::default();
        self.wiring = None;
        self.motion.forget_board();
        self.reader.forget();
        self.delivery.begin();
        self.enter(LinkState::Opening);
    }

    pub(super) fn open_further(&mut self) {
        if self.is_running() || self.state == LinkState::Fault {
            return;
        }
        if self.now.saturating_sub(self.opened) >= SILENCE {
            self.not_opened();
            return;
        }
        let now = self.now;
        match &mut self.phase {
            Phase::Sync if self.delivery.is_synced() => {
                self.enter(LinkState::Identify);
                self.phase = Phase::Identify {
                    packed: Vec::new(),
                    known: None,
                    asked: self.now,
                };
                self.ask_who();
            }
            Phase::Identify { asked, .. }
                if now.saturating_sub(*asked) >= ASK_AGAIN && self.delivery.is_empty() =>
            {
                // It has arrived; its answer was lost.
                *asked = now;
                self.ask_who();
            }
            Phase::Ask { asked, .. }
                if self.delivery.is_synced()
                    && self.delivery.is_empty()
                    && now.saturating_sub(*asked) >= ASK_AGAIN =>
            {
                *asked = now;
                self.say_marked(Command::GetConfig, &[], Mark::Config);
            }
            Phase::Restarting { since, restarts } if now.saturating_sub(*since) >= RESTARTS => {
                self.phase = Phase::Ask {
                    asked: HostTime::ZERO,
                    restarts: *restarts,
                    told: false,
                };
                self.clock = Clock::new(self.clock.rate);
                self.upkeep = Upkeep::default();
                self.delivery.begin();
            }
            Phase::Learn { .. } => self.learn(),
            _ => {}
        }
    }

    fn not_opened(&mut self) {
        let (heard, bytes) = (self.delivery.is_synced(), self.traffic.received > 0);
        if !heard && bytes && self.delivery.tries() > 1 {
            self.refuse(
                602,
                &format!("what the board sends makes no sense; {ANOTHER}"),
            );
        } else {
            self.alarm(
                601,
                &format!("no answer from the board within 5 s; {ANOTHER}"),
            );
            self.enter(LinkState::Lost);
        }
    }

    fn refuse(&mut self, number: u16, text: &str) {
        self.alarm(number, text);
        self.enter(LinkState::Fault);
    }

    /// Asks for the next piece of the dictionary, or for the end that it would have.
    fn ask_who(&mut self) {
        if let Phase::Identify { packed, known, .. } = &self.phase {
            let end = known.and_then(|known| self.shelf.end(known));
            let from = end.map_or(packed.len(), |(from, _)| from) as i64;
            self.say(Command::Identify, &[from, PIECE as i64]);
        }
    }

    pub(super) fn identified(&mut self, offset: u32, data: &[u8]) {
        let now = self.now;
        let Phase::Identify {
            packed,
            known,
            asked,
        } = &mut self.phase
        else {
            return;
        };
        if let Some(place) = *known {
            let Some((from, end)) = self.shelf.end(place) else {
                return;
            };
            if offset as usize != from {
                return;
            }
            if data == end {
                let whole = self.shelf.whole(place).unwrap_or_default().to_vec();
                self.identified_as(&whole);
                return;
            }
            *known = self.shelf.find(place + 1, packed);
        } else {
            if offset as usize != packed.len() {
                return;
            }
            packed.extend_from_slice(data);
            if data.is_empty() {
                let packed = core::mem::take(packed);
                self.shelf.put(packed.clone());
                self.identified_as(&packed);
                if self.wiring.is_some() {
                    let name = self.info.firmware.clone();
                    self.events.push(Event::Learned { name, packed });
                }
                return;
            }
            if packed.len() > LONGEST_PACKED {
                self.refuse(602, "the dictionary of the board never ends");
                return;
            }
            if offset == 0 {
                *known = self.shelf.find(0, packed);
            }
        }
        *asked = now;
        // A board that is known takes time: silence is counted from here.
        self.opened = now;
        self.ask_who();
    }

    fn identified_as(&mut self, packed: &[u8]) {
        if let Err((number, text)) = self.understand(packed) {
            self.refuse(number, &text);
        }
    }

    fn understand(&mut self, packed: &[u8]) -> Result<(), (u16, String)> {
        let board = Dictionary::unpack(packed).map_err(|text| (602, text))?;
        let io = &self.config.io;
        if let Some(missing) = board.missing(!io.spindle_pwm.is_empty(), !io.index.is_empty()) {
            return Err((602, format!("the board does not know `{missing}`")));
        }
        let rate = board
            .constant("CLOCK_FREQ")
            .filter(|rate| *rate >= 1_000_000);
        let rate = rate.ok_or((602, "the board does not tell its clock rate".to_owned()))?;
        let wiring = Wiring::new(&self.config, &board, rate.into()).map_err(|text| (603, text))?;
        let window = board.constant("RECEIVE_WINDOW");
        self.info.firmware = format!("{} {}", board.processor(), board.version);
        self.info.receive_bytes = window
            .and_then(|bytes| bytes.try_into().ok())
            .unwrap_or(u16::MAX);
        self.delivery.set_window(window);
        self.clock = Clock::new(rate.into());
        self.motion
            .set_up(&self.config, board.processor(), rate.into());
        self.delivery.set_most_messages(self.motion.rates.messages);
        self.dictionary = board;
        self.wiring = Some(wiring);
        self.enter(LinkState::Configure);
        self.phase = Phase::Ask {
            asked: HostTime::ZERO,
            restarts: 0,
            told: false,
        };
        Ok(())
    }

    /// The board said how it is set up: configured, check, shut down, queue.
    pub(super) fn configured(&mut self, [configured, crc, shut_down, queue]: [u32; 4]) {
        if self.is_running() {
            let ours = self.wiring.as_ref().map(|wiring| wiring.crc);
            if configured == 0 || ours != Some(crc) {
                self.board_restarted();
            }
            return;
        }
        let Phase::Ask { restarts, told, .. } = self.phase else {
            return;
        };
        let Some(wiring) = &self.wiring else {
            return;
        };
        let ours = configured != 0 && crc == wiring.crc && shut_down == 0;
        if ours {
            self.info.blocks = queue.try_into().unwrap_or(u16::MAX);
            self.motion.set_queue(queue);
            self.phase = Phase::Learn { restarts };
        } else if told {
            self.refuse(603, "the board does not take its configuration");
        } else if configured == 0 && shut_down == 0 {
            let (messages, crc) = (wiring.messages.clone(), wiring.crc);
            for bytes in messages {
                self.delivery.say(super::Message::plain(bytes));
            }
            self.say(Command::FinalizeConfig, &[crc.into()]);
            // Asked in the same stream, behind it.
            self.phase = Phase::Ask {
                asked: self.now,
                restarts,
                told: true,
            };
        } else {
            self.restart_board(restarts + 1, shut_down != 0);
        }
    }

    /// A board that gives up because of what an earlier host has left undone begins
    /// anew.
    pub(super) fn shut_down_early(&mut self) -> bool {
        let restarts = match self.phase {
            Phase::Learn { restarts } => restarts,
            Phase::Running if !self.known && self.now < self.upkeep.inherited_until => 0,
            _ => return !self.is_running(),
        };
        self.motion.forget_board();
        self.reading = None;
        self.enter(LinkState::Configure);
        self.restart_board(restarts + 1, true);
        true
    }

    /// A board that is set up for something else, or shut down, begins anew.
    fn restart_board(&mut self, restarts: u32, shut_down: bool) {
        if restarts > MOST_RESTARTS {
            self.refuse(603, "the board does not give up its old configuration");
        } else if self.dictionary.has(Command::Reset) {
            self.say(Command::Reset, &[]);
            self.send();
            self.opened = self.now;
            let since = self.now;
            self.phase = Phase::Restarting { since, restarts };
        } else {
            if !shut_down {
                self.say(Command::EmergencyStop, &[]);
            }
            self.say(Command::ConfigReset, &[]);
            self.phase = Phase::Ask {
                asked: self.now,
                restarts,
                told: false,
            };
        }
    }

    /// The clock, where the axes stand, and the switches.
    fn learn(&mut self) {
        self.ask_clock();
        if !self.clock.is_ready() {
            return;
        }
        self.phase = Phase::Running;
        self.take_over_outputs();
        self.forget_spindle();
        let index = self.wiring.as_ref().and_then(|wiring| wiring.index);
        if let Some(oid) = index {
            let at = self.soon();
            let ticks = |micros| self.clock.ticks(Duration::from_micros(micros)) as i64;
            let arguments = [oid, i64::from(at as u32), ticks(100), ticks(20_000)];
            self.say(Command::QueryCounter, &arguments);
        }
        self.read_place(Purpose::Opening);
    }
}
