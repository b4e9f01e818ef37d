//! Runs the kernel in its thread: ticks by the clock, sleeps in between.

use std::path::PathBuf;

use crossbeam::channel::{RecvTimeoutError, TryRecvError};
use gsk_messages::{Message, say};
use tracing::error;
use web_time::{Duration, Instant};

use super::journal::ChangeLog;
use super::{Command, Console, Kernel, Notice, SNAPSHOT_TICKS, SpeedRatio};
use gsk_panel::pages::PageId;

use crate::kernel::pace::{RunSpeed, TickPacer};
use crate::platform::{self, TaskHandle};
use crate::retained::Keeper;
use crate::termination::{TERMINATED_EXIT_CODE, TerminationFlag};
use crate::transfer::udisk;
use crate::{log, output, transfer};

/// Time between two checks whether the memory of the control needs to be saved.
const KEEPER_INTERVAL: Duration = Duration::from_millis(100);
/// Interval between two hand-overs of the recordings to the disk.
const RECORDING_INTERVAL: Duration = Duration::from_secs(1);
/// Time that the window has to close when the program ends.
const WINDOW_CLOSE_TIMEOUT: Duration = Duration::from_secs(3);

/// Time between two snapshots: the duration of [`SNAPSHOT_TICKS`] on a real lathe.
const SNAPSHOT_INTERVAL: Duration = Duration::from_millis(SNAPSHOT_TICKS);
/// Least time without processor time after which the process or the computer counts as having
/// slept.
const MIN_SLEEP: Duration = Duration::from_secs(2);
/// Number of ticks that the thread makes between two checks of keys and clock.
const TICKS_PER_CHECK: u64 = 40;
/// Longest time for which the thread makes ticks without other work.
const MAX_TICK_TIME: Duration = Duration::from_millis(10);

/// The parts of the rest of the program that the kernel thread uses.
pub struct KernelEnvironment {
    /// Wakes the window for a new snapshot or notice; it must not wait for the window.
    pub wake: Box<dyn Fn() + Send>,
    /// Saves the memory of the control; `None` if there is no data directory.
    pub keeper: Option<Keeper>,
    /// The folder for files that the control sends; `None` to store none.
    pub partner_folder: Option<PathBuf>,
    /// The folder that is the control's U disk; `None` without a U disk.
    pub udisk_folder: Option<PathBuf>,
    /// Set by a termination signal to end the program.
    pub termination: TerminationFlag,
}

/// Handle of the running kernel thread; dropping it stops the thread.
#[derive(Debug)]
pub struct KernelThread {
    console: Console,
    task: Option<TaskHandle>,
}

impl KernelThread {
    pub fn is_alive(&self) -> bool {
        self.task.as_ref().is_some_and(TaskHandle::is_running)
    }

    /// Stops the thread and waits until it has saved everything.
    pub fn stop(&mut self) {
        let Some(task) = self.task.take() else {
            return;
        };
        // The queue may be full: the kernel empties it.
        let _ = self.console.commands.send(Command::Quit);
        if !task.finish() {
            output::report_error(&say::kernel_thread_failed());
        }
    }
}

