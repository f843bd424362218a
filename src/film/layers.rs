//! The channels of a film's EXR: their names and where their values come from.

use super::Pixel;

/// Layers written only when asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExtraLayers {
    /// Mean number of photons found a query.
    pub photon_count: bool,
    /// Mean kernel radius of the queries \[m\].
    pub kernel_radius: bool,
    /// Square of the radiance's standard error, and the number of samples behind it.
    pub variance: bool,
}

/// One channel of the file.
#[derive(Clone, Copy)]
pub(super) struct FilmChannel {
    pub name: &'static str,
    pub value: fn(&Pixel) -> f64,
}

/// `R, G, B, A` of the whole image, then the layers it is made of. EXR groups channels by what stands
/// before the dot.
const CHANNELS: [FilmChannel; 16] = [
    FilmChannel { name: "R", value: |pixel| pixel.radiance().x },
    FilmChannel { name: "G", value: |pixel| pixel.radiance().y },
    FilmChannel { name: "B", value: |pixel| pixel.radiance().z },
    FilmChannel { name: "A", value: Pixel::alpha },
    FilmChannel { name: "single_scatter.R", value: |pixel| pixel.single_scatter.x },
    FilmChannel { name: "single_scatter.G", value: |pixel| pixel.single_scatter.y },
    FilmChannel { name: "single_scatter.B", value: |pixel| pixel.single_scatter.z },
    FilmChannel { name: "multiple_scatter.R", value: |pixel| pixel.multiple_scatter.x },
    FilmChannel { name: "multiple_scatter.G", value: |pixel| pixel.multiple_scatter.y },
    FilmChannel { name: "multiple_scatter.B", value: |pixel| pixel.multiple_scatter.z },
    FilmChannel { name: "emission.R", value: |pixel| pixel.emission.x },
    FilmChannel { name: "emission.G", value: |pixel| pixel.emission.y },
    FilmChannel { name: "emission.B", value: |pixel| pixel.emission.z },
    FilmChannel { name: "transmittance.R", value: |pixel| pixel.transmittance.x },
    FilmChannel { name: "transmittance.G", value: |pixel| pixel.transmittance.y },
    FilmChannel { name: "transmittance.B", value: |pixel| pixel.transmittance.z },
];

const VARIANCE_CHANNELS: [FilmChannel; 4] = [
    FilmChannel { name: "variance.R", value: |pixel| pixel.variance.x },
    FilmChannel { name: "variance.G", value: |pixel| pixel.variance.y },
    FilmChannel { name: "variance.B", value: |pixel| pixel.variance.z },
    FilmChannel { name: "sample_count", value: |pixel| pixel.sample_count },
];

/// The channels of a file, in the alphabetical order that EXR demands.
pub(super) fn channels(extra: &ExtraLayers) -> Vec<FilmChannel> {
    let mut channels = CHANNELS.to_vec();
    if extra.photon_count {
        channels.push(FilmChannel { name: "photon_count", value: |pixel| pixel.photon_count });
    }
    if extra.kernel_radius {
        channels.push(FilmChannel { name: "kernel_radius", value: |pixel| pixel.kernel_radius });
    }
    if extra.variance {
        channels.extend(VARIANCE_CHANNELS);
    }
    channels.sort_by_key(|channel| channel.name);
    channels
}
