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

use super::{FilesError, PcError, Talk, Traffic, Watch, folder};
use crate::{platform, ports};

/// A file of the PC to send to the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToSend {
    /// Path on the PC.
    pub path: PathBuf,
    /// Location at the control.
    pub place: RemotePath,
    /// Replace a file of the same name without a question.
    pub overwrite: bool,
}

/// A command for the thread.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// List the ports of the computer.
    FindPorts,
    /// Read the lengths of files on the PC.
    Measure(Vec<PathBuf>),
    /// Open a port (打开串口).
    Open {
        /// Name of the port.
        port: String,
        /// Rate, bits a second.
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
    /// Send files (开始传送).
    Send(Vec<ToSend>),
    /// Send the files of a folder, parameters last; each replaces a file of the same name.
    Restore(PathBuf),
    /// Receive files into a folder.
    Receive {
        /// The files at the control.
        places: Vec<RemotePath>,
        /// The folder on the PC.
        into: PathBuf,
    },
    /// Receive all files of the partition USER into a folder.
    BackUp(PathBuf),
    /// Delete files at the control (删除文件).
    Delete(Vec<RemotePath>),
    /// Rename a file at the control (文件重命名).
    Rename {
        /// The file.
        from: RemotePath,
        /// Its new name.
        to: FileName,
    },
    /// Write a file that the control has sent unrequested.
    Keep {
        /// Path on the PC.
        path: PathBuf,
        /// The file.
        file: TransferFile,
    },
    /// The answer to a question of the current job.
    Answer(Answer),
}

/// State of the connection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stage {
    /// No port is open.
    #[default]
    Closed,
    /// The port is open, the control has not answered yet.
    Open,
    /// The control has answered.
    Connected,
}

/// A question of a job: a file name is taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Question {
    /// At the control (manual V-3.3).
    AtControl {
        /// The file.
        place: RemotePath,
        /// A free name for the existing file; `None` for data, which have one name only.
        free: Option<FileName>,
        /// Files in the partition.
        entries: Vec<DirectoryEntry>,
    },
    /// On the PC, at this path.
    OnDisk(PathBuf),
}

/// What to do with a file whose name is taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Replace the existing file (`是`).
    Overwrite,
    /// Rename (`否`): the existing file at the control gets this name, or a free one; on
    /// the PC the new file gets a number after its name.
    Rename(Option<FileName>),
    /// Skip the new file (`取消`).
    Skip,
}

/// The answer to a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// What to do with the file.
    pub choice: Choice,
    /// Apply the choice to all other files of this job.
    pub of_all: bool,
}

/// What a job does with its files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Send them to the control.
    Send,
    /// Receive them from the control.
    Receive,
    /// Delete them at the control.
    Delete,
}

/// Result for one file of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fate {
    /// The file has been sent, received or deleted.
    Done,
    /// The operator has skipped it.
    Skipped,
    /// It was refused: which file, and why.
    Refused(Message),
}

/// An event for the window.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// The ports of the computer, each by the name that opens it.
    Ports(Vec<String>),
    /// Lengths of files on the PC, bytes; `None`: the file does not exist.
    Lengths(Vec<(PathBuf, Option<u64>)>),
    /// The state of the connection has changed.
    Stage(Stage),
    /// A command other than a job has failed.
    Failed(Message),
    /// A command other than a job has succeeded.
    Said(Message),
    /// Files in the partitions of the control.
    Listed(Vec<(Partition, Vec<DirectoryEntry>)>),
    /// A job begins with these files.
    Begun(Kind, Vec<String>),
    /// A file of the job begins, by its index.
    At(usize),
    /// Progress of the current file, and the number of retransmitted frames.
    Moves(TransferProgress, u64),
    /// A file of the job has ended, by its index.
    Ended(usize, Fate),
    /// Transfer totals so far.
    Traffic(Traffic),
    /// A file name is taken: the job waits for the answer.
    Asked(Question),
    /// The job is finished; the reason, if it has not reached its end.
    Over(Option<Message>),
    /// The control has sent a file unrequested (manual V-3.4).
    Pushed(TransferFile),
}

