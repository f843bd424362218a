//! Files as written to a stream, without offsets: made of the grids of files that have them.

/// Mark, versions, flag and UUID; then come metadata, of which the files used here have none.
const HEADER_LEN: usize = 57;
const OFFSETS_FLAG: usize = 20;

/// The first grid of each file, one after the other, in a file without offsets.
pub fn stream_of(files: &[Vec<u8>]) -> Vec<u8> {
    let mut stream = files[0][..HEADER_LEN].to_vec();
    stream[OFFSETS_FLAG] = 0;
    stream.extend(0u32.to_le_bytes());
    stream.extend((files.len() as u32).to_le_bytes());
    for file in files {
        append_grid(&mut stream, file);
    }
    stream
}

fn append_grid(stream: &mut Vec<u8>, file: &[u8]) {
    assert_eq!(number(file, HEADER_LEN, 4), 0, "the file has metadata");
    let start = HEADER_LEN + 8;
    // Unique name, type, name of the parent.
    let strings_end = (0..3).fold(start, |at, _| at + 4 + number(file, at, 4));
    let grid_start = number(file, strings_end, 8);
    let grid_end = number(file, strings_end + 16, 8);
    stream.extend(&file[start..strings_end]);
    stream.extend([0; 24]);
    stream.extend(&file[grid_start..grid_end]);
}

fn number(file: &[u8], at: usize, len: usize) -> usize {
    file[at..at + len].iter().rev().fold(0, |number, &byte| number << 8 | usize::from(byte))
}
