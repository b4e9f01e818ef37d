//! Executes a program on a real machine: a pulse board makes the motion at its own pace, and
//! the operator confirms that a stopped program continues.

use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use super::{End, Run, SETTLE_MS};
use crate::board::{Answer, Operator, PulseBoard};

const RESET_KEY: BitAddress = BitAddress::new(Area::X, 26, 0);
const MACHINE_ZERO_KEY: BitAddress = BitAddress::new(Area::X, 20, 3);
const FEED_HOLD_KEY: BitAddress = BitAddress::new(Area::X, 24, 7);
/// DM00, the decode signal of M00. It is on until its FIN, and only then does the program
/// stop.
const PROGRAM_STOP: BitAddress = BitAddress::new(Area::F, 9, 7);

/// The key that returns an axis to its machine zero.
const fn axis_key(axis: Axis) -> BitAddress {
    match axis {
        Axis::X => BitAddress::new(Area::X, 23, 1),
        Axis::Z => BitAddress::new(Area::X, 22, 7),
    }
}
/// Time limit of a return to machine zero, ticks.
const LONGEST_RETURN: u32 = 10 * 60 * 1000;
/// Ticks without motion after which a key counts as without effect.
const KEY_ACTS_WITHIN: u32 = 1000;
/// Ticks within which RESET clears the alarms that can be cleared.
const RESET_ACTS_WITHIN: u32 = 5000;
/// Ticks at standstill after which a stop raises no late alarm any more.
const STANDS: u32 = 300;

/// A pulse board that makes the motion of a run, with the operator who supervises it.
pub struct Board {
    /// The board.
    pub(super) live: Box<dyn PulseBoard>,
    home: bool,
    person: Option<Box<dyn Operator>>,
    /// Whether an alarm ends the run. Set after RESET, because alarms from before do not
    /// count.
    minds_alarms: bool,
}

impl Board {
    /// Takes an opened board. With `home` both axes return to machine zero before the program
    /// starts. `person` answers the question at a stop; with `None` a stop ends the run.
    pub fn new(live: Box<dyn PulseBoard>, home: bool, person: Option<Box<dyn Operator>>) -> Self {
        Self {
            live,
            home,
            person,
            minds_alarms: false,
        }
    }
}

/// State of a stop that waits for the operator.
#[derive(Debug, Default)]
pub(super) struct Standing {
    /// Duration of the stop, ticks.
    ticks: u32,
    /// Whether the question is on the terminal.
    asked: bool,
    /// Line of the last M00.
    program_stop: Option<u32>,
}

