//! Sums of a thousand million tiny powers.

use super::super::report::Row;
use crate::math::Rgb;
use crate::trace::PowerBalance;

const GROUP: &str = "1e9 powers of 1e-9";

/// As the tracer adds: power by power in shares of 8192 photons, then share by share. Single precision stalls at 1/32.
pub(super) fn rows() -> Vec<Row> {
    let (count, share) = (1_000_000_000_u64, 8192);
    let power = Rgb::splat(f64::from(1e-9_f32));
    let of_share = |photons: u64| {
        let mut balance = PowerBalance::default();
        (0..photons).for_each(|_| balance.emitted += std::hint::black_box(power));
        balance
    };
    let mut whole = PowerBalance::default();
    let full = of_share(share);
    (0..count / share).for_each(|_| whole.add(std::hint::black_box(&full)));
    whole.add(&of_share(count % share));
    let exact = 1e9 * f64::from(1e-9_f32);
    vec![Row::exact(GROUP, "sum", exact, whole.emitted.x, 1e-12)]
}
