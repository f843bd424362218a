//! The peaks that lamps make in scattered light, and cells that need not hold them.
//!
//! Where light of intensity I from a point scatters once, twice-scattered light falls as the inverse distance d to the point: the fluence is
//! sigma_s I pi^2 / (4 d) of what nearby scatterers send on, as the integral of 1 / (|y|^2 |x - y|^2) over all y is pi^3 / |x|. Cells
//! would flatten the peak over their edge; near a lamp they hold light times w = d / R instead, which has none, and what is read is divided by
//! w. That is exact for any w as cells shrink.
//!
//! Points that are spread evenly along a ray hardly ever meet the peak. Nearer than r to a lamp they count by a share d / r, and what is left,
//! 1 - d / r, belongs to the lamp and is looked for apart, by the inverse of the distance to it.

use crate::light::{Light, LightChoice};
use crate::math::{DVec3, Ray, Span, mean_channel};
use crate::medium::Bounds;

/// Lamps beyond which they cost more to look for than their peaks matter.
const MOST_LAMPS: usize = 8;

/// Share of all intensity below which a lamp's peak is lost in the light of the others.
const LEAST_SHARE: f64 = 0.05;

/// How far peaks reach \[cells\]: beyond, they are nearly straight over a cell.
const REACH: f64 = 3.0;

/// How near to a lamp light is looked for by the distance to it, too \[cells\].
const NEAR: f64 = 1.0;

/// How near to a lamp the peak goes on \[cells\]: it has no bound.
const NEAREST: f64 = 1e-6;

/// Lamps inside a medium.
#[derive(Clone, Debug)]
pub struct Lamps {
    /// Positions \[m\].
    lamps: Vec<DVec3>,
    /// Edge of a cell \[m\].
    edge: f64,
}

impl Lamps {
    /// The lamps among the chosen lights inside bounds, for cells that are `edge` long \[m\]; `None` if there are none or too many.
    pub fn of(lights: &[Light], choice: LightChoice, bounds: &Bounds, edge: f64) -> Option<Self> {
        let lit = lights.iter().enumerate().filter(|(index, _)| choice.has_light(*index));
        let lamp = |(_, light): (usize, &Light)| {
            let position = light.position().filter(|position| bounds.contains(*position))?;
            Some((position, mean_channel(light.color()?)))
        };
        let lamps: Vec<(DVec3, f64)> = lit.filter_map(lamp).collect();
        let least: f64 = LEAST_SHARE * lamps.iter().map(|(_, intensity)| intensity).sum::<f64>();
        let strong = lamps.into_iter().filter(|(_, intensity)| *intensity > least);
        let lamps: Vec<DVec3> = strong.map(|(position, _)| position).collect();
        (1..=MOST_LAMPS).contains(&lamps.len()).then_some(Self { lamps, edge })
    }

    /// What light at a place is multiplied by: 1 far from lamps.
    #[inline]
    pub fn weight(&self, place: DVec3) -> f64 {
        let reach = REACH * self.edge;
        let mut weight = 1.0;
        for position in &self.lamps {
            let squared = place.distance_squared(*position);
            if squared < reach * reach {
                weight *= squared.sqrt().max(NEAREST * self.edge) / reach;
            }
        }
        weight
    }

    /// What is left of a peak at a place by the mean over a ball about it: that of 1 / d over a ball of radius r about a lamp is 3 / (2 r).
    pub fn mean_share(&self, place: DVec3, ball_radius: f64) -> f64 {
        let [nearest, reach] = [NEAREST, REACH].map(|cells| cells * self.edge);
        let share = |lamp: &DVec3| {
            let distance = place.distance(*lamp).max(nearest);
            (distance / (2.0 / 3.0 * ball_radius).clamp(nearest, reach)).min(1.0)
        };
        self.lamps.iter().map(share).product()
    }

    /// The share of light at a place that is no lamp's own: 1 but near lamps.
    #[inline]
    pub fn even_share(&self, place: DVec3) -> f64 {
        self.lamps.iter().map(|lamp| self.closeness(*lamp, place)).product()
    }

    /// The share that is that lamp's own. With the even share, those of all lamps add up to 1; at a lamp it has all but nothing of the peak of another.
    pub fn own_share(&self, lamp: usize, place: DVec3) -> f64 {
        let peak = |lamp: &DVec3| 1.0 / self.closeness(*lamp, place) - 1.0;
        let own = peak(&self.lamps[lamp]);
        if own > 0.0 {
            (1.0 - self.even_share(place)) * own / self.lamps.iter().map(peak).sum::<f64>()
        } else {
            0.0
        }
    }

