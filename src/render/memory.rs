//! How much memory is free, so that what does not fit is refused by name: an allocation that fails ends the process.

use std::fs;

use crate::render::RenderError;

/// What a pixel takes while an image is made and written \[bytes\], measured at 10^6 pixels.
const PIXEL_BYTES: u64 = 600;

/// What a pixel takes for each light that has a layer of its own \[bytes\].
const LIGHT_BYTES: u64 = 90;

/// Refuses an image with layers of so many lights that does not fit.
pub fn check_image(pixels: usize, lights: usize) -> Result<(), RenderError> {
    let what = || format!("an image of {pixels} pixels");
    let bytes = (pixels as u64).saturating_mul(PIXEL_BYTES + LIGHT_BYTES * lights as u64);
    check(bytes, what, "take a smaller --resolution")
}

/// Refuses what takes more bytes than are free.
pub fn check(
    bytes: u64,
    what: impl FnOnce() -> String,
    way_out: &'static str,
) -> Result<(), RenderError> {
    match free_bytes() {
        Some(free) if bytes > free => Err(RenderError::OutOfMemory {
            what: what(),
            needed_mib: bytes.div_ceil(1 << 20),
            free_mib: free >> 20,
            way_out,
        }),
        _ => Ok(()),
    }
}

/// Memory that the process may still take \[bytes\]: of the machine, of its control group and of its address space the least;
/// `None` where the system does not tell (it is Linux that does).
pub fn free_bytes() -> Option<u64> {
    let read = |path: &str| fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| kibibytes(&text, "MemAvailable:"));
    let number = |path: &str| read(path)?.trim().parse::<u64>().ok();
    let group = number("/sys/fs/cgroup/memory.max")
        .zip(number("/sys/fs/cgroup/memory.current"))
        .map(|(most, taken)| most.saturating_sub(taken.saturating_sub(cached_bytes())));
    let taken = read("/proc/self/status").and_then(|text| kibibytes(&text, "VmSize:"));
    let space = read("/proc/self/limits")
        .and_then(|text| address_space(&text))
        .zip(taken)
        .map(|(most, taken)| most.saturating_sub(taken));
    [machine, group, space].into_iter().flatten().min()
}

/// What the control group holds of files, which the system gives back when asked.
fn cached_bytes() -> u64 {
    let text = fs::read_to_string("/sys/fs/cgroup/memory.stat").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("file "));
    line.and_then(|bytes| bytes.trim().parse().ok()).unwrap_or(0)
}

/// A figure of proc(5) given in units of 1024 bytes \[bytes\].
fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// The soft limit of the address space \[bytes\], if there is one.
fn address_space(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_the_system_are_found_by_name() {
        let text = "MemTotal:       24586732 kB\nMemAvailable:    1000 kB\n";
        assert_eq!(kibibytes(text, "MemAvailable:"), Some(1_024_000));
        assert_eq!(kibibytes(text, "VmSize:"), None);
        let limits = "Limit                     Soft Limit           Hard Limit           Units     \n\
                      Max address space         4096000000           unlimited            bytes     \n";
        assert_eq!(address_space(limits), Some(4_096_000_000));
        assert_eq!(address_space("Max address space         unlimited  unlimited  bytes"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_no_machine_holds_is_refused() {
        assert!(check_image(1, 0).is_ok());
        let error = check_image(1 << 50, 0).unwrap_err().to_string();
        assert!(error.contains("an image of 1125899906842624 pixels takes 6442"), "{error}");
        assert!(error.ends_with("take a smaller --resolution"), "{error}");
    }
}
