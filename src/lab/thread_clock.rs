//! Processor time of one thread: what work costs, however many others share the machine.

/// Counts the processor time of the thread that made it; where the system does not tell, the time that passes.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThreadClock {
    #[cfg(unix)]
    start: f64,
    #[cfg(not(unix))]
    start: std::time::Instant,
}

impl ThreadClock {
    /// Starts counting.
    pub(super) fn start() -> Self {
        #[cfg(unix)]
        let start = now();
        #[cfg(not(unix))]
        let start = std::time::Instant::now();
        Self { start }
    }

    /// Since the start \[s\], on the same thread.
    pub(super) fn seconds(self) -> f64 {
        #[cfg(unix)]
        return now() - self.start;
        #[cfg(not(unix))]
        return self.start.elapsed().as_secs_f64();
    }
}

#[cfg(unix)]
fn now() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn sleep_costs_next_to_nothing() {
        let clock = ThreadClock::start();
        std::thread::sleep(std::time::Duration::from_millis(50));
        let asleep = clock.seconds();
        assert!((0.0..0.02).contains(&asleep), "{asleep}");
    }
}
