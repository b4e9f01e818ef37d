//! Motion in the board: what is sent, what is certainly made, and whether the
//! board's count agrees.

use core::time::Duration;

use super::super::super::{Doubt, Event, HostTime, LinkState, RunTime};
use super::super::answers::Status;
use super::{Halt, LineLink, Queued, SETTLED};
use crate::units::{PerAxis, Point, Pulses};

/// A board answers for motion so long before it has made it, and a switch is told so
/// much later.
const PREPARED: Duration = Duration::from_millis(200);
/// A report may have been under way for so long.
const LATE_REPORT: Duration = Duration::from_millis(300);

impl LineLink {
    /// Sends what waits, as far as the board's buffer and queue reach.
    pub(super) fn feed(&mut self) {
        let space = usize::from(self.board().receive_bytes).saturating_sub(1);
        while let Some(segment) = self.backlog.front() {
            let under_way: usize = self.unanswered.iter().map(|line| line.bytes).sum();
            if under_way + segment.line.len() > space {
                return;
            }
            let Some(segment) = self.backlog.pop_front() else {
                return;
            };
            self.send(&segment.line, true);
            if self.queued.is_empty() {
                self.progressed = self.now;
            }
            self.queued.push_back(Queued {
                duration: segment.duration,
                end: segment.end,
                pulses: segment.pulses,
                answered: false,
            });
        }
    }

    pub(super) fn line_done(&mut self, error: Option<u16>) {
        let Some(line) = self.unanswered.pop_front() else {
            if self.halt == Halt::None && self.is_prepared() {
                self.protocol_error("an answer to nothing");
            }
            return;
        };
        if self.homing.is_some() && self.unanswered.is_empty() {
            return self.homed(error);
        }
        if self.is_cutting() {
            return self.pass_answered(error);
        }
        if let Some(number) = error {
            if self.halt == Halt::None && (self.state != LinkState::Locked || self.released) {
                self.protocol_error(&format!("a line was refused with error:{number}"));
            }
            return;
        }
        if line.is_segment
            && let Some(segment) = self.queued.iter_mut().find(|segment| !segment.answered)
        {
            segment.answered = true;
        }
        // The board cannot hold more than its queue: what is beyond was made.
        self.retire(usize::from(self.board().blocks));
        self.feed();
    }

    /// All answered segments but the newest `held` have left the queue of the board: its
    /// pulse timer has been handed them, and makes them next.
    pub(super) fn retire(&mut self, held: usize) {
        let answered = self
            .queued
            .iter()
            .take_while(|segment| segment.answered)
            .count();
        let leaving = answered.saturating_sub(held);
        let mut made_by = self.now + self.opening.prepared;
        let at = self.handed.len();
        for segment in self.queued.drain(..leaving).rev() {
            let duration = segment.duration;
            self.handed.insert(at, (made_by, segment));
            made_by = made_by.saturating_sub(duration);
            self.progressed = self.now;
        }
    }

    /// Counts as made what the pulse timer was handed so long ago; all of it when the
    /// board stands.
    pub(super) fn settle(&mut self, stands: bool) {
        let now = self.now;
        while let Some((_, segment)) = self
            .handed
            .pop_front_if(|(made_by, _)| stands || *made_by <= now)
        {
            for (axis, way) in way_between(self.made, segment.pulses)
                .into_iter()
                .enumerate()
            {
                match way {
                    1 => self.went[axis][0] = Some(now),
                    -1 => self.went[axis][1] = Some(now),
                    _ => {}
                }
            }
            self.past.push_back((now, self.made));
            self.executed = segment.end;
            self.made = segment.pulses;
        }
        while self
            .past
            .pop_front_if(|(at, _)| now.saturating_sub(*at) > LATE_REPORT)
            .is_some()
        {}
    }

    /// Motion of the board that may not have been made yet, the next first.
    fn unmade(&self) -> impl Iterator<Item = &Queued> {
        let handed = self.handed.iter().map(|(_, segment)| segment);
        handed.chain(&self.queued)
    }

    /// The ways on which the axes are moving, as far as the board's answers tell; 0: they
    /// stand, or turn round about now.
    pub(super) fn ways(&self) -> [i64; 2] {
        let recent = |went: Option<HostTime>| {
            went.is_some_and(|went| self.now.saturating_sub(went) < PREPARED)
        };
        let mut seen = self.went.map(|ways| ways.map(recent));
        let mut from = self.made;
        for segment in self.unmade() {
            for (axis, way) in way_between(from, segment.pulses).into_iter().enumerate() {
                seen[axis][0] |= way > 0;
                seen[axis][1] |= way < 0;
            }
            from = segment.pulses;
        }
        seen.map(|[up, down]| i64::from(up) - i64::from(down))
    }

