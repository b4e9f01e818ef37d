//! The interface between the kernel and the window: commands to the kernel, snapshots and
//! notices to the window.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::{Receiver, Sender, bounded};
use crossbeam::queue::ArrayQueue;
use gsk_core::alarm::Alarm;
use gsk_core::cnc::ControlRequest;
use gsk_core::command::{ProgramId, SourcePosition};
use gsk_core::machine::LatheFault;
use gsk_core::memory::{OperationLevel, WriteRefusal};
use gsk_core::model::{ModelId, ProgramNaming};
use gsk_core::operation::RunState;
use gsk_core::plc::address::BitAddress;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_debugger::watch::WatchTarget;
use gsk_link::LinkState;
use gsk_messages::{Language, Message};
use gsk_panel::alarm_log::AlarmRecord;
use gsk_panel::keys::Key;
use gsk_panel::pages::{PageId, UdiskFile};
use gsk_panel::panel::SerialFile;
use gsk_panel::screen::Screen;
use gsk_panel::why::{CauseChain, CauseSubject};
use gsk_project::ProjectState;
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::program_summary::ProgramSummary;

use super::class_seat::SeatAction;
use super::exercise::ExerciseAction;
use super::exercise_run::{ExerciseState, HandedInSolution};
use super::lesson::LessonAction;
use super::link_view::LinkView;
use super::monitor::MachineView;
use super::part::PartView;
use super::practice_session::LessonState;
use super::probe::Probe;
use super::program::breakpoints::{BreakpointCommand, BreakpointHalt};
use super::program::start::StartDistance;
use super::program::wait::ProgramWait;
use super::program::watches::WatchReading;
use super::timeline::{PastMoment, TimelineCommand, TimelineView};
use crate::files::tool_library::ToolMinutes;
use crate::input_watch::InputWatch;
use crate::job::SelectedJob;
use crate::kernel::pace::RunSpeed;
use crate::network::class::seat_request::SeatRequest;
use crate::network::{NetworkSettings, NetworkStates};
use crate::platform;

/// The setup of the current control, with which a program is previewed.
#[derive(Clone, Debug)]
pub struct PreviewSetup {
    pub setup: Setup,
    /// Whether it is that of a practice machine, whose part belongs to its lesson or exercise.
    pub is_practice: bool,
    /// Whether a program runs, or is held: its own G50 changes the work zero.
    pub is_running: bool,
    /// Distance from the machine coordinates of the control to the position of the slides, mm; not
    /// zero before the machine zero return.
    pub slide_shift: Point,
}

