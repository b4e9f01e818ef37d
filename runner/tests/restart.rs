//! Restarts at random blocks: the rest of the path and the end state equal those of an
//! uninterrupted run. `RESTART_BLOCKS=500` sets the number of blocks (default 20),
//! `RESTART_SEED=2` draws others.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

#[path = "restart/board.rs"]
mod board;
#[path = "restart/part_position.rs"]
mod part_position;
#[path = "restart/programs.rs"]
mod programs;
#[path = "restart/threads.rs"]
mod threads;
#[path = "restart/words.rs"]
mod words;

use gsk_core::cnc::{ControlRequest, Event};
use gsk_core::command::{ExecutedMove, ProgramId, SourcePosition};
use gsk_core::memory::ToolOffset;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_runner::machining::Machining;
use gsk_runner::machining::guess::{guess_program_job, practice_job};
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::report::modal_codes;
use gsk_runner::restart::{BlockWatcher, RestartWords, find_block, plan_restart};

use programs::{PROGRAMS, TestProgram};

const AUTO_KEY: BitAddress = BitAddress::new(Area::X, 20, 1);
const START_KEY: BitAddress = BitAddress::new(Area::X, 25, 0);
const RESET_KEY: BitAddress = BitAddress::new(Area::X, 26, 0);
const LIMIT: u32 = 3_000_000;
/// Allowed distance of two passes of a thread along the work, mm.
const HELIX_MM: f64 = 0.005;
/// Distance of two points that count as one, mm.
const SAME_MM: f64 = 1e-6;

/// Random numbers that are the same in each run: xorshift.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % end.max(1)
    }
}

/// Reports the begin of a block by its number in the run.
struct BlockNumber(u64);

impl BlockWatcher for BlockNumber {
    fn follow_tick(&mut self, simulation: &Simulation) -> Option<SourcePosition> {
        for event in simulation.cnc.events() {
            if let Event::BlockStarted(source, _) = event {
                self.0 -= 1;
                if self.0 == 0 {
                    return Some(*source);
                }
            }
        }
        None
    }
}

fn setup(program: &TestProgram) -> Setup {
    let mut setup = Setup::default();
    let memory = &mut setup.memory;
    memory.parameters.set_bit(1, 4, true).unwrap();
    memory.parameters.set_bit(2, 1, true).unwrap();
    let has_chuck = program.name == "manual example";
    memory.parameters.set_bit(164, 0, has_chuck).unwrap();
    memory.settings.macro_b = program.macro_b;
    for (number, x, z, r) in [(1, 0.0, 0.0, 0.4), (2, 1.2, -0.8, 0.2), (3, -2.0, 1.5, 0.3)] {
        memory
            .offsets
            .set(number, ToolOffset { x, z, r, t: 3 })
            .unwrap();
    }
    for text in program.subprograms {
        memory.programs.store(*text).expect(program.name);
    }
    memory.programs.open_external(Program::new(program.text));
    memory.programs.select(ProgramId::External);
    setup
}

/// A run with its record.
struct RecordedRun {
    simulation: Simulation,
    part: LivePart,
    /// For each block the number of moves that had ended when it began, and its source.
    blocks: Vec<(usize, SourcePosition)>,
    moves: Vec<ExecutedMove>,
    /// Tick at which each move has ended, as an index of `path`.
    move_ends: Vec<usize>,
    path: Vec<Point>,
    /// Angle of the spindle after each tick, degrees.
    angles: Vec<f64>,
    is_over: bool,
}

impl RecordedRun {
    fn new(simulation: Simulation, part: LivePart) -> Self {
        Self {
            simulation,
            part,
            blocks: Vec::new(),
            moves: Vec::new(),
            move_ends: Vec::new(),
            path: Vec::new(),
            angles: Vec::new(),
            is_over: false,
        }
    }

    fn tick(&mut self) {
        self.simulation.tick();
        self.part.follow_tick(&self.simulation);
        for event in self.simulation.cnc.events() {
            match event {
                Event::BlockStarted(source, _) => self.blocks.push((self.moves.len(), *source)),
                Event::MoveEnded(executed) => {
                    self.moves.push(*executed);
                    self.move_ends.push(self.path.len());
                }
                Event::ProgramEnded { .. } => self.is_over = true,
                Event::AlarmRaised(alarm) => panic!("alarm {}", alarm.line_text_en()),
                _ => {}
            }
        }
        self.path.push(self.simulation.cnc.position_machine());
        (self.angles).push(self.simulation.lathe.spindle_degrees());
    }

