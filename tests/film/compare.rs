//! Image comparison against figures computed by hand.

use photonvdb::film::{FilmError, RgbImage, compare};

fn image(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> RgbImage {
    let pixels = (0..width * height).map(|index| [value(index % width, index / width); 3]);
    RgbImage { width, height, pixels: pixels.collect() }
}

#[test]
fn equal_images_have_no_error() {
    let image = image(33, 20, |x, y| (x * y) as f32);
    let error = compare(&image, &image).unwrap();
    assert_eq!([error.mean_ratio, error.rel_rmse, error.block_rel_rms], [1.0, 0.0, 0.0]);
}

#[test]
fn a_gain_is_a_bias_at_every_scale() {
    let reference = image(40, 24, |_, _| 2.0);
    let error = compare(&image(40, 24, |_, _| 2.5), &reference).unwrap();
    assert_eq!([error.mean_ratio, error.rel_rmse, error.block_rel_rms], [1.25, 0.25, 0.25]);
}

#[test]
fn fine_noise_averages_out_in_blocks() {
    let reference = image(32, 32, |_, _| 4.0);
    let checkered = image(32, 32, |x, y| if (x + y) % 2 == 0 { 5.0 } else { 3.0 });
    let error = compare(&checkered, &reference).unwrap();
    assert_eq!([error.mean_ratio, error.rel_rmse, error.block_rel_rms], [1.0, 0.25, 0.0]);
}

#[test]
fn one_wrong_channel_counts_a_third() {
    let reference = image(3, 1, |_, _| 1.0);
    let mut wrong = reference.clone();
    for pixel in &mut wrong.pixels {
        pixel[1] = 2.0;
    }
    let error = compare(&wrong, &reference).unwrap();
    assert!((error.mean_ratio - 4.0 / 3.0).abs() < 1e-15);
    assert!((error.rel_rmse - (1.0_f64 / 3.0).sqrt()).abs() < 1e-15);
}

#[test]
fn a_black_reference_is_no_trap() {
    let black = image(4, 4, |_, _| 0.0);
    let same = compare(&black, &black).unwrap();
    assert_eq!([same.mean_ratio, same.rel_rmse, same.block_rel_rms], [1.0, 0.0, 0.0]);
    assert!(compare(&image(4, 4, |_, _| 1.0), &black).unwrap().rel_rmse.is_infinite());
}

#[test]
fn sizes_must_agree() {
    let error = compare(&image(4, 3, |_, _| 1.0), &image(3, 4, |_, _| 1.0)).unwrap_err();
    assert!(matches!(error, FilmError::SizeMismatch { image: [4, 3], reference: [3, 4] }));
    assert_eq!(error.to_string(), "the image is 4 x 3 pixels but its reference is 3 x 4");
}
