//! Drives a pulse board for the kernel: its port, the control whose slides it moves, and
//! the snapshots that wait until the slides have reached their positions.

use std::collections::VecDeque;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crossbeam::channel::Receiver;
use gsk_core::command::ProgramId;
use gsk_core::linked::{LinkNote, LinkedControl, MotionStamp};
use gsk_core::simulation::Simulation;
use gsk_history::board_exchange::{BoardStep, ExchangeLog, ExchangedBytes, StampedStep};
use gsk_link::{LinkConfig, LinkState, SettingDifference};
use gsk_messages::{Message, say};
use web_time::Duration;

use super::PanelSnapshot;
use super::link_view::{LinkView, PositionCheck};
use crate::board::host_clock::HostClock;
use crate::board::port_io::{PortIo, TrafficLine};
use crate::files::{atomic, time::format_utc};
use crate::guard::Orphan;
use crate::ports;

/// Greatest number of lines of traffic that are stored for the link page.
const MAX_TRAFFIC_LINES: usize = 200;
/// Number of round trips from which median and maximum are computed.
const MAX_ROUND_TRIPS: usize = 100;
/// Time between two updates of the link page.
const VIEW_INTERVAL: Duration = Duration::from_millis(100);
/// Time without a read of the port from which on the computer counts as busy.
const BUSY_ABSENCE: Duration = Duration::from_millis(20);
/// Interval over which the longest time between two reads of the port is determined; the recent one
/// covers the current and the previous interval.
const ABSENCE_INTERVAL: Duration = Duration::from_secs(5);
/// Greatest number of position checks that are stored for the link page.
const MAX_LOG_LINES: usize = 20;

/// Extension of the files with the dictionaries of boards. The constants after it limit their
/// number, size and name.
const DICTIONARY_EXTENSION: &str = "dictionary";
const MAX_BOARDS: usize = 16;
const MAX_FILE_BYTES: u64 = 1 << 17;
const MAX_NAME_CHARS: usize = 80;

/// Configuration of a board, and the paths of the files about it.
#[derive(Clone, Debug)]
pub struct BoardConnection {
    /// The section `link` of the machine file: port and wiring of the board.
    pub config: LinkConfig,
    /// Path of the log file of position checks; `None` for no log.
    pub log_path: Option<PathBuf>,
    /// Folder in which the dictionaries of boards are stored, so that a known board connects
    /// faster; `None` to store none.
    pub dictionary_folder: Option<PathBuf>,
    /// The executable file of the guard process, which holds the port; usually
    /// [`crate::platform::own_executable`].
    pub holder_program: PathBuf,
}

/// Measures the times between two reads of the port, which are long on a busy computer.
#[derive(Clone, Copy, Debug, Default)]
struct PortAbsence {
    last_read: Duration,
    /// The longest time between two reads in the current interval, then that in the previous one.
    recent: [Duration; 2],
    interval_end: Duration,
    longest: Duration,
}

impl PortAbsence {
    /// Records that the port was read at the host time `now`.
    fn record_read(&mut self, now: Duration) {
        let away = now.saturating_sub(self.last_read);
        self.last_read = now;
        if now >= self.interval_end {
            self.interval_end = now + ABSENCE_INTERVAL;
            self.recent = [Duration::ZERO, self.recent[0]];
        }
        self.recent[0] = self.recent[0].max(away);
        self.longest = self.longest.max(away);
    }

    /// Returns the longest time between two reads in the last two intervals, and the longest of
    /// all.
    fn longest(&self) -> (Duration, Duration) {
        (self.recent[0].max(self.recent[1]), self.longest)
    }
}