    fn press(&mut self, key: BitAddress) {
        for is_down in [true, false] {
            self.simulation.cnc.set_panel_key(key, is_down);
            for _ in 0..100 {
                self.tick();
            }
        }
    }

    /// Runs to the end of the program, or for a number of ticks; M00 is answered.
    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            if self.is_over && !self.simulation.cnc.is_moving() {
                return;
            }
            self.tick();
            let cnc = &self.simulation.cnc;
            if cnc.run_state() == RunState::Stop && !cnc.is_moving() {
                self.press(START_KEY);
            }
            let wait = self.simulation.cnc.active_message();
            assert!(wait.is_none(), "{}", wait.unwrap().line_text_en());
        }
    }

    /// Lets the last outputs settle.
    fn settle(&mut self) {
        for _ in 0..3000 {
            self.tick();
        }
    }
}

/// What must be equal at the end.
fn end_state(run: &RecordedRun) -> String {
    let (cnc, lathe) = (&run.simulation.cnc, &run.simulation.lathe);
    let round = |point: Point| format!("{:.4} {:.4}", point.x, point.z);
    let frame = cnc.frame();
    let variables: Vec<_> = (cnc.variable_numbers().into_iter())
        .map(|number| (cnc.variables().get(number), cnc.real_variable(number)))
        .collect();
    format!(
        "{:?} F{} S{} {:?} T{:?} {} {} {} {} {} spindle {} {:?} {} M{} {} {} {:?} {:?} {:?}",
        modal_codes(cnc.modal()),
        cnc.modal().feed,
        cnc.modal().spindle,
        cnc.modal().m,
        cnc.tool(),
        round(cnc.position_absolute()),
        round(cnc.position_machine()),
        round(cnc.position_relative()),
        round(frame.zero),
        round(frame.offset),
        cnc.spindle().s_word(),
        cnc.spindle().limit(),
        cnc.spindle().is_surface_mode(),
        cnc.spindle_m_code(),
        lathe.is_coolant_on(),
        lathe.is_chuck_clamped(),
        lathe.station(),
        cnc.offsets(),
        variables,
    )
}

/// Greatest distance of the path of `run` from that of `reference`, mm, move by move: the ticks
/// of a move are compared with those of the same move and its neighbours. `first` and
/// `first_reference` are the numbers of the first compared moves.
fn greatest_deviation(
    run: &RecordedRun,
    first: usize,
    reference: &RecordedRun,
    first_reference: usize,
) -> f64 {
    let mut greatest: f64 = 0.0;
    for number in first..run.moves.len() {
        let end_before = |run: &RecordedRun, number: usize| {
            number.checked_sub(1).map_or(0, |it| run.move_ends[it])
        };
        let same = number - first + first_reference;
        let last = (same + 1).min(reference.moves.len() - 1);
        let range = end_before(reference, same.saturating_sub(1))..=reference.move_ends[last];
        let course = &reference.path[range];
        let mut at = 0;
        // The slides follow with a lag of some ticks, in the first move from another one.
        let from = end_before(run, number) + if number == first { 100 } else { 0 };
        for point in run.path.iter().take(run.move_ends[number]).skip(from) {
            let distance = |index: usize| {
                course.get(index + 1).map_or(f64::MAX, |end| {
                    distance_to_segment(*point, course[index], *end)
                })
            };
            // Most points are near the last one.
            let near = (at..at + 50).find(|index| distance(*index) < 1e-4);
            let nearest = near.or_else(|| {
                let by_distance = |a: &usize, b: &usize| distance(*a).total_cmp(&distance(*b));
                (0..course.len()).min_by(by_distance)
            });
            at = nearest.unwrap_or_default();
            greatest = greatest.max(distance(at));
        }
    }
    greatest
}

fn distance_to_segment(point: Point, from: Point, to: Point) -> f64 {
    let along = to - from;
    let length = along.length();
    if length == 0.0 {
        return (point - from).length();
    }
    let at = ((point - from).dot(along) / (length * length)).clamp(0.0, 1.0);
    (point - from - along * at).length()
}

