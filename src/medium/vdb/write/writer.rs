//! A VDB file in the making: header, then each grid's entry and body.
//!
//! An entry says where its grid begins and ends, and the header bears a hash of everything; both are
//! written over zeros once they are known.

use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

use super::error::{GridProblem, VdbWriteError};
use super::grid::{GridToWrite, ValuesToWrite};
use super::leaves::put_leaves;
use super::metadata::{metadata_bytes, put_string};
use super::names::unique_names;
use super::options::WriteOptions;
use super::order::entries_in_order;
use super::output::Output;
use super::statistics::Statistics;
use super::transform::transform_bytes;
use super::tree::put_topology;
use super::value::StoredValue;
use crate::files::{WriteFailure, write_beside};
use crate::medium::vdb::block::Layout;
use crate::medium::vdb::contents::MAGIC;
use crate::medium::vdb::descriptor::{HALF_SUFFIX, SEPARATOR, shown_name};
use crate::medium::vdb::listing::UUID_LEN;
use crate::medium::vdb::sparse::SparseGrid;

const VERSION: u32 = 224;
/// Release of the OpenVDB library whose files these are like.
const LIBRARY_VERSION: [u32; 2] = [10, 0];
/// Mark, version, library version, flag of offsets.
const UUID_POSITION: u64 = 21;
const MAX_NAME_LEN: usize = u16::MAX as usize;

/// Writes grids to `path`, in place of what was there.
///
/// # Errors
/// When a grid cannot be written, or the file cannot; what was at `path` is then untouched.
pub fn write_vdb(
    path: &Path,
    grids: &[GridToWrite<'_>],
    options: &WriteOptions,
) -> Result<Vec<WrittenGrid>, VdbWriteError> {
    write_beside(path, |file| {
        let names: Vec<&str> = grids.iter().map(|grid| grid.name).collect();
        let mut writer = VdbWriter::new(file, path, &names, options)?;
        let written = grids.iter().map(|grid| writer.write_grid(grid)).collect::<Result<_, _>>()?;
        writer.finish()?;
        Ok(written)
    })
}

/// Writes a VDB file grid by grid, so that only one of them must be in memory.
#[derive(Debug)]
pub struct VdbWriter<W: Write> {
    output: Output<W>,
    path: PathBuf,
    options: WriteOptions,
    /// Name and unique name of every grid the file is to hold.
    names: Vec<(String, String)>,
    written_count: usize,
}

/// What was written of a grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenGrid {
    /// Name that no other grid of the file has, as readers show it: `density[1]`.
    pub unique_name: String,
    /// Active voxels, those in tiles included.
    pub active_voxel_count: u64,
    /// Size in the file \[bytes\].
    pub byte_count: u64,
}

impl<W: Write + Seek> VdbWriter<W> {
    /// Begins a file that will hold grids of these `names`, in their order. `output` is at its
    /// beginning and is called `path` in messages.
    ///
    /// # Errors
    /// When a name cannot be written, or `output` fails.
    pub fn new(
        output: W,
        path: &Path,
        names: &[&str],
        options: &WriteOptions,
    ) -> Result<Self, VdbWriteError> {
        let is_refused = |name: &&&str| name.len() > MAX_NAME_LEN || name.contains(SEPARATOR);
        if let Some(name) = names.iter().find(is_refused) {
            return Err(VdbWriteError::Grid {
                path: path.to_path_buf(),
                grid: name.chars().take(40).collect(),
                problem: GridProblem::Name,
            });
        }
        let pairs = names.iter().map(|name| name.to_string()).zip(unique_names(names));
        let mut writer = Self {
            output: Output::new(output),
            path: path.to_path_buf(),
            options: *options,
            names: pairs.collect(),
            written_count: 0,
        };
        writer.put_header().map_err(|source| writer.failure(source))?;
        Ok(writer)
    }

