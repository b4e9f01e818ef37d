//! Twenty programs that hit something, each at its block, and twenty that hit nothing.
//!
//! All of them work on the same stock with the same tools:
//!
//! ```text
//!   jaws, chuck                    T01 turning, T02 boring bar, T03 grooving 3 mm,
//!   █████┌──────────────────┐      T04 threading, T05 drill of 10
//!        │ bar 50, 70 out   0
//! ```

use gsk_core::preview::preview;
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::{command::ProgramId, units::Diameter};
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::{Finding, Machining};
use gsk_workpiece::collision::{Obstacle, TouchingPart};
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::{Form, Stock, Tailstock};
use gsk_workpiece::tool::{BodyPart, Holder, Tool};

const TURRET: TouchingPart = TouchingPart::Body(BodyPart::Turret);
const HOLDER: TouchingPart = TouchingPart::Body(BodyPart::Holder);
const BACK: TouchingPart = TouchingPart::Body(BodyPart::InsertBack);

/// What the program begins with: the spindle turns.
const HEAD: &str = "G50 X100 Z50\nG97 M03 S500\nG98\n";

fn job() -> Job {
    let mut job = Job::new(Stock {
        length: 110.0,
        ..Stock::bar(50.0, 0.0, 70.0)
    });
    job.tools.insert(1, Tool::turning());
    job.tools.insert(2, Tool::boring());
    job.tools.insert(3, Tool::grooving(3.0));
    job.tools.insert(4, Tool::threading(60.0));
    job.tools.insert(5, Tool::drill(10.0));
    job
}

/// The same with a bore of 20, and with a tailstock.
fn tube() -> Job {
    let mut job = job();
    job.stock.form = Form::Tube {
        diameter: Diameter(50.0),
        bore: Diameter(20.0),
    };
    job
}

/// A bore in which the bar touches the other wall.
fn narrow() -> Job {
    let mut job = tube();
    job.stock.form = Form::Tube {
        diameter: Diameter(50.0),
        bore: Diameter(12.0),
    };
    job
}

fn with_tailstock() -> Job {
    let mut job = job();
    job.stock.tailstock = Some(Tailstock {
        quill: Diameter(40.0),
        center: Diameter(8.0),
    });
    job
}

fn findings(job: Job, head: &str, text: &str) -> Vec<Finding> {
    let mut setup = Setup::default();
    let mut programs = ProgramMemory::default();
    programs.open_external(Program::new(format!("{head}{text}\nM30\n")));
    programs.select(ProgramId::External);
    setup.memory.programs = programs;
    setup.memory.parameters.set(84, 8).unwrap();
    job.check().unwrap();
    let mut machining = Machining::new(job);
    let rates = RapidRates::of(&setup.memory);
    let result = preview(&setup, &setup.memory.programs, &mut |executed| {
        machining.moved(executed, rates);
    });
    assert_eq!(result.alarm, None, "{text}");
    machining.findings().to_vec()
}

