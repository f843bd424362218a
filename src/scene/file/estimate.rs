//! `[estimate]`

use serde::{Serialize, Serializer};

use super::table::Table;
use crate::estimate::{Divisor, Kernel};
use crate::scene::error::Problem;

/// `[estimate]`: how the photon map is read.
///
/// | key | type | unit | default | range | meaning |
/// |---|---|---|---|---|---|
/// | `k` | integer | | 50 | 1 (2 with divisor `k-1` or `calibrated`) to 10^6 | photons of one estimate |
/// | `divisor` | `"k"`, `"k-1"`, `"k-1/2"`, `"calibrated"` | | `"k-1"` | | numerator of the estimate; `"calibrated"` measures it |
/// | `kernel` | `"constant"`, `"epanechnikov"` | | `"constant"` | | weight by distance |
/// | `max_radius` | number | m | a share of the medium's size | above 0 | largest radius of a query |
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EstimateSettings {
    /// Photons of one estimate.
    pub k: usize,
    /// Numerator of the estimate.
    #[serde(serialize_with = "serialize_divisor")]
    pub divisor: Divisor,
    /// Weight by distance.
    #[serde(serialize_with = "serialize_kernel")]
    pub kernel: Kernel,
    /// Largest radius of a query \[m\]; `None`: a share of the medium's size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_radius: Option<f64>,
}

const DIVISORS: [(&str, Divisor); 4] = [
    ("k", Divisor::K),
    ("k-1", Divisor::KMinus1),
    ("k-1/2", Divisor::KMinusHalf),
    ("calibrated", Divisor::Calibrated),
];

const KERNELS: [(&str, Kernel); 2] =
    [("constant", Kernel::Constant), ("epanechnikov", Kernel::Epanechnikov)];

const MAX_K: u64 = 1_000_000;

fn serialize_divisor<S: Serializer>(divisor: &Divisor, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(divisor.name())
}

fn serialize_kernel<S: Serializer>(kernel: &Kernel, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kernel.name())
}

impl EstimateSettings {
    /// Every key of the section.
    pub(super) const KEYS: [&str; 4] = ["k", "divisor", "kernel", "max_radius"];

    pub(super) fn read(table: &Table) -> Result<Self, Problem> {
        table.allow(&Self::KEYS)?;
        let divisor = table.choose("divisor", &DIVISORS)?.unwrap_or(Divisor::KMinus1);
        let k: u64 = table.get_or("k", 50)?;
        table.ensure("k", (1..=MAX_K).contains(&k), "must lie in 1 to 1000000")?;
        // One photon alone has an infinite mean: nothing makes it unbiased.
        if k == 1 && matches!(divisor, Divisor::KMinus1 | Divisor::Calibrated) {
            let least = format!("must be at least 2 with divisor {:?}", divisor.name());
            table.ensure("k", false, &least)?;
        }
        let max_radius = table.get("max_radius")?;
        table.ensure("max_radius", max_radius.is_none_or(|r| r > 0.0), "must be above 0")?;
        let kernel = table.choose("kernel", &KERNELS)?.unwrap_or(Kernel::Constant);
        Ok(Self { k: k as usize, divisor, kernel, max_radius })
    }
}