/// Handle of the thread; dropping it ends the thread.
#[derive(Debug)]
pub struct Worker {
    orders: Sender<Order>,
    news: Receiver<News>,
    cancel: Arc<AtomicBool>,
}

impl Worker {
    /// Starts the thread. It calls `wake` after each event.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(wake: impl Fn() + Send + Sync + 'static) -> io::Result<Self> {
        let (orders, from_window) = unbounded();
        let (to_window, news) = unbounded();
        let cancel = Arc::new(AtomicBool::new(false));
        let mut desk = Desk {
            orders: from_window,
            tell: Tell {
                news: to_window,
                wake: Arc::new(wake),
            },
            cancel: Arc::clone(&cancel),
            talk: None,
            stage: Stage::Closed,
        };
        platform::turn("transfer", move || desk.turn())?;
        Ok(Self {
            orders,
            news,
            cancel,
        })
    }

    /// Queues a command; the thread carries out earlier ones first.
    pub fn order(&self, order: Order) {
        self.cancel.store(false, Ordering::Relaxed);
        // A thread that has ended needs no command.
        let _ = self.orders.send(order);
    }

    /// Cancels the current job (取消).
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Returns the next event, if there is one.
    pub fn news(&self) -> Option<News> {
        self.news.try_recv().ok()
    }
}

/// Reports events to the window.
#[derive(Clone)]
struct Tell {
    news: Sender<News>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Tell {
    fn tell(&self, news: News) {
        // A window that is gone needs no events.
        let _ = self.news.send(news);
        (self.wake)();
    }
}

/// Reports the progress of files to the window.
struct Onlooker {
    tell: Tell,
    cancel: Arc<AtomicBool>,
    last: Option<(TransferProgress, u64)>,
}

impl Watch for Onlooker {
    fn moves(&mut self, progress: TransferProgress, retries: u64) {
        if self.last != Some((progress, retries)) {
            self.last = Some((progress, retries));
            self.tell.tell(News::Moves(progress, retries));
        }
    }

