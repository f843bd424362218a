//! Stratified photons one shell at a time: the law that all of the thesis's stratified models share.
//!
//! Let u be the number of photons expected in the ball out to the k-th one. The k-th photon is the j-th of the x
//! photons of its shell, which ends at u = T; the shells inside it hold T - x photons for certain. With V the
//! fraction of the way back from the outer end,
//!
//! u_(k) = T (1 - q V)^d, V ~ Beta(x + 1 - j, j), k = T - x + j,
//!
//! where d = 1 and q = x / T for photons uniform in volume, and q = 1 - (1 - x / T)^(1/d) for photons uniform in
//! radius (equations 2.27 and 2.41 of the thesis). Its 1-D and basic models are shells of two photons and of one.
//!
//! E\[1/u\] = 2F1(d, x+1-j; x+1; q) / T, summed as a series of positive terms: the logarithms of the closed form
//! cancel to nothing long before k = 10^9.

/// Terms of a series below this share of their sum no longer change it.
const NEGLIGIBLE: f64 = 1e-18;

/// Negligible terms in a row that end a series: single ones may vanish.
const NEGLIGIBLE_RUN: usize = 6;

/// The law of the expected photon count in the ball out to the k-th photon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellLaw {
    /// Photons in all shells up to that of the k-th photon, T.
    end: f64,
    /// Photons in that shell, x.
    count: f64,
    /// Which of them is the k-th photon, j, from 1 on.
    place: f64,
    /// 1 for photons uniform in volume, else the dimension, d.
    power: f64,
}

impl ShellLaw {
    /// Photons uniform in the volume of the shell.
    pub fn uniform_in_volume(end: u64, count: u64, place: u64) -> Self {
        Self { end: end as f64, count: count as f64, place: place as f64, power: 1.0 }
    }

    /// Photons uniform in the radius, in `dimension` dimensions.
    pub fn uniform_in_radius(end: u64, count: u64, place: u64, dimension: u32) -> Self {
        let power = f64::from(dimension);
        Self { power, ..Self::uniform_in_volume(end, count, place) }
    }

    /// k.
    fn k(&self) -> f64 {
        self.end - self.count + self.place
    }

    /// q: how far the shell reaches back, as a share of its outer radius (of its volume if the power is 1).
    fn depth(&self) -> f64 {
        let share = self.count / self.end;
        if self.power == 1.0 { share } else { -((-share).ln_1p() / self.power).exp_m1() }
    }

    /// Whether the mean of 1/u is finite: it is not where the shell begins at 0 and k = 1.
    pub fn has_mean(&self) -> bool {
        self.count < self.end || self.place > 1.0
    }

    /// Whether the variance of 1/u is finite.
    pub fn has_variance(&self) -> bool {
        self.count < self.end || self.place > 2.0
    }

    /// E\[k/u\] - 1. Infinite for the first photon.
    pub fn bias(&self) -> f64 {
        if !self.has_mean() {
            return f64::INFINITY;
        }
        if self.count == self.end {
            // The first shell of two, uniform in volume: 2F1(1, 1; 3; 1) = 2.
            return 1.0;
        }
        if self.power == 1.0 { self.bias_in_volume() } else { self.bias_in_radius() }
    }

    /// (j/T) sum (m+1)/(x+1+m) q^m c_m, c_m = prod_{i<m} (x+1-j+i)/(x+1+i): every term positive, no digit lost.
    fn bias_in_volume(&self) -> f64 {
        let (q, mut product) = (self.depth(), 1.0);
        let sum = sum_series((0..).map(|m| {
            let m = f64::from(m);
            let term = product * (m + 1.0) / (self.count + 1.0 + m);
            product *= q * self.ratio(m);
            term
        }));
        self.place / self.end * sum
    }

    /// S - (x-j)/T (1 + S), S the series of 2F1 without its first term.
    fn bias_in_radius(&self) -> f64 {
        let (q, mut term) = (self.depth(), 1.0);
        let excess = sum_series((0..).map(|m| {
            let m = f64::from(m);
            term *= q * self.ratio(m) * (self.power + m) / (m + 1.0);
            term
        }));
        excess - (self.count - self.place) / self.end * (1.0 + excess)
    }

    /// (x+1-j+m) / (x+1+m)
    fn ratio(&self, m: f64) -> f64 {
        (self.count + 1.0 - self.place + m) / (self.count + 1.0 + m)
    }

    /// E\[(k-1/2)/u\] - 1 to full relative accuracy, where that is known: for a shell of one photon it is
    /// sum t^(2i)/(2i+1), t = 1/(2k-1), of order 1/k^2, which a difference of terms of order 1/k would lose.
    pub fn half_bias(&self) -> Option<f64> {
        if self.count != 1.0 || self.power != 1.0 || !self.has_mean() {
            return None;
        }
        let square = (2.0 * self.k() - 1.0).powi(-2);
        let mut power = 1.0;
        Some(sum_series((1..).map(|i| {
            power *= square;
            power / f64::from(2 * i + 1)
        })))
    }

    /// Var\[k/u\]; infinite where 1/u^2 has no mean.
    ///
    /// From the central moments of V, never as a difference of squares: with w = V - E\[V\] and
    /// h = q / (1 - q E\[V\]), 1/u = (1 - q E\[V\])^(-d) (1 - h w)^(-d) / T, and the moments of h w obey
    /// M_{m+1} = m h / (x + 1 + m) ((1 - 2 E\[V\]) M_m + h E\[V\] (1 - E\[V\]) M_{m-1}).
    pub fn variance(&self) -> f64 {
        if !self.has_variance() {
            return f64::INFINITY;
        }
        let (d, total) = (self.power, self.count + 1.0);
        let mean = (total - self.place) / total;
        let spread = mean * (1.0 - mean);
        let q = self.depth();
        let h = q / (1.0 - q * mean);

        let (mut before, mut moment) = (0.0, h * h * spread / (total + 1.0));
        // Binomial coefficients of (1 - y)^(-d) and (1 - y)^(-2d) at y^m.
        let (mut first, mut second) = (d * (d + 1.0) / 2.0, d * (2.0 * d + 1.0));
        let (mut of_mean, mut of_square) = (0.0, 0.0);
        let mut run = 0;
        for m in 2.. {
            let (in_mean, in_square) = (first * moment, (second - 2.0 * first) * moment);
            of_mean += in_mean;
            of_square += in_square;
            run = if in_square.abs() <= NEGLIGIBLE * of_square.abs() { run + 1 } else { 0 };
            if run == NEGLIGIBLE_RUN {
                break;
            }
            let m = f64::from(m);
            let next = m * h / (total + m) * ((1.0 - 2.0 * mean) * moment + h * spread * before);
            (before, moment) = (moment, next);
            first *= (d + m) / (m + 1.0);
            second *= (2.0 * d + m) / (m + 1.0);
        }
        let scale = self.k() / self.end * (1.0 - q * mean).powf(-d);
        scale * scale * (of_square - of_mean * of_mean)
    }
}

/// The sum of a series of terms that fall off at least geometrically in the end.
fn sum_series(terms: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut run) = (0.0, 0);
    for term in terms {
        sum += term;
        run = if term.abs() <= NEGLIGIBLE * sum.abs() { run + 1 } else { 0 };
        if run == NEGLIGIBLE_RUN {
            break;
        }
    }
    sum
}
