//! A place of a scene: what one map says there, and what all maps together do.
//!
//! The power within r of a place is kept on a grid of radii that is even in r^3, and read between them linearly in r^3:
//! exactly where the density is even. Estimates of one map are held against the mean over all other maps, P. Of a Poisson
//! number N, 1/(N + 1) has the mean of 1/E\[N\]: where P divides, it is therefore taken as if a typical photon more had been found.

use crate::map::{NearestPhotons, PhotonMap, RADIUS_FLOOR};
use crate::math::{Ball, DVec3, Rgb, mean_channel};
use crate::medium::Bounds;

/// Steps of r^3 from the place to its reach.
pub(super) const STEP_COUNT: usize = 128;

/// Where all maps are asked, and what they hold about it.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub(super) position: DVec3,
    /// Radius of the largest ball \[m\].
    pub(super) reach: f64,
    /// Power within each radius of the grid, over all maps \[W\].
    pooled: [f64; STEP_COUNT],
    /// Photons within reach, over all maps.
    pooled_count: u64,
    /// Map by map, k by k.
    readings: Vec<Reading>,
}

/// What one map holds in the ball of k photons.
#[derive(Clone, Copy, Debug)]
struct Reading {
    /// Radius of the ball \[m\].
    radius: f64,
    /// Power of the k photons \[W\].
    power: f64,
    /// Power within that radius, as read from the grid.
    on_grid: f64,
    /// Power in the inner ball.
    inner: f64,
}

/// Which balls are asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Balls<'a> {
    /// Ascending.
    pub(super) ks: &'a [u64],
    /// Steps to the radius of the inner ball, in which the density counts as even.
    pub(super) inner_step: usize,
}

/// Errors of one estimate.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaceErrors {
    /// Power of the k photons / expected in their ball - 1.
    pub(super) intrinsic: f64,
    /// Density expected in their ball / in the inner ball - 1.
    pub(super) smoothing: f64,
    /// Density estimated / expected in the inner ball - 1.
    pub(super) total: f64,
}

impl Place {
    pub(super) fn new(position: DVec3, reach: f64) -> Self {
        let pooled = [0.0; STEP_COUNT];
        Self { position, reach, pooled, pooled_count: 0, readings: Vec::new() }
    }

    /// Asks one more map; `None` if it holds fewer photons than the largest k.
    pub(super) fn ask(&mut self, finder: &mut NearestPhotons<'_>, balls: Balls<'_>) -> Option<()> {
        let map = finder.map();
        let unit = map.frame().unit;
        let largest = balls.ks.last().copied().unwrap_or(1) as usize;
        let mut reach = self.reach;
        let mut around = photons_within(finder, self.position, reach);
        let within_reach = around.len();
        while around.len() < largest {
            if around.len() == map.len() {
                return None;
            }
            reach *= 1.5;
            around = photons_within(finder, self.position, reach);
        }
        around.sort_unstable_by_key(|photon| (photon.0.to_bits(), photon.1));
        let distance = |square: f32| f64::from(square).sqrt() * unit;

        let mut own = [0.0; STEP_COUNT];
        for &(square, photon) in around.iter().filter(|p| distance(p.0) < self.reach) {
            let step = STEP_COUNT as f64 * (distance(square) / self.reach).powi(3);
            own[(step as usize).min(STEP_COUNT - 1)] += power(map, photon);
        }
        let mut sum = 0.0;
        for (own, pooled) in own.iter_mut().zip(&mut self.pooled) {
            sum += *own;
            *own = sum;
            *pooled += sum;
        }
        self.pooled_count += within_reach as u64;

        let (mut found, mut sum) = (0, 0.0);
        for &k in balls.ks {
            let upto = k as usize;
            sum += around[found..upto].iter().map(|&(_, p)| power(map, p)).sum::<f64>();
            found = upto;
            // As estimates do: photons that coincide have no infinite density.
            let radius = distance(around[upto - 1].0).max(f64::from(RADIUS_FLOOR) * unit);
            let on_grid = self.read(&own, radius);
            let inner = own[balls.inner_step - 1];
            self.readings.push(Reading { radius, power: sum, on_grid, inner });
        }
        Some(())
    }

    /// Errors of each k in one of `map_count` maps.
    pub(super) fn errors(
        &self,
        map: usize,
        map_count: usize,
        balls: Balls<'_>,
        bounds: &Bounds,
    ) -> impl Iterator<Item = PlaceErrors> {
        let others = (map_count - 1) as f64;
        let photon = self.pooled[STEP_COUNT - 1] / self.pooled_count.max(1) as f64;
        let volume = |radius: f64| bounds.overlap(Ball { center: self.position, radius }).mass;
        let inner_radius = self.reach * (balls.inner_step as f64 / STEP_COUNT as f64).cbrt();
        let inner_volume = volume(inner_radius);
        let inner = self.pooled[balls.inner_step - 1];
        let first = map * balls.ks.len();
        let readings = &self.readings[first..first + balls.ks.len()];
        readings.iter().map(move |reading| {
            let all = self.read(&self.pooled, reading.radius);
            let found = (all - reading.on_grid) / others;
            let expected = found + photon / others;
            let density = (inner - reading.inner + photon) / others / inner_volume;
            let ball = volume(reading.radius);
            PlaceErrors {
                intrinsic: reading.power / expected - 1.0,
                smoothing: found / ball / density - 1.0,
                total: reading.power / ball / density - 1.0,
            }
        })
    }

    /// Power within a radius, from the grid; beyond it as if the density went on.
    fn read(&self, grid: &[f64; STEP_COUNT], radius: f64) -> f64 {
        let step = STEP_COUNT as f64 * (radius / self.reach).powi(3);
        if step >= STEP_COUNT as f64 {
            return grid[STEP_COUNT - 1] * step / STEP_COUNT as f64;
        }
        let below = step as usize;
        let before = if below == 0 { 0.0 } else { grid[below - 1] };
        before + (grid[below] - before) * (step - below as f64)
    }
}

/// Squared distances in map units, and photons.
fn photons_within(
    finder: &mut NearestPhotons<'_>,
    position: DVec3,
    radius: f64,
) -> Vec<(f32, u32)> {
    finder.within(position, radius).iter().map(|(photon, square)| (square, photon)).collect()
}

/// Mean channel of a photon's power \[W\].
fn power(map: &PhotonMap, photon: u32) -> f64 {
    mean_channel(Rgb::from_array(map.power(photon).map(f64::from)))
}