impl Run<'_> {
    /// Waits until the board allows a tick. Returns false if the end was requested.
    pub(super) fn may_tick(&mut self) -> bool {
        let Some(board) = &mut self.board else {
            return true;
        };
        let on = board.live.wait(&mut self.simulation);
        if !on {
            self.ended = Some(End::Asked);
        }
        // An alarm that the board raises between two ticks is no event of either.
        if let Some(alarm) = self.simulation.cnc.alarms().first()
            && board.minds_alarms
            && self.ended.is_none()
        {
            self.ended = Some(End::Alarm(alarm.clone()));
        }
        on
    }

    /// RESET unlocks the board; with [`Board::home`] both axes then return to machine zero.
    pub(super) fn prepare_board(&mut self) {
        let Some(home) = self.board.as_ref().map(|board| board.home) else {
            return;
        };
        self.press(RESET_KEY);
        for _ in 0..RESET_ACTS_WITHIN {
            if self.simulation.cnc.alarms().is_empty() {
                break;
            }
            self.tick();
        }
        if let Some(board) = &mut self.board {
            board.minds_alarms = true;
        }
        if !home {
            return;
        }
        self.press(MACHINE_ZERO_KEY);
        for axis in [Axis::X, Axis::Z] {
            self.home(axis);
        }
    }

    /// Holds the key of an axis until the axis is referenced. Some boards return both axes
    /// with the key of the first.
    fn home(&mut self, axis: Axis) {
        let key = axis_key(axis);
        let mut still = 0;
        for _ in 0..LONGEST_RETURN {
            if *self.simulation.cnc.referenced().get(axis) || self.ended.is_some() {
                self.simulation.cnc.set_panel_key(key, false);
                return self.settle();
            }
            self.simulation.cnc.set_panel_key(key, true);
            self.tick();
            still = if self.stands() { still + 1 } else { 0 };
            if still >= KEY_ACTS_WITHIN
                && let Some(why) = self.simulation.cnc.refuses_axis(axis)
            {
                self.ended = Some(End::Refused(why));
            }
        }
        self.simulation.cnc.set_panel_key(key, false);
        let why = say::run_home_endless(format_args!("{axis:?}"));
        self.ended = Some(End::Refused(why));
    }

    /// Whether control and board are at standstill.
    fn stands(&self) -> bool {
        let cnc = &self.simulation.cnc;
        !cnc.is_moving() && cnc.board_lag().is_none_or(|lag| lag.ticks == 0)
    }

    /// Supervises a program on a board, once a tick. The operator ends a stop at the terminal
    /// or with the cycle start of the machine. Without an operator at the terminal a stop ends
    /// the run.
    pub(super) fn attend(&mut self) {
        let state = self.simulation.cnc.run_state();
        if state == RunState::Run {
            let cnc = &self.simulation.cnc;
            let program_stop = match cnc.plc().memory().bit(PROGRAM_STOP) {
                true => Some(cnc.cursor().line),
                false => self.standing.program_stop,
            };
            self.standing = Standing {
                program_stop,
                ..Standing::default()
            };
        }
        if state == RunState::Run || self.ended.is_some() || !self.stands() {
            return;
        }
        self.standing.ticks += 1;
        if self.standing.ticks < STANDS {
            return;
        }
        if state == RunState::Reset {
            let why = match self.begun {
                true => End::Stop(say::run_reset_ended()),
                false => End::Refused(say::run_nothing_begun()),
            };
            self.ended = Some(self.refused().unwrap_or(why));
            return;
        }
        let hold = state == RunState::Hold;
        let place = self.place(hold);
        if !self.standing.asked {
            self.standing.asked = true;
            match self.question(&place) {
                true => {}
                // The operator held it at the machine, and continues it there.
                false if hold => self.watcher.tell(&say::run_goes_on_at_machine(place)),
                false => self.ended = Some(End::Stop(say::run_start_at(place))),
            }
            return;
        }
        match self.answer(&place) {
            Answer::Enter => {
                self.stops += u32::from(!hold);
                self.press_again();
                self.standing = Standing::default();
            }
            Answer::Gone if !hold => {
                self.ended = Some(End::Stop(say::run_start_at(place)));
            }
            Answer::None | Answer::Other | Answer::Gone => {}
        }
    }

    /// The message that says at which line the program stopped, and how.
    fn place(&self, hold: bool) -> Message {
        let line = self.simulation.cnc.cursor().line;
        match self.standing.program_stop == Some(line) {
            _ if hold => say::run_feed_hold(line),
            true => say::run_program_stop(line),
            false => say::run_stop(line),
        }
    }

    /// Shows the question whether to continue after a stop. Returns false if no operator is
    /// there.
    fn question(&mut self, place: &Message) -> bool {
        let person = self
            .board
            .as_ref()
            .and_then(|board| board.person.as_deref());
        let Some(person) = person else {
            return false;
        };
        person.forget();
        self.watcher.tell(&say::run_question(place.clone()));
        true
    }

    /// The operator's answer. An invalid answer repeats the question.
    fn answer(&mut self, place: &Message) -> Answer {
        let person = self
            .board
            .as_ref()
            .and_then(|board| board.person.as_deref());
        let answer = person.map_or(Answer::None, Operator::answer);
        if answer == Answer::Other {
            self.question(place);
        }
        answer
    }

    /// Asks the operator whether to start another part, and waits for the answer.
    pub(super) fn may_begin_another(&mut self) -> bool {
        if self.board.is_none() {
            return true;
        }
        let place = say::run_part_made(self.parts, self.wanted_parts);
        if !self.question(&place) {
            return false;
        }
        while self.ended.is_none() {
            if self.simulation.cnc.run_state() == RunState::Run {
                return true;
            }
            match self.answer(&place) {
                Answer::Enter => return true,
                Answer::Gone => return false,
                Answer::None | Answer::Other => self.tick(),
            }
        }
        false
    }

    /// Holds a program that still runs at the end of the run, and waits until the board has
    /// made the motion sent to it.
    pub(super) fn come_to_rest(&mut self) {
        if self.board.is_none() {
            return self.settle();
        }
        if self.simulation.cnc.run_state() == RunState::Run {
            self.simulation.cnc.set_panel_key(FEED_HOLD_KEY, true);
        }
        for _ in 0..SETTLE_MS {
            let runs = self.simulation.cnc.run_state() == RunState::Run;
            if self.stands() && !runs {
                break;
            }
            self.tick();
        }
        self.simulation.cnc.set_panel_key(FEED_HOLD_KEY, false);
    }

    /// Stops the board and closes its port.
    pub(super) fn close_board(&mut self) {
        if let Some(board) = self.board.take() {
            board.live.close(&mut self.simulation);
        }
    }
}
