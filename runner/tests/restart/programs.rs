//! The programs of the restart test: cycles, threads, subprograms, nose radius, macros.

/// A program and its subprograms.
pub struct TestProgram {
    pub name: &'static str,
    pub text: &'static str,
    pub subprograms: &'static [&'static str],
    pub macro_b: bool,
}

const fn plain(name: &'static str, text: &'static str) -> TestProgram {
    TestProgram {
        name,
        text,
        subprograms: &[],
        macro_b: false,
    }
}

const fn with_subprograms(
    name: &'static str,
    text: &'static str,
    subprograms: &'static [&'static str],
) -> TestProgram {
    TestProgram {
        name,
        text,
        subprograms,
        macro_b: false,
    }
}

const fn with_macro_b(
    name: &'static str,
    text: &'static str,
    subprograms: &'static [&'static str],
) -> TestProgram {
    TestProgram {
        name,
        text,
        subprograms,
        macro_b: true,
    }
}

const SAMPLE_1: &str = include_str!("../../../assets/programs/01-stepped-shaft.CNC");
const SAMPLE_2: &str = include_str!("../../../assets/programs/02-bushing.CNC");
const SAMPLE_3: &str = include_str!("../../../assets/programs/03-grooved-pin.CNC");
const SAMPLE_4: &str = include_str!("../../../assets/programs/04-manual-example.CNC");
const GROOVE: &str = include_str!("../../../assets/programs/O1031.CNC");

