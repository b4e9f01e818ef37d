//! Runs the kernel in its thread: ticks by the clock, sleeps in between.

use std::path::PathBuf;

use crossbeam::channel::{RecvTimeoutError, TryRecvError};
use gsk_messages::{Message, say};
use tracing::error;
use web_time::{Duration, Instant};

use super::journal::Journal;
use super::{Command, Console, Kernel, Notice, PICTURE_TICKS, Times};
use crate::ending::{ENDED, Ending};
use crate::pace::{Pace, Speed};
use crate::platform::{self, Turning};
use crate::retained::Keeper;
use crate::{log, output, transfer};

/// Time between two checks whether memory needs to be saved.
const KEEP: Duration = Duration::from_millis(100);
/// Time the window has to close when the program ends.
const WINDOW_CLOSES: Duration = Duration::from_secs(3);

/// Time between two snapshots: the duration of [`PICTURE_TICKS`] on a real lathe.
const PICTURE: Duration = Duration::from_millis(PICTURE_TICKS);
/// A program that got no processor time for this duration was asleep.
const ASLEEP: Duration = Duration::from_secs(2);
/// Ticks between two checks of keys and clock.
const TICKS_A_LOOK: u64 = 40;
/// Longest time the thread makes ticks without other work.
const AT_ONCE: Duration = Duration::from_millis(10);

/// What the kernel thread needs from its environment.
pub struct Outside {
    /// Called when there is a new snapshot or notice; it must not wait for the window.
    pub wake: Box<dyn Fn() + Send>,
    /// Saves the memory; `None` without a data directory.
    pub keeper: Option<Keeper>,
    /// The folder for files that the control sends, if there is one.
    pub partner: Option<PathBuf>,
    /// Requests the end of the program.
    pub ending: Ending,
}

/// Handle of the running kernel thread; dropping it stops the thread.
#[derive(Debug)]
pub struct KernelThread {
    console: Console,
    turning: Option<Turning>,
}

impl KernelThread {
    pub fn is_alive(&self) -> bool {
        self.turning.as_ref().is_some_and(Turning::goes_on)
    }

    /// Stops the thread and waits until it has saved everything.
    pub fn stop(&mut self) {
        let Some(turning) = self.turning.take() else {
            return;
        };
        // The queue may be full: the kernel empties it.
        let _ = self.console.commands.send(Command::Quit);
        if !turning.finish() {
            output::complain_of(&say::kernel_thread_failed());
        }
    }
}

impl Drop for KernelThread {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Starts the kernel thread.
///
/// # Errors
/// The system starts no thread.
pub fn start(kernel: Kernel, console: &Console, outside: Outside) -> std::io::Result<KernelThread> {
    let mut running = Some(Running::new(kernel, outside, console.clone()));
    let turning = platform::turn("kernel", move || {
        let goes_on = running.as_mut().is_some_and(Running::turn);
        if !goes_on && let Some(running) = running.take() {
            running.end();
        }
        goes_on
    })?;
    Ok(KernelThread {
        console: console.clone(),
        turning: Some(turning),
    })
}

/// The kernel with its clock.
struct Running {
    kernel: Kernel,
    outside: Outside,
    console: Console,
    pace: Pace,
    journal: Journal,
    /// When the next snapshot is due.
    picture_at: Instant,
    /// A moment just before the window's last command, and the number of commands by then.
    heard: (Duration, u64),
    /// Time at which the keys that are down were first seen held.
    held: Option<Duration>,
    /// When the loop last checked the clock.
    looked: Instant,
    /// When the keeper last checked the memory.
    kept: Instant,
}

impl Running {
    fn new(mut kernel: Kernel, outside: Outside, console: Console) -> Self {
        let now = Instant::now();
        kernel.show();
        (outside.wake)();
        Self {
            kernel,
            outside,
            console,
            pace: Pace::new(now),
            journal: Journal::default(),
            picture_at: now,
            heard: (platform::time_with_sleep(), 0),
            held: None,
            looked: now,
            kept: now,
        }
    }

    /// Makes the ticks that are due and waits for the next ones, or for a command; returns
    /// `false` at the end.
    fn turn(&mut self) -> bool {
        if self.kernel.quit || self.outside.ending.is_asked() {
            return false;
        }
        let now = Instant::now();
        // The computer may sleep at any moment.
        let awake = platform::time_with_sleep();
        self.let_go(awake);
        self.say_after_sleep(now);
        self.tick(now);
        self.show(now);
        self.hand_out_sent();
        self.keep(now);
        let goes_on = self.hear(now);
        // The computer may have slept since: a command counts from the moment before it
        // was received.
        if self.kernel.heard > self.heard.1 {
            self.heard = (awake, self.kernel.heard);
        }
        goes_on
    }

