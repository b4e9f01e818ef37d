//! A termination signal ends the program while a board moves. This test is a separate process:
//! the signal reaches all of it.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

#[path = "common/twin.rs"]
mod twin;

use std::time::{Duration, Instant};

use gsk_core::setup::Setup;
use gsk_host::kernel::{BoardConnection, Command, Kernel, KernelEnvironment, LinkAction, start};
use gsk_host::termination::TerminationFlag;
use gsk_link::{LinkConfig, LinkState};
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use twin::{TwinProcess, send_signal};

const TIME_LIMIT: Duration = Duration::from_secs(120);

#[test]
fn a_termination_signal_stops_the_board() {
    let twin = TwinProcess::start(&[]);
    let ending = TerminationFlag::install_signal_handlers().unwrap();
    let (mut kernel, console) = Kernel::new(Emulator::new(Setup::delivered()));
    kernel.run(4000);
    console.send(Command::WatchLink(true));
    // There is no display to query.
    console.input_watch.trust_window();
    kernel.connect(BoardConnection {
        config: LinkConfig {
            port: twin.port.clone(),
            ..LinkConfig::default()
        },
        log_path: None,
        dictionary_folder: None,
        holder_program: env!("CARGO_BIN_EXE_gsk980td").into(),
    });
    let host = KernelEnvironment {
        wake: Box::new(|| {}),
        keeper: None,
        partner_folder: None,
        udisk_folder: None,
        termination: ending.clone(),
    };
    let mut thread = start(kernel, &console, host).unwrap();
    let start_time = Instant::now();
    let mut locked = false;
    while !locked && start_time.elapsed() < TIME_LIMIT {
        std::thread::sleep(Duration::from_millis(50));
        if let Some(view) = console.link.pop() {
            locked = view.state == LinkState::Locked;
            if !view.differences.is_empty() {
                console.send(Command::Link(LinkAction::WriteSettings));
            }
        }
    }
    assert!(locked);
    for key in [Key::Reset, Key::Jog] {
        console.send(Command::Tap(key));
        std::thread::sleep(Duration::from_millis(500));
    }
    let key_command = |down| Command::Key {
        key: Key::ZLeft,
        down,
    };
    // The kernel releases held keys when it receives no message for a while.
    let moving = (0..100).any(|_| {
        console.send(key_command(false));
        console.send(key_command(true));
        twin.wait_for_line("Run", Duration::from_millis(500))
            .is_some()
    });
    assert!(moving);
    send_signal("TERM", std::process::id());
    // The link resets the board by Ctrl-X, moving or not.
    twin.wait_for_line("reset", TIME_LIMIT).unwrap();
    assert!(ending.is_requested());
    thread.stop();
}
