//! The seat of a class: reports the state of the machine, and carries out requests of the
//! instructor. There is none that presses a key.

use gsk_core::alarm::AlarmClass;
use gsk_core::operation::RunState;
use gsk_link::LinkState;
use gsk_messages::say;
use gsk_mtconnect::program_name;
use gsk_panel::pages::mode_message;
use gsk_panel::raster;
use gsk_workpiece::grid::mm;
use gsk_workpiece::region::Region;
use web_time::{Duration, Instant};

use super::{Command, Kernel, Notice, PanelSnapshot};
use crate::network::class::lcd_picture::{LCD_DOTS, LCD_WIDTH, LcdPicture};
use crate::network::class::part_outline::CoarseOutline;
use crate::network::class::seat_report::{
    SeatReport, SeatTask, SeatText, SeatTrouble, SeatTroubleKind,
};
use crate::network::class::seat_request::{SeatAnswer, SeatRefusal, SeatRequest, SeatRights};
use gsk_panel::keys::Key;
use gsk_panel::screen::Screen;

/// Interval between two reports.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);
/// Interval between two outlines of the part.
const PART_INTERVAL: Duration = Duration::from_secs(2);
/// Interval between two pictures of the LCD.
const LCD_INTERVAL: Duration = Duration::from_millis(300);

/// What the learner does in his class.
#[derive(Clone, Debug, PartialEq)]
pub enum SeatAction {
    /// Answer an offered task.
    Answer(SeatAnswer),
    /// Ask for help (true), or withdraw that.
    AskHelp(bool),
    /// Hand a sealed result in.
    HandIn(Vec<u8>),
    /// Report the sum of the best points.
    Points(u32),
}

/// What changes when the learner does something.
type SeatActivity = (Vec<Key>, i32, RunState);

/// The state of a seat beside the machine.
#[derive(Debug)]
pub(super) struct ClassSeatState {
    points: u32,
    asks_help: bool,
    /// What the learner did last, and when.
    activity: (SeatActivity, Instant),
    next_report: Instant,
    next_part: Instant,
    next_lcd: Instant,
    /// The section that was passed on last; `None` before the first one.
    shown_version: Option<u64>,
    shown_screen: Option<Screen>,
}

impl Default for ClassSeatState {
    fn default() -> Self {
        let now = Instant::now();
        Self {
            points: 0,
            asks_help: false,
            activity: ((Vec::new(), 0, RunState::Reset), now),
            next_report: now,
            next_part: now,
            next_lcd: now,
            shown_version: None,
            shown_screen: None,
        }
    }
}

impl Kernel {
    /// Carries out what the learner does in his class.
    pub(super) fn execute_seat_action(&mut self, action: SeatAction) {
        match action {
            SeatAction::AskHelp(asks) => self.class_seat.asks_help = asks,
            SeatAction::Points(points) => self.class_seat.points = points,
            SeatAction::Answer(answer) => {
                if let Some(feed) = self.network.seat_feed() {
                    feed.answer(answer);
                }
            }
            SeatAction::HandIn(result) => {
                if let Some(feed) = self.network.seat_feed() {
                    feed.hand_in(result);
                }
            }
        }
    }

    /// Whether the learner asks for help; `None` outside a class.
    pub(super) fn asks_help(&self) -> Option<bool> {
        self.network.has_seat().then_some(self.class_seat.asks_help)
    }

    /// Forgets what the class has seen: another class begins with everything.
    pub(super) fn begin_class(&mut self) {
        self.class_seat = ClassSeatState {
            points: self.class_seat.points,
            ..ClassSeatState::default()
        };
    }

    /// Reports the state to the class, and carries out its requests. Returns whether there was
    /// one: the window must read its notice.
    pub(super) fn follow_class(&mut self, snapshot: &PanelSnapshot) -> bool {
        if !self.network.has_seat() {
            return false;
        }
        let mut has_request = false;
        while let Some(request) = self.network.seat_feed().and_then(|it| it.take_request()) {
            self.execute_class_request(request);
            has_request = true;
        }
        let now = Instant::now();
        if now >= self.class_seat.next_report {
            self.class_seat.next_report = now + REPORT_INTERVAL;
            let report = self.seat_report(snapshot, now);
            if let Some(feed) = self.network.seat_feed() {
                feed.report(report);
            }
        }
        // A section takes longer than the other reports: the port of a board does not wait for it.
        let is_board_moving = matches!(snapshot.board, Some(LinkState::Moving | LinkState::Homing));
        if now >= self.class_seat.next_part && !is_board_moving {
            self.class_seat.next_part = now + PART_INTERVAL;
            self.show_part_to_class();
        }
        let is_watched = self
            .network
            .seat_feed()
            .is_some_and(|it| it.is_lcd_watched());
        if !is_watched {
            self.class_seat.shown_screen = None;
        } else if now >= self.class_seat.next_lcd {
            self.class_seat.next_lcd = now + LCD_INTERVAL;
            self.show_lcd_to_class(snapshot);
        }
        has_request
    }