    /// Releases held keys if the window has been silent for too long, or if nothing proves
    /// that they are still held: no motion depends on a release that may never come.
    fn let_go(&mut self, now: Duration) {
        let kernel = &mut self.kernel;
        if !kernel.keys.any_down() {
            self.held = None;
            if kernel.is_linked() && kernel.watch.is_silent(now) {
                kernel.drop_wheel();
            }
            return;
        }
        let pressed = *self.held.get_or_insert(now);
        let silent = kernel.watch.has_window_lapsed(self.heard.0, now);
        if silent || kernel.watch.has_lapsed(pressed, now) {
            self.held = None;
            kernel.let_go();
            kernel.say(Notice::Said(say::keys_let_go()));
            (self.outside.wake)();
        }
    }

    /// Reports that the machine was not running while the computer slept or the page was
    /// frozen.
    fn say_after_sleep(&mut self, now: Instant) {
        let away = now.duration_since(self.looked);
        self.looked = now;
        if away > ASLEEP && !self.kernel.is_linked() {
            let said = say::window_stood_still(away.as_secs());
            self.kernel.say(Notice::Said(said));
            (self.outside.wake)();
        }
    }

    fn tick(&mut self, now: Instant) {
        let Self { kernel, pace, .. } = self;
        if !kernel.is_linked() {
            self.journal.turn(now, pace.next());
        }
        pace.set_speed(kernel.speed(), now);
        let due = pace.due(now);
        if kernel.is_linked() {
            // The clock of the board counts; the machine runs as fast as it must.
            kernel.speed_percent = 100;
            kernel.times = None;
            if kernel.run_linked() {
                (self.outside.wake)();
            }
        } else {
            let ran = run(kernel, due, pace.speed(), now + AT_ONCE);
            pace.give_back(due.saturating_sub(ran));
        }
        let link = kernel.link_state();
        self.journal.look(&kernel.emulator.simulation.cnc, link);
    }

    /// Publishes a snapshot when one is due; with a board the snapshots come with its
    /// ticks.
    fn show(&mut self, now: Instant) {
        let Self { kernel, pace, .. } = self;
        if kernel.is_linked() || now < self.picture_at {
            return;
        }
        self.picture_at = now + PICTURE;
        let real = pace.speed() == Speed::REAL;
        kernel.speed_percent = if real {
            speed_percent(pace.ratio())
        } else {
            100
        };
        kernel.times = (!real).then(|| times(pace.ratio()));
        if kernel.show() {
            (self.outside.wake)();
        }
    }

    /// Passes the files that the control has sent to its partner.
    fn hand_out_sent(&mut self) {
        let Some(folder) = &self.outside.partner else {
            return;
        };
        let files = self.kernel.emulator.panel.take_sent();
        if !files.is_empty() {
            let console = self.console.clone();
            transfer::write_aside(folder.clone(), files, move |written| {
                tell_of_transfer(&console, written);
            });
        }
    }

    /// Saves changes of the memory.
    fn keep(&mut self, now: Instant) {
        if let Some(keeper) = &mut self.outside.keeper
            && now.duration_since(self.kept) > KEEP
        {
            self.kept = now;
            keeper.look(self.kernel.kept());
            for complaint in keeper.complaints() {
                error!("not saved: {complaint}");
                self.kernel.say(Notice::Said(complaint));
                (self.outside.wake)();
            }
        }
    }

    /// Waits for a command, or for the next ticks; returns `false` once every sender is
    /// gone.
    fn hear(&mut self, now: Instant) -> bool {
        let kernel = &mut self.kernel;
        let told = match kernel.wakes_at(now, &self.pace) {
            Some(until) => platform::receive(&kernel.commands, Some(until)),
            // A wait yields the processor, even with no time to wait: on a busy computer
            // the thread continues tens of milliseconds later, and the board gets no bytes
            // meanwhile.
            None => kernel.commands.try_recv().map_err(|error| match error {
                TryRecvError::Empty => RecvTimeoutError::Timeout,
                TryRecvError::Disconnected => RecvTimeoutError::Disconnected,
            }),
        };
        match told {
            Ok(command) => {
                kernel.carry_out(command);
                true
            }
            Err(none) => none == RecvTimeoutError::Timeout,
        }
    }

