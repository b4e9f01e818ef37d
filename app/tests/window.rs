//! The window without a display, driven through its accessible names as a screen
//! reader or a tester does: names, mouse, PC keys, and what the LCD says.

use std::path::Path;
use std::time::Duration;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gsk_app::cli::Language;
use gsk_app::kernel::Kernel;
use gsk_app::window::{Settings, Window, fonts};
use gsk_core::command::ProgramId;
use gsk_core::setup::Setup;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::{KEYS, Key, Role};

/// A window with its kernel, which runs only when it is told to.
struct Bench {
    kernel: Kernel,
    harness: Harness<'static, Window>,
}

impl Bench {
    /// Switched on, the self-test over.
    fn new() -> Self {
        let (kernel, console) = Kernel::new(Emulator::new(Setup::default()));
        let settings = Settings {
            language: Language::En,
            ..Settings::default()
        };
        let harness = Harness::builder()
            .with_size(egui::vec2(1280.0, 806.0))
            .with_context_setup(fonts::set_up)
            .build_ui_state(
                |ui, window: &mut Window| window.ui(ui),
                Window::new(console, settings),
            );
        let mut bench = Self { kernel, harness };
        bench.run(4000);
        bench
    }

    /// Lets the control run so many milliseconds and draws what there is to see.
    fn run(&mut self, ms: u64) {
        self.harness.step();
        self.kernel.run(ms);
        self.kernel.show();
        self.harness.step();
    }

    /// Clicks a key of the panel with the mouse.
    #[track_caller]
    fn click(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.run(200);
    }

    fn lcd(&self) -> String {
        self.harness.get_by_label("LCD").value().unwrap_or_default()
    }

    #[track_caller]
    fn lcd_shows(&self, text: &str) {
        let lcd = self.lcd();
        assert!(lcd.contains(text), "no `{text}` on the LCD:\n{lcd}");
    }

    /// The figure behind U on the relative position page.
    fn shown_u(&self) -> f64 {
        let lcd = self.lcd();
        let row = lcd.lines().nth(3).unwrap_or_default();
        let figure = row
            .split_whitespace()
            .last()
            .and_then(|figure| figure.parse().ok());
        assert!(figure.is_some(), "no coordinate in row 3:\n{lcd}");
        figure.unwrap_or_default()
    }

    /// Opens a program as the dialog, a dropped file and `--program` do.
    fn open(&mut self, file: &str) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../assets/programs")
            .join(file);
        let context = self.harness.ctx.clone();
        self.harness.state_mut().open(&context, path);
        let opened = (0..1000).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            self.run(1);
            let programs = self.kernel.emulator().simulation.cnc.programs();
            programs.current() == Some(ProgramId::External)
        });
        assert!(opened, "{file} is not opened");
    }
}

#[test]
fn a_program_is_opened_started_and_stopped_by_the_emergency_stop() {
    let mut bench = Bench::new();
    bench.open("01-stepped-shaft.CNC");
    bench.lcd_shows("O0001");
    let before = bench.shown_u();

    bench.click("Automatic mode");
    bench.lcd_shows("自动方式");
    bench.click("Cycle start");
    bench.run(10_000);
    assert_ne!(bench.shown_u(), before, "X stands:\n{}", bench.lcd());

    bench.click("Emergency stop");
    bench.lcd_shows("准备未绪");
    bench.lcd_shows("207");
    bench.click("Position pages");
    let stopped = bench.shown_u();
    bench.run(1000);
    assert_eq!(bench.shown_u(), stopped);

    bench.click("Emergency stop");
    bench.run(500);
    assert!(!bench.lcd().contains("准备未绪"), "it is released");
    bench.run(1000);
    assert_eq!(bench.shown_u(), stopped, "nothing moves by itself");
}

#[test]
fn every_key_is_there_by_name() {
    let bench = Bench::new();
    for row in &KEYS {
        let count = bench.harness.query_all_by_label(row.name_en).count();
        assert_eq!(count, 1, "{} by its name «{}»", row.id, row.name_en);
    }
}

#[test]
fn machine_keys_reach_their_contact_and_light_their_lamp() {
    let mut bench = Bench::new();
    for (name, mode) in [
        ("Jog mode", "手动方式"),
        ("Edit mode", "编辑方式"),
        ("MDI mode", "录入方式"),
        ("Automatic mode", "自动方式"),
    ] {
        bench.click(name);
        bench.lcd_shows(mode);
    }
    let lamp = Key::from_id("SBK").and_then(|key| key.row().lamp).unwrap();
    let lit = |bench: &Bench| lamp.of(&bench.kernel.emulator().lamps());
    assert!(!lit(&bench));
    bench.click("Single block");
    assert!(lit(&bench));
}

#[test]
fn a_held_mouse_button_holds_the_key() {
    let mut bench = Bench::new();
    bench.click("Jog mode");
    let place = bench
        .harness
        .get_by_label("Z axis, arrow left")
        .rect()
        .center();
    let button = |pressed| egui::Event::PointerButton {
        pos: place,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::default(),
    };
    bench.harness.event(egui::Event::PointerMoved(place));
    bench.harness.event(button(true));
    bench.run(50);
    let emulator = |bench: &Bench| bench.kernel.emulator().clone();
    for _ in 0..20 {
        bench.run(50);
    }
    assert!(
        emulator(&bench).simulation.cnc.is_moving(),
        "held: the axis moves"
    );
    bench.harness.event(button(false));
    bench.run(1000);
    assert!(
        !emulator(&bench).simulation.cnc.is_moving(),
        "let go: it stands"
    );
}

#[test]
fn pc_keys_press_panel_keys() {
    let mut bench = Bench::new();
    bench
        .harness
        .key_press_modifiers(egui::Modifiers::CTRL, egui::Key::Num2);
    bench.run(300);
    bench.lcd_shows("自动方式");
    bench.harness.key_press(egui::Key::F5);
    bench.run(300);
    bench.lcd_shows("外部信息");
    bench.harness.key_press(egui::Key::F1);
    bench.run(10);
    assert!(
        bench
            .harness
            .query_by_label("PC keyboard and panel keys")
            .is_some()
    );
}

#[test]
fn every_machine_key_has_its_contact() {
    for row in &KEYS {
        if let Role::Machine(bit) = row.role {
            assert!(
                (20..=26).contains(&bit.byte),
                "{} has X{}",
                row.id,
                bit.byte
            );
        }
    }
}
