//! The transfer view of the window. The control is a separate process at the other end of a
//! pseudo terminal.

use std::path::Path;
use std::time::{Duration, Instant};

use egui_kittest::kittest::Queryable;
use gsk_app::pc::{Item, Remembered};
use gsk_app::window::Settings;
use gsk_app::window::layout::{Layout, Layouts};
use gsk_core::setup::Setup;
use gsk_messages::Language;

use crate::common::Bench;
use crate::serial::{Control, folder};

/// Time limit of each wait, on a busy computer.
const LONGEST: Duration = Duration::from_secs(60);

/// A window with the transfer view.
fn view(port: &str, list: Vec<Item>) -> Bench {
    let settings = Settings {
        language: Language::En,
        layouts: Layouts::of(Layout::Panel),
        transfer: Remembered {
            port: port.to_owned(),
            list,
            ..Remembered::default()
        },
        ..Settings::default()
    };
    let size = egui::vec2(1280.0, 806.0);
    let mut bench = Bench::remembering(Setup::default(), settings, size);
    for entry in ["Views", "Transfer"] {
        bench.harness.get_by_label(entry).click();
        bench.run(1);
        bench.run(1);
    }
    bench.run(1);
    bench.run(1);
    bench
}

/// Draws frames until a text is shown.
#[track_caller]
fn sees(bench: &mut Bench, words: &str) {
    let begun = Instant::now();
    while bench
        .harness
        .query_all_by_label_contains(words)
        .next()
        .is_none()
    {
        assert!(begun.elapsed() < LONGEST, "{words} is never seen");
        std::thread::sleep(Duration::from_millis(5));
        bench.run(1);
    }
}

/// Draws frames until a label is no longer shown.
#[track_caller]
fn while_seen(bench: &mut Bench, name: &str) {
    let begun = Instant::now();
    while bench.harness.query_all_by_label(name).next().is_some() {
        assert!(begun.elapsed() < LONGEST, "{name} stays");
        std::thread::sleep(Duration::from_millis(5));
        bench.run(1);
    }
}

#[track_caller]
fn click(bench: &mut Bench, name: &str) {
    bench.harness.get_by_label(name).click();
    bench.run(1);
    bench.run(1);
}

fn item(folder: &Path, name: &str, text: &str) -> Item {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    Item {
        path,
        name: name.to_owned(),
        partition: 0,
    }
}

#[test]
fn files_are_sent_a_name_that_is_taken_is_asked_for_and_files_are_deleted() {
    let folder = folder("view");
    let control = Control::with(&[]);
    let list = vec![item(&folder, "O0007.CNC", "O0007;\nM30;\n%\n")];
    let mut bench = view(&control.port, list);
    sees(&mut bench, "Port closed");
    click(&mut bench, "Open port");
    sees(&mut bench, "Port open");
    click(&mut bench, "Connect");
    sees(&mut bench, "Disconnect");
    click(&mut bench, "Start");
    sees(&mut bench, "1 file(s)");

    // The answers are yes, no, cancel. No gives the existing file the proposed name.
    click(&mut bench, "Start");
    sees(&mut bench, "The control has a file O0007.CNC already");
    click(&mut bench, "No");
    sees(&mut bench, "Rename a file of the control");
    click(&mut bench, "OK");
    sees(&mut bench, "2 file(s)");
    click(&mut bench, "Receive files");
    sees(&mut bench, "O0008.CNC");
    sees(&mut bench, "ParaW.par");

    click(&mut bench, "O0008.CNC");
    click(&mut bench, "Delete files");
    sees(&mut bench, "Delete 1 file(s) of the control?");
    let agree = bench.harness.get_all_by_label("Delete files").last();
    agree.expect("the answer").click();
    bench.run(1);
    sees(&mut bench, "All done");
    while_seen(&mut bench, "O0008.CNC");
    sees(&mut bench, "O0007.CNC");
    click(&mut bench, "Close port");
    sees(&mut bench, "Port closed");
    assert_eq!(
        control.listed(),
        ["O0007.CNC", "Tofs.ofs", "Wcomp.wmp", "ParaW.par"]
    );
}

#[test]
fn what_is_wrong_with_port_and_cable_is_said_with_what_to_do() {
    let mut bench = view("/dev/no-such-port", Vec::new());
    click(&mut bench, "Open port");
    sees(&mut bench, "/dev/no-such-port cannot be opened");
    sees(&mut bench, "is it plugged in?");

    let control = Control::with(&[]);
    let mut bench = view(&control.port, Vec::new());
    click(&mut bench, "Open port");
    sees(&mut bench, "Port open");
    click(&mut bench, "Connect");
    sees(&mut bench, "Disconnect");
    drop(control);
    sees(&mut bench, "was the cable pulled");
    sees(&mut bench, "Open port");
}
