//! Everything that stops the axes, and what is known afterwards.
//!
//! The stop group lives in the board: limit switches, emergency stop, drive alarm,
//! the silence of the host and the link's own flush trigger it; both axes then stop
//! at once, and the board knows where.

use core::time::Duration;

use super::super::super::{Event, HostTime, Input, LinkState, Refused};
use super::super::commands::Command;
use super::super::delivery::{Mark, Message};
use super::super::wiring::Wiring;
use super::{GIVE_UP, Purpose, StepLink};
use crate::units::{PerAxis, Pulses};

/// Reasons of the group.
const LIMIT_X: u32 = 1;
const LIMIT_Z: u32 = 2;
const EMERGENCY: u32 = 3;
const SILENT_HOST: u32 = 4;
const DRIVES: u32 = 5;
const REACHED: u32 = 6;
const FLUSH: u32 = 9;
/// A switch counts when it was operated in so many samples, so far apart; between
/// two looks.
const SAMPLES: i64 = 4;
const SAMPLE: Duration = Duration::from_micros(15);
const LOOK: Duration = Duration::from_millis(1);
/// The group reports itself so often, and is doubted when it has not for longer.
const REPORT: Duration = Duration::from_millis(100);
const DOUBT: Duration = Duration::from_millis(450);
/// First time-out of the group, as all later ones.
const FIRST: Duration = Duration::from_millis(250);

/// The stop group in the board. Two take turns, so that a late report of the one
/// that has done its work is not taken for the other's.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Group {
    which: usize,
    used: bool,
    armed: bool,
    reported: HostTime,
    /// Input that ends a move, and the switches left out because they were
    /// operated.
    until: Option<Input>,
    left_out: [bool; 2],
}

impl Group {
    pub(super) fn armed_oid(&self, wiring: Option<&Wiring>) -> Option<i64> {
        wiring
            .filter(|_| self.armed)
            .map(|wiring| wiring.groups[self.which])
    }
}

/// Why the axes are being stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Why {
    /// The kernel asked for it.
    Flush,
    /// Motion came late, or could not be brought to the board in time.
    Late(&'static str),
    /// Motion of so many turns and bends that the board cannot be told in time.
    TooFine,
    /// The group has not reported itself.
    Doubt,
    /// The group was triggered.
    Trip(u32),
}

/// A stop under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stopping {
    why: Why,
    since: HostTime,
    asked: HostTime,
    /// The board has confirmed it.
    stands: bool,
}

impl StepLink {
    /// Arms the group: at a standstill, with everything that may stop the axes.
    pub(super) fn arm_group(&mut self, until: Option<(Input, bool)>) {
        let Some(wiring) = self.wiring.clone() else {
            return;
        };
        if self.group.used {
            // Triggered, the old group lets go of the axes.
            let old = wiring.groups[self.group.which];
            self.say(Command::TrsyncTrigger, &[old, FLUSH.into()]);
        }
        self.group = Group {
            which: 1 - self.group.which,
            used: true,
            armed: true,
            reported: self.now,
            until: until.map(|(input, _)| input),
            left_out: [false; 2],
        };
        let oid = wiring.groups[self.group.which];
        let clock = self.clock.clone();
        let ticks = |duration| clock.ticks(duration) as i64;
        let at = self.soon();
        let begin = i64::from(at as u32);
        let start = [oid, begin, ticks(REPORT), SILENT_HOST.into()];
        self.delivery.say(Message {
            mark: Some(Mark::Group),
            due: Some(at),
            vital: true,
            ..Message::plain(self.dictionary.message(Command::TrsyncStart, &start))
        });
        let timeout = self.clock.at(self.now + FIRST);
        for axis in [wiring.axes.x, wiring.axes.z] {
            self.say(Command::StepperStopOnTrigger, &[axis, oid]);
        }
        let (sample, look) = (ticks(SAMPLE), ticks(LOOK));
        for switch in &wiring.switches {
            let reason = match switch.input {
                Input::LimitX => Some(LIMIT_X),
                Input::LimitZ => Some(LIMIT_Z),
                Input::EmergencyStop => Some(EMERGENCY),
                Input::DriveAlarm => Some(DRIVES),
                _ => None,
            };
            let operated = self.input(switch.input) == Some(true);
            let waited = until.filter(|(input, _)| *input == switch.input);
            let (reason, level) = match (waited, reason) {
                (Some((_, wanted)), _) if wanted => (REACHED, switch.level),
                (Some(_), _) => (REACHED, 1 - switch.level),
                (None, Some(reason)) if !operated => (reason, switch.level),
                (None, reason) => {
                    match reason {
                        Some(LIMIT_X) => self.group.left_out[0] = true,
                        Some(LIMIT_Z) => self.group.left_out[1] = true,
                        _ => {}
                    }
                    self.say(Command::EndstopHome, &[switch.oid, 0, 0, 0, 0, 0, 0, 0]);
                    continue;
                }
            };
            let arguments = [
                switch.oid,
                begin,
                sample,
                SAMPLES,
                look,
                level,
                oid,
                reason.into(),
            ];
            self.say_vital(Command::EndstopHome, &arguments, at);
        }
        let first = [oid, i64::from(timeout as u32)];
        self.say_vital(Command::TrsyncSetTimeout, &first, timeout);
        self.motion.forget_steps();
    }

