//! The commands `ladder find`, `print` and `parameters`.

use super::{TempFile, run_gsk};

#[test]
fn a_ladder_is_searched_as_in_the_manual() {
    // 000:12995-12997.
    let (code, out, _) = run_gsk(&["ladder", "find", "G8.4", "--lang", "zh"]);
    assert_eq!(code, 0);
    assert!(out.contains("找到第 1 项：[行(1) 列(2)]"), "{out}");
    assert!(out.contains("查找 G0008.4 完毕：共找到 5 项结果"), "{out}");
    let (code, out, _) = run_gsk(&["ladder", "find", "K7.7"]);
    assert_eq!(code, 1);
    assert_eq!(out, "K0007.7: 0 match(es)\n");
    let rows = |arguments: &[&str]| {
        let (_, out, _) = run_gsk(&[&["ladder", "find", "TMRB"], arguments].concat());
        let rows = out.lines().filter_map(|line| {
            let row = line.split("row ").nth(1)?.split(' ').next()?;
            row.parse::<u32>().ok()
        });
        rows.collect::<Vec<_>>()
    };
    let all = rows(&[]);
    assert!(all.len() > 5 && all.is_sorted());
    let middle = all[all.len() / 2].to_string();
    let down = rows(&["--direction", "down", "--from", &middle]);
    let up = rows(&["--direction", "up", "--from", &middle]);
    assert!(up.is_sorted_by(|a, b| a >= b) && up.first() == down.first());
    assert!(up.len() < all.len() && down.len() < all.len());
}

#[test]
fn a_ladder_is_printed_and_its_parameters_are_listed() {
    let page = TempFile::new("ladder.html", b"");
    let (code, _, err) = run_gsk(&["ladder", "print", "-o", page.path(), "--lang", "zh"]);
    assert_eq!(code, 0, "{err}");
    let text = std::fs::read_to_string(page.path()).unwrap();
    assert!(text.contains("<svg") && text.contains("急停") && text.ends_with("</html>\n"));
    let (code, _, err) = run_gsk(&["ladder", "print", "-o", "ladder.pdf"]);
    assert_eq!(code, 2);
    assert!(err.contains(".html"), "{err}");
    let (code, out, _) = run_gsk(&["ladder", "parameters"]);
    assert_eq!(code, 0);
    let line = out.lines().find(|line| line.starts_with("DT0005"));
    let line = line.unwrap_or_else(|| panic!("{out}"));
    assert!(line.contains("500") && line.contains("P080") && line.contains("M time"));
    let broken = TempFile::new("broken.il", b"END1\nLD X0.0\nEND2\nOUT");
    for command in ["parameters", "find"] {
        let arguments = match command {
            "find" => vec!["ladder", "find", "X0.0", broken.path()],
            _ => vec!["ladder", command, broken.path()],
        };
        let (code, _, err) = run_gsk(&arguments);
        assert_eq!(code, 1);
        assert!(err.contains("E0"), "{err}");
    }
}
