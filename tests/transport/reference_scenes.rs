//! The path tracer's images against references from an independent light tracer (`tests/scenes`), within noise.

use crate::transport_support::*;
use photonvdb::film::read_rgb;
use photonvdb::math::Rgb;
use photonvdb::reference::{Limits, Unwatched, render_reference};
use photonvdb::scene::Scene;

/// Edge of the blocks that are compared \[pixels\].
const BLOCK: usize = 16;

/// A sum of pixels, and the variance of that sum.
#[derive(Clone, Copy, Default)]
struct Sum {
    found: Rgb,
    expected: Rgb,
    variance: Rgb,
    pixel_count: f64,
}

impl Sum {
    fn add(&mut self, other: &Self) {
        self.found += other.found;
        self.expected += other.expected;
        self.variance += other.variance;
        self.pixel_count += other.pixel_count;
    }

    /// z-scores of the channels; the reference has noise of `noise` a pixel.
    fn z(&self, noise: f64) -> Rgb {
        let variance = self.variance + Rgb::splat(noise * noise * self.pixel_count);
        (self.found - self.expected) / variance.map(f64::sqrt)
    }
}

/// Image mean and means of blocks of 16 x 16 pixels.
fn assert_like_reference(name: &str, samples: u64) {
    let path = |ending: &str| tests().join("scenes").join(format!("{name}.{ending}"));
    let scene = Scene::load(&path("toml")).unwrap();
    let truth = read_rgb(&path("exr")).unwrap();
    let figures: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path("ref.json")).unwrap()).unwrap();
    let limits = Limits { samples: Some(samples), ..Limits::default() };
    let reference = render_reference(&scene, &limits, &Unwatched).unwrap();
    let columns = truth.width / BLOCK;
    let mut blocks = vec![Sum::default(); columns * truth.height / BLOCK];
    for (index, (pixel, expected)) in reference.film.pixels.iter().zip(&truth.pixels).enumerate() {
        let (x, y) = (index % truth.width / BLOCK, index / truth.width / BLOCK);
        blocks[y * columns + x].add(&Sum {
            found: pixel.radiance(),
            expected: glam::Vec3::from_array(*expected).as_dvec3(),
            variance: pixel.variance,
            pixel_count: 1.0,
        });
    }
    let mut whole = Sum::default();
    blocks.iter().for_each(|block| whole.add(block));
    let mean = whole.expected.element_sum() / 3.0 / whole.pixel_count;
    let noise = mean * number(&figures, "reference_relrmse_noise");
    let ratio = whole.found / whole.expected;
    println!("{name}: {ratio} of the reference, z {}, {:?}", whole.z(noise), reference.progress);
    assert!(whole.z(noise).abs().max_element() < LARGEST_Z);
    for (index, block) in blocks.iter().enumerate().filter(|(_, block)| block.expected != Rgb::ZERO)
    {
        let z = block.z(noise);
        let what = format!(
            "{name}, block {index}: {} of the reference, z {z}",
            block.found / block.expected
        );
        println!("{what}");
        assert!(z.abs().max_element() < LARGEST_Z, "{what}");
    }
}

#[test]
fn fog_with_a_point_light_inside() {
    assert_like_reference("fog_point", 64);
}

#[test]
fn forward_scattering_fog_with_a_spot() {
    assert_like_reference("fog_spot", 64);
}

#[test]
fn smoke_of_a_file_in_sunlight() {
    assert_like_reference("smoke_sun", 64);
}