/// Figures of one restart.
#[derive(Default, Debug)]
struct Figures {
    path_mm: f64,
    part_mm3: f64,
    /// Greatest distance of a thread from the helix of the reference, along the work, mm.
    helix_mm: f64,
    /// Restarts of which every way collides.
    refused: usize,
}

impl Figures {
    fn add(&mut self, other: &Self) {
        self.path_mm = self.path_mm.max(other.path_mm);
        self.part_mm3 = self.part_mm3.max(other.part_mm3);
        self.helix_mm = self.helix_mm.max(other.helix_mm);
        self.refused += other.refused;
    }
}

/// Restarts at block number `number` of the reference run, or at a pass of its cycle, and
/// compares. `reach` is the allowed distance of the ends of moves, mm.
fn restart(
    now: &Simulation,
    part: &LivePart,
    reference: &RecordedRun,
    (number, pass): (u64, Option<u64>),
    reach: f64,
) -> Figures {
    let target = find_block(now, Some(part.clone()), &mut BlockNumber(number), pass);
    let target = target.unwrap_or_else(|why| panic!("{}", why.text(gsk_messages::Language::En)));
    let plan = plan_restart(now, target.part.as_ref(), &target, &RestartWords::default());
    // A tool that stands within the part cannot reach its point by rapids of one axis: the
    // restart is refused, and its path is compared without the part.
    let is_refused = plan.is_err();
    let plan = plan.or_else(|why| {
        assert_eq!(why, gsk_messages::say::restart_approach_collision());
        plan_restart(now, None, &target, &RestartWords::default())
    });
    let plan = plan.unwrap_or_else(|why| panic!("{}", why.text(gsk_messages::Language::En)));
    let (moves_before, source) = reference.blocks[number as usize - 1];
    let mut number = number as usize - 1;
    if plan.block != source {
        // A thread begins with its first block.
        while reference.blocks[number].1 != plan.block {
            number -= 1;
        }
    }
    let moves_before = moves_before.min(reference.blocks[number].0);

    let mut run = RecordedRun::new(now.clone(), target.part.expect("a part"));
    let request = ControlRequest::Restart(plan.restart);
    assert_eq!(run.simulation.cnc.request_refusal(&request), None);
    run.simulation.cnc.request(request).unwrap();
    run.press(AUTO_KEY);
    run.press(START_KEY);
    while run.simulation.cnc.has_restart() || run.simulation.cnc.is_moving() {
        assert!(run.path.len() < LIMIT as usize, "no approach");
        run.tick();
    }
    assert_eq!(run.simulation.cnc.run_state(), RunState::Stop);
    assert!(run.blocks.is_empty(), "no block begins in the approach");
    let first_move = run.moves.len();
    run.press(START_KEY);
    run.run(LIMIT);
    assert!(run.is_over, "the program does not end");
    run.settle();

    let sources = |blocks: &[(usize, SourcePosition)]| -> Vec<SourcePosition> {
        blocks.iter().map(|block| block.1).collect()
    };
    // A block that begins at one of its passes has begun before.
    let first_block = number + usize::from(pass.is_some());
    assert_eq!(
        sources(&run.blocks),
        sources(&reference.blocks[first_block..]),
        "blocks"
    );
    let moves = &run.moves[first_move..];
    let skipped = reference.moves.len() - moves.len();
    assert_eq!(skipped > moves_before, pass.is_some(), "number of moves");
    let moves_before = moves_before.max(skipped);
    let expected = &reference.moves[moves_before..];
    assert_eq!(moves.len(), expected.len(), "number of moves");
    for (made, wanted) in moves.iter().zip(expected) {
        let ends = |it: &ExecutedMove| (it.source, it.kind, it.feed, it.conditions.tool);
        assert_eq!(ends(made), ends(wanted));
        assert!(
            (made.from - wanted.from).length() < reach,
            "{made:?} {wanted:?}"
        );
        assert!(
            (made.to - wanted.to).length() < reach,
            "{made:?} {wanted:?}"
        );
        let centers = made.center.zip(wanted.center);
        assert!(centers.is_none_or(|(a, b)| (a - b).length() < 1e-6));
        if let Some((made, wanted)) = made.conditions.thread.zip(wanted.conditions.thread) {
            assert_eq!(made, wanted, "phase of a thread");
        }
    }
    assert_eq!(end_state(&run), end_state(reference), "end state");
    let volume = |run: &RecordedRun| run.part.machining().scene().part().volume();
    Figures {
        refused: usize::from(is_refused),
        helix_mm: threads::greatest_helix_distance(&run, first_move, reference, moves_before),
        path_mm: greatest_deviation(&run, first_move, reference, moves_before),
        part_mm3: match is_refused {
            true => 0.0,
            false => (volume(&run) - volume(reference)).abs(),
        },
    }
}

