//! The transfer view of the window. The control is a separate process at the other end of a
//! pseudo terminal.

use std::path::Path;
use std::time::{Duration, Instant};

use egui_kittest::kittest::Queryable;
use gsk_core::setup::Setup;
use gsk_host::pc::{SendListItem, TransferSettings};
use gsk_messages::Language;
use gsk_window::WindowSettings;
use gsk_window::layout::{Layouts, WindowLayout};

use crate::common::WindowBench;
use crate::serial::{ControlProcess, serial_folder};

/// Time limit of each wait, on a busy computer.
const TIME_LIMIT: Duration = Duration::from_secs(60);

/// A window with the transfer view.
fn open_view(port: &str, list: Vec<SendListItem>) -> WindowBench {
    let settings = WindowSettings {
        language: Language::En,
        layouts: Layouts::with_layout(WindowLayout::Panel),
        transfer: TransferSettings {
            port: port.to_owned(),
            list,
            ..TransferSettings::default()
        },
        ..WindowSettings::default()
    };
    let size = egui::vec2(1280.0, 806.0);
    let mut bench = WindowBench::with_settings(Setup::default(), settings, size);
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
fn wait_for_text(bench: &mut WindowBench, text: &str) {
    let start_time = Instant::now();
    while bench
        .harness
        .query_all_by_label_contains(text)
        .next()
        .is_none()
    {
        assert!(start_time.elapsed() < TIME_LIMIT, "{text} is never seen");
        std::thread::sleep(Duration::from_millis(5));
        bench.run(1);
    }
}

/// Draws frames until a label is no longer shown.
#[track_caller]
fn wait_until_gone(bench: &mut WindowBench, name: &str) {
    let start_time = Instant::now();
    while bench.harness.query_all_by_label(name).next().is_some() {
        assert!(start_time.elapsed() < TIME_LIMIT, "{name} stays");
        std::thread::sleep(Duration::from_millis(5));
        bench.run(1);
    }
}

#[track_caller]
fn click(bench: &mut WindowBench, name: &str) {
    bench.harness.get_by_label(name).click();
    bench.run(1);
    bench.run(1);
}

fn create_item(folder: &Path, name: &str, text: &str) -> SendListItem {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    SendListItem {
        path,
        name: name.to_owned(),
        partition: 0,
    }
}

#[test]
fn files_are_sent_renamed_on_conflict_and_deleted() {
    let folder = serial_folder("view");
    let control = ControlProcess::start(&[]);
    let list = vec![create_item(&folder, "O0007.CNC", "O0007;\nM30;\n%\n")];
    let mut bench = open_view(&control.port, list);
    wait_for_text(&mut bench, "Port closed");
    click(&mut bench, "Open port");
    wait_for_text(&mut bench, "Port open");
    click(&mut bench, "Connect");
    wait_for_text(&mut bench, "Disconnect");
    click(&mut bench, "Start");
    wait_for_text(&mut bench, "1 file(s)");

    // The answers are yes, no, cancel. No gives the existing file the proposed name.
    click(&mut bench, "Start");
    wait_for_text(&mut bench, "The control already has a file O0007.CNC");
    click(&mut bench, "No");
    wait_for_text(&mut bench, "Rename a file of the control");
    click(&mut bench, "OK");
    wait_for_text(&mut bench, "2 file(s)");
    click(&mut bench, "Receive files");
    wait_for_text(&mut bench, "O0008.CNC");
    wait_for_text(&mut bench, "ParaW.par");

    click(&mut bench, "O0008.CNC");
    click(&mut bench, "Delete files");
    wait_for_text(&mut bench, "Delete 1 file(s) of the control?");
    let confirm = bench.harness.get_all_by_label("Delete files").last();
    confirm.expect("the answer").click();
    bench.run(1);
    wait_for_text(&mut bench, "All done");
    wait_until_gone(&mut bench, "O0008.CNC");
    wait_for_text(&mut bench, "O0007.CNC");
    click(&mut bench, "Close port");
    wait_for_text(&mut bench, "Port closed");
    assert_eq!(
        control.file_names(),
        [
            "O0007.CNC",
            "Tofs.ofs",
            "Wcomp.wmp",
            "ParaW.par",
            "Main.ldx"
        ]
    );
}

#[test]
fn port_and_cable_errors_are_reported_with_advice() {
    let mut bench = open_view("/dev/no-such-port", Vec::new());
    click(&mut bench, "Open port");
    wait_for_text(&mut bench, "/dev/no-such-port cannot be opened");
    wait_for_text(&mut bench, "is it plugged in?");

    let control = ControlProcess::start(&[]);
    let mut bench = open_view(&control.port, Vec::new());
    click(&mut bench, "Open port");
    wait_for_text(&mut bench, "Port open");
    click(&mut bench, "Connect");
    wait_for_text(&mut bench, "Disconnect");
    drop(control);
    wait_for_text(&mut bench, "was the cable pulled");
    wait_for_text(&mut bench, "Open port");
}
