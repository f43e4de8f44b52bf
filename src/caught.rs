//! Panics as values: a fault of the program in one piece of work must neither end
//! the other pieces nor leave them waiting.

use std::{
    any::Any,
    cell::RefCell,
    panic::{self, AssertUnwindSafe},
};

thread_local! {
    /// What the last panic of this thread said, and where.
    static LAST: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Does a piece of work; what it was about to return, or what its panic said.
///
/// # Errors
/// The message of the panic, with file and line where [`note_panics`] was called.
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    LAST.take();
    panic::catch_unwind(AssertUnwindSafe(work))
        .map_err(|payload| LAST.take().unwrap_or_else(|| said(&*payload)))
}

/// Has panics of this process noted for [`caught`] instead of printed. With
/// `RUST_BACKTRACE` set they are printed as well.
pub fn note_panics() {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        let mut what = said(info.payload());
        if let Some(place) = info.location() {
            what += &format!(" ({}:{})", place.file(), place.line());
        }
        tracing::debug!("a panic: {what}");
        LAST.set(Some(what));
        if std::env::var_os("RUST_BACKTRACE").is_some_and(|v| v != "0") {
            usual(info);
        }
    }));
}

fn said(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no reason was given").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_value_with_its_words() {
        assert_eq!(caught(|| 7), Ok(7), "law: what is returned is handed on");
        let index = 3;
        let got = caught(|| [1, 2][index % 4]).expect_err("there is no fourth");
        assert!(got.contains("index is 3"), "law: the words of the panic, got `{got}`");
        let got = caught(|| panic::panic_any(1_u8)).expect_err("a panic");
        // Where the process notes panics, their place follows.
        let said = got.starts_with("no reason was given");
        assert!(said, "law: a panic without words is one, too, got `{got}`");
    }
}
