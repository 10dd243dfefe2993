//! Which bytes of a file are its text.

/// The mark that Windows programs put before UTF-8.
pub(super) const UTF8_MARK: &[u8] = b"\xef\xbb\xbf";
/// So many bytes are looked at to tell text from other content.
const LOOKED_AT: usize = 1024;

/// The text of a file without its byte order mark; the error says what the file holds instead of
/// text of a byte a character.
pub(in crate::scene) fn plain_text(bytes: &[u8]) -> Result<&[u8], String> {
    let text = bytes.strip_prefix(UTF8_MARK).unwrap_or(bytes);
    let start = &text[..text.len().min(LOOKED_AT)];
    let marked = [b"\xff\xfe".as_slice(), b"\xfe\xff", b"\x00\x00\xfe\xff"];
    if marked.iter().any(|mark| start.starts_with(mark)) || is_unmarked_utf16(start) {
        Err("is UTF-16 or UTF-32 text; save it as UTF-8".to_owned())
    } else if start.contains(&0) {
        Err("is not a text file".to_owned())
    } else {
        Ok(text)
    }
}

/// Whether every other byte is zero, as in UTF-16 of a text of ASCII.
fn is_unmarked_utf16(start: &[u8]) -> bool {
    let zeros = |parity| start.iter().skip(parity).step_by(2).filter(|&&byte| byte == 0).count();
    let pairs = start.len() / 2;
    let [even, odd] = [zeros(0), zeros(1)];
    pairs >= 2 && even.max(odd) * 10 > pairs * 9 && even.min(odd) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_no_part_of_a_text() {
        assert_eq!(plain_text(b"\xef\xbb\xbfv 0"), Ok(b"v 0".as_slice()));
        assert_eq!(plain_text(b"v 0"), Ok(b"v 0".as_slice()));
        assert_eq!(plain_text(b""), Ok(b"".as_slice()));
        assert_eq!(plain_text(b"caf\xe9"), Ok(b"caf\xe9".as_slice()));
    }

    #[test]
    fn wide_characters_are_named_in_either_order_and_without_a_mark() {
        let wide = |mark: &[u8], bytes: fn(u16) -> [u8; 2]| {
            let text = "v 1 2 3\n".encode_utf16().flat_map(bytes);
            mark.iter().copied().chain(text).collect::<Vec<u8>>()
        };
        for mark in [b"\xff\xfe".as_slice(), b""] {
            assert!(plain_text(&wide(mark, u16::to_le_bytes)).unwrap_err().contains("UTF-16"));
        }
        for mark in [b"\xfe\xff".as_slice(), b""] {
            assert!(plain_text(&wide(mark, u16::to_be_bytes)).unwrap_err().contains("UTF-16"));
        }
        assert!(plain_text(&[0; 64]).unwrap_err().contains("not a text file"));
    }
}
