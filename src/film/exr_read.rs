//! Reading the colours of an EXR image: half, float or integer samples, scan lines or tiles, any
//! compression, from the first part with the channels R, G and B.
//!
//! The file is not trusted: sizes are checked before anything of that size is allocated, and a panic
//! of the decoder on damaged bytes becomes an error.

use std::fs::File;
use std::io::BufReader;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::block::UncompressedBlock;
use exr::block::lines::LineRef;
use exr::block::reader::{ChunksReader, Reader};
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, SampleType};
use exr::meta::header::Header;
use half::f16;

use super::exr_limits::{check_chunk, check_header, check_pixel_count};
use super::{FilmError, RgbImage};

/// Reads the channels R, G and B of the first part of an EXR that has them. The image is the file's
/// display window; what its pixels do not cover is black.
///
/// # Errors
/// [`FilmError::Read`], [`FilmError::Damaged`], [`FilmError::Unsupported`], [`FilmError::NoRgb`] or
/// [`FilmError::TooLarge`], each with the path.
pub fn read_rgb(path: &Path) -> Result<RgbImage, FilmError> {
    guarded(path, || {
        let reader = open(path)?;
        match choose_part(path, reader.headers(), ["R", "G", "B"])? {
            Some((part, canvas)) => read_part(path, reader, part, &canvas),
            None => Err(no_rgb(path, reader.headers())),
        }
    })
}

/// Reads the layer `variance`, the square of each pixel's standard error, of an EXR that has it.
///
/// # Errors
/// As [`read_rgb`].
pub fn read_variance(path: &Path) -> Result<Option<RgbImage>, FilmError> {
    guarded(path, || {
        let reader = open(path)?;
        let names = ["variance.R", "variance.G", "variance.B"];
        let found = choose_part(path, reader.headers(), names)?;
        found.map(|(part, canvas)| read_part(path, reader, part, &canvas)).transpose()
    })
}

/// The image of three channels of one part.
fn read_part(
    path: &Path,
    reader: Reader<BufReader<File>>,
    part: usize,
    canvas: &Canvas,
) -> Result<RgbImage, FilmError> {
    let display = canvas.display_size();
    check_pixel_count(path, display)?;
    let pixels = vec![[0.0; 3]; display.area()];
    let mut image = RgbImage { width: display.width(), height: display.height(), pixels };
    decode(reader, part, canvas, &mut image).map_err(|error| exr_error(path, error))?;
    Ok(image)
}

/// Decodes the chunks of one part into the image.
fn decode(
    reader: Reader<BufReader<File>>,
    part: usize,
    canvas: &Canvas,
    image: &mut RgbImage,
) -> exr::error::UnitResult {
    let chunks = reader.filter_chunks(false, |_, tile, block| {
        block.layer == part && tile.is_largest_resolution_level()
    })?;
    let meta = chunks.meta_data().clone();
    for chunk in chunks {
        let chunk = chunk?;
        // The offset table of a damaged file may lead to another part.
        if chunk.layer_index == part {
            check_chunk(&canvas.header, &chunk.compressed_block)?;
            canvas.insert(&UncompressedBlock::decompress_chunk(chunk, &meta, false)?, image)?;
        }
    }
    Ok(())
}

/// The headers of the file, every size in them checked against the file's length.
pub(super) fn open(path: &Path) -> Result<Reader<BufReader<File>>, FilmError> {
    let read_error = |source| FilmError::Read { path: path.to_path_buf(), source };
    let file = File::open(path).map_err(read_error)?;
    let length = file.metadata().map_err(read_error)?.len();
    let reader =
        exr::block::read(BufReader::new(file), false).map_err(|error| exr_error(path, error))?;
    for header in reader.headers() {
        check_header(path, header, length)?;
    }
    Ok(reader)
}

/// Runs `read` and turns a panic of the decoder into an error.
pub(super) fn guarded<T>(
    path: &Path,
    read: impl FnOnce() -> Result<T, FilmError>,
) -> Result<T, FilmError> {
    // Nothing that `read` changed outlives a panic: the image under construction is dropped.
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| {
        let reason = "its content contradicts itself".to_string();
        Err(FilmError::Damaged { path: path.to_path_buf(), reason })
    })
}

