//! The pane *Network*, a task that the instructor of a class offers, and the window of a class.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use gsk_core::setup::Setup;
use gsk_exercise::exam::ExamPin;
use gsk_exercise::library::EXERCISES;
use gsk_host::files::exercises;
use gsk_host::kernel::Notice;
use gsk_host::network::class::class_address::ClassAddress;
use gsk_host::network::class::seat_request::{SeatPin, SeatRequest};
use gsk_host::network::{AgentSettings, BrokerSettings, NetworkSettings};
use gsk_messages::Language;
use gsk_tests::test_folder;
use gsk_window::class_window::{ClassStart, ClassWindow};
use gsk_window::layout::{Layouts, WindowLayout};
use gsk_window::{WindowSettings, fonts};

use crate::common::WindowBench;

const WAIT: Duration = Duration::from_secs(10);

fn open_bench(network: NetworkSettings) -> WindowBench {
    let settings = WindowSettings {
        language: Language::En,
        layouts: Layouts::with_layout(WindowLayout::Learner),
        network,
        ..WindowSettings::default()
    };
    WindowBench::with_settings(Setup::default(), settings, egui::vec2(1366.0, 768.0))
}

fn open_pane(bench: &mut WindowBench) {
    bench.click("Views");
    bench.click("Network…");
}

/// Runs until a text is shown.
#[track_caller]
fn wait_for(bench: &mut WindowBench, text: &str) {
    let end = Instant::now() + WAIT;
    while bench.harness.query_all_by_label_contains(text).count() == 0 {
        assert!(Instant::now() < end, "no `{text}`");
        bench.run(20);
    }
}

#[test]
fn everything_is_off_as_delivered() {
    let mut bench = open_bench(NetworkSettings::default());
    open_pane(&mut bench);
    let off = "Off: nothing is sent, and nothing listens";
    assert_eq!(bench.harness.query_all_by_label(off).count(), 3);
    assert!(bench.harness.query_by_label("Ask for help").is_none());
}

#[test]
fn the_switch_of_the_agent_listens_and_stops() {
    let mut bench = open_bench(NetworkSettings {
        agent: AgentSettings {
            is_on: false,
            address: "127.0.0.1:0".to_owned(),
        },
        ..NetworkSettings::default()
    });
    open_pane(&mut bench);
    let switch = "MTConnect agent and page for a phone";
    bench.click(switch);
    wait_for(&mut bench, "Listening at http://127.0.0.1:");
    assert!(bench.harness.state().settings().network.agent.is_on);
    let state = bench.console.network.agent.get();
    let address = state.message().text(Language::En);
    let address = address.trim_start_matches("Listening at http://");
    let address = address.trim_end_matches('/').to_owned();
    assert!(TcpStream::connect(&address).is_ok(), "{address}");
    bench.click(switch);
    bench.run(100);
    assert!(TcpStream::connect(&address).is_err(), "{address}");
    assert!(!bench.harness.state().settings().network.agent.is_on);
}

#[test]
fn a_broker_that_is_not_there_is_named_in_one_sentence() {
    // A stored switch acts at the start; nothing listens at port 9.
    let mut bench = open_bench(NetworkSettings {
        broker: BrokerSettings {
            is_on: true,
            url: "mqtt://ann@127.0.0.1:9/hall".to_owned(),
            ..BrokerSettings::default()
        },
        ..NetworkSettings::default()
    });
    open_pane(&mut bench);
    wait_for(&mut bench, "Not connected: MQTT: mqtt://127.0.0.1:9/hall: ");
}

fn offer(bench: &mut WindowBench, exercise: &str) {
    let request = SeatRequest::Task {
        exercise: exercise.to_owned(),
    };
    let notice = Notice::TaskOffered(Box::new(request));
    bench.console.notice_sender.send(notice).unwrap();
    bench.run(50);
}

