//! Mode 0: rows of any kind, each byte as the difference to that of the row before.

use super::Broken;
use super::stream::{Stream, signed};

const HEADER: u8 = 0xa0;
/// Rows in a group.
const GROUP: usize = 16;
/// Bytes of the row that the first one is relative to, at least.
const TAIL: usize = 32;

/// `count` rows of `stride` bytes, of which there are some.
pub fn decode(bytes: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, Broken> {
    let (mut stream, tail) = Stream::between(bytes, HEADER, stride.max(TAIL))?;
    let mut last = tail[tail.len() - stride..].to_vec();
    let most = ((8192 / stride) & !(GROUP - 1)).min(256);
    let mut rows = vec![0; count * stride];
    for block in rows.chunks_mut(most * stride) {
        let groups = (block.len() / stride).div_ceil(GROUP);
        for (column, last) in last.iter_mut().enumerate() {
            let modes = stream.take(groups.div_ceil(4))?;
            for (group, rows) in block.chunks_mut(GROUP * stride).enumerate() {
                let mode = modes[group / 4] >> (group % 4 * 2) & 3;
                let differences = differences(&mut stream, mode)?;
                for (row, difference) in rows.chunks_mut(stride).zip(differences) {
                    *last = last.wrapping_add(signed(difference.into()) as u8);
                    row[column] = *last;
                }
            }
        }
    }
    stream.end()?;
    Ok(rows)
}

/// The codes of the differences of a group.
fn differences(stream: &mut Stream<'_>, mode: u8) -> Result<[u8; GROUP], Broken> {
    let bits = match mode {
        0 => return Ok([0; GROUP]),
        3 => {
            let mut codes = [0; GROUP];
            codes.copy_from_slice(stream.take(GROUP)?);
            return Ok(codes);
        }
        _ => 2 * usize::from(mode),
    };
    // The largest code says that a byte follows.
    let most = (1 << bits) - 1;
    let packed = stream.take(GROUP * bits / 8)?;
    let mut codes = [0; GROUP];
    for (index, code) in codes.iter_mut().enumerate() {
        let place = index * bits;
        let short = packed[place / 8] >> (8 - bits - place % 8) & most;
        *code = if short == most { stream.byte()? } else { short };
    }
    Ok(codes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the specification, as the first of four columns; the second is stored in two
    /// bits, the third whole, the fourth does not change.
    #[test]
    fn differences_are_stored_in_as_many_bits_as_they_need() {
        let four_bits = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
        let whole: Vec<u8> = (0..16).collect();
        let baseline = [100, 50, 0, 7];
        let stream = [
            [HEADER, 2].as_slice(),
            &four_bits,
            &[1, 0b00_01_10_11, 0, 0, 0, 9],
            &[3],
            &whole,
            &[0],
            &[0; 28],
            &baseline,
        ]
        .concat();
        let rows = decode(&stream, 16, 4).unwrap();
        let column = |index: usize| rows.iter().skip(index).step_by(4).copied().collect::<Vec<_>>();
        let steps = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0];
        let mut place = 100_i32;
        let expected = steps.map(|step| {
            place += step;
            place as u8
        });
        assert_eq!(column(0), expected);
        assert_eq!(column(1)[..5], [50, 49, 50, 45, 45]);
        assert_eq!(column(2)[..5], [0, 255, 0, 254, 0]);
        assert_eq!(column(3), [7; 16]);
        for length in 0..stream.len() {
            assert!(decode(&stream[..length], 16, 4).is_err(), "{length} bytes");
        }
        let end = stream.len() - TAIL;
        let longer = [&stream[..end], &[0], &stream[end..]].concat();
        assert!(matches!(decode(&longer, 16, 4), Err(Broken::TooLong(1))));
    }
}
