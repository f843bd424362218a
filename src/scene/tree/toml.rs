//! TOML to a tree, with the line of every key.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{Node, Origin, SyntaxError, Value};

pub(super) fn parse(text: &str) -> Result<Node, SyntaxError> {
    let lines = Lines::of(text);
    let table = DeTable::parse(text).map_err(|error| SyntaxError {
        line: error.span().map_or(1, |span| lines.line(span)),
        problem: error.message().trim().replace('\n', "; "),
    })?;
    let origin = Origin::Line(1);
    Ok(Node { origin, value: convert_table(table.get_ref(), &lines) })
}

fn convert_table(table: &DeTable<'_>, lines: &Lines) -> Value {
    let entry = |(key, value): (&Spanned<_>, &Spanned<_>)| {
        let origin = Origin::Line(lines.line(key.span()));
        let name: &std::borrow::Cow<'_, str> = key.get_ref();
        (name.to_string(), Node { origin, value: convert(value, lines) })
    };
    Value::Table(table.iter().map(entry).collect())
}

fn convert(value: &Spanned<DeValue<'_>>, lines: &Lines) -> Value {
    match value.get_ref() {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Boolean(value) => Value::Boolean(*value),
        DeValue::Integer(digits) => i128::from_str_radix(digits.as_str(), digits.radix())
            .map_or(Value::Foreign("an integer of too many digits"), Value::Integer),
        DeValue::Float(digits) => {
            digits.as_str().parse().map_or(Value::Foreign("not a number"), Value::Float)
        }
        DeValue::Datetime(_) => Value::Foreign("a date"),
        DeValue::Array(items) => Value::List(items.iter().map(|i| item(i, lines)).collect()),
        DeValue::Table(table) => convert_table(table, lines),
    }
}

fn item(value: &Spanned<DeValue<'_>>, lines: &Lines) -> Node {
    Node { origin: Origin::Line(lines.line(value.span())), value: convert(value, lines) }
}

/// Where lines start, in bytes.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        Self(text.match_indices('\n').map(|(position, _)| position + 1).collect())
    }

    /// The line a span begins in, from 1.
    fn line(&self, span: Range<usize>) -> usize {
        1 + self.0.partition_point(|&start| start <= span.start)
    }
}
