//! A scene file as a tree of plain values: what TOML and JSON have in common, before any key has a meaning.
//!
//! Every value remembers where it was written, so that an error found much later still names the line.

mod json;
mod toml;

use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::error::SceneError;

/// A scene file holds a few hundred bytes; what is larger is another kind of file.
const MAX_FILE_BYTES: u64 = 16 << 20;

/// A value and where it was written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    pub origin: Origin,
    pub value: Value,
}

/// Where a value was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// In the scene file, line unknown (JSON).
    File,
    /// In the scene file, at this line, from 1.
    Line(usize),
    /// Outside the file: [`Overrides`](super::Overrides), usually the command line.
    Override,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Boolean(bool),
    Integer(i128),
    Float(f64),
    Text(String),
    List(Vec<Node>),
    /// In the order of the file or of the alphabet; keys are distinct.
    Table(Vec<(String, Node)>),
    /// A kind no key of a scene takes, by name.
    Foreign(&'static str),
}

/// Reads a scene file, TOML or JSON by its extension.
pub(super) fn read(path: &Path) -> Result<Node, SceneError> {
    let parse = parser_of(path)?;
    parse_as(parse, &read_text(path)?, path)
}

/// Reads text as though it were the scene file at `path`.
pub(super) fn parse(text: &str, path: &Path) -> Result<Node, SceneError> {
    parse_as(parser_of(path)?, text, path)
}

/// Reads a scene from JSON in memory, which messages call `name`.
pub(super) fn read_json(text: &str, name: &Path) -> Result<Node, SceneError> {
    parse_as(json::parse, text, name)
}

fn parse_as(parse: Parser, text: &str, file: &Path) -> Result<Node, SceneError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    parse(text).map_err(|SyntaxError { line, problem }| SceneError::Syntax {
        file: file.into(),
        line,
        problem,
    })
}

/// Text → values with their lines.
type Parser = fn(&str) -> Result<Node, SyntaxError>;

/// What reads a file of that name.
fn parser_of(path: &Path) -> Result<Parser, SceneError> {
    let parse: Parser = match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase)
    {
        Some(extension) if extension == "toml" => toml::parse,
        Some(extension) if extension == "json" => json::parse,
        _ => return Err(SceneError::Extension { file: path.into() }),
    };
    Ok(parse)
}

/// TOML that is part of the program; `None` if it cannot be read.
pub(super) fn parse_toml(text: &str) -> Option<Node> {
    toml::parse(text).ok()
}

/// What a parser could not read.
struct SyntaxError {
    line: usize,
    problem: String,
}

fn read_text(path: &Path) -> Result<String, SceneError> {
    let unreadable = |source| SceneError::Read { file: path.into(), source };
    let mut text = String::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(MAX_FILE_BYTES + 1).read_to_string(&mut text).map_err(unreadable)?;
    if text.len() as u64 > MAX_FILE_BYTES {
        return Err(SceneError::TooLarge { file: path.into(), limit_mib: MAX_FILE_BYTES >> 20 });
    }
    Ok(text)
}

impl Node {
    /// Says of the value and all it holds that it was written there.
    pub fn place(&mut self, origin: Origin) {
        self.origin = origin;
        match &mut self.value {
            Value::List(items) => items.iter_mut().for_each(|item| item.place(origin)),
            Value::Table(entries) => entries.iter_mut().for_each(|(_, node)| node.place(origin)),
            _ => {}
        }
    }

    /// Where the value at a key path such as `light[2].intensity` was written, or the deepest table around it.
    pub fn origin_of(&self, path: &str) -> Origin {
        let mut node = self;
        for step in path.replace('[', ".[").split('.') {
            let child = match &node.value {
                Value::Table(entries) => entries.iter().find(|(key, _)| key == step),
                Value::List(items) => {
                    let index = step.trim_matches(['[', ']']).parse::<usize>().ok();
                    match index.and_then(|index| items.get(index)) {
                        Some(item) => {
                            node = item;
                            continue;
                        }
                        None => None,
                    }
                }
                _ => None,
            };
            match child {
                Some((_, child)) => node = child,
                None => break,
            }
        }
        node.origin
    }

    /// Puts `value` at `section.key`, in place of what the file says. Leaves a file alone that has something
    /// else than a table there: reading it will say so.
    pub fn set(&mut self, section: &str, key: &str, value: Value) {
        let table = self.entry(section, || Value::Table(Vec::new()));
        if let Some(node) = table.and_then(|table| table.entry(key, || value.clone())) {
            *node = Node { origin: Origin::Override, value };
        }
    }

    /// Puts `value` at `key` of each table in the list at `section` that `applies`; elsewhere as [`Self::set`].
    pub fn set_in_each(
        &mut self,
        section: &str,
        key: &str,
        value: Value,
        applies: impl Fn(&Node) -> bool,
    ) {
        let Some(Node { value: Value::List(items), .. }) =
            self.entry(section, || Value::Table(Vec::new()))
        else {
            return self.set(section, key, value);
        };
        for item in items.iter_mut().filter(|item| applies(item)) {
            if let Some(node) = item.entry(key, || value.clone()) {
                *node = Node { origin: Origin::Override, value: value.clone() };
            }
        }
    }

    /// The text at `key` of a table.
    pub fn text(&self, key: &str) -> Option<&str> {
        let Value::Table(entries) = &self.value else { return None };
        match &entries.iter().find(|(name, _)| name == key)?.1.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    fn entry(&mut self, key: &str, default: impl FnOnce() -> Value) -> Option<&mut Node> {
        let origin = self.origin;
        let Value::Table(entries) = &mut self.value else { return None };
        let index = entries.iter().position(|(name, _)| name == key).unwrap_or_else(|| {
            entries.push((key.into(), Node { origin, value: default() }));
            entries.len() - 1
        });
        entries.get_mut(index).map(|(_, node)| node)
    }
}

/// The value as an error message shows it.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Boolean(value) => write!(f, "{value}"),
            Value::Integer(value) => write!(f, "{value}"),
            Value::Float(value) => write!(f, "{value}"),
            Value::Text(value) => write!(f, "{value:?}"),
            Value::List(items) if items.len() <= 4 => {
                f.write_str("[")?;
                for (index, item) in items.iter().enumerate() {
                    write!(f, "{}{}", if index > 0 { ", " } else { "" }, item.value)?;
                }
                f.write_str("]")
            }
            Value::List(items) => write!(f, "a list of {}", items.len()),
            Value::Table(_) => f.write_str("a table"),
            Value::Foreign(kind) => f.write_str(kind),
        }
    }
}
