//! What passes between the kernel and the window: commands one way, pictures and notices
//! the other.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::{Receiver, Sender, bounded};
use crossbeam::queue::ArrayQueue;
use gsk_core::alarm::Alarm;
use gsk_core::cnc::Request;
use gsk_core::command::ProgramId;
use gsk_core::machine::Fault;
use gsk_core::memory::{Level, Refusal};
use gsk_core::model::ModelId;
use gsk_core::operation::RunState;
use gsk_core::plc::address::BitAddress;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_link::LinkState;
use gsk_messages::Message;
use gsk_panel::alarm_log::AlarmRecord;
use gsk_panel::keys::Key;
use gsk_panel::pages::PageId;
use gsk_panel::panel::SerialFile;
use gsk_panel::screen::Screen;
use gsk_project::ProjectState;
use gsk_runner::first_look::FirstLook;

use super::lesson::{LessonOrder, LessonState};
use super::link_view::LinkView;
use super::monitor::MachineView;
use super::part::PartView;
use super::probe::Probe;
use super::waiting::Waits;
use crate::input_watch::InputWatch;
use crate::job::Chosen;
use crate::pace::Speed;
use crate::platform;

/// What the window asks of the kernel.
#[derive(Clone, Debug)]
pub enum Command {
    /// A key of the panel went down or came up.
    Key {
        /// The key.
        key: Key,
        /// Down, or up.
        down: bool,
    },
    /// Press a key and let it go.
    Tap(Key),
    /// A character that the panel has no key of its own for.
    Type(char),
    /// Turn the handwheel by so many detents.
    Turn(i32),
    /// Open a program that was read from a file.
    Open(Box<Opened>),
    /// Open a program and press [自动] and cycle start: a person wants to see it cut. With a
    /// pulse board it is opened only.
    OpenAndStart(Box<Opened>),
    /// A file comes in through the serial port.
    Receive(Box<SerialFile>),
    /// The partner could not take what the control sent.
    TransferFailed,
    /// What the opened program cuts, for the graphic page.
    Fit {
        /// Least point, X as a radius.
        least: Point,
        /// Greatest point.
        greatest: Point,
    },
    /// Take samples for the scope from now on, or no more.
    Probe(Option<Probe>),
    /// Hand out the machine and the PLC with the pictures, or no more.
    Monitor(bool),
    /// Break something, or mend it.
    Fault(Fault, bool),
    /// Ask the control for something; a refusal is said.
    Ask(Box<Request>),
    /// Ask the control for parameters, pitch errors, offsets and variables, all of them or
    /// none; a refusal is said.
    Write(Vec<Request>),
    /// Switch the control off and on again.
    PowerCycle,
    /// Hold a machine input at a value, or give it back to its sensor.
    ForceInput(BitAddress, Option<bool>),
    /// Let every forced bit of the PLC go.
    FreeBits,
    /// Mend every fault and give every input back to its sensor.
    Mend,
    /// End the faults of a crash and press RESET.
    FreeLathe,
    /// Run programs at this speed from now on, while no board moves real slides.
    Speed(Speed),
    /// Do something with lessons.
    Lesson(LessonOrder),
    /// Do something with the pulse board.
    Link(LinkOrder),
    /// Hand out what the LCD shows in the other language, too, or no more.
    Translate(bool),
    /// Hand out what is heard of the machine, or no more.
    Listen(bool),
    /// Hand out the state of the pulse board, or no more.
    WatchLink(bool),
    /// Store a text as a program of the memory, and say what came of it.
    Store(String, Sender<Result<u16, NotStored>>),
    /// Hand out once what a preview of the control as it stands starts from.
    HandOut(Sender<Box<Setup>>),
    /// Hand out once what the control holds, and the operation level in force.
    HandOutState(Sender<Box<(ProjectState, Level)>>),
    /// The job of the part in the simulated lathe, on fresh stock; none: there is none.
    Job(Option<Box<Chosen>>),
    /// New stock is clamped.
    FreshStock,
    /// Whether the simulated lathe stops where a tool hits something.
    CrashStops(bool),
    /// Hand out the part with the pictures, or no more; it is cut in either case.
    ShowPart(bool),
    /// The window is alive; held keys may stay down.
    Alive,
    /// Let go of every key.
    ReleaseAll,
    /// Stop the kernel.
    Quit,
}

