//! What comes from outside: pictures and words of the kernel, files that are dropped.

use std::path::PathBuf;

use egui::Ui;

use super::Window;
use super::message::Message;
use crate::kernel::Notice;
use crate::platform;

impl Window {
    /// Takes what the kernel has sent.
    pub(super) fn receive(&mut self) {
        // The program that is no longer the selected one.
        let mut left = None;
        if let Some(picture) = self.console.pictures.pop() {
            let before = self.picture.as_ref();
            let alarm = before.and_then(|it| it.alarm.as_ref());
            let alarms = picture.alarm.is_some() && picture.alarm.as_ref() != alarm;
            let was_known = before.is_some_and(|it| !it.place_unknown);
            if alarms || (picture.place_unknown && was_known) {
                // The newest word stands on the line.
                self.message = None;
            }
            let was = before.and_then(|it| it.program);
            left = was.filter(|program| picture.program != Some(*program));
            if before.is_none_or(|before| before.screen != picture.screen) {
                platform::tell_screen(|| picture.screen.text());
            }
            self.views.lessons().seen(&picture);
            self.hear(&picture);
            self.picture = Some(picture);
        }
        while let Ok(notice) = self.console.notices.try_recv() {
            match notice {
                Notice::Said(text) => self.message = Some(Message::Said(text)),
                Notice::Collided(what) => self.message = Some(Message::Collided(what)),
                Notice::FreshStock => {
                    self.message
                        .take_if(|message| matches!(message, Message::Collided(_)));
                }
                Notice::Refused(alarm) => self.message = Some(Message::Refused(alarm)),
                Notice::Sent(what) => self.message = Some(Message::Sent(what)),
                Notice::NumberTaken(opened, number) => {
                    self.questions.ask_for_place(opened, number);
                }
                Notice::Opened { name, path, place } => {
                    self.views.program().opened(path.as_deref(), &place);
                    self.views.lathe().opened(path.as_deref(), &place);
                    let shown = PathBuf::from(name);
                    let shown = shown.file_name().unwrap_or_default();
                    let shown = shown.to_string_lossy().into_owned();
                    self.message = Some(Message::opened(self.message.take(), shown, place));
                    if let Some(path) = path.as_ref().filter(|path| platform::lasts(path)) {
                        self.settings.remember(path);
                    }
                    self.opened = path;
                }
                // What it says of a file must not cover an alarm that stands by now.
                Notice::Looked(..)
                    if self.picture.as_ref().is_some_and(|it| it.alarm.is_some()) => {}
                Notice::Looked(file, look) => {
                    self.message = Some(Message::looked(self.message.take(), file, look));
                }
                Notice::Key(Some(why)) => self.message = Some(Message::KeyRefused(why)),
                Notice::Key(None) => {
                    self.message
                        .take_if(|message| matches!(message, Message::KeyRefused(_)));
                }
            }
        }
        if let (Some(message), Some((file, time_s))) =
            (&mut self.message, self.views.lathe().program_time())
        {
            message.update_time(file, time_s);
        }
        // What is said of the new one has come before its picture.
        self.message
            .take_if(|message| left.is_some_and(|program| message.is_about(program)));
    }

    /// Files that were dropped on the window.
    pub(super) fn take_files(&mut self, ui: &Ui) {
        let (dropped, hovering) = ui.input(|input| {
            let dropped = input.raw.dropped_files.clone();
            (dropped, !input.raw.hovered_files.is_empty())
        });
        if !dropped.is_empty() {
            let (opener, context) = (self.opener.clone(), ui.ctx().clone());
            platform::take_dropped(&dropped, move |path| opener.open(path, &context));
        } else if hovering {
            self.message = Some(Message::DropHere);
        }
    }
}
