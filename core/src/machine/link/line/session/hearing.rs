//! What the board says: answers, reports, and when it is asked for one.

use super::super::super::{Doubt, Event, HostTime, LinkState};
use super::super::Family;
use super::super::answers::{Answer, BoardState, Status};
use super::super::opening::{Opening, Outcome};
use super::{AWAY, HEARD, Halt, LineLink, STATUS_IDLE, STATUS_MOVING};

impl LineLink {
    pub(super) fn take(&mut self, answer: &Answer) {
        if matches!(self.state, LinkState::Off | LinkState::Lost) {
            // It is for the operator to bring it back; it may say why it was silent.
            if matches!(answer, Answer::Banner(_)) && self.opening.is_done() {
                self.board_restarted();
            }
            return;
        }
        if !self.opening.is_done() {
            let expected = self.opening.expects_banner();
            if matches!(answer, Answer::Banner(_)) && !expected {
                self.board_restarted();
                return;
            }
            if matches!(answer, Answer::Ok | Answer::Error(_)) {
                self.unanswered.pop_front();
            }
            let outcome = self.opening.take(answer, &self.required, self.now);
            self.open_further(outcome);
            return;
        }
        match answer {
            Answer::Ok => self.line_done(None),
            Answer::Error(number) => self.line_done(Some(*number)),
            Answer::Alarm(number) => self.board_alarm(*number),
            Answer::Message(text) => self.board_says(text),
            Answer::Status(status) => self.report(*status),
            Answer::Banner(_) if matches!(self.halt, Halt::Restarting(_)) => self.banner_came(),
            Answer::Banner(_) if self.now < self.excused_until || self.started => {
                self.started = false;
            }
            Answer::Banner(_) => self.board_restarted(),
            Answer::Starts => {
                self.started = true;
                self.board_restarted();
            }
            Answer::Garbage => {
                self.traffic.garbage += 1;
                if self.state == LinkState::Moving {
                    self.protocol_error("a line that made no sense");
                }
            }
            _ => {}
        }
    }

    pub(super) fn report(&mut self, status: Status) {
        if let Some(asked) = self.asked.take() {
            self.traffic.round_trip = Some(self.now.saturating_sub(asked));
        }
        self.traffic.reports += 1;
        self.status = Some(status);
        self.follow_spindle(&status);
        self.pins = status.pins;
        if let Some(board) = self.pulses(status).filter(|_| self.counts) {
            self.stood = Some(self.to_kernel(board));
        }
        if let Some(ways) = self.limit_hit.take() {
            self.name_limits(status.pins, ways);
        }
        if self.state == LinkState::Moving
            && self.halt == Halt::None
            && let Some(board) = self.pulses(status)
        {
            // Pulses are made one at a time, and reports have three decimals.
            let [x, z] = self.required.pulses_per_mm;
            let off = self.off_path(board);
            if off > 0.002 + 2.0 / x + 2.0 / z {
                self.lose_position(Doubt::OffPath);
                self.alarm(
                    611,
                    &format!("the board is {off:.3} mm off the commanded path"),
                );
                // On a ramp it would go on toward a place nobody commanded.
                self.forget_motion();
                self.restart();
                self.enter(LinkState::Fault);
                return;
            }
        }
        if let Some(free) = status.free_blocks {
            let held = self.board().blocks.saturating_sub(free);
            self.retire(usize::from(held));
        }
        self.settle(status.state == BoardState::Idle);
        if status.state != BoardState::Idle {
            self.still_since = None;
        } else if self.still_since.is_none() {
            self.still_since = Some(self.now);
        }
        match status.state {
            BoardState::Held if matches!(self.halt, Halt::Braking(_)) => {
                self.restart();
            }
            BoardState::Held if self.halt == Halt::None && self.state.takes_motion() => {
                self.alarm(607, "the board was held by an input of its own");
                self.lose_position(Doubt::Misunderstood);
                self.flush();
                self.enter(LinkState::Fault);
            }
            BoardState::Alarm if self.state.takes_motion() => {
                self.board_alarm(0);
            }
            BoardState::Alarm if self.unlocks && self.halt == Halt::None => {
                self.unlocks = false;
                self.send("$X", false);
            }
            BoardState::Idle => self.unlocks = false,
            BoardState::Other if self.state.takes_motion() => {
                self.alarm(607, "the board reports a state nobody asked for");
                self.flush();
                self.enter(LinkState::Fault);
            }
            _ => {}
        }
    }

    /// Asks for a report when one is due.
    pub(super) fn ask(&mut self) {
        // A board that seeks its switches does not answer.
        let restarts = matches!(self.halt, Halt::Restarting(_));
        if restarts && self.opening.family == Family::FluidNc {
            // It takes a second for that, and answers meanwhile, mostly.
            self.asked = self
                .asked
                .filter(|asked| self.now.saturating_sub(*asked) < HEARD);
        } else if restarts || self.homing.is_some() {
            return;
        }
        if self.asked.is_some() {
            return;
        }
        let interval = match self.state {
            _ if self.halt != Halt::None => STATUS_MOVING,
            LinkState::Moving => STATUS_MOVING,
            _ => STATUS_IDLE,
        };
        if self.now.saturating_sub(self.last_asked) >= interval {
            self.outgoing.push(b'?');
            self.asked = Some(self.now);
            self.last_asked = self.now;
        }
    }

    /// The board is asked anew who it is and how it is set.
    pub(super) fn open_again(&mut self) {
        self.forget_motion();
        self.restart();
        self.halt = Halt::None;
        self.limit_hit = None;
        self.counts = false;
        self.restarted = false;
        self.started = false;
        self.unlocks = true;
        self.opening = Opening::again(self.now);
        self.enter(LinkState::Opening);
    }

    /// The next step of the dialogue that opens the link.
    pub(super) fn open_further(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Waits => {}
            Outcome::Send(line) => {
                if line == "$I" {
                    self.enter(LinkState::Identify);
                }
                self.send(&line, false);
            }
            Outcome::Configures(line) => {
                self.enter(LinkState::Configure);
                self.send(&line, false);
            }
            Outcome::Done => {
                self.unanswered.clear();
                self.enter(LinkState::Locked);
                if core::mem::take(&mut self.unlocks) {
                    // RESET has asked for it.
                    self.send("$X", false);
                }
            }
            Outcome::Differs(differences) => {
                let text = format!("settings of the board that differ: {}", differences.len());
                self.events
                    .extend(differences.into_iter().map(Event::Differs));
                self.alarm(603, &text);
            }
            Outcome::Fails(number, text) => {
                self.alarm(number, &text);
                self.enter(if number == 601 {
                    LinkState::Lost
                } else {
                    LinkState::Fault
                });
            }
        }
    }

    /// Takes the time over. While the computer was away nobody waited for the board.
    pub(super) fn passes(&mut self, now: HostTime) {
        let gap = now.saturating_sub(self.now);
        self.now = self.now.max(now);
        if gap < AWAY {
            return;
        }
        if gap >= self.config.lookahead() && !self.backlog.is_empty() {
            // The board stands by now; what waited for room in it would move it again.
            self.backlog.clear();
            self.protocol_error("the computer was away while motion waited for room");
        }
        self.progressed += gap;
        self.pass_was_unwatched(gap);
        for line in &mut self.unanswered {
            line.sent += gap;
        }
        if let Some(asked) = &mut self.asked {
            *asked += gap;
        }
        match &mut self.halt {
            Halt::None => {}
            Halt::Draining(since) | Halt::Braking(since) => *since += gap,
            Halt::Restarting(restart) => {
                restart.since += gap;
                restart.sent += gap;
            }
        }
    }
}