/// What may be asked of the pulse board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkOrder {
    /// Close the port and open it again.
    Reconnect,
    /// Write the settings that differ into the board.
    WriteSettings,
    /// Compare its count with the commanded pulses now.
    Check,
}

/// What becomes of a program whose number is in the memory already, with another text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Storing {
    /// Whoever opened it is asked.
    #[default]
    Ask,
    /// It takes the place of the other.
    Replace,
    /// It is run without being stored.
    RunOnly,
}

/// A program read from a file, ready for the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Opened {
    /// Name to be shown.
    pub name: String,
    /// Its file; a sample has none.
    pub path: Option<PathBuf>,
    /// What becomes of it when its number is taken.
    pub storing: Storing,
    /// The program.
    pub program: Program,
    /// Subprograms from its folder.
    pub subprograms: Vec<Program>,
}

/// Where an opened program stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the memory, under its number.
    Stored(u16),
    /// It can be run and read, but not edited, and is gone with the power.
    OnlyRun(NotStored),
}

/// Why an opened program is not in the memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotStored {
    /// It has no number, nor has its name.
    NoNumber,
    /// Its number belongs to another program, which was to stay.
    NumberTaken(u16),
    /// Switch, lock or level stand against it.
    Refused(Refusal),
    /// The memory does not take it.
    Alarm(Alarm),
}

/// What the kernel tells the window besides pictures; none is lost.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// A program was opened.
    Opened {
        /// Its name.
        name: String,
        /// Its file, if it has one.
        path: Option<PathBuf>,
        /// Where it stands now.
        place: Place,
    },
    /// It was not opened: the memory has another program of its number.
    NumberTaken(Box<Opened>, u16),
    /// The control has sent something: what, and where it is.
    Sent(String),
    /// Something went wrong, or should be known.
    Said(Message),
    /// The tool has hit something.
    Collided(Message),
    /// New stock is clamped: what was hit before is over.
    FreshStock,
    /// The control refused what was asked of it.
    Refused(Alarm),
    /// A program that was opened, by the name of its file, has been looked through.
    Looked(String, Box<FirstLook>),
    /// A key does nothing, and why; none: a key acts again.
    Key(Option<Message>),
}

/// The panel as it is seen at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// The LCD.
    pub screen: Screen,
    /// The same in the language that it does not speak, while that is asked for.
    pub translated: Option<Box<Screen>>,
    /// The page on it.
    pub page: PageId,
    /// Which way the axis keys move the slides.
    pub keys_reversed: KeysReversed,
    /// The control model.
    pub model: ModelId,
    /// Brightness of the LCD.
    pub brightness: u8,
    /// Lamps: the Y memory.
    pub y: [u8; 20],
    /// Keys that are down, the latched emergency stop among them.
    pub pressed: Vec<Key>,
    /// Position of the handwheel, detents.
    pub wheel: i32,
    /// Machine time over wall time at the speed of a real lathe, %; 100 unless the PC is
    /// too slow.
    pub speed_percent: u32,
    /// How fast a program is to run.
    pub speed: Speed,
    /// Machine time over wall time while another speed than a real lathe's is in force.
    pub times: Option<Times>,
    /// What stands against ladder and sensors.
    pub imposed: Imposed,
    /// The newest alarm that stands, or the first message of the ladder.
    pub alarm: Option<Alarm>,
    /// The slides behind a pulse board want their reference return.
    pub place_unknown: bool,
    /// State of the pulse board that moves real slides, if there is one.
    pub board: Option<LinkState>,
    /// Whether a program runs or is held.
    pub run: RunState,
    /// What the program under way waits for, if that takes longer than usual.
    pub waits: Option<Waits>,
    /// A slide or the spindle moves.
    pub moves: bool,
    /// The selected program.
    pub program: Option<ProgramId>,
    /// The lesson under way: all that is shown is its practice machine.
    pub lesson: Option<LessonState>,
    /// The alarms that were raised since the control was opened, the newest first.
    pub raised: Arc<Vec<AlarmRecord>>,
    /// Slides and spindle, while somebody listens.
    pub motion: Option<Motion>,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Where the slides are, mm (X in radius).
    pub slides: Point,
    /// Speed of the spindle without its direction, r/min, in steps so that pictures do not
    /// change for nothing.
    pub spindle: f64,
}

