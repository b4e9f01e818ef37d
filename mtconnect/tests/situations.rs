//! The documents of twelve situations of a simulated lathe. With `MTCONNECT_FOLDER` they are also
//! written there, for `tests/oracles/mtconnect_schemas.py`.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "tests fail by panicking"
)]

use std::path::{Path, PathBuf};

use gsk_core::machine::LatheFault;
use gsk_core::setup::Setup;
use gsk_mtconnect::model::DATA_ITEMS;
use gsk_mtconnect::query::{AssetQuery, CurrentQuery, ErrorCode, SampleQuery};
use gsk_mtconnect::{
    Agent, AgentAssets, AgentError, AgentIdentity, AgentRequest, DeviceDescription, MachineLoad,
    MachineReading, MachineSource, SchemaVersion, program_name,
};
use gsk_panel::emulator::{Emulator, WaitCondition, WaitOutcome};
use gsk_panel::keys::Key;
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;

/// The moment at which the agents start, ms since 1970.
const START_MS: u64 = 1_772_323_200_000;
const PROGRAM: &str = "O0007;\nN10 G50 X100 Z100;\nN20 M03 S500;\nN30 T0101;\n\
    N40 G00 X40 Z2;\nN50 G98 G01 Z-30 F60;\n(a <comment> & \"more\") N60 G00 X100 Z100;\nN70 M30;\n";

/// A lathe with its agents, one for each version of the schemas.
struct Bench {
    emulator: Emulator,
    agents: Vec<Agent>,
    job: Option<Job>,
    ticks: u64,
    folder: Option<PathBuf>,
}

impl Bench {
    fn new(setup: Setup) -> Self {
        let emulator = Emulator::new(setup);
        let agents = SchemaVersion::ALL.map(|schema| {
            let simulation = emulator.simulation();
            let description = DeviceDescription::new(simulation.lathe.config(), &simulation.cnc);
            let address = "127.0.0.1:5000";
            Agent::new(AgentIdentity::new(description, schema, address, START_MS))
        });
        let mut bench = Self {
            emulator,
            agents: agents.into(),
            job: None,
            ticks: 0,
            folder: std::env::var_os("MTCONNECT_FOLDER").map(PathBuf::from),
        };
        bench.run(1000);
        bench
    }

    fn now_ms(&self) -> u64 {
        START_MS + self.ticks
    }

    fn observe(&mut self) {
        let simulation = self.emulator.simulation();
        let reading = MachineReading::new(&MachineSource {
            cnc: &simulation.cnc,
            lathe: &simulation.lathe,
            job: self.job.as_ref(),
            load: Some(MachineLoad {
                spindle: 41.26,
                x: 3.0,
                z: 12.34,
            }),
            run_ms: self.ticks,
        });
        let now_ms = self.now_ms();
        for agent in &mut self.agents {
            agent.record(now_ms, reading.clone());
        }
    }

    fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.emulator.tick();
            self.ticks += 1;
            if self.ticks.is_multiple_of(20) {
                self.observe();
            }
        }
    }

    fn press(&mut self, key: Key) {
        self.emulator.key_down(key);
        self.run(100);
        self.emulator.key_up(key);
        self.run(100);
    }

    fn wait(&mut self, condition: &WaitCondition) {
        for _ in 0..3000 {
            if self.emulator.run_until(condition, 0) == WaitOutcome::Reached {
                return self.run(200);
            }
            self.run(20);
        }
        panic!("{condition:?}");
    }

    /// Stores the program and its job, and passes both on as assets.
    fn load(&mut self, text: &str) {
        self.emulator.load_program("part", text).expect("stored");
        let mut job = Job::new(Stock::bar(50.0, 1.0, 60.0));
        job.tools.insert(1, Tool::turning());
        job.tools.insert(2, Tool::grooving(3.0));
        job.tools.insert(3, Tool::threading(60.0));
        job.tools.insert(4, Tool::drill(8.5));
        self.job = Some(job);
        self.pass_assets();
    }

    fn pass_assets(&mut self) {
        let cnc = self.emulator.cnc();
        let id = cnc.programs().selected().expect("a program");
        let program = cnc.programs().get(id).expect("a program").clone();
        let assets = AgentAssets {
            job: self.job.clone(),
            program: Some((program_name(cnc, id), program)),
        };
        let now_ms = self.now_ms();
        for agent in &mut self.agents {
            agent.set_assets(now_ms, &assets);
        }
    }

    /// Checks that the state has each of these texts, and writes the documents of the situation.
    fn check(&mut self, situation: &str, expected: &[&str]) {
        self.observe();
        for agent in &self.agents {
            let now_ms = START_MS + self.ticks;
            let current = agent.current(&CurrentQuery::default(), now_ms).unwrap();
            for text in expected {
                assert!(current.contains(text), "{situation}: {text}\n{current}");
            }
            let documents = [
                ("Devices", agent.probe(now_ms)),
                ("Streams", current),
                ("Streams", all_observations(agent, now_ms)),
                ("Assets", agent.assets(&all_assets(), now_ms).unwrap()),
                ("Error", error_document(agent, now_ms)),
            ];
            let schema = agent.identity().schema;
            if let Some(folder) = &self.folder {
                for (index, (kind, text)) in documents.iter().enumerate() {
                    write(
                        folder,
                        &format!("{situation}-{index}.{kind}_{schema}.xml"),
                        text,
                    );
                }
            }
        }
    }
}

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::create_dir_all(folder).unwrap();
    std::fs::write(folder.join(name), text).unwrap();
}

fn all_assets() -> AssetQuery {
    AssetQuery {
        ids: Vec::new(),
        asset_type: None,
        with_removed: true,
        count: 1000,
    }
}

fn sample_query(parameters: &str) -> SampleQuery {
    match AgentRequest::parse("/sample", parameters, "lathe") {
        Ok(AgentRequest::Sample(query)) => query,
        other => panic!("{other:?}"),
    }
}

/// The last observations, and a check that a client reads each exactly once.
fn all_observations(agent: &Agent, now_ms: u64) -> String {
    let mut next = None;
    let mut sequences = Vec::new();
    let query = sample_query("count=37");
    loop {
        let document = agent.sample(&query, next, now_ms).unwrap();
        let found = document.text.split(" sequence=\"").skip(1);
        let mut numbers: Vec<u64> = found
            .map(|rest| rest.split('"').next().unwrap().parse().unwrap())
            .collect();
        numbers.sort_unstable();
        sequences.extend(numbers);
        next = Some(document.next_sequence);
        if !document.has_observations {
            break;
        }
    }
    assert!(sequences.iter().copied().eq(1..agent.next_sequence()));
    let query = sample_query("count=4000");
    agent.sample(&query, None, now_ms).unwrap().text
}

fn error_document(agent: &Agent, now_ms: u64) -> String {
    let query = sample_query("from=18446744073709551615");
    let error = agent.sample(&query, None, now_ms).unwrap_err();
    assert_eq!(error.code, ErrorCode::OutOfRange);
    agent.error(&error, now_ms)
}

#[test]
fn a_lathe_after_power_on_is_ready() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.check(
        "power-on",
        &[
            ">AVAILABLE</Availability>",
            ">READY</Execution>",
            ">ARMED</EmergencyStop>",
            "componentId=\"path\"",
            "<Normal dataItemId=\"motion\"",
            "<Normal dataItemId=\"x_drive\"",
        ],
    );
}

