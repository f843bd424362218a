//! EXR files: what is written is read back, and damaged files end in errors.

use std::fs;
use std::path::Path;

use photonvdb::film::{
    ExrOptions, Film, FilmError, Pixel, RenderMetadata, RgbImage, describe_exr, read_rgb,
    read_variance, write_exr,
};
use photonvdb::math::Rgb;

/// A film whose every value is different and exact in `f32`.
fn gradient(width: usize, height: usize) -> Film {
    let mut film = Film::new(width, height);
    for (index, pixel) in film.pixels.iter_mut().enumerate() {
        let base = index as f64;
        *pixel = Pixel {
            single_scatter: Rgb::new(base, base + 0.25, base + 0.5),
            multiple_scatter: Rgb::new(1.0, 2.0, 3.0),
            emission: Rgb::new(0.125, 0.0, 4.0),
            transmittance: Rgb::new(0.75, 0.5, 0.25),
            photon_count: 100.0,
            kernel_radius: 0.5,
            variance: Rgb::new(0.5, 0.0625, 0.0),
            sample_count: 64.0,
        };
    }
    film
}

fn metadata() -> RenderMetadata {
    let mut metadata = RenderMetadata::new();
    metadata.set("seed", u64::MAX);
    metadata.set("divisor", "k-1");
    metadata.set("scene", "Wölkchen 雲.toml");
    metadata.set("photons_emitted", 1_000_000_000_000_u64);
    for setting in ["kernel", "emission", "k", "passes", "version", "scene_hash"] {
        metadata.set(setting, setting);
    }
    metadata
}

#[test]
fn radiance_comes_back_bit_for_bit() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("image.exr");
    let film = gradient(37, 35);
    write_exr(&path, &film, &ExrOptions::default(), &metadata()).unwrap();
    let image = read_rgb(&path).unwrap();
    assert_eq!(image, RgbImage::from(&film));
    assert_eq!(image.pixels[40], [41.125, 42.25, 47.5]);
}

#[test]
fn layers_hold_the_parts_of_the_image() {
    use exr::prelude::*;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("image.exr");
    let film = gradient(20, 18);
    let extra = ExrOptions {
        photon_count: true,
        kernel_radius: true,
        variance: true,
        ..ExrOptions::default()
    };
    write_exr(&path, &film, &extra, &metadata()).unwrap();

    let image = read_all_flat_layers_from_file(&path).unwrap();
    assert_eq!(image.layer_data.len(), 1);
    let channels = &image.layer_data[0].channel_data.list;
    let value = |name: &str, index: usize| {
        let channel = channels.iter().find(|channel| channel.name.eq(name)).unwrap();
        channel.sample_data.value_by_flat_index(index).to_f32()
    };
    assert_eq!(channels.len(), 22);
    let index = 20 * 17 + 3;
    let base = index as f32;
    assert_eq!(value("A", index), 0.5);
    assert_eq!(value("R", index), base + 1.125);
    assert_eq!(value("single_scatter.G", index), base + 0.25);
    assert_eq!(value("multiple_scatter.B", index), 3.0);
    assert_eq!(value("emission.R", index), 0.125);
    assert_eq!(value("transmittance.B", index), 0.25);
    assert_eq!(value("photon_count", index), 100.0);
    assert_eq!(value("kernel_radius", index), 0.5);
    assert_eq!(value("variance.G", index), 0.0625);
    assert_eq!(value("sample_count", index), 64.0);

    let variance = read_variance(&path).unwrap().unwrap();
    assert_eq!((variance.width, variance.height), (20, 18));
    assert!(variance.pixels.iter().all(|pixel| *pixel == [0.5, 0.0625, 0.0]));
    write_exr(&path, &film, &ExrOptions::default(), &metadata()).unwrap();
    assert_eq!(read_variance(&path).unwrap(), None);
}

