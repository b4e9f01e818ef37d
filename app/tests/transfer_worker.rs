//! The thread of the transfer view: its orders and events, with a control in a separate
//! process.

use std::path::Path;
use std::time::{Duration, Instant};

use gsk_host::pc::worker::{
    ConnectionStage, FileResult, NameConflict, NameConflictAnswer, NameConflictChoice, PcWorker,
    PcWorkerCommand, PcWorkerEvent, ToSend,
};
use gsk_messages::Language;
use gsk_transfer::{FileName, Partition, RemotePath};

use crate::serial::{ControlProcess, serial_folder};

/// Time limit of each wait, on a busy computer.
const TIME_LIMIT: Duration = Duration::from_secs(60);
const SHAFT: &str = "O0007 (SHAFT);\nG00 X10.;\nM30;\n%\n";

/// Receives events until `wanted` returns a value.
#[track_caller]
fn wait_for_event<T>(worker: &PcWorker, mut wanted: impl FnMut(PcWorkerEvent) -> Option<T>) -> T {
    let start_time = Instant::now();
    loop {
        match worker.next_event() {
            Some(news) => {
                if let Some(found) = wanted(news) {
                    return found;
                }
            }
            None => std::thread::sleep(Duration::from_millis(2)),
        }
        assert!(start_time.elapsed() < TIME_LIMIT, "it never comes");
    }
}

/// Starts a thread and opens the port of a control.
fn open_port(control: &ControlProcess) -> PcWorker {
    let worker = PcWorker::start(|| {}).expect("a thread");
    worker.send_command(PcWorkerCommand::Open {
        port: control.port.clone(),
        baud: 115_200,
    });
    worker
}

fn connect(control: &ControlProcess) -> PcWorker {
    let worker = open_port(control);
    worker.send_command(PcWorkerCommand::Connect);
    wait_for_event(&worker, |news| {
        matches!(news, PcWorkerEvent::Listed(_)).then_some(())
    });
    worker
}

/// Waits for the end of a job and answers each question with `choice`. Returns the results of
/// the files, the error, and the count of questions.
#[track_caller]
fn wait_for_end(
    worker: &PcWorker,
    choice: &NameConflictChoice,
) -> (Vec<FileResult>, Option<String>, usize) {
    let (mut fates, mut question_count) = (Vec::new(), 0);
    let error = wait_for_event(worker, |news| match news {
        PcWorkerEvent::FileEnded(_, fate) => {
            fates.push(fate);
            None
        }
        PcWorkerEvent::Conflict(_) => {
            question_count += 1;
            worker.send_command(PcWorkerCommand::Answer(NameConflictAnswer {
                choice: choice.clone(),
                for_all: true,
            }));
            None
        }
        PcWorkerEvent::JobFinished(error) => Some(error),
        _ => None,
    });
    (
        fates,
        error.map(|why| why.text(Language::En)),
        question_count,
    )
}

fn file_to_send(folder: &Path, name: &str, text: &str) -> ToSend {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    ToSend {
        path,
        location: RemotePath {
            partition: Partition::User,
            name: FileName::new(name).expect("a name"),
        },
        overwrite: false,
    }
}

#[test]
fn a_backup_is_restored_and_files_of_the_pc_are_kept() {
    let folder = serial_folder("worker");
    let saved = folder.join("saved");
    let control = ControlProcess::start(&["--parameter-switch"]);
    let worker = connect(&control);
    worker.send_command(PcWorkerCommand::Send(vec![file_to_send(
        &folder,
        "O0007.CNC",
        SHAFT,
    )]));
    assert_eq!(
        wait_for_end(&worker, &NameConflictChoice::Skip),
        (vec![FileResult::Done], None, 0)
    );
    worker.send_command(PcWorkerCommand::BackUp(saved.clone()));
    let all = vec![FileResult::Done; 5];
    assert_eq!(
        wait_for_end(&worker, &NameConflictChoice::Skip),
        (all.clone(), None, 0)
    );
    let text = |name: &str| std::fs::read_to_string(saved.join(name)).expect("a file");
    assert_eq!(text("O0007.CNC"), SHAFT);

    // In a second backup every name exists; one answer applies to all.
    std::fs::write(saved.join("O0007.CNC"), "mine").expect("written");
    worker.send_command(PcWorkerCommand::BackUp(saved.clone()));
    let skipped = vec![FileResult::Skipped; 5];
    assert_eq!(
        wait_for_end(&worker, &NameConflictChoice::Skip),
        (skipped, None, 1)
    );
    assert_eq!(text("O0007.CNC"), "mine");
    worker.send_command(PcWorkerCommand::BackUp(saved.clone()));
    assert_eq!(
        wait_for_end(&worker, &NameConflictChoice::Rename(None)),
        (all.clone(), None, 1)
    );
    assert_eq!(
        (text("O0007.CNC").as_str(), text("O0007 (2).CNC").as_str()),
        ("mine", SHAFT)
    );

    let changed = SHAFT.replace("X10.", "X20.");
    std::fs::write(saved.join("O0007.CNC"), &changed).expect("written");
    worker.send_command(PcWorkerCommand::Restore(saved.clone()));
    assert_eq!(
        wait_for_end(&worker, &NameConflictChoice::Skip),
        (all, None, 0)
    );
    worker.send_command(PcWorkerCommand::BackUp(folder.join("again")));
    wait_for_end(&worker, &NameConflictChoice::Skip);
    let again = std::fs::read_to_string(folder.join("again/O0007.CNC"));
    assert_eq!(again.expect("a file"), changed);
}

