//! A job for a program that has none: its tools from what it does with each, its stock
//! from where it cuts. What comes of it is a guess, and is said to be one.

use std::collections::BTreeMap;

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::memory::Offsets;
use gsk_core::preview::{Progress, preview_while};
use gsk_core::setup::Setup;
use gsk_core::units::{Diameter, Point};
use gsk_workpiece::collision::Toucher;
use gsk_workpiece::job::{Job, Place};
use gsk_workpiece::stock::{Form, Stock};
use gsk_workpiece::tool::{Insert, Letter, Tool};

use super::Machining;
use crate::curves::RapidRates;

/// Moves that a guess looks at: the first of a program.
pub const MOST_MOVES: usize = 20_000;
/// Moves with which a bar is tried.
const TRIED_MOVES: usize = 3_000;
/// Bars that are tried.
const MOST_BARS: usize = 8;
/// Stock between the deepest cut and the jaws, mm.
const TO_JAWS: f64 = 10.0;
/// Diameter of a chuck over the radius of its stock, at least.
const CHUCK: f64 = 5.0;
/// What a facing cut takes at most, mm.
const FACE: f64 = 0.5;
/// Thinner bars are none, mm of radius.
const THINNEST: f64 = 1.0;
/// What a bar has more than the widest cut along it, mm of radius.
const SKIN: f64 = 1.0;
/// Wall around the widest bore, mm.
const WALL: f64 = 10.0;
/// Cuts begin no farther in front of a zero at the face, mm.
const APPROACH: f64 = 10.0;
/// Fronts that are tried.
const MOST_FRONTS: usize = 4;
/// A length that is nothing, mm.
const NOTHING: f64 = 1e-6;
/// Width of a grooving tool whose width nothing shows, mm.
const GROOVE: f64 = 3.0;
/// How far the steps of a wide groove overlap, mm.
const OVERLAP: f64 = 0.5;
/// A drill whose diameter nothing shows, mm.
const DRILL: f64 = 10.0;

/// What a program does with a tool.
#[derive(Clone, Debug, Default)]
struct Use {
    offset: u8,
    threads: bool,
    /// Feeds along the spindle axis, towards the chuck and away from it.
    along: [u32; 2],
    /// The longest of them along Z, mm.
    longest: f64,
    /// Feeds straight in, and at the spindle axis.
    plunges: u32,
    drills: u32,
    /// How often it leaves a cut towards the axis and away from it.
    leaves: [u32; 2],
    /// The steepest way back into the part, degrees.
    steepest: f64,
    /// Nearest to the axis within the part, mm of radius.
    nearest: Option<f64>,
    /// Where its cuts begin, Z.
    positions: Vec<f64>,
}

/// A bar and tools to learn on where no program says what is cut: the tip of the first
/// tool stands before the bar at power-on, and no offset is right, so that the tools
/// must be set by trial cuts.
pub fn practice() -> Job {
    let length = |x: f64, z: f64| Place { x: Diameter(x), z };
    let tools = [
        (1, Tool::turning(), length(0.0, 0.0)),
        (2, Tool::grooving(3.0), length(6.4, -2.7)),
        (3, Tool::threading(60.0), length(-3.2, 4.1)),
    ];
    let mut job = Job::new(Stock::bar(50.0, 1.0, 81.0));
    job.zero = Some(length(-64.0, -10.0));
    for (number, tool, length) in tools {
        job.tools.insert(number, tool);
        job.lengths.insert(number, length);
    }
    job
}

/// A job for the selected program of a set-up, as long as `go_on` says so.
pub fn of_program(setup: &Setup, go_on: &mut dyn FnMut(&Progress) -> bool) -> Option<Job> {
    let mut moves = Vec::new();
    let take = &mut |executed: &ExecutedMove| {
        if moves.len() < MOST_MOVES {
            moves.push(*executed);
        }
    };
    preview_while(setup, &setup.memory.programs, take, go_on);
    let rates = RapidRates::of(&setup.memory);
    guess(&moves, &setup.memory.offsets, rates)
}

/// A job for these moves of a program; `None` for one that cuts nothing.
pub fn guess(moves: &[ExecutedMove], offsets: &Offsets, rates: RapidRates) -> Option<Job> {
    let cuts: Vec<&ExecutedMove> = moves.iter().filter(|executed| is_cut(executed)).collect();
    let deepest = cuts.iter().map(|cut| cut.from.z.min(cut.to.z));
    let deepest = deepest.reduce(f64::min)?;
    let front = fronts(&cuts).into_iter().fold(0.0, f64::max);
    let uses = uses(moves, front);
    let tools: BTreeMap<u8, Tool> = uses
        .iter()
        .map(|(number, used)| (*number, tool(used, &uses, offsets)))
        .collect();
    let bore = bore(&uses, &tools);
    let job = |radius: f64, front: f64| {
        let mut stock = Stock::bar(radius * 2.0, front, front - deepest.min(0.0) + TO_JAWS);
        stock.chuck.diameter.0 = stock.chuck.diameter.0.max(radius * CHUCK);
        if let Some(bore) = bore.filter(|bore| *bore < radius) {
            stock.form = Form::Tube {
                diameter: Diameter(radius * 2.0),
                bore: Diameter(bore * 2.0),
            };
        }
        Job {
            tools: tools.clone(),
            ..Job::new(stock)
        }
    };
    // The largest bar that is cut and that no rapid goes through; else the one that the
    // fewest do.
    let tried = &moves[..moves.len().min(TRIED_MOVES)];
    let mut least: Option<(usize, Job)> = None;
    for radius in radii(&cuts, &tools) {
        for front in fronts(&cuts) {
            let job = job(radius, front);
            let Some(hits) = rapids_through(&job, tried, rates) else {
                continue;
            };
            if hits == 0 {
                return Some(job);
            }
            if least.as_ref().is_none_or(|(fewest, _)| hits < *fewest) {
                least = Some((hits, job));
            }
        }
    }
    least.map(|(_, job)| job)
}