#[test]
fn the_learner_decides_about_an_offered_task() {
    let mut bench = open_bench(NetworkSettings::default());
    let folder = test_folder("offered-task");
    let found = exercises::load_exercises(None);
    bench
        .harness
        .state_mut()
        .set_exercises(found, folder.to_owned(), Ok(None));
    open_pane(&mut bench);
    offer(&mut bench, "no-such-exercise");
    let question = "The instructor offers the exercise";
    assert!(bench.harness.query_by_label_contains(question).is_none());
    offer(&mut bench, "02-jog");
    bench.click("Not now");
    assert!(bench.harness.query_by_label_contains(question).is_none());
    assert!(bench.kernel.snapshot().exercise.is_none());
    offer(&mut bench, "02-jog");
    bench.click("Begin");
    bench.run(100);
    let exercise = bench.kernel.snapshot().exercise;
    assert_eq!(
        exercise.map(|exercise| exercise.id).as_deref(),
        Some("02-jog")
    );
    let pane = bench
        .harness
        .query_by_label("MTConnect agent and page for a phone");
    assert!(pane.is_none(), "it would cover the exercise");
}

fn offer_file(bench: &mut WindowBench, exercise: &str, text: &str, drawing: Option<&str>) {
    let request = SeatRequest::TaskFile {
        exercise: exercise.to_owned(),
        text: text.to_owned(),
        drawing: drawing.map(str::to_owned),
    };
    let notice = Notice::TaskOffered(Box::new(request));
    bench.console.notice_sender.send(notice).unwrap();
    bench.run(50);
}

#[test]
fn an_exercise_of_the_instructor_is_kept_only_after_the_learner_has_agreed() {
    let mut bench = open_bench(NetworkSettings::default());
    let folder = test_folder("sent-task");
    let found = exercises::load_exercises(None);
    let window = bench.harness.state_mut();
    window.set_exercises(found, folder.to_owned(), Ok(None));
    let (_, text) = EXERCISES.iter().find(|(id, _)| *id == "02-jog").unwrap();
    let question = "The instructor sends an exercise of his own";
    let is_offered = |bench: &WindowBench| {
        let harness = &bench.harness;
        harness.query_by_label_contains(question).is_some()
    };
    let not_finite = text.replacen("time_limit: ", "time_limit: NaN, // ", 1);
    assert_ne!(&not_finite, text);
    for (text, drawing) in [
        ("", None),
        ("(title: 1)", None),
        (&*not_finite, None),
        (*text, Some("no base64!")),
        (*text, Some("iVBORw0KGgo=")),
    ] {
        offer_file(&mut bench, "jog-course", text, drawing);
        assert!(!is_offered(&bench), "{text} {drawing:?}");
    }
    let kept = folder.join("exercises/jog-course/task.ron");
    offer_file(&mut bench, "jog-course", text, None);
    assert!(is_offered(&bench));
    bench.click("Not now");
    assert!(!kept.exists() && bench.kernel.snapshot().exercise.is_none());
    offer_file(&mut bench, "jog-course", text, None);
    bench.click("Begin");
    bench.run(100);
    let exercise = bench.kernel.snapshot().exercise.unwrap();
    assert_eq!(exercise.id, "jog-course");
    assert_eq!(std::fs::read_to_string(&kept).unwrap(), *text);
    let stored = exercises::load_exercises(Some(&folder));
    assert!(stored.tasks.iter().any(|task| task.id == "jog-course"));
    // Another text of the same name is an exercise of this session; the stored one stays.
    let changed = format!("{text}\n// changed\n");
    offer_file(&mut bench, "jog-course", &changed, None);
    assert!(is_offered(&bench));
    bench.click("Begin");
    bench.run(100);
    assert_eq!(std::fs::read_to_string(&kept).unwrap(), *text);
    // One that comes with the program is not replaced.
    offer_file(&mut bench, "03-handwheel", text, None);
    bench.click("Begin");
    bench.run(100);
    assert!(!folder.join("exercises/03-handwheel").exists());
    // The seat has this text already.
    offer_file(&mut bench, "02-jog", text, None);
    assert!(!is_offered(&bench));
    bench.click("Not now");
}

fn offer_exam(bench: &mut WindowBench, exercises: &[&str], pin: &SeatPin) {
    let request = SeatRequest::BeginExam {
        exercises: exercises.iter().map(|id| (*id).to_owned()).collect(),
        pin: pin.clone(),
    };
    let notice = Notice::TaskOffered(Box::new(request));
    bench.console.notice_sender.send(notice).unwrap();
    bench.run(50);
}

