//! A table of a scene for people.

use std::fmt::Write;

use photonvdb::lab::{PixelRow, PointRow, SceneTable};

use super::{percent_with_error, ratio, saving_line};

const EXPLANATION: &str = "\
intrinsic bias: power of the k nearest photons over that expected in their ball, the mean of all other maps, less 1;
smoothing: density expected in that ball over that expected in the inner ball, which stands for the point, less 1;
total bias: density estimated over that of the inner ball, less 1; local bias: root mean square over single pixels,
chance taken off; sd: of one estimate, of one pixel, relative to what is true there; rel. RMSE: of all pixels, relative to
their mean; var. ratio: variance of random over this one;
savings: as far as the squared error at points, and the variance of pixels, fall as photons grow in the same balls;
efficiency: 1 / (squared error x processor time of a map, or of an image [s])
";

/// The table, what it is held against, and what it cost. Biases in per cent.
pub fn of(table: &SceneTable, scene: &str) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = points(&mut text, table, scene);
    let _ = pixels(&mut text, table);
    let _ = costs(&mut text, table);
    text + EXPLANATION
}

fn points(text: &mut String, table: &SceneTable, scene: &str) -> std::fmt::Result {
    let Some(row) = table.points.first() else { return Ok(()) };
    let reference = &table.reference;
    writeln!(
        text,
        "{scene}: {} runs of {} photons; biases in per cent +- standard error",
        row.runs, row.n
    )?;
    writeln!(
        text,
        "points: {} places; against the mean of {} maps, in inner balls of {:.1} photons a map",
        row.places, reference.maps, reference.photons_in_inner_ball
    )?;
    writeln!(
        text,
        "{:<11}{:>5}{:>19}{:>20}{:>9}{:>9}{:>10}{:>19}{:>8}{:>14}{:>12}",
        "emission",
        "k",
        "intrinsic bias",
        "95 % from..to",
        "k-1/2",
        "k-1",
        "smoothing",
        "total bias",
        "sd",
        "var. ratio",
        "efficiency"
    )?;
    table.points.iter().try_for_each(|row| writeln!(text, "{}", point_line(row)))
}

fn pixels(text: &mut String, table: &SceneTable) -> std::fmt::Result {
    let Some(row) = table.pixels.first() else { return Ok(()) };
    let reference = &table.reference;
    write!(text, "pixels: {} of an image, k = {}; against ", row.pixels, row.k)?;
    match reference.image_runs {
        0 => writeln!(text, "the reference given")?,
        runs => writeln!(
            text,
            "the mean of {runs} renders of {} photons, whose pixels are known to {:.2} %",
            reference.image_photons,
            100.0 * reference.image_noise
        )?,
    }
    writeln!(
        text,
        "{:<11}{:>19}{:>20}{:>12}{:>8}{:>11}{:>14}{:>12}",
        "emission",
        "bias",
        "95 % from..to",
        "local bias",
        "sd",
        "rel. RMSE",
        "var. ratio",
        "efficiency"
    )?;
    table.pixels.iter().try_for_each(|row| writeln!(text, "{}", pixel_line(row)))
}

fn costs(text: &mut String, table: &SceneTable) -> std::fmt::Result {
    let seconds = |time: Option<f64>| time.map_or("-".into(), |time| format!("{time:.3} s"));
    for cost in &table.costs {
        writeln!(
            text,
            "{}: {} of processor time a map, {} an image",
            cost.emission,
            seconds(cost.seconds_per_map),
            seconds(cost.seconds_per_image)
        )?;
    }
    for saving in &table.point_savings {
        writeln!(text, "points, {}", saving_line(saving))?;
    }
    for saving in &table.pixel_savings {
        writeln!(text, "pixels, {}", saving_line(saving))?;
    }
    Ok(())
}

fn point_line(row: &PointRow) -> String {
    let percent = |value: f64| format!("{:+.3}", 100.0 * value);
    format!(
        "{:<11}{:>5}{:>19}{:>20}{:>9}{:>9}{:>10}{:>19}{:>8}{:>14}{:>12}",
        row.emission,
        row.k,
        percent_with_error(row.intrinsic_bias, row.std_error),
        interval(row.low_95, row.high_95),
        percent(row.intrinsic_bias_k_minus_half),
        percent(row.intrinsic_bias_k_minus_1),
        percent(row.smoothing_bias),
        percent_with_error(row.total_bias, row.total_std_error),
        format!("{:.2}", 100.0 * row.variance.sqrt()),
        ratio(row.variance_ratio, row.variance_ratio_std_error),
        efficiency(row.efficiency)
    )
}

fn pixel_line(row: &PixelRow) -> String {
    format!(
        "{:<11}{:>19}{:>20}{:>12}{:>8}{:>11}{:>14}{:>12}",
        row.emission,
        percent_with_error(row.bias, row.std_error),
        interval(row.low_95, row.high_95),
        format!("{:.3}", 100.0 * row.local_bias),
        format!("{:.2}", 100.0 * row.variance.sqrt()),
        format!("{:.2}", 100.0 * row.rel_rmse),
        ratio(row.variance_ratio, row.variance_ratio_std_error),
        efficiency(row.efficiency)
    )
}

fn interval(low: f64, high: f64) -> String {
    format!("{:+.3}..{:+.3}", 100.0 * low, 100.0 * high)
}

fn efficiency(value: Option<f64>) -> String {
    value.map_or("-".into(), |efficiency| format!("{efficiency:.3e}"))
}