impl Drop for KernelThread {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Starts the kernel thread. `outside` is its environment.
///
/// # Errors
/// The system starts no thread.
pub fn start(
    kernel: Kernel,
    console: &Console,
    outside: KernelEnvironment,
) -> std::io::Result<KernelThread> {
    let mut kernel_loop = Some(KernelLoop::new(kernel, outside, console.clone()));
    let task = platform::start_task("kernel", move || {
        let keep_running = kernel_loop.as_mut().is_some_and(KernelLoop::take_turn);
        if !keep_running && let Some(kernel_loop) = kernel_loop.take() {
            kernel_loop.end();
        }
        keep_running
    })?;
    Ok(KernelThread {
        console: console.clone(),
        task: Some(task),
    })
}

/// The kernel with its clock and the state of the kernel thread.
struct KernelLoop {
    kernel: Kernel,
    outside: KernelEnvironment,
    console: Console,
    pace: TickPacer,
    journal: ChangeLog,
    /// Time at which the next snapshot is due.
    next_snapshot: Instant,
    /// A time just before the window's last command, on the clock that includes sleep, and the
    /// number of commands up to it.
    last_command: (Duration, u64),
    /// Time, on the clock that includes sleep, at which a key was first down; `None` while no key
    /// is down.
    held_since: Option<Duration>,
    /// Time at which the loop last checked the clock.
    last_check: Instant,
    /// Time at which the keeper last checked the memory for changes.
    last_keeper_check: Instant,
    /// Time at which the recordings are handed over to the disk next.
    next_flush: Instant,
    /// Whether the LCD showed the page of the U disk in the last turn.
    is_udisk_shown: bool,
}

impl KernelLoop {
    fn new(mut kernel: Kernel, outside: KernelEnvironment, console: Console) -> Self {
        let now = Instant::now();
        kernel.publish();
        (outside.wake)();
        Self {
            kernel,
            outside,
            console,
            pace: TickPacer::new(now),
            journal: ChangeLog::default(),
            next_snapshot: now,
            last_command: (platform::time_with_sleep(), 0),
            held_since: None,
            last_check: now,
            last_keeper_check: now,
            next_flush: now,
            is_udisk_shown: false,
        }
    }

    /// Runs the ticks that are due, then waits for the next ones or for a command; returns
    /// `false` when the program ends.
    fn take_turn(&mut self) -> bool {
        if self.kernel.quit_requested || self.outside.termination.is_requested() {
            return false;
        }
        let now = Instant::now();
        // The computer may sleep at any moment.
        let awake = platform::time_with_sleep();
        self.release_unproven_keys(awake);
        self.report_sleep(now);
        self.run_due_ticks(now);
        self.publish_snapshot(now);
        self.pass_sent_files();
        self.follow_udisk();
        self.save_changes(now);
        if now >= self.next_flush {
            self.next_flush = now + RECORDING_INTERVAL;
            self.kernel.flush_recorders();
        }
        let keep_running = self.wait_for_command(now);
        // The computer may have slept since: a command counts from the moment before it
        // was received.
        if self.kernel.command_count > self.last_command.1 {
            self.last_command = (awake, self.kernel.command_count);
        }
        keep_running
    }

    /// Releases held keys if the window has been silent for too long, or if there is no proof
    /// that they are still held: no motion may depend on a release that never comes.
    fn release_unproven_keys(&mut self, now: Duration) {
        let kernel = &mut self.kernel;
        if !kernel.key_edges.has_key_down() {
            self.held_since = None;
            if kernel.is_linked() && kernel.input_watch.is_silent(now) {
                kernel.drop_wheel();
            }
            return;
        }
        let pressed = *self.held_since.get_or_insert(now);
        let silent = kernel
            .input_watch
            .has_window_lapsed(self.last_command.0, now);
        if silent || kernel.input_watch.has_lapsed(pressed, now) {
            self.held_since = None;
            kernel.release_keys_and_wheel();
            kernel.notify(Notice::Message(say::keys_let_go()));
            (self.outside.wake)();
        }
    }

    /// Notifies the operator that the machine was stopped while the computer slept or the page
    /// was frozen.
    fn report_sleep(&mut self, now: Instant) {
        let away = now.duration_since(self.last_check);
        self.last_check = now;
        if away > MIN_SLEEP && !self.kernel.is_linked() {
            let message = say::window_stood_still(away.as_secs());
            self.kernel.notify(Notice::Message(message));
            (self.outside.wake)();
        }
    }

    fn run_due_ticks(&mut self, now: Instant) {
        let Self { kernel, pace, .. } = self;
        if !kernel.is_linked() {
            self.journal.log_delay(now, pace.next_due());
        }
        pace.set_speed(kernel.speed(), now);
        let due = pace.take_due(now);
        if kernel.is_linked() {
            // The clock of the board counts; the machine runs as fast as it must.
            kernel.speed_percent = 100;
            kernel.speed_ratio = None;
            if kernel.run_linked() {
                (self.outside.wake)();
            }
        } else {
            let ran = run_ticks(kernel, due, pace.speed(), now + MAX_TICK_TIME);
            pace.give_back(due.saturating_sub(ran));
        }
        let link = kernel.link_state();
        self.journal.log_changes(kernel.emulator.cnc(), link);
    }

