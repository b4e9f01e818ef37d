//! The kernel: owns the emulator, carries out what the window asks for, hands
//! out pictures. The same code runs in its thread and, step by step, in a test.

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

/// Ticks between two pictures.
pub const PICTURE_TICKS: u64 = 25;
/// Ticks between two looks at machine and PLC, for the views that show them.
const MACHINE_TICKS: u64 = 50;
/// A handwheel that was not turned for so long has come to rest.
const WHEEL_RESTS: Duration = Duration::from_millis(300);
/// Commands that wait for the kernel.
const QUEUE: usize = 1024;

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
    /// The serial port at a port of the computer.
    serial: Option<SerialLine>,
    links: Arc<ArrayQueue<LinkView>>,
    link_watched: bool,
    /// The LCD is shown in the other language, too.
    translates: bool,
    /// Somebody listens to the machine.
    listens: bool,
    /// A practice machine stands in the place of the learner's own.
    lesson: Option<Practising>,
    /// The alarms that were raised.
    raised: Raised,
    /// The program that was opened last.
    opened: Option<LastOpened>,
    notices: Sender<Notice>,
    /// Keys that are down, and what happened to others.
    keys: Edges,
    refusals: Refusals,
    waiting: Waiting,
    tick: u64,
    last: Option<Snapshot>,
    speed_percent: u32,
    speed: Speed,
    times: Option<Times>,
    /// Only while a scope is open.
    probing: Option<Probing>,
    /// The part that is cut.
    part: PartSide,
    /// Commands so far: the window is heard.
    heard: u64,
    /// What proves that held keys are still held.
    watch: InputWatch,
    /// After the display has hung the handwheel has to rest until then.
    wheel_rests_until: Duration,
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

    /// Who sends programs in DNC operation.
    pub fn take_programs_from(&mut self, source: Source) {
        self.partner = Some(Partner::new(source));
    }

    /// The serial port is at a port of the computer.
    pub fn take_serial_line(&mut self, line: SerialLine) {
        self.emulator.panel.connect_port();
        self.serial = Some(line);
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
        match &mut self.lesson {
            Some(lesson) => lesson.tick(&mut self.emulator),
            None => self.emulator.tick(),
        }
        self.tick += 1;
        self.raised.look(&self.emulator.simulation.cnc);
        if let Some(serial) = &mut self.serial {
            // Files come and go at the learner's own machine, also during a lesson.
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

    /// Puts out a picture if anything has changed since the last one.
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

    /// What moves.
    fn motion(&self) -> Motion {
        /// Steps of the spindle's speed, r/min.
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
                // Who asked may have gone.
                let _ = to.try_send(Box::new(standing::setup(&self.emulator)));
            }
            Command::HandOutState(to) => {
                let own = self.kept();
                let level = own.simulation.cnc.battery().authority.level();
                let state = retained::project::of_emulator(own);
                // Who asked may have gone.
                let _ = to.try_send(Box::new((state, level)));
            }
            Command::ReleaseAll => self.release_all(),
            Command::Alive => {}
            Command::Quit => self.quit = true,
        }
    }

    /// Whether something was pressed or turned that would move a real machine, and the
    /// display has hung of late: nobody knows how long ago that was.
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
            // A wheel that turns on does not take the axis along again.
            self.wheel_rests_until = now + WHEEL_RESTS;
        }
        late
    }

    /// Asks for parameters, pitch errors, offsets and variables as one; where the control
    /// does not take each of them, none.
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

    /// Nothing proves any more that the hand is at the machine: every key is let go, and
    /// what the handwheel was turned by and the axis has not followed is dropped.
    fn let_go(&mut self) {
        self.release_all();
        self.drop_wheel();
    }

    fn drop_wheel(&mut self) {
        // It is no request that could be refused.
        let _ = self.emulator.simulation.cnc.request(Request::DropWheel);
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
