//! DNC operation: a program arrives through the serial port while it runs.

use gsk_core::cnc::Event;
use gsk_core::command::ExecutedMove;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::setup::{Setup, dnc_teach_ladder};
use gsk_core::simulation::Simulation;

const AUTO: BitAddress = BitAddress::new(Area::X, 20, 1);
const START: BitAddress = BitAddress::new(Area::X, 25, 0);
const RESET: BitAddress = BitAddress::new(Area::X, 26, 0);

/// A control on one end of the line, a text on the other.
struct DncBench {
    simulation: Simulation,
    partner: Box<dyn Iterator<Item = u8>>,
    /// Pause after each character, ticks.
    pause: u64,
    moves: Vec<ExecutedMove>,
    ended: bool,
}

impl DncBench {
    fn new(setup: Setup, partner: Box<dyn Iterator<Item = u8>>) -> Self {
        let setup = Setup {
            ladder: dnc_teach_ladder().into(),
            ..setup
        };
        let mut simulation = Simulation::new(setup);
        simulation.cnc.set_dnc_partner(true);
        Self {
            simulation,
            partner,
            pause: 0,
            moves: Vec::new(),
            ended: false,
        }
    }

    fn tick(&mut self) {
        let now = self.simulation.cnc.ticks();
        let due = self.pause == 0 || now.is_multiple_of(self.pause);
        while due && self.simulation.cnc.dnc_free_characters() > 0 {
            let Some(byte) = self.partner.next() else {
                self.simulation.cnc.end_dnc();
                break;
            };
            assert_eq!(self.simulation.cnc.receive_dnc(&[byte]), 1);
            if self.pause > 0 {
                break;
            }
        }
        self.simulation.tick();
        for event in self.simulation.cnc.events() {
            match event {
                Event::MoveEnded(executed) => self.moves.push(*executed),
                Event::ProgramEnded { .. } => self.ended = true,
                _ => {}
            }
        }
    }

    fn press(&mut self, key: BitAddress) {
        for down in [true, false] {
            self.simulation.cnc.set_panel_key(key, down);
            for _ in 0..100 {
                self.tick();
            }
        }
    }

    fn start_dnc(&mut self) {
        for _ in 0..100 {
            self.tick();
        }
        self.press(AUTO);
        self.press(AUTO);
        assert_eq!(self.simulation.cnc.mode(), OperatingMode::Dnc);
        self.press(START);
    }

    fn run_to_end(&mut self, limit: u64) {
        for _ in 0..limit {
            if self.ended {
                return;
            }
            self.tick();
            assert_eq!(self.simulation.cnc.alarms(), []);
        }
        panic!("no end within {limit} ms");
    }
}

/// The moves of the blocks, without their times, which depend on the line.
fn move_texts(moves: &[ExecutedMove]) -> Vec<String> {
    let path = moves.iter().map(|m| {
        let (line, kind) = (m.source.line, m.kind.name());
        format!(
            "{line} {kind} {:?} {:?} {:?} {:?}",
            m.from, m.to, m.center, m.feed
        )
    });
    path.collect()
}

fn setup_with_nose() -> Setup {
    let mut setup = Setup::default();
    setup.memory.parameters.set_bit(2, 1, true).unwrap();
    setup
        .memory
        .offsets
        .set(
            1,
            gsk_core::memory::ToolOffset {
                x: 0.0,
                z: 0.0,
                r: 0.8,
                t: 3,
            },
        )
        .unwrap();
    setup
}

/// Everything with an effect beyond its own block: corners, successive threads, compensation,
/// skipped and empty blocks, a call.
const PART: &str = "%
O0007;
N10 G00 X60 Z2 T0101 S400 M03;
G42 G01 X20 Z0 F600;
(a comment)
G01 Z-10;
X30;

G01 Z-20;
X40 Z-25;
G02 X50 Z-30 R5;
G40 G00 X60;
;
G00 X42 Z-18;
G01 Z-20 R2 F300;
(between)
X46;
G00 X42 Z-20;
G32 X42 Z-24 F1.5;
(between)
X44 Z-26;
G00 X60 Z2;
M98 P20009;
G90 X38 Z-5 F400;
X36;
G65 H01 P#200 Q3;
G65 H02 P#201 Q#200 R4;
G00 X#201 Z10;
M30;
%
G00 X0 Z0;
";

const CALLED: &str = "O0009;
G71 U2 R0.5;
G71 P10 Q20 U0.2 W0.1 F300;
N10 G00 X50;
N20 G01 Z-5;
G65 H80 P30;
G00 X1;
N30 M99;
";

fn setup_of(part: &str) -> Setup {
    let mut setup = setup_with_nose();
    setup.memory.programs.store(CALLED).unwrap();
    setup.memory.programs.store(part).unwrap();
    setup
}

