//! What can be typed after `photonvdb convert`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use photonvdb::medium::vdb::{IndexBox, WriteCompression, WriteOptions};

use crate::cli::args::VolumeArguments;
use crate::cli::file_names::vdb_name;

const EXAMPLES: &str = "\
Examples:
  photonvdb convert smoke.vdb -o density.vdb --grid density
      One grid alone.
  photonvdb convert smoke.vdb -o small.vdb --half --compression zip
      Every grid, as small as it gets.
  photonvdb convert smoke.vdb -o corner.vdb --crop -64,0,-64,-1,127,63
      The voxels from -64 0 -64 to -1 127 63.

Names are those that `photonvdb inspect` shows. Double and integer grids become float, double vectors float vectors;
class, transform, background, inactive values and metadata stay.";

/// `photonvdb convert`
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct ConvertArguments {
    /// OpenVDB file to read
    pub input: PathBuf,

    /// OpenVDB file to write; may be the one that is read
    #[arg(short, long, value_name = "OUT.vdb", value_parser = vdb_name())]
    pub output: PathBuf,

    /// Grid to write, may be given several times [default: every grid that can be converted]
    #[arg(long = "grid", value_name = "NAME")]
    pub grids: Vec<String>,

    /// New name, where one grid is written
    #[arg(long, value_name = "NAME")]
    pub rename: Option<String>,

    /// Round values to 16 bits; grids that were saved so stay so
    #[arg(long)]
    pub half: bool,

    /// How values are packed
    #[arg(long, value_name = "C", value_enum, default_value = "blosc")]
    pub compression: PackingChoice,

    /// Lowest and highest voxel to keep; outside, everything becomes background
    #[arg(long, value_name = "I0,J0,K0,I1,J1,K1", value_parser = parse_index_box, allow_hyphen_values = true)]
    pub crop: Option<IndexBox>,

    /// Reading volumes
    #[command(flatten)]
    pub volume: VolumeArguments,
}

/// How values are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PackingChoice {
    /// Every value as it is
    None,
    /// Without values of inactive voxels, where possible
    Mask,
    /// As mask, packed with zlib: smallest, slow to write
    Zip,
    /// As mask, packed with Blosc: what OpenVDB does by default
    Blosc,
}

impl ConvertArguments {
    /// How grids are to be stored.
    pub fn write_options(&self) -> WriteOptions {
        let compression = match self.compression {
            PackingChoice::None => WriteCompression::None,
            PackingChoice::Mask => WriteCompression::ActiveMask,
            PackingChoice::Zip => WriteCompression::Zip,
            PackingChoice::Blosc => WriteCompression::Blosc,
        };
        WriteOptions { compression, half: self.half }
    }
}

/// Parses `-8,0,0,7,15,15`: the lowest and the highest voxel of a box.
fn parse_index_box(text: &str) -> Result<IndexBox, String> {
    let numbers: Result<Vec<i32>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let corners = numbers.ok().and_then(|numbers| <[i32; 6]>::try_from(numbers).ok());
    let [i0, j0, k0, i1, j1, k1] = corners.ok_or_else(|| {
        format!("`{text}` is not a box; write six whole numbers, its lowest and its highest voxel, like -8,0,0,7,15,15")
    })?;
    if i0 > i1 || j0 > j1 || k0 > k1 {
        return Err(format!("`{text}` holds no voxel: its lowest must not lie above its highest"));
    }
    Ok(IndexBox { min: [i0, j0, k0], max: [i1, j1, k1] })
}
