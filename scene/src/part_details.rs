//! Threads and cut faces of the part, and how the part lies in space.

use glam::Mat4;

use crate::description::{LatheDescription, LatheKind, SectionCut};
use crate::effects::bar_bend;
use crate::mesh::SceneMesh;
use crate::part::outline::PartOutline;
use crate::placement::LathePlacement;
use crate::section_cut::{add_face, kept_sweep, tool_angle};

/// Number of hatch lines over the longer side of the part.
const HATCH_LINES: f32 = 18.0;
/// Least and greatest distance between two hatch lines, mm.
const HATCH_MM: (f32, f32) = (2.5, 25.0);

/// Returns the matrix with which the part is drawn. A cut part does not turn: its cut face shows
/// the half section in the plane of the tool.
pub fn part_model(lathe: &LatheDescription, placement: &LathePlacement) -> Mat4 {
    let turn = match lathe.overlay.section_cut {
        SectionCut::Whole => placement.spindle,
        SectionCut::Quarter | SectionCut::Half => Mat4::from_rotation_x(tool_angle(lathe.kind)),
    };
    bar_bend(lathe) * turn
}

/// Builds the mesh of the threads and cut faces of a part.
pub fn build_details(outline: &PartOutline, kind: LatheKind, cut: SectionCut) -> SceneMesh {
    let mut mesh = SceneMesh::default();
    let [start, extent] = kept_sweep(kind, cut);
    for thread in outline.threads() {
        thread.add_to(&mut mesh, [start, extent]);
    }
    if let (SectionCut::Quarter | SectionCut::Half, Some((low, high, radius))) =
        (cut, outline.bounds())
    {
        let spacing = (high - low).max(radius * 2.0) / HATCH_LINES;
        let spacing = spacing.clamp(HATCH_MM.0, HATCH_MM.1);
        for (angle, side) in [(start, -1.0), (start + extent, 1.0)] {
            let lines = outline.section_lines(angle);
            add_face(&mut mesh, &lines, angle, side, spacing);
        }
    }
    mesh
}
