//! The kernel: owns the emulator, carries out what the window asks for, hands
//! out pictures. The same code runs in its thread and, step by step, in a test.

mod drive;
mod edges;
mod journal;
pub mod link_view;
mod linked;
pub mod live;
pub mod monitor;
mod opening;
pub mod part;
pub mod probe;
mod refused;
mod standing;
mod thread;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::{Receiver, Sender, bounded};
use crossbeam::queue::ArrayQueue;
use gsk_core::alarm::Alarm;
use gsk_core::cnc::{Event, Request};
use gsk_core::machine::Fault;
use gsk_core::operation::{Mode, RunState};
use gsk_core::plc::address::BitAddress;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_link::LinkState;
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_panel::panel::{KeyEvent, SerialFile};
use gsk_panel::refusal::Press;
use gsk_panel::screen::Screen;
use gsk_runner::first_look::FirstLook;
use gsk_runner::partner::{Partner as _, Patience};

use crate::dnc::{Partner, Source};
use crate::job::Chosen;
use crate::pace::Speed;
pub use drive::Connection;
use drive::Drive;
use edges::{Edge, Edges};
use link_view::LinkView;
use monitor::MachineView;
use opening::LastOpened;
pub use opening::{NotStored, Place};
use part::{PartSide, PartView};
use probe::{Probe, Probing};
use refused::{Refusals, Verdict};
pub use thread::{KernelThread, Outside, start};

/// Ticks between two pictures.
pub const PICTURE_TICKS: u64 = 25;
/// Ticks between two looks at machine and PLC, for the views that show them.
const MACHINE_TICKS: u64 = 50;
/// Commands that wait for the kernel.
const QUEUE: usize = 1024;

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
    /// Switch the control off and on again.
    PowerCycle,
    /// Hold a machine input at a value, or give it back to its sensor.
    ForceInput(BitAddress, Option<bool>),
    /// Let every forced bit of the PLC go.
    FreeBits,
    /// Mend every fault and give every input back to its sensor.
    Mend,
    /// Run programs at this speed from now on, while no board moves real slides.
    Speed(Speed),
    /// Do something with the pulse board.
    Link(LinkOrder),
    /// Hand out the state of the pulse board, or no more.
    WatchLink(bool),
    /// Store a text as a program of the memory, and say what came of it.
    Store(String, Sender<Result<u16, NotStored>>),
    /// Hand out once what a preview of the control as it stands starts from.
    HandOut(Sender<Box<Setup>>),
    /// The job of the part in the simulated lathe, on fresh stock; none: there is none.
    Job(Option<Box<Chosen>>),
    /// New stock is clamped.
    FreshStock,
    /// Whether the simulated lathe stops where a tool hits something.
    CrashStops(bool),
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
        answer.recv_timeout(LONGEST).ok().map(|setup| *setup)
    }

    /// Stores a text as a program of the memory and selects it; `None` where the kernel
    /// gives no answer. It waits, as [`Self::setup`] does.
    pub fn store(&self, text: String) -> Option<Result<u16, NotStored>> {
        const LONGEST: Duration = Duration::from_secs(5);
        let (to, answer) = bounded(1);
        self.commands.send(Command::Store(text, to)).ok()?;
        answer.recv_timeout(LONGEST).ok()
    }
}

/// What was handed out of machine and PLC.
#[derive(Debug, Default)]
struct Monitored {
    last: Option<MachineView>,
    /// When to look again, ticks.
    next: u64,
}

/// The kernel.
#[derive(Debug)]
pub struct Kernel {
    emulator: Emulator,
    commands: Receiver<Command>,
    pictures: Arc<ArrayQueue<Snapshot>>,
    machine: Arc<ArrayQueue<MachineView>>,
    /// Only while somebody asks for machine and PLC.
    monitored: Option<Monitored>,
    /// A board that moves the slides.
    drive: Option<Drive>,
    /// Sends programs in DNC operation.
    partner: Option<Partner>,
    links: Arc<ArrayQueue<LinkView>>,
    link_watched: bool,
    /// The program that was opened last.
    opened: Option<LastOpened>,
    notices: Sender<Notice>,
    /// Keys that are down, and what happened to others.
    keys: Edges,
    refusals: Refusals,
    tick: u64,
    last: Option<Snapshot>,
    speed_percent: u32,
    speed: Speed,
    times: Option<Times>,
    /// Only while a scope is open.
    probing: Option<Probing>,
    /// The part that is cut.
    part: PartSide,
    quit: bool,
}

