//! Tests the errors and warnings of the compiler with their lines and rules, and that
//! random text never makes it panic.

use std::sync::Arc;

use gsk_plc::{INSTRUCTIONS, Ladder, Plc, PlcAddress, Rule};
use proptest::prelude::*;

/// Returns rule and line of every error; without errors, those of every warning.
fn findings(source: &str) -> Vec<(Rule, u32)> {
    let found = match Ladder::compile(source) {
        Ok(ladder) => ladder.warnings().to_vec(),
        Err(errors) => errors.errors,
    };
    found.iter().map(|error| (error.code, error.line)).collect()
}

/// Returns a program with the rungs in level 2. Line 1 is END1; the rungs start in line 2.
fn level2(rungs: &str) -> String {
    format!("END1\n{rungs}\nEND2")
}

#[test]
fn one_statement_rules() {
    // Rung lines from line 2, expected rule, expected line.
    let table: &[(&str, Rule, u32)] = &[
        ("FOO R1.0", Rule::E00, 2),
        ("ADDB 1 R1 R2 R3", Rule::E00, 2),
        (".NOTE \"x\"", Rule::E00, 2),
        (".NET \"no end", Rule::E00, 2),
        (".OPT fast", Rule::E00, 2),
        ("OUT R1.0", Rule::E02, 2),
        ("AND R1.0\nOUT R1.0", Rule::E02, 2),
        ("LD R1.0\nORB\nOUT R1.0", Rule::E02, 3),
        ("LD R1.0\nLD R1.1\nOUT R1.2", Rule::E02, 4),
        ("LD R1.0\nOUT R1.1\nAND R1.2\nOUT R1.3", Rule::E02, 4),
        ("LD R1.0\nOUT R1.1\nANB\nOUT R1.3", Rule::E02, 4),
        ("LD D1.0\nOUT R1.0", Rule::E03, 2),
        ("LD R1\nOUT R1.0", Rule::E03, 2),
        ("LD X30.0\nOUT R1.0", Rule::E03, 2),
        ("LD X1.8\nOUT R1.0", Rule::E03, 2),
        ("LD R1.0\nOUT X1.0", Rule::E03, 3),
        ("LD R1.0\nSET F1.0", Rule::E03, 3),
        ("LD R1.0\nOUT R900.0", Rule::E03, 3),
        ("LD R1.0\nRST K30.7", Rule::E03, 3),
        ("LD R1.0\nCMP 1 5 R1.1 R2.0", Rule::E03, 3),
        ("LD R1.0\nCMP 1 5 3 R2.6", Rule::E03, 3),
        ("LD R1.0\nCMP 1 256 3 R2.0", Rule::E03, 3),
        ("LD R1.0\nCMP 3 5 3 R2.0", Rule::E06, 3),
        ("LD R1.0\nCMP 1 5 3", Rule::E06, 3),
        ("LD R1.0\nMOVN 1 5 X1", Rule::E03, 3),
        ("LD R1.0\nMOVN 1 5 7", Rule::E03, 3),
        ("LD R1.0\nMOVN 2 5 R999", Rule::E03, 3),
        ("LD R1.0\nMOVN 4 5 R897", Rule::E03, 3),
        ("LD R1.0\nMOVN 4 5 D997", Rule::E03, 3),
        ("LD R1.0\nMOVN 4 4294967296 D0", Rule::E03, 3),
        ("LD R1.0\nTMRB T100 5 R1.1", Rule::E03, 3),
        ("LD R1.0\nTMRB C1 5 R1.1", Rule::E03, 3),
        ("LD R1.0\nTMRB T1 DC5 R1.1", Rule::E03, 3),
        ("LD R1.0\nCTRC 0100 R1.0 C1 5 R1.1", Rule::E03, 3),
        ("LD R1.0\nCTRC 02 R1.0 C1 5 R1.1", Rule::E03, 3),
        ("LD R1.0\nDECB 1 F1 0 F2", Rule::E03, 3),
        ("LD R1.0\nCODB 1 9 F1 R2 , 1 2", Rule::E06, 3),
        ("LD R1.0\nCODB 1 1 F1 R2 , 1 2 3", Rule::E06, 3),
        ("LD R1.0\nCODB 1 1 F1 R2", Rule::E06, 3),
        ("LD R1.0\nCODB 1 1 F1 R2 , 1 300", Rule::E03, 3),
        ("LD R1.0\nCODB 1 1 F1 X2 , 1 3", Rule::E03, 3),
        ("LD R1.0\nROTB 1111 0 1 R1 R2 R3 R4.0", Rule::E03, 3),
        ("LD R1.0 , 5\nOUT R1.0", Rule::E06, 2),
        ("LD R1.0\nJMPB 5", Rule::E03, 3),
        ("LD R1.0\nJMPB L10000", Rule::E03, 3),
        (".MSG R0.0 1000 \"x\"", Rule::E03, 2),
        (".MSG A0.0 999 \"x\"", Rule::E03, 2),
        (".MSG A0.0 1000 \"x\"\n.MSG A0.0 1001 \"y\"", Rule::E04, 3),
        (".CMT Q1 \"x\" \"y\"", Rule::E03, 2),
        (
            ".CMT R1 \"一二三四五六七八九十一二三四五六\" \"y\"",
            Rule::E03,
            2,
        ),
        (".INIT R1 5", Rule::E03, 2),
        (".INIT K1 256", Rule::E03, 2),
        (".INIT K1", Rule::E00, 2),
    ];
    for (rungs, rule, line) in table {
        assert_eq!(findings(&level2(rungs)), [(*rule, *line)], "{rungs}");
    }
}

