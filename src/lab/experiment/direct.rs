//! Places all n photons and finds the k-th nearest, as the thesis describes its experiments.
//!
//! Photons get coordinates, in the thesis's units: a scene of radius n^(1/d) around the query at the origin, so that
//! the ball of radius r is expected to hold r^d of them. The scene in one dimension is \[-n/2, n/2\], r counted twice.

use std::f64::consts::TAU;

use super::fixed_radius::place_and_count;
use super::jittered::JitteredCells;
use super::shells::{PhotonShell, shell_of};
use crate::lab::model::Model;
use crate::math::{Random, uniform};

/// Places all photons of a model.
pub(super) enum DirectDraw {
    Random(Placed, u32),
    Parts(Placed),
    Shells(Placed, Vec<PhotonShell>, u32),
    Jittered(JitteredCells),
    FixedRadius(Vec<u64>, Vec<f64>, u64),
}

/// Squared distances of all photons, and which are wanted.
pub(super) struct Placed {
    n: u64,
    /// Photons wanted, from 0 on, ascending.
    places: Vec<usize>,
    squares: Vec<f64>,
}

impl DirectDraw {
    /// For ascending `ks` of the model; none where there is nothing to place.
    pub(super) fn new(model: Model, n: u64, ks: &[u64]) -> Option<Self> {
        let places = ks.iter().map(|&k| k as usize - 1).collect();
        let placed = Placed { n, places, squares: Vec::with_capacity(n as usize) };
        Some(match model {
            Model::FirstApproximation => return None,
            Model::FixedRadius => Self::FixedRadius(ks.to_vec(), Vec::new(), n),
            Model::Random(dimension) => Self::Random(placed, dimension),
            Model::Stratified => Self::Parts(placed),
            Model::Jittered(dimension) => {
                let edge = (n as f64).powf(1.0 / f64::from(dimension)).round() as u64;
                Self::Jittered(JitteredCells::grid(dimension, edge, ks))
            }
            _ => Self::Shells(placed, all_shells(model, n), model.dimension()),
        })
    }

    /// Places one set of photons: u_(k) of each k into `measures`; with a fixed radius, the number of photons in it.
    pub(super) fn draw(&mut self, random: &mut Random, measures: &mut [f64]) {
        match self {
            Self::Random(placed, dimension) => {
                let dimension = *dimension;
                let radius = (placed.n as f64).powf(1.0 / f64::from(dimension));
                placed.place(|squares, n| {
                    squares
                        .extend((0..n).map(|_| radius * radius * ball_square(dimension, random)));
                });
                placed.read(dimension, measures);
            }
            Self::Parts(placed) => {
                placed.place(|squares, n| {
                    let middle = 0.5 * n as f64;
                    squares.extend(
                        (0..n).map(|part| (2.0 * (part as f64 + uniform(random) - middle)).powi(2)),
                    );
                });
                placed.read(1, measures);
            }
            Self::Shells(placed, shells, dimension) => {
                let dimension = *dimension;
                placed.place(|squares, _| {
                    for shell in &*shells {
                        squares.extend((0..shell.count).map(|_| {
                            let measure = shell.measure(uniform(random));
                            let radius = measure.powf(1.0 / f64::from(dimension));
                            let point = direction(dimension, random).map(|axis| axis * radius);
                            point.iter().map(|along| along * along).sum::<f64>()
                        }));
                    }
                });
                placed.read(dimension, measures);
            }
            Self::Jittered(cells) => cells.draw(random, measures),
            Self::FixedRadius(ks, distances, n) => {
                place_and_count(*n, ks, random, distances, measures);
            }
        }
    }
}

/// The shells of all n photons; the last one is left out where it is not complete.
fn all_shells(model: Model, n: u64) -> Vec<PhotonShell> {
    let mut shells = Vec::new();
    let mut k = 1;
    while let Some((shell, _)) = shell_of(model, n, k).filter(|(shell, _)| k + shell.count - 1 <= n)
    {
        shells.push(shell);
        k += shell.count;
    }
    shells
}

impl Placed {
    fn place(&mut self, fill: impl FnOnce(&mut Vec<f64>, u64)) {
        self.squares.clear();
        fill(&mut self.squares, self.n);
    }

    /// Finds the photons wanted: u = r^d.
    fn read(&mut self, dimension: u32, measures: &mut [f64]) {
        let Some(&last) = self.places.last() else { return };
        self.squares.select_nth_unstable_by(last, f64::total_cmp);
        self.squares[..=last].sort_unstable_by(f64::total_cmp);
        for (measure, &place) in measures.iter_mut().zip(&self.places) {
            *measure = self.squares[place].powf(0.5 * f64::from(dimension));
        }
    }
}

/// Squared distance from the origin of a point uniform in the ball of radius 1.
fn ball_square(dimension: u32, random: &mut Random) -> f64 {
    loop {
        let square = (0..dimension).map(|_| (2.0 * uniform(random) - 1.0).powi(2)).sum::<f64>();
        if square <= 1.0 {
            return square;
        }
    }
}

/// A direction of unit length, uniform.
fn direction(dimension: u32, random: &mut Random) -> [f64; 3] {
    let (sin, cos) = (TAU * uniform(random)).sin_cos();
    let z = if dimension == 3 { 2.0 * uniform(random) - 1.0 } else { 0.0 };
    let across = (1.0 - z * z).sqrt();
    [across * cos, across * sin, z]
}
