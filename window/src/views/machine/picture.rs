//! The picture of the machine view: draws part, path and tool, and handles the pointer in it.

use egui::{PointerButton, Pos2, Rect, Response, Role, Sense, Ui, Vec2, WidgetInfo, pos2, vec2};
use gsk_messages::{Language, say};
use gsk_workpiece::grid::from_grid;

use super::camera::Camera;
use super::{
    Instrument, LatheView, SelectedBlock, animation, grid, overlay, path_lines, section_drawing,
    to_block_ref, to_pos2,
};

/// Maximum distance of a click from the path to select a block, points.
const CLICK_REACH: f32 = 8.0;
/// Exponent of the zoom factor per point that the wheel scrolls.
const ZOOM_PER_POINT: f32 = 0.004;
/// Length of the chuck that the fitted picture shows, mm from the jaws' front.
const VISIBLE_CHUCK_MM: f32 = 35.0;
/// Margin around the tool in the picture of a program that cuts no part, mm.
const TOOL_MARGIN_MM: Vec2 = vec2(22.0, 14.0);
/// Minimum scale at which a single position is shown, points per millimetre.
const CLOSE_SCALE: f32 = 120.0;

impl LatheView {
    pub(super) fn show_picture(&mut self, ui: &mut Ui, language: Language) {
        let rect = ui.available_rect_before_wrap();
        let sense = Sense::CLICK | Sense::DRAG;
        let response = ui.interact(rect, ui.scope_id().with("lathe"), sense);
        response.widget_info(|| {
            let name = say::lathe_picture().text(language);
            WidgetInfo::labeled(Role::Canvas, true, name)
        });
        if rect.width() < 20.0 || rect.height() < 20.0 {
            return;
        }
        let mut camera = self.current_camera(rect);
        self.handle_pointer(ui, &response, &mut camera);
        let tip = self.part.as_ref().map(|part| to_pos2(part.tip));
        if let (true, Some(tip)) = (self.picture.follows_tool, tip) {
            camera.keep_visible(tip);
            self.picture.camera = Some(camera);
        }
        let painter = ui.painter().with_clip_rect(rect);
        let solid = self.part.as_ref().filter(|_| self.picture.is_solid);
        let mut is_tool_drawn = false;
        if let Some(part) = solid {
            is_tool_drawn = self.solid_drawing.draw(&painter, &camera, part);
        } else {
            grid::draw_lines(&painter, &camera);
            if let Some(part) = &self.part {
                self.section_drawing.draw(&painter, &camera, part);
            }
        }
        let path = &self.preview.path;
        if self.instruments.selected == Instrument::Microscope {
            self.instruments.microscope.draw(&painter, &camera);
        } else {
            self.path_renderer.draw(&painter, &camera, path);
            self.instruments.load.draw_path(&painter, &camera, path);
        }
        if let Some(fault) = self.preview.fault_block {
            path_lines::mark_wrong(&painter, &camera, &self.preview.path, fault);
        }
        if let Some(SelectedBlock { block, pass }) = &self.selected {
            // Highlighting all passes of a cycle would hide the part.
            match pass {
                Some(pass) => {
                    path_lines::highlight_pass(&painter, &camera, &path.pass_segments(pass));
                }
                None => path_lines::highlight_block(&painter, &camera, path, *block, false),
            }
        }
        if let Some(part) = &self.part {
            let tip = to_pos2(part.tip);
            if let Some(block) = part.block.map(to_block_ref) {
                match path.running_pass(block, tip) {
                    Some(pass) => {
                        path_lines::highlight_pass(&painter, &camera, &path.pass_segments(pass));
                    }
                    None => path_lines::highlight_block(&painter, &camera, path, block, true),
                }
            }
            if solid.is_none() {
                is_tool_drawn = self
                    .section_drawing
                    .draw_job_tool(&painter, &camera, part, tip);
            }
            if !is_tool_drawn {
                section_drawing::draw_tip_cross(&painter, &camera, tip);
            }
            if part.coolant {
                animation::draw_coolant(&painter, &camera, tip);
            }
            overlay::draw_hits(&painter, &camera, part);
        }
        // A measurement may lie over the states, which it is more important than.
        if let Some(part) = &self.part {
            overlay::draw_states(&painter, rect, part, language);
        }
        if self.instruments.selected == Instrument::Caliper {
            self.instruments.caliper.draw(&painter, &camera, language);
            self.instruments.caliper.show_readings(ui, rect, language);
        }
        if solid.is_none() {
            grid::draw_figures(&painter, &camera, language);
        }
        if self.instruments.selected != Instrument::Microscope {
            overlay::draw_legend(&painter, rect, language);
        }
    }

    /// Lets the picture show the part, and the whole tool where it is now.
    pub(super) fn fit_picture(&mut self) {
        self.picture.show_whole_part();
        self.picture.fitted_tip = self.part.as_ref().map(|part| to_pos2(part.tip));
    }

