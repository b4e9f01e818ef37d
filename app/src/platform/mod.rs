//! What the systems that the program runs on do each in its own way. Nothing outside
//! this room asks which of them it is.
//!
//! | File | What |
//! |---|---|
//! | `files` | one file under two names, files for their owner alone, names of ports |
//! | `process` | this program's own file and name, how its end is asked for |
//! | `tie` | what ties the program to the process that holds its port |
//! | `serial` | serial ports, pseudo terminals |
//! | `desktop` | whether there is a display, a file dialog; the console behind a window |

#[cfg(unix)]
mod unix;
#[cfg(windows)]
mod windows;

#[cfg(unix)]
pub use unix::*;
#[cfg(windows)]
pub use windows::*;
