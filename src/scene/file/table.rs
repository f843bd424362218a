//! A table of the scene file under its key path, and the typed values read from it.

use crate::math::{DVec3, Rgb};
use crate::scene::error::Problem;
use crate::scene::tree::{Node, Value};

/// Larger magnitudes overflow once squared and summed in single precision; no scene needs them.
const MAX_MAGNITUDE: f64 = 1e30;

/// A table of the scene file.
pub(in crate::scene) struct Table<'a> {
    path: String,
    entries: &'a [(String, Node)],
}

/// What can be read from a single value.
pub(super) trait FromNode: Sized {
    /// Named in errors.
    const EXPECTED: &'static str;
    fn from_node(node: &Node) -> Option<Self>;
}

impl<'a> Table<'a> {
    /// The outermost table.
    pub fn root(node: &'a Node) -> Result<Self, Problem> {
        Self::of(String::new(), node)
    }

    fn of(path: String, node: &'a Node) -> Result<Self, Problem> {
        match &node.value {
            Value::Table(entries) => Ok(Self { path, entries }),
            other if path.is_empty() => {
                Err(Problem::new("scene", format!("expected a table of sections, found {other}")))
            }
            other => Err(Problem::new(path, format!("expected a table, found {other}"))),
        }
    }

    /// The full path of a key of this table.
    pub fn key_path(&self, key: &str) -> String {
        if self.path.is_empty() { key.into() } else { format!("{}.{key}", self.path) }
    }

    /// Something wrong with the value of `key`.
    pub fn problem(&self, key: &str, text: impl Into<String>) -> Problem {
        Problem::new(self.key_path(key), text)
    }

    fn find(&self, key: &str) -> Option<&'a Node> {
        self.entries.iter().find(|(name, _)| name == key).map(|(_, node)| node)
    }

    /// Whether the file gives `key`.
    pub fn has(&self, key: &str) -> bool {
        self.find(key).is_some()
    }

    /// Whether the value of `key` is text.
    pub fn is_text(&self, key: &str) -> bool {
        matches!(self.find(key), Some(Node { value: Value::Text(_), .. }))
    }

    /// The table at `key`; an empty one if the file does not give it.
    pub fn section(&self, key: &str) -> Result<Table<'a>, Problem> {
        let path = self.key_path(key);
        match self.find(key) {
            Some(node) => Table::of(path, node),
            None => Ok(Table { path, entries: &[] }),
        }
    }

    /// The tables of the list at `key`; none if the file does not give it.
    pub fn sections(&self, key: &str) -> Result<Vec<Table<'a>>, Problem> {
        let path = self.key_path(key);
        match self.find(key).map(|node| &node.value) {
            None => Ok(Vec::new()),
            Some(Value::List(items)) => items
                .iter()
                .enumerate()
                .map(|(index, item)| Table::of(format!("{path}[{index}]"), item))
                .collect(),
            Some(other) => Err(self.problem(
                key,
                format!("expected a list of tables, as [[{key}]] writes it, found {other}"),
            )),
        }
    }

    /// The table at `key`, or those of the list there; an empty one if the file does not give it.
    pub fn section_or_sections(&self, key: &str) -> Result<Vec<Table<'a>>, Problem> {
        match self.find(key).map(|node| &node.value) {
            Some(Value::List(_)) => self.sections(key),
            _ => self.section(key).map(|table| vec![table]),
        }
    }

    /// The value of `key`, if the file gives it.
    pub fn get<T: FromNode>(&self, key: &str) -> Result<Option<T>, Problem> {
        let Some(node) = self.find(key) else { return Ok(None) };
        T::from_node(node).map(Some).ok_or_else(|| {
            let value = &node.value;
            let text = if is_extreme(value) {
                format!(
                    "numbers must be finite and of magnitude up to {MAX_MAGNITUDE:e}, found {value}"
                )
            } else {
                format!("expected {}, found {value}", T::EXPECTED)
            };
            self.problem(key, text)
        })
    }

    /// The value of `key`, or the default.
    pub fn get_or<T: FromNode>(&self, key: &str, default: T) -> Result<T, Problem> {
        Ok(self.get(key)?.unwrap_or(default))
    }

    /// The value of `key`, which the file must give.
    pub fn require<T: FromNode>(&self, key: &str) -> Result<T, Problem> {
        let missing = || self.problem(key, format!("missing key; expected {}", T::EXPECTED));
        self.get(key)?.ok_or_else(missing)
    }

    /// The meaning of the word at `key`, if the file gives it.
    pub fn choose<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Result<Option<T>, Problem> {
        let Some(word) = self.get::<String>(key)? else { return Ok(None) };
        let found = words.iter().find(|(name, _)| *name == word).map(|(_, meaning)| *meaning);
        let unknown = || format!("unknown value {word:?}; accepted: {}", quoted(words));
        found.map(Some).ok_or_else(|| self.problem(key, unknown()))
    }

    /// The meaning of the word at `key`, which the file must give.
    pub fn require_choice<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Result<T, Problem> {
        let missing = || self.problem(key, format!("missing key; accepted: {}", quoted(words)));
        self.choose(key, words)?.ok_or_else(missing)
    }

    /// A problem unless `holds`; `rule` continues the sentence that names the key.
    pub fn ensure(&self, key: &str, holds: bool, rule: &str) -> Result<(), Problem> {
        match self.find(key) {
            _ if holds => Ok(()),
            Some(node) => Err(self.problem(key, format!("{rule}, found {}", node.value))),
            None => Err(self.problem(key, rule)),
        }
    }

    /// A problem if the table has a key that is not in `known`.
    pub fn allow(&self, known: &[&str]) -> Result<(), Problem> {
        match self.entries.iter().find(|(key, _)| !known.contains(&key.as_str())) {
            Some((key, _)) => Err(self.problem(key, unknown_key(key, known))),
            None => Ok(()),
        }
    }

    /// A problem if the table has a key that its kind does not take; `kinds` lists each kind with its keys.
    pub fn allow_for(&self, kind: &str, kinds: &[(&str, &[&str])]) -> Result<(), Problem> {
        let known = kinds.iter().find(|(name, _)| *name == kind).map_or(&[][..], |(_, keys)| keys);
        for (key, _) in self.entries.iter().filter(|(key, _)| !known.contains(&key.as_str())) {
            if let Some((owner, _)) = kinds.iter().find(|(_, keys)| keys.contains(&key.as_str())) {
                let text = format!("belongs to kind {owner:?}, but this kind is {kind:?}");
                return Err(self.problem(key, text));
            }
        }
        self.allow(known)
    }
}