/// A command that the window sends to the kernel thread.
#[derive(Clone, Debug)]
pub enum Command {
    /// Press or release a key of the panel.
    Key {
        key: Key,
        /// True if the key goes down, false if it comes up.
        down: bool,
    },
    /// Press a key and release it.
    Tap(Key),
    /// Type a character that has no key on the panel.
    Type(char),
    /// Explain a state: the chain of causes follows as a notice.
    Explain(CauseSubject),
    /// Turn the handwheel by this number of detents.
    Turn(i32),
    /// Open a program read from a file.
    Open(Box<OpenedProgram>),
    /// Open a sample. The simulated lathe is prepared for it: no crash, no alarm, slides at their
    /// start, new stock; `starts`: 自动 and cycle start are pressed. With a pulse board the
    /// program is opened only.
    OpenSample {
        /// The sample program to open.
        program: Box<OpenedProgram>,
        /// Whether the sample is started immediately.
        starts: bool,
    },
    /// Pass a file to the control through its serial port.
    Receive(Box<SerialFile>),
    /// Report to the control that the partner could not take the file that it has sent.
    TransferFailed,
    /// Fit the graphic page to the range of the opened program's cuts.
    FitGraphic {
        /// Corner with the least coordinates, mm, X as a radius.
        least: Point,
        /// Corner with the greatest coordinates, mm, X as a radius.
        greatest: Point,
    },
    /// Start to take samples for the scope with these settings; `None` stops the sampling.
    Probe(Option<Probe>),
    /// Publish the state of machine and PLC (true), or stop publishing it.
    Monitor(bool),
    /// Set (true) or clear (false) a fault of the lathe.
    Fault(LatheFault, bool),
    /// Send a request to the control; a refusal becomes a notice.
    Request(Box<ControlRequest>),
    /// Write parameters, pitch errors, offsets and variables, all or none; a refusal
    /// becomes a notice.
    Write(Vec<ControlRequest>),
    /// Plug a U disk with these files into the control.
    PlugUdisk(Vec<UdiskFile>),
    /// Switch the control off and on again.
    PowerCycle,
    /// Force a machine input to a value; `None` returns it to its sensor.
    ForceInput(BitAddress, Option<bool>),
    /// Release every forced bit of the PLC.
    ReleaseForcedBits,
    /// Clear every fault of the lathe and return every input to its sensor.
    ClearFaults,
    /// Clear the faults that a crash has set, and press RESET.
    FreeLathe,
    /// Set the speed at which programs run, unless a board moves real slides.
    Speed(RunSpeed),
    /// Start, control or end a lesson.
    Lesson(LessonAction),
    /// Start an exercise or hand it in.
    Exercise(ExerciseAction),
    /// Reconnect, set up or check the pulse board.
    Link(LinkAction),
    /// Publish the LCD in the other language, too (true), or stop publishing it.
    Translate(bool),
    /// Publish the motion for the sound of the machine (true), or stop publishing it.
    PublishMotion(bool),
    /// Publish the state of the pulse board (true), or stop publishing it.
    WatchLink(bool),
    /// Store a text as a program of the memory; the channel receives its number or why it
    /// is not stored.
    Store(String, Sender<Result<u16, NotStored>>),
    /// Send once the setup for a preview of the current control.
    SendSetup(Sender<Box<PreviewSetup>>),
    /// Send once the content of the control and the current operation level.
    SendState(Sender<Box<(ProjectState, OperationLevel)>>),
    /// Send once a copy of control and simulated lathe, and of the part in it.
    SendMachine(Sender<Box<MachineCopy>>),
    /// Set the job of the part in the simulated lathe, on fresh stock; `None` removes the
    /// part.
    Job(Option<Box<SelectedJob>>),
    /// Put the tools of a job with the same stock and place into the tool post; the part is
    /// kept.
    Tools(Box<SelectedJob>),
    /// Clamp uncut stock in the chuck.
    FreshStock,
    /// Set whether the simulated lathe stops at a collision.
    CrashStops(bool),
    /// Set whether a cut above the limits breaks insert, spindle or clamping of the simulated
    /// lathe.
    Overload(bool),
    /// Publish, show or change the time line of the session.
    Timeline(TimelineCommand),
    /// Set the breakpoints, or end the halt at one of them.
    Breakpoints(BreakpointCommand),
    /// Publish these values with the snapshots.
    Watch(Vec<WatchTarget>),
    /// Switch services of the network on and off; names in discovery topics have this language.
    Network(Box<NetworkSettings>, Language),
    /// Answer the instructor of the class, ask for help or hand a result in.
    Seat(SeatAction),
    /// Publish the part with the snapshots (true), or stop publishing it. The part is cut in either
    /// case.
    ShowPart(bool),
    /// Prove that the window is alive, so that held keys stay down.
    Alive,
    /// Release all keys of the panel.
    ReleaseAll,
    Quit,
}

/// A copy of control and simulated lathe, and the part in it; `None` without a job.
pub type MachineCopy = (Simulation, Option<LivePart>);

/// A command of the window for the pulse board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkAction {
    /// Close the port of the board and open it again.
    Reconnect,
    /// Write the required values of the settings that differ into the board.
    WriteSettings,
    /// Compare the board's count with the commanded pulses at once.
    Check,
}