    /// The camera that the user has moved; if there is none, a camera that shows everything.
    fn current_camera(&self, rect: Rect) -> Camera {
        if let Some(camera) = self.picture.camera {
            return camera.with_rect(rect);
        }
        if let Some(part) = self.part.as_ref().filter(|_| self.picture.is_solid) {
            let stock = &part.job.stock;
            let (_, jaws) = stock.chuck_section();
            let shown = [&stock.section(), &jaws, &stock.tailstock_section()];
            return Camera::fit_solid(&shown, self.is_rear(), rect);
        }
        let part = self.part.as_ref().map(|part| {
            let stock = &part.job.stock;
            let (radius, front) = (stock.radius() as f32, stock.front() as f32);
            let back = stock.jaw_front() as f32 - VISIBLE_CHUCK_MM;
            let jaws = stock.chuck_section().1.bounds();
            let jaws = jaws.map_or(radius, |it| from_grid(it.high).x as f32);
            let clamped = Rect::from_min_max(pos2(back, -jaws), pos2(front, jaws));
            let tools = self.picture.tool_bounds.as_ref();
            let tools = tools.map_or(Rect::ZERO, |(_, bounds)| *bounds);
            // The whole tool is visible while its tip is at the end of the bar, or anywhere with
            // an empty chuck.
            let tip = match part.empty_chuck {
                Some(far) => to_pos2(far),
                None => pos2(front, radius),
            };
            let shown = clamped.union(tools.translate(tip.to_vec2()));
            let fitted = self
                .picture
                .fitted_tip
                .map(|tip| tools.translate(tip.to_vec2()));
            fitted.map_or(shown, |tool| shown.union(tool))
        });
        let is_chuck_empty = (self.part.as_ref()).is_some_and(|part| part.empty_chuck.is_some());
        // At the end of its path the insert is not cut off.
        let tool_reach = (self.picture.tool_bounds.as_ref()).map_or(0.0, |(_, it)| it.right());
        let path = self.preview.path.bounds.map(|mut path| {
            path.max.x += tool_reach.max(0.0);
            path
        });
        let bounds = match (part, path) {
            (Some(part), Some(path)) => part.union(path),
            // The path shows where the tool is. Without a path the tool needs a margin.
            (Some(part), None) if !is_chuck_empty => part.expand2(TOOL_MARGIN_MM),
            (one, other) => one
                .or(other)
                .unwrap_or(Rect::from_center_size(Pos2::ZERO, vec2(200.0, 120.0))),
        };
        Camera::fit(bounds, self.is_rear(), rect)
    }

    /// Whether the tool post is on the far side of the spindle; false until the first result
    /// of the worker.
    const fn is_rear(&self) -> bool {
        self.preview.rear_tool_post
    }

    /// Handles mouse and touch input in the picture; moves `camera` accordingly.
    fn handle_pointer(&mut self, ui: &Ui, response: &Response, camera: &mut Camera) {
        let before = *camera;
        let hover = response.hover_pos();
        self.pointer = hover.map(|at| camera.part_position(at));
        if let Some(at) = hover {
            let (scrolled, pinched) =
                ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = (scrolled * ZOOM_PER_POINT).exp() * pinched;
            if factor != 1.0 {
                camera.zoom(factor, at);
            }
        }
        if response.dragged() {
            let is_turn = response.dragged_by(PointerButton::Primary)
                && ui.input(|input| !input.modifiers.shift);
            if is_turn && self.picture.is_solid && self.part.is_some() {
                camera.orbit(response.drag_delta());
            } else {
                camera.pan(response.drag_delta());
            }
        }
        if *camera != before {
            self.picture.camera = Some(*camera);
        }
        if response.double_clicked() {
            self.picture.show_whole_part();
            *camera = self.current_camera(camera.rect);
        } else if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            let path = &self.preview.path;
            match self.instruments.selected {
                Instrument::Caliper => self.instruments.caliper.toggle_kept(),
                Instrument::Path | Instrument::Microscope | Instrument::Job => {
                    let piece = path.nearest_segment(
                        camera.part_position(at),
                        CLICK_REACH / camera.points_per_mm,
                    );
                    self.selected = piece.and_then(|piece| {
                        let pass = path.pass_at(piece).cloned();
                        let block = path.block_at(piece)?;
                        Some(SelectedBlock { block, pass })
                    });
                    let block = self.selected.as_ref().map(|chosen| chosen.block);
                    self.program_text.request =
                        block.map(|block| self.make_show_request(block, false));
                }
            }
        }
        match self.instruments.selected {
            Instrument::Path | Instrument::Job => {}
            Instrument::Caliper => self.instruments.caliper.set_pointer(self.pointer, camera),
            Instrument::Microscope => self
                .instruments
                .microscope
                .set_pointer(self.pointer, camera),
        }
    }

    /// Moves a position, part coordinates, to the centre and enlarges the picture to a close
    /// view.
    pub(super) fn show_enlarged(&mut self, at: Pos2) {
        self.show_centred(at);
        if let Some(camera) = &mut self.picture.camera {
            camera.points_per_mm = camera.points_per_mm.max(CLOSE_SCALE);
        }
    }

    /// Moves a position, part coordinates, to the centre at the current scale.
    pub(super) fn show_centred(&mut self, at: Pos2) {
        let rect = Rect::from_center_size(Pos2::ZERO, vec2(600.0, 400.0));
        let camera = self.current_camera(rect);
        self.picture.camera = Some(camera.with_centre(at));
    }
}
