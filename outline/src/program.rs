//! Writes the program that turns an outline: G71 and G70, or the blocks of the outline alone.

use core::fmt::Write as _;

use gsk_messages::{Language, Message, say};

use crate::block_words::pointed;
use crate::blocks::{ArcFormat, BlockShape, GridEnd, OutlineBlock, OutlineBlocks};
use crate::profile::TurnedProfile;
use crate::rules::CutRule;

/// Greatest number of blocks between P and Q of G70 to G73.
const MAX_CYCLE_BLOCKS: usize = 100;
/// Distance of the start point from the stock, mm; in X of the diameter.
const CLEARANCE_MM: f64 = 2.0;

/// What is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutlineFormat {
    /// The blocks of the outline alone.
    Contour,
    /// A whole program with G71 and G70.
    #[default]
    G71,
}

/// The values of roughing and finishing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughingValues {
    /// Depth of a cut, mm of the radius.
    pub depth: f64,
    /// Retract after a cut, mm of the radius.
    pub retract: f64,
    /// Finishing allowance in X, mm of the diameter.
    pub allowance_x: f64,
    /// Finishing allowance in Z, mm.
    pub allowance_z: f64,
    /// Feed of roughing, mm per revolution.
    pub feed: f64,
    /// Feed of finishing, mm per revolution.
    pub finishing_feed: f64,
    /// Speed of the spindle, revolutions per minute.
    pub speed: u32,
    /// Number of the tool and of its offset.
    pub tool: u8,
}

impl Default for RoughingValues {
    fn default() -> Self {
        Self {
            depth: 1.5,
            retract: 0.5,
            allowance_x: 0.4,
            allowance_z: 0.1,
            feed: 0.2,
            finishing_feed: 0.1,
            speed: 800,
            tool: 1,
        }
    }
}

/// How the program of an outline is written.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramOptions {
    /// What is written.
    pub format: OutlineFormat,
    /// Diameter of the stock, mm; `None`: the largest diameter and 2 mm, rounded up.
    pub stock: Option<f64>,
    /// Corner angle of the finishing insert, degrees.
    pub insert: Option<f64>,
    /// The values of roughing and finishing.
    pub values: RoughingValues,
    /// The O number.
    pub number: u16,
    /// The name of the drawing, for the first comment.
    pub name: String,
    /// The language of the comments.
    pub language: Language,
}

impl Default for ProgramOptions {
    fn default() -> Self {
        Self {
            format: OutlineFormat::default(),
            stock: None,
            insert: None,
            values: RoughingValues::default(),
            number: 1,
            name: String::new(),
            language: Language::En,
        }
    }
}

impl TurnedProfile {
    /// The diameter of the stock: the given one, or the largest diameter and 2 mm, rounded up.
    pub fn stock_diameter(&self, options: &ProgramOptions) -> f64 {
        let guess = || libm::ceil(self.largest_diameter() + 2.0 - 1e-6);
        options.stock.unwrap_or_else(guess)
    }

    /// Writes the program.
    ///
    /// # Errors
    /// A value is outside its range, the outline cannot be cut so, or it has too many blocks.
    pub fn write_program(&self, options: &ProgramOptions) -> Result<String, Message> {
        check_values(options)?;
        let rule = match options.format {
            OutlineFormat::G71 => CutRule::Roughing,
            OutlineFormat::Contour => CutRule::Finishing {
                insert: options.insert,
            },
        };
        self.check_directions(rule)?;
        let blocks = self.write_blocks(
            ArcFormat::RadiusOrCenter,
            options.format == OutlineFormat::G71,
        )?;
        if options.format == OutlineFormat::Contour {
            return Ok(contour_text(&blocks, &options.values));
        }
        // The blocks of the profile: to the diameter of the start, to its Z, and the outline.
        let count = blocks.blocks.len() + 2;
        if count > MAX_CYCLE_BLOCKS {
            return Err(say::outline_too_many_blocks(count, MAX_CYCLE_BLOCKS));
        }
        let stock = self.stock_diameter(options);
        let largest = self.largest_diameter();
        if stock < largest {
            return Err(say::outline_small_stock(stock, largest));
        }
        Ok(roughing_text(&blocks, stock, options))
    }
}

