//! The pane *Network*: switches for the MTConnect agent and MQTT with address and state, and the
//! address of the page for a phone as a QR code.

use egui::{Context, Key as PcKey, RichText, ScrollArea, TextEdit, Ui, Vec2};
use gsk_host::kernel::SeatAction;
use gsk_host::kernel::{Command, Console};
use gsk_host::network::class::class_address::ClassAddress;
use gsk_host::network::mqtt::{BrokerTransport, BrokerUrl, parse_broker};
use gsk_host::network::service_state::{ServiceState, SharedServiceState};
use gsk_host::network::{ClassSettings, NetworkSettings, page_url};
use gsk_host::platform;
use gsk_messages::{Language, Message, say};
use web_time::Duration;

use crate::Window;
use crate::placement::panel_placement::PlacedArea;
use crate::placement::stop_key_clearance;
use crate::theme;
use crate::widgets::qr_code::QrPicture;

const WINDOW_SIZE: [f32; 2] = [460.0, 520.0];
/// Time between two checks of the states of the connections.
const STATE_INTERVAL: Duration = Duration::from_millis(500);
/// Width of a field for an address, points.
const FIELD_WIDTH: f32 = 280.0;

/// The state of the pane.
pub struct NetworkPane {
    is_open: bool,
    /// What the operator has entered.
    draft: NetworkSettings,
    /// What the kernel has received last.
    applied: NetworkSettings,
    code: QrPicture,
    /// Where the agent listens, and the address of its page for a phone.
    page: (String, Option<String>),
    /// The class that an option of the command line names; `None` without that option.
    class_option: Option<ClassSettings>,
}

impl NetworkPane {
    /// The pane with the stored settings, which the kernel has not received yet.
    pub fn new(settings: &NetworkSettings) -> Self {
        Self {
            is_open: false,
            draft: settings.clone(),
            applied: NetworkSettings::default(),
            code: QrPicture::default(),
            page: (String::new(), None),
            class_option: None,
        }
    }

    /// Joins a class at the start, whatever the stored settings say.
    pub fn join_class(&mut self, class: ClassSettings) {
        // Without a name the learner must enter one.
        self.is_open |= class.name.trim().is_empty();
        self.class_option = Some(class);
    }

    pub const fn toggle(&mut self) {
        self.is_open = !self.is_open;
    }

    pub const fn close(&mut self) {
        self.is_open = false;
    }

    /// Hands stored settings to the kernel in the first frame: until then the control before this
    /// one may still listen.
    pub fn apply_stored(
        &mut self,
        settings: &NetworkSettings,
        console: &Console,
        language: Language,
    ) {
        let mut wanted = settings.clone();
        let has_option = self.class_option.is_some();
        if let Some(class) = self.class_option.take() {
            wanted.class = class;
        }
        let is_first = self.applied == NetworkSettings::default() && wanted != self.applied;
        if has_option || is_first {
            self.draft = wanted;
            self.apply(console, language);
        }
    }

    fn apply(&mut self, console: &Console, language: Language) {
        let NetworkSettings { broker, class, .. } = &mut self.draft;
        separate_password(&mut broker.url, &mut broker.password);
        separate_password(&mut class.broker, &mut class.password);
        let draft = Box::new(self.draft.clone());
        console.send(Command::Network(draft, language));
        self.applied.clone_from(&self.draft);
    }

    /// Draws the pane; returns the settings to store if the operator has changed them.
    pub fn show(
        &mut self,
        context: &Context,
        language: Language,
        console: &Console,
        (placed, asks_help): (&[PlacedArea], Option<bool>),
    ) -> Option<NetworkSettings> {
        if !self.is_open {
            return None;
        }
        // A connection changes its state without the window.
        context.request_repaint_after(STATE_INTERVAL);
        // The pane never covers the stop keys of the panel.
        let size = Vec2::from(WINDOW_SIZE);
        let area = stop_key_clearance::best_rect(
            context.content_rect(),
            &stop_key_clearance::stop_key_rects(placed),
            |room| stop_key_clearance::rate_beside_panel(room, size, placed),
        );
        let (mut is_open, mut is_changed) = (true, false);
        egui::Window::new(say::network_title().text(language))
            .id(egui::Id::unique("network pane"))
            .collapsible(false)
            .open(&mut is_open)
            .default_size(WINDOW_SIZE)
            .default_pos(area.right_top() - egui::vec2(WINDOW_SIZE[0].min(area.width()), 0.0))
            .constrain_to(area)
            .show(context, |ui| {
                ScrollArea::vertical().show(ui, |ui| {
                    if platform::has_listeners() {
                        is_changed |= self.show_agent(ui, language, &console.network.agent);
                        ui.separator();
                    }
                    is_changed |= self.show_broker(ui, language, &console.network.broker);
                    ui.separator();
                    is_changed |= self.show_class(ui, language, console, asks_help);
                });
            });
        let escape =
            context.input_mut(|input| input.consume_key(egui::Modifiers::NONE, PcKey::Escape));
        self.is_open = is_open && !escape;
        if !is_changed {
            return None;
        }
        self.apply(console, language);
        Some(self.draft.clone())
    }

