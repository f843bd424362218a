//! Placeholder of the stage `trace`.
