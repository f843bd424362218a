//! What an EXR file holds, without its pixels.

use std::path::Path;

use exr::meta::attribute::{AttributeValue, SampleType, Text};
use exr::meta::header::Header;

use super::FilmError;
use super::exr_read::{guarded, open};

/// The parts of an EXR file.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrDescription {
    /// At least one.
    pub parts: Vec<ExrPart>,
}

/// One part: an image with channels of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrPart {
    /// Name of the part; files of one part often leave it out.
    pub name: Option<String>,
    /// \[pixels\]
    pub width: usize,
    /// \[pixels\]
    pub height: usize,
    /// How the pixels are compressed, as the `exr` crate names it.
    pub compression: String,
    /// Name and sample type (`half`, `float` or `uint`) of each channel, in alphabetical order.
    pub channels: Vec<(String, &'static str)>,
    /// Name and value of each descriptive attribute that is text or a number, in alphabetical order.
    pub attributes: Vec<(String, String)>,
}

impl ExrPart {
    /// The layers: what stands before the last dot of the channel names, `""` for channels without a
    /// dot, each with its channels.
    pub fn layers(&self) -> Vec<(&str, Vec<&str>)> {
        let mut layers: Vec<(&str, Vec<&str>)> = Vec::new();
        for (name, _) in &self.channels {
            let (layer, channel) = name.rsplit_once('.').unwrap_or(("", name));
            match layers.iter_mut().find(|(existing, _)| *existing == layer) {
                Some((_, channels)) => channels.push(channel),
                None => layers.push((layer, vec![channel])),
            }
        }
        layers
    }
}

/// Reads the headers of an EXR file.
///
/// # Errors
/// [`FilmError::Read`], [`FilmError::Damaged`], [`FilmError::Unsupported`] or [`FilmError::TooLarge`].
pub fn describe_exr(path: &Path) -> Result<ExrDescription, FilmError> {
    guarded(path, || {
        let reader = open(path)?;
        Ok(ExrDescription { parts: reader.headers().iter().map(describe_part).collect() })
    })
}

/// Attributes that other fields say already, or that only a decoder needs.
const STRUCTURAL: [&[u8]; 5] =
    [b"name", b"chunkCount", b"pixelAspectRatio", b"screenWindowWidth", b"type"];

fn describe_part(header: &Header) -> ExrPart {
    let channels = header.channels.list.iter().map(|channel| {
        let sample_type = match channel.sample_type {
            SampleType::F16 => "half",
            SampleType::F32 => "float",
            SampleType::U32 => "uint",
        };
        (utf8(&channel.name), sample_type)
    });
    let mut attributes: Vec<(String, String)> = header
        .all_named_attributes()
        .filter(|(name, _)| !STRUCTURAL.contains(name))
        .filter_map(|(name, value)| {
            Some((String::from_utf8_lossy(name).into_owned(), readable(&value)?))
        })
        .collect();
    attributes.sort();
    ExrPart {
        name: header.own_attributes.layer_name.as_ref().map(utf8),
        width: header.layer_size.width(),
        height: header.layer_size.height(),
        compression: header.compression.to_string(),
        channels: channels.collect(),
        attributes,
    }
}

fn readable(value: &AttributeValue) -> Option<String> {
    match value {
        AttributeValue::Text(text) => Some(utf8(text)),
        AttributeValue::F32(number) => Some(number.to_string()),
        AttributeValue::F64(number) => Some(number.to_string()),
        AttributeValue::I32(number) => Some(number.to_string()),
        _ => None,
    }
}

fn utf8(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}
