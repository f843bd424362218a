//! The colour and brightness of what glows: blackbody radiance in linear RGB.
//!
//! Planck's law B = 2 h c^2 / lambda^5 / (exp(h c / (lambda k T)) - 1), weighted with the CIE 1931 colour-matching functions
//! and summed over wavelengths, is XYZ in W/(m^2 sr); Y counts each watt by how bright it looks, so that the luminance is
//! 683 Y \[cd/m^2\]. A matrix leads to Rec.709 primaries. Colours of blackbodies below some 1900 K lie outside of what
//! those can make: the channels below 0 (blue, and below 990 K green) are set to 0.
//!
//! ln(XYZ / T) is smooth in 1 / T up to infinite temperatures: a table of it, cubic between its rows, is within 1e-6 of the
//! sums.

use std::sync::LazyLock;

use super::cie_1931::{FIRST_NANOMETRES, MATCHING_FUNCTIONS, STEP_NANOMETRES};
use crate::math::{DMat3, DVec3, Rgb};

const PLANCK: f64 = 6.626_070_15e-34;
const LIGHT_SPEED: f64 = 299_792_458.0;
const BOLTZMANN: f64 = 1.380_649e-23;

/// What is colder does not glow: it is 1e14 times darker than at 1000 K \[K\].
pub(super) const COLDEST: f64 = 400.0;

/// Intervals of the table, in 1 / T from 0 on.
const INTERVALS: usize = 320;

/// ln(XYZ / T) at 1 / T = i / (`INTERVALS` `COLDEST`), with a row beyond either end.
static TABLE: LazyLock<Vec<DVec3>> = LazyLock::new(|| {
    let row = |i: usize| {
        let inverse = (i as f64 - 1.0) / (INTERVALS as f64 * COLDEST);
        xyz_over_temperature(inverse).map(f64::ln)
    };
    (0..INTERVALS + 3).map(row).collect()
});

/// From XYZ to linear RGB of Rec.709 primaries and white D65 (IEC 61966-2-1).
const XYZ_TO_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(3.240_454_2, -0.969_266_0, 0.055_643_4),
    DVec3::new(-1.537_138_5, 1.876_010_8, -0.204_025_9),
    DVec3::new(-0.498_531_4, 0.041_556_0, 1.057_225_2),
);

/// Radiance of a blackbody \[W/(m^2 sr)\], each watt counted by the eye's response; channels below 0 are set to 0. Nothing
/// below 400 K.
pub fn blackbody_radiance(kelvin: f64) -> Rgb {
    (XYZ_TO_RGB * blackbody_xyz(kelvin)).max(Rgb::ZERO)
}