    /// Without it the axes must not move; no stop takes it back.
    fn say_vital(&mut self, command: Command, arguments: &[i64], due: u64) {
        self.delivery.say(Message {
            due: Some(due),
            vital: true,
            ..Message::plain(self.dictionary.message(command, arguments))
        });
    }

    /// From now on this input stops the axes as soon as it is operated (or is no
    /// longer, with `operated` false): the board sees it, and tells where.
    ///
    /// # Errors
    /// The axes do not stand with a position that is certain, or it is not wired.
    pub fn arm(&mut self, input: Input, operated: bool) -> Result<(), Refused> {
        let mut switches = self.wiring.iter().flat_map(|wiring| &wiring.switches);
        if !switches.any(|switch| switch.input == input) {
            return Err(Refused::NotWired);
        }
        if self.state != LinkState::Ready || self.stopping.is_some() {
            return Err(Refused::NotReady);
        }
        self.arm_group(Some((input, operated)));
        Ok(())
    }

    /// The input that was waited for does not stop the axes any more.
    pub fn disarm(&mut self) {
        if self.state == LinkState::Ready && self.stopping.is_none() && self.group.until.is_some() {
            self.arm_group(None);
        }
    }

    /// The group says how it is.
    pub(super) fn group_told(&mut self, [oid, can_trigger, reason, clock]: [u32; 4]) {
        if self.group.armed_oid(self.wiring.as_ref()) != Some(i64::from(oid)) {
            return;
        }
        self.group.reported = self.now;
        if can_trigger != 0 {
            self.clock.told(self.now, clock);
            return;
        }
        self.group.armed = false;
        let why = match self.stopping {
            Some(stopping) if reason == FLUSH => stopping.why,
            _ => Why::Trip(reason),
        };
        self.give_up_motion();
        if let Why::Trip(reason) = why {
            self.tell_trip(reason);
        }
        self.stopping = Some(Stopping {
            why,
            since: self.now,
            asked: self.now,
            stands: true,
        });
        self.read_place(Purpose::Stopped);
    }

    fn tell_trip(&mut self, reason: u32) {
        match reason {
            LIMIT_X => self.alarm(621, "limit input of X at the board"),
            LIMIT_Z => self.alarm(622, "limit input of Z at the board"),
            EMERGENCY => {
                self.upkeep.drives_on = false;
                self.alarm(207, "emergency stop input of the board");
            }
            SILENT_HOST => self.alarm(605, "the board has not heard of the PC for 250 ms"),
            DRIVES => self.alarm(221, "alarm input of the drives at the board"),
            REACHED => {}
            _ => self.alarm(
                607,
                &format!("the axes were stopped in the board, reason {reason}"),
            ),
        }
    }

    /// Both axes stop at once; nothing queued is left, the position is kept.
    pub(super) fn flush(&mut self) {
        if self.takes_motion() {
            self.halt(Why::Flush);
        }
    }

    /// Motion would come too late, or did not come: the axes are stopped.
    /// Why it did is known when the board has answered, or has not.
    pub(super) fn late(&mut self, detail: &'static str) {
        if self.stopping.is_none() && self.is_running() {
            self.halt(Why::Late(detail));
        }
        self.delivery.drop_motion();
    }

