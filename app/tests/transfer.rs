//! The partner of the serial port: what the control sends is stored in a folder; a file that
//! is dropped on the window is received.

use std::path::Path;
use std::time::Duration;

use gsk_core::setup::Setup;
use gsk_host::kernel::{Command, Kernel, KernelEnvironment, Notice, start};
use gsk_host::termination::TerminationFlag;
use gsk_host::transfer;
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::keys::Key;
use gsk_panel::panel::SerialCable;

use crate::common::folder::TempFolder;
use crate::process::executable;

/// A control in EDIT mode, on the program page, with O0331 typed.
fn ready_to_send() -> Emulator {
    let mut setup = Setup::default();
    setup
        .memory
        .programs
        .store("O0331;\nM30;\n")
        .expect("room for a program");
    let mut emulator = Emulator::new(setup);
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    emulator.connect_cable(SerialCable::Simulated);
    emulator.press(Key::Edit);
    emulator.press(Key::Program);
    emulator.type_text("O331");
    emulator
}

/// The notice of the kernel thread after OUT.
fn notice_after_output(partner: &Path) -> Option<Notice> {
    let (kernel, console) = Kernel::new(ready_to_send());
    let host = KernelEnvironment {
        wake: Box::new(|| {}),
        keeper: None,
        partner_folder: Some(partner.to_owned()),
        udisk_folder: None,
        termination: TerminationFlag::default(),
    };
    let mut thread = start(kernel, &console, host).expect("a thread");
    console.send(Command::Tap(Key::Output));
    let notice = console.notices.recv_timeout(Duration::from_secs(60)).ok();
    thread.stop();
    notice
}

#[test]
fn a_sent_program_is_stored_in_the_folder() {
    let data = TempFolder::new("sent");
    let partner = data.join(transfer::FOLDER);
    let notice = notice_after_output(&partner);
    let expected = format!("O0331.CNC → {}", partner.display());
    assert_eq!(notice, Some(Notice::Sent(expected)));
    let text = std::fs::read_to_string(partner.join("O0331.CNC")).expect("the file");
    assert_eq!(text, "O0331;\nM30;\n%\n");
}

#[test]
fn an_unwritable_folder_is_reported() {
    let data = TempFolder::new("not-sent");
    let partner = data.join(transfer::FOLDER);
    std::fs::write(&partner, b"a file in the way").expect("written");
    let notice = notice_after_output(&partner);
    assert!(
        matches!(&notice, Some(Notice::Message(text)) if text.to_string().contains("cannot be written")),
        "{notice:?}"
    );
}

#[test]
fn a_script_sends_into_its_data_directory_and_receives_from_its_folder() {
    let data = TempFolder::new("script");
    let script = data.join("operate.txt");
    let text = "receive o0007.nc\nwait 1s\npress EDIT\npress PRG\ntype O7\npress OUT\nwait 1s\n";
    std::fs::write(&script, text).expect("written");
    std::fs::write(data.join("o0007.nc"), "O0007;\nM99;\n%\n").expect("written");
    let output = executable()
        .args(["operate", "--data"])
        .args([&data.0, &script])
        .output()
        .expect("the program");
    assert!(output.status.success(), "{output:?}");
    let sent = data.join(transfer::FOLDER).join("O0007.CNC");
    let text = std::fs::read_to_string(sent).expect("the file");
    assert_eq!(text, "O0007;\nM99;\n%\n");
}