#[test]
fn a_jogged_axis_moves() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.press(Key::Jog);
    let start = bench.emulator.cnc().position_machine().z;
    bench.emulator.key_down(Key::ZLeft);
    bench.run(500);
    let z = bench.emulator.cnc().position_machine().z;
    assert!(z < start);
    bench.check("jog", &[">MANUAL</ControllerMode>", ">READY</Execution>"]);
    let items = AgentRequest::parse("/current", "path=//DataItem[@id='z_machine']", "lathe");
    let Ok(AgentRequest::Current(query)) = items else {
        panic!("{items:?}");
    };
    let agent = &bench.agents[0];
    let document = agent.current(&query, bench.now_ms()).unwrap();
    assert_eq!(document.matches(" sequence=").count(), 1);
    let value = document.split("subType=\"ACTUAL\">").nth(1).unwrap();
    let value: f64 = value.split('<').next().unwrap().parse().unwrap();
    // A sample is recorded ten times a second.
    assert!(value < start && (value - z).abs() < 5.0, "{value} {z}");
}

#[test]
fn a_running_program_is_active_at_its_block_and_ends() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.load(PROGRAM);
    bench.press(Key::Auto);
    bench.press(Key::CycleStart);
    bench.wait(&WaitCondition::Text("G01".to_owned()));
    while bench.emulator.cnc().cursor().line != 6 {
        bench.run(20);
    }
    bench.run(1500);
    bench.check(
        "cut",
        &[
            ">ACTIVE</Execution>",
            ">AUTOMATIC</ControllerMode>",
            ">O0007</Program>",
            ">N50 G98 G01 Z-30 F60;</Block>",
            ">6</LineNumber>",
            ">N0050</LineLabel>",
            ">1</ToolNumber>",
            ">T01</ToolAssetId>",
            "subType=\"PROGRAMMED\">1</PathFeedrate>",
            "subType=\"ACTUAL\">1</PathFeedrate>",
            ">500</RotaryVelocity>",
            ">CLOCKWISE</Direction>",
            ">41.3</Load>",
            ">3</Load>",
            ">12.3</Load>",
        ],
    );
    bench.wait(&WaitCondition::Stopped);
    bench.check(
        "end",
        &[
            ">READY</Execution>",
            "subType=\"ALL\">1</PartCount>",
            "subType=\"ACTUAL\">0</PathFeedrate>",
        ],
    );
    let agent = &bench.agents[0];
    let all = all_observations(agent, bench.now_ms());
    assert!(
        all.contains("(a &lt;comment&gt; &amp; &quot;more&quot;)"),
        "{all}"
    );
}

#[test]
fn feed_hold_and_single_block_interrupt_a_program() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.load(PROGRAM);
    bench.press(Key::Auto);
    bench.press(Key::CycleStart);
    while bench.emulator.cnc().cursor().line != 6 {
        bench.run(20);
    }
    bench.run(1000);
    bench.press(Key::FeedHold);
    bench.check("feed-hold", &[">FEED_HOLD</Execution>"]);
    bench.press(Key::SingleBlock);
    bench.press(Key::CycleStart);
    bench.wait(&WaitCondition::Stopped);
    bench.check(
        "single-block",
        &[
            ">INTERRUPTED</Execution>",
            "subType=\"SINGLE_BLOCK\">ON</ControllerModeOverride>",
        ],
    );
}

#[test]
fn an_alarm_of_a_program_is_a_fault_until_reset() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.load("O0008;\nG01 X10;\nM30;\n");
    bench.press(Key::Auto);
    bench.press(Key::CycleStart);
    bench.wait(&WaitCondition::Alarm);
    let number = bench.emulator.cnc().alarms()[0].number;
    let fault = format!("type=\"MOTION_PROGRAM\" nativeCode=\"{number}\"");
    bench.check("program-alarm", &["<Fault dataItemId=\"motion\"", &fault]);
    bench.press(Key::Reset);
    bench.check(
        "after-reset",
        &["<Normal dataItemId=\"motion\"", ">READY</Execution>"],
    );
}

