//! One image by two ways: three channels at once or one by one, and a uniform grid or the closed form.

use crate::grid_support::Voxels;
use crate::transport_support::*;
use photonvdb::film::Film;
use photonvdb::light::{DirectionalLight, Light};
use photonvdb::math::{DAffine3, DVec3, Rgb};
use photonvdb::medium::Medium;
use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::Scene;

const SIGMA_T: Rgb = Rgb::new(0.5, 1.0, 2.0);
const ALBEDO: Rgb = Rgb::new(0.9, 1.0, 0.7);

fn lit(medium: Medium) -> Scene {
    let direction = DVec3::new(-0.4, -0.8, -0.45).normalize();
    let sun = Light::Directional(DirectionalLight { direction, irradiance: Rgb::splat(3.0) });
    let mut scene = scene(medium, sun, 10_000);
    scene.lights.push(white_sky());
    scene.estimate.k = 30;
    scene.render.samples_per_pixel = 1;
    scene
}

/// Mean of each quarter of the image, channel by channel.
fn quarters(film: &Film) -> [f64; 12] {
    let mut sums = [0.0; 12];
    for (index, pixel) in film.pixels.iter().enumerate() {
        let (x, y) = (index % film.width * 2 / film.width, index / film.width * 2 / film.height);
        let share = 4.0 / film.pixels.len() as f64;
        let radiance = pixel.radiance() * share;
        let quarter = 2 * y + x;
        (0..3).for_each(|channel| sums[3 * quarter + channel] += radiance[channel]);
    }
    sums
}

fn rendered(medium: Medium) -> [Runs; 12] {
    over_seeds(&mut lit(medium), |scene| {
        quarters(&render(scene, &RenderOptions::passes(1), &Unobserved).unwrap().film)
    })
}

#[test]
fn three_channels_at_once_or_one_by_one() {
    for g in [0.0, 0.5] {
        let together = rendered(fog(CUBE, SIGMA_T, ALBEDO, g));
        for channel in 0..3 {
            let alone = rendered(grey_fog(CUBE, SIGMA_T[channel], ALBEDO[channel], g));
            for quarter in 0..4 {
                let index = 3 * quarter + channel;
                let what = format!("g {g}, quarter {quarter}, channel {channel}");
                let zero = together[index].minus(alone[index]);
                println!("  of {:.4}", alone[index].mean);
                zero.assert_is(0.0, &what);
            }
        }
    }
}

/// Where the background has the same value, too, a constant grid is a box of fog.
#[test]
fn a_uniform_grid_or_the_closed_form() {
    for g in [0.0, 0.5] {
        let mut voxels = Voxels { background: 0.75, ..Voxels::default() };
        for voxel in [[-3, -3, -3], [3, 3, 3], [0, 0, 0]] {
            voxels.set(voxel, 0.75);
        }
        let place = DAffine3::from_scale(DVec3::splat(0.25));
        let extinction = voxels.extinction(place, 2.0);
        let grid = rendered(grid_medium(extinction, ALBEDO, g));
        let closed_form = rendered(fog(CUBE, Rgb::splat(1.5), ALBEDO, g));
        for (index, (a, b)) in grid.iter().zip(closed_form).enumerate() {
            println!("  of {:.4}", b.mean);
            a.minus(b)
                .assert_is(0.0, &format!("g {g}, quarter {}, channel {}", index / 3, index % 3));
        }
    }
}
