//! Draws only what the k asked for depend on: order statistics of few photons in the place of all n.
//!
//! - Random photons: the order statistics of n uniform numbers are u_(k) / n = G_k / G_{n+1}, G_m the sum of m
//!   exponential numbers, so that one walk through the k asked for draws them all.
//! - Shells: photons of other shells do not matter.
//! - Jittered cells: nor do cells beyond a radius that holds k photons for certain.

use rand_distr::{Distribution, Exp1, Gamma};

use super::fixed_radius::draw_counts;
use super::jittered::JitteredCells;
use super::shells::{PhotonShell, shell_of};
use crate::lab::model::Model;
use crate::math::{Random, uniform};

/// Draws u_(k) for a list of k.
pub(super) enum FastDraw {
    Random(Box<RandomDraw>),
    Shells(Vec<ShellDraw>),
    Jittered(JitteredCells),
    FixedRadius(u64, Vec<u64>),
}

impl FastDraw {
    /// For ascending `ks` of the model; none where there is nothing to draw.
    pub(super) fn new(model: Model, n: u64, ks: &[u64]) -> Option<Self> {
        Some(match model {
            Model::FirstApproximation => return None,
            Model::FixedRadius => Self::FixedRadius(n, ks.to_vec()),
            Model::Random(_) => Self::Random(Box::new(RandomDraw::new(n, ks)?)),
            Model::Jittered(dimension) => Self::Jittered(JitteredCells::nearest(dimension, ks)),
            _ => Self::Shells(shell_draws(model, n, ks)),
        })
    }

    /// Draws one set of photons: u_(k) of each k into `measures`; with a fixed radius, the number of photons in it.
    pub(super) fn draw(&mut self, random: &mut Random, measures: &mut [f64]) {
        match self {
            Self::Random(draw) => draw.draw(random, measures),
            Self::Shells(shells) => {
                shells.iter_mut().for_each(|shell| shell.draw(random, measures));
            }
            Self::Jittered(cells) => cells.draw(random, measures),
            Self::FixedRadius(n, ks) => draw_counts(*n, ks, random, measures),
        }
    }
}

/// Order statistics of n uniform numbers.
pub(super) struct RandomDraw {
    n: f64,
    /// The gap before each k, none where it is a single photon.
    gaps: Vec<Option<Gamma<f64>>>,
    rest: Gamma<f64>,
}

impl RandomDraw {
    fn new(n: u64, ks: &[u64]) -> Option<Self> {
        let before = std::iter::once(0).chain(ks.iter().copied());
        let gaps = before.zip(ks).map(|(before, &k)| match k - before {
            1 => None,
            gap => Gamma::new(gap as f64, 1.0).ok(),
        });
        let rest = Gamma::new((n + 1 - ks.last()?) as f64, 1.0).ok()?;
        Some(Self { n: n as f64, gaps: gaps.collect(), rest })
    }

    fn draw(&self, random: &mut Random, measures: &mut [f64]) {
        let mut sum = 0.0;
        for (gap, measure) in self.gaps.iter().zip(measures.iter_mut()) {
            sum += match gap {
                None => Exp1.sample(random),
                Some(gap) => gap.sample(random),
            };
            *measure = sum;
        }
        let scale = self.n / (sum + self.rest.sample(random));
        measures.iter_mut().for_each(|measure| *measure *= scale);
    }
}

/// One shell, and the k whose photons lie in it.
pub(super) struct ShellDraw {
    shell: PhotonShell,
    /// Index of k, and which of the shell's photons it is, from 0 on.
    wanted: Vec<(usize, usize)>,
    fractions: Vec<f64>,
}

fn shell_draws(model: Model, n: u64, ks: &[u64]) -> Vec<ShellDraw> {
    let mut draws: Vec<ShellDraw> = Vec::new();
    for (index, &k) in ks.iter().enumerate() {
        let Some((shell, place)) = shell_of(model, n, k) else { continue };
        let wanted = (index, place as usize - 1);
        match draws.last_mut() {
            Some(draw) if draw.shell == shell => draw.wanted.push(wanted),
            _ => {
                let fractions = vec![0.0; shell.count as usize];
                draws.push(ShellDraw { shell, wanted: vec![wanted], fractions });
            }
        }
    }
    draws
}

impl ShellDraw {
    fn draw(&mut self, random: &mut Random, measures: &mut [f64]) {
        self.fractions.iter_mut().for_each(|fraction| *fraction = uniform(random));
        match &mut self.fractions[..] {
            [_] => {}
            [first, second] => (*first, *second) = (first.min(*second), first.max(*second)),
            many => many.sort_unstable_by(f64::total_cmp),
        }
        for &(index, place) in &self.wanted {
            measures[index] = self.shell.measure(self.fractions[place]);
        }
    }
}
