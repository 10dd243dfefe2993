//! What the page's JavaScript gives to WebAssembly, beside the clock.

use crate::webgpu::Driver;

#[link(wasm_import_module = "raystream")]
unsafe extern "C" {
    /// Fills memory with random bytes.
    fn random(first: *mut u8, bytes: usize);
    /// Tells the page why the program ends, in UTF-8.
    fn report(first: *const u8, bytes: usize);
}

/// Random numbers, as the crate `getrandom` asks for them on platforms that it does not know.
#[unsafe(no_mangle)]
unsafe extern "Rust" fn __getrandom_v03_custom(
    first: *mut u8,
    bytes: usize,
) -> Result<(), getrandom_03::Error> {
    // SAFETY: the caller owns this memory, and the page writes within it.
    unsafe { random(first, bytes) };
    Ok(())
}

#[link(wasm_import_module = "raystream_gpu")]
unsafe extern "C" {
    /// A new buffer's number, or 0 where there is no room. Like all that waits for the GPU it
    /// returns when that is done.
    fn allocate(bytes: f64) -> u32;
    /// Forgets a buffer.
    fn free(buffer: u32);
    /// Copies memory into a buffer.
    fn write(buffer: u32, first_byte: f64, first: *const u8, bytes: usize);
    /// Copies a part of a buffer to memory. Waits.
    fn read(buffer: u32, first_byte: f64, first: *mut u8, bytes: usize);
    /// Runs launches: their description in UTF-8, and all their parameters. Waits.
    fn run(text: *const u8, text_bytes: usize, parameters: *const u8, parameter_bytes: usize);
    /// How many bytes there are to say of what has gone wrong since this was last called; 0 for
    /// nothing.
    fn failure() -> usize;
    /// What [`failure`] counted, in UTF-8.
    fn failure_text(first: *mut u8);
}

/// The GPU that the page has opened.
#[derive(Clone, Copy, Debug)]
pub struct Browser;

impl Driver for Browser {
    fn allocate(&self, bytes: u64) -> Option<u32> {
        // SAFETY: it is given no memory.
        let number = unsafe { allocate(bytes as f64) };
        (number != 0).then_some(number)
    }

    fn free(&self, buffer: u32) {
        // SAFETY: it is given no memory.
        unsafe { free(buffer) };
    }

    fn write(&self, buffer: u32, first_byte: u64, bytes: &[u8]) {
        // SAFETY: the page only reads, and within these bytes.
        unsafe { write(buffer, first_byte as f64, bytes.as_ptr(), bytes.len()) };
    }

    fn read(&self, buffer: u32, first_byte: u64, bytes: &mut [u8]) {
        // SAFETY: the page writes within these bytes, which are borrowed until it returns.
        unsafe { read(buffer, first_byte as f64, bytes.as_mut_ptr(), bytes.len()) };
    }

    fn run(&self, work: &str, parameters: &[u8]) {
        // SAFETY: the page only reads, and both outlive the call.
        unsafe { run(work.as_ptr(), work.len(), parameters.as_ptr(), parameters.len()) };
    }

    fn failure(&self) -> Option<String> {
        // SAFETY: it is given no memory.
        let bytes = unsafe { failure() };
        if bytes == 0 {
            return None;
        }
        let mut text = vec![0; bytes];
        // SAFETY: it writes as many bytes as it has just said.
        unsafe { failure_text(text.as_mut_ptr()) };
        Some(String::from_utf8_lossy(&text).into_owned())
    }
}

/// Tells the page what a panic says, which ends the program.
pub fn report_panics() {
    std::panic::set_hook(Box::new(|panic| {
        let message = panic.to_string();
        // SAFETY: the page only reads, and the text outlives the call.
        unsafe { report(message.as_ptr(), message.len()) };
    }));
}