/// Radii that a bar may have, the largest first: where outside cuts begin and end, and a
/// little more than the widest cut along it.
fn radii(cuts: &[&ExecutedMove], tools: &BTreeMap<u8, Tool>) -> Vec<f64> {
    let is_outside = |cut: &&&ExecutedMove| {
        let tool = tools.get(&cut.conditions.tool);
        tool.is_none_or(|tool| !tool.is_internal())
    };
    let outside = || cuts.iter().filter(is_outside);
    let mut radii: Vec<f64> = outside()
        .flat_map(|cut| [cut.from.x, cut.to.x])
        .filter(|radius| *radius > THINNEST)
        .collect();
    let widest = |along: f64, cut: &&ExecutedMove| match cut.from.z == cut.to.z {
        true => along,
        false => along.max(cut.from.x.min(cut.to.x)),
    };
    let along = outside().fold(0.0, widest);
    let inside = cuts.iter().fold(0.0, widest) + WALL;
    radii.push(if along > 0.0 { along + SKIN } else { inside });
    radii.sort_by(|a, b| b.total_cmp(a));
    radii.dedup_by(|a, b| (*a - *b).abs() < 0.01);
    radii.truncate(MOST_BARS);
    radii
}

/// Where the front of a bar may lie: at the facing cuts and before them, at the zero of
/// the program, or where its cuts begin if the zero lies at the chuck.
fn fronts(cuts: &[&ExecutedMove]) -> Vec<f64> {
    let faced = cuts
        .iter()
        .filter(|cut| cut.from.z == cut.to.z && cut.from.x.min(cut.to.x) < THINNEST)
        .map(|cut| cut.to.z)
        .reduce(f64::max);
    if let Some(faced) = faced {
        return vec![faced + FACE, faced];
    }
    let mut begins: Vec<f64> = cuts.iter().map(|cut| cut.from.z.max(cut.to.z)).collect();
    begins.sort_by(|a, b| b.total_cmp(a));
    begins.dedup_by(|a, b| (*a - *b).abs() < 0.01);
    match begins.first() {
        Some(first) if *first > APPROACH => {
            begins.truncate(MOST_FRONTS);
            begins
        }
        _ => vec![0.0],
    }
}

fn is_cut(executed: &ExecutedMove) -> bool {
    !matches!(executed.kind, MoveKind::Rapid | MoveKind::Dwell)
}

/// How many rapids go through the stock; none of a job that is not cut.
fn rapids_through(job: &Job, moves: &[ExecutedMove], rates: RapidRates) -> Option<usize> {
    let mut machining = Machining::new(job.clone());
    for executed in moves {
        machining.moved(executed, rates);
    }
    let hits = |finding: &&super::Finding| finding.collision.toucher == Toucher::RapidInsert;
    let is_cut = machining.removed_volume() > 0.0;
    is_cut.then(|| machining.findings().iter().filter(hits).count())
}

fn uses(moves: &[ExecutedMove], front: f64) -> BTreeMap<u8, Use> {
    let mut uses = BTreeMap::<u8, Use>::new();
    let mut last: Option<&ExecutedMove> = None;
    for executed in moves {
        let conditions = &executed.conditions;
        let used = uses.entry(conditions.tool).or_default();
        if conditions.offset != 0 {
            used.offset = conditions.offset;
        }
        let before = last.filter(|it| it.conditions.tool == conditions.tool);
        used.take(executed, before, front);
        last = Some(executed);
    }
    uses.retain(|number, used| *number != 0 && used.cuts());
    uses
}

impl Use {
    fn cuts(&self) -> bool {
        self.threads || self.along != [0, 0] || self.plunges > 0 || self.drills > 0
    }

    fn take(&mut self, executed: &ExecutedMove, before: Option<&ExecutedMove>, front: f64) {
        let (from, to) = (executed.from, executed.to);
        let way = to - from;
        if to.z < front && executed.kind != MoveKind::Dwell {
            let nearest = from.x.min(to.x);
            self.nearest = Some(self.nearest.map_or(nearest, |known| known.min(nearest)));
        }
        let after_cut_along = before
            .is_some_and(|before| is_cut(before) && (before.to.z - before.from.z).abs() > NOTHING);
        if after_cut_along && way.x.abs() > NOTHING && way.z >= -NOTHING {
            self.leaves[usize::from(way.x > 0.0)] += 1;
        }
        match executed.kind {
            MoveKind::Rapid | MoveKind::Dwell => {}
            MoveKind::Thread | MoveKind::RunOut => self.threads = true,
            MoveKind::Feed | MoveKind::Clockwise | MoveKind::CounterClockwise => {
                self.take_cut(from, way);
            }
        }
    }

