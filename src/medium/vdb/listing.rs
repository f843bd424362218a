//! The grids of a file, found without reading their values.
//!
//! After mark and version come: library version (two numbers), a byte that says whether grids have
//! offsets, a UUID of 36 characters, metadata, and the number of grids. Each grid has an entry; its
//! body is compression, metadata, transform, tree. A file written to a stream has no offsets: its
//! grids follow one another, and each must be walked over to find the next.

use std::collections::HashMap;

use super::block::Layout;
use super::codec::Compression;
use super::cursor::Cursor;
use super::descriptor::Descriptor;
use super::fault::Fault;
use super::load::StoredTree;
use super::metadata::Metadata;
use super::summary::{Census, GridSummary};
use super::transform::Transform;
use super::tree::skip_leaf;
use super::value::ValueType;
use crate::math::DAffine3;

pub(super) const UUID_LEN: usize = 36;
const WHAT: &str = "the header";

/// The grids of a file.
#[derive(Debug)]
pub(super) struct Listing {
    grids: Vec<ListedGrid>,
    /// Index of the first grid of each unique name that has a tree of its own.
    owners: HashMap<String, usize>,
    /// Why the list is not complete, if it is not.
    pub damage: Option<Fault>,
}

impl Listing {
    /// Reads the header after the version, and every grid up to its values. Fails when not even one
    /// is found.
    pub(super) fn read<'a>(cursor: &mut Cursor<'a>, bytes: &'a [u8]) -> Result<Self, Fault> {
        let _library_version = cursor.array::<8>(WHAT)?;
        let has_offsets = cursor.u8(WHAT)? != 0;
        cursor.take(UUID_LEN, WHAT)?;
        Metadata::read(cursor)?;
        let count = cursor.u32("the number of grids")?;

        let mut grids = Vec::new();
        let mut damage = None;
        for _ in 0..count {
            let next = ListedGrid::read(cursor, bytes, has_offsets, &mut grids);
            if let Err(fault) = next {
                damage = Some(fault);
                break;
            }
        }
        if let (Some(fault), true) = (&damage, grids.is_empty()) {
            return Err(fault.clone());
        }
        let owners =
            grids.iter().enumerate().rev().filter(|(_, grid)| grid.descriptor.parent.is_none());
        let owners =
            owners.map(|(index, grid)| (grid.descriptor.unique_name.clone(), index)).collect();
        // Nothing is missing when it is the last grid that breaks off: that grid says so itself.
        let damage = damage.filter(|_| grids.len() < count as usize);
        Ok(Self { grids, owners, damage })
    }

    /// What there is to say of each grid.
    pub(super) fn summaries(&self) -> Vec<GridSummary> {
        self.grids.iter().map(|grid| self.summary(grid)).collect()
    }

    /// The tree of a grid, its own or the one it shares, when it can be read.
    pub(super) fn tree(&self, index: usize) -> Option<&StoredTree> {
        self.owner(self.grids.get(index)?).ok()?.readable_tree().ok()
    }

    /// The grid whose tree this one has: itself, or the one it is an instance of.
    fn owner<'g>(&'g self, grid: &'g ListedGrid) -> Result<&'g ListedGrid, Fault> {
        let Some(parent) = &grid.descriptor.parent else {
            return Ok(grid);
        };
        let owner = self.owners.get(parent).and_then(|&index| self.grids.get(index));
        owner.ok_or_else(|| {
            Fault::invalid(format!("it shares the tree of a grid {parent:?} that is not there"))
        })
    }

    fn summary(&self, grid: &ListedGrid) -> GridSummary {
        let owner = self.owner(grid);
        let readable = owner.clone().and_then(ListedGrid::readable_tree);
        let owner = owner.unwrap_or(grid);
        let tree = owner.tree.as_ref();
        let census = tree.map(|tree| &tree.census);
        let metadata = &owner.metadata;
        let transform = grid.transform();
        let unusable = readable.err().or_else(|| transform.err().cloned());
        GridSummary {
            name: grid.descriptor.name().to_owned(),
            unique_name: grid.descriptor.shown_name(),
            value_type: owner.value_type.clone(),
            class: grid.metadata.class.clone().unwrap_or_else(|| "unknown".into()),
            half: owner.descriptor.is_half,
            compression: owner.compression.map_or_else(String::new, Compression::words),
            map: grid
                .transform
                .as_ref()
                .map_or_else(String::new, |transform| transform.map.clone()),
            index_to_world: transform.ok().copied(),
            background: tree.and_then(|tree| tree.census.background(tree.value_type)),
            active_bbox: census.map_or_else(|| metadata.bbox(), |census| census.bbox),
            active_voxel_count: census
                .map_or(metadata.voxel_count.unwrap_or(0), |census| census.active_voxel_count),
            active_tile_count: census.map_or(0, |census| census.active_tile_count),
            leaf_count: census.map_or(0, Census::leaf_count),
            memory_bytes: tree.map_or(0, |tree| {
                let component_count = if tree.value_type.is_scalar() { 1 } else { 3 };
                tree.memory_bytes(component_count * size_of::<f32>())
            }),
            metadata: grid.metadata.further.clone(),
            unusable: unusable.map(|fault| fault.to_string()),
        }
    }
}

