//! What JavaScript calls. Text and bytes go through one buffer of the program in each direction:
//! JavaScript [reserves](reserve) it and fills it before a call, and reads the
//! [answer](answer_first) after one.

use crate::imports::{Browser, report_panics};
use crate::studio::Studio;
use std::cell::RefCell;

#[derive(Default)]
struct State {
    studio: Option<Studio<Browser>>,
    input: Vec<u8>,
    answer: String,
}

thread_local! {
    static STATE: RefCell<State> = RefCell::default();
}

fn with<T>(change: impl FnOnce(&mut State, &mut Studio<Browser>) -> T) -> T {
    STATE.with_borrow_mut(|state| {
        let mut studio = state.studio.take().unwrap_or_else(|| {
            report_panics();
            Studio::new(Some(Browser))
        });
        let done = change(state, &mut studio);
        state.studio = Some(studio);
        done
    })
}

/// Makes room for an input of so many bytes. Returns where it is.
#[unsafe(no_mangle)]
extern "C" fn reserve(bytes: usize) -> *mut u8 {
    with(|state, _| {
        state.input = vec![0; bytes];
        state.input.as_mut_ptr()
    })
}

/// Answers the question in the input. Returns how many bytes the answer has. While the answer waits
/// for a GPU, nothing else may be called.
#[unsafe(no_mangle)]
extern "C" fn ask() -> usize {
    with(|state, studio| {
        state.answer = match std::str::from_utf8(&state.input) {
            Ok(question) => studio.answer(question),
            Err(error) => serde_json::json!({ "error": error.to_string() }).to_string(),
        };
        state.answer.len()
    })
}

/// Where the answer begins.
#[unsafe(no_mangle)]
extern "C" fn answer_first() -> *const u8 {
    with(|state, _| state.answer.as_ptr())
}

/// Where the pixels that were painted last begin.
#[unsafe(no_mangle)]
extern "C" fn pixels_first() -> *const u8 {
    with(|_, studio| studio.pixels().as_ptr())
}

/// Keeps the input as a file: so many bytes of its name, then its content.
#[unsafe(no_mangle)]
extern "C" fn add_file(name_bytes: usize) {
    with(|state, studio| {
        let mut name = std::mem::take(&mut state.input);
        let content = name.split_off(name_bytes.min(name.len()));
        studio.add_file(&String::from_utf8_lossy(&name), content);
    });
}

/// Forgets all files.
#[unsafe(no_mangle)]
extern "C" fn clear_files() {
    with(|_, studio| studio.clear_files());
}
