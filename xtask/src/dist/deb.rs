//! The package for Debian and Ubuntu: an `ar` archive with two `tar` archives. It is written
//! here, without dpkg, so that builds are reproducible on every system.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::archive::{self, Item, ar, gz, tar_gz};
use super::linux::{PackageContents, empty_folder};
use super::notes::Section;
use super::{VERSION, stdout_of, target, with_path};
use crate::error::TaskError;

const MAINTAINER: &str = "The gsk980td contributors <maintainers@gsk980td.invalid>";
const DOC: &str = "usr/share/doc/gsk980td";
/// Sizes of the installed icons, pixels, besides the window's own icon of 256.
const ICONS: [u32; 6] = [16, 24, 32, 48, 64, 128];
/// Packages that the window needs besides the libraries it loads: an OpenGL driver and key
/// names.
const WINDOW: [&str; 2] = ["libgl1-mesa-dri", "xkb-data"];

/// Makes the `.deb` in `folder` and returns its path.
///
/// # Errors
/// A file cannot be read or written, or `md5sum` fails.
pub fn make(
    root: &Path,
    folder: &Path,
    parts: &PackageContents,
    version: &Section,
) -> Result<PathBuf, TaskError> {
    let architecture = parts.needs.processor.1;
    let path = folder.join(format!("gsk980td_{VERSION}_{architecture}.deb"));
    let items = installed_files(root, parts, version)?;
    let control = [
        Item::text("control", control_file(parts, &items)),
        Item::text("md5sums", md5sums(root, &items)?),
    ];
    let members = [
        ("debian-binary", b"2.0\n".to_vec()),
        (
            "control.tar.gz",
            with_path(&path, tar_gz("./", &control, parts.time))?,
        ),
        (
            "data.tar.gz",
            with_path(&path, tar_gz("./", &items, parts.time))?,
        ),
    ];
    with_path(&path, fs::write(&path, ar(&members, parts.time)))?;
    Ok(path)
}

/// Lists every file that the package installs.
fn installed_files(
    root: &Path,
    parts: &PackageContents,
    version: &Section,
) -> Result<Vec<Item>, TaskError> {
    let read = |name: &str| {
        let path = root.join(name);
        with_path(&path, fs::read(&path))
    };
    let packed = |bytes: &[u8]| with_path(root, gz(bytes));
    let mut items = vec![Item {
        name: "usr/bin/gsk980td".to_owned(),
        bytes: parts.program.clone(),
        program: true,
    }];
    let mut add = |name: String, bytes: Vec<u8>| items.push(Item::text(name, bytes));
    for name in ["gsk980td.desktop", "gsk980td-open.desktop"] {
        let bytes = read(&format!("app/linux/{name}"))?;
        add(format!("usr/share/applications/{name}"), bytes);
    }
    let mime_types = read("app/linux/gsk980td.xml")?;
    add(
        "usr/share/mime/packages/gsk980td.xml".to_owned(),
        mime_types,
    );
    let lintian = read("app/linux/gsk980td.lintian-overrides")?;
    add("usr/share/lintian/overrides/gsk980td".to_owned(), lintian);
    let icon =
        |folder: &str, end: &str| format!("usr/share/icons/hicolor/{folder}/apps/gsk980td.{end}");
    for size in ICONS {
        let bytes = read(&format!("assets/icon/gsk980td-{size}.png"))?;
        add(icon(&format!("{size}x{size}"), "png"), bytes);
    }
    add(icon("256x256", "png"), read("assets/icon/gsk980td.png")?);
    add(icon("scalable", "svg"), read("assets/icon/gsk980td.svg")?);
    for (name, page) in &parts.pages {
        add(format!("usr/share/man/man1/{name}.gz"), packed(page)?);
    }
    for (_, path, script) in &parts.shells {
        add((*path).to_owned(), script.as_bytes().to_vec());
    }
    for name in ["NOTICE", "README.md", "README.zh-CN.md"] {
        add(format!("{DOC}/{name}"), read(name)?);
    }
    let others = packed(&read("THIRD-PARTY.md")?)?;
    add(format!("{DOC}/THIRD-PARTY.md.gz"), others);
    let changes = packed(debian_changelog(version).as_bytes())?;
    add(format!("{DOC}/changelog.gz"), changes);
    let licence = String::from_utf8_lossy(&read("LICENSE-MIT")?).into_owned();
    add(format!("{DOC}/copyright"), copyright(&licence).into_bytes());
    for (name, path) in archive::entries(root, "assets/programs")? {
        let name = name.replace("assets/programs/", "");
        add(
            format!("{DOC}/examples/{name}"),
            with_path(&path, fs::read(&path))?,
        );
    }
    for (name, path) in archive::entries(root, "posts")? {
        add(format!("{DOC}/{name}"), with_path(&path, fs::read(&path))?);
    }
    Ok(items)
}

