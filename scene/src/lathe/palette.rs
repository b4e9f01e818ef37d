//! The materials of the machines.

use crate::mesh::SceneMaterial;

/// Paint of the upper machine covers.
pub const LIGHT: SceneMaterial = SceneMaterial::paint(214, 216, 214);
/// Paint of the machine base.
pub const DARK: SceneMaterial = SceneMaterial::paint(62, 68, 76);
/// Contrasting paint on the two CNC machines.
pub const ACCENT: SceneMaterial = SceneMaterial::paint(34, 70, 104);
/// Green paint of the bench lathe.
pub const BENCH_GREEN: SceneMaterial = SceneMaterial::paint(58, 98, 84);
/// Black surface of rubber, plastic and blackened steel.
pub const BLACK: SceneMaterial = SceneMaterial::paint(36, 38, 42);
/// Sheet metal of trays and walls.
pub const SHEET: SceneMaterial = SceneMaterial::paint(150, 156, 160);
/// Steel of ground slideways.
pub const GROUND_STEEL: SceneMaterial = SceneMaterial::steel(158, 62);
/// Turned, polished steel.
pub const TURNED_STEEL: SceneMaterial = SceneMaterial::steel(170, 70).turned();
/// Polished steel of handles and rods.
pub const BRIGHT_STEEL: SceneMaterial = SceneMaterial::steel(186, 42);
/// Blackened steel of holders.
pub const HOLDER_STEEL: SceneMaterial = SceneMaterial::steel(78, 112);
/// Bronze of the sliding tips of the steady rest.
pub const BRONZE: SceneMaterial = SceneMaterial {
    color: [186, 132, 66],
    roughness: 84,
    metal: 220,
    rings: 0,
    glow: 0,
};
/// Hardened steel of jaws.
pub const JAW_STEEL: SceneMaterial = SceneMaterial::steel(124, 92);
/// Coated carbide of inserts.
pub const CARBIDE: SceneMaterial = SceneMaterial {
    color: [222, 176, 62],
    roughness: 64,
    metal: 210,
    rings: 0,
    glow: 18,
};
/// High-speed steel of drills.
pub const DRILL_STEEL: SceneMaterial = SceneMaterial::steel(142, 60);
/// Orange hose of the coolant.
pub const HOSE: SceneMaterial = SceneMaterial::paint(226, 112, 34);
/// The coolant jet.
pub const COOLANT: SceneMaterial = SceneMaterial {
    color: [196, 222, 226],
    roughness: 24,
    metal: 0,
    rings: 0,
    glow: 34,
};
/// Transparent panes of guards.
pub const PANE: SceneMaterial = SceneMaterial {
    color: [160, 190, 200],
    roughness: 18,
    metal: 0,
    rings: 0,
    glow: 0,
};
/// Top of a work bench.
pub const BENCH_TOP: SceneMaterial = SceneMaterial::paint(168, 132, 92);
/// Floor of the workshop.
pub const FLOOR: SceneMaterial = SceneMaterial {
    color: [112, 116, 120],
    roughness: 215,
    metal: 0,
    rings: 0,
    glow: 0,
};
/// Glowing tubes of the work lamp.
pub const LAMP: SceneMaterial = SceneMaterial::paint(255, 255, 246).glowing(255);
/// Glowing screen of the control.
pub const SCREEN: SceneMaterial = SceneMaterial::paint(46, 104, 150).glowing(150);
