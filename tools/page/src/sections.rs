//! What a WebAssembly module has beside its program: names, for debuggers.

use anyhow::{Context, Result, ensure};

/// What every module of this version begins with.
const HEAD: &[u8] = b"\0asm\x01\0\0\0";
/// The kind of a section that is no part of the program.
const CUSTOM: u8 = 0;

/// The module without what browsers do not need.
///
/// # Errors
/// If it is no module.
pub fn without_custom(module: &[u8]) -> Result<Vec<u8>> {
    ensure!(module.starts_with(HEAD), "the compiler has made no WebAssembly of version 1");
    let (mut kept, mut rest) = (HEAD.to_vec(), &module[HEAD.len()..]);
    while let Some((&kind, after)) = rest.split_first() {
        let (length, used) = unsigned(after)?;
        let end = 1 + used + length;
        let section = rest.get(..end).context("the WebAssembly ends within a section")?;
        if kind != CUSTOM {
            kept.extend(section);
        }
        rest = &rest[end..];
    }
    Ok(kept)
}

/// A number of seven bits a byte, the lowest first, and its bytes.
fn unsigned(bytes: &[u8]) -> Result<(usize, usize)> {
    let mut number = 0;
    for (index, byte) in bytes.iter().take(5).enumerate() {
        number |= usize::from(byte & 0x7f) << (7 * index);
        if byte & 0x80 == 0 {
            return Ok((number, index + 1));
        }
    }
    anyhow::bail!("the WebAssembly has a section without a length")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn module(sections: &[&[u8]]) -> Vec<u8> {
        [HEAD, &sections.concat()].concat()
    }

    #[test]
    fn the_program_stays_and_the_names_go() {
        let long: Vec<u8> = [&[10, 0x80, 0x01][..], &[7; 128]].concat();
        let sections: [&[u8]; 3] = [&[1, 2, 8, 9], &[0, 3, 1, b'n', 5], &long];
        let kept = without_custom(&module(&sections)).unwrap();
        assert_eq!(kept, module(&[sections[0], sections[2]]));
        assert_eq!(without_custom(HEAD).unwrap(), HEAD);
    }

    #[test]
    fn what_is_no_module_is_an_error() {
        for wrong in [&b"no"[..], &module(&[&[1, 2, 8]]), &module(&[&[1]]), &module(&[&[1, 0xff]])]
        {
            assert!(without_custom(wrong).is_err(), "{wrong:?}");
        }
    }
}
