//! The thread that works as the PC side of the serial port for the window: it owns the
//! port, takes commands and reports events. The window never waits for it.

mod job;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, TryRecvError, unbounded};
use gsk_messages::{Message, say};
use gsk_transfer::{
    DirectoryEntry, FileName, Partition, PcCommand, RemotePath, TransferFile, TransferProgress,
};
use web_time::Duration;

use super::{FilesError, PcError, TransferObserver, TransferSession, TransferTotals, folder};
use crate::{platform, ports};

/// A file of the PC to send to the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToSend {
    /// Path of the file to send on the PC.
    pub path: PathBuf,
    /// Partition and name that the file gets at the control.
    pub location: RemotePath,
    /// Whether to replace a file of the same name without a question.
    pub overwrite: bool,
}

/// A command for the worker thread.
#[derive(Clone, Debug, PartialEq)]
pub enum PcWorkerCommand {
    /// List the ports of the computer.
    FindPorts,
    /// Read the lengths of files on the PC.
    Measure(Vec<PathBuf>),
    /// Open a serial port (打开串口); closes the port that is open.
    Open {
        /// Name of the port to open.
        port: String,
        /// Rate of the port to open, bits per second.
        baud: u32,
    },
    /// Close the port (关闭串口), connected or not.
    Close,
    /// Connect with the control (建立连接).
    Connect,
    /// Disconnect from the control (断开连接).
    Disconnect,
    /// List the files of the control (获取CNC目录).
    List,
    /// Send these files to the control (开始传送).
    Send(Vec<ToSend>),
    /// Send the files of a folder, parameters last; each replaces a file of the same name.
    Restore(PathBuf),
    /// Receive files into a folder.
    Receive {
        /// The files at the control that are received.
        locations: Vec<RemotePath>,
        /// The folder on the PC into which files are received.
        into: PathBuf,
    },
    /// Receive all files of the partition USER into this folder.
    BackUp(PathBuf),
    /// Delete files at the control (删除文件).
    Delete(Vec<RemotePath>),
    /// Rename a file at the control (文件重命名).
    Rename {
        /// The file at the control that is renamed.
        from: RemotePath,
        /// New name of the file.
        to: FileName,
    },
    /// Write a file that the control has sent unrequested to the PC.
    StorePushed {
        /// Path on the PC to which the file is written.
        path: PathBuf,
        /// Name and content of the file.
        file: TransferFile,
    },
    /// Answer the question about a name conflict in the current job.
    Answer(NameConflictAnswer),
}

/// State of the connection with the control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ConnectionStage {
    /// The port is closed.
    #[default]
    Closed,
    /// The port is open, the control has not answered yet.
    Open,
    /// The port is open and the control has answered.
    Connected,
}

/// The question of a job about a file name that is taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NameConflict {
    /// The name is taken at the control (manual V-3.3).
    AtControl {
        /// The existing file at the control that has the name.
        location: RemotePath,
        /// A free name for the existing file; `None` for data, which have one name only.
        free_name: Option<FileName>,
        /// The files in the partition of the existing file.
        entries: Vec<DirectoryEntry>,
    },
    /// The name is taken on the PC, by the file at this path.
    OnDisk(PathBuf),
}

/// The decision about a file whose name is already used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NameConflictChoice {
    /// Replace the existing file (`是`).
    Overwrite,
    /// Rename (`否`): the existing file at the control gets this name, or a free one; on
    /// the PC the new file gets a number after its name.
    Rename(Option<FileName>),
    /// Skip the new file (`取消`).
    Skip,
}

/// The operator's decision about a [`NameConflict`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameConflictAnswer {
    /// Whether to overwrite, rename or skip the file.
    pub choice: NameConflictChoice,
    /// Whether the choice applies to all other files of this job.
    pub for_all: bool,
}

/// The kind of a job: sending, receiving or deleting files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileJobKind {
    /// The job sends files to the control.
    Send,
    /// The job receives files from the control.
    Receive,
    /// The job deletes files at the control.
    Delete,
}

/// The result of one file of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileResult {
    /// The file was sent, received or deleted.
    Done,
    /// The operator has skipped the file.
    Skipped,
    /// The file was refused; the message names it and the reason.
    Refused(Message),
}

/// An event of the worker thread for the window.
#[derive(Clone, Debug, PartialEq)]
pub enum PcWorkerEvent {
    /// The ports of the computer, each by the name that opens it.
    Ports(Vec<String>),
    /// Lengths of files on the PC, bytes; `None`: the file does not exist.
    Lengths(Vec<(PathBuf, Option<u64>)>),
    /// The connection has changed to this state.
    Stage(ConnectionStage),
    /// A command other than a job has failed for this reason.
    Failed(Message),
    /// A command other than a job has succeeded, as the message reports.
    Succeeded(Message),
    /// The files in each partition of the control.
    Listed(Vec<(Partition, Vec<DirectoryEntry>)>),
    /// A job of this kind begins; its files have these names.
    JobBegun(FileJobKind, Vec<String>),
    /// The job begins with its file of this index.
    FileBegun(usize),
    /// Progress of the current file, and the number of frames retransmitted so far.
    Progress(TransferProgress, u64),
    /// The file of the job with this index has ended.
    FileEnded(usize, FileResult),
    /// Totals of the transfers since the port was opened.
    Totals(TransferTotals),
    /// A file name is taken: the job waits for [`PcWorkerCommand::Answer`].
    Conflict(NameConflict),
    /// The job has ended; the message is the reason if it did not process all files.
    JobFinished(Option<Message>),
    /// The control has sent a file unrequested (manual V-3.4).
    Pushed(TransferFile),
}

