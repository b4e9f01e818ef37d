//! Receives what comes from outside: snapshots and notices of the kernel, dropped files.

use std::path::PathBuf;

use egui::{Context, Ui};
use gsk_core::command::ProgramId;
use gsk_core::operation::RunState;
use gsk_host::files::tool_library;
use gsk_host::kernel::{Notice, PanelSnapshot};
use gsk_host::platform;
use gsk_messages::say;

use crate::Window;
use crate::widgets::status_message::StatusMessage;

/// Whether another machine is operated since an earlier snapshot: a practice machine, the learner's
/// own one, or that of an exercise which has begun again.
fn is_other_machine(before: &PanelSnapshot, now: &PanelSnapshot) -> bool {
    let begun_at = |snapshot: &PanelSnapshot| snapshot.exercise.as_ref().map(|it| it.begun_at);
    before.is_at_practice_machine() != now.is_at_practice_machine()
        || begun_at(before) != begun_at(now)
}

impl Window {
    /// Takes the snapshots and notices that the kernel has sent.
    pub(crate) fn receive(&mut self, context: &Context) {
        let snapshot = self.console.snapshots.pop();
        let deselected = snapshot.and_then(|snapshot| self.take_snapshot(snapshot));
        while let Ok(notice) = self.console.notices.try_recv() {
            self.take_notice(notice, context);
        }
        if let (Some(message), Some((file, time_s))) =
            (&mut self.message, self.views.lathe().program_time())
        {
            message.update_time(file, time_s);
        }
        // The preview of the newly selected program arrived before this snapshot and stays.
        self.message
            .take_if(|message| deselected.is_some_and(|program| message.is_about(program)));
    }

    /// Takes a snapshot. Returns the program that was selected until now; `None` if it still is.
    fn take_snapshot(&mut self, snapshot: PanelSnapshot) -> Option<ProgramId> {
        let previous = self.snapshot.as_ref();
        let alarm = previous.and_then(|it| it.alarm.as_ref());
        let is_new_alarm = snapshot.alarm.is_some() && snapshot.alarm.as_ref() != alarm;
        let was_position_known = previous.is_some_and(|it| !it.position_unknown);
        // The alarm of a crash says less than the crash itself.
        if (is_new_alarm && snapshot.crash.is_none())
            || (snapshot.position_unknown && was_position_known)
        {
            // The new alarm or the lost position replaces an older message.
            self.message = None;
        }
        // What was shown before a program starts is no longer true in it.
        let starts = previous.is_some_and(|it| it.run_state == RunState::Reset)
            && snapshot.run_state == RunState::Run;
        let is_passing = |message: &mut StatusMessage| {
            matches!(
                message,
                StatusMessage::Text(_) | StatusMessage::KeyRefused(_)
            )
        };
        // A hint where the next cycle start begins must not be hidden.
        let warns_of_start = previous.is_some_and(|it| {
            (it.resumes_at.is_none() && snapshot.resumes_at.is_some())
                || (it.start_distance.is_none() && snapshot.start_distance.is_some())
        });
        if starts || warns_of_start {
            self.message.take_if(is_passing);
        }
        let previous_program = previous.and_then(|it| it.program);
        let deselected = previous_program.filter(|program| snapshot.program != Some(*program));
        if previous.is_none_or(|before| before.screen != snapshot.screen) {
            platform::publish_screen_text(|| snapshot.screen.text());
        }
        // A practice machine without a part must not show that of the learner's own lathe.
        if previous
            .is_some_and(|it| it.is_at_practice_machine() != snapshot.is_at_practice_machine())
        {
            self.views.renew_part();
        }
        if previous.is_some_and(|before| is_other_machine(before, &snapshot)) {
            // The crash, or what was passing, was on the machine that was replaced.
            self.message.take_if(|message| {
                matches!(message, StatusMessage::Collided(_)) || is_passing(message)
            });
        }
        self.views.lessons().take_snapshot(&snapshot);
        self.views.program().take_snapshot(&snapshot);
        self.play_machine(&snapshot);
        self.snapshot = Some(snapshot);
        deselected
    }