#[test]
fn the_learner_begins_an_exam_of_the_class_and_its_pin_ends_it() {
    let mut bench = open_bench(NetworkSettings::default());
    let folder = test_folder("offered-exam");
    let found = exercises::load_exercises(None);
    let window = bench.harness.state_mut();
    window.set_exercises(found, folder.to_owned(), Ok(None));
    let pin = |pin: &str| {
        let pin = ExamPin::new(pin, 5).unwrap();
        let (salt, hash) = pin.as_hash();
        let hash = hash.to_owned();
        SeatPin { salt, hash }
    };
    let question = "The instructor begins an exam. Exercises: 2";
    offer_exam(&mut bench, &["02-jog", "no-such-exercise"], &pin("4711"));
    assert!(
        bench
            .harness
            .query_by_label_contains("begins an exam")
            .is_none()
    );
    offer_exam(&mut bench, &["02-jog", "01-reference"], &pin("4711"));
    assert!(bench.harness.query_by_label_contains(question).is_some());
    bench.click("Not now");
    assert!(bench.kernel.snapshot().exercise.is_none());
    offer_exam(&mut bench, &["02-jog", "01-reference"], &pin("4711"));
    bench.click("Begin");
    bench.run(100);
    let exercise = bench.kernel.snapshot().exercise.unwrap();
    assert!(exercise.is_exam && exercise.id == "02-jog");
    // Another exam waits for the end of this one.
    offer_exam(&mut bench, &["01-reference"], &pin("4711"));
    assert!(
        bench
            .harness
            .query_by_label_contains("begins an exam")
            .is_none()
    );
    let end = |bench: &mut WindowBench, pin: SeatPin| {
        let notice = Notice::TaskOffered(Box::new(SeatRequest::EndExam { pin }));
        bench.console.notice_sender.send(notice).unwrap();
        bench.run(100);
    };
    end(&mut bench, pin("4712"));
    assert!(!bench.kernel.snapshot().exercise.unwrap().is_handed_in);
    end(&mut bench, pin("4711"));
    wait_for(&mut bench, "The exam is over. The results are in");
    assert!(bench.kernel.snapshot().exercise.unwrap().is_handed_in);
    // The exercise that was under way is a sealed result.
    let exam = folder.join("exams").read_dir().unwrap().next().unwrap();
    let result = exam.unwrap().path().join("1-02-jog.gskresult");
    assert!(result.exists(), "{}", result.display());
}

#[test]
fn a_class_that_is_pasted_fills_code_and_broker() {
    let mut bench = open_bench(NetworkSettings::default());
    open_pane(&mut bench);
    bench.harness.get_by_label("Code").focus();
    bench.run(20);
    let link = "http://pc:8080/?class=K7M2@mqtt://ann@192.168.1.5:1884/hall";
    let paste = egui::Event::Text(link.to_owned());
    bench.harness.input_mut().events.push(paste);
    bench.run(20);
    bench.harness.get_by_label("Name on the tile").focus();
    bench.run(20);
    let value = |bench: &WindowBench, name: &str| {
        let fields = bench.harness.query_all_by_label(name);
        let values: Vec<String> = fields.filter_map(|field| field.value()).collect();
        values.join("|")
    };
    assert_eq!(value(&bench, "Code"), "K7M2");
    let broker = value(&bench, "MQTT broker");
    assert!(
        broker.contains("mqtt://ann@192.168.1.5:1884/hall"),
        "{broker}"
    );
}

/// A packet with a message.
fn publish(topic: &str, payload: &str) -> Vec<u8> {
    let mut body = (topic.len() as u16).to_be_bytes().to_vec();
    body.extend(topic.as_bytes());
    body.extend(payload.as_bytes());
    let length = [(body.len() & 0x7f) as u8 | 0x80, (body.len() >> 7) as u8];
    [&[0x31], &length[..], &body].concat()
}

