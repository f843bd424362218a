//! The topology of a 5-4-3 tree: background, tiles of the root, nodes depth first.

use std::io::{self, Seek, Write};

use super::block::NodeValues;
use super::order::{Entry, Item};
use super::output::Output;
use super::pack::Packer;
use super::value::StoredValue;
use crate::medium::vdb::block::Layout;
use crate::medium::vdb::sparse::{SparseGrid, Tile};
use crate::medium::vdb::tree::{LOWER, Level, UPPER};

/// Writes the topology of a grid whose leaves and tiles are sorted.
pub(super) fn put_topology<V: StoredValue, W: Write + Seek>(
    grid: &SparseGrid<V>,
    entries: &[Entry],
    layout: &Layout,
    background: V,
    output: &mut Output<W>,
) -> io::Result<()> {
    let regions = || entries.chunk_by(|one, next| one.region == next.region);
    let (tile_count, child_count) = regions().fold((0u32, 0u32), |(tiles, children), region| {
        let is_tile = root_tile(grid, region).is_some();
        (tiles + u32::from(is_tile), children + u32::from(!is_tile))
    });
    let mut bytes = 1u32.to_le_bytes().to_vec();
    background.put(&mut bytes);
    bytes.extend(tile_count.to_le_bytes());
    bytes.extend(child_count.to_le_bytes());
    for tile in regions().filter_map(|region| root_tile(grid, region)) {
        put_origin(tile.origin, &mut bytes);
        tile.value.put(&mut bytes);
        bytes.push(tile.active.into());
    }
    output.put(&bytes)?;

    let mut node = NodeToWrite::new(layout, background);
    for region in regions().filter(|region| root_tile(grid, region).is_none()) {
        put_region(grid, region, &mut node, output)?;
    }
    Ok(())
}

fn root_tile<'g, V>(grid: &'g SparseGrid<V>, region: &[Entry]) -> Option<&'g Tile<V>> {
    let first = region.first().filter(|entry| entry.is_root_tile())?;
    match first.item {
        Item::Tile(index) => grid.tiles.get(index),
        Item::Leaf(_) => None,
    }
}

/// Writes a child of the root, and its children, each followed by the masks of its leaves.
fn put_region<V: StoredValue, W: Write + Seek>(
    grid: &SparseGrid<V>,
    region: &[Entry],
    node: &mut NodeToWrite<'_, V>,
    output: &mut Output<W>,
) -> io::Result<()> {
    let children = || region.chunk_by(|one, next| one.upper_place() == next.upper_place());
    let mut bytes = Vec::new();
    put_origin(region[0].region, &mut bytes);
    node.begin(UPPER);
    for child in children() {
        let place = child[0].upper_place();
        match child[0].item {
            Item::Tile(index) if child[0].is_upper_tile() => {
                node.set_tile(place, &grid.tiles[index])
            }
            _ => node.set_child(place),
        }
    }
    node.put(&mut bytes);
    output.put(&bytes)?;

    for child in children().filter(|child| !child[0].is_upper_tile()) {
        bytes.clear();
        node.begin(LOWER);
        for entry in child {
            match entry.item {
                Item::Tile(index) => node.set_tile(entry.lower_place(), &grid.tiles[index]),
                Item::Leaf(_) => node.set_child(entry.lower_place()),
            }
        }
        node.put(&mut bytes);
        for entry in child {
            if let Item::Leaf(index) = entry.item {
                put_mask(&grid.masks[index], &mut bytes);
            }
        }
        output.put(&bytes)?;
    }
    Ok(())
}

/// A node between root and leaves in the making.
#[derive(Debug)]
struct NodeToWrite<'l, V> {
    layout: &'l Layout,
    background: V,
    children: Vec<u64>,
    active: Vec<u64>,
    values: Vec<V>,
    packer: Packer,
}

impl<'l, V: StoredValue> NodeToWrite<'l, V> {
    fn new(layout: &'l Layout, background: V) -> Self {
        Self {
            layout,
            background,
            children: Vec::new(),
            active: Vec::new(),
            values: Vec::new(),
            packer: Packer::new(),
        }
    }

    /// A node that is all background.
    fn begin(&mut self, level: Level) {
        let Self { children, active, values, .. } = self;
        for mask in [children, active] {
            mask.clear();
            mask.resize(level.len() / 64, 0);
        }
        values.clear();
        values.resize(level.len(), self.background);
    }

    fn set_tile(&mut self, place: usize, tile: &Tile<V>) {
        self.values[place] = tile.value;
        self.active[place >> 6] |= u64::from(tile.active) << (place & 63);
    }

    fn set_child(&mut self, place: usize) {
        self.children[place >> 6] |= 1 << (place & 63);
        self.values[place] = V::default();
    }

    fn put(&mut self, bytes: &mut Vec<u8>) {
        put_mask(&self.children, bytes);
        put_mask(&self.active, bytes);
        let values = NodeValues {
            values: &self.values,
            active: &self.active,
            children: &self.children,
            background: self.background,
        };
        values.put(self.layout, &mut self.packer, bytes);
    }
}

fn put_origin(origin: [i32; 3], bytes: &mut Vec<u8>) {
    origin.iter().for_each(|along| bytes.extend(along.to_le_bytes()));
}

/// Appends the bits of a mask.
pub(super) fn put_mask(mask: &[u64], bytes: &mut Vec<u8>) {
    mask.iter().for_each(|word| bytes.extend(word.to_le_bytes()));
}
