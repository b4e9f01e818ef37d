//! Worked examples of textbooks, lecture notes and calculators, each with its source. The load
//! that is computed from their inputs must be the published one within 5 %.

use gsk_workpiece::cutting::{
    CuttingChip, CuttingMaterial, cantilever_mm_per_n, chisel_edge_factors, cutting_power_kw,
    cutting_torque_nm, roughness_ra_um, surface_speed_m_per_min,
};
use gsk_workpiece::tool::Tool;
use libm::pow;

/// Greatest deviation from a published result.
const TOLERANCE: f64 = 0.05;

/// A worked example: inputs, and the results that its source publishes (0: not published).
#[derive(Clone, Copy)]
struct WorkedExample {
    source: &'static str,
    /// Specific cutting force at a thickness of 1 mm, N/mm², and exponent; 0: a constant kc.
    kc11: f64,
    mc: f64,
    /// Rake angle, degrees; `None` without a correction.
    rake: Option<f64>,
    /// Depth of cut and feed, mm; entering angle, degrees.
    depth: f64,
    feed: f64,
    entering: f64,
    /// Cutting speed, m/min, or with a diameter, mm, the spindle speed, r/min; 0 without.
    speed: f64,
    diameter: f64,
    /// Efficiency of the drive by which power and torque are divided.
    efficiency: f64,
    thickness: f64,
    specific: f64,
    force: f64,
    power: f64,
    torque: f64,
}

/// Each source was opened. The first seven have a specific force that depends on the thickness.
const EXAMPLES: [WorkedExample; 12] = [
    WorkedExample {
        source: "C. Patrício, Kienzle Eq Exemplo 2016, scribd.com/document/332954029: ABNT 1035",
        kc11: 1990.0,
        mc: 0.26,
        depth: 4.0,
        feed: 0.56,
        entering: 60.0,
        thickness: 0.485,
        force: 5382.0,
        ..NONE
    },
    WorkedExample {
        source: "the same with its tool of 15° rake, diameter 100 mm, 320 r/min",
        kc11: 1990.0,
        mc: 0.26,
        rake: Some(15.0),
        depth: 4.0,
        feed: 0.56,
        entering: 60.0,
        speed: 320.0,
        diameter: 100.0,
        force: 4682.0,
        power: 7.84,
        ..NONE
    },
    WorkedExample {
        source: "Mecanizado de una pieza en torno, scribd.com/document/409225301: facing, steel 308",
        kc11: 2300.0,
        mc: 0.21,
        depth: 1.0,
        feed: 0.15,
        entering: 95.0,
        speed: 606.3,
        diameter: 105.0,
        thickness: 0.1494,
        specific: 3428.57,
        power: 1.714,
        ..NONE
    },
    WorkedExample {
        source: "Ghosh, Mallik, Manufacturing Science, problem 4.5 (FOSSEE textbook companion 3250)",
        kc11: 1400.0,
        mc: 0.4,
        depth: 2.5,
        feed: 0.25,
        force: 1517.0,
        ..NONE
    },
    WorkedExample {
        source: "the same, problem 4.10: cast iron, 60 strokes of 200 mm a minute, edge at 60°",
        kc11: 810.0,
        mc: 0.4,
        depth: 4.0,
        feed: 0.25,
        entering: 60.0,
        speed: 12.0,
        power: 0.294,
        ..NONE
    },
    WorkedExample {
        source: "SPBapp, spb.pascal-schmidt.de, turning: 42CrMo4, diameter 50 mm, 150 m/min",
        kc11: 2100.0,
        mc: 0.25,
        depth: 2.0,
        feed: 0.2,
        speed: 954.93,
        diameter: 50.0,
        thickness: 0.2,
        specific: 3140.0,
        force: 1256.0,
        ..NONE
    },
    WorkedExample {
        source: "Zerspankraft Fc (Kienzle) Rechner, tool zerspankraft-fc, 2026: structural steel",
        kc11: 1700.0,
        mc: 0.25,
        depth: 3.0,
        feed: 0.2,
        specific: 2542.0,
        force: 1525.0,
        ..NONE
    },
    WorkedExample {
        source: "Mitsubishi Materials, cutting power for turning: mild steel, kc for f 0.2 mm",
        kc11: 3100.0,
        depth: 3.0,
        feed: 0.2,
        speed: 120.0,
        efficiency: 0.8,
        power: 4.65,
        ..NONE
    },
    WorkedExample {
        source: "machinecalcs.com, turning horsepower calculator",
        kc11: 1500.0,
        depth: 2.0,
        feed: 0.2,
        speed: 1146.0,
        diameter: 50.0,
        efficiency: 0.8,
        power: 2.25,
        torque: 18.75,
        ..NONE
    },
    WorkedExample {
        source: "the same, force at the edge",
        kc11: 1500.0,
        depth: 2.0,
        feed: 0.2,
        force: 600.0,
        ..NONE
    },
    WorkedExample {
        // 1 hp for 1 in³/min is 2.731 J/mm³; 0.1 in, 0.012 in, 300 ft/min; 4.32 hp.
        source: "tools.gera.services, lathe turning horsepower calculator: mild steel",
        kc11: 2731.0,
        depth: 2.54,
        feed: 0.3048,
        speed: 91.44,
        power: 3.221,
        ..NONE
    },
    WorkedExample {
        // 200 mm/min at 400 r/min; the book has the mean diameter of 12.25 mm, 4 W·s/mm³.
        source: "Kalpakjian, Schmid, turning of 304 (question and data: github.com/xmfcx/uni-lab2-hw3)",
        kc11: 4000.0,
        depth: 0.25,
        feed: 0.5,
        speed: 400.0,
        diameter: 12.25,
        force: 500.0,
        power: 0.1283,
        torque: 3.063,
        ..NONE
    },
];