#[test]
fn the_window_of_a_class_shows_seats_and_requests_an_lcd() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let data = test_folder("class-data");
    let (_, text) = EXERCISES.iter().find(|(id, _)| *id == "02-jog").unwrap();
    let own_text = text.replacen("en: \"Jog to a position\"", "en: \"My own task\"", 1);
    exercises::write_new(&data, "own", &own_text).unwrap();
    let class = format!("K7M2@{}", listener.local_addr().unwrap());
    let start = ClassStart {
        class: ClassAddress::parse(&class).unwrap(),
        results: test_folder("class-results").to_owned(),
        language: Language::En,
        exercises: exercises::load_exercises(Some(&data)),
        data: Some(data.to_owned()),
        page_address: None,
        seat_page: None,
    };
    let window = ClassWindow::start(start).map_err(|it| it.text(Language::En));
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1100.0, 720.0))
        .with_context_setup(fonts::set_up)
        .build_ui_state(
            |ui, window: &mut ClassWindow| window.ui(ui),
            window.unwrap(),
        );
    harness.step();
    assert!(
        harness
            .query_by_label_contains("No seat has joined")
            .is_some()
    );
    let (mut broker, _) = listener.accept().unwrap();
    broker
        .set_read_timeout(Some(Duration::from_millis(20)))
        .unwrap();
    broker.write_all(&[0x20, 2, 0, 0]).unwrap();
    let seats = "gsk980td/class/K7M2/seats";
    for (seat, state) in [
        ("a1", r#"{"name":"Ann","is_online":true,"is_running":true}"#),
        (
            "b2",
            r#"{"name":"Bo","is_online":true,"asks_help":true,"has_board":true}"#,
        ),
    ] {
        let packet = publish(&format!("{seats}/{seat}/state"), state);
        broker.write_all(&packet).unwrap();
    }
    let end = Instant::now() + WAIT;
    while harness.query_by_label("Bo: asks for help").is_none() {
        assert!(Instant::now() < end);
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
    }
    // The seat that asks for help is before the one that runs.
    let left = |name| harness.get_by_label(name).rect().left();
    assert!(left("Bo: asks for help") < left("Ann: running"));
    harness.get_by_label("Bo: asks for help").click();
    harness.run_steps(3);
    assert!(
        harness
            .query_all_by_label("a board moves real slides")
            .count()
            == 2
    );
    harness.get_by_label("Show the LCD").click();
    harness.run_steps(3);
    await_request(
        &mut broker,
        &format!("{seats}/b2/request{{\"request\":\"lcd\""),
    );
    // An exercise of the instructor's own travels with its text, another one by its name.
    harness.get_by_label("Ann: running").click();
    harness.run_steps(3);
    for (title, sent) in [
        (
            "Jog to a position",
            "{\"request\":\"task\",\"exercise\":\"02-jog\"}",
        ),
        (
            "My own task",
            "{\"request\":\"task_file\",\"exercise\":\"own\",\"text\":\"",
        ),
    ] {
        harness.get_by_label("Send a task").click();
        harness.run_steps(3);
        // Those of the instructor are the last of the list, below the visible ones.
        harness.get_by_label(title).click_accesskit();
        harness.run_steps(3);
        await_request(&mut broker, &format!("{seats}/a1/request{sent}"));
    }
    // An exam for all: the seat with a board gets none.
    harness.get_by_label("Exam…").click();
    harness.run_steps(3);
    harness.get_by_label("Jog to a position").click();
    harness.get_by_label("PIN").focus();
    harness.run_steps(2);
    let pin = egui::Event::Text("4711".to_owned());
    harness.input_mut().events.push(pin);
    harness.run_steps(3);
    harness.get_by_label("Begin at all seats").click();
    harness.run_steps(3);
    let begin =
        format!("{seats}/a1/request{{\"request\":\"begin_exam\",\"exercises\":[\"02-jog\"]");
    let sent = await_request(&mut broker, &begin);
    assert!(
        !sent.contains("b2/request{\"request\":\"begin_exam"),
        "{sent}"
    );
    assert!(!sent.contains("4711"), "{sent}");
    harness.get_by_label("Join…").click();
    harness.run_steps(3);
    // Without a network no seat can join a broker of this computer.
    let texts = [
        "A seat joins with K7M2@mqtt://",
        "Other computers cannot reach",
    ];
    let shown = |text: &&str| harness.query_all_by_label_contains(text).count() > 0;
    assert!(texts.iter().any(shown));
}

/// Reads what the view sends until a request has arrived; returns all of it.
fn await_request(broker: &mut TcpStream, request: &str) -> String {
    let end = Instant::now() + WAIT;
    let mut received = Vec::new();
    loop {
        let mut bytes = [0; 4096];
        if let Ok(count) = broker.read(&mut bytes) {
            received.extend(&bytes[..count]);
        }
        let text = String::from_utf8_lossy(&received);
        if text.contains(request) {
            return text.into_owned();
        }
        assert!(Instant::now() < end, "{request}: {text}");
    }
}
