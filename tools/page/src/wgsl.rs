//! The kernels as browsers take them: WGSL, made of the SPIR-V that is checked in.

use crate::wasm::root;
use anyhow::{Context, Result, bail};
use naga::back::wgsl::{WriterFlags, write_string};
use naga::compact::{KeepUnused, compact};
use naga::front::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::collections::BTreeMap;
use std::fs;

/// The kernels of all programs, from the repository's root.
const SPIRV: &str = "host-crate/shaders/kernels.spv";

/// The text of each kernel by its name. In it the word of abilities is an override, which the page
/// sets when it makes a pipeline.
///
/// # Errors
/// If the SPIR-V cannot be read, or a kernel has no WGSL.
pub fn kernels() -> Result<BTreeMap<String, String>> {
    let path = root()?.join(SPIRV);
    let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    translated(&bytes).with_context(|| format!("{} has no WGSL", path.display()))
}

/// WGSL of each entry point of a module.
fn translated(spirv: &[u8]) -> Result<BTreeMap<String, String>> {
    let options = spv::Options { strict_capabilities: true, ..spv::Options::default() };
    let all = spv::parse_u8_slice(spirv, &options)?;
    let mut texts = BTreeMap::new();
    for index in 0..all.entry_points.len() {
        let mut module = all.clone();
        module.entry_points = vec![module.entry_points.swap_remove(index)];
        compact(&mut module, KeepUnused::No);
        let name = module.entry_points[0].name.clone();
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        let info = match validator.validate(&module) {
            Ok(info) => info,
            Err(error) => bail!("{name}: {}", error.emit_to_string("")),
        };
        let text = write_string(&module, &info, WriterFlags::empty()).context(name.clone())?;
        texts.insert(name, text);
    }
    Ok(texts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kernel_has_a_text_with_its_own_entry_point_and_abilities_to_set() {
        let texts = kernels().unwrap();
        assert!(texts.len() > 50);
        for (name, text) in &texts {
            assert!(text.contains(&format!("fn {name}(")), "{name}");
            assert_eq!(text.matches("@compute").count(), 1, "{name}");
            let overrides = text.matches("@id(0) override").count();
            assert_eq!(text.matches("override ").count(), overrides, "{name}");
            let asks = ["trace_paths", "first_hits"].contains(&name.as_str());
            assert!(overrides <= 1 && (overrides == 1 || !asks), "{name}: {overrides}");
        }
    }

    #[test]
    fn what_is_no_spirv_is_an_error() {
        assert!(translated(b"").is_err());
        assert!(translated(&[7; 64]).is_err());
    }
}
