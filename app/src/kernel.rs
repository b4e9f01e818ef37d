//! The kernel: owns the emulator, carries out the window's commands and publishes
//! snapshots. The same code runs in its thread and, step by step, in a test.

mod console;
mod drive;
mod edges;
mod journal;
mod lesson;
pub mod link_view;
mod linked;
pub mod live;
pub mod monitor;
mod opening;
pub mod part;
pub mod probe;
mod raised;
mod refused;
mod standing;
mod thread;
mod waiting;

use std::sync::Arc;

use crossbeam::channel::{Receiver, Sender, bounded};
use crossbeam::queue::ArrayQueue;
use gsk_core::alarm::Alarm;
use gsk_core::cnc::{Event, Request};
use gsk_core::operation::{Mode, RunState};
use gsk_core::program::Program;
use gsk_core::simulation::Simulation;
use gsk_messages::say;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_panel::panel::KeyEvent;
use gsk_panel::refusal::KeyPress;
use gsk_runner::partner::{Partner as _, Patience};
use web_time::Duration;

use crate::dnc::{Partner, Source};
use crate::input_watch::InputWatch;
use crate::pace::Speed;
use crate::platform;
use crate::retained;
use crate::serial::SerialLine;
pub use console::{
    Command, Console, Imposed, KeysReversed, LinkOrder, Motion, NotStored, Notice, Opened, Place,
    Snapshot, Storing, Times,
};
pub use drive::Connection;
use drive::Drive;
use edges::{Edge, Edges};
use lesson::Practising;
pub use lesson::{LessonOrder, LessonState};
use link_view::LinkView;
use monitor::MachineView;
use opening::LastOpened;
use part::PartSide;
use probe::Probing;
use raised::Raised;
use refused::{Refusals, Verdict};
pub use thread::{KernelThread, Outside, start};
use waiting::Waiting;

/// Ticks between two snapshots.
pub const PICTURE_TICKS: u64 = 25;
/// Ticks between two views of machine and PLC, while the window shows them.
const MACHINE_TICKS: u64 = 50;
/// A handwheel that has not turned for this time is at rest.
const WHEEL_RESTS: Duration = Duration::from_millis(300);
/// Capacity of the queues of commands and notices.
const QUEUE: usize = 1024;

/// What the kernel has published of machine and PLC.
#[derive(Debug, Default)]
struct Monitored {
    last: Option<MachineView>,
    /// Tick of the next view.
    next: u64,
}

/// The kernel.
#[derive(Debug)]
pub struct Kernel {
    emulator: Emulator,
    commands: Receiver<Command>,
    pictures: Arc<ArrayQueue<Snapshot>>,
    machine: Arc<ArrayQueue<MachineView>>,
    /// `Some` only while a view shows machine and PLC.
    monitored: Option<Monitored>,
    /// The board that moves real slides, if one is connected.
    drive: Option<Drive>,
    /// The partner that sends programs in DNC operation.
    partner: Option<Partner>,
    /// The control's serial port, connected to a port of the computer.
    serial: Option<SerialLine>,
    links: Arc<ArrayQueue<LinkView>>,
    link_watched: bool,
    /// The snapshot contains the LCD in the other language, too.
    translates: bool,
    /// The snapshot contains the motion, for the sound of the machine.
    listens: bool,
    /// The lesson under way: a practice machine replaces the learner's own machine.
    lesson: Option<Practising>,
    /// The alarms raised since the control was opened.
    raised: Raised,
    /// The program opened last.
    opened: Option<LastOpened>,
    notices: Sender<Notice>,
    /// Key edges that wait, and the keys that are down.
    keys: Edges,
    refusals: Refusals,
    waiting: Waiting,
    tick: u64,
    last: Option<Snapshot>,
    speed_percent: u32,
    speed: Speed,
    times: Option<Times>,
    /// `Some` only while a scope is open.
    probing: Option<Probing>,
    /// The part in the lathe.
    part: PartSide,
    /// Number of commands so far: it proves that the window is alive.
    heard: u64,
    /// Proof that held keys are still held.
    watch: InputWatch,
    /// After the display has hung, the kernel drops handwheel turns until the wheel has
    /// rested up to this time.
    wheel_rests_until: Duration,
    quit: bool,
}

