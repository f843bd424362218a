//! The models: where photons lie around the query point, and what that makes of the k-nearest estimate.
//!
//! Everything is told in u, the number of photons expected in the ball of radius r around the query: n r in one
//! dimension, r^2 in two, r^3 in three (in the thesis's units). Every estimator is c / u_(k), its true value 1, and
//! its bias c E\[1/u_(k)\] - 1, so that n and the dimension matter only through the law of u_(k).

mod counts;
mod jittered_line;
mod law;
mod shell;
mod triangle;

pub use law::{Law, law};
pub use shell::ShellLaw;
pub use triangle::Shell;

use super::error::LabError;

/// A model of where photons lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Model {
    /// n photons uniform at random, independent of each other; 1, 2 or 3 dimensions (1.11).
    Random(u32),
    /// 1-D, one photon in each of n equal parts, with E\[r_k\] put in the place of r_k (2.2, 2.3).
    FirstApproximation,
    /// 1-D, one photon in each of n equal parts, counted in an interval of fixed radius around the query in the middle,
    /// where k are expected (1.12, 1.13).
    FixedRadius,
    /// 1-D, one photon in each of n equal parts, the query in the middle (2.9, 2.13).
    Stratified,
    /// One photon in each of n concentric shells of equal measure; 2 or 3 dimensions (2.21, 2.36).
    Basic(u32),
    /// x photons in the x-th of concentric shells, uniform in the radius; 2 or 3 dimensions (2.27, 2.41).
    Order(u32),
    /// The same, uniform in area or volume.
    OrderVolume(u32),
    /// One photon in each cell of a cubic grid, the query at a random place; 1, 2 or 3 dimensions.
    Jittered(u32),
}

impl Model {
    /// Every model, in the order of the thesis.
    pub const ALL: [Model; 15] = [
        Model::Random(1),
        Model::FixedRadius,
        Model::FirstApproximation,
        Model::Stratified,
        Model::Jittered(1),
        Model::Random(2),
        Model::Basic(2),
        Model::Order(2),
        Model::OrderVolume(2),
        Model::Jittered(2),
        Model::Random(3),
        Model::Basic(3),
        Model::Order(3),
        Model::OrderVolume(3),
        Model::Jittered(3),
    ];

    /// As on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Random(1) => "1d-random",
            Self::Random(2) => "2d-random",
            Self::Random(_) => "3d-random",
            Self::FirstApproximation => "1d-first-approximation",
            Self::FixedRadius => "1d-fixed-radius",
            Self::Stratified => "1d-stratified",
            Self::Basic(2) => "2d-basic",
            Self::Basic(_) => "3d-basic",
            Self::Order(2) => "2d-order",
            Self::Order(_) => "3d-order",
            Self::OrderVolume(2) => "2d-order-volume",
            Self::OrderVolume(_) => "3d-order-volume",
            Self::Jittered(1) => "1d-jittered",
            Self::Jittered(2) => "2d-jittered",
            Self::Jittered(_) => "3d-jittered",
        }
    }

    /// The model of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|model| model.name() == name)
    }

    /// Number of dimensions.
    pub fn dimension(self) -> u32 {
        match self {
            Self::FirstApproximation | Self::FixedRadius | Self::Stratified => 1,
            Self::Random(d)
            | Self::Basic(d)
            | Self::Order(d)
            | Self::OrderVolume(d)
            | Self::Jittered(d) => d,
        }
    }

    /// The fewest photons among which there is a k-th one of the kind the model tells of.
    pub fn photons_needed(self, k: u64) -> u64 {
        match self {
            // The last shell must be complete.
            Self::Order(_) | Self::OrderVolume(_) => Shell::of(k).end,
            Self::Jittered(dimension) => cells_needed(k, dimension),
            _ => k,
        }
    }

    /// The number of photons nearest to n that the model can have: jittered grids have d-th powers.
    pub fn nearest_count(self, n: u64) -> u64 {
        match self {
            Self::Jittered(dimension) => {
                let edge = (n as f64).powf(1.0 / f64::from(dimension)).round().max(1.0);
                (edge as u64).saturating_pow(dimension)
            }
            _ => n,
        }
    }

    /// Checks that the model has a k-th of n photons.
    ///
    /// # Errors
    /// k is 0, beyond 10^15, or more than n allows.
    pub fn check(self, n: u64, k: u64) -> Result<(), LabError> {
        const LARGEST: u64 = 1_000_000_000_000_000;
        if k == 0 || k > LARGEST {
            return Err(LabError::KOutOfRange { k });
        }
        let needed = self.photons_needed(k);
        if needed > n {
            return Err(LabError::TooFewPhotons { model: self.name(), n, k, needed });
        }
        Ok(())
    }
}

/// Cells of the smallest cubic grid that holds the ball out to the k-th photon around any query in its middle cell.
fn cells_needed(k: u64, dimension: u32) -> u64 {
    let edge = 2 * super::jitter::reach(k, dimension) + 1;
    edge.saturating_pow(dimension)
}
