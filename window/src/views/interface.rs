//! The interface of a view: what it starts with, what it is drawn with, what it does.

use std::sync::Arc;

use egui::Ui;
use gsk_host::kernel::Console;
use gsk_host::kernel::monitor::MachineView;
use gsk_host::kernel::part::PartView;
use gsk_messages::Language;

use crate::settings::WindowSettings;
use crate::widgets::questions::Unsaved;

/// The data with which views are created: the kernel's console and the settings of the last
/// session.
#[derive(Clone, Copy)]
pub struct ViewStart<'a> {
    pub console: &'a Console,
    pub settings: &'a WindowSettings,
}

/// Context, language and data with which a view is drawn.
#[derive(Clone, Copy)]
pub struct ViewFrame<'a> {
    pub language: Language,
    /// Whether the view is in a separate window and receives all keys.
    pub owns_keys: bool,
    /// The newest state of the machine, for views whose row has `is_monitor`; `None` before
    /// the first one.
    pub machine: Option<&'a Arc<MachineView>>,
    /// The newest state of the part, for views whose row has `shows_part`; `None` before the
    /// first one.
    pub part: Option<&'a Arc<PartView>>,
}

/// A view of the window, such as machine or scope.
pub trait View {
    /// Creates the view in the closed state.
    fn create(start: ViewStart<'_>) -> Self
    where
        Self: Sized;

    /// Called when the view opens.
    fn open(&mut self) {}

    /// Called when the view closes.
    fn close(&mut self) {}

    /// Draws the view and handles its input.
    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>);

    /// The unsaved work that closing the window would lose; `None` if there is none.
    fn unsaved(&self) -> Option<Unsaved> {
        None
    }
}
