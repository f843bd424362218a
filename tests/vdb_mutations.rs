//! Damaged files: whatever is done to its bytes, reading a file ends soon, in a grid or in an error, and takes
//! no more memory than the file and the limit account for.
//!
//! `PHOTONVDB_MUTATIONS=50000` makes that many mutations of each file, and a line for each.

#[path = "vdb/support/bytes.rs"]
mod bytes;
#[path = "vdb/support/carry.rs"]
mod carry;

use std::sync::Mutex;
use std::time::{Duration, Instant};

use bytes::committed;
use peak_alloc::PeakAlloc;
use photonvdb::medium::vdb::{Limits, VdbFile, VolumeSource};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;
/// Memory is counted for all threads together: one test at a time.
static ALONE: Mutex<()> = Mutex::new(());

/// Small files, of every codec, precision, type and kind of tile.
const FILES: [&str; 31] = [
    "all_active_leaf",
    "background_nonzero",
    "codec_blosc",
    "codec_zip",
    "codec_zip_blosc_mask",
    "codec_zip_mask",
    "empty_bg",
    "half_grid_blosc",
    "half_grid_inactive",
    "half_grid_mask",
    "half_grid_zip_mask",
    "half_tiles_blosc_mask",
    "half_tiles_zip_mask",
    "inactive_many",
    "inactive_two",
    "instanced_vec3s",
    "nan_inf_neg_half",
    "points",
    "single_voxel_neg",
    "tiles_only_zip",
    "tiles_root_active",
    "tiles_root_inactive",
    "type_bool_zip_mask",
    "type_double_half_zip",
    "type_int32_half",
    "type_int64_blosc",
    "type_mask_blosc_mask",
    "type_vec3d",
    "type_vec3d_half",
    "type_vec3i",
    "type_vec3s_half",
];
/// Larger files, fewer times: several grids, streams, an instance, metadata, transforms, a level set.
const LARGE_FILES: [&str; 11] = [
    "codec_none",
    "density_after_points",
    "huge_coords",
    "instanced",
    "levelset_mask",
    "metadata_rich",
    "stream_no_offsets",
    "stream_others",
    "stream_reals",
    "type_int64",
    "xf_rotated",
];
/// What the largest of these files needs, rounded up.
const LIMITS: Limits = Limits { max_bytes: 1 << 20 };
/// Memory that may be taken for a byte of the file and the limit: the grid, and its sampling structure.
const MAX_MEMORY_RATIO: f64 = 8.0;
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

/// Reads all there is, and checks how long that takes and how much memory. Says how many grids could be read, and
/// how much memory it took for a byte of file and limit.
fn read_all(bytes: &[u8], what: impl std::fmt::Display) -> (usize, f64) {
    let memory_before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let start = Instant::now();
    let read_count = carry::carry(bytes, &LIMITS);
    assert!(start.elapsed() < PATIENCE, "{what}: {:?}", start.elapsed());
    let peak = MEMORY.peak_usage().saturating_sub(memory_before);
    let ratio = peak as f64 / (bytes.len() as f64 + LIMITS.max_bytes as f64);
    assert!(ratio <= MAX_MEMORY_RATIO, "{what}: {peak} bytes for a file of {}", bytes.len());
    (read_count, ratio)
}

fn damage(name: &str, count: u64) {
    let campaign = std::env::var("PHOTONVDB_MUTATIONS").ok();
    let count = campaign.and_then(|count| count.parse().ok()).unwrap_or(count);
    let sound = committed(name);
    let start = Instant::now();
    let (mut unread_count, mut grid_count, mut max_ratio) = (0, 0, 0.0_f64);
    for seed in 0..count {
        let mut random = Stream(seed << 20 | name.len() as u64);
        let bytes = mutate(&sound, &mut random);
        let (grids, ratio) = read_all(&bytes, format_args!("{name}, seed {seed}"));
        unread_count += u64::from(grids == 0);
        grid_count += grids;
        max_ratio = max_ratio.max(ratio);
    }
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{name}: {count} damaged files, {unread_count} without a grid, {grid_count} grids read; \
        memory ratio {max_ratio:.2}, {seconds:.1} s"
    );
}

fn alone() -> impl Drop {
    // A test that failed has nothing to say about the next.
    ALONE.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

#[test]
fn damaged_small_files_end_in_a_grid_or_an_error() {
    let _alone = alone();
    FILES.iter().for_each(|name| damage(name, 2000));
}

#[test]
fn damaged_large_files_end_in_a_grid_or_an_error() {
    let _alone = alone();
    LARGE_FILES.iter().for_each(|name| damage(name, 300));
}

#[test]
fn every_truncation_of_a_small_file_ends() {
    let _alone = alone();
    let sound = committed("nan_inf_neg_half");
    for len in 0..sound.len() {
        assert_eq!(read_all(&sound[..len], len).0, 0, "of {len} bytes");
    }
}

#[test]
fn a_tiny_file_cannot_claim_much_memory() {
    let _alone = alone();
    // Four billion tiles or nodes at the root, of which none follows.
    let sound = committed("empty_bg");
    let background = 2.5f32.to_le_bytes();
    let at = sound.windows(4).rposition(|window| window == background).unwrap();
    for offset in [4, 8] {
        let mut bytes = sound.clone();
        bytes[at + offset..at + offset + 4].fill(0xff);
        assert_eq!(read_all(&bytes, offset).0, 0);
    }
}

/// Entries without a grid cost 36 bytes each: listing them must stay in proportion.
#[test]
fn a_file_of_empty_entries_is_listed_in_part() {
    const COUNT: u32 = 70_000;
    let _alone = alone();
    // Up to the number of grids, which is followed by their entries.
    let mut bytes = committed("no_grids");
    bytes.truncate(bytes.len() - 4);
    bytes[20] = 1;
    bytes.extend(COUNT.to_le_bytes());
    for _ in 0..COUNT {
        let end = bytes.len() as u64 + 36;
        bytes.extend([0; 12]);
        (0..3).for_each(|_| bytes.extend(end.to_le_bytes()));
    }
    let file = VdbFile::from_bytes(bytes.clone()).unwrap();
    assert_eq!(file.grids().len(), 1 << 13);
    assert!(file.damage().unwrap().contains("it claims to hold 70000 grids"));
    drop(file);
    assert_eq!(read_all(&bytes, "empty entries").0, 0);
}

/// Files that once broke a reader, and damaged ones of the larger corpus.
#[test]
fn known_damage_ends_in_an_error() {
    let _alone = alone();
    for directory in bytes::larger_corpora() {
        let damaged = |path: &&std::path::PathBuf| path.to_string_lossy().contains("poc_");
        for path in bytes::files(&directory).iter().filter(damaged) {
            let name = path.display();
            assert_eq!(read_all(&std::fs::read(path).unwrap(), &name).0, 0, "{name}");
        }
    }
}
