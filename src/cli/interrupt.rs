//! Ctrl-C: the first press ends the render after the pass in flight, the second ends the program.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::console::say;
use super::error::CliError;

/// What shells report of a program ended by SIGINT: 128 + 2.
const ENDED_BY_INTERRUPT: i32 = 130;

/// Catches Ctrl-C from now on. The flag returned becomes true at the first press.
pub fn catch() -> Result<Arc<AtomicBool>, CliError> {
    let pressed = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&pressed);
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(ENDED_BY_INTERRUPT);
        }
        say("\nending after the pass in flight; press Ctrl-C again to end at once");
    })?;
    Ok(pressed)
}
