//! Worked examples of textbooks, lecture notes and makers of tools, each with its source. The
//! formulas of the load must give the published results within 5 %.

use gsk_workpiece::cutting::{
    CuttingChip, CuttingMaterial, cutting_power_kw, cutting_torque_nm, roughness_ra_um,
    surface_speed_m_per_min,
};

/// Greatest deviation from a published result.
const TOLERANCE: f64 = 0.05;

#[track_caller]
fn assert_close(computed: f64, published: f64) {
    let deviation = (computed / published - 1.0).abs();
    assert!(deviation <= TOLERANCE, "{computed} instead of {published}");
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

/// Mitsubishi Materials, technical information, formulae for cutting power in turning: mild
/// steel, vc 120 m/min, ap 3 mm, f 0.2 mm, Kc 3100 MPa, efficiency 80 %: 4.65 kW.
#[test]
fn mitsubishi_power_of_turning_mild_steel() {
    let chip = CuttingChip::from_straight_edge(3.0, 0.2, 90.0);
    let force = material(3100.0, 0.0).cutting_force_n(&chip);
    assert_close(cutting_power_kw(force, 120.0) / 0.8, 4.65);
}

/// Keyence, introduction to machining, calculation of cutting power: mild steel, vc 140 m/min,
/// ap 5 mm, f 0.1 mm, Kc 3610 MPa, efficiency 80 %: 5.26 kW.
#[test]
fn keyence_power_of_turning_mild_steel() {
    let chip = CuttingChip::from_straight_edge(5.0, 0.1, 90.0);
    let force = material(3610.0, 0.0).cutting_force_n(&chip);
    assert_close(cutting_power_kw(force, 140.0) / 0.8, 5.26);
}

/// machinecalcs.com, turning horsepower calculator: diameter 50 mm, 180 m/min, f 0.2 mm, ap 2 mm,
/// kc 1500 N/mm²: 1146 r/min, 1.8 kW at the cut.
#[test]
fn machinecalcs_power_and_speed() {
    assert_close(surface_speed_m_per_min(25.0, 1146.0), 180.0);
    let chip = CuttingChip::from_straight_edge(2.0, 0.2, 90.0);
    let force = material(1500.0, 0.0).cutting_force_n(&chip);
    assert_close(cutting_power_kw(force, 180.0), 1.8);
    // 9550 · P / n, without the efficiency of the drive.
    assert_close(cutting_torque_nm(force, 25.0), 9550.0 * 1.8 / 1146.0);
}

/// Student project 'Mecanizado de una pieza en torno' with the tables of Sandvik Coromant:
/// stainless steel 308, kc1 2300 N/mm², mc 0.21, facing with ap 1 mm, f 0.15 mm, entering angle
/// 95°, vc 200 m/min: h 0.1494 mm, kc 3428.57 N/mm², 1.714 kW.
#[test]
fn facing_of_stainless_steel() {
    let steel = material(2300.0, 0.21);
    let chip = CuttingChip::from_straight_edge(1.0, 0.15, 95.0);
    assert_close(chip.thickness_mm(), 0.1494);
    assert_close(steel.specific_force(chip.thickness_mm()), 3428.57);
    assert_close(cutting_power_kw(steel.cutting_force_n(&chip), 200.0), 1.714);
}

/// L. Gueraiche, TD 2 Tournage, University of Jijel 2020: the table of Kc by chip thickness.
#[test]
fn gueraiche_specific_forces() {
    let published = [
        ("E295", 0.1, 3620.0),
        ("E295", 0.4, 2530.0),
        ("C60", 0.125, 3100.0),
        ("C60", 0.25, 2730.0),
        ("18CrNi8", 0.1, 4510.0),
        ("18CrNi8", 0.2, 3660.0),
        ("S235JR", 0.4, 2080.0),
        ("EN-GJL-200", 0.2, 1530.0),
        ("EN-GJL-200", 0.08, 1920.0),
    ];
    for (name, thickness, force) in published {
        let material = CuttingMaterial::from_name(name).expect("in the table");
        assert_close(material.specific_force(thickness), force);
    }
}

/// Lesson 'Efforts et puissance de coupe' (R. Cireddu, Génie mécanique): cast iron Ft10 from
/// diameter 100 to 96 mm, f 0.4 mm, Kc 100 daN/mm²: 80 daN.
#[test]
fn cireddu_force_on_cast_iron() {
    let chip = CuttingChip::from_straight_edge(2.0, 0.4, 90.0);
    assert_close(material(1000.0, 0.0).cutting_force_n(&chip), 800.0);
}

/// S. Kalpakjian, S. Schmid, Manufacturing Engineering and Technology, example of turning:
/// stainless steel 304 from diameter 12.5 to 12 mm, 400 r/min, 200 mm/min, 4 W·s/mm³: 128 W,
/// 3.1 N·m, 506 N. The book takes the mean diameter.
#[test]
fn kalpakjian_power_torque_and_force() {
    let chip = CuttingChip::from_straight_edge(0.25, 200.0 / 400.0, 90.0);
    let force = material(4000.0, 0.0).cutting_force_n(&chip);
    assert_close(force, 506.0);
    assert_close(cutting_torque_nm(force, 6.25), 3.1);
    let speed = surface_speed_m_per_min(6.25, 400.0);
    assert_close(cutting_power_kw(force, speed) * 1000.0, 128.0);
}

/// vibromera.eu, turning surface finish calculator: f 0.2 mm, nose 0.8 mm: 1.56 µm.
/// machinecalcs.com gives 1.60 µm for the same, with 31.2 in the place of 32.
#[test]
fn roughness_of_two_calculators() {
    let roughness = roughness_ra_um(0.2, 0.8).expect("a nose");
    assert_close(roughness, 1.56);
    assert_close(roughness, 1.60);
    assert_eq!(roughness_ra_um(0.2, 0.0), None);
}
