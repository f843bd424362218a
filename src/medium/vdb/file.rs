//! A VDB file: recognising it, listing its grids, and reading any of them.

use std::path::Path;

use half::f16;

use super::contents::{Contents, MAGIC};
use super::cursor::Cursor;
use super::error::VdbError;
use super::listing::Listing;
use super::load::{Memory, StoredTree, load};
use super::sparse::SparseGrid;
use super::summary::GridSummary;
use super::value::{GridValue, ValueType};
use super::{Limits, VolumeSource};
use crate::math::DAffine3;

const VERSIONS: std::ops::RangeInclusive<u32> = 222..=225;

/// An OpenVDB file in memory, its grids listed and ready to be read.
#[derive(Debug)]
pub struct VdbFile {
    name: String,
    contents: Contents,
    /// Bytes that were allocated for the file; none where the caller had them.
    held_bytes: u64,
    listing: Listing,
    summaries: Vec<GridSummary>,
}

impl VdbFile {
    /// Reads the file into memory and lists its grids.
    ///
    /// # Errors
    /// When it cannot be read, is not an OpenVDB file, is of an unknown version, or is damaged
    /// before its first grid. A grid that cannot be used is no error here: its summary says why.
    pub fn open(path: &Path) -> Result<Self, VdbError> {
        Self::open_within(path, &Limits::default())
    }

    /// As [`VdbFile::open`], with a limit of one's own. The file's bytes count towards the limit of every
    /// grid read from it, too.
    ///
    /// # Errors
    /// As [`VdbFile::open`], and when the file is larger than `limits` allows.
    pub fn open_within(path: &Path, limits: &Limits) -> Result<Self, VdbError> {
        let name = path.display().to_string();
        let contents = Contents::read(path, &name, limits)?;
        let held_bytes = contents.bytes.len() as u64;
        Self::list(name, contents, held_bytes)
    }

    /// As [`VdbFile::open`], of bytes already in memory. They count towards no limit.
    ///
    /// # Errors
    /// As [`VdbFile::open`].
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, VdbError> {
        Self::list("the VDB in memory".into(), Contents::of_bytes(bytes), 0)
    }

    /// What is left of some limits while the file's bytes are held.
    pub fn limits_beside(&self, limits: &Limits) -> Limits {
        Limits { max_bytes: limits.max_bytes.saturating_sub(self.held_bytes) }
    }

    /// A hash of all bytes of the file.
    pub fn content_hash(&self) -> u64 {
        self.contents.hash
    }

    /// Where the file breaks off, when not all of its grids could be listed.
    pub fn damage(&self) -> Option<String> {
        self.listing.damage.as_ref().map(ToString::to_string)
    }

    /// Reads a grid with its values as they are stored; `V` must be the grid's type.
    ///
    /// # Errors
    /// As [`VolumeSource::load_scalar`].
    pub fn load_stored<V: GridValue>(
        &self,
        index: usize,
        limits: &Limits,
    ) -> Result<SparseGrid<V>, VdbError> {
        let summary = self.summary(index)?;
        if summary.unusable.is_none() && summary.value_type != V::WORD {
            return Err(self.wrong_type(summary, V::WORD));
        }
        self.load_as(index, limits, |value: V| value)
    }

    /// The bytes of the file and what was found in them.
    #[cfg(feature = "vdb-rs")]
    pub(super) fn parts(&self) -> (&[u8], &Listing) {
        (&self.contents.bytes, &self.listing)
    }

    fn list(name: String, contents: Contents, held_bytes: u64) -> Result<Self, VdbError> {
        let mut cursor = Cursor::new(&contents.bytes, 0);
        if cursor.array("the header").ok() != Some(MAGIC) {
            return Err(VdbError::NotVdb { file: name });
        }
        let version = cursor.u32("the header").map_err(|fault| fault.in_file(&name))?;
        if !VERSIONS.contains(&version) {
            return Err(VdbError::Version { file: name, version });
        }
        let listing = Listing::read(&mut cursor, &contents.bytes);
        let listing = listing.map_err(|fault| fault.in_file(&name))?;
        let summaries = listing.summaries();
        Ok(Self { name, contents, held_bytes, listing, summaries })
    }

    fn summary(&self, index: usize) -> Result<&GridSummary, VdbError> {
        self.summaries.get(index).ok_or_else(|| VdbError::NoSuchIndex {
            file: self.name.clone(),
            index,
            count: self.summaries.len(),
        })
    }

    /// The tree and the transform of a grid that can be used.
    fn usable(&self, index: usize) -> Result<(&StoredTree, DAffine3), VdbError> {
        let summary = self.summary(index)?;
        match (self.listing.tree(index), summary.index_to_world, &summary.unusable) {
            (Some(tree), Some(index_to_world), None) => Ok((tree, index_to_world)),
            (_, _, reason) => Err(VdbError::Unusable {
                file: self.name.clone(),
                grid: summary.unique_name.clone(),
                reason: reason.clone().unwrap_or_default(),
            }),
        }
    }

    fn load_as<V: GridValue, O: Copy + Default + Send + Sync>(
        &self,
        index: usize,
        limits: &Limits,
        convert: impl Fn(V) -> O + Copy + Sync,
    ) -> Result<SparseGrid<O>, VdbError> {
        let (tree, index_to_world) = self.usable(index)?;
        let memory = Memory { held: self.held_bytes, limit: limits.max_bytes };
        load(&self.contents.bytes, tree, index_to_world, memory, convert)
            .map_err(|fault| fault.in_grid(&self.name, &self.summaries[index].unique_name))
    }

    fn wrong_type(&self, summary: &GridSummary, wanted: &'static str) -> VdbError {
        VdbError::WrongType {
            file: self.name.clone(),
            grid: summary.unique_name.clone(),
            value_type: summary.value_type.clone(),
            wanted,
        }
    }
}

impl VolumeSource for VdbFile {
    fn name(&self) -> &str {
        &self.name
    }

    fn grids(&self) -> &[GridSummary] {
        &self.summaries
    }

    fn load_scalar(&self, index: usize, limits: &Limits) -> Result<SparseGrid<f32>, VdbError> {
        match self.usable(index)?.0.value_type {
            ValueType::Float => self.load_as(index, limits, |value: f32| value),
            ValueType::Double => self.load_as(index, limits, |value: f64| value as f32),
            ValueType::Half => self.load_as(index, limits, f16::to_f32),
            ValueType::Int32 => self.load_as(index, limits, |value: i32| value as f32),
            ValueType::Int64 => self.load_as(index, limits, |value: i64| value as f32),
            _ => Err(self.wrong_type(&self.summaries[index], "numbers")),
        }
    }

    fn load_vector(&self, index: usize, limits: &Limits) -> Result<SparseGrid<[f32; 3]>, VdbError> {
        match self.usable(index)?.0.value_type {
            ValueType::Vec3s => self.load_as(index, limits, |value: [f32; 3]| value),
            ValueType::Vec3d => self
                .load_as(index, limits, |value: [f64; 3]| value.map(|component| component as f32)),
            _ => Err(self.wrong_type(&self.summaries[index], "vectors")),
        }
    }
}
