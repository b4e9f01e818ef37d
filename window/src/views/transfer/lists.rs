//! 文件列表: draws the lists of files to send and of files in the control.

use egui::{Grid, Label, RichText, Sense, Ui, vec2};
use gsk_messages::{Language, say};

use super::{TransferDialog, TransferView};
use crate::theme;

/// Minimum and maximum width of the column of paths, points. The constant after it is the
/// width of the further columns together.
const PATH_WIDTH_RANGE: [f32; 2] = [120.0, 420.0];
const OTHER_COLUMNS_WIDTH: f32 = 300.0;
/// Approximate width of a letter in a path, points.
const LETTER_WIDTH: f32 = 7.0;

/// Converts a file size from bytes to kilobytes, rounded up.
fn kilobytes(bytes: u64) -> u64 {
    bytes.div_ceil(1024)
}

/// Shortens a path to a column of `width` points; the end of the path remains.
fn shorten_path(path: &str, width: f32) -> String {
    let max_letters = (width / LETTER_WIDTH) as usize;
    let letters = path.chars().count();
    if letters <= max_letters {
        return path.to_owned();
    }
    let end = path.chars().skip(letters + 1 - max_letters);
    core::iter::once('…').chain(end).collect()
}

impl TransferView {
    /// Draws 发送文件路径, CNC保存文件名, 长度, 存储区 (path, name, length, partition). A double click edits a
    /// row; its context menu removes it.
    pub(super) fn show_files_to_send(&mut self, ui: &mut Ui, language: Language) {
        if self.settings.list.is_empty() {
            ui.label(RichText::new(say::transfer_view_list_empty().text(language)).weak());
            return;
        }
        let width = (ui.available_width() - OTHER_COLUMNS_WIDTH)
            .clamp(PATH_WIDTH_RANGE[0], PATH_WIDTH_RANGE[1]);
        let (mut edited_row, mut removed_row, mut is_cleared) = (None, None, false);
        Grid::new("to-send")
            .num_columns(4)
            .spacing(vec2(18.0, 4.0))
            .striped(true)
            .show(ui, |ui| {
                for heading in [
                    say::transfer_view_column_path(),
                    say::transfer_view_column_name(),
                    say::transfer_view_column_size(),
                    say::transfer_view_column_partition(),
                ] {
                    ui.label(RichText::new(heading.text(language)).weak());
                }
                ui.end_row();
                for (at, item) in self.settings.list.iter().enumerate() {
                    let path = item.path.display().to_string();
                    let length = self.lengths.get(&item.path).copied();
                    let text = RichText::new(shorten_path(&path, width));
                    let text = match length {
                        Some(None) => text.color(theme::ALARM_TEXT),
                        _ => text,
                    };
                    let label = Label::new(text).truncate().selectable(false);
                    let label = label.sense(Sense::click());
                    let row = ui.scope(|ui| {
                        ui.set_width(width);
                        ui.add(label)
                    });
                    let row = row.inner;
                    let hint = match length {
                        Some(None) => say::transfer_view_no_file(&path).text(language),
                        _ => path,
                    };
                    let row = row.on_hover_text(hint);
                    if row.double_clicked() {
                        edited_row = Some(at);
                    }
                    row.context_menu(|ui| {
                        if ui
                            .button(say::transfer_view_edit().text(language))
                            .clicked()
                        {
                            edited_row = Some(at);
                        }
                        if ui
                            .button(say::transfer_view_remove().text(language))
                            .clicked()
                        {
                            removed_row = Some(at);
                        }
                        is_cleared |= ui
                            .button(say::transfer_view_clear().text(language))
                            .clicked();
                    });
                    ui.monospace(&item.name);
                    let length = length.flatten().map(kilobytes);
                    ui.monospace(length.map_or_else(|| "-".to_owned(), |it| it.to_string()));
                    ui.monospace(item.partition().name());
                    ui.end_row();
                }
            });
        if let Some(at) = edited_row {
            self.dialog = self
                .settings
                .list
                .get(at)
                .map(|it| TransferDialog::change_row(at, it));
        }
        if let Some(at) = removed_row {
            self.settings.list.remove(at);
        }
        if is_cleared {
            self.settings.list.clear();
        }
    }

    /// Draws the tree of partitions. A check box selects a file; that of a partition selects
    /// all of its files.
    pub(super) fn show_control_files(&mut self, ui: &mut Ui, language: Language) {
        if self.listing.partitions.is_empty() {
            ui.label(RichText::new(say::transfer_view_not_listed().text(language)).weak());
            return;
        }
        let listing = &mut self.listing;
        for (index, (partition, entries)) in listing.partitions.iter().enumerate() {
            let key = |name: &gsk_transfer::FileName| (index, name.to_string());
            let checked = entries
                .iter()
                .filter(|it| listing.checked.contains(&key(&it.name)));
            let mut all_checked = !entries.is_empty() && checked.count() == entries.len();
            let words = RichText::new(partition.name()).strong();
            let tick = egui::Checkbox::new(&mut all_checked, words);
            if ui.add_enabled(!entries.is_empty(), tick).changed() {
                for entry in entries {
                    match all_checked {
                        true => listing.checked.insert(key(&entry.name)),
                        false => listing.checked.remove(&key(&entry.name)),
                    };
                }
            }
            ui.indent(("partition", index), |ui| {
                Grid::new(("entries", index))
                    .num_columns(2)
                    .spacing(vec2(24.0, 2.0))
                    .show(ui, |ui| {
                        for entry in entries {
                            let key = key(&entry.name);
                            let mut is_checked = listing.checked.contains(&key);
                            if ui.checkbox(&mut is_checked, entry.name.as_str()).changed() {
                                match is_checked {
                                    true => listing.checked.insert(key),
                                    false => listing.checked.remove(&key),
                                };
                            }
                            let bytes = say::transfer_view_bytes(entry.size).text(language);
                            ui.label(RichText::new(bytes).weak());
                            ui.end_row();
                        }
                    });
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_path_keeps_its_end() {
        assert_eq!(shorten_path("/a/b.nc", 80.0), "/a/b.nc");
        assert_eq!(shorten_path("/programs/轴/O0001.CNC", 80.0), "…/O0001.CNC");
    }
}
