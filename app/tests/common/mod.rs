//! A window without a display, with its kernel, for the tests of the window.
#![allow(dead_code, reason = "each test binary uses a part of it")]

pub mod folder;
pub mod mouse_operator;
pub mod windows;

use std::path::Path;
use std::time::Duration;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gsk_core::setup::Setup;
use gsk_host::kernel::{Console, Kernel};
use gsk_messages::Language;
use gsk_panel::emulator::Emulator;
use gsk_window::layout::{Layouts, WindowLayout};
use gsk_window::{Window, WindowSettings, fonts};

/// A window with its kernel. The kernel runs only when the test calls it.
pub struct WindowBench {
    pub kernel: Kernel,
    /// A second handle of the window's console.
    pub console: Console,
    pub harness: Harness<'static, Window>,
    /// Whether the control makes no tick: in a tick it would lose a board that is not served.
    pub is_halted: bool,
}

impl WindowBench {
    /// A control that is on and has finished its self-test.
    pub fn new() -> Self {
        Self::with_setup(Setup::default())
    }

    /// The same with a setup.
    pub fn with_setup(setup: Setup) -> Self {
        Self::with_layouts(
            setup,
            Layouts::with_layout(WindowLayout::Panel),
            egui::vec2(1280.0, 806.0),
        )
    }

    /// The same with layouts, in a window of `size` points.
    pub fn with_layouts(setup: Setup, layouts: Layouts, size: egui::Vec2) -> Self {
        let settings = WindowSettings {
            language: Language::En,
            layouts,
            ..WindowSettings::default()
        };
        Self::with_settings(setup, settings, size)
    }

    /// The same with stored settings.
    pub fn with_settings(setup: Setup, settings: WindowSettings, size: egui::Vec2) -> Self {
        let mut bench = Self::with_emulator(Emulator::new(setup), settings, size);
        bench.is_halted = false;
        bench.run(4000);
        bench
    }

    /// A window whose control has already run and is halted.
    pub fn with_emulator(emulator: Emulator, settings: WindowSettings, size: egui::Vec2) -> Self {
        let (kernel, console) = Kernel::new(emulator);
        let harness = Harness::builder()
            .with_size(size)
            .with_context_setup(fonts::set_up)
            .build_ui_state(
                |ui, window: &mut Window| window.ui(ui),
                Window::new(console.clone(), settings),
            );
        Self {
            kernel,
            console,
            harness,
            is_halted: true,
        }
    }

    /// Runs the control for `ms` milliseconds and draws the result.
    pub fn run(&mut self, ms: u64) {
        self.harness.step();
        self.kernel.run(if self.is_halted { 0 } else { ms });
        self.kernel.publish();
        self.harness.step();
    }

    /// Clicks a key of the panel with the mouse.
    #[track_caller]
    pub fn click(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.run(200);
    }

    pub fn lcd(&self) -> String {
        self.harness.get_by_label("LCD").value().unwrap_or_default()
    }

    /// The LCD as the kernel sends it, whatever the window draws.
    pub fn lcd_of_kernel(&self) -> String {
        self.kernel.snapshot().screen.text()
    }

    #[track_caller]
    pub fn assert_lcd_contains(&self, text: &str) {
        let lcd = self.lcd();
        assert!(lcd.contains(text), "no `{text}` on the LCD:\n{lcd}");
    }

    /// The number after U on the relative position page.
    pub fn shown_u(&self) -> f64 {
        let lcd = self.lcd();
        let row = lcd.lines().nth(3).unwrap_or_default();
        let number = row
            .split_whitespace()
            .last()
            .and_then(|figure| figure.parse().ok());
        assert!(number.is_some(), "no coordinate in row 3:\n{lcd}");
        number.unwrap_or_default()
    }

    /// Opens a program as the dialog, a dropped file and `--program` do.
    pub fn open(&mut self, file: &str) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../assets/programs")
            .join(file);
        let context = self.harness.ctx.clone();
        self.harness.state_mut().open(&context, path);
        let is_open = (0..1000).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            self.run(1);
            // The program view may show the message, too.
            let shows = |words| {
                let mut all = self.harness.query_all_by_label_contains(words);
                all.next().is_some()
            };
            shows("Opened ") || shows(", no alarm") || shows(": P/S ") || shows(": PLC ")
        });
        assert!(is_open, "{file} is not opened");
    }
}
