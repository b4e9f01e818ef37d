//! Checks the directions of dependencies: between packages according to the table in
//! ARCHITECTURE.md, between the modules of `core` according to `tests/core-modules.tsv`. No
//! two neighbours use each other, and in `core`, `runner` and `plot` no neighbours form a
//! circle. Only one module queries the system.

mod paths;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use gsk_tests::repository;
use paths::{ModuleSource, sources};

/// The modules of `core`, from leaf to root, and what each uses.
const CORE_MODULES: &str = "tests/core-modules.tsv";
/// The folders of the packages that have a library.
const PACKAGES: [&str; 32] = [
    "messages",
    "units",
    "plc",
    "link",
    "transfer",
    "twins",
    "workpiece",
    "tooling",
    "scene",
    "core",
    "milling",
    "mtconnect",
    "telemetry",
    "commission",
    "panel",
    "project",
    "port",
    "forms",
    "outline",
    "runner",
    "lesson",
    "plot",
    "debugger",
    "history",
    "exercise",
    "help",
    "language",
    "host",
    "window",
    "app",
    "web",
    "tests",
];
/// The library of the firmware's workspace that a package may use.
const FIRMWARE_MOTION: &str = "`firmware/motion`";
/// Libraries that `core` re-exports.
const RE_EXPORTED: [&str; 2] = ["plc", "units"];

/// Where one module uses another: file and line.
type UsePositions = Vec<String>;
/// Uses between neighbours: `(folder, user, used)`.
type ModuleUses = BTreeMap<(String, String, String), UsePositions>;

/// The uses between the modules of each folder of a package, including its root.
fn package_uses(package: &str) -> ModuleUses {
    let sources = sources(&repository().join(package).join("src"));
    let modules: BTreeSet<&[String]> = sources
        .iter()
        .flat_map(|source| (1..=source.module.len()).map(|depth| &source.module[..depth]))
        .collect();
    let mut uses = ModuleUses::new();
    for source in &sources {
        for named in &source.names {
            let Some(target) = resolve_path(&source.module, &named.segments) else {
                continue;
            };
            let shared = source.module.iter().zip(&target);
            let shared = shared.take_while(|(own, other)| own == other).count();
            let (Some(user), Some(used)) = (source.module.get(shared), target.get(shared)) else {
                continue;
            };
            if modules.contains(&target[..=shared]) {
                let mut folder = vec![package.to_owned()];
                folder.extend_from_slice(&target[..shared]);
                let place = format!("{}:{}", source.file, named.line);
                let key = (folder.join("/"), user.clone(), used.clone());
                uses.entry(key).or_default().push(place);
            }
        }
    }
    uses
}

/// A path from the root of its package; `None` for a path into another package.
fn resolve_path(module: &[String], segments: &[String]) -> Option<Vec<String>> {
    let ups = segments.iter().take_while(|word| *word == "super").count();
    let (above, rest) = match segments[0].as_str() {
        "crate" => (0, &segments[1..]),
        "self" => (module.len(), &segments[1..]),
        "super" => (module.len().checked_sub(ups)?, &segments[ups..]),
        _ => return None,
    };
    let above = module[..above].iter();
    Some(above.chain(rest).cloned().collect())
}