#[test]
fn description_lists_layers_and_metadata() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("image.exr");
    let extra = ExrOptions { photon_count: true, ..ExrOptions::default() };
    write_exr(&path, &gradient(8, 4), &extra, &metadata()).unwrap();

    let description = describe_exr(&path).unwrap();
    let [part] = description.parts.as_slice() else { panic!("one part expected") };
    assert_eq!([part.width, part.height], [8, 4]);
    let names: Vec<&str> = part.layers().iter().map(|(name, _)| *name).collect();
    let expected = ["", "emission", "multiple_scatter", "single_scatter", "transmittance"];
    assert_eq!(names, expected);
    assert_eq!(part.layers()[0].1, ["A", "B", "G", "R", "photon_count"]);
    assert!(part.channels.iter().all(|(_, sample_type)| *sample_type == "float"));
    let attribute = |name: &str| {
        let found = part.attributes.iter().find(|(existing, _)| existing == name);
        found.map(|(_, value)| value.as_str())
    };
    assert_eq!(attribute("photonvdb:seed"), Some("18446744073709551615"));
    assert_eq!(attribute("photonvdb:scene"), Some("Wölkchen 雲.toml"));
    assert!(attribute("software").unwrap().starts_with("photonvdb "));
}

#[test]
fn equal_films_make_equal_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, threads: usize| {
        let path = directory.path().join(name);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            write_exr(&path, &gradient(64, 100), &ExrOptions::default(), &metadata()).unwrap();
        });
        fs::read(path).unwrap()
    };
    let first = write("a.exr", 1);
    for (name, threads) in [("b.exr", 1), ("c.exr", 2), ("d.exr", 7)] {
        assert!(write(name, threads) == first, "{name}");
    }
}

#[test]
fn other_writers_are_read() {
    use exr::prelude::*;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("other.exr");
    let color = |x: usize, y: usize| (x as f32, (y as f32) * 0.5, 0.25_f32);
    let channels = SpecificChannels::build()
        .with_channel::<f16>("R")
        .with_channel::<f32>("G")
        .with_channel::<u32>("B")
        .with_pixel_fn(|Vec2(x, y)| {
            let (red, green, blue) = color(x, y);
            (f16::from_f32(red), green, (blue * 4.0) as u32)
        });
    for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(7, 5))] {
        for compression in [Compression::Uncompressed, Compression::RLE, Compression::PIZ] {
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            let mut image = Image::from_encoded_channels((30, 20), encoding, channels.clone());
            image.attributes.display_window = IntegerBounds::new((-3, -2), (40, 25));
            image.write().to_file(&path).unwrap();

            let image = read_rgb(&path).unwrap();
            assert_eq!([image.width, image.height], [40, 25]);
            assert_eq!(image.pixels[0], [0.0; 3], "outside the data window");
            assert_eq!(image.pixels[(4 + 2) * 40 + 11 + 3], [11.0, 2.0, 1.0]);
        }
    }
}

#[test]
fn an_image_without_colour_says_what_it_has() {
    use exr::prelude::*;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("depth.exr");
    let channels = SpecificChannels::build().with_channel::<f32>("Z").with_pixel_fn(|_| (1.0_f32,));
    Image::from_channels((4, 4), channels).write().to_file(&path).unwrap();
    let error = read_rgb(&path).unwrap_err();
    assert!(matches!(error, FilmError::NoRgb { .. }));
    let message = error.to_string();
    assert!(message.contains("depth.exr") && message.ends_with("its channels are Z"), "{message}");
}

#[test]
fn missing_and_foreign_files_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let missing = directory.path().join("missing.exr");
    assert!(matches!(read_rgb(&missing), Err(FilmError::Read { .. })));
    let foreign = directory.path().join("foreign.exr");
    for bytes in [b"".as_slice(), b"PNG", &[0; 4096]] {
        fs::write(&foreign, bytes).unwrap();
        let message = read_rgb(&foreign).unwrap_err().to_string();
        assert!(message.contains("foreign.exr"), "{message}");
    }
}

/// Reads the file both ways; a panic fails the test.
fn survive(path: &Path) {
    let _ = read_rgb(path);
    let _ = describe_exr(path);
}

#[test]
fn truncated_files_are_errors() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("image.exr");
    write_exr(&path, &gradient(33, 40), &ExrOptions::default(), &metadata()).unwrap();
    let bytes = fs::read(&path).unwrap();
    for length in (0..bytes.len()).step_by(97) {
        fs::write(&path, &bytes[..length]).unwrap();
        assert!(read_rgb(&path).is_err(), "{length} of {} bytes", bytes.len());
        survive(&path);
    }
}

#[test]
fn damaged_bytes_never_panic() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("image.exr");
    write_exr(&path, &gradient(33, 40), &ExrOptions::default(), &metadata()).unwrap();
    let bytes = fs::read(&path).unwrap();
    for index in 0..bytes.len().min(1500) {
        for value in [0x00, 0x7f, 0xff, bytes[index] ^ 1] {
            let mut damaged = bytes.clone();
            damaged[index] = value;
            fs::write(&path, &damaged).unwrap();
            survive(&path);
        }
    }
}