    /// Publishes a snapshot when one is due; with a board, snapshots are published with its
    /// ticks.
    fn publish_snapshot(&mut self, now: Instant) {
        let Self { kernel, pace, .. } = self;
        if kernel.is_linked() || now < self.next_snapshot {
            return;
        }
        self.next_snapshot = now + SNAPSHOT_INTERVAL;
        let real = pace.speed() == RunSpeed::REAL;
        kernel.speed_percent = if real {
            speed_percent(pace.ratio())
        } else {
            100
        };
        kernel.speed_ratio = (!real).then(|| round_ratio(pace.ratio()));
        if kernel.publish() {
            (self.outside.wake)();
        }
    }

    /// Writes the files that the control has sent into the partner folder, in the background.
    fn pass_sent_files(&mut self) {
        let Some(folder) = &self.outside.partner_folder else {
            return;
        };
        let files = self.kernel.emulator.take_sent();
        if !files.is_empty() {
            let console = self.console.clone();
            transfer::write_in_background(folder.clone(), files, move |written| {
                report_transfer(&console, written);
            });
        }
    }

    /// Reads the folder of the U disk when its page opens, and writes the files that the control
    /// has stored there, both in the background.
    fn follow_udisk(&mut self) {
        let Some(folder) = &self.outside.udisk_folder else {
            return;
        };
        let is_shown = self.kernel.emulator.panel().page() == PageId::Udisk;
        if is_shown && !self.is_udisk_shown {
            let (folder, console) = (folder.clone(), self.console.clone());
            let reading = platform::run_in_background("udisk", move || {
                let files = udisk::read_folder(&folder).unwrap_or_default();
                console.send(Command::PlugUdisk(files));
            });
            if let Err(error) = reading {
                error!("U disk: {error}");
            }
        }
        self.is_udisk_shown = is_shown;
        let files = udisk::to_serial_files(self.kernel.emulator.take_udisk_files());
        if !files.is_empty() {
            let console = self.console.clone();
            transfer::write_in_background(folder.clone(), files, move |written| {
                report_transfer(&console, written);
            });
        }
    }

    /// Saves changes of the memory, at most once per `KEEPER_INTERVAL`.
    fn save_changes(&mut self, now: Instant) {
        if let Some(keeper) = &mut self.outside.keeper
            && now.duration_since(self.last_keeper_check) > KEEPER_INTERVAL
        {
            self.last_keeper_check = now;
            keeper.save_if_changed(self.kernel.own_machine());
            for complaint in keeper.complaints() {
                error!("not saved: {complaint}");
                self.kernel.notify(Notice::Message(complaint));
                (self.outside.wake)();
            }
        }
    }

    /// Waits for a command, or until the next ticks are due; returns `false` once every sender
    /// of commands is gone.
    fn wait_for_command(&mut self, now: Instant) -> bool {
        let kernel = &mut self.kernel;
        let received = match kernel.wake_time(now, &self.pace) {
            Some(until) => platform::receive(&kernel.commands, Some(until)),
            // A wait yields the processor, even with no time to wait: on a busy computer
            // the thread continues tens of milliseconds later, and the board gets no bytes
            // meanwhile.
            None => kernel.commands.try_recv().map_err(|error| match error {
                TryRecvError::Empty => RecvTimeoutError::Timeout,
                TryRecvError::Disconnected => RecvTimeoutError::Disconnected,
            }),
        };
        match received {
            Ok(command) => {
                kernel.execute_command(command);
                true
            }
            Err(none) => none == RecvTimeoutError::Timeout,
        }
    }