/// What the kernel does with an opened program if another program in memory has its number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StorePolicy {
    /// Query the operator and do not open the program yet.
    #[default]
    AskOperator,
    /// Replace the stored program that has the same number.
    Replace,
    /// Run the opened program without storing it.
    RunOnly,
}

/// A program read from a file, ready to be opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenedProgram {
    /// Name of the program as the window shows it.
    pub name: String,
    /// Path of the program file; `None` for a sample.
    pub path: Option<PathBuf>,
    /// What to do if a stored program has the same number.
    pub store_policy: StorePolicy,
    pub program: Program,
    /// Subprograms from the folder of the program file.
    pub subprograms: Vec<Program>,
}

/// The location where the kernel has stored an opened program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProgramPlacement {
    /// The program is stored in memory under this number.
    Stored(u16),
    /// Outside the memory, because the memory does not store it for this reason. The program can be
    /// run and read, but not edited, and it is lost at power-off.
    OnlyRun(NotStored),
}

/// The reason why an opened program is not stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotStored {
    /// Neither the program nor its file name has a number.
    NoNumber,
    /// Another stored program has this number and is kept.
    NumberTaken(u16),
    /// The program switch, a program lock or the operation level forbids it; the payload names
    /// which.
    Refused(WriteRefusal),
    /// The program memory refuses the program with this alarm.
    Alarm(Alarm),
}

/// A report of the kernel to the window, besides snapshots; no notice is lost while the window
/// reads them.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// A program was opened; the values are its name, file and storage.
    Opened {
        /// Name of the opened program.
        name: String,
        /// Path of the opened file; `None` for a sample.
        path: Option<PathBuf>,
        /// Whether the program is stored in memory, and under which number.
        placement: ProgramPlacement,
    },
    /// The program was not opened because another program in the memory has this number.
    NumberTaken(Box<OpenedProgram>, u16),
    /// A file that the control has sent was written at this path.
    Sent(String),
    /// A message that the window shows to the operator.
    Message(Message),
    /// A tool has collided; the message describes the collision.
    Collided(Message),
    /// Tools of the tool library have cut: the window adds the minutes to their lives.
    ToolsHaveCut(Vec<ToolMinutes>),
    /// New stock was clamped, so that earlier collisions are obsolete.
    FreshStock,
    /// A program has run to its end; the values are the program and the parts counted so far.
    ProgramEnded(ProgramId, u32),
    /// The control has refused a request with this alarm.
    Refused(Alarm),
    /// The preview of an opened program is finished; the values are its file name and the summary.
    Previewed(String, Box<ProgramSummary>),
    /// The instructor of the class offers an exercise or an exam, or ends an exam: the window asks
    /// the learner, or answers.
    TaskOffered(Box<SeatRequest>),
    /// The learner has handed in, or the time of his exercise is over.
    HandedIn(Box<HandedInSolution>),
    /// The reason why a key has no effect; `None` once a key acts again. The key is `None` for a
    /// typed character.
    KeyRefusal(Option<(Option<Key>, Message)>),
    /// The chain of causes that the window has requested.
    Explained(Box<CauseChain>),
}