#[test]
fn an_emergency_stop_is_triggered_and_armed_again() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.press(Key::EmergencyStop);
    bench.run(500);
    bench.check(
        "emergency-stop",
        &[
            ">TRIGGERED</EmergencyStop>",
            "<Fault dataItemId=\"system\"",
            ">STOPPED</Execution>",
        ],
    );
    bench.press(Key::EmergencyStop);
    bench.press(Key::Reset);
    bench.run(500);
    let text = bench.agents[0].current(&CurrentQuery::default(), bench.now_ms());
    assert!(text.unwrap().contains(">ARMED</EmergencyStop>"));
}

#[test]
fn a_drive_alarm_is_a_fault_of_its_axis() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.emulator.set_fault(LatheFault::DriveZ, true);
    bench.run(500);
    bench.check(
        "drive-alarm",
        &[
            "<Fault dataItemId=\"z_drive\"",
            "nativeCode=\"222\"",
            "<Normal dataItemId=\"x_drive\"",
        ],
    );
}

#[test]
fn a_message_of_the_ladder_is_a_warning() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.load("O0009;\nT0202;\nM30;\n");
    bench.emulator.set_fault(LatheFault::TurretBlocked, true);
    bench.press(Key::Auto);
    bench.press(Key::CycleStart);
    bench.wait(&WaitCondition::Alarm);
    bench.check(
        "ladder-message",
        &[
            "<Warning dataItemId=\"logic\"",
            "<Message dataItemId=\"message\"",
        ],
    );
}

#[test]
fn a_typed_block_runs_as_manual_data_input() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.press(Key::Mdi);
    bench.press(Key::Program);
    bench.check("mdi", &[">MANUAL_DATA_INPUT</ControllerMode>"]);
}

#[test]
fn another_job_changes_and_removes_assets() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.load(PROGRAM);
    bench.observe();
    if let Some(job) = &mut bench.job {
        job.tools.remove(&4);
        job.tools.insert(1, Tool::boring());
    }
    bench.pass_assets();
    bench.check(
        "assets",
        &[
            "assetType=\"CuttingTool\">T01</AssetChanged>",
            "assetType=\"CuttingTool\">T04</AssetRemoved>",
        ],
    );
    let agent = &bench.agents[0];
    let query = |ids: &[&str]| AssetQuery {
        ids: ids.iter().copied().map(str::to_owned).collect(),
        ..all_assets()
    };
    let text = agent.assets(&query(&["T04", "O0007"]), START_MS).unwrap();
    assert!(
        text.contains("removed=\"true\"") && text.contains("/programs/O0007"),
        "{text}"
    );
    let missing: Result<String, AgentError> = agent.assets(&query(&["T99"]), START_MS);
    assert_eq!(missing.unwrap_err().code, ErrorCode::AssetNotFound);
    assert_eq!(agent.program_text("O0007").as_deref(), Some(PROGRAM));
}

#[test]
fn the_past_is_read_at_each_sequence_number() {
    let mut bench = Bench::new(Setup::for_operator_script());
    bench.press(Key::Jog);
    let agent = &bench.agents[0];
    let now_ms = bench.now_ms();
    let at = |sequence: u64| {
        let query = CurrentQuery {
            at: Some(sequence),
            ..CurrentQuery::default()
        };
        agent.current(&query, now_ms)
    };
    let last = agent.next_sequence() - 1;
    let unavailable = DATA_ITEMS.len() as u64;
    assert!(
        at(unavailable)
            .unwrap()
            .contains(">UNAVAILABLE</Availability>")
    );
    assert!(at(last).unwrap().contains(">MANUAL</ControllerMode>"));
    assert_eq!(at(last + 1).unwrap_err().code, ErrorCode::OutOfRange);
    assert_eq!(at(0).unwrap_err().code, ErrorCode::OutOfRange);
    for sequence in 1..=last {
        let text = at(sequence).unwrap();
        let numbers = text.split(" sequence=\"").skip(1);
        let largest = numbers.map(|rest| rest.split('"').next().unwrap().parse::<u64>().unwrap());
        assert_eq!(largest.max(), Some(sequence));
    }
}