/// The values that an example does not give.
const NONE: WorkedExample = WorkedExample {
    source: "",
    kc11: 0.0,
    mc: 0.0,
    rake: None,
    depth: 0.0,
    feed: 0.0,
    entering: 90.0,
    speed: 0.0,
    diameter: 0.0,
    efficiency: 1.0,
    thickness: 0.0,
    specific: 0.0,
    force: 0.0,
    power: 0.0,
    torque: 0.0,
};

#[track_caller]
fn assert_close(source: &str, computed: f64, published: f64) {
    let deviation = (computed / published - 1.0).abs();
    assert!(
        published == 0.0 || deviation <= TOLERANCE,
        "{source}: {computed} instead of {published}"
    );
}

/// A material of which an example gives the specific force itself.
fn material(kc11: f64, mc: f64) -> CuttingMaterial {
    CuttingMaterial {
        name: "example",
        group: "P2",
        kc11,
        mc,
        source: "",
    }
}

#[test]
fn worked_examples_are_computed_from_their_inputs() {
    let mut published = 0;
    for example in EXAMPLES {
        let source = example.source;
        let table = material(example.kc11, example.mc);
        let material = example.rake.map_or(table, |rake| table.with_rake(rake));
        let chip = CuttingChip::from_straight_edge(example.depth, example.feed, example.entering);
        let force = material.cutting_force_n(&chip);
        let radius = example.diameter / 2.0;
        let speed = match radius > 0.0 {
            true => surface_speed_m_per_min(radius, example.speed),
            false => example.speed,
        };
        let results = [
            (chip.thickness_mm(), example.thickness),
            (
                material.specific_force(chip.thickness_mm()),
                example.specific,
            ),
            (force, example.force),
            (
                cutting_power_kw(force, speed) / example.efficiency,
                example.power,
            ),
            (
                cutting_torque_nm(force, radius) / example.efficiency,
                example.torque,
            ),
        ];
        for (computed, expected) in results {
            assert_close(source, computed, expected);
            published += u32::from(expected > 0.0);
        }
    }
    assert_eq!(published, 22);
}

/// Lesson 'Efforts et puissance de coupe' (R. Cireddu, studylibfr.com/doc/7407586): cast iron Ft10
/// from diameter 100 to 96 mm, f 0.4 mm, Kc 100 daN/mm²: 80 daN.
#[test]
fn cireddu_force_on_cast_iron() {
    let chip = CuttingChip::from_straight_edge((100.0 - 96.0) / 2.0, 0.4, 90.0);
    let force = material(1000.0, 0.0).cutting_force_n(&chip);
    assert_close("Cireddu", force, 800.0);
}

