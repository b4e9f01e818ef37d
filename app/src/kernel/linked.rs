//! The kernel while a pulse board moves the slides: its clock counts.

use gsk_link::LinkState;
use web_time::{Duration, Instant};

use super::drive::Drive;
use super::{Connection, Kernel, LinkOrder, Notice, PICTURE_TICKS, Snapshot};
use crate::pace::Pace;

/// How often a link without a port is looked at.
const WITHOUT_PORT: Duration = Duration::from_millis(4);
/// So long the kernel makes ticks before it hears the board again: on a slow computer
/// a whole lookahead of them would take too long.
const AT_ONCE: Duration = Duration::from_millis(3);
/// Ticks between two pictures of a computer that is busy.
const HURRIED_PICTURE_TICKS: u64 = 4 * PICTURE_TICKS;

impl Kernel {
    /// A board moves the slides from now on. Its port may be missing: that is an
    /// alarm of the control.
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

    /// When the thread has something to do again; none: at once, a board is heard all
    /// the time.
    pub(super) fn wakes_at(&self, now: Instant, pace: &Pace) -> Option<Instant> {
        match &self.drive {
            None => Some(pace.next()),
            Some(drive) if drive.has_port() => None,
            Some(_) => Some(now + WITHOUT_PORT),
        }
    }

    /// Whether a board moves the slides.
    pub const fn is_linked(&self) -> bool {
        self.drive.is_some()
    }

    /// Where the link stands, if there is one.
    pub(super) fn link_state(&self) -> Option<LinkState> {
        self.drive.as_ref().map(Drive::state)
    }

    /// Takes what the window asked for, hears the board, runs as many ticks as it
    /// lets pass, and puts out pictures of what it has made. Waits 2 ms at most.
    /// Returns whether there is something to be seen.
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
        // The state is the board's of now, also while no motion is made.
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