#[test]
fn rules_of_the_whole_program() {
    let long_level1 = |rungs| format!("{}END1\nEND2", "LD R1.0\nSET R1.1\n".repeat(rungs));
    let deep: String = (1..=9)
        .map(|n| format!("SP P{n}\nLD R1.0\nCALL P{}\nSPE\n", n + 1))
        .collect();
    let deep = format!("END1\nLD R1.0\nCALL P1\nEND2\n{deep}SP P10\nSPE");
    let branches = "LD R1.0\n".repeat(17) + &"ORB\n".repeat(15) + "OUT R1.0";
    let table: Vec<(String, Vec<(Rule, u32)>)> = vec![
        (String::new(), vec![(Rule::E01, 1), (Rule::E01, 1)]),
        ("END2".to_owned(), vec![(Rule::E01, 1)]),
        ("END1\nEND1\nEND2".to_owned(), vec![(Rule::E01, 2)]),
        ("END1\nEND2\nEND2".to_owned(), vec![(Rule::E01, 3)]),
        (
            "END2\nEND1".to_owned(),
            vec![(Rule::E01, 2), (Rule::E01, 2)],
        ),
        (
            "END1\nEND2\nLD R1.0\nOUT R1.1".to_owned(),
            vec![(Rule::E01, 3)],
        ),
        (level2(&branches), vec![(Rule::E02, 18)]),
        (
            level2("LBL L1\nLBL L1\nLD R1.0\nJMPB L1"),
            vec![(Rule::E04, 3)],
        ),
        (
            level2("LD R1.0\nTMRB T1 5 R1.1\nLD R1.0\nTMRB T1 5 R1.2"),
            vec![(Rule::E04, 5)],
        ),
        (level2("LD R1.0\nJMPB L1"), vec![(Rule::E04, 3)]),
        (level2("LD R1.0\nCALL P1"), vec![(Rule::E04, 3)]),
        (
            "END1\nEND2\nSP P1\nSPE\nSP P1\nSPE".to_owned(),
            vec![(Rule::E04, 5)],
        ),
        (
            "LD R1.0\nJMPB L1\nEND1\nLBL L1\nEND2".to_owned(),
            vec![(Rule::E05, 2)],
        ),
        (
            "END1\nLBL L1\nEND2\nSP P1\nLD R1.0\nJMPB L1\nSPE".to_owned(),
            vec![(Rule::E05, 6)],
        ),
        (
            "LD R1.0\nCALL P1\nEND1\nEND2\nSP P1\nSPE".to_owned(),
            vec![(Rule::E05, 2)],
        ),
        ("END1\nSP P1\nEND2".to_owned(), vec![(Rule::E05, 2)]),
        ("END1\nEND2\nSP P1".to_owned(), vec![(Rule::E05, 3)]),
        ("END1\nSPE\nEND2".to_owned(), vec![(Rule::E05, 2)]),
        (
            "END1\nEND2\nSP P1\nLD R1.0\nCALL P1\nSPE".to_owned(),
            vec![(Rule::E05, 5)],
        ),
        (deep, vec![(Rule::E05, 35)]),
        (
            level2(&"LD R1.0\nSET R1.1\n".repeat(2500)),
            vec![(Rule::E07, 5003)],
        ),
        (long_level1(250), vec![(Rule::E07, 501)]),
        (long_level1(249), vec![(Rule::W04, 499)]),
        (long_level1(199), vec![]),
        (
            level2("LD R1.0\nOUT R1.1\nLD R1.2\nOUT R1.1"),
            vec![(Rule::W01, 5)],
        ),
        (level2("LBL L7"), vec![(Rule::W02, 2)]),
        (
            level2("LD R1.0\nOUT R1.1\nLD R1.2\nAND R1.3"),
            vec![(Rule::W03, 5)],
        ),
    ];
    for (source, expected) in table {
        assert_eq!(findings(&source), expected, "{source}");
    }
}

