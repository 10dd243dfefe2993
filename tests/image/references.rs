//! Pictures of another tool.

use glam::DVec3;
use raystream::image::read_color;
use raystream_tests::large_scenes;

#[test]
fn other_tools_references_are_read() {
    let Some(folder) = large_scenes() else { return };
    // Means of the pictures, as the OpenEXR library reads them, summed in double precision.
    let means = [
        ("cornell_ball", [0.157_984_353, 0.100_244_509, 0.028_874_090]),
        ("sibenik", [0.191_285_145, 0.132_125_391, 0.084_355_166]),
        ("conference", [0.323_281_460, 0.259_671_272, 0.224_071_477]),
    ];
    for (scene, expected) in means {
        let image = read_color(&folder.join(scene).join("reference.exr")).unwrap();
        assert_eq!((image.width, image.height), (800, 600));
        let mean = image.pixels.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / 480_000.0;
        for i in 0..3 {
            assert!(
                (mean[i] / expected[i] - 1.0).abs() < 1e-6,
                "{scene}: {mean} is not {expected:?}"
            );
        }
    }
}
