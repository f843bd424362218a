//! A picture for a quick look: the film's radiance, exposed, tone-mapped and encoded as 8-bit sRGB.
//!
//! The curve is the identity up to [`KNEE`] and then `a + (1 - a) (1 - exp(-(x - a) / (1 - a)))`: it
//! keeps its slope at the knee and reaches white only in the limit, so that nothing clips. It works on
//! each channel, which lets bright colours fade to white.

use std::io::{self, BufWriter};
use std::path::Path;

use super::{Film, FilmError, write_beside};
use crate::math::Rgb;

/// Where the curve leaves the identity.
const KNEE: f64 = 0.6;
/// Share of the lit pixels that lie below [`WHITE_LEVEL`].
const WHITE_QUANTILE: f64 = 0.99;
/// Linear display value of the luminance at [`WHITE_QUANTILE`].
const WHITE_LEVEL: f64 = 0.85;

/// Writes `film` to `path` as an 8-bit sRGB PNG over black, in place of what was there.
///
/// `exposure` multiplies the radiance. `None` finds it in the film: the 99th percentile of the
/// luminance of all pixels that are not black becomes 0.85 of white.
///
/// # Errors
/// [`FilmError::Write`]; the old file, if any, is then untouched.
pub fn write_preview_png(path: &Path, film: &Film, exposure: Option<f64>) -> Result<(), FilmError> {
    let bytes = tone_mapped(film, exposure);
    write_beside(path, |file| {
        let dimension = |size| u32::try_from(size).map_err(io::Error::other);
        let mut encoder = png::Encoder::new(
            BufWriter::new(file),
            dimension(film.width)?,
            dimension(film.height)?,
        );
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(bytes.as_flattened())?;
        writer.finish()?;
        Ok(())
    })
}

/// The pixels of `film` as 8-bit sRGB over black, exposed as by [`write_preview_png`].
pub fn tone_mapped(film: &Film, exposure: Option<f64>) -> Vec<[u8; 3]> {
    let exposure = exposure.unwrap_or_else(|| automatic_exposure(film));
    let byte = |radiance: f64| srgb_byte(shoulder(radiance * exposure));
    film.pixels.iter().map(|pixel| pixel.radiance().to_array().map(byte)).collect()
}

/// The factor that brings the 99th percentile of the lit pixels to [`WHITE_LEVEL`]; 1 for a black film.
fn automatic_exposure(film: &Film) -> f64 {
    let luminances = film.pixels.iter().map(|pixel| luminance(pixel.radiance()));
    let mut lit: Vec<f64> = luminances.filter(|l| l.is_normal() && *l > 0.0).collect();
    if lit.is_empty() {
        return 1.0;
    }
    let rank = ((lit.len() - 1) as f64 * WHITE_QUANTILE).round() as usize;
    let (_, white, _) = lit.select_nth_unstable_by(rank, f64::total_cmp);
    inverse_shoulder(WHITE_LEVEL) / *white
}

/// Relative luminance of Rec.709 primaries.
fn luminance(color: Rgb) -> f64 {
    color.dot(Rgb::new(0.2126, 0.7152, 0.0722))
}

fn shoulder(value: f64) -> f64 {
    if value <= KNEE {
        return value;
    }
    let span = 1.0 - KNEE;
    KNEE + span * (1.0 - (-(value - KNEE) / span).exp())
}

fn inverse_shoulder(level: f64) -> f64 {
    let span = 1.0 - KNEE;
    KNEE - span * (1.0 - (level - KNEE) / span).ln()
}

/// The sRGB transfer function (IEC 61966-2-1), rounded to 8 bits. NaN becomes 0.
fn srgb_byte(linear: f64) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded =
        if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Pixel;

    #[test]
    fn shoulder_is_smooth_and_inverts() {
        let step = 1e-7;
        let slope = (shoulder(KNEE + step) - shoulder(KNEE - step)) / (2.0 * step);
        assert!((slope - 1.0).abs() < 1e-6);
        assert!((shoulder(inverse_shoulder(WHITE_LEVEL)) - WHITE_LEVEL).abs() < 1e-12);
        assert_eq!(shoulder(f64::INFINITY), 1.0);
    }

    #[test]
    fn srgb_is_exact_at_known_values() {
        let expected = [(0.0, 0), (0.215_860_5, 128), (0.5, 188), (1.0, 255), (f64::NAN, 0)];
        for (linear, byte) in expected {
            assert_eq!(srgb_byte(linear), byte, "{linear}");
        }
    }

    #[test]
    fn exposure_ignores_black_and_broken_pixels() {
        let grey = |value| Pixel { emission: Rgb::splat(value), ..Pixel::default() };
        let mut film = Film::new(100, 10);
        assert_eq!(automatic_exposure(&film), 1.0);
        film.pixels[3] = grey(2.0);
        film.pixels[4] = grey(f64::NAN);
        film.pixels[5] = grey(f64::INFINITY);
        let expected = inverse_shoulder(WHITE_LEVEL) / 2.0;
        assert!((automatic_exposure(&film) - expected).abs() < 1e-12);
    }
}
