//! `load`: the tables of materials and of cutting values.

use std::fmt::Write as _;

use gsk_messages::{Language, say};
use gsk_runner::report;
use gsk_workpiece::cutting::{
    CuttingChip, CuttingMaterial, CuttingOperation, StartingValues, cutting_power_kw,
    roughness_ra_um,
};

use super::{CommandError, EXIT_OK, output};
use crate::cli::{LoadCommand, LoadValuesArgs};

/// Prints one of the tables. The error is an unknown material.
pub fn load(command: &LoadCommand, language: Option<Language>) -> Result<u8, CommandError> {
    let text = match command {
        LoadCommand::Materials => materials(),
        LoadCommand::Values(args) => {
            let name = &args.material;
            let material = CuttingMaterial::from_name(name);
            let material = material.ok_or_else(|| say::stock_unknown_grade(name))?;
            values(args, &material, language)
        }
    };
    output::print(&text);
    Ok(EXIT_OK)
}

/// The table of materials, one in a line.
fn materials() -> String {
    let lines = CuttingMaterial::all().map(|it| {
        let CuttingMaterial {
            name,
            group,
            kc11,
            mc,
            source,
        } = it;
        format!("{name}\t{group}\tkc1.1 {kc11}\tmc {mc:.2}\t{source}\n")
    });
    lines.collect()
}

/// The starting values of a material: each operation with its ranges, the spindle speeds at the
/// diameter, the load of the mean values, and the source.
fn values(args: &LoadValuesArgs, material: &CuttingMaterial, language: Option<Language>) -> String {
    let localize = |message| report::message_text(&message, language);
    let mut text = String::new();
    for row in StartingValues::of_material(material) {
        let is_turning = row.operation != CuttingOperation::Grooving;
        let greatest_feed = match is_turning && args.nose > 0.0 {
            true => args.nose * 2.0 / 3.0,
            false => f64::INFINITY,
        };
        let feed = (
            row.feed_mm.0.min(greatest_feed),
            row.feed_mm.1.min(greatest_feed),
        );
        let speed = row.speed_m_per_min;
        let range = |(least, greatest): (f64, f64), digits: usize| match least == greatest {
            true => format!("{least:.digits$}"),
            false => format!("{least:.digits$}~{greatest:.digits$}"),
        };
        let line = say::load_values(row.operation.name(), range(speed, 0), range(feed, 2));
        text += &localize(line);
        if let Some(depth) = row.depth_mm {
            text += &localize(say::load_values_depth(range(depth, 2)));
        }
        if let Some(diameter) = args.diameter.filter(|it| *it > 0.0) {
            let rpm = |speed: f64| speed * 1000.0 / (core::f64::consts::PI * diameter);
            text += &localize(say::load_values_rpm(range((rpm(speed.0), rpm(speed.1)), 0)));
        }
        let mean = |(least, greatest): (f64, f64)| f64::midpoint(least, greatest);
        if let Some(depth) = row.depth_mm {
            let chip = CuttingChip::from_straight_edge(mean(depth), mean(feed), 95.0);
            let force = material.cutting_force_n(&chip);
            let power = cutting_power_kw(force, mean(speed));
            text += &localize(say::load_values_force(
                format_args!("{force:.0}"),
                format_args!("{power:.2}"),
            ));
            if let Some(roughness) = roughness_ra_um(mean(feed), args.nose) {
                text += &localize(say::report_load_roughness(format_args!("{roughness:.2}")));
            }
        }
        let _ = writeln!(text, "\n  {}", row.source);
    }
    if text.is_empty() {
        text = localize(say::load_no_values(material.name)) + "\n";
    }
    text
}