/// Whether a number of the value is NaN, infinite or too large.
fn is_extreme(value: &Value) -> bool {
    match value {
        Value::Float(number) => number.is_nan() || number.abs() > MAX_MAGNITUDE,
        Value::Integer(number) => number.unsigned_abs() as f64 > MAX_MAGNITUDE,
        Value::List(items) => items.iter().any(|item| is_extreme(&item.value)),
        _ => false,
    }
}

fn quoted<T>(words: &[(&str, T)]) -> String {
    words.iter().map(|(word, _)| format!("{word:?}")).collect::<Vec<_>>().join(", ")
}

fn unknown_key(key: &str, known: &[&str]) -> String {
    let distance = |word: &str| strsim::damerau_levenshtein(&key.to_lowercase(), word);
    let nearest = known.iter().map(|word| (distance(word), *word)).min();
    match nearest {
        Some((distance, word)) if distance <= 1 + word.len() / 3 => {
            format!("unknown key; did you mean {word:?}?")
        }
        _ => format!("unknown key; known here: {}", known.join(", ")),
    }
}

impl FromNode for f64 {
    const EXPECTED: &'static str = "a number";
    fn from_node(node: &Node) -> Option<Self> {
        let number = match node.value {
            Value::Integer(value) => value as f64,
            Value::Float(value) => value,
            _ => return None,
        };
        (!is_extreme(&node.value)).then_some(number)
    }
}

impl FromNode for u64 {
    const EXPECTED: &'static str = "an integer from 0 to 2^64 - 1";
    fn from_node(node: &Node) -> Option<Self> {
        match node.value {
            Value::Integer(value) => value.try_into().ok(),
            _ => None,
        }
    }
}

impl FromNode for bool {
    const EXPECTED: &'static str = "true or false";
    fn from_node(node: &Node) -> Option<Self> {
        match node.value {
            Value::Boolean(value) => Some(value),
            _ => None,
        }
    }
}

impl FromNode for String {
    const EXPECTED: &'static str = "text in quotes";
    fn from_node(node: &Node) -> Option<Self> {
        match &node.value {
            Value::Text(text) => Some(text.clone()),
            _ => None,
        }
    }
}

/// A list of exactly N values.
fn list<T: FromNode, const N: usize>(node: &Node) -> Option<[T; N]> {
    let Value::List(items) = &node.value else { return None };
    let values: Option<Vec<T>> = items.iter().map(T::from_node).collect();
    values?.try_into().ok()
}

impl FromNode for [u64; 2] {
    const EXPECTED: &'static str = "a list of 2 integers";
    fn from_node(node: &Node) -> Option<Self> {
        list(node)
    }
}

impl FromNode for [f64; 16] {
    const EXPECTED: &'static str = "a list of 16 numbers";
    fn from_node(node: &Node) -> Option<Self> {
        list(node)
    }
}

impl FromNode for DVec3 {
    const EXPECTED: &'static str = "a list of 3 numbers";
    fn from_node(node: &Node) -> Option<Self> {
        list(node).map(DVec3::from_array)
    }
}

/// One number for all three channels or axes, or one for each.
#[derive(Clone, Copy)]
pub(super) struct OneOrThree(pub Rgb);

impl FromNode for OneOrThree {
    const EXPECTED: &'static str = "a number or a list of 3 numbers";
    fn from_node(node: &Node) -> Option<Self> {
        let one = f64::from_node(node).map(DVec3::splat);
        one.or_else(|| DVec3::from_node(node)).map(Self)
    }
}
