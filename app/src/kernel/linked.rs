//! Runs the kernel while a pulse board moves the slides: the clock of the board counts.

use gsk_link::LinkState;
use web_time::{Duration, Instant};

use super::drive::Drive;
use super::{Connection, Kernel, LinkOrder, Notice, PICTURE_TICKS, Snapshot};
use crate::pace::Pace;

/// Time between two checks of a link without a port.
const WITHOUT_PORT: Duration = Duration::from_millis(4);
/// Longest time the kernel makes ticks before it reads the port again: on a slow computer
/// a whole lookahead of ticks would take too long.
const AT_ONCE: Duration = Duration::from_millis(3);
/// Ticks between two snapshots on a busy computer.
const HURRIED_PICTURE_TICKS: u64 = 4 * PICTURE_TICKS;

impl Kernel {
    /// Connects a board: it moves the slides from now on. A missing port raises an alarm
    /// of the control.
    pub fn connect(&mut self, connection: Connection) {
        self.disconnect();
        let mut drive = Drive::open(connection, &mut self.emulator.simulation);
        drive.watch(self.link_watched);
        self.drive = Some(drive);
        self.watch.set_linked(true);
    }

    pub(super) fn disconnect(&mut self) -> Option<Connection> {
        let drive = self.drive.take()?;
        self.watch.set_linked(false);
        Some(drive.close(&mut self.emulator.simulation))
    }

    /// Returns when the thread has work again; `None`: at once, because a board needs
    /// constant reading.
    pub(super) fn wakes_at(&self, now: Instant, pace: &Pace) -> Option<Instant> {
        match &self.drive {
            None => Some(pace.next()),
            Some(drive) if drive.has_port() => None,
            Some(_) => Some(now + WITHOUT_PORT),
        }
    }

    pub const fn is_linked(&self) -> bool {
        self.drive.is_some()
    }

    /// Returns the state of the link, if there is one.
    pub(super) fn link_state(&self) -> Option<LinkState> {
        self.drive.as_ref().map(Drive::state)
    }

    /// Takes the window's commands, reads the board, runs the ticks that it permits and
    /// publishes snapshots of what the board has made. Waits 2 ms at most. Returns whether
    /// there is something new to show.
    pub fn run_linked(&mut self) -> bool {
        self.take_commands();
        let Some(mut drive) = self.drive.take() else {
            return false;
        };
        drive.hear();
        // Drawing may be what keeps a busy computer from the port.
        let between = match drive.is_hurried() {
            true => HURRIED_PICTURE_TICKS,
            false => PICTURE_TICKS,
        };
        let begun = Instant::now();
        while begun.elapsed() < AT_ONCE && drive.may_tick() {
            drive.before(&mut self.emulator.simulation);
            self.tick();
            drive.after(&mut self.emulator.simulation);
            if self.tick.is_multiple_of(between) {
                drive.keep_picture(self.snapshot());
            }
        }
        let program = self.opened.as_ref().map(|opened| opened.name.as_str());
        drive.speak(program);
        let mut shown = self.show_machine();
        if let Some(view) = drive.due_view() {
            self.links.force_push(view);
            shown = true;
        }
        for said in drive.said() {
            self.say(Notice::Said(said));
            shown = true;
        }
        // The board's state is current, also while no motion is made.
        let board = Some(drive.state());
        let changed = self.last.as_ref().is_some_and(|last| last.board != board);
        let again = || self.last.clone().filter(|_| changed);
        let picture = drive.due_picture().or_else(again);
        if let Some(picture) = picture.map(|picture| Snapshot { board, ..picture })
            && self.last.as_ref() != Some(&picture)
        {
            self.pictures.force_push(picture.clone());
            self.last = Some(picture);
            shown = true;
        }
        let reopen = drive.is_to_be_reopened();
        self.drive = Some(drive);
        if reopen {
            self.order(LinkOrder::Reconnect);
        }
        shown
    }

    pub(super) fn order(&mut self, order: LinkOrder) {
        match (order, &mut self.drive) {
            (LinkOrder::Reconnect, _) => {
                if let Some(connection) = self.disconnect() {
                    self.connect(connection);
                }
            }
            (LinkOrder::WriteSettings, Some(drive)) => drive.write_settings(),
            (LinkOrder::Check, Some(drive)) => drive.check(),
            (_, None) => {}
        }
    }
}