impl Kernel {
    /// Creates a kernel and the console for its window.
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
            serial: None,
            links: Arc::clone(&links),
            link_watched: false,
            translates: false,
            listens: false,
            lesson: None,
            raised: Raised::default(),
            opened: None,
            notices: notices.clone(),
            keys: Edges::default(),
            refusals: Refusals::default(),
            waiting: Waiting::default(),
            tick: 0,
            last: None,
            speed_percent: 100,
            speed: Speed::REAL,
            times: None,
            probing: None,
            part: PartSide::new(Arc::clone(&part)),
            heard: 0,
            watch: InputWatch::default(),
            wheel_rests_until: Duration::ZERO,
            quit: false,
        };
        let watch = kernel.watch.clone();
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
                watch,
            },
        )
    }

    /// Sets the partner that sends programs in DNC operation.
    pub fn take_programs_from(&mut self, source: Source) {
        self.partner = Some(Partner::new(source));
    }

    /// Connects the control's serial port to a port of the computer.
    pub fn take_serial_line(&mut self, line: SerialLine) {
        self.emulator.panel.connect_port();
        self.serial = Some(line);
    }

    pub const fn emulator(&self) -> &Emulator {
        &self.emulator
    }

    /// Returns the speed in force: only a program in automatic operation on the simulated
    /// lathe runs faster or slower than on a real one (decision WINDOW-9).
    pub fn speed(&self) -> Speed {
        let runs = self.emulator.simulation.cnc.run_state() == RunState::Run;
        match runs && self.drive.is_none() {
            true => self.speed,
            false => Speed::REAL,
        }
    }

    /// Takes the window's commands and runs this number of ticks.
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
        match &mut self.lesson {
            Some(lesson) => lesson.tick(&mut self.emulator),
            None => self.emulator.tick(),
        }
        self.tick += 1;
        self.raised.look(&self.emulator.simulation.cnc);
        if let Some(serial) = &mut self.serial {
            // Files are exchanged with the learner's own machine, also during a lesson.
            let own = match &mut self.lesson {
                Some(lesson) => lesson.own(),
                None => &mut self.emulator,
            };
            for said in serial.tick(own) {
                self.say(Notice::Said(said));
            }
        }
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
        if let Some((finding, stops)) = self.part.ticked(simulation, simulated) {
            let collision = finding.collision;
            let (x, z) = (collision.tip.diameter().0, collision.tip.z);
            let what = collision.message();
            let message = match stops {
                true => say::window_crash(what, x, z),
                false => say::window_collision(what, x, z),
            };
            self.say(Notice::Collided(message));
        }
    }

    /// Publishes a snapshot if anything has changed since the last one; returns whether
    /// there is something new to show.
    pub fn show(&mut self) -> bool {
        let part_shown = self.part.show(&self.emulator.simulation);
        let monitored = self.show_machine() || part_shown;
        self.waiting.look(self.tick, &self.emulator.simulation);
        let snapshot = self.snapshot();
        if self.last.as_ref() == Some(&snapshot) {
            return monitored;
        }
        self.pictures.force_push(snapshot.clone());
        self.last = Some(snapshot);
        true
    }

    /// Publishes machine and PLC if a view shows them and they have changed.
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

    /// Returns the current state of the panel.
    pub fn snapshot(&self) -> Snapshot {
        let panel = &self.emulator.panel;
        Snapshot {
            screen: self.emulator.screen(),
            translated: self
                .translates
                .then(|| Box::new(self.emulator.translated_screen())),
            page: panel.page(),
            model: self.emulator.simulation.cnc.model().id(),
            keys_reversed: KeysReversed {
                x: self.emulator.simulation.cnc.parameters().up_is_positive(),
                z: self.emulator.simulation.cnc.parameters().left_is_positive(),
            },
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
            waits: self
                .waiting
                .said(self.tick, self.emulator.simulation.cnc.run_state()),
            moves: self.emulator.simulation.cnc.is_moving() || self.motion().spindle > 0.0,
            program: self.emulator.simulation.cnc.programs().current(),
            lesson: self.lesson.as_ref().map(Practising::state),
            raised: self.raised.shown(),
            motion: self.listens.then(|| self.motion()),
            imposed: Imposed {
                bits: self.emulator.simulation.cnc.plc().forces().len(),
                inputs: self.emulator.simulation.lathe.forced_inputs(),
                faults: self.emulator.simulation.lathe.faults(),
            },
        }
    }

    /// Returns slides and spindle in motion, of the board or of the simulated lathe.
    fn motion(&self) -> Motion {
        /// Resolution of the spindle speed, r/min.
        const STEP: f64 = 10.0;
        let Simulation { cnc, lathe, .. } = &self.emulator.simulation;
        let (slides, spindle) = match cnc.has_board() {
            true => (cnc.position_machine(), cnc.spindle_of_board()),
            false => (lathe.slides(), Some(lathe.spindle_rpm())),
        };
        let spindle = spindle.unwrap_or_else(|| cnc.spindle_switched()).abs();
        Motion {
            slides,
            spindle: (spindle / STEP).round() * STEP,
        }
    }

    fn carry_out(&mut self, command: Command) {
        self.heard += 1;
        if self.is_late(&command) {
            self.say(Notice::Said(say::key_came_late()));
            return;
        }
        if matches!(
            command,
            Command::Key { down: true, .. } | Command::Tap(_) | Command::Type(_) | Command::Turn(_)
        ) {
            self.learner_acts();
        }
        match command {
            // The emergency stop waits for no other key.
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
            Command::Open(opened) => {
                self.open(*opened);
            }
            Command::OpenAndStart(opened) => {
                let is_selected = self.open(*opened);
                if is_selected && self.drive.is_none() {
                    self.keys.push(Edge::Tap(Key::Auto));
                    self.keys.push(Edge::Tap(Key::CycleStart));
                }
            }
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
            Command::Write(requests) => self.write(requests),
            Command::Job(chosen) => {
                let part = match &mut self.lesson {
                    Some(lesson) => lesson.own_part(),
                    None => &mut self.part,
                };
                part.set(chosen.map(|chosen| *chosen));
            }
            Command::FreshStock => {
                self.part.fresh_stock();
                self.say(Notice::FreshStock);
            }
            Command::CrashStops(stops) => self.part.set_crash_stops(stops),
            Command::ShowPart(visible) => self.part.set_visible(visible),
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
            Command::Lesson(order) => self.order_lesson(order),
            Command::Speed(speed) => self.speed = speed,
            Command::Mend => self.emulator.simulation.lathe.mend(),
            Command::FreeLathe => {
                part::end_crash_faults(&mut self.emulator.simulation);
                self.keys.push(Edge::Tap(Key::Reset));
                self.say(Notice::Said(say::window_lathe_is_free()));
            }
            Command::Link(order) => self.order(order),
            Command::Translate(on) => self.translates = on,
            Command::Listen(on) => self.listens = on,
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
                // The receiver may be gone.
                let _ = to.try_send(Box::new(standing::setup(&self.emulator)));
            }
            Command::HandOutState(to) => {
                let own = self.kept();
                let level = own.simulation.cnc.battery().authority.level();
                let state = retained::project::of_emulator(own);
                // The receiver may be gone.
                let _ = to.try_send(Box::new((state, level)));
            }
            Command::ReleaseAll => self.release_all(),
            Command::Alive => {}
            Command::Quit => self.quit = true,
        }
    }

    /// Whether the command would move a real machine while the display has hung: the age
    /// of the key press is unknown.
    fn is_late(&mut self, command: &Command) -> bool {
        let turns = matches!(command, Command::Turn(_));
        let moves = match command {
            Command::Key { key, down: true } | Command::Tap(key) => edges::moves(*key),
            _ => turns,
        };
        if !moves || self.drive.is_none() {
            return false;
        }
        let now = platform::time_with_sleep();
        let late = !self.watch.is_fresh(now) || turns && now < self.wheel_rests_until;
        if turns && late {
            // A wheel that keeps turning does not take the axis along again.
            self.wheel_rests_until = now + WHEEL_RESTS;
        }
        late
    }

    /// Writes parameters, pitch errors, offsets and variables all or none: if the control
    /// refuses one of them, it writes none.
    fn write(&mut self, requests: Vec<Request>) {
        let rights = self.emulator.simulation.cnc.rights();
        let taken = |request: &Request| match request {
            Request::SetOffset { .. } => rights.offsets(),
            Request::SetVariable { .. } | Request::SetMacroVariable { .. } => rights.variables(),
            _ => rights.parameters(),
        };
        if let Err(refusal) = requests.iter().try_for_each(taken) {
            let why = gsk_project::refusal_message(refusal);
            self.say(Notice::Said(say::commission_refused(why)));
            return;
        }
        for request in requests {
            if let Err(alarm) = self.emulator.simulation.cnc.request(request) {
                self.say(Notice::Refused(alarm));
                return;
            }
        }
    }

    /// Turns the handwheel; in step mode nothing moves and a notice says why.
    fn turn(&mut self, detents: i32) {
        self.emulator.turn(detents);
        let cnc = &self.emulator.simulation.cnc;
        // An alarm takes precedence over this notice.
        if cnc.mode().motion() == Mode::Step && cnc.alarms().is_empty() {
            self.say(Notice::Said(say::key_handwheel_in_step_mode()));
        }
    }

    /// Passes a key event or a typed character to the panel.
    fn hand_over(&mut self, event: KeyEvent) {
        let pressed = match event {
            KeyEvent::Down(key) => Some(KeyPress::new(key, &self.emulator.simulation.cnc)),
            KeyEvent::Type(_) => Some(None),
            _ => None,
        };
        let refused = self.emulator.key(event);
        if let Some(press) = pressed {
            let verdict = self.refusals.pressed(press, refused, self.tick);
            self.tell(verdict);
        }
    }

    /// Reports why a key does nothing, or that a key acts again.
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

    /// Lets go of every key and drops the handwheel detents that the axis has not
    /// followed: nothing proves any more that a hand is at the machine.
    fn let_go(&mut self) {
        self.release_all();
        self.drop_wheel();
    }

    fn drop_wheel(&mut self) {
        // This request cannot be refused.
        let _ = self.emulator.simulation.cnc.request(Request::DropWheel);
    }

    fn release_all(&mut self) {
        self.keys.clear();
        self.emulator.key(KeyEvent::ReleaseAll);
    }

    fn say(&self, notice: Notice) {
        // The window reads the notices with every snapshot; a thousand unread ones mean
        // that it is gone.
        let _ = self.notices.try_send(notice);
    }
}