    /// Writes the next grid.
    ///
    /// # Errors
    /// When it has another name than the next of the list, when its leaves and tiles do not fit
    /// together, or the output fails. The file is then not to be used.
    pub fn write_grid(&mut self, grid: &GridToWrite<'_>) -> Result<WrittenGrid, VdbWriteError> {
        let unique_name = match self.names.get(self.written_count) {
            Some((name, unique_name)) if name == grid.name => unique_name.clone(),
            _ => return Err(self.out_of_order(Some(grid.name.to_owned()))),
        };
        self.written_count += 1;
        match grid.values {
            ValuesToWrite::Float(values) => self.put_grid(grid, values, &unique_name),
            ValuesToWrite::Vec3(values) => self.put_grid(grid, values, &unique_name),
        }
    }

    /// Completes the file and returns the output.
    ///
    /// # Errors
    /// When not all grids were written, or the output fails.
    pub fn finish(mut self) -> Result<W, VdbWriteError> {
        if self.written_count < self.names.len() {
            return Err(self.out_of_order(None));
        }
        let path = std::mem::take(&mut self.path);
        let uuid = self.output.uuid();
        let patched = self.output.patch(UUID_POSITION, uuid.as_bytes());
        patched
            .and_then(|()| self.output.into_inner())
            .map_err(|source| WriteFailure { path, source }.into())
    }

    fn put_header(&mut self) -> io::Result<()> {
        let grid_count = u32::try_from(self.names.len()).map_err(io::Error::other)?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        LIBRARY_VERSION.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        bytes.push(1);
        bytes.extend([0; UUID_LEN]);
        let metadata_count = 0u32;
        bytes.extend(metadata_count.to_le_bytes());
        bytes.extend(grid_count.to_le_bytes());
        self.output.put(&bytes)
    }

    fn put_grid<V: StoredValue>(
        &mut self,
        grid: &GridToWrite<'_>,
        values: &SparseGrid<V>,
        unique_name: &str,
    ) -> Result<WrittenGrid, VdbWriteError> {
        let refused = |problem| VdbWriteError::Grid {
            path: self.path.clone(),
            grid: shown_name(unique_name),
            problem,
        };
        let entries = entries_in_order(values).map_err(refused)?;
        let statistics = Statistics::of(values, &entries);
        let compression = self.options.compression.compression();
        let mut head = compression.flags().to_le_bytes().to_vec();
        head.extend(metadata_bytes(grid, &statistics, &self.options).map_err(refused)?);
        head.extend(transform_bytes(&values.index_to_world).map_err(refused)?);

        let layout = Layout::new(V::TYPE, self.options.half || grid.half, compression);
        let background =
            if layout.is_half { values.background.rounded() } else { values.background };
        let output = &mut self.output;
        let entry = entry_bytes::<V>(unique_name, layout.is_half);
        let written = output.put(&entry).and_then(|()| {
            let offsets_position = output.position();
            output.put(&[0; 24])?;
            let start = output.position();
            output.put(&head)?;
            put_topology(values, &entries, &layout, background, output)?;
            let values_start = output.position();
            put_leaves(values, &entries, &layout, background, output)?;
            let end = output.position();
            let offsets: Vec<u8> =
                [start, values_start, end].iter().flat_map(|offset| offset.to_le_bytes()).collect();
            output.patch(offsets_position, &offsets)?;
            Ok(end - start)
        });
        let byte_count = written.map_err(|source| self.failure(source))?;
        Ok(WrittenGrid {
            unique_name: shown_name(unique_name),
            active_voxel_count: statistics.active_voxel_count,
            byte_count,
        })
    }

    fn failure(&self, source: io::Error) -> VdbWriteError {
        WriteFailure { path: self.path.clone(), source }.into()
    }

    fn out_of_order(&self, got: Option<String>) -> VdbWriteError {
        VdbWriteError::Order {
            path: self.path.clone(),
            names: self.names.iter().map(|(name, _)| name.clone()).collect(),
            got,
        }
    }
}

/// The entry of a grid up to its offsets: name, type, and no parent.
fn entry_bytes<V: StoredValue>(unique_name: &str, is_half: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    put_string(&mut bytes, unique_name);
    let suffix = if is_half { HALF_SUFFIX } else { "" };
    put_string(&mut bytes, &format!("Tree_{}_5_4_3{suffix}", V::WORD));
    put_string(&mut bytes, "");
    bytes
}