    fn is_cancelled(&mut self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

/// The state of the thread.
struct Desk {
    orders: Receiver<Order>,
    tell: Tell,
    cancel: Arc<AtomicBool>,
    talk: Option<Talk>,
    stage: Stage,
}

impl Desk {
    /// Carries out a command, or moves bytes while there is none; returns whether to
    /// continue.
    fn turn(&mut self) -> bool {
        if self.talk.is_none() {
            return match platform::receive(&self.orders, None) {
                Ok(order) => {
                    self.carry_out(order);
                    true
                }
                Err(none) => none == RecvTimeoutError::Timeout,
            };
        }
        match self.orders.try_recv() {
            Ok(order) => self.carry_out(order),
            Err(TryRecvError::Empty) => self.listen(),
            Err(TryRecvError::Disconnected) => {
                self.close();
                return false;
            }
        }
        true
    }

    /// Handles an idle line: the control may send unrequested, and a cable may be
    /// unplugged.
    fn listen(&mut self) {
        let Some(talk) = &mut self.talk else { return };
        match talk.idle() {
            Ok(None) => {}
            Ok(Some(file)) => {
                self.go(Stage::Connected);
                self.tell.tell(News::Pushed(file));
            }
            Err(error) => self.failed(&error),
        }
    }

    fn go(&mut self, stage: Stage) {
        if self.stage != stage {
            self.stage = stage;
            self.tell.tell(News::Stage(stage));
        }
    }

    /// Reports an error; without a port or an answer the connection is lost.
    fn failed(&mut self, error: &PcError) {
        self.falls_back(error);
        self.tell.tell(News::Failed(error.message()));
    }

    fn falls_back(&mut self, error: &PcError) {
        match error {
            PcError::Port(_) | PcError::Files(FilesError::Gone(_)) => {
                self.talk = None;
                self.go(Stage::Closed);
            }
            error if error.ends_connection() => self.go(Stage::Open),
            _ => {}
        }
    }

    fn close(&mut self) {
        if let Some(talk) = self.talk.take()
            && self.stage == Stage::Connected
        {
            talk.end();
        }
        self.talk = None;
        self.go(Stage::Closed);
    }

    fn carry_out(&mut self, order: Order) {
        match order {
            Order::FindPorts => self.tell.tell(News::Ports(found())),
            Order::Measure(paths) => self.tell.tell(News::Lengths(measured(paths))),
            Order::Open { port, baud } => self.open(&port, baud),
            Order::Close => self.close(),
            Order::Connect => self.connect(),
            Order::Disconnect => self.disconnect(),
            Order::List => self.list(),
            Order::Send(files) => self.send(files),
            Order::Restore(folder) => self.restore(&folder),
            Order::Receive { places, into } => self.receive(places, &into),
            Order::BackUp(folder) => self.back_up(&folder),
            Order::Delete(places) => self.delete(places),
            Order::Rename { from, to } => self.rename(from, to),
            Order::Keep { path, file } => self.tell.tell(kept(&path, &file)),
            // The job that asked has ended meanwhile.
            Order::Answer(_) => {}
        }
    }

    fn open(&mut self, port: &str, baud: u32) {
        self.close();
        let watch = Onlooker {
            tell: self.tell.clone(),
            cancel: Arc::clone(&self.cancel),
            last: None,
        };
        match Talk::open(port, baud, Box::new(watch)) {
            Ok(talk) => {
                self.talk = Some(talk);
                self.go(Stage::Open);
            }
            Err(error) => self.failed(&error),
        }
    }

    /// Runs work at the open port and reports its error.
    fn at_port<T>(&mut self, work: impl FnOnce(&mut Talk) -> Result<T, PcError>) -> Option<T> {
        let done = work(self.talk.as_mut()?);
        match done {
            Ok(done) => Some(done),
            Err(error) => {
                self.failed(&error);
                None
            }
        }
    }

    fn connect(&mut self) {
        if self.at_port(Talk::connect).is_some() {
            self.go(Stage::Connected);
            self.list();
        }
    }

    fn disconnect(&mut self) {
        if self.at_port(Talk::take_leave).is_some() {
            self.go(Stage::Open);
        }
    }

    fn list(&mut self) {
        let listed = self.at_port(|talk| {
            let all = Partition::ALL.into_iter();
            all.map(|it| Ok((it, talk.list(it)?))).collect()
        });
        if let Some(listed) = listed {
            self.tell.tell(News::Listed(listed));
        }
    }

    fn rename(&mut self, from: RemotePath, to: FileName) {
        let (name, new) = (from.name.clone(), to.clone());
        let renamed = self.at_port(|talk| talk.change(&name, PcCommand::Rename { from, to }));
        if renamed.is_some() {
            self.tell.tell(News::Said(say::transfer_renamed(name, new)));
            self.list();
        }
    }
}

/// Returns the ports of the computer.
fn found() -> Vec<String> {
    // Without a list from the system the user types the port.
    let found = ports::list().unwrap_or_default();
    let name = |port: ports::Found| match port.by_id {
        Some(by_id) => by_id.display().to_string(),
        None => port.path,
    };
    found.into_iter().map(name).collect()
}

fn measured(paths: Vec<PathBuf>) -> Vec<(PathBuf, Option<u64>)> {
    let measured = |path: PathBuf| {
        let facts = platform::facts(&path).ok().filter(|facts| facts.is_file);
        (path, facts.map(|facts| facts.length))
    };
    paths.into_iter().map(measured).collect()
}

fn kept(path: &Path, file: &TransferFile) -> News {
    match folder::write(path, &file.bytes) {
        Ok(()) => {
            let (name, size) = (&file.remote_path.name, file.bytes.len());
            News::Said(say::transfer_got(name, path.display(), size))
        }
        Err(error) => News::Failed(error.message()),
    }
}

/// Time between two checks of the line while a job waits for an answer.
const LOOK: Duration = Duration::from_millis(50);
