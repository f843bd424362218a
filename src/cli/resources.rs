//! What the process has used, where the system tells: processor time (Unix) and memory (Linux).

use std::fs;

/// Processor time of all threads so far \[s\], to the nanosecond; `None` where unknown.
pub fn cpu_seconds() -> Option<f64> {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }
    #[cfg(not(unix))]
    None
}

/// The most memory the process ever held \[bytes\]; `None` where unknown.
pub fn peak_memory_bytes() -> Option<u64> {
    parse_peak_memory(&fs::read_to_string("/proc/self/status").ok()?)
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
    fn memory_is_found_by_name() {
        let status = "Name:\tphotonvdb\nVmPeak:\t  9000 kB\nVmHWM:\t     2048 kB\n";
        assert_eq!(parse_peak_memory(status), Some(2_097_152));
        assert_eq!(parse_peak_memory("Name:\tphotonvdb\n"), None);
    }

    /// Finer than the ticks of 10 ms that `/proc` knows.
    #[cfg(unix)]
    #[test]
    fn processor_time_runs() {
        let start = cpu_seconds().expect("a time");
        let later = (0..u32::MAX).find_map(|_| cpu_seconds().filter(|&now| now > start));
        assert!(later.is_some_and(|later| later < 1e6 && (100.0 * (later - start)).fract() > 0.0));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_process_uses_something() {
        assert!(peak_memory_bytes().is_some_and(|bytes| bytes > 100_000));
    }
}