/// The connection to a board that moves the control's slides.
pub(super) struct Drive {
    connection: BoardConnection,
    linked: LinkedControl,
    /// `None` if the port could not be opened or has failed.
    port_io: Option<PortIo>,
    clock: HostClock,
    /// Receives the answers of the board while a second holder stops it, after the first
    /// holder is gone; `None` otherwise.
    stop_answer: Option<Receiver<Vec<u8>>>,
    view_requested: bool,
    /// Host time at which the next view of the link page is due.
    next_view: Duration,
    snapshots: VecDeque<(MotionStamp, PanelSnapshot)>,
    traffic_lines: VecDeque<TrafficLine>,
    round_trips: VecDeque<Duration>,
    absence: PortAbsence,
    report_count: u64,
    differences: Vec<SettingDifference>,
    position_checks: VecDeque<PositionCheck>,
    /// Messages for the operator that the kernel has not taken yet.
    messages: Vec<Message>,
    /// What the flight recorders need of the exchange.
    exchange: ExchangeLog,
}

impl core::fmt::Debug for Drive {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Drive")
            .field("connection", &self.connection)
            .field("state", &self.linked.state())
            .finish_non_exhaustive()
    }
}

impl Drive {
    /// Opens the port of the board. If that fails, the control raises an alarm. `recorded_from`:
    /// the exchange is recorded from this tick of the machine on; `None`: it is not.
    pub fn open(
        connection: BoardConnection,
        simulation: &mut Simulation,
        recorded_from: Option<u64>,
    ) -> Self {
        tracing::info!(port = connection.config.port, "port of the board");
        let mut linked = LinkedControl::open(connection.config.clone(), simulation, Duration::ZERO);
        let folder = connection.dictionary_folder.as_deref();
        let dictionaries = folder.map_or_else(Vec::new, read_dictionaries);
        let mut exchange = match recorded_from {
            Some(tick) => ExchangeLog::open(tick, connection.config.clone(), dictionaries.clone()),
            None => ExchangeLog::default(),
        };
        linked.add_dictionaries(dictionaries);
        let port_io = match PortIo::open(&connection.config, &connection.holder_program) {
            Ok(mut carrier) => {
                // The link page shows after a fault what came before it.
                carrier.set_recording(true);
                Some(carrier)
            }
            Err(cause) => {
                tracing::error!("{cause}");
                exchange.add(BoardStep::PortFailed(cause.message()));
                linked.handle_port_failure(cause.message());
                None
            }
        };
        Self {
            connection,
            linked,
            port_io,
            clock: HostClock::start(),
            stop_answer: None,
            view_requested: false,
            next_view: Duration::ZERO,
            snapshots: VecDeque::new(),
            traffic_lines: VecDeque::new(),
            round_trips: VecDeque::new(),
            absence: PortAbsence::default(),
            report_count: 0,
            differences: Vec::new(),
            position_checks: VecDeque::new(),
            messages: Vec::new(),
            exchange,
        }
    }

    /// Returns and removes the recorded steps of the exchange so far.
    pub fn take_exchange(&mut self) -> Vec<StampedStep> {
        self.exchange.take_steps()
    }

    /// Stops the board, closes its port and returns the slides to the simulation. Returns the
    /// connection, with which the board can be opened again, and the last recorded steps.
    pub fn close(mut self, simulation: &mut Simulation) -> (BoardConnection, Vec<StampedStep>) {
        self.exchange.add(BoardStep::Closed);
        let steps = self.take_exchange();
        self.linked.check_count_before_close();
        for note in self.linked.take_notes() {
            self.handle_note(&note, None);
        }
        let Self {
            connection,
            linked,
            port_io: mut carrier,
            ..
        } = self;
        let last = linked.close(simulation);
        if let Some(carrier) = &mut carrier {
            carrier.close(&last);
        }
        (connection, steps)
    }

