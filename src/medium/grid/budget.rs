//! What building a sampling structure may take: every vector and table is counted against the limit before it
//! is allocated.

use crate::medium::{
    pages::Pages,
    vdb::{Limits, memory_size},
};

/// Why no [`DensityGrid`](super::DensityGrid) was built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DensityGridError {
    /// Voxels and sampling structure together would take more memory than allowed.
    #[error(
        "its sampling structure needs {} of memory, voxels included, and the limit is {}; \
                raise the limit (--max-volume-memory) or export it at a lower resolution",
        memory_size(*needed), memory_size(*limit)
    )]
    TooLarge {
        /// What is needed at least, as far as it was counted \[bytes\].
        needed: u64,
        /// What is allowed \[bytes\].
        limit: u64,
    },
    /// The machine has not got the memory.
    #[error(
        "its sampling structure needs {} of memory, voxels included, more than there is; \
                export it at a lower resolution",
        memory_size(*needed)
    )]
    OutOfMemory {
        /// What is needed at least \[bytes\].
        needed: u64,
    },
}

/// Memory counted so far and memory allowed.
#[derive(Debug)]
pub(super) struct Budget {
    needed: u64,
    limit: u64,
}

impl Budget {
    /// With some bytes taken already.
    pub(super) fn new(held: u64, limits: &Limits) -> Result<Self, DensityGridError> {
        let mut budget = Self { needed: 0, limit: limits.max_bytes };
        budget.spend(held)?;
        Ok(budget)
    }

    /// Counts bytes that are about to be allocated.
    pub(super) fn spend(&mut self, bytes: u64) -> Result<(), DensityGridError> {
        self.needed = self.needed.saturating_add(bytes);
        if self.needed > self.limit {
            return Err(DensityGridError::TooLarge { needed: self.needed, limit: self.limit });
        }
        Ok(())
    }

    /// Counts hash tables of entries of some size before they grow to `len` entries.
    pub(super) fn spend_table<T>(&mut self, len: usize) -> Result<(), DensityGridError> {
        // One control byte an entry; up to seven eighths of a power of two are filled.
        let bucket_count = (len as u64).saturating_mul(8).div_ceil(7).next_power_of_two();
        self.spend(bucket_count.saturating_mul(size_of::<T>() as u64 + 1))
    }

    /// An empty vector with room for `len` elements.
    pub(super) fn vector<T>(&mut self, len: usize) -> Result<Vec<T>, DensityGridError> {
        self.spend((len as u64).saturating_mul(size_of::<T>() as u64))?;
        let mut vector = Vec::new();
        let reserved = vector.try_reserve_exact(len);
        reserved.map_err(|_| DensityGridError::OutOfMemory { needed: self.needed })?;
        Ok(vector)
    }

    /// As many bytes, all 0.
    pub(super) fn pages(&mut self, len: usize) -> Result<Pages, DensityGridError> {
        self.spend(len as u64)?;
        Pages::zeroed(len).map_err(|_| DensityGridError::OutOfMemory { needed: self.needed })
    }
}
