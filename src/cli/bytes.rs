//! Amounts of memory as people write them: `512MiB`, `8 GB` or `8589934592`.

use bytesize::ByteSize;

/// Parses an amount of memory of at least one byte.
pub fn parse_bytes(text: &str) -> Result<u64, String> {
    match text.parse::<ByteSize>() {
        Ok(ByteSize(bytes)) if bytes > 0 => Ok(bytes),
        _ => Err(format!("`{text}` is not an amount of memory; write it like 512MiB, 8GiB or 2GB")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_in_every_spelling() {
        for (text, bytes) in [
            ("1", 1),
            ("2GB", 2_000_000_000),
            ("512MiB", 512 << 20),
            ("1.5 GiB", 3 << 29),
            ("8gib", 8 << 30),
        ] {
            assert_eq!(parse_bytes(text), Ok(bytes), "{text}");
        }
        for text in ["", "0", "-1", "8 cows", "GiB", "nan", "0.2"] {
            assert!(parse_bytes(text).is_err(), "{text}");
        }
    }
}