    /// Reads the bytes that the board has sent and advances the time of its link; waits at most 2
    /// ms.
    pub fn read_board(&mut self) {
        let bytes = match self.port_io.as_mut().map(PortIo::read) {
            Some(Ok(bytes)) => bytes,
            Some(Err(error)) => {
                self.handle_port_loss(&error);
                Vec::new()
            }
            None => Vec::new(),
        };
        let answered = self.stop_answer.as_ref().map(Receiver::try_recv);
        if let Some(Ok(answered)) = answered {
            self.stop_answer = None;
            self.handle_guard_stop(&answered);
        }
        let now = self.clock.now();
        let jump = self.clock.take_wall_clock_jump();
        if !jump.is_zero() {
            let gap_ns = jump.as_nanos() as u64;
            self.exchange.add(BoardStep::HostGap(gap_ns));
            self.linked.handle_host_gap(jump);
        }
        if self.linked.is_opening() {
            // The first dictionary of a board is written to the disk here: this absence
            // does not count.
            self.absence = PortAbsence {
                last_read: now,
                ..PortAbsence::default()
            };
        }
        self.absence.record_read(now);
        self.exchange.add_read(now, &bytes);
        self.linked.pump(&bytes, now);
        if self.linked.state() == LinkState::Opening {
            // The board reports all differences again.
            self.differences.clear();
        }
        let traffic = self.linked.traffic();
        if traffic.reports != self.report_count {
            self.report_count = traffic.reports;
            push_limited(&mut self.round_trips, traffic.round_trip, MAX_ROUND_TRIPS);
        }
    }

    /// Closes the port after a read or write error or the end of the guard process, logs
    /// `error`, and reports the failure and any stop by the guard to the link.
    fn handle_port_loss(&mut self, error: &std::io::Error) {
        let orphan = self.port_io.take().and_then(|mut it| it.take_orphan());
        let cause = ports::failure_message(error);
        tracing::error!("{cause}");
        self.exchange.add(BoardStep::PortFailed(cause.clone()));
        self.linked.handle_port_failure(cause);
        match orphan {
            Some(Orphan::Stopped(answered)) => self.handle_guard_stop(&answered),
            Some(Orphan::BeingStopped(answered)) => self.stop_answer = Some(answered),
            None => {}
        }
    }

    fn handle_guard_stop(&mut self, answered: &[u8]) {
        let bytes = ExchangedBytes(answered.to_vec());
        self.exchange.add(BoardStep::GuardStopped(bytes));
        self.linked.handle_guard_stop(answered);
    }

    /// Whether the computer was too busy recently to read the port in time.
    pub fn is_busy(&self) -> bool {
        self.absence.longest().0 > BUSY_ABSENCE
    }

    pub fn state(&self) -> LinkState {
        self.linked.state()
    }

    /// Whether the slides may still be moving.
    pub fn has_pending_motion(&self) -> bool {
        self.linked.has_pending_motion()
    }

    pub fn may_tick(&mut self) -> bool {
        let is_permitted = self.linked.can_tick();
        self.exchange.add_tick_request(is_permitted);
        is_permitted
    }

    /// Passes the inputs that the board reads to the simulation before a tick.
    pub fn before_tick(&mut self, simulation: &mut Simulation) {
        self.linked.before_tick(simulation);
    }

    /// Passes the motion and outputs that a tick has commanded to the board's link.
    pub fn after_tick(&mut self, simulation: &mut Simulation) {
        self.linked.after_tick(simulation);
    }

    /// Writes the bytes that wait for the board, and the log of position checks. `program` is
    /// the name of the opened program for the log; `None` without one.
    pub fn write_board(&mut self, program: Option<&str>) {
        let written = match &mut self.port_io {
            Some(carrier) => {
                carrier.renew_lease(self.linked.needs_guard());
                carrier.set_stop_bytes(&self.linked.stop_bytes());
                carrier.write(self.linked.tx())
            }
            None => self.linked.tx().len(),
        };
        let taken = self.linked.tx().get(..written).unwrap_or_default();
        self.exchange.add_written(taken);
        self.linked.mark_written(written);
        for note in self.linked.take_notes() {
            self.handle_note(&note, program);
        }
        if let Some(carrier) = &mut self.port_io {
            let linked = &self.linked;
            let lines = carrier
                .take_traffic(|outward, collected| linked.next_traffic_text(outward, collected));
            push_limited(&mut self.traffic_lines, lines, MAX_TRAFFIC_LINES);
        }
    }