    fn seat_report(&mut self, snapshot: &PanelSnapshot, now: Instant) -> SeatReport {
        let activity = (snapshot.pressed.clone(), snapshot.wheel, snapshot.run_state);
        if self.class_seat.activity.0 != activity {
            self.class_seat.activity = (activity, now);
        }
        let idle = now.duration_since(self.class_seat.activity.1);
        let cnc = self.shown_machine().cnc();
        let (name, allows_faults) = self.network.seat_name();
        SeatReport {
            name: name.to_owned(),
            is_online: true,
            mode: SeatText::new(&mode_message(cnc.mode())),
            is_running: matches!(snapshot.run_state, RunState::Run | RunState::Hold),
            program: snapshot.program.map(|id| program_name(cnc, id)),
            line: snapshot.running_block.map(|block| block.line),
            trouble: seat_trouble(snapshot),
            task: seat_task(snapshot),
            points: self.class_seat.points,
            asks_help: self.class_seat.asks_help,
            idle_min: (idle.as_secs() / 60) as u32,
            has_board: self.has_real_slides,
            allows_faults,
        }
    }

    fn show_part_to_class(&mut self) {
        let (version, section) = match self.part.state().machining() {
            Some(machining) => {
                let part = machining.scene().part();
                (Some(part.version()), Some(part.section()))
            }
            None => (None, None),
        };
        if self.class_seat.shown_version == version {
            return;
        }
        self.class_seat.shown_version = version;
        let outline = section.map(|section| coarse_outline(&section));
        if let Some(feed) = self.network.seat_feed() {
            feed.show_part(outline.unwrap_or_default());
        }
    }

    fn show_lcd_to_class(&mut self, snapshot: &PanelSnapshot) {
        if self.class_seat.shown_screen.as_ref() == Some(&snapshot.screen) {
            return;
        }
        let picture = lcd_picture(&snapshot.screen, snapshot.brightness);
        self.class_seat.shown_screen = Some(snapshot.screen.clone());
        if let Some(feed) = self.network.seat_feed() {
            feed.show_lcd(picture);
        }
    }

    /// Carries out a request, or answers why the seat refuses it.
    fn execute_class_request(&mut self, request: SeatRequest) {
        let rights = SeatRights {
            has_board: self.has_real_slides,
            allows_faults: self.network.seat_name().1,
            is_in_exam: self.is_in_exam(),
        };
        let is_fault = matches!(
            request,
            SeatRequest::Fault { .. } | SeatRequest::ClearFaults
        );
        let in_exercise = is_fault && self.is_in_exercise();
        let refusal = request.refusal(rights);
        let refusal = refusal.or(in_exercise.then_some(SeatRefusal::Exercise));
        let subject = request.subject();
        if let (Some(refusal), Some(subject)) = (refusal, &subject) {
            return self.answer_class(subject.clone(), Some(refusal));
        }
        match request {
            SeatRequest::Lcd { .. } => {}
            // The learner answers; the window knows the exam.
            SeatRequest::Task { .. }
            | SeatRequest::TaskFile { .. }
            | SeatRequest::BeginExam { .. }
            | SeatRequest::EndExam { .. } => {
                return self.notify(Notice::TaskOffered(Box::new(request)));
            }
            SeatRequest::Fault { fault } => {
                self.execute_command(Command::Fault(fault, true));
                self.notify(Notice::Message(say::class_fault_set()));
            }
            SeatRequest::ClearFaults => {
                self.execute_command(Command::ClearFaults);
                self.notify(Notice::Message(say::class_faults_cleared()));
            }
            SeatRequest::Coming => {
                self.class_seat.asks_help = false;
                self.notify(Notice::Message(say::class_helped()));
            }
        }
        if let Some(subject) = subject {
            self.answer_class(subject, None);
        }
    }

    fn answer_class(&mut self, subject: String, refusal: Option<SeatRefusal>) {
        self.execute_seat_action(SeatAction::Answer(SeatAnswer { subject, refusal }));
    }
}

