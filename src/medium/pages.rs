//! Large blocks of memory straight from the operating system, in large pages where it has them.
//!
//! The memory comes zeroed when it is first touched, by whichever thread does so; where there is none it is an
//! error. With pages of 2 MiB instead of 4 KiB a file and its bricks are read several times faster (there are 512
//! times fewer pages to hand out), and looking densities up misses the processor's table of pages less often.

use std::io;
use std::ops::{Deref, DerefMut};

use memmap2::MmapMut;

/// Bytes, all 0 at first.
#[derive(Debug)]
pub(in crate::medium) struct Pages(MmapMut);

impl Pages {
    /// `len` bytes, or one instead of none.
    pub(in crate::medium) fn zeroed(len: usize) -> io::Result<Self> {
        let map = MmapMut::map_anon(len.max(1))?;
        #[cfg(target_os = "linux")]
        {
            /// Below this, rounding up to large pages would waste more than it gains.
            const LARGE_BYTES: usize = 16 << 20;
            if len >= LARGE_BYTES {
                // Refused where the system has no large pages: small ones serve, too.
                let _ = map.advise(memmap2::Advice::HugePage);
            }
        }
        Ok(Self(map))
    }
}

impl Deref for Pages {
    type Target = [u8];

    #[inline(always)]
    fn deref(&self) -> &[u8] {
        &self.0
    }
}

impl DerefMut for Pages {
    fn deref_mut(&mut self) -> &mut [u8] {
        &mut self.0
    }
}
