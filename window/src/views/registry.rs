//! The registry of views: one line for each. A view is a type that implements [`View`](super::interface::View); its
//! name, keys and sizes are its row in `view.rs`.

use gsk_host::platform;

use super::bench::Bench;
use super::commission::CommissionView;
use super::data::DataView;
use super::interface::{View, ViewStart};
use super::ladder::LadderView;
use super::lathe::LatheSceneView;
use super::lesson::LessonView;
use super::link::LinkPage;
use super::machine::LatheView;
use super::program::ProgramView;
use super::project::ProjectView;
use super::scope::Scope;
use super::transfer::TransferView;
use crate::view::ViewId;
use crate::widgets::questions::Unsaved;

macro_rules! register {
    ($($id:ident: $field:ident = $view:ty $(, if $available:expr)?;)*) => {
        /// All views, each under its own name for what only it can do.
        pub struct AllViews {
            $(pub $field: $view,)*
        }

        impl AllViews {
            pub fn create(start: ViewStart<'_>) -> Self {
                Self { $($field: View::create(start),)* }
            }

            /// The view with this name; `None` if this platform does not have it, so that the
            /// compiler can leave its code out.
            pub fn get(&mut self, view: ViewId) -> Option<&mut dyn View> {
                match view {
                    $(ViewId::$id => {
                        $(if !$available {
                            return None;
                        })?
                        Some(&mut self.$field)
                    })*
                }
            }

            /// The first unsaved work in the order of the registry; `None` if there is none.
            pub fn first_unsaved(&self) -> Option<Unsaved> {
                None$(.or_else(|| self.$field.unsaved()))*
            }
        }
    };
}

register! {
    Program: program = ProgramView;
    Machine: lathe = LatheView;
    Lathe: scene = LatheSceneView;
    Project: project = ProjectView, if platform::has_folders();
    Scope: scope = Scope;
    Bench: bench = Bench;
    Ladder: ladder = LadderView;
    Link: link = LinkPage;
    Lesson: lessons = LessonView;
    Transfer: transfer = TransferView, if platform::has_ports();
    Commission: commission = CommissionView;
    Data: data = DataView;
}
