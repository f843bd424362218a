//! Any bytes as an OpenVDB file: lists its grids, reads all of them under a small limit, and carries densities to
//! their sampling structure and a ray through it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use photonvdb::medium::vdb::Limits;
use rayon::ThreadPoolBuilder;

#[path = "../../tests/vdb/support/carry.rs"]
mod carry;

const LIMITS: Limits = Limits { max_bytes: 1 << 18 };

fuzz_target!(
    init: {
        // On the fuzzer's own thread: handing small files to another takes longer than reading them.
        ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().unwrap();
    },
    |bytes: &[u8]| {
        carry::carry(bytes, &LIMITS);
    }
);
