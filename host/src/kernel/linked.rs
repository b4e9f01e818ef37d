//! Runs the kernel while a pulse board moves the slides: the clock of the board determines the
//! ticks.

use gsk_link::LinkState;
use web_time::{Duration, Instant};

use super::drive::Drive;
use super::{BoardConnection, Kernel, LinkAction, Notice, PanelSnapshot, SNAPSHOT_TICKS};
use crate::kernel::pace::TickPacer;

/// Time between two ticks of the link while its port is closed.
const NO_PORT_INTERVAL: Duration = Duration::from_millis(4);
/// Longest time for which the kernel makes ticks before it reads the port again: on a slow
/// computer a whole lookahead of ticks would take too long.
const MAX_TICK_TIME: Duration = Duration::from_millis(3);
/// Ticks of 1 ms between two snapshots on a busy computer.
const BUSY_SNAPSHOT_TICKS: u64 = 4 * SNAPSHOT_TICKS;

impl Kernel {
    /// Connects a board, which then moves the slides; disconnects an earlier board. A missing port
    /// raises an alarm of the control.
    pub fn connect(&mut self, connection: BoardConnection) {
        self.disconnect();
        self.follow_with_recorders();
        let recorded_from = (!self.recorders.is_empty()).then(|| self.emulator.ticks());
        let simulation = self.emulator.board_simulation();
        let mut drive = Drive::open(connection, simulation, recorded_from);
        drive.request_view(self.link_watched);
        self.drive = Some(drive);
        self.has_real_slides = true;
        self.input_watch.set_linked(true);
    }

    pub(super) fn disconnect(&mut self) -> Option<BoardConnection> {
        let mut drive = self.drive.take()?;
        self.has_real_slides = false;
        self.input_watch.set_linked(false);
        self.exchange.extend(drive.take_exchange());
        let (connection, last_steps) = drive.close(self.emulator.board_simulation());
        self.exchange.extend(last_steps);
        self.follow_with_recorders();
        Some(connection)
    }

    /// Returns the time at which the kernel thread has work again; `None` if it has work at once,
    /// because a board needs constant reading.
    pub(super) fn wake_time(&self, now: Instant, pace: &TickPacer) -> Option<Instant> {
        match &self.drive {
            None => Some(pace.next_due()),
            Some(drive) if drive.has_port() => None,
            Some(_) => Some(now + NO_PORT_INTERVAL),
        }
    }

    pub const fn is_linked(&self) -> bool {
        self.drive.is_some()
    }

    /// Returns the state of the link; `None` if no board is connected.
    pub(super) fn link_state(&self) -> Option<LinkState> {
        self.drive.as_ref().map(Drive::state)
    }

    /// Executes the window's commands, reads the board, runs the ticks that it permits and
    /// publishes snapshots whose motion the board has made. Waits 2 ms at most. Returns true if
    /// there is something new to show.
    pub fn run_linked(&mut self) -> bool {
        self.execute_commands();
        let Some(mut drive) = self.drive.take() else {
            return false;
        };
        drive.read_board();
        // Drawing may be what keeps a busy computer from the port.
        let snapshot_ticks = match drive.is_busy() {
            true => BUSY_SNAPSHOT_TICKS,
            false => SNAPSHOT_TICKS,
        };
        let begun = Instant::now();
        while begun.elapsed() < MAX_TICK_TIME && drive.may_tick() {
            drive.before_tick(self.emulator.board_simulation());
            self.tick();
            drive.after_tick(self.emulator.board_simulation());
            if self.tick.is_multiple_of(snapshot_ticks) {
                drive.keep_snapshot(self.snapshot());
            }
        }
        let program = self.last_opened.as_ref().map(|opened| opened.name.as_str());
        drive.write_board(program);
        self.exchange.extend(drive.take_exchange());
        let mut shown = self.publish_machine();
        if let Some(view) = drive.due_view() {
            self.links.force_push(view);
            shown = true;
        }
        for message in drive.take_messages() {
            self.notify(Notice::Message(message));
            shown = true;
        }
        // The board's state is current, also while no motion is made.
        let board = Some(drive.state());
        let changed = self
            .last_snapshot
            .as_ref()
            .is_some_and(|last| last.board != board);
        let again = || self.last_snapshot.clone().filter(|_| changed);
        let snapshot = drive.take_due_snapshot().or_else(again);
        if let Some(snapshot) = snapshot.map(|picture| PanelSnapshot { board, ..picture })
            && self.last_snapshot.as_ref() != Some(&snapshot)
        {
            self.snapshots.force_push(snapshot.clone());
            self.last_snapshot = Some(snapshot);
            shown = true;
        }
        let reopen = drive.needs_reopen();
        self.drive = Some(drive);
        let last = self.last_snapshot.take();
        shown |= last.as_ref().is_some_and(|it| self.follow_class(it));
        self.last_snapshot = last;
        if reopen {
            self.execute_link_command(LinkAction::Reconnect);
        }
        shown
    }

    pub(super) fn execute_link_command(&mut self, order: LinkAction) {
        match (order, &mut self.drive) {
            (LinkAction::Reconnect, _) => {
                if let Some(connection) = self.disconnect() {
                    self.connect(connection);
                }
            }
            (LinkAction::WriteSettings, Some(drive)) => drive.write_settings(),
            (LinkAction::Check, Some(drive)) => drive.check(),
            (_, None) => {}
        }
    }
}