    /// Draws the agent; returns whether its settings are to be applied.
    fn show_agent(&mut self, ui: &mut Ui, language: Language, state: &SharedServiceState) -> bool {
        let mut section = SectionForm::begin(ui, language, state);
        let (draft, applied) = (&mut self.draft.agent, &self.applied.agent);
        section.show_switch(
            ui,
            &mut draft.is_on,
            &say::network_agent(),
            &say::network_agent_hint(),
        );
        section.show_field(
            ui,
            &mut draft.address,
            &say::network_address(),
            "127.0.0.1:5000",
        );
        let is_changed = section.end(ui, draft != applied);
        if let ServiceState::Listening(url) = state.get() {
            if self.page.0 != url {
                self.page = (url.clone(), page_url(&url));
            }
            match &self.page.1 {
                Some(url) => {
                    let name = say::network_page_code(url).text(language);
                    ui.label(&name);
                    self.code.show(ui, url, &name);
                }
                None => {
                    let hint = say::network_page_local().text(language);
                    ui.label(RichText::new(hint).color(theme::HINT_TEXT));
                }
            }
        }
        is_changed
    }

    /// Draws the broker; returns whether its settings are to be applied.
    fn show_broker(&mut self, ui: &mut Ui, language: Language, state: &SharedServiceState) -> bool {
        let mut section = SectionForm::begin(ui, language, state);
        let (draft, applied) = (&mut self.draft.broker, &self.applied.broker);
        section.show_switch(
            ui,
            &mut draft.is_on,
            &say::network_broker(),
            &say::network_broker_hint(),
        );
        let example = "mqtt://192.168.1.5/gsk980td/lathe";
        section.show_field(ui, &mut draft.url, &say::network_address(), example);
        section.show_ca(ui, &draft.url, &mut draft.ca);
        section.show_password(ui, &mut draft.password);
        ui.checkbox(
            &mut draft.has_discovery,
            say::network_discovery().text(language),
        );
        section.end(ui, draft != applied)
    }

    /// Draws the class; returns whether its settings are to be applied.
    fn show_class(
        &mut self,
        ui: &mut Ui,
        language: Language,
        console: &Console,
        asks_help: Option<bool>,
    ) -> bool {
        let mut section = SectionForm::begin(ui, language, &console.network.class);
        let (draft, applied) = (&mut self.draft.class, &self.applied.class);
        section.show_switch(
            ui,
            &mut draft.is_on,
            &say::network_class(),
            &say::network_class_hint(),
        );
        section.show_field(ui, &mut draft.name, &say::class_name(), "");
        if section.show_field(ui, &mut draft.code, &say::class_code(), "K7M2") {
            take_pasted_class(draft);
        }
        section.show_field(
            ui,
            &mut draft.broker,
            &say::network_broker(),
            "mqtt://192.168.1.5",
        );
        section.show_ca(ui, &draft.broker, &mut draft.ca);
        section.show_password(ui, &mut draft.password);
        ui.checkbox(
            &mut draft.allows_faults,
            say::network_faults_allowed().text(language),
        );
        let note = RichText::new(say::class_privacy().text(language));
        ui.label(note.color(theme::HINT_TEXT));
        let is_changed = section.end(ui, draft != applied);
        if let Some(asks) = asks_help {
            show_help_request(ui, language, console, asks);
        }
        is_changed
    }
}

/// Draws the button with which a learner asks for help.
pub fn show_help_request(ui: &mut Ui, language: Language, console: &Console, asks: bool) {
    let (name, colour) = match asks {
        true => (say::class_help_requested(), theme::WARNING),
        false => (say::class_help_request(), theme::TEXT),
    };
    let name = RichText::new(name.text(language)).color(colour);
    if ui.add(egui::Button::selectable(asks, name)).clicked() {
        console.send(Command::Seat(SeatAction::AskHelp(!asks)));
    }
}

impl Window {
    /// Shows the pane of the network, and stores its settings.
    pub(crate) fn show_network_pane(&mut self, context: &Context) {
        let (language, console) = (self.settings.language, &self.console);
        self.network
            .apply_stored(&self.settings.network, console, language);
        let asks_help = self.snapshot.as_ref().and_then(|it| it.asks_help);
        let shown = (self.placed_areas.as_slice(), asks_help);
        if let Some(settings) = self.network.show(context, language, console, shown) {
            self.name_learner(&settings.class);
            self.settings.network = settings;
        }
    }