/// A grid as found: what could be read of it, and what stopped the reading.
#[derive(Debug)]
struct ListedGrid {
    descriptor: Descriptor,
    value_type: String,
    compression: Option<Compression>,
    metadata: Metadata,
    transform: Option<Transform>,
    tree: Option<StoredTree>,
    fault: Option<Fault>,
}

impl ListedGrid {
    /// Reads the entry at the cursor and the grid it tells of, adds the grid, and moves the cursor
    /// to the next entry. Fails when it is not known where that one begins.
    fn read<'a>(
        cursor: &mut Cursor<'a>,
        bytes: &'a [u8],
        has_offsets: bool,
        grids: &mut Vec<Self>,
    ) -> Result<(), Fault> {
        let mut grid = Self::entered(Descriptor::read(cursor)?);
        let next = if has_offsets {
            grid.read_in_place(cursor, bytes)
        } else {
            grid.read_in_stream(cursor)
        };
        grids.push(grid);
        next
    }

    /// A grid of which only the entry is known.
    fn entered(descriptor: Descriptor) -> Self {
        let (value_type, _) = ValueType::of_tree(&descriptor.tree);
        Self {
            descriptor,
            value_type,
            compression: None,
            metadata: Metadata::default(),
            transform: None,
            tree: None,
            fault: None,
        }
    }

    /// Reads the grid where its entry says it is. Its own faults stay its own: the next entry is
    /// known.
    fn read_in_place<'a>(&mut self, cursor: &mut Cursor<'a>, bytes: &'a [u8]) -> Result<(), Fault> {
        let place = self.descriptor.place(cursor.position(), bytes.len());
        let place = place.inspect_err(|fault| self.fault = Some(fault.clone()))?;
        let mut body = Cursor::new(&bytes[..place.end], place.start);
        self.fault = self.read_body(&mut body, place.end).err();
        *cursor = Cursor::new(bytes, place.end);
        Ok(())
    }

    /// Reads the grid at the cursor and moves the cursor behind it.
    fn read_in_stream(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Fault> {
        let end = self.read_body(cursor, usize::MAX).and_then(|()| self.skip_values(cursor));
        end.inspect_err(|fault| self.fault = Some(fault.clone()))
    }

    /// Reads everything before the values.
    fn read_body(&mut self, cursor: &mut Cursor<'_>, end: usize) -> Result<(), Fault> {
        let compression = Compression::from_flags(cursor.u32("the grid")?)?;
        self.compression = Some(compression);
        self.metadata = Metadata::read(cursor)?;
        self.transform = Some(Transform::read(cursor)?);
        if self.descriptor.parent.is_some() {
            return Ok(());
        }
        let value_type = ValueType::of_tree(&self.descriptor.tree).1?;
        let layout = Layout::new(value_type, self.descriptor.is_half, compression);
        let start = cursor.position();
        let census = Census::take(cursor, &layout)?;
        self.tree = Some(StoredTree { value_type, layout, start, end, census });
        Ok(())
    }

    /// Moves the cursor over the values of the leaves.
    fn skip_values(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Fault> {
        if let Some(tree) = &mut self.tree {
            for &active_count in &tree.census.leaf_active_counts {
                skip_leaf(cursor, tree.value_type, &tree.layout, usize::from(active_count))?;
            }
            tree.end = cursor.position();
        }
        Ok(())
    }

    fn transform(&self) -> Result<&DAffine3, &Fault> {
        match &self.transform {
            Some(transform) => transform.index_to_world.as_ref(),
            None => Err(self.fault.as_ref().unwrap_or(&Fault::EndsEarly("the transform"))),
        }
    }

    /// The tree, or why it cannot be read.
    fn readable_tree(&self) -> Result<&StoredTree, Fault> {
        match (&self.fault, &self.tree) {
            (None, Some(tree)) => tree.value_type.refusal().map_or(Ok(tree), Err),
            (None, None) => Err(Fault::EndsEarly("the grid")),
            (Some(fault), _) => Err(fault.clone()),
        }
    }
}
