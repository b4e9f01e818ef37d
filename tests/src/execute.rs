//! Programs through both paths, with results in the form of the command line.

use gsk_core::alarm::{Alarm, AlarmClass};
use gsk_core::cnc::{Cnc, Event};
use gsk_core::command::{ExecutedMove, MoveKind, ProgramId};
use gsk_core::interpreter::Modal;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::preview::{End, preview};
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::{Feed, Point};
use serde_json::{Value, json};

/// 自动, X20.1.
const AUTO: BitAddress = BitAddress::new(Area::X, 20, 1);
/// 运行, X25.0.
const CYCLE_START: BitAddress = BitAddress::new(Area::X, 25, 0);
/// How long a key is held and rests, ticks.
const KEY_TICKS: u32 = 100;
/// Machine time after which a run is given up, ticks.
const LIMIT: u64 = 1_800_000;
/// What the axes may take to come to rest after an alarm, ticks.
const REST: u64 = 5000;

/// What a path saw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// The moves, in execution order.
    pub moves: Vec<Value>,
    /// The result; what a path does not know is left out.
    pub result: Value,
}

/// A number without the noise of the last bits.
fn rounded(value: f64) -> f64 {
    let rounded = (value * 1e6).round() / 1e6;
    if rounded == 0.0 { 0.0 } else { rounded }
}

fn pair(point: Point) -> Value {
    json!([rounded(point.diameter().0), rounded(point.z)])
}

/// A move as one JSON object.
pub fn move_json(executed: &ExecutedMove) -> Value {
    let mut value = json!({
        "line": executed.source.line,
        "n": executed.source.sequence,
        "kind": executed.kind.name(),
        "x0": rounded(executed.from.diameter().0),
        "z0": rounded(executed.from.z),
        "x": rounded(executed.to.diameter().0),
        "z": rounded(executed.to.z),
        "dt": rounded(executed.duration_s),
    });
    if let Some(center) = executed.center {
        value["cx"] = json!(rounded(center.diameter().0));
        value["cz"] = json!(rounded(center.z));
    }
    match executed.feed {
        Some(Feed::PerMinute(feed)) => {
            value["feed"] = json!(rounded(feed));
            value["per"] = json!("min");
        }
        Some(Feed::PerRevolution(lead)) if executed.kind.is_thread() => {
            value["lead"] = json!(rounded(lead));
        }
        Some(Feed::PerRevolution(feed)) => {
            value["feed"] = json!(rounded(feed));
            value["per"] = json!("rev");
        }
        None => {}
    }
    value
}

/// Moves of no length are left out, as the command line does.
fn counts(executed: &ExecutedMove) -> bool {
    executed.kind == MoveKind::Dwell || executed.center.is_some() || executed.from != executed.to
}

fn alarm_json(alarm: Option<&Alarm>) -> Value {
    let Some(alarm) = alarm else {
        return Value::Null;
    };
    let class = match alarm.class() {
        AlarmClass::Ps => "PS",
        AlarmClass::System => "SYS",
        AlarmClass::Overtravel => "OT",
        AlarmClass::EmergencyStop => "ESTOP",
        AlarmClass::Servo => "SERVO",
        AlarmClass::Link => "LINK",
        AlarmClass::Plc => "PLC",
    };
    let program = alarm.source.map(|source| match source.program {
        ProgramId::Stored(number) => format!("O{number:04}"),
        ProgramId::External => "external".to_owned(),
        ProgramId::Mdi => "MDI".to_owned(),
    });
    json!({
        "class": class,
        "number": alarm.number,
        "text": alarm.text(),
        "line": alarm.source.map(|source| source.line),
        "n": alarm.source.and_then(|source| source.sequence),
        "program": program,
        "detail": alarm.detail,
    })
}

fn modal_json(modal: &Modal) -> Value {
    json!([
        format!("G{:02}", modal.motion),
        if modal.surface_speed { "G96" } else { "G97" },
        if modal.feed_per_revolution {
            "G99"
        } else {
            "G98"
        },
        format!("G{}", modal.nose_compensation),
    ])
}