    fn handle_note(&mut self, note: &LinkNote, program: Option<&str>) {
        match note {
            LinkNote::DictionaryReceived {
                name,
                compressed: packed,
            } => self.keep_dictionary(name, packed),
            LinkNote::SettingDiffers(difference) => self.differences.push(difference.clone()),
            &LinkNote::CountChecked {
                program: ended,
                commanded,
                counted,
                agrees,
            } => {
                let name = match ended {
                    Some(ProgramId::Stored(number)) => format!("O{number:04}"),
                    Some(_) => file_name(program.unwrap_or("-")),
                    None => "-".to_owned(),
                };
                let [x, z] =
                    counted.map_or([None; 2], |counted| [Some(counted.x), Some(counted.z)]);
                let [x, z] = [x, z].map(|it| it.map_or("-".to_owned(), |it| it.0.to_string()));
                let result = match agrees {
                    true => say::counts_agree(),
                    false => say::counts_differ(),
                };
                let message = say::position_check(
                    format_utc(SystemTime::now()),
                    name,
                    commanded.x.0,
                    commanded.z.0,
                    x,
                    z,
                    result,
                );
                self.write_log(&message.to_string());
                push_limited(
                    &mut self.position_checks,
                    [PositionCheck { message, agrees }],
                    MAX_LOG_LINES,
                );
            }
        }
    }

    /// Writes the dictionary of a board to a file named `name`; does nothing without a folder.
    fn keep_dictionary(&self, name: &str, packed: &[u8]) {
        let Some(folder) = &self.connection.dictionary_folder else {
            return;
        };
        let plain = |letter: char| letter.is_ascii_alphanumeric() || "._-".contains(letter);
        let name: String = name
            .chars()
            .map(|letter| if plain(letter) { letter } else { '-' })
            .take(MAX_NAME_CHARS)
            .collect();
        let file = folder.join(format!("{name}.{DICTIONARY_EXTENSION}"));
        let _ = std::fs::create_dir_all(folder).and_then(|()| atomic::write(&file, packed));
    }

    fn write_log(&mut self, line: &str) {
        let Some(path) = &self.connection.log_path else {
            return;
        };
        let file = OpenOptions::new().create(true).append(true).open(path);
        if let Err(error) = file.and_then(|mut file| writeln!(file, "{line}")) {
            tracing::error!("{}: {error}", path.display());
            let message = say::subject_reason(path.display(), say::as_written(error));
            self.messages.push(message);
            // Reported once; position checks continue without their log.
            self.connection.log_path = None;
        }
    }

    /// Removes and returns the messages for the operator.
    pub fn take_messages(&mut self) -> Vec<Message> {
        core::mem::take(&mut self.messages)
    }

    /// Stores a snapshot until the slides have reached its positions.
    pub fn keep_snapshot(&mut self, snapshot: PanelSnapshot) {
        self.snapshots.push_back((self.linked.stamp(), snapshot));
    }

    /// Removes and returns the newest snapshot whose motion the board has made; `None` without one.
    pub fn take_due_snapshot(&mut self) -> Option<PanelSnapshot> {
        // After a stop, the board may never make the motion of waiting snapshots.
        self.snapshots
            .retain(|(stamp, _)| !self.linked.is_discarded(*stamp));
        let mut due = None;
        while let Some((stamp, _)) = self.snapshots.front()
            && self.linked.has_executed(*stamp)
        {
            due = self.snapshots.pop_front();
        }
        due.map(|(_, snapshot)| snapshot)
    }

    /// Writes to the board those settings that differ from the configuration.
    pub fn write_settings(&mut self) {
        self.differences.clear();
        self.exchange.add(BoardStep::SettingsWritten);
        self.linked.write_settings();
    }

