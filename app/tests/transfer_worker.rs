//! The thread of the transfer view: its orders and events, with a control in a separate
//! process.

use std::path::Path;
use std::time::{Duration, Instant};

use gsk_app::pc::worker::{Answer, Choice, Fate, News, Order, Question, Stage, ToSend, Worker};
use gsk_messages::Language;
use gsk_transfer::{FileName, Partition, RemotePath};

use crate::serial::{Control, folder};

/// Time limit of each wait, on a busy computer.
const LONGEST: Duration = Duration::from_secs(60);
const SHAFT: &str = "O0007 (SHAFT);\nG00 X10.;\nM30;\n%\n";

/// Receives events until `wanted` returns a value.
#[track_caller]
fn until<T>(worker: &Worker, mut wanted: impl FnMut(News) -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        match worker.news() {
            Some(news) => {
                if let Some(found) = wanted(news) {
                    return found;
                }
            }
            None => std::thread::sleep(Duration::from_millis(2)),
        }
        assert!(begun.elapsed() < LONGEST, "it never comes");
    }
}

/// Starts a thread and opens the port of a control.
fn at(control: &Control) -> Worker {
    let worker = Worker::start(|| {}).expect("a thread");
    worker.order(Order::Open {
        port: control.port.clone(),
        baud: 115_200,
    });
    worker
}

fn connected(control: &Control) -> Worker {
    let worker = at(control);
    worker.order(Order::Connect);
    until(&worker, |news| {
        matches!(news, News::Listed(_)).then_some(())
    });
    worker
}

/// Waits for the end of a job and answers each question with `choice`. Returns the results of
/// the files, the error, and the count of questions.
#[track_caller]
fn over(worker: &Worker, choice: &Choice) -> (Vec<Fate>, Option<String>, usize) {
    let (mut fates, mut asked) = (Vec::new(), 0);
    let why = until(worker, |news| match news {
        News::Ended(_, fate) => {
            fates.push(fate);
            None
        }
        News::Asked(_) => {
            asked += 1;
            worker.order(Order::Answer(Answer {
                choice: choice.clone(),
                of_all: true,
            }));
            None
        }
        News::Over(why) => Some(why),
        _ => None,
    });
    (fates, why.map(|why| why.text(Language::En)), asked)
}

fn to_send(folder: &Path, name: &str, text: &str) -> ToSend {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    ToSend {
        path,
        place: RemotePath {
            partition: Partition::User,
            name: FileName::new(name).expect("a name"),
        },
        overwrite: false,
    }
}

#[test]
fn a_set_is_saved_and_brought_back_and_files_of_the_pc_are_not_lost() {
    let folder = folder("worker");
    let saved = folder.join("saved");
    let control = Control::with(&["--parameter-switch"]);
    let worker = connected(&control);
    worker.order(Order::Send(vec![to_send(&folder, "O0007.CNC", SHAFT)]));
    assert_eq!(over(&worker, &Choice::Skip), (vec![Fate::Done], None, 0));
    worker.order(Order::BackUp(saved.clone()));
    let all = vec![Fate::Done; 4];
    assert_eq!(over(&worker, &Choice::Skip), (all.clone(), None, 0));
    let text = |name: &str| std::fs::read_to_string(saved.join(name)).expect("a file");
    assert_eq!(text("O0007.CNC"), SHAFT);

    // In a second backup every name exists; one answer applies to all.
    std::fs::write(saved.join("O0007.CNC"), "mine").expect("written");
    worker.order(Order::BackUp(saved.clone()));
    let skipped = vec![Fate::Skipped; 4];
    assert_eq!(over(&worker, &Choice::Skip), (skipped, None, 1));
    assert_eq!(text("O0007.CNC"), "mine");
    worker.order(Order::BackUp(saved.clone()));
    assert_eq!(over(&worker, &Choice::Rename(None)), (all.clone(), None, 1));
    assert_eq!(
        (text("O0007.CNC").as_str(), text("O0007 (2).CNC").as_str()),
        ("mine", SHAFT)
    );

    let changed = SHAFT.replace("X10.", "X20.");
    std::fs::write(saved.join("O0007.CNC"), &changed).expect("written");
    worker.order(Order::Restore(saved.clone()));
    assert_eq!(over(&worker, &Choice::Skip), (all, None, 0));
    worker.order(Order::BackUp(folder.join("again")));
    over(&worker, &Choice::Skip);
    let again = std::fs::read_to_string(folder.join("again/O0007.CNC"));
    assert_eq!(again.expect("a file"), changed);
}

#[test]
fn a_job_is_broken_off_at_once_and_leaves_nothing_half() {
    let folder = folder("cancelled");
    let control = Control::with(&[]);
    let worker = connected(&control);
    let long: String = (1..9000)
        .map(|n| format!("N{n} G01 X{}.;\n", n % 90))
        .collect();
    let long = format!("O0100;\n{long}M30;\n%\n");
    let files = vec![
        to_send(&folder, "O0100.CNC", &long),
        to_send(&folder, "O0101.CNC", "O0101;\nM30;\n%\n"),
    ];
    worker.order(Order::Send(files));
    until(&worker, |news| match news {
        News::Moves(progress, _) if progress.done > 2000 => Some(()),
        _ => None,
    });
    worker.cancel();
    let (fates, why, _) = over(&worker, &Choice::Skip);
    assert_eq!(fates, []);
    assert_eq!(why.as_deref(), Some("0 of 2 files; broken off"));
    let listed = until(&worker, |news| match news {
        News::Listed(partitions) => Some(partitions),
        _ => None,
    });
    let programs = listed.iter().flat_map(|(_, entries)| entries);
    assert!(
        programs
            .into_iter()
            .all(|it| it.name.program_number().is_none()),
        "{listed:?}"
    );
    // The next job is not cancelled.
    worker.order(Order::Send(vec![to_send(&folder, "O0007.CNC", SHAFT)]));
    assert_eq!(over(&worker, &Choice::Skip), (vec![Fate::Done], None, 0));
}

#[test]
fn what_the_control_sends_by_itself_comes_in_and_a_taken_name_offers_a_free_one() {
    let folder = folder("pushed");
    let file = to_send(&folder, "O0007.CNC", SHAFT);
    let path = file.path.to_string_lossy().into_owned();
    let control = Control::with(&["--out", &path, "--out-after", "1"]);
    let worker = at(&control);
    let pushed = until(&worker, |news| match news {
        News::Pushed(file) => Some(file),
        _ => None,
    });
    assert_eq!(pushed.bytes, SHAFT.as_bytes());
    let kept = folder.join("kept.CNC");
    worker.order(Order::Keep {
        path: kept.clone(),
        file: pushed,
    });
    until(&worker, |news| matches!(news, News::Said(_)).then_some(()));
    assert_eq!(std::fs::read_to_string(kept).expect("a file"), SHAFT);

    worker.order(Order::Send(vec![file]));
    let free = until(&worker, |news| match news {
        News::Asked(Question::AtControl { free, .. }) => Some(free),
        _ => None,
    });
    assert_eq!(free, Some(FileName::from_program(8)));
    // The port is closed during the question: no file is sent, and the job ends.
    worker.order(Order::Close);
    let (_, why, _) = over(&worker, &Choice::Skip);
    assert!(why.is_some());
    let mut worker = connected(&control);
    drop(control);
    until(&worker, |news| {
        matches!(news, News::Stage(Stage::Closed)).then_some(())
    });
    worker = at(&Control::with(&[]));
    until(&worker, |news| {
        matches!(news, News::Failed(_)).then_some(())
    });
}
