//! Releases held keys when the release event of the window is lost or late.

use std::time::{Duration, Instant};

use gsk_app::ending::Ending;
use gsk_app::input_watch::{DisplayReply, Holders, InputWatch};
use gsk_app::kernel::{Command, Console, Kernel, Outside, start};
use gsk_app::platform::time_with_sleep;
use gsk_core::cnc::Request;
use gsk_core::setup::Setup;
use gsk_link::LinkState;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_twins::grbl::Variant;

use bench::board::{Board, Machine};
use bench::keys::{INCREMENT_100, JOG, RAPID, STEP, WHEEL_Z, Z_MINUS};

/// The control, its link and a board, in virtual time.
#[path = "../../tests/tests/control/bench/mod.rs"]
#[allow(dead_code, reason = "each test uses what it needs")]
mod bench;

const LONGEST: Duration = Duration::from_secs(60);

/// Waits for a snapshot in which the key is down, or up.
fn is_seen(console: &Console, down: bool, longest: Duration) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < longest {
        if let Some(picture) = console.pictures.pop()
            && picture.pressed.contains(&Key::ZLeft) == down
        {
            return true;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    false
}

/// Starts a kernel in its thread and holds a key down. `alive` keeps it held.
fn held(alive: impl Fn(&Console)) -> (gsk_app::kernel::KernelThread, Console) {
    let (mut kernel, console) = Kernel::new(Emulator::new(Setup::delivered()));
    kernel.run(4000);
    let outside = Outside {
        wake: Box::new(|| {}),
        keeper: None,
        partner: None,
        ending: Ending::heard().unwrap(),
    };
    let thread = start(kernel, &console, outside).unwrap();
    // On a busy computer the key may be up again before a snapshot is taken.
    let pressed = (0..100).any(|_| {
        let (key, down) = (Key::ZLeft, true);
        alive(&console);
        console.send(Command::Key { key, down });
        is_seen(&console, true, Duration::from_millis(300))
    });
    assert!(pressed);
    (thread, console)
}

#[test]
fn a_key_comes_up_when_nobody_says_any_more_that_it_is_held() {
    let (mut thread, console) = held(|_| {});
    assert!(is_seen(&console, false, LONGEST), "it stays down for ever");
    assert!(thread.is_alive());
    thread.stop();
}

/// The window still draws, but the display does not confirm it: the display hangs, or shows
/// the key up.
#[test]
fn painted_pictures_do_not_hold_a_key() {
    for shown in [None, Some(0)] {
        let alive = |console: &Console| {
            console.watch.set_holders(Holders {
                keys: 1,
                ..Holders::default()
            });
            console.send(Command::Alive);
            if let Some(keys) = shown {
                let (now, pointer) = (time_with_sleep(), false);
                console
                    .watch
                    .record_reply(now, now, DisplayReply::Down { keys, pointer });
            }
        };
        let (mut thread, console) = held(alive);
        let begun = Instant::now();
        let up = loop {
            alive(&console);
            if is_seen(&console, false, Duration::from_millis(20)) {
                break true;
            }
            if begun.elapsed() > LONGEST {
                break false;
            }
        };
        assert!(up, "{shown:?}: it stays down for ever");
        thread.stop();
    }
}

/// How the display fails while the operator moves the machine.
#[derive(Clone, Copy, Debug)]
enum Display {
    /// It stops replying.
    Freezes,
    /// It replies after three seconds, all at once.
    Stalls,
    /// The key is released, and the window never receives the event.
    LosesRelease,
}

/// What the operator does.
#[derive(Clone, Copy, Debug)]
enum Hand {
    Jogs,
    JogsAtRapid,
    TurnsWheel,
}

/// Greatest time for which an axis moves after the display has failed, ms.
const ENDS_WITHIN: u64 = 600;

/// Moves a board by hand with a display that fails at `fails` ms. Returns for how long the
/// axis continued to move, ms.
fn moves_on<T: Board>(machine: &mut Machine<T>, hand: Hand, display: Display, fails: u64) -> u64 {
    let watch = InputWatch::default();
    let ms = Duration::from_millis;
    let holds = !matches!(hand, Hand::TurnsWheel);
    if holds {
        machine.press(JOG);
    } else {
        // 001.3: the step key selects the handwheel.
        machine.set(1, 1 << 3);
        machine.press(STEP);
        machine.press(WHEEL_Z);
        machine.press(INCREMENT_100);
    }
    if matches!(hand, Hand::JogsAtRapid) {
        machine.press(RAPID);
    }
    if holds {
        machine.simulation.cnc.set_panel_key(Z_MINUS, true);
    }
    watch.set_linked(true);
    watch.set_holders(Holders {
        keys: usize::from(holds),
        ..Holders::default()
    });
    let mut held = holds;
    let (mut last, mut moved) = (machine.twin.pulses(), 0);
    for at in 0..8000 {
        let now = ms(at);
        let keys = usize::from(holds && !(matches!(display, Display::LosesRelease) && at >= fails));
        let shown = DisplayReply::Down {
            keys,
            pointer: false,
        };
        let answers = match display {
            Display::LosesRelease => true,
            Display::Freezes => at < fails,
            Display::Stalls => at < fails || at >= fails + 3000,
        };
        if at % 50 == 7 && answers {
            watch.record_reply(now, now, shown);
        }
        if matches!(hand, Hand::TurnsWheel) && at % 10 == 0 && at < fails {
            machine.simulation.lathe.turn_handwheel(-5);
        }
        // The kernel thread does the same.
        if held && watch.has_lapsed(Duration::ZERO, now) {
            held = false;
            machine.simulation.cnc.set_panel_key(Z_MINUS, false);
        }
        if !holds && watch.is_silent(now) {
            machine.simulation.cnc.request(Request::DropWheel).unwrap();
        }
        machine.ms();
        if machine.twin.pulses() != last {
            last = machine.twin.pulses();
            moved = at;
        }
    }
    moved.saturating_sub(fails)
}

fn ends_in_time<T: Board>(ready: &Machine<T>, kind: &str) {
    for hand in [Hand::Jogs, Hand::JogsAtRapid, Hand::TurnsWheel] {
        for display in [Display::Freezes, Display::Stalls, Display::LosesRelease] {
            if matches!((hand, display), (Hand::TurnsWheel, Display::LosesRelease)) {
                continue;
            }
            let mut longest = 0;
            // The display fails at different moments between two queries.
            for fails in [1007, 1008, 1041, 1077, 1106] {
                let mut machine = ready.clone();
                let stood = machine.twin.pulses();
                let on = moves_on(&mut machine, hand, display, fails);
                assert_ne!(
                    machine.twin.pulses(),
                    stood,
                    "{kind} {hand:?}: it never moved"
                );
                longest = longest.max(on);
            }
            assert!(
                longest <= ENDS_WITHIN,
                "{kind} {hand:?} {display:?}: it moved on for {longest} ms"
            );
            println!("{kind} {hand:?} {display:?}: {longest} ms");
            assert!(longest >= 50, "{kind} {hand:?} {display:?}: {longest} ms");
        }
    }
}

#[test]
fn a_display_that_fails_lets_the_axis_stand_within_600_ms() {
    for variant in [Variant::Grbl, Variant::GrblHal] {
        ends_in_time(&Machine::referenced(variant), &format!("{variant:?}"));
    }
    ends_in_time(&Machine::timed_referenced(), "Klipper");
    let ready = Machine::referenced(Variant::Grbl);
    assert_eq!(ready.linked.state(), LinkState::Ready);
}