fn exr_error(path: &Path, error: exr::error::Error) -> FilmError {
    let path = path.to_path_buf();
    match error {
        exr::error::Error::Io(source) => FilmError::Read { path, source },
        exr::error::Error::NotSupported(reason) => {
            FilmError::Unsupported { path, reason: reason.into_owned() }
        }
        exr::error::Error::Invalid(reason) => {
            FilmError::Damaged { path, reason: reason.into_owned() }
        }
        exr::error::Error::Aborted => FilmError::Damaged { path, reason: "aborted".to_string() },
    }
}

/// The first part with the channels named, if there is one; they must not be subsampled.
fn choose_part(
    path: &Path,
    headers: &[Header],
    names: [&str; 3],
) -> Result<Option<(usize, Canvas)>, FilmError> {
    for (part, header) in headers.iter().enumerate() {
        let channel =
            |name: &str| header.channels.list.iter().position(|found| found.name.eq(name));
        let [Some(red), Some(green), Some(blue)] = names.map(channel) else { continue };
        if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
            let reason = "its channels are subsampled".to_string();
            return Err(FilmError::Unsupported { path: path.to_path_buf(), reason });
        }
        return Ok(Some((part, Canvas { header: header.clone(), rgb: [red, green, blue] })));
    }
    Ok(None)
}

fn no_rgb(path: &Path, headers: &[Header]) -> FilmError {
    let names = headers.iter().flat_map(|header| &header.channels.list);
    let names: Vec<String> = names.map(|channel| channel.name.to_string()).collect();
    FilmError::NoRgb { path: path.to_path_buf(), channels: names.join(", ") }
}

/// Where the blocks of one part lie in the image.
struct Canvas {
    header: Header,
    /// Indices of the channels read: red, green and blue.
    rgb: [usize; 3],
}

impl Canvas {
    fn display_size(&self) -> Vec2<usize> {
        self.header.shared_attributes.display_window.size
    }

    /// Copies the lines of a block to the image, moved from the data window to the display window.
    fn insert(&self, block: &UncompressedBlock, image: &mut RgbImage) -> exr::error::UnitResult {
        let Vec2(width, height) = block.index.pixel_size;
        if block.data.len() != width * height * self.header.channels.bytes_per_pixel {
            return Err(exr::error::Error::Invalid("block size".into()));
        }
        let Vec2(data_x, data_y) = self.header.own_attributes.layer_position;
        let Vec2(display_x, display_y) = self.header.shared_attributes.display_window.position;
        let offset_x = i64::from(data_x) - i64::from(display_x);
        let offset_y = i64::from(data_y) - i64::from(display_y);
        for line in block.lines(&self.header.channels) {
            let Some(component) = self.rgb.iter().position(|&index| index == line.location.channel)
            else {
                continue;
            };
            let Vec2(left, row) = line.location.position;
            let Some(row) = inside(row as i64 + offset_y, image.height) else { continue };
            let channel = &self.header.channels.list[line.location.channel];
            for (column, sample) in (left as i64 + offset_x..).zip(samples(channel, &line)?) {
                if let Some(column) = inside(column, image.width) {
                    image.pixels[row * image.width + column][component] = sample;
                }
            }
        }
        Ok(())
    }
}

fn inside(coordinate: i64, size: usize) -> Option<usize> {
    usize::try_from(coordinate).ok().filter(|&coordinate| coordinate < size)
}

/// The samples of a line as floats.
fn samples(channel: &ChannelDescription, line: &LineRef<'_>) -> exr::error::Result<Vec<f32>> {
    match channel.sample_type {
        SampleType::F16 => line.read_samples::<f16>().map(|sample| Ok(sample?.to_f32())).collect(),
        SampleType::F32 => line.read_samples::<f32>().collect(),
        SampleType::U32 => line.read_samples::<u32>().map(|sample| Ok(sample? as f32)).collect(),
    }
}
