//! A picture in the terminal: half blocks, two pixels a character, in 24-bit colours where the terminal says that it has
//! them (`COLORTERM`), else in the 256 of xterm.

use std::env;
use std::fmt::Write as _;
use std::io::{self, IsTerminal, Write};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use photonvdb::film::{Film, Pixel, tone_mapped};
use photonvdb::math::Rgb;

use super::console::columns;

/// Largest picture \[pixels\].
const MAX_SIZE: [usize; 2] = [120, 96];

/// Width where nothing tells that of the terminal \[characters\].
const COLUMNS: usize = 80;

/// Levels of a channel in the colour cube of xterm.
const CUBE_LEVELS: [u8; 6] = [0, 95, 135, 175, 215, 255];

/// How often a picture that is not yet done is drawn.
const INTERVAL: Duration = Duration::from_secs(2);

/// The picture of one render, each in place of the one before.
#[derive(Default)]
pub struct TerminalPicture {
    /// When the last was drawn, and how many lines it took.
    last: Mutex<Option<(Instant, usize)>>,
}

impl TerminalPicture {
    /// Draws a film that goes on to change, on a terminal, and not too often.
    pub fn show_unfinished(&self, film: &Film) {
        let last = *self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let is_due = last.is_none_or(|(drawn, _)| drawn.elapsed() >= INTERVAL);
        if is_due && io::stderr().is_terminal() {
            self.show(film);
        }
    }

    /// Draws a film on stderr, tone-mapped as a preview is.
    pub fn show(&self, film: &Film) {
        let columns = columns().unwrap_or(COLUMNS);
        let is_direct =
            env::var("COLORTERM").is_ok_and(|value| value == "truecolor" || value == "24bit");
        let picture = draw(&shrunk(film, columns), if is_direct { direct } else { indexed });
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let picture = over(last.map(|(_, lines)| lines), &picture);
        // A stderr that is gone ends no render.
        let _ = io::stderr().lock().write_all(picture.as_bytes());
        *last = Some((Instant::now(), picture.lines().count()));
    }
}

/// A picture in place of one of so many lines, which end above the cursor.
fn over(lines_before: Option<usize>, picture: &str) -> String {
    let up = lines_before.map_or_else(String::new, |lines| format!("\x1b[{lines}A"));
    up + picture
}

/// Lines of upper half blocks: the upper pixel in front, the lower one behind.
fn draw(film: &Film, code: fn([u8; 3]) -> String) -> String {
    let colors = tone_mapped(film, None);
    let rows: Vec<_> = colors.chunks(film.width.max(1)).collect();
    let mut picture = String::new();
    for pair in rows.chunks(2) {
        for (x, &upper) in pair[0].iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = match pair.get(1) {
                Some(lower) => {
                    write!(picture, "\x1b[38;{};48;{}m\u{2580}", code(upper), code(lower[x]))
                }
                None => write!(picture, "\x1b[0;38;{}m\u{2580}", code(upper)),
            };
        }
        picture += "\x1b[0m\n";
    }
    picture
}

fn direct([r, g, b]: [u8; 3]) -> String {
    format!("2;{r};{g};{b}")
}

/// The nearest colour of the cube or of the greys.
fn indexed(color: [u8; 3]) -> String {
    let steps = color.map(|byte| {
        let distance = |step: &usize| CUBE_LEVELS[*step].abs_diff(byte);
        (0..6).min_by_key(distance).unwrap_or(0)
    });
    let mean = color.iter().map(|&byte| usize::from(byte)).sum::<usize>() / 3;
    let grey_step = (mean.saturating_sub(3) / 10).min(23);
    let distance = |other: [usize; 3]| -> usize {
        color.iter().zip(other).map(|(&byte, level)| usize::from(byte).abs_diff(level).pow(2)).sum()
    };
    let cube = distance(steps.map(|step| usize::from(CUBE_LEVELS[step])));
    let index = if distance([8 + 10 * grey_step; 3]) < cube {
        232 + grey_step
    } else {
        16 + 36 * steps[0] + 6 * steps[1] + steps[2]
    };
    format!("5;{index}")
}

/// The film in a size that fits so many columns, each pixel the mean radiance of those it stands for.
fn shrunk(film: &Film, columns: usize) -> Film {
    let across = film.width as f64 / columns.min(MAX_SIZE[0]).max(1) as f64;
    let down = film.height as f64 / MAX_SIZE[1] as f64;
    let factor = across.max(down).max(1.0);
    let size = |length: usize| ((length as f64 / factor).round() as usize).max(1);
    let mut small = Film::new(size(film.width), size(film.height));
    let (width, height) = (small.width, small.height);
    for (index, pixel) in small.pixels.iter_mut().enumerate() {
        let xs = share(index % width, width, film.width);
        let ys = share(index / width, height, film.height);
        let count = (xs.len() * ys.len()) as f64;
        let sum: Rgb = ys
            .flat_map(|y| xs.clone().map(move |x| y * film.width + x))
            .map(|place| film.pixels[place].radiance())
            .sum();
        *pixel = Pixel { emission: sum / count, ..Pixel::default() };
    }
    small
}

/// The pixels of `full` that part `index` of `parts` stands for: at least one.
fn share(index: usize, parts: usize, full: usize) -> std::ops::Range<usize> {
    let start = index * full / parts;
    start..((index + 1) * full / parts).max(start + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_the_indices_of_xterm() {
        for (color, index) in [
            ([0, 0, 0], "5;16"),
            ([255, 0, 0], "5;196"),
            ([128, 128, 128], "5;244"),
            ([95, 135, 175], "5;67"),
        ] {
            assert_eq!(indexed(color), index);
        }
    }

    #[test]
    fn pictures_take_each_others_place() {
        assert_eq!(over(None, "a\nb\n"), "a\nb\n");
        assert_eq!(over(Some(2), "a\nb\n"), "\x1b[2Aa\nb\n");
    }

    #[test]
    fn a_film_is_shrunk_by_means_and_drawn_two_rows_a_line() {
        let mut film = Film::new(400, 300);
        for (index, pixel) in film.pixels.iter_mut().enumerate() {
            // The left half is lit in two of four columns.
            let lit = index % 400 < 200 && index % 4 < 2;
            pixel.emission = Rgb::splat(if lit { 1.0 } else { 0.0 });
        }
        let small = shrunk(&film, 100);
        assert_eq!([small.width, small.height], [100, 75]);
        assert!((small.pixels[3 * 100 + 20].radiance().x - 0.5).abs() < 1e-12);
        assert_eq!(small.pixels[3 * 100 + 70].radiance(), Rgb::ZERO);
        let picture = draw(&small, direct);
        assert_eq!(picture.lines().count(), 38);
        assert_eq!(picture.matches('\u{2580}').count(), 100 * 38);
        assert!(picture.contains("38;2;0;0;0;48;2;0;0;0m"));
        assert!(picture.ends_with("\x1b[0m\n"));
        // Nothing is enlarged.
        assert_eq!(shrunk(&Film::new(3, 1), 80).pixels.len(), 3);
    }
}