#[test]
fn errors_give_line_rung_and_reason() {
    let errors = Ladder::compile("END1\nLD R1.0\nOUT X1.0\nEND2").unwrap_err();
    let error = &errors.errors[0];
    assert_eq!((error.line, error.rung), (3, 2));
    assert_eq!(
        errors.to_string(),
        "line 3, rung 2: E03 X1.0: OUT writes bits of Y, G, R, K and A; X is read only\n\
         编译失败: 1 错误, 0 警告."
    );
}

#[test]
fn directives_and_listing() {
    let source = "
        .unit \"U\"   ; header
        .AUTHOR \"A;B\"
        .VERSION \"V\"
        .REMARK \"R\"
        .OPT n1
        .CMT X0.5 \"急停\" \"E-stop\"
        .CMT DT5 \"时间\" \"Time\"
        .MSG A1.0 1009 \"b\"
        .MSG A0.0 1000 \"a\"
        .INIT DT5 700
        .INIT K12 3
        .NET \"first\"
        ld x0.5
        out g8.4 ; coil
        end1
        .NET \"second\"
        LDI X0.5
        CODB 1 1 R1 R2,5 6
        LD X0.5
        CTRC 0010 R10.7 C0 DC3 R24.0
        JMPB L7
        LBL L0007
        END2";
    let ladder = Ladder::compile(source).unwrap();
    assert_eq!(ladder.header().author, "A;B");
    let messages: Vec<_> = ladder.messages().iter().map(|m| m.number).collect();
    assert_eq!(messages, [1000, 1009]);
    let subject = PlcAddress::Bit("X0.5".parse().unwrap());
    assert_eq!(ladder.comment(subject).unwrap().english, "E-stop");
    assert_eq!(ladder.labels().collect::<Vec<_>>(), [(7, 5)]);
    let titles: Vec<_> = ladder.rungs().map(|rung| rung.title).collect();
    assert_eq!(titles[..3], [Some("first"), None, Some("second")]);
    assert_eq!(ladder.rung_count(), 6);

    let listing = ladder.to_source();
    assert!(
        listing.contains("LD X0000.5               ; E-stop"),
        "{listing}"
    );
    assert!(
        listing.contains("CTRC 0010 R0010.7 C0000 DC0003 R0024.0"),
        "{listing}"
    );
    let again = Ladder::compile(&listing).unwrap();
    assert_eq!(again.to_source(), listing);
    assert_eq!(again.steps(), ladder.steps());

    let mut plc = Plc::new(Arc::new(ladder));
    assert_eq!((plc.memory().dt(5), plc.memory().k(12)), (700, 3));
    plc.memory_mut().set_a(1, 1);
    let active: Vec<_> = plc.active_messages().collect();
    assert_eq!(active, [(1009, "b")]);
}

/// Generates words of the language, and some that are invalid.
fn word() -> impl Strategy<Value = String> {
    let names: Vec<&'static str> = INSTRUCTIONS.iter().map(|row| row.name).collect();
    prop_oneof![
        4 => prop::sample::select(names).prop_map(str::to_owned),
        3 => "[XYFGRKADTC]{1,2}[0-9]{1,3}(\\.[0-8])?",
        2 => "[0-9]{1,11}",
        1 => "[LP][0-9]{1,4}",
        1 => prop::sample::select(vec![",", ";", "\"", ".NET", ".MSG", ".INIT", ".CMT", ".OPT"])
            .prop_map(str::to_owned),
        2 => Just("\n".to_owned()),
    ]
}

