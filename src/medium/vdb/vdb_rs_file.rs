//! A second reader: the public crate [`vdb-rs`](https://crates.io/crates/vdb-rs) 0.6, for the grids it
//! reads right. Feature `vdb-rs`; its Blosc is C.
//!
//! What `vdb-rs` does not know it misreads without a word (backgrounds, tiles at the root, types
//! other than `float` and `int32`), and on files it does not expect it panics, claims memory without
//! end, or writes past a buffer (a Blosc frame that lies). So [`VdbFile`] decides: it refuses, with
//! the reason, every grid of a kind that would be misread, and reads a grid through before `vdb-rs` sees
//! it. The grid is handed over as a file of its own, with no metadata and no other grids, which
//! `vdb-rs` would read first and trust. Nothing of `vdb-rs` shows in what is returned: it is compared
//! voxel for voxel with [`VdbFile`]'s in the tests.

use std::io::Cursor as Seekable;
use std::path::Path;

use vdb_rs::{Grid, Index, Map, Node, ParseError, VdbReader};

use super::contents::MAGIC;
use super::cursor::Cursor;
use super::error::VdbError;
use super::fault::Fault;
use super::file::VdbFile;
use super::metadata::Metadata;
use super::sparse::{SparseGrid, Tile};
use super::summary::{Census, GridSummary};
use super::tree::{LEAF_LEN, ROOT_DIM};
use super::value::GridValue;
use super::{Limits, VolumeSource};
use crate::math::{DAffine3, DMat3, DVec3};

/// What the grid is called in the file made for `vdb-rs`.
const NAME: &str = "grid";
/// A version of the format in which `vdb-rs` reads grids as they are read here.
const VERSION: u32 = 224;
const MAPS: [&str; 3] = ["UniformScaleMap", "UniformScaleTranslateMap", "ScaleTranslateMap"];
const WAY_OUT: &str = "read it with VdbFile";

/// An OpenVDB file whose grids `vdb-rs` reads. It is listed by [`VdbFile`]; a grid that `vdb-rs` would
/// misread is listed as unusable, with the reason.
///
/// ```
/// use photonvdb::medium::vdb::{Limits, VdbRsFile, VolumeSource, find_density};
///
/// # fn main() -> Result<(), photonvdb::medium::vdb::VdbError> {
/// let file = VdbRsFile::open("media/smoke_plume.vdb".as_ref())?;
/// let density = find_density(&file, "density", true)?;
/// let grid = file.load_scalar(density, &Limits::default())?;
/// # assert_eq!(grid.leaves.len() as u64, file.grids()[density].leaf_count);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct VdbRsFile {
    file: VdbFile,
    summaries: Vec<GridSummary>,
}

impl VdbRsFile {
    /// Reads the file into memory and lists its grids.
    ///
    /// # Errors
    /// As [`VdbFile::open`].
    pub fn open(path: &Path) -> Result<Self, VdbError> {
        VdbFile::open(path).map(Self::over)
    }

    /// As [`VdbRsFile::open`], of bytes already in memory.
    ///
    /// # Errors
    /// As [`VdbFile::from_bytes`].
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, VdbError> {
        VdbFile::from_bytes(bytes).map(Self::over)
    }

    fn over(file: VdbFile) -> Self {
        let listed = file.grids().iter().enumerate().map(|(index, summary)| {
            let refusal = || misread(&file, index, summary).map(|why| format!("{why}; {WAY_OUT}"));
            let unusable = summary.unusable.clone().or_else(refusal);
            GridSummary { unusable, ..summary.clone() }
        });
        let summaries = listed.collect();
        Self { file, summaries }
    }

    /// The grid of a kind that can be read.
    fn usable(&self, index: usize) -> Result<&GridSummary, VdbError> {
        let summary = self.summaries.get(index).ok_or_else(|| VdbError::NoSuchIndex {
            file: self.name().to_owned(),
            index,
            count: self.summaries.len(),
        })?;
        match &summary.unusable {
            Some(reason) => Err(VdbError::Unusable {
                file: self.name().to_owned(),
                grid: summary.unique_name.clone(),
                reason: reason.clone(),
            }),
            None => Ok(summary),
        }
    }

