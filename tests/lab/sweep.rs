//! Speed against error in a scene whose image is known.

use std::cell::Cell;

use photonvdb::emission::EmissionKind;
use photonvdb::estimate::Divisor;
use photonvdb::film::RgbImage;
use photonvdb::lab::{KnownImage, Sweep, SweepError, SweepSetting};
use photonvdb::scene::Scene;

/// Radiance 1 all around a ball that absorbs nothing: every pixel is 1.
const FURNACE: &str = r#"
[camera]
position = [0.0, 0.0, -6.0]
look_at = [0.0, 0.0, 0.0]
vertical_fov = 12.0
resolution = [16, 12]
[medium]
kind = "homogeneous"
bounds = { center = [0.0, 0.0, 0.0], radius = 1.0 }
sigma_t = 1.0
albedo = 1.0
[[light]]
kind = "environment"
radiance = 1.0
"#;

fn furnace() -> Scene {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("scene.toml");
    std::fs::write(&path, FURNACE).unwrap();
    Scene::load(&path).unwrap()
}

fn image(light: f32) -> KnownImage {
    let image = RgbImage { width: 16, height: 12, pixels: vec![[light; 3]; 16 * 12] };
    KnownImage { image, variance: None }
}

fn sweep() -> Sweep {
    let emission = EmissionKind::Random;
    let knn =
        |photons, k| SweepSetting::Knn { photons, emission, k, divisor: Divisor::KMinus1, rays: 1 };
    let settings = vec![
        knn(2000, 10),
        knn(8000, 10),
        SweepSetting::Lattice { photons: 8000, emission, cells: Some(8), rays: 1 },
        SweepSetting::Paths { paths: 4 },
        SweepSetting::Paths { paths: 64 },
        SweepSetting::Target { error: 0.1, emission },
    ];
    Sweep { settings, runs: 8, seed: 2, reference_paths: 64 }
}

/// A clock that each image moves on by a second, so that only the error decides the front.
#[test]
fn errors_are_those_of_a_furnace() {
    let clock = Cell::new(0.0);
    let seconds = || {
        clock.set(clock.get() + 1.0);
        Some(clock.get())
    };
    let steps = Cell::new(0);
    let sweep = sweep();
    let advanced = || steps.set(steps.get() + 1);
    let table = sweep.tabulate(&mut furnace(), Some(&image(1.0)), seconds, advanced).unwrap();
    assert_eq!((steps.get(), table.rows.len()), (sweep.step_count(true), 6));
    for row in &table.rows {
        let parts = row.bias.hypot(row.noise);
        assert!((row.error / parts - 1.0).abs() < 1e-9 && row.noise > 0.0, "{row:?}");
        assert!(row.mean_bias.abs() < 4.5 * row.mean_bias_std_error + 0.02, "{row:?}");
        assert_eq!(row.cpu_seconds, Some(1.0));
        assert_eq!(row.efficiency, Some(1.0 / (row.error * row.error)));
    }
    let [knn, .., paths, many_paths, target] = &table.rows[..] else { panic!("{table:?}") };
    // The path tracer has no bias, and errs by the root of its paths.
    assert!(many_paths.bias < 0.5 * many_paths.noise, "{many_paths:?}");
    assert!((paths.noise / many_paths.noise - 4.0).abs() < 1.0, "{paths:?} {many_paths:?}");
    assert_eq!((knn.photons, knn.k, knn.divisor), (Some(2000), Some(10), Some("k-1")));
    assert!(target.estimated_error.is_some_and(|error| error <= 0.1) && target.error < 0.2);
    assert_eq!(table.rows.iter().filter(|row| row.is_on_front).count(), 1);
    let best = table.rows.iter().min_by(|a, b| a.error.total_cmp(&b.error)).unwrap();
    assert!(best.is_on_front);
}

/// A row is the same whatever stands beside it; without an image given, one is made, and its noise is known.
#[test]
fn rows_do_not_depend_on_each_other() {
    let table = |sweep: &Sweep| sweep.tabulate(&mut furnace(), None, || None, || ()).unwrap();
    let all = Sweep { runs: 2, ..sweep() };
    let (both, last) =
        (table(&all), table(&Sweep { settings: all.settings[2..].into(), ..all.clone() }));
    assert_eq!(
        both.to_csv().lines().skip(3).collect::<Vec<_>>(),
        last.to_csv().lines().skip(1).collect::<Vec<_>>()
    );
    assert_eq!(both.reference.paths, Some(64));
    assert!(both.reference.noise.is_some_and(|noise| noise > 0.0));
    assert!(both.rows.iter().all(|row| row.efficiency.is_none() && !row.is_on_front));
    assert!(both.to_csv_with_times().lines().nth(1).is_some_and(|line| line.ends_with(",,,0")));
}

#[test]
fn what_cannot_be_swept_says_the_way_out() {
    let refused = |sweep: &Sweep, image: &KnownImage| {
        sweep.tabulate(&mut furnace(), Some(image), || None, || ()).unwrap_err()
    };
    let error = refused(&Sweep { runs: 1, ..sweep() }, &image(1.0));
    assert!(matches!(error, SweepError::TooFewRuns { runs: 1 }), "{error}");
    let error = refused(&Sweep { runs: 1 << 40, ..sweep() }, &image(1.0));
    assert!(error.to_string().contains("lower --resolution or --runs"), "{error}");
    assert!(matches!(refused(&sweep(), &image(0.0)), SweepError::BlackReference));
    assert!(matches!(refused(&sweep(), &image(f32::NAN)), SweepError::BlackReference));
    let mut wide = image(1.0);
    (wide.image.width, wide.image.height) = (12, 16);
    assert!(refused(&sweep(), &wide).to_string().contains("12 x 16"));
}
