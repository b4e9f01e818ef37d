//! The kernel in its thread: ticks against the clock, asleep in between.

use std::path::PathBuf;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crossbeam::channel::{RecvTimeoutError, TryRecvError};
use gsk_messages::{Message, say};
use tracing::error;

use super::journal::Journal;
use super::{Command, Console, Kernel, Notice, PICTURE_TICKS, Times};
use crate::ending::{ENDED, Ending};
use crate::pace::{Pace, Speed};
use crate::retained::Keeper;
use crate::{log, transfer};

/// Held keys are let go when the window has said nothing for so long: no motion
/// depends on a release that may never come.
const LEASE: Duration = Duration::from_millis(600);
/// How often the memory is looked at for something to be saved.
const KEEP: Duration = Duration::from_millis(100);
/// So long the window may take to close when the program is to end.
const WINDOW_CLOSES: Duration = Duration::from_secs(3);

/// Between two pictures: as long as the control needs for them at the speed of a real
/// lathe.
const PICTURE: Duration = Duration::from_millis(PICTURE_TICKS);
/// Ticks between two looks at keys and clock.
const TICKS_A_LOOK: u64 = 40;
/// So long ticks run at once, at most.
const AT_ONCE: Duration = Duration::from_millis(10);

/// What the kernel thread needs from outside.
pub struct Outside {
    /// Called when there is a new picture or a notice; must not wait for the window.
    pub wake: Box<dyn Fn() + Send>,
    /// Saves the memory, if there is a data directory.
    pub keeper: Option<Keeper>,
    /// The folder that takes what the control sends, if there is one.
    pub partner: Option<PathBuf>,
    /// Whether the program is to end.
    pub ending: Ending,
}

/// The running thread.
#[derive(Debug)]
pub struct KernelThread {
    console: Console,
    thread: Option<JoinHandle<()>>,
}

impl KernelThread {
    /// Whether it still runs.
    pub fn is_alive(&self) -> bool {
        self.thread
            .as_ref()
            .is_some_and(|thread| !thread.is_finished())
    }

    /// Stops it; everything is saved then.
    pub fn stop(&mut self) {
        let Some(thread) = self.thread.take() else {
            return;
        };
        // The queue may be full: the kernel empties it.
        let _ = self.console.commands.send(Command::Quit);
        if thread.join().is_err() {
            complain!("gsk980td: {}", say::kernel_thread_failed());
        }
    }
}

impl Drop for KernelThread {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Starts the kernel in a thread of its own.
pub fn start(kernel: Kernel, console: &Console, outside: Outside) -> std::io::Result<KernelThread> {
    let own = console.clone();
    let thread = thread::Builder::new()
        .name("kernel".to_owned())
        .spawn(move || turn(kernel, outside, &own))?;
    Ok(KernelThread {
        console: console.clone(),
        thread: Some(thread),
    })
}

fn turn(mut kernel: Kernel, mut outside: Outside, console: &Console) {
    let start = Instant::now();
    let mut pace = Pace::new(start);
    let mut picture_at = start;
    let mut heard = start;
    let mut kept = start;
    let mut journal = Journal::default();
    kernel.show();
    (outside.wake)();
    while !kernel.quit && !outside.ending.is_asked() {
        let now = Instant::now();
        if kernel.keys.any_down() && now.duration_since(heard) > LEASE {
            kernel.release_all();
        }
        if !kernel.is_linked() {
            journal.turn(now, pace.next());
        }
        pace.set_speed(kernel.speed(), now);
        let due = pace.due(now);
        if kernel.is_linked() {
            // The board's clock counts; the machine is as fast as it has to be.
            kernel.speed_percent = 100;
            kernel.times = None;
            if kernel.run_linked() {
                (outside.wake)();
            }
        } else {
            let ran = run(&mut kernel, due, pace.speed(), now + AT_ONCE);
            pace.give_back(due.saturating_sub(ran));
        }
        journal.look(&kernel.emulator.simulation.cnc, kernel.link_state());
        if !kernel.is_linked() && now >= picture_at {
            picture_at = now + PICTURE;
            let real = pace.speed() == Speed::REAL;
            kernel.speed_percent = if real {
                speed_percent(pace.ratio())
            } else {
                100
            };
            kernel.times = (!real).then(|| times(pace.ratio()));
            if kernel.show() {
                (outside.wake)();
            }
        }
        if let Some(folder) = &outside.partner {
            let files = kernel.emulator.panel.take_sent();
            if !files.is_empty() {
                let console = console.clone();
                transfer::write_aside(folder.clone(), files, move |written| {
                    tell_of_transfer(&console, written);
                });
            }
        }
        if let Some(keeper) = &mut outside.keeper
            && now.duration_since(kept) > KEEP
        {
            kept = now;
            keeper.look(&kernel.emulator);
            for complaint in keeper.complaints() {
                error!("not saved: {complaint}");
                kernel.say(Notice::Said(complaint));
                (outside.wake)();
            }
        }
        let told = match kernel.wakes_at(now, &pace) {
            Some(until) => {
                let told = kernel.commands.recv_deadline(until);
                told.map_err(|none| none == RecvTimeoutError::Disconnected)
            }
            // Whoever waits yields the processor first, even when there is no time to
            // wait: on a busy computer it is back tens of milliseconds later, and the
            // board has heard nothing meanwhile.
            None => {
                let told = kernel.commands.try_recv();
                told.map_err(|none| none == TryRecvError::Disconnected)
            }
        };
        match told {
            Ok(command) => {
                heard = Instant::now();
                kernel.carry_out(command);
            }
            Err(over) if over => break,
            Err(_) => {}
        }
    }
    kernel.release_all();
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

/// Runs what is due as long as there is time and the speed stays in force; returns how
/// many ticks that were. Keys are seen every few ticks.
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

/// The board stands and all is saved: the window closes now, or the program ends
/// without it.
fn wait_for_window(kernel: &Kernel) {
    let last = Instant::now() + WINDOW_CLOSES;
    while let Ok(command) = kernel.commands.recv_deadline(last) {
        if matches!(command, Command::Quit) {
            return;
        }
    }
    log::finish();
    std::process::exit(ENDED.into());
}

/// The operator is told what has become of files that the control has sent.
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

/// With two digits, so that the picture does not change for nothing.
fn times(ratio: f64) -> Times {
    let step = match ratio {
        ..1.0 => 0.05,
        ..10.0 => 0.5,
        ..100.0 => 5.0,
        _ => 50.0,
    };
    Times((ratio / step).round() * step)
}

/// In steps of 5 % below 95 %, so that the picture does not change for nothing.
fn speed_percent(ratio: f64) -> u32 {
    if ratio > 0.95 {
        100
    } else {
        ((ratio * 20.0).floor() * 5.0) as u32
    }
}
