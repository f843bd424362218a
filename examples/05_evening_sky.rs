//! Makes the sky of the example scenes: an evening gradient, as a latitude-longitude EXR.
//!
//! ```sh
//! cargo run --release --example 05_evening_sky
//! ```

use exr::prelude::write_rgb_file;
use photonvdb::math::Rgb;

/// Radiance at the sine of the elevation, from below the horizon to straight up \[W/(m^2 sr)\].
const STOPS: [(f64, Rgb); 6] = [
    (-1.0, Rgb::new(0.010, 0.010, 0.014)),
    (-0.12, Rgb::new(0.035, 0.035, 0.055)),
    (0.0, Rgb::new(0.30, 0.20, 0.16)),
    (0.12, Rgb::new(0.22, 0.20, 0.24)),
    (0.40, Rgb::new(0.08, 0.12, 0.24)),
    (1.0, Rgb::new(0.03, 0.06, 0.15)),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all("output")?;
    // Rows are elevations; the sky is the same all around, so that a few columns do.
    let (width, height) = (4, 1024);
    write_rgb_file("output/evening_sky.exr", width, height, |_, row| {
        let polar = std::f64::consts::PI * (row as f64 + 0.5) / height as f64;
        let color = radiance(polar.cos()).as_vec3();
        (color.x, color.y, color.z)
    })?;
    println!("wrote output/evening_sky.exr; examples/scenes/evening_sky.exr is a copy of it");
    Ok(())
}

/// Smooth between the stops.
fn radiance(sine: f64) -> Rgb {
    let above = STOPS.iter().position(|(stop, _)| *stop >= sine).unwrap_or(STOPS.len() - 1);
    let ((low, from), (high, to)) = (STOPS[above.saturating_sub(1)], STOPS[above]);
    let share = if high > low { (sine - low) / (high - low) } else { 0.0 };
    from.lerp(to, share * share * (3.0 - 2.0 * share))
}