    /// Releases all keys, disconnects the board and saves.
    fn end(self) {
        let Self {
            mut kernel,
            outside,
            mut journal,
            ..
        } = self;
        kernel.watch.end();
        kernel.release_all();
        kernel.leave_lesson();
        kernel.disconnect();
        journal.look(&kernel.emulator.simulation.cnc, kernel.link_state());
        if let Some(keeper) = outside.keeper {
            kernel.emulator.store_edited();
            keeper.finish(&kernel.emulator);
        }
        if outside.ending.is_asked() {
            (outside.wake)();
            wait_for_window(&kernel);
        }
    }
}

/// Runs the ticks that are due until time is up or the speed in force changes; returns the
/// number of ticks. Keys take effect every few ticks.
fn run(kernel: &mut Kernel, due: u64, speed: Speed, until: Instant) -> u64 {
    let mut ran = 0;
    loop {
        let ticks = (due - ran).min(TICKS_A_LOOK);
        kernel.run(ticks);
        ran += ticks;
        if ran >= due || kernel.speed() != speed || Instant::now() >= until {
            return ran;
        }
    }
}

/// Waits until the window closes after the board has stopped and all is saved; ends the
/// program without the window if it does not.
fn wait_for_window(kernel: &Kernel) {
    let last = Instant::now() + WINDOW_CLOSES;
    while let Ok(command) = platform::receive(&kernel.commands, Some(last)) {
        if matches!(command, Command::Quit) {
            return;
        }
    }
    log::finish();
    std::process::exit(ENDED.into());
}

/// Reports to the operator what happened to files that the control has sent.
fn tell_of_transfer(console: &Console, written: Result<String, Message>) {
    match written {
        // A window that is gone needs no message.
        Ok(what) => drop(console.say.try_send(Notice::Sent(what))),
        Err(said) => {
            error!("{said}");
            let _ = console.say.try_send(Notice::Said(said));
            console.send(Command::TransferFailed);
        }
    }
}

/// Rounds to two digits, so that snapshots do not change needlessly.
fn times(ratio: f64) -> Times {
    let step = match ratio {
        ..1.0 => 0.05,
        ..10.0 => 0.5,
        ..100.0 => 5.0,
        _ => 50.0,
    };
    Times((ratio / step).round() * step)
}

/// Rounds down to steps of 5 % below 95 %, so that snapshots do not change needlessly.
fn speed_percent(ratio: f64) -> u32 {
    if ratio > 0.95 {
        100
    } else {
        ((ratio * 20.0).floor() * 5.0) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::setup::Setup;
    use gsk_panel::emulator::Emulator;
    use gsk_panel::keys::Key;

    fn running() -> (Running, Console) {
        let (kernel, console) = Kernel::new(Emulator::new(Setup::default()));
        let outside = Outside {
            wake: Box::new(|| {}),
            keeper: None,
            partner: None,
            ending: Ending::default(),
        };
        (Running::new(kernel, outside, console.clone()), console)
    }

    #[test]
    fn held_keys_are_let_go_after_a_silence_whatever_waits_to_be_heard() {
        let (mut running, console) = running();
        let held = || Command::Key {
            key: Key::XUp,
            down: true,
        };
        for _ in 0..2 {
            // A key pressed after the silence is held.
            console.send(held());
            assert!(running.turn());
            // The silence counts from the turn that received the key: the computer may
            // sleep before the next one.
            assert_eq!(running.heard.1, running.kernel.heard);
            assert!(running.turn());
            assert!(running.kernel.keys.any_down());
            // The computer slept: commands from before the sleep are no sign of life.
            running.heard.0 = platform::time_with_sleep().saturating_sub(Duration::from_secs(2));
            console.send(Command::Alive);
            assert!(running.turn());
            assert!(!running.kernel.keys.any_down());
        }
    }

    #[test]
    fn a_sleep_is_said_and_a_short_delay_is_not() {
        let (mut running, console) = running();
        let woken = Instant::now();
        for (away, said) in [(1, None), (7, Some(7))] {
            running.looked = woken;
            running.say_after_sleep(woken + Duration::from_secs(away));
            let heard = console.notices.try_iter().collect::<Vec<_>>();
            let expected = said.map(|seconds| Notice::Said(say::window_stood_still(seconds)));
            assert_eq!(heard, Vec::from_iter(expected));
        }
    }
}
