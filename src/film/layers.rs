//! The channels of a film's EXR: their names and where their values come from.

use super::{Film, Pixel};

/// What an EXR holds beside the usual layers, and in which precision. Depths and the layers of lights are written where the film has
/// them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExrOptions {
    /// Mean number of photons found a query.
    pub photon_count: bool,
    /// Mean kernel radius of the queries \[m\].
    pub kernel_radius: bool,
    /// Square of the radiance's standard error, and the number of samples behind it.
    pub variance: bool,
    /// Coverage a channel: 1 - transmittance.
    pub alpha: bool,
    /// Colours and coverage in 16 bits; what is measured (depths, variance, counts, radii) stays in 32. What is larger than the
    /// largest half, 65504, becomes that.
    pub half: bool,
}

/// One channel of the file.
pub(super) struct FilmChannel<'a> {
    pub name: String,
    /// Of the pixel of an index.
    pub value: Box<dyn Fn(usize) -> f64 + Sync + 'a>,
    pub half: bool,
}

/// A channel of a pixel.
type PixelChannel = (&'static str, fn(&Pixel) -> f64);

/// `R, G, B, A` of the whole image, then the layers it is made of. EXR groups channels by what stands
/// before the last dot.
const CHANNELS: [PixelChannel; 16] = [
    ("R", |pixel| pixel.radiance().x),
    ("G", |pixel| pixel.radiance().y),
    ("B", |pixel| pixel.radiance().z),
    ("A", Pixel::alpha),
    ("single_scatter.R", |pixel| pixel.single_scatter.x),
    ("single_scatter.G", |pixel| pixel.single_scatter.y),
    ("single_scatter.B", |pixel| pixel.single_scatter.z),
    ("multiple_scatter.R", |pixel| pixel.multiple_scatter.x),
    ("multiple_scatter.G", |pixel| pixel.multiple_scatter.y),
    ("multiple_scatter.B", |pixel| pixel.multiple_scatter.z),
    ("emission.R", |pixel| pixel.emission.x),
    ("emission.G", |pixel| pixel.emission.y),
    ("emission.B", |pixel| pixel.emission.z),
    ("transmittance.R", |pixel| pixel.transmittance.x),
    ("transmittance.G", |pixel| pixel.transmittance.y),
    ("transmittance.B", |pixel| pixel.transmittance.z),
];

/// The names that OpenEXR gives to the coverage of coloured mattes.
const ALPHA_CHANNELS: [PixelChannel; 3] = [
    ("AR", |pixel| 1.0 - pixel.transmittance.x),
    ("AG", |pixel| 1.0 - pixel.transmittance.y),
    ("AB", |pixel| 1.0 - pixel.transmittance.z),
];

const VARIANCE_CHANNELS: [PixelChannel; 4] = [
    ("variance.R", |pixel| pixel.variance.x),
    ("variance.G", |pixel| pixel.variance.y),
    ("variance.B", |pixel| pixel.variance.z),
    ("sample_count", |pixel| pixel.sample_count),
];

/// The channels of a file, in the alphabetical order that EXR demands.
pub(super) fn channels<'a>(film: &'a Film, options: &ExrOptions) -> Vec<FilmChannel<'a>> {
    let mut channels: Vec<FilmChannel> = Vec::new();
    let of_pixel = |&(name, value): &PixelChannel, half: bool| FilmChannel {
        name: name.to_string(),
        value: Box::new(move |index| value(&film.pixels[index])),
        half,
    };
    channels.extend(CHANNELS.iter().map(|channel| of_pixel(channel, options.half)));
    if options.alpha {
        channels.extend(ALPHA_CHANNELS.iter().map(|channel| of_pixel(channel, options.half)));
    }
    if options.photon_count {
        channels.push(of_pixel(&("photon_count", |pixel| pixel.photon_count), false));
    }
    if options.kernel_radius {
        channels.push(of_pixel(&("kernel_radius", |pixel| pixel.kernel_radius), false));
    }
    if options.variance {
        channels.extend(VARIANCE_CHANNELS.iter().map(|channel| of_pixel(channel, false)));
    }
    for light in &film.lights {
        channels.extend(["R", "G", "B"].into_iter().enumerate().map(|(number, channel)| {
            FilmChannel {
                name: format!("light.{}.{channel}", light.name),
                value: Box::new(move |index| light.radiance[index][number]),
                half: options.half,
            }
        }));
    }
    if let Some(depths) = &film.depths {
        let mut push = |name: &str, value: Box<dyn Fn(usize) -> f64 + Sync + 'a>| {
            channels.push(FilmChannel { name: name.to_string(), value, half: false });
        };
        push("Z", Box::new(move |index| depths[index].half()));
        push("scatter.Z", Box::new(move |index| depths[index].scatter()));
    }
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    channels
}
