//! Files that take the place of old ones: complete, or not at all.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use photonvdb::film::{Film, FilmError, Pixel, check_writable, write_beside, write_preview_png};
use photonvdb::math::Rgb;

fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn a_new_file_takes_the_place_of_the_old() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("result.txt");
    for text in ["first", "second"] {
        write_beside(&path, |file| file.write_all(text.as_bytes())).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
    assert_eq!(names(directory.path()), ["result.txt"]);
}

#[test]
fn a_failed_write_leaves_the_old_file_alone() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("result.txt");
    fs::write(&path, "good").unwrap();
    let error = write_beside(&path, |file| {
        file.write_all(b"half of the new con")?;
        Err(io::Error::from(io::ErrorKind::StorageFull))
    })
    .unwrap_err();
    assert!(error.to_string().contains("result.txt"), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "good");
    assert_eq!(names(directory.path()), ["result.txt"]);
}

#[test]
fn targets_that_are_no_files_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let message = |path: &Path| {
        let error = check_writable(path).unwrap_err();
        assert!(matches!(error, FilmError::Write { .. }));
        assert_eq!(error.to_string(), write_beside(path, |_| Ok(())).unwrap_err().to_string());
        error.to_string()
    };
    assert!(message(directory.path()).ends_with("it is a directory"));
    let absent = directory.path().join("absent").join("image.exr");
    assert!(message(&absent).contains("absent does not exist"));
    let below_file = directory.path().join("file").join("image.exr");
    fs::write(directory.path().join("file"), "").unwrap();
    assert!(message(&below_file).contains("does not exist"));
    assert_eq!(names(directory.path()), ["file"]);
}

#[test]
fn checking_leaves_nothing_behind() {
    let directory = tempfile::tempdir().unwrap();
    check_writable(&directory.path().join("image.exr")).unwrap();
    assert!(names(directory.path()).is_empty());
}

#[cfg(unix)]
#[test]
fn devices_are_written_to_and_links_followed() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    write_beside(Path::new("/dev/null"), |file| file.write_all(b"gone")).unwrap();
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());

    let directory = tempfile::tempdir().unwrap();
    let [real, link] = ["real.txt", "link.txt"].map(|name| directory.path().join(name));
    fs::write(&real, "old").unwrap();
    symlink(&real, &link).unwrap();
    write_beside(&link, |file| file.write_all(b"new")).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&real).unwrap(), "new");
}

fn preview(film: &Film, exposure: Option<f64>) -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("preview.png");
    write_preview_png(&path, film, exposure).unwrap();
    let decoder = png::Decoder::new(io::BufReader::new(fs::File::open(path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut bytes).unwrap();
    assert_eq!([frame.width as usize, frame.height as usize], [film.width, film.height]);
    bytes
}

#[test]
fn a_black_film_makes_a_black_picture() {
    assert!(preview(&Film::new(5, 3), None).iter().all(|&byte| byte == 0));
}

#[test]
fn automatic_exposure_does_not_depend_on_the_unit_of_radiance() {
    let ramp = |scale: f64| {
        let mut film = Film::new(100, 1);
        for (index, pixel) in film.pixels.iter_mut().enumerate() {
            pixel.multiple_scatter = Rgb::splat(scale * index as f64);
        }
        preview(&film, None)
    };
    let bytes = ramp(1.0);
    for scale in [2.0_f64.powi(-60), 2.0_f64.powi(40)] {
        assert_eq!(ramp(scale), bytes);
    }
    assert!(bytes.is_sorted());
    // 0.85 of white is 237 of 255 in sRGB; the 99th percentile is the last but one pixel.
    assert_eq!(bytes[3 * 98], 237);
}

#[test]
fn exposure_scales_and_colours_stay_in_order() {
    let mut film = Film::new(1, 1);
    film.pixels[0] = Pixel { emission: Rgb::new(0.25, 0.125, 0.0), ..Pixel::default() };
    assert_eq!(preview(&film, Some(2.0)), [188, 137, 0]);
}