/// A machine in which RESET has interrupted the program, and the part that a full run begins
/// with.
fn interrupted(program: &TestProgram, random: &mut Random) -> (Simulation, LivePart) {
    let setup = setup(program);
    let job =
        guess_program_job(&setup, &mut |_| true).unwrap_or_else(|| practice_job(&setup.lathe));
    let part = LivePart::new(Machining::new(job));
    let simulation = Simulation::new(setup);
    let mut whole = RecordedRun::new(simulation.clone(), part.clone());
    whole.press(AUTO_KEY);
    whole.press(START_KEY);
    whole.run(LIMIT);
    assert!(whole.is_over, "{} does not end", program.name);
    let length = whole.path.len() as u64;
    let mut run = RecordedRun::new(simulation, part.clone());
    run.press(AUTO_KEY);
    run.press(START_KEY);
    run.run((600 + random.below(length - 1000)) as u32);
    run.press(RESET_KEY);
    run.settle();
    // The operator has moved the tool away from the part.
    if let Some(zero) = run.simulation.cnc.program_zero() {
        let away = Point::new(random.below(20) as f64, random.below(30) as f64);
        run.simulation.place_slides(zero + away);
    }
    (run.simulation, part)
}

/// The uninterrupted run from the state of the interrupted machine.
fn uninterrupted(now: &Simulation, part: &LivePart) -> RecordedRun {
    let mut simulation = now.clone();
    if let Some(zero) = simulation.cnc.program_zero() {
        simulation.place_slides(zero);
    }
    simulation.cnc.request(ControlRequest::CursorTo(1)).unwrap();
    let mut run = RecordedRun::new(simulation, part.clone());
    run.press(AUTO_KEY);
    run.press(START_KEY);
    run.run(LIMIT);
    assert!(run.is_over);
    run.settle();
    run
}

#[test]
fn restarts_at_random_blocks_equal_an_uninterrupted_run() {
    let wanted = std::env::var("RESTART_BLOCKS").ok();
    let wanted: usize = wanted.and_then(|it| it.parse().ok()).unwrap_or(20);
    let only = std::env::var("RESTART_PROGRAM").ok();
    let seed = std::env::var("RESTART_SEED").ok();
    let seed: u64 = seed.and_then(|it| it.parse().ok()).unwrap_or(1);
    let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let mut greatest = Figures::default();
    let mut done = 0;
    for (index, program) in PROGRAMS.iter().enumerate() {
        if only.as_ref().is_some_and(|only| only != program.name) {
            continue;
        }
        let share = wanted / PROGRAMS.len() + usize::from(index < wanted % PROGRAMS.len());
        let (now, part) = interrupted(program, &mut random);
        let reference = uninterrupted(&now, &part);
        let mut worst = Figures::default();
        for _ in 0..share {
            let number = 1 + random.below(reference.blocks.len() as u64);
            println!(
                "{} block {number} {:?}",
                program.name,
                reference.blocks[number as usize - 1].1
            );
            let figures = restart(&now, &part, &reference, (number, None), SAME_MM);
            worst.add(&figures);
            done += 1;
        }
        println!("{}: {share} restarts, {worst:?}", program.name);
        greatest.add(&worst);
    }
    println!("{done} restarts, greatest {greatest:?}");
    assert!(greatest.refused * 10 <= done, "{greatest:?} of {done}");
    assert!(greatest.path_mm < 0.005, "{greatest:?}");
    assert!(greatest.part_mm3 < 1.0, "{greatest:?}");
    assert!(greatest.helix_mm < HELIX_MM, "{greatest:?}");
}