    /// Releases all keys, disconnects the board and saves the memory.
    fn end(self) {
        let Self {
            mut kernel,
            outside,
            mut journal,
            ..
        } = self;
        kernel.input_watch.end();
        kernel.release_all_keys();
        kernel.leave_lesson();
        kernel.disconnect();
        journal.log_changes(kernel.emulator.cnc(), kernel.link_state());
        if let Some(keeper) = outside.keeper {
            kernel.emulator.store_edited();
            keeper.finish(&kernel.emulator);
        }
        kernel.finish_recorders(!outside.termination.has_crashed());
        if outside.termination.is_requested() {
            (outside.wake)();
            wait_for_window(&kernel);
        }
    }
}

/// Runs the number `due` of ticks, but not beyond the time `until` and only while the current speed
/// is `speed`. Returns the number of ticks run. Keys are checked every `TICKS_PER_CHECK` ticks.
fn run_ticks(kernel: &mut Kernel, due: u64, speed: RunSpeed, until: Instant) -> u64 {
    let mut ran = 0;
    loop {
        let ticks = (due - ran).min(TICKS_PER_CHECK);
        kernel.run(ticks);
        ran += ticks;
        if ran >= due || kernel.speed() != speed || Instant::now() >= until {
            return ran;
        }
    }
}

/// Waits at most `WINDOW_CLOSE_TIMEOUT` until the window closes, after the board has stopped
/// and all is saved. If the window stays open, ends the process.
fn wait_for_window(kernel: &Kernel) {
    let last = Instant::now() + WINDOW_CLOSE_TIMEOUT;
    while let Ok(command) = platform::receive(&kernel.commands, Some(last)) {
        if matches!(command, Command::Quit) {
            return;
        }
    }
    log::finish();
    std::process::exit(TERMINATED_EXIT_CODE.into());
}

/// Notifies the window where the files that the control has sent were written, or why not.
fn report_transfer(console: &Console, written: Result<String, Message>) {
    match written {
        // A window that is gone needs no message.
        Ok(what) => drop(console.notice_sender.try_send(Notice::Sent(what))),
        Err(message) => {
            error!("{message}");
            let _ = console.notice_sender.try_send(Notice::Message(message));
            console.send(Command::TransferFailed);
        }
    }
}

/// Rounds the ratio of machine time to wall time to steps of a twentieth of the next higher power
/// of ten, so that snapshots do not change needlessly.
fn round_ratio(ratio: f64) -> SpeedRatio {
    let step = match ratio {
        ..1.0 => 0.05,
        ..10.0 => 0.5,
        ..100.0 => 5.0,
        _ => 50.0,
    };
    SpeedRatio((ratio / step).round() * step)
}

/// Converts the ratio of machine time to wall time to percent, rounded down to steps of 5 % so that
/// snapshots do not change needlessly; 100 above a ratio of 0.95.
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

    fn new_loop() -> (KernelLoop, Console) {
        let (kernel, console) = Kernel::new(Emulator::new(Setup::default()));
        let outside = KernelEnvironment {
            wake: Box::new(|| {}),
            keeper: None,
            partner_folder: None,
            udisk_folder: None,
            termination: TerminationFlag::default(),
        };
        (KernelLoop::new(kernel, outside, console.clone()), console)
    }

    #[test]
    fn held_keys_are_released_after_a_silence_despite_waiting_commands() {
        let (mut kernel_loop, console) = new_loop();
        let held = || Command::Key {
            key: Key::XUp,
            down: true,
        };
        for _ in 0..2 {
            // A key pressed after the silence is held.
            console.send(held());
            assert!(kernel_loop.take_turn());
            // The silence counts from the turn that received the key: the computer may
            // sleep before the next one.
            assert_eq!(kernel_loop.last_command.1, kernel_loop.kernel.command_count);
            assert!(kernel_loop.take_turn());
            assert!(kernel_loop.kernel.key_edges.has_key_down());
            // The computer slept: commands from before the sleep are no sign of life.
            kernel_loop.last_command.0 =
                platform::time_with_sleep().saturating_sub(Duration::from_secs(2));
            console.send(Command::Alive);
            assert!(kernel_loop.take_turn());
            assert!(!kernel_loop.kernel.key_edges.has_key_down());
        }
    }

    #[test]
    fn a_sleep_is_reported_and_a_short_delay_is_not() {
        let (mut kernel_loop, console) = new_loop();
        let woken = Instant::now();
        for (away, reported_s) in [(1, None), (7, Some(7))] {
            kernel_loop.last_check = woken;
            kernel_loop.report_sleep(woken + Duration::from_secs(away));
            let received = console.notices.try_iter().collect::<Vec<_>>();
            let expected =
                reported_s.map(|seconds| Notice::Message(say::window_stood_still(seconds)));
            assert_eq!(received, Vec::from_iter(expected));
        }
    }
}
