//! A pulse board in the kernel's hands: its port, the control it moves, and the
//! pictures that wait until the slides are where they show them.

use std::collections::VecDeque;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crossbeam::channel::Receiver;
use gsk_core::command::ProgramId;
use gsk_core::linked::{Linked, Note, Stamp};
use gsk_core::simulation::Simulation;
use gsk_link::{LinkConfig, LinkState, SettingDifference};
use gsk_messages::{Message, say};
use web_time::Duration;

use super::Snapshot;
use super::link_view::{LinkView, PositionCheck};
use crate::carrier::{Carrier, Line};
use crate::files::{atomic, time::utc};
use crate::guard::Orphan;
use crate::host_clock::HostClock;
use crate::ports;

/// Lines of the traffic that are kept for the link page.
const EXCHANGES: usize = 200;
/// Round trips that median and worst are of.
const TRIPS: usize = 100;
/// Between two looks of the link page.
const VIEW_INTERVAL: Duration = Duration::from_millis(100);
/// A computer that was away for so long is busy.
const BUSY: Duration = Duration::from_millis(20);
/// Two of them are "of late" for the time the port was not looked at.
const AWAY_INTERVAL: Duration = Duration::from_secs(5);
/// Lines of the log that are kept for the link page.
const LOG_LINES: usize = 20;

/// End of the names of the files with dictionaries of boards; how many are read, and
/// how long they and their names may be.
const DICTIONARY: &str = "dictionary";
const MOST_BOARDS: usize = 16;
const LONGEST_FILE: u64 = 1 << 17;
const LONGEST_NAME: usize = 80;

/// Which board, and where its log goes.
#[derive(Clone, Debug)]
pub struct Connection {
    /// The section `link` of the machine file.
    pub config: LinkConfig,
    /// The log of position checks, if there is a place for it.
    pub log: Option<PathBuf>,
    /// Folder for what boards say they understand.
    pub boards: Option<PathBuf>,
    /// The program of the process that holds the port: [`crate::platform::own_program`].
    pub program: PathBuf,
}

/// How long the board was not heard, because the computer did something else.
#[derive(Clone, Copy, Debug, Default)]
struct Away {
    heard: Duration,
    /// The longest of the interval that runs, and of the one before it.
    late: [Duration; 2],
    turns: Duration,
    longest: Duration,
}

impl Away {
    /// The board is heard.
    fn hear(&mut self, now: Duration) {
        let away = now.saturating_sub(self.heard);
        self.heard = now;
        if now >= self.turns {
            self.turns = now + AWAY_INTERVAL;
            self.late = [Duration::ZERO, self.late[0]];
        }
        self.late[0] = self.late[0].max(away);
        self.longest = self.longest.max(away);
    }

    /// The longest of late, and of all.
    fn longest(&self) -> (Duration, Duration) {
        (self.late[0].max(self.late[1]), self.longest)
    }
}

/// A board that drives the control's slides.
pub(super) struct Drive {
    connection: Connection,
    linked: Linked,
    /// None when the port could not be opened, or has failed.
    carrier: Option<Carrier>,
    clock: HostClock,
    /// What the board answers to the holder that stops it in place of the one that is gone.
    being_stopped: Option<Receiver<Vec<u8>>>,
    watched: bool,
    /// When the link page looks again.
    next_view: Duration,
    pictures: VecDeque<(Stamp, Snapshot)>,
    exchanges: VecDeque<Line>,
    trips: VecDeque<Duration>,
    away: Away,
    reports: u64,
    differences: Vec<SettingDifference>,
    log: VecDeque<PositionCheck>,
    /// For the operator.
    said: Vec<Message>,
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
    /// Opens the port; a port that cannot be opened is an alarm of the control.
    pub fn open(connection: Connection, simulation: &mut Simulation) -> Self {
        tracing::info!(port = connection.config.port, "port of the board");
        let mut linked = Linked::open(connection.config.clone(), simulation, Duration::ZERO);
        linked.know(
            connection
                .boards
                .as_deref()
                .map_or_else(Vec::new, met_before),
        );
        let carrier = match Carrier::open(&connection.config, &connection.program) {
            Ok(mut carrier) => {
                // Who opens the link page after a fault wants to see what came before it.
                carrier.watch(true);
                Some(carrier)
            }
            Err(cause) => {
                tracing::error!("{cause}");
                linked.lost(cause.message());
                None
            }
        };
        Self {
            connection,
            linked,
            carrier,
            clock: HostClock::start(),
            being_stopped: None,
            watched: false,
            next_view: Duration::ZERO,
            pictures: VecDeque::new(),
            exchanges: VecDeque::new(),
            trips: VecDeque::new(),
            away: Away::default(),
            reports: 0,
            differences: Vec::new(),
            log: VecDeque::new(),
            said: Vec::new(),
        }
    }

