//! Tests of the program text.

mod arbitrary;
mod blocks;
mod memory;
mod syntax;
