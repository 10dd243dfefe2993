//! Filters: what rows of attributes stand for.

use std::f32::consts::FRAC_1_SQRT_2;

/// Unit vectors of four bytes, or four integers of two, from octahedral coordinates; the fourth
/// stays.
pub fn octahedral(rows: &mut [u8], stride: usize) {
    for row in rows.chunks_exact_mut(stride) {
        if let [x, y, z, _] = row {
            let unit = vector([*x, *y, *z].map(|byte| f32::from(byte as i8)), 127.0);
            [*x, *y, *z] = unit.map(|number| number as i8 as u8);
        } else {
            let unit = vector([0, 1, 2].map(|index| f32::from(short(row, index))), 32_767.0);
            for (index, number) in unit.into_iter().enumerate() {
                set_short(row, index, number as i16);
            }
        }
    }
}

/// A unit vector, times `most`, of octahedral coordinates and what stands for 1.
fn vector([x, y, one]: [f32; 3], most: f32) -> [f32; 3] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    let below = z.min(0.0);
    let (x, y) = (x - below.copysign(x), y - below.copysign(y));
    let scale = most / (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|number| (number * scale).round())
}

/// Quaternions of four integers of two bytes, from their three smaller components.
pub fn quaternions(rows: &mut [u8]) {
    for row in rows.chunks_exact_mut(8) {
        let last = short(row, 3);
        let one = f32::from(last | 3);
        let [x, y, z] = [0, 1, 2].map(|index| f32::from(short(row, index)) / one * FRAC_1_SQRT_2);
        let largest = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let first = (last & 3) as usize;
        for (turn, number) in [largest, x, y, z].into_iter().enumerate() {
            set_short(row, (first + turn) % 4, (number * 32_767.0).round() as i16);
        }
    }
}

/// Floats of four bytes, from an exponent of 8 bits and a mantissa of 24.
pub fn exponential(rows: &mut [u8]) {
    for number in rows.chunks_exact_mut(4) {
        let code = i32::from_le_bytes([number[0], number[1], number[2], number[3]]);
        let (exponent, mantissa) = (code >> 24, code << 8 >> 8);
        let value = (exponent as f32).exp2() * mantissa as f32;
        number.copy_from_slice(&value.to_le_bytes());
    }
}

fn short(row: &[u8], index: usize) -> i16 {
    i16::from_le_bytes([row[2 * index], row[2 * index + 1]])
}

fn set_short(row: &mut [u8], index: usize, value: i16) {
    row[2 * index..2 * index + 2].copy_from_slice(&value.to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_are_of_unit_length() {
        // (0.5, -0.25) of 7, which is 1 in four bits; below, with 127.
        let mut rows = [3, 0xfe, 7, 9, 127, 127, 127, 1];
        octahedral(&mut rows, 4);
        let unit = |at: usize| [0, 1, 2].map(|k| f32::from(rows[at + k] as i8) / 127.0);
        let expected = [3.0, -2.0, 2.0_f32].map(|x| x / 17.0_f32.sqrt());
        for (found, expected) in unit(0).into_iter().zip(expected) {
            assert!((found - expected).abs() <= 1.0 / 127.0, "{rows:?}");
        }
        assert_eq!((rows[3], rows[7]), (9, 1));
        assert_eq!(unit(4)[2], -1.0, "{rows:?}");
        let mut rows: Vec<u8> =
            [512_i16, 0, 1023, 5].into_iter().flat_map(i16::to_le_bytes).collect();
        octahedral(&mut rows, 8);
        let (x, z) = (f32::from(short(&rows, 0)), f32::from(short(&rows, 2)));
        assert!(((x * x + z * z).sqrt() - 32_767.0).abs() < 1.5 && (x - z).abs() < 100.0);
        assert_eq!(short(&rows, 3), 5);
    }

    #[test]
    fn quaternions_have_their_largest_component_back() {
        // One is 1023 with the index 2 in its lowest bits.
        let mut rows: Vec<u8> =
            [1023_i16, 0, 0, 1020 | 2].into_iter().flat_map(i16::to_le_bytes).collect();
        quaternions(&mut rows);
        let half = (FRAC_1_SQRT_2 * 32_767.0).round() as i16;
        assert_eq!([0, 1, 2, 3].map(|index| short(&rows, index)), [0, 0, half, half]);
    }

    #[test]
    fn floats_are_mantissas_times_powers_of_two() {
        let codes = [0x0000_0005_u32, 0xfe00_0003, 0x02ff_ffff];
        let mut rows: Vec<u8> = codes.into_iter().flat_map(u32::to_le_bytes).collect();
        exponential(&mut rows);
        let floats: Vec<f32> = bytemuck::pod_collect_to_vec(&rows);
        assert_eq!(floats, [5.0, 0.75, -4.0]);
    }
}