    fn take_notice(&mut self, notice: Notice, context: &Context) {
        match notice {
            Notice::Message(text) => self.message = Some(StatusMessage::Text(text)),
            Notice::Collided(what) => self.message = Some(StatusMessage::Collided(what)),
            Notice::ToolsHaveCut(spent) => {
                let text = match tool_library::add_minutes(&spent) {
                    Ok(worn) => worn.into_iter().next(),
                    Err(why) => Some(why),
                };
                if let Some(text) = text {
                    self.message = Some(StatusMessage::Text(text));
                }
            }
            // What was to be done before the new stock is done.
            Notice::FreshStock => {
                self.message.take_if(|message| {
                    matches!(message, StatusMessage::Collided(_) | StatusMessage::Text(_))
                });
            }
            Notice::ProgramEnded(program, parts) => self.show_program_end(program, parts),
            Notice::Refused(alarm) => self.message = Some(StatusMessage::Refused(alarm)),
            Notice::Sent(description) => self.message = Some(StatusMessage::Sent(description)),
            Notice::NumberTaken(opened, number) => {
                self.questions.ask_about_number(opened, number);
            }
            Notice::Opened {
                name,
                path,
                placement: storage,
            } => {
                self.views.program().load_opened(path.as_deref(), &storage);
                self.views
                    .lathe()
                    .report_opened_program(path.as_deref(), &storage);
                let file_name = PathBuf::from(name);
                let shown = file_name.file_name().unwrap_or_default();
                let shown = shown.to_string_lossy().into_owned();
                self.message = Some(StatusMessage::for_opened(
                    self.message.take(),
                    shown,
                    storage,
                    self.console.naming(),
                ));
                if let Some(path) = path.as_ref().filter(|path| platform::is_persistent(path)) {
                    self.settings.add_recent(path);
                }
                self.opened_program = path;
            }
            // The result of a preview must not hide a current alarm.
            Notice::Previewed(..)
                if self.snapshot.as_ref().is_some_and(|it| it.alarm.is_some()) => {}
            // A program that was not opened, because another one runs.
            Notice::Previewed(..) if self.is_opening_refused() => {}
            Notice::Previewed(file, look) => {
                self.message = Some(StatusMessage::for_preview(self.message.take(), file, look));
            }
            Notice::TaskOffered(request) => self.take_class_offer(&request),
            Notice::HandedIn(solution) => {
                let exercises = self.views.lessons().exercises();
                exercises.take_solution(*solution, context);
            }
            // Why a key does nothing is what an examinee has to know.
            Notice::KeyRefusal(Some(_)) if self.is_in_exam() => {}
            Notice::Explained(chain) => self.why.take_chain(*chain),
            Notice::KeyRefusal(Some((key, reason))) => {
                self.why.set_refused_key(key);
                self.message = Some(StatusMessage::KeyRefused(reason));
            }
            Notice::KeyRefusal(None) => {
                self.message
                    .take_if(|message| matches!(message, StatusMessage::KeyRefused(_)));
            }
        }
    }

    /// Whether the message line shows why a program was not opened.
    fn is_opening_refused(&self) -> bool {
        let refusal = say::program_opened_after_reset("").id();
        matches!(&self.message, Some(StatusMessage::Text(text)) if text.id() == refusal)
    }

    /// Shows that a program has run to its end, unless the message line has something graver.
    fn show_program_end(&mut self, program: ProgramId, parts: u32) {
        let is_free = self.message.as_ref().is_none_or(|message| {
            !matches!(
                message,
                StatusMessage::Collided(_) | StatusMessage::Refused(_) | StatusMessage::KernelEnded
            )
        });
        if is_free {
            let text = match program {
                ProgramId::Stored(number) => {
                    say::window_program_ended(self.console.naming().name(number), parts)
                }
                _ => say::window_opened_program_ended(parts),
            };
            self.message = Some(StatusMessage::Done(text));
        }
    }

    /// Opens files that were dropped on the window, and shows a hint while files are dragged
    /// over it.
    pub(crate) fn take_dropped_files(&mut self, ui: &Ui) {
        let (dropped, hovering) = ui.input(|input| {
            let dropped = input.raw.dropped_files.clone();
            (dropped, !input.raw.hovered_files.is_empty())
        });
        if !dropped.is_empty() {
            let (opener, context) = (self.opener.clone(), ui.ctx().clone());
            platform::take_dropped(&dropped, move |path| opener.open(path, &context));
        } else if hovering {
            self.message = Some(StatusMessage::DropHere);
        }
    }
}