    /// Queries the board's count at once and compares it with the commanded pulses.
    pub fn check(&mut self) {
        self.exchange.add(BoardStep::CountChecked);
        self.linked.check_count();
    }

    /// Sets whether [`Self::due_view`] creates views for the link page.
    pub const fn request_view(&mut self, on: bool) {
        self.view_requested = on;
    }

    /// Whether the port of the board is open; reading it then sets the pace of the kernel.
    pub const fn has_port(&self) -> bool {
        self.port_io.is_some()
    }

    /// Whether the operator has pressed RESET to open the port of the lost board again.
    pub const fn needs_reopen(&self) -> bool {
        self.linked.needs_reopening()
    }

    /// Returns a view for the link page; `None` unless the page is open and a view is due.
    pub fn due_view(&mut self) -> Option<LinkView> {
        let now = self.clock.now();
        if !self.view_requested || now < self.next_view {
            return None;
        }
        self.next_view = now + VIEW_INTERVAL;
        Some(self.make_view())
    }

    fn make_view(&self) -> LinkView {
        let mut trips: Vec<_> = self.round_trips.iter().copied().collect();
        trips.sort_unstable();
        let worst = trips.last().copied();
        let linked = &self.linked;
        let settled = linked.state() == LinkState::Configure;
        LinkView {
            state: linked.state(),
            is_connected: !linked.is_opening()
                && !matches!(linked.state(), LinkState::Off | LinkState::Lost),
            protocol: linked.config().protocol,
            port: linked.config().port.clone(),
            board: linked.board().clone(),
            position_known: linked.knows_position(),
            round_trip: worst.map(|worst| (trips[trips.len() / 2], worst)),
            absence: self.absence.longest(),
            outstanding: linked.outstanding(),
            lookahead: linked.config().lookahead(),
            traffic: linked.traffic(),
            inputs: linked.inputs(),
            missing_outputs: linked.missing_outputs(),
            outputs: linked.outputs(),
            spindle: linked.spindle(),
            encoder: linked.encoder(),
            commanded: linked.commanded(),
            counted: linked.counted(),
            differences: if settled {
                self.differences.clone()
            } else {
                Vec::new()
            },
            traffic_lines: self.traffic_lines.iter().cloned().collect(),
            position_checks: self.position_checks.iter().cloned().collect(),
        }
    }
}

/// Returns the last component of a path.
fn file_name(path: &str) -> String {
    let name = Path::new(path).file_name();
    name.map_or_else(
        || path.to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// Reads the dictionaries of known boards from `folder`; empty if it cannot be read. The caller
/// ignores damaged ones.
fn read_dictionaries(folder: &Path) -> Vec<Vec<u8>> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| {
            path.extension()
                .is_some_and(|end| end == DICTIONARY_EXTENSION)
        })
        .collect();
    files.sort();
    let short = |path: &PathBuf| {
        std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() <= MAX_FILE_BYTES)
    };
    files
        .iter()
        .filter(|path| short(path))
        .take(MAX_BOARDS)
        .filter_map(|path| std::fs::read(path).ok())
        .collect()
}

/// Appends the entries of `new` to a list and drops the oldest entries above `limit`.
fn push_limited<T>(list: &mut VecDeque<T>, new: impl IntoIterator<Item = T>, limit: usize) {
    list.extend(new);
    while list.len() > limit {
        list.pop_front();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn longest_absence_is_kept_and_the_recent_one_expires() {
        let ms = Duration::from_millis;
        let mut away = PortAbsence::default();
        for at in [2, 4, 94, 96] {
            away.record_read(ms(at));
        }
        assert_eq!(away.longest(), (ms(90), ms(90)));
        // Two intervals later it is not recent any more.
        for at in (96..12_000).step_by(2) {
            away.record_read(ms(at));
        }
        assert_eq!(away.longest(), (ms(2), ms(90)));
        away.record_read(ms(12_040));
        assert_eq!(away.longest().0, ms(42));
    }
}
