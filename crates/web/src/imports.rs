//! What the page's JavaScript gives to WebAssembly, beside the clock.

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

/// Tells the page what a panic says, which ends the program.
pub fn report_panics() {
    std::panic::set_hook(Box::new(|panic| {
        let message = panic.to_string();
        // SAFETY: the page only reads, and the text outlives the call.
        unsafe { report(message.as_ptr(), message.len()) };
    }));
}