/// What has stopped the machine; `None` if nothing has.
fn seat_trouble(snapshot: &PanelSnapshot) -> Option<SeatTrouble> {
    if let Some(crash) = &snapshot.crash {
        return Some(SeatTrouble {
            kind: SeatTroubleKind::Crash,
            text: SeatText::new(crash),
        });
    }
    let alarm = snapshot.alarm.as_ref()?;
    let kind = match alarm.class() {
        AlarmClass::EmergencyStop => SeatTroubleKind::Emergency,
        _ => SeatTroubleKind::Alarm,
    };
    let text = SeatText {
        en: alarm.line_text_en(),
        zh: alarm.line_text(),
    };
    Some(SeatTrouble { kind, text })
}

/// The lesson or exercise; `None` at the learner's own machine.
fn seat_task(snapshot: &PanelSnapshot) -> Option<SeatTask> {
    if let Some(exercise) = &snapshot.exercise {
        return Some(SeatTask {
            id: exercise.id.clone(),
            title: SeatText {
                en: exercise
                    .title
                    .in_language(gsk_messages::Language::En)
                    .into_owned(),
                zh: exercise
                    .title
                    .in_language(gsk_messages::Language::Zh)
                    .into_owned(),
            },
            step: None,
            remaining_min: Some(exercise.remaining_s.div_ceil(60)),
            is_exam: exercise.is_exam,
            is_handed_in: exercise.is_handed_in,
        });
    }
    let lesson = snapshot.lesson.as_ref()?;
    Some(SeatTask {
        id: lesson.name.clone(),
        step: Some(lesson.view.step + 1),
        ..SeatTask::default()
    })
}

/// The lines of a half section, coarse.
fn coarse_outline(section: &Region) -> CoarseOutline {
    let lines: Vec<Vec<[f32; 2]>> = section
        .contours()
        .iter()
        .map(|line| {
            let points = line.iter();
            points
                .map(|point| [mm(point.x) as f32, mm(point.y).max(0.0) as f32])
                .collect()
        })
        .collect();
    CoarseOutline::from_lines(&lines)
}

