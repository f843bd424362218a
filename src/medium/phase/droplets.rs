//! Scattering by the water droplets of fog and clouds.
//!
//! Jendersie and d'Eon, *An Approximate Mie Scattering Function for Fog and Cloud Rendering* (SIGGRAPH 2023 Talks): Lorenz and Mie's
//! phase function of droplets, for visible light, as a mixture of a narrow Henyey-Greenstein lobe, the diffraction peak, and a wide Draine
//! lobe. The four parameters were fitted to droplets of 5 to 50 micrometres diameter; rainbow and glory are smoothed out. The mean
//! cosine is 0.843, 0.864, 0.879 and 0.891 at 5, 10, 20 and 50 micrometres, 0.013 to 0.019 above that of Mie theory.

use super::{Lobe, Phase};

/// The smallest droplets that the fit is of: their diameter in micrometres.
pub const SMALLEST_DROPLET: f64 = 5.0;

/// The largest, in micrometres.
pub const LARGEST_DROPLET: f64 = 50.0;

impl Phase {
    /// Of water droplets, by their diameter in micrometres, which is held to 5 to 50.
    pub fn droplets(diameter: f64) -> Self {
        let d = diameter.clamp(SMALLEST_DROPLET, LARGEST_DROPLET);
        let peak = Lobe::henyey_greenstein((-0.099_056_7 / (d - 1.671_54)).exp());
        let wide = Lobe {
            g: (-2.206_79 / (d + 3.910_29) - 0.428_934).exp(),
            alpha: (3.624_89 - 8.292_88 / (d + 5.528_25)).exp(),
        };
        let wide_share = (-0.599_085 / (d - 0.641_583) - 0.665_888).exp();
        Self::two_lobes(peak, wide, 1.0 - wide_share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean cosines by Mie theory (Bohren and Huffman's series) at 550 nm, refractive index 1.334, diameters spread evenly over
    /// +-10 %: the fit, which weighs the shape of the peak, lies up to 0.02 above.
    #[test]
    fn mean_cosines_are_those_of_droplets() {
        for (diameter, by_mie) in [(5.0, 0.8246), (10.0, 0.8513), (20.0, 0.8645), (50.0, 0.8751)] {
            let excess = Phase::droplets(diameter).mean_cosine() - by_mie;
            assert!(excess > 0.01 && excess < 0.02, "{diameter}: {excess}");
        }
    }

    /// Forward scattering sharpens with the diameter, and there is a backward rise.
    #[test]
    fn the_peak_grows_with_the_droplets() {
        let [small, large] = [6.0, 40.0].map(Phase::droplets);
        assert!(large.density(1.0) > 20.0 * small.density(1.0));
        assert!(small.density(-1.0) > small.density(-0.3));
        assert_eq!(Phase::droplets(0.0), Phase::droplets(5.0));
        assert_eq!(Phase::droplets(f64::INFINITY), Phase::droplets(50.0));
    }
}
