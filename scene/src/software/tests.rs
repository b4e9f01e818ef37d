//! Tests of pictures drawn by the processor.

use std::sync::Arc;

use super::*;
use crate::camera::CameraPreset;
use crate::description::{LatheKind, SceneTheme, TipPosition};
use crate::part_outline::PartOutline;

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