/// Regression: the decoder of DWA chunks allocates what their counters say, which ended the process.
#[test]
fn huge_counters_of_dwa_chunks_are_refused() {
    use exr::prelude::*;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("dwa.exr");
    let wave = |x: usize| f16::from_f32((x as f32 * 0.3).sin() + 1.0);
    let channels = SpecificChannels::rgb(|Vec2(x, y)| (wave(x), wave(y), wave(x + y)));
    let encoding = Encoding {
        compression: Compression::DWAA(None),
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let image = Image::from_encoded_channels((32, 32), encoding, channels);
    image.write().to_file(&path).unwrap();
    let red = read_rgb(&path).unwrap().pixels[5][0];
    assert!((red - wave(5).to_f32()).abs() < 0.05, "{red}");

    // The only entry of the offset table points right behind itself.
    let bytes = fs::read(&path).unwrap();
    let points_behind_itself = |at: &usize| bytes[at - 8..*at] == (*at as u64).to_le_bytes();
    let chunk = (8..bytes.len()).find(points_behind_itself).unwrap();
    // The counters follow the line number and the size of the chunk.
    for counter in [1, 6, 7, 8, 9] {
        let mut damaged = bytes.clone();
        let place = chunk + 8 + 8 * counter;
        damaged[place..place + 8].copy_from_slice(&(1_u64 << 52).to_le_bytes());
        fs::write(&path, &damaged).unwrap();
        assert!(matches!(read_rgb(&path), Err(FilmError::Damaged { .. })), "counter {counter}");
    }
}

/// Every layer under the name that it is looked for by; halves where colours are asked for as halves.
#[test]
fn layers_of_lights_depths_and_halves() {
    use exr::prelude::*;
    use photonvdb::film::PixelDepths;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("image.exr");
    let names = ["key".to_string(), "1".to_string()];
    let mut film = Film::new(20, 3).with_depths().with_lights(&names);
    film.pixels = gradient(20, 3).pixels;
    let depths = PixelDepths {
        half_distance: 3.0,
        half_share: 0.5,
        scatter_distance: 1.25,
        scatter_weight: 0.25,
    };
    film.depths.as_mut().unwrap()[7] = depths;
    film.lights[0].radiance[7] = photonvdb::math::Rgb::new(0.1, 1e9, -1e9);
    film.lights[1].radiance[7] = photonvdb::math::Rgb::new(1.0, 2.0, 3.0);
    for half in [false, true] {
        let options = ExrOptions { alpha: true, variance: true, half, ..ExrOptions::default() };
        write_exr(&path, &film, &options, &metadata()).unwrap();
        let image = read_all_flat_layers_from_file(&path).unwrap();
        let channels = &image.layer_data[0].channel_data.list;
        let found: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
        let mut sorted = found.clone();
        sorted.sort();
        assert_eq!(found, sorted);
        let sample = |name: &str| {
            let channel = channels.iter().find(|channel| channel.name.eq(name)).unwrap();
            let is_half = matches!(channel.sample_data, FlatSamples::F16(_));
            let measured = ["Z", "scatter.Z", "sample_count"].contains(&name);
            assert_eq!(is_half, half && !measured && !name.starts_with("variance"), "{name}");
            channel.sample_data.value_by_flat_index(7).to_f32()
        };
        assert_eq!([sample("AR"), sample("AG"), sample("AB")], [0.25, 0.5, 0.75]);
        assert_eq!([sample("Z"), sample("scatter.Z")], [6.0, 5.0]);
        assert_eq!(["R", "G", "B"].map(|c| sample(&format!("light.1.{c}"))), [1.0, 2.0, 3.0]);
        assert_eq!([sample("variance.R"), sample("sample_count")], [0.5, 64.0]);
        let largest = if half { 65504.0 } else { 1e9 };
        assert!((sample("light.key.R") - 0.1).abs() < if half { 3e-5 } else { 1e-8 });
        assert_eq!([sample("light.key.G"), sample("light.key.B")], [largest, -largest]);
        assert_eq!(read_rgb(&path).unwrap().pixels[7], [8.125, 9.25, 14.5]);
    }
}
