//! E16: k-nearest estimates among photons placed at random, by the map and the estimator of renders.

use std::num::NonZeroUsize;

use super::Extent;
use super::check::{Check, Quantity};
use super::error::ValidateError;
use super::stage::fog;
use crate::estimate::{Divisor, EstimateOptions, Estimator, Kernel};
use crate::map::{Columns, PhotonMap};
use crate::math::{DVec3, Random, Stream, uniform};
use crate::medium::{Bounds, UniformExtinction};
use crate::trace::{MapFrame, Photon};

const GROUP: &str = "neighbours";

/// Places asked in a map, near its middle.
const PLACES: usize = 50;

pub(super) fn checks<'a>(extent: Extent) -> Vec<Check<'a>> {
    [5, 20, 50].into_iter().filter_map(NonZeroUsize::new).map(|k| of_poisson(extent, k)).collect()
}

/// Means by every divisor and kernel, and the variance 1 / (k - 2) of k - 1, about a density of 1.
fn of_poisson<'a>(extent: Extent, k: NonZeroUsize) -> Check<'a> {
    let real = k.get() as f64;
    let ways = [
        ("divisor k", Divisor::K, Kernel::Constant, real / (real - 1.0)),
        ("divisor k-1/2", Divisor::KMinusHalf, Kernel::Constant, (real - 0.5) / (real - 1.0)),
        ("divisor k-1", Divisor::KMinus1, Kernel::Constant, 1.0),
        ("Epanechnikov", Divisor::K, Kernel::Epanechnikov, 1.0),
    ];
    let name = |what: &str| format!("E16, k {k}: {what}");
    let mean = |(what, _, _, exact): (&str, _, _, _)| Quantity::new(name(what), exact);
    let mut quantities: Vec<Quantity> = ways.map(mean).to_vec();
    quantities.push(Quantity::new(name("variance, divisor k-1"), 1.0 / (real - 2.0)));
    Check::new(GROUP, quantities, extent.pick(4000, 20_000), move |batch| {
        let mut random = Stream::Experiment.random(batch.seed, 0);
        // Independent maps by the hundred: neighbours of one map are not.
        let maps = 20;
        let mut figures = vec![0.0; 5];
        for _ in 0..maps {
            let (map, density) = random_map(batch.count / 4, &mut random)?;
            let medium = fog(Bounds::Infinite, 1.0, 0.0, 0.0);
            let extinction = UniformExtinction { sigma_t: 1.0 };
            let places: Vec<DVec3> = (0..PLACES).map(|_| in_cube(0.3, &mut random)).collect();
            for (n, (_, divisor, kernel, _)) in ways.into_iter().enumerate() {
                let constant = divisor.constant(k).unwrap_or(k.get() as f64);
                let max_radius = f64::INFINITY;
                let options = EstimateOptions { k, constant, kernel, max_radius };
                let mut estimator = Estimator::new(&medium, &extinction, &map, options);
                for place in &places {
                    let value = estimator.power_density(*place).value.x / density;
                    let share = 1.0 / (maps * PLACES) as f64;
                    figures[n] += value * share;
                    if n == 2 {
                        figures[4] += (value - 1.0).powi(2) * share;
                    }
                }
            }
        }
        Ok(figures)
    })
}

/// About `count` photons of 1 W, a Poisson number of them, in the cube from -1 to 1, and their density.
fn random_map(count: u64, random: &mut Random) -> Result<(PhotonMap, f64), ValidateError> {
    let mut photons = Vec::new();
    // Exponential steps along a line that fills the cube.
    let mut filled = -(-uniform(random)).ln_1p();
    while filled < count as f64 {
        photons.push(Photon {
            position: in_cube(1.0, random).as_vec3().to_array(),
            direction: [0.0, 0.0, 1.0],
            power: [1.0; 3],
            sigma_t: 1.0,
            order: 0,
        });
        filled -= (-uniform(random)).ln_1p();
    }
    let frame = MapFrame { origin: DVec3::ZERO, unit: 1.0 };
    Ok((PhotonMap::build(&photons, frame, Columns::default())?, count as f64 / 8.0))
}

fn in_cube(half: f64, random: &mut Random) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| half * (2.0 * uniform(random) - 1.0)))
}
