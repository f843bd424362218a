//! Placeholder of the stage `map`.
