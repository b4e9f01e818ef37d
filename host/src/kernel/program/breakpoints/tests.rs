use gsk_core::cnc::ControlRequest;
use gsk_core::command::ProgramId;
use gsk_core::operation::RunState;
use gsk_core::setup::Setup;
use gsk_debugger::source_files::ProgramSources;
use gsk_panel::emulator::Emulator;
use gsk_panel::pages::PageId;

use super::*;
use crate::kernel::Console;
use crate::kernel::timeline::TimelineCommand;

const PROGRAM: &str =
    "O0001;\nG50 X60 Z20;\nG65 H01 P#200 Q5;\nG00 X52 Z2;\nG01 X46 F200;\nZ-5;\nG00 X60;\nM30;\n";

/// A kernel whose program is about to start, with these breakpoints.
fn ready_kernel(locations: &[&str]) -> (Kernel, Console) {
    let (mut kernel, console) = Kernel::new(Emulator::new(Setup::default()));
    kernel.run(4000);
    let store = ControlRequest::StoreProgram(PROGRAM.to_owned());
    console.send(Command::Request(Box::new(store)));
    let parse = |text: &&str| BreakLocation::parse(text, &ProgramSources::default()).unwrap();
    let locations = locations.iter().map(parse).collect();
    console.send(Command::Breakpoints(BreakpointCommand::Set(locations)));
    console.send(Command::Tap(Key::Auto));
    kernel.run(500);
    (kernel, console)
}

fn press(kernel: &mut Kernel, console: &Console, key: Key, ticks: u64) {
    console.send(Command::Tap(key));
    kernel.run(ticks);
}

/// Returns the line of the block at which machine time is halted; `None` while it runs.
fn halted_line(kernel: &Kernel) -> Option<u32> {
    kernel.snapshot().halt.map(|halt| halt.block.unwrap().line)
}

#[test]
fn machine_time_stands_still_at_a_breakpoint_until_the_operator_continues() {
    let (mut kernel, console) = ready_kernel(&["O1:6"]);
    press(&mut kernel, &console, Key::CycleStart, 60_000);
    assert_eq!(halted_line(&kernel), Some(6));
    let halt = kernel.snapshot().halt.unwrap();
    assert_eq!(halt.location.as_deref(), Some("O1:6"));
    assert_eq!(halt.variables, [(200, 5.0)]);
    let machine = kernel.emulator.clone();
    kernel.run(5000);
    assert!(kernel.emulator == machine, "time has passed");
    console.send(Command::Breakpoints(BreakpointCommand::NextBlock));
    kernel.run(60_000);
    assert_eq!(halted_line(&kernel), Some(7));
    assert_eq!(kernel.snapshot().halt.unwrap().location, None);
    press(&mut kernel, &console, Key::CycleStart, 60_000);
    assert_eq!(kernel.snapshot().halt, None);
    assert_eq!(kernel.emulator.cnc().run_state(), RunState::Reset);
}

#[test]
fn at_a_halt_page_keys_act_stop_keys_end_it_and_other_keys_do_nothing() {
    let (mut kernel, console) = ready_kernel(&["X<50"]);
    press(&mut kernel, &console, Key::CycleStart, 60_000);
    assert_eq!(halted_line(&kernel), Some(5));
    let machine = kernel.emulator.clone();
    for command in [
        Command::Tap(Key::Edit),
        Command::Turn(3),
        Command::Type('g'),
    ] {
        console.send(command);
        kernel.run(500);
    }
    assert!(kernel.emulator == machine);
    let stands = Notice::Message(say::breakpoint_time_stands());
    assert_eq!(
        console
            .notices
            .try_iter()
            .filter(|it| *it == stands)
            .count(),
        3
    );
    press(&mut kernel, &console, Key::Offset, 10);
    assert!(matches!(kernel.snapshot().page, PageId::Oft));
    assert_eq!(halted_line(&kernel), Some(5));
    press(&mut kernel, &console, Key::Reset, 2000);
    assert_eq!(kernel.snapshot().halt, None);
    assert_eq!(kernel.emulator.cnc().run_state(), RunState::Reset);
}

#[test]
fn a_breakpoint_stays_armed_when_the_machine_goes_back() {
    let (mut kernel, console) = ready_kernel(&["O1:6"]);
    let before = kernel.emulator.ticks();
    press(&mut kernel, &console, Key::CycleStart, 60_000);
    assert_eq!(halted_line(&kernel), Some(6));
    for command in [
        TimelineCommand::LookAt(before),
        TimelineCommand::ContinueFromHere,
    ] {
        console.send(Command::Timeline(command));
        kernel.run(0);
    }
    assert_eq!(kernel.snapshot().halt, None);
    press(&mut kernel, &console, Key::CycleStart, 60_000);
    assert_eq!(halted_line(&kernel), Some(6));
    let block = kernel.snapshot().running_block.unwrap();
    assert_eq!(block.program, ProgramId::Stored(1));
}

/// The ticks since the last slot of the ladder in the machine that is shown, and its tick.
fn shown_slot(kernel: &Kernel) -> (u64, u64) {
    let shown = kernel.shown_machine();
    (shown.cnc().ticks_since_ladder_slot(), shown.ticks())
}

#[test]
fn slots_of_the_ladder_lead_back_from_a_halt_and_forwards_to_it() {
    let (mut kernel, console) = ready_kernel(&["O1:6"]);
    press(&mut kernel, &console, Key::CycleStart, 60_000);
    assert_eq!(halted_line(&kernel), Some(6));
    let present = kernel.emulator.clone();
    let (since, halted_at) = shown_slot(&kernel);
    let last_slot = match since {
        0 => halted_at - 8,
        since => halted_at - since,
    };
    let mut step = |back: bool, count: u64| {
        for _ in 0..count {
            console.send(Command::Timeline(TimelineCommand::StepSlot { back }));
            kernel.run(0);
        }
        let past = kernel.snapshot().past.map(|past| past.tick);
        let state = kernel.shown_machine().clone();
        (past, shown_slot(&kernel), state)
    };
    let (past, shown, first) = step(true, 1);
    assert_eq!((past, shown), (Some(last_slot), (0, last_slot)));
    let far = last_slot - 200 * 8;
    let (past, shown, _) = step(true, 200);
    assert_eq!((past, shown), (Some(far), (0, far)));
    let (past, _, again) = step(false, 200);
    assert_eq!(past, Some(last_slot));
    assert!(again == first, "another state");
    let (past, ..) = step(false, 1);
    assert_eq!(past, None, "the present is shown");
    assert_eq!(halted_line(&kernel), Some(6));
    assert!(kernel.emulator == present, "the present has moved");
}