pub const PROGRAMS: [TestProgram; 20] = [
    plain("shaft", SAMPLE_1),
    plain("bushing", SAMPLE_2),
    with_subprograms("pin", SAMPLE_3, &[GROOVE]),
    plain("manual example", SAMPLE_4),
    plain(
        "G71 G70",
        "G50 X100 Z100;\nG97 G98 S800 M03;\nT0101 M08;\nG00 X52 Z2;\nG71 U2 R0.5 F300;\nG71 P10 Q20 U0.4 W0.1;\nN10 G00 X20;\nG01 Z-10 F150;\nX30 Z-15;\nZ-25;\nG02 X40 Z-30 R5;\nN20 G01 X52;\nT0202;\nG70 P10 Q20;\nG00 X100 Z100 M09;\nM30;\n",
    ),
    plain(
        "G72 G70",
        "G50 X100 Z100;\nG97 G98 S600 M03;\nT0101;\nG00 X52 Z2;\nG72 W2 R0.5 F300;\nG72 P10 Q20 U0.2 W0.2;\nN10 G00 Z-20;\nG01 X40 F150;\nZ-10;\nX30 Z-5;\nN20 Z2;\nG70 P10 Q20;\nG00 X100 Z100;\nM05;\nM30;\n",
    ),
    plain(
        "G73",
        "G50 X100 Z100;\nG97 G98 S600 M03;\nT0101;\nG00 X60 Z10;\nG73 U6 W3 R4;\nG73 P10 Q20 U0.4 W0.1 F400;\nN10 G00 X20 Z1;\nG01 Z-10 F200;\nX30 Z-20;\nN20 X42;\nG70 P10 Q20;\nG00 X100 Z100;\nM30;\n",
    ),
    plain(
        "G74 G75",
        "G50 X100 Z100;\nG97 G98 S500 M03;\nT0303 M08;\nG00 X20 Z2;\nG74 R0.5;\nG74 X10 Z-8 P2000 Q3000 F100;\nG00 X52 Z-15;\nG75 R0.5;\nG75 X40 Z-21 P2000 Q3000 F100;\nG00 X100 Z100;\nM30;\n",
    ),
    plain(
        "G90 G94",
        "G50 X100 Z100;\nG97 G98 S800 M03;\nT0101;\nG00 X52 Z2;\nG90 X46 Z-20 F250;\nX42;\nX38 R-2;\nG00 X52 Z4;\nG94 X20 Z1 F200;\nZ0;\nZ-1 R-1;\nG00 X100 Z100;\nM30;\n",
    ),
    plain(
        "G92 thread",
        "G50 X100 Z100;\nG97 S400 M03;\nT0101;\nG00 X32 Z5;\nG92 X29 Z-20 F1.5;\nX28.6;\nX28.3;\nG00 X100 Z100;\nM30;\n",
    ),
    plain(
        "G76 thread",
        "G50 X100 Z100;\nG97 S400 M03;\nT0101;\nG00 X32 Z5;\nG76 P010060 Q100 R0.05;\nG76 X28 Z-20 P1000 Q300 F1.5;\nG00 X100 Z100;\nM05;\nM30;\n",
    ),
    plain(
        "G32 chain",
        "G50 X100 Z100;\nG97 S300 M03;\nT0101;\nG00 X28 Z5;\nG32 Z-10 F2;\nG32 X32 Z-20;\nG32 Z-25;\nG00 X40;\nZ5;\nX27.5;\nG32 Z-10 F2;\nX31.5 Z-20;\nG00 X40;\nG00 X100 Z100;\nM30;\n",
    ),
    plain(
        "nose radius outside",
        "G50 X100 Z100;\nG97 G98 S700 M03;\nT0101;\nG00 X40 Z5;\nG42 G00 X20 Z2;\nG01 Z-10 F200;\nX30 Z-15;\nG02 X40 Z-20 R5;\nG01 Z-30;\nX52;\nG40 G00 X60 Z5;\nG00 X100 Z100;\nM30;\n",
    ),
    plain(
        "nose radius both sides",
        "G50 X100 Z100;\nG97 G98 S700 M03;\nT0202;\nG00 X40 Z5;\nG42 G01 X24 Z1 F300;\nZ-8 F150;\nG03 X34 Z-13 R5;\nG01 Z-20;\nX44 W-3;\nG40 X56;\nG00 Z5;\nT0303;\nG41 G01 X50 Z-30 F300;\nX30;\nG40 X56 Z-25;\nG00 X100 Z100;\nM30;\n",
    ),
    plain(
        "surface speed",
        "G50 X120 Z100;\nG50 S1500;\nG96 S100 M03;\nG99 T0101;\nG00 X60 Z0;\nG01 X10 F0.3;\nG00 Z2;\nX50;\nG01 Z-20 F0.2;\nX56;\nG97 S500;\nG98;\nG00 Z1;\nX46;\nG01 Z-20 F100;\nX56;\nM05;\nM04 S300;\nG00 Z2;\nG01 X44 F200;\nZ-10;\nX56;\nG00 X120 Z100;\nM30;\n",
    ),
    with_subprograms(
        "nested subprograms",
        "G50 X100 Z100;\nG97 G98 S500 M03;\nT0101;\nG00 X52 Z2;\nM98 P30021;\nG00 X52 Z2;\nM98 P0022;\nG04 X0.3;\nG00 X100 Z100;\nM30;\n",
        &[
            "O0021;\nG00 U-4;\nG01 W-12 F300;\nM98 P20022;\nG00 U6;\nW12;\nU-6;\nM99;\n",
            "O0022;\nG01 U-1 W-1 F200;\nG01 U1 W-1;\nM99;\n",
        ],
    ),
    plain(
        "G65 loop",
        "G50 X100 Z100;\nG97 G98 S600 M03;\nT0101;\nG65 H01 P#200 Q40000;\nG65 H01 P#201 Q0;\nG00 X52 Z2;\nN30 G00 X#200;\nG01 Z-15 F300;\nG00 U2;\nZ2;\nG65 H03 P#200 Q#200 R2000;\nG65 H02 P#201 Q#201 R1;\nG65 H84 P30 Q#201 R4;\nG65 H01 P#500 Q#201;\nG00 X100 Z100;\nM30;\n",
    ),
    with_macro_b(
        "macro B loop",
        "G50 X100 Z100;\nG97 G98 S600 M03;\nT0101;\n#100=44;\n#101=0;\nG00 X52 Z2;\nWHILE [#100 GT 36] DO1;\nG00 X#100;\nG01 Z[-10-#101] F300;\nG00 U2;\nZ2;\n#100=#100-2;\n#101=#101+1;\nEND1;\n#500=#101;\nG00 X100 Z100;\nM30;\n",
        &[],
    ),
    with_macro_b(
        "macro B calls",
        "G50 X100 Z100;\nG97 G98 S600 M03;\nT0101;\nG00 X52 Z2;\nG65 P0031 A46 B12 C2;\nG65 P0031 A42 B8 C3;\nIF [#510 GT 100] GOTO 90;\n#510=#510+1;\nG01 X51 F500;\nN90 G00 X100 Z100;\nM30;\n",
        &[
            "O0031;\n#9=#3;\nWHILE [#9 GT 0] DO1;\nG00 X#1;\nG01 Z-#2 F300;\nG00 U2;\nG00 Z2;\n#1=#1-1;\n#9=#9-1;\nEND1;\n#511=#511+#2;\nM99;\n",
        ],
    ),
    plain(
        "increments and a second zero",
        "G50 X100 Z100;\nG97 G98 S500 M03;\nT0101;\nG00 U-46 W-98;\nG01 W-10 F250;\nU4 W-4;\nG00 U2;\nW14;\nG50 X40 Z0;\nG01 X36 F200;\nZ-6;\nG00 X44 Z2;\nG01 U-6 W-4 F150;\nG00 U6 W4;\nG50 X60 Z2;\nG00 X106 Z100;\nM05;\nM30;\n",
    ),
];
