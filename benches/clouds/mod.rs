//! Clouds of photons and a camera's queries, for benches of the gather.

use photonvdb::map::{Columns, PhotonMap, morton_code};
use photonvdb::math::{DVec3, Random, Stream, uniform};
use photonvdb::trace::{MapFrame, Photon};

/// How photons lie in the cube from -1 to 1.
#[derive(Clone, Copy, Debug)]
pub enum Cloud {
    /// Evenly.
    Uniform,
    /// As the density of smoke: clumps of many sizes and empty space between.
    Smoke,
    /// Most of them in a narrow cone, the others about it.
    Beam,
}

impl Cloud {
    pub const ALL: [Self; 3] = [Self::Uniform, Self::Smoke, Self::Beam];

    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Smoke => "smoke",
            Self::Beam => "beam",
        }
    }

    fn place(self, random: &mut Random) -> DVec3 {
        let mut draw = || DVec3::from_array(std::array::from_fn(|_| 2.0 * uniform(random) - 1.0));
        match self {
            Self::Uniform => draw(),
            Self::Smoke => loop {
                let place = draw();
                let level = 0.5 * (draw().x + 1.0);
                if level < smoke_density(place) {
                    return place;
                }
            },
            Self::Beam => {
                let (along, across, share) = (draw(), draw(), draw().x);
                let depth = -(1.0 - 0.5 * (along.x + 1.0) * 0.86).ln();
                if share < 0.0 {
                    DVec3::new(across.x * 0.1 * depth, across.y * 0.1 * depth, depth - 1.0)
                } else {
                    let spread = 0.15 + 0.3 * depth;
                    let near = DVec3::new(across.x, across.y, across.z * across.x.abs()) * spread;
                    (near * along.length() + DVec3::Z * (depth - 1.0))
                        .clamp(DVec3::NEG_ONE, DVec3::ONE)
                }
            }
        }
    }

    /// A map of `count` photons in the frame of the cube, with their directions if wanted.
    pub fn map(self, count: u32, direction: bool) -> Option<PhotonMap> {
        let mut random = Stream::Experiment.random(1, self as u64);
        let photons: Vec<Photon> = (0..count)
            .map(|_| Photon {
                position: self.place(&mut random).as_vec3().to_array(),
                direction: DVec3::new(0.36, 0.48, 0.8 - uniform(&mut random))
                    .normalize()
                    .as_vec3()
                    .to_array(),
                power: [0.2, 0.3, 0.5],
                sigma_t: 1.0,
                order: 1,
            })
            .collect();
        let frame = MapFrame { origin: DVec3::ZERO, unit: 1.0 };
        PhotonMap::build(&photons, frame, Columns { direction, ..Columns::default() }).ok()
    }
}

/// Octaves of value noise, cut off below their middle.
fn smoke_density(place: DVec3) -> f64 {
    let mut sum = 0.0;
    for octave in 0..5 {
        let scaled = place * f64::from(2 << octave);
        let cell = scaled.floor();
        let t = scaled - cell;
        let t = t * t * (3.0 - 2.0 * t);
        let at = |x: f64, y: f64, z: f64| {
            let corner = cell + DVec3::new(x, y, z);
            let index = (corner.x + 1000.0 * corner.y + 1e6 * corner.z + 1e9) as u64;
            Stream::Scramble.hash(octave, index) as f64 / u64::MAX as f64
        };
        let line = |y: f64, z: f64| at(0.0, y, z) * (1.0 - t.x) + at(1.0, y, z) * t.x;
        let plane = |z: f64| line(0.0, z) * (1.0 - t.y) + line(1.0, z) * t.y;
        let value = plane(0.0) * (1.0 - t.z) + plane(1.0) * t.z;
        sum += value * 0.5_f64.powi(octave as i32 + 1);
    }
    let fade = (1.0 - place.length_squared()).max(0.0);
    ((sum - 0.5) * 4.0).clamp(0.0, 1.0) * fade
}

/// The queries of some tiles of 16 x 16 pixels of a picture 128 pixels wide, 64 steps along each ray, in the order in
/// which the renderer asks them.
pub fn queries() -> Vec<DVec3> {
    let mut all = Vec::new();
    for [left, top] in [[56, 56], [32, 64], [80, 24], [8, 104]] {
        let mut tile: Vec<DVec3> = (0..16 * 16 * 64)
            .map(|i| {
                let (x, y, z) = (left + i % 16, top + i / 16 % 16, i / 256);
                let middle =
                    |n: i32, count: i32| (f64::from(n) + 0.5) / f64::from(count) * 2.0 - 1.0;
                DVec3::new(middle(x, 128), middle(y, 128), middle(z, 64))
            })
            .collect();
        let low = tile.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        tile.sort_by_cached_key(|&place| {
            morton_code(((place - low) * 512.0).to_array().map(|c| c as u64))
        });
        all.extend(tile);
    }
    all
}