    /// Distance of the board from the path it has been given, mm.
    pub(super) fn off_path(&self, board: PerAxis<Pulses>) -> f64 {
        let [per_x, per_z] = self.required.pulses_per_mm;
        let millimetres = |pulses: PerAxis<Pulses>| {
            Point::new(pulses.x.0 as f64 / per_x, pulses.z.0 as f64 / per_z)
        };
        let at = millimetres(self.to_kernel(board));
        let past = self.past.iter().map(|(_, place)| *place);
        let unmade = self.unmade().map(|segment| segment.pulses);
        let mut from = millimetres(self.past.front().map_or(self.made, |(_, place)| *place));
        let mut nearest = (at - from).length();
        for place in past.chain([self.made]).chain(unmade) {
            let to = millimetres(place);
            nearest = nearest.min(distance_to_line(at, from, to));
            from = to;
        }
        nearest
    }

    pub(super) fn to_kernel(&self, board: PerAxis<Pulses>) -> PerAxis<Pulses> {
        PerAxis::new(
            Pulses(board.x.0 - self.offset.x.0),
            Pulses(board.z.0 - self.offset.z.0),
        )
    }

    /// When the board stands and nothing is queued, its count is compared.
    pub(super) fn verify(&mut self) {
        let flushed = self.state == LinkState::Verify;
        let stands = self.state == LinkState::Ready;
        if !(flushed || stands || self.state == LinkState::Moving) || self.halt != Halt::None {
            return;
        }
        let idle = self.unanswered.is_empty()
            && self.backlog.is_empty()
            && self.queued.is_empty()
            && self.segments.pending() == RunTime::ZERO;
        let settled = self
            .still_since
            .is_some_and(|since| self.now.saturating_sub(since) >= SETTLED);
        let Some(board) = self.status.and_then(|status| self.pulses(status)) else {
            return;
        };
        if !(idle && settled) {
            return;
        }
        let kernel = self.to_kernel(board);
        if flushed {
            // The kernel takes over where the board came to stand.
            self.commanded = kernel;
            self.made = kernel;
            self.segments.begin(kernel, self.executed);
            if core::mem::take(&mut self.slipped) {
                self.lose_position(Doubt::TooFast);
            }
            self.events.push(Event::Position(kernel));
            self.stand();
            return;
        }
        if self.agrees(kernel) {
            if stands {
                return;
            }
            self.events.push(Event::Position(kernel));
            self.events.push(Event::Drained);
            self.stand();
            return;
        }
        self.lose_position(Doubt::Differs);
        let text = format!(
            "commanded X {} Z {} pulses, the board counts X {} Z {}",
            self.commanded.x.0, self.commanded.z.0, kernel.x.0, kernel.z.0
        );
        self.alarm(611, &text);
        self.enter(LinkState::Locked);
    }

    fn stand(&mut self) {
        self.enter(if self.position_known {
            LinkState::Ready
        } else {
            LinkState::Locked
        });
    }

    /// Speed of the fastest motion handed over and not yet made, mm/min.
    pub(super) fn fastest(&self) -> f64 {
        let [per_x, per_z] = self.required.pulses_per_mm;
        let mut from = self.made;
        let mut fastest = 0.0_f64;
        let queued = self.unmade().map(|piece| (piece.pulses, piece.duration));
        let waiting = self
            .backlog
            .iter()
            .map(|piece| (piece.pulses, piece.duration));
        for (to, duration) in queued.chain(waiting) {
            let way = Point::new(
                (to.x.0 - from.x.0) as f64 / per_x,
                (to.z.0 - from.z.0) as f64 / per_z,
            );
            fastest = fastest.max(way.length() / duration.as_secs_f64().max(1e-3) * 60.0);
            from = to;
        }
        fastest
    }

    /// Equal, or as near as the three decimals of a report can tell.
    pub(super) fn agrees(&self, kernel: PerAxis<Pulses>) -> bool {
        let near = |a: Pulses, b: Pulses, per_mm: f64| {
            let rounding = if per_mm > 500.0 {
                (per_mm * 0.000_5).ceil() as u64
            } else {
                0
            };
            (a.0 - b.0).unsigned_abs() <= rounding
        };
        let [x, z] = self.required.pulses_per_mm;
        near(kernel.x, self.commanded.x, x) && near(kernel.z, self.commanded.z, z)
    }

    /// The board's count in the kernel's pulses, as last reported.
    pub fn counted(&self) -> Option<PerAxis<Pulses>> {
        let board = self.status.and_then(|status| self.pulses(status))?;
        Some(self.to_kernel(board))
    }

    pub(super) fn pulses(&self, status: Status) -> Option<PerAxis<Pulses>> {
        let [x, z] = status.position?;
        let [per_x, per_z] = self.required.pulses_per_mm;
        Some(PerAxis::new(
            Pulses((x * per_x).round() as i64),
            Pulses((z * per_z).round() as i64),
        ))
    }
}

/// The ways on which the axes go from one place to another.
const fn way_between(from: PerAxis<Pulses>, to: PerAxis<Pulses>) -> [i64; 2] {
    [(to.x.0 - from.x.0).signum(), (to.z.0 - from.z.0).signum()]
}

/// Distance of a point from the stretch between two others.
fn distance_to_line(at: Point, from: Point, to: Point) -> f64 {
    let along = to - from;
    let square = along.x * along.x + along.z * along.z;
    if square == 0.0 {
        return (at - from).length();
    }
    let way = at - from;
    let share = ((way.x * along.x + way.z * along.z) / square).clamp(0.0, 1.0);
    (way - along * share).length()
}