/// Ghosh, Mallik, problem 4.14: a drill of 20 mm, f 0.25 mm. The book takes lips of 11.67 mm and a
/// chip of f / 2, shear of 400 N/mm² with a friction of 0.6 and a rake of 18.6° (1024 N/mm²), and
/// finds 18.2 N·m with the chisel edge. With the thickness f / 2 · sin 59° it would be 15.4 N·m.
#[test]
fn ghosh_torque_of_a_drill_with_its_chisel_edge() {
    let lip = CuttingChip {
        area_mm2: 11.67 * 0.125,
        width_mm: 11.67,
    };
    let force = 2.0 * material(1024.0, 0.0).cutting_force_n(&lip);
    let (torque, thrust) = chisel_edge_factors(0.0, 10.0);
    assert_close("drill", cutting_torque_nm(force, 5.0) * torque, 18.2);
    // M = 0.6 Fc d instead of 0.5 Fc d, F = 5 Ft sin β instead of 2 Ft sin β.
    assert_eq!((torque, thrust), (1.2, 2.5));
    assert_eq!(chisel_edge_factors(3.0, 10.0), (1.0, 1.0), "a bored hole");
}

/// Groove and parting off of a screw (course paper 193170-5, step 5, with the handbook by Kosilova
/// and Meshcheryakov): 31.71 kgf at 28.25 m/min, 0.15 kW.
#[test]
fn power_of_a_groove_and_of_parting_off() {
    let power = cutting_power_kw(31.71 * 9.806_65, 28.25);
    assert_close("screw", power, 0.15);
}

/// The handbook by Kosilova and Meshcheryakov, table 22, as the papers ukrbukva.net/56407 (turning:
/// 300, 1.0, 0.75, -0.15) and 193170-5 (cutting off: 408, 0.72, 0.8, 0) quote it, kgf. The ratio of
/// both for the chips of blades of 4 and 5 mm at 0.1 mm and 28.25 m/min is that of the inserts.
#[test]
fn cutting_off_against_turning_by_the_constants_of_a_handbook() {
    let (feed, speed) = (0.1, 28.25);
    for width in [4.0, 5.0] {
        let turning = 300.0 * width * pow(feed, 0.75) * pow(speed, -0.15);
        let cutting_off = 408.0 * pow(width, 0.72) * pow(feed, 0.8);
        let insert = Tool::grooving(width).insert;
        let factor = insert.force_factor() / Tool::turning().insert.force_factor();
        assert_close("handbook", factor, cutting_off / turning);
    }
}

/// E. Isakov, Boring: calculating deflection, Cutting Tool Engineering, July 2019: bar of 1 in, 4 in,
/// 207.8 lbf, 30 Mpsi: 0.003 in; 25.4 mm, 101.6 mm, 911.1 N, 206 000 N/mm²: 0.0757 mm.
#[test]
fn deflection_of_a_boring_bar() {
    let (inch, pound, psi) = (25.4, 4.448_22, 0.006_894_76);
    let bar = 207.8 * pound * cantilever_mm_per_n(4.0 * inch, inch, 30e6 * psi);
    assert_close("Isakov, inches", bar, 0.003 * inch);
    let bar = 911.1 * cantilever_mm_per_n(101.6, 25.4, 206_000.0);
    assert_close("Isakov, metric", bar, 0.0757);
}

/// machinecalcs.com, boring bar deflection calculator: bar of 1 in, 4 in, 100 lbf, 29 Mpsi:
/// 0.001498 in. Werkzeug-Durchbiegung, tool werkzeug-durchbiegung: 10 mm, 40 mm, 200 N, carbide of
/// 600 000 N/mm²: 0.0145 mm; 6 mm, 30 mm, 100 N, steel of 210 000 N/mm²: 0.0674 mm.
#[test]
fn deflections_of_two_calculators() {
    let (inch, pound, psi) = (25.4, 4.448_22, 0.006_894_76);
    let bar = 100.0 * pound * cantilever_mm_per_n(4.0 * inch, inch, 29e6 * psi);
    assert_close("boring bar", bar, 0.001_498 * inch);
    let carbide = 200.0 * cantilever_mm_per_n(40.0, 10.0, 600_000.0);
    assert_close("carbide", carbide, 0.0145);
    let steel = 100.0 * cantilever_mm_per_n(30.0, 6.0, 210_000.0);
    assert_close("steel", steel, 0.0674);
}

/// vibromera.eu, turning surface finish calculator: f 0.2 mm, nose 0.8 mm: 1.56 µm.
/// machinecalcs.com gives 1.60 µm for the same, with 31.2 in the place of 32.
#[test]
fn roughness_of_two_calculators() {
    let roughness = roughness_ra_um(0.2, 0.8).expect("a nose");
    assert_close("vibromera", roughness, 1.56);
    assert_close("machinecalcs", roughness, 1.60);
    assert_eq!(roughness_ra_um(0.2, 0.0), None);
}
