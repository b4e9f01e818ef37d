//! The words around the panel, in Chinese and English. The panel itself is
//! always as printed.

use crate::cli::Language;

/// A word or sentence of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Text {
    /// Open a program.
    Open,
    /// Menu of the last programs.
    Recent,
    /// No last programs yet.
    RecentEmpty,
    /// Reload the opened program.
    Reload,
    /// Menu of the views.
    Views,
    /// The scope.
    Scope,
    /// The fault bench.
    Bench,
    /// The ladder.
    Ladder,
    /// The link page.
    Link,
    /// PC keys.
    Keys,
    /// The other language.
    Language,
    /// Name of the LCD for screen readers.
    Lcd,
    /// Name of the handwheel.
    Handwheel,
    /// What the handwheel takes.
    HandwheelHint,
    /// Title of the key map.
    KeysTitle,
    /// Letters, digits and signs of the PC.
    KeysCharacters,
    /// How one mouse presses two keys.
    KeysLatch,
    /// The keys that turn the handwheel.
    KeysWheel,
    /// How to leave the key map.
    KeysClose,
    /// Heading: key of the panel.
    PanelKey,
    /// Heading: key of the PC.
    PcKey,
    /// Filter of the file dialog.
    Programs,
    /// Filter of the file dialog.
    AllFiles,
    /// In front of what the control has sent.
    Sent,
    /// Drop here.
    DropHere,
    /// The PC is too slow.
    Slow,
    /// The kernel has stopped.
    KernelGone,
    /// A program was opened.
    Opened,
    /// No file was chosen.
    NothingChosen,
    /// Hint on an empty status line.
    Hint,
    /// Hint while real slides want their reference return.
    ReturnHint,
    /// Lamp lit, for screen readers.
    Lit,
    /// Lamp dark, for screen readers.
    Dark,
    /// The e-stop is pressed: how to release it.
    EmergencyHint,
}

impl Text {
    /// The words in a language.
    pub const fn of(self, language: Language) -> &'static str {
        let (zh, en) = self.both();
        match language {
            Language::Zh => zh,
            Language::En => en,
        }
    }

    const fn both(self) -> (&'static str, &'static str) {
        match self {
            Self::Open => ("打开程序…", "Open program…"),
            Self::Recent => ("最近文件", "Recent"),
            Self::RecentEmpty => ("(无)", "(none)"),
            Self::Reload => ("重新读入", "Reload"),
            Self::Views => ("视图", "Views"),
            Self::Scope => ("示波器", "Scope"),
            Self::Bench => ("故障台", "Fault bench"),
            Self::Ladder => ("梯形图", "Ladder"),
            Self::Link => ("驱动板", "Pulse board"),
            Self::Keys => ("键盘 F1", "Keys F1"),
            Self::Language => ("English", "中文"),
            Self::Lcd => ("显示屏", "LCD"),
            Self::Handwheel => ("手轮", "Handwheel"),
            Self::HandwheelHint => (
                "滚动、拖动或按 [ ] 键转动手轮;Shift 加 [ ] 一次十格",
                "Scroll, drag or press [ ] to turn the handwheel; ten with Shift",
            ),
            Self::KeysTitle => ("电脑键盘与面板按键", "PC keyboard and panel keys"),
            Self::KeysCharacters => (
                "字母、数字和符号: 按面板所印; 复合键的第二个字符 (D Q C Y #) 直接键入",
                "Letters, digits and signs: as printed on the panel; the second character of a \
                 compound key (D Q C Y #) is typed directly",
            ),
            Self::KeysLatch => (
                "右键单击面板按键: 按住不放, 再次单击松开 (例如 取消+复位)",
                "A right click on a panel key holds it down until the next one (for instance \
                 CAN while RESET is pressed)",
            ),
            Self::KeysWheel => (
                "[ 和 ]: 手轮一格; 加 Shift 十格",
                "[ and ]: the handwheel by one graduation; with Shift by ten",
            ),
            Self::KeysClose => ("再按 F1 关闭", "F1 closes this"),
            Self::PanelKey => ("面板按键", "Panel key"),
            Self::PcKey => ("电脑按键", "PC key"),
            Self::Programs => ("零件程序", "Part programs"),
            Self::AllFiles => ("所有文件", "All files"),
            Self::Sent => ("已输出", "Sent"),
            Self::DropHere => ("松开鼠标以打开程序", "Drop to open the program"),
            Self::Slow => (
                "电脑速度不足, 机床时间变慢",
                "The PC is too slow: machine time runs at",
            ),
            Self::KernelGone => (
                "控制内核已停止, 请重新启动程序",
                "The control has stopped: restart the program",
            ),
            Self::Opened => ("已打开", "Opened"),
            Self::NothingChosen => (
                "没有选择文件;也可以把文件拖进窗口",
                "no file was chosen; a file can also be dropped on the window",
            ),
            Self::Hint => (
                "打开程序, 按 [自动] 再按 [运行]",
                "Open a program, press [自动] AUTO, then [运行] START",
            ),
            Self::ReturnHint => (
                "滑板的位置未知: 按 [机械零点], 再按 X、Z 轴的方向键返回机械零点",
                "Nobody knows where the slides stand: press [机械零点] machine zero, then the keys \
                 of X and Z",
            ),
            Self::Lit => ("亮", "on"),
            Self::Dark => ("灭", "off"),
            Self::EmergencyHint => (
                "急停已按下, 再按一次旋开",
                "Emergency stop is pressed; press it again to release",
            ),
        }
    }
}

/// One of two sentences, for words that a view alone needs.
pub const fn say(language: Language, zh: &'static str, en: &'static str) -> &'static str {
    match language {
        Language::Zh => zh,
        Language::En => en,
    }
}
