//! Tests of pictures drawn by the processor.

use std::sync::Arc;

use super::*;
use crate::camera::CameraPreset;
use crate::description::{LatheKind, SceneTheme, TipPosition};
use crate::part::outline::PartOutline;

fn lathe(kind: LatheKind, theme: SceneTheme) -> LatheDescription {
    let bar = vec![
        [-30.0, 0.0],
        [120.0, 0.0],
        [120.0, 18.0],
        [60.0, 18.0],
        [60.0, 30.0],
        [-30.0, 30.0],
    ];
    LatheDescription {
        kind,
        theme,
        has_coolant: true,
        jaw_radius: 30.0,
        tip: TipPosition {
            x: 60.0,
            radius: 18.0,
        },
        part: Arc::new(PartOutline::from_polygons(&[bar], 30.0)),
        ..LatheDescription::default()
    }
}

fn mean(pixels: &[u8]) -> f32 {
    let sum: u32 = pixels.chunks_exact(4).map(|it| u32::from(it[1])).sum();
    sum as f32 / (pixels.len() / 4) as f32
}

#[test]
fn the_three_machines_differ_and_day_is_brighter_than_night() {
    let mut renderer = SoftwareRenderer::default();
    let mut draw = |kind, theme| {
        let lathe = lathe(kind, theme);
        let camera = CameraPreset::Operator.camera(&lathe);
        renderer.draw(&lathe, &camera, [160, 100], SoftwareQuality::Thorough)
    };
    let kinds = [LatheKind::FlatBed, LatheKind::SlantBed, LatheKind::Bench];
    let night = kinds.map(|kind| draw(kind, SceneTheme::Night));
    let day = kinds.map(|kind| draw(kind, SceneTheme::Day));
    for (night, day) in night.iter().zip(&day) {
        assert!(!night.is_refining && night.pixels.len() == 160 * 100 * 4);
        assert!(mean(&day.pixels) > mean(&night.pixels) + 3.0);
    }
    let different = |a: &SoftwarePicture, b: &SoftwarePicture| {
        let pairs = a.pixels.iter().zip(&b.pixels);
        pairs.filter(|(a, b)| a.abs_diff(**b) > 20).count()
    };
    assert!(different(&night[0], &night[1]) > 4000);
    assert!(different(&night[1], &night[2]) > 4000);
    assert!(different(&night[0], &night[2]) > 4000);
}

#[test]
fn a_layer_that_is_kept_gives_the_same_picture() {
    let mut still = lathe(LatheKind::FlatBed, SceneTheme::Day);
    let camera = CameraPreset::Operator.camera(&still);
    let size = [120, 80];
    let mut renderer = SoftwareRenderer::default();
    renderer.draw(&still, &camera, size, SoftwareQuality::Thorough);
    still.spindle_angle = 0.7;
    let kept = renderer.draw(&still, &camera, size, SoftwareQuality::Thorough);
    let fresh = SoftwareRenderer::default().draw(&still, &camera, size, SoftwareQuality::Thorough);
    let pairs = kept.pixels.iter().zip(&fresh.pixels);
    // The layer has the shadows of the earlier angle.
    let different = pairs.filter(|(a, b)| a.abs_diff(**b) > 24).count();
    assert!(different < 400, "{different}");
}

/// Returns the number of pixels that differ after a change of the description.
fn changed_pixels(change: impl FnOnce(&mut LatheDescription)) -> usize {
    let before = lathe(LatheKind::FlatBed, SceneTheme::Day);
    let mut after = before.clone();
    change(&mut after);
    let camera = CameraPreset::Operator.camera(&before);
    let draw = |lathe: &LatheDescription| {
        let mut renderer = SoftwareRenderer::default();
        renderer.draw(lathe, &camera, [240, 160], SoftwareQuality::Quick)
    };
    let (before, after) = (draw(&before), draw(&after));
    let pairs = before
        .pixels
        .chunks_exact(4)
        .zip(after.pixels.chunks_exact(4));
    let is_other = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 24);
    pairs.filter(is_other).count()
}

#[test]
fn all_that_opengl_draws_is_drawn_by_the_processor_too() {
    use crate::chips::{ChipFlow, ChipSource};
    use crate::description::SectionCut;
    use crate::part::material::PartMaterial;
    use crate::tool_path::{ToolPathBuilder, ToolPathPiece};
    let mut chips = ChipFlow::default();
    let cut = ChipSource {
        at: glam::vec3(60.0, 0.0, 20.0),
        away: Vec3::Z,
        feed: 0.05,
        speed: 100.0,
        material: PartMaterial::Steel,
        tray_y: -300.0,
    };
    (0..20).for_each(|_| chips.advance(0.05, Some(&cut)));
    let mut path = ToolPathBuilder::new(200.0);
    path.add(ToolPathPiece {
        ends: [[125.0, 40.0], [230.0, 0.0]],
        color: [255, 0, 0],
    });
    let path = Arc::new(path.build());
    let brass = |it: &LatheDescription| {
        let part = PartOutline::clone(&it.part);
        Arc::new(part.with_material(PartMaterial::Brass))
    };
    let counts = [
        changed_pixels(|it| it.effects.chips = chips.states()),
        changed_pixels(|it| it.effects.marks = vec![[90.0, 18.0]]),
        changed_pixels(|it| it.effects.bar_bend = 0.1),
        changed_pixels(|it| it.overlay.section_cut = SectionCut::Quarter),
        changed_pixels(|it| it.effects.is_spindle_blurred = true),
        changed_pixels(|it| it.dimensions.steady_rest = Some(100.0)),
        changed_pixels(|it| it.part = brass(it)),
        changed_pixels(|it| it.overlay.path = Some(path)),
    ];
    assert!(counts.iter().all(|it| *it > 20), "{counts:?}");
}

#[test]
fn lamps_and_hand_wheel_are_seen_from_the_front() {
    let before = lathe(LatheKind::FlatBed, SceneTheme::Night);
    let camera = OrbitCamera {
        target: glam::vec3(-230.0, 40.0, 150.0),
        yaw: 0.0,
        pitch: 0.1,
        distance: 1100.0,
        is_parallel: false,
    };
    let draw = |lathe: &LatheDescription| {
        let mut renderer = SoftwareRenderer::default();
        renderer.draw(lathe, &camera, [240, 240], SoftwareQuality::Quick)
    };
    let dark = draw(&before);
    let changed = |change: &dyn Fn(&mut LatheDescription)| {
        let mut after = before.clone();
        change(&mut after);
        let pairs = draw(&after).pixels.into_iter().zip(dark.pixels.clone());
        pairs.filter(|(a, b)| a.abs_diff(*b) > 24).count()
    };
    for lamp in 0..3 {
        assert!(
            changed(&|it| it.effects.lit_lamps[lamp] = true) > 20,
            "{lamp}"
        );
    }
    assert!(changed(&|it| it.effects.wheel_detents = 40) > 10);
}

#[test]
fn a_window_gets_a_better_picture_after_a_while() {
    let lathe = lathe(LatheKind::Bench, SceneTheme::Day);
    let camera = CameraPreset::Tool.camera(&lathe);
    let mut renderer = SoftwareRenderer::default();
    let mut draw = || renderer.draw(&lathe, &camera, [48, 32], SoftwareQuality::Quick);
    assert!(draw().is_refining);
    let pictures = (0..400).take_while(|_| draw().is_refining).count();
    assert!(pictures < 399);
}