    /// Joins a class at the start; an empty name is that of the learner on his results.
    pub fn join_class(&mut self, class: ClassSettings) {
        let name = match class.name.as_str() {
            "" => self.settings.learner.clone(),
            name => name.to_owned(),
        };
        let class = ClassSettings { name, ..class };
        self.name_learner(&class);
        self.network.join_class(class);
    }

    /// Puts the name in a class on results, unless they have another one.
    fn name_learner(&mut self, class: &ClassSettings) {
        let exercises = self.views.lessons().exercises();
        if class.is_on && exercises.learner().trim().is_empty() {
            exercises.set_learner(class.name.trim());
        }
    }
}

/// Splits a class that was pasted into the field of the code.
fn take_pasted_class(draft: &mut ClassSettings) {
    if let Ok(class) = ClassAddress::from_pasted(&draft.code) {
        draft.code = class.code.to_string();
        draft.broker = class.broker.without_password();
        draft.password = class.broker.password.unwrap_or_default();
    }
}

/// Moves a password out of an address: addresses are stored and shown.
fn separate_password(address: &mut String, password: &mut String) {
    if let Ok(url) = parse_broker(address.trim())
        && let Some(given) = &url.password
    {
        password.clone_from(given);
        *address = url.without_password();
    }
}

/// A service in the pane: its switch, its fields, its state.
struct SectionForm<'a> {
    language: Language,
    state: &'a SharedServiceState,
    /// Whether the switch was clicked or a field was confirmed.
    is_confirmed: bool,
}

impl<'a> SectionForm<'a> {
    fn begin(ui: &mut Ui, language: Language, state: &'a SharedServiceState) -> Self {
        ui.add_space(4.0);
        Self {
            language,
            state,
            is_confirmed: false,
        }
    }

    fn show_switch(&mut self, ui: &mut Ui, is_on: &mut bool, name: &Message, hint: &Message) {
        let by_option = self.state.is_by_option();
        let mut shown = *is_on || by_option;
        let name = RichText::new(name.text(self.language)).strong();
        let switch = ui.add_enabled(!by_option, egui::Checkbox::new(&mut shown, name));
        let fixed = say::network_by_option().text(self.language);
        let switch = switch.on_disabled_hover_text(fixed);
        if switch.on_hover_text(hint.text(self.language)).changed() {
            *is_on = shown;
            self.is_confirmed = true;
        }
    }

    /// Draws a field; returns whether the operator has left it.
    fn show_field(
        &mut self,
        ui: &mut Ui,
        text: &mut String,
        name: &Message,
        example: &str,
    ) -> bool {
        let row = ui.horizontal(|ui| {
            let name = ui.label(name.text(self.language));
            let field = TextEdit::singleline(text)
                .desired_width(FIELD_WIDTH)
                .hint_text(example);
            ui.add(field).labelled_by(name.id).lost_focus()
        });
        let enter = ui.input(|input| input.key_pressed(PcKey::Enter));
        self.is_confirmed |= row.inner && enter;
        row.inner
    }

    /// Draws the field for the file of the authority, if the address requests TLS.
    fn show_ca(&mut self, ui: &mut Ui, address: &str, file: &mut String) {
        let has_tls = |url: &BrokerUrl| url.transport == BrokerTransport::Tls;
        if parse_broker(address.trim()).is_ok_and(|url| has_tls(&url)) {
            let hint = say::network_ca_hint().text(self.language);
            let row = ui.scope(|ui| self.show_field(ui, file, &say::network_ca(), "ca.crt"));
            row.response.on_hover_text(hint);
        }
    }

    fn show_password(&mut self, ui: &mut Ui, text: &mut String) {
        ui.horizontal(|ui| {
            let name = ui.label(say::network_password().text(self.language));
            let field = TextEdit::singleline(text)
                .password(true)
                .desired_width(FIELD_WIDTH / 2.0);
            let field = ui.add(field).labelled_by(name.id);
            field.on_hover_text(say::network_password_hint().text(self.language));
        });
    }

    /// Draws the state and the button; returns whether the settings are to be applied.
    fn end(self, ui: &mut Ui, is_changed: bool) -> bool {
        let apply = egui::Button::new(say::network_apply().text(self.language));
        let apply = ui.add_enabled(is_changed, apply).clicked();
        let state = self.state.get();
        let colour = match state {
            ServiceState::Off => theme::STATE_TEXT,
            ServiceState::Connecting(_) => theme::BUSY,
            ServiceState::Listening(_) | ServiceState::Connected(_) => theme::SUCCESS,
            ServiceState::Failed(_) => theme::ERROR_TEXT,
        };
        ui.label(RichText::new(state.message().text(self.language)).color(colour));
        is_changed && (apply || self.is_confirmed)
    }
}
