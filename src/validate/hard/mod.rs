//! Numerically hard cases.
use super::report::Report;
use super::error::ValidateError;

pub fn hard_cases() -> Result<Report, ValidateError> { Ok(Report::default()) }
