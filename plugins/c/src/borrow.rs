//! From the caller's pointers to references and slices.

use std::ffi::{CStr, c_char};

use crate::Failure;

/// What a handle points to.
///
/// # Safety
/// `handle` is null, or points to a living `T` that nobody changes meanwhile.
pub unsafe fn borrow<'a, T>(handle: *const T, name: &str) -> Result<&'a T, Failure> {
    // SAFETY: the caller's.
    unsafe { handle.as_ref() }.ok_or_else(|| Failure::null(name))
}

/// A text in UTF-8.
///
/// # Safety
/// `text` is null, or points to bytes that end with 0.
pub unsafe fn text<'a>(text: *const c_char, name: &str) -> Result<&'a str, Failure> {
    if text.is_null() {
        return Err(Failure::null(name));
    }
    // SAFETY: not null; the rest is the caller's.
    let bytes = unsafe { CStr::from_ptr(text) };
    bytes.to_str().map_err(|_| Failure::argument(format!("{name} is not UTF-8")))
}

/// `count` items of `N` numbers to read; a null pointer is as good as any for none.
///
/// # Safety
/// `numbers` is null, or points to that many that nobody changes meanwhile.
pub unsafe fn items<'a, const N: usize>(
    numbers: *const f64,
    count: usize,
    name: &str,
) -> Result<&'a [[f64; N]], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    check::<[f64; N]>(numbers.is_null(), numbers.is_aligned(), count, name)?;
    // SAFETY: not null, aligned, and of a size that can be; the rest is the caller's.
    Ok(unsafe { std::slice::from_raw_parts(numbers.cast(), count) })
}

/// `count` items of `N` numbers to write.
///
/// # Safety
/// `numbers` is null, or points to room for that many, initialised, that nobody else uses meanwhile.
pub unsafe fn room<'a, const N: usize>(
    numbers: *mut f32,
    count: usize,
    name: &str,
) -> Result<&'a mut [[f32; N]], Failure> {
    if count == 0 {
        return Ok(&mut []);
    }
    check::<[f32; N]>(numbers.is_null(), numbers.is_aligned(), count, name)?;
    // SAFETY: not null, aligned, and of a size that can be; the rest is the caller's.
    Ok(unsafe { std::slice::from_raw_parts_mut(numbers.cast(), count) })
}

fn check<T>(is_null: bool, is_aligned: bool, count: usize, name: &str) -> Result<(), Failure> {
    if is_null {
        return Err(Failure::null(name));
    }
    if !is_aligned {
        return Err(Failure::argument(format!("{name} is not aligned")));
    }
    match count.checked_mul(size_of::<T>()) {
        Some(bytes) if isize::try_from(bytes).is_ok() => Ok(()),
        _ => Err(Failure::argument(format!("{name} cannot have {count} items"))),
    }
}