    /// Gives the slides back to the simulation; the board stops.
    pub fn close(mut self, simulation: &mut Simulation) -> Connection {
        self.linked.check_last();
        for note in self.linked.notes() {
            self.note(&note, None);
        }
        let Self {
            connection,
            linked,
            mut carrier,
            ..
        } = self;
        let last = linked.close(simulation);
        if let Some(carrier) = &mut carrier {
            carrier.end(&last);
        }
        connection
    }

    /// Hears the board and lets its time pass; waits at most 2 ms.
    pub fn hear(&mut self) {
        let bytes = match self.carrier.as_mut().map(Carrier::read) {
            Some(Ok(bytes)) => bytes,
            Some(Err(error)) => {
                self.lose(&error);
                Vec::new()
            }
            None => Vec::new(),
        };
        let answered = self.being_stopped.as_ref().map(Receiver::try_recv);
        if let Some(Ok(answered)) = answered {
            self.being_stopped = None;
            self.linked.stopped_by_holder(&answered);
        }
        let now = self.clock.now();
        let jump = self.clock.take_jump();
        if !jump.is_zero() {
            self.linked.judge_absence(jump);
        }
        if self.linked.is_opening() {
            // What a board says of itself for the first time is put on the disk.
            self.away = Away {
                heard: now,
                ..Away::default()
            };
        }
        self.away.hear(now);
        self.linked.pump(&bytes, now);
        if self.linked.state() == LinkState::Opening {
            // What was found different is found again.
            self.differences.clear();
        }
        let traffic = self.linked.traffic();
        if traffic.reports != self.reports {
            self.reports = traffic.reports;
            keep(&mut self.trips, traffic.round_trip, TRIPS);
        }
    }

    /// The port is gone, or its holder is.
    fn lose(&mut self, error: &std::io::Error) {
        let orphan = self.carrier.take().and_then(|mut it| it.take_orphan());
        let cause = ports::gone(error);
        tracing::error!("{cause}");
        self.linked.lost(cause);
        match orphan {
            Some(Orphan::Stopped(answered)) => self.linked.stopped_by_holder(&answered),
            Some(Orphan::BeingStopped(answered)) => self.being_stopped = Some(answered),
            None => {}
        }
    }

    /// Whether the computer has other things to do than to look at the port.
    pub fn is_hurried(&self) -> bool {
        self.away.longest().0 > BUSY
    }

    /// Where the link stands.
    pub fn state(&self) -> LinkState {
        self.linked.state()
    }

    /// Whether the slides may still be on their way.
    pub fn is_behind(&self) -> bool {
        self.linked.is_behind()
    }

    /// Whether the kernel may make a tick.
    pub fn may_tick(&mut self) -> bool {
        self.linked.may_tick()
    }

    /// Before a tick.
    pub fn before(&mut self, simulation: &mut Simulation) {
        self.linked.before(simulation);
    }

    /// After a tick.
    pub fn after(&mut self, simulation: &mut Simulation) {
        self.linked.after(simulation);
    }

    /// Writes what waits, and the log.
    pub fn speak(&mut self, program: Option<&str>) {
        let written = match &mut self.carrier {
            Some(carrier) => {
                carrier.renew(self.linked.needs_guard());
                carrier.stop_with(&self.linked.stop_bytes());
                carrier.write(self.linked.tx())
            }
            None => self.linked.tx().len(),
        };
        self.linked.consumed(written);
        for note in self.linked.notes() {
            self.note(&note, program);
        }
        if let Some(carrier) = &mut self.carrier {
            let linked = &self.linked;
            let said = carrier.traffic(|outward, collected| linked.next_text(outward, collected));
            keep(&mut self.exchanges, said, EXCHANGES);
        }
    }

    fn note(&mut self, note: &Note, program: Option<&str>) {
        match note {
            Note::Learned { name, packed } => self.remember(name, packed),
            Note::Differs(difference) => self.differences.push(difference.clone()),
            &Note::Checked {
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
                let said = say::position_check(
                    utc(SystemTime::now()),
                    name,
                    commanded.x.0,
                    commanded.z.0,
                    x,
                    z,
                    result,
                );
                self.write_log(&said.to_string());
                keep(&mut self.log, [PositionCheck { said, agrees }], LOG_LINES);
            }
        }
    }

    /// What is not kept is read from the board again.
    fn remember(&self, name: &str, packed: &[u8]) {
        let Some(folder) = &self.connection.boards else {
            return;
        };
        let plain = |letter: char| letter.is_ascii_alphanumeric() || "._-".contains(letter);
        let name: String = name
            .chars()
            .map(|letter| if plain(letter) { letter } else { '-' })
            .take(LONGEST_NAME)
            .collect();
        let file = folder.join(format!("{name}.{DICTIONARY}"));
        let _ = std::fs::create_dir_all(folder).and_then(|()| atomic::write(&file, packed));
    }

