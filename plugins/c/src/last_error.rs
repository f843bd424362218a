//! The sentence of the last failure, of each thread.

use std::cell::RefCell;
use std::ffi::{CString, c_char};

thread_local! {
    static LAST: RefCell<CString> = RefCell::new(CString::default());
}

/// Forgets it.
pub fn clear() {
    keep("");
}

/// Keeps a sentence.
pub fn keep(sentence: &str) {
    let text = CString::new(sentence.replace('\0', " ")).unwrap_or_default();
    // A thread that is ending keeps none.
    let _ = LAST.try_with(|last| last.replace(text));
}

/// The sentence kept: empty if none is.
pub fn pointer() -> *const c_char {
    LAST.try_with(|last| last.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}