impl Kernel {
    /// A kernel and the console that goes with it.
    pub fn new(emulator: Emulator) -> (Self, Console) {
        let (commands, from_window) = bounded(QUEUE);
        let (notices, from_kernel) = bounded(QUEUE);
        let pictures = Arc::new(ArrayQueue::new(1));
        let machine = Arc::new(ArrayQueue::new(1));
        let links = Arc::new(ArrayQueue::new(1));
        let part = Arc::new(ArrayQueue::new(1));
        let kernel = Self {
            emulator,
            commands: from_window,
            pictures: Arc::clone(&pictures),
            machine: Arc::clone(&machine),
            monitored: None,
            drive: None,
            partner: None,
            links: Arc::clone(&links),
            link_watched: false,
            opened: None,
            notices: notices.clone(),
            keys: Edges::default(),
            refusals: Refusals::default(),
            tick: 0,
            last: None,
            speed_percent: 100,
            speed: Speed::REAL,
            times: None,
            probing: None,
            part: PartSide::new(Arc::clone(&part)),
            quit: false,
        };
        (
            kernel,
            Console {
                commands,
                pictures,
                machine,
                link: links,
                part,
                notices: from_kernel,
                say: notices,
            },
        )
    }

    /// Who sends programs in DNC operation.
    pub fn take_programs_from(&mut self, source: Source) {
        self.partner = Some(Partner::new(source));
    }

    /// The emulator.
    pub const fn emulator(&self) -> &Emulator {
        &self.emulator
    }

    /// The speed in force: only a program that runs by itself on the simulated lathe is
    /// faster or slower than a real one (decision WINDOW-9).
    pub fn speed(&self) -> Speed {
        let runs = self.emulator.simulation.cnc.run_state() == RunState::Run;
        match runs && self.drive.is_none() {
            true => self.speed,
            false => Speed::REAL,
        }
    }

    /// Takes what the window asked for and runs so many ticks.
    pub fn run(&mut self, ticks: u64) {
        self.take_commands();
        for _ in 0..ticks {
            self.tick();
        }
    }

    fn take_commands(&mut self) {
        while let Ok(command) = self.commands.try_recv() {
            self.carry_out(command);
        }
    }

    fn tick(&mut self) {
        for event in self.keys.due(self.tick) {
            self.hand_over(event);
        }
        if let Some(partner) = &mut self.partner {
            partner.feed(&mut self.emulator.simulation.cnc, Patience::None);
        }
        self.emulator.tick();
        self.tick += 1;
        for event in self.emulator.simulation.cnc.events() {
            if let Event::Advised(text) = event {
                self.say(Notice::Said(text.clone()));
            }
        }
        let verdict = self
            .refusals
            .judge(self.tick, &self.emulator.simulation.cnc);
        self.tell(verdict);
        if let Some(probing) = &mut self.probing {
            probing.take(self.tick, &self.emulator);
        }
        let simulated = self.drive.is_none();
        let simulation = &mut self.emulator.simulation;
        if let Some(finding) = self.part.ticked(simulation, simulated) {
            let collision = finding.collision;
            let (x, z) = (collision.tip.diameter().0, collision.tip.z);
            let what = collision.message();
            self.say(Notice::Said(say::window_collision(what, x, z)));
        }
    }

    /// Puts out a picture if anything has changed since the last one.
    pub fn show(&mut self) -> bool {
        let part_shown = self.part.show(&self.emulator.simulation);
        let monitored = self.show_machine() || part_shown;
        let snapshot = self.snapshot();
        if self.last.as_ref() == Some(&snapshot) {
            return monitored;
        }
        self.pictures.force_push(snapshot.clone());
        self.last = Some(snapshot);
        true
    }

    /// Puts out machine and PLC if somebody asks for them and they have changed.
    fn show_machine(&mut self) -> bool {
        let Some(monitored) = &mut self.monitored else {
            return false;
        };
        if self.tick < monitored.next {
            return false;
        }
        monitored.next = self.tick + MACHINE_TICKS;
        let now = MachineView::of(&self.emulator);
        if monitored.last.as_ref() == Some(&now) {
            return false;
        }
        self.machine.force_push(now.clone());
        monitored.last = Some(now);
        true
    }

    /// The panel as it is now.
    pub fn snapshot(&self) -> Snapshot {
        let panel = &self.emulator.panel;
        Snapshot {
            screen: self.emulator.screen(),
            brightness: panel.view().brightness,
            y: self.emulator.lamps(),
            pressed: panel.pressed(),
            wheel: panel.wheel(),
            speed_percent: self.speed_percent,
            speed: self.speed,
            times: self.times,
            alarm: self.standing_alarm(),
            place_unknown: self.emulator.simulation.cnc.is_position_unknown(),
            board: self.drive.as_ref().map(Drive::state),
            run: self.emulator.simulation.cnc.run_state(),
            imposed: Imposed {
                bits: self.emulator.simulation.cnc.plc().forces().len(),
                inputs: self.emulator.simulation.lathe.forced_inputs(),
                faults: self.emulator.simulation.lathe.faults(),
            },
        }
    }

