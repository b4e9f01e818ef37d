//! Releases held keys when the release event of the window is lost or late.

use std::time::{Duration, Instant};

use gsk_core::cnc::ControlRequest;
use gsk_core::setup::Setup;
use gsk_host::input_watch::{DisplayReply, Holders, InputWatch};
use gsk_host::kernel::{Command, Console, Kernel, KernelEnvironment, start};
use gsk_host::platform::time_with_sleep;
use gsk_host::termination::TerminationFlag;
use gsk_link::LinkState;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_twins::grbl::Variant;

use bench::board::{BenchBoard, LinkedMachine};
use bench::keys::{INCREMENT_100, JOG, RAPID, STEP, WHEEL_Z, Z_MINUS};

/// The control, its link and a board, in virtual time.
#[path = "../../tests/tests/control/bench/mod.rs"]
#[allow(dead_code, reason = "each test uses what it needs")]
pub mod bench;

const TIME_LIMIT: Duration = Duration::from_secs(60);

/// Waits for a snapshot in which the key is down, or up.
fn wait_for_key(console: &Console, down: bool, time_limit: Duration) -> bool {
    let start_time = Instant::now();
    while start_time.elapsed() < time_limit {
        if let Some(snapshot) = console.snapshots.pop()
            && snapshot.pressed.contains(&Key::ZLeft) == down
        {
            return true;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    false
}

/// Starts a kernel in its thread and holds a key down. `keep_alive` keeps it held.
fn hold_key(keep_alive: impl Fn(&Console)) -> (gsk_host::kernel::KernelThread, Console) {
    let (mut kernel, console) = Kernel::new(Emulator::new(Setup::delivered()));
    kernel.run(4000);
    let host = KernelEnvironment {
        wake: Box::new(|| {}),
        keeper: None,
        partner_folder: None,
        udisk_folder: None,
        termination: TerminationFlag::install_signal_handlers().unwrap(),
    };
    let thread = start(kernel, &console, host).unwrap();
    // On a busy computer the key may be up again before a snapshot is taken.
    let pressed = (0..100).any(|_| {
        let (key, down) = (Key::ZLeft, true);
        keep_alive(&console);
        console.send(Command::Key { key, down });
        wait_for_key(&console, true, Duration::from_millis(300))
    });
    assert!(pressed);
    (thread, console)
}

#[test]
fn a_key_is_released_when_the_window_is_silent() {
    let (mut thread, console) = hold_key(|_| {});
    assert!(
        wait_for_key(&console, false, TIME_LIMIT),
        "it stays down for ever"
    );
    assert!(thread.is_alive());
    thread.stop();
}

/// The window still draws, but the display does not confirm it: the display hangs, or shows
/// the key up.
#[test]
fn drawn_frames_alone_do_not_hold_a_key() {
    for keys_down in [None, Some(0)] {
        let keep_alive = |console: &Console| {
            console.input_watch.set_holders(Holders {
                keys: 1,
                ..Holders::default()
            });
            console.send(Command::Alive);
            if let Some(keys) = keys_down {
                let (now, pointer) = (time_with_sleep(), false);
                console
                    .input_watch
                    .record_reply(now, now, DisplayReply::Down { keys, pointer });
            }
        };
        let (mut thread, console) = hold_key(keep_alive);
        let start_time = Instant::now();
        let is_up = loop {
            keep_alive(&console);
            if wait_for_key(&console, false, Duration::from_millis(20)) {
                break true;
            }
            if start_time.elapsed() > TIME_LIMIT {
                break false;
            }
        };
        assert!(is_up, "{keys_down:?}: it stays down for ever");
        thread.stop();
    }
}

/// How the display fails while the operator moves the machine.
#[derive(Clone, Copy, Debug)]
enum DisplayFault {
    /// It stops replying.
    Freeze,
    /// It replies after three seconds, all at once.
    Stall,
    /// The key is released, and the window never receives the event.
    LostRelease,
}

/// What the operator does.
#[derive(Clone, Copy, Debug)]
enum OperatorAction {
    Jog,
    JogAtRapid,
    TurnWheel,
}

/// Greatest time for which an axis moves after the display has failed, ms.
const MAX_STOP_TIME_MS: u64 = 600;

/// Moves a board by hand with a display that fails at `fails_at_ms` ms. Returns for how long the
/// axis continued to move, ms.
fn motion_after_fault_ms<T: BenchBoard>(
    machine: &mut LinkedMachine<T>,
    action: OperatorAction,
    fault: DisplayFault,
    fails_at_ms: u64,
) -> u64 {
    let watch = InputWatch::default();
    let ms = Duration::from_millis;
    let holds_key = !matches!(action, OperatorAction::TurnWheel);
    if holds_key {
        machine.press(JOG);
    } else {
        // 001.3: the step key selects the handwheel.
        machine.set_parameter(1, 1 << 3);
        machine.press(STEP);
        machine.press(WHEEL_Z);
        machine.press(INCREMENT_100);
    }
    if matches!(action, OperatorAction::JogAtRapid) {
        machine.press(RAPID);
    }
    if holds_key {
        machine.simulation.cnc.set_panel_key(Z_MINUS, true);
    }
    watch.set_linked(true);
    watch.set_holders(Holders {
        keys: usize::from(holds_key),
        ..Holders::default()
    });
    let mut is_held = holds_key;
    let (mut last_pulses, mut last_motion_ms) = (machine.twin.pulses(), 0);
    for at_ms in 0..8000 {
        let now = ms(at_ms);
        let keys = usize::from(
            holds_key && !(matches!(fault, DisplayFault::LostRelease) && at_ms >= fails_at_ms),
        );
        let reply = DisplayReply::Down {
            keys,
            pointer: false,
        };
        let replies = match fault {
            DisplayFault::LostRelease => true,
            DisplayFault::Freeze => at_ms < fails_at_ms,
            DisplayFault::Stall => at_ms < fails_at_ms || at_ms >= fails_at_ms + 3000,
        };
        if at_ms % 50 == 7 && replies {
            watch.record_reply(now, now, reply);
        }
        if matches!(action, OperatorAction::TurnWheel) && at_ms % 10 == 0 && at_ms < fails_at_ms {
            machine.simulation.lathe.turn_handwheel(-5);
        }
        // The kernel thread does the same.
        if is_held && watch.has_lapsed(Duration::ZERO, now) {
            is_held = false;
            machine.simulation.cnc.set_panel_key(Z_MINUS, false);
        }
        if !holds_key && watch.is_silent(now) {
            machine
                .simulation
                .cnc
                .request(ControlRequest::DropWheel)
                .unwrap();
        }
        machine.run_one_ms();
        if machine.twin.pulses() != last_pulses {
            last_pulses = machine.twin.pulses();
            last_motion_ms = at_ms;
        }
    }
    last_motion_ms.saturating_sub(fails_at_ms)
}

fn assert_stop_time<T: BenchBoard>(ready: &LinkedMachine<T>, kind: &str) {
    for action in [
        OperatorAction::Jog,
        OperatorAction::JogAtRapid,
        OperatorAction::TurnWheel,
    ] {
        for fault in [
            DisplayFault::Freeze,
            DisplayFault::Stall,
            DisplayFault::LostRelease,
        ] {
            if matches!(
                (action, fault),
                (OperatorAction::TurnWheel, DisplayFault::LostRelease)
            ) {
                continue;
            }
            let mut longest = 0;
            // The display fails at different moments between two queries.
            for fails_at_ms in [1007, 1008, 1041, 1077, 1106] {
                let mut machine = ready.clone();
                let start_pulses = machine.twin.pulses();
                let motion_ms = motion_after_fault_ms(&mut machine, action, fault, fails_at_ms);
                assert_ne!(
                    machine.twin.pulses(),
                    start_pulses,
                    "{kind} {action:?}: it never moved"
                );
                longest = longest.max(motion_ms);
            }
            assert!(
                longest <= MAX_STOP_TIME_MS,
                "{kind} {action:?} {fault:?}: it moved on for {longest} ms"
            );
            println!("{kind} {action:?} {fault:?}: {longest} ms");
            assert!(longest >= 50, "{kind} {action:?} {fault:?}: {longest} ms");
        }
    }
}

#[test]
fn an_axis_stops_within_600_ms_after_the_display_fails() {
    for variant in [Variant::Grbl, Variant::GrblHal] {
        assert_stop_time(&LinkedMachine::referenced(variant), &format!("{variant:?}"));
    }
    assert_stop_time(&LinkedMachine::timed_referenced(), "Klipper");
    let ready = LinkedMachine::referenced(Variant::Grbl);
    assert_eq!(ready.linked.state(), LinkState::Ready);
}
