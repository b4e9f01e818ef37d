//! Converts the programmed path of the machine view to lines of the scene.

use std::sync::Arc;

use egui::Color32;
use gsk_scene::tool_path::{ToolPath, ToolPathBuilder, ToolPathPiece};

use crate::theme;
use crate::views::machine::path::{DrawnPath, SegmentKind};

/// Least time between two conversions of a path that still grows, s.
const GROWING_INTERVAL_S: f64 = 0.5;

/// The programmed path for the 3D view, converted when it changes.
#[derive(Default)]
pub struct ScenePath {
    source: Option<Arc<DrawnPath>>,
    /// The source of `built`, and the x of the scene's zero in part coordinates, mm.
    built_from: Option<(Arc<DrawnPath>, f64)>,
    built: Option<Arc<ToolPath>>,
    built_at_s: f64,
    now_s: f64,
}

impl ScenePath {
    /// Sets the path; `None` hides it. `now_s`: time of the picture.
    pub fn set(&mut self, path: Option<&Arc<DrawnPath>>, now_s: f64) {
        self.source = path.cloned();
        self.now_s = now_s;
    }

    /// The lines relative to the front of the chuck's body, which is at Z `face`, mm.
    pub fn get(&mut self, face: f64) -> Option<Arc<ToolPath>> {
        let source = self.source.as_ref()?;
        let known = self.built_from.as_ref();
        let is_same = known.is_some_and(|(path, zero)| Arc::ptr_eq(path, source) && *zero == face);
        let is_early = source.is_partial
            && self.built.is_some()
            && self.now_s - self.built_at_s < GROWING_INTERVAL_S;
        if !is_same && !is_early {
            self.built_from = Some((Arc::clone(source), face));
            self.built = Some(Arc::new(convert(source, face as f32)));
            self.built_at_s = self.now_s;
        }
        self.built.clone()
    }
}

fn convert(path: &DrawnPath, face: f32) -> ToolPath {
    let size = path.bounds.map_or(egui::Vec2::ZERO, |it| it.size());
    let mut builder = ToolPathBuilder::new(size.max_elem());
    for (from, segment) in path.segments() {
        let color = match segment.kind {
            SegmentKind::Rapid | SegmentKind::Jump => theme::RAPID_PATH,
            SegmentKind::Feed => theme::FEED_PATH,
            SegmentKind::Thread => theme::THREAD_PATH,
        };
        builder.add(ToolPathPiece {
            ends: [from, segment.end].map(|it| [it.x - face, it.y]),
            color: rgb(color),
        });
    }
    builder.build()
}

fn rgb(color: Color32) -> [u8; 3] {
    [color.r(), color.g(), color.b()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::views::machine::path::tests::preview_path;

    #[test]
    fn the_path_is_in_the_plane_of_the_tool_with_the_colours_of_the_view() {
        let text = "G50 X60 Z20\nG00 X40 Z2\nG01 Z-30 F100\nG00 X60\nM30\n";
        let drawn = Arc::new(preview_path(text));
        let mut path = ScenePath::default();
        assert_eq!(path.get(0.0), None);
        path.set(Some(&drawn), 0.0);
        let lines = path.get(-100.0).unwrap();
        let cut = ToolPathPiece {
            ends: [[102.0, 20.0], [70.0, 20.0]],
            color: [90, 180, 255],
        };
        assert!(lines.pieces().contains(&cut), "{lines:?}");
        assert!(Arc::ptr_eq(&lines, &path.get(-100.0).unwrap()));
        path.set(None, 1.0);
        assert_eq!(path.get(-100.0), None);
    }
}
