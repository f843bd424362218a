//! A film as arrays of 32-bit floats, layer by layer: the numbers that its EXR holds, for hosts that want no file.

use rayon::prelude::*;

use super::layers::{FilmChannel, channels};
use super::{ExrOptions, Film};

/// One layer: `channel_count` numbers a pixel, row-major, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerArray {
    /// As in an EXR, without the channel: `single_scatter`, `light.sun`. The image itself is `rgba`, coverage a channel `alpha`.
    pub name: String,
    /// 1, 3 (red, green, blue) or 4 (and coverage).
    pub channel_count: usize,
    /// `height * width * channel_count` numbers, the channels of a pixel together.
    pub values: Vec<f32>,
}

/// The layers that [`write_exr`](super::write_exr) would write, in full precision, the image first.
pub fn layer_arrays(film: &Film, options: &ExrOptions) -> Vec<LayerArray> {
    let channels = channels(film, &ExrOptions { half: false, ..*options });
    let mut layers: Vec<(&str, Vec<(usize, &FilmChannel)>)> = Vec::new();
    for channel in &channels {
        let (layer, place) = place_of(&channel.name);
        match layers.iter_mut().find(|(name, _)| *name == layer) {
            Some((_, members)) => members.push((place, channel)),
            None => layers.push((layer, vec![(place, channel)])),
        }
    }
    // Stable: the alphabet's order but for the image.
    layers.sort_by_key(|(name, _)| *name != IMAGE);
    layers.into_iter().map(|(name, members)| layer_array(film, name, members)).collect()
}

/// What the channels R, G, B, A are together.
const IMAGE: &str = "rgba";

/// The layer of a channel, and its place in it.
fn place_of(channel: &str) -> (&str, usize) {
    match channel {
        "R" => (IMAGE, 0),
        "G" => (IMAGE, 1),
        "B" => (IMAGE, 2),
        "A" => (IMAGE, 3),
        "AR" => ("alpha", 0),
        "AG" => ("alpha", 1),
        "AB" => ("alpha", 2),
        _ => match channel.rsplit_once('.') {
            Some((layer, "R")) => (layer, 0),
            Some((layer, "G")) => (layer, 1),
            Some((layer, "B")) => (layer, 2),
            _ => (channel, 0),
        },
    }
}

fn layer_array(film: &Film, name: &str, mut members: Vec<(usize, &FilmChannel)>) -> LayerArray {
    members.sort_by_key(|(place, _)| *place);
    let channel_count = members.len();
    let mut values = vec![0.0; film.pixels.len() * channel_count];
    values.par_chunks_exact_mut(channel_count).enumerate().for_each(|(index, pixel)| {
        for (value, (_, channel)) in pixel.iter_mut().zip(&members) {
            *value = (channel.value)(index) as f32;
        }
    });
    LayerArray { name: name.to_owned(), channel_count, values }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    #[test]
    fn layers_hold_their_channels_in_order() {
        let mut film = Film::new(2, 1).with_depths().with_lights(&["sun".into()]);
        film.pixels[1].single_scatter = Rgb::new(1.0, 2.0, 3.0);
        film.pixels[1].transmittance = Rgb::new(0.5, 0.25, 0.75);
        film.pixels[0].transmittance = Rgb::ONE;
        film.lights[0].radiance[1] = Rgb::new(4.0, 5.0, 6.0);
        let options = ExrOptions { alpha: true, photon_count: true, ..ExrOptions::default() };
        let layers = layer_arrays(&film, &options);
        let names: Vec<&str> = layers.iter().map(|layer| layer.name.as_str()).collect();
        let expected = [
            "rgba",
            "alpha",
            "Z",
            "emission",
            "light.sun",
            "multiple_scatter",
            "photon_count",
            "scatter.Z",
            "single_scatter",
            "transmittance",
        ];
        assert_eq!(names, expected);
        let values = |name: &str| {
            let layer = layers.iter().find(|layer| layer.name == name).unwrap();
            layer.values.clone()
        };
        assert_eq!(values("rgba"), [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 0.5]);
        assert_eq!(values("alpha"), [0.0, 0.0, 0.0, 0.5, 0.75, 0.25]);
        assert_eq!(values("light.sun"), [0.0, 0.0, 0.0, 4.0, 5.0, 6.0]);
        assert_eq!(values("photon_count"), [0.0, 0.0]);
    }
}
