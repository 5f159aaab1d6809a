//! Times of one thread, whatever else the machine does, and what many of them have in common.

use cpu_time::ThreadTime;

/// Seconds of this thread that `work` takes, done `repeat` times: the mean. Reading the clock is
/// not counted.
pub fn seconds(repeat: u32, mut work: impl FnMut()) -> f64 {
    let start = ThreadTime::now();
    for _ in 0..repeat {
        work();
    }
    (start.elapsed().as_secs_f64() - reading()).max(0.0) / f64::from(repeat)
}

/// What reading the clock costs by itself.
fn reading() -> f64 {
    static COST: std::sync::OnceLock<f64> = std::sync::OnceLock::new();
    *COST.get_or_init(|| {
        let samples = (0..1000).map(|_| ThreadTime::now().elapsed().as_secs_f64());
        median(&samples.collect::<Vec<_>>())
    })
}

/// The median; 0 of none.
pub fn median(samples: &[f64]) -> f64 {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}
