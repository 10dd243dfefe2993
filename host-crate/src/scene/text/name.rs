//! Names as files spell them.

use std::fmt;

/// A name in an OBJ or MTL: the bytes that stand there, in whatever encoding. Two names are equal
/// if their bytes are.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(in crate::scene) struct Name(pub Vec<u8>);

impl Name {
    pub(in crate::scene) fn new(bytes: &[u8]) -> Self {
        Self(bytes.to_vec())
    }
}

/// Bytes that are not UTF-8, and those that would disturb a terminal, as `\xNN`.
impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for chunk in self.0.utf8_chunks() {
            for character in chunk.valid().chars() {
                if character.is_control() {
                    write!(f, "{}", character.escape_default())?;
                } else {
                    write!(f, "{character}")?;
                }
            }
            for byte in chunk.invalid() {
                write!(f, "\\x{byte:02X}")?;
            }
        }
        Ok(())
    }
}

/// A word for a message: the start of one that is long.
pub(in crate::scene) fn shown(word: &[u8]) -> String {
    const LONGEST: usize = 60;
    let more = if word.len() > LONGEST { "..." } else { "" };
    format!("{}{more}", word[..word.len().min(LONGEST)].escape_ascii())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_any_bytes_are_shown_apart() {
        assert_eq!(Name::new("Tür".as_bytes()).to_string(), "Tür");
        assert_eq!(Name::new(b"T\xfcr").to_string(), "T\\xFCr");
        assert_eq!(Name::new(b"T\xf6r").to_string(), "T\\xF6r");
        assert_eq!(Name::new(b"a\x1b[2J").to_string(), "a\\u{1b}[2J");
        assert_eq!(shown(&[b'x'; 1000]), format!("{}...", "x".repeat(60)));
    }
}
