//! The kernel: owns the emulator, executes the window's commands and publishes snapshots. The same
//! code runs in its thread and, step by step, in a test.

mod alarm_history;
mod class_seat;
mod commands;
mod console;
mod drive;
mod edges;
mod exercise;
mod exercise_run;
mod flight_recording;
mod handwheel_run;
pub mod headless_board;
mod journal;
mod key_refusals;
mod lesson;
pub mod link_view;
mod linked;
pub mod monitor;
pub mod pace;
pub mod part;
mod practice_session;
pub mod probe;
mod program;
mod publishing;
mod thread;
pub mod timeline;

use std::sync::Arc;

use crossbeam::channel::{Receiver, Sender, bounded};
use crossbeam::queue::ArrayQueue;
use gsk_core::alarm::Alarm;
use gsk_core::cnc::{Cnc, ControlRequest, Event};
use gsk_core::operation::{OperatingMode, RunState};
use gsk_debugger::watch::WatchTarget;
use gsk_history::board_exchange::StampedStep;
use gsk_messages::{Language, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::{KeyEvent, SerialCable};
use gsk_panel::refusal::KeyPress;
use gsk_panel::why::BitLog;
use gsk_runner::machining::Machining;
use gsk_runner::partner::{PartnerWait, ProgramPartner as _};
use web_time::Duration;

use crate::flight::FlightRecorder;
use crate::input_watch::InputWatch;
use crate::kernel::pace::RunSpeed;
use crate::network::{NetworkServices, NetworkSettings};
use crate::ports::dnc::{DncPartner, DncSource};
use crate::serial::SerialLine;
use alarm_history::AlarmHistory;
use class_seat::ClassSeatState;
pub use class_seat::SeatAction;
pub use console::{
    Command, Console, ForcedState, KeysReversed, LinkAction, MachineMotion, NotStored, Notice,
    OpenedProgram, PanelSnapshot, PreviewSetup, ProgramPlacement, SpeedRatio, StorePolicy,
};
pub use drive::BoardConnection;
use drive::Drive;
use edges::KeyEdgeQueue;
pub use exercise::ExerciseAction;
pub use exercise_run::{ExamTask, ExerciseState, HandedInSolution};
use handwheel_run::HandwheelRun;
use key_refusals::{KeyRefusals, RefusalReport};
pub use lesson::LessonAction;
use link_view::LinkView;
use monitor::MachineView;
use part::KernelPart;
pub use practice_session::LessonState;
use practice_session::PracticeSession;
use probe::ActiveProbe;
use program::breakpoints::ProgramBreakpoints;
pub use program::breakpoints::{BreakpointCommand, BreakpointHalt};
use program::opening::LastOpened;
pub use program::start::StartDistance;
use program::start::StartWatch;
use program::wait::WaitWatch;
pub use program::watches::WatchReading;
pub use thread::{KernelEnvironment, KernelThread, start};
use timeline::{Timeline, TimelineMarkKind};

/// Ticks of 1 ms between two snapshots.
pub const SNAPSHOT_TICKS: u64 = 25;
/// Ticks of 1 ms between two views of machine and PLC, while the window shows them.
const MACHINE_VIEW_TICKS: u64 = 50;
/// Ticks of 1 ms between two checks of the bits of the PLC: a slot of the ladder.
const BIT_LOG_TICKS: u64 = 8;
/// Ticks between two reports of the time in the material of the tools.
const TOOL_LIFE_TICKS: u64 = 10_000;
/// Time without a turn after which a handwheel counts as at rest.
const WHEEL_REST_TIME: Duration = Duration::from_millis(300);
/// Capacity of the command queue and of the notice queue, entries.
const QUEUE_CAPACITY: usize = 1024;

/// The last published state of machine and PLC, and the tick of the next publication.
#[derive(Debug, Default)]
struct MachineMonitor {
    last_view: Option<MachineView>,
    /// Tick at which the next view of machine and PLC is published.
    next_tick: u64,
}

/// Runs the control and executes the commands of the window.
#[derive(Debug)]
pub struct Kernel {
    emulator: Emulator,
    commands: Receiver<Command>,
    snapshots: Arc<ArrayQueue<PanelSnapshot>>,
    machine: Arc<ArrayQueue<MachineView>>,
    /// State of the publication of machine and PLC; `None` while no view shows them.
    machine_monitor: Option<MachineMonitor>,
    /// The board that moves real slides; `None` if none is connected.
    drive: Option<Drive>,
    /// Whether a board is connected, also while [`Self::run_linked`] holds its drive.
    has_real_slides: bool,
    /// The partner that sends programs in DNC operation; `None` without a source.
    partner: Option<DncPartner>,
    /// The control's serial port, connected to a port of the computer; `None` if it is not
    /// connected.
    serial: Option<SerialLine>,
    links: Arc<ArrayQueue<LinkView>>,
    link_watched: bool,
    /// Whether snapshots contain the LCD in the other language, too.
    translate_screen: bool,
    /// Whether snapshots contain the motion of slides and spindle, for the sound of the machine.
    publish_motion: bool,
    /// The current lesson, in which a practice machine replaces the learner's own machine; `None`
    /// outside lessons.
    lesson: Option<PracticeSession>,
    /// The alarms raised since the control was opened.
    alarm_history: AlarmHistory,
    /// The program that was opened last from a file; `None` before the first one.
    last_opened: Option<LastOpened>,
    notices: Sender<Notice>,
    /// Key events that wait for their tick, and the keys that are down.
    key_edges: KeyEdgeQueue,
    key_refusals: KeyRefusals,
    /// Records when bits of the PLC change.
    bit_log: BitLog,
    wait_watch: WaitWatch,
    start_watch: StartWatch,
    program_breakpoints: ProgramBreakpoints,
    watches: Vec<WatchTarget>,
    tick: u64,
    last_snapshot: Option<PanelSnapshot>,
    speed_percent: u32,
    speed: RunSpeed,
    speed_ratio: Option<SpeedRatio>,
    /// The sampling for the scope; `None` while no scope is open.
    active_probe: Option<ActiveProbe>,
    /// The part in the lathe, with its job.
    part: KernelPart,
    /// The history of the learner's own machine, and the past moment that is shown.
    timeline: Timeline,
    /// Whether and how far the program follows the handwheel.
    handwheel_run: HandwheelRun,
    /// The recorders of the learner's own machine, outside exercises and lessons.
    recorders: Vec<FlightRecorder>,
    /// Steps of the exchange with a board that the recorders have not taken yet.
    exchange: Vec<StampedStep>,
    /// What passes the state of the machine to the network; off unless it is switched on.
    network: NetworkServices,
    /// What the class knows of this seat.
    class_seat: ClassSeatState,
    /// Number of commands received so far; an increase proves that the window is alive.
    command_count: u64,
    /// Shows whether keys that are down are still held.
    input_watch: InputWatch,
    /// Time, on the clock that includes sleep, until which handwheel turns are dropped after the
    /// display has hung; each further turn postpones it by `WHEEL_REST_TIME`.
    wheel_rests_until: Duration,
    quit_requested: bool,
}

impl Kernel {
    /// Creates a kernel for an emulator, and the console with the channels between the kernel and
    /// its window.
    pub fn new(mut emulator: Emulator) -> (Self, Console) {
        let (commands, from_window) = bounded(QUEUE_CAPACITY);
        let (notices, from_kernel) = bounded(QUEUE_CAPACITY);
        let snapshots = Arc::new(ArrayQueue::new(1));
        let machine = Arc::new(ArrayQueue::new(1));
        let links = Arc::new(ArrayQueue::new(1));
        let part = Arc::new(ArrayQueue::new(1));
        let timeline = Arc::new(ArrayQueue::new(1));
        emulator.record_inputs();
        let kernel = Self {
            emulator,
            commands: from_window,
            snapshots: Arc::clone(&snapshots),
            machine: Arc::clone(&machine),
            machine_monitor: None,
            drive: None,
            has_real_slides: false,
            partner: None,
            serial: None,
            links: Arc::clone(&links),
            link_watched: false,
            translate_screen: false,
            publish_motion: false,
            lesson: None,
            alarm_history: AlarmHistory::default(),
            last_opened: None,
            notices: notices.clone(),
            key_edges: KeyEdgeQueue::default(),
            key_refusals: KeyRefusals::default(),
            bit_log: BitLog::default(),
            wait_watch: WaitWatch::default(),
            start_watch: StartWatch::default(),
            program_breakpoints: ProgramBreakpoints::default(),
            watches: Vec::new(),
            tick: 0,
            last_snapshot: None,
            speed_percent: 100,
            speed: RunSpeed::REAL,
            speed_ratio: None,
            active_probe: None,
            part: KernelPart::new(Arc::clone(&part)),
            timeline: Timeline::new(Arc::clone(&timeline)),
            handwheel_run: HandwheelRun::default(),
            recorders: Vec::new(),
            exchange: Vec::new(),
            network: NetworkServices::default(),
            class_seat: ClassSeatState::default(),
            command_count: 0,
            input_watch: InputWatch::default(),
            wheel_rests_until: Duration::ZERO,
            quit_requested: false,
        };
        let watch = kernel.input_watch.clone();
        let network = kernel.network.states().clone();
        let model = kernel.emulator.cnc().model().id();
        (
            kernel,
            Console {
                model,
                commands,
                snapshots,
                machine,
                link: links,
                part,
                timeline,
                notices: from_kernel,
                notice_sender: notices,
                input_watch: watch,
                network,
            },
        )
    }

    /// Sets the source of the programs in DNC operation.
    pub fn set_dnc_source(&mut self, source: DncSource) {
        self.partner = Some(DncPartner::new(source));
    }

    /// Connects the control's serial port to a port of the computer.
    pub fn connect_serial_line(&mut self, line: SerialLine) {
        self.emulator.connect_cable(SerialCable::Line);
        self.serial = Some(line);
    }

    /// What passes the state of the machine to the network.
    pub const fn network(&mut self) -> &mut NetworkServices {
        &mut self.network
    }

    /// Switches services of the network on and off, as the settings of the window say.
    pub fn set_network(&mut self, settings: &NetworkSettings, language: Language) {
        let simulation = self.emulator.simulation();
        if self.network.apply(settings, simulation, language) {
            self.begin_class();
        }
    }

    pub const fn emulator(&self) -> &Emulator {
        &self.emulator
    }

    /// Returns the current speed of machine time: the selected one while a program runs
    /// automatically on the simulated lathe, else that of a real lathe (decision WINDOW-9). An
    /// exam has the speed of a real lathe.
    pub fn speed(&self) -> RunSpeed {
        let runs = self.emulator.cnc().run_state() == RunState::Run;
        let is_at_machine = self.timeline.shows_past() || self.is_in_exam();
        match runs && self.drive.is_none() && !is_at_machine {
            true => self.speed,
            false => RunSpeed::REAL,
        }
    }

    /// Executes the window's commands and runs this number of ticks, unless the past is shown.
    pub fn run(&mut self, ticks: u64) {
        self.execute_commands();
        if self.timeline.shows_past() && !self.has_real_slides {
            // The machine stands still while its past is shown.
            return self.advance_past();
        }
        if self.is_exam_paused() {
            return;
        }
        for _ in 0..ticks {
            if self.program_breakpoints.is_halted() || !self.take_handwheel_tick() {
                return;
            }
            self.tick();
        }
    }

    fn execute_commands(&mut self) {
        while let Ok(command) = self.commands.try_recv() {
            self.execute_command(command);
        }
    }

    fn tick(&mut self) {
        for event in self.key_edges.take_due(self.tick) {
            self.pass_key_event(event);
        }
        // The recording of an exercise has only inputs of an operator.
        let is_in_exercise = self.is_in_exercise();
        if let Some(partner) = self.partner.as_mut().filter(|_| !is_in_exercise) {
            partner.send_text(&mut self.emulator, PartnerWait::Forbidden);
        }
        match &mut self.lesson {
            Some(lesson) => lesson.tick(&mut self.emulator),
            None => self.emulator.tick(),
        }
        self.tick += 1;
        let has_collided = self.cut_part();
        self.mark_events();
        self.follow_breakpoints(has_collided);
        self.start_watch.update(self.emulator.cnc());
        if let Some(serial) = &mut self.serial {
            // Files are exchanged with the learner's own machine, also during a lesson.
            let own = match &mut self.lesson {
                Some(lesson) => lesson.own(),
                None => &mut self.emulator,
            };
            for message in serial.tick(own) {
                self.notify(Notice::Message(message));
            }
        }
        self.report_events();
        let verdict = self.key_refusals.check_due(self.tick, self.emulator.cnc());
        self.report_verdict(verdict);
        let now = self.emulator.ticks();
        if now.is_multiple_of(BIT_LOG_TICKS) {
            self.bit_log.follow_tick(self.emulator.cnc(), now);
        }
        let is_published = self.network.follows_ticks();
        self.part.set_measures_load(is_published);
        if is_published {
            let part = self.part.state();
            let job = part.machining().map(Machining::job);
            let load = part.load();
            self.network
                .follow_tick(self.emulator.simulation(), job, load);
        }
        if let Some(probing) = &mut self.active_probe {
            probing.take_sample(self.tick, &self.emulator);
        }
        if self.tick.is_multiple_of(TOOL_LIFE_TICKS) {
            self.report_tool_minutes();
        }
        self.follow_exercise();
        self.follow_with_recorders();
    }

    /// Reports the time in the material of tools from the tool library.
    pub(super) fn report_tool_minutes(&mut self) {
        let spent = self.part.take_tool_minutes();
        if !spent.is_empty() {
            self.notify(Notice::ToolsHaveCut(spent));
        }
    }

    /// Cuts the part after a tick of the machine, before anything else changes the machine: a
    /// replay has the same order. Returns whether the tool has collided, or a cut has broken
    /// something.
    fn cut_part(&mut self) -> bool {
        let simulated = !self.has_real_slides;
        let Some(message) = self.part.after_tick(&mut self.emulator, simulated) else {
            return false;
        };
        self.notify(Notice::Collided(message));
        if self.has_timeline() {
            let tick = self.emulator.ticks();
            self.timeline.marks().add(tick, TimelineMarkKind::Collision);
        }
        true
    }

    /// Collects the alarms and the blocks of a tick. With a board a new alarm ends a look at
    /// the past.
    fn mark_events(&mut self) {
        let is_raised = self.alarm_history.update(&self.emulator);
        if is_raised && self.has_real_slides {
            self.return_to_present();
        }
        if !self.has_timeline() {
            return;
        }
        let tick = self.emulator.ticks();
        let marks = self.timeline.marks();
        if is_raised && let Some(newest) = self.alarm_history.records().first() {
            marks.add(tick, TimelineMarkKind::Alarm(newest.alarm.number));
        }
        let mut events = self.emulator.cnc().events().iter();
        if events.any(|event| matches!(event, Event::BlockStarted(..))) {
            marks.add(tick, TimelineMarkKind::Block);
        }
    }

    /// Turns the handwheel by this number of detents. In step mode nothing moves and a refusal
    /// explains why.
    fn turn_handwheel(&mut self, detents: i32) {
        self.emulator.turn(detents);
        let cnc = self.emulator.cnc();
        // An alarm takes precedence over this notice.
        if cnc.mode().motion_mode() == OperatingMode::Step && cnc.alarms().is_empty() {
            let why = Some(say::key_handwheel_in_step_mode());
            let verdict = self.key_refusals.record_press(None, None, why, self.tick);
            self.report_verdict(verdict);
        }
    }

    /// Passes a key event or a typed character to the panel.
    fn pass_key_event(&mut self, event: KeyEvent) {
        let key = match event {
            KeyEvent::Down(key) => Some(key),
            _ => None,
        };
        let pressed = match event {
            KeyEvent::Down(key) => Some(KeyPress::new(key, self.emulator.cnc())),
            KeyEvent::Type(_) => Some(None),
            _ => None,
        };
        let cnc = self.emulator.cnc();
        let by_exercise = self.emulator.panel().limit_refusal(event, cnc);
        let refused = self.emulator.key(event);
        // The window shows no refusals of keys in an exam, but what its task refuses.
        if let Some(why) = by_exercise.filter(|_| self.is_in_exam()) {
            self.notify(Notice::Message(why));
        }
        if let Some(press) = pressed {
            let verdict = self
                .key_refusals
                .record_press(key, press, refused, self.tick);
            self.report_verdict(verdict);
        }
    }

    /// Notifies the window why a key does nothing, or that a key acts again.
    fn report_verdict(&self, verdict: Option<RefusalReport>) {
        match verdict {
            Some(RefusalReport::Refused(key, why)) => {
                self.notify(Notice::KeyRefusal(Some((key, why))));
            }
            Some(RefusalReport::Obsolete) => self.notify(Notice::KeyRefusal(None)),
            None => {}
        }
    }

    /// Drops what is known of refused keys, because another machine is operated from now on.
    fn clear_key_refusals(&mut self) {
        let verdict = self.key_refusals.clear();
        self.report_verdict(verdict);
    }

    /// Releases every key and drops the handwheel detents that the axis has not followed yet,
    /// because there is no longer proof that the operator is at the machine.
    fn release_keys_and_wheel(&mut self) {
        self.release_all_keys();
        self.drop_wheel();
    }

    fn drop_wheel(&mut self) {
        // This request cannot be refused.
        let _ = self.emulator.request(ControlRequest::DropWheel);
    }

    fn release_all_keys(&mut self) {
        self.key_edges.clear();
        self.emulator.key(KeyEvent::ReleaseAll);
    }

    fn notify(&self, notice: Notice) {
        // The window reads the notices with every snapshot; a thousand unread ones mean
        // that it is gone.
        let _ = self.notices.try_send(notice);
    }
}

fn active_alarm(cnc: &Cnc) -> Option<Alarm> {
    let alarm = cnc.alarms().first().cloned();
    alarm.or_else(|| cnc.active_message())
}