    /// Reads the grid through, then lets `vdb-rs` read it.
    fn load<V: GridValue>(
        &self,
        index: usize,
        limits: &Limits,
        read: impl Fn(&mut VdbReader<Seekable<Vec<u8>>>) -> Result<Grid<V>, ParseError>,
        to_f32: impl Fn(V) -> f32,
    ) -> Result<SparseGrid<f32>, VdbError> {
        let sound = self.file.load_stored::<V>(index, limits)?;
        let has_root_tile = sound.tiles.iter().any(|tile| tile.dim == ROOT_DIM.unsigned_abs());
        let background = to_f32(sound.background);
        drop(sound);

        let grid = if has_root_tile {
            Err(refused("it has tiles at the root, which vdb-rs drops"))
        } else {
            self.alone(index).and_then(|file| {
                VdbReader::new(Seekable::new(file))
                    .and_then(|mut reader| read(&mut reader))
                    .map_err(|error| refused(&format!("vdb-rs cannot read it ({error})")))
            })
        };
        grid.and_then(|grid| plain(&grid, background, to_f32))
            .map_err(|fault| fault.in_grid(self.name(), &self.summaries[index].unique_name))
    }

    /// A file with this grid alone, without metadata.
    fn alone(&self, index: usize) -> Result<Vec<u8>, Fault> {
        const WHAT: &str = "the grid";
        let (bytes, listing) = self.file.parts();
        let parts = listing.descriptor(index).zip(listing.tree(index));
        let (descriptor, tree) = parts.ok_or(Fault::EndsEarly(WHAT))?;
        let start = usize::try_from(descriptor.start).map_err(|_| Fault::EndsEarly(WHAT))?;
        let mut head = Cursor::new(bytes, start);
        let compression = head.u32(WHAT)?;
        Metadata::read(&mut head)?;
        let mut topology = Cursor::new(bytes, tree.start);
        Census::take(&mut topology, tree.value_type, &tree.layout)?;
        let values_start = topology.position();
        let body = bytes.get(head.position()..tree.end).ok_or(Fault::EndsEarly(WHAT))?;

        let mut file = MAGIC.to_vec();
        file.extend(VERSION.to_le_bytes());
        // Version of the library, presence of offsets, a UUID, no metadata, one grid.
        file.extend([0; 8]);
        file.push(1);
        file.extend([b'0'; 36]);
        file.extend(0u32.to_le_bytes());
        file.extend(1u32.to_le_bytes());
        for text in [NAME, &descriptor.tree, ""] {
            file.extend((text.len() as u32).to_le_bytes());
            file.extend(text.as_bytes());
        }
        // Places of the grid, of its values and of its end, then the grid: compression, no metadata.
        let grid_start = file.len() + 24;
        let body_start = grid_start + 8;
        let values = body_start + (values_start - head.position());
        for place in [grid_start, values, body_start + body.len()] {
            file.extend((place as u64).to_le_bytes());
        }
        file.extend(compression.to_le_bytes());
        file.extend(0u32.to_le_bytes());
        file.extend(body);
        Ok(file)
    }
}

impl VolumeSource for VdbRsFile {
    fn name(&self) -> &str {
        self.file.name()
    }

    fn grids(&self) -> &[GridSummary] {
        &self.summaries
    }

    fn load_scalar(&self, index: usize, limits: &Limits) -> Result<SparseGrid<f32>, VdbError> {
        if self.usable(index)?.value_type == i32::WORD {
            self.load(index, limits, |reader| reader.read_grid::<i32>(NAME), |value| value as f32)
        } else {
            self.load(index, limits, |reader| reader.read_grid::<f32>(NAME), |value| value)
        }
    }

    fn load_vector(&self, index: usize, _: &Limits) -> Result<SparseGrid<[f32; 3]>, VdbError> {
        let summary = self.usable(index)?;
        Err(VdbError::WrongType {
            file: self.name().to_owned(),
            grid: summary.unique_name.clone(),
            value_type: summary.value_type.clone(),
            wanted: "vectors",
        })
    }
}

fn refused(why: &str) -> Fault {
    Fault::Unsupported(format!("{why}; {WAY_OUT}"))
}