/// Formats the file `control` of the package.
fn control_file(parts: &PackageContents, items: &[Item]) -> String {
    let size: usize = items
        .iter()
        .map(|item| item.bytes.len().div_ceil(1024))
        .sum();
    let window: Vec<_> = parts.needs.loads.iter().map(String::as_str).collect();
    format!(
        "Package: gsk980td\n\
         Version: {VERSION}\n\
         Architecture: {}\n\
         Maintainer: {MAINTAINER}\n\
         Installed-Size: {size}\n\
         Depends: {}\n\
         Recommends: {}\n\
         Suggests: xdg-desktop-portal\n\
         Section: science\n\
         Priority: optional\n\
         Description: control of a GSK980TD lathe on a PC\n \
         The operator panel of the control with its keys and Chinese LCD pages in a\n \
         window, a complete control with its PLC behind it, and a simulated lathe\n \
         behind that, for training and for trying part programs.\n \
         .\n \
         Commands check a part program, execute it and draw its toolpath without a\n \
         display. A real lathe can be driven through a pulse board at a serial port;\n \
         who does that belongs to the group dialout.\n",
        parts.needs.processor.1,
        parts.needs.depends.join(", "),
        [&window[..], &WINDOW].concat().join(", "),
    )
}

/// Returns the text of the file `md5sums`, which `md5sum` makes from the installed tree.
fn md5sums(root: &Path, items: &[Item]) -> Result<String, TaskError> {
    let stage = empty_folder(target(root).join("dist-deb"))?;
    let mut names: Vec<_> = items.iter().map(|item| item.name.as_str()).collect();
    names.sort_unstable();
    for item in items {
        let path = stage.join(&item.name);
        if let Some(folder) = path.parent() {
            with_path(folder, fs::create_dir_all(folder))?;
        }
        with_path(&path, fs::write(&path, &item.bytes))?;
    }
    let sums = stdout_of(
        Command::new("md5sum")
            .arg("--")
            .args(names)
            .current_dir(&stage),
    )?;
    with_path(&stage, fs::remove_dir_all(&stage))?;
    Ok(sums)
}

/// Formats a section of the changelog in Debian's format.
fn debian_changelog(version: &Section) -> String {
    let mut out = format!("gsk980td ({VERSION}) unstable; urgency=medium\n");
    for line in version.text.lines().filter(|line| !line.trim().is_empty()) {
        if let Some(heading) = line.strip_prefix("### ") {
            out += &format!("\n  [ {heading} ]\n");
        } else if let Some(item) = line.strip_prefix("- ") {
            out += &wrapped("  * ", item);
        } else {
            out += &wrapped("    ", line.trim());
        }
    }
    out + &format!("\n -- {MAINTAINER}  {}\n", version.to_rfc_5322())
}

/// Wraps `words` after `begin` into lines of at most 78 characters; all lines but the first
/// are indented by four.
fn wrapped(begin: &str, words: &str) -> String {
    let mut out = String::new();
    let mut line = begin.to_owned();
    for word in words.split_whitespace() {
        let empty = line.trim_matches([' ', '*']).is_empty();
        if !empty && line.chars().count() + word.chars().count() > 77 {
            out += line.trim_end();
            out.push('\n');
            "    ".clone_into(&mut line);
        }
        line += word;
        line.push(' ');
    }
    out += line.trim_end();
    out.push('\n');
    out
}

/// Formats the file `copyright` with the text of the MIT licence.
fn copyright(licence: &str) -> String {
    let indented = |text: &str| {
        let lines = text.trim().lines().map(|line| match line.trim_end() {
            "" => " .\n".to_owned(),
            line => format!(" {line}\n"),
        });
        lines.collect::<String>()
    };
    let terms = licence
        .find("Permission is")
        .map_or(licence, |at| &licence[at..]);
    format!(
        "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n\
         Upstream-Name: gsk980td\n\
         Comment:\n \
         The program contains packages of others and glyphs of several fonts: NOTICE and\n \
         THIRD-PARTY.md.gz beside this file name them with their licences.\n\
         \n\
         Files: *\n\
         Copyright: 2026 The gsk980td contributors\n\
         License: MIT or Apache-2.0\n\
         \n\
         License: MIT\n\
         {}\n\
         License: Apache-2.0\n \
         On Debian systems the licence is found in /usr/share/common-licenses/Apache-2.0.\n",
        indented(terms),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dist::needs::Requirements;

    #[test]
    fn changelog_has_debian_format() {
        let text = format!("### Added\n\n- {}\n- two", "word ".repeat(20));
        let date = (2026, 11, 22);
        let changelog = debian_changelog(&Section { date, text: &text });
        let lines: Vec<_> = changelog.lines().collect();
        assert!(lines[0].starts_with("gsk980td (") && lines[0].ends_with("; urgency=medium"));
        assert_eq!(lines[2], "  [ Added ]");
        assert!(lines[3].starts_with("  * word word"));
        assert!(lines[4].starts_with("    word"), "{}", lines[4]);
        assert!(
            lines
                .iter()
                .all(|line| line.len() <= 78 || line.starts_with(" -- ")),
            "{changelog}"
        );
        assert!(changelog.ends_with(">  Sun, 22 Nov 2026 00:00:00 +0000\n"));
    }

    #[test]
    fn control_file_names_processor_and_dependencies() {
        let parts = PackageContents {
            program: Vec::new(),
            needs: Requirements {
                processor: ("aarch64", "arm64"),
                depends: vec!["libc6 (>= 2.34)".to_owned()],
                loads: vec!["libgl1".to_owned()],
            },
            pages: Vec::new(),
            shells: Vec::new(),
            time: 0,
        };
        let control = control_file(&parts, &[Item::text("a", vec![0; 1025])]);
        for line in [
            "Architecture: arm64",
            "Depends: libc6 (>= 2.34)",
            "Recommends: libgl1, libgl1-mesa-dri, xkb-data",
            "Installed-Size: 2",
        ] {
            assert!(
                control.lines().any(|found| found == line),
                "{line}: {control}"
            );
        }
    }
}