    fn take_cut(&mut self, from: Point, way: Point) {
        if way.z.abs() <= NOTHING {
            if way.x < 0.0 {
                self.plunges += 1;
                self.positions.push(from.z);
            }
        } else if from.x.abs() <= NOTHING && way.x.abs() <= NOTHING {
            self.drills += 1;
        } else {
            self.along[usize::from(way.z > 0.0)] += 1;
            self.longest = self.longest.max(way.z.abs());
            if way.z < 0.0 && way.x < 0.0 {
                let steep = libm::atan2(-way.x, -way.z).to_degrees();
                self.steepest = self.steepest.max(steep);
            }
        }
    }

    /// Whether it only goes in and out of grooves within the part; a chamfer at their
    /// edge is no turning.
    fn grooves(&self) -> bool {
        self.plunges > 0 && self.longest <= GROOVE && self.nearest.is_some()
    }

    /// Whether its cuts lie on the inside.
    const fn is_internal(&self) -> bool {
        self.leaves[0] > self.leaves[1]
    }

    /// The least distance between its plunges, mm.
    fn step(&self) -> Option<f64> {
        let mut positions = self.positions.clone();
        positions.sort_by(f64::total_cmp);
        let steps = positions.windows(2).map(|pair| pair[1] - pair[0]);
        steps.filter(|step| *step > 0.1).min_by(f64::total_cmp)
    }
}

fn tool(used: &Use, uses: &BTreeMap<u8, Use>, offsets: &Offsets) -> Tool {
    let row = offsets.get(used.offset);
    let (nose, tip) = (row.r.abs(), row.t);
    let internal = match tip {
        0 | 9 => used.is_internal(),
        tip => matches!(tip, 1 | 2 | 6),
    };
    let mut tool = if used.threads {
        let mut tool = Tool::threading(60.0);
        tool.tip = if internal { 6 } else { 8 };
        return tool;
    } else if used.drills > 0 && used.along == [0, 0] {
        let bored = uses.values().filter(|other| other.is_internal());
        let nearest = bored.filter_map(|other| other.nearest);
        let diameter = nearest
            .reduce(f64::min)
            .map_or(DRILL, |radius| 2.0 * radius);
        return Tool::drill(diameter.max(1.0));
    } else if used.grooves() {
        // A groove that is wider than its tool is cut in steps of less than the tool.
        let step = used.step().filter(|step| *step < GROOVE);
        Tool::grooving(step.map_or(GROOVE, |step| (step + OVERLAP).min(GROOVE)))
    } else if internal {
        Tool::boring()
    } else {
        turning(used.steepest)
    };
    let left_hand = used.along[1] > used.along[0];
    tool.tip = match (tip, internal, left_hand) {
        (1..=8, ..) => tip,
        (_, true, false) => 2,
        (_, true, true) => 1,
        (_, false, false) => 3,
        (_, false, true) => 4,
    };
    if nose > 0.0 {
        match &mut tool.insert {
            Insert::Turning { nose: own, .. }
            | Insert::Grooving { nose: own, .. }
            | Insert::Threading { nose: own, .. } => *own = nose,
            Insert::Drill { .. } => {}
        }
    }
    if tool.check().is_ok() {
        tool
    } else {
        Tool::turning()
    }
}

/// An outside tool whose back clears a contour that goes in so steeply, degrees.
fn turning(steepest: f64) -> Tool {
    // An edge of 16 mm: shoulders are finished in one go.
    let insert = |letter, entering, nose| Insert::Turning {
        letter,
        entering,
        size: 15.875,
        nose,
    };
    // What is left between the second edge and the spindle axis.
    let clears = |letter: Letter, entering: f64| 180.0 - entering - letter.corner();
    let insert = if steepest <= clears(Letter::C, 95.0) {
        insert(Letter::C, 95.0, 0.8)
    } else if steepest <= clears(Letter::D, 93.0) {
        insert(Letter::D, 93.0, 0.4)
    } else {
        insert(Letter::V, 93.0, 0.4)
    };
    Tool {
        insert,
        ..Tool::turning()
    }
}

/// Radius of the hole that inside tools find, mm; none where a drill makes it.
fn bore(uses: &BTreeMap<u8, Use>, tools: &BTreeMap<u8, Tool>) -> Option<f64> {
    let drills = |tool: &Tool| matches!(tool.insert, Insert::Drill { .. });
    if tools.values().any(drills) {
        return None;
    }
    let inside = |number: &u8| tools.get(number).is_some_and(Tool::is_internal);
    uses.iter()
        .filter(|(number, _)| inside(number))
        .filter_map(|(_, used)| used.nearest)
        .reduce(f64::min)
        .filter(|radius| *radius > 0.5)
}