#[test]
fn a_received_program_runs_like_a_stored_one() {
    let mut stored = DncBench::new(setup_of(PART), Box::new(core::iter::empty()));
    let stored_program = gsk_core::cnc::ControlRequest::SelectProgram(7);
    stored.simulation.cnc.request(stored_program).unwrap();
    stored.press(AUTO);
    stored.press(START);
    stored.run_to_end(600_000);
    assert!(stored.moves.len() > 30, "{}", stored.moves.len());
    for (baud, pause) in [(115_200, 0), (4800, 0), (115_200, 7)] {
        let mut setup = setup_of("O0001;\nM30;\n");
        setup.memory.parameters.set(44, baud).unwrap();
        let mut coming = DncBench::new(setup, Box::new(PART.bytes()));
        coming.pause = pause;
        coming.start_dnc();
        coming.run_to_end(600_000);
        assert_eq!(
            move_texts(&coming.moves),
            move_texts(&stored.moves),
            "{baud} {pause}"
        );
        assert_eq!(coming.simulation.cnc.counters().parts, 1);
        assert_eq!(coming.simulation.cnc.run_state(), RunState::Reset);
    }
}

/// Endless blocks, each with a different position.
fn endless_blocks() -> Box<dyn Iterator<Item = u8>> {
    let lines = (1_u64..).flat_map(|count| {
        let z = (count % 50) as f64 / 10.0;
        let line = format!(
            "N{} G01 X{} Z-{z:.1} F6000 (no {count});\n",
            count % 10_000,
            count % 7
        );
        line.into_bytes()
    });
    Box::new("O1234;\nG00 X10 Z1;\n".bytes().chain(lines))
}

#[test]
fn an_endless_program_runs_in_bounded_memory() {
    let mut line = DncBench::new(Setup::default(), endless_blocks());
    line.start_dnc();
    let mut sizes = Vec::new();
    while line.moves.len() < 1500 {
        line.tick();
        assert_eq!(line.simulation.cnc.alarms(), []);
        if line.simulation.cnc.ticks().is_multiple_of(5_000) {
            // The whole state.
            sizes.push(format!("{:?}", line.simulation).len());
        }
    }
    let last = line.moves.last().unwrap();
    assert_eq!(last.source.line as usize, line.moves.len() + 1);
    assert!(sizes.len() > 5, "{sizes:?}");
    let (least, most) = (sizes.iter().min().unwrap(), sizes.iter().max().unwrap());
    assert!(most - least < 32_768, "{sizes:?}");
}

#[test]
fn the_partner_waits_while_the_program_waits() {
    let mut line = DncBench::new(Setup::default(), endless_blocks());
    line.start_dnc();
    for _ in 0..5000 {
        line.tick();
    }
    let hold = BitAddress::new(Area::X, 24, 7);
    line.press(hold);
    for _ in 0..10_000 {
        line.tick();
    }
    assert_eq!(line.simulation.cnc.run_state(), RunState::Hold);
    // The buffer is full, and the control requests no more.
    assert_eq!(line.simulation.cnc.dnc_free_characters(), 0);
    let stood = line.moves.len();
    line.press(START);
    for _ in 0..2000 {
        line.tick();
    }
    assert!(line.moves.len() > stood);
    assert_eq!(line.simulation.cnc.alarms(), []);
}

#[test]
fn reset_closes_the_line_and_the_next_start_reopens_it() {
    let mut line = DncBench::new(Setup::default(), endless_blocks());
    line.start_dnc();
    assert_eq!(line.simulation.cnc.dnc_request_count(), 1);
    for _ in 0..3000 {
        line.tick();
    }
    line.press(RESET);
    assert!(line.simulation.cnc.programs().dnc_buffer().is_none());
    assert_eq!(line.simulation.cnc.dnc_free_characters(), 0);
    let stood = line.moves.len();
    // The partner sends from the beginning again.
    line.partner = endless_blocks();
    line.press(START);
    assert_eq!(line.simulation.cnc.dnc_request_count(), 2);
    for _ in 0..1000 {
        line.tick();
    }
    assert_eq!(line.moves[stood].source.line, 2);
}

#[test]
fn a_line_that_breaks_stops_the_axes_with_alarm_086() {
    let mut line = DncBench::new(Setup::default(), endless_blocks());
    line.start_dnc();
    for _ in 0..1000 {
        line.tick();
    }
    assert_eq!(line.simulation.cnc.run_state(), RunState::Run);
    line.simulation.cnc.set_dnc_partner(false);
    let numbers: Vec<u16> = line
        .simulation
        .cnc
        .alarms()
        .iter()
        .map(|a| a.number)
        .collect();
    assert_eq!(numbers, [86]);
    for _ in 0..500 {
        line.tick();
    }
    assert!(!line.simulation.cnc.is_moving());
    assert!(line.simulation.cnc.programs().dnc_buffer().is_none());
}
