//! What the process has used: processor time and memory, where the system tells (Linux).

use std::fs;

/// Unit of processor times in `/proc`, on every Linux architecture Rust supports \[1/s\].
const TICKS_PER_SECOND: f64 = 100.0;

/// Processor time of all threads so far \[s\]; `None` where unknown.
pub fn cpu_seconds() -> Option<f64> {
    parse_cpu_seconds(&fs::read_to_string("/proc/self/stat").ok()?)
}

/// The most memory the process ever held \[bytes\]; `None` where unknown.
pub fn peak_memory_bytes() -> Option<u64> {
    parse_peak_memory(&fs::read_to_string("/proc/self/status").ok()?)
}

/// Fields 14 and 15 (user and system time) of proc_pid_stat(5). The second field, the program's name, may
/// itself hold spaces and parentheses.
fn parse_cpu_seconds(stat: &str) -> Option<f64> {
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut fields = after_name.split_whitespace().skip(11);
    let user: f64 = fields.next()?.parse().ok()?;
    let system: f64 = fields.next()?.parse().ok()?;
    Some((user + system) / TICKS_PER_SECOND)
}

/// `VmHWM` of proc_pid_status(5), in units of 1024 bytes.
fn parse_peak_memory(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_behind_an_awkward_name() {
        let stat = "7 (a) (b c) R 1 7 7 0 -1 4194304 90 0 0 0 250 50 0 0 20 0 1 0 100 2 3";
        assert_eq!(parse_cpu_seconds(stat), Some(3.0));
        assert_eq!(parse_cpu_seconds("7 (a"), None);
        let status = "Name:\tphotonvdb\nVmPeak:\t  9000 kB\nVmHWM:\t     2048 kB\n";
        assert_eq!(parse_peak_memory(status), Some(2_097_152));
        assert_eq!(parse_peak_memory("Name:\tphotonvdb\n"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_process_uses_something() {
        assert!(cpu_seconds().is_some_and(|seconds| seconds < 1e6));
        assert!(peak_memory_bytes().is_some_and(|bytes| bytes > 100_000));
    }
}
