//! Where the cells of a lattice lie.

use crate::lattice::Lamps;
use crate::math::{DAffine3, DMat3, DVec3};
use crate::medium::{Bounds, Parallelepiped};

/// Cells of equal size that fill a medium's bounds, or, of a round medium, the cube about it.
#[derive(Clone, Debug)]
pub struct LatticeShape {
    /// From world space to cells: integer coordinates are the cells' lower corners.
    to_cells: DAffine3,
    counts: [usize; 3],
    cell_volume: f64,
    /// What power is multiplied with before it is added to cells: about the inverse of their volume, so that sums in 32 bits
    /// have room in media of any size, and a power of two, so that nothing is rounded.
    power_scale: f64,
    cell_edge: f64,
    /// The ball that the medium fills, in cells, if it does not fill the lattice.
    ball: Option<(DVec3, f64)>,
    /// Lamps whose peaks the cells do not hold.
    lamps: Option<Lamps>,
}

/// Edges that subdivide a cell to find how much of it a ball fills.
const PARTS: usize = 8;

impl LatticeShape {
    /// The lattice of a medium, its longest edge divided into `resolution` cells, the others into cells about as long;
    /// an even number along each, and at least 4. `None` for infinite media.
    pub fn new(bounds: &Bounds, resolution: usize) -> Option<Self> {
        let (filled, center_radius) = match *bounds {
            Bounds::Sphere { center, radius } => {
                let edges = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * (2.0 * radius));
                let corner = center - DVec3::splat(radius);
                (Parallelepiped::new(corner, edges), Some((center, radius)))
            }
            _ => (bounds.parallelepiped()?, None),
        };
        let lengths = filled.edges().map(DVec3::length);
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let counts = lengths.map(|length| {
            let pairs = (0.5 * resolution as f64 * length / longest).round();
            2 * (pairs as usize).max(2)
        });
        let [a, b, c] = std::array::from_fn(|axis| filled.edges()[axis] / counts[axis] as f64);
        let cell = DMat3::from_cols(a, b, c);
        let to_cells = DAffine3::from_mat3_translation(cell, filled.corner()).inverse();
        let ball = center_radius.map(|(center, radius)| {
            (to_cells.transform_point3(center), radius * counts[0] as f64 / lengths[0])
        });
        let cell_volume = cell.determinant().abs();
        let power_scale = (-cell_volume.log2().round()).exp2();
        let cell_edge = longest / resolution as f64;
        Some(Self { to_cells, counts, cell_volume, power_scale, cell_edge, ball, lamps: None })
    }

    /// The same, its cells freed from the peaks of these lamps.
    pub fn with_lamps(mut self, lamps: Option<Lamps>) -> Self {
        self.lamps = lamps;
        self
    }

    /// Lamps by whose weight what the cells hold is multiplied.
    #[inline]
    pub fn lamps(&self) -> Option<&Lamps> {
        self.lamps.as_ref()
    }

    /// The lattice with cells twice as long, half as many.
    pub fn coarser(&self) -> Self {
        Self {
            to_cells: DAffine3::from_scale(DVec3::splat(0.5)) * self.to_cells,
            counts: self.counts.map(|count| count / 2),
            cell_volume: 8.0 * self.cell_volume,
            power_scale: 0.125 * self.power_scale,
            cell_edge: 2.0 * self.cell_edge,
            ball: self.ball.map(|(center, radius)| (0.5 * center, 0.5 * radius)),
            lamps: self.lamps.clone(),
        }
    }

    /// Cells along each axis.
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// Cells in all.
    pub fn cell_count(&self) -> usize {
        self.counts.iter().product()
    }

    /// Volume of a cell \[m^3\].
    pub fn cell_volume(&self) -> f64 {
        self.cell_volume
    }

    /// What power is multiplied with before it is added to cells \[m^-3\].
    pub fn power_scale(&self) -> f64 {
        self.power_scale
    }

    /// Length of a cell's edge along the longest side \[m\].
    pub fn cell_edge(&self) -> f64 {
        self.cell_edge
    }

    /// Whether the medium fills every cell.
    pub fn is_full(&self) -> bool {
        self.ball.is_none()
    }

    /// A point in cells.
    #[inline]
    pub fn point(&self, position: DVec3) -> DVec3 {
        self.to_cells.transform_point3(position)
    }

    /// A displacement in cells.
    #[inline]
    pub fn displacement(&self, displacement: DVec3) -> DVec3 {
        self.to_cells.transform_vector3(displacement)
    }

    /// The share of a cell that the medium fills.
    pub fn filled_share(&self, cell: [usize; 3]) -> f32 {
        let Some((center, radius)) = self.ball else { return 1.0 };
        let corner = DVec3::from_array(cell.map(|c| c as f64));
        let from_middle = corner + DVec3::splat(0.5) - center;
        // Half the diagonal of a cell is sqrt(3) / 2.
        if from_middle.length() < radius - 0.87 {
            return 1.0;
        }
        if from_middle.length() > radius + 0.87 {
            return 0.0;
        }
        let part = |index: usize| (index as f64 + 0.5) / PARTS as f64;
        let parts = (0..PARTS * PARTS * PARTS).filter(|index| {
            let (i, j, k) = (index % PARTS, index / PARTS % PARTS, index / PARTS / PARTS);
            let place = corner + DVec3::new(part(i), part(j), part(k));
            place.distance_squared(center) <= radius * radius
        });
        parts.count() as f32 / (PARTS * PARTS * PARTS) as f32
    }
}
