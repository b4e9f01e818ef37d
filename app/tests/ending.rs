//! A termination signal ends the program while a board moves. This test is a separate process:
//! the signal reaches all of it.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

#[path = "common/twin.rs"]
mod twin;

use std::time::{Duration, Instant};

use gsk_app::ending::Ending;
use gsk_app::kernel::{Command, Connection, Kernel, LinkOrder, Outside, start};
use gsk_core::setup::Setup;
use gsk_link::{LinkConfig, LinkState};
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use twin::{Twin, signal};

const LONGEST: Duration = Duration::from_secs(120);

#[test]
fn the_board_is_stopped_when_the_program_is_told_to_end() {
    let twin = Twin::play(&[]);
    let ending = Ending::heard().unwrap();
    let (mut kernel, console) = Kernel::new(Emulator::new(Setup::delivered()));
    kernel.run(4000);
    console.send(Command::WatchLink(true));
    // There is no display to query.
    console.watch.trust_window();
    kernel.connect(Connection {
        config: LinkConfig {
            port: twin.port.clone(),
            ..LinkConfig::default()
        },
        log: None,
        boards: None,
        program: env!("CARGO_BIN_EXE_gsk980td").into(),
    });
    let outside = Outside {
        wake: Box::new(|| {}),
        keeper: None,
        partner: None,
        ending: ending.clone(),
    };
    let mut thread = start(kernel, &console, outside).unwrap();
    let begun = Instant::now();
    let mut locked = false;
    while !locked && begun.elapsed() < LONGEST {
        std::thread::sleep(Duration::from_millis(50));
        if let Some(view) = console.link.pop() {
            locked = view.state == LinkState::Locked;
            if !view.differences.is_empty() {
                console.send(Command::Link(LinkOrder::WriteSettings));
            }
        }
    }
    assert!(locked);
    for key in [Key::Reset, Key::Jog] {
        console.send(Command::Tap(key));
        std::thread::sleep(Duration::from_millis(500));
    }
    let down = |down| Command::Key {
        key: Key::ZLeft,
        down,
    };
    // The kernel releases held keys when it receives no message for a while.
    let moving = (0..100).any(|_| {
        console.send(down(false));
        console.send(down(true));
        twin.says("Run", Duration::from_millis(500)).is_some()
    });
    assert!(moving);
    signal("TERM", std::process::id());
    // The link resets the board by Ctrl-X, moving or not.
    twin.says("reset", LONGEST).unwrap();
    assert!(ending.is_asked());
    thread.stop();
}
