//! The PC's side for the window: a thread that has the port, takes orders and says what
//! comes of them. The window never waits for it.

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

/// A file of the PC for the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToSend {
    /// Where it stands on the PC.
    pub path: PathBuf,
    /// Where it goes at the control.
    pub place: RemotePath,
    /// It takes the place of one of its name unasked.
    pub overwrite: bool,
}

/// What the thread is to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// Say which ports there are.
    FindPorts,
    /// Say how long files of the PC are.
    Measure(Vec<PathBuf>),
    /// Open a port (打开串口), at so many bits a second.
    Open {
        /// Its name.
        port: String,
        /// Its speed.
        baud: u32,
    },
    /// Close it (关闭串口), connected or not.
    Close,
    /// Connect with the control (建立连接).
    Connect,
    /// Take leave of it (断开连接).
    Disconnect,
    /// List its files (获取CNC目录).
    List,
    /// Send files (开始传送).
    Send(Vec<ToSend>),
    /// Send the files of a folder, parameters last; each takes the place of one of its name.
    Restore(PathBuf),
    /// Receive files into a folder.
    Receive {
        /// The files.
        places: Vec<RemotePath>,
        /// The folder.
        into: PathBuf,
    },
    /// Receive all files into a folder.
    BackUp(PathBuf),
    /// Delete files (删除文件).
    Delete(Vec<RemotePath>),
    /// Rename one (文件重命名).
    Rename {
        /// The file.
        from: RemotePath,
        /// Its new name.
        to: FileName,
    },
    /// Write a file that the control has sent by itself.
    Keep {
        /// Where to.
        path: PathBuf,
        /// The file.
        file: TransferFile,
    },
    /// What was asked is answered.
    Answer(Answer),
}

/// How far the line is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stage {
    /// No port is open.
    #[default]
    Closed,
    /// The port is open.
    Open,
    /// The control has answered.
    Connected,
}

/// A name that is taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Question {
    /// At the control (manual V-3.3).
    AtControl {
        /// The file.
        place: RemotePath,
        /// A name that the one there could be given; none for data.
        free: Option<FileName>,
        /// What the partition holds.
        entries: Vec<DirectoryEntry>,
    },
    /// On the PC.
    OnDisk(PathBuf),
}

/// What becomes of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The new file takes its place (`是`).
    Overwrite,
    /// The one at the control gets this name, else a free one (`否`); on the PC the new
    /// file gets a number behind its name.
    Rename(Option<FileName>),
    /// The file is left out (`取消`).
    Skip,
}

/// The answer to a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// What becomes of the file.
    pub choice: Choice,
    /// The same of all others of this job.
    pub of_all: bool,
}

/// What a job does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Files go to the control.
    Send,
    /// They come from it.
    Receive,
    /// They are deleted.
    Delete,
}

/// What has become of a file of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fate {
    /// All of it has arrived; or it is gone, where it was to be.
    Done,
    /// It was left out.
    Skipped,
    /// It was refused: which file, and why.
    Refused(Message),
}

/// What has come of something.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// The ports there are: each with what it is opened by.
    Ports(Vec<String>),
    /// How long files of the PC are, bytes; none: there is no such file.
    Lengths(Vec<(PathBuf, Option<u64>)>),
    /// How far the line is now.
    Stage(Stage),
    /// What went wrong beside a job.
    Failed(Message),
    /// Something is done.
    Said(Message),
    /// What the partitions of the control hold.
    Listed(Vec<(Partition, Vec<DirectoryEntry>)>),
    /// A job begins, with these files.
    Begun(Kind, Vec<String>),
    /// A file of the job begins.
    At(usize),
    /// How far it has come, and frames that went out again.
    Moves(TransferProgress, u64),
    /// It has ended.
    Ended(usize, Fate),
    /// What has gone so far.
    Traffic(Traffic),
    /// A name is taken: the job waits for the answer.
    Asked(Question),
    /// The job is over; why, if it did not come to its end.
    Over(Option<Message>),
    /// The control has sent a file by itself (manual V-3.4).
    Pushed(TransferFile),
}

/// The thread, from outside. It ends with this.
#[derive(Debug)]
pub struct Worker {
    orders: Sender<Order>,
    news: Receiver<News>,
    cancel: Arc<AtomicBool>,
}

impl Worker {
    /// Starts it. `wake` is called when there is news.
    ///
    /// # Errors
    /// The system gives no thread.
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

    /// Gives an order; those before it are carried out first.
    pub fn order(&self, order: Order) {
        self.cancel.store(false, Ordering::Relaxed);
        // A thread that has ended has nothing to do any more.
        let _ = self.orders.send(order);
    }

    /// Breaks the job under way off (取消).
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// What has come since.
    pub fn news(&self) -> Option<News> {
        self.news.try_recv().ok()
    }
}

/// What the window is told.
#[derive(Clone)]
struct Tell {
    news: Sender<News>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Tell {
    fn tell(&self, news: News) {
        // A window that is gone needs no news.
        let _ = self.news.send(news);
        (self.wake)();
    }
}

/// Tells the window how far files have come.
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

/// The thread.
struct Desk {
    orders: Receiver<Order>,
    tell: Tell,
    cancel: Arc<AtomicBool>,
    talk: Option<Talk>,
    stage: Stage,
}

impl Desk {
    /// Carries out an order, or bytes while there is none; whether to go on.
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

    /// Nothing is asked for: the control may send by itself, and a cable may be pulled.
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

    /// Says why; without a port or an answer there is no connection any more.
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
            // The job that has asked has ended meanwhile.
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

    /// Does something at the open port.
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

/// The ports of the computer.
fn found() -> Vec<String> {
    // A system that does not tell its ports leaves them to be typed.
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

/// So often somebody who waits for an answer looks at the line.
const LOOK: Duration = Duration::from_millis(50);