/// Why `vdb-rs` would not read the grid as it is, as far as can be told before its values are read.
fn misread(file: &VdbFile, index: usize, summary: &GridSummary) -> Option<String> {
    let descriptor = file.parts().1.descriptor(index)?;
    let value_type = summary.value_type.as_str();
    if ![f32::WORD, i32::WORD].contains(&value_type) {
        return Some(format!("it holds {value_type} values and vdb-rs reads only float and int32"));
    }
    if summary.half && value_type == f32::WORD {
        return Some("its values are saved as halves, which vdb-rs may misread".into());
    }
    if !MAPS.contains(&summary.map.as_str()) {
        return Some(format!("its transform is a {} and vdb-rs reads only scales", summary.map));
    }
    if summary.background.map(f64::to_bits) != Some(0) {
        return Some("its background is not 0, and vdb-rs takes it for 0".into());
    }
    if descriptor.parent.is_some() {
        return Some("it shares the tree of another grid, which vdb-rs does not look up".into());
    }
    if descriptor.start == 0 {
        return Some("it was written to a stream, and vdb-rs needs the places of grids".into());
    }
    None
}

/// The grid in plain form, nodes in the order of the file.
fn plain<V: GridValue>(
    grid: &Grid<V>,
    background: f32,
    to_f32: impl Fn(V) -> f32,
) -> Result<SparseGrid<f32>, Fault> {
    const WHAT: &str = "the tree as vdb-rs has it";
    let mut sparse = SparseGrid {
        background,
        index_to_world: index_to_world(&grid.transform),
        leaves: Vec::new(),
        masks: Vec::new(),
        values: Vec::new(),
        tiles: Vec::new(),
    };
    for upper in &grid.tree.root_nodes {
        let is_tile = |place: usize| (!upper.child_mask[place]).then(|| upper.value_mask[place]);
        push_tiles(&mut sparse.tiles, upper, &upper.data, is_tile, &to_f32);
        for place in upper.child_mask.iter_ones() {
            let lower = upper.nodes.get(&(place as u32)).ok_or(Fault::EndsEarly(WHAT))?;
            let is_tile =
                |place: usize| (!lower.child_mask[place]).then(|| lower.value_mask[place]);
            push_tiles(&mut sparse.tiles, lower, &lower.data, is_tile, &to_f32);
            for place in lower.child_mask.iter_ones() {
                let leaf = lower.nodes.get(&(place as u32)).ok_or(Fault::EndsEarly(WHAT))?;
                let mask = leaf.value_mask.as_raw_slice().first_chunk();
                let values: Option<&[V; LEAF_LEN]> = leaf.buffer.first_chunk();
                let (mask, values) = mask.zip(values).ok_or(Fault::EndsEarly(WHAT))?;
                sparse.leaves.push(leaf.origin.to_array());
                sparse.masks.push(*mask);
                sparse.values.extend(values.iter().map(|&value| to_f32(value)));
            }
        }
    }
    Ok(sparse)
}

/// The tiles of a node: the active ones, then those inactive with a value other than 0. `is_tile` says
/// of a place whether there is a tile, and whether it is active.
fn push_tiles<V: GridValue, N: Node>(
    tiles: &mut Vec<Tile<f32>>,
    node: &N,
    values: &[V],
    is_tile: impl Fn(usize) -> Option<bool>,
    to_f32: impl Fn(V) -> f32,
) {
    for active in [true, false] {
        for (place, &value) in values.iter().enumerate() {
            if is_tile(place) == Some(active) && (active || !value.is_same(V::default())) {
                tiles.push(Tile {
                    origin: node.offset_to_global_coord(Index(place as u32)).0.to_array(),
                    dim: 1 << N::TOTAL,
                    value: to_f32(value),
                    active,
                });
            }
        }
    }
}

/// The map as `vdb-rs` read it. Its vectors are of an older version of glam.
fn index_to_world(map: &Map) -> DAffine3 {
    let (scale, translation) = match map {
        Map::UniformScaleMap { scale_values, .. } => (scale_values.to_array(), [0.0; 3]),
        Map::ScaleTranslateMap { scale_values, translation, .. } => {
            (scale_values.to_array(), translation.to_array())
        }
    };
    DAffine3 {
        matrix3: DMat3::from_diagonal(DVec3::from_array(scale)),
        translation: DVec3::from_array(translation),
    }
}
