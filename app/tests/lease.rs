//! A key of the window whose release never comes.

use std::time::{Duration, Instant};

use gsk_app::ending::Ending;
use gsk_app::kernel::{Command, Console, Kernel, Outside, start};
use gsk_core::setup::Setup;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;

const LONGEST: Duration = Duration::from_secs(60);

/// Whether a picture comes in which the key is down, or up.
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

#[test]
fn a_key_comes_up_when_nobody_says_any_more_that_it_is_held() {
    let (mut kernel, console) = Kernel::new(Emulator::new(Setup::delivered()));
    kernel.run(4000);
    let outside = Outside {
        wake: Box::new(|| {}),
        keeper: None,
        partner: None,
        ending: Ending::heard().unwrap(),
    };
    let mut thread = start(kernel, &console, outside).unwrap();
    // On a busy computer it may be up again before a picture was taken.
    let pressed = (0..100).any(|_| {
        let (key, down) = (Key::ZLeft, true);
        console.send(Command::Key { key, down });
        is_seen(&console, true, Duration::from_millis(500))
    });
    assert!(pressed);
    assert!(is_seen(&console, false, LONGEST), "it stays down for ever");
    assert!(thread.is_alive());
    thread.stop();
}
