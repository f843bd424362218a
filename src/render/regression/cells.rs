//! An image in cells of pixels, and the fits of windows of 5 x 5 of them.

use std::ops::Range;

use rayon::prelude::*;

use super::fit::{FeaturePixel, LIGHTS, LightFit, Moments, PixelLight};

/// Edge of the cells that larger ones are made of \[pixels\].
const FINE: usize = 4;

/// Edge of the cells of a window \[pixels\], and cells from its middle to its edge: 3 x 3 pixels for radius 1, else 5 x 5 cells.
pub fn cells(radius: usize) -> (usize, usize) {
    if radius == 1 { (1, 1) } else { ((2 * radius).div_ceil(5), 2) }
}

/// A half's image in cells of pixels, of which the last may be cut short.
pub struct CellImage<'a> {
    /// Row by row.
    pub pixels: &'a [FeaturePixel],
    /// Sums of finer cells, if cells are to be made of them.
    pub fine: Option<&'a FineCells>,
    /// \[pixels\]
    pub width: usize,
    /// \[pixels\]
    pub height: usize,
    /// Edge of the cells \[pixels\].
    pub cell: usize,
    /// Cells from the middle of a window to its edge.
    pub reach: usize,
}

impl CellImage<'_> {
    /// Light of the pixels of every `step`th of some rows, from the fits of the cells around.
    pub fn filter_rows(&self, rows: Range<usize>, step: usize) -> Vec<PixelLight> {
        let Self { width, height, cell, .. } = *self;
        let columns = width.div_ceil(cell);
        let cell_rows = height.div_ceil(cell);
        let first_row = (rows.start / cell).saturating_sub(1);
        let fits = self.fits(first_row..(rows.end.div_ceil(cell) + 1).min(cell_rows));
        let mut filtered = Vec::with_capacity(rows.len().div_ceil(step) * width);
        for y in rows.step_by(step) {
            let [above, below] = self.nearest(y, cell_rows);
            let t = self.blend(y, above, below);
            let heights = [above, below].map(|row| y as f64 - self.middle(row));
            let [above, below] = [above, below].map(|row| (row - first_row) * columns);
            let blended: Vec<LightFit> = (0..columns)
                .map(|x| LightFit::blended(&fits[above + x], &fits[below + x], t, heights))
                .collect();
            for (x, pixel) in self.pixels[y * width..(y + 1) * width].iter().enumerate() {
                let nearest = self.nearest(x, columns);
                let t = self.blend(x, nearest[0], nearest[1]);
                let mut light = [0.0; LIGHTS];
                for (column, share) in nearest.into_iter().zip([1.0 - t, t]) {
                    let from_middle = x as f64 - self.middle(column);
                    blended[column].add_light(&mut light, share, from_middle, pixel);
                }
                filtered.push(light);
            }
        }
        filtered
    }

    /// The middle of a row or column of cells \[pixels\].
    fn middle(&self, cell: usize) -> f64 {
        (cell as f64 + 0.5) * self.cell as f64 - 0.5
    }

    /// The cells whose middles lie on either side of a pixel, along one axis; one twice at the ends and where it is the pixel itself.
    fn nearest(&self, pixel: usize, count: usize) -> [usize; 2] {
        let own = pixel / self.cell;
        match (pixel as f64).total_cmp(&self.middle(own)) {
            std::cmp::Ordering::Less => [own.saturating_sub(1), own],
            std::cmp::Ordering::Equal => [own; 2],
            std::cmp::Ordering::Greater => [own, (own + 1).min(count - 1)],
        }
    }

    /// How far a pixel lies from the middle of one of its nearest cells towards that of the other, as a share.
    fn blend(&self, pixel: usize, one: usize, other: usize) -> f64 {
        match one == other {
            true => 0.0,
            false => (pixel as f64 - self.middle(one)) / self.cell as f64,
        }
    }

    /// The fits of some rows of cells.
    fn fits(&self, rows: Range<usize>) -> Vec<LightFit> {
        let columns = self.width.div_ceil(self.cell);
        let cell_rows = self.height.div_ceil(self.cell);
        let edge = self.cell as f64;
        let near = |middle: usize, count: usize| {
            middle.saturating_sub(self.reach)..(middle + self.reach + 1).min(count)
        };
        let first = rows.start.saturating_sub(self.reach);
        let last = (rows.end + self.reach).min(cell_rows);
        // Sums over the cells of a window's row, from the cell in the middle of it.
        let along: Vec<Moments> = (first..last)
            .flat_map(|row| {
                let own = self.moments(row);
                (0..columns).map(move |middle| {
                    let mut sum = Moments::default();
                    for column in near(middle, columns) {
                        sum.add_moved(&own[column], 0, (column as f64 - middle as f64) * edge);
                    }
                    sum
                })
            })
            .collect();
        let fit = |row: usize, column: usize| {
            let mut sum = Moments::default();
            for other in near(row, cell_rows) {
                let moments = &along[(other - first) * columns + column];
                sum.add_moved(moments, 1, (other as f64 - row as f64) * edge);
            }
            sum.fit()
        };
        rows.flat_map(|row| (0..columns).map(move |column| (row, column)))
            .map(|(row, column)| fit(row, column))
            .collect()
    }

    /// The sums of the cells of a row, each from its middle.
    fn moments(&self, row: usize) -> Vec<Moments> {
        match self.fine.filter(|_| self.cell.is_multiple_of(FINE)) {
            Some(fine) => self.moments_of_finer(fine, row),
            None => self.moments_of_pixels(row),
        }
    }

    fn moments_of_finer(&self, fine: &FineCells, row: usize) -> Vec<Moments> {
        let times = self.cell / FINE;
        // From the middle of a cell to that of its part.
        let offset =
            |part: usize| ((part % times) as f64 + 0.5) * FINE as f64 - 0.5 * self.cell as f64;
        let mut row_moments = vec![Moments::default(); self.width.div_ceil(self.cell)];
        for fine_row in row * times..((row + 1) * times).min(fine.moments.len() / fine.columns) {
            let parts = &fine.moments[fine_row * fine.columns..(fine_row + 1) * fine.columns];
            for (parts, moments) in parts.chunks(times).zip(&mut row_moments) {
                let mut sum = Moments::default();
                for (column, part) in parts.iter().enumerate() {
                    sum.add_moved(part, 0, offset(column));
                }
                moments.add_moved(&sum, 1, offset(fine_row));
            }
        }
        row_moments
    }

    fn moments_of_pixels(&self, row: usize) -> Vec<Moments> {
        let Self { pixels, width, height, cell, .. } = *self;
        let mut row_moments = vec![Moments::default(); width.div_ceil(cell)];
        for y in row * cell..((row + 1) * cell).min(height) {
            let dy = y as f64 - self.middle(row);
            let cells = pixels[y * width..(y + 1) * width].chunks(cell);
            for ((column, cell), moments) in cells.enumerate().zip(&mut row_moments) {
                for (x, pixel) in cell.iter().enumerate() {
                    let dx = (column * self.cell + x) as f64 - self.middle(column);
                    moments.add_pixel(dx, dy, pixel);
                }
            }
        }
        row_moments
    }
}

