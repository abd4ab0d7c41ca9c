//! How long something took: on the wall, and on all processors together.

use std::time::{Duration, Instant};

/// A beginning.
pub struct Clock {
    wall: Instant,
    processors: Option<Duration>,
}

impl Clock {
    /// Now.
    pub fn start() -> Clock {
        Clock { processors: processor_time(), wall: Instant::now() }
    }

    /// Seconds since, and seconds of all this process's threads; `None` where the system doesn't tell.
    pub fn read(&self) -> (f64, Option<f64>) {
        let wall = self.wall.elapsed().as_secs_f64();
        let processors =
            processor_time().zip(self.processors).map(|(now, then)| now.saturating_sub(then).as_secs_f64());
        (wall, processors)
    }
}

/// What the process's threads have spent so far, those that have ended too.
#[cfg(unix)]
fn processor_time() -> Option<Duration> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(Duration::new(time.tv_sec.try_into().ok()?, time.tv_nsec.try_into().ok()?))
}

#[cfg(not(unix))]
fn processor_time() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleeping_takes_time_on_the_wall_and_work_on_a_processor() {
        let clock = Clock::start();
        std::thread::sleep(Duration::from_millis(5));
        assert!(clock.read().0 >= 0.005);
        if let (_, Some(before)) = clock.read() {
            let mut x = 1u64;
            while clock.read().1 == Some(before) {
                x = std::hint::black_box(x.wrapping_mul(3));
            }
        }
    }
}