/// The state of the panel at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelSnapshot {
    /// Text that the LCD shows.
    pub screen: Screen,
    /// The LCD in the other language; `None` unless the window has requested it.
    pub translated: Option<Box<Screen>>,
    /// The page that the LCD shows.
    pub page: PageId,
    /// Axes whose keys act in the reverse direction.
    pub keys_reversed: KeysReversed,
    pub model: ModelId,
    /// Brightness of the LCD, 0 (darkest) to 15.
    pub brightness: u8,
    /// The Y memory of the PLC, which holds the lamps.
    pub y_memory: [u8; 20],
    /// Keys that are down, including the latched emergency stop.
    pub pressed: Vec<Key>,
    /// Position of the handwheel, in detents.
    pub wheel: i32,
    /// Machine time divided by wall time at the speed of a real lathe, %; 100 unless the
    /// computer is too slow.
    pub speed_percent: u32,
    /// The speed that the operator has selected for programs.
    pub speed: RunSpeed,
    /// Machine time divided by wall time; `None` while the control runs at the speed of a real
    /// lathe.
    pub speed_ratio: Option<SpeedRatio>,
    /// Numbers of forced PLC bits, forced inputs and active faults.
    pub forced: ForcedState,
    /// The newest active alarm, or the first message of the ladder; `None` without either.
    pub alarm: Option<Alarm>,
    /// Whether the slides of a pulse board need a reference return.
    pub position_unknown: bool,
    /// State of the pulse board that moves real slides; `None` if the lathe is simulated.
    pub board: Option<LinkState>,
    /// Whether a program runs or is held.
    pub run_state: RunState,
    /// The block that is being executed; `None` without one.
    pub running_block: Option<SourcePosition>,
    /// The breakpoint at which machine time is halted; `None` while it runs.
    pub halt: Option<BreakpointHalt>,
    /// The watched values, in the order of [`Command::Watch`].
    pub watches: Vec<WatchReading>,
    /// The condition for which the running program waits; `None` unless that takes longer than
    /// usual.
    pub program_wait: Option<ProgramWait>,
    /// The distance of the slides from the last start of the selected program, if its G50 would now
    /// take another start point; `None` otherwise.
    pub start_distance: Option<StartDistance>,
    /// Whether the slides are away from the last start in whatever mode.
    pub is_away_from_start: bool,
    /// The block at which the selected program would continue after a RESET in the middle; `None`
    /// otherwise.
    pub resumes_at: Option<SourcePosition>,
    /// Whether the program waits in automatic mode with the cursor after its last block.
    pub waits_at_end: bool,
    /// The sentence about the crash or the cut that has stopped the lathe, until the lathe is free; `None`
    /// without one, or if its faults are hidden.
    pub crash: Option<Message>,
    /// Whether a slide or the spindle moves.
    pub is_moving: bool,
    /// The selected program; `None` if none is selected.
    pub program: Option<ProgramId>,
    /// The current lesson, whose practice machine the snapshot shows; `None` outside lessons.
    pub lesson: Option<LessonState>,
    /// The current exercise, whose machine the snapshot shows; `None` outside exercises.
    pub exercise: Option<ExerciseState>,
    /// Whether the learner asks the instructor of his class for help; `None` outside a class.
    pub asks_help: Option<bool>,
    /// The alarms raised since the control was opened, the newest first.
    pub alarm_records: Arc<Vec<AlarmRecord>>,
    /// The past moment that the snapshot shows; `None` for the present.
    pub past: Option<PastMoment>,
    /// Motion of slides and spindle; `None` unless the window plays the sound of the machine.
    pub motion: Option<MachineMotion>,
}

impl PanelSnapshot {
    /// Whether the machine of a lesson or an exercise replaces the learner's own one.
    pub const fn is_at_practice_machine(&self) -> bool {
        self.lesson.is_some() || self.exercise.is_some()
    }
}

/// Position and speed of slides and spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MachineMotion {
    /// Position of the slides, mm (X as a radius).
    pub slides: Point,
    /// Absolute speed of the spindle, r/min, rounded so that snapshots do not change
    /// needlessly.
    pub spindle_rpm: f64,
}

/// Whether the axis keys move the slides in the opposite direction from a lathe with its
/// chuck on the left and its tool post in front.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KeysReversed {
    /// True if the upper axis key is X+ (parameter 175.0).
    pub x: bool,
    /// True if the left axis key is Z+ (parameter 175.1).
    pub z: bool,
}

/// Machine time divided by wall time, rounded so that snapshots do not change needlessly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedRatio(pub f64);

/// Numbers of the bits, inputs and faults that views have forced on control and lathe. They remain
/// forced until they are released, also when the view is closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ForcedState {
    /// Number of PLC bits that are forced.
    pub forced_bits: usize,
    /// Number of machine inputs that are forced.
    pub forced_inputs: usize,
    /// Number of active lathe faults.
    pub faults: usize,
}

