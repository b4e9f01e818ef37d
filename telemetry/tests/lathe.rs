//! The documents of a lathe, and when they are published.

#![allow(clippy::expect_used, reason = "tests fail by panicking")]

use std::collections::BTreeMap;

use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_messages::Language;
use gsk_mtconnect::{AgentAssets, DeviceDescription, MachineReading, MachineSource};
use gsk_telemetry::{
    DEFAULT_DISCOVERY_PREFIX, DiscoveryOptions, LatheIdentity, LathePublisher, TelemetryMessage,
};
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;
use serde_json::Value;

struct Bench {
    simulation: Simulation,
    publisher: LathePublisher,
    now_ms: u64,
}

impl Bench {
    fn new(discovery: Option<DiscoveryOptions>) -> Self {
        let simulation = Simulation::new(Setup::default());
        let description = DeviceDescription::new(simulation.lathe.config(), &simulation.cnc);
        let identity = LatheIdentity::new("hall/lathe 7", description, Language::En);
        Self {
            simulation,
            publisher: LathePublisher::new(identity, discovery, 4),
            now_ms: 0,
        }
    }

    fn reading(&self) -> MachineReading {
        MachineReading::new(&MachineSource {
            cnc: &self.simulation.cnc,
            lathe: &self.simulation.lathe,
            job: None,
            load: None,
            run_ms: 0,
        })
    }

    /// Passes this time and reads the machine each 20 ms; returns what is published.
    fn run(&mut self, ms: u64) -> Vec<TelemetryMessage> {
        let mut published = Vec::new();
        for _ in 0..ms / 20 {
            for _ in 0..20 {
                self.simulation.tick();
            }
            self.now_ms += 20;
            self.publisher
                .set_reading(1_772_323_200_000 + self.now_ms, self.reading());
            published.extend(self.publisher.take_due(self.now_ms));
        }
        published
    }
}

fn by_topic(messages: &[TelemetryMessage]) -> BTreeMap<&str, Value> {
    let parse = |message: &TelemetryMessage| {
        let text = String::from_utf8_lossy(&message.payload).into_owned();
        serde_json::from_str(&text).unwrap_or(Value::String(text))
    };
    messages
        .iter()
        .map(|it| (it.topic.as_str(), parse(it)))
        .collect()
}

#[test]
fn the_first_messages_are_the_whole_state() {
    let mut bench = Bench::new(None);
    let first = bench.run(20);
    assert!(first.iter().all(|message| message.is_retained));
    let documents = by_topic(&first);
    let levels: Vec<&str> = documents
        .keys()
        .filter_map(|topic| topic.strip_prefix("hall/lathe 7/"))
        .collect();
    let expected = [
        "alarms", "c", "chuck", "control", "device", "lathe", "online", "path", "program", "tools",
        "x", "z",
    ];
    assert_eq!(levels, expected);
    let document = |level: &str| &documents[format!("hall/lathe 7/{level}").as_str()];
    assert_eq!(document("online"), "online");
    assert_eq!(document("path")["execution"], "READY");
    assert_eq!(document("path")["time"], "2026-03-01T00:00:00.020Z");
    assert!(document("x")["x_work"].is_number());
    assert!(document("x")["x_load"].is_null());
    assert_eq!(document("alarms")["count"], 0);
    assert_eq!(document("device")["control"], "GSK980TD");
}

#[test]
fn only_changes_are_published_and_at_a_limited_rate() {
    let mut bench = Bench::new(None);
    bench.run(20);
    // A machine at rest publishes its time counters at most.
    let idle = bench.run(2000);
    let topics = by_topic(&idle);
    assert!(
        topics.keys().all(|topic| *topic == "hall/lathe 7/control"),
        "{topics:?}"
    );
    // Fast changes of one topic: one document at once, then four a second.
    let (mut published, mut newest) = (0, 0);
    for step in 0..100_u64 {
        bench.now_ms += 20;
        let mut reading = bench.reading();
        let index = gsk_mtconnect::model::item_index("x_work").expect("an item");
        reading.values[index] = gsk_mtconnect::AgentValue::Number(step as f64);
        bench.publisher.set_reading(bench.now_ms, reading);
        let due = bench.publisher.take_due(bench.now_ms);
        if let Some(document) = by_topic(&due).get("hall/lathe 7/x") {
            published += 1;
            newest = document["x_work"].as_f64().expect("a number") as u64;
            assert!(published > 1 || step == 0, "{step}");
            assert_eq!(newest, step);
        }
    }
    assert!(
        (8..=9).contains(&published) && newest >= 90,
        "{published} {newest}"
    );
}

#[test]
fn a_new_connection_receives_everything_again() {
    let mut bench = Bench::new(None);
    let first = bench.run(20).len();
    bench.run(1000);
    bench.publisher.forget_published();
    let again = bench.publisher.take_due(bench.now_ms);
    assert_eq!(again.len(), first);
    assert!(bench.publisher.take_due(bench.now_ms).is_empty());
    assert_eq!(&*bench.publisher.farewell().payload, b"offline");
}

#[test]
fn program_and_tools_are_published() {
    let mut bench = Bench::new(None);
    bench.run(20);
    let mut job = Job::new(Stock::bar(40.0, 1.0, 50.0));
    job.tools.insert(3, Tool::turning());
    let program = Program::new("O0001;\nM30;\n");
    let assets = AgentAssets {
        job: Some(job),
        program: Some(("O0001".to_owned(), program)),
    };
    bench.publisher.set_assets(0, assets);
    bench.now_ms += 1000;
    let due = bench.publisher.take_due(bench.now_ms);
    let documents = by_topic(&due);
    assert_eq!(documents["hall/lathe 7/program"]["name"], "O0001");
    assert_eq!(documents["hall/lathe 7/program"]["text"], "O0001;\nM30;\n");
    let tool = &documents["hall/lathe 7/tools"]["tools"][0];
    assert_eq!(tool["number"], 3);
    assert_eq!(tool["tool"]["insert"]["Turning"]["nose"], 0.8);
}

#[test]
fn discovery_describes_existing_members() {
    let prefix = DEFAULT_DISCOVERY_PREFIX.to_owned();
    let mut bench = Bench::new(Some(DiscoveryOptions { prefix }));
    let first = bench.run(20);
    let documents = by_topic(&first);
    let configs: Vec<(&&str, &Value)> = documents
        .iter()
        .filter(|(topic, _)| topic.starts_with("homeassistant/"))
        .collect();
    assert_eq!(configs.len(), 15);
    let mut ids: Vec<&Value> = Vec::new();
    for (topic, config) in configs {
        assert!(
            topic.contains("/hall_lathe_7/") && topic.ends_with("/config"),
            "{topic}"
        );
        let document = &documents[config["state_topic"].as_str().expect("a topic")];
        let template = config["value_template"].as_str().expect("a template");
        let member = template.split("value_json.").nth(1).expect(template);
        let member = member.split([' ', '}']).next().expect(template);
        assert!(document.get(member).is_some(), "{topic}: {member}");
        assert_eq!(config["availability_topic"], "hall/lathe 7/online");
        ids.push(&config["unique_id"]);
    }
    ids.sort_by_key(ToString::to_string);
    ids.dedup();
    assert_eq!(ids.len(), 15);
}
