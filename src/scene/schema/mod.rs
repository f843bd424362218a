//! What a scene file may say, for programs and people: one table of keys, as JSON Schema and as a page.
//!
//! The reader (`scene/file/`) checks each value where it uses it, with a sentence of its own, and keeps no table that could
//! be printed. So the table here is a second statement of the same format, and a test reads every key, word, default and
//! limit of it with the reader.

mod json;
mod key;
mod tables;
mod words;

pub use json::json_schema;
pub use words::scene_reference;