/// Handle of the worker thread; dropping it ends the thread.
#[derive(Debug)]
pub struct PcWorker {
    commands: Sender<PcWorkerCommand>,
    events: Receiver<PcWorkerEvent>,
    cancel: Arc<AtomicBool>,
}

impl PcWorker {
    /// Starts the worker thread, which calls `wake` after each event.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(wake: impl Fn() + Send + Sync + 'static) -> io::Result<Self> {
        let (commands, from_window) = unbounded();
        let (to_window, news) = unbounded();
        let cancel = Arc::new(AtomicBool::new(false));
        let mut thread = PcWorkerThread {
            commands: from_window,
            events: EventSender {
                events: to_window,
                wake: Arc::new(wake),
            },
            cancel: Arc::clone(&cancel),
            session: None,
            stage: ConnectionStage::Closed,
        };
        platform::start_task("transfer", move || thread.take_turn())?;
        Ok(Self {
            commands,
            events: news,
            cancel,
        })
    }

    /// Queues a command; the thread carries out earlier ones first.
    pub fn send_command(&self, order: PcWorkerCommand) {
        self.cancel.store(false, Ordering::Relaxed);
        // A thread that has ended needs no command.
        let _ = self.commands.send(order);
    }

    /// Cancels the current job (取消).
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Returns the next event; `None` if there is none now.
    pub fn next_event(&self) -> Option<PcWorkerEvent> {
        self.events.try_recv().ok()
    }
}

/// Sends events to the window and makes it redraw.
#[derive(Clone)]
struct EventSender {
    events: Sender<PcWorkerEvent>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl EventSender {
    fn send(&self, news: PcWorkerEvent) {
        // A window that is gone needs no events.
        let _ = self.events.send(news);
        (self.wake)();
    }
}

/// Sends the progress of file transfers to the window.
struct ProgressReporter {
    events: EventSender,
    cancel: Arc<AtomicBool>,
    last_progress: Option<(TransferProgress, u64)>,
}

impl TransferObserver for ProgressReporter {
    fn on_progress(&mut self, progress: TransferProgress, retries: u64) {
        if self.last_progress != Some((progress, retries)) {
            self.last_progress = Some((progress, retries));
            self.events.send(PcWorkerEvent::Progress(progress, retries));
        }
    }