/// Sums of pixels in cells, each from its middle, of which those of larger cells are made.
pub struct FineCells {
    columns: usize,
    moments: Vec<Moments>,
}

impl FineCells {
    /// Those of an image.
    pub fn of(image: CellImage) -> Self {
        let image = CellImage { cell: FINE, fine: None, ..image };
        let rows = (0..image.height.div_ceil(FINE)).into_par_iter();
        let moments = rows.flat_map_iter(|row| image.moments_of_pixels(row)).collect();
        Self { columns: image.width.div_ceil(FINE), moments }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Stream, uniform};

    /// Cells made of finer ones give the light of those made of pixels, up to the edges of an image that they do not divide; and some rows that of all.
    #[test]
    fn finer_cells_and_fewer_rows_give_the_same() {
        let (width, height) = (71, 59);
        let mut random = Stream::Experiment.random(23, 0);
        let pixels: Vec<FeaturePixel> = (0..width * height)
            .map(|_| {
                let [single, opacity, red, green, blue] =
                    std::array::from_fn(|_| uniform(&mut random));
                FeaturePixel { single, opacity, light: [red, green, blue] }
            })
            .collect();
        for radius in [10, 20, 30] {
            let (cell, reach) = cells(radius);
            let image = || CellImage { pixels: &pixels, fine: None, width, height, cell, reach };
            let fine = FineCells::of(image());
            let of_fine = CellImage { fine: Some(&fine), ..image() };
            let all = image().filter_rows(16..height, 1);
            let some = of_fine.filter_rows(16..height, 5);
            assert_eq!(some.len(), 9 * width);
            for (row, found) in some.chunks(width).enumerate() {
                let exact = &all[5 * row * width..][..width];
                for (a, b) in found.as_flattened().iter().zip(exact.as_flattened()) {
                    assert!((a - b).abs() < 1e-10, "{radius}, {row}: {a} {b}");
                }
            }
        }
    }
}