fn check_values(options: &ProgramOptions) -> Result<(), Message> {
    let values = &options.values;
    let ranges = [
        (say::outline_depth(), values.depth, 0.001, 99.0),
        (say::outline_retract(), values.retract, 0.0, 99.0),
        (say::outline_allowance_x(), values.allowance_x, 0.0, 99.0),
        (say::outline_allowance_z(), values.allowance_z, 0.0, 99.0),
        (say::outline_feed(), values.feed, 0.001, 10.0),
        (
            say::outline_finishing_feed(),
            values.finishing_feed,
            0.001,
            10.0,
        ),
        (say::outline_speed(), f64::from(values.speed), 1.0, 9999.0),
        (say::outline_tool(), f64::from(values.tool), 1.0, 32.0),
        (
            say::outline_insert(),
            options.insert.unwrap_or(35.0),
            10.0,
            90.0,
        ),
        (
            say::outline_stock(),
            options.stock.unwrap_or(1.0),
            0.001,
            9999.0,
        ),
    ];
    for (name, value, least, greatest) in ranges {
        // False for NaN, too.
        let is_valid = value >= least && value <= greatest;
        if !is_valid {
            return Err(say::outline_value_range(name, value, least, greatest));
        }
    }
    Ok(())
}

/// The characters of a name that a comment of a program may have.
fn comment_name(name: &str) -> String {
    let plain = |letter: &char| !letter.is_control() && !matches!(letter, '(' | ')' | '%' | ';');
    name.chars().filter(plain).take(40).collect()
}

/// The blocks of the outline alone: from its start, at the finishing feed.
fn contour_text(outline: &OutlineBlocks, values: &RoughingValues) -> String {
    let lines = outline.contour_lines(&pointed(values.finishing_feed));
    lines.iter().map(|line| format!("{line}\n")).collect()
}

fn roughing_text(outline: &OutlineBlocks, stock: f64, options: &ProgramOptions) -> String {
    let values = &options.values;
    let start_z = outline.start.z as f64 / 1000.0 + CLEARANCE_MM;
    let change_x = libm::ceil((stock + 60.0) / 10.0) * 10.0;
    let change_z = libm::ceil((start_z + 100.0) / 10.0) * 10.0;
    let change = format!("X{} Z{}", pointed(change_x), pointed(change_z));
    let comment = |message: Message| format!("({})", message.text(options.language));
    let mut text = format!("O{:04}", options.number);
    let name = comment_name(&options.name);
    if !name.is_empty() {
        let _ = write!(text, " ({name})");
    }
    let stock_comment = comment(say::outline_comment_stock(pointed(stock)));
    let change_comment = comment(say::outline_comment_change());
    let tool = format!("T{:02}{:02}", values.tool, values.tool);
    let _ = write!(
        text,
        "\n{stock_comment}\nG50 {change} {change_comment}\nG97 G99 S{} M03\n{tool}\n",
        values.speed
    );
    let _ = writeln!(
        text,
        "G00 X{} Z{}",
        pointed(stock + CLEARANCE_MM),
        pointed(start_z)
    );
    let _ = writeln!(
        text,
        "G71 U{} R{}\nG71 P10 Q20 U{} W{} F{}",
        pointed(values.depth),
        pointed(values.retract),
        pointed(values.allowance_x),
        pointed(values.allowance_z),
        pointed(values.feed)
    );
    // The profile begins at the Z of the start point.
    let first = OutlineBlock {
        end: outline.start,
        shape: BlockShape::Line,
    };
    let profile = OutlineBlocks {
        start: GridEnd {
            z: outline.start.z + libm::round(CLEARANCE_MM * 1000.0) as i64,
            ..outline.start
        },
        blocks: [&[first], &outline.blocks[..]].concat(),
    };
    for line in profile.cycle_lines((10, 20), &pointed(values.finishing_feed)) {
        text.push_str(&line);
        text.push('\n');
    }
    let _ = write!(
        text,
        "G70 P10 Q20\nG00 {change}\nT{:02}00\nM05\nM30\n%\n",
        values.tool
    );
    text
}