/// CIE 1931 XYZ of a blackbody \[W/(m^2 sr)\]: the luminance is 683 Y \[cd/m^2\]. 0 below 400 K, and where the temperature is
/// no number.
pub fn blackbody_xyz(kelvin: f64) -> DVec3 {
    // Written so that NaN counts as cold.
    if !(kelvin >= COLDEST && kelvin.is_finite()) {
        return DVec3::ZERO;
    }
    let place = INTERVALS as f64 * COLDEST / kelvin;
    let row = (place as usize).min(INTERVALS - 1);
    let t = place - row as f64;
    let (before, start, end, after) = (TABLE[row], TABLE[row + 1], TABLE[row + 2], TABLE[row + 3]);
    // Lagrange's cubic through the rows at -1, 0, 1 and 2.
    let logarithm = before * (-t * (t - 1.0) * (t - 2.0) / 6.0)
        + start * ((t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0)
        + end * (-(t + 1.0) * t * (t - 2.0) / 2.0)
        + after * ((t + 1.0) * t * (t - 1.0) / 6.0);
    logarithm.map(f64::exp) * kelvin
}

/// XYZ / T \[W/(m^2 sr K)\] by the inverse temperature \[1/K\], continued analytically through 0.
fn xyz_over_temperature(inverse: f64) -> DVec3 {
    let rows = MATCHING_FUNCTIONS.iter().enumerate();
    rows.map(|(i, &matching)| {
        let wavelength = 1e-9 * (FIRST_NANOMETRES + STEP_NANOMETRES * i as f64);
        let exponent = PLANCK * LIGHT_SPEED / (wavelength * BOLTZMANN) * inverse;
        // x / (exp(x) - 1), which is 1 at 0.
        let falloff = if exponent == 0.0 { 1.0 } else { exponent / exponent.exp_m1() };
        let classical = 2.0 * LIGHT_SPEED * BOLTZMANN / wavelength.powi(4);
        DVec3::from_array(matching) * (classical * falloff * 1e-9 * STEP_NANOMETRES)
    })
    .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chromaticity(kelvin: f64) -> (f64, f64) {
        let xyz = blackbody_xyz(kelvin);
        let sum = xyz.element_sum();
        (xyz.x / sum, xyz.y / sum)
    }

    /// x and y to four digits: Wyszecki and Stiles, *Color Science*, table 1(3.3.4), as recomputed with today's constants.
    #[test]
    fn colors_are_those_of_the_planckian_locus() {
        for (kelvin, x, y) in [
            (1000.0, 0.6528, 0.3445),
            (1500.0, 0.5857, 0.3931),
            (2000.0, 0.5267, 0.4133),
            (3000.0, 0.4369, 0.4041),
            (4000.0, 0.3804, 0.3768),
            (5000.0, 0.3451, 0.3516),
            (6500.0, 0.3135, 0.3236),
            (10_000.0, 0.2806, 0.2883),
        ] {
            let (own_x, own_y) = chromaticity(kelvin);
            assert!(
                (own_x - x).abs() < 1e-4 && (own_y - y).abs() < 1e-4,
                "{kelvin}: {own_x} {own_y}"
            );
        }
        // The limit of infinite temperature.
        let (x, y) = chromaticity(1e12);
        assert!((x - 0.2399).abs() < 2e-4 && (y - 0.2341).abs() < 2e-4, "{x} {y}");
    }

    /// Until 1979 the candela was 1/60 of what 1 cm^2 of a blackbody shines at the freezing point of platinum, 2042 K, and
    /// 683 lm/W was chosen to keep it.
    #[test]
    fn platinum_shines_with_sixty_candelas_a_square_centimetre() {
        let luminance = 683.0 * blackbody_xyz(2042.0).y;
        assert!((luminance / 6e5 - 1.0).abs() < 6e-3, "{luminance}");
    }

    /// Lumens a watt of an ideal blackbody, as reference works give them: 54.7 at 4000 K, 95 at 7000 K (8.0 and 14 % of 683), and
    /// nowhere more than near 6640 K.
    #[test]
    fn luminous_efficacies_are_those_of_reference_works() {
        let efficacy = |kelvin: f64| {
            let power = 5.670_374_419e-8 * kelvin.powi(4) / std::f64::consts::PI;
            683.0 * blackbody_xyz(kelvin).y / power
        };
        for (kelvin, lumens) in [(4000.0, 54.7), (7000.0, 95.0)] {
            assert!((efficacy(kelvin) - lumens).abs() < 0.1, "{kelvin}: {}", efficacy(kelvin));
        }
        assert!(efficacy(6640.0) > efficacy(6540.0) && efficacy(6640.0) > efficacy(6740.0));
    }

    /// White D65 is (1, 1, 1), and within the gamut RGB has the luminance of XYZ: 0.2126 R + 0.7152 G + 0.0722 B = Y.
    #[test]
    fn rgb_keeps_white_and_luminance() {
        let white = XYZ_TO_RGB * DVec3::new(0.950_47, 1.0, 1.088_83);
        assert!((white - DVec3::ONE).abs().max_element() < 1e-5, "{white}");
        for kelvin in [2000.0, 2700.0, 4000.0, 6500.0, 12_000.0] {
            let luminance =
                blackbody_radiance(kelvin).dot(Rgb::new(0.212_673, 0.715_152, 0.072_175));
            let ratio = luminance / blackbody_xyz(kelvin).y;
            assert!((ratio - 1.0).abs() < 1e-4, "{kelvin}: {ratio}");
        }
    }

    /// Wien's displacement and the Stefan-Boltzmann law hold for the constants used.
    #[test]
    fn the_constants_make_stefan_boltzmann() {
        let second = PLANCK * LIGHT_SPEED / BOLTZMANN;
        assert!((second - 1.438_776_877e-2).abs() < 1e-11);
        let sigma = 2.0 * std::f64::consts::PI.powi(5) * BOLTZMANN.powi(4)
            / (15.0 * PLANCK.powi(3) * LIGHT_SPEED.powi(2));
        assert!((sigma / 5.670_374_419e-8 - 1.0).abs() < 1e-9, "{sigma}");
    }

    #[test]
    fn the_table_is_as_near_as_stated() {
        for step in 0..4000 {
            let kelvin = 400.0 * 1.0025_f64.powi(step);
            let exact = xyz_over_temperature(1.0 / kelvin) * kelvin;
            let error = (blackbody_xyz(kelvin) / exact - DVec3::ONE).abs().max_element();
            assert!(error < 1e-6, "{kelvin}: {error}");
        }
    }

    #[test]
    fn what_is_hotter_is_brighter_in_every_channel() {
        let mut last = Rgb::ZERO;
        for step in 0..3000 {
            let kelvin = 300.0 * 1.003_f64.powi(step);
            let radiance = blackbody_radiance(kelvin);
            assert!(radiance.is_finite() && radiance.cmpge(last).all(), "{kelvin}: {radiance}");
            last = radiance;
        }
        for none in [f64::NAN, -1.0, 0.0, 399.0, f64::INFINITY] {
            assert_eq!(blackbody_radiance(none), Rgb::ZERO);
        }
        let warm = blackbody_radiance(1500.0);
        assert!(warm.x > 5.0 * warm.y && warm.y > 0.0 && warm.z == 0.0, "{warm}");
    }
}