/// The window's ends of the channels to the kernel.
#[derive(Clone, Debug)]
pub struct Console {
    /// The control model of the kernel.
    pub model: ModelId,
    /// The channel that sends commands to the kernel.
    pub commands: Sender<Command>,
    /// Queue with the newest snapshot of the panel.
    pub snapshots: Arc<ArrayQueue<PanelSnapshot>>,
    /// Queue with the newest state of machine and PLC, while the window has requested it.
    pub machine: Arc<ArrayQueue<MachineView>>,
    /// Queue with the newest state of the pulse board, while the window has requested it.
    pub link: Arc<ArrayQueue<LinkView>>,
    /// Queue with the newest state of the part, while there is a job.
    pub part: Arc<ArrayQueue<Arc<PartView>>>,
    /// Queue with the newest state of the time line, while the window has requested it.
    pub timeline: Arc<ArrayQueue<Arc<TimelineView>>>,
    /// The channel that receives the notices of the kernel.
    pub notices: Receiver<Notice>,
    /// Sender for helper threads, whose notices are received from `notices`, too.
    pub notice_sender: Sender<Notice>,
    /// Shows the kernel whether keys that are down are still held.
    pub input_watch: InputWatch,
    /// The states of the services of the network.
    pub network: NetworkStates,
}

impl Console {
    /// How the control model writes the names of programs.
    pub fn naming(&self) -> ProgramNaming {
        self.model.record().program_naming()
    }

    /// Sends a command without waiting; a full queue or an ended kernel drops it.
    pub fn send(&self, command: Command) {
        // A full queue means that the kernel has not run for a thousand commands: one more
        // would not help, and the window must not wait.
        let _ = self.commands.try_send(command);
    }

    /// Returns the setup for a preview of the current control; `None` if the kernel does
    /// not answer within 5 s. It blocks: call it from helper threads only.
    pub fn setup(&self) -> Option<Setup> {
        self.preview_setup().map(|it| it.setup)
    }

    /// Returns the setup as [`Self::setup`] does, and whether it is that of a practice machine.
    pub fn preview_setup(&self) -> Option<PreviewSetup> {
        const ANSWER_TIMEOUT: Duration = Duration::from_secs(5);
        let (to, answer) = bounded(1);
        self.commands.send(Command::SendSetup(to)).ok()?;
        platform::wait_for_answer(&answer, ANSWER_TIMEOUT).map(|setup| *setup)
    }

    /// Returns the content of the control and the current operation level; `None` if the kernel
    /// does not answer within 5 s. It blocks, as [`Self::setup`] does.
    pub fn state(&self) -> Option<(ProjectState, OperationLevel)> {
        const ANSWER_TIMEOUT: Duration = Duration::from_secs(5);
        let (to, answer) = bounded(1);
        self.commands.send(Command::SendState(to)).ok()?;
        platform::wait_for_answer(&answer, ANSWER_TIMEOUT).map(|state| *state)
    }

    /// Returns a copy of the machine with its part; `None` if the kernel does not answer within
    /// 5 s. It blocks, as [`Self::setup`] does.
    pub fn machine_copy(&self) -> Option<Box<MachineCopy>> {
        const ANSWER_TIMEOUT: Duration = Duration::from_secs(5);
        let (to, answer) = bounded(1);
        self.commands.send(Command::SendMachine(to)).ok()?;
        platform::wait_for_answer(&answer, ANSWER_TIMEOUT)
    }

    /// Stores a text as a program of the memory and selects it; returns its number, or why it is
    /// not stored. `None` if the kernel does not answer within 5 s. It blocks, as [`Self::setup`]
    /// does.
    pub fn store(&self, text: String) -> Option<Result<u16, NotStored>> {
        const ANSWER_TIMEOUT: Duration = Duration::from_secs(5);
        let (to, answer) = bounded(1);
        self.commands.send(Command::Store(text, to)).ok()?;
        platform::wait_for_answer(&answer, ANSWER_TIMEOUT)
    }
}
