//! The reference return: fast to the switch, slowly off it, and a little farther.
//! Both edges are seen by the board itself.

use core::time::Duration;

use super::super::super::{Event, FINE, HostTime, Input, LinkState, Refused, Sample};
use super::{Purpose, StepLink};
use crate::units::{Axis, PerAxis, Pulses};

/// The return of an axis ends within this.
const LONGEST: Duration = Duration::from_secs(120);
/// Time to come to speed, ms.
const RAMP_MS: f64 = 100.0;
/// Standing so long before the count is compared.
const SETTLED: Duration = Duration::from_millis(50);

/// How far an axis has come.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    /// To the switch.
    Seek,
    /// Off it.
    Leave,
    /// Away from it, up to this place.
    PullOff(f64),
    /// Standing there.
    Settle,
}

/// A reference return under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Homing {
    asked: PerAxis<bool>,
    axis: Axis,
    input: Input,
    since: HostTime,
    step: Step,
    /// Place, pulses, and speed, pulses a ms.
    place: f64,
    speed: f64,
}

impl StepLink {
    /// Begins the reference return of these axes, one after the other.
    ///
    /// # Errors
    /// The board moves or has not said how it stands.
    pub fn home(&mut self, axes: PerAxis<bool>) -> Result<(), Refused> {
        let first = match (axes.x, axes.z) {
            (true, _) => Axis::X,
            (_, true) => Axis::Z,
            _ => return Err(Refused::NotReady),
        };
        self.align(self.motion.commanded, self.motion.newest_end())?;
        self.lose_position();
        self.enter(LinkState::Homing);
        self.home_axis(axes, first);
        Ok(())
    }

    fn home_axis(&mut self, asked: PerAxis<bool>, axis: Axis) {
        let switches = match axis {
            Axis::X => [Input::DecelerationX, Input::LimitX],
            Axis::Z => [Input::DecelerationZ, Input::LimitZ],
        };
        let wired = switches
            .into_iter()
            .find(|input| self.input(*input).is_some());
        let Some(input) = wired else {
            self.alarm(609, &format!("no reference switch of {axis:?} is wired"));
            self.enter(LinkState::Locked);
            return;
        };
        let operated = self.input(input) == Some(true);
        self.homing = Some(Homing {
            asked,
            axis,
            input,
            since: self.now,
            step: if operated { Step::Leave } else { Step::Seek },
            place: self.motion.commanded.get(axis).0 as f64,
            speed: 0.0,
        });
        self.arm_group(Some((input, !operated)));
    }

    /// The switch has changed: the axes stand there.
    pub(super) fn home_reached(&mut self, kernel: PerAxis<Pulses>) {
        let Some(mut homing) = self.homing else {
            return;
        };
        homing.place = kernel.get(homing.axis).0 as f64;
        homing.speed = 0.0;
        if homing.step == Step::Seek {
            homing.step = Step::Leave;
            self.arm_group(Some((homing.input, false)));
        } else {
            let way = self.config.line.home.pull_off_um;
            let pulses = f64::from(way) / 1000.0 * self.per_mm(homing.axis);
            let target = homing.place - self.toward(homing.axis) * pulses.ceil();
            homing.step = Step::PullOff(target);
            self.arm_group(None);
        }
        self.homing = Some(homing);
    }

    /// The next piece of the way.
    pub(super) fn home_on(&mut self) {
        let Some(mut homing) = self.homing.filter(|_| self.stopping.is_none()) else {
            return;
        };
        if self.now.saturating_sub(homing.since) >= LONGEST {
            self.alarm(609, "the reference return takes longer than 120 s");
            self.halt(super::Why::Flush);
            return;
        }
        let home = self.config.line.home;
        let toward = self.toward(homing.axis);
        let pulses_a_ms = |feed: u32| f64::from(feed) / 60_000.0 * self.per_mm(homing.axis);
        let target = match homing.step {
            Step::Seek => toward * pulses_a_ms(home.seek),
            Step::Leave | Step::PullOff(_) => -toward * pulses_a_ms(home.locate),
            Step::Settle => {
                self.home_settled(homing.axis);
                return;
            }
        };
        let change = target.abs() / RAMP_MS;
        while self.free_time() >= Duration::from_millis(1) {
            homing.speed += (target - homing.speed).clamp(-change, change);
            homing.place += homing.speed;
            if let Step::PullOff(end) = homing.step
                && (homing.place - end) * toward <= 0.0
            {
                homing.place = end;
                homing.step = Step::Settle;
            }
            if self.home_to(&homing).is_err() {
                self.alarm(
                    609,
                    "the speed of the reference return is too high for the board",
                );
                self.halt(super::Why::Flush);
                return;
            }
            if homing.step == Step::Settle {
                let _ = self.finish();
                break;
            }
        }
        self.homing = Some(homing);
    }

    fn home_to(&mut self, homing: &Homing) -> Result<(), Refused> {
        let end = self.motion.newest_end() + Duration::from_millis(1);
        let mut sample = Sample::new(end, self.motion.commanded);
        *sample.pulses.get_mut(homing.axis) = Pulses(libm::round(homing.place) as i64);
        *sample.fine.get_mut(homing.axis) = libm::round(homing.place * FINE as f64) as i64;
        self.take_sample(sample)
    }

    /// The axis stands off its switch when the board's count says so.
    fn home_settled(&mut self, axis: Axis) {
        let settled = self
            .standing_since()
            .is_some_and(|since| self.now >= since + SETTLED);
        if settled && self.reading.is_none() && !self.motion.is_waiting() {
            self.read_place(Purpose::Homed(axis));
        }
    }

    /// The board has told where the axis stands.
    pub(super) fn homed(&mut self, axis: Axis) {
        let Some(homing) = self.homing else {
            return;
        };
        if self.motion.counted() != Some(self.motion.commanded) {
            self.alarm(
                611,
                "the board has not made the pulses of its reference return",
            );
            self.enter(LinkState::Locked);
        } else if axis == Axis::X && homing.asked.z {
            self.home_axis(homing.asked, Axis::Z);
        } else {
            self.enter(LinkState::Locked);
            self.events.push(Event::Homed(homing.asked));
        }
    }

    const fn toward(&self, axis: Axis) -> f64 {
        let negative = match axis {
            Axis::X => self.config.x.home_negative,
            Axis::Z => self.config.z.home_negative,
        };
        if negative { -1.0 } else { 1.0 }
    }

    const fn per_mm(&self, axis: Axis) -> f64 {
        match axis {
            Axis::X => self.pulses_per_mm[0],
            Axis::Z => self.pulses_per_mm[1],
        }
    }
}