/// Generates a rung that is valid anywhere in level 2.
fn legal_rung() -> impl Strategy<Value = String> {
    let any_bit = || {
        prop_oneof![
            "X[12]?[0-9]\\.[0-7]",
            "F[12]?[0-9]\\.[0-7]",
            "R[1-8]?[0-9]{1,2}\\.[0-7]",
            "K[12][0-9]\\.[0-7]"
        ]
    };
    let coil = || {
        prop_oneof![
            "Y1?[0-9]\\.[0-7]",
            "G1?[0-9]{1,2}\\.[0-7]",
            "R[1-8]?[0-9]{1,2}\\.[0-7]"
        ]
    };
    let word = || {
        prop_oneof![
            "R[1-7]?[0-9]{1,2}",
            "D[1-7]?[0-9]{1,2}",
            "(T|C|DC|DT)[0-9]{1,2}",
            "G1?[0-9]{1,2}"
        ]
    };
    let length = || prop::sample::select(vec![1, 2, 4]);
    let digit = || 0..2u8;
    let output = prop_oneof![
        coil().prop_map(|bit| format!("OUT {bit}")),
        coil().prop_map(|bit| format!("SET {bit}")),
        coil().prop_map(|bit| format!("RST {bit}")),
        (length(), word(), word(), 0..6u8, 0..500u16)
            .prop_map(|(length, a, b, bit, byte)| format!("CMP {length} {a} {b} R{byte}.{bit}")),
        (length(), word(), word()).prop_map(|(n, a, b)| format!("MOVN {n} {a} {b}")),
        (
            length(),
            word(),
            any::<i32>().prop_map(|n| n & i32::MAX),
            0..800u16
        )
            .prop_map(|(n, a, base, to)| format!("DECB {n} {a} {base} R{to}")),
        (0..255u8, 0..255u8, 0..800u16)
            .prop_map(|(a, b, at)| { format!("CODB 1 1 R{at} D{at} , {a} {b}") }),
        (digit(), digit(), 0..99u8, 0..99u8, coil())
            .prop_map(|(a, b, c, dc, bit)| format!("CTRC 00{a}{b} X0.0 C{c} DC{dc} {bit}")),
        (0..16u8, 1..40u8, length(), 0..900u16, 0..800u16, coil()).prop_map(
            |(format, stations, n, at, to, bit)| {
                format!("ROTB {format:04b} {stations} {n} D{at} R{to} D{to} {bit}")
            }
        ),
    ];
    (prop::collection::vec(any_bit(), 1..4), output).prop_map(|(bits, output)| {
        let mut rung = format!("LD {}\n", bits[0]);
        for (index, bit) in bits[1..].iter().enumerate() {
            let contact = ["ANI", "ORI", "OR"][index % 3];
            rung.push_str(&format!("{contact} {bit}\n"));
        }
        rung + &output + "\n"
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn no_text_panics_the_compiler(source in "\\PC{0,200}") {
        let _ = Ladder::compile(&source);
    }

    #[test]
    fn no_words_panic_the_compiler_or_the_scan(words in prop::collection::vec(word(), 0..80)) {
        let source = words.join(" ");
        if let Ok(ladder) = Ladder::compile(&source) {
            let listing = ladder.to_source();
            prop_assert_eq!(Ladder::compile(&listing).unwrap().to_source(), listing);
            let mut plc = Plc::new(Arc::new(ladder));
            plc.run_slot();
        }
    }

    #[test]
    fn legal_programs_scan_and_print(
        rungs in prop::collection::vec(legal_rung(), 1..60),
        inputs in prop::collection::vec(any::<u8>(), 30),
        timer in 0..100u8,
    ) {
        let timed = format!("LD X0.1\nTMRB T{timer} DT{timer} R899.0\nLBL L1\n");
        let source = format!(
            "{}END1\n{timed}{}LD X0.2\nJMPB L1\nLD X0.3\nCALL P1\nEND2\nSP P1\n{}SPE",
            rungs[0], rungs.concat(), rungs[0],
        );
        let ladder = Ladder::compile(&source).map_err(|errors| TestCaseError::fail(errors.to_string()))?;
        let listing = ladder.to_source();
        prop_assert_eq!(Ladder::compile(&listing).unwrap().to_source(), listing);
        let mut plc = Plc::new(Arc::new(ladder));
        for (byte, value) in (0..).zip(inputs) {
            plc.memory_mut().set_x(byte, value);
            plc.run_slot();
        }
    }
}