    fn is_cancelled(&mut self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

/// The state of the thread that transfers files.
struct PcWorkerThread {
    commands: Receiver<PcWorkerCommand>,
    events: EventSender,
    cancel: Arc<AtomicBool>,
    session: Option<TransferSession>,
    stage: ConnectionStage,
}

impl PcWorkerThread {
    /// Executes the next command, or moves bytes without one; returns false when the thread must
    /// end.
    fn take_turn(&mut self) -> bool {
        if self.session.is_none() {
            return match platform::receive(&self.commands, None) {
                Ok(order) => {
                    self.execute(order);
                    true
                }
                Err(none) => none == RecvTimeoutError::Timeout,
            };
        }
        match self.commands.try_recv() {
            Ok(order) => self.execute(order),
            Err(TryRecvError::Empty) => self.poll_idle_line(),
            Err(TryRecvError::Disconnected) => {
                self.close();
                return false;
            }
        }
        true
    }

    /// Moves bytes while no command runs: the control may send a file unrequested, and a cable
    /// may be unplugged.
    fn poll_idle_line(&mut self) {
        let Some(talk) = &mut self.session else {
            return;
        };
        match talk.poll() {
            Ok(None) => {}
            Ok(Some(file)) => {
                self.set_stage(ConnectionStage::Connected);
                self.events.send(PcWorkerEvent::Pushed(file));
            }
            Err(error) => self.report_failure(&error),
        }
    }

    fn set_stage(&mut self, stage: ConnectionStage) {
        if self.stage != stage {
            self.stage = stage;
            self.events.send(PcWorkerEvent::Stage(stage));
        }
    }

    /// Sends the error to the window. If the error is about the port or a missing answer, the
    /// connection counts as lost.
    fn report_failure(&mut self, error: &PcError) {
        self.lower_stage(error);
        self.events.send(PcWorkerEvent::Failed(error.message()));
    }

    fn lower_stage(&mut self, error: &PcError) {
        match error {
            PcError::Port(_) | PcError::Files(FilesError::Gone(_)) => {
                self.session = None;
                self.set_stage(ConnectionStage::Closed);
            }
            error if error.ends_connection() => self.set_stage(ConnectionStage::Open),
            _ => {}
        }
    }

    fn close(&mut self) {
        if let Some(talk) = self.session.take()
            && self.stage == ConnectionStage::Connected
        {
            talk.close();
        }
        self.session = None;
        self.set_stage(ConnectionStage::Closed);
    }

    fn execute(&mut self, order: PcWorkerCommand) {
        match order {
            PcWorkerCommand::FindPorts => self.events.send(PcWorkerEvent::Ports(port_names())),
            PcWorkerCommand::Measure(paths) => self
                .events
                .send(PcWorkerEvent::Lengths(file_lengths(paths))),
            PcWorkerCommand::Open { port, baud } => self.open(&port, baud),
            PcWorkerCommand::Close => self.close(),
            PcWorkerCommand::Connect => self.connect(),
            PcWorkerCommand::Disconnect => self.disconnect(),
            PcWorkerCommand::List => self.list(),
            PcWorkerCommand::Send(files) => self.send(files),
            PcWorkerCommand::Restore(folder) => self.restore(&folder),
            PcWorkerCommand::Receive {
                locations: places,
                into,
            } => self.receive(places, &into),
            PcWorkerCommand::BackUp(folder) => self.back_up(&folder),
            PcWorkerCommand::Delete(places) => self.delete(places),
            PcWorkerCommand::Rename { from, to } => self.rename(from, to),
            PcWorkerCommand::StorePushed { path, file } => {
                self.events.send(store_pushed(&path, &file));
            }
            // The task that sent the question has ended meanwhile.
            PcWorkerCommand::Answer(_) => {}
        }
    }

    fn open(&mut self, port: &str, baud: u32) {
        self.close();
        let watch = ProgressReporter {
            events: self.events.clone(),
            cancel: Arc::clone(&self.cancel),
            last_progress: None,
        };
        match TransferSession::open(port, baud, Box::new(watch)) {
            Ok(talk) => {
                self.session = Some(talk);
                self.set_stage(ConnectionStage::Open);
            }
            Err(error) => self.report_failure(&error),
        }
    }

    /// Runs `work` at the open port. Sends its error to the window and then returns `None`, as
    /// without a port.
    fn with_port<T>(
        &mut self,
        work: impl FnOnce(&mut TransferSession) -> Result<T, PcError>,
    ) -> Option<T> {
        let done = work(self.session.as_mut()?);
        match done {
            Ok(done) => Some(done),
            Err(error) => {
                self.report_failure(&error);
                None
            }
        }
    }

    fn connect(&mut self) {
        if self.with_port(TransferSession::connect).is_some() {
            self.set_stage(ConnectionStage::Connected);
            self.list();
        }
    }

    fn disconnect(&mut self) {
        if self.with_port(TransferSession::disconnect).is_some() {
            self.set_stage(ConnectionStage::Open);
        }
    }

    fn list(&mut self) {
        let listed = self.with_port(|talk| {
            let all = Partition::ALL.into_iter();
            all.map(|it| Ok((it, talk.list(it)?))).collect()
        });
        if let Some(listed) = listed {
            self.events.send(PcWorkerEvent::Listed(listed));
        }
    }

    fn rename(&mut self, from: RemotePath, to: FileName) {
        let (name, new) = (from.name.clone(), to.clone());
        let renamed = self.with_port(|talk| talk.change(&name, PcCommand::Rename { from, to }));
        if renamed.is_some() {
            self.events
                .send(PcWorkerEvent::Succeeded(say::transfer_renamed(name, new)));
            self.list();
        }
    }
}

/// Lists the names of the serial ports of the computer.
pub fn port_names() -> Vec<String> {
    // Without a list from the system the user types the port.
    let found = ports::list_ports().unwrap_or_default();
    let name = |port: ports::PortInfo| match port.by_id {
        Some(by_id) => by_id.display().to_string(),
        None => port.path,
    };
    found.into_iter().map(name).collect()
}

fn file_lengths(paths: Vec<PathBuf>) -> Vec<(PathBuf, Option<u64>)> {
    let measured = |path: PathBuf| {
        let facts = platform::path_facts(&path)
            .ok()
            .filter(|facts| facts.is_file);
        (path, facts.map(|facts| facts.length))
    };
    paths.into_iter().map(measured).collect()
}

fn store_pushed(path: &Path, file: &TransferFile) -> PcWorkerEvent {
    match folder::write_file(path, &file.bytes) {
        Ok(()) => {
            let (name, size) = (&file.remote_path.name, file.bytes.len());
            PcWorkerEvent::Succeeded(say::transfer_got(name, path.display(), size))
        }
        Err(error) => PcWorkerEvent::Failed(error.message()),
    }
}

/// Time between two checks of the line while a job waits for an answer.
const ANSWER_POLL_INTERVAL: Duration = Duration::from_millis(50);
