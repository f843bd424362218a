//! Damaged files: whatever is done to its bytes, reading a file ends soon, in a grid or in an
//! error.

#[path = "vdb/support/bytes.rs"]
mod bytes;

use std::time::{Duration, Instant};

use bytes::committed;
use photonvdb::medium::vdb::{GridSummary, Limits, VdbFile, VolumeSource, sanitize_density};

/// Small files, of every codec, precision and kind of tile.
const FILES: [&str; 10] = [
    "inactive_many",
    "inactive_two",
    "nan_inf_neg_half",
    "tiles_only_zip",
    "tiles_root_active",
    "tiles_root_inactive",
    "background_nonzero",
    "all_active_leaf",
    "empty_bg",
    "points",
];
/// Larger files, fewer times: several grids, a stream, an instance, metadata, vectors, blosc
/// streams.
const LARGE_FILES: [&str; 6] = [
    "density_after_points",
    "stream_no_offsets",
    "instanced",
    "metadata_rich",
    "type_int64",
    "xf_rotated",
];
const LIMITS: Limits = Limits { max_bytes: 16 << 20 };
/// Far more than any takes, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(10);

/// splitmix64, so that every mutation can be made again.
struct Stream(u64);

impl Stream {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) % bound as u64) as usize
    }
}

/// Integers that overflow, look negative, or claim too much.
const EXTREMES: [i64; 10] = [
    0,
    1,
    -1,
    i64::MIN,
    i64::MAX,
    i32::MIN as i64,
    i32::MAX as i64,
    u32::MAX as i64,
    1 << 20,
    0x7fff_ffff_0000_0000,
];

fn mutate(file: &[u8], random: &mut Stream) -> Vec<u8> {
    let mut bytes = file.to_vec();
    // Half of the places are among the first bytes: headers, entries, metadata, transforms.
    let head = bytes.len().min(900);
    let place = |random: &mut Stream, len: usize| {
        let range = if random.below(2) == 0 { head.min(len) } else { len };
        random.below(range)
    };
    match random.below(6) {
        0 => bytes.truncate(random.below(bytes.len())),
        1 => {
            for _ in 0..=random.below(4) {
                let at = place(random, bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
        }
        2 => {
            let at = place(random, bytes.len());
            bytes[at] = random.below(256) as u8;
        }
        3 | 4 => {
            let extreme = EXTREMES[random.below(EXTREMES.len())].to_le_bytes();
            let width = [4, 8][random.below(2)];
            let at = place(random, bytes.len() - width);
            bytes[at..at + width].copy_from_slice(&extreme[..width]);
        }
        _ => {
            let at = place(random, bytes.len());
            let len = (1 + random.below(64)).min(bytes.len() - at);
            let fill = [0, 0xff][random.below(2)];
            bytes[at..at + len].fill(fill);
        }
    }
    bytes
}

/// Reads all there is. Says how many grids could be read.
fn read_all(bytes: Vec<u8>) -> usize {
    let Ok(file) = VdbFile::from_bytes(bytes) else {
        return 0;
    };
    let read = |index: usize, _: &GridSummary| {
        let scalar = file.load_scalar(index, &LIMITS);
        let vector = file.load_vector(index, &LIMITS);
        if let Ok(mut grid) = scalar {
            assert_eq!(grid.values.len(), 512 * grid.leaves.len());
            assert_eq!(grid.masks.len(), grid.leaves.len());
            assert!(grid.values.len() * 4 + grid.tiles.len() * 24 <= LIMITS.max_bytes as usize);
            assert!(grid.leaves.iter().flatten().all(|along| along % 8 == 0));
            sanitize_density(&mut grid);
            return true;
        }
        vector.is_ok()
    };
    file.grids().iter().enumerate().filter(|(index, grid)| read(*index, grid)).count()
}

fn damage(name: &str, count: u64) {
    let sound = committed(name);
    let mut read_count = 0;
    for seed in 0..count {
        let mut random = Stream(seed << 20 | name.len() as u64);
        let bytes = mutate(&sound, &mut random);
        let start = Instant::now();
        read_count += read_all(bytes);
        assert!(start.elapsed() < PATIENCE, "{name}, seed {seed}");
    }
    println!("{name}: {read_count} grids read of {count} damaged files");
}

#[test]
fn damaged_small_files_end_in_a_grid_or_an_error() {
    FILES.iter().for_each(|name| damage(name, 4000));
}

#[test]
fn damaged_large_files_end_in_a_grid_or_an_error() {
    LARGE_FILES.iter().for_each(|name| damage(name, 600));
}

#[test]
fn every_truncation_of_a_small_file_ends() {
    let sound = committed("nan_inf_neg_half");
    for len in 0..sound.len() {
        assert_eq!(read_all(sound[..len].to_vec()), 0, "of {len} bytes");
    }
}

#[test]
fn a_tiny_file_cannot_claim_much_memory() {
    // Four billion tiles or nodes at the root, of which none follows.
    let sound = committed("empty_bg");
    let background = 2.5f32.to_le_bytes();
    let at = sound.windows(4).rposition(|window| window == background).unwrap();
    for offset in [4, 8] {
        let mut bytes = sound.clone();
        bytes[at + offset..at + offset + 4].fill(0xff);
        assert_eq!(read_all(bytes), 0);
    }
}