#[test]
fn a_cancelled_job_stores_no_file() {
    let folder = serial_folder("cancelled");
    let control = ControlProcess::start(&[]);
    let worker = connect(&control);
    let long: String = (1..9000)
        .map(|n| format!("N{n} G01 X{}.;\n", n % 90))
        .collect();
    let long = format!("O0100;\n{long}M30;\n%\n");
    let files = vec![
        file_to_send(&folder, "O0100.CNC", &long),
        file_to_send(&folder, "O0101.CNC", "O0101;\nM30;\n%\n"),
    ];
    worker.send_command(PcWorkerCommand::Send(files));
    wait_for_event(&worker, |news| match news {
        PcWorkerEvent::Progress(progress, _) if progress.done > 2000 => Some(()),
        _ => None,
    });
    worker.cancel();
    let (fates, error, _) = wait_for_end(&worker, &NameConflictChoice::Skip);
    assert_eq!(fates, []);
    assert_eq!(error.as_deref(), Some("0 of 2 files; cancelled"));
    let partitions = wait_for_event(&worker, |news| match news {
        PcWorkerEvent::Listed(partitions) => Some(partitions),
        _ => None,
    });
    let programs = partitions.iter().flat_map(|(_, entries)| entries);
    assert!(
        programs
            .into_iter()
            .all(|it| it.name.program_number().is_none()),
        "{partitions:?}"
    );
    // The next job is not cancelled.
    worker.send_command(PcWorkerCommand::Send(vec![file_to_send(
        &folder,
        "O0007.CNC",
        SHAFT,
    )]));
    assert_eq!(
        wait_for_end(&worker, &NameConflictChoice::Skip),
        (vec![FileResult::Done], None, 0)
    );
}

#[test]
fn a_pushed_file_is_received_and_an_existing_name_offers_a_free_one() {
    let folder = serial_folder("pushed");
    let file = file_to_send(&folder, "O0007.CNC", SHAFT);
    let path = file.path.to_string_lossy().into_owned();
    let control = ControlProcess::start(&["--out", &path, "--out-after", "1"]);
    let worker = open_port(&control);
    let received = wait_for_event(&worker, |news| match news {
        PcWorkerEvent::Pushed(file) => Some(file),
        _ => None,
    });
    assert_eq!(received.bytes, SHAFT.as_bytes());
    let saved_path = folder.join("kept.CNC");
    worker.send_command(PcWorkerCommand::StorePushed {
        path: saved_path.clone(),
        file: received,
    });
    wait_for_event(&worker, |news| {
        matches!(news, PcWorkerEvent::Succeeded(_)).then_some(())
    });
    assert_eq!(std::fs::read_to_string(saved_path).expect("a file"), SHAFT);

    worker.send_command(PcWorkerCommand::Send(vec![file]));
    let free = wait_for_event(&worker, |news| match news {
        PcWorkerEvent::Conflict(NameConflict::AtControl {
            free_name: free, ..
        }) => Some(free),
        _ => None,
    });
    assert_eq!(free, Some(FileName::from_program(8)));
    // The port is closed during the question: no file is sent, and the job ends.
    worker.send_command(PcWorkerCommand::Close);
    let (_, error, _) = wait_for_end(&worker, &NameConflictChoice::Skip);
    assert!(error.is_some());
    let mut worker = connect(&control);
    drop(control);
    wait_for_event(&worker, |news| {
        matches!(news, PcWorkerEvent::Stage(ConnectionStage::Closed)).then_some(())
    });
    worker = open_port(&ControlProcess::start(&[]));
    wait_for_event(&worker, |news| {
        matches!(news, PcWorkerEvent::Failed(_)).then_some(())
    });
}
