//! Properties of generated and arbitrary texts.

use proptest::prelude::*;

use super::super::*;
use crate::memory::ControlParameters;

#[derive(Debug, PartialEq)]
struct BlockMeaning {
    n: Option<u32>,
    o: Option<u16>,
    skip: bool,
    words: Vec<(u8, WordNumber)>,
}

fn without_spans(block: &ProgramBlock) -> BlockMeaning {
    let words = block.words().iter();
    BlockMeaning {
        n: block.n,
        o: block.o,
        skip: block.skip,
        words: words.map(|word| (word.address, word.value)).collect(),
    }
}

fn number_text(address: char) -> BoxedStrategy<String> {
    match address {
        'G' => prop::sample::select(vec![0, 1, 2, 3, 4, 28, 32, 50, 71, 76, 92, 97])
            .prop_map(|code: u8| format!("{code:02}"))
            .boxed(),
        'H' | 'L' | 'M' => (1..=99_u8).prop_map(|code| code.to_string()).boxed(),
        'T' => (0..=32_u8, 0..=32_u8)
            .prop_map(|(t, o)| format!("{t}{o:02}"))
            .boxed(),
        'S' | 'N' | 'O' => "[0-9]{1,4}".boxed(),
        'P' | 'Q' => "-?[0-9]{1,7}".boxed(),
        'F' => "0{0,2}[1-9][0-9]{0,3}(\\.[0-9]{0,3})?".boxed(),
        _ => "[+-]?(0{0,2}[0-9]{1,4}(\\.[0-9]{0,3})?|\\.[0-9]{1,3}|#[0-9]{1,4})".boxed(),
    }
}

/// A valid block with blanks, comments, lower case and full-width letters.
fn block_text() -> impl Strategy<Value = String> {
    let letters = prop::sample::subsequence("NFGHKMPQRSTUWXZ".chars().collect::<Vec<_>>(), 0..=10);
    let gap = prop::sample::select(vec!["", " ", "\t", "(车;*)", "（外圆）", "　"]);
    let words = letters.prop_shuffle().prop_flat_map(|letters| {
        letters
            .into_iter()
            .map(|letter| (Just(letter), number_text(letter), 0..3_u8))
            .collect::<Vec<_>>()
    });
    let end = prop::sample::select(vec!["", ";", "*", "；", "\r\n"]);
    (any::<bool>(), words, gap, end).prop_map(|(skip, words, gap, end)| {
        let mut text = String::from(if skip { "/" } else { "" });
        for (letter, number, style) in words {
            text.push(match style {
                0 => letter,
                1 => letter.to_ascii_lowercase(),
                _ => char::from_u32(letter as u32 - 0x21 + 0xFF01).unwrap_or(letter),
            });
            text.push_str(&number);
            text.push_str(gap);
        }
        text + end
    })
}

/// Texts that resemble programs, with all kinds of errors.
fn messy_text() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        block_text(),
        "[-+.#/%;*()0-9A-Za-z \\r\\n]{0,12}",
        "\\PC{0,6}",
        prop::sample::select(vec![
            "\n", "\r", "\r\n", ";", "%", "（", "）", "％", "；", "\u{feff}", "O12", "N10"
        ])
        .prop_map(str::to_string),
    ];
    prop::collection::vec(piece, 0..12).prop_map(|pieces| pieces.concat())
}

fn file_lines(text: &str) -> Vec<String> {
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    text.lines().map(str::to_string).collect()
}

