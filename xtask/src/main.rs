use spirv_builder::*;
fn main() {
    let mut b = SpirvBuilder::new("shader-crate", std::env::args().nth(2).unwrap_or("spirv-unknown-spv1.3".into()));
    b.build_script.defaults = false;
    b.toolchain_overwrite = Some(std::env::var("RUST_GPU_TOOLCHAIN").unwrap());
    b.rustc_codegen_spirv_location = Some(std::env::var("RUSTC_CODEGEN_SPIRV").unwrap().into());
    b.release = true;
    let r = b.build().unwrap();
    std::fs::copy(r.module.unwrap_single(), "/tmp/kernels.spv").unwrap();
}