/// The program, the block of its first collision (the line after the head, from 1), and
/// what touches what.
type Case = (fn() -> Job, &'static str, u32, TouchingPart, Obstacle);

const CRASHES: [Case; 20] = [
    // Rapids through the stock: along, in from the front, across, into a shoulder.
    (
        job,
        "T0101\nG00 X40 Z2\nG00 Z-20",
        3,
        TouchingPart::RapidInsert,
        Obstacle::Stock,
    ),
    (
        job,
        "T0101\nG00 X52 Z-20\nG00 X46",
        3,
        TouchingPart::RapidInsert,
        Obstacle::Stock,
    ),
    (
        job,
        "T0101\nG00 X0 Z2\nG00 Z-1",
        3,
        TouchingPart::RapidInsert,
        Obstacle::Stock,
    ),
    (
        job,
        "T0101\nG00 X44 Z2\nG01 Z-20 F200\nG00 Z-21",
        4,
        TouchingPart::RapidInsert,
        Obstacle::Stock,
    ),
    (
        job,
        "T0101\nG00 X44 Z2\nG01 Z-20 F200\nG00 X100 Z-50",
        4,
        TouchingPart::RapidInsert,
        Obstacle::Stock,
    ),
    (
        tube,
        "T0202\nG00 X18 Z2\nG00 X22 Z-5",
        3,
        TouchingPart::RapidInsert,
        Obstacle::Stock,
    ),
    (
        job,
        "T0505\nG00 X0 Z3\nG00 Z-5",
        3,
        TouchingPart::RapidInsert,
        Obstacle::Stock,
    ),
    (
        job,
        "T0303\nG00 X52 Z-20\nG01 X40 F50\nG00 Z-10",
        4,
        TouchingPart::RapidInsert,
        Obstacle::Stock,
    ),
    // The spindle stands.
    (
        job,
        "M05\nT0101\nG00 X46 Z2\nG01 Z-10 F100",
        4,
        TouchingPart::StandingInsert,
        Obstacle::Stock,
    ),
    (
        job,
        "T0101\nG00 X46 Z2\nG01 Z-10 F100\nM05\nG01 Z-20",
        5,
        TouchingPart::StandingInsert,
        Obstacle::Stock,
    ),
    // Jaws and chuck.
    (
        job,
        "T0101\nG00 X48 Z2\nG01 Z-75 F200",
        3,
        TouchingPart::Insert,
        Obstacle::Jaws,
    ),
    (
        job,
        "T0101\nG00 X60 Z2\nG00 Z-80",
        3,
        TouchingPart::RapidInsert,
        Obstacle::Jaws,
    ),
    (
        job,
        "T0303\nG00 X60 Z-68\nG01 X45 Z-72 F50",
        3,
        TouchingPart::Insert,
        Obstacle::Jaws,
    ),
    // Holder, back of the insert, turret.
    (
        job,
        "T0303\nG00 X52 Z-20\nG01 X10 F50",
        3,
        HOLDER,
        Obstacle::Stock,
    ),
    (
        job,
        "T0101\nG00 X52 Z-30\nG01 X20 F50",
        3,
        BACK,
        Obstacle::Stock,
    ),
    (
        narrow,
        "T0202\nG00 X11 Z2\nG01 X12.6 F50\nG01 Z-10",
        4,
        HOLDER,
        Obstacle::Stock,
    ),
    (
        job,
        "T0101\nG00 X30 Z-10",
        2,
        TouchingPart::RapidInsert,
        Obstacle::Stock,
    ),
    (
        job,
        "T0101\nG00 X0 Z1\nG01 Z-40 F100",
        3,
        BACK,
        Obstacle::Stock,
    ),
    // The tailstock.
    (
        with_tailstock,
        "T0101\nG00 X30 Z30\nG01 X20 F100",
        2,
        TouchingPart::RapidInsert,
        Obstacle::Tailstock,
    ),
    (
        with_tailstock,
        "T0101\nG00 X52 Z2\nG01 X4 F100",
        3,
        TouchingPart::Insert,
        Obstacle::Tailstock,
    ),
];

/// A program that hits nothing.
type Clean = (fn() -> Job, &'static str);

const CLEAN: [Clean; 20] = [
    (job, "T0101\nG00 X46 Z2\nG01 Z-30 F100\nG01 X52\nG00 Z2"),
    (
        job,
        "T0101\nG00 X54 Z2\nG90 X46 Z-30 F100\nX42\nX38\nG00 X100 Z50",
    ),
    (
        job,
        "T0101\nG00 X54 Z2\nG94 X-1.6 Z-1 F100\nZ-2\nG00 X100 Z50",
    ),
    (
        job,
        "T0101\nG00 X54 Z2\nG90 X46 Z-30 R-3 F100\nG00 X100 Z50",
    ),
    (
        job,
        "T0101\nG00 X52 Z2\nG71 U2 R1\nG71 P10 Q20 U0.5 W0.2 F100\nN10 G00 X20\nG01 Z-10\nX30 Z-25\n\
         Z-35\nN20 X52\nG70 P10 Q20\nG00 X100 Z50",
    ),
    (
        job,
        "T0101\nG00 X52 Z2\nG72 W2 R1\nG72 P10 Q20 U0.5 W0.2 F100\nN10 G00 Z-20\nG01 X40\nX30 Z-10\n\
         N20 Z2\nG70 P10 Q20\nG00 X100 Z50",
    ),
    (
        job,
        "T0303\nG00 X52 Z-20\nG01 X40 F50\nG04 X1\nG00 X52\nG00 Z-30\nG01 X42\nG00 X52",
    ),
    (
        job,
        "T0303\nG00 X52 Z-20\nG75 R1\nG75 X36 Z-30 P2000 Q2500 F50\nG00 X100 Z50",
    ),
    (job, "T0303\nG00 X52 Z-40\nG01 X30 F30\nG00 X60"),
    (
        job,
        "T0101\nG00 X48 Z2\nG01 Z-30 F100\nG00 X60 Z5\nT0404\nG00 X52 Z5\nG92 X47 Z-20 F1.5\nX46.4\n\
         X46.1\nG00 X100 Z50",
    ),
    (
        job,
        "T0404\nG00 X52 Z5\nG76 P010060 Q100 R0.1\nG76 X46.1 Z-20 P975 Q400 F1.5\nG00 X100 Z50",
    ),
    (job, "T0505\nG00 X0 Z3\nG01 Z-30 F50\nG00 Z3"),
    (
        job,
        "T0505\nG00 X0 Z3\nG74 R1\nG74 Z-30 Q5000 F50\nG00 X100 Z50",
    ),
    (tube, "T0202\nG00 X21 Z2\nG01 Z-40 F80\nG01 X20\nG00 Z2"),
    (
        tube,
        "T0202\nG00 X20 Z2\nG90 X22 Z-40 F80\nX24\nX25\nG00 Z50",
    ),
    (tube, "T0101\nG00 X54 Z0\nG01 X18 F80\nG00 Z2"),
    (
        job,
        "T0101\nG00 X40 Z2\nG01 Z0 F100\nG03 X50 Z-5 R5\nG01 Z-20\nG00 X60 Z2",
    ),
    (job, "T0101\nG00 X54 Z-40\nG00 X50\nG00 Z2\nG00 X100 Z50"),
    (
        with_tailstock,
        "T0101\nG00 X54 Z2\nG00 X52\nG90 X46 Z-30 F100\nG00 X100 Z50",
    ),
    (job, "M05\nT0101\nG00 X52 Z2\nG01 Z-30 F200\nG00 X100 Z50"),
];

#[test]
fn twenty_crashes_are_found_at_their_blocks() {
    let head = u32::try_from(HEAD.lines().count()).unwrap();
    for (job, text, line, touching_part, obstacle) in CRASHES {
        let findings = findings(job(), HEAD, text);
        let Some(first) = findings.first() else {
            panic!("nothing is found in\n{text}");
        };
        let found = (
            first.source.map(|source| source.line),
            first.collision.touching_part,
            first.collision.obstacle,
        );
        assert_eq!(
            found,
            (Some(head + line), touching_part, obstacle),
            "{text}\n{first:?}"
        );
        assert!(first.collision.depth > 0.0, "{first:?}");
    }
    // The turret needs a short holder.
    let mut short = job();
    let holder = Holder::Shank {
        width: 20.0,
        length: 20.0,
    };
    short.tools.get_mut(&1).unwrap().holder = holder;
    let found = findings(short, HEAD, "T0101\nG00 X46 Z2\nG01 Z-60 F200");
    assert!(
        found
            .iter()
            .any(|finding| finding.collision.touching_part == TURRET),
        "{found:?}"
    );
}

#[test]
fn twenty_clean_programs_hit_nothing() {
    for (job, text) in CLEAN {
        assert_eq!(findings(job(), HEAD, text), [], "{text}");
    }
}
