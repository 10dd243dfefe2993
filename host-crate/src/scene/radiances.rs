//! Numbers of pictures, as radiances.

use super::bounds;
use glam::Vec3;

/// What every OpenEXR file begins with.
pub(super) const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Makes radiances of all texels, and says so if some were none.
pub(super) fn mend(texels: &mut [Vec3]) -> Option<String> {
    let components = texels.iter().flat_map(Vec3::to_array);
    let brightest =
        components.filter(|c| f64::from(*c) <= bounds::MAX_RADIANCE).fold(0.0, f32::max);
    let mut mended = 0;
    for texel in texels.iter_mut() {
        let fine = texel.to_array().map(|component| {
            if component.is_nan() { 0.0 } else { component.clamp(0.0, brightest) }
        });
        if fine != texel.to_array() {
            mended += 1;
            *texel = Vec3::from_array(fine);
        }
    }
    (mended > 0).then(|| {
        format!(
            "{mended} texels are no radiances: what is negative or not a number is black, what is \
             infinite as bright as the brightest of the others, {brightest}."
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_radiance_is_mended_and_said() {
        let mut texels = vec![
            Vec3::new(1.0, 2.0, 3.0),
            Vec3::new(f32::NAN, -1.0, f32::INFINITY),
            Vec3::new(f32::NEG_INFINITY, 0.0, 0.5),
        ];
        let warning = mend(&mut texels).unwrap();
        assert!(warning.starts_with("2 texels") && warning.contains("others, 3."), "{warning}");
        let expected = [Vec3::new(1.0, 2.0, 3.0), Vec3::Z * 3.0, Vec3::Z * 0.5];
        assert_eq!(texels, expected);
        assert_eq!(mend(&mut texels), None);
    }
}