/// The dots and colours of the LCD.
fn lcd_picture(screen: &Screen, brightness: u8) -> LcdPicture {
    let dots = raster::bitmap(screen);
    let palette = raster::palette(screen.colours(), brightness);
    let dot = |index: usize| {
        let (x, y) = (index % LCD_WIDTH, index / LCD_WIDTH);
        dots.get(x as i32, y as i32)
    };
    LcdPicture {
        background: palette.background,
        text: palette.text,
        dots: (0..LCD_DOTS).map(dot).collect(),
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};
    use std::net::{TcpListener, TcpStream};

    use gsk_core::machine::LatheFault;
    use gsk_core::setup::Setup;
    use gsk_messages::Language;
    use gsk_panel::emulator::Emulator;

    use super::*;
    use crate::kernel::Console;
    use crate::network::{ClassSettings, NetworkSettings};

    const WAIT: Duration = Duration::from_secs(10);

    /// A seat, and the broker of its class that the test itself plays.
    struct Bench {
        kernel: Kernel,
        console: Console,
        broker: TcpStream,
        received: Vec<u8>,
        request_topic: String,
    }

    impl Bench {
        fn new(allows_faults: bool) -> Self {
            let listener = TcpListener::bind("127.0.0.1:0").expect("listens");
            let address = listener.local_addr().expect("an address");
            let (mut kernel, console) = Kernel::new(Emulator::new(Setup::default()));
            let settings = NetworkSettings {
                class: ClassSettings {
                    is_on: true,
                    code: "abc".to_owned(),
                    broker: address.to_string(),
                    ca: String::new(),
                    name: "Ann".to_owned(),
                    allows_faults,
                    password: String::new(),
                },
                ..NetworkSettings::default()
            };
            kernel.set_network(&settings, Language::En);
            let (mut broker, _) = listener.accept().expect("a client");
            broker.write_all(&[0x20, 2, 0, 0]).expect("sent");
            let short = Duration::from_millis(10);
            broker.set_read_timeout(Some(short)).expect("an option");
            let mut bench = Self {
                kernel,
                console,
                broker,
                received: Vec::new(),
                request_topic: String::new(),
            };
            bench.wait_for("\"is_online\":true");
            let text = String::from_utf8_lossy(&bench.received).into_owned();
            let (before, _) = text.split_once("/request").expect("a subscription");
            let start = before.rfind("gsk980td/class/ABC/seats/").expect("a topic");
            bench.request_topic = format!("{}/request", &before[start..]);
            bench
        }

        /// Runs the machine until the seat has sent a text.
        fn wait_for(&mut self, text: &str) {
            let end = Instant::now() + WAIT;
            loop {
                self.kernel.run(25);
                self.kernel.publish();
                let mut bytes = [0; 8192];
                if let Ok(count) = self.broker.read(&mut bytes) {
                    self.received.extend(&bytes[..count]);
                }
                let sent = String::from_utf8_lossy(&self.received);
                if sent.contains(text) {
                    return;
                }
                assert!(Instant::now() < end, "{text}: {sent}");
            }
        }

        /// Sends a request, as the instructor does.
        fn request(&mut self, json: &str) {
            self.received.clear();
            let topic = self.request_topic.as_bytes();
            let mut body = (topic.len() as u16).to_be_bytes().to_vec();
            body.extend(topic);
            body.extend(json.as_bytes());
            let length = [(body.len() & 0x7f) as u8 | 0x80, (body.len() >> 7) as u8];
            let packet = [&[0x30], &length[..], &body].concat();
            self.broker.write_all(&packet).expect("sent");
        }
    }

    #[test]
    fn faults_are_set_only_where_the_learner_allows_them() {
        let fault = r#"{"request":"fault","fault":"TurretBlocked"}"#;
        let mut strict = Bench::new(false);
        strict.request(fault);
        strict.wait_for(r#""subject":"turret-blocked","refusal":"faults""#);
        assert_eq!(strict.kernel.emulator().lathe().fault_count(), 0);
        let mut seat = Bench::new(true);
        seat.request(fault);
        seat.wait_for(r#""subject":"turret-blocked","refusal":null"#);
        let has_fault = |seat: &Bench| {
            let lathe = seat.kernel.emulator().lathe();
            lathe.has_fault(LatheFault::TurretBlocked)
        };
        assert!(has_fault(&seat));
        seat.request(r#"{"request":"clear_faults"}"#);
        seat.wait_for(r#""subject":"clear-faults","refusal":null"#);
        assert!(!has_fault(&seat));
        // A board moves real slides: whatever the learner allows.
        seat.kernel.has_real_slides = true;
        seat.request(fault);
        seat.wait_for(r#""refusal":"board""#);
        let hash = "0f".repeat(32);
        seat.request(&format!(
            r#"{{"request":"begin_exam","exercises":["02-jog"],"pin":{{"salt":1,"hash":"{hash}"}}}}"#
        ));
        seat.wait_for(r#""subject":"exam","refusal":"board""#);
        assert!(!has_fault(&seat));
    }

    #[test]
    fn a_task_is_offered_and_no_key_is_ever_pressed() {
        let mut seat = Bench::new(true);
        let before = seat.kernel.emulator().panel().pressed();
        for key in [
            r#"{"request":"key","key":"CycleStart"}"#,
            r#"{"request":"press","key":"Reset"}"#,
            r#"{"Key":{"key":"CycleStart","down":true}}"#,
        ] {
            seat.request(key);
        }
        seat.request(r#"{"request":"task","exercise":"first-shaft"}"#);
        let end = Instant::now() + WAIT;
        let offered = loop {
            seat.kernel.run(25);
            seat.kernel.publish();
            let notices = seat.console.notices.try_iter();
            let mut offers = notices.filter_map(|notice| match notice {
                Notice::TaskOffered(request) => Some(*request),
                _ => None,
            });
            if let Some(request) = offers.next() {
                break request;
            }
            assert!(Instant::now() < end);
        };
        let exercise = "first-shaft".to_owned();
        assert_eq!(offered, SeatRequest::Task { exercise });
        assert_eq!(seat.kernel.emulator().panel().pressed(), before);
        let answer = SeatAnswer {
            subject: "first-shaft".to_owned(),
            refusal: Some(SeatRefusal::Learner),
        };
        let command = Command::Seat(SeatAction::Answer(answer));
        seat.console.send(command);
        seat.wait_for(r#""refusal":"learner""#);
    }

    #[test]
    fn help_alarms_and_the_lcd_reach_the_class() {
        let mut seat = Bench::new(false);
        seat.console.send(Command::Seat(SeatAction::AskHelp(true)));
        seat.wait_for(r#""asks_help":true"#);
        seat.request(r#"{"request":"coming"}"#);
        seat.wait_for(r#""asks_help":false"#);
        seat.request(r#"{"request":"lcd","seconds":5}"#);
        seat.wait_for("/lcdL1");
        seat.console.send(Command::Fault(LatheFault::DriveX, true));
        seat.wait_for(r#""trouble":{"kind":"alarm""#);
    }
}