    /// The motion needs more messages than the board may be given.
    pub(super) fn too_fine(&mut self) {
        if self.stopping.is_none() && self.is_running() {
            self.halt(Why::TooFine);
        }
        self.delivery.drop_motion();
    }

    pub(super) fn halt(&mut self, why: Why) {
        if self.stopping.is_some() {
            return;
        }
        self.give_up_motion();
        self.stopping = Some(Stopping {
            why,
            since: self.now,
            asked: self.now,
            stands: false,
        });
        self.trigger();
        self.enter(LinkState::Verify);
    }

    fn trigger(&mut self) {
        if let Some(wiring) = &self.wiring {
            let oid = wiring.groups[self.group.which];
            // What is asked before and what is queued behind is without effect.
            self.say_marked(Command::TrsyncTrigger, &[oid, FLUSH.into()], Mark::Group);
        }
    }

    pub(super) fn watch_group(&mut self) {
        let patience = self.patience();
        if let Some(stopping) = &mut self.stopping {
            if stopping.stands {
                return;
            }
            if self.now.saturating_sub(stopping.since) >= GIVE_UP {
                self.lost("the board does not confirm that the axes were stopped");
            } else if self.now.saturating_sub(stopping.asked) >= patience {
                stopping.asked = self.now;
                self.trigger();
            }
            return;
        }
        let silent = self.now.saturating_sub(self.group.reported) >= DOUBT;
        if self.group.armed && silent && self.takes_motion() {
            self.alarm(605, "the stop group of the board does not report itself");
            self.halt(Why::Doubt);
            return;
        }
        let released = [Input::LimitX, Input::LimitZ]
            .into_iter()
            .zip(self.group.left_out)
            .any(|(input, left_out)| left_out && self.input(input) == Some(false));
        let stands = self.state != LinkState::Moving && !self.motion.is_under_way();
        if released && stands && self.takes_motion() {
            // The switch that was left out is free: it counts again.
            self.motion.unblock();
            self.arm_group(None);
        }
    }

    /// Nothing more goes out, and nothing that waits.
    pub(super) fn give_up_motion(&mut self) {
        self.motion.drop_queued();
        self.delivery.drop_motion();
        self.reading = None;
    }

    /// Behind a stop that was wanted: with a position that is certain motion is taken
    /// again.
    fn go_on(&mut self) {
        if self.known {
            self.arm_group(None);
            self.enter(LinkState::Ready);
        } else {
            self.enter(LinkState::Locked);
        }
    }

    /// The board said where the axes stand after a stop.
    pub(super) fn stopped(&mut self, board: PerAxis<Pulses>) {
        let Some(stopping) = self.stopping.take() else {
            return;
        };
        let keep = self.config.flush_keep_speed.into();
        let now = self.clock.at(self.now);
        let stop = self.motion.stopped_at(board, now, self.pulses_per_mm);
        if stopping.why == Why::Trip(REACHED) && self.homing.is_some() {
            self.home_reached(stop.kernel);
            return;
        }
        let reached = stopping.why == Why::Trip(REACHED);
        // A stepper that was stopped dead may have slipped when it was fast.
        self.known &= stop.on_path && (stop.speed <= keep || reached);
        self.released = false;
        if let Why::Trip(reason @ (LIMIT_X | LIMIT_Z)) = stopping.why {
            self.motion
                .block(if reason == LIMIT_X { 0 } else { 1 }, stop.way);
        }
        self.events.push(Event::Position(stop.kernel));
        self.tell_outputs_again();
        match stopping.why {
            Why::Flush => self.go_on(),
            Why::Trip(REACHED) => {
                if let Some(input) = self.group.until {
                    self.events.push(Event::Reached(input, stop.kernel));
                }
                self.go_on();
            }
            Why::Late(detail) => {
                self.alarm(612, detail);
                self.enter(LinkState::Fault);
            }
            Why::TooFine => {
                let text = "the motion turns and bends more often than the board can be told: \
                            a lower feed, or longer blocks";
                self.alarm(604, text);
                self.enter(LinkState::Fault);
            }
            Why::Doubt => self.enter(LinkState::Fault),
            Why::Trip(_) => self.enter(LinkState::Tripped),
        }
    }
}