/// The path of `check`.
pub fn check(setup: &Setup) -> Seen {
    let mut moves = Vec::new();
    let seen = preview(setup, &setup.programs, &mut |executed| {
        if counts(executed) {
            moves.push(move_json(executed));
        }
    });
    let result = json!({
        "end": match seen.end {
            End::M30 => "M30",
            End::M99 => "M99",
            End::Text => "EOF",
            End::Alarm => "alarm",
            End::Limit => "limit",
        },
        "alarm": alarm_json(seen.alarm.as_ref()),
        "time_s": seen.time_s,
        "blocks": seen.blocks,
        "stops": seen.stops,
        "parts": seen.parts,
        "final": {
            "abs": pair(seen.absolute),
            "machine": pair(seen.machine),
            "rel": pair(seen.relative),
        },
        "modal": modal_json(&seen.modal),
        "coolant": seen.coolant,
    });
    Seen { moves, result }
}

/// The path of `run`.
pub fn run(setup: &Setup) -> Seen {
    let mut run = Run::new(Simulation::new(setup.clone()));
    run.press(AUTO);
    run.press(CYCLE_START);
    while run.end.is_none() && run.simulation.cnc.ticks() < LIMIT {
        run.tick();
        let cnc = &run.simulation.cnc;
        if run.end.is_none() && cnc.run_state() == RunState::Stop && !cnc.is_moving() {
            run.stops += 1;
            run.press(CYCLE_START);
        }
    }
    // M99 goes on for ever: what is seen is the moment of its end.
    for _ in 0..REST {
        if run.end == Some("M99") || !run.simulation.cnc.is_moving() {
            break;
        }
        run.tick();
    }
    run.seen()
}

struct Run {
    simulation: Simulation,
    moves: Vec<Value>,
    alarm: Option<Alarm>,
    end: Option<&'static str>,
    parts: u32,
    stops: u32,
    blocks: u64,
}

impl Run {
    const fn new(simulation: Simulation) -> Self {
        Self {
            simulation,
            moves: Vec::new(),
            alarm: None,
            end: None,
            parts: 0,
            stops: 0,
            blocks: 0,
        }
    }

    fn press(&mut self, key: BitAddress) {
        for down in [true, false] {
            self.simulation.cnc.set_panel_key(key, down);
            for _ in 0..KEY_TICKS {
                self.tick();
            }
        }
    }

    fn tick(&mut self) {
        self.simulation.tick();
        for event in self.simulation.cnc.events() {
            match event {
                Event::Moved(executed) if counts(executed) => {
                    self.moves.push(move_json(executed));
                }
                Event::BlockEnded(_) => self.blocks += 1,
                Event::Moved(_) | Event::BlockBegan(..) | Event::Explained(_) => {}
                Event::AlarmRaised(alarm) => {
                    self.end.get_or_insert("alarm");
                    self.alarm.get_or_insert_with(|| alarm.clone());
                }
                Event::PartFinished => {
                    self.parts += 1;
                    // M30 says so itself in the same tick.
                    let ended = self.simulation.cnc.events().iter();
                    let by_m30 = ended
                        .clone()
                        .any(|event| matches!(event, Event::ProgramEnded { .. }));
                    if !by_m30 && self.simulation.cnc.run_state() == RunState::Run {
                        self.end.get_or_insert("M99");
                    }
                }
                Event::ProgramEnded { m30 } => {
                    self.end.get_or_insert(if *m30 { "M30" } else { "EOF" });
                }
            }
        }
    }

    fn seen(self) -> Seen {
        let cnc: &Cnc = &self.simulation.cnc;
        let y = |byte, bit| cnc.plc().memory().bit(BitAddress::new(Area::Y, byte, bit));
        let (tool, offset) = cnc.tool();
        let result = json!({
            "end": self.end.unwrap_or("limit"),
            "alarm": alarm_json(self.alarm.as_ref()),
            "blocks": self.blocks,
            "stops": self.stops,
            "parts": self.parts,
            "final": {
                "abs": pair(cnc.position_absolute()),
                "machine": pair(cnc.position_machine()),
                "rel": pair(cnc.position_relative()),
            },
            "modal": modal_json(cnc.modal()),
            "t": format!("{tool:02}{offset:02}"),
            "spindle": if y(1, 2) { "cw" } else if y(0, 4) { "ccw" } else { "stop" },
            "coolant": y(0, 3),
        });
        Seen {
            moves: self.moves,
            result,
        }
    }
}