proptest! {
    /// A tab before a block makes the general parser read it, not `PlainWords`: the results
    /// must be equal.
    #[test]
    fn plain_words_are_read_as_all_others(
        text in prop_oneof![
            block_text(),
            "[GXZUWRF/N]{0,2}[A-Z0-9.+#;/ ()-]{0,24}",
            "(N?[0-9]{0,5} ?)(G[0-9]{1,3} ?){0,2}([XZUWFRIKMST]-?[0-9]{0,5}\\.?[0-9]{0,4} ?){0,5}[;*（.#]?\r?\n?",
        ],
        point_required in any::<bool>(),
        inch in any::<bool>(),
    ) {
        let syntax = Syntax { point_required, inch, ..Syntax::default() };
        // A block that begins with a variable has a separate message.
        prop_assume!(!text.trim_start().starts_with('#'));
        let after_tab = format!("\t{text}");
        match (parse_block(&text, syntax), parse_block(&after_tab, syntax)) {
            (Ok(plain), Ok(whole)) => {
                prop_assert_eq!(without_spans(&plain), without_spans(&whole));
                for (plain, whole) in plain.words().iter().zip(whole.words()) {
                    prop_assert_eq!((plain.span.0 + 1, plain.span.1 + 1), whole.span);
                }
            }
            (Err(plain), Err(whole)) => {
                prop_assert_eq!((plain.alarm, plain.column + 1), (whole.alarm, whole.column));
                prop_assert_eq!(plain.detail, whole.detail);
            }
            (plain, whole) => prop_assert!(false, "{:?} {:?}", plain, whole),
        }
    }

    #[test]
    fn parse_print_parse(text in block_text()) {
        let block = parse_block(&text, Syntax::default())
            .map_err(|error| TestCaseError::fail(format!("{text}: {error}")))?;
        let print = block.to_string();
        let again = parse_block(&print, Syntax::default()).unwrap();
        prop_assert_eq!(without_spans(&block), without_spans(&again), "{}", print);
        prop_assert_eq!(&print, &again.to_string());
    }

    #[test]
    fn whatever_can_be_read_reads_back(text in messy_text()) {
        if let Ok(block) = parse_block(&text, Syntax::default()) {
            let print = block.to_string();
            let again = parse_block(&print, Syntax::default()).unwrap();
            prop_assert_eq!(without_spans(&block), without_spans(&again), "{}", print);
        }
    }

    #[test]
    fn no_text_breaks_a_program(text in messy_text()) {
        let program = Program::new(text.as_str());
        let lines = file_lines(&text);
        prop_assert_eq!(program.line_count() as usize, lines.len());
        for (number, line) in (1..).zip(&lines) {
            prop_assert_eq!(program.line(number), line.as_str());
        }
        let mut last = 1;
        for index in 0..program.block_count() {
            let line = program.block_line(index);
            prop_assert!(line >= last && line <= program.line_count());
            prop_assert!(program.block_from_line(line) <= index);
            last = line;
            let start = program.block(index).trim_start();
            if let Ok(block) = program.parse_with_variables(index, Syntax::default()) {
                let something = !block.is_empty() || block.n.is_some() || block.o.is_some() || block.skip;
                let mark = start.starts_with([';', '*', '；', '＊', '\u{feff}', '%']);
                prop_assert!(something || mark, "block {} {:?}", index, start);
            }
        }
        let parts = split_programs(&text);
        let blocks: u32 = parts.iter().map(Program::block_count).sum();
        prop_assert_eq!(blocks, program.block_count());
        prop_assert_eq!(program.renumbered(77).number(), Some(77));
        let stored = ron::to_string(&program).unwrap();
        prop_assert_eq!(&ron::from_str::<Program>(&stored).unwrap(), &program);
    }

    #[test]
    fn no_text_breaks_the_mdi_block(words in prop::collection::vec(messy_text(), 0..4)) {
        let parameters = ControlParameters::default();
        let mut mdi = MdiBlock::default();
        for word in words {
            let _ = mdi.enter(&word, &parameters, false);
            prop_assert!(mdi.block(&parameters).is_ok(), "{:?}", mdi);
        }
    }

    #[test]
    fn any_characters_at_all(text in any::<String>()) {
        let program = Program::new(text.as_str());
        for index in 0..program.block_count() {
            let _ = program.parse(index, Syntax::default());
        }
        let _ = parse_block(&text, Syntax { point_required: true, ..Syntax::default() });
    }
}
