//! Keeps the time line and the flight recorders of the kernel up to date.

use gsk_messages::Message;

use super::{Kernel, Notice};
use crate::flight::{FlightRecorder, join_inputs};

impl Kernel {
    /// Adds a recorder. It follows the learner's own machine, also during a lesson.
    pub fn add_flight_recorder(&mut self, recorder: FlightRecorder) {
        self.recorders.push(recorder);
        self.follow_with_recorders();
    }

    /// Passes the inputs since the last call to the time line and to the recorders, which also
    /// receive the exchange with a pulse board.
    pub(super) fn follow_with_recorders(&mut self) {
        self.record_exercise();
        let (own, part, timeline) = match &mut self.lesson {
            Some(lesson) => {
                let own = lesson.own_state();
                let timeline = own.timeline.as_mut().unwrap_or(&mut self.timeline);
                (&mut *own.emulator, &mut own.part, timeline)
            }
            None => (&mut self.emulator, &mut self.part, &mut self.timeline),
        };
        let inputs = join_inputs(own.ticks(), own.take_inputs(), part.take_inputs());
        timeline.follow(own, part.state(), &inputs, self.has_real_slides);
        let steps = core::mem::take(&mut self.exchange);
        for recorder in &mut self.recorders {
            recorder.follow_board(&steps, self.has_real_slides);
            if recorder.follows_board() || !self.has_real_slides {
                recorder.follow(own, part.state(), &inputs, &steps);
            }
        }
    }

    /// Passes the recorded bytes to the disk. A recorder whose disk has failed ends, with a notice.
    pub(super) fn flush_recorders(&mut self) {
        self.follow_with_recorders();
        let own = match &self.lesson {
            Some(lesson) => lesson.own_machine(),
            None => &self.emulator,
        };
        let recorders = self.recorders.iter_mut();
        let failures: Vec<Message> = recorders
            .filter_map(|recorder| recorder.flush(own))
            .collect();
        for failure in failures {
            tracing::error!("{failure}");
            self.notify(Notice::Message(failure));
        }
    }

