//! The contents of the help: the first hour, the last alarm, and the chapters.

use egui::Ui;
use gsk_core::model::ModelId;
use gsk_help::{Subject, Topic, article, topic, topics_of};
use gsk_host::kernel::PanelSnapshot;
use gsk_messages::{Language, Message, say};

use super::{HelpRequest, HelpWindow, show_topic_list};
use crate::widgets::card::{self, Card, CardPicture};
use crate::widgets::icons::Icon;

/// A group of topics in the contents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HelpChapter {
    /// Help chapter about keys and lamps of the panel.
    Panel,
    /// Help chapter about pages of the LCD and their fields.
    Pages,
    /// Help chapter about words of part programs.
    Codes,
    Alarms,
    /// Help chapter about parameters and their bits.
    Parameters,
    /// Help chapter about signals of the PLC, and diagnoses.
    Signals,
    /// Help chapter about modes, functions and other terms.
    Notions,
}

/// A help chapter with its icon and the function that returns its name.
type ChapterRow = (HelpChapter, Icon, fn() -> Message);

const CHAPTERS: [ChapterRow; 7] = [
    (HelpChapter::Panel, Icon::KEYBOARD, say::help_chapter_panel),
    (HelpChapter::Pages, Icon::SCREEN, say::help_chapter_pages),
    (HelpChapter::Codes, Icon::CODE, say::help_chapter_codes),
    (HelpChapter::Alarms, Icon::WARNING, say::help_chapter_alarms),
    (
        HelpChapter::Parameters,
        Icon::PARAMETER,
        say::help_chapter_parameters,
    ),
    (
        HelpChapter::Signals,
        Icon::SIGNAL,
        say::help_chapter_signals,
    ),
    (HelpChapter::Notions, Icon::BOOK, say::help_chapter_notions),
];

impl HelpChapter {
    const fn contains(self, subject: Subject<'_>) -> bool {
        let chapter = match subject {
            Subject::Key(_) | Subject::Lamp(_) => Self::Panel,
            Subject::Page(_) | Subject::Field(..) => Self::Pages,
            Subject::Code(_) => Self::Codes,
            Subject::Alarm(_) => Self::Alarms,
            Subject::Parameter(_) | Subject::Bit(..) => Self::Parameters,
            Subject::Signal(_) | Subject::Diagnosis(_) => Self::Signals,
            Subject::Notion(_) => Self::Notions,
        };
        self as u8 == chapter as u8
    }

    fn topics(self, model: ModelId) -> Vec<&'static Topic> {
        let all = topics_of(model).iter();
        all.filter(|topic| self.contains(topic.subject)).collect()
    }
}

impl HelpWindow {
    /// Draws the contents, or the topics of the chosen chapter. Returns the operator's request,
    /// if any.
    pub(super) fn show_contents(
        &mut self,
        ui: &mut Ui,
        language: Language,
        snapshot: Option<&PanelSnapshot>,
    ) -> Option<HelpRequest> {
        let model = snapshot.map(|picture| picture.model).unwrap_or_default();
        if let Some(chapter) = self.chapter {
            let topics = chapter.topics(model);
            if let Some(chosen) = show_topic_list(ui, &topics, topics.len(), language) {
                self.push_topic(chosen);
            }
            return None;
        }
        ui.label(say::window_help_begin().text(language));
        ui.add_space(4.0);
        let last_alarm = snapshot
            .and_then(|picture| picture.alarm_records.first())
            .and_then(|record| topic(Subject::Alarm(record.alarm.row()?.number)));
        let mut cards = vec![Card {
            picture: CardPicture::Icon(Icon::LESSON),
            title: say::window_help_first_hour().text(language),
            detail: say::window_help_lessons().text(language),
            is_marked: false,
        }];
        cards.extend(last_alarm.map(|topic| Card {
            picture: CardPicture::Icon(Icon::WARNING),
            title: say::window_help_last_alarm().text(language),
            detail: article(topic, language).heading,
            is_marked: false,
        }));
        let first_chapter = cards.len();
        cards.extend(CHAPTERS.iter().map(|(chapter, icon, name)| Card {
            picture: CardPicture::Icon(*icon),
            title: name().text(language),
            detail: say::window_help_topics(chapter.topics(model).len()).text(language),
            is_marked: false,
        }));
        let responses = card::show_cards(ui, &cards);
        let clicked = responses.iter().position(egui::Response::clicked)?;
        if clicked == 0 {
            return Some(HelpRequest::OpenLessons);
        }
        match CHAPTERS.get(clicked.wrapping_sub(first_chapter)) {
            Some((chapter, ..)) => self.chapter = Some(*chapter),
            None => self.push_topic(last_alarm?),
        }
        None
    }
}
