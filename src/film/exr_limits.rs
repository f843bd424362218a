//! Limits on what an EXR file may make the decoder allocate: the file is not trusted.

use std::path::Path;

use exr::block::chunk::CompressedBlock;
use exr::compression::Compression;
use exr::error::{Error, UnitResult};
use exr::math::Vec2;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, compute_chunk_count};

use super::FilmError;

/// Largest number of pixels that is read: 16384 x 8192.
pub const MAX_PIXEL_COUNT: usize = 1 << 27;

/// Largest block that is decoded.
const MAX_BLOCK_BYTES: usize = 1 << 30;

/// Refuses images that are too large.
pub(super) fn check_pixel_count(
    path: &Path,
    Vec2(width, height): Vec2<usize>,
) -> Result<(), FilmError> {
    match width.checked_mul(height) {
        Some(count) if count <= MAX_PIXEL_COUNT => Ok(()),
        _ => Err(FilmError::TooLarge {
            path: path.to_path_buf(),
            width,
            height,
            limit: MAX_PIXEL_COUNT,
        }),
    }
}

/// Every size the decoder will allocate for must be believable: each chunk takes 8 bytes in the offset
/// table alone, and a block has at most [`MAX_BLOCK_BYTES`].
pub(super) fn check_header(
    path: &Path,
    header: &Header,
    file_length: u64,
) -> Result<(), FilmError> {
    let damaged =
        |reason: &str| FilmError::Damaged { path: path.to_path_buf(), reason: reason.to_string() };
    check_pixel_count(path, header.layer_size)?;
    if let BlockDescription::Tiles(tiles) = header.blocks {
        check_pixel_count(path, tiles.tile_size)?;
    }
    if block_bytes(header) > MAX_BLOCK_BYTES {
        let reason = "its blocks are larger than 1 GiB".to_string();
        return Err(FilmError::Unsupported { path: path.to_path_buf(), reason });
    }
    let chunk_count = compute_chunk_count(header.compression, header.layer_size, header.blocks);
    if chunk_count as u64 > file_length / 8 || chunk_count != header.chunk_count {
        return Err(damaged("it is too short for the number of its blocks"));
    }
    if header.channels.list.is_empty() {
        return Err(damaged("it has no channels"));
    }
    Ok(())
}

/// Bytes of the largest block of a part, decoded.
fn block_bytes(header: &Header) -> usize {
    let Vec2(width, height) = header.max_block_pixel_size();
    let Vec2(image_width, image_height) = header.layer_size;
    let pixel_count = width.min(image_width) * height.min(image_height);
    pixel_count.saturating_mul(header.channels.bytes_per_pixel)
}

/// Refuses a DWA chunk whose counters of decoded values cannot belong to its block: the decoder
/// allocates whatever they say.
pub(super) fn check_chunk(header: &Header, block: &CompressedBlock) -> UnitResult {
    /// Places of these counters among the eleven that open a chunk.
    const VALUE_COUNTERS: [usize; 5] = [1, 6, 7, 8, 9];
    let bytes = match (header.compression, block) {
        (Compression::DWAA(_) | Compression::DWAB(_), CompressedBlock::ScanLine(lines)) => {
            &lines.compressed_pixels_le
        }
        (Compression::DWAA(_) | Compression::DWAB(_), CompressedBlock::Tile(tile)) => {
            &tile.compressed_pixels_le
        }
        _ => return Ok(()),
    };
    let place = header.get_block_data_indices(block)?;
    let Vec2(width, height) = header.get_absolute_block_pixel_coordinates(place)?.size;
    let bytes_of = |width: usize, height: usize| {
        (width * height).saturating_mul(header.channels.bytes_per_pixel)
    };
    // Where compression would not have helped, there are bare samples and no counters.
    if bytes.len() == bytes_of(width, height) {
        return Ok(());
    }
    // Coefficients come in whole blocks of 8 x 8, and a run-length code may double its input.
    let limit = 2 * bytes_of(width.next_multiple_of(8), height.next_multiple_of(8)) as u64;
    let counter = |place: usize| bytes.get(8 * place..8 * place + 8)?.try_into().ok();
    let mut counters = VALUE_COUNTERS.into_iter().filter_map(counter).map(u64::from_le_bytes);
    if counters.any(|value| value > limit) {
        return Err(Error::Invalid("counters of a DWA chunk".into()));
    }
    Ok(())
}
