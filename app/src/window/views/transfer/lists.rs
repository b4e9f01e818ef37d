//! 文件列表: draws the lists of files to send and of files in the control.

use egui::{Grid, Label, RichText, Sense, Ui, vec2};
use gsk_messages::{Language, say};

use super::{BAD, Dialog, TransferView};

/// Least and greatest width of the column of paths, and the width of the columns after it,
/// points.
const PATH: [f32; 2] = [120.0, 420.0];
const AFTER: f32 = 300.0;
/// Approximate width of a letter of a path, points.
const LETTER: f32 = 7.0;

/// File size in kilobytes, rounded up.
fn kilobytes(bytes: u64) -> u64 {
    bytes.div_ceil(1024)
}

/// Shortens a path to the width of its column. The end of the path remains.
fn ending(path: &str, width: f32) -> String {
    let most = (width / LETTER) as usize;
    let letters = path.chars().count();
    if letters <= most {
        return path.to_owned();
    }
    let end = path.chars().skip(letters + 1 - most);
    core::iter::once('…').chain(end).collect()
}

impl TransferView {
    /// Draws 发送文件路径, CNC保存文件名, 长度, 存储区 (path, name, length, partition). A double click edits a
    /// row; its context menu removes it.
    pub(super) fn sending(&mut self, ui: &mut Ui, language: Language) {
        if self.remembered.list.is_empty() {
            ui.label(RichText::new(say::transfer_view_list_empty().text(language)).weak());
            return;
        }
        let width = (ui.available_width() - AFTER).clamp(PATH[0], PATH[1]);
        let (mut edited, mut removed, mut cleared) = (None, None, false);
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
                for (at, item) in self.remembered.list.iter().enumerate() {
                    let path = item.path.display().to_string();
                    let length = self.lengths.get(&item.path).copied();
                    let text = RichText::new(ending(&path, width));
                    let text = match length {
                        Some(None) => text.color(BAD),
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
                        edited = Some(at);
                    }
                    row.context_menu(|ui| {
                        if ui
                            .button(say::transfer_view_edit().text(language))
                            .clicked()
                        {
                            edited = Some(at);
                        }
                        if ui
                            .button(say::transfer_view_remove().text(language))
                            .clicked()
                        {
                            removed = Some(at);
                        }
                        cleared |= ui
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
        if let Some(at) = edited {
            self.dialog = self
                .remembered
                .list
                .get(at)
                .map(|it| Dialog::change(at, it));
        }
        if let Some(at) = removed {
            self.remembered.list.remove(at);
        }
        if cleared {
            self.remembered.list.clear();
        }
    }

    /// Draws the tree of partitions. A check box selects a file; that of a partition selects
    /// all of its files.
    pub(super) fn receiving(&mut self, ui: &mut Ui, language: Language) {
        if self.listing.partitions.is_empty() {
            ui.label(RichText::new(say::transfer_view_not_listed().text(language)).weak());
            return;
        }
        let listing = &mut self.listing;
        for (at, (partition, entries)) in listing.partitions.iter().enumerate() {
            let key = |name: &gsk_transfer::FileName| (at, name.to_string());
            let chosen = entries
                .iter()
                .filter(|it| listing.ticked.contains(&key(&it.name)));
            let mut all = !entries.is_empty() && chosen.count() == entries.len();
            let words = RichText::new(partition.name()).strong();
            let tick = egui::Checkbox::new(&mut all, words);
            if ui.add_enabled(!entries.is_empty(), tick).changed() {
                for entry in entries {
                    match all {
                        true => listing.ticked.insert(key(&entry.name)),
                        false => listing.ticked.remove(&key(&entry.name)),
                    };
                }
            }
            ui.indent(("partition", at), |ui| {
                Grid::new(("entries", at))
                    .num_columns(2)
                    .spacing(vec2(24.0, 2.0))
                    .show(ui, |ui| {
                        for entry in entries {
                            let key = key(&entry.name);
                            let mut ticked = listing.ticked.contains(&key);
                            if ui.checkbox(&mut ticked, entry.name.as_str()).changed() {
                                match ticked {
                                    true => listing.ticked.insert(key),
                                    false => listing.ticked.remove(&key),
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
        assert_eq!(ending("/a/b.nc", 80.0), "/a/b.nc");
        assert_eq!(ending("/programs/轴/O0001.CNC", 80.0), "…/O0001.CNC");
    }
}