    /// The lamps that a part of a ray passes near: the number of each, its place, and the part where it has a share.
    pub fn near(&self, ray: &Ray, span: Span) -> impl Iterator<Item = (usize, DVec3, Span)> {
        self.lamps.iter().enumerate().filter_map(move |(number, lamp)| {
            let ball = Bounds::Sphere { center: *lamp, radius: NEAR * self.edge };
            let chord = ball.intersect(ray)?.intersect(span)?;
            Some((number, *lamp, chord))
        })
    }

    /// Distance to a lamp as a share of that up to which it is near; 1 beyond.
    #[inline]
    fn closeness(&self, lamp: DVec3, place: DVec3) -> f64 {
        let near = NEAR * self.edge;
        let squared = place.distance_squared(lamp);
        if squared < near * near { squared.sqrt().max(NEAREST * self.edge) / near } else { 1.0 }
    }

    /// The mean weight along a piece of a ray that lies in one cell: that of the middles of its halves, which is right through a lamp, too.
    #[inline]
    pub fn mean_weight(&self, ray: &Ray, enters: f64, leaves: f64) -> f64 {
        let quarter = 0.25 * (leaves - enters);
        0.5 * (self.weight(ray.at(enters + quarter)) + self.weight(ray.at(leaves - quarter)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::PointLight;
    use crate::math::Rgb;

    fn lamp(position: DVec3, intensity: f64) -> Light {
        Light::Point(PointLight { position, intensity: Rgb::splat(intensity) })
    }

    #[test]
    fn weights_take_the_peaks_off() {
        let bounds = Bounds::Box { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };
        let (near, far) = (DVec3::new(0.5, 0.0, 0.0), DVec3::new(9.0, 0.0, 0.0));
        let weak = DVec3::new(-0.5, 0.0, 0.0);
        let lights = [lamp(DVec3::ZERO, 1.0), lamp(near, 3.0), lamp(far, 1.0), lamp(weak, 0.1)];
        let of = |choice| Lamps::of(&lights, choice, &bounds, 0.1);
        let lamps = of(LightChoice::All).unwrap();
        // In proportion to the distance within three cells; 1 beyond, and about the weak one.
        for position in [DVec3::ZERO, near] {
            for (distance, weight) in [(0.06, 0.2), (0.15, 0.5), (0.31, 1.0), (0.01, 0.1 / 3.0)] {
                let found = lamps.weight(position + DVec3::Y * distance);
                assert!((found - weight).abs() < 1e-12, "{distance}: {found}");
            }
        }
        assert_eq!(lamps.weight(weak), 1.0);
        assert!(of(LightChoice::Light(2)).is_none() && of(LightChoice::Medium).is_none());
        assert_eq!(of(LightChoice::Light(1)).unwrap().weight(DVec3::ZERO), 1.0);
        // Through the lamp: the mean distance is a quarter of the piece.
        let neighbour = near - DVec3::X * 0.06;
        let lights = [lamp(near, 1.0), lamp(neighbour, 1.0)];
        let close = Lamps::of(&lights, LightChoice::All, &bounds, 0.1).unwrap();
        let ray = Ray::new(near - DVec3::X * 0.25, DVec3::X);
        let mean = lamps.mean_weight(&ray, 0.0, 0.5);
        assert!((mean - 0.125 / 0.3).abs() < 1e-12, "{mean}");
        // Shares of light near both.
        for place in [DVec3::X * 0.46, DVec3::new(0.53, 0.02, 0.0), DVec3::new(0.3, 0.1, 0.2)] {
            let own: f64 = (0..2).map(|lamp| close.own_share(lamp, place)).sum();
            assert!((close.even_share(place) + own - 1.0).abs() < 1e-15);
        }
        assert_eq!(close.even_share(DVec3::new(0.3, 0.1, 0.2)), 1.0);
        assert!(close.own_share(1, DVec3::X * 0.46) > 0.1);
        // The mean over a ball about a lamp, and about a place that is far from it.
        for (distance, share) in [(0.0, 1e-7 / 0.02), (0.01, 0.5), (0.02, 1.0), (0.2, 1.0)] {
            let found = close.mean_share(near + DVec3::X * distance, 0.03);
            assert!((found / share - 1.0).abs() < 1e-12, "{distance}: {found}");
        }
        let many: Vec<Light> = (0..9).map(|_| lamp(DVec3::ZERO, 1.0)).collect();
        assert!(Lamps::of(&many, LightChoice::All, &bounds, 0.1).is_none());
    }
}
