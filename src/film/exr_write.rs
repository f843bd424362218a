//! Writing a film as OpenEXR: one part, 32-bit floats or halves, lossless ZIP in blocks of 16 lines.
//!
//! Equal films and metadata make equal bytes, for any number of threads.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use exr::block::UncompressedBlock;
use exr::block::writer::ChunksWriter;
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::{ChannelDescription, Chromaticities, LineOrder, SampleType, Text};
use exr::meta::header::Header;
use half::f16;

use super::layers::{FilmChannel, channels};
use super::metadata::utf8_text;
use super::{ExrOptions, Film, FilmError, RenderMetadata, write_beside};

/// Writes `film` to `path` in place of what was there, with `metadata` as text attributes.
///
/// Channels: `R, G, B` the radiance, premultiplied by nature; `A` the coverage; `single_scatter`,
/// `multiple_scatter`, `emission` and `transmittance` as `.R .G .B`; what `options` ask for; where the film has depths `Z`, the distance
/// at which half of the light is lost, and `scatter.Z`, the mean one of the first scattering; and `light.NAME` as `.R .G .B` of its
/// lights.
///
/// # Errors
/// [`FilmError::Write`]; the old file, if any, is then untouched.
pub fn write_exr(
    path: &Path,
    film: &Film,
    options: &ExrOptions,
    metadata: &RenderMetadata,
) -> Result<(), FilmError> {
    write_beside(path, |file| {
        write_part(file, film, &channels(film, options), metadata).map_err(into_io_error)?;
        sort_attributes(file)
    })
}

fn write_part(
    file: &mut File,
    film: &Film,
    channels: &[FilmChannel],
    metadata: &RenderMetadata,
) -> exr::error::UnitResult {
    let headers = [header(film, channels, metadata)].into_iter().collect();
    exr::block::write(BufWriter::new(file), headers, true, |meta, writer| {
        let Some(part) = meta.headers.first() else { return Ok(()) };
        let blocks = meta.collect_ordered_block_data(|block| {
            UncompressedBlock::collect_block_data_from_lines(&part.channels, block, |line| {
                let Vec2(left, row) = line.location.position;
                let first = row * film.width + left;
                let FilmChannel { value, half, .. } = &channels[line.location.channel];
                // The line lies in memory and has the size asked for: writing to it cannot fail.
                let _ = match half {
                    true => line.write_samples(|column| half_of(value(first + column))),
                    false => line.write_samples(|column| value(first + column) as f32),
                };
            })
        });
        writer.on_progress(|_| ()).compress_all_blocks_parallel(&meta, blocks)
    })
}

/// The nearest half; what is too large becomes the largest.
fn half_of(value: f64) -> f16 {
    let largest = f64::from(f16::MAX);
    f16::from_f64(value.clamp(-largest, largest))
}

fn header(film: &Film, channels: &[FilmChannel], metadata: &RenderMetadata) -> Header {
    let descriptions = channels.iter().map(|channel| ChannelDescription {
        name: Text::from(channel.name.as_str()),
        sample_type: if channel.half { SampleType::F16 } else { SampleType::F32 },
        quantize_linearly: false,
        sampling: Vec2(1, 1),
    });
    let mut header =
        Header::new(Text::from("film"), (film.width, film.height), descriptions.collect())
            .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing);
    header.shared_attributes.chromaticities = Some(REC_709);
    header.own_attributes.software_name =
        Some(utf8_text(concat!("photonvdb ", env!("CARGO_PKG_VERSION"))));
    header.own_attributes.other.extend(metadata.attributes());
    header
}

/// Primaries and white point of ITU-R BT.709, the colour space of all RGB here.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

fn into_io_error(error: exr::error::Error) -> io::Error {
    match error {
        exr::error::Error::Io(source) => source,
        other => io::Error::other(other.to_string()),
    }
}

/// Puts the attributes of a single-part file into alphabetical order. The `exr` crate keeps custom ones
/// in a hash map, whose order would make the bytes differ from run to run.
fn sort_attributes(file: &mut File) -> io::Result<()> {
    const MAGIC_AND_VERSION: u64 = 8;
    file.seek(SeekFrom::Start(MAGIC_AND_VERSION))?;
    let mut reader = BufReader::new(&mut *file);
    let mut attributes = Vec::new();
    while let Some(attribute) = read_attribute(&mut reader)? {
        attributes.push(attribute);
    }
    // The name stands first in an attribute's bytes, and ends with the lowest of all bytes.
    attributes.sort();
    file.seek(SeekFrom::Start(MAGIC_AND_VERSION))?;
    file.write_all(&attributes.concat())
}

/// The bytes of one attribute: name, type, size and value. `None` at the end of the header.
fn read_attribute(reader: &mut impl Read) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    let mut byte = [0];
    for _ in ["name", "type"] {
        loop {
            reader.read_exact(&mut byte)?;
            if byte == [0] && bytes.is_empty() {
                return Ok(None);
            }
            bytes.extend(byte);
            if byte == [0] {
                break;
            }
        }
    }
    let mut size = [0; 4];
    reader.read_exact(&mut size)?;
    bytes.extend(size);
    reader.take(u32::from_le_bytes(size).into()).read_to_end(&mut bytes)?;
    Ok(Some(bytes))
}