#[test]
fn modules_of_core_use_what_the_table_says() {
    let table = fs::read_to_string(repository().join(CORE_MODULES)).expect(CORE_MODULES);
    let rows: Vec<(&str, BTreeSet<&str>)> = table
        .lines()
        .skip(1)
        .map(|line| line.split_once('\t').unwrap_or((line, "")))
        .map(|(module, uses)| (module, uses.split_whitespace().collect()))
        .collect();
    let found = package_uses("core");
    let mut faults = Vec::new();
    let mut unused: BTreeSet<(&str, &str)> = BTreeSet::new();
    let mut above = BTreeSet::new();
    for (module, uses) in &rows {
        for used in uses {
            unused.insert((module, used));
            if !above.contains(used) {
                faults.push(format!("{CORE_MODULES}: {used} must stand above {module}"));
            }
        }
        above.insert(*module);
    }
    for ((folder, user, used), places) in &found {
        if folder == "core" && !unused.remove(&(user.as_str(), used.as_str())) {
            faults.push(format!(
                "{user} must not use {used} ({CORE_MODULES}):\n  {}",
                places.join("\n  ")
            ));
        }
    }
    for (user, used) in unused {
        faults.push(format!("{CORE_MODULES}: {user} no longer uses {used}"));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn neighbours_use_each_other_one_way() {
    let packages = PACKAGES.map(package_uses);
    let mut faults = Vec::new();
    for uses in &packages {
        for ((folder, one, other), there) in uses {
            let back = uses.get(&(folder.clone(), other.clone(), one.clone()));
            let Some(back) = back.filter(|_| one < other) else {
                continue;
            };
            faults.push(format!(
                "{folder}: {one} and {other} use each other:\n  {}\n and\n  {}",
                there.join("\n  "),
                back.join("\n  ")
            ));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn neighbours_of_core_runner_and_plot_form_no_circle() {
    let mut folders: BTreeMap<String, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    let uses = ["core", "runner", "plot"].map(package_uses);
    for (folder, user, used) in uses.into_iter().flat_map(BTreeMap::into_keys) {
        let users = folders.entry(folder).or_default();
        users.entry(user).or_default().insert(used);
    }
    assert!(folders.contains_key("core/interpreter") && folders.contains_key("plot"));
    let circles: Vec<String> = folders
        .iter()
        .map(|(folder, uses)| (folder, modules_in_circles(uses)))
        .filter(|(_, circle)| !circle.is_empty())
        .map(|(folder, circle)| format!("{folder}: {circle:?}"))
        .collect();
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

/// The modules that are left when those without uses are removed until none is left to
/// remove: the members of circles and their users.
fn modules_in_circles(uses: &BTreeMap<String, BTreeSet<String>>) -> Vec<&str> {
    let mut left: Vec<&str> = uses.keys().map(String::as_str).collect();
    loop {
        let count = left.len();
        let before = left.clone();
        left.retain(|user| {
            uses[*user]
                .iter()
                .any(|used| before.contains(&used.as_str()))
        });
        if left.len() == count {
            return left;
        }
    }
}

#[test]
fn a_circle_of_three_is_found() {
    let uses = |pairs: &[(&str, &str)]| {
        let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (user, used) in pairs {
            uses.entry((*user).into())
                .or_default()
                .insert((*used).into());
        }
        uses
    };
    let chain = [("a", "b"), ("b", "c")];
    assert!(modules_in_circles(&uses(&chain)).is_empty());
    let circle = uses(&[("a", "b"), ("b", "c"), ("c", "a"), ("c", "d")]);
    assert_eq!(modules_in_circles(&circle), ["a", "b", "c"]);
}

/// The allowed uses of each package, according to the table in ARCHITECTURE.md.
fn allowed_uses() -> BTreeMap<String, BTreeSet<String>> {
    let text = fs::read_to_string(repository().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let mut allowed = BTreeMap::new();
    for line in text.lines() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, package, _, uses, _] = cells[..] else {
            continue;
        };
        let Some(package) = package.strip_prefix("`gsk980td") else {
            continue;
        };
        let package = match package.split_once('`') {
            Some(("", _)) => "app",
            Some((name, _)) => name.trim_start_matches('-'),
            None => panic!("{line}: a name in backquotes"),
        };
        let words: BTreeSet<&str> = uses.split('`').skip(1).step_by(2).collect();
        let all = uses.starts_with("everything") || uses.starts_with("all");
        let named = PACKAGES.into_iter().filter(|name| *name != package);
        let named = named.filter(|name| all || words.contains(name));
        let mut named: BTreeSet<String> = named.map(str::to_owned).collect();
        if uses.contains(FIRMWARE_MOTION) {
            named.insert("motion".to_owned());
        }
        allowed.insert(package.to_owned(), named);
    }
    allowed
}

/// The libraries of the workspace that the sources of a package use, with the position.
fn named_libraries(package: &str, sources: &[ModuleSource]) -> BTreeMap<String, String> {
    let mut used = BTreeMap::new();
    for source in sources {
        for named in &source.names {
            let Some(library) = named.segments[0].strip_prefix("gsk_") else {
                continue;
            };
            let next = named.segments.get(1).map_or("", String::as_str);
            let handed_on = library == "core" && RE_EXPORTED.contains(&next);
            let library = if handed_on { next } else { library };
            if library != package {
                let place = format!("{}:{}", source.file, named.line);
                used.entry(library.to_owned()).or_insert(place);
            }
        }
    }
    used
}

/// The workspace's libraries among the dependencies of a package, without those of its tests.
fn package_dependencies(package: &str) -> Vec<String> {
    let manifest = repository().join(package).join("Cargo.toml");
    let manifest = fs::read_to_string(manifest).expect("Cargo.toml");
    let sections = manifest.split("\n[").filter(|section| {
        let head = section.lines().next().unwrap_or_default();
        head.ends_with("dependencies]") && !head.contains("dev-")
    });
    sections
        .flat_map(str::lines)
        .filter_map(|line| line.strip_prefix("gsk_"))
        .filter_map(|line| line.split(['.', ' ', '=']).next())
        .map(str::to_owned)
        .collect()
}

#[test]
fn packages_use_what_the_architecture_says() {
    let allowed = allowed_uses();
    let mut faults = Vec::new();
    for package in PACKAGES {
        let Some(may) = allowed.get(package) else {
            faults.push(format!("ARCHITECTURE.md has no row for {package}"));
            continue;
        };
        let used = named_libraries(package, &sources(&repository().join(package).join("src")));
        for (library, place) in &used {
            if !may.contains(library) {
                faults.push(format!("{place}: {package} must not use {library}"));
            }
        }
        for library in package_dependencies(package) {
            if !may.contains(&library) {
                faults.push(format!(
                    "{package}/Cargo.toml: {package} must not use {library}"
                ));
            }
        }
        // The app and the tests may use everything, but need not.
        let whole = may.len() == PACKAGES.len() - 1;
        for library in may.iter().filter(|_| !whole) {
            if !used.contains_key(library) {
                faults.push(format!(
                    "ARCHITECTURE.md: {package} no longer uses {library}"
                ));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The folder of the code that differs by system.
const PLATFORM_FOLDER: &str = "host/src/platform/";
/// Besides it: the entry point for a browser, and the comparison with other systems.
const PAGE_FILES: [&str; 3] = [
    "tests/src/bin/golden.rs",
    "web/src/main.rs",
    "web/src/unpack.rs",
];
/// How a source queries the system, or uses functions of one system alone.
const SYSTEM_QUERIES: [&str; 18] = [
    "cfg(unix",
    "cfg(windows",
    "(all(unix",
    "(not(unix",
    "(not(windows",
    "target_os",
    "target_family",
    "target_arch",
    "web_sys::",
    "js_sys::",
    "wasm_bindgen",
    "std::os::",
    "rustix::",
    "signal_hook::",
    "ctrlc::",
    "win32console::",
    "/proc/",
    "/dev/",
];

#[test]
fn only_the_platform_folder_queries_the_system() {
    let mut faults = Vec::new();
    let mut in_room = false;
    for source in PACKAGES.map(|package| sources(&repository().join(package).join("src"))) {
        for file in source.into_iter().map(|source| source.file) {
            let text = fs::read_to_string(repository().join(&file)).expect("a source");
            let asking = text.lines().enumerate().filter(|(_, line)| {
                let code = line.split("//").next().unwrap_or_default();
                SYSTEM_QUERIES.iter().any(|word| code.contains(word))
            });
            let places: Vec<_> = asking
                .map(|(index, line)| format!("{file}:{}: {}", index + 1, line.trim()))
                .collect();
            let file = file.replace('\\', "/");
            match file.starts_with(PLATFORM_FOLDER) || PAGE_FILES.contains(&file.as_str()) {
                true => in_room |= !places.is_empty(),
                false => faults.extend(places),
            }
        }
    }
    assert!(in_room, "{PLATFORM_FOLDER} asks nothing: has it moved?");
    assert!(
        faults.is_empty(),
        "belongs into {PLATFORM_FOLDER}:\n{}",
        faults.join("\n")
    );
}

/// Folders that also run on a page in a browser.
const PAGE_FOLDERS: [&str; 9] = [
    "host/src/files/",
    "host/src/input_watch.rs",
    "host/src/job.rs",
    "host/src/kernel/",
    "host/src/loading.rs",
    "host/src/retained/",
    "host/src/preview/",
    "host/src/transfer/",
    "window/src/",
];
/// Except boards, which a page does not have.
const BOARD_FILES: [&str; 2] = [
    "host/src/kernel/drive.rs",
    "host/src/kernel/headless_board.rs",
];
/// Functions that fail on a page at run time.
const UNAVAILABLE_ON_A_PAGE: [&str; 6] = [
    "std::fs",
    "std::thread",
    "std::process::id",
    "std::process::Command",
    "time::Instant",
    "SystemTime",
];

#[test]
fn what_runs_on_a_page_has_files_threads_and_clock_from_the_platform() {
    let mut faults = Vec::new();
    let mut seen = BTreeSet::new();
    let packages =
        ["host", "window"].map(|package| sources(&repository().join(package).join("src")));
    for source in packages.into_iter().flatten() {
        let file = source.file.replace('\\', "/");
        let Some(room) = PAGE_FOLDERS.iter().find(|room| file.starts_with(*room)) else {
            continue;
        };
        seen.insert(room);
        // `files/time.rs` formats moments for the log of a board.
        if BOARD_FILES.contains(&file.as_str())
            || file.ends_with("/tests.rs")
            || file.ends_with("/time.rs")
        {
            continue;
        }
        let text = fs::read_to_string(repository().join(&source.file)).expect("a source");
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let asking = code.lines().enumerate().filter(|(_, line)| {
            let code = line.split("//").next().unwrap_or_default();
            let web = code.replace("web_time::Instant", "");
            UNAVAILABLE_ON_A_PAGE.iter().any(|word| web.contains(word))
        });
        faults.extend(asking.map(|(at, line)| format!("{file}:{}: {}", at + 1, line.trim())));
    }
    assert_eq!(seen.len(), PAGE_FOLDERS.len(), "a room has moved: {seen:?}");
    assert!(faults.is_empty(), "fails on a page:\n{}", faults.join("\n"));
}