/// Whether the axis keys move the slides the other way round than on a lathe with its chuck
/// on the left and its tool post in front.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KeysReversed {
    /// The upper key is X+ (175.0).
    pub x: bool,
    /// The left key is Z+ (175.1).
    pub z: bool,
}

/// Machine time over wall time, in steps so that pictures do not change for nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times(pub f64);

/// What views have imposed on control and lathe; it stands until it is taken back,
/// also when the view is closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Imposed {
    /// Forced bits of the PLC.
    pub bits: usize,
    /// Machine inputs held at a value.
    pub inputs: usize,
    /// Faults of the lathe.
    pub faults: usize,
}

/// The window's end of the channels.
#[derive(Clone, Debug)]
pub struct Console {
    /// To the kernel.
    pub commands: Sender<Command>,
    /// The newest picture.
    pub pictures: Arc<ArrayQueue<Snapshot>>,
    /// The newest state of machine and PLC, while it is asked for.
    pub machine: Arc<ArrayQueue<MachineView>>,
    /// The newest state of the pulse board, while it is asked for.
    pub link: Arc<ArrayQueue<LinkView>>,
    /// The newest state of the part, while there is a job.
    pub part: Arc<ArrayQueue<PartView>>,
    /// Messages.
    pub notices: Receiver<Notice>,
    /// For helpers that read files: their messages come out of `notices`.
    pub say: Sender<Notice>,
    /// What proves that held keys are still held.
    pub watch: InputWatch,
}

impl Console {
    /// Sends a command; a kernel that has ended hears nothing.
    pub fn send(&self, command: Command) {
        // A full queue means that the kernel has stood still for a thousand
        // commands: one more would not help, and the window must not wait.
        let _ = self.commands.try_send(command);
    }

    /// What a preview of the control as it stands starts from; `None` where the kernel
    /// gives no answer. It waits: for threads beside the window only.
    pub fn setup(&self) -> Option<Setup> {
        const LONGEST: Duration = Duration::from_secs(5);
        let (to, answer) = bounded(1);
        self.commands.send(Command::HandOut(to)).ok()?;
        platform::answer(&answer, LONGEST).map(|setup| *setup)
    }

    /// What the control holds, and the operation level in force; `None` where the kernel
    /// gives no answer. It waits, as [`Self::setup`] does.
    pub fn state(&self) -> Option<(ProjectState, Level)> {
        const LONGEST: Duration = Duration::from_secs(5);
        let (to, answer) = bounded(1);
        self.commands.send(Command::HandOutState(to)).ok()?;
        platform::answer(&answer, LONGEST).map(|state| *state)
    }

    /// Stores a text as a program of the memory and selects it; `None` where the kernel
    /// gives no answer. It waits, as [`Self::setup`] does.
    pub fn store(&self, text: String) -> Option<Result<u16, NotStored>> {
        const LONGEST: Duration = Duration::from_secs(5);
        let (to, answer) = bounded(1);
        self.commands.send(Command::Store(text, to)).ok()?;
        platform::answer(&answer, LONGEST)
    }
}