    fn write_log(&mut self, line: &str) {
        let Some(path) = &self.connection.log else {
            return;
        };
        let file = OpenOptions::new().create(true).append(true).open(path);
        if let Err(error) = file.and_then(|mut file| writeln!(file, "{line}")) {
            tracing::error!("{}: {error}", path.display());
            let said = say::subject_reason(path.display(), say::as_written(error));
            self.said.push(said);
            // Said once; the position check goes on without its log.
            self.connection.log = None;
        }
    }

    /// What the operator should read.
    pub fn said(&mut self) -> Vec<Message> {
        core::mem::take(&mut self.said)
    }

    /// Keeps a picture until the slides are where it shows them.
    pub fn keep_picture(&mut self, snapshot: Snapshot) {
        self.pictures.push_back((self.linked.stamp(), snapshot));
    }

    /// The newest picture of what the board has made.
    pub fn due_picture(&mut self) -> Option<Snapshot> {
        // Behind a stop what they show may never have been made.
        self.pictures
            .retain(|(stamp, _)| !self.linked.is_void(*stamp));
        let mut due = None;
        while let Some((stamp, _)) = self.pictures.front()
            && self.linked.has_made(*stamp)
        {
            due = self.pictures.pop_front();
        }
        due.map(|(_, snapshot)| snapshot)
    }

    /// Writes the settings that differ into the board.
    pub fn write_settings(&mut self) {
        self.differences.clear();
        self.linked.write_settings();
    }

    /// Compares the counts now.
    pub fn check(&mut self) {
        self.linked.check();
    }

    /// The link page is open, or no more.
    pub const fn watch(&mut self, on: bool) {
        self.watched = on;
    }

    /// Whether a read of the port paces the kernel.
    pub const fn has_port(&self) -> bool {
        self.carrier.is_some()
    }

    /// Whether RESET asks for the lost board.
    pub const fn is_to_be_reopened(&self) -> bool {
        self.linked.is_to_be_reopened()
    }

    /// The link page's view, when it is watched and due.
    pub fn due_view(&mut self) -> Option<LinkView> {
        let now = self.clock.now();
        if !self.watched || now < self.next_view {
            return None;
        }
        self.next_view = now + VIEW_INTERVAL;
        Some(self.view())
    }

    fn view(&self) -> LinkView {
        let mut trips: Vec<_> = self.trips.iter().copied().collect();
        trips.sort_unstable();
        let worst = trips.last().copied();
        let linked = &self.linked;
        let settled = linked.state() == LinkState::Configure;
        LinkView {
            state: linked.state(),
            connected: !linked.is_opening()
                && !matches!(linked.state(), LinkState::Off | LinkState::Lost),
            protocol: linked.config().protocol,
            port: linked.config().port.clone(),
            board: linked.board().clone(),
            position_known: linked.knows_position(),
            round_trip: worst.map(|worst| (trips[trips.len() / 2], worst)),
            away: self.away.longest(),
            outstanding: linked.outstanding(),
            lookahead: linked.config().lookahead(),
            traffic: linked.traffic(),
            inputs: linked.inputs(),
            missing_outputs: linked.missing_outputs(),
            outputs: linked.outputs(),
            spindle: linked.spindle(),
            commanded: linked.commanded(),
            counted: linked.counted(),
            differences: if settled {
                self.differences.clone()
            } else {
                Vec::new()
            },
            exchanges: self.exchanges.iter().cloned().collect(),
            log: self.log.iter().cloned().collect(),
        }
    }
}

/// Name of a program's file without its folder.
fn file_name(path: &str) -> String {
    let name = Path::new(path).file_name();
    name.map_or_else(
        || path.to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// What boards met before said they understand. A damaged file is as good as none.
fn met_before(folder: &Path) -> Vec<Vec<u8>> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|end| end == DICTIONARY))
        .collect();
    files.sort();
    let short = |path: &PathBuf| {
        std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() <= LONGEST_FILE)
    };
    files
        .iter()
        .filter(|path| short(path))
        .take(MOST_BOARDS)
        .filter_map(|path| std::fs::read(path).ok())
        .collect()
}

/// Appends to what is kept of the newest.
fn keep<T>(kept: &mut VecDeque<T>, new: impl IntoIterator<Item = T>, most: usize) {
    kept.extend(new);
    while kept.len() > most {
        kept.pop_front();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_absence_is_kept_and_that_of_late_forgotten() {
        let ms = Duration::from_millis;
        let mut away = Away::default();
        for at in [2, 4, 94, 96] {
            away.hear(ms(at));
        }
        assert_eq!(away.longest(), (ms(90), ms(90)));
        // Two intervals later it is not of late any more.
        for at in (96..12_000).step_by(2) {
            away.hear(ms(at));
        }
        assert_eq!(away.longest(), (ms(2), ms(90)));
        away.hear(ms(12_040));
        assert_eq!(away.longest().0, ms(42));
    }
}