    /// Ends all recordings. `is_complete` is false after a crash of the program.
    pub(super) fn finish_recorders(&mut self, is_complete: bool) {
        self.follow_with_recorders();
        for recorder in self.recorders.drain(..) {
            recorder.finish(is_complete);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::sync::Arc;

    use gsk_core::cnc::ControlRequest;
    use gsk_core::machine::{LatheFault, LoadLimits};
    use gsk_core::setup::Setup;
    use gsk_history::moment::HistoryInput;
    use gsk_history::replay::replay;
    use gsk_lesson::{Lesson, built_in_lessons};
    use gsk_panel::emulator::{Emulator, EmulatorInput};
    use gsk_panel::keys::Key;
    use gsk_panel::panel::SerialFile;
    use gsk_tests::test_folder;
    use gsk_workpiece::job::Job;
    use gsk_workpiece::stock::Stock;
    use gsk_workpiece::tool::Tool;

    use super::*;
    use crate::flight::RecordingTarget;
    use crate::job::SelectedJob;
    use crate::kernel::{Command, LessonAction};

    /// A program with a rapid through the stock.
    const CRASH: &str = "O0001;\nG50 X60 Z20;\nT0101 M03 S500;\nG00 X52 Z2;\nG01 X48 F300;\n\
                         Z-5;\nG00 X20 Z-30;\nM30;\n";

    fn selected_job() -> Box<SelectedJob> {
        let mut job = Job::new(Stock::bar(50.0, 0.0, 60.0));
        job.tools.insert(1, Tool::turning());
        Box::new(SelectedJob {
            job,
            file: Some("bar.job.ron".into()),
        })
    }

    #[test]
    fn what_the_window_commands_is_replayed_with_part_and_crash() {
        let folder = test_folder("kernel-recording");
        let file = folder.join("kernel.gskrec");
        let (mut kernel, console) = Kernel::new(Emulator::new(Setup::default()));
        let target = RecordingTarget::File(file.clone());
        kernel.add_flight_recorder(FlightRecorder::start(target).expect("a thread"));
        let lesson = built_in_lessons().into_iter().next().expect("a lesson");
        let commands = [
            Command::Job(Some(selected_job())),
            Command::Request(Box::new(ControlRequest::StoreProgram(CRASH.to_owned()))),
            Command::Tap(Key::Auto),
            Command::Tap(Key::CycleStart),
            Command::Fault(LatheFault::DoorOpen, true),
            Command::Turn(5),
            Command::Receive(Box::new(SerialFile {
                name: "O0003.CNC".to_owned(),
                text: "O0003;\nM99;\n".to_owned(),
            })),
            Command::FreeLathe,
            Command::FreshStock,
            Command::CrashStops(false),
            Command::PowerCycle,
            Command::Tap(Key::Jog),
        ];
        kernel.run(4000);
        for command in commands {
            console.send(command);
            kernel.run(6000);
            kernel.flush_recorders();
        }
        begin_and_leave(&mut kernel, Arc::new(lesson));
        kernel.run(100);
        kernel.finish_recorders(true);
        let replayed = replay(&fs::read(&file).expect("a file")).expect("a recording");
        assert_eq!((replayed.error, replayed.difference), (None, None));
        assert!(replayed.is_complete && replayed.equal_hashes > 5);
        let history = replayed.history.expect("a session");
        let crashed = history.inputs().iter().any(|recorded| {
            let blocked = EmulatorInput::Fault(LatheFault::SpindleBlocked, true);
            recorded.input == HistoryInput::Machine(blocked)
        });
        assert!(crashed, "the program hits the stock");
        let end = history.present().expect("the end");
        assert!(end.emulator == kernel.emulator);
        let part = |part: &gsk_history::machine_part::MachinePart| {
            part.machining().expect("a job").scene().part().clone()
        };
        assert_eq!(part(&end.part), part(kernel.part.state()));
        assert!(!end.part.crash_stops());
    }

    /// A pass of 2 mm with a feed that no nose of 0.8 mm bears.
    const OVERLOAD: &str = "O0001;\nG50 X60 Z20;\nT0101 M03 S500;\nG99 G00 X52 Z2;\nX46;\n\
                            G01 Z-8 F0.2;\nZ-30 F1.3;\nX54 F0.3;\nG00 X60 Z20;\nM30;\n";

    /// Runs the pass with the limits of a machine file, and returns the kernel.
    fn run_overload(limits: LoadLimits, by_switch: bool) -> (Kernel, crate::kernel::Console) {
        let mut setup = Setup::default();
        setup.lathe.load = limits;
        let (mut kernel, console) = Kernel::new(Emulator::new(setup));
        kernel.run(4000);
        let text = OVERLOAD.to_owned();
        console.send(Command::Job(Some(selected_job())));
        console.send(Command::Overload(by_switch));
        console.send(Command::Request(Box::new(ControlRequest::StoreProgram(
            text,
        ))));
        for key in [Key::Auto, Key::CycleStart] {
            console.send(Command::Tap(key));
            kernel.run(300);
        }
        (kernel, console)
    }

    fn fault_after(limits: LoadLimits, ms: u64) -> (Vec<LatheFault>, Option<String>) {
        let (mut kernel, console) = run_overload(limits, false);
        kernel.run(ms);
        let lathe = kernel.emulator.lathe();
        let active = LatheFault::ALL.map(|(_, fault)| fault).into_iter();
        let active = active.filter(|fault| lathe.has_fault(*fault)).collect();
        let message = kernel.part.crash_message(&kernel.emulator);
        console.send(Command::FreeLathe);
        kernel.run(10);
        assert_eq!(kernel.emulator.lathe().fault_count(), 0);
        assert_eq!(kernel.part.crash_message(&kernel.emulator), None);
        (
            active,
            message.map(|it| it.text(gsk_messages::Language::En)),
        )
    }

    #[test]
    fn a_cut_above_the_limits_breaks_the_insert_and_the_replay_is_the_same() {
        let folder = test_folder("overload-recording");
        let file = folder.join("overload.gskrec");
        let (mut kernel, console) = run_overload(LoadLimits::default(), true);
        let target = RecordingTarget::File(file.clone());
        kernel.add_flight_recorder(FlightRecorder::start(target).expect("a thread"));
        for _ in 0..8 {
            kernel.run(5000);
            kernel.flush_recorders();
        }
        assert!(kernel.emulator.lathe().has_fault(LatheFault::InsertBroken));
        let part = |part: &gsk_history::machine_part::MachinePart| {
            part.machining().expect("a job").scene().part().clone()
        };
        let turned = part(kernel.part.state());
        assert!((turned.max_radius(-7.0, -1.0) - 23.0).abs() < 1e-3);
        assert!(
            (turned.max_radius(-25.0, -15.0) - 25.0).abs() < 1e-3,
            "not cut"
        );
        console.send(Command::FreeLathe);
        kernel.run(100);
        assert!(!kernel.emulator.lathe().has_fault(LatheFault::InsertBroken));
        kernel.finish_recorders(true);
        let replayed = replay(&fs::read(&file).expect("a file")).expect("a recording");
        assert_eq!((replayed.error, replayed.difference), (None, None));
        assert!(replayed.is_complete && replayed.equal_hashes >= 2);
        let history = replayed.history.expect("a session");
        let end = history.present().expect("the end");
        assert!(end.emulator == kernel.emulator && end.part.overload());
        assert_eq!(part(&end.part), turned);
        let breaks = EmulatorInput::Fault(LatheFault::InsertBroken, true);
        let count = history.inputs().iter();
        let count = count.filter(|it| it.input == HistoryInput::Machine(breaks.clone()));
        assert_eq!(count.count(), 1);
    }

    #[test]
    fn the_machine_file_switches_overload_on_and_gives_the_limits() {
        let limits = |power_kw, grip_nm, events| LoadLimits {
            power_kw,
            grip_nm,
            events,
            ..LoadLimits::default()
        };
        assert_eq!(
            fault_after(limits(Some(0.1), Some(1.0), false), 30_000),
            (vec![], None)
        );
        let (faults, message) = fault_after(limits(Some(0.1), None, true), 6000);
        assert!(faults.contains(&LatheFault::SpindleBlocked), "{faults:?}");
        let message = message.expect("a sentence");
        assert!(message.contains("the spindle stalls"), "{message}");
        // Stock that does not turn stops the next motion of the tool as a crash does.
        let (faults, message) = fault_after(limits(None, Some(1.0), true), 6000);
        assert!(faults.contains(&LatheFault::StockLoose), "{faults:?}");
        assert!(faults.contains(&LatheFault::DriveZ), "{faults:?}");
        let message = message.expect("a sentence");
        assert!(
            message.contains("slips in the chuck") && message.contains("CRASH"),
            "{message}"
        );
        let (faults, message) = fault_after(limits(None, None, true), 40_000);
        assert!(faults.contains(&LatheFault::InsertBroken), "{faults:?}");
        assert!(message.expect("a sentence").contains("breaks at a feed of"));
    }

    /// The learner's own machine waits during a lesson, and its recording with it.
    fn begin_and_leave(kernel: &mut Kernel, lesson: Arc<Lesson>) {
        let before = kernel.emulator.ticks();
        kernel.execute_lesson_command(LessonAction::Begin(lesson));
        assert!(kernel.lesson.is_some());
        kernel.run(500);
        kernel.flush_recorders();
        kernel.execute_lesson_command(LessonAction::Leave);
        assert_eq!(kernel.emulator.ticks(), before);
    }
}