    fn carry_out(&mut self, command: Command) {
        match command {
            // It waits for nothing.
            Command::Key {
                key: Key::EmergencyStop,
                down: true,
            }
            | Command::Tap(Key::EmergencyStop) => {
                self.emulator.key_down(Key::EmergencyStop);
            }
            Command::Key { key, down: true } => self.keys.push(Edge::Down(key)),
            Command::Key { key, down: false } => self.keys.push(Edge::Up(key)),
            Command::Tap(key) => self.keys.push(Edge::Tap(key)),
            Command::Type(character) => self.keys.push(Edge::Type(character)),
            Command::Turn(detents) => self.turn(detents),
            Command::Open(opened) => self.open(*opened),
            Command::Receive(file) => {
                if let Err(refused) = self.emulator.receive(*file) {
                    self.say(Notice::Said(refused.message()));
                }
            }
            Command::TransferFailed => self.emulator.panel.transfer_failed(),
            Command::Fit { least, greatest } => self.emulator.fit_graphic(least, greatest),
            Command::Probe(None) => self.probing = None,
            Command::Probe(Some(probe)) => match &mut self.probing {
                Some(probing) => probing.exchange(probe),
                None => self.probing = Some(Probing::new(probe)),
            },
            Command::Monitor(on) => self.monitored = on.then(Monitored::default),
            Command::Fault(fault, on) => self.emulator.simulation.lathe.set_fault(fault, on),
            Command::Ask(request) => {
                if let Err(alarm) = self.emulator.simulation.cnc.request(*request) {
                    self.say(Notice::Refused(alarm));
                }
            }
            Command::Job(chosen) => self.part.set(chosen.map(|chosen| *chosen)),
            Command::FreshStock => self.part.fresh_stock(),
            Command::CrashStops(stops) => self.part.set_crash_stops(stops),
            Command::PowerCycle => self.emulator.power_cycle(),
            Command::ForceInput(address, state) => {
                self.emulator.simulation.lathe.force_input(address, state);
            }
            Command::FreeBits => {
                let forces = self.emulator.simulation.cnc.plc().forces().to_vec();
                for force in forces {
                    self.carry_out(Command::Ask(Box::new(Request::ForceBit(force.bit, None))));
                }
            }
            Command::Speed(speed) => self.speed = speed,
            Command::Mend => self.emulator.simulation.lathe.mend(),
            Command::Link(order) => self.order(order),
            Command::WatchLink(on) => {
                self.link_watched = on;
                if let Some(drive) = &mut self.drive {
                    drive.watch(on);
                }
            }
            Command::Store(text, to) => {
                let _ = to.try_send(self.store(&Program::new(text)));
            }
            Command::HandOut(to) => {
                // Who asked may have gone.
                let _ = to.try_send(Box::new(standing::setup(&self.emulator)));
            }
            Command::ReleaseAll => self.release_all(),
            Command::Alive => {}
            Command::Quit => self.quit = true,
        }
    }

    /// Turns the handwheel; in step mode it moves nothing and says why.
    fn turn(&mut self, detents: i32) {
        self.emulator.turn(detents);
        let cnc = &self.emulator.simulation.cnc;
        // An alarm says more.
        if cnc.mode().motion() == Mode::Step && cnc.alarms().is_empty() {
            self.say(Notice::Said(say::key_handwheel_in_step_mode()));
        }
    }

    /// Gives the panel what a key or a typed character did.
    fn hand_over(&mut self, event: KeyEvent) {
        let pressed = match event {
            KeyEvent::Down(key) => Some(Press::new(key, &self.emulator.simulation.cnc)),
            KeyEvent::Type(_) => Some(None),
            _ => None,
        };
        let refused = self.emulator.key(event);
        if let Some(press) = pressed {
            let verdict = self.refusals.pressed(press, refused, self.tick);
            self.tell(verdict);
        }
    }

    /// Says why a key does nothing, or that one acts again.
    fn tell(&self, verdict: Option<Verdict>) {
        match verdict {
            Some(Verdict::Refused(why)) => self.say(Notice::Key(Some(why))),
            Some(Verdict::Acts) => self.say(Notice::Key(None)),
            None => {}
        }
    }

    fn standing_alarm(&self) -> Option<Alarm> {
        let cnc = &self.emulator.simulation.cnc;
        let alarm = cnc.alarms().first().cloned();
        alarm.or_else(|| cnc.standing_message())
    }

    fn release_all(&mut self) {
        self.keys.clear();
        self.emulator.key(KeyEvent::ReleaseAll);
    }

    fn say(&self, notice: Notice) {
        // The window reads them with every picture; a thousand unread ones mean
        // that it is gone.
        let _ = self.notices.try_send(notice);
    }
}
